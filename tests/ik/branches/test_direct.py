"""The direct solution of every machine with three linear axes: exact, all solutions, singular poses named."""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest

from chainbuild import frames
from chainbuild.chain.assemble import Element, linear, rotary, shift
from chainbuild.ik.branches.direct import linear_axes_for
from chainbuild.robot import Robot
from tests.kit.compare import same_turns
from tests.kit.kin_robots import ALL, NOT_DIRECT, poses, robot_of
from tests.kit.robots import arm, make_chain, table_machine

# KIN_TYP → number of solutions of a generic pose.
TWO = (1, 2, 9, 10, 11, 16, 22, 23, 25, 28, 33, 52, 57, 58, 59, 60, 61, 63, 64, 76, 80, 81, 82)
ONE = (3, 4, 5, 6, 7, 8, 17, 18, 30, 34, 207)


def check(kin: int, count: int, seed: int) -> None:
    robot = robot_of(kin)
    expected = 2 if kin in TWO else 1
    for axes in poses(robot, count, seed):
        target = robot.fk(axes)
        found = robot.ik_all(target, start=axes + 0.1)
        assert len(found) == expected
        assert any(same_turns(robot, branch.axes, axes) for branch in found)
        for branch in found:
            reached = robot.fk(branch.axes)
            assert branch.success
            assert robot.violated_limits(branch.axes) == ()
            assert np.abs(reached.translation - target.translation).max() < 1e-9
            assert np.abs(reached.rotation[:, 2] - target.rotation[:, 2]).max() < 1e-9
            if robot.task == "pose":
                assert np.abs(reached.rotation - target.rotation).max() < 1e-9


@pytest.mark.parametrize("kin", TWO + ONE)
def test_every_solution_is_found_and_none_is_wrong(kin: int) -> None:
    check(kin, 25, seed=1)


@pytest.mark.slow
@pytest.mark.parametrize("kin", TWO + ONE)
def test_two_thousand_poses(kin: int) -> None:
    check(kin, 2000, seed=2)


def test_the_lists_above_are_complete() -> None:
    assert {kin for kin in ALL if kin not in (70, 98)} == {*TWO, *ONE, *NOT_DIRECT}


@pytest.mark.parametrize("kin", NOT_DIRECT)
def test_other_types_are_told_apart(kin: int) -> None:
    assert robot_of(kin).plan().name != "direct"


def test_a_virtual_axis_stays_at_the_start() -> None:
    robot = robot_of(70)
    for axes in poses(robot, 60):
        found = robot.ik_all(robot.fk(axes), start=axes)
        assert found
        assert all(branch.axes[5] == pytest.approx(axes[5], abs=1e-9) for branch in found)
        assert np.abs(found[0].axes - axes).max() < 1e-6


def head() -> Robot:
    elements: list[Element] = [
        linear("X", "x"), linear("Y", "y"), linear("Z", "z"),
        rotary("C", "z"), shift(x=30.0, y=10.0), rotary("A", "x"), shift(z=-150.0),
    ]  # fmt: skip
    return Robot(make_chain(elements, [], "X Y Z C A"))


def test_the_direction_pair_of_the_manual() -> None:
    # KIN_TYP manual 1.4: C0 A45 and C180 A-45 point the tool the same way.
    robot = head()
    found = robot.ik_all(robot.fk([0.0, 0.0, 0.0, 0.0, 45.0]), start=np.zeros(5))
    pairs = {(round(abs(b.axes[3])), round(b.axes[4])) for b in found}
    assert pairs == {(0, 45), (180, -45)}


@pytest.mark.parametrize("c", [0.0, 77.0, -160.0])
def test_at_the_pole_the_c_axis_is_free_and_keeps_its_start(c: float) -> None:
    robot = head()
    (found,) = robot.ik_all(robot.fk([100.0, -20.0, 5.0, 33.0, 0.0]), start=[0.0, 0.0, 0.0, c, 10.0])
    assert found.free_axes == ("C",)
    assert found.axes[3] == pytest.approx(c, abs=1e-12)
    assert found.axes[4] == pytest.approx(0.0, abs=1e-12)
    assert found.position_error < 1e-12


def test_near_the_pole_both_solutions_are_exact() -> None:
    robot = head()
    for tilt in (1e-3, 1e-6, 1e-8):
        target = robot.fk([1.0, 2.0, 3.0, 40.0, math.degrees(tilt)])
        for found in robot.ik_all(target, start=np.zeros(5)):
            assert found.position_error < 1e-9
            assert found.rotation_error < 1e-9


def test_a_free_spatial_angle_keeps_its_axis_value() -> None:
    robot = robot_of(59)
    axes = np.array([10.0, 20.0, 30.0, 50.0, 0.0])
    target = robot.fk(axes)
    start = np.array([0.0, 0.0, 0.0, -35.0, 20.0])
    found = robot.ik_all(target, start=start)
    if found[0].free_axes:
        assert found[0].axes[3] == pytest.approx(-35.0)
    assert found[0].position_error < 1e-9


