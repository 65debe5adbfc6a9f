"""singularity along paths, collide between rows, and what ik --follow says of its path."""

from __future__ import annotations

import json
import math
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest

from chainbuild import PathOptions, PathPlace, Robot, path_report
from chainbuild.cli.pathinput import PathInput
from chainbuild.errors import TableError
from tests.kit.command_line import Outcome, Run, rows_of, write

ARM_AXES = "A1,A2,A3,A4,A5,A6\n"
CROSSING = ARM_AXES + "0,-90,90,0,-8,0\n0,-90,90,0,8,0\n"
ELBOW = ARM_AXES + "47,-127,-109,-179,75,289\n36,-19,30,-179,75,289\n"  # bent up, then down: no line leads there
HEAD = "X,Y,Z,C,A\n0,0,-100,10,-20\n50,10,-100,30,20\n"  # through A = 0
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def arm() -> Robot:
    return Robot.load("kr6r900")


def path_of(outcome: Outcome) -> dict:
    assert outcome.code == 0, outcome.err
    return json.loads(outcome.out)["path"]


def poses_of(run: Run, machine: str, axes: Path) -> Path:
    assert run("fk", machine, "--axes", axes, "-o", "poses.csv").code == 0
    return Path("poses.csv")


@pytest.mark.parametrize("between", ["ptp", "cp"])
def test_the_wrist_between_two_rows_is_found(run: Run, between: str) -> None:
    outcome = run("singularity", "kr6r900", "--axes", write("p.csv", CROSSING), "--between", between)
    assert outcome.code == 0
    (line,) = [line for line in outcome.out.splitlines() if line.lstrip().startswith("wrist  1 + 0.14")]
    assert "1 + 0.5" in line or "1 + 0.499" in line
    assert re.search(r"^wrist at 1 \+ [\d.]+: A4 and A6 are parallel", outcome.out, re.MULTILINE)
    if between == "ptp":  # A5 alone moves: A4 stands, and what the worst direction asks of it has no end
        assert re.search(r"A4 +0 deg/s +∞ +381 deg/s", line)
    last = outcome.out.splitlines()[-1]
    assert last.startswith(f"2 rows, {between} between them, 22.")
    assert last.endswith("the smallest singular value at the rows is 0.03939")


def test_rows_alone_see_nothing_between_them(run: Run) -> None:
    outcome = run("singularity", "kr6r900", "--axes", write("p.csv", CROSSING), "--between", "rows")
    assert "wrist" not in outcome.out
    data = json.loads(run("singularity", "kr6r900", "--axes", "p.csv", "--between", "rows", "--json").out)
    assert data["rows"] == data["path"]["stretches"] == []
    assert data["path"]["proven"] is False
    on_row = run("singularity", "kr6r900", "--axes", write("q.csv", CROSSING + "200,-90,90,0,0,0\n"), "--between=rows")
    assert re.search(r"^ 3 +0 +wrist \(alpha5\)", on_row.out, re.MULTILINE)
    assert "limit violated at 3: A1 is 200" in on_row.out


def test_the_feed_gives_times_and_speeds(run: Run) -> None:
    words = ("singularity", "kr6r900", "--axes", write("p.csv", CROSSING), "--feed", "600")
    data = path_of(run(*words, "--json"))
    seconds = data["length_mm"] / 10.0
    assert data["seconds"] == pytest.approx(seconds)
    fast = {one["name"]: one["needed"] for one in data["speeds"]}
    assert fast["A5"] == pytest.approx(16.0 / seconds)
    assert fast["A1"] == 0.0
    (stretch,) = data["stretches"]
    assert stretch["seconds"] == pytest.approx(stretch["length_mm"] / 10.0)
    assert stretch["minima"][0]["seconds"] == pytest.approx(seconds / 2.0, rel=1e-6)
    out = run(*words).out
    assert re.search(r"Kind +From +To +mm +s +Closest", out)
    assert "Largest axis speeds at 600 mm/min" in out
    assert re.search(rf"^ A5 +{16.0 / seconds:.4g} deg/s", out, re.MULTILINE)
    beyond = run("singularity", "kr6r900", "--axes", "p.csv", "--feed", "60000").out
    assert re.search(r"^ A5 .*from 1 to 2", beyond, re.MULTILINE)


def test_near_moves_the_ends_of_stretches(run: Run) -> None:
    write("p.csv", CROSSING)
    for near in (0.05, 0.1):
        data = path_of(run("singularity", "kr6r900", "--axes", "p.csv", "--near", near, "--json"))
        begin, end = (data["stretches"][0][key]["axes"]["A5"] for key in ("from", "to"))
        assert (begin, end) == pytest.approx((-math.degrees(math.asin(near)), math.degrees(math.asin(near))))


