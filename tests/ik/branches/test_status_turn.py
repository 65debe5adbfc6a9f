"""Status and turn of KIN_TYP 45: the manual's program, hand-drawn poses, eight statuses for eight branches."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.programmed.status import WRIST_IN_FRONT
from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.status_turn import (
    status_and_decided,
    status_constants,
    status_turn,
    status_turn_rows,
)
from chainbuild.robot import Robot
from tests.kit.arms45 import bent_arm, status_by_frames
from tests.kit.kin_robots import robot_of
from tests.kit.kin_types import build
from tests.kit.robots import arm


def wide(robot: Robot) -> Robot:
    """Return the robot with limits of half a turn, so that -30° is never shown as 330°."""
    axes = tuple(replace(axis, lower=-180.0, upper=180.0) for axis in robot.axes)
    return Robot(robot.chain.with_axes(axes))


@pytest.fixture(scope="module")
def kuka() -> Robot:
    return wide(chainbuild.Robot.load("kr6r900_2"))


@pytest.mark.parametrize(
    ("axes", "status", "turn"),
    [
        # KIN_TYP manual 3.3.3 programs IS2 IT2 for a tool straight down or forward: A2 < 0, forearm in front.
        ((0, -90, 90, 0, 0, 0), 2, 0b000010),
        ((0, -90, 90, 0, 30, 0), 2, 0b000010),
        ((0, -90, 90, 0, -30, 0), 6, 0b010010),
        ((-10, -90, 90, -5, 30, -400), 2, 0b101011),
        # Arm thrown backwards over axis 1: the wrist is behind it, and behind the line from axis 2 to axis 3 or not.
        ((0, -150, 40, 0, 30, 0), 3, 0b000010),
        ((0, -150, -40, 0, 30, 0), 1, 0b000110),
        # Stretched forward, elbow bent up: the wrist is behind the line.
        ((0, -10, -30, 0, 30, 0), 0, 0b000110),
    ],
)
def test_hand_drawn_poses(kuka: Robot, axes, status: int, turn: int) -> None:
    assert status_turn(kuka, axes) == (status, turn)


def test_eight_branches_have_eight_statuses(kuka: Robot) -> None:
    rng = np.random.default_rng(6)
    eight = 0
    for robot in (kuka, wide(chainbuild.Robot.load("tx2_60"))):
        for _ in range(100):
            found = robot.ik_all(robot.fk(rng.uniform(-170.0, 170.0, 6)))
            bits = [branch.status_bits for branch in found]
            assert len(set(bits)) == len(bits)
            eight += len(bits) == 8
            for branch in found:
                assert (branch.status_bits, branch.turn_bits) == status_turn(robot, branch.axes)
    assert eight > 50


def test_an_arm_that_carries_the_workpiece_has_the_same_status() -> None:
    hd = {7: 400.0, 8: 455.0, 9: 420.0, 10: 80.0, 11: 25.0, 12: -35.0, 14: -90.0, 15: 90.0}
    plain, turned = build(45, hd).robot, build(45, {**hd, 1: 50.0, 33: 1}).robot
    assert turned.axes[0].name == plain.axes[0].name
    rng = np.random.default_rng(7)
    for _ in range(50):
        axes = rng.uniform(-170.0, 170.0, 6)
        assert status_turn(turned, axes) == status_turn(plain, axes)


def test_reversed_axes_do_not_change_what_is_seen() -> None:
    hd = {7: 400.0, 8: 455.0, 9: 420.0, 10: 80.0, 11: 25.0, 12: -35.0}
    plain, mirrored = build(45, hd).robot, build(45, {**hd, 21: 1, 22: 1, 23: 1}).robot
    rng = np.random.default_rng(8)
    for _ in range(50):
        axes = rng.uniform(-170.0, 170.0, 6)
        assert status_turn(mirrored, axes * [-1, -1, -1, 1, 1, 1])[0] == status_turn(plain, axes)[0]


def everything_counts() -> Robot:
    """Return an arm with zeros, a coupling and offsets that its recipe does not have."""
    chain = bent_arm().chain
    assert isinstance(chain.axis_map, AffineMap)
    coupled = chain.axis_map.A.copy()
    coupled[2, 1] += 0.5  # the third joint follows the second axis, too
    b = np.array([0.3, -0.4, 0.5, 0.6, -0.7, 0.8])
    # The hand further along axis 4, and the upper arm along axis 2, than where the recipe draws them.
    joints = list(chain.joints)
    for before, n in ((3, 4), (1, 2)):
        T = joints[n].T_parent_joint.copy()
        T[:3, 3] += 0.05 * joints[before].direction
        joints[n] = replace(joints[n], T_parent_joint=T)
    return Robot(replace(chain, joints=tuple(joints), axis_map=AffineMap.of(coupled, b, ["rotary"] * 6)))


def test_zeros_couplings_and_every_offset_count() -> None:
    robot = everything_counts()
    rng = np.random.default_rng(9)
    rows = rng.uniform(-170.0, 170.0, (200, 6))
    assert [status_turn(robot, row) for row in rows] == [status_by_frames(robot, row) for row in rows]


def test_compiled_code_names_the_same(kuka: Robot) -> None:
    pytest.importorskip("numba")
    from chainbuild.ik.branches.compiled.entries import status_rows

    turned = build(45, {7: 400.0, 8: 455.0, 9: 420.0, 10: 80.0, 11: 25.0, 12: -35.0, 1: 50.0, 33: 1}).robot
    rng = np.random.default_rng(10)
    for robot in (kuka, everything_counts(), turned):
        rows = rng.uniform(-170.0, 170.0, (400, 6))
        rows[:200] = 10.0 * np.round(rows[:200] / 10.0)
        rows[rng.random(rows.shape) < 0.1] = 0.0
        rows += rng.choice([0.0, -2.5e-15, 2e-9, -2e-9], rows.shape)
        constants, bits = status_constants(robot), np.empty((len(rows), 2), np.int64)
        status_rows(constants, rows, bits)
        np.testing.assert_array_equal(bits, status_turn_rows(robot, rows))
        assert len(np.unique(bits[:, 0])) == 8
    assert status_constants(arm()) is None


@pytest.mark.parametrize(("aside_mm", "decided"), [(0.05, 0), (0.2, WRIST_IN_FRONT)])
def test_the_elbow_is_decided_by_how_far_the_wrist_is_from_its_line(kuka: Robot, aside_mm: float, decided: int) -> None:
    """Metres, whatever the length of the upper arm: 0.455 m here, which a share of it would show."""
    elbow = math.atan2(25.0, 420.0)  # axis 3 where the wrist is on the line through axes 2 and 3
    axes = np.degrees([0.0, -1.0, elbow + math.asin(aside_mm / math.hypot(420.0, 25.0)), 0.0, 0.6, 0.0])
    bits, open_bits = status_and_decided(kuka, axes[None])
    assert (int(bits[0]) & WRIST_IN_FRONT) == WRIST_IN_FRONT
    assert (int(open_bits[0]) & WRIST_IN_FRONT) == decided


def test_other_kinematics_have_none() -> None:
    with pytest.raises(ChainbuildError, match="KIN_TYP 45 only"):
        status_turn(arm(), np.zeros(6))
    assert arm().ik_all(arm().fk([0, -90, 90, 0, 30, 0]))[0].status_bits is None
    assert robot_of(45).ik_all(robot_of(45).fk([10, 20, 30, 40, 50, 60]))[0].status_bits is not None


def test_a_zero_that_was_rounded_is_not_below_zero() -> None:
    robot = chainbuild.Robot.load("kr6r900_2")
    assert (
        status_turn(robot, [10.0, -80.0, 70.0, 20.0, 40.0, -2.5e-15])[1]
        == status_turn(robot, [10.0, -80.0, 70.0, 20.0, 40.0, 0.0])[1]
    )
    assert status_turn(robot, [10.0, -80.0, 70.0, 20.0, 40.0, -1e-8])[1] & 32
    assert not status_turn(robot, [10.0, -80.0, 70.0, 20.0, -1e-12, 0.0])[0] & 4
