"""Palletising robots with a level flange: KIN_TYP 96 (four axes, linkage) and 213 (five axes).

Side view of 96 at zero (both arms as the conventions' defaults have them)::

          G3 o------ HD5 ------o--HD6--+
             |                         | HD10
         HD3 |                         + G4, tool downwards
             |
          G2 o
             | HD2
    base ----+--HD1--> X
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from chainbuild.chain.assemble import Element, Move, mark, rotary, shift, turn
from chainbuild.convention import Choices
from chainbuild.formats.twincat.recipes.parts import asked_sign
from chainbuild.formats.twincat.recipes.recipe import Params, Recipe, RecipeFunction, head_rotary
from chainbuild.frames import rot_x, rot_z

# Choice of `kin96_tool_offset` → signs of HD8, HD7 (x, y) and of HD9 (z).
_TOOL_SIGNS_96: Final = {"lateral_plus_z_down": (1.0, -1.0), "all_plus": (1.0, 1.0), "all_minus": (-1.0, -1.0)}


def kin_96(p: Params, choose: Choices) -> Recipe:
    """Build the palletiser with linkage: `level` turns the head back by the second arm's angle to the horizontal."""
    absolute = choose["kin96_arm2_angle"] == "absolute"
    arm1, arm2 = p.mm("g2_to_g3"), p.mm("g3_to_head")
    side, drop = p.mm("g1_to_g2_y"), p.mm("g3_to_g4_z")
    arm1_up = arm1 == 0 or choose["kin96_zero_pose"] == "arm1_up"
    return Recipe(
        tool=[
            rotary("G1", "z"),
            shift(p.mm("base_to_g2_x"), side * asked_sign(choose, "kin96_y_offset_sign", side), p.mm("base_to_g2_z")),
            rotary("G2", "y"),
            shift(z=arm1) if arm1_up else shift(x=arm1),
            rotary("G3", "y", drive={"G3": 1.0, "G2": -1.0} if absolute else {"G3": 1.0}),
            shift(x=arm2),
            rotary("level", "y", drive={"G3": -1.0} if absolute else {"G2": -1.0, "G3": -1.0}),
            shift(p.mm("head_to_g4"), 0.0, drop * asked_sign(choose, "kin96_head_z_sign", drop)),
            rotary("G4", "z"),
            mark("flange"),
            *_tool_96(p, choose),
        ]
    )


def _tool_96(p: Params, choose: Choices) -> list[Element]:
    x, y, z = (p.mm(f"tool_{letter}") for letter in "xyz")
    length = shift(z=-p.tool_length_mm)
    if not any((x, y, z)):
        return [length]
    lateral, height = _TOOL_SIGNS_96[choose["kin96_tool_offset"]]
    return [shift(lateral * x, lateral * y, height * z), length]


def kin_213(p: Params, choose: Choices) -> Recipe:
    """Build the five-axis palletiser: the six-axis arm of KIN_TYP 45 without its fourth joint."""

    def joint(name: str, direction: str) -> Move:
        key = name.lower()
        return head_rotary(
            choose, name, direction, sign=p.direction(f"direction_{key}"), zero_deg=p.deg(f"offset_{key}")
        )

    return Recipe(
        tool=[
            joint("G1", "z"),
            shift(x=p.mm("base_to_g2_x"), z=p.mm("base_to_g2_z")),
            joint("G2", "y"),
            shift(z=p.mm("g2_to_g3_z")),
            joint("G3", "y"),
            shift(x=p.mm("g3_to_g4_x"), z=-p.mm("g4_to_g3_z")),
            joint("G4", "y"),
            shift(x=p.mm("g4_to_g5_x"), z=-p.mm("g4_to_g5_z")),
            joint("G5", "z" if choose["kin213_g5_sense"] == "plus" else "-z"),
            *_tool_213(p, choose),
        ]
    )


def _tool_213(p: Params, choose: Choices) -> list[Element]:
    """Return flange, HD1 to HD3, HD6 and the tool length, by where z of the flange frame points."""
    frame = choose["kin213_flange_frame"]
    # Where z points out of the flange, lengths out of it count along +z.
    out = 1.0 if frame == "z_down" else -1.0
    height = p.mm("tool_z") * (1.0 if frame == "z_up_signed" else out)
    return [
        *([turn(rot_x(180))] if frame == "z_down" else []),
        mark("flange"),
        shift(p.mm("tool_x"), p.mm("tool_y"), height),
        turn(rot_z(p.deg("tool_rotation_z"))),
        shift(z=out * p.tool_length_mm),
    ]


RECIPES: Final[Mapping[int, RecipeFunction]] = {96: kin_96, 213: kin_213}
