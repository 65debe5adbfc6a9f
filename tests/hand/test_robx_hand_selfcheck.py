"""Checks of the hand formulas against numbers printed in the manual and poses of independent code."""

from __future__ import annotations

import itertools
import json
import re
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.kit.paths import PACKAGE, REFERENCE

from .robx_hand import orirpy2_deg, orirpy_deg, parallelogram_angle_deg, pose_mm, scara_c_deg
from .robx_parts import CONVENTIONS, DEFAULTS, Matrix, frame, rot_x, rot_y, rot_z, rpy

PACKAGE_DATA = PACKAGE / "data"

# The four-axis articulated arm of the forerunner package TE4 (TE4 manual, data of the 4-axis NR kinematic)
TE4_ARM: dict[str, Any] = {
    "KINCLASS": 1,
    "NUM_AXES": 4,
    "MAIN_AXES": 3,
    "WRIST_AXES": 1,
    "A4PAR": 1,
    "MAIN_LENGTH_AB": [300.0, 300.0],
    "TIRORO_POS": [0.0, 0.0, 500.0],
    "TX3P3_POS": [300.0, 0.0, 0.0],
    "TX3P3_RPY": [0.0, 0.0, -90.0],
    "TFLWP_POS": [200.0, 0.0, 0.0],
}
# A six-axis arm whose flange frame is WP turned so that X_FL = Z_WP (default TFLWP_RPY)
ARM: dict[str, Any] = {
    "NUM_AXES": 6,
    "MAIN_AXES": 3,
    "WRIST_AXES": 2,
    "MAIN_LENGTH_AB": [0.0, 500.0],
    "TX3P3_POS": [400.0, 0.0, 0.0],
    "TX3P3_RPY": [0.0, 90.0, 0.0],
    "TFLWP_POS": [0.0, 0.0, 80.0],
}
SCARA: dict[str, Any] = {
    "NUM_AXES": 4,
    "MAIN_AXES": 2,
    "A4PAR": 1,
    "MAIN_LENGTH_AB": [250.0, 200.0],
    "TIRORO_RPY": [0.0, 0.0, 90.0],  # Y_IRO up
    "TX3P3_RPY": [0.0, 0.0, -90.0],  # Z3 = Y_IRO
    "SPECIAL_FEATURE_MASK": 1,
}


def columns(T: Matrix) -> list[list[float]]:
    """Returns the directions of X, Y, Z."""
    return [list(np.round(T[:3, k], 9) + 0.0) for k in range(3)]


def machine_data(path: Path) -> dict[str, Any]:
    """Returns the ROBX data of a reference file, arrays as lists."""
    md: dict[str, Any] = {}
    for name, index, text in re.findall(r"\$MC_ROBX_(\w+?)(?:\[(\d+)\])?=(\S+)", path.read_text(encoding="utf-8")):
        number = float(text) if "." in text else int(text)
        if index:
            md.setdefault(name, list(DEFAULTS.get(name, [0] * 6)))[int(index)] = number
        else:
            md[name] = number
    return md


def test_rpy_example_of_section_4_2() -> None:
    X4, Y4, Z4 = columns(rpy([-90, 90, -90]))
    assert (X4, Y4, Z4) == ([0, 0, -1], [0, 1, 0], [1, 0, 0])


@pytest.mark.parametrize(
    ("axes", "origin"),
    [
        ([0, 0, 0, 0], [1100, 0, 500]),
        ([0, -90, 90, 0], [800, 0, 800]),
        ([30, -60, 45, 20], [813.212306, 469.508344, 820.022186]),
    ],
)
def test_te4_articulated_arm(axes: list[float], origin: list[float]) -> None:
    T = pose_mm(TE4_ARM, axes)
    assert np.abs(T[:3, 3] - origin).max() <= 1e-6
    if not any(axes):
        assert columns(T) == [[0, 1, 0], [0, 0, 1], [1, 0, 0]]


def test_mames_example_of_section_5_3_17() -> None:
    md = {**ARM, "MAMES": [0, 90, -90, 0, 0, 0]}
    T = pose_mm(md, [0, 0, 0, 0, 0, 0])  # upper arm vertical, forearm horizontal
    np.testing.assert_allclose(T[:3, 3], [480, 0, 500], atol=1e-9)


