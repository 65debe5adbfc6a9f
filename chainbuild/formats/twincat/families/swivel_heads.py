"""KIN_TYP 2, 16, 22, 30, 70: heads that swivel about X and Y.

Seen along -Y at zero; 2 has A outside, 16 and 70 have B outside, in 22 both meet in a point, 30 has A alone::

      X, Y, Z ──o slide
                |  offsets to the outer axis
                B
                |  HD4 down, HD5 (x)        (16, 70)
                A
                |  HD1 down, HD6 (y)        (16, 70)
               [ ] clamped tool; tool length down
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from chainbuild.chain.assemble import Element, linear, shift, turn
from chainbuild.chain.axismap import AffineMap, AxisMap
from chainbuild.chain.elements import Axis
from chainbuild.convention import Choices
from chainbuild.formats.twincat.maps.drives import VirtualTurnDrives
from chainbuild.formats.twincat.maps.heads import VirtualTurnMap
from chainbuild.formats.twincat.recipes.head_parts import direction_sign, flip, slides, towards_slide, zero_deg
from chainbuild.formats.twincat.recipes.parts import asked_sign, coded_sign, tool_end
from chainbuild.formats.twincat.recipes.recipe import (
    Drive,
    Params,
    Recipe,
    RecipeFunction,
    driven,
    mapped,
    zero_and_sign,
)
from chainbuild.frames import rot_z
from chainbuild.units import si_factor


def kin_2(p: Params, choose: Choices) -> Recipe:
    """Build the A/B swivel head: A carries B."""
    x, y = p.mm("b_to_a_x"), p.mm("b_to_a_y")
    s = towards_slide(choose, x, y)
    at_b = (x or y) and choose["kin2_slide_point"] == "b_axis_at_zero"
    return Recipe(
        tool=[
            *slides(p, choose),
            shift(s * x, s * y) if at_b else shift(),
            driven("A", "x", Drive()),
            shift(-s * x, -s * y),
            driven("B", "y", Drive()),
            *tool_end(p, z=-p.mm("tool_z")),
        ],
    )


def kin_16(p: Params, choose: Choices) -> Recipe:
    """Build the B/A swivel head: B carries A."""
    slide_x, slide_y, tool_y = p.mm("b_to_slide_x"), p.mm("a_to_slide_y"), p.mm("tool_y")
    s = towards_slide(choose, slide_x, slide_y, tool_y)
    a_z, tool_z, a_x = p.mm("b_to_a_z"), p.mm("tool_z"), p.mm("b_to_a_x")
    down = -flip(choose, "kin16_heights", "signed", a_z, tool_z)
    return Recipe(
        tool=[
            *slides(p, choose),
            shift(-s * slide_x, -s * slide_y),
            driven("B", "y", _drive(p, choose, "b")),
            shift(x=asked_sign(choose, "kin16_hd5_sign", a_x) * a_x, z=down * a_z),
            driven("A", "x", _drive(p, choose, "a")),
            *tool_end(p, y=s * tool_y, z=down * tool_z),
        ],
    )


def kin_22(p: Params, choose: Choices) -> Recipe:
    """Build the X/Y table under an A/B head whose axes meet in one point."""
    a = driven("A", "x", Drive(coded_sign(p, choose, "direction_a")))
    b = driven("B", "y", Drive(coded_sign(p, choose, "direction_b")))
    order = (a, b) if choose["kin22_axis_order"] == "a_outside" else (b, a)
    return Recipe(
        tool=[linear("Z", "z"), *order, *tool_end(p, z=-p.mm("tool_z"))],
        workpiece=[linear("X", "x", sign=-1.0), linear("Y", "y", sign=-1.0)],
    )


def kin_30(p: Params, choose: Choices) -> Recipe:
    """Build the A head."""
    slide_x, slide_y, x, y = p.mm("a_to_slide_x"), p.mm("a_to_slide_y"), p.mm("tool_x"), p.mm("tool_y")
    s = towards_slide(choose, slide_x, slide_y, x, y)
    return Recipe(
        tool=[
            *slides(p, choose),
            shift(-s * slide_x, -s * slide_y, -p.mm("a_to_slide_z")),
            driven("A", "x", _drive(p, choose, "a")),
            *tool_end(p, -s * x, -s * y, -p.mm("tool_z")),
        ],
    )


def kin_70(p: Params, choose: Choices) -> Recipe:
    """Build the B/A head turned by HD14 about Z; CV turns the programmed tool vector and has no drive."""
    b, a = _drive(p, choose, "b"), _drive(p, choose, "a")
    slide_x, slide_y, a_x, tool_y = p.mm("b_to_slide_x"), p.mm("a_to_slide_y"), p.mm("b_to_a_x"), p.mm("tool_y")
    s = flip(choose, "kin70_lateral_sign", "reversed", slide_x, slide_y, a_x, tool_y)
    lead = [*slides(p, choose), *_mounted(p, choose, shift(-s * slide_x, -s * slide_y))]
    axis_map = _virtual_axis(p, choose, b, a)
    turned = isinstance(axis_map, VirtualTurnMap)
    return Recipe(
        tool=[
            *lead,
            mapped("B", "y") if turned else driven("B", "y", b),
            shift(x=s * a_x, z=-p.mm("b_to_a_z")),
            mapped("A", "x") if turned else driven("A", "x", a),
            *tool_end(p, y=s * tool_y, z=-p.mm("tool_z")),
        ],
        axes=tuple(_limited(axis) for axis in p.axes),
        axis_map=axis_map,
        drives=VirtualTurnDrives(axis_map) if isinstance(axis_map, VirtualTurnMap) else None,
    )


def _mounted(p: Params, choose: Choices, to_slide: Element) -> tuple[Element, Element]:
    """Return the turn HD14 of the head of 70 and the offset to the slide, in the order the convention says."""
    angle = p.deg("mounting_angle")
    mounting = turn(rot_z(asked_sign(choose, "kin70_hd14_sign", angle) * angle))
    outside = (
        angle and flip(choose, "kin70_offset_place", "outside_hd14", p.mm("b_to_slide_x"), p.mm("a_to_slide_y")) < 0
    )
    return (to_slide, mounting) if outside else (mounting, to_slide)


def _limited(axis: Axis) -> Axis:
    """Return an axis of 70 with the range that KIN_TYP manual 2.33 permits A and B; CV is an input of its own."""
    if axis.name in ("A", "B"):
        return replace(axis, lower=-90.0, upper=90.0)
    return replace(axis, held=True) if axis.name == "CV" else axis


def _virtual_axis(p: Params, choose: Choices, b: Drive, a: Drive) -> AxisMap:
    if choose["kin70_cv"] == "programmed":
        text = "B, A and CV are programmed: a URDF file holds the angles B, A of the machine that follow from them"
        p.note("CB421", "direction_b", text)
        signs = (1.0, 1.0, 1.0, b.sign, a.sign, 1.0)
        return VirtualTurnMap.of(signs, (0.0, 0.0, 0.0, b.offset_deg, a.offset_deg, 0.0))
    A = np.eye(5, 6)  # CV drives no joint
    return AffineMap(A, np.zeros(5), np.array([si_factor(axis.kind) for axis in p.axes]), A.T.copy())


def _drive(p: Params, choose: Choices, axis: str) -> Drive:
    """Return the drive of a signed axis with a zero offset."""
    sign, zero = direction_sign(p, f"direction_{axis}"), zero_deg(p, choose, f"offset_{axis}")
    return zero_and_sign(choose, sign, zero, printed="outside")


RECIPES: Final[Mapping[int, RecipeFunction]] = {2: kin_2, 16: kin_16, 22: kin_22, 30: kin_30, 70: kin_70}
