"""Translation: worked numbers of the manuals, arrangements and wrists, sequence, zeros, additional axes, gripper."""

from __future__ import annotations

import numpy as np
import pytest

from chainbuild.robot import Robot
from tests.kit.robx_files import CC4, NR6, TE4_ARM, F, R, T, chain_of, close, pose_of


@pytest.mark.parametrize("package", ["ROBX", "TRAFO6"])
@pytest.mark.parametrize(
    ("axes", "position"),
    [
        ((0, 0, 0, 0), (1100, 0, 500)),
        ((0, -90, 90, 0), (800, 0, 800)),
        ((30, -60, 45, 20), (813.212306, 469.508344, 820.022186)),
    ],
)
def test_worked_four_axis_arm(package, axes, position):
    pose = pose_of(chain_of(TE4_ARM, package=package), axes)
    assert np.abs(pose[:3, 3] - position).max() < 1e-6
    # At zero X of the flange points along Y, Y along Z, Z along X; A4 is parallel to A3 and adds to the pitch.
    at_zero = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    turned = R("z", axes[0]) @ R("y", axes[1] + axes[2] + axes[3])
    assert np.abs(pose[:3, :3] - turned[:3, :3] @ at_zero).max() < 1e-12


def test_robot_and_elementary_matrices_agree():
    chain = chain_of(NR6)
    axes = (10, -50, 40, 30, 20, -70)
    pose = Robot(chain).fk(axes)
    expected = pose_of(chain, axes)
    assert np.abs(pose.translation * 1000 - expected[:3, 3]).max() < 1e-9
    assert np.abs(pose.rotation - expected[:3, :3]).max() < 1e-12


def test_manual_example_of_rpy():
    # A = -90, B = 90, C = -90: X4 = -Z1, Y4 = Y1, Z4 = X1.
    frame = F((0, 0, 0), (-90, 90, -90))
    assert np.allclose(frame[:3, :3], [[0, 0, 1], [0, 1, 0], [-1, 0, 0]], atol=1e-15)


@pytest.mark.parametrize(
    ("axes", "upper_arm", "forearm"),
    [((0, 0, 0), (0, 0, 1), (1, 0, 0)), ((0, 90, 0), (1, 0, 0), (0, 0, -1)), ((0, 0, 90), (0, 0, 1), (0, 0, -1))],
)
def test_manual_example_of_zero_points(axes, upper_arm, forearm):
    """Mechanical zero: upper arm upright, forearm level. MAMES = +90, -90 (ROBX manual 5.3.17)."""
    chain = chain_of({**NR6, "MAMES": (0, 90, -90, 0, 0, 0)})
    wrist = (*axes, 0, 0, 0)
    tip = pose_of(chain, wrist)[:3, 3]
    elbow_to_tip = 795 + 85
    expected = np.array((150, 0, 445)) + 700 * np.array(upper_arm) + elbow_to_tip * np.array(forearm)
    height = 115 * np.cross(forearm, (0, 1, 0))  # Z of P3: the offset of the forearm
    assert np.abs(tip - expected - height).max() < 1e-9


BASIC = {
    1: lambda q, *_: T(*q),
    2: lambda q, a, b: T(y=q[0]) @ T(x=a) @ R("y", q[1]) @ T(x=b) @ R("y", q[2]),
    3: lambda q, a, b: R("z", q[0]) @ T(x=a) @ R("y", q[1]) @ T(x=b) @ R("y", q[2]),
    4: lambda q, a, _: T(z=q[0]) @ T(y=q[1]) @ T(x=a) @ R("y", q[2]),
    5: lambda q, a, _: R("z", q[0]) @ T(x=a) @ R("y", q[1]) @ T(x=q[2]),
    6: lambda q, a, _: R("z", q[0]) @ T(z=q[1]) @ T(x=a + q[2]),
    7: lambda q, a, b: R("z", q[0]) @ T(x=a) @ R("y", q[1]) @ T(x=b) @ R("z", q[2]),
}


@pytest.mark.parametrize("wrist", [2, 3, 5, 6])
@pytest.mark.parametrize("main", sorted(BASIC))
def test_six_axes(main, wrist):
    a45, d45 = ((40, 55), (0, 70)) if wrist > 3 else ((0, 0), (0, 0))
    alpha = (-90, 90) if wrist in (2, 5) else (-70, 55)
    data = {
        **NR6,
        "MAIN_AXES": main,
        "WRIST_AXES": wrist,
        "MAIN_LENGTH_AB": (130, 420),
        "TROWO_POS": (11, -22, 33),
        "TROWO_RPY": (15, 25, -35),
        "TIRORO_RPY": (20, -30, 40),
        "TX3P3_POS": (300, 21, 32),
        "TX3P3_RPY": (10, 70, -25),
        "TFLWP_POS": (5, 6, 95),
        "TFLWP_RPY": (35, -45, 55),
        "TTCFL_POS": (7, 8, 9),
        "TTCFL_RPY": (-15, 5, 65),
        "DHPAR4_5A": a45,
        "DHPAR4_5D": d45,
        "DHPAR4_5ALPHA": alpha,
        "MAMES": (5, -6, 7, -8, 9, -10),
        "AXES_DIR": (-1, 1, -1, 1, -1, -1),
    }
    axes = np.array((31, -47, 53, 71, -37, 113), dtype=float)
    q = axes * data["AXES_DIR"] - data["MAMES"]
    expected = (
        F((11, -22, 33), (15, 25, -35))
        @ F((0, 0, 445), (20, -30, 40))
        @ BASIC[main](q[:3], 130, 420)
        @ F((300, 21, 32), (10, 70, -25))
        @ (R("z", q[3]) @ T(a45[0], 0, d45[0]) @ R("x", alpha[0]))
        @ (R("z", q[4]) @ T(a45[1], 0, d45[1]) @ R("x", alpha[1]))
        @ R("z", q[5])
        @ F((5, 6, 95), (35, -45, 55))
        @ F((7, 8, 9), (-15, 5, 65))
    )
    chain = chain_of(data)
    assert close(pose_of(chain, axes), expected)
    assert [axis.name for axis in chain.axes] == ["A1", "A2", "A3", "A4", "A5", "A6"]