def test_table_example_of_section_8_2_3() -> None:
    l1, l2, l3, l4 = 700.0, 300.0, 110.0, 45.0
    md = {
        **ARM,
        "TRAFO_AXES_IN": [1, 2, 3, 4, 5, 6, 0, 0, 0, 7, 8, 0, 0, 0, 0],
        "EXT_ROT_AX_VECTOR_1": [0.0, 0.0, 1.0],
        "EXT_ROT_AX_VECTOR_2": [0.0, 1.0, 0.0],
        "EXT_ROT_JOINT_OFFSET_1": [l3, 0.0, 0.0],
        "EXT_ROT_BASE_OFFSET": [l1, 0.0, l2],
        "EXT_ROT_PART_OFFSET": [0.0, 0.0, l4],
    }
    bcs = pose_mm(ARM, [0] * 6)
    np.testing.assert_allclose(pose_mm(md, [0] * 8)[:3, 3], bcs[:3, 3] - [l1 + l3, 0, l2 + l4], atol=1e-9)
    # E1 = 90: the second axis turns over +Y of the base, the workpiece's X points along it
    turned = pose_mm(md, [0] * 6 + [90, 0])
    x, y, z = bcs[:3, 3] - [l1, l3, l2 + l4]
    np.testing.assert_allclose(turned[:3, 3], [y, -x, z], atol=1e-9)


def test_flange_axes_example_of_section_8_3_3() -> None:
    l1, l2, l3, l4 = 50.0, 120.0, 70.0, 35.0
    md = {
        **ARM,
        "TRAFO_AXES_IN": [1, 2, 3, 4, 5, 6, 0, 0, 0, 0, 0, 0, 7, 8, 0],
        "EXT_FL_ROT_AX_VECTOR_1": [0.0, 0.0, 1.0],
        "EXT_FL_ROT_AX_VECTOR_2": [0.0, 1.0, 0.0],
        "EXT_FL_ROT_JOINT_OFF_1": [l2, 0.0, -l3],
        "EXT_FL_ROT_BASE_OFFSET": [l1, 0.0, 0.0],
        "TTCFL_POS": [0.0, 0.0, -l4],
        "TTCFL_RPY": [0.0, 90.0, 0.0],
    }
    T_FL_TC = np.linalg.inv(pose_mm(ARM, [0] * 6)) @ pose_mm(md, [0] * 8)
    np.testing.assert_allclose(T_FL_TC[:3, 3], [l1 + l2, 0, -l3 - l4], atol=1e-9)
    assert columns(T_FL_TC)[2] == [1, 0, 0]  # Z_TC = X_FL


@pytest.mark.parametrize("name", ["robx_kr6r900_machine_dat", "robx_irb2600_12_165", "robx_genser_3_inclined"])
def test_reference_rows(name: str) -> None:
    md = machine_data(REFERENCE / f"{name}.tea")
    rows = json.loads((REFERENCE / f"{name}.json").read_text(encoding="utf-8"))["rows"]
    assert len(rows) >= 20
    for row in rows:
        T = pose_mm(md, row["axes"])
        assert np.abs(T[:3, 3] - row["p"]).max() <= 1e-6
        assert np.abs(T[:3, :3] - row["R"]).max() <= 1e-9


def test_tool_lengths_and_direction() -> None:
    md = {**ARM, "TC_DP3": 10.0, "TC_DP4": 20.0, "TC_DP5": 30.0}
    bare = np.linalg.inv(pose_mm(ARM, [0] * 6))
    for plane, xyz in ((17, [30, 20, 10]), (18, [20, 10, 30]), (19, [10, 30, 20])):
        tip = (bare @ pose_mm({**md, "G_PLANE": plane}, [0] * 6))[:3, 3]
        np.testing.assert_allclose(tip, xyz, atol=1e-9)
        for direction in (1, -1):
            tip = (bare @ pose_mm({**md, "G_PLANE": plane, "TOOL_DIR": direction}, [0] * 6))[:3, 3]
            np.testing.assert_allclose(tip, [-v for v in xyz], atol=1e-9)


def test_tool_rotation_turns_about_the_tip() -> None:
    md = {**ARM, "TC_DP5": 30.0, "CC_TOA_START_NUM": 2, "TC_DPC": [0.0, 10.0, 20.0, 30.0]}
    T = np.linalg.inv(pose_mm(ARM, [0] * 6)) @ pose_mm(md, [0] * 6)
    np.testing.assert_allclose(T, frame([30, 0, 0], [10, 20, 30]), atol=1e-9)
    vectors = {**ARM, "CC_TOA_START_NUM": -1, "TC_DPV": [-1.0, 0.0, 0.0], "TC_DPVN": [0.0, 1.0, 0.0]}
    T = np.linalg.inv(pose_mm(ARM, [0] * 6)) @ pose_mm(vectors, [0] * 6)
    np.testing.assert_allclose(T, rot_y(90.0), atol=1e-9)  # X to -Z, Y stays


