"""Nonlinear axis map of tools that grow with the tilt of their head: the nozzle of 25, the minimum distance of 98.

The last joint carries what is added to the length at no tilt; a law says how much that is: q = (X, Y, Z, C, A, law(a)),
a the angle by which A leans the tool: the axis value and a zero offset.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, Protocol

import numpy as np

from chainbuild import tolerances
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AffineMap, Formulas
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.files import number_text
from chainbuild.formats.twincat.maps.heads import FIVE_AXES, nonzero, straight_map
from chainbuild.units import m_from_mm, rad_from_deg

_A: Final = 4  # index in X, Y, Z, C, A


class TiltLaw(Protocol):
    """How a tool grows with its tilt [rad]."""

    def extension(self, angle: float) -> float:
        """Return what is added to the length at angle 0 [m]; not a number where the angle is not permitted."""
        ...

    def slope(self, angle: float) -> float:
        """Return the derivative [m/rad], finite everywhere."""
        ...

    def bounds(self, low: float, high: float) -> tuple[float, float]:
        """Return bounds of the extension [m] over a range of angles."""
        ...

    def refusal(self, angle: float) -> ChainbuildError | None:
        """Return the error of an angle that is not permitted, or None."""
        ...

    def formula(self, angle: str) -> str | None:
        """Return the extension [m] as an expression of an angle, or None where it has cases."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class TiltLengthMap:
    """Joints X, Y, Z, C, A are the axes; the last joint follows the tilt by a law.

    Attributes:
        straight: Axis values → X, Y, Z, C, A: the same in SI.
        law: Tilt → value of the last joint.
        offset: Added to A, it gives the tilt [rad].
        axis: Name of the tilting axis.
    """

    straight: AffineMap
    law: TiltLaw
    offset: float
    axis: str = "A"

    @classmethod
    def of(cls, law: TiltLaw, offset_deg: float = 0.0) -> TiltLengthMap:
        """Build the map of a law and the angle that makes a tilt of A."""
        return cls(straight_map(FIVE_AXES, (0.0,) * 5), law, rad_from_deg(offset_deg))

    def _tilt(self, axes: Vector) -> float:
        return float(self.straight.q(axes)[_A]) + self.offset

    @property
    def periodic(self) -> tuple[int, ...]:
        """Indices of the axes whose whole turn leads to the same pose: C, A."""
        return (3, _A)

    def named(self, names: Sequence[str]) -> TiltLengthMap:
        """Return the map that names the tilting axis by another name."""
        return replace(self, axis=names[_A])

    def q(self, axes: Vector) -> Vector:
        """Return the joint values (6,) of axis values (5,); the last not a number where the law permits no tilt."""
        return np.append(self.straight.q(axes), self.law.extension(self._tilt(axes)))

    def formulas(self, symbols: Sequence[str]) -> Formulas | None:
        """Return the map written down; None where its law is no formula."""
        law = self.law.formula("tilt")
        rows = self.straight.sums(symbols)
        return None if law is None else Formulas((("tilt", f"{rows[_A]} + {number_text(self.offset)}"),), (*rows, law))

    def axes(self, q: Vector) -> Vector:
        """Return the axis values of joint values; the last one's follows from them."""
        return self.straight.axes(q[:-1])

    def dq_daxes(self, axes: Vector) -> Matrix:
        """Return the derivative (6, 5)."""
        last = np.zeros((1, 5))
        last[0, _A] = self.law.slope(self._tilt(axes))
        return np.vstack((self.straight.A, last))

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return the error of a tilt that the law does not permit, or None."""
        error = self.law.refusal(self._tilt(axes))
        if error is not None and error.parameter is None:
            error.parameter = self.axis
        return error

    def q_bounds(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector]:
        """Return the joint bounds."""
        low, high = self.straight.q_bounds(lower, upper)
        shortest, longest = self.law.bounds(float(low[_A]) + self.offset, float(high[_A]) + self.offset)
        return np.append(low, shortest), np.append(high, longest)


@dataclass(frozen=True, slots=True)
class NozzleLaw:
    """KIN_TYP 25: the tip keeps its height: length·(1/cos a - 1).

    Attributes:
        length: Length at a = 0 [m].
    """

    length: float

    def extension(self, angle: float) -> float:
        """Return what is added to the length [m]; not a number where the nozzle is horizontal."""
        cosine = math.cos(angle)
        if abs(cosine) < tolerances.ZERO_VECTOR:
            return math.nan
        return self.length * (1.0 / cosine - 1.0)

    def slope(self, angle: float) -> float:
        """Return the derivative [m/rad]."""
        return self.length * math.sin(angle) / nonzero(math.cos(angle)) ** 2

    def bounds(self, low: float, high: float) -> tuple[float, float]:
        """Return bounds [m]; where the tilt may pass 90 degrees, those assumed for a slide."""
        tilt = max(abs(low), abs(high))
        if math.cos(min(tilt, math.pi)) <= tolerances.GIMBAL_LOCK:
            bound = m_from_mm(tolerances.ASSUMED_LINEAR_LIMIT_MM)
            return -bound, bound
        ends = (0.0, self.extension(tilt))
        return min(ends), max(ends)

    def refusal(self, angle: float) -> ChainbuildError | None:
        """Return the error of a horizontal nozzle, whose length would be infinite, or None."""
        if math.isfinite(self.extension(angle)):
            return None
        return AxisValueError(
            "the nozzle is horizontal: no length would keep its height",
            permitted="less than 90 deg off 0",
        )

    def formula(self, angle: str) -> str:
        """Return the extension [m] as an expression of an angle."""
        return f"{number_text(self.length)}*(1/cos({angle}) - 1)"
