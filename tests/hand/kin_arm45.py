"""Hand formula of the six-axis arm KIN_TYP 45: joints about Z, Y, Y, X, Y, X of the base at the internal zero.

Internal zero: upper arm up, forearm and hand along +X. Units: mm and degrees (KIN_TYP manual 3.3).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .kin_heads_base import (
    Conv,
    Head,
    Matrix,
    Params,
    chain,
    choice,
    expect_axes,
    flag_sign,
    rot_x,
    rot_y,
    rot_z,
    shift,
)

DIRECTION_FLAGS = (21, 22, 23, 24, 25, 26)
ZERO_OFFSETS = (36, 14, 15, 37, 38, 39)
LENGTH_DIRECTIONS = ((0, 0, 0), (0, 0, -1), (-1, 0, 0), (0, -1, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0))


def joint_angles(hd: Head, axes: Sequence[float], conv: Conv) -> list[float]:
    """Returns the internal joint angles [deg] of the channel's axis values."""
    inside = choice(conv, "offset_inside_flag") == "inside"
    out = []
    for value, flag, offset in zip(expect_axes(axes, 6), DIRECTION_FLAGS, ZERO_OFFSETS, strict=True):
        sign = flag_sign(hd.raw(flag))
        out.append(sign * (value - hd[offset]) if inside else sign * value - hd[offset])
    return out


def arm(hd: Head, joints: Sequence[float]) -> Matrix:
    """Returns the flange face in base axes (x out of the flange at the internal zero)."""
    return chain(
        rot_z(joints[0]),
        shift(hd[11], 0.0, hd[7]),
        rot_y(joints[1]),
        shift(0.0, 0.0, hd[8]),
        rot_y(joints[2]),
        shift(hd[9], -hd[32], -hd[12]),
        rot_x(joints[3]),
        rot_y(joints[4]),
        shift(hd[10], 0.0, 0.0),
        rot_x(joints[5]),
    )


def _tool_rotation(hd: Head) -> Matrix:
    """Returns the tool's rotation: HD35 = 0 about Z, Y', X''; 1 about X, Y', Z''."""
    if hd.raw(35) == 0:
        return chain(rot_z(hd[6]), rot_y(hd[5]), rot_x(hd[4]))
    return chain(rot_x(hd[4]), rot_y(hd[5]), rot_z(hd[6]))


def _length_shift(hd: Head, tool_length_mm: float) -> Matrix:
    """Returns the shift of the tool length along the direction HD34 names; 0 ignores the length."""
    code = int(hd.raw(34))
    if not 0 <= code < len(LENGTH_DIRECTIONS):
        raise ValueError(f"type 45: HD34 = {code} is no tool length direction")
    x, y, z = LENGTH_DIRECTIONS[code]
    return shift(x * tool_length_mm, y * tool_length_mm, z * tool_length_mm)


def _flange_turn(hd: Head, conv: Conv) -> tuple[Matrix, bool]:
    """Returns the flange frame at the internal zero and whether tool offsets stay in the frame of variant 1."""
    if hd.raw(31) == 0:
        return rot_y(90.0), False
    variant = choice(conv, "flange_variant_2")
    if variant == "z_out_x_up":
        return rot_y(90.0) @ rot_z(180.0), False
    return np.eye(4), variant == "base_frame_offsets_variant_1"


def kin45(param: Params, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Returns the tool in the base frame, or with HD33 = 1 the fixed tool in the flange frame (KIN_TYP manual 3.3)."""
    hd = Head(param)
    flange_turn, offsets_in_variant_1 = _flange_turn(hd, conv)
    flange = arm(hd, joint_angles(hd, axes, conv)) @ flange_turn
    place, turn, length = shift(hd[2], hd[3], hd[1]), _tool_rotation(hd), _length_shift(hd, tool_length_mm)
    rest = turn @ length if choice(conv, "kin45_length_frame") == "tool" else length @ turn
    if hd.raw(33) != 0:
        return np.asarray(np.linalg.inv(flange) @ place @ rest, dtype=np.float64)
    if offsets_in_variant_1:
        place = chain(rot_y(90.0), place, rot_y(-90.0))
    return chain(flange, place, rest)
