"""Hand formulas of the closed loops KIN_TYP 12, 21, 37 and 209, forward and inverse.

`kinNN(hd, axes, tool_length_mm, conv)`: HD values by printed number in mm, degrees or flags, axes in channel order (mm,
deg), choices by name; the result is the tool in the workpiece frame, in mm, or None where the struts do not close.
`all_axesNN(hd, T, tool_length_mm, conv)`: every set of axis values of that pose in the assembly that the forward
formula chooses. Sections of the KIN_TYP manual stand at each formula.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from .tables_algebra import Matrix, chain, internal, on_table, rx, ry, rz, seen_from, shift, table_flag

Hd = Mapping[int, float]
Conv = Mapping[str, str]
LoopFormula = Callable[[Hd, Sequence[float], float, Conv], Matrix | None]
LoopInverse = Callable[[Hd, Matrix, float, Conv], list[list[float]]]

# Name → choices, the default first.
LOOP_CHOICES: dict[str, tuple[str, ...]] = {
    "kin12_azimuth": ("deg_0", "deg_90", "deg_180", "deg_minus_90"),
    "kin12_numbering": ("ccw", "cw"),
    "kin12_carriages": ("above", "below"),
    "kin12_hd4_sign": ("minus", "plus"),
    "kin12_tool_xy": ("as_printed", "swapped"),
    "kin12_tool_xy_sign": ("minus", "plus"),
    "kin12_z_positive": ("up", "down"),
    "kin209_column_angle": ("columns", "table", "table_reversed"),
    "kin37_azimuth": ("deg_minus_90", "deg_0", "deg_90", "deg_180"),
    "kin37_numbering": ("ccw", "cw"),
    "kin37_hd1_sign": ("minus", "plus"),
    "kin37_hd13_sign": ("minus", "plus"),
    "kin37_limits_of": ("axis", "lever"),
    "kin21_side": ("left", "right"),
    "kin21_hd5_along": ("y", "x"),
    "kin21_c_zero": ("along_arm", "along_x"),
    "kin21_hd10_sign": ("plus", "minus"),
    "kin21_beta_sign": ("plus", "minus"),
    "kin21_slides": ("x1_carries_c", "x2_carries_c"),
}
_SIGN = {"plus": 1.0, "minus": -1.0}
_AZIMUTH = {"deg_0": 0.0, "deg_90": 90.0, "deg_180": 180.0, "deg_minus_90": -90.0}
_COUNTING = {"ccw": 1.0, "cw": -1.0}


def _choice(conv: Conv, name: str) -> str:
    return conv.get(name, LOOP_CHOICES[name][0])


def _sign(conv: Conv, name: str) -> float:
    return _SIGN[_choice(conv, name)]


def _towards(angle_deg: float) -> Matrix:
    """Return the horizontal unit vector at an angle to X."""
    return np.array([math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg)), 0.0])


def common_point(centres: Sequence[Matrix], rod: float, lower: bool) -> Matrix | None:
    """Return the point at one distance from three centres, below or above their plane; None: there is none.

    With equal radii it stands on the axis of the circle through the three: over the circle's centre, which weighs
    each corner by the square of the opposite side times the sum of the other two squares less it.
    """
    a, b, c = centres
    normal = np.cross(b - a, c - a)
    if abs(normal[2]) < 1e-9 * max(1.0, float(np.abs(normal).max())):
        return None  # no triangle, or an upright one, which has no lower side
    up = normal / np.linalg.norm(normal) * math.copysign(1.0, normal[2])
    sides = np.array([np.sum((b - c) ** 2), np.sum((c - a) ** 2), np.sum((a - b) ** 2)])
    weights = sides * (sides.sum() - 2.0 * sides)
    centre = (weights[0] * a + weights[1] * b + weights[2] * c) / weights.sum()
    height = rod**2 - float(np.sum((a - centre) ** 2))
    if height < 0.0:
        return None
    return np.asarray(centre + (-1.0 if lower else 1.0) * math.sqrt(height) * up)


# 12 and 209: three upright columns


def _columns(hd: Hd, conv: Conv, turned: float) -> list[Matrix]:
    """Return the rods' upper ends at Z = 0 as if their lower ends met in one point: column 1, 2, 3."""
    to_first, to_second = (hd.get(9, 0.0), hd.get(10, 0.0)) if hd.get(8, 0.0) == 1.0 else (120.0, 120.0)
    third = _AZIMUTH[_choice(conv, "kin12_azimuth")] + turned
    sense = _COUNTING[_choice(conv, "kin12_numbering")]
    inward = hd.get(5, 0.0) - hd.get(6, 0.0)
    return [inward * _towards(third + sense * angle) for angle in (to_first, -to_second, 0.0)]


