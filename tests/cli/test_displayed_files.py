"""What `fk` writes comes back: as a recording, as input of `ik`, as a path; for every shipped machine."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import chainbuild

RTCP = [name for name in chainbuild.shipped() if chainbuild.Robot.load(name).chain.display.rtcp]


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def values(rows: list[dict[str, str]], names: list[str]) -> np.ndarray:
    return np.array([[float(row[name]) for name in names] for row in rows])


def write_axes(path: Path, robot: chainbuild.Robot, count: int) -> list[str]:
    """Write axis values inside all limits, near zero; return the header and the rows."""
    lower, upper = (np.array([getattr(axis, end) for axis in robot.axes]) for end in ("lower", "upper"))
    middle, rng = np.clip(0.0, lower, upper), np.random.default_rng(3)
    lower, upper = np.maximum(lower, middle - 60.0), np.minimum(upper, middle + 60.0)
    rows: list[np.ndarray] = []
    while len(rows) < count:
        row = lower + (upper - lower) * rng.random(len(lower))
        rows += [] if robot.violated_limits(row) else [row]
    lines = [",".join(axis.name for axis in robot.axes), *(",".join(map(repr, row.tolist())) for row in rows)]
    path.write_text("\n".join(lines) + "\n", "utf-8")
    return lines


@pytest.mark.parametrize("name", chainbuild.shipped())
def test_what_fk_writes_comes_back(name: str, run: Any, tmp_path: Path) -> None:
    robot = chainbuild.Robot.load(name)
    names = [axis.name for axis in robot.axes]
    header, *rows = write_axes(tmp_path / "axes.csv", robot, 8)
    wanted = np.array([[float(value) for value in row.split(",")] for row in rows])
    assert run("fk", name, "--axes", "axes.csv", "-o", "poses.csv").code == 0
    written = rows_of(tmp_path / "poses.csv")
    shown = [column for column in written[0] if column not in names]
    lines = [f"{row},{','.join(poses[c] for c in shown)}" for row, poses in zip(rows, written, strict=True)]
    (tmp_path / "recording.csv").write_text("\n".join([f"{header},{','.join(shown)}", *lines]) + "\n", "utf-8")
    told = run("crosscheck", name, "--recording", "recording.csv")
    assert told.code == 0, told.out
    told = run("ik", name, "--poses", "poses.csv", "--start", "axes.csv", "-o", "back.csv")
    assert told.code == 0, told.err
    assert np.abs(values(rows_of(tmp_path / "back.csv"), names) - wanted).max() < 1e-4
    for words in ((), ("--follow",)):
        assert run("ik", name, "--poses", "poses.csv", *words, "-o", "back.csv").code in (0, 3)
        back = rows_of(tmp_path / "back.csv")
        solved = [n for n, row in enumerate(back) if row["status"] == "ok"]
        axes = values([back[n] for n in solved], names)
        for n, found in zip(solved, axes, strict=True):
            T, reached = robot.fk(wanted[n]).homogeneous, robot.fk(found).homogeneous
            assert np.abs(reached[:3, 3] - T[:3, 3]).max() < 2e-6
            column = robot.chain.tool_column
            assert robot.task == "position" or np.abs(reached[:3, column] - T[:3, column]).max() < 1e-5
        if robot.chain.display.rtcp and robot.chain.display.columns == () and robot.chain.display.axes:
            assert solved == list(range(len(rows)))


@pytest.mark.parametrize("name", [name for name in RTCP if chainbuild.Robot.load(name).chain.display.kind == "axes"])
def test_rtcp_rows_bring_the_same_axes(name: str, run: Any, tmp_path: Path) -> None:
    """Without a start: the rotary axes are those of the file, the linear ones follow exactly."""
    robot = chainbuild.Robot.load(name)
    names = [axis.name for axis in robot.axes]
    _, *rows = write_axes(tmp_path / "axes.csv", robot, 8)
    wanted = np.array([[float(value) for value in row.split(",")] for row in rows])
    assert run("fk", name, "--axes", "axes.csv", "-o", "poses.csv").code == 0
    start = ("--start", "axes.csv") if robot.chain.display.keeps_side else ()  # the hand of a SCARA
    assert run("ik", name, "--poses", "poses.csv", *start, "-o", "back.csv").code == 0
    back = values(rows_of(tmp_path / "back.csv"), names)
    given = list(robot.chain.display.axes)
    assert np.array_equal(back[:, given].round(12), wanted[:, given].round(12))
    assert np.abs(back - wanted).max() < 1e-9


def test_the_numbers_of_a_c_table(run: Any) -> None:
    """The control shows A10 C40, not the angles of the tool's matrix; a=10, c=40 of them are another pose."""
    told = run("fk", "ac_table_kin58", "--at", "100,20,-300,10,40")
    header, row = (line.split(",") for line in told.out.splitlines())
    shown = dict(zip(header, row, strict=True))
    assert header == ["x_mm", "y_mm", "z_mm", "tool_x", "tool_y", "tool_z", "A", "C"]
    assert (float(shown["A"]), float(shown["C"])) == (10.0, 40.0)
    Path("poses.csv").write_text(told.out, "utf-8")
    back = run("ik", "ac_table_kin58", "--poses", "poses.csv").out.splitlines()
    assert back[1].startswith("100.0,20.0,-300.0,10.0,40.0,ok,")


