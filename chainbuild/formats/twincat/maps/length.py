"""Nonlinear axis map of tools that grow with the tilt of their head: the nozzle of 25, the minimum distance of 98.

The last joint carries what is added to the length at no tilt; a law says how much that is: q = (X, Y, Z, C, A, law(a)),
a the angle of joint A.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from chainbuild import tolerances
from chainbuild.chain.axismap import AffineMap, Matrix, Vector
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.formats.twincat.maps.heads import FIVE_AXES, nonzero, straight_map
from chainbuild.units import m_from_mm

_A = 4  # index in X, Y, Z, C, A


class TiltLaw(Protocol):
    """How a tool grows with the angle of its swivel axis [rad]."""

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


@dataclass(frozen=True, slots=True, eq=False)
class TiltLengthMap:
    """Joints X, Y, Z, C, A straight; the last joint follows the angle of A by a law.

    Attributes:
        straight: Axis values → X, Y, Z, C, A.
        law: Angle of A → value of the last joint.
    """

    straight: AffineMap
    law: TiltLaw

    @classmethod
    def of(cls, law: TiltLaw, offsets_deg: Sequence[float] = (0.0,) * 5) -> TiltLengthMap:
        """Build the map of a law and the angles added to the axis values X, Y, Z, C, A."""
        return cls(straight_map(FIVE_AXES, offsets_deg), law)

    @property
    def periodic(self) -> tuple[str, ...]:
        """Axes whose whole turn leads to the same pose."""
        return ("C", "A")

    def q(self, axes: Vector) -> Vector:
        """Return the joint values (6,) of axis values (5,); the last not a number where the law permits no tilt."""
        q = self.straight.q(axes)
        return np.append(q, self.law.extension(float(q[_A])))

    def axes(self, q: Vector) -> Vector:
        """Return the axis values of joint values; the last one's follows from them."""
        return self.straight.axes(q[:-1])

    def dq_daxes(self, axes: Vector) -> Matrix:
        """Return the derivative (6, 5)."""
        last = np.zeros((1, 5))
        last[0, _A] = self.law.slope(float(self.straight.q(axes)[_A]))
        return np.vstack((self.straight.A, last))

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return the error of a tilt that the law does not permit, or None."""
        return self.law.refusal(float(self.straight.q(axes)[_A]))

    def q_bounds(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector]:
        """Return the joint bounds."""
        low, high = self.straight.q_bounds(lower, upper)
        shortest, longest = self.law.bounds(float(low[_A]), float(high[_A]))
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
            parameter="A",
            permitted="less than 90 deg off 0",
        )
