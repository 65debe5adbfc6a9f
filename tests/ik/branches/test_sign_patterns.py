"""Axes that count the other way: the same arm has the same branches, with the signs of these axes changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.assemble import Element, rotary, shift, turn
from chainbuild.frames import rot_x
from chainbuild.robot import Robot
from tests.kit.compare import same_turns
from tests.kit.robots import robot_from, ur5

HALF = 90.0


def denavit_hartenberg(rows: Sequence[tuple[float, float, float]]) -> Robot:
    """Return an arm of rows (d, a in mm, alpha in degrees)."""
    elements: list[Element] = []
    for n, (d, a, alpha) in enumerate(rows, 1):
        elements += [rotary(f"A{n}", "z"), shift(x=a, z=d), turn(rot_x(alpha))]
    return robot_from(elements)


def collaborative(d1: float, a2: float, a3: float, d4: float, d5: float, d6: float) -> Robot:
    """Return an arm with three parallel axes, as its maker gives it."""
    return denavit_hartenberg([(d1, 0, HALF), (0, a2, 0), (0, a3, 0), (d4, 0, HALF), (d5, 0, -HALF), (d6, 0, 0)])


def irb120() -> Robot:
    return robot_from([
        rotary("A1", "z"), shift(z=290.0), rotary("A2", "y"), shift(z=270.0), rotary("A3", "y"), shift(x=302.0, z=70.0),
        rotary("A4", "x"), rotary("A5", "y"), rotary("A6", "x"), shift(x=72.0),
    ])  # fmt: skip


ARMS = {
    "UR5": ur5,
    "UR10e": lambda: collaborative(180.7, -612.7, -571.55, 174.15, 119.85, 116.55),
    "CR5": lambda: collaborative(147.0, -427.0, -357.0, 141.0, 116.0, 105.0),
    "KR 6": lambda: Robot.load("kr6r900"),
    "IRB 120": irb120,
}


def endless(robot: Robot) -> Robot:
    """Return an arm without limits: a range that is not symmetric would be another one."""
    return Robot(robot.chain.with_axes(tuple(chainbuild.Axis.unlimited(a.name, a.kind) for a in robot.axes)))


def flipped(robot: Robot, signs: np.ndarray) -> Robot:
    joints = zip(robot.chain.joints, signs.tolist(), strict=True)
    return Robot(replace(robot.chain, joints=tuple(replace(j, direction=sign * j.direction) for j, sign in joints)))


def compare(name: str, patterns: Sequence[int]) -> None:
    robot = endless(ARMS[name]())
    rng = np.random.default_rng(3)
    known = []
    for axes in rng.uniform(-150.0, 150.0, (2, 6)):
        found = robot.ik_all(robot.fk(axes)).axes
        assert any(same_turns(robot, one, axes) for one in found)
        known.append((axes, found))
    assert {len(found) for _, found in known} <= {2, 4, 6, 8}
    for pattern in patterns:
        signs = np.array([-1.0 if pattern >> n & 1 else 1.0 for n in range(6)])
        other = flipped(robot, signs)
        for axes, found in known:
            target = other.fk(signs * axes)
            np.testing.assert_allclose(target.homogeneous, robot.fk(axes).homogeneous, atol=1e-12)
            again = other.ik_all(target).axes
            assert len(again) == len(found), (pattern, other.plan().name)
            for one in found:
                assert any(same_turns(other, signs * one, branch) for branch in again)


@pytest.mark.parametrize("name", ["UR5", "UR10e"])
def test_one_of_three_parallel_axes_counts_the_other_way(name: str) -> None:
    compare(name, (0b000010, 0b001000, 0b001110))


@pytest.mark.slow
@pytest.mark.parametrize("name", ARMS)
def test_every_pattern_of_signs(name: str) -> None:
    compare(name, range(64))


def test_a_target_of_such_an_arm_is_reached() -> None:
    robot = flipped(endless(ur5()), np.array([1.0, 1.0, -1.0, 1.0, 1.0, 1.0]))
    target = robot.fk([10.0, -50.0, -70.0, 20.0, 60.0, 5.0])
    assert robot.ik(target, solver="analytic").success