def test_parallelogram_keeps_the_forearm_direction() -> None:
    md = {**ARM, "SPECIAL_KIN": 2}
    R = [pose_mm(md, [0, a2, 25, 0, 0, 0])[:3, :3] for a2 in (-40, 30)]
    np.testing.assert_allclose(R[0], R[1], atol=1e-12)
    alike = {**md, "AXES_DIR": [1, 1, -1, 1, 1, 1], "MAMES": [0, 90, 90, 0, 0, 0]}
    for choice in ("mcs", "elbow"):
        angle = parallelogram_angle_deg(alike, [0, 12, -30, 0, 0, 0], {"parallelogram_monitor": choice})
        assert angle == pytest.approx(162.0)


@pytest.mark.parametrize("z3", [-90.0, 90.0])
def test_absolute_c_follows_the_pose(z3: float) -> None:
    """Signed sum and C of the pose agree, whichever way A4 points; the offset is minus C at zero."""
    md = {**SCARA, "TX3P3_RPY": [0.0, 0.0, z3]}
    wrapped = {**md, "SPECIAL_FEATURE_MASK": 0}
    md["C_ANGLE_OFFSET"] = -scara_c_deg(wrapped, [0, 0, 0, 0])
    for axes in ([10, 20, 30, 40], [0, 170, 60, -20], [-5, -100, -80, 15]):
        absolute = scara_c_deg(md, axes, {"c_sum": "signed"})
        difference = (absolute - scara_c_deg(wrapped, axes)) % 360.0
        assert min(difference, 360.0 - difference) < 1e-9


def test_axis_sequence_of_section_5_3_15() -> None:
    plain = pose_mm(SCARA, [1, 20, 30, 40])
    np.testing.assert_allclose(pose_mm({**SCARA, "AXIS_SEQ": [2, 1, 3, 4, 5, 6]}, [20, 1, 30, 40]), plain, atol=1e-12)
    np.testing.assert_allclose(pose_mm({**SCARA, "AXIS_SEQ": [3, 1, 2, 4, 5, 6]}, [20, 30, 1, 40]), plain, atol=1e-12)
    # A4 parallel to A3: the lift may as well be the last axis, values 4, 1, 2, 3
    np.testing.assert_allclose(pose_mm({**SCARA, "AXIS_SEQ": [4, 1, 2, 3, 5, 6]}, [20, 30, 40, 1]), plain, atol=1e-12)


def test_upright_scara_reaches_as_drawn() -> None:
    T = pose_mm(SCARA, [50, 0, 0, 0])
    np.testing.assert_allclose(T[:3, 3], [450, 0, 50], atol=1e-9)
    T = pose_mm(SCARA, [50, 90, 0, 0])
    np.testing.assert_allclose(T[:3, 3], [250, 200, 50], atol=1e-9)


def test_gripper_motion_shows_the_fixed_tool_from_the_flange() -> None:
    md = {**ARM, "TROWO_POS": [-900.0, 50.0, 20.0]}
    axes = [10, -40, 60, 20, 30, 40]
    T_WO_FL = pose_mm(md, axes)
    T = pose_mm({**md, "GRIP_REL_MOVE": 1, "TC_DP3": 100.0}, axes)
    np.testing.assert_allclose(T_WO_FL @ T, frame([0, 0, 100], [0, 0, 0]), atol=1e-9)
    with pytest.raises(ValueError, match="six robot axes"):
        pose_mm({**TE4_ARM, "GRIP_REL_MOVE": 1}, [0, 0, 0, 0])


def test_linear_axes_carry_the_machine() -> None:
    md = {
        **ARM,
        "TRAFO_AXES_IN": [1, 2, 3, 4, 5, 6, 7, 0, 0, 0, 0, 0, 0, 0, 0],
        "EXT_AXIS_VECTOR_1": [0.0, 0.6, 0.8],
        "EXT_AX_OFFSET": [100.0, 0.0, 0.0],
        "TROWO_RPY": [0.0, 0.0, 30.0],
    }
    at_zero, moved = pose_mm(md, [0] * 6 + [100]), pose_mm(md, [0] * 6 + [200])
    np.testing.assert_allclose(moved[:3, 3] - at_zero[:3, 3], [0, 60, 80], atol=1e-9)


@pytest.mark.parametrize(("a", "b", "c"), list(itertools.product((-170, 20, 180), (-90, -35, 90), (-60, 180))))
def test_orientation_angles_rebuild_the_rotation(a: float, b: float, c: float) -> None:
    R = (rot_z(a) @ rot_y(b) @ rot_x(c))[:3, :3]
    np.testing.assert_allclose(rpy(orirpy_deg(R))[:3, :3], R, atol=1e-9)
    R = (rot_x(a) @ rot_y(b) @ rot_z(c))[:3, :3]
    A, B, C = orirpy2_deg(R)
    np.testing.assert_allclose((rot_x(A) @ rot_y(B) @ rot_z(C))[:3, :3], R, atol=1e-9)


