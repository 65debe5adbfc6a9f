"""KIN_TYP 36: the SCARA, two horizontal arms with a vertical slide at their end.

Top view at zero (arms stretched along +X)::

    (HD4, HD5) C1 o------- HD2 -------o C2 ------- HD3 -------o Z, C3, tool downwards

The elbow left or right of the stretched arm is fixed when the transformation is switched on.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from chainbuild.chain.assemble import linear, mark, rotary, shift
from chainbuild.convention import Choices
from chainbuild.formats.twincat.recipes.parts import asked_sign
from chainbuild.formats.twincat.recipes.recipe import Drive, Params, Recipe, RecipeFunction, driven


def kin_36(p: Params, choose: Choices) -> Recipe:
    """Build the SCARA; with HD7 = 1 C2 is the second arm's angle to the X axis, so that joint 2 is C2 - C1."""
    x, y = p.mm("base_to_c1_x"), p.mm("base_to_c1_y")
    base = asked_sign(choose, "kin36_base_offset_sign", x, y)
    zero1, zero2 = p.deg("offset_c1"), p.deg("offset_c2")
    counted = asked_sign(choose, "kin36_angle_offset_sign", zero1, zero2)
    first, second = counted * zero1, counted * zero2
    elbow = driven("C2", "z", Drive(1.0, second))
    wrist = rotary("C3", "z")
    if p.flag("absolute_c2"):
        elbow = rotary("C2", "z", drive={"C2": 1.0, "C1": -1.0}, offset_deg=second - first)
        if choose["kin36_tool_angle"] == "follows_hd7":
            wrist = rotary("C3", "z", drive={"C3": 1.0, "C2": -1.0}, offset_deg=-second)
    return Recipe(
        tool=[
            shift(base * x, base * y),
            driven("C1", "z", Drive(1.0, first)),
            shift(x=p.mm("c1_to_c2_x")),
            elbow,
            shift(x=p.mm("c2_to_c3_x")),
            linear("Z", "z"),
            wrist,
            mark("flange"),
            shift(z=-p.mm("tool_z") - p.tool_length_mm),
        ]
    )


RECIPES: Final[Mapping[int, RecipeFunction]] = {36: kin_36}
