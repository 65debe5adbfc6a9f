"""Additional axes of base, workpiece and flange, and gripper-referred motion: the manual's examples with numbers."""

from __future__ import annotations

import numpy as np
import pytest

from tests.kit.robx_files import FLANGE, NR6, TABLE, F, R, T, chain_of, close, pose_of, read, robx_text


def test_base_axes_move_the_whole_robot():
    data = {
        **NR6,
        "TROWO_POS": (0, 0, 50),
        "TROWO_RPY": (90, 0, 0),
        "EXT_AXIS_VECTOR_1": (1, 0, 0),
        "EXT_AXIS_VECTOR_3": (0, 0.6, 0.8),
        "EXT_AX_OFFSET": (100, 7, 20),
    }
    chain = chain_of(data, axes_in=(1, 2, 3, 4, 5, 6, 7, 0, 8))
    assert [axis.name for axis in chain.axes][6:] == ["EX1", "EX3"]
    assert [(axis.kind, axis.held) for axis in chain.axes][6:] == [("linear", True), ("linear", True)]
    robot = (10, -80, 60, 20, 30, 40)
    still = pose_of(chain_of({**NR6, "TROWO_POS": (0, 0, 50), "TROWO_RPY": (90, 0, 0)}), robot)
    moved = pose_of(chain, (*robot, 500, 220))
    assert close(moved, T(400, 200 * 0.6, 200 * 0.8) @ still)


def test_programmed_height_is_split_between_track_and_robot():
    """Z1000 with Z_EXT = 800 leaves 200 to the robot (ROBX manual 8.1.3)."""
    data = {**NR6, "EXT_AXIS_VECTOR_1": (0, 0, 1)}
    axes = (10, -20, 60, 20, 30, 40)
    target = pose_of(chain_of(data, axes_in=(1, 2, 3, 4, 5, 6, 7)), (*axes, 800))
    robot_alone = pose_of(chain_of(NR6), axes)
    assert target[2, 3] - 800 == pytest.approx(robot_alone[2, 3])


def workpiece_of(chain, axes):
    """Return the workpiece frame in WO, from the pose of a robot that stands still."""
    still = pose_of(chain_of(NR6), axes[:6])
    return still @ np.linalg.inv(pose_of(chain, axes))


def test_manual_example_of_table_axes():
    """Rotary and swivel axis (ROBX manual 8.2.3) with L1 = 900, L2 = 200, L3 = 30, L4 = 40."""
    chain = chain_of(TABLE, axes_in=(1, 2, 3, 4, 5, 6, 0, 0, 0, 7, 8))
    robot = (10, -80, 60, 20, 30, 40)
    assert [axis.name for axis in chain.axes][6:] == ["EW1", "EW2"]
    assert [axis.carries for axis in chain.axes][6:] == ["workpiece", "workpiece"]
    assert close(workpiece_of(chain, (*robot, 0, 0)), T(930, 0, 240))
    turned = T(900, 0, 200) @ R("z", 25) @ T(30) @ R("y", -35) @ T(z=40)
    assert close(workpiece_of(chain, (*robot, 25, -35)), turned)


def test_three_table_axes_with_offsets():
    data = {
        **TABLE,
        "EXT_ROT_JOINT_OFFSET_2": (1, 2, 3),
        "EXT_ROT_AX_VECTOR_3": (1, 0, 0),
        "EXT_ROT_AX_OFFSET": (5, 6, 7),
    }
    chain = chain_of(data, axes_in=(1, 2, 3, 4, 5, 6, 0, 0, 0, 7, 8, 9))
    expected = T(900, 0, 200) @ R("z", 20) @ T(30) @ R("y", 30) @ T(1, 2, 3) @ R("x", 40) @ T(z=40)
    assert close(workpiece_of(chain, (10, -80, 60, 20, 30, 40, 25, 36, 47)), expected)


def test_manual_example_of_flange_axes():
    """Two axes behind the flange (ROBX manual 8.3.3) with L1 = 50, L2 = 60, L3 = 70, L4 = 80."""
    chain = chain_of(FLANGE, axes_in=(1, 2, 3, 4, 5, 6, 0, 0, 0, 0, 0, 0, 7, 8))
    robot = (10, -80, 60, 20, 30, 40)
    flange = pose_of(chain_of(NR6), robot)
    at_zero = np.linalg.inv(flange) @ pose_of(chain, (*robot, 0, 0))
    assert np.abs(at_zero[:3, 3] - (110, 0, -150)).max() < 1e-9
    assert np.abs(at_zero[:3, 2] - (1, 0, 0)).max() < 1e-12
    turned = T(50) @ R("z", 25) @ T(60, 0, -70) @ R("y", -35) @ F((0, 0, -80), (0, 90, 0))
    assert close(pose_of(chain, (*robot, 25, -35)), flange @ turned)
    assert [axis.name for axis in chain.axes][6:] == ["EF1", "EF2"]
    assert all(axis.held for axis in chain.axes[6:])


def test_gripper_referred_motion_exchanges_world_and_flange():
    data = {**NR6, "TROWO_POS": (900, 50, -200), "TROWO_RPY": (20, 30, 40)}
    axes = (10, -80, 60, 20, 30, 40)
    plain = chain_of(data)
    gripper = chain_of(data, kinematic="gripper", extra="$TC_DP3[1,1]=120\n$TC_DP4[1,1]=13")
    assert close(pose_of(gripper, axes), np.linalg.inv(pose_of(plain, axes)) @ T(0, 13, 120))
    assert {axis.carries for axis in gripper.axes} == {"workpiece"}
    assert gripper.name != plain.name
    assert [entry.name for entry in read(robx_text(data)).kinematics()] == ["ROBX", "gripper"]


def test_gripper_referred_motion_with_a_track():
    data = {**NR6, "TROWO_POS": (900, 50, -200), "EXT_AXIS_VECTOR_1": (1, 0, 0), "EXT_AX_OFFSET": (10, 0, 0)}
    chain = chain_of(data, kinematic="gripper", axes_in=range(1, 8))
    axes = (10, -80, 60, 20, 30, 40)
    robot = pose_of(chain_of(data), axes)
    assert close(pose_of(chain, (*axes, 310)), np.linalg.inv(T(300) @ robot))