def test_json_holds_the_report(run: Run, arm: Robot) -> None:
    rows = [[0, -90, 90, 10, 20 - 7 * k, k] for k in range(7)] + [[200, -90, 90, 10, -30, 0]]
    write("p.csv", ARM_AXES + "".join(",".join(map(str, row)) + "\n" for row in rows))
    data = path_of(run("singularity", "kr6r900", "--axes", "p.csv", "--feed", "3000", "--json"))
    report = path_report(arm, rows, options=PathOptions(feed_mm_min=3000.0))
    assert (data["rows"], data["between"], data["gaps"], data["leaves"]) == (8, "ptp", [], [])
    assert data["length_mm"] == pytest.approx(report.length_mm)
    np.testing.assert_allclose(data["smallest"], report.smallest)
    (stretch,), (expected,) = data["stretches"], report.stretches
    for key, place in (("from", expected.begin), ("to", expected.end)):
        assert stretch[key]["row"] == place.row + 1
        assert stretch[key]["share"] == pytest.approx(place.share)
        assert list(stretch[key]["axes"].values()) == pytest.approx(place.axes.tolist())
    (minimum,), (known,) = stretch["minima"], expected.minima
    assert (minimum["row"], minimum["singular"], minimum["sentence"]) == (known.place.row + 1, True, known.sentence)
    assert minimum["worst"]["A4"] is None  # infinite
    assert minimum["speeds"] == pytest.approx({one.name: one.needed for one in known.speeds})
    (violation,) = data["violations"]
    assert (violation["name"], violation["from"]["row"], violation["to"]["row"]) == ("A1", 7, 7)
    assert violation["excess"] == pytest.approx(30.0)
    assert [one["name"] for one in data["speeds"]] == [one.speed.name for one in report.speeds]


def test_poses_are_a_path_of_the_tip(run: Run) -> None:
    write("start.csv", ARM_AXES + "0,-90,90,0,-8,0\n")
    poses = poses_of(run, "kr6r900", write("a.csv", CROSSING))
    words = ("singularity", "kr6r900", "--poses", poses, "--start", "start.csv", "--json")
    data = path_of(run(*words))
    assert data["between"] == "cp"
    assert [one["kind"] for one in data["stretches"]] == ["wrist"]
    straight = path_of(run(*words, "--between", "ptp"))
    assert straight["between"] == "ptp"
    assert straight["stretches"][0]["minima"][0]["share"] == pytest.approx(0.5, abs=1e-6)


def test_a_pose_without_solution_is_a_gap(run: Run) -> None:
    text = poses_of(run, "kr6r900", write("a.csv", CROSSING + "0,-90,90,0,20,0\n")).read_text("utf-8")
    header, first, second, third = text.splitlines()
    far = ",".join(["9000", *second.split(",")[1:]])
    write("gap.csv", "\n".join([header, first, far, third]) + "\n")
    write("start.csv", ARM_AXES + "0,-90,90,0,-8,0\n")
    words = ("singularity", "kr6r900", "--poses", "gap.csv", "--start", "start.csv")
    outcome = run(*words, "--picture", "gap.svg")
    assert outcome.code == 0
    assert "row 2 has no axis values or no pose: the path is interrupted there" in outcome.out
    assert "gap.csv:3: unreachable" in outcome.err
    # A row alone between gaps is looked at for itself: sin 8° is not close, but within 0.2.
    wide = run(*words, "--near", "0.2").out
    assert re.search(r"^ wrist +1 +1 +0 +1 +0.139", wide, re.MULTILINE)
    data = path_of(run(*words, "--json"))
    assert data["gaps"] == [2]
    assert data["smallest"][1] is None
    alone = json.loads(run(*words, "--between", "rows", "--json").out)
    assert alone["smallest"][1] is None
    assert alone["smallest"][2] == pytest.approx(data["smallest"][2])


def test_a_line_that_leaves_the_reach_is_told(run: Run) -> None:
    outcome = run("singularity", "kr6r900", "--axes", write("e.csv", ELBOW), "--between", "cp")
    assert "the line leaves the reach of the arm at 1 + 0.98" in outcome.out
    data = path_of(run("singularity", "kr6r900", "--axes", "e.csv", "--between", "cp", "--json"))
    assert data["leaves"][0]["share"] == pytest.approx(0.980375, abs=1e-5)


@pytest.mark.parametrize("between", ["ptp", "cp"])
def test_programmed_rotary_axes_have_notices_instead_of_stretches(run: Run, between: str) -> None:
    outcome = run("singularity", "ca_head_kin9", "--axes", write("h.csv", HEAD), "--between", between)
    assert "no part of the path is close to a singularity" in outcome.out
    words = r"^notice: from 1 \+ 0.3\d+ to 1 \+ 0.6\d+: a tool vector as the target would pass"
    assert re.search(words, outcome.out, re.MULTILINE)
    data = path_of(run("singularity", "ca_head_kin9", "--axes", "h.csv", "--between", between, "--json"))
    assert [one["of_vector"] for one in data["stretches"]] == [True]


