"""The page in a browser: its panel, its keys, its gizmo, its solutions, its looks."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser

from chainbuild.ik.branches.status_turn import status_turn
from chainbuild.inspect.export import export_page
from chainbuild.inspect.scene import labelled_frames
from chainbuild.inspect.sweep import rest_pose
from chainbuild.robot import Robot
from tests.kit.drawn_robots import arm
from tests.kit.live_page import LivePage, opened


class _Lives(dict[str, LivePage]):
    """Open pages by machine; each is written and opened once."""

    def __init__(self, browser: Browser, folder: Path, stack: ExitStack) -> None:
        super().__init__()
        self.browser, self.folder, self.stack = browser, folder, stack

    def page(self, name: str) -> Path:
        return export_page(Robot.load(name), self.folder / f"{name}.html")

    def __missing__(self, name: str) -> LivePage:
        self[name] = self.stack.enter_context(opened(self.browser, self.page(name)))
        return self[name]


@pytest.fixture(scope="module")
def lives(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[_Lives]:
    with ExitStack() as stack:
        yield _Lives(browser, tmp_path_factory.mktemp("pages"), stack)


@pytest.fixture
def kuka(lives: _Lives) -> LivePage:
    return lives["kr6r900"]


def behind(robot: Robot, n: int) -> set[str]:
    """Return the links that axis n moves: those behind the joints that it drives."""
    slopes = robot.chain.axis_map.A[:, n]  # type: ignore[attr-defined]
    moved = {joint.child for joint, slope in zip(robot.chain.joints, slopes, strict=True) if slope}
    for joint in robot.chain.joints:
        if joint.parent in moved:
            moved.add(joint.child)
    return moved


@pytest.mark.parametrize("name", ["kr6r900", "ac_table_kin58", "irb2600_table"])
def test_every_slider_moves_the_links_behind_its_axis_and_nothing_else(name: str, lives: _Lives) -> None:
    robot, live = Robot.load(name), lives[name]
    links = [link.name for link in robot.chain.links]
    before = live.drawn(links)
    for n, axis in enumerate(robot.axes):
        at = live.axes
        slider = f'input[type=range][data-axis="{axis.name}"]'
        low, high = (float(live.one(slider).get_attribute(end) or "nan") for end in ("min", "max"))
        wanted = low + 0.3 * (high - low)
        live.set_input(slider, wanted)
        after = live.axes
        assert after[n] == pytest.approx(wanted, abs=1e-9)
        np.testing.assert_array_equal(np.delete(after, n), np.delete(at, n))
        drawn, expected, moving = live.drawn(links), robot.frame_placements(after), behind(robot, n)
        for k, link in enumerate(links):
            np.testing.assert_allclose(drawn[k], expected[link].homogeneous, atol=1e-6)
            assert (np.abs(drawn[k] - before[k]).max() > 1e-6) == (link in moving), link
        before = drawn


def test_a_typed_axis_moves_there_and_beyond_its_limits_is_told(kuka: LivePage) -> None:
    kuka.call("set", [0.0, -90.0, 90.0, 0.0, 45.0, 0.0])
    kuka.one('input[type=number][data-axis="A2"]').fill("-77.12345678")
    assert kuka.axes[1] == -77.12345678
    assert kuka.status() == "ok"
    kuka.one('input[type=number][data-axis="A2"]').fill("60")
    assert kuka.axes[1] == 60.0
    assert kuka.status() == "limits"
    assert "A2" in kuka.one("[data-status]").inner_text()
    assert kuka.tab.evaluate("[...document.querySelectorAll('.axis.outside .name')].map((n) => n.textContent)") == [
        "A2"
    ]
    kuka.one('input[type=number][data-axis="A2"]').fill("")
    assert kuka.axes[1] == 60.0
    kuka.one('input[type=number][data-axis="A2"]').fill("-90")
    assert kuka.status() == "ok"
    kuka.one('input[type=number][data-axis="A2"]').blur()
    assert kuka.one('input[type=number][data-axis="A2"]').input_value() == "-90.000"


def test_a_pose_is_typed_column_by_column(kuka: LivePage) -> None:
    robot = Robot.load("kr6r900")
    start, goal = [10.0, -80.0, 70.0, 5.0, 50.0, 20.0], [-30.0, -60.0, 95.0, -15.0, 30.0, 44.0]
    kuka.call("set", start)
    shown = kuka.shown()
    for column, value in robot.display(start).items():
        assert shown[column] == pytest.approx(value, abs=1e-9)
    for column, value in robot.display(goal).items():
        kuka.one(f'[data-pose="{column}"]').fill(repr(float(value)))
    assert kuka.status() == "ok"
    np.testing.assert_allclose(robot.fk(kuka.axes).homogeneous, robot.fk(goal).homogeneous, atol=1e-8)
    kuka.one('[data-pose="x_mm"]').fill("5000")
    assert kuka.status() == "unreachable"
    kuka.one('[data-pose="x_mm"]').fill(repr(float(robot.display(goal)["x_mm"])))
    assert kuka.status() == "ok"
    np.testing.assert_allclose(robot.fk(kuka.axes).homogeneous, robot.fk(goal).homogeneous, atol=1e-8)


def arrow(live: LivePage) -> tuple[float, float]:
    """Return the place in the window of the upper blue arrow of the gizmo, along z; no body has its colour."""
    picture = live.picture().astype(int)
    rows, columns = np.nonzero((picture[..., 2] > 240) & (picture[..., :2].max(axis=2) < 15))
    assert len(rows) > 20
    near = rows < rows.min() + 12
    return float(columns[near].mean()), float(rows[near].mean())


def dragged(live: LivePage, by: tuple[float, float]) -> None:
    """Drag the upper arrow along z by pixels, in steps."""
    x, y = arrow(live)
    mouse = live.tab.mouse
    mouse.move(x, y)
    live.tab.wait_for_timeout(50)
    mouse.down()
    for share in (0.25, 0.5, 0.75, 1.0):
        mouse.move(x + share * by[0], y + share * by[1])
        live.tab.wait_for_timeout(30)


@pytest.mark.parametrize("space", ["tool", "workpiece"])
def test_an_arrow_of_the_gizmo_moves_the_tool_along_itself(space: str, kuka: LivePage) -> None:
    robot = Robot.load("kr6r900")
    kuka.call("set", [20.0, -90.0, 90.0, 10.0, 60.0, 0.0])
    kuka.one("#space").select_option(space)
    before = robot.fk(kuka.axes)
    camera = kuka.tab.evaluate("window.chainbuild.frames")
    dragged(kuka, (0.0, -40.0))
    during = robot.fk(kuka.axes)
    kuka.tab.mouse.up()
    after = robot.fk(kuka.axes)
    np.testing.assert_allclose(during.homogeneous, after.homogeneous, atol=1e-8)
    np.testing.assert_allclose(after.rotation, before.rotation, atol=1e-8)
    way = after.translation - before.translation
    along = before.rotation[:, 2] if space == "tool" else np.array([0.0, 0.0, 1.0])
    assert abs(way @ along) > 0.02
    np.testing.assert_allclose(way, (way @ along) * along, atol=1e-8)
    assert way[2] > 0  # up, as the mouse went
    assert kuka.status() == "ok"
    assert kuka.tab.evaluate("window.chainbuild.frames") > camera
    kuka.one("#space").select_option("tool")


def test_a_table_machine_follows_the_arrow_in_the_workpiece(lives: _Lives) -> None:
    robot, live = Robot.load("ac_table_kin58"), lives["ac_table_kin58"]
    live.call("set", rest_pose(robot))
    before = robot.fk(live.axes)
    dragged(live, (0.0, -30.0))
    live.tab.mouse.up()
    way = robot.fk(live.axes).translation - before.translation
    along = before.rotation[:, 2]
    assert way @ along > 0.005
    np.testing.assert_allclose(way, (way @ along) * along, atol=1e-8)


def test_solutions_are_offered_and_chosen(kuka: LivePage) -> None:
    robot = Robot.load("kr6r900")
    kuka.call("set", [10.0, -80.0, 70.0, 15.0, 50.0, 20.0])
    T = robot.fk(kuka.axes)
    wanted = robot.ik_all(T, kuka.axes)
    count = len(wanted)
    kuka.until(f"document.querySelectorAll('[data-branch]').length === {count}")
    assert kuka.one('[data-branch="0"]').get_attribute("aria-pressed") == "true"
    names = [kuka.one(f'[data-branch="{k}"]').inner_text() for k in range(count)]
    kuka.one('[data-branch="1"]').click()
    np.testing.assert_allclose(robot.fk(kuka.axes).homogeneous, T.homogeneous, atol=1e-8)
    assert kuka.axes[3] != pytest.approx(15.0, abs=1.0)
    assert f"A4\u00a0{kuka.axes[3]:.1f}".replace("-", "\u2212") in names[1]
    assert kuka.one("[data-branch]").count() == count
    assert kuka.one('[data-branch="1"]').get_attribute("aria-pressed") == "true"
    kuka.one('[data-branch="0"]').click()
    np.testing.assert_allclose(kuka.axes, [10.0, -80.0, 70.0, 15.0, 50.0, 20.0], atol=1e-6)


def test_a_ghost_becomes_strong_where_its_solution_is_looked_at(kuka: LivePage) -> None:
    kuka.call("set", [10.0, -80.0, 70.0, 15.0, 50.0, 20.0])
    kuka.until("document.querySelectorAll('[data-branch]').length > 1")
    kuka.tab.mouse.move(900, 700)
    kuka.one("#theme").focus()
    kuka.tab.wait_for_timeout(200)
    faint = kuka.picture()[60:, 400:].astype(int)
    kuka.one('[data-branch="1"]').focus()
    kuka.tab.wait_for_timeout(200)
    strong = kuka.picture()[60:, 400:].astype(int)
    assert (np.abs(faint - strong).max(axis=2) > 20).sum() > 200


def test_named_poses_are_buttons(kuka: LivePage) -> None:
    kuka.call("set", [1.0] * 6)
    assert kuka.one('[data-preset="zero"]').get_attribute("aria-pressed") == "false"
    kuka.one('[data-preset="zero"]').click()
    np.testing.assert_array_equal(kuka.axes, np.zeros(6))
    assert kuka.one('[data-preset="zero"]').get_attribute("aria-pressed") == "true"


def test_arrow_keys_choose_and_step_an_axis(kuka: LivePage) -> None:
    kuka.call("set", [0.0, -90.0, 90.0, 0.0, 45.0, 0.0])
    kuka.one('input[type=range][data-axis="A2"]').focus()
    press = kuka.tab.keyboard.press
    press("ArrowRight")
    assert kuka.axes[1] == -89.0
    press("Shift+ArrowLeft")
    assert kuka.axes[1] == -99.0
    press("ArrowDown")
    press("ArrowRight")
    np.testing.assert_array_equal(kuka.axes, [0.0, -99.0, 91.0, 0.0, 45.0, 0.0])
    kuka.one("#axes select").select_option("0.1")
    kuka.one('input[type=range][data-axis="A5"]').focus()
    press("ArrowRight")
    assert kuka.axes[4] == 45.1
    kuka.one("#axes select").select_option("1")
    kuka.call("set", [0.0, -90.0, 90.0, 0.0, 119.5, 0.0])
    press("ArrowUp")
    press("ArrowDown")
    press("ArrowRight")
    assert kuka.axes[4] == 120.0  # no farther than the limit
    at = kuka.axes
    kuka.one('[data-pose="x_mm"]').focus()
    press("ArrowLeft")
    # A slider of another section keeps its keys.
    kuka.tab.evaluate(
        "const other = document.createElement('input'); other.type = 'range'; other.id = 'other';"
        " document.querySelector('#panel').append(other); other.focus();"
    )
    press("ArrowRight")
    assert kuka.one("#other").input_value() == "51"
    kuka.tab.evaluate("document.querySelector('#other').remove()")
    np.testing.assert_array_equal(kuka.axes, at)


def test_the_address_keeps_the_pose(browser: Browser, lives: _Lives) -> None:
    wanted = [10.0, -80.5, 70.25, 15.0, 50.0, 20.125]
    fragment = "#axes=" + ",".join(map(str, wanted))
    with opened(browser, lives.page("kr6r900"), fragment) as live:
        np.testing.assert_array_equal(live.axes, wanted)
        live.call("set", [0.0, -90.0, 90.0, 0.0, 45.0, 0.5])
        live.until("window.location.hash === '#axes=0,-90,90,0,45,0.5'")
        live.tab.evaluate("window.location.hash = '#axes=1,-90,90,0,45,2'")
        live.until("window.chainbuild.axes()[5] === 2")
        for bad in ("#axes=1,2", "#axes=1,2,3,4,5,x", "#axes=1,2,3,4,5,", "#axes=1,2,3,4,5,1e999", "#other"):
            live.tab.evaluate(f"window.location.hash = {bad!r}")
            live.tab.wait_for_timeout(20)
            assert live.axes[5] == 2.0


def test_the_singular_value_has_a_bar_and_a_sentence(kuka: LivePage) -> None:
    kuka.call("set", [0.0, -90.0, 90.0, 0.0, 45.0, 0.0])
    free = kuka.one("[data-singular]")
    assert float(free.get_attribute("data-singular") or "nan") > 0.05
    green = kuka.tab.evaluate("getComputedStyle(document.querySelector('.level')).backgroundColor")
    kuka.call("set", [0.0, -90.0, 90.0, 0.0, 0.0, 0.0])
    assert float(free.get_attribute("data-singular") or "nan") < 1e-9
    assert "A4 and A6 run away" in free.inner_text()
    red = kuka.tab.evaluate("getComputedStyle(document.querySelector('.level')).backgroundColor")
    assert red == "rgb(208, 52, 44)"
    assert green != red


def test_sums_of_axes_have_bars(lives: _Lives) -> None:
    robot, live = Robot.load("parallelogram_nr"), lives["parallelogram_nr"]
    (limit,) = robot.chain.constraints
    assert live.one("[data-bar] .name").inner_text() == limit.label
    value = limit.sum.offset + np.dot(limit.sum.coefficients, live.axes)
    assert live.one("[data-bar] output").inner_text() == f"{value:.3f}°"
    assert live.one("[data-bar]").get_attribute("class") == "bar"
    live.call("set", [0.0, 0.0, -15.0, 0.0, 0.0, 0.0])
    assert live.one("[data-bar]").get_attribute("class") == "bar outside"
    assert limit.name in live.one("[data-status]").inner_text()


@pytest.mark.parametrize("name", ["kr6r900", "parallelogram_nr"])
def test_nothing_is_wider_than_the_window(name: str, lives: _Lives) -> None:
    live = lives[name]
    live.call("set", rest_pose(Robot.load(name)))
    cut = (
        "[...document.querySelectorAll('input, button, select')].filter((e) => e.offsetWidth).filter((e) => {"
        " const b = e.getBoundingClientRect(); return b.left < 0 || b.right > window.innerWidth; }).length"
    )
    for width, height in ((390, 844), (1280, 720)):
        live.tab.set_viewport_size({"width": width, "height": height})
        live.tab.wait_for_timeout(150)
        assert live.overflow() <= 0
        assert live.tab.evaluate(cut) == 0
        under = live.tab.evaluate("const t = document.querySelector('#tools'); t.offsetTop + t.offsetHeight")
        assert all(box[1] >= under for box in live.tab.evaluate(BOXES))
        if width == 390:
            seen = live.picture()[:380].astype(int)
            assert ((seen[..., 0] > 130) & (seen[..., 0] - seen[..., 2] > 80)).sum() > 500


def test_dark_follows_the_system_and_the_switch(browser: Browser, lives: _Lives) -> None:
    paper = "getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number)[0]"
    with opened(browser, lives.page("kr6r900"), scheme="dark") as live:
        assert live.tab.evaluate(paper) < 60
        assert live.picture()[:, 392:].mean() < 110
        live.one("#theme").click()
        assert live.tab.evaluate(paper) > 200
        assert live.picture()[:, 392:].mean() > 150


def test_every_field_has_a_name_and_a_unit(kuka: LivePage) -> None:
    names = kuka.tab.evaluate(
        "[...document.querySelectorAll('#panel, #tools')].flatMap((root) => [...root.querySelectorAll('input, select,"
        " button')]).map((e) => [e.type, e.ariaLabel || e.textContent ||"
        " (e.labels[0] || {}).textContent || ''])"
    )
    assert all(name.strip() for _, name in names)
    fields = [name for kind, name in names if kind in ("number", "range")]
    assert len(fields) == 18
    assert all("degrees" in name or "millimetres" in name for name in fields)


@pytest.mark.parametrize("name", ["kr6r900", "ac_table_kin58"])
def test_labels_stand_beside_what_they_name(name: str, lives: _Lives) -> None:
    robot, live = Robot.load(name), lives[name]
    texts = live.one("#labels span").all_inner_texts()
    assert texts == [text for text, _ in labelled_frames(robot.chain)]
    for change in (0.0, 12.0, -25.0):
        frames = live.tab.evaluate("window.chainbuild.frames")
        live.call("set", rest_pose(robot) + change)
        live.until(f"window.chainbuild.frames > {frames}")
        boxes = np.array(live.tab.evaluate(BOXES))
        origins = np.array(live.tab.evaluate(ORIGINS))
        for x, y, width, height in boxes:
            inside = (
                (origins[:, 0] > x) & (origins[:, 0] < x + width) & (origins[:, 1] > y) & (origins[:, 1] < y + height)
            )
            assert not inside.any()
        low, high = boxes[:, None, :2], (boxes[:, :2] + boxes[:, 2:])[:, None]
        apart = ((high <= low.swapaxes(0, 1)) | (low >= high.swapaxes(0, 1))).any(axis=2)
        assert apart[~np.eye(len(boxes), dtype=bool)].all()
    live.one("[data-show=frames]").uncheck()
    live.until("document.querySelector('#labels').hidden")
    live.one("[data-show=frames]").check()
    live.until("!document.querySelector('#labels').hidden")


BOXES = (
    "[...document.querySelectorAll('#labels span')].filter((e) => !e.hidden)"
    ".map((e) => { const b = e.getBoundingClientRect(); return"
    " [b.x, b.y, b.width, b.height]; })"
)
# Where the lines begin that lead from a frame to its name.
ORIGINS = (
    "[...document.querySelectorAll('#labels i')].filter((e) => !e.hidden)"
    ".map((e) => { const m = new DOMMatrix(getComputedStyle(e).transform);"
    " const b = document.querySelector('#labels').getBoundingClientRect(); return [m.e + b.x, m.f + b.y]; })"
)


def test_a_page_at_rest_draws_nothing(kuka: LivePage) -> None:
    kuka.call("set", [0.0, -90.0, 90.0, 0.0, 45.0, 0.0])
    kuka.until("document.querySelectorAll('[data-branch]').length > 0")
    kuka.tab.wait_for_timeout(800)  # longer than until the fine picture
    frames = kuka.tab.evaluate("window.chainbuild.frames")
    kuka.tab.wait_for_timeout(250)
    assert kuka.tab.evaluate("window.chainbuild.frames") == frames
    kuka.call("set", [0.0, -90.0, 90.0, 0.0, 46.0, 0.0])
    kuka.until(f"window.chainbuild.frames > {frames}")


def test_loops_say_where_they_do_not_close(lives: _Lives) -> None:
    robot, live = Robot.load("delta_kin37"), lives["delta_kin37"]
    links = [link.name for link in robot.chain.links]
    assert live.one("[data-gizmo=rotate]").is_hidden()  # the tool keeps its direction
    live.set_input('input[type=range][data-axis="J1"]', 20.0)
    expected = robot.frame_placements(live.axes)
    drawn = live.drawn(links)
    for k, link in enumerate(links):
        np.testing.assert_allclose(drawn[k], expected[link].homogeneous, atol=1e-6)
    live.call("set", [180.0, 0.0, 0.0])
    assert live.status() == "unreachable"
    np.testing.assert_allclose(live.drawn(links), drawn, atol=1e-9)
    # There is no tool to move.
    live.set_input('[data-pose="x_mm"]', 10.0)
    dragged(live, (0.0, -30.0))
    live.tab.mouse.up()
    np.testing.assert_array_equal(live.axes, [180.0, 0.0, 0.0])


def test_bodies_and_frames_are_hidden_on_request(kuka: LivePage) -> None:
    def warm() -> int:
        picture = kuka.picture()[60:, 400:].astype(int)
        return int(((picture[..., 0] > 130) & (picture[..., 0] - picture[..., 2] > 80)).sum())

    seen = warm()
    kuka.one("[data-show=bodies]").uncheck()
    kuka.tab.wait_for_timeout(200)
    assert warm() < 0.1 * seen
    kuka.one("[data-show=bodies]").check()
    kuka.tab.wait_for_timeout(200)
    assert warm() == pytest.approx(seen, rel=0.05)


def test_hostile_names_stay_text(browser: Browser, tmp_path: Path) -> None:
    nasty = '"><img src=x onerror="document.title=1">'
    chain = arm().chain
    axes = (replace(chain.axes[0], name=nasty), *chain.axes[1:])
    page = export_page(Robot(replace(chain, title=nasty, axes=axes)), tmp_path / "page.html")
    with opened(browser, page) as live:
        assert live.one("#panel img").count() == 0
        assert live.one(".axis .name").first.inner_text() == nasty
        assert live.one("input[type=range]").first.get_attribute("data-axis") == nasty
        live.call("set", [999.0] * 6)
        assert nasty in live.one("[data-status]").inner_text()
        assert live.one("#panel img").count() == 0


def test_status_and_turn_are_those_of_the_package(lives: _Lives) -> None:
    robot, live = Robot.load("tx2_60"), lives["tx2_60"]
    lower, upper = (np.array([getattr(axis, end) for axis in robot.axes]) for end in ("lower", "upper"))
    rng = np.random.default_rng(3)
    for _ in range(4):
        live.call("set", lower + (upper - lower) * rng.random(6))
        live.until("document.querySelectorAll('[data-branch]').length > 0")
        status, turn = status_turn(robot, live.axes)
        assert f"IS\u00a0{status} IT\u00a0{turn}" in live.one('[data-branch][aria-pressed="true"]').first.inner_text()
