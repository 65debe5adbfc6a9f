"""Plausibility of the arms of a kinematic: the lengths that it needs, by KIN_TYP."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

from chainbuild.chain.check import ArmLength, check_length_magnitudes, check_reach_magnitude
from chainbuild.formats.twincat.recipes.recipe import Params

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
