"""KIN_TYP 8, 10, 18, 207: the saw spindle on C and A, with axes on drives or set by hand.

Seen along -X at C = 0 with A = 90, the rest position::

      X, Y, Z ──o head reference point, static offset HD7 (x), HD8 (y)
                |
                C   about Z
                |   HD9 (x), HD10 (y), HD3 down
                A───HD2───[ ]───  clamped blade, tool length on along +Y; tool vector -Y
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

from chainbuild import tolerances
from chainbuild.chain.assemble import Element, Move, linear, shift, turn
from chainbuild.convention import Choices
from chainbuild.formats.twincat.recipes.head_parts import flip, slides, towards_slide, zero_deg
from chainbuild.formats.twincat.recipes.parts import tool_end
from chainbuild.formats.twincat.recipes.recipe import Drive, Params, Recipe, RecipeFunction, driven
from chainbuild.frames import cos_sin_deg, rot_x, rot_z


def kin_8(p: Params, choose: Choices) -> Recipe:
    """Build the saw on C; A is set by hand."""
    return Recipe(tool=[*slides(p, choose), _c(p, choose), *_spindle(p, choose, _set_a(p))])


def kin_10(p: Params, choose: Choices) -> Recipe:
    """Build the saw on C and A."""
    a = driven("A", "x", Drive(1.0, -zero_deg(p, choose, "offset_a")))
    return Recipe(tool=[*slides(p, choose), _c(p, choose), *_spindle(p, choose, a)])


def kin_18(p: Params, choose: Choices) -> Recipe:
    """Build the saw with both C and A set by hand."""
    return Recipe(tool=[*slides(p, choose), turn(rot_z(p.deg("setting_c"))), *_spindle(p, choose, _set_a(p))])


def kin_207(p: Params, choose: Choices) -> Recipe:
    """Build the inclined cutting tool: X and Y belong to the cutting plane, Z plunges along the blade."""
    head = slides(p, choose)
    plunge = _plunge(p, choose)
    return Recipe(tool=[*head, *plunge[:1], _c(p, choose), *plunge[1:], *_spindle(p, choose, _set_a(p))])


def _c(p: Params, choose: Choices) -> Move:
    return driven("C", "z", Drive(1.0, -zero_deg(p, choose, "offset_c")))


def _set_a(p: Params) -> Element:
    return turn(rot_x(p.deg("setting_a")))


def _spindle(p: Params, choose: Choices, a: Element) -> Sequence[Element]:
    """Return what C carries."""
    x, y = p.mm("a_to_c_x"), p.mm("a_to_c_y")
    s = towards_slide(choose, x, y)
    return [shift(-s * x, -s * y, -p.mm("a_to_head_z")), a, *tool_end(p, z=_length(p, choose))]


def _length(p: Params, choose: Choices) -> float:
    """Return where the clamped tool lies on the spindle, seen from A along the tool vector [mm]."""
    length = p.mm("spindle_length")
    return -flip(choose, "saw_hd2_sign", "plus", length) * length


def _plunge(p: Params, choose: Choices) -> Sequence[Element]:
    """Return the joints that lead from the tip to the programmed point of KIN_TYP 207: before C, then on C.

    The tip, at height p_z = Z + below, is slid along Rz(c)·Rx(HD4)·e_y onto the plane z0. What of it is level is a
    slide along y on C by (z0 - p_z)·cot HD4; "slid_xyz" also takes the height to z0.
    """
    point = choose["kin207_programmed_point"]
    if point == "tip":
        return [shift()]
    cosine, sine = cos_sin_deg(p.deg("setting_a"))
    if abs(sine) < tolerances.ZERO_VECTOR:
        text = (
            f"with HD4 = {p.deg('setting_a'):g} degrees the blade is level and cannot plunge to the cutting height HD11"
        )
        p.refuse("setting_a", text, "an inclination other than 0 and 180 degrees")
        return [shift()]
    text = "Z also moves the programmed point sideways, in the direction of the blade; the tool cannot go below HD11"
    p.note("CB422", "cutting_height", text, hint="a URDF file holds the motion as the free joint 'plunge'")
    below = -p.mm("a_to_head_z") + (_length(p, choose) - p.tool_length_mm) * cosine
    relative = below != 0 and choose["kin207_z0"] == "relative"
    z0 = p.mm("cutting_height") + (below if relative else 0.0)
    slope = cosine / sine
    slide = linear("plunge", "y", drive={"Z": -slope}, offset_mm=slope * (z0 - below))
    if point == "slid_xyz":
        return [linear("plane", "z", drive={"Z": -1.0}, offset_mm=z0 - below), slide]
    return [shift(), slide]


RECIPES: Final[Mapping[int, RecipeFunction]] = {8: kin_8, 10: kin_10, 18: kin_18, 207: kin_207}
