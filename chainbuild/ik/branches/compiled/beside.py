"""Solutions of a singular pose, compiled: from those of poses beside it, and from each other past the folds between.

Equations lose digits where branches meet or solutions form curves, and may lose some of the solutions with these. Those
of poses beside it are brought to the pose by damped Newton steps. Where the tool hardly moves along a direction, a
branch that meets this one lies that way: steps of several sizes along it, each brought back to the pose, lead there.
"""

from __future__ import annotations

import math
from typing import Final

from chainbuild.ik.branches.compiled.axes import look, missed, way_of, write_pose
from chainbuild.ik.branches.compiled.constants import UNSURE
from chainbuild.ik.branches.compiled.finish import copy_rows, write_axis_values
from chainbuild.ik.branches.core.branches import BETWEEN_BRANCHES, CLOSE_BRANCHES, SAME_BRANCH
from chainbuild.ik.search.compiled.kernels import damped_step, jit, solve_in_place

_STEPS: Final = 30  # damped Newton steps: a start near a branch takes five, where branches meet twenty
_EXACT: Final = 1e-15  # m and rad: rounding
_SLOW_BELOW: Final = 1e-11  # m and rad: below, steps that gain less than half have come to rounding
_HOPELESS_AFTER: Final = 14  # steps: what is not near by then is given up
_HOPELESS: Final = 0.05  # m and rad
_DAMPING: Final = 0.1  # times the squared error
_MOST_DAMPED: Final = 0.01  # far from a solution, where more only takes longer
_FLOOR: Final = 1e-14  # damping that keeps the factorisation alive
_LONGEST: Final = 0.8  # rad or m of one step
_WEAK: Final = 2e-2  # share of the Jacobian's size: a weaker direction may lead to a branch nearby
_LOST: Final = 1e-6  # the same below which solutions may go on as a curve
_ITERATIONS: Final = 4  # inverse ones, each of which gains the squared ratio of two singular values
_AWAY: Final = (1e-3, 5e-3, 2.5e-2, 0.15)  # rad or m along a weak direction: past the middle of two branches is enough
_CLUSTER: Final = 5e-3  # share of the Jacobian's size: two directions so weak have branches between them, too
_HALF: Final = math.sqrt(0.5)
_BACK: Final = 0.1  # share of such a step: what comes so near to where it began ends there
_TRIED: Final = 1e-2  # rad or m along a lost direction: there the residual of an isolated solution is far from rounding
_CORRECTIONS: Final = 24  # bring an isolated solution's step back, see `core.beside`
_MET: Final = 1e-11  # m and rad: a place on a curve


@jit
def _stepped(axes, room, damping):
    """Move room.x by a damped Newton step of its Jacobian and remaining motion."""
    rows, longest = copy_rows(axes, room), _LONGEST
    damped_step(rows, room.Jf, room.error, room.H, room.g, room.step, damping)
    for m in range(len(axes.free)):
        longest = max(longest, abs(room.step[m]))
    for m in range(len(axes.free)):
        room.x[axes.free[m]] += room.step[m] * (_LONGEST / longest)


@jit
def _descended(axes, room, target, reached, origin, near):
    """Bring room.x to the target; return whether it is a solution then, and farther than near from an origin (n,)."""
    left = math.inf
    for step in range(_STEPS + 1):
        before = left
        left = max(look(axes, room, target))
        if not left < math.inf or left < _EXACT or step == _STEPS or (left < _SLOW_BELOW and left > 0.5 * before):
            break
        if step >= _HOPELESS_AFTER and left > _HOPELESS:
            break
        _stepped(axes, room, max(_FLOOR, min(_MOST_DAMPED, _DAMPING * left * left)))
        away = 0.0
        for m in range(len(axes.free)):
            away = max(away, abs(room.x[axes.free[m]] - origin[axes.free[m]]))
        if away < near:
            return False
    return left < reached


@jit
def _is_place(axes, room, target, places, count):
    """Tell whether room.x is one of the first places; close ones are one where the place between them is as good."""
    x = room.x
    for i in range(count):
        apart = 0.0
        for m in range(len(x)):
            apart = max(apart, abs(way_of(axes, m, places[i, m], x[m])))
            if apart >= CLOSE_BRANCHES:
                break
        if apart < SAME_BRANCH:
            return True
        if apart < CLOSE_BRANCHES:
            for m in range(len(x)):
                x[m] -= 0.5 * way_of(axes, m, places[i, m], x[m])
            write_pose(axes, room)
            between = max(missed(axes, room, target))
            for m in range(len(x)):
                x[m] += way_of(axes, m, places[i, m], x[m])
            if between < BETWEEN_BRANCHES:
                return True
    return False


