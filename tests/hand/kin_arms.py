"""Hand formulas of the arms KIN_TYP 36, 85, 96, 206, 208, 213.

`f(param, axes, tool_length_mm, conv)`: raw file values by file index, axes in channel order (mm, deg), choices by name;
the result is the tool in the workpiece frame (the machine base: no axis moves the workpiece), in mm.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from .tables_algebra import (
    Formula,
    Head,
    Matrix,
    chain,
    choice,
    internal,
    rx,
    ry,
    rz,
    shift,
    sign_of,
    turn,
    zero_is_plus,
)

Param = dict[int, float]
Conv = dict[str, str]
Vector = tuple[float, float, float]


def kin36(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """SCARA, axes C1 C2 Z C3 (3.1), written as sums of the two arms: a1, a2 are the arms' angles to X."""
    c1, c2, z, c3 = axes
    hd = Head(param)
    offset = sign_of(conv, "kin36_angle_offset_sign")
    from_x = hd.flag(7) != 0
    a1 = c1 + offset * hd(6)
    a2 = c2 + offset * hd(8) + (0.0 if from_x else a1)
    base = sign_of(conv, "kin36_base_offset_sign")
    x = base * hd(4) + hd(2) * math.cos(math.radians(a1)) + hd(3) * math.cos(math.radians(a2))
    y = base * hd(5) + hd(2) * math.sin(math.radians(a1)) + hd(3) * math.sin(math.radians(a2))
    absolute = choice(conv, "kin36_tool_angle") == "follows_hd7" and from_x
    return chain(shift(x, y, z - hd(1) - tool_length_mm), rz(c3 if absolute else a2 + c3))


