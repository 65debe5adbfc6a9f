"""The damped solver: options, weights, coupled limits, and why a pose was refused."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild.chain.assemble import Element, rotary, shift
from chainbuild.chain.sums import AxisConstraint, AxisSum
from chainbuild.errors import ChainbuildError
from chainbuild.ik.region import freedoms_of
from chainbuild.ik.request import DEFAULT, IkOptions
from chainbuild.robot import Robot
from tests.kit.draws import random_axes
from tests.kit.robots import arm, make_chain, table_machine

BOTH = pytest.mark.parametrize("compiled", [True, False], ids=["compiled", "plain"])
POSE = (10.0, -80.0, 70.0, 20.0, 40.0, 30.0)


def limited_arm(lower: float, upper: float) -> Robot:
    """Return the arm with a limit on A2 + A3, as a parallelogram has."""
    limit = AxisConstraint("elbow angle", AxisSum((0.0, 1.0, 1.0, 0.0, 0.0, 0.0), 0.0), lower, upper, 75329)
    return Robot(replace(arm().chain, constraints=(limit,)))


@BOTH
def test_coupled_limits_are_kept(compiled: bool) -> None:
    robot, rng, options = limited_arm(-40.0, 60.0), np.random.default_rng(4), IkOptions(compiled=compiled)
    found = outside = 0
    for _ in range(60):
        axes = random_axes(robot, rng)
        result = robot.ik(robot.fk(axes), solver="damped", options=options)
        inside = not robot.violated_limits(axes)
        outside += not inside
        assert result.success or not inside, "a pose with an answer inside was refused"
        if result.success:
            found += 1
            assert robot.violated_limits(result.axes) == ()
    assert found > 20
    assert outside > 20


@BOTH
def test_the_refusal_names_the_coupled_limit(compiled: bool) -> None:
    robot = limited_arm(100.0, 101.0)
    axes = np.array(POSE)
    result = robot.ik(robot.fk(axes), axes, solver="damped", options=IkOptions(compiled=compiled))
    assert result.status == "limits"
    assert "elbow angle (alarm 75329)" in result.reason
    assert robot.violated_limits(result.axes) == ()  # the nearest pose is one the machine may take


@BOTH
def test_the_refusal_names_axis_value_and_limit(compiled: bool) -> None:
    robot = arm()
    result = robot.ik(
        robot.fk([0.0, 100.0, 0.0, 0.0, 30.0, 0.0]), solver="damped", options=IkOptions(compiled=compiled)
    )
    assert result.status == "limits"
    assert "A2 at" in result.reason or "A3 at" in result.reason
    assert "(limit " in result.reason
    assert robot.violated_limits(result.axes) == ()
    assert result.position_error > 0.0


@BOTH
def test_too_far_and_too_near(compiled: bool) -> None:
    # Two links of 400 and 300 mm in a plane: they reach from 100 to 700 mm.
    elements: list[Element] = [rotary("A1", "z"), shift(x=400.0), rotary("A2", "z"), shift(x=300.0), rotary("A3", "z")]
    robot, options = Robot(make_chain(elements, [], "A1 A2 A3")), IkOptions(compiled=compiled)
    near = robot.ik(pin.SE3(np.eye(3), np.array([0.05, 0.0, 0.0])), options=options)
    assert near.status == "unreachable"
    assert near.reason.startswith("too near: the tool ends 50.0")
    beyond = robot.ik(pin.SE3(np.eye(3), np.array([2.0, 0.0, 0.0])), options=options)
    assert beyond.reason == "too far: 2000.0 mm from the workpiece frame, the kinematic reaches 700.0 mm"
    np.testing.assert_allclose(beyond.position_error, 1.3, atol=1e-3)
    assert beyond.restarts == 0, "no other start can reach it"
    far = arm().ik(pin.SE3(np.eye(3), np.array([1.3, 0.0, 0.4])), solver="damped", options=options)
    assert far.status == "unreachable"
    assert far.reason.startswith("too far: the tool ends ")
    assert 0.25 < far.position_error < 0.35


@BOTH
def test_an_impossible_orientation_is_told_from_an_impossible_position(compiled: bool) -> None:
    robot = arm()
    T = robot.fk([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])  # stretched out
    T.rotation = T.rotation @ pin.exp3(np.array([0.0, 2.0, 0.0]))
    result = robot.ik(T, solver="damped", options=IkOptions(compiled=compiled))
    assert result.status in {"unreachable", "limits"}
    T.translation *= 0.97
    result = robot.ik(T, solver="damped", options=IkOptions(compiled=compiled))
    assert result.status == "unreachable"
    assert "the position can be reached, but not with this orientation" in result.reason


@BOTH
def test_a_weight_of_0_frees_a_direction(compiled: bool) -> None:
    robot, axes = arm(), np.array(POSE)
    T = robot.fk(axes)
    wanted = pin.SE3(T.rotation @ pin.exp3(np.array([0.0, 0.0, 2.5])), T.translation)
    free_spin = IkOptions(weights=(1.0, 1.0, 1.0, 1.0, 1.0, 0.0), compiled=compiled)
    result = robot.ik(wanted, axes, options=free_spin)
    assert result.success
    np.testing.assert_allclose(result.axes, axes, atol=1e-5)  # the start serves: only the turn about z differs
    anywhere = IkOptions(weights=(1.0, 1.0, 1.0, 0.0, 0.0, 0.0), compiled=compiled)
    result = robot.ik(pin.SE3(np.eye(3), T.translation), axes, options=anywhere)
    assert result.success
    np.testing.assert_allclose(robot.fk(result.axes).translation, T.translation, atol=1e-6)
    along_x = IkOptions(weights=(0.0, 1.0, 1.0, 1.0, 1.0, 1.0), compiled=compiled)
    result = robot.ik(T * pin.SE3(np.eye(3), np.array([0.02, 0.0, 0.0])), axes, options=along_x)
    assert result.success
    np.testing.assert_allclose(result.axes, axes, atol=1e-5)


@BOTH
def test_weights_decide_what_counts_where_not_all_can_be_met(compiled: bool) -> None:
    robot = arm()
    T = robot.fk([0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    T = pin.SE3(T.rotation @ pin.exp3(np.array([0.0, 1.0, 0.0])), T.translation * 0.99)
    place = robot.ik(T, options=IkOptions(weights=(100.0,) * 3 + (1.0,) * 3, compiled=compiled))
    turn = robot.ik(T, options=IkOptions(weights=(1.0,) * 3 + (100.0,) * 3, compiled=compiled))
    assert not place.success
    assert not turn.success
    assert place.position_error < turn.position_error
    assert place.rotation_error > turn.rotation_error


@BOTH
def test_looser_tolerances_take_no_more_steps(compiled: bool) -> None:
    robot, rng = arm(), np.random.default_rng(6)
    for _ in range(20):
        T = robot.fk(random_axes(robot, rng))
        tight = robot.ik(T, options=IkOptions(compiled=compiled))
        loose = robot.ik(T, options=IkOptions(position_tolerance=1e-3, rotation_tolerance=1e-3, compiled=compiled))
        assert loose.success
        assert loose.position_error <= 1e-3
        assert loose.iterations <= tight.iterations


@BOTH
def test_the_seed_decides_the_starts_and_nothing_else_does(compiled: bool) -> None:
    robot, T = arm(), arm().fk(POSE)
    answers = [robot.ik(T, options=IkOptions(seed=seed, compiled=compiled)) for seed in (1, 1, 2)]
    np.testing.assert_array_equal(answers[0].axes, answers[1].axes)
    assert all(answer.success for answer in answers)


@BOTH
def test_a_budget_of_one_start(compiled: bool) -> None:
    robot, rng = arm(), np.random.default_rng(2)
    options = IkOptions(max_restarts=0, compiled=compiled)
    results = [robot.ik(robot.fk(random_axes(robot, rng)), solver="damped", options=options) for _ in range(40)]
    assert all(result.restarts == 0 for result in results)
    assert 20 < sum(result.success for result in results) < 40


@pytest.mark.parametrize(
    "bad",
    [
        {"position_tolerance": 0.0},
        {"rotation_tolerance": float("nan")},
        {"weights": (1.0,) * 5},
        {"weights": (-1.0,) + (1.0,) * 5},
        {"weights": (1.0, 1.0, 1.0, 1.0, 0.0, 0.0)},
        {"weights": (0.0,) * 6},
        {"max_restarts": -1},
    ],
)
def test_bad_options_are_refused(bad: dict[str, object]) -> None:
    with pytest.raises(ChainbuildError) as caught:
        IkOptions(**bad)
    assert caught.value.parameter in bad


@BOTH
def test_a_tool_vector_along_x(compiled: bool) -> None:
    robot = chainbuild.Robot.load("arm_nr5")
    assert (robot.task, robot.chain.tool_axis) == ("direction", "x")
    rng = np.random.default_rng(1)
    for _ in range(30):
        T = robot.fk(random_axes(robot, rng))
        result = robot.ik(T, options=IkOptions(compiled=compiled))
        assert result.success
        np.testing.assert_allclose(robot.fk(result.axes).rotation[:, 0], T.rotation[:, 0], atol=1e-6)


def test_whole_turns_and_limits_of_a_box() -> None:
    box = freedoms_of(arm()).box
    y = np.radians([190.0, 0.0, 0.0, 0.0, 0.0, 400.0])
    np.testing.assert_allclose(np.degrees(box.into(y)), [-170.0, 0.0, 0.0, 0.0, 0.0, 40.0], atol=1e-9)
    assert box.outside(y) == [0, 5]
    assert box.excess(np.radians([175.0, 0.0, 0.0, 0.0, 0.0, 0.0])) == pytest.approx(np.radians(5.0))
    near = box.nearest(np.zeros(6), np.radians([0.0, 0.0, 0.0, 300.0, 0.0, 330.0]))
    np.testing.assert_allclose(np.degrees(near), [0.0] * 6, atol=1e-9)  # 360 is beyond both limits
    near = box.nearest(np.radians([0.0] * 5 + [-20.0]), np.radians([0.0] * 5 + [330.0]))
    assert np.degrees(near[5]) == pytest.approx(340.0)


def test_starts_that_hold_other_values_of_input_axes() -> None:
    robot = chainbuild.Robot.load("irb2600_track")
    held = np.array([axis.held for axis in robot.axes])
    rng = np.random.default_rng(3)
    for place in rng.uniform(0.0, 1000.0, 25):  # more problems than are kept
        axes = np.where(held, place, 20.0)
        found = robot.ik(robot.fk(axes), start=axes + np.where(held, 0.0, 3.0))
        assert found.success
        np.testing.assert_allclose(found.axes, axes, atol=1e-6)


def test_machines_with_tables_are_reached_from_anywhere() -> None:
    robot, rng = table_machine(), np.random.default_rng(9)
    targets = robot.fk_batch([random_axes(robot, rng) for _ in range(500)])
    assert robot.ik_batch(targets).success.all()


@pytest.mark.parametrize("options", [DEFAULT, IkOptions(compiled=False)], ids=["compiled", "plain"])
def test_one_free_axis_is_enough(options: IkOptions) -> None:
    robot = chainbuild.Robot.load("kr6r900")
    axes = [10.0, -80.0, 70.0, 20.0, 40.0, 30.0]
    for free in range(6):
        held = {axis.name: value for n, (axis, value) in enumerate(zip(robot.axes, axes, strict=True)) if n != free}
        found = robot.ik(robot.fk(axes), held=held, options=options)
        assert found.success
        np.testing.assert_allclose(found.axes, axes, atol=1e-6)
        elsewhere = robot.fk([value + (n != free) for n, value in enumerate(axes)])
        assert not robot.ik(elsewhere, held=held, options=options).success
        assert [b.axes == pytest.approx(axes, abs=1e-6) for b in robot.ik_all(robot.fk(axes), held=held)] == [True]


@pytest.mark.parametrize("options", [DEFAULT, IkOptions(compiled=False)], ids=["compiled", "plain"])
def test_one_weight_is_enough(options: IkOptions) -> None:
    robot = chainbuild.Robot.load("kr6r900")
    T = robot.fk([10.0, -80.0, 70.0, 20.0, 40.0, 30.0])
    height = replace(options, weights=(0.0, 0.0, 1.0, 0.0, 0.0, 0.0))
    found = robot.ik(T, [0.0, -90.0, 90.0, 0.0, 10.0, 0.0], options=height)
    assert found.success
    assert abs(robot.fk(found.axes).actInv(T).translation[2]) < 1e-6


@BOTH
def test_beyond_the_ends_of_linear_axes_no_other_start_is_tried(compiled: bool) -> None:
    robot, options = table_machine(), IkOptions(compiled=compiled)
    T = robot.fk(np.zeros(len(robot.axes)))
    T.translation[0] += 2.0 * robot.kinematics.reach
    found = robot.ik(T, solver="damped", options=options)
    assert (found.success, found.restarts) == (False, 0)
    batch = robot.ik_batch([T] * 4, options=options)
    assert not batch.counts[:, 2].any()
