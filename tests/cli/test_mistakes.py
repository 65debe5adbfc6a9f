"""Mistakes and habits of the first hour: each is answered right, or by one message that leads on."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest

import chainbuild
from chainbuild.cli import entry
from chainbuild.machines import shipped_path
from tests.kit.command_line import Outcome, Run, write
from tests.kit.command_lines import ALONE, EVERYWHERE, HABITS, NEEDS


def lines_of(table: str) -> list[tuple[str, int, str]]:
    """Return command line, exit code and part of the answer of each line."""
    found = []
    for line in table.strip().splitlines():
        words, _, answer = line.partition(" => ")
        code, _, text = answer.partition(" ")
        found.append((words, int(code), text))
    return found


LINES = lines_of(ALONE)
# An arm with a spherical wrist as Denavit-Hartenberg rows.
TABLE = "# standard\na,d,alpha,theta\n25,400,-90,0\n455,0,0,-90\n35,0,-90,0\n0,420,90,0\n0,0,-90,0\n0,80,0,0\n"


@pytest.fixture
def files(run: Run) -> Run:
    """Return the command in a folder with what people have there."""
    write("path.csv", "A1,A2,A3,A4,A5,A6\n0,-90,90,0,30,0\n0,-80,90,0,30,0\n")
    write("poses.csv", "x_mm,y_mm,z_mm,qx,qy,qz,qw\n700,0,700,0,0.7071067811865476,0,0.7071067811865476\n")
    write("far.csv", "x_mm,y_mm,z_mm,qx,qy,qz,qw\n7000,0,700,0,0,0,1\n")
    write("header.csv", "A1,A2,A3,A4,A5,A6\n")
    write("poses_header.csv", "x_mm,y_mm,z_mm,qx,qy,qz,qw\n")
    write("notes.txt", "Dear reader,\n")
    write("empty.lis", "")
    for name in ("copy.tea", "my arm.tea"):
        write(name, shipped_path("kr6r900").read_text("utf-8"))
    Path("folder").mkdir()
    return run


def check(outcome: Outcome, line: str, code: int, text: str) -> None:
    assert outcome.code == code, f"{line}\n{outcome.err}"
    assert text in outcome.out + outcome.err, f"{line}\n{outcome.err}"
    if code in (1, 2) and "check" not in line:
        assert outcome.out == "" or "--json" in line, line
        told = [one for one in outcome.err.splitlines() if not one.startswith("2 findings")]
        # One message: its line, and either the spot with its mark or how to see the usage.
        usage = told[-1].endswith("--help shows the usage")
        assert len(told) == (2 if usage else 3 if told[-1].strip() == "^" else 1), f"{line}\n{outcome.err}"
        assert usage == (code == 2), line


@pytest.mark.parametrize("command", [name for name in entry.build_app() if not name.startswith("-")] + [""])
def test_what_is_typed_with_a_command_is_answered(files: Run, command: str) -> None:
    commands = set(NEEDS) | {"types", "warm", "completion"}
    for line, code, text in LINES:
        first = line.split(" ")[0]
        if (first if first in commands else "") == command:
            check(files(*shlex.split(line)), line, code, text)


@pytest.mark.parametrize("command", NEEDS)
def test_a_mistake_with_the_machine_is_told_by_every_command_and_nothing_is_written(files: Run, command: str) -> None:
    before = sorted(Path().rglob("*"))
    for words, code, text in lines_of(EVERYWHERE):
        line = f"{command} {words.replace('NEEDS', NEEDS[command])}"
        outcome = files(*shlex.split(line))
        assert outcome.code == code, f"{line}\n{outcome.err}"
        assert text in outcome.out + outcome.err, f"{line}\n{outcome.err}"
    assert sorted(Path().rglob("*")) == before


HEAVY = ("demo", "inspect")  # both draw every machine that they are given


@pytest.mark.parametrize(
    "command",
    [pytest.param(name, marks=[pytest.mark.slow] * (name in HEAVY)) for name in NEEDS if name != "as-universal"],
)
def test_a_habit_with_the_machine_is_understood_by_every_command(files: Run, command: str) -> None:
    chainbuild.write_urdf(chainbuild.Robot.load("kr6r900"), "given")
    write("arm.csv", TABLE)
    for words in HABITS.strip().splitlines():
        line = f"{command} {words.replace('NEEDS', NEEDS[command])}"
        outcome = files(*shlex.split(line))
        assert outcome.code in (0, 3), f"{line}\n{outcome.err}"


@pytest.mark.parametrize("command", sorted(set(NEEDS) - {"as-universal", "demo"}))
def test_options_stand_anywhere_and_are_spelt_either_way(files: Run, command: str) -> None:
    """Before the machine, with an underscore or an equals sign, a negative number, a path with a blank."""
    needs = shlex.split(NEEDS[command])
    outcome = files(command, "--tool_length", "-5", *needs, "./my arm.tea", "--convention=axes_dir_index=internal")
    assert outcome.code == 0, outcome.err


def test_every_command_is_tried() -> None:
    """Twenty lines each and twelve habits with the machine; of commands without one what there is."""
    names = {name for name in entry.build_app() if not name.startswith("-")}
    assert set(NEEDS) | {"types", "warm", "completion"} == names
    shared = len(lines_of(EVERYWHERE))
    for command in NEEDS:
        assert shared + sum(line.split(" ")[0] == command for line, _, _ in LINES) >= 20
