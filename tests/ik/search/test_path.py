"""Paths: each pose from the one before, on the nearest branch, through limits, gaps and wrist singularities."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from chainbuild.ik.request import IkOptions
from tests.kit.draws import random_axes
from tests.kit.robots import arm, table_machine

BOTH = [True, False]


def largest_step(axes: np.ndarray, start: np.ndarray) -> float:
    return float(np.abs(np.diff(axes, axis=0, prepend=start[None])).max())


@pytest.mark.parametrize("compiled", BOTH)
@pytest.mark.parametrize("make", [arm, table_machine])
def test_a_smooth_path_stays_on_its_branch(make, compiled: bool) -> None:
    robot, rng = make(), np.random.default_rng(3)
    first, last = (0.5 * random_axes(robot, rng) for _ in range(2))
    wanted = first + np.linspace(0.0, 1.0, 400)[:, None] * (last - first)
    found = robot.ik_path(robot.fk_batch(wanted), first, options=IkOptions(compiled=compiled))
    assert found.success.all()
    np.testing.assert_allclose(found.axes, wanted, atol=1e-5)
    assert found.counts[:, 2].max() == 0


@pytest.mark.parametrize("compiled", BOTH)
def test_many_turns_are_followed_and_end_at_the_limit(compiled: bool) -> None:
    robot = arm()
    wanted = np.tile([10.0, -80.0, 70.0, 20.0, 40.0, 0.0], (101, 1))
    wanted[:, 5] = np.linspace(-340.0, 340.0, 101)
    found = robot.ik_path(robot.fk_batch(wanted), wanted[0], options=IkOptions(compiled=compiled))
    assert found.success.all()
    np.testing.assert_allclose(found.axes[:, 5], wanted[:, 5], atol=1e-5)


@pytest.mark.parametrize("compiled", BOTH)
def test_straight_through_the_wrist_singularity(compiled: bool) -> None:
    # Axis 5 passes exactly through 0: a tracker that keeps its sign would turn axes 4 and 6 by half a turn.
    robot = arm()
    wanted = np.tile([10.0, -60.0, 60.0, 30.0, 0.0, 20.0], (61, 1))
    wanted[:, 4] = np.linspace(-30.0, 30.0, 61)
    found = robot.ik_path(robot.fk_batch(wanted), wanted[0], options=IkOptions(compiled=compiled))
    assert found.success.all()
    assert largest_step(found.axes, wanted[0]) < 1.3


def line_past_the_singularity(robot) -> tuple[np.ndarray, np.ndarray]:
    axes = np.array([10.0, -60.0, 60.0, 30.0, 0.3, 20.0])
    poses = np.repeat(robot.fk(axes).homogeneous[None], 61, axis=0)
    poses[:, :3, 3] += np.linspace(-0.1, 0.1, 61)[:, None] * np.array([0.5, 0.7, 0.5])
    return poses, robot.ik(poses[0], axes).axes


def test_past_the_wrist_singularity_no_more_than_needed() -> None:
    # All branches of every pose, all whole turns: the least largest step that any sequence of them has.
    robot = chainbuild.Robot.load("kr6r900")
    poses, start = line_past_the_singularity(robot)
    layer, cost = start[None], np.zeros(1)
    for pose in poses:
        following = np.array([branch.axes for branch in robot.ik_all(pose, windings=True)])
        steps = np.abs(following[:, None] - layer[None]).max(axis=2)
        cost = np.maximum(steps, cost[None]).min(axis=1)
        layer = following
    found = robot.ik_path(poses, start)
    assert found.success.all()
    assert largest_step(found.axes, start) <= 1.3 * cost.min()
    for row, pose in zip(found.axes, poses, strict=True):
        np.testing.assert_allclose(robot.fk(row).homogeneous, pose, atol=1e-6)


@pytest.mark.parametrize("compiled", BOTH)
def test_a_gap_does_not_move_the_machine(compiled: bool) -> None:
    robot = arm()
    axes = np.array([10.0, -80.0, 70.0, 20.0, 40.0, 30.0])
    T = robot.fk_batch([axes, axes + 1.0, axes + 2.0])
    T[1, 0, 3] = 30.0
    found = robot.ik_path(T, axes, options=IkOptions(compiled=compiled))
    assert found.status == ["ok", "unreachable", "ok"]
    np.testing.assert_allclose(found.axes[2], axes + 2.0, atol=1e-6)


def test_a_path_without_start_begins_anywhere() -> None:
    robot = arm()
    wanted = np.linspace([0.0, -80.0, 70.0, 20.0, 40.0, 30.0], [40.0, -60.0, 50.0, 10.0, 60.0, 0.0], 50)
    found = robot.ik_path([robot.fk(row) for row in wanted])
    assert found.success.all()
    assert np.abs(np.diff(found.axes, axis=0)).max() < 10.0


def test_held_axes_stay_along_the_path() -> None:
    robot = chainbuild.Robot.load("irb2600_track")
    held = [axis.held for axis in robot.axes]
    name = next(axis.name for axis in robot.axes if axis.held)
    wanted = np.linspace(np.where(held, 250.0, 5.0), np.where(held, 250.0, 25.0), 30)
    found = robot.ik_path(robot.fk_batch(wanted), wanted[0], held={name: 250.0})
    np.testing.assert_allclose(found.axes, wanted, atol=1e-5)
