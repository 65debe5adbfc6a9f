"""Compiled code frees what it takes: what counts no references may neither make arrays nor be handed new ones."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

import chainbuild
from chainbuild.robot import Robot
from tests.bench.arms.geometry import OTHER, Arm
from tests.bench.arms.peers import robot_of
from tests.kit.draws import random_axes
from tests.kit.general_arms import DRAWN, arm_of

SHIPPED = ("gantry_ss", "bed_mill_kin1", "ac_table_kin58", "kr6r900", "tx2_60", "comau_calibrated", "scara_cc")


@pytest.fixture(autouse=True)
def counted() -> Iterator[None]:
    """Let numba count what it takes and frees."""
    _nrt_python.memsys_enable_stats()
    yield
    _nrt_python.memsys_disable_stats()


def kept() -> int:
    """Return how many arrays that compiled code has made are still there."""
    stats = rtsys.get_allocation_stats()
    return int(stats.alloc - stats.free)


def solve(robot: Robot, poses: list[np.ndarray]) -> None:
    for T in poses:
        robot.ik(T)
        robot.ik_all(T)
    robot.ik_batch(poses)
    robot.ik_path(poses)
    robot.ik_all_batch(poses)


@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_machines(name: str) -> None:
    robot, rng = chainbuild.Robot.load(name), np.random.default_rng(1)
    poses = [robot.fk(random_axes(robot, rng)).homogeneous for _ in range(10)]
    solve(robot, poses)
    before = kept()
    solve(robot, poses)
    assert kept() == before


@pytest.mark.parametrize("name", list(DRAWN))
def test_arms_and_their_doubtful_poses(name: str) -> None:
    serial, rng = arm_of(DRAWN[name]), np.random.default_rng(2)
    axes, points = (np.array([getattr(s, part) for s in serial.screws]) for part in ("direction", "point"))
    made = Arm(name, OTHER, False, axes, points, serial.M)
    robot, right = robot_of(made), math.pi / 2.0 * rng.integers(-1, 3, (6, 6))
    poses = [made.pose(row) for row in (*right, *rng.uniform(-math.pi, math.pi, (6, 6)))]
    solve(robot, poses)
    before = kept()
    solve(robot, poses)
    assert kept() == before
