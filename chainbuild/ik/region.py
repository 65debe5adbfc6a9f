"""The region that a solver searches: limits, coupled limits, whole turns."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AffineMap, periodic_of
from chainbuild.chain.elements import Chain
from chainbuild.chain.sums import AxisConstraint
from chainbuild.ik import rules
from chainbuild.kinematics.mechanism import Mechanism

_ENDLESS_START: Final = math.pi  # random starts of axes without end are drawn from ± this
_START_STAGGER: Final = 0.07  # default start: the middle of the limits, moved by this share so that no two axes line up
_WHOLE: Final = 1e-12  # how far a gear factor may be from a whole number


@dataclass(frozen=True, slots=True, eq=False)
class Box:
    """Limits of some axes in SI, and limits on sums of them.

    Attributes:
        lower: (n,) lower limits, -inf where endless.
        upper: (n,) upper limits, +inf where endless.
        periodic: (n,) True where a whole turn leads to the same pose.
        names: Axis names.
        sums: (c, n) rows g of the coupled limits sum_lower ≤ g·y ≤ sum_upper, each of length 1.
        sum_lower: (c,) lower coupled limits.
        sum_upper: (c,) upper coupled limits.
    """

    lower: Vector
    upper: Vector
    periodic: NDArray[np.bool_]
    names: tuple[str, ...]
    sums: Matrix
    sum_lower: Vector
    sum_upper: Vector
    _limits: list[tuple[float, float]] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_limits", list(zip(self.lower.tolist(), self.upper.tolist(), strict=True)))

    def outside(self, y: Vector) -> list[int]:
        """Return the indices of the axes beyond their limits."""
        # Plain floats: for a handful of axes quicker than arrays.
        values = enumerate(zip(y.tolist(), self._limits, strict=True))
        return [n for n, (value, (lower, upper)) in values if not lower <= value <= upper]

    def leaves(self, y: Vector) -> bool:
        """Return whether any axis is beyond its limits."""
        for value, (lower, upper) in zip(y.tolist(), self._limits, strict=True):  # noqa: SIM110 (any() is slower)
            if not lower <= value <= upper:
                return True
        return False

    def into(self, y: Vector) -> Vector:
        """Return y with periodic axes outside their limits moved by whole turns to the nearest place inside."""
        if not self.leaves(y):
            return y
        y = y.copy()
        for n in self.outside(y):
            if self.periodic[n]:
                y[n] = self._turned_inside(n, float(y[n]))
        return y

    def _turned_inside(self, n: int, value: float) -> float:
        lower, upper = float(self.lower[n]), float(self.upper[n])
        gap = lower - value if value < lower else upper - value
        moved = value + math.copysign(math.ceil(abs(gap) / math.tau) * math.tau, gap)
        return moved if lower <= moved <= upper else value

    def onto_limits(self, y: Vector) -> Vector:
        """Return y moved onto the limits of the axes, and onto the coupled ones."""
        moved = self.clamp(y)
        return self.onto_sums(moved) if len(self.sums) else moved

    def clamp(self, y: Vector) -> Vector:
        """Return y cut to the limits of the axes."""
        return np.minimum(np.maximum(y, self.lower), self.upper)

    def onto_sums(self, y: Vector) -> Vector:
        """Return y moved onto each coupled limit it violates, by axes that their own limits leave room to move."""
        for g, lower, upper in zip(self.sums, self.sum_lower, self.sum_upper, strict=True):
            for _ in range(len(y)):
                value = float(g.dot(y))
                gap = min(max(value, lower), upper) - value
                if gap == 0.0:
                    break
                push = gap * g
                movable = np.where(push > 0.0, y < self.upper, y > self.lower) * g
                length = float(movable.dot(movable))
                if length == 0.0:
                    break
                y = self.clamp(y + gap / length * movable)
        return y

    def inside(self, y: Vector) -> bool:
        """Return whether y keeps all limits."""
        return self.excess(y) <= rules.INSIDE_SLACK

    def excess(self, y: Vector) -> float:
        """Return by how much y violates its limits, coupled ones included; 0 inside."""
        total = sum(max(self.lower[n] - y[n], y[n] - self.upper[n]) for n in self.outside(y))
        if len(self.sums):
            value = self.sums @ y
            total += float(np.maximum(np.maximum(self.sum_lower - value, value - self.sum_upper), 0.0).sum())
        return float(total)

    def nearest(self, y: Vector, wanted: Vector) -> Vector:
        """Return y with periodic axes moved by whole turns as near as all limits allow to `wanted`."""
        moved = y
        for n, far in enumerate((wanted - y).tolist()):
            if not -math.pi <= far <= math.pi and self.periodic[n]:
                (lower, upper), value, count = self._limits[n], float(y[n]), round(far / math.tau)
                while count and not lower <= value + count * math.tau <= upper:
                    count -= 1 if count > 0 else -1
                if count:
                    moved = y.copy() if moved is y else moved
                    moved[n] = value + count * math.tau
        return moved if moved is y or not len(self.sums) or self.inside(moved) else y

    def turned_to(self, y: list[float], turning: Iterable[int], wanted: Vector) -> Vector | None:
        """Return y (n,) with some axes moved by whole turns towards `wanted` and the others cut to their limits.

        None if one of the turning axes has no position inside its limits.
        """
        for n in turning:
            (lower, upper), value = self._limits[n], y[n]
            far = float(wanted[n]) - value
            if not -math.pi <= far <= math.pi:
                value += math.tau * round(far / math.tau)
            if not lower <= value <= upper:
                value = self._turned_inside(n, value)
                if not lower <= value <= upper:
                    return None
            y[n] = value
        for n, (value, (lower, upper)) in enumerate(zip(y, self._limits, strict=True)):
            if not lower <= value <= upper:
                y[n] = lower if value < lower else upper
        return np.array(y)

    def restricted(self, free: NDArray[np.intp], x: Vector) -> Box:
        """Return the region of some axes while the others stay at x."""
        if len(free) == len(self.lower):
            return self
        held = np.delete(np.arange(len(x)), free)
        fixed_part = self.sums[:, held] @ x[held]
        names = tuple(self.names[n] for n in free)
        axes = (self.lower[free], self.upper[free], self.periodic[free], names)
        sums = (self.sums[:, free], self.sum_lower - fixed_part, self.sum_upper - fixed_part)
        return Box(*axes, *_unit_rows(*sums))


@dataclass(frozen=True, slots=True, eq=False)
class Freedoms:
    """Limits and scaling of a robot's axes, prepared once per robot.

    Attributes:
        box: Limits of all axes.
        middle: (n_axes,) the default start [SI].
        si_factors: (n_axes,) mm and degrees to SI.
    """

    box: Box
    middle: Vector
    si_factors: Vector


def freedoms_of(mechanism: Mechanism) -> Freedoms:
    """Return the freedoms of a mechanism, prepared at first use."""
    return mechanism.prepared("freedoms", lambda: _prepare(mechanism))


def _prepare(mechanism: Mechanism) -> Freedoms:
    axes, limits = mechanism.axes, mechanism.limits
    factors = mechanism.kinematics.si_factors
    lower = _inner(limits.lower.tolist(), factors, math.inf)
    upper = _inner(limits.upper.tolist(), factors, -math.inf)
    periodic = periodic_axes(mechanism.chain)
    box = Box(lower, upper, periodic, tuple(a.name for a in axes), *_coupled(limits.sums, factors))
    span_low, span_high = finite_span(lower, upper)
    stagger = _START_STAGGER * np.where(np.arange(len(axes)) % 2 == 0, 1.0, -1.0)
    middle = (span_low + span_high) / 2.0 + stagger * np.minimum(span_high - span_low, math.tau)
    return Freedoms(box, middle, factors)


def _inner(limits: Sequence[float], factors: Vector, inwards: float) -> Vector:
    """Return limits in SI that stay on the inner side when they are turned back into mm and degrees."""
    bounds = []
    for limit, factor in zip(limits, factors.tolist(), strict=True):
        bound = limit * factor
        while math.isfinite(bound) and (bound / factor - limit) * inwards < 0.0:
            bound = math.nextafter(bound, inwards)
        bounds.append(bound)
    return np.array(bounds)


def finite_span(lower: Vector, upper: Vector) -> tuple[Vector, Vector]:
    """Return limits to draw starts from: those given, ± half a turn where there are none."""
    return (
        np.where(np.isfinite(lower), lower, -_ENDLESS_START),
        np.where(np.isfinite(upper), upper, _ENDLESS_START),
    )


def _coupled(rows: Sequence[AxisConstraint], factors: Vector) -> tuple[Matrix, Vector, Vector]:
    """Return limits on sums of axes as rows over SI axis values."""
    sums = np.array([row.sum.coefficients for row in rows]).reshape(len(rows), len(factors)) / factors
    offset = np.array([row.sum.offset for row in rows])
    lower, upper = (np.array([getattr(row, end) for row in rows], dtype=float) - offset for end in ("lower", "upper"))
    return _unit_rows(sums, lower, upper)


def _unit_rows(sums: Matrix, lower: Vector, upper: Vector) -> tuple[Matrix, Vector, Vector]:
    """Scale rows to length 1; a row that no axis moves stays as it is."""
    length = np.linalg.norm(sums, axis=1)
    length[length == 0.0] = 1.0
    return sums / length[:, None], lower / length, upper / length


def periodic_axes(chain: Chain) -> NDArray[np.bool_]:
    """Return for each axis whether a whole turn of it leads to the same pose.

    True where the axis turns revolute joints only, each by a whole number of turns.
    """
    if not isinstance(chain.axis_map, AffineMap):
        return np.isin(np.arange(len(chain.axes)), periodic_of(chain.axis_map))
    A = chain.axis_map.A
    revolute = np.array([joint.kind == "revolute" for joint in chain.joints])
    result = np.zeros(len(chain.axes), dtype=bool)
    for n, axis in enumerate(chain.axes):
        moved = A[:, n] != 0.0
        whole = np.abs(A[:, n] - np.round(A[:, n])) < _WHOLE
        result[n] = axis.kind == "rotary" and bool((revolute[moved] & whole[moved]).all())
    return result
