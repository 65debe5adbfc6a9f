"""Hand-derived forward kinematics of the ROBX transformation (mm and degrees), to check a translator against.

Every function takes `md`, the machine data by name without the prefix ROBX_ (arrays as lists), plus
`TRAFO_AXES_IN` (15 channel axis numbers, 0 = none), the tool (`TC_DP3`, `TC_DP4`, `TC_DP5`, `TC_DPC`, `TC_DPV`,
`TC_DPVN`, `G_PLANE`) and `GRIP_REL_MOVE` (1: gripper-referred motion is on). What is missing has the default in
`robx_parts.DEFAULTS`. `axes` holds the machine values (mm, deg) of the assigned inputs in the order of TRAFO_AXES_IN;
`conv` names a choice for readings the manual leaves open.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from .robx_parts import (
    Matrix,
    basic_axes,
    conventions,
    frame,
    get,
    rot_about,
    rpy,
    shift,
    tool_lengths,
    tool_rotation,
    unit,
    wrist,
)


def pose_mm(md: dict[str, Any], axes: Sequence[float], conv: dict[str, str] | None = None) -> Matrix:
    """Returns the TCP in the workpiece frame as a 4x4 matrix with its translation in mm."""
    c = conventions(conv)
    value = input_values(md, axes, c)
    if get(md, "GRIP_REL_MOVE", c):
        return gripper_pose(md, value, c)
    T_WO_TCP = flange(md, value, c) @ flange_to_tool(md, value, c) @ tool(md, c)
    return inverse(table(md, value, c)) @ T_WO_TCP


def input_values(md: dict[str, Any], axes: Sequence[float], c: dict[str, str]) -> dict[int, float]:
    """Returns the machine value of each assigned index of TRAFO_AXES_IN (5.1.4)."""
    assigned = md.get("TRAFO_AXES_IN")
    slots = range(get(md, "NUM_AXES", c)) if assigned is None else [i for i, n in enumerate(assigned) if n]
    if len(slots) != len(axes):
        raise ValueError(f"{len(slots)} axes assigned, {len(axes)} values")
    value = dict(zip(slots, (float(v) for v in axes), strict=True))
    flange_axes = any(i in value for i in (12, 13, 14))
    if flange_axes and get(md, "NUM_AXES", c) < 6:
        raise ValueError("axes at the flange need six robot axes (8.3.1)")
    if get(md, "GRIP_REL_MOVE", c):
        if get(md, "NUM_AXES", c) < 6:
            raise ValueError("gripper-referred motion needs six robot axes (9.2.1)")
        if any(i >= 9 for i in value) and c["gripper_extra_axes"] == "refused":
            raise ValueError("gripper-referred motion allows additional axes in the BCS only (9.1.3)")
    return value


def mathematical_values(md: dict[str, Any], value: dict[int, float], c: dict[str, str]) -> list[float]:
    """Returns q1, q2, ...: direction first, then the zero offset in the mathematical direction (5.3.15 to 5.3.17)."""
    seq, direction, mames = (get(md, name, c) for name in ("AXIS_SEQ", "AXES_DIR", "MAMES"))
    q = []
    for i in range(get(md, "NUM_AXES", c)):
        k = seq[i] - 1  # the input that serves as internal axis i + 1
        j = i if c["axes_dir_index"] == "internal" else k
        q.append(direction[j] * value[k] - mames[j])
    return q


def elbow_deg(md: dict[str, Any], q: Sequence[float], c: dict[str, str]) -> float:
    """Returns the third joint: with SPECIAL_KIN 2 the value of A3 is the forearm's pitch in space (5.2.3)."""
    if get(md, "SPECIAL_KIN", c) != 2:
        return q[2]
    if c["special_kin_2"] == "absolute_pitch":
        return q[2] - q[1]
    i = 1 if c["axes_dir_index"] == "internal" else get(md, "AXIS_SEQ", c)[1] - 1
    return float(q[2] - (q[1] + get(md, "MAMES", c)[i]))  # relative_at_zero


