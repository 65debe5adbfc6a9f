"""Slides with a lever or an eccentric disc in place of the missing slide: KIN_TYP 85, 205."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from chainbuild.chain.assemble import Element, linear, mark, shift, turn
from chainbuild.convention import Choices
from chainbuild.formats.twincat.recipes.parts import asked_sign, offset
from chainbuild.formats.twincat.recipes.recipe import Drive, Params, Recipe, RecipeFunction, driven, head_rotary
from chainbuild.frames import cos_sin_deg, rot_y, rot_z

# HD16, HD17 of 205 → axis of the disc; 0/0 is the discontinued state.
_DISC_AXES: Final = {(1, 0): "z", (0, 1): "x"}
# Choice of `kin205_zero_points` of 205 → the zero positions that act.
_ZERO_POINTS: Final = {
    "sum": ("machine_to_x", "machine_to_z"),
    "x_only": ("machine_to_x",),
    "z_only": ("machine_to_z",),
}


def kin_85(p: Params, choose: Choices) -> Recipe:
    """Build the lever on a slide: the arm swings in the XZ plane, C is its angle to the horizontal.

    Both bends of the arm, left and right, reach a point with different X; the controller keeps the one it was
    switched on in.
    """
    zero = p.deg("offset_c")
    pivot = Drive(1.0, zero * asked_sign(choose, "kin85_angle_offset_sign", zero))
    upwards = choose["kin85_lever_sense"] == "raises"
    return Recipe(
        tool=[
            linear("X", "x"),
            shift(z=p.mm("centre_z")),
            driven("C", "-y" if upwards else "y", pivot),
            shift(x=p.mm("arm_length")),
            mark("flange"),
            *_lever_tool(p, choose),
        ]
    )


def _lever_tool(p: Params, choose: Choices) -> list[Element]:
    length = p.tool_length_mm
    if length == 0:
        return []
    effect = choose["kin85_tool_length"]
    if effect == "ignored":
        text = f"the tool length of {length:g} mm has no effect: KIN_TYP 85 has no tool offset"
        p.note("CB407", "arm_length", text, hint="--convention kin85_tool_length=… lets it act")
        return []
    return [shift(x=length) if effect == "along_arm" else shift(z=-length)]


def kin_205(p: Params, choose: Choices) -> Recipe:
    """Build the eccentric disc: X and Z carry the disc C, on which the tool sits off centre."""
    about = _disc_axis(p, choose)
    return Recipe(
        tool=[
            *_zero_points(p, choose),
            linear("X", "x", sign=p.sign("direction_x", zero_is_plus=True)),
            linear("Z", "z", sign=p.sign("direction_z", zero_is_plus=True)),
            head_rotary(choose, "C", about, sign=p.sign("direction_c", zero_is_plus=True), zero_deg=p.deg("offset_c")),
            *_disc_tool(p, choose, about),
        ]
    )


def _disc_axis(p: Params, choose: Choices) -> str:
    """Return what the disc turns about, "x" or "z", by HD16 and HD17."""
    flags = (p.flag("turns_about_z"), p.flag("turns_about_x"))
    if flags == (0, 0):
        text = "HD16 and HD17 are both 0, a discontinued state of KIN_TYP 205 whose axis the manual does not name"
        p.note("CB431", "turns_about_z", text, hint="HD16 = 1: the disc turns about Z; HD17 = 1: about X")
        return "z" if choose["kin205_legacy_mode"] == "about_z" else "x"
    if flags not in _DISC_AXES:
        p.refuse("turns_about_x", "HD16 and HD17 are both 1: the disc turns about Z or about X", "one of them 0")
    return _DISC_AXES.get(flags, "z")


def _zero_points(p: Params, choose: Choices) -> list[Element]:
    """Return the zero positions of the slides, both counted from the machine zero."""
    if not any(p.mm(n) for n in range(6, 12)):
        return []
    counted = _ZERO_POINTS[choose["kin205_zero_points"]]
    return [offset(p, name) for name in counted]


def _disc_tool(p: Params, choose: Choices, about: str) -> list[Element]:
    """Return the tool on the disc: its polar and its Cartesian place add."""
    cos, sin = cos_sin_deg(p.deg("tool_angle"))
    r, s = p.mm("tool_radius") * cos + p.mm("tool_x"), p.mm("tool_radius") * sin + p.mm("tool_y")
    tool: list[Element] = [mark("flange"), shift(z=-p.mm("tool_length_offset") - p.tool_length_mm)]
    if about == "z":
        return [shift(r, s), *tool]
    variant = choose["kin205_x_variant"]
    if variant == "tool_along_z":
        return [shift(0.0, r, s), *tool]
    # Both turn the tool's z to X; the first one turns its x to Y, too.
    tilted = rot_y(90) @ rot_z(90) if variant == "yz_plane" else rot_y(90)
    return [turn(tilted), shift(r, s), *tool]


RECIPES: Final[Mapping[int, RecipeFunction]] = {85: kin_85, 205: kin_205}
