"""Hand formulas of saws, bevel and swivel heads: KIN_TYP 8, 10, 11, 16, 18, 22, 30, 33, 70, 76, 207.

Each function: raw HD values, axes in channel order [mm, deg], tool length [mm], choices -> 4x4 tool in workpiece.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from .kin_heads_base import (
    Conv,
    Head,
    Matrix,
    Params,
    chain,
    choice,
    chosen_sign,
    cosd,
    directed,
    expect_axes,
    flag_sign,
    less_offset,
    rot_about,
    rot_x,
    rot_y,
    rot_z,
    shift,
    sign_of,
    sind,
    static,
)


def _saw(hd: Head, c_deg: float, a_deg: float, tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the saw head shared by types 8, 10, 18, 207: at a = 90 the spindle lies along Y, its clamp at +Y."""
    named = chosen_sign(conv, "named_offset_sign")
    spindle = -hd[2] * chosen_sign(conv, "saw_hd2_sign") - tool_length_mm
    pivot = shift(-named * hd[9], -named * hd[10], -hd[3])
    return chain(static(hd, conv), rot_z(c_deg), pivot, rot_x(a_deg), shift(0.0, 0.0, spindle))


def kin8(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of a saw with C and a hand-set A = HD4 (KIN_TYP manual 2.8)."""
    hd, (x, y, z, c) = Head(param), expect_axes(axes, 4)
    return shift(x, y, z) @ _saw(hd, less_offset(c, hd[5], conv), hd[4], tool_length_mm, conv)


def kin10(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of a saw with the axes C and A (KIN_TYP manual 2.10)."""
    hd, (x, y, z, c, a) = Head(param), expect_axes(axes, 5)
    c_in, a_in = less_offset(c, hd[5], conv), less_offset(a, hd[4], conv)
    return shift(x, y, z) @ _saw(hd, c_in, a_in, tool_length_mm, conv)


def kin18(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of a saw whose C = HD5 and A = HD4 are set by hand (KIN_TYP manual 2.16)."""
    hd, (x, y, z) = Head(param), expect_axes(axes, 3)
    return shift(x, y, z) @ _saw(hd, hd[5], hd[4], tool_length_mm, conv)


def kin207(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of an oblique cutter, its X and Y read in the cutting plane Z0 = HD11 (KIN_TYP manual 2.40)."""
    hd, (x, y, z, c) = Head(param), expect_axes(axes, 4)
    c_in = less_offset(c, hd[5], conv)
    pose = shift(x, y, z) @ _saw(hd, c_in, hd[4], tool_length_mm, conv)
    point = choice(conv, "kin207_programmed_point")
    if point == "tip":
        return pose
    plunge = (rot_z(c_in) @ rot_x(hd[4]))[:3, 1]
    if abs(plunge[2]) < 1e-9:
        raise ValueError("type 207: the plunge direction is parallel to the cutting plane")
    tip_z = float(pose[2, 3])
    plane = hd[11] if choice(conv, "kin207_z0") == "absolute" else hd[11] + tip_z - z
    pose[:3, 3] += plunge * ((plane - tip_z) / plunge[2])
    pose[2, 3] = plane if point == "slid_xyz" else tip_z
    return pose


def kin11(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of a head with an inclined B axis over a workpiece that turns about A (KIN_TYP manual 2.11)."""
    hd, (x, y, z, a, b) = Head(param), expect_axes(axes, 5)
    axis_b = (0.0, chosen_sign(conv, "kin11_tilt_sign") * sind(hd[3]), cosd(hd[3]))
    reach = hd[2] - tool_length_mm
    if choice(conv, "kin11_ideal_length") == "with_hd1":
        reach -= hd[1]
    tool = chain(shift(x, y, 0.0), rot_about(axis_b, b), shift(0.0, 0.0, reach))
    # The slide Z carries the workpiece, so it runs against the workpiece's own Z. The sense of A is that of every
    # rotary axis under a workpiece; its convention is listed with the table types.
    sense = {"right_handed": 1.0, "left_handed": -1.0}[conv.get("table_rotary_sense", "right_handed")]
    workpiece = chain(shift(0.0, 0.0, -z), rot_x(sense * a))
    return np.asarray(np.linalg.inv(workpiece) @ tool, dtype=np.float64)


def kin16(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of a B/A swivel head: B carries A (KIN_TYP manual 2.14)."""
    hd, (x, y, z, b, a) = Head(param), expect_axes(axes, 5)
    b_in = directed(b, sign_of(hd.raw(10)), hd[8], conv)
    a_in = directed(a, sign_of(hd.raw(9)), hd[7], conv)
    named, down = chosen_sign(conv, "named_offset_sign"), -chosen_sign(conv, "kin16_heights")
    return chain(
        shift(x, y, z),
        shift(-named * hd[2], -named * hd[3], 0.0),
        rot_y(b_in),
        shift(chosen_sign(conv, "kin16_hd5_sign") * hd[5], 0.0, down * hd[4]),
        rot_x(a_in),
        shift(0.0, named * hd[6], down * hd[1] - tool_length_mm),
    )


def kin22(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of an A/B head with one pivot over an X/Y table (KIN_TYP manual 2.19)."""
    hd, (x, y, z, a, b) = Head(param), expect_axes(axes, 5)
    coded = sign_of if choice(conv, "sign_coding") == "plus_minus_one" else flag_sign
    turn_a, turn_b = rot_x(coded(hd.raw(4)) * a), rot_y(coded(hd.raw(5)) * b)
    turns = turn_a @ turn_b if choice(conv, "kin22_axis_order") == "a_outside" else turn_b @ turn_a
    # The table's X and Y run against the workpiece axes: seen from the workpiece the tool moves by +X, +Y.
    return chain(shift(x, y, z), turns, shift(0.0, 0.0, -hd[1] - tool_length_mm))


def kin30(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of a head with A only (KIN_TYP manual 2.23, parameter table from the vendor's web pages)."""
    hd, (x, y, z, a) = Head(param), expect_axes(axes, 4)
    named = chosen_sign(conv, "named_offset_sign")
    a_in = directed(a, sign_of(hd.raw(4)), hd[5], conv)
    return chain(
        shift(x, y, z),
        shift(-named * hd[6], -named * hd[7], -hd[8]),
        rot_x(a_in),
        shift(-named * hd[2], -named * hd[3], -hd[1] - tool_length_mm),
    )


def kin33(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of a bevel head whose tool point stands still under C and A (KIN_TYP manual 2.24)."""
    hd, (x, y, z, c, a) = Head(param), expect_axes(axes, 5)
    s, u = sind(hd[3]), cosd(hd[3])
    axis_a = {
        "xz_plus": (s, 0.0, u),
        "xz_minus": (-s, 0.0, u),
        "yz_plus": (0.0, s, u),
        "yz_minus": (0.0, -s, u),
    }[choice(conv, "kin33_tilt_axis")]
    k = chosen_sign(conv, "static_offset_sign")
    length = tool_length_mm if choice(conv, "kin33_tool_length") == "along_tool" else 0.0
    return chain(
        shift(x, y, z),
        shift(k * hd[4], k * hd[5], k * hd[6]),
        rot_z(c + 180.0 * hd.raw(7)),
        rot_about(axis_a, a),
        shift(0.0, 0.0, -length),
    )


def kin70_machine_angles(b_deg: float, a_deg: float, cv_deg: float) -> tuple[float, float]:
    """Returns the machine angles b, a [deg] whose tool vector is the programmed one turned by CV about Z."""
    v = (rot_z(cv_deg) @ rot_y(b_deg) @ rot_x(a_deg))[:3, 2]
    lift = math.degrees(math.asin(max(-1.0, min(1.0, -float(v[1])))))
    if cosd(a_deg) < 0.0:
        return math.degrees(math.atan2(-v[0], -v[2])), 180.0 - lift
    return math.degrees(math.atan2(v[0], v[2])), lift


def kin70(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of a B/A head turned by HD14 with the virtual axis CV (KIN_TYP manual 2.33)."""
    hd, (x, y, z, b, a, cv) = Head(param), expect_axes(axes, 6)
    b_in = directed(b, sign_of(hd.raw(10)), hd[8], conv)
    a_in = directed(a, sign_of(hd.raw(9)), hd[7], conv)
    if choice(conv, "kin70_cv") == "programmed":
        b_in, a_in = kin70_machine_angles(b_in, a_in, cv)
    k = chosen_sign(conv, "kin70_lateral_sign")
    mount = rot_z(chosen_sign(conv, "kin70_hd14_sign") * hd[14])
    lateral = shift(-k * hd[2], -k * hd[3], 0.0)
    head = mount @ lateral if choice(conv, "kin70_offset_place") == "inside_hd14" else lateral @ mount
    return chain(
        shift(x, y, z),
        head,
        rot_y(b_in),
        shift(k * hd[5], 0.0, -hd[4]),
        rot_x(a_in),
        shift(0.0, k * hd[6], -hd[1] - tool_length_mm),
    )


def kin76(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the programmed pose of a mechanically compensated bevel head, spatial C and A (KIN_TYP manual 2.34)."""
    hd, (x, y, z, c, a) = Head(param), expect_axes(axes, 5)
    k = chosen_sign(conv, "kin76_offset_sign")
    return chain(
        shift(x, y, z),
        shift(k * hd[8], k * hd[9], k * hd[10]),
        rot_z(c),
        rot_x(a),
        shift(0.0, 0.0, -hd[1] - tool_length_mm),
    )
