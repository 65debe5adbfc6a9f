"""Hand-written building blocks of the ROBX chain: rotations, frames, basic axes, wrist and tool (mm and degrees).

Sources are sections of the ROBX manual (transformation 4100). Nothing here uses the package under test.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]

# Values before anything is set (ROBX manual 11.2); the last block (tool, programming) is neutral, not from the manual.
# TFLWP_RPY is absent: its third default is not legible and comes from the convention tflwp_default_c.
DEFAULTS: dict[str, Any] = {
    "KINCLASS": 1,
    "SPECIAL_KIN": 1,
    "MAIN_AXES": 1,
    "WRIST_AXES": 1,
    "NUM_AXES": 4,
    "A4PAR": 0,
    "MAIN_LENGTH_AB": [0.0, 500.0],
    "TX3P3_POS": [0.0, 0.0, 0.0],
    "TX3P3_RPY": [0.0, 0.0, 0.0],
    "TFLWP_POS": [0.0, 0.0, 0.0],
    "TIRORO_POS": [0.0, 0.0, 0.0],
    "TIRORO_RPY": [0.0, 0.0, 0.0],
    "TROWO_POS": [0.0, 0.0, 0.0],
    "TROWO_RPY": [0.0, 0.0, 0.0],
    "TTCFL_POS": [0.0, 0.0, 0.0],
    "TTCFL_RPY": [0.0, 0.0, 0.0],
    "TFL_EXT_RPY": [0.0, 0.0, 0.0],
    "DHPAR4_5A": [0.0, 0.0],
    "DHPAR4_5D": [0.0, 0.0],
    "DHPAR4_5ALPHA": [-90.0, 90.0],
    "MAMES": [0.0] * 6,
    "AXES_DIR": [1] * 6,
    "AXIS_SEQ": [1, 2, 3, 4, 5, 6],
    "CC_TOA_START_NUM": 0,
    "TOOL_DIR": 0,
    "SPECIAL_FEATURE_MASK": 0,
    "C_ANGLE_OFFSET": 0.0,
    "EXT_AXIS_VECTOR_1": [0.0, 0.0, 1.0],
    "EXT_AXIS_VECTOR_2": [0.0, 1.0, 0.0],
    "EXT_AXIS_VECTOR_3": [0.0, 0.0, 1.0],
    "EXT_AX_OFFSET": [0.0, 0.0, 0.0],
    "EXT_ROT_AX_VECTOR_1": [1.0, 0.0, 0.0],
    "EXT_ROT_AX_VECTOR_2": [1.0, 0.0, 0.0],
    "EXT_ROT_AX_VECTOR_3": [1.0, 0.0, 0.0],
    "EXT_ROT_AX_OFFSET": [0.0, 0.0, 0.0],
    "EXT_ROT_JOINT_OFFSET_1": [0.0, 0.0, 0.0],
    "EXT_ROT_JOINT_OFFSET_2": [0.0, 0.0, 0.0],
    "EXT_ROT_BASE_OFFSET": [0.0, 0.0, 0.0],
    "EXT_ROT_PART_OFFSET": [0.0, 0.0, 0.0],
    "EXT_FL_ROT_AX_VECTOR_1": [1.0, 0.0, 0.0],
    "EXT_FL_ROT_AX_VECTOR_2": [0.0, 1.0, 0.0],
    "EXT_FL_ROT_AX_VECTOR_3": [0.0, 0.0, 1.0],
    "EXT_FL_ROT_AX_OFFSET": [0.0, 0.0, 0.0],
    "EXT_FL_ROT_JOINT_OFF_1": [0.0, 0.0, 0.0],
    "EXT_FL_ROT_JOINT_OFF_2": [0.0, 0.0, 0.0],
    "EXT_FL_ROT_BASE_OFFSET": [0.0, 0.0, 0.0],
    # tool and programming: no ROBX data, neutral values
    "TC_DP3": 0.0,  # length 1
    "TC_DP4": 0.0,  # length 2
    "TC_DP5": 0.0,  # length 3
    "G_PLANE": 17,
    "TC_DPC": [0.0] * 10,  # TC_DPC1..TC_DPC10
    "TC_DPV": [0.0, 0.0, 0.0],  # TC_DPV3..TC_DPV5
    "TC_DPVN": [0.0, 0.0, 0.0],  # TC_DPVN3..TC_DPVN5
    "GRIP_REL_MOVE": 0,  # 1 after CC_GRIP_REL_MOVE_ON (9.2.1)
}

# First choice of every open reading; the meanings are in the package's convention table.
CONVENTIONS: dict[str, str] = {
    "tfl_ext": "after_ttcfl",
    "ss": "xyz",
    "cc_linear_sign": "plus",
    "cc_rotary_sign": "plus",
    "sc": "zy",
    "cs": "zx",
    "rr": "rot_rot_lin",
    "nn": "zyz",
    "axes_dir_index": "internal",
    "special_kin_2": "absolute_pitch",
    "parallelogram_monitor": "mcs",
    "table_origin": "robot_base",
    "gripper_trowo": "as_is",
    "gripper_flange_data": "unused",
    "leftover_joint_offset": "counts",
    "gripper_extra_axes": "refused",
    "tool_length_plane": "cyclic",
    "dpvn_axis": "y",
    "c_sum": "plain",
    "c_offset": "subtract",
    "tflwp_default_c": "180",
}


def conventions(conv: dict[str, str] | None) -> dict[str, str]:
    """Returns all conventions, with the given ones in place of the defaults."""
    unknown = set(conv or {}) - set(CONVENTIONS)
    if unknown:
        raise KeyError(f"unknown conventions {sorted(unknown)}")
    return {**CONVENTIONS, **(conv or {})}


def get(md: dict[str, Any], name: str, c: dict[str, str]) -> Any:
    """Returns the machine data value, or the manual's default (11.2)."""
    if name == "TFLWP_RPY" and name not in md:
        return [0.0, -90.0, float(c["tflwp_default_c"])]
    return md[name] if name in md else DEFAULTS[name]


