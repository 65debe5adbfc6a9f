"""Turning machines that work with a rotary axis in place of a slide: KIN_TYP 13, 14, 202, 203.

The rotary workpiece axis turns about Z. The controller shows X and Y on the workpiece while the machine moves a slide
and the spindle; the chain is that of the machine axes, so inverse kinematics finds them from X and Y.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from chainbuild.chain.assemble import Element, linear, mark, shift, turn
from chainbuild.convention import Choices
from chainbuild.formats.twincat.recipes.parts import asked_sign, offset, tool_end
from chainbuild.formats.twincat.recipes.recipe import Params, Recipe, RecipeFunction, head_rotary, table_rotary
from chainbuild.frames import rot_y, rot_z

# Choice of `kin203_arm_zero` → direction of the arm in x, y.
_ARM_ZERO: Final = {"deg_0": (1.0, 0.0), "deg_90": (0.0, 1.0), "deg_180": (-1.0, 0.0), "deg_270": (0.0, -1.0)}


def kin_13(p: Params, choose: Choices) -> Recipe:
    """Build the face machining of 13 and 14; 14 differs only in the sign of X that the controller keeps.

    A tool off the X axis by HD4 cannot reach the circle of that radius about the turning centre.
    """
    y = p.mm("tool_y")
    return Recipe(
        tool=[
            linear("X", "x"),
            linear("Z", "z"),
            *tool_end(p, y=y * asked_sign(choose, "face_y_offset_sign", y), z=-p.mm("tool_z")),
        ],
        workpiece=[table_rotary(choose, "C", "z", sign=p.direction("direction_c"))],
    )


def kin_202(p: Params, choose: Choices) -> Recipe:
    """Build the swivelling turning tool: at zero it lies along X and points left (HD10 = 0) or right (1)."""
    right = p.flag("right_variant")
    spindle: list[Element] = [offset(p, "machine_to_cs"), _spindle(p, choose, "CS")]
    if right and choose["kin202_right_frame"] == "turned_180":
        spindle.append(turn(rot_z(180)))
    return Recipe(
        tool=[
            offset(p, "machine_to_xq"),
            linear("XQ", "x"),
            linear("ZQ", "z"),
            head_rotary(choose, "YQ", "z", zero_deg=p.deg("offset_yq")),
            turn(rot_y(-90.0 if right else 90.0)),
            *_lengthened_tool(p),
        ],
        workpiece=spindle,
    )


def kin_203(p: Params, choose: Choices) -> Recipe:
    """Build the face machining with a tool arm: ZL carries YL, the arm is offset from YL by HD10."""
    length = p.mm("arm_length")
    x, y = _ARM_ZERO[choose["kin203_arm_zero"]] if length else (0.0, 0.0)
    return Recipe(
        tool=[
            offset(p, "machine_to_yl"),
            linear("ZL", "z"),
            head_rotary(choose, "YL", "z", zero_deg=p.deg("offset_yl")),
            shift(length * x, length * y),
            *_lengthened_tool(p),
        ],
        workpiece=[offset(p, "machine_to_c"), _spindle(p, choose, "C")],
    )


def _spindle(p: Params, choose: Choices, name: str) -> Element:
    return table_rotary(choose, name, "z", zero_deg=p.deg(f"offset_{name.lower()}"))


def _lengthened_tool(p: Params) -> list[Element]:
    """Return the tool's end where HD1 adds to the tool length."""
    return [mark("flange"), shift(z=-p.mm("tool_length_offset") - p.tool_length_mm)]


RECIPES: Final[Mapping[int, RecipeFunction]] = {13: kin_13, 14: kin_13, 202: kin_202, 203: kin_203}
