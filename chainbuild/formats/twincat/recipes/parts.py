"""Pieces that recipes of several families share: slides, offsets by name, flagged axes, the tool's end.

Everything here returns elements of `chain.assemble`; lengths are mm, angles degrees.
"""

from __future__ import annotations

from typing import Final, Literal

from chainbuild.chain.assemble import Element, Fixed, Move, linear, mark, shift
from chainbuild.convention import Choices
from chainbuild.formats.twincat.recipes.recipe import Direction, Params, table_flag, table_rotary

_FLAG_VALUES: Final = (-1, 0, 1)  # off, and the two directions


def tool_slides() -> list[Element]:
    """Return X, Y, Z, all carrying the tool."""
    return [linear("X", "x"), linear("Y", "y"), linear("Z", "z")]


def offset(p: Params, name: str, sign: float = 1.0) -> Fixed:
    """Return the shift by the three HDs NAME_x, NAME_y, NAME_z, times sign."""
    x, y, z = (p.mm(f"{name}_{letter}") for letter in "xyz")
    return shift(sign * x, sign * y, sign * z)


def tool_end(p: Params, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> list[Element]:
    """Return the last part of a machine tool's branch: to the clamping point, and the tool length down from there."""
    return [shift(x, y, z), mark("flange"), shift(z=-p.tool_length_mm)]


def asked_sign(choose: Choices, convention: str, *values: float) -> float:
    """Return the sign a plus/minus convention gives to values; it is used only where one of them is not zero."""
    return float(choose.sign(convention)) if any(values) else 1.0


def asked_offset(p: Params, choose: Choices, convention: str, name: str) -> Fixed:
    """Return the shift by NAME_x, NAME_y, NAME_z with the sign of a plus/minus convention."""
    return offset(p, name, asked_sign(choose, convention, *(p.mm(f"{name}_{letter}") for letter in "xyz")))


def coded_sign(p: Params, choose: Choices, key: str | int) -> float:
    """Return a direction of motion of KIN_TYP 22, 23 and 52, whose coding is not printed (convention `sign_coding`).

    Zero counts as +1 in both readings and leaves a finding; they differ at positive values only. Other values than
    -1, 0 and 1 are refused.
    """
    row, value = p.data.row(key), p.number(key)
    if value not in row.permitted:
        p.refuse(key, f"HD{row.n} is {value:g}", ", ".join(f"{choice:g}" for choice in row.permitted))
    sign = p.sign(key)
    if value > 0 and choose["sign_coding"] == "zero_one":
        return -1.0
    return sign


def flagged_axis(
    p: Params,
    choose: Choices,
    name: str,
    direction: Direction,
    carries: Literal["tool", "workpiece"] = "workpiece",
) -> Move:
    """Return a rotary axis with the HDs direction_NAME and offset_NAME (KIN_TYP 57, 58, 61, 63, 64, 80 to 82).

    The manual names these flags without their values, so a number other than a flag is decoded, not refused; it
    leaves finding CB430.
    """
    flag = f"direction_{name.lower()}"
    sign, value = table_flag(p, choose, flag), p.number(flag)
    if value not in _FLAG_VALUES:
        text = f"the direction flag HD{p.data.row(flag).n} of {name} is {value:.10g}; it is read as {sign:+g}"
        hint = "0 keeps the sense of rotation, 1 reverses it"
        p.note("CB430", flag, text, hint=f"{hint}; is this a length at the wrong index?" if abs(value) > 1 else hint)
    return table_rotary(choose, name, direction, sign=sign, zero_deg=p.deg(f"offset_{name.lower()}"), carries=carries)
