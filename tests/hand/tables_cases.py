"""Generic machines for the hand formulas: which HD numbers each manual table lists, and a set of values for them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .kin_arms import FORMULAS as ARMS
from .kin_faces import FORMULAS as FACES
from .kin_tables import FORMULAS as TABLES
from .tables_algebra import RAW_UNIT, Formula, Matrix

FORMULAS: dict[int, Formula] = {**TABLES, **FACES, **ARMS}
TIGHT = 1e-9


def span(text: str) -> tuple[int, ...]:
    """Return the numbers of a text such as '1-3 7'."""
    numbers: list[int] = []
    for part in text.split():
        first, _, last = part.partition("-")
        numbers += range(int(first), int(last or first) + 1)
    return tuple(numbers)


@dataclass(frozen=True)
class Case:
    """HD numbers of one type as printed: lengths, angles, flags (with the value that reverses), and its axes.

    `rank` is the dimension of what the axes move: position and tool vector together.
    """

    axes: str  # l linear, r rotary
    lengths: str
    angles: str = ""
    reversing: tuple[tuple[int, float], ...] = ()
    fixed: tuple[tuple[int, float], ...] = ()
    rank: int = 5

    @property
    def flags(self) -> tuple[int, ...]:
        """Return the numbers of the direction flags."""
        return tuple(number for number, _ in self.reversing)

    def param(self, seed: int = 1) -> dict[int, float]:
        """Return raw values: lengths of 20 to 300 mm, angles of 3 to 40 deg, both signs, flags 0."""
        random = np.random.default_rng(seed)
        values: dict[int, float] = {}
        for numbers, low, high in ((self.lengths, 20, 300), (self.angles, 3, 40)):
            for number in span(numbers):
                sign = -1 if random.random() < 0.5 else 1
                values[number - 1] = round(sign * float(random.uniform(low, high)) / RAW_UNIT)
        values.update({number - 1: value for number, value in self.fixed})
        return values

    def position(self, seed: int = 1) -> list[float]:
        """Return axis values: 50 to 400 mm, 10 to 70 deg, both signs."""
        random = np.random.default_rng(seed + 100)
        ranges = [(50, 400) if axis == "l" else (10, 70) for axis in self.axes]
        return [float(random.choice([-1, 1]) * random.uniform(*limits)) for limits in ranges]


def _reversed_by(value: float, numbers: str) -> tuple[tuple[int, float], ...]:
    return tuple((number, value) for number in span(numbers))


_ARM_208 = "1-3 12 13-15 19-21 25-27 31-33"
_ARM_208_ANGLES = "4-6 10 11 16-18 22-24 28-30 34-36"

CASES: dict[int, Case] = {
    1: Case("lllrr", "1-9", "10 11", _reversed_by(1, "13 14")),
    13: Case("lrl", "1 4", "", _reversed_by(1, "5"), rank=3),
    14: Case("lrl", "1 4", "", _reversed_by(1, "5"), rank=3),
    23: Case("lllrr", "1 2", "", _reversed_by(-1, "4 5")),
    34: Case("lllr", "2 3", rank=3),  # C and two of the linear axes move the same three freedoms
    36: Case("rrlr", "1-5", "6 8", fixed=((7, 0),), rank=3),
    52: Case("lllrr", "1-3", "", _reversed_by(-1, "4 5")),
    57: Case("lllrr", "1-9 14-16", "10 11", _reversed_by(1, "12 13")),
    58: Case("lllrr", "1-9 14-16", "10 11", _reversed_by(1, "12 13")),
    61: Case("lllrr", "1-12 17-19", "13 14", _reversed_by(1, "15 16")),
    63: Case("lllrr", "1-12 17-19", "13 14", _reversed_by(1, "15 16")),
    64: Case("lllrrr", "1-15", "16-18", _reversed_by(1, "19-21")),
    80: Case("lllrr", "1-12", "13 14", _reversed_by(1, "15 16")),
    81: Case("lllrr", "1-12", "13 14", _reversed_by(1, "15 16")),
    82: Case("lllrrr", "1-15", "16 17", _reversed_by(1, "18 19")),
    85: Case("lr", "1 2", "3", rank=2),
    96: Case("rrrr", "1-10", rank=3),
    202: Case("lrlr", "1-4 6-8", "5 9", fixed=((10, 0),), rank=4),
    203: Case("rrl", "1-4 6-8 10", "5 9", rank=3),
    205: Case("lrl", "1 2 4-11", "3 12", _reversed_by(-1, "13-15"), ((16, 1), (17, 0)), rank=3),
    206: Case("lrrrrr", _ARM_208 + " 37-39", _ARM_208_ANGLES + " 40-43"),
    208: Case("lrrrr", _ARM_208, _ARM_208_ANGLES),
    213: Case("rrrrr", "1-3 7-12 48", "6 14 15 36-38", _reversed_by(1, "21-25")),
}


def pose(kin: int, hd: dict[int, float], axes: list[float], length: float = 0.0, **conv: str) -> Matrix:
    """Return a pose from HD values in mm and degrees, or unscaled where the case lists a flag."""
    case = CASES[kin]
    unscaled = {*case.flags, *(number for number, _ in case.fixed)}
    raw = {number - 1: value if number in unscaled else value / RAW_UNIT for number, value in hd.items()}
    return FORMULAS[kin](raw, axes, length, conv)


def same(left: Matrix, right: Matrix) -> bool:
    """Tell whether two poses are equal."""
    return bool(np.allclose(left, right, rtol=0, atol=TIGHT))
