"""Units: the only place where mm, degrees, 1e-4 mm, 1e-4 degrees and rpm become SI.

>>> m_from_mm(1444.0)
1.444
>>> mm_from_tenth_um(8300000)
830.0
>>> deg_from_raw(-900000)
-90.0
>>> round(rad_s_from_rpm(60.0), 12)
6.28318530718
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, Literal, get_args

from chainbuild.errors import ChainbuildError

AxisKind = Literal["linear", "rotary"]
AxisUnit = Literal["mm", "deg"]
Units = Literal["controller", "si"]  # of axis values: mm and degrees, or metres and radians

UNITS: Final[tuple[Units, ...]] = get_args(Units)

# By definition.
RAD_PER_DEG: Final = math.pi / 180.0
M_PER_MM: Final = 1e-3
_RAW_PER_UNIT: Final = 10_000.0  # TwinCAT lists count in 1e-4 mm and 1e-4 degrees


def m_from_mm(value: float) -> float:
    """Return metres for millimetres (divided, so that decimal input stays decimal)."""
    return value / 1000.0


def mm_from_m(value: float) -> float:
    """Return millimetres for metres."""
    return value * 1000.0


def rad_from_deg(value: float) -> float:
    """Return radians for degrees."""
    return value * RAD_PER_DEG


def deg_from_rad(value: float) -> float:
    """Return degrees for radians."""
    return value / RAD_PER_DEG


def mm_from_tenth_um(raw: float) -> float:
    """Return millimetres for the 1e-4 mm counts of a TwinCAT list."""
    return raw / _RAW_PER_UNIT


def deg_from_raw(raw: float) -> float:
    """Return degrees for the 1e-4 degree counts of a TwinCAT list."""
    return raw / _RAW_PER_UNIT


def raw_from_mm(value_mm: float) -> float:
    """Return 1e-4 mm counts for millimetres."""
    return value_mm * _RAW_PER_UNIT


def m_s_from_mm_min(value: float) -> float:
    """Return m/s for mm/min."""
    return value / 60_000.0


def rad_s_from_rpm(value: float) -> float:
    """Return rad/s for revolutions a minute."""
    return value * math.tau / 60.0


def rad_s2_from_rev_s2(value: float) -> float:
    """Return rad/s² for rev/s²."""
    return value * math.tau


def unit_of(kind: AxisKind) -> AxisUnit:
    """Return the unit a controller shows an axis in."""
    return "mm" if kind == "linear" else "deg"


def si_factor(kind: AxisKind) -> float:
    """Return the factor from an axis value (mm or degrees) to SI."""
    return M_PER_MM if kind == "linear" else RAD_PER_DEG


@dataclass(frozen=True, slots=True)
class AxisLabels:
    """What axis values are values of.

    Attributes:
        names: Axis names in channel order.
        kinds: "linear" or "rotary", one for each.
        units: "controller": mm and degrees; "si": metres and radians.
    """

    names: tuple[str, ...]
    kinds: tuple[AxisKind, ...]
    units: Units = "controller"

    def __repr__(self) -> str:
        shown = [f"{name} [{unit}]" for name, unit in zip(self.names, self.units_of_axes, strict=True)]
        return f"<AxisLabels {', '.join(shown if len(shown) < 10 else [*shown[:3], '…', shown[-1]])}>"

    @property
    def factors(self) -> tuple[float, ...]:
        """What mm and degrees are multiplied with to get these units, one for each axis."""
        return tuple(si_factor(kind) if self.units == "si" else 1.0 for kind in self.kinds)

    @property
    def units_of_axes(self) -> tuple[str, ...]:
        """The unit of each axis."""
        si = self.units == "si"
        return tuple(("m" if kind == "linear" else "rad") if si else unit_of(kind) for kind in self.kinds)

    def to(self, units: Units) -> AxisLabels:
        """Return the labels of the same axes in other units.

        Raises:
            ChainbuildError: there are no such units.
        """
        if not isinstance(units, str) or units not in UNITS:
            raise ChainbuildError(f"there are no units {units!r}", parameter="units", permitted=", ".join(UNITS))
        return self if units == self.units else AxisLabels(self.names, self.kinds, units)