def linear_travel(md: dict[str, Any], value: dict[int, float], c: dict[str, str]) -> Matrix:
    """Returns the travel of the machine's base by the linear additional axes, in WO (8.1.2.2)."""
    travel = np.zeros(3)
    for i in range(3):
        if 6 + i in value:
            direction = unit(get(md, f"EXT_AXIS_VECTOR_{i + 1}", c))
            travel = travel + direction * (value[6 + i] - get(md, "EXT_AX_OFFSET", c)[i])
    return travel


def flange(md: dict[str, Any], value: dict[int, float], c: dict[str, str]) -> Matrix:
    """Returns T_WO_FL: base travel, TROWO, TIRORO, basic axes, TX3P3, wrist, TFLWP (5.3.2 to 5.3.5)."""
    q = mathematical_values(md, value, c)
    travel = linear_travel(md, value, c)
    T_WO_RO = frame(get(md, "TROWO_POS", c), get(md, "TROWO_RPY", c))
    if get(md, "GRIP_REL_MOVE", c) and c["gripper_trowo"] == "inverse":
        T_WO_RO = inverse(T_WO_RO)
    T_WO_IRO = (
        shift(travel[0], travel[1], travel[2]) @ T_WO_RO @ frame(get(md, "TIRORO_POS", c), get(md, "TIRORO_RPY", c))
    )
    T_IRO_P3 = basic_axes(md, q, elbow_deg(md, q, c), c)
    T_P3_X3 = frame(get(md, "TX3P3_POS", c), get(md, "TX3P3_RPY", c))
    T_WP_FL = frame(get(md, "TFLWP_POS", c), get(md, "TFLWP_RPY", c))
    return T_WO_IRO @ T_IRO_P3 @ T_P3_X3 @ wrist(md, q, c) @ T_WP_FL


def flange_axes(md: dict[str, Any], value: dict[int, float], c: dict[str, str]) -> Matrix:
    """Returns base offset, axis 1, offset, axis 2, offset, axis 3 behind the flange, in its directions (8.3.2.2)."""
    if not any(i in value for i in (12, 13, 14)):
        return np.eye(4)
    T = np.eye(4)
    before = ("EXT_FL_ROT_BASE_OFFSET", "EXT_FL_ROT_JOINT_OFF_1", "EXT_FL_ROT_JOINT_OFF_2")
    for i, name in enumerate(before):
        if c["leftover_joint_offset"] == "counts" or i == 0 or any(12 + k in value for k in range(i, 3)):
            T = T @ shift(*get(md, name, c))
        if 12 + i in value:
            angle = value[12 + i] - get(md, "EXT_FL_ROT_AX_OFFSET", c)[i]
            T = T @ rot_about(get(md, f"EXT_FL_ROT_AX_VECTOR_{i + 1}", c), angle)
    return T


def flange_to_tool(md: dict[str, Any], value: dict[int, float], c: dict[str, str]) -> Matrix:
    """Returns the frame along whose axes tool lengths act, seen from FL: flange axes, TTCFL, TFL_EXT (5.3.6, 6.1.3)."""
    carrier = frame(get(md, "TTCFL_POS", c), get(md, "TTCFL_RPY", c))
    turned = rpy(get(md, "TFL_EXT_RPY", c))
    if c["tfl_ext"] == "after_ttcfl":
        return flange_axes(md, value, c) @ carrier @ turned
    if c["tfl_ext"] == "after_fl":
        return turned @ flange_axes(md, value, c) @ carrier
    return flange_axes(md, value, c) @ carrier  # orientation_only: see tool()