def test_angles_of_an_rtcp_kinematic_are_refused_with_the_right_columns(run: Any) -> None:
    Path("poses.csv").write_text("x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n1,2,3,10,0,40\n", "utf-8")
    told = run("ik", "ac_table_kin58", "--poses", "poses.csv")
    assert told.code == 1
    assert "unknown column 'a_deg'" in told.err
    assert "programmed by position and its rotary axes A, C" in told.err


def test_rotary_columns_win_over_a_quaternion_and_a_contradiction_is_told(run: Any) -> None:
    table = run("fk", "ac_table_kin58", "--quaternion", "--at", "100,20,-300,10,40", "--at", "0,0,-300,10,50").out
    Path("poses.csv").write_text(table, "utf-8")
    agreeing = run("ik", "ac_table_kin58", "--poses", "poses.csv")
    assert (agreeing.code, agreeing.err.count("contradict")) == (0, 0)
    wrong = table.splitlines()
    wrong[2] = wrong[2].replace(",10.0,50.0", ",10.0,51.0")
    Path("poses.csv").write_text("\n".join(wrong) + "\n", "utf-8")
    told = run("ik", "ac_table_kin58", "--poses", "poses.csv")
    assert told.code == 0
    assert "poses.csv:3: qx, qy, qz, qw contradict A, C, which are used" in told.err
    assert told.out.splitlines()[2].split(",")[3:5] == ["10.0", "51.0"]


def test_quaternion_and_angles_come_on_demand(run: Any) -> None:
    at = ("--at", "100,20,-300,10,40")
    plain = run("fk", "ac_table_kin58", *at).out.splitlines()[0]
    assert "q" not in plain.replace("_", "")
    full = run("fk", "ac_table_kin58", *at, "--quaternion", "--angles", "ypr").out.splitlines()
    assert full[0] == "x_mm,y_mm,z_mm,qx,qy,qz,qw,tool_x,tool_y,tool_z,A,C,a_deg,b_deg,c_deg"
    angles = dict(zip(full[0].split(","), full[1].split(","), strict=True))
    assert [float(angles[f"{letter}_deg"]) for letter in "abc"] == [-10.0, 0.0, -40.0]
    Path("poses.csv").write_text("\n".join(full) + "\n", "utf-8")
    assert run("ik", "ac_table_kin58", "--poses", "poses.csv").code == 0
    assert run("fk", "kr6r900_2", "--at", "0,-90,90,0,30,0", "--angles", "cba").code == 2
    assert run("fk", "kr6r900_2", "--at", "0,-90,90,0,30,0", "--angles", "own").code == 0
    assert run("fk", "ac_table_kin58", *at, "--angles", "zyx").code == 2
    five = run("fk", "arm_nr5", "--at", "0,-90,90,10,20", "--angles", "own").out.splitlines()[0]
    assert five.endswith("tool_x,tool_y,tool_z,a_deg,b_deg,c_deg")


def test_a_perfect_recording_of_a_table_machine_agrees(run: Any) -> None:
    """Rotary columns are those of the axes: position alone is compared, and nothing differs."""
    robot = chainbuild.Robot.load("ac_table_kin58")
    lines = ["X,Y,Z,A,C,x_mm,y_mm,z_mm"]
    for axes in np.random.default_rng(1).uniform(-50.0, 50.0, (10, 5)) - [0, 0, 200, 0, 0]:
        shown = robot.display(axes)
        lines.append(",".join(map(repr, [*axes.tolist(), *(shown[n] for n in ("x_mm", "y_mm", "z_mm"))])))
    Path("recorded.csv").write_text("\n".join(lines) + "\n", "utf-8")
    told = run("crosscheck", "ac_table_kin58", "--recording", "recorded.csv")
    assert (told.code, "agrees" in told.out) == (0, True)
