"""What archives and users write: checksums, array assignments, names without prefix, slips and repeats."""

from __future__ import annotations

import re

import pytest

from chainbuild.findings import Collector
from chainbuild.formats.sinumerik.reading.data_table import tabulate
from chainbuild.formats.sinumerik.reading.reader import Reading, read_assignments
from chainbuild.formats.text import SourceText
from chainbuild.machines import shipped_path
from tests.kit.robx_files import NR6, close, pose_of, read, robx_text


def reading(text: str, collector: Collector | None = None) -> Reading:
    return read_assignments(SourceText("a.tea", text, "utf-8"), collector or Collector())


def values(text: str) -> list[object]:
    return [row.value for row in reading(text).assignments]


CHECKSUMS = {
    "number": ("N62908 $MC_ROBX_TX3P3_POS[0]=1444 '2F34", 1444.0),
    "lower case, closed": ("N62908 $MC_ROBX_TX3P3_POS[0]=-14.5 '2f3c'", -14.5),
    "one digit": ("$MC_ROBX_NUM_AXES=6 '0", 6.0),
    "hexadecimal value": ("$MC_ROBX_SPECIAL_FEATURE_MASK='H1F' '2F34", 31.0),
    "binary value": ("$MC_ROBX_SPECIAL_FEATURE_MASK='B101' 'b101", 5.0),
    "binary value without one": ("$MC_ROBX_SPECIAL_FEATURE_MASK 'B101'", 5.0),
    "string": ('$MN_AXCONF_MACHAX_NAME_TAB[0]="RX1" \'4a1b', "RX1"),
    "string, no blank": ('$MN_AXCONF_MACHAX_NAME_TAB[0]="RX1"\'4a1b', "RX1"),
    "string that looks like one": ('$MN_AXCONF_MACHAX_NAME_TAB[0]="X \'2F"', "X '2F"),
    "empty string": ('$MN_AXCONF_MACHAX_NAME_TAB[9]="" \'1fff', ""),
    "before a comment": ("$MC_ROBX_NUM_AXES=6 '2F34 ; six", 6.0),
}


@pytest.mark.parametrize("form", CHECKSUMS)
def test_checksums_of_lines(form):
    text, value = CHECKSUMS[form]
    assert values(text) == [value]


def test_an_archive_with_checksums_is_the_file_without(tmp_path):
    plain = shipped_path("irb2600_track").read_text("utf-8")
    lines, summed = plain.splitlines(), 0
    for n, line in enumerate(lines):
        if re.match(r"\s*(?:N\d+\s*)?\$M[NCA]_", line):
            code, semicolon, comment = line.partition(";")
            lines[n] = f"{code.rstrip()} '{(n * 7919) % 0xFFFF:x} {semicolon}{comment}"
            summed += 1
    names = [f'N10000 $MN_AXCONF_MACHAX_NAME_TAB[{n}]="MX{n + 1}" \'{n:x}a' for n in range(8)]
    assert summed > 40
    archive = read("\n".join(["%_N_NC_TEA", *names, *lines]))
    assert not [f for f in archive.findings if f.severity != "info"]
    ours, theirs = archive.chain(), read(plain).chain()
    axes = [10.0 * n for n in range(7)]
    assert close(pose_of(ours, axes), pose_of(theirs, axes))
    assert ours.axes == theirs.axes


def test_a_channel_with_a_checksum():
    assert reading("CHANDATA(2) '1a2\n$MC_ROBX_NUM_AXES=6").channels == (2,)


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("$MC_ROBX_TX3P3_POS[0]=SET(1, -2.5,3e1)", {0: 1.0, 1: -2.5, 2: 30.0}),
        ("$MC_ROBX_AXES_DIR[2] = set(-1,1) '3f", {2: -1.0, 3: 1.0}),
        ("$MC_ROBX_MAIN_LENGTH_AB=SET(150,700)", {0: 150.0, 1: 700.0}),
        ("$MC_ROBX_NUM_AXES=SET(6)", {None: 6.0}),
        ('$MN_AXCONF_MACHAX_NAME_TAB[0]=SET("X,1", "Y1")', {0: "X,1", 1: "Y1"}),
    ],
)
def test_array_assignments(line, expected):
    assert {row.index: row.value for row in reading(line).assignments} == expected


def test_data_of_the_control_without_their_prefix():
    text = robx_text(NR6).replace("$MC_", "")
    assert "TRAFO_TYPE_1=4100" in text
    assert [entry.type for entry in read(text).kinematics()][:1] == ["ROBX NR, 6 axes"]


@pytest.mark.parametrize(
    ("text", "stands"),
    [
        ("$MC_ROBX_MAIN_LENGHT_AB[1]=1150", "MAIN_LENGTH_AB keeps its default 0, 500"),
        ("$MC_ROBX_MAIN_LENGHT_AB[1]=1150\n$MC_ROBX_MAIN_LENGTH_AB[0]=25", "MAIN_LENGTH_AB keeps the value 25, 500"),
        ("$MC_ROBX_MAIN_LENGHT_AB[1]=1150\nCHANDATA(2)\n$MC_ROBX_MAIN_LENGTH_AB[0]=25", "its default 0, 500"),
    ],
)
def test_a_misspelt_name_says_what_counts_in_its_place(text, stands):
    collector = Collector()
    reading(text, collector)
    (finding,) = [f for f in collector.findings if f.code == "CB108"]
    assert stands in finding.text
    assert finding.hint == "did you mean $MC_ROBX_MAIN_LENGTH_AB?"
    assert finding.span.line == 1


def test_a_misspelt_name_of_the_older_package():
    collector = Collector()
    reading("$MC_TRAFO6_NUM_AXIS=6\n$MC_TRAFO6_NUM_AXES=5", collector)
    assert collector.findings[0].hint == "did you mean $MC_TRAFO6_NUM_AXES?"
    assert "NUM_AXES keeps the value 5" in collector.findings[0].text


def test_equal_repeats_are_counted_and_differing_ones_warned_of():
    collector = Collector()
    lines = ["$MC_ROBX_NUM_AXES=6", "$MC_ROBX_NUM_AXES=6.0", "$MC_ROBX_KINCLASS=1", "$MC_ROBX_KINCLASS=1"]
    table = tabulate(reading("\n".join([*lines, "$MC_ROBX_NUM_AXES=5"])), collector)
    assert table.channel(1).number("ROBX_NUM_AXES") == 5
    assert [(f.code, f.severity) for f in collector.findings] == [("CB113", "warning"), ("CB117", "info")]
    assert "same value: 2" in collector.findings[1].text