def tool(md: dict[str, Any], c: dict[str, str]) -> Matrix:
    """Returns the TCP seen from the frame in which tool lengths act: lengths, then rotation about the tip (6.1.1)."""
    if c["tfl_ext"] == "orientation_only":
        return tool_lengths(md, c) @ rpy(get(md, "TFL_EXT_RPY", c)) @ tool_rotation(md, c)
    return tool_lengths(md, c) @ tool_rotation(md, c)


def table(md: dict[str, Any], value: dict[int, float], c: dict[str, str]) -> Matrix:
    """Returns T_WO_workpiece of the rotary axes under the workpiece (8.2.2.2); WO itself without such an axis."""
    if not any(i in value for i in (9, 10, 11)):
        return np.eye(4)
    origin = np.zeros(3)  # choice wo
    if c["table_origin"] in ("robot_base", "riding"):
        origin = origin + np.asarray(get(md, "TROWO_POS", c), dtype=float)
    if c["table_origin"] == "riding":
        origin = origin + linear_travel(md, value, c)
    T = shift(origin[0], origin[1], origin[2])
    before = ("EXT_ROT_BASE_OFFSET", "EXT_ROT_JOINT_OFFSET_1", "EXT_ROT_JOINT_OFFSET_2")
    for i, name in enumerate(before):
        if c["leftover_joint_offset"] == "counts" or i == 0 or any(9 + k in value for k in range(i, 3)):
            T = T @ shift(*get(md, name, c))
        if 9 + i in value:
            angle = value[9 + i] - get(md, "EXT_ROT_AX_OFFSET", c)[i]
            T = T @ rot_about(get(md, f"EXT_ROT_AX_VECTOR_{i + 1}", c), angle)
    return T @ shift(*get(md, "EXT_ROT_PART_OFFSET", c))


def gripper_pose(md: dict[str, Any], value: dict[int, float], c: dict[str, str]) -> Matrix:
    """Returns the fixed tool, standing on WO, seen from the flange that holds the workpiece (9.1.2)."""
    W = table(md, value, c)  # the table turns what stands on it: here the fixed tool
    T_FL_WO = inverse(flange(md, value, c))
    E = inverse(flange_axes(md, value, c))  # the flange axes turn what the robot carries: here the workpiece
    if c["gripper_flange_data"] == "unused":
        return E @ T_FL_WO @ W @ tool_lengths(md, c) @ tool_rotation(md, c)
    if c["gripper_flange_data"] == "robot_side":
        return inverse(flange_to_tool(md, value, c)) @ T_FL_WO @ W @ tool(md, c)
    carrier = flange_to_tool(md, {i: v for i, v in value.items() if i < 12}, c)
    return E @ T_FL_WO @ W @ carrier @ tool(md, c)  # tool_side


def inverse(T: Matrix) -> Matrix:
    """Returns the inverse of a rigid motion: transposed rotation, translation turned back."""
    R, p = T[:3, :3], T[:3, 3]
    inv = np.eye(4)
    inv[:3, :3] = R.T
    inv[:3, 3] = -(R.T @ p)
    return inv


def scara_c_deg(md: dict[str, Any], axes: Sequence[float], conv: dict[str, str] | None = None) -> float:
    """Returns the displayed angle C of a four-axis machine (5.3.19, 5.3.20).

    Absolute with SPECIAL_FEATURE_MASK bit 0 for CC, SC, CS whose A4 is parallel to the last rotary basic axis;
    otherwise the third ORIRPY angle of the pose in the BCS, in (-180, 180].
    """
    c = conventions(conv)
    value = input_values(md, axes, c)
    rotary = {2: (1, 2, 3), 4: (2, 3), 6: (0, 3)}.get(get(md, "MAIN_AXES", c), ())
    absolute = int(get(md, "SPECIAL_FEATURE_MASK", c)) & 1
    if not (absolute and rotary and get(md, "A4PAR", c) == 1 and get(md, "NUM_AXES", c) == 4):
        T_WO_TCP = flange(md, value, c) @ flange_to_tool(md, value, c) @ tool(md, c)
        return orirpy_deg(T_WO_TCP[:3, :3])[2]
    q = mathematical_values(md, value, c)
    total = sum(scara_sign(md, i, c) * q[i] for i in rotary)
    offset = float(get(md, "C_ANGLE_OFFSET", c))
    return total - offset if c["c_offset"] == "subtract" else total + offset


