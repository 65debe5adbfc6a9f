"""Hand formulas of the face and turning types KIN_TYP 13, 14, 202, 203, 205 and the tool length law of 98.

`f(param, axes, tool_length_mm, conv)`: raw file values by file index, axes in channel order (mm, deg), choices by name;
the result is the tool in the workpiece frame, in mm. Where the tool does not lie along Z the frame is turned
so that its z is the tool vector (tip to holder).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from .tables_algebra import (
    Formula,
    Head,
    Matrix,
    chain,
    choice,
    internal,
    negative_is_minus,
    on_table,
    rx,
    ry,
    rz,
    seen_from,
    shift,
    sign_of,
    zero_is_plus,
)

Param = dict[int, float]
Conv = dict[str, str]


class TiltError(ValueError):
    """The tilt exceeds HD4 of type 98: the controller stops with an error."""


def kin13(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Face transformation, axes X C Z (2.13); 14 has the same forward kinematics and keeps the side of X."""
    x, c_axis, z = axes
    hd = Head(param)
    c = on_table(zero_is_plus(hd.flag(5)) * c_axis, conv)
    y = sign_of(conv, "face_y_offset_sign") * hd(4)
    return seen_from(rz(c), shift(x, y, z - hd(1) - tool_length_mm))


def kin202(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Tool on XQ, ZQ and the turning axis YQ, workpiece on CS; LEFT (HD10 = 0) points to -X, RIGHT to +X."""
    xq, yq, zq, cs = axes
    hd = Head(param)
    right = hd.flag(10) != 0
    tool_vector = ry(-90.0 if right else 90.0)
    tool = chain(hd.vector(2), shift(xq, 0, zq), rz(yq - hd(5)), tool_vector, shift(0, 0, -hd(1) - tool_length_mm))
    frame = {"unshifted": 0.0, "turned_180": 180.0 if right else 0.0}[choice(conv, "kin202_right_frame")]
    return seen_from(chain(hd.vector(6), rz(on_table(cs - hd(9), conv)), rz(frame)), tool)


def kin203(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Tool on an arm HD10 turned by YL and lifted by ZL, workpiece on C, axes C YL ZL."""
    c_axis, yl, zl = axes
    hd = Head(param)
    cos, sin = {"deg_0": (1, 0), "deg_90": (0, 1), "deg_180": (-1, 0), "deg_270": (0, -1)}[
        choice(conv, "kin203_arm_zero")
    ]
    arm = shift(cos * hd(10), sin * hd(10), -hd(1) - tool_length_mm)
    tool = chain(hd.vector(2), shift(0, 0, zl), rz(yl - hd(5)), arm)
    return seen_from(chain(hd.vector(6), rz(on_table(c_axis - hd(9), conv))), tool)


def _turns_about_x(hd: Head, conv: Conv) -> bool:
    """Return the axis HD16, HD17 of 205 choose; combinations the manual forbids are an error."""
    legacy = {"about_z": False, "about_x": True}[choice(conv, "kin205_legacy_mode")]
    modes = {(1, 0): False, (0, 1): True, (0, 0): legacy}
    key = (int(hd.flag(16)), int(hd.flag(17)))
    if key not in modes:
        raise ValueError(f"HD16 = {key[0]}, HD17 = {key[1]} is not permitted")
    return modes[key]


def kin205(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Tool on an eccentric disc C carried by X and Z, axes X C Z; polar (HD2, HD3) and HD4, HD5 add."""
    x, c_axis, z = axes
    hd = Head(param)
    polar = math.radians(hd(3))  # printed in mm, but it is an angle
    r = hd(2) * math.cos(polar) + hd(4)
    s = hd(2) * math.sin(polar) + hd(5)
    c = internal(c_axis, hd(12), negative_is_minus(hd.flag(13)), conv, "outside")
    zeros = {
        "sum": (hd.vector(6), hd.vector(9)),
        "x_only": (hd.vector(6),),
        "z_only": (hd.vector(9),),
    }[choice(conv, "kin205_zero_points")]
    slides = shift(negative_is_minus(hd.flag(14)) * x, 0, negative_is_minus(hd.flag(15)) * z)
    length = hd(1) + tool_length_mm
    if not _turns_about_x(hd, conv):
        return chain(*zeros, slides, rz(c), shift(r, s, -length))
    disc = {
        "yz_plane": (ry(90), rz(90), shift(r, s, -length)),
        "turned_about_y": (ry(90), shift(r, s, -length)),
        "tool_along_z": (shift(0, r, s - length),),
    }[choice(conv, "kin205_x_variant")]
    return chain(*zeros, slides, rx(c), *disc)


def effective_tool_length_mm(param: Param, tool_length_mm: float, theta_deg: float, conv: Conv | None = None) -> float:
    """Return the tool length type 98 (2.39) hands to the carrier kinematic at a tilt of theta.

    Up to HD2 the length is unchanged; above it L grows so that the head's height L * cos(theta) stays at its value
    for HD2, up to HD3, where it stops growing. HD1 takes no part unless the convention kin98_hd1 says so.

    Raises:
        TiltError: the tilt is above HD4.
    """
    hd = Head(param)
    tilt = abs(theta_deg)
    if tilt > hd(4):
        raise TiltError(f"tilt {tilt} deg is above HD4 = {hd(4)} deg")
    length = tool_length_mm
    if tilt > hd(2):
        length *= math.cos(math.radians(hd(2))) / math.cos(math.radians(min(tilt, hd(3))))
    return length + {"excluded": 0.0, "added": hd(1)}[choice(conv or {}, "kin98_hd1")]


FORMULAS: dict[int, Formula] = {13: kin13, 14: kin13, 202: kin202, 203: kin203, 205: kin205}