def _tripod_tool(hd: Hd, length: float, conv: Conv) -> Matrix:
    """Return the vector from the rods' common point to the tip, in the workpiece frame of 12."""
    along = {"as_printed": (3, 2), "swapped": (2, 3)}[_choice(conv, "kin12_tool_xy")]
    aside = _sign(conv, "kin12_tool_xy_sign")
    x, y = (aside * hd.get(n, 0.0) for n in along)
    zero = _sign(conv, "kin12_hd4_sign") * hd.get(4, 0.0)
    return np.array([x, y, zero - hd.get(1, 0.0) - length])


def _tripod_tip(hd: Hd, slides: Sequence[float], length: float, conv: Conv, turned: float) -> Matrix | None:
    sense = {"up": 1.0, "down": -1.0}[_choice(conv, "kin12_z_positive")]
    raised = zip(_columns(hd, conv, turned), slides, strict=True)
    ends = [column + np.array([0.0, 0.0, sense * slide]) for column, slide in raised]
    point = common_point(ends, hd.get(7, 0.0), lower=_choice(conv, "kin12_carriages") == "above")
    return None if point is None else point + _tripod_tool(hd, length, conv)


def _tripod_slides(hd: Hd, tip: Matrix, length: float, conv: Conv, turned: float) -> list[list[float]]:
    """Return the slides (none or one set) with every carriage on its side of the platform."""
    point = tip - _tripod_tool(hd, length, conv)
    rises = {"above": 1.0, "below": -1.0}[_choice(conv, "kin12_carriages")]
    sense = {"up": 1.0, "down": -1.0}[_choice(conv, "kin12_z_positive")]
    slides = []
    for column in _columns(hd, conv, turned):
        rise = hd.get(7, 0.0) ** 2 - (point[0] - column[0]) ** 2 - (point[1] - column[1]) ** 2
        if rise < 0.0:
            return []
        slides.append(float(sense * (point[2] + rises * math.sqrt(rise))))
    met = _tripod_tip(hd, slides, length, conv, turned)
    return [slides] if met is not None and np.allclose(met, tip, rtol=0, atol=1e-6) else []