def scara_sign(md: dict[str, Any], i: int, c: dict[str, str]) -> float:
    """Returns the weight of internal axis i (from 0) in the absolute C: -1 where it turns against X_FL, if signed."""
    if c["c_sum"] == "plain":
        return 1.0
    # directions at mathematical zero, seen in P3, which is parallel to IRO there
    R_P3_X3 = rpy(get(md, "TX3P3_RPY", c))[:3, :3]
    x_fl = R_P3_X3 @ rpy(get(md, "TFLWP_RPY", c))[:3, 0]
    axis = np.array([0.0, 1.0, 0.0])  # CC and SC: about Y_IRO
    if get(md, "MAIN_AXES", c) == 2 and c["cc_rotary_sign"] == "minus":
        axis = -axis
    if get(md, "MAIN_AXES", c) == 6 and c["cs"] != "rotary_about_y":
        axis = np.array([0.0, 0.0, 1.0])
    if i == 3:  # A4 turns about Z3 (5.3.4)
        axis = R_P3_X3[:, 2]
    return -1.0 if float(axis @ x_fl) < -0.5 else 1.0


def parallelogram_angle_deg(md: dict[str, Any], axes: Sequence[float], conv: dict[str, str] | None = None) -> float:
    """Returns the angle watched by SW_LIMITS_PARALLEL on an arm with SPECIAL_KIN 2 (5.3.21)."""
    c = conventions(conv)
    value = input_values(md, axes, c)
    if c["parallelogram_monitor"] == "mcs":
        seq = get(md, "AXIS_SEQ", c)
        q2_dh = -value[seq[1] - 1] + 90.0
        q3_dh = value[seq[2] - 1] + 270.0
        return q3_dh - q2_dh
    return 180.0 - elbow_deg(md, mathematical_values(md, value, c), c)


def orirpy_deg(R: Matrix) -> tuple[float, float, float]:
    """Returns A, B, C with R = Rz(A) Ry(B) Rx(C), B in [-90, 90]; A = 0 where B = +-90 (4.2, 6.1.3)."""
    cos_b = math.hypot(R[0, 0], R[1, 0])  # first column: (cA cB, sA cB, -sB)
    b = math.atan2(-R[2, 0], cos_b)
    if cos_b < 1e-9:  # second row with A = 0: (0, cC, -sC)
        return 0.0, math.degrees(b), half_open(math.atan2(-R[1, 2], R[1, 1]))
    return half_open(math.atan2(R[1, 0], R[0, 0])), math.degrees(b), half_open(math.atan2(R[2, 1], R[2, 2]))


def orirpy2_deg(R: Matrix) -> tuple[float, float, float]:
    """Returns A, B, C with R = Rx(A) Ry(B) Rz(C), B in [-90, 90]; A = 0 where B = +-90 (6.1.3)."""
    cos_b = math.hypot(R[1, 2], R[2, 2])  # third column: (sB, -sA cB, cA cB)
    b = math.atan2(R[0, 2], cos_b)
    if cos_b < 1e-9:  # second row with A = 0: (sC, cC, 0)
        return 0.0, math.degrees(b), half_open(math.atan2(R[1, 0], R[1, 1]))
    return half_open(math.atan2(-R[1, 2], R[2, 2])), math.degrees(b), half_open(math.atan2(-R[0, 1], R[0, 0]))


def half_open(angle: float) -> float:
    """Returns the angle (rad) in degrees within (-180, 180]."""
    deg = math.degrees(angle)
    return 180.0 if deg <= -180.0 else deg
