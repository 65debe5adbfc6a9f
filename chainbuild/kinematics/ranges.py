"""The range of an axis that its own limits and those of the drives leave.

Where a drive follows several axes, the range of each depends on the others: it is given for the middle of the others,
and the widest range beside it. Affine drives are solved for the axis, others by halving between a value inside and one
outside, to the last digit.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.drives import AffineDrives, DriveLimit, DriveMap
from chainbuild.chain.elements import Axis, Chain

Range = tuple[float, float]

_SCANNED: Final = 721  # places that are looked at: half a degree apart over a turn, finer than any gap of a head
_HALVINGS: Final = 60  # from half a degree to the last digit of a double
# A head's angle and the drive behind it differ by at most half a turn, beyond a constant [deg].
_HALF_TURN_DEG: Final = 180.0
_SAME: Final = 1e-9  # mm or degrees: rounding of counts


def with_ranges(chain: Chain) -> tuple[Chain, tuple[str, ...]]:
    """Return the chain with the ranges of its axes, and the names of axes that nothing is left for.

    Such an axis keeps its limits; it has a widest range if others than the middle of the others leave something.

    Args:
        chain: A chain whose axes have the limits of their own values.
    """
    limits = [one for one in chain.drive_limits if one.bounded]
    if chain.drives is None or not limits:
        return chain, ()
    ranges = _Ranges(chain.axes, chain.drives, limits)
    axes, lost = list(chain.axes), []
    for alone in (True, False):  # first what depends on no other axis: it decides where the middle of the others is
        before = tuple(axes)
        ranges = _Ranges(before, chain.drives, limits)
        for n, axis in enumerate(before):
            if axis.endless or not ranges.deciding(n) or ranges.is_alone(n) != alone:
                continue
            found, widest = ranges.at_middle(n), None if alone else ranges.widest(n)
            if found is None:
                lost.append(axis.name)
                axes[n] = replace(axis, widest=widest)
                continue
            given = any(one.axis == n for one in limits)
            axes[n] = replace(axis, lower=found[0], upper=found[1], assumed=axis.assumed and not given, widest=widest)
    return chain.with_axes(tuple(axes)), tuple(lost)


def range_beside(chain: Chain, n: int, at: Vector) -> Range | None:
    """Return the range of axis n while the others stand at axis values (n_axes,); None where nothing is left.

    Args:
        chain: A chain with the ranges of its axes.
        n: Index of the axis.
        at: Axis values, mm and degrees.
    """
    limits = [one for one in chain.drive_limits if one.bounded]
    if chain.axes[n].widest is None or chain.drives is None or not limits:
        return chain.axes[n].range
    axes = tuple(replace(axis, lower=axis.range[0], upper=axis.range[1]) for axis in chain.axes)
    return _Ranges(axes, chain.drives, limits, at).at_middle(n)


def within_reach(chain: Chain) -> tuple[Chain, tuple[int, ...]]:
    """Return the chain with limits no wider than the drives reach, and the indices of the axes that it narrows.

    An axis whose limits lie beyond the reach altogether is left as it is.
    """
    if chain.drives is None:
        return chain, ()
    axes, narrowed = list(chain.axes), []
    for n, (least, most) in chain.drives.reach.items():
        axis = axes[n]
        lower, upper = max(axis.lower, least), min(axis.upper, most)
        if axis.lower < least - _SAME or axis.upper > most + _SAME:
            narrowed.append(n)
        if lower < upper:
            axes[n] = replace(axis, lower=lower, upper=upper, endless=False)
    return chain.with_axes(tuple(axes)), tuple(narrowed)


class _Ranges:
    """The ranges of the axes of one chain.

    Args:
        axes: With the limits of their own values.
        drives: What the drives stand at.
        limits: Theirs.
        middle: Where the other axes stand; None: in their middle.
    """

    def __init__(
        self, axes: tuple[Axis, ...], drives: DriveMap, limits: list[DriveLimit], middle: Vector | None = None
    ) -> None:
        self.axes, self.drives, self.limits, self.follows = axes, drives, limits, drives.follows
        ends = [(0.0, 0.0) if axis.endless else (axis.lower, axis.upper) for axis in axes]
        self.middle: Vector = np.array(ends).mean(axis=1) if middle is None else middle

    def deciding(self, n: int) -> list[DriveLimit]:
        """Return the limits of drives that follow axis n."""
        return [one for one in self.limits if self.follows[one.axis, n]]

    def is_alone(self, n: int) -> bool:
        """Return whether the drives that follow axis n follow no other."""
        return all(self.follows[one.axis].sum() == 1 for one in self.deciding(n))

    def own(self, n: int) -> Range:
        """Return the limits of an axis' own values; none where they are assumed and those of its drive are known."""
        axis = self.axes[n]
        free = Axis.unlimited(axis.name, axis.kind)
        assumed = axis.assumed and (axis.lower, axis.upper) == (free.lower, free.upper)
        if assumed and n in self.drives.turning and any(one.axis == n for one in self.limits):
            return -math.inf, math.inf
        return axis.lower, axis.upper

    def at_middle(self, n: int) -> Range | None:
        """Return the range of axis n with the others in their middle, or None where nothing is left."""
        if not isinstance(self.drives, AffineDrives):
            return self._scanned(n, self._scope(n), self.deciding(n))
        low, high = self.own(n)
        for one in self.deciding(n):
            factor = float(self.drives.A[one.axis, n])
            rest = float(self.drives.drives(self.middle)[one.axis]) - factor * float(self.middle[n])
            low, high = _both((low, high), _solved(one, factor, (rest, rest)))
        return (low, high) if low < high else None

    def widest(self, n: int) -> Range | None:
        """Return the range of axis n with the others wherever suits it best, or None where nothing is left."""
        if not isinstance(self.drives, AffineDrives):
            alone = [one for one in self.deciding(n) if self.follows[one.axis].sum() == 1]
            return self._scanned(n, self._scope(n), alone)
        own = low, high = self.own(n)
        for one in self.deciding(n):
            row = self.drives.A[one.axis].copy()
            factor, row[n] = float(row[n]), 0.0
            ends = np.array([(-math.inf, math.inf) if axis.endless else axis.range for axis in self.axes])
            parts = np.array([np.sort(k * pair) for k, pair in zip(row, ends, strict=True) if k]).reshape(-1, 2)
            rest = float(self.drives.b[one.axis]) + parts.sum(axis=0)
            low, high = _both((low, high), _solved(one, factor, (float(rest[0]), float(rest[1]))))
        if not low < high:
            return None
        if math.isfinite(own[0]):  # the drive is looked at by itself: what is named is the limit that is violated
            return own
        return (low, high) if math.isfinite(low) and math.isfinite(high) else (self.axes[n].lower, self.axes[n].upper)

    def _scope(self, n: int) -> Range:
        """Return where a value of axis n can lie at all."""
        low, high = self.own(n)
        if math.isfinite(low):
            return low, high
        one = next(limit for limit in self.limits if limit.axis == n)
        shift = float(self.drives.drives(self.middle)[n] - self.middle[n])
        return one.lower - shift - _HALF_TURN_DEG, one.upper - shift + _HALF_TURN_DEG

    def _scanned(self, n: int, scope: Range, limits: list[DriveLimit]) -> Range | None:
        """Return the stretch of axis n inside limits of drives that is nearest to the middle."""
        middle = (scope[0] + scope[1]) / 2.0
        places = np.unique([*np.linspace(*scope, _SCANNED), middle])
        inside = np.array([self._inside(n, float(place), limits) for place in places])
        if not inside.any():
            return None
        good = np.flatnonzero(inside)
        first = last = int(good[np.argmin(np.abs(places[good] - middle))])
        while first > 0 and inside[first - 1]:
            first -= 1
        while last < len(places) - 1 and inside[last + 1]:
            last += 1
        low, high = float(places[first]), float(places[last])
        low = low if first == 0 else self._edge(n, low, float(places[first - 1]), limits)
        high = high if last == len(places) - 1 else self._edge(n, high, float(places[last + 1]), limits)
        return (low, high) if low < high else None

    def _edge(self, n: int, inside: float, outside: float, limits: list[DriveLimit]) -> float:
        for _ in range(_HALVINGS):
            between = (inside + outside) / 2.0
            if self._inside(n, between, limits):
                inside = between
            else:
                outside = between
        return inside

    def _inside(self, n: int, value: float, limits: list[DriveLimit]) -> bool:
        at: Vector = self.middle.copy()
        at[n] = value
        drives = self.drives.drives(at)
        return all(one.lower <= drives[one.axis] <= one.upper for one in limits)


def _both(one: Range, other: Range) -> Range:
    return max(one[0], other[0]), min(one[1], other[1])


def _solved(limit: DriveLimit, factor: float, rest: Range) -> Range:
    """Return the values x with limit.lower ≤ factor·x + r ≤ limit.upper for some r of a range."""
    ends = (limit.lower - rest[1]) / factor, (limit.upper - rest[0]) / factor
    return (ends[0] + 0.0, ends[1] + 0.0) if factor > 0.0 else (ends[1] + 0.0, ends[0] + 0.0)
