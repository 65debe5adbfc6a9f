"""A free axis placed where all limits hold.

An axis that a pose does not determine keeps its start value. Where another axis is then beyond a limit, as X and Y of a
table under a vertical tool, the solution is followed while the free axis turns: the margins to all limits are sampled,
and where one of them passes through zero a stretch inside the limits may begin. The place nearest to the start counts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.ik.branches.core.axis_values import axes_for_each
from chainbuild.ik.branches.core.branches import Candidate, collect, verified
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.core.serial import ArmSolver

# SI axis values that may be solutions of a query, with the indices of their free axes.
SolutionsOf = Callable[[BranchQuery], Iterator[tuple[Vector, list[int]]]]

_STEP: Final = math.radians(10.0)  # margins are nearly sinusoids of it: the parabola of three is good to 4e-5
_SLIDE_STEPS: Final = 72  # places along a free linear axis, as many as two turns have
_NEAR_ZERO: Final = 1e-3  # m or rad: a margin whose parabola ends farther below zero does not touch it
_ROOT_STEPS: Final = 60  # far more than the ten that a smooth margin needs
_AT_ZERO: Final = 1e-11  # m or rad: a margin so small is inside, within the slack
_THIRD: Final = 0.382  # golden section
_PEAK_STEPS: Final = 45  # golden sections that bring 20 degrees to 1e-10 rad: the square of it is below rounding


def solutions_of(solver: ArmSolver) -> SolutionsOf:
    """Return what yields SI axis values that may be solutions, with their free axes."""

    def solve(query: BranchQuery) -> Iterator[tuple[Vector, list[int]]]:
        joints = np.array([screw.joint for screw in query.serial().screws], dtype=np.intp)
        keep = query.q0[joints].tolist()
        free_axes = query.structure.free
        found = solver(query.target.homogeneous, keep)
        every = axes_for_each(query, joints, [values for values, _ in found], free_axes)
        for (_, free), places in zip(found, every, strict=True):
            for x in places:
                yield x, query.undetermined_axes(joints, free, free_axes)

    return solve


def placed_branches(query: BranchQuery, solve: SolutionsOf) -> Iterator[tuple[Vector, Vector]]:
    """Yield the branches with free axes, mm and degrees: these at the start, and where all limits hold."""
    for (x, free), placed in zip(solve(query), with_free_axes_inside(query, solve), strict=True):
        found = collect(query, [placed] if free else []).branches
        if len(found):
            yield query.shown(x), found[0].axes


def with_free_axes_inside(query: BranchQuery, solve: SolutionsOf) -> Iterator[Candidate]:
    """Yield the solutions of a query, those with free axes where all limits hold if there is such a place.

    Args:
        query: The query.
        solve: Its solver; of a query with another start it keeps free axes at that one.
    """
    moved: list[Vector] = []
    for x, free in solve(query):
        inside = None
        if free and not any(np.array_equal(x, other) for other in moved) and _is_outside(query, x):
            moved.append(x)
            places = (_nearest_inside(_Motion(query, solve, n), x) for n in free)
            inside = next((place for place in places if place is not None), None)
        yield x if inside is None else inside, query.axis_names(free)


def _is_outside(query: BranchQuery, x: Vector) -> bool:
    row = verified(query, x)
    return row is not None and bool(query.mechanism.limits.violated(row.axes))


class _Place(NamedTuple):
    """A solution with the free axis at a value.

    Attributes:
        value: Of the free axis, in SI.
        x: (n_axes,) the solution, in SI; where there is none, the one it was looked for beside.
        margins: How far inside each limit it is, the lower and the upper one of each axis, sum and drive, negative
            outside; -inf where there is no solution.
    """

    value: float
    x: Vector
    margins: Vector


class _Motion:
    """The solutions of one pose while a free axis moves.

    Args:
        query: The query.
        solve: Its solver.
        n: Index of the free axis.
    """

    def __init__(self, query: BranchQuery, solve: SolutionsOf, n: int) -> None:
        self.query, self.n, self._solve = query, n, solve
        self.start = float(query.x0[n])

    def place(self, value: float, near: Vector) -> _Place:
        """Return the solution with the free axis at a value, of several the one nearest to another."""
        x0 = self.query.x0.copy()
        x0[self.n] = value
        found = [x for x, free in self._solve(replace(self.query, x0=x0)) if self.n in free]
        if not found:
            limits = self.query.mechanism.limits
            return _Place(value, near, np.full(2 * (len(near) + len(limits.sums) + len(limits.drives)), -math.inf))
        x = min(found, key=lambda x: self._distance(x, near))
        return _Place(value, x, self._margins(x))

    def _distance(self, x: Vector, near: Vector) -> float:
        motion, turns = x - near, self.query.periodic
        motion[turns] = np.remainder(motion[turns] + math.pi, math.tau) - math.pi
        return float(np.linalg.norm(motion))

    def _margins(self, x: Vector) -> Vector:
        shown, limits = self.query.shown(x), self.query.mechanism.limits
        margins = [margin for n, value in enumerate(x.tolist()) for margin in self._ends(n, value)]
        for limit in limits.sums:
            total = limit.sum.value(shown)
            margins += [total - limit.lower, limit.upper - total]
        if limits.drive_map is not None:
            drives = limits.drive_map.drives(shown).tolist()
            for one in limits.drives:
                margins += [drives[one.axis] - one.lower, one.upper - drives[one.axis]]
        return np.array([-math.inf if math.isnan(margin) else margin for margin in margins])

    def _ends(self, n: int, value: float) -> tuple[float, float]:
        """Return how far inside each of its limits an axis is, at the best of its whole turns.

        The nearer one of both would have a kink between them, and samples may stand on either side of a narrow range.
        """
        low, high = float(self.query.lower[n]), float(self.query.upper[n])
        if self.query.periodic[n] and math.isfinite(high - low):
            middle = 0.5 * (low + high)
            value = middle + math.remainder(value - middle, math.tau)
        return value - low, high - value

    def samples(self, x: Vector) -> list[_Place]:
        """Return places within the limits of the free axis and two turns about its start, ascending.

        Args:
            x: (n_axes,) the solution at the start, which is followed to both sides.
        """
        values = self._values()
        first = int(np.searchsorted(values, self.start))
        found: list[_Place] = []
        near = x
        for value in values[first:].tolist():
            found.append(self.place(value, near))
            near = found[-1].x
        near = x
        for value in values[:first][::-1].tolist():
            found.insert(0, self.place(value, near))
            near = found[0].x
        return found

    def _values(self) -> Vector:
        low, high = float(self.query.lower[self.n]), float(self.query.upper[self.n])
        count = _SLIDE_STEPS
        if self.query.mechanism.axes[self.n].kind == "rotary":
            within = low <= self.start - math.pi and self.start + math.pi <= high
            around = math.pi if within and self.query.periodic[self.n] else math.tau
            low, high = max(low, self.start - around), min(high, self.start + around)
            count = math.ceil((high - low) / _STEP) + 1
        if not math.isfinite(high - low) or low > high:
            return np.empty(0)
        places = (*np.linspace(low, high, count), min(max(self.start, low), high))
        return np.array(sorted(set(places)))


def _nearest_inside(motion: _Motion, x: Vector) -> Vector | None:
    """Return the solution inside all limits whose free axis is nearest to the start, or None."""
    query = motion.query
    samples = motion.samples(x)
    if len(samples) > 2:
        samples = sorted([*samples, *_peaks(motion, samples)], key=lambda place: place.value)
    for _, column, k in sorted(_ends(motion, samples)):
        end = samples[k] if column < 0 else _root(motion, column, samples[k], samples[k + 1])
        row = verified(query, end.x)
        if row is None or query.mechanism.limits.violated(row.axes):
            continue
        if query.keeps is None or query.keeps(row.axes):
            return end.x
    return None


def _ends(motion: _Motion, samples: list[_Place]) -> Iterator[tuple[float, int, int]]:
    """Yield where stretches inside all limits may begin: distance to the start, limit (-1: a sample itself), sample."""
    if not samples:
        return
    margins = np.array([place.margins for place in samples])
    values, slack = [place.value for place in samples], float(motion.query.slack.min())
    for k in np.flatnonzero((margins >= -slack).all(axis=1)).tolist():
        yield abs(values[k] - motion.start), -1, k
    inside = margins >= 0.0
    # A limit that is violated at both ends is violated between them, or its peak would be a sample.
    possible = (np.maximum(margins[1:], margins[:-1]) >= -slack).all(axis=1)
    for k, column in np.argwhere((inside[1:] != inside[:-1]) & possible[:, None]).tolist():
        before, after = float(margins[k, column]), float(margins[k + 1, column])
        share = before / (before - after) if math.isfinite(before - after) else 0.5
        yield abs(values[k] + share * (values[k + 1] - values[k]) - motion.start), column, k


def _peaks(motion: _Motion, samples: list[_Place]) -> Iterator[_Place]:
    """Yield the places where a margin that is negative at the samples comes up to zero between them."""
    margins = np.array([place.margins for place in samples])
    left, middle, right = margins[:-2], margins[1:-1], margins[2:]
    with np.errstate(invalid="ignore", divide="ignore"):
        bend = left - 2.0 * middle + right
        top = middle - (right - left) ** 2 / (8.0 * bend)
    high = (middle < 0.0) & (middle >= left) & (middle >= right) & (bend < 0.0) & (top > -_NEAR_ZERO)
    for k, column in np.argwhere(high).tolist():
        yield _peak(motion, column, samples[k], samples[k + 2])


def _peak(motion: _Motion, column: int, first: _Place, last: _Place) -> _Place:
    """Return where a margin is largest between two places (golden section)."""
    low, high = first.value, last.value
    a = motion.place(low + _THIRD * (high - low), first.x)
    b = motion.place(high - _THIRD * (high - low), first.x)
    for _ in range(_PEAK_STEPS):
        if a.margins[column] >= b.margins[column]:
            high, b = b.value, a
            a = motion.place(low + _THIRD * (high - low), b.x)
        else:
            low, a = a.value, b
            b = motion.place(high - _THIRD * (high - low), a.x)
    return a if a.margins[column] >= b.margins[column] else b


def _root(motion: _Motion, column: int, low: _Place, high: _Place) -> _Place:
    """Return where a margin changes its sign between two places (regula falsi, Illinois), on the inner side."""
    below, above = float(low.margins[column]), float(high.margins[column])
    rising, moved = above >= 0.0, 0
    for _ in range(_ROOT_STEPS):
        value = 0.5 * (low.value + high.value)
        if math.isfinite(below - above):
            value = (low.value * above - high.value * below) / (above - below)
        if not low.value < value < high.value:
            break
        middle = motion.place(value, low.x)
        margin = float(middle.margins[column])
        if abs(margin) < _AT_ZERO:
            return middle
        if (margin >= 0.0) == rising:
            below = 0.5 * below if moved == 1 else below
            high, above, moved = middle, margin, 1
        else:
            above = 0.5 * above if moved == -1 else above
            low, below, moved = middle, margin, -1
    return high if rising else low
