"""Elementary algebra of the hand formulas: homogeneous matrices in mm and degrees, HD values, open choices.

Independent of the library on purpose: numpy and math only.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import reduce

import numpy as np
from numpy.typing import NDArray

Matrix = NDArray[np.float64]
Formula = Callable[[dict[int, float], Sequence[float], float, dict[str, str]], Matrix]

RAW_UNIT = 1e-4  # lengths are filed in 1e-4 mm, angles in 1e-4 deg

DEFAULTS: dict[str, str] = {
    "offset_inside_flag": "as_printed",
    "sign_coding": "plus_minus_one",
    "table_rotary_sense": "right_handed",
    "table_flag_coding": "zero_one",
    "slide_offset_sign": "minus",
    "machine_zero_sign": "minus",
    "pivot_to_slide_effect": "shifts_zero",
    "face_y_offset_sign": "plus",
    "table_slide_order": "slides_carry_rotary",
    "kin23_platform_sign": "plus",
    "kin34_offset_sign": "plus",
    "kin52_table_order": "a_carries_b",
    "kin52_tool_y_sign": "plus",
    "kin52_wcs_offset_sign": "minus",
    "kin85_lever_sense": "raises",
    "kin85_angle_offset_sign": "minus",
    "kin85_tool_length": "ignored",
    "kin36_base_offset_sign": "plus",
    "kin36_angle_offset_sign": "minus",
    "kin36_tool_angle": "relative_to_arm2",
    "kin96_arm2_angle": "absolute",
    "kin96_zero_pose": "arm1_up",
    "kin96_y_offset_sign": "plus",
    "kin96_head_z_sign": "minus",
    "kin96_tool_offset": "lateral_plus_z_down",
    "kin213_flange_frame": "z_up",
    "kin213_g5_sense": "plus",
    "linear_unit_deviation_sense": "right_handed",
    "linear_unit_offset_sign": "minus",
    "kin206_cardan_axis": "about_z",
    "kin202_right_frame": "unshifted",
    "kin203_arm_zero": "deg_0",
    "kin205_zero_points": "sum",
    "kin205_legacy_mode": "about_z",
    "kin205_x_variant": "yz_plane",
    "kin98_hd1": "excluded",
}


class Head:
    """The HD values of one kinematic, by their printed number (HD1 is file index 0)."""

    def __init__(self, param: Mapping[int, float]) -> None:
        self._param = param

    def __call__(self, number: int) -> float:
        """Return HDnumber in mm or degrees."""
        return self._param.get(number - 1, 0.0) * RAW_UNIT

    def flag(self, number: int) -> float:
        """Return HDnumber unscaled."""
        return self._param.get(number - 1, 0.0)

    def vector(self, first: int, sign: float = 1.0) -> Matrix:
        """Return the shift by sign * (HDfirst, HDfirst+1, HDfirst+2)."""
        return shift(sign * self(first), sign * self(first + 1), sign * self(first + 2))


def choice(conv: Mapping[str, str], name: str) -> str:
    """Return the chosen reading of an open point, else its default."""
    return conv.get(name, DEFAULTS[name])


def sign_of(conv: Mapping[str, str], name: str) -> float:
    """Return +1 or -1 for a convention whose choices are plus and minus."""
    return {"plus": 1.0, "minus": -1.0}[choice(conv, name)]


def shift(x: float, y: float, z: float) -> Matrix:
    """Return the translation by (x, y, z) in mm."""
    matrix = np.eye(4)
    matrix[:3, 3] = (x, y, z)
    return matrix


def turn(axis: Sequence[float], angle_deg: float) -> Matrix:
    """Return the right-handed turn about a unit vector through the origin."""
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    x, y, z = axis
    matrix = np.eye(4)
    matrix[:3, :3] = (
        (c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s),
        (y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s),
        (z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)),
    )
    return matrix


def rx(angle_deg: float) -> Matrix:
    """Return the right-handed turn about X."""
    return turn((1.0, 0.0, 0.0), angle_deg)


def ry(angle_deg: float) -> Matrix:
    """Return the right-handed turn about Y."""
    return turn((0.0, 1.0, 0.0), angle_deg)


def rz(angle_deg: float) -> Matrix:
    """Return the right-handed turn about Z."""
    return turn((0.0, 0.0, 1.0), angle_deg)


def chain(*matrices: Matrix) -> Matrix:
    """Return the product from left (base) to right (tip)."""
    return reduce(np.matmul, matrices)


def seen_from(workpiece: Matrix, tool: Matrix) -> Matrix:
    """Return the tool in the workpiece frame, both given in the machine frame."""
    rotation = workpiece[:3, :3].T
    inverse = np.eye(4)
    inverse[:3, :3] = rotation
    inverse[:3, 3] = -rotation @ workpiece[:3, 3]
    return np.asarray(inverse @ tool)


def zero_is_plus(flag: float) -> float:
    """Return the direction of a flag coded 0 positive, 1 negative."""
    return 1.0 if flag == 0 else -1.0


def negative_is_minus(value: float) -> float:
    """Return the direction of a flag coded by its sign, 0 counting as positive."""
    return -1.0 if value < 0 else 1.0


def table_flag(flag: float, conv: Mapping[str, str]) -> float:
    """Return the direction a table type's flag means."""
    coding = {"zero_one": zero_is_plus, "plus_minus_one": negative_is_minus}
    return coding[choice(conv, "table_flag_coding")](flag)


def sign_value(value: float, conv: Mapping[str, str]) -> float:
    """Return the direction of types 23 and 52, whose sign values are not printed."""
    coding = {"zero_one": zero_is_plus, "plus_minus_one": negative_is_minus}
    return coding[choice(conv, "sign_coding")](value)


def internal(axis_deg: float, offset_deg: float, direction: float, conv: Mapping[str, str], printed: str) -> float:
    """Return the angle of the kinematic model; `printed` is the reading this type has by default."""
    reading = choice(conv, "offset_inside_flag")
    if reading == "as_printed":
        reading = printed
    return {"inside": direction * (axis_deg - offset_deg), "outside": direction * axis_deg - offset_deg}[reading]


def on_table(theta_deg: float, conv: Mapping[str, str]) -> float:
    """Return the turn of a workpiece-side axis whose internal angle is theta."""
    return {"right_handed": theta_deg, "left_handed": -theta_deg}[choice(conv, "table_rotary_sense")]