BENT: dict[str, Any] = {"NUM_AXES": 6, "MAIN_LENGTH_AB": [100.0, 200.0], "TX3P3_POS": [30.0, 40.0, 50.0]}
SEQUENCE = {**BENT, "AXIS_SEQ": [2, 1, 3, 4, 5, 6], "AXES_DIR": [1, -1, 1, 1, 1, 1], "MAMES": [0, 5, 0, 0, 0, 0]}
NR = {
    **ARM,
    "TTCFL_POS": [7.0, 8.0, 9.0],
    "TFL_EXT_RPY": [0.0, 90.0, 0.0],
    "TC_DP3": 30.0,
    "TROWO_POS": [9.0, 5.0, 2.0],
}
COUPLED = {**ARM, "SPECIAL_KIN": 2, "MAMES": [0, 90, -90, 0, 0, 0]}
TABLE = {**NR, "TRAFO_AXES_IN": [1, 2, 3, 4, 5, 6, 7, 0, 0, 8, 0, 0, 0, 0, 0]}
# convention: a machine that uses it, by which every choice must give another pose
USERS: dict[str, dict[str, Any]] = {
    "tfl_ext": NR,
    "ss": {**BENT, "MAIN_AXES": 1},
    "cc_linear_sign": {**BENT, "MAIN_AXES": 2},
    "cc_rotary_sign": {**BENT, "MAIN_AXES": 2},
    "sc": {**BENT, "MAIN_AXES": 4},
    "cs": {**BENT, "MAIN_AXES": 6},
    "rr": {**BENT, "MAIN_AXES": 5},
    "nn": {**BENT, "MAIN_AXES": 7},
    "axes_dir_index": SEQUENCE,
    "special_kin_2": COUPLED,
    "table_origin": TABLE,
    "gripper_trowo": {**NR, "GRIP_REL_MOVE": 1},
    "gripper_flange_data": {**NR, "GRIP_REL_MOVE": 1},
    "leftover_joint_offset": {**TABLE, "EXT_ROT_JOINT_OFFSET_2": [5.0, 6.0, 7.0]},
    "tool_length_plane": {**NR, "G_PLANE": 18, "TC_DP4": 20.0},
    "dpvn_axis": {**ARM, "CC_TOA_START_NUM": -1, "TC_DPV": [1, 0, 0], "TC_DPVN": [0, 1, 0]},
    "tflwp_default_c": ARM,
}
TABLE_OF_CHOICES = tomllib.loads((PACKAGE_DATA / "conventions_robx.toml").read_text(encoding="utf-8"))


def test_defaults_are_those_of_the_convention_table() -> None:
    # Those that change no pose have no formula here.
    posed = {name: entry["default"] for name, entry in TABLE_OF_CHOICES.items() if entry.get("poses", True)}
    assert posed == CONVENTIONS


@pytest.mark.parametrize("name", sorted(USERS))
def test_every_choice_gives_another_pose(name: str) -> None:
    md = USERS[name]
    axes = [10, 20, 30, 40, 50, 60, 70, 80][: len([n for n in md.get("TRAFO_AXES_IN", range(1, 7)) if n])]
    poses = [pose_mm(md, axes, {name: choice}) for choice in TABLE_OF_CHOICES[name]["choices"]]
    for one, two in itertools.combinations(poses, 2):
        assert np.abs(one - two).max() > 1e-3


def test_every_choice_gives_another_c_or_angle() -> None:
    md = {**SCARA, "TX3P3_RPY": [0.0, 0.0, 90.0], "C_ANGLE_OFFSET": 15.0}
    axes = [1, 20, 30, 40]
    # X_FL = Z3 points down: A2 and A3 turn against it, A4 with it
    assert scara_c_deg(md, axes) == pytest.approx(75.0)
    assert scara_c_deg(md, axes, {"c_sum": "signed"}) == pytest.approx(-25.0)
    assert scara_c_deg(md, axes, {"c_offset": "add"}) == pytest.approx(105.0)
    assert parallelogram_angle_deg(COUPLED, [0, 12, -30, 0, 0, 0]) == pytest.approx(162.0)
    # q2 = -78, q3 = 60, elbow joint 138
    other = {"parallelogram_monitor": "elbow"}
    assert parallelogram_angle_deg(COUPLED, [0, 12, -30, 0, 0, 0], other) == pytest.approx(42.0)