def test_the_picture_shows_stretches_and_minima(run: Run) -> None:
    assert run("singularity", "kr6r900", "--axes", write("p.csv", CROSSING), "--picture", "p.svg").code == 0
    root = ET.parse("p.svg").getroot()
    assert "wrist" in [text.text for text in root.iter(f"{SVG}text")]
    (circle,) = root.iter(f"{SVG}circle")
    assert float(circle.get("cx", "")) == pytest.approx(350.0, abs=0.1)  # the middle of the frame, on its lower edge
    assert float(circle.get("cy", "")) == pytest.approx(440.0, abs=0.1)
    assert circle.get("fill") != "white"


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["--axes", "p.csv", "--feed", "0"], 1, "wrong feed"),
        (["--axes", "p.csv", "--feed", "-5"], 1, "wrong feed"),
        (["--axes", "p.csv", "--near", "1"], 1, "above 0 and below 1"),
        (["--axes", "p.csv", "--near", "0"], 1, "above 0 and below 1"),
        (["--axes", "p.csv", "--speed", "0"], 1, "wrong speed"),
        (["--poses", "p.csv", "--at", "0,-90,90,0,8,0"], 2, "one of them"),
        (["--poses", "p.csv", "--axes", "p.csv"], 2, "one of them"),
        (["--axes", "p.csv", "--start", "p.csv"], 2, "--start requires --poses"),
        (["--at", "0,-90,90,0,8,0", "--between", "cp"], 2, "--between requires --axes or --poses"),
        (["--at", "0,-90,90,0,8,0", "--feed", "5"], 2, "--feed requires a path"),
        (["--axes", "p.csv", "--between", "rows", "--near", "0.2"], 2, "--near requires a path"),
        (["--axes", "p.csv", "--nearest"], 2, "--nearest requires --at or --between rows"),
        (["--axes", "p.csv", "--length", "500"], 2, "--length requires"),
        (["--axes", "p.csv", "--between", "line"], 2, "ptp"),
        (["--axes", "empty.csv"], 1, "the table has no rows"),
        (["--axes", "p.csv", "--picture", "p.csv"], 2, "is also the input"),
    ],
)
def test_what_is_refused(run: Run, words: list[str], code: int, message: str) -> None:
    write("p.csv", CROSSING)
    write("empty.csv", ARM_AXES)
    outcome = run("singularity", "kr6r900", *words)
    assert (outcome.code, outcome.out) == (code, "")
    assert message in outcome.err


def test_blocks_are_judged_by_the_thresholds_of_the_control(run: Run) -> None:
    write("p.csv", ARM_AXES + "0,-90,90,0,-8,0\n0,-90,90,0,0,0\n0,-90,90,0,0.01,0\n0,-90,90,0,8,0\n")
    words = ("singularity", "kr6r900", "--axes", "p.csv")
    lines = [line for line in run(*words).out.splitlines() if line.startswith("rows ")]
    assert [line.split(",")[0] for line in lines] == ["rows 1 … 2", "rows 2 … 3", "rows 3 … 4"]
    assert all(line.endswith("alarm 10911") for line in lines)
    data = json.loads(run(*words, "--json").out)
    assert [(one["row"], one["level"]) for one in data["verdicts"]["blocks"]] == [(n, "singular") for n in (1, 2, 3)]
    assert data["thresholds"]["clearance"] == 0.001
    assert json.loads(run(*words, "--between", "rows", "--json").out).get("verdicts") is None


def test_the_axis_that_the_path_moves_too_fast_is_shown(run: Run) -> None:
    write("p.csv", ARM_AXES + "0,-90,90,5,-8,0\n20,-80,85,5,8,0\n")
    out = run("singularity", "kr6r900", "--axes", "p.csv", "--between", "cp", "--feed", "12000").out
    assert re.search(r"^ wrist .* A4 +960\.\d deg/s +18\d\d deg/s +381 deg/s", out, re.MULTILINE)
    assert re.search(r"^ A4 +960\.\d deg/s +1 \+ 0.525\d+ +381 deg/s +from 1 to 2", out, re.MULTILINE)


def test_places_next_to_a_row_are_called_by_it() -> None:
    labels = [PathPlace(3, share, np.zeros(6), 0.0).label for share in (0.0, 1e-9, 0.25, 1.0 - 1e-9, 1.0)]
    assert labels == ["4", "4 + 1e-09", "4 + 0.25", "5", "5"]


