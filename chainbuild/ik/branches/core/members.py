"""Members of a family that are inside all limits, where the solutions that were found of it are outside."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.ik.branches.core.axis_values import turned_axes
from chainbuild.ik.branches.core.beside import Beside
from chainbuild.ik.branches.core.query import BranchQuery

_MOST: Final = 16  # solutions whose families are looked at, nearest first
_FINEST: Final = 5e-4  # rad or m: a piece of a curve inside the limits that is shorter may be passed over
_ASIDE: Final = 0.1  # share of a step by which a curve may leave its chord


def members_inside(query: BranchQuery, outside: Sequence[Vector]) -> Iterator[Vector]:
    """Yield a member (n_axes,) [SI] inside all limits of each curve of solutions that has one, once or more often.

    Args:
        query: The query.
        outside: (n_axes,) each, solutions outside the limits, nearest first; isolated ones yield nothing.
    """
    beside = Beside(query)
    for x in outside[:_MOST]:
        settled = beside.settled(x)
        for direction in beside.directions(settled):
            both = (_first_inside(beside, settled, sign * direction) for sign in (1.0, -1.0))
            found = [member for member in both if member is not None]
            if found:
                yield min(found, key=query.distance)


def _first_inside(beside: Beside, x: Vector, direction: Vector) -> Vector | None:
    """Return the first place inside all limits along a curve of solutions, or None."""
    for start, end, _ in beside.steps_along(x, direction):
        found = _inside(beside.query, end)
        found = _between(beside, start, end) if found is None else found
        if found is not None:
            return found
    return None


def _between(beside: Beside, start: Vector, end: Vector) -> Vector | None:
    """Return a place inside all limits between two of a curve that are outside, or None."""
    size = float(np.abs(end - start).max())
    if size < _FINEST or not _may_pass(beside.query, start, end, size):
        return None
    middle = beside.between(start, end)
    if middle is None:
        return None
    found = _inside(beside.query, middle)
    for one, other in ((start, middle), (middle, end)):
        found = _between(beside, one, other) if found is None else found
    return found


def _inside(query: BranchQuery, x: Vector) -> Vector | None:
    """Return x with its whole turns as near to the start as its limits permit, or None outside these."""
    for turned in turned_axes(query, x, query.structure.free):
        shown = query.shown(turned)
        if not query.mechanism.limits.violated(shown) and (query.keeps is None or query.keeps(shown)):
            return turned
    return None


def _may_pass(query: BranchQuery, start: Vector, end: Vector, size: float) -> bool:
    """Tell whether a step along a curve may have places inside all limits; the twin of `doubtful.curves._may_pass`."""
    first, last, aside = 0.0, 1.0, _ASIDE * size
    rows = zip(start.tolist(), end.tolist(), query.lower.tolist(), query.upper.tolist(), query.periodic, strict=True)
    for a, b, lower, upper, is_periodic in rows:
        low, high, turns = lower - aside, upper + aside, 0.0
        if is_periodic and math.isfinite(high - low):
            turns = math.tau * math.ceil((low - max(a, b)) / math.tau)
        if min(a, b) + turns > high or max(a, b) + turns < low:
            return False
        if abs(b - a) > aside:
            one, other = (low - turns - a) / (b - a), (high - turns - a) / (b - a)
            first, last = max(first, min(one, other)), min(last, max(one, other))
    return first <= last