def kin85(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Lever on a slide, axes X C (2.38): C turns the arm HD2 in the XZ plane about the height HD1."""
    x, c_axis = axes
    hd = Head(param)
    g = c_axis + sign_of(conv, "kin85_angle_offset_sign") * hd(3)
    about_y = {"raises": -g, "lowers": g}[choice(conv, "kin85_lever_sense")]
    tip = {
        "ignored": shift(hd(2), 0, 0),
        "along_tool_vector": shift(hd(2), 0, -tool_length_mm),
        "along_arm": shift(hd(2) + tool_length_mm, 0, 0),
    }[choice(conv, "kin85_tool_length")]
    return chain(shift(x, 0, hd(1)), ry(about_y), tip)


def _moved(rotation: Matrix, x: float, z: float) -> Matrix:
    """Return the shift by the turned vector (x, 0, z): an arm whose far end keeps its orientation."""
    end = rotation[:3, :3] @ np.array([x, 0.0, z])
    return shift(float(end[0]), float(end[1]), float(end[2]))


def kin96(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Palletiser, axes G1..G4: the arms shift the head, parallelograms keep it horizontal."""
    g1, g2, g3, g4 = axes
    hd = Head(param)
    arm1 = {"arm1_up": (0.0, hd(3)), "arm1_forward": (hd(3), 0.0)}[choice(conv, "kin96_zero_pose")]
    arm2_angle = {"absolute": g3, "relative": g2 + g3}[choice(conv, "kin96_arm2_angle")]
    base = shift(hd(1), sign_of(conv, "kin96_y_offset_sign") * hd(4), hd(2))
    head = shift(hd(6), 0, sign_of(conv, "kin96_head_z_sign") * hd(10))
    lateral, vertical = {
        "lateral_plus_z_down": (1.0, -1.0),
        "all_plus": (1.0, 1.0),
        "all_minus": (-1.0, -1.0),
    }[choice(conv, "kin96_tool_offset")]
    tip = shift(lateral * hd(8), lateral * hd(7), vertical * hd(9) - tool_length_mm)
    return chain(rz(g1), base, _moved(ry(g2), *arm1), _moved(ry(arm2_angle), hd(5), 0.0), head, rz(g4), tip)


def _deviated(nominal: str, side_deg: float, plan_deg: float, conv: Conv) -> Matrix:
    """Return an axis direction; `side` is the deviation in XZ (nominal X) or YZ (nominal Y), `plan` in XY.

    Written out by components: the turn in the XY plane is the outermost.
    """
    reading = choice(conv, "linear_unit_deviation_sense")
    sign = {"right_handed": 1.0, "left_handed": -1.0, "toward_positive": 1.0}[reading]
    p, q = math.radians(sign * side_deg), math.radians(sign * plan_deg)
    towards = reading == "toward_positive"
    if nominal == "x":
        up = math.sin(p) if towards else -math.sin(p)
        return np.array([math.cos(q) * math.cos(p), math.sin(q) * math.cos(p), up])
    aside = math.sin(q) if towards else -math.sin(q)
    return np.array([aside * math.cos(p), math.cos(q) * math.cos(p), math.sin(p)])


def _linear_unit_arm(hd: Head, axes: Sequence[float], nominal: str, tool: Vector, conv: Conv) -> Matrix:
    """Return 206 and 208: a slide along X, then rotary axes given by point and direction at the zero pose."""
    offset = sign_of(conv, "linear_unit_offset_sign")
    travel = (axes[0] + offset * hd(12)) * _deviated("x", hd(10), hd(11), conv)
    pose = shift(*travel.tolist())
    point = (0.0, 0.0, 0.0)
    for i, (value, along) in enumerate(zip(axes[1:], nominal, strict=True)):
        first = 13 + 6 * i  # HD13 belongs to A2
        point = (hd(first), hd(first + 1), hd(first + 2))
        direction = _deviated(along, hd(first + 3), hd(first + 4), conv)
        if i == 4:  # only A6 of 206 has a cardan angle
            direction = _cardan(hd(43), conv)[:3, :3] @ direction
        rotation = turn(direction.tolist(), value + offset * hd(first + 5))
        pose = chain(pose, shift(*point), rotation, shift(-point[0], -point[1], -point[2]))
    return chain(pose, shift(*point), shift(*tool), rx(hd(6)), ry(hd(5)), rz(hd(4)))


def _cardan(alpha_deg: float, conv: Conv) -> Matrix:
    """Return the turn that tilts the axis A6 of 206 by its cardan angle."""
    return {
        "about_z": rz(alpha_deg),
        "about_minus_z": rz(-alpha_deg),
        "about_y": ry(alpha_deg),
        "about_minus_y": ry(-alpha_deg),
    }[choice(conv, "kin206_cardan_axis")]


def kin206(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Five-axis arm on a linear unit, axes A1..A6 (3.4): the tool length adds to HD2."""
    hd = Head(param)
    return _linear_unit_arm(hd, axes, "xxxyx", (hd(1), hd(2) + tool_length_mm, hd(3)), conv)


def kin208(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Four-axis arm on a linear unit, axes A1..A5 (3.5): the tool length adds to HD3."""
    hd = Head(param)
    return _linear_unit_arm(hd, axes, "xxxy", (hd(1), hd(2), hd(3) + tool_length_mm), conv)


def kin213(param: Param, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix:
    """Five-axis palletiser, axes G1..G5 (3.6): a serial arm about Z, Y, Y, Y and the flange axis."""
    hd = Head(param)
    j1, j2, j3, j4, j5 = (
        internal(value, hd(offset), zero_is_plus(hd.flag(21 + i)), conv, "outside")
        for i, (value, offset) in enumerate(zip(axes, (36, 14, 15, 37, 38), strict=True))
    )
    arm = chain(rz(j1), shift(hd(11), 0, hd(7)), ry(j2), shift(0, 0, hd(8)), ry(j3), shift(hd(9), 0, -hd(12)))
    hand = chain(ry(j4), shift(hd(10), 0, -hd(48)), rz(sign_of(conv, "kin213_g5_sense") * j5))
    frame, along = {
        "z_up": (rx(0), -1.0),
        "z_down": (rx(180), 1.0),
        "z_up_signed": (rx(0), 1.0),
    }[choice(conv, "kin213_flange_frame")]
    down = 1.0 if choice(conv, "kin213_flange_frame") == "z_down" else -1.0
    tip = chain(shift(hd(2), hd(3), along * hd(1)), rz(hd(6)), shift(0, 0, down * tool_length_mm))
    return chain(arm, hand, frame, tip)


FORMULAS: dict[int, Formula] = {36: kin36, 85: kin85, 96: kin96, 206: kin206, 208: kin208, 213: kin213}
