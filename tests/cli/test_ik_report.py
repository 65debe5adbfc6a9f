"""What fk and ik say beside their tables: held axes, reasons of failed rows, contradictory orientations."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.kit.command_line import Run, rows_of, write

POSE = "x_mm,y_mm,z_mm,qx,qy,qz,qw"
INPUTS = {"irb2600_track": {"EX1": (800.0, 1200.5)}, "irb2600_table": {"EW1": (20.0, -45.0), "EW2": (0.0, 170.0)}}
ARM = ((0.0, 10.0, -20.0, 30.0, 40.0, 50.0), (5.0, 12.0, -18.0, 25.0, 45.0, 40.0))
ARM_NAMES = [f"A{n}" for n in range(1, 7)]


def write_axes(inputs: dict[str, tuple[float, float]]) -> None:
    lines = [",".join([*ARM_NAMES, *inputs])]
    lines += [",".join(map(repr, [*arm, *(v[n] for v in inputs.values())])) for n, arm in enumerate(ARM)]
    write("axes.csv", "\n".join(lines) + "\n")


@pytest.mark.parametrize("machine", INPUTS)
def test_held_axes_go_there_and_back(run: Run, machine: str) -> None:
    inputs = INPUTS[machine]
    write_axes(inputs)
    assert run("fk", machine, "--axes", "axes.csv", "-o", "poses.csv").code == 0
    poses = Path("poses.csv").read_text("utf-8")
    assert poses.splitlines()[0].endswith(",".join(["c_deg", *inputs]))
    found = run("ik", machine, "--poses", "poses.csv", "-o", "back.csv")
    assert (found.code, found.err) == (0, "")
    for n, row in enumerate(rows_of(Path("back.csv").read_text("utf-8"))):
        assert {name: float(row[name]) for name in inputs} == {name: values[n] for name, values in inputs.items()}
    assert run("fk", machine, "--axes", "back.csv", "-o", "again.csv").code == 0
    for one, two in zip(rows_of(poses), rows_of(Path("again.csv").read_text("utf-8")), strict=True):
        for name in ("x_mm", "y_mm", "z_mm"):
            assert float(one[name]) == pytest.approx(float(two[name]), abs=1.1e-3)
        assert abs(sum(float(one[q]) * float(two[q]) for q in ("qx", "qy", "qz", "qw"))) == pytest.approx(1, abs=1e-11)


def test_held_axes_without_values_stand_at_0_and_that_is_told(run: Run) -> None:
    write_axes({"EW1": (0.0, 0.0), "EW2": (0.0, 0.0)})
    poses = run("fk", "irb2600_table", "--axes", "axes.csv").out.splitlines()
    write("poses.csv", "\n".join(",".join(line.split(",")[:7]) for line in poses) + "\n")
    outcome = run("ik", "irb2600_table", "--poses", "poses.csv")
    assert outcome.code == 0
    assert outcome.err.startswith("EW1, EW2 held at 0")
    assert len(outcome.err.splitlines()) == 1
    assert {row["EW1"] for row in rows_of(outcome.out)} == {"0.0"}
    write("start.csv", "A1,A2,A3,A4,A5,A6,EW1,EW2\n0,10,-20,30,40,50,15,25\n")
    started = run("ik", "irb2600_table", "--poses", "poses.csv", "--start", "start.csv")
    assert "held at 0" not in started.err
    assert {(row["EW1"], row["EW2"]) for row in rows_of(started.out) if row["A1"]} <= {("15.0", "25.0")}


def test_help_explains_held_axes(run: Run) -> None:
    for command in ("fk", "ik"):
        assert "such as a track" in " ".join(run(command, "--help").out.split())


def test_failed_rows_are_told_by_reason(run: Run) -> None:
    far = [f"{x},0,0,0,0,0,1" for x in range(9000, 9011)]
    low = [f"700,0,{z},0,0,0,1" for z in (100, 101)]
    write("poses.csv", "\n".join([POSE, low[0], *far, "800,0,600,0,1,0,0", low[1]]) + "\n")
    outcome = run("ik", "kr6r900", "--poses", "poses.csv")
    assert outcome.code == 3
    assert [row["status"] for row in rows_of(outcome.out)] == ["limits", *["unreachable"] * 11, "ok", "limits"]
    first, second, last = outcome.err.splitlines()
    assert first.startswith("poses.csv:3: unreachable: too far: 9000.0 mm from the workpiece frame, ")
    assert first.endswith(" mm (11 rows like this)")
    assert second.startswith("poses.csv:2: limits: reached only outside the limits: A2 at ")
    assert second.endswith(" deg (limit 45.000) (2 rows like this)")
    assert last == "poses.csv: 13 of 14 poses failed: 2 limits, 11 unreachable"


def test_the_most_frequent_reasons_are_told(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("chainbuild.cli.ik._REASONS_SHOWN", 3)
    # Tool upright: the mill's X and Y are those of the pose; 700 is beyond 400 and 300, and z = 0 beyond Z's limit.
    places = [(700, 0, 0)] * 2 + [(0, 700, 0)] + [(700, 700, 0)] * 3 + [(0, 0, 0)] + [(0, 0, 200)]
    lines = [f"{x},{y},{z},0,0,1" for x, y, z in places]
    write("poses.csv", "\n".join(["x_mm,y_mm,z_mm,tool_x,tool_y,tool_z", *lines]) + "\n")
    outcome = run("ik", "ac_table_kin58", "--poses", "poses.csv")
    assert outcome.code == 3
    *told, rest, total = outcome.err.splitlines()
    assert [line.split(": ")[0] for line in told] == ["poses.csv:5", "poses.csv:2", "poses.csv:4"]
    assert [line.rpartition("(")[2] for line in told[:2]] == ["3 rows like this)", "2 rows like this)"]
    named = ["".join(axis for axis in "XYZAC" if f"{axis} at" in line) for line in told]
    assert named == ["XYZ", "XZ", "YZ"]
    assert rest == "… and 1 more, for 1 other reason"
    assert total == "poses.csv: 7 of 8 poses failed: 7 limits"


def test_angles_that_contradict_the_quaternion_are_told_once(run: Run) -> None:
    write("axes.csv", "C1,B1,B2,A1,B3,A2\n0,-90,90,0,30,0\n0,-80,80,0,30,0\n0,-70,70,0,30,0\n")
    poses = run("fk", "kr6r900_2", "--axes", "axes.csv").out.splitlines()
    agreeing = run("ik", "kr6r900_2", "--poses", write_lines(poses))
    assert agreeing.err == ""
    wrong = [",".join([*line.split(",")[:-3], "77", *line.split(",")[-2:]]) for line in poses[2:]]
    outcome = run("ik", "kr6r900_2", "--poses", write_lines([*poses[:2], *wrong]))
    assert outcome.err == "poses.csv:3: a_deg, b_deg, c_deg contradict the quaternion, which is used (2 rows in all)\n"
    assert outcome.out == agreeing.out


def write_lines(lines: list[str]) -> str:
    write("poses.csv", "\n".join(lines) + "\n")
    return "poses.csv"


def test_a_four_axis_robot_without_orientation_is_told_that_c_will_do(run: Run) -> None:
    write("poses.csv", "x_mm,y_mm,z_mm\n800,100,300\n")
    outcome = run("ik", "scara_cc", "--poses", "poses.csv")
    assert outcome.code == 1
    assert "missing column c_deg, or qx, qy, qz, qw" in outcome.err
