"""Status and turn in tables: written by fk, read by ik as a filter, told along a path."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import chainbuild
from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.status_turn import status_turn_rows

ARM = "kr6r900_2"
NAMES = ("C1", "B1", "B2", "A1", "B3", "A2")


def write_axes(rows: np.ndarray) -> None:
    lines = [",".join(NAMES), *(",".join(map(repr, row)) for row in rows.tolist())]
    Path("axes.csv").write_text("\n".join(lines) + "\n", "utf-8")


def axes_of(table: str) -> np.ndarray:
    return np.array([[float(field) for field in line.split(",")[:6]] for line in table.splitlines()[1:]])


def test_is_and_it_bring_the_axes_back_without_a_start(run: Any) -> None:
    robot = chainbuild.Robot.load(ARM)
    lower, upper = (np.array([getattr(axis, end) for axis in robot.axes]) for end in ("lower", "upper"))
    rows = lower + (upper - lower) * np.random.default_rng(8).random((40, 6))
    write_axes(rows)
    assert run("fk", ARM, "--axes", "axes.csv", "-o", "poses.csv").code == 0
    head, first = Path("poses.csv").read_text("utf-8").splitlines()[:2]
    assert head.endswith(",a_deg,b_deg,c_deg,is,it")
    assert [int(field) for field in first.split(",")[-2:]] == list(chainbuild.status_turn(robot, rows[0]))
    told = run("ik", ARM, "--poses", "poses.csv")
    assert told.code == 0, told.err
    assert np.abs(axes_of(told.out) - rows).max() < 1e-7


@pytest.mark.parametrize(("status", "turn"), [("0b110", "0b010010"), ("6", "18"), ("6.0", "")])
def test_spellings_of_bits(run: Any, status: str, turn: str) -> None:
    robot = chainbuild.Robot.load(ARM)
    shown = robot.display([10.0, -60.0, 70.0, 20.0, -40.0, 30.0])
    assert chainbuild.status_turn(robot, [10.0, -60.0, 70.0, 20.0, -40.0, 30.0]) == (6, 18)
    head, row = ",".join(shown), ",".join(map(repr, shown.values()))
    Path("poses.csv").write_text(f"{head},is,it\n{row},{status},{turn}\n", "utf-8")
    told = run("ik", ARM, "--poses", "poses.csv")
    assert told.code == 0, told.err
    assert np.abs(axes_of(told.out) - [10.0, -60.0, 70.0, 20.0, -40.0, 30.0]).max() < 1e-6


@pytest.mark.parametrize(
    ("columns", "values", "words"),
    [
        ("is", "8", "0 … 7"),
        ("is", "1.5", "0 … 7"),
        ("it", "3", "status"),
        ("is,it", "2,16", "axis 5"),
        ("is", "x", "is"),
    ],
)
def test_bits_that_cannot_be_are_refused_with_their_line(run: Any, columns: str, values: str, words: str) -> None:
    shown = chainbuild.Robot.load(ARM).display([10.0, -60.0, 70.0, 20.0, -40.0, 30.0])
    head, row = ",".join(shown), ",".join(map(repr, shown.values()))
    Path("poses.csv").write_text(f"{head},{columns}\n{row},{values}\n", "utf-8")
    told = run("ik", ARM, "--poses", "poses.csv")
    assert told.code == 1
    assert told.err.startswith("poses.csv:2")
    assert words in told.err


def test_a_path_through_the_stretched_wrist_is_told(run: Any) -> None:
    rows = np.array([[0.0, -80.0, 80.0, 0.0, 40.0 - 10.0 * n, 0.0] for n in range(9)])
    write_axes(rows)
    assert run("fk", ARM, "--axes", "axes.csv", "-o", "poses.csv").code == 0
    poses = Path("poses.csv").read_text("utf-8").splitlines()
    Path("poses.csv").write_text("\n".join(line.rsplit(",", 2)[0] for line in poses) + "\n", "utf-8")
    write_axes(rows[:1])
    told = run("ik", ARM, "--poses", "poses.csv", "--start", "axes.csv", "--follow")
    assert told.code == 0
    assert told.err.count("poses.csv:7:") == 1
    assert "status" in told.err
    Path("with.csv").write_text("\n".join(poses) + "\n", "utf-8")
    told = run("ik", ARM, "--poses", "with.csv", "--start", "axes.csv", "--follow")
    assert "with.csv:7:" in told.err


def test_python_takes_the_bits_among_the_displayed_values() -> None:
    robot, axes = chainbuild.Robot.load(ARM), [10.0, -60.0, 70.0, 20.0, -40.0, 30.0]
    shown = robot.display(axes)
    assert np.abs(robot.from_display({**shown, "is": 6, "it": 18}).axes - axes).max() < 1e-6
    other = robot.from_display({**shown, "is": 2})
    assert chainbuild.status_turn(robot, other.axes)[0] == 2
    with pytest.raises(ChainbuildError):
        robot.from_display({**shown, "is": 1.5})
    with pytest.raises(ChainbuildError, match="unknown column 'is'"):
        chainbuild.Robot.load("kr6r900").from_display({"x_mm": 1, "y_mm": 2, "z_mm": 3, "is": 1})


def test_the_status_of_a_table_is_computed_at_once(run: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []

    def counted(robot: chainbuild.Robot, rows: Any) -> Any:
        asked.append(len(rows))
        return status_turn_rows(robot, rows)

    monkeypatch.setattr("chainbuild.ik.branches.status_turn.status_turn_rows", counted)
    rows = np.array([[10.0, -60.0, 70.0, 20.0, -40.0, 30.0], [0.0, -90.0, 90.0, 0.0, 30.0, 0.0], [-10.0] * 6])
    write_axes(rows)
    told = run("fk", ARM, "--at", "10,-60,70,20,-40,30", "--axes", "axes.csv")
    assert asked == [1, 3]
    bits = [[int(field) for field in line.split(",")[-2:]] for line in told.out.splitlines()[1:]]
    assert bits[0] == bits[1] == [6, 18]
    assert bits[1:] == status_turn_rows(chainbuild.Robot.load(ARM), rows).tolist()
