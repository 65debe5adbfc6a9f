"""Inverse kinematics: every answer verified, inside limits, near the start; failures say why."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from chainbuild.chain.assemble import Element, linear, mark, rotary, shift
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.ik.search.compiled import packing
from chainbuild.robot import Robot
from tests.kit.draws import random_axes
from tests.kit.robots import arm, make_chain, table_machine


def scara() -> Robot:
    elements: list[Element] = [
        rotary("C1", "z"), shift(x=225.0), rotary("C2", "z"), shift(x=175.0), linear("Z", "z"), rotary("C3", "z"),
        mark("flange"), shift(x=12.0, z=-50.0),
    ]  # fmt: skip
    return Robot(make_chain(elements, [], "C1 C2 Z C3"))


def three_axes() -> Robot:
    return Robot(make_chain([linear("X", "x"), linear("Y", "y"), linear("Z", "z")], [], "X Y Z"))


def on_track() -> Robot:
    elements: list[Element] = [
        linear("X1", "x"),
        rotary("A1", "z"),
        rotary("A2", "y"),
        shift(x=455.0),
        rotary("A3", "y"),
    ]
    elements += [shift(x=420.0), rotary("A4", "x"), rotary("A5", "y"), rotary("A6", "x"), shift(x=80.0)]
    return Robot(make_chain(elements, [], "A1 A2 A3 A4 A5 A6 X1", held=("X1",)))


@pytest.mark.parametrize("make", [arm, table_machine, scara, three_axes])
def test_reachable_targets_are_found_inside_limits(make) -> None:
    robot, rng = make(), np.random.default_rng(7)
    for _ in range(300):
        target = robot.fk(random_axes(robot, rng))
        found = robot.ik(target)
        assert found.success and found.status == "ok", found
        reached = robot.fk(found.axes)
        assert np.linalg.norm(reached.translation - target.translation) < 1e-9
        assert np.linalg.norm(reached.rotation[:, 2] - target.rotation[:, 2]) < 1e-9
        if found.task == "pose":
            assert np.abs(reached.rotation - target.rotation).max() < 1e-9
        assert robot.violated_limits(found.axes) == ()
        assert found.position_error < 1e-9


def test_the_answer_stays_near_the_start() -> None:
    robot = arm()
    start = np.array([10.0, -80.0, 70.0, 20.0, 40.0, 300.0])
    found = robot.ik(robot.fk(start + 2.0), start)
    np.testing.assert_allclose(found.axes, start + 2.0, atol=1e-6)
    assert found.restarts == 0


def test_an_array_serves_as_pose() -> None:
    robot = arm()
    target = robot.fk([10.0, -80.0, 70.0, 20.0, 40.0, 30.0])
    np.testing.assert_array_equal(robot.ik(target.homogeneous).axes, robot.ik(target).axes)


def test_the_order_of_bytes_and_their_number_do_not_matter() -> None:
    robot = arm()
    target = robot.fk([10.0, -80.0, 70.0, 20.0, 40.0, 30.0]).homogeneous
    for kind, within in ((">f8", 1e-12), ("f4", 1e-4)):
        given = target.astype(kind)
        np.testing.assert_allclose(robot.ik(given).axes, robot.ik(target).axes, atol=within)
        np.testing.assert_allclose(robot.ik_all(given).axes, robot.ik_all(target).axes, atol=within)
        np.testing.assert_allclose(robot.ik_batch(given[None]).axes[0], robot.ik(target).axes, atol=within)
        np.testing.assert_allclose(robot.ik_all_batch(given[None]), robot.ik_all_batch(target[None]), atol=within)
    with pytest.raises(ChainbuildError, match="rigid"):
        robot.ik_all_batch(2.0 * np.eye(4, dtype=">f8")[None])


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf, 1e300])
@pytest.mark.parametrize("row", [0, 1, 2])
def test_every_coordinate_of_a_place_is_a_number(
    monkeypatch: pytest.MonkeyPatch, row: int, wrong: float, compiled: bool
) -> None:
    if not compiled:
        monkeypatch.setattr(packing, "available", lambda: False)
    for robot in (arm(), table_machine(), scara()):
        T = robot.fk(np.zeros(len(robot.axes))).homogeneous
        T[row, 3] = wrong
        for call in (
            robot.ik,
            robot.ik_all,
            lambda T, r=robot: r.ik_batch([T]),
            lambda T, r=robot: r.ik_all_batch([T]),
        ):
            with pytest.raises(ChainbuildError, match="rigid"):
                call(T)


def test_the_same_call_gives_the_same_answer() -> None:
    robot, rng = arm(), np.random.default_rng(8)
    target = robot.fk(random_axes(robot, rng))
    np.testing.assert_array_equal(robot.ik(target).axes, arm().ik(target).axes)


def test_too_far_is_said_at_once() -> None:
    found = arm().ik(pin.SE3(np.eye(3), np.array([0.5, 0.2, 5.0])))
    assert (found.success, found.status, found.restarts) == (False, "unreachable", 0)
    assert "too far" in found.reason


def test_unreachable_within_the_bound() -> None:
    found = arm().ik(pin.SE3(np.eye(3), np.array([0.0, 0.0, 1.37])))
    assert (found.success, found.status) == (False, "unreachable")
    assert found.position_error > 1e-6


def test_outside_the_limits_is_told_apart_from_unreachable() -> None:
    robot = arm()
    behind = robot.fk([0.0, -80.0, 70.0, 20.0, 40.0, 30.0])
    # A2 at +100°, which the limits forbid, with a forearm that no other branch can replace.
    found = robot.ik(robot.fk([0.0, 100.0, 0.0, 0.0, 30.0, 0.0]))
    assert robot.ik(behind).success
    assert not found.success
    assert found.status == "limits"
    assert "A2" in found.reason or "A3" in found.reason


def test_input_axes_are_held() -> None:
    robot = on_track()
    axes = np.array([10.0, -40.0, 70.0, 20.0, 40.0, 30.0, 250.0])
    target = robot.fk(axes)
    assert robot.task == "pose"
    for held in ({"X1": 250.0}, [250.0]):
        found = robot.ik(target, held=held)
        assert found.success
        assert found.axes[6] == 250.0
    assert robot.ik(target, start=axes + np.array([1, 1, 1, 1, 1, 1, 0])).axes[6] == 250.0
    assert robot.ik(target).axes[6] == 0.0


def test_other_axes_can_be_held_too() -> None:
    robot = arm()
    axes = np.array([10.0, -40.0, 70.0, 20.0, 40.0, 30.0])
    found = robot.ik(robot.fk(axes), start=axes + 3.0, held={"A4": 20.0})
    assert found.success
    np.testing.assert_allclose(found.axes, axes, atol=1e-6)


@pytest.mark.parametrize(
    ("held", "text"),
    [
        ({"A9": 1.0}, "no axis 'A9'"),
        ({"A1": float("nan")}, "axis A1 has the value nan"),
        ([1.0, 2.0], "expected 0 held values, one for each input axis, got 2"),
        (5, "held must be a mapping of axis name to value or a sequence"),
        ("A1", "held must be a mapping of axis name to value or a sequence"),
        ({"A1": "x"}, "A1 is held at 'x'"),
        ({"A1": 1j}, "A1 is held at 1j"),
        ({"A1": 10**400}, "A1 has the value inf"),
        ({"A1": [1.0]}, "A1 is held at"),
    ],
)
def test_bad_held_values_are_refused(held, text) -> None:
    with pytest.raises(AxisValueError, match=text):
        arm().ik(pin.SE3.Identity(), held=held)


def test_bad_start_values_are_refused() -> None:
    with pytest.raises(AxisValueError, match="6 axis values"):
        arm().ik(pin.SE3.Identity(), start=[0.0])


def test_tool_vector_opposite_to_the_start() -> None:
    robot = table_machine()
    target = robot.fk([0.0, 0.0, 0.0, 170.0, 10.0])
    assert robot.ik(target, start=[0.0, 0.0, 0.0, -10.0, 10.0]).success


def test_whole_turns_are_chosen_near_the_start() -> None:
    robot = arm()
    axes = np.array([10.0, -40.0, 70.0, 20.0, 40.0, 330.0])
    assert robot.ik(robot.fk(axes), start=axes - 5.0).axes[5] == pytest.approx(330.0)
    assert robot.ik(robot.fk(axes), start=axes - 5.0 - [0, 0, 0, 0, 0, 300]).axes[5] == pytest.approx(-30.0)


def test_without_a_start_an_axis_that_does_not_matter_stays_at_zero() -> None:
    robot = table_machine()
    home = [0.0, 0.0, 0.0, 12.0, 0.0]  # A = 12° brings the table level: C is free
    found = robot.ik(robot.fk(home))
    np.testing.assert_allclose(found.axes, home, atol=1e-3)  # an upright tool pins C only by its tolerance


def test_answers_keep_the_limits_to_the_last_digit() -> None:
    robot, rng = table_machine(), np.random.default_rng(9)
    lower, upper = (np.array([getattr(axis, end) for axis in robot.axes]) for end in ("lower", "upper"))
    for _ in range(200):
        axes = random_axes(robot, rng)
        at_limit = rng.random(len(axes)) < 0.4
        axes[at_limit] = np.where(rng.random(len(axes)) < 0.5, lower, upper)[at_limit]
        found = robot.ik(robot.fk(axes))
        if found.success:
            assert (found.axes >= lower).all() and (found.axes <= upper).all(), found.axes


def test_a_held_axis_outside_its_limits_is_no_success() -> None:
    robot = arm()
    found = robot.ik(robot.fk([175.0, -90.0, 90.0, 0.0, 30.0, 0.0]), held={"A1": 175.0})
    assert (found.success, found.status) == (False, "limits")
    assert "A1" in found.reason
