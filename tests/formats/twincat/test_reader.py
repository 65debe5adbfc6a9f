"""Every text form of a TwinCAT parameter list."""

from __future__ import annotations

import pytest

from chainbuild.errors import ChainbuildError
from chainbuild.findings import Collector
from tests.kit.twincat_files import codes, parameters


def number(line: str) -> float:
    (entry,) = parameters(line).assignments.values()
    return entry.number()


def text(line: str) -> str:
    (entry,) = parameters(line).assignments.values()
    return entry.text()


@pytest.mark.parametrize(
    ("line", "value"),
    [
        ("trafo[0].param[6] 4000000", 4000000.0),
        ("trafo[0].param[6]\t4000000", 4000000.0),
        ("   trafo[0].param[6]     4000000   ", 4000000.0),
        ("trafo[0].param[6] -900000", -900000.0),
        ("trafo[0].param[6] +900000", 900000.0),
        ("trafo[0].param[6] 1.5", 1.5),
        ("trafo[0].param[6] .5", 0.5),
        ("trafo[0].param[6] 5.", 5.0),
        ("trafo[0].param[6] 1e6", 1e6),
        ("trafo[0].param[6] -1.25E-3", -0.00125),
        ("trafo[0].param[6] 0x10", 16.0),
        ("trafo[0].param[6] 7 everything behind the blank is comment", 7.0),
        ("trafo[0].param[6] 7 # with a mark", 7.0),
        ("trafo[0].param[6] 7 ( HD7", 7.0),
        ("trafo[0].param[6] 7( HD7", 7.0),
        ("trafo[0].param[6] 7#HD7", 7.0),
        ("trafo[0].param[6] 7 1.5, 8", 7.0),
        ("trafo[0]. param[6] 7", 7.0),
        ("TRAFO[0].Param[6] 7", 7.0),
    ],
)
def test_numbers(line: str, value: float) -> None:
    assert number(line) == value


@pytest.mark.parametrize(
    ("line", "value"),
    [
        ("trafo[0].name ROBOT", "ROBOT"),
        ('trafo[0].name "ROBOT"', "ROBOT"),
        ("trafo[0].name 'ROBOT'", "ROBOT"),
        ('trafo[0].name "ROB (1)" ( comment', "ROB (1)"),
        ("trafo[0].name LIN ROB", "LIN ROB"),
        ("trafo[0].name LINEAR (Linear axis first executes", "LINEAR"),
        ("trafo[0].name LINEAR (closed) and more", "LINEAR"),
        ("trafo[0].name LINEAR # comment", "LINEAR"),
        ("trafo[0].name CA-TABLE", "CA-TABLE"),
        ("trafo[0].name Führung", "Führung"),
        ('trafo[0].name ""', ""),
    ],
)
def test_strings(line: str, value: str) -> None:
    assert text(line) == value


def test_comments_blank_lines_and_the_end() -> None:
    read = parameters("# full line\n\n  # indented\n( also a comment\ntrafo[0].id 45\nEnde\nnothing = here\n")
    assert list(read.assignments) == ["kin_step[0].trafo[0].id"]
    assert read.ignored == 0


@pytest.mark.parametrize("end", ["Ende", "ENDE", "ende", "  Ende  "])
def test_the_end_ends_the_list(end: str) -> None:
    collector = Collector()
    read = parameters(f"trafo[0].id 45\n{end}\ntrafo[1].id 9\ntrafo[2].id 9", collector)
    assert len(read.assignments) == 1
    assert codes(collector) == ["CB208"]
    assert collector.findings[0].span is not None
    assert collector.findings[0].span.line == 3


def test_short_and_long_names_are_the_same() -> None:
    collector = Collector()
    read = parameters("trafo[3].param[1] 5\nkin_step[0].trafo[3].param[1] 6", collector)
    (entry,) = read.assignments.values()
    assert entry.number() == 6
    assert codes(collector) == ["CB205"]
    assert "line 1" in collector.findings[0].text


def test_the_later_value_counts() -> None:
    collector = Collector()
    read = parameters("trafo[0].id 45\ntrafo[0].param[6] 1\ntrafo[0].param[6] 2", collector)
    entry = read.get("kin_step[0].trafo[0].param[6]")
    assert entry is not None
    assert entry.number() == 2
    finding = collector.findings[0]
    assert (finding.code, finding.severity) == ("CB205", "warning")
    assert finding.span is not None
    assert finding.span.line == 3


def test_unrelated_entries_are_counted() -> None:
    read = parameters("slope_profil 1\nm_synch[34] 0x00000002 MVS_SVS (M function\ntrafo[0].id 45\nspdl_anzahl 1")
    assert read.ignored == 3
    assert len(read.assignments) == 1


def test_strange_lines_are_reported_once() -> None:
    collector = Collector()
    parameters("=====\ntrafo[0].id 45\n%%%\n[]", collector)
    assert codes(collector) == ["CB207"]
    assert "3 line(s)" in collector.findings[0].text


def test_places_are_kept() -> None:
    (entry,) = parameters("\n\n  trafo[0].param[6]   x1").assignments.values()
    assert (entry.span.line, entry.span.column) == (3, 3)
    with pytest.raises(ChainbuildError) as caught:
        entry.number()
    assert caught.value.span is not None
    assert (caught.value.line, caught.value.span.column) == (3, 23)
    assert caught.value.marked_line().endswith("\n" + " " * 26 + "^")


def test_a_lenient_reader_goes_on() -> None:
    collector = Collector(strict=False)
    read = parameters("trafo[0].id=45\ntrafo[x].id 3\ntrafo[1].id 9", collector)
    assert codes(collector) == ["CB201", "CB203"]
    assert list(read.assignments) == ["kin_step[0].trafo[1].id"]
