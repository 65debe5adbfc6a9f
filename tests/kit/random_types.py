"""Random machines of every KIN_TYP that has a hand formula, as raw parameters, axis values and channel lists."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

import chainbuild
from tests.hand.kin_heads import FORMULAS as HEADS
from tests.hand.tables_cases import FORMULAS as TABLES

FORMULAS = {**HEADS, **TABLES}

# Where a type's formula is defined only for some axis values or parameters; everything else is drawn freely.
AXIS_RANGE: dict[int, dict[str, tuple[float, float]]] = {
    12: dict.fromkeys(("Z1", "Z2", "Z3"), (-150.0, 150.0)),
    19: dict.fromkeys(("Z1", "Z2", "Z3"), (-60.0, 60.0)),
    21: {"X1": (-900.0, -450.0), "X2": (450.0, 850.0)},
    25: {"A": (-75.0, 75.0)},
    37: dict.fromkeys(("J1", "J2", "J3"), (-20.0, 70.0)),
    59: {"A": (-35.0, 35.0)},
    60: {"B": (-35.0, 35.0)},
    70: {"B": (-40.0, 40.0), "A": (-40.0, 40.0), "CV": (-90.0, 90.0)},
    209: dict.fromkeys(("Z1", "Z2", "Z3"), (-150.0, 150.0)),
}
# Struts that meet at every axis value in the ranges above: radii, rods, and where the columns of a tripod stand.
TRIPOD: dict[int, Sequence[float]] = {
    5: (400e4, 550e4), 6: (60e4, 120e4), 7: (800e4, 950e4), 8: (0, 1), 9: (105e4, 130e4), 10: (110e4, 125e4),
}  # fmt: skip
FIXED_HD: dict[int, dict[int, Sequence[float]]] = {
    12: TRIPOD,
    19: {2: (480e4, 550e4), 3: (140e4, 160e4), 4: (280e4, 330e4)},
    21: {2: (900e4, 950e4), 3: (900e4, 950e4), 4: (1200e4, 1500e4), 5: (-90e4, 120e4), 6: (-15e4, 10e4), 12: (1, 2)},
    5: {5: (0.0, 88.0e4, 92e4, -90e4, 180e4)},
    11: {3: (30e4, 45e4)},
    28: {16: (2,), 17: (5,), 12: (3,), 13: (7,)},
    33: {3: (40e4, 55e4)},
    37: {4: (40e4, 60e4), 5: (140e4, 200e4), 6: (500e4, 600e4), 7: (150e4, 220e4), 8: (-10e4, 12e4), 9: (-8e4, 11e4),
         10: (-9e4, 10e4), 11: (0,), 12: (0,)},
    59: {7: (30e4, 50e4), 19: (0,), 20: (0,), 21: (0, 1)},
    60: {7: (30e4, 50e4), 21: (0, 1)},
    207: {4: (60e4, 90e4, 110e4)},
    209: TRIPOD,
    # HD16/HD17: 1,0 turns about Z, 0,1 about X; 0,0 is the deprecated default.
}  # fmt: skip
# What has no default and must be chosen.
CHOSEN: dict[int, dict[str, str]] = {19: {"kin19_guide": "radial_planes"}}


def random_machine(kin: int, rng: np.random.Generator) -> dict[int, float]:
    """Draw raw parameters of a type, all non-zero where they are numbers."""
    data = chainbuild.catalogue()[kin]
    param: dict[int, float] = {}
    for row in data.hd:
        if row.n in FIXED_HD.get(kin, {}):
            value = float(rng.choice(FIXED_HD[kin][row.n]))
        elif row.kind == "length":
            value = float(rng.choice([-1, 1]) * rng.integers(100_000, 4_000_000))
        elif row.kind == "angle":
            value = float(rng.choice([-1, 1]) * rng.integers(10_000, 1_500_000))
        elif row.permitted:
            value = float(rng.choice(row.permitted))
        else:
            value = float(rng.integers(0, 2))
        param[row.n - 1] = value
    if kin == 205:
        param[15], param[16] = [(1.0, 0.0), (0.0, 1.0)][rng.integers(2)]
    if kin == 45:
        param[32] = 0.0 if rng.random() < 0.7 else 1.0
    return param


def random_axes(kin: int, rng: np.random.Generator) -> list[float]:
    """Draw axis values at which the type's formula is defined."""
    values = []
    for axis in chainbuild.catalogue()[kin].axes:
        lower, upper = (-900.0, 900.0) if axis.kind == "linear" else (-175.0, 175.0)
        lower, upper = AXIS_RANGE.get(kin, {}).get(axis.name, (lower, upper))
        values.append(float(rng.uniform(lower, upper)))
    return values


def channel_list(kin: int, param: dict[int, float]) -> str:
    """Return the list of a channel with this one type: index of the parameter → count."""
    lines = [f"trafo[0].id {kin}"]
    lines += [f"trafo[0].param[{index}] {value:.0f}" for index, value in param.items()]
    return "\n".join([*lines, "Ende", ""])
