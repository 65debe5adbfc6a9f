"""The pose in which a page shows a machine, and how far its axes move it from there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.bodies.shapes import machine_size, shown_limits
from chainbuild.inspect.sweep import link_placements, rest_pose, swept_poses
from chainbuild.robot import Robot
from tests.kit.drawn_robots import ROBOTS, arm, scara


@pytest.mark.parametrize("name", ROBOTS)
def test_each_axis_alone_is_looked_at_at_both_limits(name: str) -> None:
    robot = ROBOTS[name]()
    rest, ends = rest_pose(robot), np.transpose(shown_limits(robot.chain))
    swept = swept_poses(robot, rest)
    np.testing.assert_array_equal(swept[0], rest)
    assert len(swept) == 1 + 2 * len(rest)
    for k, axes in enumerate(swept[1:]):
        n = k // 2
        assert axes[n] == ends[n][k % 2]
        np.testing.assert_array_equal(np.delete(axes, n), np.delete(rest, n))


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
        return AffineMap.q(self, axes) * (np.nan if abs(axes[0]) > 60.0 else 1.0)


def test_ends_without_a_pose_are_left_out() -> None:
    chain = arm().chain
    m = chain.axis_map
    assert isinstance(m, AffineMap)
    robot = Robot(replace(chain, axis_map=_Halting(m.A, m.b, m.si_factors, m.back)))
    swept = np.array(swept_poses(robot, rest_pose(arm())))
    assert len(swept) == 11
    assert np.abs(swept[:, 0]).max() <= 60.0
    assert swept[:, 1].max() == 190.0