def rot_x(angle_deg: float) -> Matrix:
    """Returns the 4x4 right-handed rotation about X (4.2)."""
    ca, sa = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return np.array([[1.0, 0, 0, 0], [0, ca, -sa, 0], [0, sa, ca, 0], [0, 0, 0, 1]])


def rot_y(angle_deg: float) -> Matrix:
    """Returns the 4x4 right-handed rotation about Y (4.2)."""
    ca, sa = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return np.array([[ca, 0, sa, 0], [0, 1.0, 0, 0], [-sa, 0, ca, 0], [0, 0, 0, 1]])


def rot_z(angle_deg: float) -> Matrix:
    """Returns the 4x4 right-handed rotation about Z (4.2)."""
    ca, sa = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return np.array([[ca, -sa, 0, 0], [sa, ca, 0, 0], [0, 0, 1.0, 0], [0, 0, 0, 1]])


def shift(x_mm: float, y_mm: float, z_mm: float) -> Matrix:
    """Returns the 4x4 translation (mm)."""
    return np.array([[1.0, 0, 0, x_mm], [0, 1, 0, y_mm], [0, 0, 1, z_mm], [0, 0, 0, 1]])


def unit(vector: Sequence[float]) -> Matrix:
    """Returns the vector at length 1; a zero vector is a ValueError."""
    v = np.asarray(vector, dtype=float)
    length = math.sqrt(float(v @ v))
    if length == 0.0:
        raise ValueError("direction vector is zero")
    return v / length


def rot_about(vector: Sequence[float], angle_deg: float) -> Matrix:
    """Returns the 4x4 right-handed rotation about a direction: component along v stays, the rest turns (8.2.2.2)."""
    v = unit(vector)
    ca, sa = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    T = np.eye(4)
    for k, e in enumerate(np.eye(3)):
        along = (v @ e) * v
        T[:3, k] = along + ca * (e - along) + sa * np.cross(v, e)
    return T


