"""Plausibility of arms and heads: the lengths that a kinematic needs, by KIN_TYP, and the tilt of a head."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

from chainbuild.chain.check import ArmLength, check_length_magnitudes, check_reach_magnitude
from chainbuild.formats.twincat.lists.counts import TILT
from chainbuild.formats.twincat.recipes.recipe import Params
from chainbuild.frames import cos_sin_deg
from chainbuild.units import raw_from_mm

# What each arm is called, and the HDs that make its length between two parallel axes.
_ARMS: Final[Mapping[int, Mapping[str, tuple[str, ...]]]] = {
    36: {"the first arm": ("c1_to_c2_x",), "the second arm": ("c2_to_c3_x",)},
    45: {"the upper arm": ("b1_to_b2_z",), "the forearm": ("b2_to_b3_x", "b3_to_b2_z")},
    96: {"the first arm": ("g2_to_g3",), "the second arm": ("g3_to_head",)},
    213: {"the upper arm": ("g2_to_g3_z",), "the forearm": ("g3_to_g4_x", "g4_to_g3_z")},
}


def check_arm_magnitudes(p: Params) -> None:
    """Warn of arms without length, of very different length or of an unusual reach."""
    arms = []
    for what, names in _ARMS.get(p.data.number, {}).items():
        row = p.data.row(names[0])
        length_mm = math.hypot(*(p.mm(name) for name in names))
        arms.append(ArmLength(what, f"HD{row.n} {row.name}", length_mm, p.spans.get(row.n, p.span)))
    if arms:
        check_length_magnitudes(arms, p.collector)
        reach_mm = math.fsum(arm.length_mm for arm in arms)
        check_reach_magnitude(reach_mm, arms[0].span, "lengths count 1e-4 mm: are these in another unit?", p.collector)


_LEAST_TILT_DEG: Final = 1.0  # no head is built whose inner axis leans by less
_USUAL_DEG: Final = 45.0  # tilt of most of these heads
_MOST_DEG: Final = 180.0  # a larger count is no angle in degrees


def check_tilt(p: Params) -> None:
    """Warn of a head that can hardly tilt its tool: its inner axis lies along the outer one."""
    row = next((row for row in p.data.hd if row.name == TILT), None)
    if row is None or abs(cos_sin_deg(p.deg(TILT))[1]) >= cos_sin_deg(_LEAST_TILT_DEG)[1]:
        return
    if any(finding.code == "CB401" for finding in p.collector.findings):
        return  # refused already
    value = p.raw.get(row.n, row.default)
    text = f"with HD{row.n} = {p.deg(TILT):g} degrees the head can hardly tilt the tool"
    degrees = value if 0.0 < abs(value) <= _MOST_DEG else _USUAL_DEG
    meant = f"{degrees:g} degrees would be {raw_from_mm(degrees):.10g}"
    p.note("CB442", TILT, text, hint=f"counts are 1e-4 degrees: {meant}")
