"""Hand formulas of the drilling and milling heads: KIN_TYP 2, 3, 4, 5, 6, 7, 9, 17, 25, 28.

Each function: raw HD values, axes in channel order [mm, deg], tool length [mm], choices -> 4x4 tool in workpiece.
"""

from __future__ import annotations

from collections.abc import Sequence

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
    less_offset,
    rot_x,
    rot_y,
    rot_z,
    shift,
    sign_of,
    sind,
    static,
)


def kin2(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of a fork head: A carries B, HD2 and HD3 lead from B back to A (KIN_TYP manual 2.2)."""
    hd, (x, y, z, a, b) = Head(param), expect_axes(axes, 5)
    named = chosen_sign(conv, "named_offset_sign")
    lead_x, lead_y = named * hd[3], named * hd[2]
    slide = shift(x, y, z)
    if choice(conv, "kin2_slide_point") == "b_axis_at_zero":
        slide = slide @ shift(lead_x, lead_y, 0.0)
    return chain(slide, rot_x(a), shift(-lead_x, -lead_y, 0.0), rot_y(b), shift(0.0, 0.0, -hd[1] - tool_length_mm))


def _double_spindle(hd: Head, turn_deg: float, x_offset: float, tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the B turn and the offsets of one spindle, measured with its tool pointing down."""
    y_offset = -hd[2] * chosen_sign(conv, "head_y_offset_sign")
    return chain(rot_y(turn_deg), shift(x_offset, y_offset, -hd[1] - tool_length_mm))


def kin3(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of the upper spindle of a double-spindle head (KIN_TYP manual 2.3)."""
    hd, (x, y, z, b) = Head(param), expect_axes(axes, 4)
    turn = b - 180.0 if choice(conv, "kin3_b_value") == "drive" else b
    x_offset = -hd[3] * chosen_sign(conv, "named_offset_sign") * chosen_sign(conv, "kin3_offset_zero")
    return shift(x, y, z) @ _double_spindle(hd, turn, x_offset, tool_length_mm, conv)


def kin4(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of the lower spindle of a double-spindle head (KIN_TYP manual 2.4)."""
    hd, (x, y, z, b) = Head(param), expect_axes(axes, 4)
    x_offset = -hd[3] * chosen_sign(conv, "named_offset_sign")
    return shift(x, y, z) @ _double_spindle(hd, b, x_offset, tool_length_mm, conv)


def _cross_head_h(hd: Head, conv: Conv) -> float:
    """Returns the distance reference point to C axis of the active spindle: HD2 or HD3 [mm]."""
    pairs = choice(conv, "kin5_spindle_pairs")
    if pairs == "sum":
        return hd[2] + hd[3]
    adjacent, opposite = cosd(hd[5] - 45.0) > 0.0, abs(cosd(hd[5])) >= abs(sind(hd[5]))
    return hd[2] if (adjacent if pairs == "adjacent" else opposite) else hd[3]


def kin5(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of a cross head: spindle along +Y turned by C + HD5 (KIN_TYP manual 2.5)."""
    hd, (x, y, z, c) = Head(param), expect_axes(axes, 4)
    h = -_cross_head_h(hd, conv) * chosen_sign(conv, "kin5_h_sign")
    height = -hd[4] * chosen_sign(conv, "kin5_hd4_sign")
    crank = shift(h, hd[1], height)
    return chain(
        shift(x, y, z), static(hd, conv), rot_z(c + hd[5]), crank, rot_x(90.0), shift(0.0, 0.0, -tool_length_mm)
    )


def kin6(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of an underfloor cutter: tip up, spindle at +Y of the C axis (KIN_TYP manual 2.6)."""
    hd, (x, y, z, c) = Head(param), expect_axes(axes, 4)
    named = chosen_sign(conv, "named_offset_sign")
    pivot = shift(-named * hd[9], -named * hd[10], 0.0)
    height = -hd[2] * chosen_sign(conv, "kin6_hd2_sign")
    turn = rot_z(c + chosen_sign(conv, "kin6_hd4_sign") * hd[4])
    turned = turn @ pivot if choice(conv, "kin6_a_axis_offset") == "turns_with_c" else pivot @ turn
    spindle = chain(shift(0.0, hd[3], height), rot_x(180.0), shift(0.0, 0.0, -tool_length_mm))
    return chain(shift(x, y, z), static(hd, conv), turned, spindle)


def _hand_set_head(hd: Head, c_deg: float, tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the C turn, the cranks HD5, HD6 and the hand-set A = +HD3 of types 7 and 17."""
    named = chosen_sign(conv, "named_offset_sign")
    crank_y = shift(0.0, -named * hd[5], -hd[2])
    if choice(conv, "kin7_hd6_place") == "inside_c":
        turned = chain(rot_z(c_deg), shift(-named * hd[6], 0.0, 0.0), crank_y)
    else:
        turned = chain(shift(named * hd[6], 0.0, 0.0), rot_z(c_deg), crank_y)
    return chain(static(hd, conv), turned, rot_x(hd[3]), shift(0.0, 0.0, -hd[1] - tool_length_mm))


def kin7(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of a drilling head with C and a hand-set A (KIN_TYP manual 2.7)."""
    hd, (x, y, z, c) = Head(param), expect_axes(axes, 4)
    return shift(x, y, z) @ _hand_set_head(hd, less_offset(c, hd[4], conv), tool_length_mm, conv)


def kin17(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of a drilling head whose C and A are both set by hand (KIN_TYP manual 2.15)."""
    hd, (x, y, z) = Head(param), expect_axes(axes, 3)
    return shift(x, y, z) @ _hand_set_head(hd, hd[4], tool_length_mm, conv)


def _ca_head(hd: Head, c_deg: float, a_deg: float, reach_mm: float, conv: Conv) -> Matrix:
    """Returns the C/A head shared by types 9, 25, 28 up to a point `reach_mm` below the A axis."""
    pivot = chosen_sign(conv, "c_pivot_sign")
    tool_y = -hd[9] * chosen_sign(conv, "named_offset_sign")
    return chain(
        static(hd, conv),
        rot_z(c_deg),
        shift(-pivot * hd[6], -pivot * hd[5], -hd[2]),
        rot_x(a_deg),
        shift(0.0, tool_y, -reach_mm),
    )


def kin9(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of the C/A drilling and milling head (KIN_TYP manual 2.9)."""
    hd, (x, y, z, c, a) = Head(param), expect_axes(axes, 5)
    c_in, a_in = less_offset(c, hd[4], conv), less_offset(a, hd[3], conv)
    return shift(x, y, z) @ _ca_head(hd, c_in, a_in, hd[1] + tool_length_mm, conv)


def kin25(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of a plasma or laser head whose gap grows with the tilt (KIN_TYP manual 2.21)."""
    hd, (x, y, z, c, a) = Head(param), expect_axes(axes, 5)
    c_in, a_in = less_offset(c, hd[4], conv), less_offset(a, hd[3], conv)
    lean = cosd(a_in)
    if abs(lean) < 1e-9:
        raise ValueError("type 25: the beam is parallel to the sheet")
    gap_only = choice(conv, "kin25_length") == "gap"
    reach = hd[1] + tool_length_mm / lean if gap_only else (hd[1] + tool_length_mm) / lean
    return shift(x, y, z) @ _ca_head(hd, c_in, a_in, reach, conv)


def _ratio(numerator: float, denominator: float, when_unset: float) -> float:
    """Returns a gear ratio; 0/0 means not configured, any other zero divisor is a ValueError."""
    if denominator == 0.0:
        if numerator == 0.0:
            return when_unset
        raise ValueError("type 28: gear factor with a zero denominator")
    return numerator / denominator


def kin28_gear(param: Params) -> tuple[float, float, float]:
    """Returns k_ca, k_a and the zero offset NP0 [deg] of AM = AW*k_a + NP0 + k_ca*CW (KIN_TYP manual 2.22)."""
    hd = Head(param)
    k_ca = _ratio(hd.raw(12), hd.raw(13), 0.0)
    k_a = _ratio(hd.raw(16), hd.raw(17), 1.0)
    return k_ca, k_a, hd[11]


def kin28_drives(param: Params, c_deg: float, a_deg: float) -> tuple[float, float]:
    """Returns the drive values CM, AM that belong to the programmed head angles, signs on the head's side."""
    k_ca, k_a, zero = kin28_gear(param)
    return c_deg, a_deg * k_a + zero + k_ca * c_deg


def kin28(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of the geared C/A head (KIN_TYP manual 2.22)."""
    hd, (x, y, z, c, a) = Head(param), expect_axes(axes, 5)
    sign_c, sign_a = sign_of(hd.raw(14)), sign_of(hd.raw(15))
    signed_drives = choice(conv, "gear_flag_place") == "before_gear"
    k_ca, k_a, zero = kin28_gear(param)
    if choice(conv, "kin28_axis_values") == "drives":
        if k_a == 0.0:
            raise ValueError("type 28: the gear factor of A is zero")
        if signed_drives:
            c, a = sign_c * c, sign_a * a
        a = (a - zero - k_ca * c) / k_a
    if signed_drives:
        c_in, a_in = less_offset(c, hd[4], conv), less_offset(a, hd[3], conv)
    else:
        c_in, a_in = directed(c, sign_c, hd[4], conv), directed(a, sign_a, hd[3], conv)
    return shift(x, y, z) @ _ca_head(hd, c_in, a_in, hd[1] + tool_length_mm, conv)
