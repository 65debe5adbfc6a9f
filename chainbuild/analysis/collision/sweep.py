"""Limits of one axis that depend on another: the free interval over a sweep, to a hundredth of a degree."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.analysis.collision.paths import CONTACT, Contact, first_contact
from chainbuild.arrays import Vector
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.names import axis_index
from chainbuild.collision.model import CollisionModel, LinkPair
from chainbuild.errors import ChainbuildError
from chainbuild.progress import Progress, counting
from chainbuild.shown import fields_shown
from chainbuild.tolerances import LIMIT_SLACK

# Accuracy of interval ends (mm or degrees): a tenth of the promised one.
END: Final = 1e-3
_SEEDS: Final = 181  # values tried where the last free one is no longer free
DEFAULT_STEPS: Final = 41  # values of the other axis: forty intervals of its range


@dataclass(frozen=True, slots=True)
class FreeInterval:
    """Free interval of an axis at one value of the other.

    Attributes:
        over: Value of the other axis.
        lower: Lowest free value; None if no value is free.
        upper: Highest free value.
        lower_pair: Bodies that touch below; None: the range ends there.
        upper_pair: Bodies that touch above.
        lower_limit: Name of the limit on a sum of axes or on a drive that ends the interval below, else None.
        upper_limit: The same above.
    """

    __repr__ = fields_shown

    over: float
    lower: float | None
    upper: float | None
    lower_pair: LinkPair | None = None
    upper_pair: LinkPair | None = None
    lower_limit: str | None = None
    upper_limit: str | None = None


@dataclass(frozen=True, slots=True)
class Sweep:
    """Free intervals of an axis over another.

    Attributes:
        moved: Axis whose interval is computed.
        over: Axis that is swept.
        unit_moved: "mm" or "deg".
        unit_over: "mm" or "deg".
        intervals: In rising order of the swept axis.
    """

    __repr__ = fields_shown

    moved: str
    over: str
    unit_moved: str
    unit_over: str
    intervals: tuple[FreeInterval, ...]


def sweep(
    model: CollisionModel,
    moved: str,
    over: str,
    *,
    at: ArrayLike | None = None,
    values: Sequence[float] | None = None,
    bounds: tuple[float, float] | None = None,
    progress: Progress = False,
) -> Sweep:
    """Return the free interval of an axis at values of another, with the remaining axes fixed.

    The interval is the one that can be reached without contact and within limits on sums of axes: it is followed from
    value to value.

    Args:
        model: Bodies and pairs.
        moved: Axis whose interval is computed.
        over: Axis that is swept.
        at: (n_axes,) values of all axes at the start; None: the middle of the limits, or the free position next to it.
        values: Values of the swept axis; None: 41 over its limits.
        bounds: Range of the moved axis; None: its limits, and what limits on sums of axes leave of them.
        progress: True: a bar on standard error; a function: called with the values done and all values.

    Raises:
        ChainbuildError: an unknown axis, the same axis twice, or an empty range.
    """
    m, o = swept_axis(model, moved), swept_axis(model, over)
    if m == o:
        raise ChainbuildError("an axis cannot be swept against itself", parameter=moved)
    lower, upper = shown_limits(model.robot.chain)
    base = (lower + upper) / 2.0 if at is None else model.robot.axis_values(at).copy()
    span = bounds or (float(lower[m]), float(upper[m]))
    if not span[0] < span[1]:
        raise ChainbuildError("the range of the axis is empty", parameter=moved)
    chosen = np.linspace(lower[o], upper[o], DEFAULT_STEPS) if values is None else np.sort(np.asarray(values, float))
    start = int(np.argmin(np.abs(chosen - base[o])))
    found: dict[int, FreeInterval] = {}
    # From the start value upwards, then downwards, so that every value begins where its neighbour was free.
    with counting(len(chosen), progress, "positions") as advance:
        for order in (range(start, len(chosen)), range(start - 1, -1, -1)):
            seed = float(base[m])
            if order.step < 0 and start in found:
                seed = _middle(found[start], seed)
            for n in order:
                value = float(chosen[n])
                left = _within_sums(model, m, o, base, value, span) if bounds is None else _Span(*span)
                found[n] = _within(model, m, o, base, value, seed, left)
                seed = _middle(found[n], seed)
                advance(1)
    axes = model.robot.axes
    return Sweep(axes[m].name, axes[o].name, axes[m].unit, axes[o].unit, tuple(found[n] for n in sorted(found)))


def swept_axis(model: CollisionModel, name: str) -> int:
    """Return the index of an axis by name.

    Raises:
        ChainbuildError: there is no such axis.
    """
    found = axis_index(model.robot.axes, name)
    if found is None:
        known = ", ".join(axis.name for axis in model.robot.axes)
        raise ChainbuildError(f"the kinematic has no axis '{name}'", parameter="axis", permitted=known)
    return found


@dataclass(frozen=True, slots=True)
class _Span:
    """What limits leave of the range of an axis, and the names of those on sums that end it."""

    lower: float
    upper: float
    below: str | None = None
    above: str | None = None


def _within_sums(model: CollisionModel, m: int, o: int, base: Vector, over: float, span: tuple[float, float]) -> _Span:
    """Return what limits on sums leave of the range of axis m where axis o is at `over` and the others at `base`."""
    axes = base.copy()
    axes[o], axes[m] = over, 0.0
    found = _Span(*span)
    for limit in model.robot.limits.sums:
        factor, rest = limit.sum.coefficients[m], limit.sum.value(axes)
        if factor == 0.0:
            if limit.margin(axes) < -LIMIT_SLACK:
                return _Span(span[1], span[0], limit.name, limit.name)
            continue
        lower, upper = sorted(((limit.lower - rest) / factor, (limit.upper - rest) / factor))
        if lower > found.lower:
            found = replace(found, lower=lower, below=limit.name)
        if upper < found.upper:
            found = replace(found, upper=upper, above=limit.name)
    return found


def _within(model: CollisionModel, m: int, o: int, base: Vector, over: float, seed: float, left: _Span) -> FreeInterval:
    """Return the free interval within a span; its ends are named by the limits on sums where these end it."""
    if left.lower > left.upper:
        return FreeInterval(over, None, None, lower_limit=left.below, upper_limit=left.above)
    found = free_interval(model, m, o, base, over, seed, (left.lower, left.upper))
    below = left.below if found.lower == left.lower and found.lower_pair is None else None
    above = left.above if found.upper == left.upper and found.upper_pair is None else None
    return replace(found, lower_limit=below, upper_limit=above)


def _middle(interval: FreeInterval, otherwise: float) -> float:
    if interval.lower is None or interval.upper is None:
        return otherwise
    return (interval.lower + interval.upper) / 2.0


def free_interval(
    model: CollisionModel, m: int, o: int, base: Vector, over: float, seed: float, span: tuple[float, float]
) -> FreeInterval:
    """Return the free interval of axis m around a seed, with axis o at `over`.

    Args:
        model: Bodies and pairs.
        m: Axis that moves.
        o: Axis that is swept.
        base: (n_axes,) values of the other axes.
        over: Value of axis o.
        seed: Value of axis m to begin at; where it is not free, the nearest free one is taken.
        span: Range of axis m.
    """
    axes = base.copy()
    axes[o] = over
    begin = next((value for value in _seeds(seed, span) if not _touches(model, axes, m, value)), None)
    if begin is None:
        return FreeInterval(over, None, None)
    (lower, below), (upper, above) = (_end(model, axes, m, begin, bound) for bound in span)
    return FreeInterval(over, lower, upper, below, above)


def _seeds(seed: float, span: tuple[float, float]) -> Iterator[float]:
    inside = min(max(seed, span[0]), span[1])
    yield inside
    yield from sorted(np.linspace(*span, _SEEDS).tolist(), key=lambda value: abs(value - inside))


def _touches(model: CollisionModel, axes: Vector, m: int, value: float) -> bool:
    axes[m] = value
    return model.collides(axes)


def _end(model: CollisionModel, axes: Vector, m: int, begin: float, bound: float) -> tuple[float, LinkPair | None]:
    """Return the last free value from a free one towards a bound, and the pair that touches beyond it."""
    step = END if bound > begin else -END
    free = begin
    while True:
        contact = _next_contact(model, axes, m, free, bound)
        if contact is None:
            return bound, None
        free = float(contact.axes[m])
        # So small a distance may be a near miss: go on in the smallest steps until bodies collide or separate.
        while True:
            ahead = free + step
            if (bound - ahead) * step <= 0.0:
                return bound, None
            if _touches(model, axes, m, ahead):
                return free, _touching_pair(model, axes, m, ahead)
            free = ahead
            if _clearance(model, axes, m, free) > CONTACT:
                break


def _next_contact(model: CollisionModel, axes: Vector, m: int, start: float, bound: float) -> Contact | None:
    path = np.array([axes, axes])
    path[0, m], path[1, m] = start, bound
    return first_contact(model.robot, path, bodies=model)


def _clearance(model: CollisionModel, axes: Vector, m: int, value: float) -> float:
    axes[m] = value
    nearest = model.nearest(axes)
    return np.inf if nearest is None else nearest.distance


def _touching_pair(model: CollisionModel, axes: Vector, m: int, value: float) -> LinkPair:
    axes[m] = value
    return model.distance_table(axes)[0].pair
