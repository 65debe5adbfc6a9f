"""Machines with a rotary axis on each side, tool and workpiece: KIN_TYP 1, 23, 61, 63, 82."""

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
from chainbuild.formats.twincat.recipes.recipe import Params, Recipe, RecipeFunction, head_rotary, table_rotary


def kin_1(p: Params, choose: Choices) -> Recipe:
    """Build the bed-type machine: Z and B carry the tool; X, Y and C the workpiece."""
    # HD13 is coded the other way round than every other flag: 0 is the negative sense.
    b_sign = 1.0 if p.flag("direction_b") else -1.0
    return Recipe(
        tool=[
            linear("Z", "z"),
            shift(p.mm("slide_to_b_x"), p.mm("slide_to_b_y"), -p.mm("b_to_slide_z")),
            table_rotary(choose, "B", "y", sign=b_sign, zero_deg=p.deg("offset_b"), carries="tool"),
            *tool_end(p, p.mm("tool_x"), p.mm("tool_y"), -p.mm("tool_z")),
        ],
        workpiece=[
            *_cross_table(),
            offset(p, "machine_to_c"),
            table_rotary(choose, "C", "z", sign=p.direction("direction_c"), zero_deg=p.deg("offset_c")),
        ],
    )


def kin_23(p: Params, choose: Choices) -> Recipe:
    """Build the X/Y/B table with an A head: B carries the platform with the workpiece."""
    height = p.mm("b_to_workpiece_z")
    b: list[Element] = [table_rotary(choose, "B", "y", sign=coded_sign(p, choose, "direction_b"))]
    slides_below = choose["table_slide_order"] == "slides_carry_rotary"
    return Recipe(
        tool=[
            linear("Z", "z"),
            head_rotary(choose, "A", "x", sign=coded_sign(p, choose, "direction_a")),
            *tool_end(p, z=-p.mm("tool_z")),
        ],
        workpiece=[
            *([*_cross_table(), *b] if slides_below else [*b, *_cross_table()]),
            shift(z=height * asked_sign(choose, "kin23_platform_sign", height)),
        ],
    )


def kin_61(p: Params, choose: Choices) -> Recipe:
    """Build the Y/A table with a B head: X, Z and B carry the tool, Y carries A."""
    return Recipe(
        tool=[linear("X", "x"), linear("Z", "z"), *_swivel_head(p, choose, "B", "y")],
        workpiece=[linear("Y", "y", sign=-1.0), *_turning_table(p, choose, "A", "x")],
    )


def kin_63(p: Params, choose: Choices) -> Recipe:
    """Build the X/Y/B table with an A head: Z and A carry the tool, X and Y carry B."""
    return Recipe(
        tool=[linear("Z", "z"), *_swivel_head(p, choose, "A", "x")],
        workpiece=[*_cross_table(), *_turning_table(p, choose, "B", "y")],
    )


def kin_82(p: Params, choose: Choices) -> Recipe:
    """Build the B/A head over a C table: B carries A, which has neither flag nor zero offset."""
    return Recipe(
        tool=[
            *tool_slides(),
            offset(p, "b_to_slide", -1.0),
            flagged_axis(p, choose, "B", "y", "tool"),
            offset(p, "a_to_b", -1.0),
            head_rotary(choose, "A", "x"),
            *tool_end(p, -p.mm("tool_x"), -p.mm("tool_y"), -p.mm("tool_z")),
        ],
        workpiece=[
            asked_offset(p, choose, "machine_zero_sign", "machine_zero"),
            flagged_axis(p, choose, "C", "z"),
            offset(p, "c_to_workpiece"),
        ],
    )


def _cross_table() -> list[Element]:
    """Return X and Y that carry the workpiece: X100 drives the table to -X."""
    return [linear("X", "x", sign=-1.0), linear("Y", "y", sign=-1.0)]


def _swivel_head(p: Params, choose: Choices, name: str, direction: str) -> list[Element]:
    """Return the head of 61 and 63: from the reference point of the slide over the pivot to the clamp."""
    to_slide = f"{name.lower()}_to_slide"
    acts = any(p.mm(f"{to_slide}_{letter}") for letter in "xyz")
    absorbed = acts and choose["pivot_to_slide_effect"] == "absorbed"
    return [
        offset(p, to_slide, 0.0 if absorbed else -1.0),
        flagged_axis(p, choose, name, direction, "tool"),
        *tool_end(p, p.mm("tool_x"), p.mm("tool_y"), -p.mm("tool_z")),
    ]


def _turning_table(p: Params, choose: Choices, name: str, direction: str) -> list[Element]:
    """Return the rotary table of 61 and 63, whose axis meets the head's axis at the ideal zero."""
    return [
        asked_offset(p, choose, "machine_zero_sign", "machine_zero"),
        flagged_axis(p, choose, name, direction),
        offset(p, f"{name.lower()}_to_workpiece"),
        offset(p, "workpiece"),
    ]


RECIPES: Final[Mapping[int, RecipeFunction]] = {1: kin_1, 23: kin_23, 61: kin_61, 63: kin_63, 82: kin_82}
