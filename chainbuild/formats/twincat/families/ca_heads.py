"""KIN_TYP 7, 9, 17, 25, 28: the C/A fork head, with axes on drives, behind a gear or set by hand.

Seen along -X at zero; what lies below C turns with it, what lies below A swivels::

      X, Y, Z ──o head reference point, static offset HD7 (x), HD8 (y)
                |
                C   about Z
                |   HD6 (x), HD5 (y) crank, HD2 down
                A   about X
                |   HD9 (y), HD1 down
               [ ]  clamped tool; tool length down
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from chainbuild.chain.assemble import Element, Move, linear, rotary, shift, turn
from chainbuild.chain.drives import AffineDrives
from chainbuild.convention import Choices
from chainbuild.formats.twincat.maps.length import NozzleLaw, TiltLengthMap
from chainbuild.formats.twincat.recipes.head_parts import direction_sign, slides, towards_slide, zero_deg
from chainbuild.formats.twincat.recipes.parts import asked_sign, tool_end
from chainbuild.formats.twincat.recipes.recipe import Drive, Params, Recipe, RecipeFunction, driven, zero_and_sign
from chainbuild.frames import rot_x, rot_z
from chainbuild.units import m_from_mm

# Tilt of the nozzle of KIN_TYP 25 without given limits: its length grows beyond all bounds towards 90 degrees.
_NOZZLE_TILT_DEG: Final = 80.0


def kin_9(p: Params, choose: Choices) -> Recipe:
    """Build the C/A head."""
    c, a = Drive(1.0, -zero_deg(p, choose, "offset_c")), Drive(1.0, -zero_deg(p, choose, "offset_a"))
    return Recipe(tool=_fork(p, choose, driven("C", "z", c), driven("A", "x", a)))


def kin_25(p: Params, choose: Choices) -> Recipe:
    """Build the plasma or laser head: the length behind the nozzle grows so that the tip keeps its height."""
    c, a = Drive(1.0, -zero_deg(p, choose, "offset_c")), Drive(1.0, -zero_deg(p, choose, "offset_a"))
    fork = _fork(p, choose, driven("C", "z", c), driven("A", "x", a))
    growing = p.tool_length_mm
    if p.mm("tool_z") and choose["kin25_length"] == "head_and_gap":
        growing += p.mm("tool_z")
    if growing == 0:
        return Recipe(tool=fork)
    text = "the nozzle's length follows the tilt A: a URDF file holds it as the free joint 'nozzle'"
    p.note("CB421", "tool_z", text, hint=f"nozzle = {growing:g} mm·(1/cos A - 1)")
    low, high = -a.offset_deg - _NOZZLE_TILT_DEG, -a.offset_deg + _NOZZLE_TILT_DEG
    axes = tuple(replace(axis, lower=low, upper=high) if axis.name == "A" else axis for axis in p.axes)
    law = NozzleLaw(m_from_mm(growing))
    axis_map = TiltLengthMap.of(law, a.offset_deg)
    return Recipe(tool=[*fork, linear("nozzle", "-z", drive={})], axes=axes, axis_map=axis_map)


def kin_28(p: Params, choose: Choices) -> Recipe:
    """Build the C/A head behind a coupling gear; the axis values are the head's angles or the drives'."""
    signs = direction_sign(p, "direction_c"), direction_sign(p, "direction_a")
    gear = _gear(p)
    before = min(signs) < 0 and choose["gear_flag_place"] == "before_gear"
    matters = gear.couples() or before
    drives = matters and choose["kin28_axis_values"] == "drives"
    behind = gear.drives(signs if before else (1.0, 1.0)) if matters and not drives else None
    if before:
        c, a = (Drive(1.0, -zero_deg(p, choose, key)) for key in ("offset_c", "offset_a"))
        return Recipe(tool=_fork(p, choose, *gear.joints(c, a, signs) if drives else _direct(c, a)), drives=behind)
    c, a = (
        zero_and_sign(choose, sign, zero_deg(p, choose, key), printed="outside")
        for sign, key in zip(signs, ("offset_c", "offset_a"), strict=True)
    )
    return Recipe(tool=_fork(p, choose, *gear.joints(c, a) if drives else _direct(c, a)), drives=behind)


def kin_7(p: Params, choose: Choices) -> Recipe:
    """Build the drilling head on C; A is set by hand."""
    c = driven("C", "z", Drive(1.0, -zero_deg(p, choose, "offset_c")))
    return Recipe(tool=_hand_set(p, choose, c))


def kin_17(p: Params, choose: Choices) -> Recipe:
    """Build the drilling head with both C and A set by hand."""
    return Recipe(tool=_hand_set(p, choose, turn(rot_z(p.deg("setting_c")))))


def _direct(c: Drive, a: Drive) -> tuple[Move, Move]:
    return driven("C", "z", c), driven("A", "x", a)


def _fork(p: Params, choose: Choices, c: Element, a: Element) -> list[Element]:
    """Return the head of 9, 25 and 28 with its joints C and A."""
    crank_x, crank_y, tool_y = p.mm("a_to_c_x"), p.mm("a_to_c_y"), p.mm("tool_y")
    pivot = asked_sign(choose, "c_pivot_sign", crank_x, crank_y)
    y = -towards_slide(choose, tool_y) * tool_y
    return [
        *slides(p, choose),
        c,
        shift(pivot * crank_x, pivot * crank_y, -p.mm("a_to_head_z")),
        a,
        *tool_end(p, y=y, z=-p.mm("tool_z")),
    ]


def _hand_set(p: Params, choose: Choices, c: Element) -> list[Element]:
    """Return the head of 7 and 17, whose A is set by hand."""
    x, y = p.mm("head_to_c_x"), p.mm("a_to_c_y")
    s = towards_slide(choose, x, y)
    outside = x != 0 and choose["kin7_hd6_place"] == "outside_c"
    return [
        *slides(p, choose),
        shift(x=s * x if outside else 0.0),
        c,
        shift(0.0 if outside else -s * x, -s * y, -p.mm("a_to_head_z")),
        turn(rot_x(p.deg("setting_a"))),
        *tool_end(p, z=-p.mm("tool_z")),
    ]


@dataclass(frozen=True, slots=True)
class _Gear:
    """The gear of KIN_TYP 28: drive A = ratio·head A + offset + coupling·head C, drive C = head C."""

    ratio: float
    coupling: float
    offset_deg: float

    def couples(self) -> bool:
        """Return whether drives and head angles differ."""
        return (self.ratio, self.coupling, self.offset_deg) != (1.0, 0.0, 0.0)

    def drives(self, signs: Sequence[float]) -> AffineDrives:
        """Return the drives of head angles X, Y, Z, C, A; before the gear, each has a sign."""
        sign_c, sign_a = signs
        A, b = np.eye(5), np.zeros(5)
        A[3, 3], A[4, 3:] = sign_c, (sign_a * self.coupling, sign_a * self.ratio)
        b[4] = sign_a * self.offset_deg
        return AffineDrives(A + 0.0, b + 0.0)

    def joints(self, c: Drive, a: Drive, drive_signs: Sequence[float] = (1.0, 1.0)) -> tuple[Move, Move]:
        """Return the joints C and A of drive values.

        Args:
            c: From the head's C to the joint angle.
            a: From the head's A to the joint angle.
            drive_signs: Signs of the drives C and A before the gear.
        """
        sign_c, sign_a = drive_signs
        per_drive = {"A": a.sign * sign_a / self.ratio, "C": -a.sign * self.coupling * sign_c / self.ratio}
        offset = a.offset_deg - a.sign * self.offset_deg / self.ratio
        return (
            rotary("C", "z", sign=c.sign * sign_c, offset_deg=c.offset_deg),
            rotary("A", "x", drive=per_drive, offset_deg=offset),
        )


def _gear(p: Params) -> _Gear:
    coupling = _fraction(p, "coupling_numerator", "coupling_denominator", 0.0)
    ratio = _fraction(p, "gear_a_numerator", "gear_a_denominator", 1.0)
    if ratio == 0:
        p.refuse(
            "gear_a_numerator", "the gear factor of A is 0: the drive would not move A", "a numerator other than 0"
        )
        ratio = 1.0
    return _Gear(ratio, coupling, p.deg("coupling_offset"))


def _fraction(p: Params, above: str, below: str, at_zero: float) -> float:
    """Return a gear factor; 0/0 counts as `at_zero`, with a finding."""
    numerator, denominator = p.number(above), p.number(below)
    if denominator:
        return numerator / denominator
    if numerator:
        p.refuse(below, "the denominator of a gear factor is 0", "a number other than 0")
    else:
        n, m = p.data.row(above).n, p.data.row(below).n
        p.note("CB420", above, f"the gear factor HD{n}/HD{m} is 0/0; it counts as {at_zero:g}")
    return at_zero


RECIPES: Final[Mapping[int, RecipeFunction]] = {7: kin_7, 9: kin_9, 17: kin_17, 25: kin_25, 28: kin_28}
