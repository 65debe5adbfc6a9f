"""Hand formulas of the cardanic heads KIN_TYP 59 (C/A) and 60 (C/B), with the saw and underfloor options of 59.

C turns about Z; the inclined axis lies at HD7 to Z, in the XZ plane (59) or the YZ plane (60). Units: mm and degrees.
"""

from __future__ import annotations

import math
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
    expect_axes,
    rot_about,
    rot_z,
    shift,
    sind,
)

Vector3 = tuple[float, float, float]


def machine_to_spatial(c_deg: float, tilt_deg: float, hd7_deg: float) -> tuple[float, float]:
    """Returns C_s, A_s (60: B_s) of machine angles: the tool vector is Rz(C_s)*Rx(A_s)*e_z (60: Ry(B_s))."""
    half = tilt_deg / 2.0
    spatial = 2.0 * math.degrees(math.asin(sind(hd7_deg) * sind(half)))
    return c_deg + math.degrees(math.atan2(cosd(hd7_deg) * sind(half), cosd(half))), spatial


def spatial_to_machine(c_deg: float, tilt_deg: float, hd7_deg: float, sign: float = 1.0) -> tuple[float, float]:
    """Returns machine angles of spatial angles; a tilt beyond 2*HD7 is a ValueError.

    `sign` -1 is for an inclined axis on the other side of Z, which has to turn the other way for the same tilt.
    """
    if tilt_deg == 0.0:
        return c_deg, 0.0
    reach = sind(hd7_deg)
    if reach == 0.0 or abs(tilt_deg) > 2.0 * abs(hd7_deg) + 1e-9:
        raise ValueError(f"spatial angle {tilt_deg} deg exceeds 2*HD7 = {2.0 * hd7_deg} deg")
    half = max(-1.0, min(1.0, sind(tilt_deg / 2.0) / reach))
    tilt = sign * 2.0 * math.degrees(math.asin(half))
    turn = math.degrees(math.atan2(cosd(hd7_deg) * sind(tilt / 2.0), cosd(tilt / 2.0)))
    return c_deg - turn, tilt


def _inner_angles(
    hd: Head, c_deg: float, tilt_deg: float, offsets: tuple[float, float], conv: Conv, sign: float, convert: bool
) -> tuple[float, float]:
    """Returns the angles of the model: conversion of spatial angles where asked, then the rotary offsets."""
    k = chosen_sign(conv, "angle_offset_sign")
    if convert:
        c_deg, tilt_deg = spatial_to_machine(c_deg, tilt_deg, hd[7], sign)
        if choice(conv, "spatial_angle_offsets") == "direction_exact":
            return c_deg, tilt_deg
    return c_deg - k * offsets[0], tilt_deg - k * offsets[1]


def _offsets59(hd: Head, conv: Conv) -> tuple[float, float]:
    """Returns the sums of the inner offsets HD14, HD15 and, where they count, the zero offsets HD16, HD17 [deg]."""
    if choice(conv, "kin59_zero_offset") == "subtracted":
        return hd[14] + hd[16], hd[15] + hd[17]
    return hd[14], hd[15]


def _saw_shift(hd: Head, axis: Vector3, radius_mm: float, conv: Conv) -> Matrix:
    """Returns the shift from blade centre to lowest point at the target angle HD19 (KIN_TYP manual 2.29.1.1)."""
    if choice(conv, "kin59_saw_tcp") == "plus_x":
        return shift(radius_mm, 0.0, 0.0)
    convert = hd.raw(21) == 0 and choice(conv, "kin59_saw_angle") == "like_axis"
    _, tilt = _inner_angles(hd, 0.0, hd[19], _offsets59(hd, conv), conv, 1.0, convert)
    # World "up" in the blade's axes; the deepest tooth lies against its part in the blade's plane.
    up = rot_about(axis, tilt)[2, :3]
    flat = math.hypot(float(up[0]), float(up[1]))
    if flat < 1e-12:
        return shift(radius_mm, 0.0, 0.0)
    return shift(-radius_mm * float(up[0]) / flat, -radius_mm * float(up[1]) / flat, 0.0)


def _head(
    hd: Head, slide: Sequence[float], angles: tuple[float, float], axis: Vector3, innermost: Matrix, conv: Conv
) -> Matrix:
    """Returns slide, C, inclined axis and the three offset vectors M - C, C - tilted axis, tilted axis - SP."""
    k = chosen_sign(conv, "named_offset_sign")
    return chain(
        shift(slide[0], slide[1], slide[2]),
        shift(-k * hd[11], -k * hd[12], -hd[13]),
        rot_z(angles[0]),
        shift(-k * hd[8], -k * hd[9], -hd[10]),
        rot_about(axis, angles[1]),
        shift(-k * hd[4], -k * hd[5], -hd[6]),
        innermost,
    )


def _clamp(hd: Head, tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the shift from the compensation point to the tool tip."""
    k = chosen_sign(conv, "clamp_offset_sign")
    return shift(k * hd[2], k * hd[3], -hd[1] - tool_length_mm)


def kin59(
    param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv, *, blade_radius_mm: float = 0.0
) -> Matrix:
    """Returns the pose of the C/A cardanic head; HD20 = 2 shifts to the saw's tooth (KIN_TYP manual 2.29.1)."""
    hd, (x, y, z, c, a) = Head(param), expect_axes(axes, 5)
    axis = (sind(hd[7]), 0.0, cosd(hd[7]))
    angles = _inner_angles(hd, c, a, _offsets59(hd, conv), conv, 1.0, hd.raw(21) == 0)
    innermost = _clamp(hd, tool_length_mm, conv)
    if hd.raw(20) == 2:
        innermost = innermost @ _saw_shift(hd, axis, blade_radius_mm, conv)
    elif hd.raw(20) == 1 and choice(conv, "kin59_underfloor") == "turns_tool":
        innermost = rot_z(hd[19]) @ innermost
    return _head(hd, (x, y, z), angles, axis, innermost, conv)


def kin60(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the pose of the C/B cardanic head (KIN_TYP manual 2.29.2)."""
    hd, (x, y, z, c, b) = Head(param), expect_axes(axes, 5)
    sign = chosen_sign(conv, "kin60_tilt_sign")
    axis = (0.0, sign * sind(hd[7]), cosd(hd[7]))
    angles = _inner_angles(hd, c, b, (hd[14], hd[15]), conv, sign, hd.raw(21) == 0)
    return _head(hd, (x, y, z), angles, axis, _clamp(hd, tool_length_mm, conv), conv)
