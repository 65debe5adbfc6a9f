"""Every command that reads a table reads it as people have it: a German Excel export, tabs, UTF-16, standard input."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path

import pytest

from tests.kit.command_line import Run, rows_of, write

MACHINE = "kr6r900"
NAMES = ("A1", "A2", "A3", "A4", "A5", "A6")
ROWS = ((0.0, -90.0, 90.0, 0.0, 30.5, 0.0), (5.25, -85.0, 85.0, 10.0, 35.0, 0.0))
PLAIN = "\n".join([",".join(NAMES), *(",".join(map(str, row)) for row in ROWS)]) + "\n"
GERMAN = "sep=;\r\n# exported\r\n" + PLAIN.replace(",", ";").replace(".", ",").replace("A1;", "a1 [°];") + ";;;;;\r\n"
HABITS = {
    "german": GERMAN.encode("cp1252"),
    "utf-16": GERMAN.encode("utf-16"),
    "tabs": PLAIN.replace(",", "\t").encode(),
}


@pytest.fixture(params=list(HABITS))
def axes(request: pytest.FixtureRequest, run: Run) -> str:
    Path("habit.csv").write_bytes(HABITS[request.param])
    return "habit.csv"


COMMANDS = {
    "fk": ("fk", "--axes"),
    "collide": ("collide", "--json", "--axes"),
    "singularity": ("singularity", "--json", "--axes"),
}


@pytest.mark.parametrize("words", COMMANDS.values(), ids=COMMANDS)
def test_axis_tables(run: Run, axes: str, words: tuple[str, ...]) -> None:
    name, *options = words
    write("plain.csv", PLAIN)
    found, expected = (run(name, MACHINE, *options, table) for table in (axes, "plain.csv"))
    assert (found.code, found.out) == (expected.code, expected.out)
    assert found.out


def test_poses_starts_and_recordings(run: Run, axes: str) -> None:
    run("fk", MACHINE, "--axes", axes, "-o", "poses.csv")
    plain = Path("poses.csv").read_text("utf-8")
    write("german.csv", plain.replace(",", ";").replace(".", ","))
    expected = run("ik", MACHINE, "--poses", "poses.csv", "--start", axes)
    assert run("ik", MACHINE, "--poses", "german.csv", "--start", axes).out == expected.out
    found = [[float(row[name]) for name in NAMES] for row in rows_of(expected.out)]
    assert found == [pytest.approx(row) for row in ROWS]
    lines = zip(PLAIN.splitlines(), plain.splitlines(), strict=True)
    write("recorded.csv", "".join(f"{left},{right}\n".replace(",", ";").replace(".", ",") for left, right in lines))
    checked = json.loads(run("crosscheck", MACHINE, "--recording", "recorded.csv", "--json").out)
    assert checked["agrees"] is True


def test_pages_play_such_tables_back(run: Run, axes: str) -> None:
    assert run("inspect", MACHINE, "--export", "page.html", "--axes", axes).code == 0
    assert "habit.csv" in Path("page.html").read_text("utf-8")


def test_a_table_comes_from_standard_input(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    write("plain.csv", PLAIN)
    expected = run("fk", MACHINE, "--axes", "plain.csv")
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(GERMAN.encode("utf-16"))))
    assert run("fk", MACHINE, "--axes", "-").out == expected.out
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(expected.out.encode())))
    assert run("ik", MACHINE, "--poses", "-", "--start", "plain.csv", "-o", "back.csv").code == 0
    assert len(rows_of(Path("back.csv").read_text("utf-8"))) == len(ROWS)


def test_standard_input_is_one_table(run: Run) -> None:
    found = run("ik", MACHINE, "--poses", "-", "--start", "-")
    assert found.code == 2
    assert "- is standard input, which holds one table" in found.err


@pytest.mark.parametrize("words", COMMANDS.values(), ids=COMMANDS)
def test_mistakes_end_with_one_line_and_nothing_written(run: Run, words: tuple[str, ...]) -> None:
    name, *options = words
    write("bad.csv", GERMAN.replace("30,5", "1.030,5"))
    more = ["-o", "out.csv"] if name == "fk" else []
    found = run(name, MACHINE, *options, "bad.csv", *more)
    assert found.code == 1
    assert found.err.count("\n") == 3  # the fault and its mark
    assert found.err.splitlines()[0].startswith("bad.csv:4: column A5: '1.030,5' has thousands separators")
    assert not Path("out.csv").exists()
