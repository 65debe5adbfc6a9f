"""Weighted sums of axis values, and limits on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.shown import fields_shown


@dataclass(frozen=True, slots=True)
class AxisSum:
    """A weighted sum of axis values, such as the absolute angle C of a SCARA: Σ coefficient·axis + offset.

    Attributes:
        coefficients: One for each axis of the chain, in its order; axes in mm or degrees.
        offset: mm or degrees, added to the sum.
    """

    __repr__ = fields_shown

    coefficients: tuple[float, ...]
    offset: float

    def value(self, axes: ArrayLike) -> float:
        """Return the sum for axis values (n_axes,) in mm and degrees."""
        return float(np.dot(self.coefficients, np.asarray(axes, dtype=float))) + self.offset


@dataclass(frozen=True, slots=True)
class AxisConstraint:
    """A limit on a sum of axes, such as the angle of a parallelogram: lower < Σ coefficient·axis + offset < upper.

    Attributes:
        name: What is limited.
        sum: The limited value in degrees (mm where the axes are linear).
        lower: Lower limit.
        upper: Upper limit.
        alarm: Alarm the controller raises outside, where it is known.
    """

    __repr__ = fields_shown

    name: str
    sum: AxisSum
    lower: float
    upper: float
    alarm: int | None = None

    @property
    def label(self) -> str:
        """Name, and the alarm where it is known."""
        return self.name if self.alarm is None else f"{self.name} (alarm {self.alarm})"

    def margin(self, axes: ArrayLike) -> float:
        """Return the distance to the nearer limit, negative outside, for axis values (n_axes,)."""
        value = self.sum.value(axes)
        return min(value - self.lower, self.upper - value)

    def allows(self, before: ArrayLike, after: ArrayLike) -> bool:
        """Tell whether a motion is permitted: it ends inside, or starts outside and retracts towards the inside.

        Args:
            before: Axis values (n_axes,) where the motion starts.
            after: Where it ends.
        """
        margin = self.margin(after)
        return margin >= 0.0 or margin > self.margin(before)
