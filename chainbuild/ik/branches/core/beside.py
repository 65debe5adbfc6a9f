"""The solutions beside a solution: whether it is isolated, or on a curve or surface of solutions, and where that leads.

A singular Jacobian alone tells nothing: a stretched elbow is isolated, a stretched wrist is on a curve. So a step is
taken in the direction in which the Jacobian is singular, and corrected: on a curve the corrected place is as far from
the solution as the step, elsewhere it falls back to the solution.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.ik.branches.core.query import BranchQuery

_EXACT: Final = 1e-15  # m and rad: a solution that is settled; where branches meet this leaves 3e-8 of the axes
_SETTLING: Final = 60  # corrections, each of which leaves three fifths of what is left where branches meet
_MET: Final = 1e-11  # m and rad: a place that is corrected so far is a solution
_CORRECTIONS: Final = 24  # on a curve three are enough; elsewhere they bring a step back to a ten-thousandth of it
_LONGEST: Final = 0.3  # rad or m of one correction: a longer one leads to another solution
_NOTHING: Final = 1e-9  # share of a direction below which an axis stands still
_LOST: Final = (
    1e-6  # share of the largest singular value: the axes of a settled solution are off by 3e-8 where branches meet
)
_TRIED: Final = (
    1e-2  # rad or m: a step for which the residual of an isolated solution, its square, is far above rounding
)
_FAN: Final = 12  # directions tried where the Jacobian loses two ranks, fifteen degrees apart
_DRAWN: Final = 30  # the same for more ranks, drawn at random
_ALIKE: Final = 0.98  # cosine of directions that are one: twelve of a surface are all apart
_MOST_MOVED: Final = 0.999  # share of the largest motion that is as large but for rounding
_FIRST_STEP: Final = 0.05  # rad or m along a curve
_SHORTEST: Final = 1e-4  # a curve that needs shorter steps is left
_BENT: Final = 0.35  # rad that a curve turns in one step: where it turns more, another one may come close
_LARGEST: Final = 0.5  # rad: what lies between two places is seen from their chord
_FARTHEST: Final = 20.0  # m: of a straight line of slides alone
_MOST: Final = 300  # steps along a curve: twice as many as a turn of all axes takes
_MOST_WALKED: Final = 60  # steps over a surface: half a turn of six axes is 7.7 rad
_ROOM: Final = 0.5  # m or rad beyond a limit: no member of a family is so far out
_THERE: Final = 1e-5  # m and rad: as far apart as solutions that count as one


class Beside:
    """The solutions of a query around some of them, in SI axis values.

    Args:
        query: The query.
    """

    def __init__(self, query: BranchQuery) -> None:
        kinematics, mechanism = query.mechanism.kinematics, query.mechanism
        self.query, self.free = query, query.structure.free
        self.turns = query.periodic & (not query.windings)
        self.rotary = np.array([axis.kind == "rotary" for axis in mechanism.axes])[self.free]
        self._residual = kinematics.residual(query.target, mechanism.task)

    def off(self, x: Vector) -> float:
        """Return how far the pose at x is from the target [m and rad]; infinite where there is none."""
        error, _ = self._residual(x)
        largest = float(np.abs(error).max())
        return largest if math.isfinite(largest) else math.inf

    def missed(self, x: Vector) -> float:
        """Return by how much the pose at x misses the target: the distance [m] or the angle [rad], the larger one."""
        query = self.query
        return max(query.mechanism.kinematics.errors(x, query.target, query.mechanism.task))

    def way(self, x: Vector, y: Vector) -> Vector:
        """Return y - x (n_axes,), by whole turns as short as possible unless every winding counts."""
        motion: Vector = y - x
        motion[..., self.turns] = np.remainder(motion[..., self.turns] + math.pi, math.tau) - math.pi
        return motion

    def settled(self, x: Vector) -> Vector:
        """Return a solution as exact as rounding permits, also where branches meet; x where that leads away."""
        y, off = self._corrected(x, _SETTLING, _EXACT)
        return y if off < _MET and float(np.abs(y - x).max()) < _TRIED else x

    def directions(self, x: Vector) -> Matrix:
        """Return unit directions (m, n_axes) in which there are more solutions: none where a solution is isolated.

        One of a curve, two or more that span a surface; at a crossing of curves one of each.

        Args:
            x: (n_axes,) a settled solution.
        """
        null, sizes = self._null(x)
        if len(null) and len(sizes) > len(self.free) - len(null):
            null = self._continued(x, null)
        found = np.zeros((len(null), len(x)))
        found[:, self.free] = null
        if len(found):  # the first of the axes that move most goes forward
            sizes = np.abs(found)
            first = np.argmax(sizes > _MOST_MOVED * sizes.max(axis=1, keepdims=True), axis=1)
            found *= np.sign(found[np.arange(len(found)), first])[:, None]
        return found + 0.0

    def reached(self, x: Vector, directions: Matrix, others: Sequence[Vector]) -> set[int]:
        """Return which other solutions are on the curves or the surface through x, by following these.

        Args:
            x: (n_axes,) a settled solution.
            directions: What `directions` returns for it.
            others: (n_axes,) each.
        """
        if len(directions) > 1 and self._is_surface(x, directions):
            return self._walked(x, others)
        found: set[int] = set()
        for direction in directions:
            if len(found) < len(others) and not self._follow(x, direction, others, found):
                self._follow(x, -direction, others, found)
        return found

    def _is_surface(self, x: Vector, directions: Matrix) -> bool:
        """Return whether there are solutions between two directions, too: curves that cross have none there."""
        between = directions[:2, self.free].sum(axis=0)
        between *= _TRIED / float(np.linalg.norm(between))
        y, off = self._moved(x, between)
        return off < _MET and float((y - x)[self.free] @ between) > 0.9 * _TRIED**2

    def _walked(self, x: Vector, others: Sequence[Vector]) -> set[int]:
        """Return which solutions are on the surface of x, by walking to each from the nearest one known to be on it."""
        found: set[int] = set()
        left = list(range(len(others)))
        gaps = [float(np.linalg.norm(self.way(x, other))) for other in others]
        nearest = [x] * len(others)
        while left:
            n = min(left, key=gaps.__getitem__)
            left.remove(n)
            if not self._leads_to(nearest[n], others[n]):
                continue
            found.add(n)
            for m in left:
                gap = float(np.linalg.norm(self.way(others[n], others[m])))
                if gap < gaps[m]:
                    gaps[m], nearest[m] = gap, others[n]
        return found

    def _null(self, x: Vector) -> tuple[Matrix, Vector]:
        """Return directions (k, n_free) that do not move the tool, and the singular values of the Jacobian."""
        _, J = self._residual(x)
        _, sizes, rows = np.linalg.svd(J[:, self.free])
        return rows[int((sizes > _LOST * sizes[0]).sum()) :], sizes

    def _corrected(self, x: Vector, steps: int, met: float, *, on_curve: bool = False) -> tuple[Vector, float]:
        """Return x after damped Newton steps and how far the pose is off there.

        Damped by the error they lead to the solutions nearby, and leave alone what moves along these. Where a curve is
        certain, its square is enough, and quicker.
        """
        off = math.inf
        for _ in range(steps):
            error, J = self._residual(x)
            off = float(np.abs(error).max())
            if not off >= met:
                break
            J = J[:, self.free]
            H = J.T @ J
            size = float(np.linalg.norm(error))
            H.flat[:: len(H) + 1] += size * size if on_curve else size
            try:
                step = np.linalg.solve(H, J.T @ error)
            except np.linalg.LinAlgError:  # the error is below the rounding of H
                step = np.linalg.lstsq(H, J.T @ error, rcond=None)[0]
            x = x.copy()
            x[self.free] += step / max(1.0, float(np.abs(step).max()) / _LONGEST)
        else:
            off = self.off(x)
        return x, off if math.isfinite(off) else math.inf

    def _moved(self, x: Vector, step: Vector, *, on_curve: bool = False) -> tuple[Vector, float]:
        """Return the solution beside a step (n_free,) from x, and how far it is off."""
        y = x.copy()
        y[self.free] += step
        return self._corrected(y, _CORRECTIONS, _MET, on_curve=on_curve)

    def _continued(self, x: Vector, null: Matrix) -> Matrix:
        """Return those directions (m, n_free) among singular ones in which there are more solutions."""
        lines: list[Vector] = []
        for direction in _fan(null):
            ends = [self._moved(x, sign * _TRIED * direction) for sign in (1.0, -1.0)]
            ways = [(y - x)[self.free] if off < _MET else np.zeros(len(self.free)) for y, off in ends]
            secant = (ways[0] - ways[1]) @ null.T @ null
            size = float(np.linalg.norm(secant))
            if max(float(np.linalg.norm(way)) for way in ways) < 0.5 * _TRIED or size < 0.4 * _TRIED:
                continue
            secant /= size
            if all(abs(float(secant @ line)) < _ALIKE for line in lines):
                lines.append(secant)
        if len(lines) <= len(null):
            return np.array(lines).reshape(-1, len(self.free))
        _, sizes, rows = np.linalg.svd(np.array(lines), full_matrices=False)
        return np.asarray(rows[sizes > 0.1 * sizes[0]])

    def _leads_to(self, x: Vector, other: Vector) -> bool:
        """Return whether a walk over a surface of solutions, always towards another one, arrives there."""
        for _ in range(_MOST_WALKED):
            way = self.way(x, other)
            if float(np.abs(way).max()) < _THERE:
                return True
            null, _ = self._null(x)
            step = way[self.free] @ null.T @ null
            if float(np.linalg.norm(step)) < 0.02 * float(np.linalg.norm(way)):
                return False
            x, off = self._moved(x, step / max(1.0, float(np.abs(step[self.rotary]).max(initial=0.0)) / _LONGEST))
            if off >= _MET:
                return False
        return False

    def _follow(self, x: Vector, direction: Vector, others: Sequence[Vector], found: set[int]) -> bool:
        """Follow a curve of solutions from x, and add which of the others it passes; return whether nothing is left."""
        for at, ahead, is_closed in self.steps_along(x, direction):
            found |= {n for n in self._near(at, ahead, others) if n not in found and self._passes(at, ahead, others[n])}
            if len(found) == len(others) or is_closed:
                return True
        return False

    def steps_along(self, x: Vector, direction: Vector) -> Iterator[tuple[Vector, Vector, bool]]:
        """Yield the steps along a curve of solutions from x: its two places, and whether it is back at x with that.

        Args:
            x: (n_axes,) a settled solution.
            direction: (n_axes,) one of `directions`, or the other way.
        """
        at, tangent, length, passed, apart = x, direction[self.free], _FIRST_STEP, 0.0, math.inf
        for _ in range(_MOST):
            ahead, off = self._moved(at, length * tangent, on_curve=True)
            step, bend = (ahead - at)[self.free], math.inf
            if off < _MET:
                null, sizes = self._null(ahead)
                turned = step @ null.T @ null
                turned /= float(np.linalg.norm(turned)) or 1.0
                bend = float(np.linalg.norm(turned - tangent))
            if bend > _BENT or float(np.linalg.norm(step - length * tangent)) > _BENT * length:
                length /= 2.0
                if length < _SHORTEST:
                    return
                continue
            passed += length
            is_closed = passed > 3.0 * length and bool(self._near(at, ahead, [x])) and self._passes(at, ahead, x)
            yield at, ahead, is_closed
            if is_closed or self._is_beyond(ahead):
                return
            # Towards a crossing of curves the next singular value vanishes: another curve may pass close by instead.
            last, apart = apart, float(sizes[len(self.free) - len(null) - 1])
            crossing = 0.5 * length * apart / (last - apart) if apart < last < math.inf else math.inf
            most = _LARGEST if self._turns_any(turned) else _FARTHEST
            length = max(min(length * (2.0 if bend < 0.3 * _BENT else 1.0), most, crossing), _SHORTEST)
            at, tangent = ahead, turned

    def between(self, start: Vector, end: Vector) -> Vector | None:
        """Return the solution in the middle of a step along a curve, or None."""
        middle, off = self._moved(start, 0.5 * (end - start)[self.free], on_curve=True)
        return middle if off < _MET else None

    def _turns_any(self, direction: Vector) -> bool:
        return bool(np.abs(direction[self.rotary]).max(initial=0.0) > _NOTHING)

    def _is_beyond(self, x: Vector) -> bool:
        """Return whether an axis is so far beyond its limits that no member of a family is farther along."""
        query, fixed = self.query, ~self.turns
        return bool(((x < query.lower - _ROOM) | (x > query.upper + _ROOM))[fixed].any())

    def _near(self, start: Vector, end: Vector, others: Sequence[Vector]) -> list[int]:
        """Return which solutions are near the piece of a curve between two of its places."""
        whole, ways = (end - start)[self.free], self.way(start, np.array(others))[:, self.free]
        shares = ways @ whole / float(whole @ whole)
        aside = np.linalg.norm(ways - shares[:, None] * whole, axis=1) < 0.3 * float(np.linalg.norm(whole))
        return [int(n) for n in np.flatnonzero((shares > -0.1) & (shares < 1.1) & aside)]

    def _passes(self, start: Vector, end: Vector, other: Vector) -> bool:
        """Return whether the piece of a curve between two of its places passes a solution that is near it."""
        whole, way = (end - start)[self.free], self.way(start, other)[self.free]
        at, off = self._moved(start, float(way @ whole) / float(whole @ whole) * whole)
        for _ in range(4 if off < _MET else 0):
            left = self.way(at, other)
            if float(np.abs(left).max()) < _THERE:
                return True
            null, _ = self._null(at)
            at, off = self._moved(at, left[self.free] @ null.T @ null)
            if off >= _MET:
                break
        return False


def _fan(null: Matrix) -> Iterator[Vector] | Iterable[Vector]:
    """Return unit directions that are tried in a space of singular ones (k, n)."""
    if len(null) == 1:
        return null
    if len(null) == 2:
        angles = np.arange(_FAN) * math.pi / _FAN
        return np.outer(np.cos(angles), null[0]) + np.outer(np.sin(angles), null[1])
    drawn = np.random.default_rng(len(null)).normal(size=(_DRAWN, len(null)))
    mixed = np.concatenate([np.eye(len(null)), drawn / np.linalg.norm(drawn, axis=1)[:, None]])
    return mixed @ null
