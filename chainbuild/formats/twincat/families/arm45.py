"""KIN_TYP 45: the six-axis articulated arm.

Side view at internal zero (all axes after sign and zero offset at 0)::

                 HD9                HD10
        J3 o------------+
           |            | HD12
       HD8 |            +----o J4,J5 -----------o J6 ]] flange, z out of the flange = +X
           |                HD32 sideways (-Y)
        J2 o
           | HD7
    base --+--HD11-->  X
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final

from chainbuild.chain.assemble import Element, mark, shift, turn
from chainbuild.convention import Choices
from chainbuild.formats.twincat.recipes.recipe import Params, Recipe, RecipeFunction, head_rotary
from chainbuild.frames import rot_x, rot_y, rot_z

# HD34 → direction of the tool length in x, y, z.
_LENGTH_DIRECTIONS: Final = {
    1: (0.0, 0.0, -1.0),
    2: (-1.0, 0.0, 0.0),
    3: (0.0, -1.0, 0.0),
    4: (0.0, 0.0, 1.0),
    5: (1.0, 0.0, 0.0),
    6: (0.0, 1.0, 0.0),
}


def kin_45(p: Params, choose: Choices) -> Recipe:
    """Build the arm; with HD33 the flange carries the workpiece and HD1 to HD6 place a tool fixed in space."""

    def joint(name: str, direction: str) -> Element:
        key = name.lower()
        return head_rotary(
            choose, name, direction, sign=p.direction(f"direction_{key}"), zero_deg=p.deg(f"offset_{key}")
        )

    arm = [
        joint("C1", "z"),
        shift(x=p.mm("base_to_b1_x"), z=p.mm("base_to_b1_z")),
        joint("B1", "y"),
        shift(z=p.mm("b1_to_b2_z")),
        joint("B2", "y"),
        shift(p.mm("b2_to_b3_x"), -p.mm("a1_to_c1_y"), -p.mm("b3_to_b2_z")),
        joint("A1", "x"),
        joint("B3", "y"),
        shift(x=p.mm("b3_to_flange_x")),
        joint("A2", "x"),
    ]
    if p.flag("moving_workpiece"):
        axes = tuple(replace(axis, carries="workpiece") for axis in p.axes)
        return Recipe(tool=_tool(p, choose), workpiece=[*arm, *_flange(p, choose)], axes=axes)
    if p.flag("flange_variant") and choose["flange_variant_2"] == "base_frame_offsets_variant_1":
        return Recipe(tool=[*arm, mark("flange"), turn(rot_y(90)), _offsets(p), turn(rot_y(-90)), *_turned(p, choose)])
    return Recipe(tool=[*arm, *_flange(p, choose), *_tool(p, choose)])


def _flange(p: Params, choose: Choices) -> Sequence[Element]:
    """Return the turn from the hand (along +X at zero) to the flange frame."""
    if not p.flag("flange_variant"):
        return [turn(rot_y(90)), mark("flange")]
    if choose["flange_variant_2"] == "z_out_x_up":
        return [turn(rot_y(90) @ rot_z(180)), mark("flange")]
    return [mark("flange")]


def _tool(p: Params, choose: Choices) -> Sequence[Element]:
    return [_offsets(p), *_turned(p, choose)]


def _offsets(p: Params) -> Element:
    return shift(p.mm("tool_x"), p.mm("tool_y"), p.mm("tool_z"))


def _turned(p: Params, choose: Choices) -> Sequence[Element]:
    """Return the rotation of the tool frame and the tool length, in the order the convention says."""
    x, y, z = rot_x(p.deg("tool_rotation_x")), rot_y(p.deg("tool_rotation_y")), rot_z(p.deg("tool_rotation_z"))
    rotation = turn(x @ y @ z if p.flag("tool_rotation_order") else z @ y @ x)
    direction = _LENGTH_DIRECTIONS.get(p.flag("tool_length_direction"))
    if p.tool_length_mm == 0:
        return [rotation]
    if direction is None:
        text = f"the tool length of {p.tool_length_mm:g} mm has no effect, because HD34 is 0"
        p.note("CB407", "tool_length_direction", text, hint="HD34 from 1 to 6 gives the length a direction")
        return [rotation]
    length = shift(*(p.tool_length_mm * component for component in direction))
    # KIN_TYP manual 3.3 does not say in whose axes HD34 counts; without a turned tool it makes no difference.
    turned = any(p.deg(f"tool_rotation_{axis}") for axis in "xyz")
    return [length, rotation] if turned and choose["kin45_length_frame"] == "flange" else [rotation, length]


RECIPES: Final[Mapping[int, RecipeFunction]] = {45: kin_45}
