"""The controller's own budget, from machine data to alarm."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import chainbuild
from chainbuild import frames
from chainbuild.chain.elements import ControllerSolver
from chainbuild.robot import Robot
from tests.kit.robx_files import NR6, chain_of

AXES = np.array([10.0, -60.0, 70.0, 20.0, 40.0, 30.0])


def robot_with(**data: float) -> Robot:
    return chainbuild.Robot(chain_of({**NR6, **data}))


def test_the_budget_comes_from_the_machine_data() -> None:
    chain = chain_of({**NR6, "ITERMAXCOUNT": 12, "ITERPRECISION": 1e-4, "ITERLIMIT": 5, "ITERLIMIT2": 2})
    budget = chain.controller_solver
    assert budget is not None
    assert (budget.max_count, budget.precision, budget.limit_deg, budget.limit2_deg) == (12, 1e-4, 5.0, 2.0)


def test_axis_5_is_watched_by_its_mathematical_angle() -> None:
    data = {**NR6, "MAMES": (0, 90, -90, 0, 25, 0), "AXES_DIR": (1, 1, 1, 1, -1, 1)}
    budget = chain_of(data).controller_solver
    assert budget is not None
    assert budget.hand_angle is not None
    assert budget.hand_angle.value([0.0, 0.0, 0.0, 0.0, 10.0, 0.0]) == pytest.approx(-10.0 - 25.0)


@pytest.mark.parametrize(("name", "has_hand"), [("scara_cc", False), ("arm_nr5", True), ("irb2600_track", True)])
def test_robots_of_four_axes_have_no_axis_5(name: str, has_hand: bool) -> None:
    budget = chainbuild.load(name).chain().controller_solver
    assert budget is not None
    assert (budget.hand_angle is not None) == has_hand


def test_it_counts_from_the_last_position() -> None:
    robot = robot_with()
    target = robot.fk(AXES)
    at_goal = robot.ik(target, AXES, solver="controller")
    assert (at_goal.status, at_goal.iterations) == ("ok", 0)
    near = robot.ik(target, AXES + 3.0, solver="controller")
    assert near.success
    assert 2 <= near.iterations <= 8
    np.testing.assert_allclose(near.axes, AXES, atol=1e-6)


def test_the_count_ends_it() -> None:
    robot = robot_with(ITERMAXCOUNT=3)
    found = robot.ik(robot.fk(AXES), AXES + 25.0, solver="controller")
    assert (found.success, found.status, found.iterations) == (False, "stalled", 3)
    assert "3 iterations" in found.reason
    # What the controller gives up on, the damped solver may well find.
    assert robot.ik(robot.fk(AXES), AXES + 25.0).success


def test_the_precision_ends_it() -> None:
    fine, coarse = robot_with(ITERPRECISION=1e-6), robot_with(ITERPRECISION=10.0)
    target = fine.fk(AXES)
    first, second = (robot.ik(target, AXES + 3.0, solver="controller") for robot in (fine, coarse))
    assert second.success
    assert second.iterations < first.iterations
    assert first.position_error < 1e-9
    assert 1e-6 < second.position_error < 1e-2  # said, and as the machine data ask


def test_a_precision_that_double_numbers_cannot_meet() -> None:
    robot = robot_with(ITERPRECISION=1e-16)
    assert robot.ik(robot.fk(AXES), AXES + 3.0, solver="controller").success


def test_the_alarm_near_a5_at_0() -> None:
    straight = AXES.copy()
    straight[4] = 0.6
    robot = robot_with(ITERLIMIT2=1.0)
    found = robot.ik(robot.fk(straight), straight + 2.0, solver="controller")
    assert (found.success, found.status) == (False, "limits")
    assert "75370, 75371, 75372" in found.reason
    assert "ITERLIMIT2 is 1" in found.reason
    default = robot_with()  # 0: never
    assert default.ik(default.fk(straight), straight + 2.0, solver="controller").success


def test_a_singular_start_is_retracted() -> None:
    robot = robot_with(ITERLIMIT2=1.0, ITERMAXCOUNT=18)
    start = AXES.copy()
    start[4] = 0.0
    found = robot.ik(robot.fk(AXES), start, solver="controller")
    assert found.success
    assert found.axes[4] > 1.0


def test_limits_are_kept() -> None:
    robot = robot_with()
    narrow = Robot(
        robot.chain.with_axes(
            tuple(replace(a, lower=-5.0, upper=5.0) if a.name == "A1" else a for a in robot.chain.axes)
        )
    )
    found = narrow.ik(robot.fk(AXES), np.array([4.0, *AXES[1:]]), solver="controller")
    assert (found.status, found.success) == ("limits", False)
    assert "A1" in found.reason


def test_turns_are_those_nearest_to_the_start() -> None:
    robot = robot_with()
    start = AXES.copy()
    start[5] += 360.0  # no limits are given: ±360 is assumed
    found = robot.ik(robot.fk(AXES), start - 40.0, solver="controller")
    assert found.success
    assert robot.violated_limits(found.axes) == ()


def test_four_axes_follow_c_within_the_budget() -> None:
    robot = chainbuild.Robot.load("palletiser_nr4")
    axes = np.array([20.0, -70.0, 60.0, 10.0])
    T = robot.fk(axes)
    a, b, c = robot.pose_angles(axes)
    asked = frames.transform(frames.matrix_from_angles("orirpy", (a + 20.0, b + 10.0, c)), T.translation)
    found = robot.ik(asked, axes + 1.0, solver="controller")
    assert found.success
    assert 0 < found.iterations <= 8
    np.testing.assert_allclose(found.axes, axes, atol=1e-5)


def test_a_chain_of_its_own() -> None:
    robot = robot_with()
    granted = Robot(replace(robot.chain, controller_solver=ControllerSolver(8, 1e-6, 3.0, 0.0)))
    assert granted.ik(robot.fk(AXES), AXES + 1.0, solver="controller").success
