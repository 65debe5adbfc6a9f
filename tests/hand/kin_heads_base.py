"""Elementary motions, head data and named choices for the hand formulas of the KIN_TYP heads and of arm 45.

Written from the KIN_TYP manual alone; numpy and math only, nothing of the package under test. Units: mm and degrees.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]
Params = dict[int, float]
Conv = dict[str, str]

CHOICES: dict[str, tuple[str, ...]] = {
    "offset_inside_flag": ("as_printed", "inside", "outside"),
    "sign_coding": ("plus_minus_one", "zero_one"),
    "named_offset_sign": ("p_to_q", "q_to_p"),
    "static_offset_sign": ("plus", "minus"),
    "c_pivot_sign": ("minus", "plus"),
    "angle_offset_sign": ("minus", "plus"),
    "kin2_slide_point": ("a_axis", "b_axis_at_zero"),
    "kin3_b_value": ("drive", "programmed"),
    "kin3_offset_zero": ("tool_down", "tool_up"),
    "head_y_offset_sign": ("minus", "plus"),
    "kin5_spindle_pairs": ("opposite", "adjacent", "sum"),
    "kin5_h_sign": ("minus", "plus"),
    "kin5_hd4_sign": ("minus", "plus"),
    "kin6_hd4_sign": ("plus", "minus"),
    "kin6_hd2_sign": ("minus", "plus"),
    "kin6_a_axis_offset": ("turns_with_c", "static"),
    "kin7_hd6_place": ("inside_c", "outside_c"),
    "saw_hd2_sign": ("minus", "plus"),
    "kin11_tilt_sign": ("plus", "minus"),
    "kin11_ideal_length": ("with_hd1", "tool_only"),
    "kin16_heights": ("magnitudes", "signed"),
    "kin16_hd5_sign": ("plus", "minus"),
    "kin22_axis_order": ("a_outside", "b_outside"),
    "kin25_length": ("gap", "head_and_gap"),
    "kin28_axis_values": ("programmed", "drives"),
    "gear_flag_place": ("after_gear", "before_gear"),
    "kin33_tilt_axis": ("xz_plus", "xz_minus", "yz_plus", "yz_minus"),
    "kin33_tool_length": ("ignored", "along_tool"),
    "kin60_tilt_sign": ("plus", "minus"),
    "clamp_offset_sign": ("plus", "minus"),
    "spatial_angle_offsets": ("after_conversion", "direction_exact"),
    "kin59_zero_offset": ("subtracted", "not_in_pose"),
    "kin59_saw_tcp": ("lowest_point", "plus_x"),
    "kin59_saw_angle": ("like_axis", "machine"),
    "kin59_underfloor": ("no_effect", "turns_tool"),
    "kin70_lateral_sign": ("as_kin16", "reversed"),
    "kin70_offset_place": ("inside_hd14", "outside_hd14"),
    "kin70_hd14_sign": ("plus", "minus"),
    "kin70_cv": ("programmed", "machine"),
    "kin76_offset_sign": ("plus", "minus"),
    "kin207_programmed_point": ("slid_xy_tip_z", "slid_xyz", "tip"),
    "kin207_z0": ("absolute", "relative"),
    "flange_variant_2": ("base_frame", "z_out_x_up", "base_frame_offsets_variant_1"),
    "kin45_length_frame": ("tool", "flange"),
}
"""Conventions the formulas know; the first choice is the default."""


def choice(conv: Mapping[str, str], name: str) -> str:
    """Returns the choice of a convention, its default where none is given; an unknown choice is a ValueError."""
    known = CHOICES[name]
    chosen = conv.get(name, known[0])
    if chosen not in known:
        raise ValueError(f"{name}: {chosen!r} is none of {', '.join(known)}")
    return chosen


def chosen_sign(conv: Mapping[str, str], name: str) -> float:
    """Returns +1 for the default and -1 for the other choice of a two-way sign convention."""
    return 1.0 if choice(conv, name) == CHOICES[name][0] else -1.0


class Head:
    """Reads HD values by their number (HD1 = raw index 0); missing values are 0."""

    def __init__(self, param: Mapping[int, float]) -> None:
        self._param = param

    def raw(self, number: int) -> float:
        """Returns HD `number` as the file has it (flags, signs, gear numbers)."""
        return float(self._param.get(number - 1, 0.0))

    def __getitem__(self, number: int) -> float:
        """Returns HD `number` in mm or degrees (file unit 1e-4)."""
        return self.raw(number) * 1e-4


def sind(angle_deg: float) -> float:
    """Returns the sine of an angle in degrees."""
    return math.sin(math.radians(angle_deg))


def cosd(angle_deg: float) -> float:
    """Returns the cosine of an angle in degrees."""
    return math.cos(math.radians(angle_deg))


def shift(x: float, y: float, z: float) -> Matrix:
    """Returns a pure translation [mm]."""
    out = np.eye(4)
    out[:3, 3] = (x, y, z)
    return out


def rot_x(angle_deg: float) -> Matrix:
    """Returns a turn about X: Y goes towards Z for a positive angle."""
    c, s = cosd(angle_deg), sind(angle_deg)
    return np.array([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1]], dtype=np.float64)


def rot_y(angle_deg: float) -> Matrix:
    """Returns a turn about Y: Z goes towards X for a positive angle."""
    c, s = cosd(angle_deg), sind(angle_deg)
    return np.array([[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1]], dtype=np.float64)


def rot_z(angle_deg: float) -> Matrix:
    """Returns a turn about Z: X goes towards Y for a positive angle."""
    c, s = cosd(angle_deg), sind(angle_deg)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], dtype=np.float64)


def rot_about(axis: Sequence[float], angle_deg: float) -> Matrix:
    """Returns a right-handed turn about a unit vector through the origin (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], dtype=np.float64)
    out = np.eye(4)
    out[:3, :3] += sind(angle_deg) * cross + (1.0 - cosd(angle_deg)) * (cross @ cross)
    return out


def chain(*parts: Matrix) -> Matrix:
    """Returns the product of the parts, slide or base first."""
    out = np.eye(4)
    for part in parts:
        out = out @ part
    return out


def sign_of(value: float) -> float:
    """Returns the direction of a signed parameter: negative reverses, zero counts as positive."""
    return -1.0 if value < 0 else 1.0


def flag_sign(value: float) -> float:
    """Returns the direction of a 0/1 flag: 0 positive, 1 negative."""
    return 1.0 if value == 0 else -1.0


def directed(axis_deg: float, sign: float, offset_deg: float, conv: Conv) -> float:
    """Returns the inner angle of an axis whose printed rule takes the offset off after the sign [deg]."""
    offset = offset_deg * chosen_sign(conv, "angle_offset_sign")
    if choice(conv, "offset_inside_flag") == "inside":
        return sign * (axis_deg - offset)
    return sign * axis_deg - offset


def less_offset(axis_deg: float, offset_deg: float, conv: Conv) -> float:
    """Returns the inner angle of an axis with a zero offset and no direction flag [deg]."""
    return axis_deg - offset_deg * chosen_sign(conv, "angle_offset_sign")


def static(hd: Head, conv: Conv) -> Matrix:
    """Returns the static offset HD7, HD8 that no rotary axis turns."""
    sign = chosen_sign(conv, "static_offset_sign")
    return shift(sign * hd[7], sign * hd[8], 0.0)


def expect_axes(axes: Sequence[float], count: int) -> list[float]:
    """Returns the axis values as floats, or raises ValueError when their number is wrong."""
    values = [float(value) for value in axes]
    if len(values) != count:
        raise ValueError(f"{count} axis values expected, {len(values)} given")
    return values
