"""What the commands do for ROBX alone: violations, a C that runs on, the controller's solver, dynamics in SI."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from chainbuild.machines import shipped_path
from tests.kit.command_line import Run, rows_of, write

ARM_AXES = "A1,A2,A3,A4,A5,A6\n"
OUTSIDE, INSIDE = "0,60,-16,170,100,0\n", "0,0,-90,0,40,0\n"


def test_fk_and_ik_name_what_every_row_violates(run: Run) -> None:
    write("axes.csv", ARM_AXES + OUTSIDE + INSIDE + "190,0,-20,0,0,0\n")
    forward = run("fk", "parallelogram_nr", "--axes", "axes.csv", "-o", "poses.csv")
    assert forward.code == 0
    assert "1 row outside the limits of A1" in forward.err
    assert "2 rows outside the limits of parallelogram angle" in forward.err
    poses = Path("poses.csv").read_text("utf-8")
    assert [row["violations"] for row in rows_of(poses)] == ["parallelogram angle", "", "A1; parallelogram angle"]
    write("two.csv", "".join(poses.splitlines(keepends=True)[:3]))
    write("starts.csv", ARM_AXES + OUTSIDE + INSIDE)
    back = run("ik", "parallelogram_nr", "--poses", "two.csv", "--start", "starts.csv", "-o", "back.csv")
    assert back.code == 3
    refused, found = rows_of(Path("back.csv").read_text("utf-8"))
    assert (refused["status"], refused["A2"], refused["violations"]) == ("limits", "", "parallelogram angle")
    assert (found["status"], found["violations"]) == ("ok", "")
    # What ik has written fk reads again.
    write("again.csv", Path("back.csv").read_text("utf-8").splitlines()[0] + "\n0,0,-90,0,40,0,ok,0,0,\n")
    assert run("fk", "parallelogram_nr", "--axes", "again.csv").code == 0


@pytest.mark.parametrize("name", ["kr6r900", "kr6r900_2"])
def test_machines_without_such_limits_have_no_such_column(run: Run, name: str) -> None:
    head = ARM_AXES if name == "kr6r900" else "C1,B1,B2,A1,B3,A2\n"
    write("axes.csv", head + "0,-90,90,0,30,0\n")
    poses = run("fk", name, "--axes", "axes.csv", "-o", "poses.csv")
    assert poses.code == 0
    assert "violations" not in Path("poses.csv").read_text("utf-8")
    assert "violations" not in run("ik", name, "--poses", "poses.csv").out


def test_c_runs_on_there_and_back(run: Run) -> None:
    axes = [(-100.0, 20.0, 30.0, turn) for turn in (-1000.0, -200.0, 40.0, 700.0)]
    write("axes.csv", "A1,A2,A3,A4\n" + "".join(",".join(map(repr, row)) + "\n" for row in axes))
    assert run("fk", "scara_cc", "--axes", "axes.csv", "-o", "poses.csv").code == 0
    poses = rows_of(Path("poses.csv").read_text("utf-8"))
    assert [float(row["c_deg"]) for row in poses] == pytest.approx([-(50.0 + turn) for *_, turn in axes])
    found = run("ik", "scara_cc", "--poses", "poses.csv", "--start", "axes.csv")
    assert found.code == 0
    for row, wanted in zip(rows_of(found.out), axes, strict=True):
        assert [float(row[name]) for name in ("A1", "A2", "A3", "A4")] == pytest.approx(wanted, abs=1e-4)


def test_c_alone_will_do_for_four_axes(run: Run) -> None:
    write("poses.csv", "x_mm,y_mm,z_mm,c_deg\n800,100,300,700\n800,100,300,1500\n")
    found = run("ik", "scara_cc", "--poses", "poses.csv")
    assert found.code == 3
    first, second = rows_of(found.out)
    assert -sum(float(first[name]) for name in ("A2", "A3", "A4")) == pytest.approx(700.0, abs=1e-4)
    assert (second["status"], second["A4"]) == ("limits", "")
    write("poses.csv", "x_mm,y_mm,z_mm,c_deg\n800,100,300,40\n")
    assert run("ik", "irb2600", "--poses", "poses.csv").code == 1


def test_a_c_that_does_not_go_with_the_quaternion_beside_it(run: Run) -> None:
    write("axes.csv", "A1,A2,A3,A4\n-100,20,30,40\n")
    run("fk", "scara_cc", "--axes", "axes.csv", "-o", "poses.csv")
    head, row = Path("poses.csv").read_text("utf-8").splitlines()
    wrong = ",".join([*row.split(",")[:-1], "-91"])
    write("poses.csv", f"{head}\n{wrong}\n")
    found = run("ik", "scara_cc", "--poses", "poses.csv")
    assert (found.code, rows_of(found.out)[0]["status"]) == (3, "unreachable")
    assert float(rows_of(found.out)[0]["rotation_error_deg"]) == pytest.approx(1.0, abs=1e-6)


def test_the_controllers_solver(run: Run) -> None:
    text = shipped_path("irb2600").read_text("utf-8")
    write("arm.tea", text.replace("M17", "N62967 $MC_ROBX_ITERMAXCOUNT=3\nM17"))
    write("axes.csv", ARM_AXES + "0,0,0,0,40,0\n1,1,-1,2,38,1\n80,40,-60,90,-50,120\n")
    assert run("fk", "arm.tea", "--axes", "axes.csv", "-o", "poses.csv").code == 0
    write("start.csv", ARM_AXES + "0,0,0,0,40,0\n")
    found = run("ik", "arm.tea", "--poses", "poses.csv", "--start", "start.csv", "--solver", "controller")
    assert found.code == 3
    assert [row["status"] for row in rows_of(found.out)] == ["ok", "ok", "stalled"]
    assert run("ik", "arm.tea", "--poses", "poses.csv", "--start", "start.csv").code == 0


@pytest.mark.parametrize(("solver", "code"), [("best", 2), ("controller", 1)])
def test_a_solver_that_is_none(run: Run, solver: str, code: int) -> None:
    write("poses.csv", "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n500,0,500,0,90,0\n")
    assert run("ik", "kr6r900_2", "--poses", "poses.csv", "--solver", solver).code == code


def test_five_axes_are_given_by_their_tool_vector(run: Run) -> None:
    """The tool vector of a ROBX robot of five axes is X of its tool frame."""
    write("axes.csv", "A1,A2,A3,A4,A5\n10,20,-30,40,50\n")
    assert run("fk", "arm_nr5", "--axes", "axes.csv", "-o", "poses.csv").code == 0
    (row,) = rows_of(Path("poses.csv").read_text("utf-8"))
    x, y, z, w = (float(row[name]) for name in ("qx", "qy", "qz", "qw"))
    column = (1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w))
    assert [float(row[f"tool_{c}"]) for c in "xyz"] == pytest.approx(column, abs=1e-12)


def test_info_shows_dynamics_in_si_and_what_the_alarms_watch(run: Run) -> None:
    text = shipped_path("irb2600").read_text("utf-8")
    data = "N62929 $MC_ROBX_VELCP[0]=30000\nN62931 $MC_ROBX_VELORI[1]=3\nN62932 $MC_ROBX_ACCORI[2]=0.5\n"
    write("arm.tea", text.replace("M17", f"{data}N62970 $MC_ROBX_ITERLIMIT2=1\nM17"))
    rows = {row["name"]: row for row in json.loads(run("info", "arm.tea", "--json").out)["parameters"]}
    speed, turn, spin = (rows[f"$MC_ROBX_{name}"] for name in ("VELCP[0]", "VELORI[1]", "ACCORI[2]"))
    assert (speed["value"], speed["unit"], speed["si"], speed["si_unit"]) == (30000, "mm/min", 0.5, "m/s")
    assert (turn["si"], turn["si_unit"]) == (pytest.approx(0.314159265), "rad/s")
    assert (spin["si"], spin["si_unit"]) == (pytest.approx(3.14159265), "rad/s²")
    assert rows["$MC_ROBX_ITERLIMIT2"]["si_unit"] == ""
    assert "75370" in rows["$MC_ROBX_ITERLIMIT2"]["meaning"]
    shown = " ".join(run("info", "arm.tea").out.split())
    assert "0.5 m/s" in shown
