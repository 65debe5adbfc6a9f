"""Pieces that the tool-head families share: slides with the static offset, and the rules of their signs."""

from __future__ import annotations

from chainbuild.chain.assemble import Element, shift
from chainbuild.convention import Choices
from chainbuild.formats.twincat.recipes.parts import asked_sign, tool_slides
from chainbuild.formats.twincat.recipes.recipe import Params


def flip(choose: Choices, convention: str, reversing: str, *values: float) -> float:
    """Return -1 where a convention has the choice `reversing`, else +1; used only where one of the values is not 0."""
    return -1.0 if any(values) and choose[convention] == reversing else 1.0


def slides(p: Params, choose: Choices) -> list[Element]:
    """Return X, Y, Z and the static offset behind them, which no rotary axis turns (where the HD table has one)."""
    names = {row.name for row in p.data.hd}
    offset = [p.mm(key) if key in names else 0.0 for key in ("static_x", "static_y", "static_z")]
    s = asked_sign(choose, "static_offset_sign", *offset)
    return [*tool_slides(), shift(*(s * length for length in offset))]


def towards_slide(choose: Choices, *lengths_mm: float) -> float:
    """Return the sign of lateral offsets 'from P to Q': +1 for Q - P (convention `named_offset_sign`)."""
    return flip(choose, "named_offset_sign", "q_to_p", *lengths_mm)


def zero_deg(p: Params, choose: Choices, key: str) -> float:
    """Return a rotary zero offset of a head axis as what is subtracted (convention `angle_offset_sign`)."""
    offset = p.deg(key)
    return flip(choose, "angle_offset_sign", "plus", offset) * offset


def direction_sign(p: Params, key: str) -> float:
    """Return a direction sign, +1 or -1; a value that the table does not permit is refused."""
    row, value = p.data.row(key), p.number(key)
    if value not in row.permitted:
        p.refuse(key, f"HD{row.n} is {value:g}", ", ".join(f"{choice:g}" for choice in row.permitted))
    return p.sign(key)