@pytest.mark.parametrize("main", sorted(BASIC))
def test_five_axes(main):
    data = {
        **NR6,
        "MAIN_AXES": main,
        "NUM_AXES": 5,
        "TX3P3_POS": (300, 21, 32),
        "TFLWP_POS": (0, 0, 95),
        "TFLWP_RPY": (35, 0, 0),
    }
    axes = np.array((31, -47, 53, 71, -37), dtype=float)
    expected = (
        F((0, 0, 445))
        @ BASIC[main](axes[:3], 150, 700)
        @ F((300, 21, 32), (0, 90, 0))
        @ (R("z", 71) @ R("x", -90) @ R("z", -37))
        @ F((0, 0, 95), (35, 0, 0))
    )
    chain = chain_of(data)
    assert close(pose_of(chain, axes), expected)
    assert (chain.task, chain.tool_axis) == ("direction", "x")


@pytest.mark.parametrize("main", sorted(BASIC))
def test_four_axes(main):
    data = {**TE4_ARM, "MAIN_AXES": main, "TX3P3_POS": (300, 21, 32), "TX3P3_RPY": (0, 90, 0)}
    axes = np.array((31, -47, 53, 71), dtype=float)
    expected = (
        F((0, 0, 500))
        @ BASIC[main](axes[:3], 300, 300)
        @ F((300, 21, 32), (0, 90, 0))
        @ R("z", 71)
        @ F((200, 0, 0), (0, -90, 180))
    )
    chain = chain_of(data)
    assert close(pose_of(chain, axes), expected)
    assert len(chain.axes) == 4
    assert chain.task == "pose"


@pytest.mark.parametrize("sequence", [(4, 1, 2, 3), (2, 1, 3, 4), (3, 1, 2, 4)])
def test_manual_examples_of_axis_sequence(sequence):
    """CC arms whose lift is another input axis (ROBX manual 5.3.15, examples 1 and 2): only the names move."""
    plain = chain_of(CC4)
    changed = chain_of({**CC4, "AXIS_SEQ": sequence})
    internal = (120, 35, -25, 15)
    machine = [0.0] * 4
    for value, number in zip(internal, sequence, strict=True):
        machine[number - 1] = value
    assert close(pose_of(changed, machine), pose_of(plain, internal))
    assert [joint.name for joint in changed.joints] == [f"A{number}" for number in sequence]
    assert [axis.name for axis in changed.axes] == ["A1", "A2", "A3", "A4"]
    assert [axis.kind for axis in changed.axes].index("linear") == sequence[0] - 1


def test_parallelogram_keeps_the_forearm_while_the_shoulder_moves():
    data = {**NR6, "SPECIAL_KIN": 2, "AXES_DIR": (1, 1, -1, 1, 1, 1), "MAMES": (0, 90, 90, 0, 0, 0)}
    chain = chain_of(data)
    axes = np.array((25, 10, -40, 0, 0, 0), dtype=float)
    q2, q3 = axes[1] - 90, -axes[2] - 90
    expected = (
        F((0, 0, 445))
        @ R("z", 25)
        @ T(150)
        @ R("y", q2)
        @ T(700)
        @ R("y", q3 - q2)
        @ F((795, 0, 115), (0, 90, 0))
        @ T(z=85)
    )
    assert close(pose_of(chain, axes), expected)
    shoulder = axes + np.array((0, 17, 0, 0, 0, 0))
    assert np.abs(pose_of(chain, shoulder)[:3, :3] - expected[:3, :3]).max() < 1e-12


def test_angle_modes_and_tool_axis_follow_tool_dir():
    for tool_dir, mode, axis in ((0, "orirpy", "x"), (-1, "orirpy", "x"), (1, "orirpy2", "z")):
        chain = chain_of({**NR6, "TOOL_DIR": tool_dir})
        assert (chain.angle_mode, chain.tool_axis) == (mode, axis)


def test_frames_of_the_chain():
    chain = chain_of({**NR6, "TTCFL_POS": (1, 2, 3)})
    frames = {frame.name: frame for frame in chain.frames}
    assert set(frames) == {"base", "flange", "tool", "workpiece"}
    assert frames["flange"].link == frames["tool"].link == "A6_link"
    assert frames["flange"].T_link_frame[:3, 3] == pytest.approx((0, 0, 0.085))
    assert frames["tool"].T_link_frame[:3, 3] == pytest.approx((0.001, 0.002, 0.088))
    assert frames["workpiece"].link == "base"
