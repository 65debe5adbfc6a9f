"""The page in a browser: its panel, its keys, its address, its looks."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser

import chainbuild
from chainbuild.frames import matrix_from_angles
from chainbuild.inspect.export import export_page
from chainbuild.inspect.scene import labelled_frames
from chainbuild.inspect.sweep import rest_pose
from chainbuild.robot import Robot
from tests.kit.drawn_robots import arm
from tests.kit.live_page import LivePage, Lives, opened


def behind(robot: Robot, n: int) -> set[str]:
    """Return the links that axis n moves: those behind the joints that it drives."""
    slopes = robot.chain.axis_map.A[:, n]  # type: ignore[attr-defined]
    moved = {joint.child for joint, slope in zip(robot.chain.joints, slopes, strict=True) if slope}
    for joint in robot.chain.joints:
        if joint.parent in moved:
            moved.add(joint.child)
    return moved


@pytest.mark.parametrize("name", ["kr6r900", "ac_table_kin58", "irb2600_table"])
def test_every_slider_moves_the_links_behind_its_axis_and_nothing_else(name: str, lives: Lives) -> None:
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


def test_what_is_asked_stays_while_it_is_out_of_reach(kuka: LivePage) -> None:
    robot, begin = Robot.load("kr6r900"), [0.0, -90.0, 90.0, 0.0, 30.0, 0.0]
    kuka.call("set", begin)
    before = kuka.shown()
    kuka.one('[data-pose="x_mm"]').fill("2000")
    kuka.tab.keyboard.press("Tab")
    assert kuka.status() == "unreachable"
    asked = {**before, "x_mm": 2000.0}
    assert kuka.shown() == pytest.approx(asked, abs=1e-9)
    stands = robot.display(kuka.axes)
    assert kuka.one("#pose .stands").inner_text().startswith(f"The tool stands at X\u00a0{stands['x_mm']:.3f} ")
    kuka.one('[data-pose="y_mm"]').fill("100")
    assert kuka.shown() == pytest.approx({**asked, "y_mm": 100.0}, abs=1e-9)
    kuka.tab.keyboard.press("Escape")
    np.testing.assert_array_equal(kuka.axes, begin)
    assert kuka.shown() == pytest.approx(before, abs=1e-9)
    assert kuka.one("#pose .stands").inner_text() == ""


def test_a_turn_at_gimbal_lock_is_the_turn_that_is_typed(kuka: LivePage) -> None:
    begin = [0.0, -90.0, 90.0, 0.0, 0.0, 0.0]
    kuka.call("set", begin)
    assert kuka.shown()["b_deg"] == pytest.approx(90.0)
    turned = {**kuka.shown(), "a_deg": 20.0}
    kuka.one('[data-pose="a_deg"]').fill("20")
    assert kuka.shown() == pytest.approx(turned, abs=1e-9)
    R = Robot.load("kr6r900").fk(kuka.axes).rotation
    angles = [turned[f"{letter}_deg"] for letter in "abc"]
    np.testing.assert_allclose(R, matrix_from_angles("orirpy", angles), atol=1e-8)


def test_a_decimal_comma_is_a_point(kuka: LivePage) -> None:
    kuka.call("set", [0.0, -90.0, 90.0, 0.0, 45.0, 0.0])
    field = kuka.one('input[type=number][data-axis="A1"]')
    field.focus()
    kuka.tab.keyboard.press("Control+A")
    kuka.tab.keyboard.type("12,5")
    assert kuka.axes[0] == 12.5
    paste = (
        "(data) => document.activeElement.dispatchEvent(new InputEvent('beforeinput',"
        " { data, inputType: 'insertFromPaste', cancelable: true, bubbles: true }))"
    )
    for text, value in (("-1.234,5", -1234.5), ("1,234.5", 1234.5), ("1,234,567", 1234567.0), ("12,5 °", 12.5)):
        kuka.tab.keyboard.press("Control+A")
        kuka.tab.evaluate(paste, text)
        assert kuka.axes[0] == value
    kuka.one("#axes select").select_option("0.1")
    field.focus()
    kuka.tab.keyboard.press("ArrowUp")
    assert kuka.axes[0] == pytest.approx(12.6)
    kuka.tab.keyboard.press("Shift+ArrowDown")
    assert kuka.axes[0] == pytest.approx(11.6)
    assert "chosen" in (kuka.one('.axis:has([data-axis="A1"])').get_attribute("class") or "")
    kuka.one("#axes select").select_option("1")


def test_an_address_of_another_machine_is_told(browser: Browser, lives: Lives) -> None:
    with opened(browser, lives.page("kr6r900"), "#axes=1,2,3") as live:
        assert "does not hold 6 axis values" in live.one("[data-status]").inner_text()


def test_drives_that_stand_elsewhere_are_shown(browser: Browser, lives: Lives) -> None:
    robot, axes = Robot.load("rotated_head_kin70"), [100.0, 50.0, -100.0, 58.0, 58.0, 170.0]
    with opened(browser, lives.page("rotated_head_kin70")) as live:
        live.call("set", axes)
        told = [live.one(f'[data-bar="{name}_drive"] output').inner_text() for name in ("B", "A")]
        drives = robot.drives(axes)
        assert told == [f"{drives[n]:.3f}°".replace("-", "\u2212") for n in (3, 4)]


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


def test_the_address_keeps_the_pose(browser: Browser, lives: Lives) -> None:
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
    width = "parseFloat(document.querySelector('.level').style.width)"
    share = 1.0 + np.log10(float(free.get_attribute("data-singular") or "nan")) / 3.0  # of three decades
    assert kuka.tab.evaluate(width) == pytest.approx(100.0 * share, abs=0.01)
    green = kuka.tab.evaluate("getComputedStyle(document.querySelector('.level')).backgroundColor")
    kuka.call("set", [0.0, -90.0, 90.0, 0.0, 0.0, 0.0])
    assert float(free.get_attribute("data-singular") or "nan") < 1e-9
    assert kuka.tab.evaluate(width) == 0.0
    assert "A4 and A6 run away" in free.inner_text()
    red = kuka.tab.evaluate("getComputedStyle(document.querySelector('.level')).backgroundColor")
    assert red == "rgb(208, 52, 44)"
    assert green != red


def test_sums_of_axes_have_bars(lives: Lives) -> None:
    robot, live = Robot.load("parallelogram_nr"), lives["parallelogram_nr"]
    (limit,) = robot.chain.constraints
    assert live.one("[data-bar] .name").inner_text() == limit.label
    value = limit.sum.offset + np.dot(limit.sum.coefficients, live.axes)
    assert live.one("[data-bar] output").inner_text() == f"{value:.3f}°"
    assert live.one("[data-bar]").get_attribute("class") == "bar"
    live.call("set", [0.0, 0.0, -15.0, 0.0, 0.0, 0.0])
    assert live.one("[data-bar]").get_attribute("class") == "bar outside"
    assert limit.name in live.one("[data-status]").inner_text()


def test_long_numbers_are_not_cut_off(kuka: LivePage) -> None:
    kuka.tab.set_viewport_size({"width": 1280, "height": 720})
    cut = (
        "[...document.querySelectorAll('[data-pose$=_mm]')].filter((field) => { const held = field.value;"
        " field.value = '-12345.678'; const wide = field.scrollWidth; field.value = held;"
        " return wide > field.clientWidth; }).length"
    )
    assert kuka.tab.evaluate(cut) == 0


@pytest.mark.parametrize("name", ["kr6r900", "parallelogram_nr"])
def test_nothing_is_wider_than_the_window(name: str, lives: Lives) -> None:
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


def test_an_exported_page_heeds_no_message(kuka: LivePage) -> None:
    before = list(kuka.axes)
    kuka.tab.evaluate("window.came = 0; window.addEventListener('message', () => { window.came += 1; }); 0")
    kuka.tab.evaluate("window.postMessage({ chainbuild: 'axes', axes: [1, 2, 3, 4, 5, 6] }, '*')")
    kuka.tab.wait_for_timeout(60)
    assert list(kuka.axes) == before
    assert kuka.tab.evaluate("window.came") == 1  # and nothing in the page answers it


@pytest.mark.parametrize("size", [(640, 560), (700, 560), (900, 560)])
def test_in_the_cell_of_a_notebook_panel_and_picture_are_side_by_side(lives: Lives, size: tuple[int, int]) -> None:
    live = lives["gantry_robot_kin210"]
    live.call("set", rest_pose(Robot.load("gantry_robot_kin210")))
    live.tab.set_viewport_size({"width": size[0], "height": size[1]})
    live.tab.wait_for_timeout(150)
    places = "['#panel', '#pane'].map((name) => { const b = document.querySelector(name).getBoundingClientRect();"
    panel, pane = live.tab.evaluate(f"{places} return [b.left, b.top, b.right, b.bottom]; }})")
    assert panel[:2] == [0, 0] and panel[2] <= pane[0] and panel[3] == pane[3] == size[1] and pane[1] == 0
    assert pane[2] == size[0] and pane[2] - pane[0] >= 340
    assert live.overflow() <= 0
    fields = "[...document.querySelectorAll('input[type=number]')].filter((e) => e.scrollWidth > e.clientWidth).length"
    assert live.tab.evaluate(fields) == 0  # no number is cut
    wide = "[...document.querySelectorAll('#panel *')].filter((e) => e.getBoundingClientRect().right > %d).length"
    assert live.tab.evaluate(wide % panel[2]) == 0


def test_dark_follows_the_system_and_the_switch(browser: Browser, lives: Lives) -> None:
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
def test_labels_stand_beside_what_they_name(name: str, lives: Lives) -> None:
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
    live.until("[...document.querySelectorAll('#labels span')].every((tag) => tag.hidden)")
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


def test_lengths_of_the_machine_data_are_shown_on_request(browser: Browser, tmp_path: Path) -> None:
    machine = chainbuild.load("bed_mill_kin1")
    found = chainbuild.dimensions(machine)
    robot = Robot(machine.chain())
    page = export_page(robot, tmp_path / "page.html", dimensions=found)
    axes = [100.0, 50.0, -50.0, -30.0, 20.0]
    with opened(browser, page) as live:
        live.call("set", axes)
        labels = live.one("[data-parameter]")
        assert [labels.nth(n).get_attribute("data-parameter") for n in range(labels.count())] == ["HD1", "HD2", "HD9"]
        assert labels.first.is_hidden()
        live.one("[data-show=dimensions]").check()
        live.until("!document.querySelector('[data-parameter]').hidden")
        assert labels.all_inner_texts() == [one.label for one in found]
        drawn = [np.array(live.call("drawnLength", n)) for n in range(len(found))]
    placed = robot.frame_placements(axes)
    for one, ends in zip(found, drawn, strict=True):  # HD1 from the axis of B to the tool, in the head, and so on
        place = placed[one.link]
        np.testing.assert_allclose(ends, [place.act(one.start), place.act(one.end)], rtol=0, atol=1e-6)
        assert np.linalg.norm(place.act(one.end) - place.act(one.start)) == pytest.approx(abs(one.datum.value) / 1000.0)
    with opened(browser, export_page(robot, tmp_path / "page.html")) as live:
        assert live.one("#lengths").is_hidden()


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
