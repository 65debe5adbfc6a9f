"""Ten thousand reachable poses of every shipped machine: all found, none wrong, none outside its limits."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild

COUNT = 10_000


@pytest.mark.slow
@pytest.mark.parametrize("name", chainbuild.shipped())
def test_every_reachable_pose_is_found(name: str) -> None:
    robot = chainbuild.Robot.load(name)
    rng = np.random.default_rng(11)
    lower, upper = (np.array([getattr(axis, end) for axis in robot.axes]) for end in ("lower", "upper"))
    count = COUNT if robot.kinematics.product is not None else COUNT // 20  # nonlinear maps take the plain path
    axes = lower + (upper - lower) * rng.random((count, len(lower)))
    axes[:, [axis.held for axis in robot.axes]] = 0.0
    axes = np.array([row for row in axes if not robot.violated_limits(row) and has_pose(robot, row)])
    targets = robot.fk_batch(axes)
    found = robot.ik_batch(targets)
    assert found.success.mean() >= 0.9999
    reached = robot.fk_batch(found.axes[found.success])
    wanted = targets[found.success]
    assert np.abs(reached[:, :3, 3] - wanted[:, :3, 3]).max() <= 1e-6
    if robot.task == "pose":
        assert np.abs(reached[:, :3, :3] - wanted[:, :3, :3]).max() <= 1e-6
    elif robot.task == "direction":
        n = robot.kinematics.tool_axis
        assert np.abs(reached[:, :3, n] - wanted[:, :3, n]).max() <= 1e-6
    assert not any(robot.violated_limits(row) for row in found.axes[found.success])


def has_pose(robot: chainbuild.Robot, axes: np.ndarray) -> bool:
    try:
        robot.fk(axes)
    except chainbuild.ChainbuildError:
        return False
    return True