def rpy(angles_deg: Sequence[float]) -> Matrix:
    """Returns Rz(A) Ry(B) Rx(C), each about the axis already turned (4.2)."""
    return rot_z(angles_deg[0]) @ rot_y(angles_deg[1]) @ rot_x(angles_deg[2])


def frame(pos_mm: Sequence[float], rpy_deg: Sequence[float]) -> Matrix:
    """Returns a ROBX frame: translation in the parent's directions, then rotation (4.2)."""
    return shift(pos_mm[0], pos_mm[1], pos_mm[2]) @ rpy(rpy_deg)


def basic_axes(md: dict[str, Any], q: Sequence[float], q3_elbow: float, c: dict[str, str]) -> Matrix:
    """Returns T_IRO_P3 of the three basic axes (5.3.7, 5.3.8; NR 7.1, SC 7.2, CC 7.3).

    `q` are mathematical values; `q3_elbow` is the third joint after the parallelogram coupling (NR only).
    """
    q1, q2, q3 = q[0], q[1], q[2]
    A, B = get(md, "MAIN_LENGTH_AB", c)
    kind = get(md, "MAIN_AXES", c)
    if kind == 1:  # SS: three linear axes at right angles
        return shift(q1, q2, q3) if c["ss"] == "xyz" else shift(q3, q2, q1)
    if kind == 2:  # CC (7.3.3): everything parallel to Y_IRO, lengths along X
        s1 = 1.0 if c["cc_linear_sign"] == "plus" else -1.0
        s2 = 1.0 if c["cc_rotary_sign"] == "plus" else -1.0
        return shift(A, s1 * q1, 0) @ rot_y(s2 * q2) @ shift(B, 0, 0) @ rot_y(s2 * q3)
    if kind == 3:  # NR (7.1.3): A1 about Z, A2 and A3 about Y
        return rot_z(q1) @ shift(A, 0, 0) @ rot_y(q2) @ shift(B, 0, 0) @ rot_y(q3_elbow)
    if kind == 4:  # SC (7.2.3): A3 about Y, A1 and A2 linear
        return (shift(A, q2, q1) if c["sc"] == "zy" else shift(A + q2, q1, 0)) @ rot_y(q3)
    if kind == 5:
        return rr_axes(q1, q2, q3, A, c["rr"])
    if kind == 6:
        return cs_axes(q1, q2, q3, A, c["cs"])
    if kind == 7:  # NN: three rotary axes, two lengths
        last = rot_z(q3) if c["nn"] == "zyz" else rot_x(q3)
        return rot_z(q1) @ shift(A, 0, 0) @ rot_y(q2) @ shift(B, 0, 0) @ last
    raise ValueError(f"MAIN_AXES {kind}")


def rr_axes(q1: float, q2: float, q3: float, A: float, choice: str) -> Matrix:
    """Returns T_IRO_P3 of RR: one linear and two perpendicular rotary axes with one length (5.3.7, 5.3.8)."""
    if choice == "rot_rot_lin":
        return rot_z(q1) @ shift(A, 0, 0) @ rot_y(q2) @ shift(q3, 0, 0)
    if choice == "rot_lin_rot":
        return rot_z(q1) @ shift(A + q2, 0, 0) @ rot_y(q3)
    return shift(0, 0, q1) @ rot_z(q2) @ shift(A, 0, 0) @ rot_y(q3)  # lin_rot_rot


def cs_axes(q1: float, q2: float, q3: float, A: float, choice: str) -> Matrix:
    """Returns T_IRO_P3 of CS: one rotary and two linear axes with one length (5.3.7, 5.3.8)."""
    if choice == "zx":
        return rot_z(q1) @ shift(A + q3, 0, q2)
    if choice == "zy":
        return rot_z(q1) @ shift(A, q3, q2)
    return rot_y(q1) @ shift(A + q3, q2, 0)  # rotary_about_y


