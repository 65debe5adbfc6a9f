"""Base, tool, signs and zeros of a machine change nothing: the same poses, the same number of branches, each moved."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.assemble import linear, rotary, shift
from chainbuild.ik.branches.core.branches import collect
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.request import IkRequest
from chainbuild.robot import Robot
from tests.kit.compare import same_turns
from tests.kit.draws import random_axes, seed_of
from tests.kit.kin_robots import robot_of
from tests.kit.robots import arm, robot_from, table_machine, ur5
from tests.kit.shuffled import shuffled

# Spherical wrist, UR, five-axis machines, SCARA, palletiser, cylinder, a general arm.
SHIPPED = ("kr6r900", "tx2_60", "ac_table_kin58", "ca_head_kin9", "scara_cc", "palletiser_kin96", "cyl_2rot_kin202")
REGULAR = 1e-2  # smallest singular value [m, rad]: branches do not come and go with the last digits


def slide_arm() -> Robot:
    """Return six joints with slides between, in no order that a closed form knows."""
    return robot_from([
        rotary("A1", "z"), shift(x=120.0, z=90.0), linear("X2", (1.0, 0.2, 0.3)), rotary("A3", (0.3, 1.0, 0.1)),
        shift(x=200.0, y=40.0), rotary("A4", (1.0, 0.0, 0.5)), shift(x=150.0, z=-60.0), rotary("A5", "y"),
        shift(y=50.0, z=100.0), rotary("A6", (0.2, -0.4, 1.0)), shift(70.0, 20.0, 30.0),
    ])  # fmt: skip


def general_arm() -> Robot:
    """Return six rotary axes without parallel or meeting neighbours."""
    rng = np.random.default_rng(4)
    elements = []
    for n in range(6):
        elements += [rotary(f"A{n + 1}", rng.normal(size=3)), shift(*(150.0 * rng.normal(size=3)))]
    return robot_from(elements)


BUILT = {"arm": arm, "ur5": ur5, "table": table_machine, "slides": slide_arm, "general": general_arm}
MACHINES = [*SHIPPED, *BUILT, "kin 206", "kin 208"]


def machine(name: str) -> Robot:
    if name.startswith("kin "):
        return robot_of(int(name.removeprefix("kin ")))
    return BUILT[name]() if name in BUILT else chainbuild.Robot.load(name)


def check(name: str, count: int, ways: int) -> None:
    robot, rng = machine(name), np.random.default_rng(seed_of(name))
    for _ in range(ways):
        other = shuffled(robot, rng)
        assert other.robot.plan().name == robot.plan().name
        for _ in range(count):
            axes = random_axes(robot, rng)
            _, J = robot.kinematics.residual(robot.fk(axes), robot.task)(axes * robot.kinematics.si_factors)
            if np.linalg.svd(J, compute_uv=False)[-1] < REGULAR:
                continue
            target = robot.fk(axes).homogeneous
            np.testing.assert_allclose(other.robot.fk(other.axes(axes)).homogeneous, other.pose(target), atol=1e-9)
            found, moved = robot.ik_all(target, axes), other.robot.ik_all(other.pose(target), other.axes(axes))
            assert len(found) == len(moved) > 0
            for row in other.axes(found.axes):
                assert any(same_turns(other.robot, one, row, 1e-5) for one in moved.axes), axes.tolist()


@pytest.mark.parametrize("name", MACHINES)
def test_a_shuffled_machine_has_the_same_branches(name: str) -> None:
    check(name, 4, 2)


@pytest.mark.slow
@pytest.mark.parametrize("name", MACHINES)
def test_a_machine_shuffled_often_has_the_same_branches(name: str) -> None:
    check(name, 25, 12)


def test_whole_turns_of_one_branch_count_once() -> None:
    """Half a turn from the start both ways are as near: two solvers may go one each."""
    robot = arm()
    axes = np.array([10.0, -60.0, 70.0, 20.0, 30.0, 180.0])
    query = BranchQuery.of(IkRequest.of(robot, robot.fk(axes), np.array([10.0, -60.0, 70.0, 20.0, 30.0, 0.0])))
    there = axes * robot.kinematics.si_factors
    turned = there - [0.0, 0.0, 0.0, 0.0, 0.0, 2.0 * np.pi]
    assert len(collect(query, [(there, ()), (turned, ())]).branches) == 1
    assert len(collect(replace(query, windings=True), [(there, ()), (turned, ())]).branches) == 2
