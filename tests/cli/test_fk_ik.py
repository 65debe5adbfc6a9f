"""fk and ik: columns, precision, start values, failed rows, and files that appear only when all went well."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild import frames
from tests.kit.command_line import ARM, AXES, Outcome, Run, rows_of, write
from tests.kit.paths import REFERENCE

HOME = "0,-90,90,0,0,0\n"


def recorded() -> list[str]:
    """Return the names of the recorded machines."""
    return [path.stem for path in sorted(REFERENCE.glob("*.json"))]


@pytest.mark.parametrize("name", recorded())
def test_fk_gives_the_recorded_poses(run: Run, name: str) -> None:
    record = json.loads((REFERENCE / f"{name}.json").read_text("utf-8"))
    machine = next(path for path in REFERENCE.glob(f"{name}.*") if path.suffix != ".json")
    chain = chainbuild.load(machine).chain()
    axes, column = [axis.name for axis in chain.axes], chain.tool_column
    write("axes.csv", ",".join(axes) + "\n" + "".join(",".join(map(repr, r["axes"])) + "\n" for r in record["rows"]))
    options = ["--tool-length", repr(record["tool_length"])] if record.get("tool_length") else []
    outcome = run("fk", machine, "--axes", "axes.csv", "--quaternion", "-o", "poses.csv", *options)
    assert (outcome.code, outcome.out) == (0, "")
    poses = rows_of(Path("poses.csv").read_text("utf-8"))
    for row, recorded in zip(poses, record["rows"], strict=True):
        R = frames.matrix_from_quaternion([float(row[name]) for name in ("qx", "qy", "qz", "qw")])
        assert np.abs([float(row[c]) for c in ("x_mm", "y_mm", "z_mm")] - np.array(recorded["p"])).max() <= 1e-6
        if "R" in recorded:
            assert np.abs(R - recorded["R"]).max() <= 1e-9
        elif "z" in recorded:
            assert np.abs(R[:, 2] - recorded["z"]).max() <= 1e-9
        else:
            assert np.abs(R - np.eye(3)).max() <= 1e-9  # a platform that does not turn
        assert np.abs([float(row[f"tool_{c}"]) for c in "xyz"] - R[:, column]).max() <= 1e-12


def test_columns_of_fk_in_any_order_to_stdout(run: Run) -> None:
    write("axes.csv", "A2,B3,A1,B2,B1,C1\n5,4,3,2,1,0\n")
    write("ordered.csv", AXES + "0,1,2,3,4,5\n")
    one, two = run("fk", ARM, "--axes", "axes.csv"), run("fk", ARM, "--axes", "ordered.csv")
    assert one.out == two.out
    assert one.out.splitlines()[0] == "x_mm,y_mm,z_mm,qx,qy,qz,qw,tool_x,tool_y,tool_z,a_deg,b_deg,c_deg,is,it"
    assert (one.code, two.code) == (0, 0)


def test_fk_takes_values_from_the_command_line(run: Run) -> None:
    write("axes.csv", AXES + "0,-90,90,0,30,0\n-10,-80,70,0,30,0\n1,2,3,4,5,6\n")
    write("last.csv", AXES + "1,2,3,4,5,6\n")
    table = run("fk", ARM, "--axes", "axes.csv")
    given = run("fk", ARM, "--at", "0,-90,90,0,30,0", "--at", "-10,-80,70,0,30,0", "--axes", "last.csv")
    assert given.code == 0
    assert given.out == table.out


def test_values_from_the_command_line_outside_limits_are_told(run: Run) -> None:
    outcome = run("fk", "kr6r900_2", "--at", "0,200,90,0,0,0")
    assert (outcome.code, outcome.err) == (0, "--at: 1 row outside the limits of B1\n")


def test_fk_without_axis_values_is_wrong_usage(run: Run) -> None:
    outcome = run("fk", ARM)
    assert outcome.code == 2
    assert (
        outcome.err.splitlines()[0] == "chainbuild: expected axis values: --at 0,-90,90, or a table: --axes TABLE.csv"
    )


def test_the_tool_length_reaches_the_pose(run: Run) -> None:
    write("axes.csv", "A1,A2,A3,A4,A5,A6\n0,10,20,30,40,50\n")
    machine = REFERENCE / "robx_irb2600_12_165.tea"
    short, long = (
        rows_of(run("fk", machine, "--axes", "axes.csv", "--tool-length", length).out)[0] for length in ("0", "-12.5")
    )
    difference = [float(long[f"{c}_mm"]) - float(short[f"{c}_mm"]) for c in "xyz"]
    assert np.linalg.norm(difference) == pytest.approx(12.5, abs=1e-9)


def test_rows_outside_limits_are_computed_and_counted(run: Run) -> None:
    write("axes.csv", AXES + HOME + "0,200,90,0,0,0\n0,210,90,0,0,400\n")
    outcome = run("fk", "kr6r900_2", "--axes", "axes.csv")
    assert (outcome.code, len(rows_of(outcome.out))) == (0, 3)
    assert outcome.err.splitlines() == [
        "axes.csv: 2 rows outside the limits of B1",
        "axes.csv: 1 row outside the limits of A2",
    ]


def solve(run: Run, *words: str | Path) -> tuple[Outcome, list[dict[str, str]]]:
    outcome = run("ik", "kr6r900_2", *words)
    return outcome, rows_of(outcome.out)


def poses_of(run: Run, axes: str) -> None:
    write("axes.csv", AXES + axes)
    assert run("fk", "kr6r900_2", "--axes", "axes.csv", "-o", "poses.csv").code == 0


WAY = "".join(f"{10 * n},{-80 + n},{70 + n},{20 - n},{30 + n},{5 * n}\n" for n in range(8))


def test_ik_brings_the_pose_back(run: Run) -> None:
    poses_of(run, WAY)
    outcome, rows = solve(run, "--poses", "poses.csv")
    assert (outcome.code, outcome.err) == (0, "")
    assert list(rows[0]) == [*AXES.strip().split(","), "status", "position_error_mm", "rotation_error_deg"]
    write("solved.csv", outcome.out)
    assert run("fk", "kr6r900_2", "--axes", "solved.csv", "-o", "again.csv").code == 0
    wanted, reached = (rows_of(Path(name).read_text("utf-8")) for name in ("poses.csv", "again.csv"))
    for a, b, row in zip(wanted, reached, rows, strict=True):
        assert row["status"] == "ok"
        assert float(row["position_error_mm"]) < 1e-3
        assert float(row["rotation_error_deg"]) < 1e-4
        distance = np.linalg.norm([float(a[c]) - float(b[c]) for c in ("x_mm", "y_mm", "z_mm")])
        turn = 1.0 - abs(sum(float(a[c]) * float(b[c]) for c in ("qx", "qy", "qz", "qw")))
        assert distance < 1.1e-3
        assert turn < 1e-12


def test_a_start_per_pose_or_one_for_all_decides_the_branch(run: Run) -> None:
    poses_of(run, WAY)
    write("start.csv", AXES + WAY)
    _, rows = solve(run, "--poses", "poses.csv", "--start", "start.csv")
    for row, start in zip(rows, WAY.splitlines(), strict=True):
        found = [float(row[name]) for name in AXES.strip().split(",")]
        assert found == pytest.approx([float(value) for value in start.split(",")], abs=1e-4)
    write("start.csv", AXES + WAY.splitlines()[3] + "\n")
    outcome, rows = solve(run, "--poses", "poses.csv", "--start", "start.csv")
    assert (outcome.code, len(rows)) == (0, 8)


def test_angles_are_read_in_the_controllers_convention(run: Run) -> None:
    poses_of(run, WAY)
    table = rows_of(Path("poses.csv").read_text("utf-8"))
    names = ["c_deg", "x_mm", "b_deg", "y_mm", "a_deg", "z_mm"]
    write("angles.csv", ",".join(names) + "\n" + "".join(",".join(row[n] for n in names) + "\n" for row in table))
    write("start.csv", AXES + WAY)
    _, by_angles = solve(run, "--poses", "angles.csv", "--start", "start.csv")
    _, by_quaternion = solve(run, "--poses", "poses.csv", "--start", "start.csv")
    for a, b in zip(by_angles, by_quaternion, strict=True):
        assert [float(a[n]) for n in AXES.strip().split(",")] == pytest.approx(
            [float(b[n]) for n in AXES.strip().split(",")], abs=1e-6
        )


def test_failed_rows_end_with_3_and_leave_the_axes_empty(run: Run) -> None:
    poses_of(run, HOME)
    good = Path("poses.csv").read_text("utf-8").splitlines()[1]
    with Path("poses.csv").open("a", encoding="utf-8") as stream:
        stream.write("9000,0,0,0,0,0,1,0,0,1,0,0,0,2,0\n" + good + "\n")
    outcome = run("ik", "kr6r900_2", "--poses", "poses.csv", "-o", "axes.csv")
    assert outcome.code == 3
    why, count = outcome.err.splitlines()
    assert why.startswith("poses.csv:3: unreachable: too far: 9000.0 mm")
    assert count == "poses.csv: 1 of 3 poses failed: 1 unreachable"
    rows = rows_of(Path("axes.csv").read_text("utf-8"))
    assert [row["status"] for row in rows] == ["ok", "unreachable", "ok"]
    assert [rows[1][name] for name in AXES.strip().split(",")] == [""] * 6
    assert float(rows[1]["position_error_mm"]) > 1000.0
    refused = run("fk", "kr6r900_2", "--axes", "axes.csv")
    text = "axes.csv:3: the row has no axis values: inverse kinematics failed there (unreachable)"
    assert (refused.code, refused.err.splitlines()[0].split("; ")[0]) == (1, text)


@pytest.mark.parametrize(
    ("start", "message"),
    [
        (AXES, "start.csv: the table of start values has no rows"),
        (AXES + 2 * HOME, "start.csv: the table of start values has fewer rows than poses.csv"),
        (AXES + 9 * HOME, "start.csv: the table of start values has more rows than poses.csv"),
        ("C1,B1\n1,2\n", "start.csv:1: missing columns B2, A1, B3, A2"),
    ],
)
def test_start_values_must_match_the_poses(run: Run, start: str, message: str) -> None:
    poses_of(run, WAY)
    write("start.csv", start)
    outcome = run("ik", "kr6r900_2", "--poses", "poses.csv", "--start", "start.csv", "-o", "axes_out.csv")
    assert (outcome.code, outcome.out) == (1, "")
    assert outcome.err.startswith(message)
    assert sorted(path.name for path in Path().iterdir()) == ["axes.csv", "poses.csv", "start.csv"]


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (AXES + HOME + "1,2,3,4,5,nan\n", "axes.csv:3: column A2: 'nan' is not finite"),
        (AXES + HOME + "0,5,2,3,4,5,6\n", "axes.csv:3: the row has 7 values, the header 6 columns"),
        ("C1 B1\n", "axes.csv:1: the columns are separated by blanks"),
        ("C1,B1,B2,A1,B3,A2,A7\n", "axes.csv:1: unknown column 'A7'"),
    ],
)
def test_a_refused_table_leaves_no_file(run: Run, table: str, message: str) -> None:
    write("axes.csv", table)
    outcome = run("fk", ARM, "--axes", "axes.csv", "-o", "poses.csv")
    assert (outcome.code, outcome.out) == (1, "")
    assert outcome.err.startswith(message)
    assert [path.name for path in Path().iterdir()] == ["axes.csv"]


def test_an_old_file_outlives_a_refused_run(run: Run) -> None:
    write("axes.csv", AXES + HOME + "x,2,3,4,5,6\n")
    write("poses.csv", "old")
    assert run("fk", ARM, "--axes", "axes.csv", "-o", "poses.csv").code == 1
    assert Path("poses.csv").read_text("utf-8") == "old"


def test_the_output_does_not_replace_the_input(run: Run) -> None:
    write("table.csv", AXES + HOME)
    refused = run("fk", ARM, "--axes", "table.csv", "-o", "table.csv")
    assert refused.code == 2
    assert "--output table.csv: table.csv is also the input; expected another file, nothing was written" in refused.err
    assert Path("table.csv").read_text("utf-8") == AXES + HOME


def test_a_pose_that_breaks_the_angles_of_a_shorter_machine_is_named(run: Run) -> None:
    """A five-axis machine takes the tool vector alone."""
    write("poses.csv", "x_mm,y_mm,z_mm,tool_x,tool_y,tool_z\n10,20,30,0,0,1\n40,-20,30,0.6,0,0.8\n")
    machine = REFERENCE / "kin9_nut90_1.lis"
    outcome = run("ik", machine, "--poses", "poses.csv", "-o", "axes.csv")
    assert outcome.code == 0, outcome.err
    assert run("fk", machine, "--axes", "axes.csv", "-o", "back.csv").code == 0
    for row, x, direction in zip(
        rows_of(Path("back.csv").read_text("utf-8")), (10.0, 40.0), ([0, 0, 1], [0.6, 0, 0.8]), strict=True
    ):
        assert float(row["x_mm"]) == pytest.approx(x, abs=1e-3)
        assert [float(row[f"tool_{c}"]) for c in "xyz"] == pytest.approx(direction, abs=1e-6)


def path_of(rows: int) -> np.ndarray:
    """Return axis values of a path (rows, 6) that stays on one branch, with A1 turned away from where A4 points."""
    s = np.linspace(0.0, 1.0, rows)[:, None]
    return np.array([20.0, -60.0, 70.0, 150.0, -50.0, -160.0]) + s * [40.0, -25.0, 20.0, -60.0, 15.0, 50.0]


def test_follow_keeps_the_branch_of_the_start(run: Run) -> None:
    axes = path_of(40)
    write("axes.csv", AXES + "".join(",".join(map(repr, row)) + "\n" for row in axes.tolist()))
    write("start.csv", "".join(Path("axes.csv").read_text("utf-8").splitlines(keepends=True)[:2]))
    assert run("fk", "kr6r900_2", "--axes", "axes.csv", "-o", "poses.csv").code == 0
    followed = run("ik", "kr6r900_2", "--poses", "poses.csv", "--start", "start.csv", "--follow")
    assert followed.code == 0
    found = np.array([[float(row[name]) for name in AXES.strip().split(",")] for row in rows_of(followed.out)])
    assert np.abs(found - axes).max() < 1e-4
    anywhere = run("ik", "kr6r900_2", "--poses", "poses.csv", "--follow")
    assert anywhere.code == 0
    assert len(rows_of(anywhere.out)) == len(axes)


def test_follow_with_a_track_that_moves(run: Run) -> None:
    names = [axis.name for axis in chainbuild.load("irb2600_track").chain().axes]
    rows = [[0.0, 20.0, 10.0, 5.0, 30.0, 20.0, x] for x in (0.0, 0.0, 0.0, 100.0, 150.0)]
    rows = [[value + 0.5 * n for value in row[:6]] + row[6:] for n, row in enumerate(rows)]
    write("axes.csv", ",".join(names) + "\n" + "".join(",".join(map(repr, row)) + "\n" for row in rows))
    write("start.csv", "".join(Path("axes.csv").read_text("utf-8").splitlines(keepends=True)[:2]))
    assert run("fk", "irb2600_track", "--axes", "axes.csv", "-o", "poses.csv").code == 0
    followed = run("ik", "irb2600_track", "--poses", "poses.csv", "--start", "start.csv", "--follow")
    assert followed.code == 0
    found = [[float(row[name]) for name in names] for row in rows_of(followed.out)]
    assert np.abs(np.array(found) - rows).max() < 1e-4


def test_follow_starts_at_one_place(run: Run) -> None:
    write("axes.csv", AXES + HOME + HOME)
    assert run("fk", ARM, "--axes", "axes.csv", "-o", "poses.csv").code == 0
    outcome = run("ik", ARM, "--poses", "poses.csv", "--start", "axes.csv", "--follow")
    assert outcome.code == 1
    assert (
        outcome.err.splitlines()[-1]
        == "axes.csv: --follow: expected one row of start values, got more; permitted: one row"
    )


def test_positions_in_metres_are_suspected(run: Run) -> None:
    write("axes.csv", AXES + HOME + "10,-80,70,20,40,30\n")
    assert run("fk", "kr6r900_2", "--axes", "axes.csv", "-o", "poses.csv").code == 0
    header, *rows = Path("poses.csv").read_text("utf-8").splitlines()
    metres = [",".join([*(str(float(v) / 1000) for v in r.split(",")[:3]), *r.split(",")[3:]]) for r in rows]
    write("metres.csv", "\n".join([header, *metres]) + "\n")
    largest = max(abs(float(value)) / 1000 for row in rows for value in row.split(",")[:3])
    told = f"metres.csv: no coordinate is above {largest:.3g} mm: are these metres?"
    assert run("ik", "kr6r900_2", "--poses", "metres.csv").err.splitlines()[-1] == told
    assert "metres" not in run("ik", "kr6r900_2", "--poses", "poses.csv").err


def test_a_mill_may_cut_a_part_of_a_few_millimetres(run: Run) -> None:
    write("small.csv", "x_mm,y_mm,z_mm,tool_x,tool_y,tool_z\n1,2,3,0,0,1\n")
    reached = run("ik", "ac_table_kin58", "--poses", "small.csv", "--tool-length", "200")
    assert (reached.code, reached.err) == (0, "")
    missed = run("ik", "ac_table_kin58", "--poses", "small.csv", "--tool-length", "900")
    assert missed.code == 3
    assert missed.err.splitlines()[-1] == "small.csv: no coordinate is above 3 mm: are these metres?"


def test_fk_with_drives(run: Run) -> None:
    """Columns of the drives stand behind all others, and ik reads the table all the same."""
    outcome = run("fk", "cardan_head_kin59", "--at", "1,2,3,40,85", "--drives", "-o", "poses.csv")
    assert outcome.code == 0
    header = Path("poses.csv").read_text("utf-8").splitlines()[0].split(",")
    assert header[-5:] == ["X_drive", "Y_drive", "Z_drive", "C_drive", "A_drive"]
    (row,) = rows_of(Path("poses.csv").read_text("utf-8"))
    assert float(row["A_drive"]) == pytest.approx(145.658, abs=5e-4)
    assert float(row["X_drive"]) == 1.0
    assert run("ik", "cardan_head_kin59", "--poses", "poses.csv").code == 0
    equal = run("fk", ARM, "--at", "1,2,3,4,5,6", "--drives").out.splitlines()
    assert [float(value) for value in equal[1].split(",")[-6:]] == [1, 2, 3, 4, 5, 6]


def test_limits_of_drives_are_counted_and_named(run: Run) -> None:
    write("head.lis", "trafo[0].id 59\ntrafo[0].param[6] 450000\nEnde\n")
    write("head.chainbuild.toml", "[limits.drives]\nA = [-100, 100]\n")
    outcome = run("fk", "head.lis", "--at", "0,0,0,0,80", "-o", "poses.csv")
    assert "1 row outside the limits of A_drive" in outcome.err
    assert rows_of(Path("poses.csv").read_text("utf-8"))[0]["violations"] == "A_drive"
    refused = run("ik", "head.lis", "--poses", "poses.csv")
    assert refused.code == 3
    assert "A_drive is " in refused.err
    shown = run("info", "head.lis")
    assert "A_drive" in shown.out
    (data,) = json.loads(run("info", "head.lis", "--json").out)["drives"]
    assert data == {"name": "A_drive", "lower": -100.0, "upper": 100.0, "max_speed": None}


def test_rows_beyond_the_reach_are_left_out_of_measures(run: Run) -> None:
    write("head.lis", "trafo[0].id 60\ntrafo[0].param[6] 450000\nEnde\n")
    write("axes.csv", "X,Y,Z,C,B\n0,0,0,0,30\n0,0,0,0,120\n0,0,0,0,0\n")
    words = ("singularity", "head.lis", "--axes", "axes.csv")
    outcome = run(*words, "--between", "rows", "--picture", "path.svg")
    assert outcome.code == 0
    assert "1 rows have no pose and are left out" in outcome.out
    assert json.loads(run(*words, "--between", "rows", "--json").out)["smallest"][1] is None
    for between in ("ptp", "cp"):
        path = json.loads(run(*words, "--between", between, "--json").out)["path"]
        assert (path["smallest"][1], path["gaps"], path["length_mm"]) == (None, [2], 0.0)
    assert run("singularity", "head.lis", "--at", "0,0,0,0,120").code == 1