def test_rotary_axes_given_linear_axes_follow() -> None:
    robot = table_machine()
    axes = np.array([100.0, -50.0, 30.0, 40.0, -70.0])
    place = robot.fk(axes).translation
    found = linear_axes_for(robot, place, [0.0, 0.0, 0.0, 40.0, -70.0])
    assert found.success
    np.testing.assert_allclose(found.axes, axes, atol=1e-9)
    far = linear_axes_for(robot, place + [2.0, 0.0, 0.0], axes)
    assert (far.success, far.status) == (False, "limits")
    assert far.reason.startswith("reached only outside the limits of ")


def test_held_rotary_axes() -> None:
    robot = table_machine()
    axes = np.array([100.0, -50.0, 30.0, 40.0, -70.0])
    (found,) = robot.ik_all(robot.fk(axes), held={"A": 40.0, "C": -70.0})
    np.testing.assert_allclose(found.axes, axes, atol=1e-9)
    (one,) = robot.ik_all(robot.fk(axes), held={"A": 40.0})
    np.testing.assert_allclose(one.axes, axes, atol=1e-9)
    assert len(robot.ik_all(robot.fk(axes), held={"A": 39.0})) == 0


def test_whole_turns_within_the_limits() -> None:
    robot = robot_of(58)  # no limits given: rotary axes ±360°
    axes = poses(robot, 1)[0]
    near = robot.ik_all(robot.fk(axes), start=axes)
    every = robot.ik_all(robot.fk(axes), start=axes, windings=True)
    assert len(near) == 2
    assert len(every) == 8
    np.testing.assert_allclose(every[0].axes, near[0].axes, atol=1e-9)  # compiled and plain code round differently
    distances = [np.linalg.norm((b.axes - axes) * robot.kinematics.si_factors) for b in every]
    assert distances == sorted(distances)


def test_whole_turns_behind_a_gear() -> None:
    # KIN_TYP 28: the second motor's axis turns with the first, so no whole turn of C is one of the head.
    robot = robot_of(28)
    axes = poses(robot, 3)[2]
    every = robot.ik_all(robot.fk(axes), start=axes, windings=True)
    assert len(every) > 2
    for branch in every:
        assert branch.position_error < 1e-9
        assert robot.violated_limits(branch.axes) == ()
    assert np.abs(every[0].axes - axes).max() < 1e-6


def gantry() -> Robot:
    elements: list[Element] = [
        linear("X", "x"), linear("Y", "y"), linear("Z", "z"), rotary("A4", "z"), shift(x=40.0),
        rotary("A5", (0.0, 0.6, 0.8)), shift(z=-30.0), rotary("A6", (0.6, 0.0, -0.8)), shift(y=25.0, z=-100.0),
    ]  # fmt: skip
    return Robot(make_chain(elements, [], "X Y Z A4 A5 A6"))


def test_a_full_pose_with_three_inclined_rotary_axes() -> None:
    robot, rng = gantry(), np.random.default_rng(5)
    assert robot.task == "pose"
    for _ in range(50):
        axes = rng.uniform(-1.0, 1.0, 6) * [300.0, 300.0, 300.0, 115.0, 115.0, 115.0]
        found = robot.ik_all(robot.fk(axes), start=axes)
        assert 1 <= len(found) <= 2
        assert np.abs(found[0].axes - axes).max() < 1e-6


def test_the_wrist_singularity_of_a_gantry_keeps_a4() -> None:
    elements: list[Element] = [
        linear("X", "x"), linear("Y", "y"), linear("Z", "z"), rotary("A4", "x"), rotary("A5", "y"), rotary("A6", "x"),
        shift(x=70.0),
    ]  # fmt: skip
    robot = Robot(make_chain(elements, [], "X Y Z A4 A5 A6"))
    (found,) = robot.ik_all(robot.fk([1, 2, 3, 20, 0, 30]), start=[0, 0, 0, 12, 1, 0])
    assert found.free_axes == ("A4",)
    np.testing.assert_allclose(found.axes, [1, 2, 3, 12, 0, 38], atol=1e-9)


def test_an_unreachable_direction_has_no_solution() -> None:
    robot = robot_of(59)  # leans at most twice its tilt of 48 degrees
    down = pin.SE3(frames.rot_x(180.0) @ robot.fk(np.zeros(5)).rotation, np.zeros(3))
    assert len(robot.ik_all(down)) == 0


def test_a_skew_linear_axis_is_solved_too() -> None:
    elements: list[Element] = [
        linear("X", "x"), linear("Y", (0.6, 0.8, 0.0)), linear("Z", (0.0, 0.6, 0.8)),
        rotary("C", "z"), rotary("A", "x"), shift(z=-80.0),
    ]  # fmt: skip
    robot = Robot(make_chain(elements, [], "X Y Z C A"))
    axes = np.array([30.0, -40.0, 50.0, 60.0, 35.0])
    assert np.abs(robot.ik_all(robot.fk(axes), start=axes)[0].axes - axes).max() < 1e-9


def test_an_arm_is_not_direct() -> None:
    assert arm().plan().name != "direct"
    assert table_machine().plan().name == "direct"
