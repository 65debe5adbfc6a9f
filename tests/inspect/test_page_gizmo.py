"""The page in a browser: its gizmo, the solutions it offers, their ghosts."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from chainbuild.ik.branches.status_turn import status_turn
from chainbuild.inspect.sweep import rest_pose
from chainbuild.robot import Robot
from tests.kit.live_page import LivePage, Lives

PANEL = 392  # pixels to the left of the picture


def pure(picture: NDArray[np.int64], n: int) -> NDArray[np.int64]:
    """Return the places (n, 2), x and y, of what is purely red, green or blue: the gizmo; no body has its colours."""
    others = np.delete(picture, n, axis=2).max(axis=2)
    found: NDArray[np.int64] = np.argwhere((picture[..., n] > 240) & (others < 15))[:, ::-1]
    return found


def arrow(live: LivePage) -> NDArray[np.float64]:
    """Return the place in the window of the upper arrow along z, which is blue."""
    places = pure(live.picture().astype(int), 2)
    assert len(places) > 20
    return np.asarray(places[places[:, 1] < places[:, 1].min() + 12].mean(axis=0))


def ring(live: LivePage) -> NDArray[np.float64]:
    """Return the place on the ring about z, which is blue, that is farthest from the other rings."""
    picture = live.picture().astype(int)
    picture[:, :PANEL] = 0
    places, others = pure(picture, 2), np.vstack([pure(picture, 0), pure(picture, 1)])
    distances = np.linalg.norm(places[:, None] - others[None], axis=2).min(axis=1)
    return np.asarray(places[distances.argmax()], dtype=np.float64)


def dragged(live: LivePage, by: tuple[float, float], place: NDArray[np.float64] | None = None) -> None:
    """Drag the upper arrow along z, or what is at a place, by pixels, in steps."""
    x, y = (arrow(live) if place is None else place).tolist()
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


@pytest.mark.parametrize("space", ["tool", "workpiece"])
def test_a_ring_of_the_gizmo_turns_the_tool_about_itself(space: str, kuka: LivePage) -> None:
    robot = Robot.load("kr6r900")
    kuka.call("set", [20.0, -90.0, 90.0, 10.0, 60.0, 0.0])
    kuka.one("#space").select_option(space)
    frames = kuka.tab.evaluate("window.chainbuild.frames")
    kuka.one("[data-gizmo=rotate]").click()
    kuka.until(f"window.chainbuild.frames > {frames}")
    before = robot.fk(kuka.axes)
    dragged(kuka, (25.0, 3.0), ring(kuka))
    kuka.tab.mouse.up()
    after = robot.fk(kuka.axes)
    kuka.one("[data-gizmo=translate]").click()
    kuka.one("#space").select_option("tool")
    np.testing.assert_allclose(after.translation, before.translation, atol=1e-8)
    turn = before.rotation.T @ after.rotation if space == "tool" else after.rotation @ before.rotation.T
    np.testing.assert_allclose(turn[:, 2], [0.0, 0.0, 1.0], atol=1e-8)
    assert abs(turn[1, 0]) > 0.05


def test_a_table_machine_follows_the_arrow_in_the_workpiece(lives: Lives) -> None:
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


def test_loops_say_where_they_do_not_close(lives: Lives) -> None:
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


def test_status_and_turn_are_those_of_the_package(lives: Lives) -> None:
    robot, live = Robot.load("tx2_60"), lives["tx2_60"]
    lower, upper = (np.array([getattr(axis, end) for axis in robot.axes]) for end in ("lower", "upper"))
    rng = np.random.default_rng(3)
    for _ in range(4):
        live.call("set", lower + (upper - lower) * rng.random(6))
        live.until("document.querySelectorAll('[data-branch]').length > 0")
        status, turn = status_turn(robot, live.axes)
        assert f"IS\u00a0{status} IT\u00a0{turn}" in live.one('[data-branch][aria-pressed="true"]').first.inner_text()
