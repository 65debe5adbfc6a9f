"""Branches next to poses at which the equations are singular: none comes and goes with the last digits of the pose."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

from chainbuild.robot import Robot
from tests.kit.compare import same_turns
from tests.kit.paths import REFERENCE

# An arm whose wrist bends twice by 60 degrees, at a pose where none of the ways to open its loop separates solutions.
AXES = np.degrees([1.408137591922502, -np.pi / 2, -np.pi / 2, -0.5093371146875434, 0.0, 0.0])
LOST = np.degrees([-1.4677457, -4.7073393, -4.5785696, -0.0372326, 0.1487248, 2.3293136])


def check(size: float, count: int) -> None:
    robot = Robot.from_urdf(REFERENCE / "arm_jaco2_spherical_free.urdf")
    exact = robot.ik_all(robot.fk(AXES)).axes
    assert len(exact) == 8
    assert any(same_turns(robot, LOST, one, tolerance=1e-4) for one in exact)
    rng = np.random.default_rng(11)
    for _ in range(count):
        target = robot.fk(AXES) * pin.exp6(pin.Motion(size * rng.normal(size=6)))
        found = robot.ik_all(target).axes
        assert len(found) == 8
        for one in exact:
            assert any(same_turns(robot, one, other, tolerance=1e-4) for other in found)


@pytest.mark.parametrize("size", [1e-16, 1e-12, 1e-8])
def test_all_branches_at_nudged_poses(size: float) -> None:
    check(size, 3)


@pytest.mark.slow
@pytest.mark.parametrize("exponent", range(-16, -7))
def test_all_branches_at_many_nudged_poses(exponent: int) -> None:
    check(10.0**exponent, 40)
