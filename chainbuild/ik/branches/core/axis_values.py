"""From joint values to axis values: through the axis map, with whole turns within the limits."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.arrays import Indices, Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.ik import rules
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.region import periodic_axes
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.tolerances import BELOW_ZERO_DEG

_MAP_STEPS: Final = 20  # Newton steps that bring a nonlinear axis map to given joint values
_MAP_STARTS: Final = 12  # the start, its own joint values, and some anywhere within a turn
_MAP_STRIDE: Final = 1.0  # longest step [rad]
_MAP_EXACT: Final = 1e-14  # m and rad: nothing is gained by another step
_MAP_CLOSE: Final = 1e-9  # residual of rounding; the pose is verified and polished afterwards
_ROUNDED_TURN: Final = 1e-9  # turns of a joint are counted with so much to spare
_ZERO: Final = -math.radians(BELOW_ZERO_DEG)  # what is less is below zero
_MAX_TURNS: Final = 4096  # bound on the combinations of whole turns tried for one branch


def axes_for(query: BranchQuery, joints: Indices, values: Vector, columns: Indices) -> list[Vector]:
    """Return the SI axis values that give joint values, with the whole turns the query asks for, inside limits.

    Args:
        query: The query.
        joints: Joints whose values are given; they determine the columns.
        values: Their values, up to whole turns where revolute.
        columns: Axes to be found; the others stay at the start.
    """
    if not len(columns):
        return [query.x0.copy()]
    axis_map = query.mechanism.chain.axis_map
    if not isinstance(axis_map, AffineMap):
        x = _through_nonlinear_map(query, joints, values, columns)
        return [] if x is None else list(turned_axes(query, x, columns))
    return next(_through_affine_map(query, axis_map, joints, [values], columns))


def axes_for_each(
    query: BranchQuery, joints: Indices, rows: Sequence[Vector], columns: Indices
) -> Iterator[list[Vector]]:
    """Yield what `axes_for` returns, for each of some joint values."""
    axis_map = query.mechanism.chain.axis_map
    if len(columns) and isinstance(axis_map, AffineMap) and rows:
        yield from _through_affine_map(query, axis_map, joints, rows, columns)
        return
    for values in rows:
        yield axes_for(query, joints, values, columns)


def _through_affine_map(
    query: BranchQuery, axis_map: AffineMap, joints: Indices, rows: Sequence[Vector], columns: Indices
) -> Iterator[list[Vector]]:
    block = block_of(query.mechanism, axis_map, joints, columns)
    if block is None:
        yield from ([] for _ in rows)
        return
    constant = block.from_others @ query.x0[block.others] + block.b
    found = np.tile(query.x0, (len(rows), 1))
    found[:, columns] = (np.array(rows)[:, block.rows] - constant) @ block.inverse.T
    for x in found:
        if block.turns_per_axis:
            yield list(turned_axes(query, x, columns))
        else:
            yield _turned_joints(query, x, block, joints[block.rows], columns)


@dataclass(frozen=True, slots=True, eq=False)
class AxisBlock:
    """The inverse of the part of an affine map from some axes to some joints.

    Attributes:
        rows: Which of the joints determine the axes.
        inverse: (n, n) from their values to the axes.
        others: The other axes.
        from_others: (n, n_others) what these add to the joints.
        b: (n,) constants of the joints.
        turns_per_axis: Whether whole turns of single axes lead to all equivalent joint values.
    """

    rows: Indices
    inverse: Vector
    others: Indices
    from_others: Vector
    b: Vector
    turns_per_axis: bool


def block_of(mechanism: Mechanism, axis_map: AffineMap, joints: Indices, columns: Indices) -> AxisBlock | None:
    """Return the block of some joints and axes, prepared at first use; None if they do not determine the axes."""
    return mechanism.prepared(
        "block of an axis map",
        lambda: _prepare_block(mechanism, axis_map, joints, columns),
        joints.tobytes() + b"|" + columns.tobytes(),
    )


def _prepare_block(mechanism: Mechanism, axis_map: AffineMap, joints: Indices, columns: Indices) -> AxisBlock | None:
    rows = np.array(_independent_rows(axis_map.A[np.ix_(joints, columns)]), dtype=np.intp)
    if len(rows) < len(columns):
        return None
    block = axis_map.A[np.ix_(joints[rows], columns)]
    others = np.setdiff1d(np.arange(len(mechanism.axes)), columns)
    rotary = [n for n in columns if mechanism.axes[n].kind == "rotary"]
    per_axis = bool(periodic_axes(mechanism.chain)[rotary].all()) and abs(abs(np.linalg.det(block)) - 1.0) < 1e-9
    from_others = axis_map.A[np.ix_(joints[rows], others)]
    return AxisBlock(
        rows, np.asarray(np.linalg.inv(block), dtype=float), others, from_others, axis_map.b[joints[rows]], per_axis
    )


def _through_nonlinear_map(query: BranchQuery, joints: Indices, values: Vector, columns: Indices) -> Vector | None:
    """Return SI axis values with given joint values, by Newton steps from the map's own inverse and around it.

    A map that drives more axes than joints (a virtual axis) cannot know the inverse at the start's value of the others.
    """
    q = query.q0
    q[joints] = values
    x = query.x0.copy()
    x[columns] = (query.mechanism.chain.axis_map.axes(q) * query.mechanism.kinematics.si_factors)[columns]
    rng = np.random.default_rng(0)
    for attempt in range(_MAP_STARTS):
        found = _newton_on_map(query, joints, values, columns, x.copy())
        if found is not None:
            return found
        x[columns] = query.x0[columns]
        if attempt:
            x[columns] += rng.uniform(-math.pi, math.pi, len(columns))
    return None


def _newton_on_map(query: BranchQuery, joints: Indices, values: Vector, columns: Indices, x: Vector) -> Vector | None:
    kinematics = query.mechanism.kinematics
    turns = np.array([query.mechanism.chain.joints[n].kind == "revolute" for n in joints])
    for _ in range(_MAP_STEPS):
        error = values - kinematics.q(x)[joints]
        if not np.isfinite(error).all():
            return None
        error[turns] = [math.remainder(e, math.tau) for e in error[turns]]
        if float(np.abs(error).max(initial=0.0)) < _MAP_EXACT:
            return x
        J = kinematics.dq_dx(x)[np.ix_(joints, columns)]
        step = np.linalg.lstsq(J, error, rcond=None)[0]
        x[columns] += step / max(1.0, float(np.abs(step).max()) / _MAP_STRIDE)
    return x if float(np.abs(error).max(initial=0.0)) < _MAP_CLOSE else None


def turned_axes(query: BranchQuery, x: Vector, columns: Indices) -> Iterator[Vector]:
    """Yield x moved by whole turns of single axes, nearest first: all within limits, or the nearest only.

    Of axes with a common limit, a sum or a drive, the nearest that keeps it.
    """
    limits = query.mechanism.limits
    if not (query.windings or query.below_zero or limits.together):
        yield _nearest_turns(query, x, columns)
        return
    choices, open_choices = [], False
    for n in columns:
        places = _whole_turns(query, float(x[n]), int(n)) if query.periodic[n] else [float(x[n])]
        several = query.windings or int(n) in limits.together
        open_choices = open_choices or (several and len(places) > 1)
        choices.append(places if several else places[:1])
    turned = _combined(x, columns, choices)
    if query.windings or not open_choices:
        yield from turned
        return
    nearest = sorted(turned, key=query.distance)
    yield next((one for one in nearest if not limits.breaks_together(query.shown(one))), nearest[0])


def _nearest_turns(query: BranchQuery, x: Vector, columns: Indices) -> Vector:
    """Return x with the whole turns of `_whole_turns` that are nearest to the start."""
    values, start, periodic = x.tolist(), query.x0.tolist(), query.periodic.tolist()
    lower, upper, slack = query.lower.tolist(), query.upper.tolist(), query.slack.tolist()
    for n in columns.tolist():
        if periodic[n]:
            value, low, high = values[n], lower[n] - slack[n], upper[n] + slack[n]
            away = _nudged(start[n]) - value
            if not (lower[n] <= value <= upper[n] and abs(away) <= math.pi):  # most are there
                first = -math.inf if math.isinf(low) else math.ceil((low - value) / math.tau)
                last = math.inf if math.isinf(high) else math.floor((high - value) / math.tau)
                if first <= last:
                    values[n] = value + min(max(round(away / math.tau), first), last) * math.tau
    return np.array(values)


def _nudged(start: float) -> float:
    """Return a start as it counts where two places are half a turn to either side."""
    return start + math.copysign(rules.HALF_TURN_NUDGE, rules.HALF_TURN_TOWARDS - start)


def _combined(x: Vector, columns: Indices, choices: Sequence[Sequence[float]]) -> Iterator[Vector]:
    for combination in itertools.islice(itertools.product(*choices), _MAX_TURNS):
        turned = x.copy()
        turned[columns] = combination
        yield turned


def _whole_turns(query: BranchQuery, value: float, n: int) -> list[float]:
    """Return value + whole turns within the limits of axis n, nearest to the start first; else one outside them."""
    lower, upper, wanted = float(query.lower[n]), float(query.upper[n]), _nudged(float(query.x0[n]))
    slack = float(query.slack[n])
    nearest = round((wanted - value) / math.tau)
    first = nearest - 1 if math.isinf(lower) else math.ceil((lower - slack - value) / math.tau)
    last = nearest + 1 if math.isinf(upper) else math.floor((upper + slack - value) / math.tau)
    places = [value + k * math.tau for k in range(first, last + 1)]
    places.sort(key=lambda place: abs(place - wanted))
    below = query.below_zero.get(n)
    if below is None:
        return places or [value]
    turns = (_ZERO - value) / math.tau
    outside = value + (math.floor(turns) if below else math.ceil(turns)) * math.tau
    return [place for place in places if (place < _ZERO) is below] or [outside]


def _turned_joints(query: BranchQuery, x: Vector, block: AxisBlock, joints: Indices, columns: Indices) -> list[Vector]:
    """Return the axis values of joint values moved by whole turns: where a gear makes a turn of no axis whole."""
    chain = query.mechanism.chain
    low = np.where(np.isfinite(query.lower), query.lower, query.x0 - math.tau)
    high = np.where(np.isfinite(query.upper), query.upper, query.x0 + math.tau)
    factors = query.mechanism.kinematics.si_factors
    q_low, q_high = chain.axis_map.q_bounds(low / factors, high / factors)
    q = query.mechanism.kinematics.q(x)
    ranges = []
    for n in joints:
        turns = chain.joints[n].kind == "revolute"
        first = math.ceil((q_low[n] - q[n]) / math.tau - _ROUNDED_TURN) if turns else 0
        last = math.floor((q_high[n] - q[n]) / math.tau + _ROUNDED_TURN) if turns else 0
        ranges.append(range(first, last + 1))
    found = []
    for turns_of_joints in itertools.islice(itertools.product(*ranges), _MAX_TURNS):
        turned = x.copy()
        turned[columns] += block.inverse @ (math.tau * np.array(turns_of_joints, dtype=float))
        outside = query.mechanism.limits.outside(query.shown(turned))
        if not np.isin(outside, columns).any():
            found.append(turned)
    found.sort(key=query.distance)
    return found if query.windings else found[:1]


def _independent_rows(A: Vector) -> Sequence[int]:
    """Return the first rows of A that determine all columns."""
    rows: list[int] = []
    for n in range(A.shape[0]):
        if len(rows) < A.shape[1] and np.linalg.matrix_rank(A[[*rows, n]]) > len(rows):
            rows.append(n)
    return rows