@jit
def _with_place(axes, room, target, reached, places, count, origin, near):
    """Bring room.x to the target and write it behind the first places if it is none of them; return how many then.

    What comes back to an origin (n,) nearer than `near` is given up.
    """
    if (
        count < len(places)
        and _descended(axes, room, target, reached, origin, near)
        and not _is_place(axes, room, target, places, count)
    ):
        for m in range(len(room.x)):
            places[count, m] = room.x[m]
        return count + 1
    return count


@jit
def _weakest(room, rows, n, other, share, v):
    """Write the unit direction (n,) that moves the tool least, but for another one if share; return how much."""
    size = 0.0
    for m in range(n):
        v[m] = 1.0 + 0.3 * m - share * other[m]
    for _ in range(_ITERATIONS):
        for i in range(n):
            for j in range(i + 1):
                total = share * other[i] * other[j]
                for r in range(rows):
                    total += room.Jf[r, i] * room.Jf[r, j]
                room.H[i, j] = total
            room.H[i, i] += _FLOOR
            room.g[i] = v[i]
        solve_in_place(room.H, room.g, n)
        size = 0.0
        for i in range(n):
            size += room.g[i] * room.g[i]
        size = math.sqrt(size)
        for i in range(n):
            v[i] = room.g[i] / size
    return 1.0 / math.sqrt(size)


@jit
def _put(axes, room, place, step, direction):
    """Write the place a step along a direction (f,) of the free axes to room.x."""
    for m in range(len(place)):
        room.x[m] = place[m]
    for m in range(len(axes.free)):
        room.x[axes.free[m]] += step * direction[m]


@jit
def _goes_on(axes, room, target, place, direction):
    """Tell whether solutions go on along a direction: a step is brought back nearly across it, on either side."""
    longest, secant = 0.0, 0.0
    for side in range(2):
        sign, left = 1.0 - 2.0 * side, math.inf
        _put(axes, room, place, sign * _TRIED, direction)
        for _ in range(_CORRECTIONS):
            left = max(look(axes, room, target))
            if left < _MET:
                break
            _stepped(axes, room, left + _FLOOR)
        if left < _MET:
            way, along = 0.0, 0.0
            for m in range(len(axes.free)):
                moved = room.x[axes.free[m]] - place[axes.free[m]]
                way, along = way + moved * moved, along + moved * direction[m]
            longest, secant = max(longest, math.sqrt(way)), secant + sign * along
    return longest >= 0.5 * _TRIED and abs(secant) >= 0.4 * _TRIED


@jit
def _around(axes, room, target, reached, places, count, at):
    """Add the solutions next to a place; return how many there are then, and whether the place is on a curve."""
    n, place = len(axes.free), places[at]
    v, w, along = room.x.copy(), room.x.copy(), room.x.copy()
    _put(axes, room, place, 0.0, v)
    look(axes, room, target)
    rows, size = copy_rows(axes, room), 0.0
    for r in range(rows):
        for m in range(n):
            size = max(size, abs(room.Jf[r, m]))
    weak = _weakest(room, rows, n, v, 0.0, v)
    if not weak < _WEAK * size:
        return count, False
    next_weak = _weakest(room, rows, n, v, 1.0, w)
    if next_weak < _LOST * size or (weak < _LOST * size and _goes_on(axes, room, target, place, v)):
        return count, True
    for d in range(4 if next_weak < _CLUSTER * size else (2 if next_weak < _WEAK * size else 1)):
        for m in range(n):
            along[m] = v[m] if d == 0 else (w[m] if d == 1 else _HALF * (v[m] + (2.0 * d - 5.0) * w[m]))
        for step in _AWAY:
            for side in range(2):
                _put(axes, room, place, step * (1.0 - 2.0 * side), along)
                count = _with_place(axes, room, target, reached, places, count, place, _BACK * step)
    return count, False


@jit
def places_beside(axes, room, target, x0, values, counts, reached, places, count):
    """Add the solutions that those of poses beside a target lead to, and these to others.

    Args:
        axes: The machine's axes.
        room: Scratch.
        target: (4, 4) tool in the workpiece frame [m].
        x0: (n,) start in SI; held axes have their values.
        values: (K, ·, COLUMNS) joint values of poses beside the target, see `finished`.
        counts: (K,) how many, as forms tell.
        reached: What is left at a solution at most [m, rad].
        places: (·, n) out: solutions in SI, whatever the limits; those found before stand there.
        count: How many these are.

    Returns:
        How many solutions there are, and whether one of them is on a curve of solutions.
    """
    looked_at = count
    for k in range(len(counts)):
        rows = counts[k] if counts[k] >= 0 else UNSURE - counts[k]
        for i in range(rows):
            write_axis_values(axes, x0, values[k, i], room.x)
            count = _with_place(axes, room, target, reached, places, count, x0, -1.0)
    curved = False
    while looked_at < count:
        count, goes_on = _around(axes, room, target, reached, places, count, looked_at)
        looked_at += 1
        curved |= goes_on
    return count, curved
