"""A free axis is placed where all limits hold, nearest to its start."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from chainbuild.chain.sums import AxisConstraint, AxisSum
from chainbuild.ik.rtcp import linear_axes_batch
from chainbuild.robot import Robot


def bounds(robot: Robot) -> tuple[np.ndarray, np.ndarray]:
    ranges = np.array([axis.range for axis in robot.axes])
    return ranges[:, 0], ranges[:, 1]


@pytest.mark.parametrize("name", ["ac_table_kin58", "bed_mill_kin1"])
def test_every_pose_with_a_vertical_tool_has_a_branch(name: str) -> None:
    robot = Robot.load(name)
    lower, upper = bounds(robot)
    rng = np.random.default_rng(0)
    moved = 0
    for _ in range(25):
        axes = lower + (upper - lower) * rng.random(5)
        axes[3] = 0.0
        T = robot.fk(axes)
        found = robot.ik_all(T)
        assert len(found), axes
        assert found.free_axes[0] == (robot.axes[4].name,)
        assert not robot.limits.violated(found.axes[0])
        np.testing.assert_allclose(robot.fk(found.axes[0]).translation, T.translation, atol=1e-6)
        assert robot.ik(T, solver="analytic").success
        moved += abs(found.axes[0, 4]) > 1e-9
    assert moved


def test_the_place_nearest_to_the_start_is_taken() -> None:
    robot = Robot.load("ac_table_kin58")
    T = robot.fk([390.0, 100.0, -100.0, 0.0, 70.0])
    for start in (0.0, 200.0, -300.0):
        begin = [0.0, 0.0, 0.0, 0.0, start]
        found = robot.ik_all(T, begin)[0].axes
        turned = np.zeros((2881, 5))
        turned[:, 4] = np.linspace(-360.0, 360.0, 2881)
        placed = linear_axes_batch(robot, np.repeat(T.translation[None], 2881, axis=0), turned)
        inside = turned[placed.success, 4]
        nearest = min(inside, key=lambda c: abs(c - start))
        assert abs(abs(found[4] - start) - abs(nearest - start)) <= 0.25
        assert abs(found[4] - start) <= abs(nearest - start) + 1e-6


@pytest.mark.parametrize("name", ["ac_table_kin58", "bed_mill_kin1"])
def test_a_single_place_is_found(name: str) -> None:
    """At a corner of X and Y the table may turn to few places at which both are inside."""
    robot = Robot.load(name)
    lower, upper = bounds(robot)
    for x, y, c in ((0, 0, 0.0), (1, 0, -360.0), (0, 1, 180.0), (1, 1, 33.3), (1, 1, -270.0)):
        axes = np.where([x, y, 0, 0, 0], upper, lower)
        axes[3:] = 0.0, c
        found = robot.ik_all(robot.fk(axes))
        assert len(found), axes
        assert (found.axes >= lower).all()
        assert (found.axes <= upper).all()


def test_a_margin_that_only_touches_zero_counts() -> None:
    """The point is as far from the table's axis as X goes: X reaches it at one angle, where it is at its peak."""
    robot = Robot.load("ac_table_kin58")
    home = robot.fk([0.0, 0.0, -100.0, 0.0, 0.0]).homogeneous
    axis = np.mean([robot.fk([0.0, 0.0, -100.0, 0.0, c]).translation for c in (0.0, 180.0)], axis=0)
    radius = np.linalg.norm(robot.fk([400.0, 0.0, -100.0, 0.0, 0.0]).translation[:2] - axis[:2])
    narrow = [replace(axis, lower=399.9999999) if axis.name == "X" else axis for axis in robot.axes]
    narrowed = Robot(replace(robot.chain, axes=tuple(narrow)))
    direction = np.array([np.cos(1.234), np.sin(1.234)])
    T = home.copy()
    T[:2, 3] = axis[:2] + radius * direction
    found = narrowed.ik_all(T)
    assert len(found)
    assert found.axes[0, 0] == pytest.approx(400.0, abs=1e-6)


def test_a_straight_wrist_turns_both_its_axes_into_their_limits() -> None:
    robot = Robot.load("kr6r900")
    narrow = [replace(axis, lower=-100.0, upper=100.0) if axis.name == "A6" else axis for axis in robot.axes]
    narrowed = Robot(replace(robot.chain, axes=tuple(narrow)))
    T = narrowed.fk([10.0, -80.0, 70.0, 120.0, 0.0, 60.0])
    found = [branch for branch in narrowed.ik_all(T) if branch.free_axes]
    assert found
    total = robot.ik_all(T)[0].axes
    assert abs(found[0].axes[3]) == pytest.approx(80.0, abs=1e-4)
    assert abs(found[0].axes[5]) == pytest.approx(100.0, abs=1e-4)
    assert (found[0].axes[3] + found[0].axes[5] - total[3] - total[5]) % 360.0 == pytest.approx(0.0, abs=1e-4)


def test_a_pose_without_such_a_place_is_refused_by_name() -> None:
    robot = Robot.load("ac_table_kin58")
    found = robot.ik(robot.fk([10.0, 20.0, 130.0, 0.0, 50.0]), solver="analytic")
    assert (found.status, found.violated) == ("limits", ("Z",))


def narrowed(robot: Robot, n: int, middle: float, width: float) -> Robot:
    """Return a robot with little room for an axis."""
    axes = list(robot.chain.axes)
    axes[n] = replace(axes[n], lower=middle - 0.5 * width, upper=middle + 0.5 * width, endless=False)
    return Robot(replace(robot.chain, axes=tuple(axes)))


@pytest.mark.parametrize("width", [0.2, 1.0, 3.0])
def test_ranges_that_lie_between_two_samples_are_found(width: float) -> None:
    """Of another axis than the free one: it passes through its range within a few degrees of the free one."""
    rng = np.random.default_rng(5)
    arm, machine = Robot.load("kr6r900"), Robot.load("ac_table_kin58")
    for _ in range(6):
        axes = np.array([20.0, -60.0, 80.0, rng.uniform(-150.0, 150.0), 0.0, rng.uniform(-300.0, 300.0)])
        narrow = narrowed(arm, 5, axes[5], width)
        found = narrow.ik_all(narrow.fk(axes))
        assert len(found) > 0
        assert (np.abs(found.axes[:, 5] - axes[5]) <= 0.5 * width + 1e-6).all()
        axes = np.array([*rng.uniform(-100.0, 100.0, 2), -100.0, 0.0, rng.uniform(-180.0, 180.0)])
        narrow = narrowed(machine, 0, axes[0], width)
        found = narrow.ik_all(narrow.fk(axes))
        assert len(found) > 0
        assert (np.abs(found.axes[:, 0] - axes[0]) <= 0.5 * width + 1e-6).all()


@pytest.mark.parametrize("width", [0.2, 1.0])
def test_sums_with_little_room_are_kept(width: float) -> None:
    machine = Robot.load("ac_table_kin58")
    for axes in ([50.2, 40.3, -100.0, 0.0, 200.0], [-80.0, 30.0, -100.0, 0.0, -150.0]):
        total = axes[0] + axes[1]
        limit = AxisConstraint("X+Y", AxisSum((1.0, 1.0, 0.0, 0.0, 0.0), 0.0), total - 0.4 * width, total + 0.6 * width)
        robot = Robot(replace(machine.chain, constraints=(limit,)))
        T = robot.fk(axes)
        for branch in robot.ik_all(T):
            assert robot.violated_limits(branch.axes) == ()
        assert len(robot.ik_all(T)) > 0
        assert robot.ik(T).success