def wrist(md: dict[str, Any], q: Sequence[float], c: dict[str, str]) -> Matrix:
    """Returns T_X3_WP: Denavit-Hartenberg steps A4->A5 (index 0) and A5->A6 (index 1) (5.3.10 to 5.3.14, 7.1.5)."""
    n = get(md, "NUM_AXES", c)
    a, d, alpha = (get(md, f"DHPAR4_5{name}", c) for name in ("A", "D", "ALPHA"))
    T = rot_z(q[3])  # four axes: nothing follows A4
    if n >= 5:
        T = T @ shift(0, 0, d[0]) @ shift(a[0], 0, 0) @ rot_x(alpha[0]) @ rot_z(q[4])
    if n >= 6:
        T = T @ shift(0, 0, d[1]) @ shift(a[1], 0, 0) @ rot_x(alpha[1]) @ rot_z(q[5])
    return T


def by_plane(components: Sequence[float], plane: int, choice: str) -> Matrix:
    """Returns components (1, 2, 3) as a vector (x, y, z) for G17, G18, G19 (6.1.1; only G17 is printed there)."""
    one, two, three = components
    if plane == 17 or choice == "as_g17":
        return np.array([three, two, one], dtype=float)  # 1=Z, 2=Y, 3=X
    if choice == "cyclic":  # G18: 1=Y, 2=X, 3=Z; G19: 1=X, 2=Z, 3=Y
        return np.array([two, one, three] if plane == 18 else [one, three, two], dtype=float)
    # swapped: G18: 1=Y, 2=Z, 3=X; G19: 1=X, 2=Y, 3=Z
    return np.array([three, one, two] if plane == 18 else [one, two, three], dtype=float)


def tool_lengths(md: dict[str, Any], c: dict[str, str]) -> Matrix:
    """Returns the translation by the tool lengths (mm), negated where TOOL_DIR is +1 or -1 (6.1.1, 6.1.3)."""
    lengths = [float(get(md, name, c)) for name in ("TC_DP3", "TC_DP4", "TC_DP5")]
    v = by_plane(lengths, get(md, "G_PLANE", c), c["tool_length_plane"])
    if get(md, "TOOL_DIR", c) != 0:
        v = -v
    return shift(v[0], v[1], v[2])


def tool_rotation(md: dict[str, Any], c: dict[str, str]) -> Matrix:
    """Returns the tool's own rotation about its tip, from TC_DPC or from TC_DPV and TC_DPVN (6.1.1, 6.1.2)."""
    start = get(md, "CC_TOA_START_NUM", c)
    if start > 0:  # angles A, B, C in TC_DPC(n), (n+1), (n+2)
        return rpy(list(get(md, "TC_DPC", c))[start - 1 : start + 2])
    if start == 0:
        return np.eye(4)
    plane = get(md, "G_PLANE", c)
    d = by_plane(get(md, "TC_DPV", c), plane, c["tool_length_plane"])
    n = by_plane(get(md, "TC_DPVN", c), plane, c["tool_length_plane"])
    if not d.any():
        return np.eye(4)
    return vector_rotation(unit(list(d)), n, get(md, "TOOL_DIR", c) == 1, c["dpvn_axis"])


def vector_rotation(d: Matrix, normal: Matrix, nc: bool, choice: str) -> Matrix:
    """Returns the rotation whose tool direction is d (X, or Z with TOOL_DIR +1) and whose normal follows dpvn_axis."""
    T = np.eye(4)
    n = normal - (normal @ d) * d
    if math.sqrt(float(n @ n)) < 1e-9:  # no usable normal: smallest rotation of the tool direction to d
        start = np.array([0.0, 0, 1]) if nc else np.array([1.0, 0, 0])
        axis, cosine = np.cross(start, d), float(start @ d)
        sine = math.sqrt(float(axis @ axis))
        if sine < 1e-12:
            return rot_y(0.0 if cosine > 0 else 180.0)
        return rot_about(list(axis), math.degrees(math.atan2(sine, cosine)))
    n = unit(list(n))
    if choice == "y":
        columns = (np.cross(n, d), n, d) if nc else (d, n, np.cross(d, n))
    else:
        columns = (n, np.cross(d, n), d) if nc else (d, np.cross(n, d), n)
    T[:3, :3] = np.column_stack(columns)
    return T
