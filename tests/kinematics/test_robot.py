"""The robot: Jacobian by differences, inputs refused, names and bounds, the task a chain can do."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from chainbuild.chain.assemble import Element, linear, rotary, shift
from chainbuild.chain.fold import drawn_bounds
from chainbuild.errors import AxisValueError, ChainbuildError, ChainError
from chainbuild.robot import Robot
from tests.kit.draws import random_axes
from tests.kit.robots import arm, make_chain, table_machine


@pytest.mark.parametrize("make", [arm, table_machine])
def test_jacobian_is_the_derivative_of_fk(make) -> None:
    robot, rng, step = make(), np.random.default_rng(3), 1e-6
    for _ in range(50):
        axes = random_axes(robot, rng)
        J = robot.jacobian(axes)
        for n, axis in enumerate(robot.axes):
            change = np.zeros(len(axes))
            change[n] = np.degrees(step) if axis.unit == "deg" else step * 1000.0
            twist = pin.log6(robot.fk(axes - change).actInv(robot.fk(axes + change))).vector / (2.0 * step)
            np.testing.assert_allclose(twist, J[:, n], atol=1e-8)


@pytest.mark.parametrize("make", [arm, table_machine])
def test_axes_and_joint_values_are_inverse(make) -> None:
    robot, rng = make(), np.random.default_rng(4)
    for _ in range(20):
        axes = random_axes(robot, rng)
        np.testing.assert_allclose(robot.axes_from_q(robot.q(axes)), axes, atol=1e-10)


def test_model_has_the_promised_names() -> None:
    robot = arm()
    assert list(robot.model.names)[1:] == ["A1", "A2", "A3", "A4", "A5", "A6"]
    for name in ("base", "flange", "tool", "workpiece"):
        assert robot.model.existFrame(name)
    assert robot.model.nq == robot.model.nv == 6


def test_bounds_are_the_axis_limits_of_a_reversed_axis_with_an_offset() -> None:
    tool: list[Element] = [rotary("A2", "y", sign=-1.0, offset_deg=90.0), shift(x=100.0)]
    robot = Robot(make_chain(tool, [], "A2"))
    lower, upper = robot.model.lowerPositionLimit, robot.model.upperPositionLimit
    np.testing.assert_allclose(np.degrees([lower, upper]), [[-190.0], [45.0]])
    as_drawn = drawn_bounds(robot.chain.joints, lower, upper)
    np.testing.assert_allclose(np.degrees(as_drawn), [[-45.0 + 90.0], [190.0 + 90.0]])


def test_axis_values_are_in_mm_and_degrees() -> None:
    robot = table_machine()
    moved = robot.fk([10.0, 0.0, 0.0, -12.0 + 24.0, 0.0]).translation - robot.fk([0.0, 0.0, 0.0, 12.0, 0.0]).translation
    np.testing.assert_allclose(moved, [0.01, 0.0, 0.0], atol=1e-15)


@pytest.mark.parametrize(
    ("axes", "text"),
    [
        ([0.0] * 5, "6 axis values"),
        ([0.0] * 7, "6 axis values"),
        (0.0, "6 axis values"),
        ([[0.0] * 6], "6 axis values"),
        ([0.0, float("nan"), 0.0, 0.0, 0.0, 0.0], "axis A2 has the value nan"),
        ([0.0, 0.0, float("inf"), 0.0, 0.0, 0.0], "axis A3 has the value inf"),
        ([0.0, 0.0, 0.0, -1e12, 0.0, 0.0], "axis A4"),
        (["a"] * 6, "must be real numbers"),
        (None, "6 axis values|must be real numbers"),
        ([1j] * 6, "must be real numbers"),
        ([10**400] * 6, "must be real numbers"),
        (np.ma.masked_all(6), "must be real numbers"),
        (np.array(["2026-01-01"] * 6, dtype="datetime64[D]"), "must be real numbers"),
        ({}, "6 axis values|must be real numbers"),
    ],
)
def test_bad_axis_values_are_one_error(axes, text) -> None:
    robot = arm()
    for call in (robot.fk, robot.jacobian, robot.q):
        with pytest.raises(AxisValueError, match=text):
            call(axes)


@pytest.mark.parametrize(
    "q", [[0.0] * 5, [0.0, 0.0, float("nan"), 0.0, 0.0, 0.0], "x", ["a"] * 6, {}, None, [[1], [2, 3]]]
)
def test_bad_joint_values_are_one_error(q) -> None:
    with pytest.raises(AxisValueError, match="6 finite joint values"):
        arm().axes_from_q(q)


@pytest.mark.parametrize(
    "T",
    [
        np.eye(3),
        np.diag([1.0, 1.0, -1.0, 1.0]),
        2.0 * np.eye(4),
        np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [5, 0, 0, 1]], dtype=float),
        np.array([[1, 0, 0, 1e300], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], dtype=float),
        np.ma.masked_all((4, 4)),
        np.full((4, 4), np.nan),
        "pose",
    ],
)
def test_a_pose_must_be_rigid(T) -> None:
    with pytest.raises(ChainbuildError, match="a pose must be"):
        arm().ik(T)


def test_tasks_are_chosen_by_what_a_chain_can_do() -> None:
    assert arm().task == "pose"
    assert table_machine().task == "direction"
    three: list[Element] = [linear("X", "x"), linear("Y", "y"), linear("Z", "z")]
    assert Robot(make_chain(three, [], "X Y Z")).task == "position"
    scara: list[Element] = [
        rotary("C1", "z"),
        shift(x=225.0),
        rotary("C2", "z"),
        shift(x=175.0),
        linear("Z", "z"),
        rotary("C3", "z"),
    ]
    assert Robot(make_chain(scara, [], "C1 C2 Z C3")).task == "pose"


def test_violated_limits_are_named() -> None:
    robot = arm()
    assert robot.violated_limits([170.0, 45.0, 0.0, 0.0, 0.0, 0.0]) == ()
    assert robot.violated_limits([170.1, 0.0, -121.0, 0.0, 0.0, 0.0]) == ("A1", "A3")


def test_a_chain_that_contradicts_itself_is_refused() -> None:
    tool: list[Element] = [rotary("A1", "z"), shift(x=1.0), rotary("A1", "z")]
    with pytest.raises(ChainError, match="occurs 2 times"):
        Robot(make_chain(tool, [], "A1"))
    with pytest.raises(ChainError, match="driven by axis A9"):
        make_chain([rotary("A1", "z", drive={"A9": 1.0})], [], "A1")
    with pytest.raises(ChainError, match="axis map is singular"):
        make_chain([rotary("A1", "z")], [], "A1 A2")
