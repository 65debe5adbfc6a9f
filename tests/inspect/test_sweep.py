"""The sweep: every axis over its range, from a pose that shows the machine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.bodies.shapes import machine_size, shown_limits
from chainbuild.errors import ChainbuildError
from chainbuild.inspect.sweep import axis_sweep, link_placements, rest_pose
from chainbuild.robot import Robot
from tests.kit.drawn_robots import ROBOTS, arm, scara


@pytest.mark.parametrize("name", ROBOTS)
def test_each_axis_in_turn_visits_both_limits_and_returns(name: str) -> None:
    robot = ROBOTS[name]()
    motion, (lower, upper) = axis_sweep(robot), shown_limits(robot.chain)
    rest = motion.axes[0]
    assert [segment.axis for segment in motion.segments] == list(range(len(robot.axes)))
    for segment in motion.segments:
        values = motion.axes[segment.first : segment.last + 1]
        n = segment.axis
        assert values[:, n].min() == lower[n]
        assert values[:, n].max() == upper[n]
        np.testing.assert_array_equal(np.delete(values, n, axis=1), np.tile(np.delete(rest, n), (len(values), 1)))
        np.testing.assert_array_equal(values[0], rest)
        np.testing.assert_array_equal(values[-1], rest)
    assert motion.segments[-1].last == len(motion.axes) - 1
    assert motion.held == ()
    np.testing.assert_array_equal(motion.q, [robot.q(axes) for axes in motion.axes])


@pytest.mark.parametrize("name", ROBOTS)
def test_keyframes_are_close_enough_for_the_viewer_to_turn_the_right_way(name: str) -> None:
    # Between keys the viewer takes the shorter way round.
    steps = np.abs(np.diff(axis_sweep(ROBOTS[name]()).axes, axis=0))
    rotary = [n for n, axis in enumerate(ROBOTS[name]().axes) if axis.kind == "rotary"]
    assert steps[:, rotary].max() < 90.0


@pytest.mark.parametrize("name", ROBOTS)
def test_rest_pose_keeps_the_limits(name: str) -> None:
    robot = ROBOTS[name]()
    assert robot.violated_limits(rest_pose(robot)) == ()


@pytest.mark.parametrize("make", [arm, scara])
def test_rest_pose_of_an_arm_is_bent_and_above_the_floor(make) -> None:
    robot = make()
    axes = rest_pose(robot)
    J = robot.jacobian(axes)
    J[:3] /= machine_size(robot.chain)
    values = np.linalg.svd(J, compute_uv=False)
    assert values[-1] > 0.05 * values[0]
    assert robot.frame_placements(axes)["tool"].translation[2] > 0.0


@pytest.mark.parametrize("name", ROBOTS)
def test_links_stand_where_pinocchio_puts_them(name: str) -> None:
    robot, rng = ROBOTS[name](), np.random.default_rng(5)
    lower, upper = shown_limits(robot.chain)
    for _ in range(20):
        axes = lower + (upper - lower) * rng.random(len(lower))
        expected = robot.frame_placements(axes)
        for link, T in link_placements(robot.chain, robot.q(axes)).items():
            np.testing.assert_allclose(T, expected[link].homogeneous, atol=1e-12)


class _Halting(AffineMap):
    """An affine map without a pose beyond 60° of the first axis, as a closed loop may have none."""

    def q(self, axes: NDArray[np.float64]) -> NDArray[np.float64]:
        if abs(axes[0]) > 60.0:
            raise ChainbuildError("the loop cannot close")
        return AffineMap.q(self, axes)


def test_an_axis_waits_where_there_is_no_pose() -> None:
    chain = arm().chain
    m = chain.axis_map
    assert isinstance(m, AffineMap)
    motion = axis_sweep(Robot(replace(chain, axis_map=_Halting(m.A, m.b, m.si_factors, m.back))))
    assert motion.held == ("A1",)
    assert 40.0 < motion.axes[:, 0].max() <= 60.0
    assert motion.axes[:, 1].max() == 190.0
