"""Preferences of robots with more axes than their task needs, and limits kept by those."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import chainbuild
from chainbuild.errors import ChainbuildError
from chainbuild.ik.policies.redundancy import preferred
from chainbuild.ik.request import IkRequest
from chainbuild.kinematics.inputs import as_pose
from chainbuild.robot import Robot


@pytest.fixture(scope="module")
def robot() -> Robot:
    return chainbuild.Robot.load("robot_xy_unit_kin210")


def random_axes(robot: Robot, rng: np.random.Generator, share: float = 1.0) -> np.ndarray:
    lower = np.array([axis.lower for axis in robot.axes])
    upper = np.array([axis.upper for axis in robot.axes])
    return lower + (upper - lower) * (0.5 + share * (rng.random(len(lower)) - 0.5))


def same_pose(robot: Robot, axes: np.ndarray, T: np.ndarray) -> bool:
    return bool(np.abs(robot.fk(axes).homogeneous - T).max() < 2e-6) and robot.violated_limits(axes) == ()


def shares(robot: Robot, axes: np.ndarray) -> float:
    """Return how far the axes are off the middle of their limits: the sum of squared shares."""
    middle = np.array([(axis.lower + axis.upper) / 2 for axis in robot.axes])
    half = np.array([(axis.upper - axis.lower) / 2 for axis in robot.axes])
    return float((((axes - middle) / half) ** 2).sum())


def dexterity(robot: Robot, axes: np.ndarray) -> float:
    return float(np.prod(np.linalg.svd(robot.jacobian(axes), compute_uv=False)))


def test_middle_and_dexterous_improve_and_keep_the_pose(robot: Robot) -> None:
    rng = np.random.default_rng(1)
    gained = [0, 0]
    for _ in range(20):
        T = robot.fk(random_axes(robot, rng, 0.8)).homogeneous
        plain = robot.ik(T)
        middle, dexterous = robot.ik(T, prefer="middle"), robot.ik(T, prefer="dexterous")
        assert plain.success
        for result in (middle, dexterous):
            assert result.success
            assert same_pose(robot, result.axes, T)
            assert result.position_error < 1e-6
            assert result.rotation_error < 1e-6
        assert shares(robot, middle.axes) <= shares(robot, plain.axes) + 1e-12
        assert dexterity(robot, dexterous.axes) >= dexterity(robot, plain.axes) - 1e-12
        gained[0] += shares(robot, middle.axes) < 0.95 * shares(robot, plain.axes)
        gained[1] += dexterity(robot, dexterous.axes) > 1.05 * dexterity(robot, plain.axes)
    assert min(gained) > 10


def test_middle_is_a_minimum_along_the_redundancy(robot: Robot) -> None:
    rng = np.random.default_rng(2)
    T = robot.fk(random_axes(robot, rng, 0.5)).homogeneous
    best = robot.ik(T, prefer="middle").axes
    for _ in range(10):
        near = robot.ik(T, start=best + rng.normal(scale=2.0, size=len(best)))
        assert shares(robot, near.axes) >= shares(robot, best) - 1e-6


def test_near_comes_back_to_where_the_pose_was_taken(robot: Robot) -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        axes = random_axes(robot, rng, 0.8)
        T = robot.fk(axes)
        begin = axes + rng.normal(scale=5.0, size=len(axes))
        plain, near = robot.ik(T, start=begin), robot.ik(T, start=begin, prefer="near")
        distance = lambda found: float(np.linalg.norm((found.axes - begin) * robot.kinematics.si_factors))  # noqa: E731, B023
        assert same_pose(robot, near.axes, T.homogeneous)
        assert distance(near) <= distance(plain) + 1e-9


def test_held_axes_stay(robot: Robot) -> None:
    axes = random_axes(robot, np.random.default_rng(4), 0.6)
    result = robot.ik(robot.fk(axes), start=axes, held={"X": float(axes[0])}, prefer="middle")
    assert result.success
    assert result.axes[0] == pytest.approx(axes[0], abs=1e-9)


def test_an_arm_without_redundancy_stays() -> None:
    arm = chainbuild.Robot.load("kr6r900_2")
    T = arm.fk([10, -70, 60, 20, 40, 30])
    plain = arm.ik(T)
    for prefer in ("near", "middle", "dexterous"):
        assert arm.ik(T, prefer=prefer).axes == pytest.approx(plain.axes, abs=1e-6)


def test_a_failure_stays_one(robot: Robot) -> None:
    T = np.eye(4)
    T[:3, 3] = (50.0, 0.0, 0.0)
    assert not robot.ik(T, prefer="middle").success


def test_an_unknown_preference(robot: Robot) -> None:
    with pytest.raises(ChainbuildError, match="unknown preference 'best'") as caught:
        robot.ik(robot.fk(random_axes(robot, np.random.default_rng(0))), prefer="best")  # type: ignore[arg-type]
    assert caught.value.permitted == "near, middle, dexterous"


@pytest.mark.parametrize("name", ["robot_head_kin210", "robot_xy_unit_kin210", "gantry_robot_kin210"])
def test_limits_are_kept_from_wherever_the_search_starts(name: str) -> None:
    robot, rng = chainbuild.Robot.load(name), np.random.default_rng(5)
    for _ in range(40):
        target = robot.fk(random_axes(robot, rng))
        found = robot.ik(target, start=random_axes(robot, rng, share=1.5))
        assert found.success, found.reason
        assert same_pose(robot, found.axes, target.homogeneous)


def test_a_failure_is_not_moved_to_where_it_would_be_preferred() -> None:
    arm = chainbuild.Robot.load("kr6r900_2")
    target = as_pose(arm.fk([10, -70, 60, 20, 40, 30]))
    failed = replace(arm.ik(target), success=False, status="limits", reason="limits of A1")
    assert preferred(IkRequest.of(arm, target), failed, "near") is failed
