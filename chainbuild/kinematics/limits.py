"""Inside the limits or not: the one answer, for axes and for sums of axes.

Axis values are rounded, sums of them more so. A value counts as inside up to `tolerances.LIMIT_SLACK` beyond its
limit, in mm and degrees, and in metres and radians by the same amount turned into SI; solvers return such a value
as its limit. Software limits belong to the drives: a kinematic whose drive values differ from its axis values
would be checked here by them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.elements import Axis, Chain
from chainbuild.chain.sums import AxisConstraint
from chainbuild.shown import two_lines
from chainbuild.tolerances import LIMIT_SLACK


@dataclass(frozen=True, slots=True, eq=False)
class Limits:
    """The limits of a chain, in mm and degrees.

    Attributes:
        axes: The axes.
        lower: (n_axes,) lower limits, -inf where an axis is endless.
        upper: (n_axes,) upper limits, +inf where it is.
        sums: Limits on sums of axes.
    """

    axes: tuple[Axis, ...]
    lower: Vector
    upper: Vector
    sums: tuple[AxisConstraint, ...]

    def __repr__(self) -> str:
        axes = (f"{axis.name} {axis.lower:.6g} … {axis.upper:.6g} {axis.unit}" for axis in self.axes)
        sums = (f"{limit.name} {limit.lower:.6g} … {limit.upper:.6g}" for limit in self.sums)
        return two_lines(f"<Limits: {', '.join((*axes, *sums))}>")

    @classmethod
    def of(cls, chain: Chain) -> Limits:
        """Return the limits of a chain."""
        lower = np.array([-math.inf if axis.endless else axis.lower for axis in chain.axes])
        upper = np.array([math.inf if axis.endless else axis.upper for axis in chain.axes])
        return cls(chain.axes, lower, upper, chain.constraints)

    def outside(self, values: Vector) -> list[int]:
        """Return the indices of the axes that values (n_axes,) put beyond their limits; not a number is outside."""
        # Plain floats: for a handful of axes quicker than arrays.
        rows = enumerate(zip(values.tolist(), self.lower.tolist(), self.upper.tolist(), strict=True))
        return [n for n, (value, low, high) in rows if not low - LIMIT_SLACK <= value <= high + LIMIT_SLACK]

    def broken_sums(self, values: Vector) -> tuple[AxisConstraint, ...]:
        """Return the limits on sums of axes that values (n_axes,) violate."""
        return tuple(limit for limit in self.sums if limit.margin(values) < -LIMIT_SLACK)

    def violated(self, values: Vector) -> tuple[str, ...]:
        """Return the names of the axes beyond their limits, then of the limits on sums that are violated."""
        axes = (self.axes[n].name for n in self.outside(values))
        return (*axes, *(limit.name for limit in self.broken_sums(values)))

    def onto(self, values: Vector) -> Vector:
        """Return values (n_axes,) with every axis beyond its limit moved onto it."""
        return np.minimum(np.maximum(values, self.lower), self.upper)

    def in_words(self, n: int, value: float) -> str:
        """Return what is wrong with a value of axis n, such as "A3 is 170.2, outside -120 … 156 deg"."""
        axis = self.axes[n]
        return f"{axis.name} is {value:.6g}, outside {axis.lower:g} … {axis.upper:g} {axis.unit}"

    def words(self, values: Vector) -> str:
        """Return what is wrong with values (n_axes,): every axis beyond its limits, then the sums; empty: nothing."""
        axes = [self.in_words(n, float(values[n])) for n in self.outside(values)]
        sums = [f"outside the limits of {limit.label}" for limit in self.broken_sums(values)]
        return "; ".join([*axes, *sums])

    def inside_rows(self, rows: Matrix) -> NDArray[np.bool_]:
        """Return (N,) whether rows (N, n_axes) are inside all limits; not a number is outside."""
        inside = ((rows >= self.lower - LIMIT_SLACK) & (rows <= self.upper + LIMIT_SLACK)).all(axis=1)
        for limit in self.sums:
            total = rows @ np.array(limit.sum.coefficients) + limit.sum.offset
            inside = inside & (total >= limit.lower - LIMIT_SLACK) & (total <= limit.upper + LIMIT_SLACK)
        return np.asarray(inside)