def test_one_row_is_a_position(run: Run) -> None:
    one = run("singularity", "kr6r900", "--axes", write("one.csv", ARM_AXES + "0,-90,90,0,0.3,0\n"))
    assert "A4 and A6 are nearly parallel (A5 = 0.3°)" in one.out
    assert "characteristic length" in one.out


def test_rows_are_read_one_by_one(run: Run, arm: Robot) -> None:
    a5 = 10.0 * np.cos(np.arange(2000) * np.pi / 1999.0)
    write("long.csv", ARM_AXES + "".join(f"0,-90,90,0,{value:.6f},0\n" for value in a5))
    data = path_of(run("singularity", "kr6r900", "--axes", "long.csv", "--json"))
    assert (data["rows"], len(data["smallest"])) == (2000, 2000)
    (stretch,) = data["stretches"]  # over the border of what is worked on at a time
    assert stretch["from"]["row"] < 1000
    assert stretch["to"]["row"] > 1024
    assert (stretch["minima"][0]["row"], stretch["minima"][0]["singular"]) == (1000, True)
    # A broken row at the end is met only when the rows before it have been given.
    with Path("long.csv").open("a", encoding="utf-8") as stream:
        stream.write("1,2,x,4,5,6\n")
    with PathInput(axes=Path("long.csv")).rows(arm) as rows:
        for _ in range(1024):
            next(rows)
        with pytest.raises(TableError):
            list(rows)


def test_collisions_between_rows(run: Run, arm: Robot) -> None:
    rows = np.array([[0, -90, 90, 0, 0, 0], [0, 45, 150, 0, 0, 0]], dtype=float)
    write("c.csv", ARM_AXES + "".join(",".join(map(str, row)) + "\n" for row in rows))
    found = {}
    for between in ("ptp", "cp", "rows"):
        outcome = run("collide", "kr6r900", "--axes", "c.csv", "--between", between, "--json")
        assert outcome.code == 3
        found[between] = json.loads(outcome.out)
        assert found[between]["between"] == between
    assert json.loads(run("collide", "kr6r900", "--axes", "c.csv", "--json").out) == found["ptp"]
    contacts = {between: data["contacts"][0] for between, data in found.items()}
    axes = {between: np.array(list(one["axes"].values())) for between, one in contacts.items()}
    share = contacts["ptp"]["share"]
    np.testing.assert_allclose(axes["ptp"], rows[0] + share * (rows[1] - rows[0]))
    begin, end, met = (arm.fk(one).translation for one in (*rows, axes["cp"]))
    np.testing.assert_allclose(met, begin + contacts["cp"]["share"] * (end - begin), atol=2e-4)
    assert (contacts["rows"]["row"], contacts["rows"]["share"]) == (2, 0.0)
    assert [len(found[between]["remarks"]) for between in ("ptp", "cp", "rows")] == [0, 1, 1]
    assert "along a line the axes are sampled" in run("collide", "kr6r900", "--axes", "c.csv", "--between", "cp").out


def test_contacts_behind_a_nonlinear_map_are_marked_as_sampled(run: Run) -> None:
    for machine, rows, sampled in (("cardan_head_kin59", "X,Y,Z,C,A\n0,0,0,0,10\n5,0,0,10,20\n", True),
                                   ("ca_head_kin9", HEAD, False)):  # fmt: skip
        outcome = run("collide", machine, "--axes", write("m.csv", rows))
        assert ("the axis map is not affine: contacts between rows are sampled" in outcome.out) is sampled


def test_follow_tells_what_lies_between_the_rows(run: Run) -> None:
    poses = poses_of(run, "kr6r900", write("a.csv", CROSSING))
    write("start.csv", ARM_AXES + "0,-90,90,0,-8,0\n")
    words = ("ik", "kr6r900", "--poses", poses, "--start", "start.csv")
    followed, alone = run(*words, "--follow"), run(*words)
    assert followed.code == alone.code == 0
    assert re.search(
        r"poses.csv: singular \(wrist\) at 1 \+ 0\.\d+, close from 1 \+ 0.14\d* to 1 \+ 0.85", followed.err
    )
    assert "singular" not in alone.err
    assert [row["status"] for row in rows_of(followed.out)] == ["ok", "ok"]


def test_follow_counts_notes_beyond_a_screenful(run: Run) -> None:
    rows = "".join(f"0,-90,90,0,{8 * (-1) ** n},0\n" for n in range(14))
    poses = poses_of(run, "kr6r900", write("a.csv", ARM_AXES + rows))
    write("start.csv", ARM_AXES + "0,-90,90,0,8,0\n")
    err = run("ik", "kr6r900", "--poses", poses, "--start", "start.csv", "--follow").err
    assert err.count("poses.csv: singular (wrist)") == 10
    assert "… and 3 more: `chainbuild singularity --poses` lists them" in err
