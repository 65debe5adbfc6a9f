"""What `fk` writes comes back: as a recording, as input of `ik`, as a path; for every shipped machine."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import chainbuild
from tests.kit.random_types import channel_list, random_machine

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


def test_an_orientation_that_is_not_used_is_told(run: Any) -> None:
    Path("poses.csv").write_text("x_mm,y_mm,z_mm,A,C,a_deg,b_deg,c_deg\n1,2,3,10,40,-10,0,-40\n", "utf-8")
    told = run("ik", "ac_table_kin58", "--poses", "poses.csv")
    assert "a_deg, b_deg, c_deg not used: A, C counts" in told.err


@pytest.mark.parametrize("name", chainbuild.shipped())
def test_angles_that_fk_adds_are_read_or_refused_at_once(name: str, run: Any, tmp_path: Path) -> None:
    robot = chainbuild.Robot.load(name)
    write_axes(tmp_path / "axes.csv", robot, 2)
    written = run("fk", name, "--axes", "axes.csv", "--angles", "own", "--quaternion", "--drives", "-o", "poses.csv")
    other = robot.chain.display.kind != "angles" and {"a_deg", "b_deg", "c_deg"} & set(robot.chain.display_columns)
    assert written.code == (2 if other else 0), written.err
    if other:
        assert "which are no pose angles" in written.err
        return
    told = run("ik", name, "--poses", "poses.csv", "--start", "axes.csv")
    assert told.code == 0, told.err
    assert robot.chain.display.kind == "angles" or "a_deg, b_deg, c_deg not used" in told.err


@pytest.mark.parametrize("choice", ["pose_angles", "pitch_and_turn"])
def test_a_palletiser_recorded_by_pitch_and_turn(choice: str, run: Any) -> None:
    words = ("--convention", f"kin213_angles={choice}")
    robot = chainbuild.Robot.load("palletiser_kin213", conventions={"kin213_angles": choice})
    rows = [[10.0, 20.0, -30.0, 15.0, 40.0], [-40.0, 10.0, -20.0, -25.0, 60.0], [25.0, 15.0, -40.0, 5.0, -70.0]]
    rows = [row[: len(robot.axes)] for row in rows]
    shown = [robot.display(row) for row in rows]
    lines = [",".join([*(axis.name for axis in robot.axes), *shown[0]])]
    lines += [",".join(map(repr, [*row, *one.values()])) for row, one in zip(rows, shown, strict=True)]
    Path("recorded.csv").write_text("\n".join(lines) + "\n", "utf-8")
    told = run("crosscheck", "palletiser_kin213", "--recording", "recorded.csv", *words)
    assert (told.code, "agrees" in told.out) == (0, True), told.out + told.err
    shown[1]["b_deg"] += 1.0
    lines[2] = ",".join(map(repr, [*rows[1], *shown[1].values()]))
    Path("recorded.csv").write_text("\n".join(lines) + "\n", "utf-8")
    assert run("crosscheck", "palletiser_kin213", "--recording", "recorded.csv", *words).code == 3


def test_a_turn_without_a_status_is_refused_on_paths_too(run: Any) -> None:
    Path("poses.csv").write_text("x_mm,y_mm,z_mm,qx,qy,qz,qw,it\n500,0,800,0,1,0,0,63\n510,0,800,0,1,0,0,63\n", "utf-8")
    told = [run("ik", "kr6r900_2", "--poses", "poses.csv", *words) for words in ((), ("--follow",))]
    assert [one.code for one in told] == [1, 1]
    assert all("a turn (IT) needs" in one.err for one in told)


def test_columns_of_drives_are_those_of_axes(run: Any) -> None:
    Path("poses.csv").write_text("x_mm,y_mm,z_mm,A,C,C_drive\n1,2,3,10,40,40\n", "utf-8")
    assert run("ik", "ac_table_kin58", "--poses", "poses.csv").out.count("\n") == 2
    Path("poses.csv").write_text("x_mm,y_mm,z_mm,A,C,Q_drive\n1,2,3,10,40,40\n", "utf-8")
    told = run("ik", "ac_table_kin58", "--poses", "poses.csv")
    assert told.code == 1
    assert "unknown column 'Q_drive'" in told.err
    lines = "X,Y,Z,A,C,x_mm,y_mm,z_mm,C_drive\n100,20,-300,10,40,94.846,-42.540,105.767,40\n"
    Path("recorded.csv").write_text(lines, "utf-8")
    assert run("crosscheck", "ac_table_kin58", "--recording", "recorded.csv").code == 0


def test_a_picture_of_a_path_without_poses(run: Any) -> None:
    Path("axes.csv").write_text("X,Y,Z,C,A\n0,0,0,0,90\n1,0,0,0,90\n", "utf-8")
    told = run("singularity", "plasma_head_kin25", "--axes", "axes.csv", "--picture", "out.svg")
    assert "Traceback" not in told.err
    assert told.code in (0, 1, 3)


def recorded(name: str, robot: chainbuild.Robot, rows: np.ndarray) -> None:
    """Write axis values with everything that is displayed at them."""
    shown = [robot.display(row) for row in rows]
    columns = [column for column in shown[0] if column not in [axis.name for axis in robot.axes]]
    lines = [",".join([*(axis.name for axis in robot.axes), *columns])]
    lines += [
        ",".join(map(repr, [*row.tolist(), *(one[c] for c in columns)])) for row, one in zip(rows, shown, strict=True)
    ]
    Path(name).write_text("\n".join(lines) + "\n", "utf-8")


def test_displayed_axes_of_a_complete_kinematic_are_compared(run: Any) -> None:
    robot = chainbuild.Robot.load("bevel_head_kin76")
    rows = np.random.default_rng(2).uniform(-20.0, 20.0, (5, 5))
    recorded("recorded.csv", robot, rows)
    assert run("crosscheck", "bevel_head_kin76", "--recording", "recorded.csv").code == 0
    lines = Path("recorded.csv").read_text("utf-8").splitlines()
    c_deg = lines[0].split(",").index("c_deg")
    fields = lines[3].split(",")
    fields[c_deg] = repr(float(fields[c_deg]) + 1.0)
    Path("recorded.csv").write_text("\n".join([*lines[:3], ",".join(fields), *lines[4:]]) + "\n", "utf-8")
    told = run("crosscheck", "bevel_head_kin76", "--recording", "recorded.csv")
    assert (told.code, "4 of 5 poses agree" in told.out) == (3, True), told.out


@pytest.mark.parametrize(
    ("kin", "more", "convention", "choice"),
    [
        (213, "", "kin213_angles", "pitch_and_turn"),
        (208, "", "kin208_angles", "pose_angles"),
        (202, "", "kin202_c", "tool_vector"),
        (45, "ori_rotation_angle 1\n", "euler_letters", "a_first"),
    ],
)
def test_conventions_of_what_is_displayed_are_found(
    kin: int, more: str, convention: str, choice: str, run: Any
) -> None:
    """The recording is read anew for every choice: it decides what the columns mean."""
    heads = random_machine(kin, np.random.default_rng(1)) | ({9: 1.0} if kin == 202 else {})  # HD10: RIGHT
    Path("machine.lis").write_text(more + channel_list(kin, heads), "utf-8")
    robot = chainbuild.Robot.load("machine.lis", conventions={convention: choice})
    recorded("recorded.csv", robot, np.random.default_rng(4).uniform(5.0, 40.0, (8, len(robot.axes))))
    told = run("crosscheck", "machine.lis", "--recording", "recorded.csv")
    assert told.code == 3, told.out
    assert f"{convention}={choice}" in told.out
    assert "Conventions that would make it agree" in told.out, told.out


def test_the_pose_that_no_head_has_is_named_by_its_number(run: Any) -> None:
    told = run("fk", "cardan_head_kin59", "--at", "0,0,0,0,10", "--at", "0,0,0,0,120")
    assert (told.code, told.err.startswith("--at:2: the head cannot tilt the tool by A = 120 deg")) == (1, True)
    told = run("fk", "cardan_head_kin59", "--at", "0,0,0,0,120")
    assert told.err.startswith("--at: the head")
