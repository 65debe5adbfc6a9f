"""Pictures: formats, views, frames, lengths, traces, and what is refused."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import chainbuild
from chainbuild import AxisValueError, ChainbuildError, FileAccessError, Robot
from chainbuild.painting.marks import Marks
from chainbuild.painting.overlay.placing import caption_box
from chainbuild.painting.overlay.trace import draw_trace
from chainbuild.painting.overlay.triads import draw_triads
from chainbuild.painting.picture import _marks, _panes
from chainbuild.painting.raster.sight import render
from chainbuild.painting.stage import Stage, coordinate, framed, within
from chainbuild.painting.views import BACK, VIEWS, Window

SVG = "{http://www.w3.org/2000/svg}"
VIEWPORT = (960, 720)


@pytest.fixture(scope="module")
def arm() -> Robot:
    return Robot.load("kr6r900")


@pytest.fixture(scope="module")
def mill() -> Robot:
    return Robot.load("ac_table_kin58")


def texts(path: Path) -> list[str]:
    return [text.text or "" for text in ET.parse(path).iter(f"{SVG}text")]


def test_the_suffix_says_the_format(arm: Robot, tmp_path: Path) -> None:
    assert chainbuild.picture(arm, tmp_path / "a.PNG") == tmp_path / "a.PNG"
    with Image.open(tmp_path / "a.PNG") as image:
        assert (image.format, image.size) == ("PNG", VIEWPORT)
    assert (tmp_path / "a.PNG").stat().st_size < 200_000
    root = ET.parse(chainbuild.picture(arm, str(tmp_path / "a.svg"))).getroot()
    assert (root.tag, root.get("width"), root.get("viewBox")) == (f"{SVG}svg", "960", "0 0 9600 7200")


@pytest.mark.parametrize("name", ["a.bmp", "a", "a.svg.gz", ".svg"])
def test_other_suffixes_are_refused(arm: Robot, tmp_path: Path, name: str) -> None:
    with pytest.raises(ChainbuildError, match=r"says no kind of picture; permitted: \.svg, \.png"):
        chainbuild.picture(arm, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_what_is_wrong_is_said(arm: Robot, tmp_path: Path) -> None:
    path = tmp_path / "a.svg"
    with pytest.raises(ChainbuildError, match="no view 'back'; permitted: iso, front, top, right, sheet"):
        chainbuild.picture(arm, path, view="back")  # type: ignore[arg-type]
    for axes in ([0, np.nan, 0, 0, 0, 0], [0, 0], "abcdef"):
        with pytest.raises(AxisValueError):
            chainbuild.picture(arm, path, axes)
        with pytest.raises(AxisValueError):
            chainbuild.picture(arm, path, path_axes=[axes] if axes != "abcdef" else axes)
    with pytest.raises(AxisValueError, match="no rows"):
        chainbuild.picture(arm, path, path_axes=np.zeros((0, 6)))
    with pytest.raises(FileAccessError):
        chainbuild.picture(arm, tmp_path / "no" / "a.svg")
    with pytest.raises(FileAccessError):
        chainbuild.picture(arm, 5)  # type: ignore[arg-type]
    assert list(tmp_path.iterdir()) == []


def test_axes_move_the_machine_and_home_is_inside_the_limits(arm: Robot) -> None:
    home = Stage(arm)
    assert home.axes.tolist() == [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    assert home.frame("tool")[:3, 3] == pytest.approx(arm.fk(home.axes).translation, abs=1e-6)
    moved = Stage(arm, [20, -80, 70, 10, 40, 30])
    assert moved.frame("tool")[:3, 3] == pytest.approx(arm.fk(moved.axes).translation, abs=1e-6)
    lifted = Robot.load("tripod_kin12")
    low, high = (np.array([getattr(axis, end) for axis in lifted.axes]) for end in ("lower", "upper"))
    axes = Stage(lifted).axes
    assert ((axes >= low) & (axes <= high)).all()


@pytest.mark.parametrize("name", ["ac_table_kin58", "cac_table_kin64", "irb2600_table"])
def test_the_workpiece_stands_upright(name: str) -> None:
    robot = Robot.load(name)
    stage = Stage(robot)
    T = stage.frame("workpiece")
    assert T[:3, 2] == pytest.approx([0, 0, 1], abs=1e-8)
    found = T[:3, :3] @ robot.fk(stage.axes).translation + T[:3, 3]
    assert stage.frame("tool")[:3, 3] == pytest.approx(found, abs=3e-6)


def test_sheets_have_four_views_to_one_scale(mill: Robot, tmp_path: Path) -> None:
    root = ET.parse(chainbuild.picture(mill, tmp_path / "a.svg", view="sheet")).getroot()
    assert (root.get("width"), root.get("height")) == ("1280", "960")
    assert texts(tmp_path / "a.svg") == ["top", "iso", "front", "right"]
    names = [one.get("id") for one in root.iter() if one.get("id")]
    assert len(set(names)) == len(names)
    with Image.open(chainbuild.picture(mill, tmp_path / "a.png", view="sheet")) as image:
        pixels = np.asarray(image)
    assert (tmp_path / "a.png").stat().st_size < 200_000
    drawn = (pixels < 240).any(axis=2)
    drawn[:40, :120] = drawn[480:520, :120] = drawn[480:520, 640:760] = False  # the captions
    top, front, right = drawn[:480, :640], drawn[480:, :640], drawn[480:, 640:]
    # Above each other as wide, beside each other as high; what is deep from above is wide from the right.
    columns = [np.flatnonzero(part.any(axis=0))[[0, -1]] for part in (top, front)]
    rows = [np.flatnonzero(part.any(axis=1))[[0, -1]] for part in (front, right)]
    assert columns[0] == pytest.approx(columns[1], abs=1)
    assert rows[0] == pytest.approx(rows[1], abs=1)
    assert np.ptp(np.flatnonzero(top.any(axis=1))) == pytest.approx(np.ptp(np.flatnonzero(right.any(axis=0))), abs=2)


def test_frames_have_names_and_share_them(arm: Robot, mill: Robot, tmp_path: Path) -> None:
    chainbuild.picture(arm, tmp_path / "a.svg", frames=True)
    assert sorted(texts(tmp_path / "a.svg")) == ["base = workpiece", "flange = tool"]
    chainbuild.picture(mill, tmp_path / "a.svg", frames=True)
    assert sorted(texts(tmp_path / "a.svg")) == ["base", "flange = tool", "workpiece"]


def test_frames_in_one_place_are_drawn_once(arm: Robot, mill: Robot) -> None:
    for robot, count in ((arm, 2), (mill, 3)):
        marks = Marks()
        draw_triads(marks, Stage(robot), VIEWS["iso"], Window(-1.0, 2.0, 300.0, 900, 900))
        assert sum(stroke.halo for stroke in marks.strokes) == 3 * count


def test_corners_of_a_trace_that_cannot_be_told_apart_are_left_out() -> None:
    points = np.array([[0, 0, 0], [0, 0, 0.001], [0.001, 0, 0], [0.5, 0, 0.0], [0.5, 0, 0.5]])
    marks = Marks()
    draw_trace(marks, points, VIEWS["front"], Window(-1.0, 1.0, 100.0, 200, 200))
    assert marks.strokes[0].spots == ((100.0, 100.0), (150.0, 100.0), (150.0, 50.0))
    assert marks.strokes[1].spots == ((100.0, 100.0),)


def test_triads_point_along_the_axes(arm: Robot) -> None:
    marks = Marks()
    stage = Stage(arm, [0, -90, 90, 0, 0, 0])
    draw_triads(marks, stage, VIEWS["front"], Window(-1.0, 2.0, 300.0, 900, 900))
    arms = [stroke for stroke in marks.strokes if stroke.halo][:3]
    # Of the base: y away from whoever looks, then x to the right and z up, 42 pixels each.
    by_colour = {max(range(3), key=lambda n, c=one.colour: c[n]): one.spots for one in arms}  # type: ignore[misc]
    (x0, y0), (x1, y1) = by_colour[0]
    assert (x1 - x0, y1 - y0) == pytest.approx((42.0, 0.0), abs=1e-6)
    (x0, y0), (x1, y1) = by_colour[2]
    assert (x1 - x0, y1 - y0) == pytest.approx((0.0, -42.0), abs=1e-6)
    assert by_colour[1][0] == pytest.approx(by_colour[1][1])


@pytest.mark.parametrize("name", ["kr6r900", "irb2600_track", "ba_head_c_table_kin82", "robot_tilting_table_kin210"])
def test_labels_never_cover_each_other(name: str) -> None:
    stage = Stage(Robot.load(name))
    panes, size = _panes(stage, "sheet", None, labelled=True)
    marks = _marks(stage, panes, chainbuild.dimensions(chainbuild.load(name)), None, frames=True)
    boxes = [caption_box(caption) for caption in marks.captions]
    assert len(boxes) > 12
    for a, b in combinations(boxes, 2):
        assert not (a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3])
    assert all(0.0 <= a[0] < a[2] <= size[0] and 0.0 <= a[1] < a[3] <= size[1] for a in boxes)


def test_lengths_lie_where_they_are(mill: Robot, tmp_path: Path) -> None:
    machine = chainbuild.load("ac_table_kin58")
    lengths = chainbuild.dimensions(machine)
    chainbuild.picture(mill, tmp_path / "a.svg", view="front", dimensions=lengths)
    assert sorted(texts(tmp_path / "a.svg")) == ["HD1 = 150 mm", "HD6 = −60 mm", "HD9 = −500 mm"]
    paths = [one for one in ET.parse(tmp_path / "a.svg").iter(f"{SVG}path") if one.get("stroke") == "#0d479e"]
    numbers = [re.fullmatch(r"M(\d+) (\d+)l(-?\d+) ?(-?\d+)", one.get("d", "")) for one in paths]
    vertical = sorted(abs(int(found[4])) for found in numbers if found and abs(int(found[3])) < 3)
    scale = vertical[-1] / 500.0
    assert [round(value / scale) for value in vertical[-3:]] == [60, 150, 500]
    chainbuild.picture(mill, tmp_path / "a.svg", view="top", dimensions=lengths)  # all of them along the sight
    assert texts(tmp_path / "a.svg") == []


def test_a_trace_runs_through_the_tool(mill: Robot, tmp_path: Path) -> None:
    rows = np.linspace([0, 0, -100, 0, 0], [200, 100, -150, 20, 90], 30)
    stage = Stage(mill, rows[0])
    trace = stage.trace(rows)
    assert trace[0] == pytest.approx(stage.frame("tool")[:3, 3], abs=3e-6)
    T = stage.frame("workpiece")
    for row, point in zip(rows, trace, strict=True):
        assert T[:3, :3] @ mill.fk(row).translation + T[:3, 3] == pytest.approx(point, abs=1.2e-6)
    one, other = tmp_path / "a.svg", tmp_path / "b.svg"
    chainbuild.picture(mill, one, path_axes=rows)
    chainbuild.picture(mill, other, rows[0], path_axes=rows)
    assert one.read_bytes() == other.read_bytes()
    assert "#c7146b" in one.read_text()
    chainbuild.picture(mill, other, rows[-1], path_axes=rows)
    assert one.read_bytes() != other.read_bytes()


def test_traces_widen_the_picture(arm: Robot) -> None:
    stage = Stage(arm)
    alone = framed(stage.bodies, VIEWS["top"], *VIEWPORT)
    wide = framed(stage.bodies, VIEWS["top"], *VIEWPORT, 36, [(9.0, 0.0, 0.0)])
    assert wide.scale < alone.scale / 3.0


@pytest.mark.parametrize(("name", "view", "parts"), [
    ("ca_head_kin9", "iso", {"tool", "spindle", "cheek"}), ("cross_head_kin5", "back", {"tool", "spindle", "plate"}),
    ("drill_head_kin7", "iso", {"tool", "spindle", "plate"}), ("scara_cc", "iso", {"flange"}),
])  # fmt: skip
def test_a_detail_shows_the_tool_from_where_it_is_seen(name: str, view: str, parts: set[str]) -> None:
    stage = Stage(Robot.load(name))
    (pane,), size = _panes(stage, "detail", None, labelled=False)
    assert pane.view is (BACK if view == "back" else VIEWS["iso"])
    (whole,), _ = _panes(stage, "iso", None, labelled=False)
    assert pane.window.scale > 1.2 * whole.window.scale
    assert parts <= {placed.body.part for placed in stage.tool_end}
    assert not {"bed", "post", "beam", "ram"} & {placed.body.part for placed in stage.tool_end}
    u, v = (coordinate(stage.frame("tool")[:3, 3], side) for side in (pane.view.right, pane.view.up))
    column, row = (u - pane.window.left) * pane.window.scale, (pane.window.top - v) * pane.window.scale
    assert 0.0 < column < size[0]
    assert 0.0 < row < size[1]


def test_where_a_tool_points() -> None:
    for name, wanted in (
        ("ca_head_kin9", (0, 0, -1)),
        ("cross_head_kin5", (0, 1, 0)),
        ("underfloor_head_kin6", (0, 0, 1)),
    ):
        pointing = Stage(Robot.load(name)).pointing
        assert pointing @ np.array(wanted) > 0.5 * np.linalg.norm(pointing)


def test_bodies_beside_a_detail_are_left_out_and_no_others() -> None:
    stage = Stage(Robot.load("delta_kin37"))
    (whole,), _ = _panes(stage, "iso", None, labelled=False)
    assert within(stage.bodies, whole.view, whole.window) == list(stage.bodies)
    (pane,), _ = _panes(stage, "detail", None, labelled=False)
    kept = within(stage.bodies, pane.view, pane.window)
    shown = render(stage.bodies, pane.view, pane.window).bodies
    seen = {stage.bodies[n] for n in np.unique(shown) if n >= 0}
    assert seen <= set(kept)
    assert len(kept) < len(stage.bodies)
    assert (render(kept, pane.view, pane.window).depth == render(stage.bodies, pane.view, pane.window).depth).all()
