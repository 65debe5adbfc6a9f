"""Machines whose rotary axes all carry the workpiece: KIN_TYP 34, 52, 57, 58, 64, 80, 81.

In 57, 58, 64, 80 and 81 X, Y, Z carry the tool and the table is separate::

    machine zero -- offset -- outer axis -- offset -- inner axis -- offset -- workpiece zero

They differ in the axes, and in which end of HD1 to HD3 is named first: 57, 58, 64 lead from the tool clamp to the
reference point of the slide, 80 and 81 from that point to the clamp.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from chainbuild.chain.assemble import Element, linear, shift
from chainbuild.convention import Choices
from chainbuild.formats.twincat.recipes.parts import (
    asked_offset,
    asked_sign,
    coded_sign,
    flagged_axis,
    offset,
    tool_end,
    tool_slides,
)
from chainbuild.formats.twincat.recipes.recipe import Params, Recipe, RecipeFunction, table_rotary


def kin_34(p: Params, choose: Choices) -> Recipe:
    """Build the X/C table: Y and Z carry the tool; X carries C."""
    x, y = p.mm("machine_to_c_x"), p.mm("machine_to_c_y")
    sign = asked_sign(choose, "kin34_offset_sign", x, y)
    slide: list[Element] = [linear("X", "x", sign=-1.0)]
    table: list[Element] = [shift(sign * x, sign * y), table_rotary(choose, "C", "z")]
    slide_below = choose["table_slide_order"] == "slides_carry_rotary"
    return Recipe(
        tool=[linear("Y", "y"), linear("Z", "z"), *tool_end(p)],
        workpiece=[*slide, *table] if slide_below else [*table, *slide],
    )


def kin_52(p: Params, choose: Choices) -> Recipe:
    """Build the A/B table on Z: X and Y carry the tool; Z carries A and B with the workpiece."""
    tool_y, to_a = p.mm("tool_y"), p.mm("workpiece_to_a_y")
    a = table_rotary(choose, "A", "x", sign=coded_sign(p, choose, "direction_a"))
    b = table_rotary(choose, "B", "y", sign=coded_sign(p, choose, "direction_b"))
    workpiece = shift(y=to_a * asked_sign(choose, "kin52_wcs_offset_sign", to_a))
    a_outside = choose["kin52_table_order"] == "a_carries_b"
    table: list[Element] = [a, workpiece, b] if a_outside else [b, a, workpiece]
    return Recipe(
        tool=[
            linear("X", "x"),
            linear("Y", "y"),
            *tool_end(p, y=tool_y * asked_sign(choose, "kin52_tool_y_sign", tool_y), z=-p.mm("tool_z")),
        ],
        workpiece=[linear("Z", "z", sign=-1.0), *table],
    )


def kin_57(p: Params, choose: Choices) -> Recipe:
    """Build the B/C table: B carries C."""
    return Recipe(
        tool=_clamp_to_slide(p, choose),
        workpiece=[
            offset(p, "machine_to_b"),
            flagged_axis(p, choose, "B", "y"),
            offset(p, "b_to_c"),
            flagged_axis(p, choose, "C", "z"),
            offset(p, "workpiece"),
        ],
    )


def kin_58(p: Params, choose: Choices) -> Recipe:
    """Build the A/C table: A carries C."""
    return Recipe(
        tool=_clamp_to_slide(p, choose),
        workpiece=[
            offset(p, "machine_to_a"),
            flagged_axis(p, choose, "A", "x"),
            offset(p, "a_to_c"),
            flagged_axis(p, choose, "C", "z"),
            offset(p, "workpiece"),
        ],
    )


def kin_64(p: Params, choose: Choices) -> Recipe:
    """Build the C/A/C table: C1 carries A, A carries C2."""
    return Recipe(
        tool=_clamp_to_slide(p, choose),
        workpiece=[
            offset(p, "machine_to_c1"),
            flagged_axis(p, choose, "C1", "z"),
            offset(p, "c1_to_a"),
            flagged_axis(p, choose, "A", "x"),
            offset(p, "a_to_c2"),
            flagged_axis(p, choose, "C2", "z"),
            offset(p, "workpiece"),
        ],
    )


def kin_80(p: Params, choose: Choices) -> Recipe:
    """Build the A/B table: A passes through the reference point of the slide at zero and carries B."""
    return Recipe(
        tool=_slide_to_clamp(p),
        workpiece=[
            asked_offset(p, choose, "machine_zero_sign", "machine_zero"),
            flagged_axis(p, choose, "A", "x"),
            offset(p, "a_to_b"),
            flagged_axis(p, choose, "B", "y"),
            offset(p, "b_to_workpiece"),
        ],
    )


def kin_81(p: Params, choose: Choices) -> Recipe:
    """Build the B/A table: B passes through the reference point of the slide at zero and carries A."""
    return Recipe(
        tool=_slide_to_clamp(p),
        workpiece=[
            asked_offset(p, choose, "machine_zero_sign", "machine_zero"),
            flagged_axis(p, choose, "B", "y"),
            offset(p, "b_to_a"),
            flagged_axis(p, choose, "A", "x"),
            offset(p, "a_to_workpiece"),
        ],
    )


def _clamp_to_slide(p: Params, choose: Choices) -> list[Element]:
    """Return the tool branch of 57, 58, 64: HD2, HD3 lead from the clamp to the slide, HD1 is a height."""
    x, y = p.mm("tool_x"), p.mm("tool_y")
    sign = asked_sign(choose, "slide_offset_sign", x, y)
    return [*tool_slides(), *tool_end(p, sign * x, sign * y, -p.mm("tool_z"))]


def _slide_to_clamp(p: Params) -> list[Element]:
    """Return the tool branch of 80, 81: HD2, HD3 lead from the slide to the clamp, HD1 is a height."""
    return [*tool_slides(), *tool_end(p, p.mm("tool_x"), p.mm("tool_y"), -p.mm("tool_z"))]


RECIPES: Final[Mapping[int, RecipeFunction]] = {
    34: kin_34,
    52: kin_52,
    57: kin_57,
    58: kin_58,
    64: kin_64,
    80: kin_80,
    81: kin_81,
}