def kin12(hd: Hd, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix | None:
    """Tripod, axes Z1 Z2 Z3 (2.12): the platform stays parallel to itself."""
    tip = _tripod_tip(hd, axes, tool_length_mm, conv, 0.0)
    return None if tip is None else shift(*tip.tolist())


def all_axes12(hd: Hd, T: Matrix, tool_length_mm: float, conv: Conv) -> list[list[float]]:
    """Return the slides of a place of the tripod: none or one set."""
    return _tripod_slides(hd, T[:3, 3], tool_length_mm, conv, 0.0)


def _column_turn(hd: Hd, conv: Conv) -> tuple[float, float]:
    """Return by how much HD30 turns the columns and the table of 209 about the machine's Z."""
    angle = hd.get(30, 0.0)
    return {"columns": (angle, 0.0), "table": (0.0, angle), "table_reversed": (0.0, -angle)}[
        _choice(conv, "kin209_column_angle")
    ]


def _table209(hd: Hd, outer: float, inner: float, conv: Conv) -> Matrix:
    """Return the workpiece frame of 209 in the machine, from the turns of its two axes."""
    foot = shift(hd.get(35, 0.0), hd.get(36, 0.0), hd.get(37, 0.0))
    between = shift(hd.get(32, 0.0), hd.get(33, 0.0), hd.get(34, 0.0))
    tilt = ry(outer) if hd.get(31, 0.0) == 1.0 else rx(outer)
    return chain(rz(_column_turn(hd, conv)[1]), foot, tilt, between, rz(inner))


def _turn209(hd: Hd, value: float, offset: int, flag: int, conv: Conv) -> float:
    direction = table_flag(hd.get(flag, 0.0), conv)
    return on_table(internal(value, hd.get(offset, 0.0), direction, conv, "inside"), conv)


def kin209(hd: Hd, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix | None:
    """Tripod over a table, axes Z1 Z2 Z3 A C, or B in place of A where HD31 is 1 (2.41)."""
    tip = _tripod_tip(hd, axes[:3], tool_length_mm, conv, _column_turn(hd, conv)[0])
    if tip is None:
        return None
    outer = _turn209(hd, axes[3], 38, 40, conv)
    inner = _turn209(hd, axes[4], 39, 41, conv)
    return seen_from(_table209(hd, outer, inner, conv), shift(*tip.tolist()))


def _value209(hd: Hd, angle: float, offset: int, flag: int, conv: Conv) -> float:
    """Return the axis value at which a table axis has turned by an angle."""
    theta = on_table(angle, conv)  # the turn over is its own inverse
    direction = table_flag(hd.get(flag, 0.0), conv)
    outside = conv.get("offset_inside_flag") == "outside"
    return direction * (theta + hd.get(offset, 0.0)) if outside else direction * theta + hd.get(offset, 0.0)


def all_axes209(hd: Hd, T: Matrix, tool_length_mm: float, conv: Conv) -> list[list[float]]:
    """Return the axes of a place and tool vector: the table tilted to either side, where the slides reach."""
    x, y, z = T[:3, 2]  # the machine's Z, seen from the workpiece
    tilt = math.degrees(math.acos(max(-1.0, min(1.0, z))))
    # Seen from the table: (sin c sin a, cos c sin a, cos a) with A, (-cos c sin b, sin c sin b, cos b) with B.
    spin = math.degrees(math.atan2(y, -x) if hd.get(31, 0.0) == 1.0 else math.atan2(x, y))
    found = []
    for outer, inner in ((tilt, spin), (-tilt, spin + 180.0)):
        tip = (_table209(hd, outer, inner, conv) @ T)[:3, 3]
        turns = [_value209(hd, outer, 38, 40, conv), _value209(hd, inner, 39, 41, conv)]
        slides = _tripod_slides(hd, tip, tool_length_mm, conv, _column_turn(hd, conv)[0])
        found += [[*one, *turns] for one in slides]
    return found


# 37: three levers


def _delta_azimuths(conv: Conv) -> list[float]:
    step = _COUNTING[_choice(conv, "kin37_numbering")] * 120.0
    return [_AZIMUTH[_choice(conv, "kin37_azimuth")] + n * step for n in range(3)]


def _delta_tool(hd: Hd, length: float, conv: Conv) -> Matrix:
    tool = _sign(conv, "kin37_hd1_sign") * hd.get(1, 0.0)
    zero = _sign(conv, "kin37_hd13_sign") * hd.get(13, 0.0)
    return np.array([0.0, 0.0, tool + zero - length])


def kin37(hd: Hd, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix | None:
    """Delta robot, axes J1 J2 J3 (3.2): a lever is level at its HD8..10 and swings down from there."""
    ends = []
    for n, azimuth in enumerate(_delta_azimuths(conv)):
        swing = math.radians(axes[n] - hd.get(8 + n, 0.0))
        lever = hd.get(7, 0.0)
        out = hd.get(5, 0.0) - hd.get(4, 0.0) + lever * math.cos(swing)
        ends.append(out * _towards(azimuth) - np.array([0.0, 0.0, lever * math.sin(swing)]))
    point = common_point(ends, hd.get(6, 0.0), lower=True)
    return None if point is None else shift(*(point + _delta_tool(hd, tool_length_mm, conv)).tolist())


def _lever_angles(hd: Hd, out: float, aside: float, height: float) -> list[float]:
    """Return both swings, the outward one first, of a lever whose rod ends `out`, `aside` and `height` away.

    In the lever's plane the rod is shortened to the leg r of HD6² = r² + aside²; the triangle of lever, r and the line
    to the rod's end gives the angle at the joint.
    """
    lever, far = hd.get(7, 0.0), math.hypot(out, height)
    leg2 = hd.get(6, 0.0) ** 2 - aside**2
    if leg2 < 0.0 or far == 0.0 or abs(cosine := (lever**2 + far**2 - leg2) / (2.0 * lever * far)) > 1.0:
        return []
    line = math.degrees(math.atan2(-height, out))  # counted downwards as the levers are
    opening = math.degrees(math.acos(cosine))
    return [line - opening, line + opening]


def all_axes37(hd: Hd, T: Matrix, tool_length_mm: float, conv: Conv) -> list[list[float]]:
    """Return the axes of a place of the delta robot: up to eight, each lever outward or inward, all outward first."""
    point = T[:3, 3] - _delta_tool(hd, tool_length_mm, conv)
    each = []
    for n, azimuth in enumerate(_delta_azimuths(conv)):
        out = float(point @ _towards(azimuth)) - (hd.get(5, 0.0) - hd.get(4, 0.0))
        aside = float(point @ _towards(azimuth + 90.0))
        each.append([swing + hd.get(8 + n, 0.0) for swing in _lever_angles(hd, out, aside, float(point[2]))])
    found = [[one, two, three] for one in each[0] for two in each[1] for three in each[2]]
    return [axes for axes in found if _met(kin37(hd, axes, tool_length_mm, conv), T)]


def limits37(hd: Hd, conv: Conv) -> list[tuple[float, float]] | None:
    """Return lower and upper limit of each axis in degrees; None: HD11 and HD12 are 0, there is no limit."""
    low, high = hd.get(11, 0.0), hd.get(12, 0.0)
    if low == high == 0.0:
        return None
    zeros = [hd.get(8 + n, 0.0) if _choice(conv, "kin37_limits_of") == "lever" else 0.0 for n in range(3)]
    return [(low + zero, high + zero) for zero in zeros]


# 21: the lambda


def _joints21(hd: Hd, x1: float, x2: float, conv: Conv) -> tuple[Matrix, Matrix]:
    """Return the joints C and B on their slides."""
    carries_c, carries_b = {"x1_carries_c": (x1, x2), "x2_carries_c": (x2, x1)}[_choice(conv, "kin21_slides")]
    aside = {"x": np.array([1.0, 0.0, 0.0]), "y": np.array([0.0, 1.0, 0.0])}[_choice(conv, "kin21_hd5_along")]
    drive = np.array([_sign(conv, "kin21_hd10_sign") * hd.get(10, 0.0), hd.get(7, 0.0), 0.0])
    along = np.array([1.0, 0.0, 0.0])
    return drive + carries_c * along, drive + carries_b * along + hd.get(5, 0.0) * aside


def _gripper_zero(arm: float, conv: Conv) -> float:
    """Return the gripper's angle to X at C = 0."""
    return {"along_arm": arm, "along_x": 0.0}[_choice(conv, "kin21_c_zero")]


def kin21(hd: Hd, axes: Sequence[float], tool_length_mm: float, conv: Conv) -> Matrix | None:
    """Lambda, axes X1 X2 Z C (2.18): rods C to D (HD3) and B to D (HD2), the arm C to A fixed to rod CD."""
    x1, x2, z, c_axis = axes
    joint_c, joint_b = _joints21(hd, x1, x2, conv)
    line = joint_b - joint_c
    base, rod_c, rod_b = math.hypot(line[0], line[1]), hd.get(3, 0.0), hd.get(2, 0.0)
    if base == 0.0 or abs(cosine := (rod_c**2 + base**2 - rod_b**2) / (2.0 * rod_c * base)) > 1.0:
        return None
    opening = {"left": 1.0, "right": -1.0}[_choice(conv, "kin21_side")] * math.degrees(math.acos(cosine))
    rod_angle = math.degrees(math.atan2(line[1], line[0])) + opening
    arm = rod_angle + _sign(conv, "kin21_beta_sign") * hd.get(6, 0.0)
    joint_a = joint_c + hd.get(4, 0.0) * _towards(arm)
    place = shift(float(joint_a[0]), float(joint_a[1]), z - hd.get(1, 0.0) - tool_length_mm)
    return chain(place, rz(_gripper_zero(arm, conv) + c_axis), shift(hd.get(11, 0.0), 0.0, 0.0))


def all_axes21(hd: Hd, T: Matrix, tool_length_mm: float, conv: Conv) -> list[list[float]]:
    """Return the axes of a place and angle C of the lambda: the arm points either way, B stands on either side of D."""
    gripper = math.degrees(math.atan2(T[1, 0], T[0, 0]))
    joint_a = T[:3, 3] - hd.get(11, 0.0) * _towards(gripper)
    origin_c, origin_b = _joints21(hd, 0.0, 0.0, conv)
    sine = (joint_a[1] - origin_c[1]) / hd.get(4, 0.0)
    if abs(sine) > 1.0:
        return []
    slanted = math.degrees(math.asin(sine))
    found = []
    for arm in (slanted, 180.0 - slanted):
        joint_c = joint_a - hd.get(4, 0.0) * _towards(arm)
        rod_angle = arm - _sign(conv, "kin21_beta_sign") * hd.get(6, 0.0)
        joint_d = joint_c + hd.get(3, 0.0) * _towards(rod_angle)
        reach = hd.get(2, 0.0) ** 2 - (joint_d[1] - origin_b[1]) ** 2
        for side in (1.0, -1.0) if reach >= 0.0 else ():
            joint_b = float(joint_d[0]) + side * math.sqrt(reach)
            slides = [float(joint_c[0] - origin_c[0]), float(joint_b - origin_b[0])]
            if _choice(conv, "kin21_slides") == "x2_carries_c":
                slides.reverse()
            c_axis = (gripper - _gripper_zero(arm, conv) + 180.0) % 360.0 - 180.0
            found.append([*slides, float(T[2, 3]) + hd.get(1, 0.0) + tool_length_mm, c_axis])
    return [axes for axes in found if _met(kin21(hd, axes, tool_length_mm, conv), T)]


def _met(pose: Matrix | None, wanted: Matrix) -> bool:
    return pose is not None and bool(np.allclose(pose, wanted, rtol=0, atol=1e-6))


LOOPS: dict[int, LoopFormula] = {12: kin12, 21: kin21, 37: kin37, 209: kin209}
LOOP_INVERSES: dict[int, LoopInverse] = {12: all_axes12, 21: all_axes21, 37: all_axes37, 209: all_axes209}
