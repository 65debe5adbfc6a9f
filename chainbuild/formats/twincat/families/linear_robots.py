"""Robots on a linear unit: KIN_TYP 206 (five rotary axes) and 208 (four).

Every axis is given as it lies at the machine's zero: a point on it, in machine coordinates, and two small
deviation angles of its direction. A1 is the linear unit; A1 to A4 and A6 lie nominally along X, A5 along Y.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.assemble import Element, linear, mark, shift, turn
from chainbuild.convention import Choices
from chainbuild.formats.twincat.recipes.parts import asked_sign
from chainbuild.formats.twincat.recipes.recipe import Drive, Params, Recipe, RecipeFunction, driven
from chainbuild.frames import cos_sin_deg, rot_x, rot_y, rot_z

_ROTATIONS: Final = {"z": rot_z, "y": rot_y}


def kin_206(p: Params, choose: Choices) -> Recipe:
    """Build the robot with five rotary axes; A6 may lean by the cardan angle HD43, the tool length acts along y."""
    arm = ["A2", "A3", "A4", "A5", "A6"]
    length = shift(y=p.tool_length_mm)
    return Recipe(tool=[_linear_unit(p, choose), *_arm(p, choose, arm), mark("flange"), *_tool(p, length)])


def kin_208(p: Params, choose: Choices) -> Recipe:
    """Build the robot with four rotary axes; the tool length acts along z."""
    arm = ["A2", "A3", "A4", "A5"]
    length = shift(z=p.tool_length_mm)
    return Recipe(tool=[_linear_unit(p, choose), *_arm(p, choose, arm), mark("flange"), *_tool(p, length)])


def _linear_unit(p: Params, choose: Choices) -> Element:
    zero = p.mm("offset_a1")
    zero *= asked_sign(choose, "linear_unit_offset_sign", zero)
    return linear("A1", _direction(p, choose, "A1").tolist(), offset_mm=zero)


def _arm(p: Params, choose: Choices, names: Sequence[str]) -> list[Element]:
    """Return the rotary axes one after the other; shifts lead from point to point, all frames stay parallel at zero."""
    points = [np.zeros(3), *(np.array([p.mm(f"point_{name.lower()}_{c}") for c in "xyz"]) for name in names)]
    elements: list[Element] = []
    for name, (before, point) in zip(names, pairwise(points), strict=True):
        zero = p.deg(f"offset_{name.lower()}")
        zero *= asked_sign(choose, "linear_unit_offset_sign", zero)
        elements.append(shift(*(point - before)))
        elements.append(driven(name, _direction(p, choose, name).tolist(), Drive(1.0, zero)))
    return elements


def _tool(p: Params, length: Element) -> list[Element]:
    """Return HD1 to HD3, the tool length and the tool's turn about X, then Y', then Z''."""
    turned = rot_x(p.deg("tool_rotation_x")) @ rot_y(p.deg("tool_rotation_y")) @ rot_z(p.deg("tool_rotation_z"))
    return [shift(p.mm("tool_x"), p.mm("tool_y"), p.mm("tool_z")), length, turn(turned)]


def _direction(p: Params, choose: Choices, name: str) -> Vector:
    """Return the unit direction of an axis at zero, deviations and cardan angle included."""
    along, plane = ("y", "yz") if name == "A5" else ("x", "xz")
    first, second = p.deg(f"deviation_{name.lower()}_{plane}"), p.deg(f"deviation_{name.lower()}_xy")
    sense = choose["linear_unit_deviation_sense"] if first or second else "right_handed"
    direction = deviated(along, first, second, sense)
    if name != "A6" or p.deg("cardan_angle_a6") == 0:
        return direction
    choice = choose["kin206_cardan_axis"]
    sign = -1.0 if "minus" in choice else 1.0
    leaned: Vector = _ROTATIONS[choice[-1]](sign * p.deg("cardan_angle_a6")) @ direction
    return leaned


def deviated(along: str, first_deg: float, second_deg: float, sense: str) -> Vector:
    """Return a nominal direction tilted by two deviation angles (convention `linear_unit_deviation_sense`).

    Args:
        along: Nominal direction, "x" or "y".
        first_deg: Deviation in the XZ plane (along x) or the YZ plane (along y).
        second_deg: Deviation in the XY plane, applied outermost.
        sense: Choice of the convention.
    """
    if sense == "left_handed":
        first_deg, second_deg = -first_deg, -second_deg
    if sense == "toward_positive":
        # A turn towards the other axis is right-handed in XY from x and in YZ from y, left-handed in XZ and XY else.
        first_deg, second_deg = (-first_deg, second_deg) if along == "x" else (first_deg, -second_deg)
    (cos1, sin1), (cos2, sin2) = cos_sin_deg(first_deg), cos_sin_deg(second_deg)
    if along == "x":
        return np.array([cos2 * cos1, sin2 * cos1, -sin1])
    return np.array([-sin2 * cos1, cos2 * cos1, sin1])


RECIPES: Final[Mapping[int, RecipeFunction]] = {206: kin_206, 208: kin_208}
