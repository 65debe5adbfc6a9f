"""Tables that the page plays back: the data agree with what the package computes, and the page shows them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import chainbuild
from chainbuild import Robot, frames
from chainbuild.analysis.singularity.measures import measure
from chainbuild.errors import ChainbuildError, TableError
from tests.kit.command_line import Run, write
from tests.kit.paths import TESTS

ARM = "A1,A2,A3,A4,A5,A6\n"
COMAU = TESTS / "data/recordings/comau_calibrated.csv"


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("kr6r900")


def table(folder: Path, rows: Any, head: str = ARM) -> Path:
    path = folder / "path.csv"
    path.write_text(head + "\n".join(",".join(repr(float(value)) for value in row) for row in rows) + "\n", "utf-8")
    return path


def page_data(path: str | Path) -> dict[str, Any]:
    text = Path(path).read_text("utf-8")
    found = re.search(r'id="page-data">\n(.*?)\n</script>', text, re.DOTALL)
    assert found is not None
    data: dict[str, Any] = json.loads(found[1])
    return data


def swinging(count: int) -> np.ndarray:
    """Return rows that pass limits and singular places."""
    t = np.linspace(0.0, 6.0, count)[:, None]
    amplitudes = [180.0, 60.0, 60.0, 50.0, 60.0, 100.0]
    rows: np.ndarray = np.array([0, -90, 90, 0, 30, 0]) + amplitudes * np.sin(t * [1, 2, 3, 1, 2, 1.5])
    return rows


def angles_of(robot: Robot, T: np.ndarray) -> tuple[float, ...]:
    return frames.angles_from_matrix(robot.chain.angle_mode, T[:3, :3])


def covered(notes: Any, kind: str) -> set[int]:
    return {row for note in notes if note.kind == kind for row in range(note.row, note.last + 1)}


def test_rows_and_measures_are_those_of_the_package(robot: Robot, tmp_path: Path) -> None:
    rows = swinging(200)
    found = chainbuild.axes_playback(robot, table(tmp_path, rows))
    data = found.data()
    assert (data["kind"], data["source"]) == ("axes", "path.csv")
    assert data["numbers"] == list(range(1, 201))
    assert np.abs(np.array(data["rows"]) - rows).max() <= 0.5000001e-6
    assert data["rows"] == np.round(rows, 6).tolist()
    wanted = [measure(robot, row).smallest for row in rows]
    assert np.allclose(data["singular"], wanted, rtol=1e-7, atol=1e-12)
    assert np.allclose(data["singular"], chainbuild.path_report(robot, rows).smallest, rtol=1e-7, atol=1e-12)
    assert data["measured"] is data["errors"] is None


def test_violated_limits_are_named_at_every_row(robot: Robot, tmp_path: Path) -> None:
    rows = swinging(200)
    notes = chainbuild.axes_playback(robot, table(tmp_path, rows)).notes
    wrong = {n: robot.violated_limits(row) for n, row in enumerate(rows, start=1)}
    assert covered(notes, "limit") == {n for n, names in wrong.items() if names} != set()
    for note in notes:
        if note.kind == "limit":
            name = note.text.split()[0]
            assert all(name in wrong[row] for row in range(note.row, note.last + 1))
            assert note.row == 1 or name not in wrong[note.row - 1]
    assert [note.row for note in notes] == sorted(note.row for note in notes)


def test_what_happens_between_two_rows_is_told(robot: Robot, tmp_path: Path) -> None:
    rows = [[0, -90, 90, 0, 20, 0], [0, -90, 90, 0, 8, 0], [0, -90, 90, 0, -8, 0], [0, -90, 90, 0, -20, 0]]
    (note,) = chainbuild.axes_playback(robot, table(tmp_path, rows)).notes
    assert (note.row, note.last, note.kind) == (2, 2, "singular")
    assert "singular (wrist) at 2 + 0.5, close from 2 + 0.1" in note.text
    swinging_wrist = [[0, -90, 90, 0, angle, 0] for angle in (20, 3, 5, 1, 4, 20)]
    (note,) = chainbuild.axes_playback(robot, table(tmp_path, swinging_wrist)).notes
    assert (note.row, note.last, note.kind) == (2, 5, "close")
    assert note.text.startswith("close to singular (wrist) at 4, close from 1 + ")
    swinging_wrist = [[0, -90, 90, 0, angle, 0] for angle in (20, 3, -1, 1, -20)]
    (note,) = chainbuild.axes_playback(robot, table(tmp_path, swinging_wrist)).notes
    assert note.text.startswith("singular (wrist) at 2 + 0.75 and 2 more, close from 1 + ")
    notes = chainbuild.axes_playback(robot, table(tmp_path, [rows[0], [0, -90, 90, 0, 3, 0]])).notes
    assert [(one.row, one.last, one.kind) for one in notes] == [(2, 2, "close")]


def test_another_branch_is_a_jump_and_a_long_way_is_none(robot: Robot, tmp_path: Path) -> None:
    rows = [[0, -90, 90, 40, 30, 20], [80, -90, 90, 40, 30, 20], [80, -90, 90, -140, -30, 200]]
    notes = chainbuild.axes_playback(robot, table(tmp_path, rows)).notes
    (jump,) = (one for one in notes if one.kind == "jump")
    assert (jump.row, jump.last) == (3, 3)
    assert jump.text.startswith("A4 moves -180 deg from 2 to 3 while the tool moves 0 mm")


def test_poses_are_solved_from_the_solution_before(robot: Robot, run: Run) -> None:
    rows = np.linspace([10, -80, 70, 20, 40, 30], [60, -60, 60, 20, -40, 30], 6)
    poses = [robot.fk(row).homogeneous for row in rows]
    poses[2][:3, 3] += 9.0
    poses[3][:3, 3] += 11.0
    lines = ["x_mm,y_mm,z_mm,a_deg,b_deg,c_deg"]
    lines += [",".join(str(float(value)) for value in (*1000.0 * T[:3, 3], *angles_of(robot, T))) for T in poses]
    write("poses.csv", "\n".join(lines))
    outcome = run("inspect", "kr6r900", "--export", "page.html", "--poses", "poses.csv")
    assert (outcome.code, outcome.out) == (0, "page.html\n")
    assert "poses.csv:4: unreachable: " in outcome.err
    assert "2 of 6 poses failed: 2 unreachable" in outcome.err
    data = page_data("page.html")["playback"]
    last = None
    for n, (T, row) in enumerate(zip(poses, data["rows"], strict=True)):
        if n in (2, 3):
            assert row is data["singular"][n] is None
            continue
        last = robot.ik(T, last).axes
        assert np.abs(np.array(row) - last).max() < 1e-4
        assert np.abs(robot.fk(row).homogeneous - T).max() < 1e-6
    note, *_ = (one for one in data["notes"] if one["kind"] == "unreachable")
    assert (note["row"], note["last"]) == (3, 4)
    assert note["text"].startswith("unreachable: ")
    assert data["kind"] == "poses"


def test_what_a_line_between_poses_meets_is_told(robot: Robot) -> None:
    bent = [[47, -127, -109, -179, 75, 289], [36, -19, 30, -179, 75, 289]]  # up, then down: no line leads there
    found = chainbuild.pose_playback(robot, "p.csv", [robot.ik(robot.fk(row), row) for row in bent])
    (reach,) = (one for one in found.notes if one.kind == "reach")
    assert (reach.row, reach.last) == (1, 1)
    assert reach.text.startswith("the line leaves the reach of the arm at 1 + 0.98")
    mill = Robot.load("ac_table_kin58")
    rows = [[100, 20, -300, tilt, 40] for tilt in (-12, -3, 5, 12)]
    found = chainbuild.pose_playback(mill, "folder/p.csv", [mill.from_display(mill.display(row)) for row in rows])
    assert (found.source, found.kind) == ("p.csv", "poses")
    (note,) = found.notes
    assert (note.row, note.last, note.kind) == (2, 3, "vector")
    assert note.text.endswith("from 1 + 0.695648 to 3 + 0.105596; rotary axes as programmed lose nothing there")


def test_a_recording_is_compared_with_forward_kinematics(tmp_path: Path) -> None:
    robot = Robot.load("comau_calibrated")
    recording = chainbuild.read_recording(COMAU, robot.chain)
    head, *lines = COMAU.read_text("utf-8").splitlines()
    fields = lines[1].split(",")
    place = head.split(",").index("x_mm")
    for n, moved in enumerate((1.0, -2.0, 3.0), start=place):
        fields[n] = str(float(fields[n]) + moved)
    path = tmp_path / "moved.csv"
    path.write_text("\n".join([head, lines[0], ",".join(fields), *lines[2:]]), "utf-8")
    data = chainbuild.recording_playback(robot, path).data()
    computed = np.array([robot.fk(row).translation for row in recording.axes])
    measured = recording.poses[:, :3, 3].copy()
    measured[1] += [0.001, -0.002, 0.003]
    assert np.abs(np.array(data["measured"]) - measured).max() < 1e-9
    assert np.abs(np.array(data["errors"]) - 1000.0 * (measured - computed)).max() < 1e-6
    assert np.abs(np.array(data["errors"][1]) - [1.0, -2.0, 3.0]).max() < 0.01
    assert (data["kind"], data["source"], data["rows"]) == ("recording", "moved.csv", recording.axes.tolist())
    assert data["remarks"][-1].startswith("farthest from the model: row 2, 3.7")
    assert set(data["turns"]) == {None}  # positions alone were recorded


def test_what_is_turned_in_a_recording_is_told(robot: Robot, tmp_path: Path) -> None:
    rows = [[0, -90, 90, 0, 30, 0], [10, -80, 90, 20, 30, 40], [20, -80, 70, 20, 30, -40]]
    shown = [robot.display(row) for row in rows]
    shown[1]["x_mm"] += 0.5
    shown[2]["c_deg"] += 0.25
    both = [(*row, *columns.values()) for row, columns in zip(rows, shown, strict=True)]
    lines = [",".join(f"{value:.12g}" for value in values) for values in both]
    path = tmp_path / "recording.csv"
    path.write_text(f"{ARM.strip()},{','.join(shown[0])}\n" + "\n".join(lines), "utf-8")
    found = chainbuild.recording_playback(robot, path)
    assert found.remarks[-2:] == (
        "farthest from the model: row 2, 0.500 mm", "turned most against the model: row 3, 0.250 deg",
    )  # fmt: skip
    assert found.data()["turns"] == pytest.approx([0.0, 0.0, 0.25], abs=1e-5)


def test_rows_without_pose_and_maps_that_are_not_affine(tmp_path: Path) -> None:
    robot = Robot.load("cardan_head_kin59")
    rows = np.zeros((5, len(robot.axes)))
    rows[1:3, 0] = np.add(robot.axes[0].range[1], [5.0, 7.0])
    rows[3:, 3:] = 179.0
    head = ",".join(axis.name for axis in robot.axes) + "\n"
    without = [n for n, row in enumerate(rows, start=1) if not np.isfinite(robot.chain.axis_map.q(row)).all()]
    found = chainbuild.axes_playback(robot, table(tmp_path, rows, head))
    assert "between rows nothing was looked at" in found.remarks[0]
    assert sorted(covered(found.notes, "no_pose")) == without == [4, 5]
    assert [value is None for value in found.data()["singular"]] == [False, False, False, True, True]
    assert {note.kind for note in found.notes} == {"limit", "no_pose"}
    first = next(note for note in found.notes if note.kind == "limit")
    assert (first.row, first.last) == (2, 3)
    assert first.text.startswith(f"{robot.axes[0].name} is {rows[2, 0]:g}, outside ")
    assert first.text.endswith("from 2 to 3, most at 3")


def test_a_long_table_stays_small(robot: Robot, tmp_path: Path) -> None:
    found = chainbuild.axes_playback(robot, table(tmp_path, swinging(2000)))
    text = json.dumps(found.data() | {"notes": []}, separators=(",", ":"))
    assert len(text) / 2000 < 85  # 4.2 MB for 50,000 rows of six axes


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        (f"{ARM}0,-90,90,0,30,0\n0,-90,90,x,30,0\n", (3, 10), "column A4: 'x' is not a number"),
        (f"{ARM}0,-90,90,0,30\n", (2, 1), "the row has 5 values, the header 6 columns"),
        ("A1,A2,A3,A4,A5,A7\n", (1, 16), "unknown column 'A7'"),
        (ARM, (0, 1), "the table has no rows"),
    ],
)
def test_wrong_tables_are_refused_at_their_place(
    robot: Robot, tmp_path: Path, text: str, place: tuple[int, int], words: str
) -> None:
    path = tmp_path / "path.csv"
    path.write_text(text, "utf-8")
    with pytest.raises(TableError, match=re.escape(words)) as caught:
        chainbuild.axes_playback(robot, path)
    span = caught.value.span
    assert span is not None
    assert (span.file, span.line, span.column) == (str(path), *place)
    with pytest.raises(ChainbuildError):
        chainbuild.recording_playback(robot, path)
    with pytest.raises(TableError, match="no rows"):
        chainbuild.pose_playback(robot, path, [])


def test_the_command_shows_a_table_and_opens_at_axis_values(run: Run) -> None:
    Path("secret").mkdir()
    write("secret/a<b>.csv", f"{ARM}0,-90,90,0,30,0\n10,-90,90,0,30,0\n")
    words = ("inspect", "kr6r900", "--export", "page.html")
    outcome = run(*words, "--axes", "secret/a<b>.csv", "--at", "-1,-90,90,0,30,0.25")
    assert (outcome.code, outcome.out) == (0, "page.html\n")
    data = page_data("page.html")
    assert (data["rest"], data["given"]) == ([-1, -90, 90, 0, 30, 0.25], True)
    assert (data["playback"]["source"], data["playback"]["notes"]) == ("a<b>.csv", [])
    text = Path("page.html").read_text("utf-8")
    assert "secret" not in text
    assert "a<b>.csv" not in text  # no text of a file is markup
    assert run(*words).code == 0
    data = page_data("page.html")
    assert (data["playback"], data["given"]) == (None, False)


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        ("--axes a.csv --poses b.csv", 2, "--axes and --poses exclude one another"),
        ("--poses a.csv --recording b.csv", 2, "--poses and --recording exclude one another"),
        ("--at 1,2,3", 1, "expected 6 axis values, got 3"),
        ("--at 1,2,x", 2, "expected numbers separated by commas"),
        ("--recording missing.csv", 1, "missing.csv: the table cannot be read"),
        ("--recording page.html", 2, "page.html is also the input"),
        ("--axes half.csv", 1, "half.csv:3: column A1: 'x' is not a number"),
    ],
)
def test_wrong_options_leave_the_page_as_it_was(run: Run, words: str, code: int, message: str) -> None:
    write("page.html", "before")
    write("half.csv", f"{ARM}0,-90,90,0,30,0\nx,-90,90,0,30,0\n")
    outcome = run("inspect", "kr6r900", "--export", "page.html", *words.split())
    assert outcome.code == code
    assert message in outcome.err
    assert Path("page.html").read_text("utf-8") == "before"
    assert {path.name for path in Path().iterdir()} == {"page.html", "half.csv"}
