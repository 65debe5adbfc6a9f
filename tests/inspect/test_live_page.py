"""The page with Python behind it: what is done there agrees with Python, in every tab."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser

from chainbuild.collision.model import CollisionModel
from chainbuild.errors import ChainbuildError
from chainbuild.formats.load import load
from chainbuild.inspect.live import hub
from chainbuild.inspect.live.session import Session
from chainbuild.inspect.playback import axes_playback
from chainbuild.machines import shipped_path
from chainbuild.robot import Robot
from tests.kit.live_page import LivePage, opened_at
from tests.kit.live_server import Server
from tests.kit.live_thread import served

DATUM = '[data-parameter="TX3P3_POS[2]"]'
HEIGHT = 120.0  # of TX3P3_POS[2], which is 35 in the file
FOLDED = (10.0, 0.0, 155.0, -55.0, -80.0, -75.0)  # the robot touches itself


class Live:
    """A page, its session and its address."""

    def __init__(self, page: LivePage, session: Session, address: str) -> None:
        self.page, self.session, self.address = page, session, address

    def settled(self) -> None:
        """Wait until Python stands where the page does."""
        until(lambda: np.array_equal(self.session.axes, self.page.axes), self.page)


def until(met: Callable[[], bool], page: LivePage) -> None:
    """Wait, while the page goes on."""
    end = time.monotonic() + 30.0
    while not met():
        assert time.monotonic() < end, page.told
        page.tab.wait_for_timeout(10)


@pytest.fixture(scope="module")
def live(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    """Return a live page of an arm, with another beside it and a table to play back."""
    table = tmp_path_factory.mktemp("table") / "path.csv"
    table.write_text("A1,A2,A3,A4,A5,A6\n0,-90,90,0,30,0\n50,-90,90,0,30,0\n")
    playback = axes_playback(Robot.load("kr6r900"), table)
    session = Session(load("kr6r900"), beside=Robot.load("irb2600"), at=[0, -90, 90, 0, 30, 0], playback=playback)
    with served(session) as address, opened_at(browser, address, address.split("?", maxsplit=1)[0]) as page:
        page.until("document.documentElement.dataset.link === 'open'")
        yield Live(page, session, address)


@pytest.fixture
def arm(live: Live) -> Live:
    """Return the page of the arm with the data of the file."""
    live.page.call("set", [0, -90, 90, 0, 30, 0])
    live.settled()
    if live.session.values:
        until(lambda: restored(live), live.page)
        live.page.until(f"document.querySelector('{DATUM}').dataset.value === '35'")
    return live


def restored(live: Live) -> bool:
    """Return whether the data are those of the file again; a click is lost where the panel is drawn anew under it."""
    if live.session.values:
        live.page.one("#parameters .reset").click()
        live.page.tab.wait_for_timeout(500)
    return not live.session.values


def changed_file(tmp_path: Path) -> Robot:
    """Return the robot of a file in which the datum has been edited."""
    text = shipped_path("kr6r900").read_text("latin-1")
    assert text.count("TX3P3_POS[2]=35.0") == 1
    edited = tmp_path / "edited.tea"
    edited.write_text(text.replace("TX3P3_POS[2]=35.0", f"TX3P3_POS[2]={HEIGHT}"), "latin-1")
    return Robot.load(edited)


def test_slider_typed_pose_and_drag_agree_with_python(arm: Live) -> None:
    page, robot = arm.page, Robot.load("kr6r900")
    page.set_input("input[type=range][data-axis=A3]", 77.125)
    arm.settled()
    assert arm.session.axes.tolist() == [0, -90, 77.125, 0, 30, 0]

    page.set_input("input[type=number][data-pose=x_mm]", 510.5)
    arm.settled()
    assert page.status() == "ok"
    assert robot.fk(arm.session.axes).translation[0] == pytest.approx(0.5105, abs=1e-9)

    wanted = robot.fk([10, -80, 95, 20, 40, 15])
    page.call("set", [9, -81, 96, 19, 41, 14])
    page.call("drag", wanted.homogeneous.ravel())
    arm.settled()
    np.testing.assert_allclose(robot.fk(arm.session.axes).homogeneous, wanted.homogeneous, rtol=0, atol=1e-9)
    own = np.array(page.call("fk", arm.session.axes)).reshape(4, 4)
    np.testing.assert_allclose(own, robot.fk(arm.session.axes).homogeneous, rtol=0, atol=1e-12)


def test_the_branches_are_those_of_python(arm: Live, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = Robot.load("kr6r900")
    axes = [10, -80, 95, 20, 40, 15]
    every = robot.ik_all(robot.fk(axes), axes)
    assert len(every) > 2
    own = Robot.ik_all
    monkeypatch.setattr(Robot, "ik_all", lambda *given, **named: list(own(*given, **named))[:-1])
    arm.page.call("set", axes)
    arm.page.until(f"document.querySelectorAll('[data-branch]').length === {len(every) - 1}")
    monkeypatch.undo()
    arm.page.call("set", axes)
    arm.page.until(f"document.querySelectorAll('[data-branch]').length === {len(every)}")
    for k, expected in enumerate(every):
        arm.page.one(f"[data-branch='{k}']").click()
        off = (arm.page.axes - expected.axes + 180.0) % 360.0 - 180.0  # half a turn away either way is as near
        np.testing.assert_allclose(off, 0.0, rtol=0, atol=1e-9)
    listed = "[...document.querySelectorAll('[data-branch]')].map((one) => one.textContent)"
    before = arm.page.tab.evaluate(listed)
    arm.page.tab.wait_for_timeout(600)  # longer than the page rests before it asks
    assert arm.page.tab.evaluate(listed) == before


def test_a_changed_datum_moves_what_the_edited_file_moves(arm: Live, tmp_path: Path) -> None:
    page, file, edited = arm.page, Robot.load("kr6r900"), changed_file(tmp_path)
    assert page.call("drawnFurther", "file", "A6_link") is None
    assert "TX3P3_POS[2]=35.0" in page.one(f".datum:has({DATUM}) code").inner_text()
    assert page.one(f".datum:has({DATUM}) .where").inner_text() == "kr6r900.tea:27"

    page.one(DATUM).fill(str(HEIGHT))
    until(lambda: arm.session.values == {"TX3P3_POS[2]": HEIGHT}, page)
    page.until("window.chainbuild.drawnFurther('file', 'A6_link') !== null")

    rng = np.random.default_rng(3)
    for axes in rng.uniform(-60, 60, (20, 6)):
        own = np.array(page.call("fk", axes)).reshape(4, 4)
        np.testing.assert_allclose(own, edited.fk(axes).homogeneous, rtol=0, atol=1e-12)
    axes = [20, -70, 60, 30, 40, 50]
    page.call("set", axes)
    links = [link.name for link in edited.chain.links][1:]
    np.testing.assert_allclose(page.drawn(links), placed(edited, axes, links), rtol=0, atol=1e-6)
    ghost = [page.call("drawnFurther", "file", link) for link in links]
    np.testing.assert_allclose(np.reshape(ghost, (-1, 4, 4)), placed(file, axes, links), rtol=0, atol=1e-6)

    row = page.one(".further:has([data-further=file])")
    shift = np.array([float(part) for part in (row.get_attribute("data-shift") or "").split(",")])
    expected = 1000 * (edited.fk(axes).translation - file.fk(axes).translation)
    np.testing.assert_allclose(shift, expected, rtol=0, atol=1e-9)
    assert np.linalg.norm(expected) == pytest.approx(HEIGHT - 35.0)
    assert float(row.get_attribute("data-turn") or "nan") == pytest.approx(0, abs=1e-6)


def placed(robot: Robot, axes: list[float], links: list[str]) -> np.ndarray:
    """Return the placements of links in the base by Pinocchio: each joint moves the link of its name."""
    import pinocchio as pin

    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, robot.q(axes))
    joints = {joint.child: robot.model.getJointId(joint.name) for joint in robot.chain.joints}
    return np.array([data.oMi[joints[link]].homogeneous for link in links])


def test_what_a_datum_moves_is_lit_and_told(arm: Live) -> None:
    page = arm.page
    page.one(DATUM).focus()
    page.until("window.chainbuild.lit.moved.length === 3")
    assert page.tab.evaluate("window.chainbuild.lit.moved") == ["A4_link", "A5_link", "A6_link"]
    told = page.one("#parameters .detail").inner_text()
    assert "A4_link, A5_link, A6_link" in told
    assert "by (0.000, 0.000, 1.000) mm" in told  # A2 = -90 and A3 = 90: the forearm is level
    page.one("#parameters input[type=search]").focus()
    page.one("#fit").focus()
    assert page.tab.evaluate("window.chainbuild.lit.moved") == []


def test_a_refused_value_is_told_where_it_was_typed(arm: Live) -> None:
    page = arm.page
    page.one(DATUM).fill("2e9")
    page.until(f"document.querySelector('.datum.wrong {DATUM}') !== null")
    assert "below 1e+09" in page.one(f".datum:has({DATUM}) .told").inner_text()
    assert arm.session.values == {}
    page.one(DATUM).fill("36")
    until(lambda: arm.session.values == {"TX3P3_POS[2]": 36.0}, page)
    page.until("document.querySelector('.datum.wrong') === null")


def test_a_datum_is_typed_as_people_type(arm: Live) -> None:
    page, keyboard = arm.page, arm.page.tab.keyboard
    height = "document.querySelector('#parameters').offsetHeight"
    before = page.tab.evaluate(height)
    page.tab.evaluate(f"document.querySelector('{DATUM}').focus({{ preventScroll: true }})")
    page.until("window.chainbuild.lit.moved.length === 3")
    assert page.tab.evaluate(height) == before  # what is told of a datum has its place

    page.one(DATUM).select_text()
    keyboard.type("12,5")
    until(lambda: arm.session.values == {"TX3P3_POS[2]": 12.5}, page)
    page.until(f"document.querySelector('{DATUM}').dataset.value === '12.5'")
    page.one(DATUM).select_text()
    keyboard.type("-")
    assert page.one(f".datum:has({DATUM}) .told").inner_text() == "Not a number: 12.5 holds."
    keyboard.press("Escape")
    until(lambda: not arm.session.values, page)
    assert page.one(DATUM).input_value() == "35"
    page.until("document.querySelector('#parameters .reset').disabled")

    both = (
        "(selector) => { const field = document.querySelector(selector); for (const text of ['12', '']) {"
        " field.value = text; field.dispatchEvent(new Event('input', { bubbles: true })); } }"
    )
    page.tab.evaluate(both, DATUM)
    until(lambda: arm.session.values == {"TX3P3_POS[2]": 12.0}, page)
    page.until(f"document.querySelector('{DATUM}').dataset.value === '12'")
    keyboard.type("7")  # what Python has answered meanwhile is not put in front of it
    until(lambda: arm.session.values == {"TX3P3_POS[2]": 7.0}, page)


def test_arrow_keys_in_the_field_to_find_data_move_no_axis(arm: Live) -> None:
    before = arm.page.axes
    arm.page.one("#parameters input[type=search]").focus()
    for key in ("ArrowLeft", "ArrowUp", "ArrowRight", "ArrowRight"):
        arm.page.tab.keyboard.press(key)
    np.testing.assert_array_equal(arm.page.axes, before)
    assert arm.page.tab.evaluate("document.activeElement.type") == "search"


def test_a_table_is_played_on_while_data_are_changed(arm: Live) -> None:
    page = arm.page
    page.one("[data-speed]").select_option("0.5")
    page.one("[data-play]").click()
    page.one(DATUM).fill("60")
    page.until("window.chainbuild.drawnFurther('file', 'A6_link') !== null")
    assert page.one("[data-play]").inner_text() == "Pause"
    assert page.one("[data-row]").inner_text() == "1"
    page.one("[data-play]").click()


def test_collisions_are_those_of_collide(arm: Live) -> None:
    page, model = arm.page, CollisionModel(Robot.load("kr6r900"))
    page.until("document.querySelector('#collisions').dataset.collision === 'false'")
    page.call("set", FOLDED)
    page.until("document.querySelector('#collisions').dataset.collision === 'true'")
    expected = [" – ".join(pair) for pair in model.colliding_pairs(FOLDED)]
    assert expected
    rows = page.tab.evaluate(
        "[...document.querySelectorAll('li[data-collision]')].map((row) => [row.dataset.collision, +row.dataset.mm,"
        " row.classList.contains('outside')])"
    )
    assert sorted(name for name, _, touches in rows if touches) == sorted(expected)
    table = {" – ".join(one.pair): 1000 * one.distance for one in model.distance_table(FOLDED)}
    assert all(mm == pytest.approx(table[name], abs=1e-6) for name, mm, _ in rows)
    links = {link for pair in model.colliding_pairs(FOLDED) for link in pair}
    assert set(page.tab.evaluate("window.chainbuild.lit.touching")) == links


def test_two_tabs_agree(arm: Live, browser: Browser) -> None:
    with opened_at(browser, arm.address, arm.address.split("?", maxsplit=1)[0]) as second:
        second.until("document.documentElement.dataset.link === 'open'")
        second.set_input("input[type=range][data-axis=A1]", 33.5)
        arm.page.until("window.chainbuild.axes()[0] === 33.5")
        arm.page.set_input("input[type=range][data-axis=A2]", -75.25)
        second.until("window.chainbuild.axes()[1] === -75.25")
        arm.page.one(DATUM).fill("77")
        second.until(f"document.querySelector('{DATUM}').dataset.value === '77'")
        second.one(DATUM).fill("78")
        arm.page.until(f"document.querySelector('{DATUM}').value === '78'")  # though it has the focus there
        second.until(f"document.querySelector('{DATUM}').dataset.value === '78'")
        np.testing.assert_array_equal(second.axes, arm.page.axes)
        np.testing.assert_array_equal(second.call("fk", second.axes), arm.page.call("fk", second.axes))
        # Whoever comes later sees the same.
        with opened_at(browser, arm.address, arm.address.split("?", maxsplit=1)[0]) as third:
            np.testing.assert_array_equal(third.axes, second.axes)
            np.testing.assert_array_equal(third.call("fk", third.axes), second.call("fk", third.axes))


def test_the_machine_beside_moves_by_the_axes_of_the_same_names(arm: Live) -> None:
    other = Robot.load("irb2600")
    axes = [20, -30, 40, 30, 40, 50]
    arm.page.call("set", axes)
    links = [link.name for link in other.chain.links][1:]
    ghost = [arm.page.call("drawnFurther", "beside", link) for link in links]
    np.testing.assert_allclose(np.reshape(ghost, (-1, 4, 4)), placed(other, axes, links), rtol=0, atol=1e-6)
    row = arm.page.one(".further:has([data-further=beside])")
    own, there = Robot.load("kr6r900").fk(axes), other.fk(axes)
    shift = [float(part) for part in (row.get_attribute("data-shift") or "").split(",")]
    np.testing.assert_allclose(shift, 1000 * (own.translation - there.translation), rtol=0, atol=1e-9)
    cosine = (np.trace(there.rotation.T @ own.rotation) - 1) / 2
    assert float(row.get_attribute("data-turn") or "nan") == pytest.approx(np.degrees(np.arccos(cosine)), abs=1e-6)
    arm.page.one("#fit").click()  # both are inside the picture: nothing green is cut off at its top
    arm.page.tab.wait_for_timeout(200)
    red, green, _ = arm.page.picture()[0, 400:].astype(int).T
    assert (green - red).max() < 20


def test_a_section_of_the_workspace_is_drawn(arm: Live) -> None:
    page = arm.page
    before = page.picture()
    page.one("[data-section]").select_option("rz")
    page.until("document.querySelector('#workspace').dataset.state === 'shown'")
    page.tab.wait_for_timeout(200)
    after = page.picture()
    pane = page.one("#pane").bounding_box()
    assert pane is not None
    differs = (before != after).any(axis=2)[:, int(pane["x"]) :]
    assert differs.mean() > 0.05
    page.one("[data-section]").select_option("")
    page.until("document.querySelector('#workspace').dataset.state === ''")


def test_why_there_is_no_section_is_told_where_it_would_be(arm: Live, monkeypatch: pytest.MonkeyPatch) -> None:
    def none(*_given: object) -> None:
        raise ChainbuildError("no position within the limits has a pose")

    monkeypatch.setattr(hub, "section", none)
    arm.page.one("[data-section]").select_option("xz")
    arm.page.until("document.querySelector('#workspace').dataset.state === 'refused'")
    assert arm.page.one("#workspace p").inner_text() == "None: no position within the limits has a pose."
    arm.page.one("[data-section]").select_option("")


def test_a_convention_switch_equals_the_other_chain(browser: Browser) -> None:
    machine = load("ba_head_c_table_kin82")
    session = Session(machine)
    others = {"table_rotary_sense": "left_handed"}
    with served(session) as address, opened_at(browser, address, address.split("?", maxsplit=1)[0]) as page:
        page.until("document.querySelector('select[data-convention=table_rotary_sense]') !== null")
        page.one("summary:has-text('Conventions')").click()
        page.one("select[data-convention=table_rotary_sense]").select_option("left_handed")
        until(lambda: session.choices == others, page)
        expected, before = Robot(machine.chain(conventions=others)), Robot(machine.chain())
        axes = np.array([30.0, -20.0, 10.0, 15.0, 25.0, 40.0][: len(expected.axes)])
        page.until("document.querySelector('#conventions').textContent.includes('chosen by you')")
        own = np.array(page.call("fk", axes)).reshape(4, 4)
        np.testing.assert_allclose(own, expected.fk(axes).homogeneous, rtol=0, atol=1e-12)
        assert np.abs(expected.fk(axes).homogeneous - before.fk(axes).homogeneous).max() > 1e-3
        # Data are had beside it.
        page.one("input[data-parameter=HD1]").fill("17.5")
        until(lambda: session.values == {"HD1": 17.5}, page)
        page.until("document.querySelector('input[data-parameter=HD1]').dataset.value === '17.5'")
        own = np.array(page.call("fk", axes)).reshape(4, 4)
        datum = next(one for one in machine.geometry() if one.symbol == "HD1")
        changed = Robot(machine.with_values({datum: 17.5}).chain(conventions=others))
        np.testing.assert_allclose(own, changed.fk(axes).homogeneous, rtol=0, atol=1e-12)


def test_a_dropped_file_takes_the_place_of_the_machine(browser: Browser) -> None:
    session, name = Session(load("ca_head_kin9")), "a_mill_whose_file_has_a_long_name_2026_11_29"
    drop = (
        "([name, text]) => { const data = new DataTransfer(); data.items.add(new File([text], name));"
        " const event = new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true });"
        " document.body.dispatchEvent(event); }"
    )
    with served(session) as address, opened_at(browser, address, address.split("?", maxsplit=1)[0]) as page:
        page.until("document.documentElement.dataset.link === 'open'")
        page.tab.evaluate(drop, ["nothing.tea", "this is no machine data"])
        page.until("document.querySelector('#link').textContent.includes('nothing.tea')")
        page.tab.evaluate(drop, [f"{name}.lis", shipped_path("ac_table_kin58").read_text("latin-1")])
        page.until(f"document.title === '{name}' && !!window.chainbuild")
        cut = "const rows = document.querySelector('#parameters .rows'); rows.scrollWidth > rows.clientWidth"
        assert not page.tab.evaluate(cut)
        expected = Robot.load("ac_table_kin58")
        axes = np.linspace(5.0, 50.0, len(expected.axes))
        own = np.array(page.call("fk", axes)).reshape(4, 4)
        np.testing.assert_allclose(own, expected.fk(axes).homogeneous, rtol=0, atol=1e-12)


def test_another_kinematic_of_the_file_is_chosen(browser: Browser) -> None:
    session = Session(load("gantry_robot_kin210"))
    with served(session) as address, opened_at(browser, address, address.split("?", maxsplit=1)[0]) as page:
        page.until("document.documentElement.dataset.link === 'open'")
        page.one("#kinematic").select_option(label="45 (ROBOT): KIN_TYP 45, channel 0")
        page.until("!!window.chainbuild && window.chainbuild.axes().length === 6")
        expected = Robot.load("gantry_robot_kin210", kinematic=45)
        axes = [10.0, 20.0, 30.0, 40.0, 50.0, 60.0]
        own = np.array(page.call("fk", axes)).reshape(4, 4)
        np.testing.assert_allclose(own, expected.fk(axes).homogeneous, rtol=0, atol=1e-12)


@pytest.mark.slow  # a quarter of a minute of waiting; the server's side of it is in live/test_server.py
def test_a_killed_and_restarted_server_is_met_again(browser: Browser, tmp_path: Path) -> None:
    with Server(tmp_path, "kr6r900", token=None) as first:
        address = first.address
        with opened_at(browser, address, address.split("?", maxsplit=1)[0]) as page:
            page.until("document.documentElement.dataset.link === 'open'")
            page.one(DATUM).fill(str(HEIGHT))
            page.until("window.chainbuild.drawnFurther('file', 'A6_link') !== null")
            page.call("set", [10, -80, 95, 20, 40, 15])
            first.process.kill()
            page.until("document.documentElement.dataset.link === 'lost'")
            page.set_input("input[type=range][data-axis=A1]", 12.5)  # goes on by itself
            resting = f"document.querySelector('{DATUM}').closest('[inert]') !== null"
            assert page.tab.evaluate(resting)  # what only Python can do is not offered
            with Server(tmp_path, "kr6r900", port=first.port, token=None) as second:
                assert second.address == address
                page.until("document.documentElement.dataset.link === 'open'")
                page.told.clear()  # the browser tells on its console that it could not connect
                assert not page.tab.evaluate(resting)
                # A page that comes now is told by Python what the first has kept.
                until(lambda: _seen(browser, address) == ([12.5, -80, 95, 20, 40, 15], "120"), page)


def _seen(browser: Browser, address: str) -> tuple[list[float], str | None]:
    """Return the axis values and the changed datum of a new page."""
    with opened_at(browser, address, address.split("?", maxsplit=1)[0]) as page:
        page.until(f"document.querySelector('{DATUM}') !== null")
        return page.axes.tolist(), page.one(DATUM).get_attribute("data-value")
