"""Solutions of a singular pose, compiled: from those of poses beside it, and from each other past the folds between.

Equations lose digits where branches meet or solutions form curves, and may lose some of the solutions with these. Those
of poses beside it are brought to the pose by damped Newton steps. Where the tool hardly moves along a direction, a
branch that meets this one lies that way: steps of several sizes along it, each brought back to the pose, lead there.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from chainbuild.ik.branches.compiled.axes import copy_rows, inverted, look, way_of, weakest
from chainbuild.ik.branches.compiled.constants import CLUSTERED, ENDS, ISOLATED, PIECES, STATE, UNKNOWN, UNSURE
from chainbuild.ik.branches.compiled.doubtful.curves import follow_curve, piece_through
from chainbuild.ik.branches.compiled.doubtful.descents import descended, is_place
from chainbuild.ik.branches.compiled.doubtful.steps import (
    ARRIVED,
    goes_on,
    put,
    short_way,
    stepped,
    weakest_at,
)
from chainbuild.ik.branches.compiled.finish import write_axis_values
from chainbuild.ik.search.compiled.kernels import jit, leaf

_WEAK: Final = 2e-2  # share of the Jacobian's size: a weaker direction may lead to a branch nearby
_LOST: Final = 1e-6  # the same below which solutions may go on as a curve
_LOST_TOO: Final = 1e-5  # for a second one: where several are lost, a solution is less exact in all of them
_NEIGHBOURS: Final = 1.0  # rad or m: between two branches of a valley that are nearer there may be a third
_AWAY: Final = (1e-3, 5e-3, 2.5e-2, 0.15)  # rad or m along a weak direction: past the middle of two branches is enough
_CLUSTER: Final = 5e-3  # share of the Jacobian's size: two directions so weak have branches between them, too
_VALLEY: Final = 1e-3  # share of the Jacobian's size: a direction so weak may lead through a valley
_ALONG: Final = 0.3  # rad or m of a step through a valley
_MOST_ALONG: Final = 32  # such steps: a whole turn of two axes
_TO_FLOOR: Final = 3  # Newton's steps from there to the valley's floor
_FLOOR: Final = 0.9  # share of what was left before such a step that is the floor's height
_ACROSS: Final = 1e-6  # their damping: above the square of what is along it, below that of what is across
_FLAT: Final = 1e-3  # m and rad: a floor that is higher is no longer of this valley
# Shares of up to three directions that do not move the tool: tried to find where solutions go on.
_FAN: Final = (
    (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (1.0, 1.0, 0.0), (1.0, -1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 1.0),
    (1.0, 0.0, -1.0), (0.0, 1.0, 1.0), (0.0, 1.0, -1.0), (1.0, 1.0, 1.0), (1.0, 1.0, -1.0), (1.0, -1.0, 1.0),
    (-1.0, 1.0, 1.0),
)  # fmt: skip
_MOST_LOST: Final = 4  # such directions, or ways on: what they are together remains unknown
_TURNS: Final = 3  # each tried so often, turned to where the solutions are
_ALIKE: Final = 0.98  # cosine of directions that are one
_HALF: Final = math.sqrt(0.5)
_BACK: Final = 0.1  # share of such a step: what comes so near to where it began ends there
# Newton's steps from a place nearer than this share of the weakest direction's strength lead to the solution: a half by
# Kantorovich's theorem, divided by a bound of what a radian changes of six axes' Jacobian.
_ITS_OWN: Final = 0.05


@jit
def _lines(axes, room, target, place, null, count, lines):
    """Write the directions (·, f) in which solutions go on, where up to three do not move the tool; return how many.

    As many as there is room for mean a surface, or what is none of both.
    """
    f, found = len(axes.free), 0
    direction = np.empty(f)
    for shares in _FAN:
        size = math.sqrt(shares[0] * shares[0] + shares[1] * shares[1] + shares[2] * shares[2])
        if (count < 3 and shares[2] != 0.0) or (count < 2 and shares[1] != 0.0):
            continue
        for m in range(f):
            direction[m] = (shares[0] * null[0, m] + shares[1] * null[1, m] + shares[2] * null[2, m]) / size
        met = False
        for _ in range(1 if count == 1 else _TURNS):
            met = goes_on(axes, room, target, place, direction, null, count, lines[found])
            if met:
                break
            for m in range(f):
                direction[m] = lines[found, m]
        for r in range(found):
            cosine = 0.0
            for m in range(f):
                cosine += lines[r, m] * lines[found, m]
            met = met and not abs(cosine) > _ALIKE
        found += 1 if met else 0
        if found == len(lines):
            break
    return found


@jit
def _told(axes, room, target, curves, places, count, left):
    """Complete what is known of the place behind the first ones; return how many there are then.

    An isolated one is one more, a place on a curve if the curve is new, where curves cross each that is new. A surface
    remains unknown.
    """
    n, f, place = len(room.x), len(axes.free), places[count]
    null, lines = np.zeros((_MOST_LOST, f)), np.zeros((_MOST_LOST, f))
    weak, rows, size = weakest_at(axes, room, target, null)
    place[n], place[n + 1], place[n + 2] = _ITS_OWN * weak / size, left, -1.0
    lost = 0
    while lost < _MOST_LOST and weak < (_LOST_TOO if lost else _LOST) * size:
        lost += 1
        if lost < _MOST_LOST:
            weak = weakest(room, rows, f, null, float(lost), null[lost])
    if lost == 0:
        return count + 1
    known = piece_through(axes, room, target, curves, place, lines[0], 0.0)
    if lost == 1 and known >= 0:
        return count
    ways = _MOST_LOST if lost == _MOST_LOST else _lines(axes, room, target, place, null, lost, lines)
    ways = _MOST_LOST if ways > 0 and curves.known[ENDS] != 0 else ways
    place[n + 2] = known
    if ways == _MOST_LOST:
        curves.known[STATE] = UNKNOWN
    if ways in (0, _MOST_LOST):
        return count + 1
    first = count
    count += 1 if known >= 0 else 0
    for k in range(ways):
        if lost > 1 and piece_through(axes, room, target, curves, place, lines[k], 0.0) >= 0:
            continue
        if count == len(places):
            curves.known[STATE] = UNKNOWN
            return count
        piece = follow_curve(axes, room, target, curves, place, lines[k])
        if piece >= 0:
            for m in range(n + 2):
                places[count, m] = place[m]
            places[count, n + 2] = piece
            _join(axes, room, target, curves, places, first, piece)
            count += 1
    return max(count, first + 1)


@jit
def _join(axes, room, target, curves, places, count, piece):
    """Join the curve of a piece to those of the first places that it passes."""
    n, anyhow = len(room.x), np.zeros(len(axes.free))
    for i in range(count):
        owner = int(places[i, n + 2])
        if (
            owner >= 0
            and curves.owners[owner] != curves.owners[piece]
            and piece_through(axes, room, target, curves, places[i], anyhow, float(piece)) >= 0
        ):
            known = curves.owners[owner]
            for k in range(curves.known[PIECES]):
                if curves.owners[k] == known:
                    curves.owners[k] = piece


@leaf
def _with_place(axes, room, target, reached, curves, places, count, origin, near):
    """Bring room.x to the target and write it behind the first places if it is none of them; return how many then.

    Args:
        axes: The machine's axes.
        room: Scratch.
        target: (4, 4) tool in the workpiece frame [m].
        reached: What is left at a solution at most [m, rad].
        curves: See `places_beside`.
        places: Likewise.
        count: How many there are.
        origin: (n,) from where a step began: what comes back to it
        near: nearer than that is given up.
    """
    if count == len(places) or (curves.known[ENDS] != 0 and curves.known[STATE] != ISOLATED):
        return count
    left = descended(axes, room, target, places, count, origin, near, reached)
    if not left < reached or is_place(axes, room, target, left, places, count):
        return count
    for m in range(len(room.x)):
        places[count, m] = room.x[m]
    return _told(axes, room, target, curves, places, count, left)


@jit
def _along_valley(axes, room, target, curves, places, count, at, direction, sign):
    """Add the solutions along the valley of a place, where the tool hardly moves, looked for where its floor is lowest.

    Where a pose is beside one of a curve of solutions, some of these are left, far from each other.

    Returns:
        How many places there are then, and whether the valley leads back to where it began.
    """
    n, f = len(room.x), len(axes.free)
    floor, tangent, spare = places[at].copy(), sign * direction, np.empty((1, f))
    height, before, is_lower, is_back = 0.0, 0.0, False, False
    for step in range(_MOST_ALONG):
        put(axes, room, floor, _ALONG, tangent)
        before, height, left = height, max(look(axes, room, target)), math.inf
        for _ in range(_TO_FLOOR):
            if height > _FLOOR * left:
                break
            stepped(axes, room, _ACROSS, 1.0)
            left, height = height, max(look(axes, room, target))
        rows, moved, back = copy_rows(axes, room), 0.0, 0.0
        for m in range(f):
            tangent[m] = room.x[axes.free[m]] - floor[axes.free[m]]
            moved += tangent[m] * tangent[m]
        inverted(room, rows, f, spare, 0.0, tangent)
        ends = not (height < _FLAT and moved > 0.25 * _ALONG * _ALONG)
        ahead = room.x.copy()
        if is_lower and (ends or height > before):
            known = count
            put(axes, room, floor, 0.0, tangent)
            count = _with_place(axes, room, target, ARRIVED, curves, places, count, floor, -1.0)
            for k in range(known, count):
                places[k, n] = -1.0  # has been looked at from here
        is_lower = step == 0 or height < before  # the first one may be next to a solution, too
        for m in range(n):
            floor[m] = ahead[m]
            back = max(back, abs(way_of(axes, m, places[at, m], floor[m])))
        is_back = step > 1 and back < _ALONG
        if ends or is_back:
            break
    return count, is_back


@jit
def _around(axes, room, target, curves, places, count, at):
    """Add the solutions next to an isolated place; return how many there are then."""
    n, f, place = len(room.x), len(axes.free), places[at]
    if places[at, n] >= _ITS_OWN * _WEAK or places[at, n + 2] >= 0.0:
        return count
    null, along = np.empty((2, f)), np.empty(f)
    v, w = null[0], null[1]
    put(axes, room, place, 0.0, v)
    weak, rows, size = weakest_at(axes, room, target, null)
    if weak < _VALLEY * size and places[at, n] >= 0.0:
        is_back = False
        for side in range(2):
            if not is_back:
                count, is_back = _along_valley(axes, room, target, curves, places, count, at, v, 1.0 - 2.0 * side)
        put(axes, room, place, 0.0, v)
        _, rows, size = weakest_at(axes, room, target, null)
    next_weak = weakest(room, rows, f, null, 1.0, w)
    for d in range(4 if next_weak < _CLUSTER * size else (2 if next_weak < _WEAK * size else 1)):
        for m in range(f):
            along[m] = v[m] if d == 0 else (w[m] if d == 1 else _HALF * (v[m] + (2.0 * d - 5.0) * w[m]))
        for step in _AWAY:
            for side in range(2):
                put(axes, room, place, step * (1.0 - 2.0 * side), along)
                count = _with_place(axes, room, target, ARRIVED, curves, places, count, place, _BACK * step)
    is_cluster = next_weak < _CLUSTER * size
    for other in range(at if weak < _VALLEY * size else 0):
        apart = short_way(axes, places[other], place, along)
        if places[other, n] < _ITS_OWN * _VALLEY and apart < _NEIGHBOURS:
            put(axes, room, place, -0.5, along)
            count = _with_place(axes, room, target, ARRIVED, curves, places, count, place, -1.0)
            if is_cluster:
                put(axes, room, place, 1.0, along)
                count = _with_place(axes, room, target, ARRIVED, curves, places, count, place, -1.0)
    if is_cluster:
        curves.known[CLUSTERED] = 1
    return count


@leaf
def places_beside(axes, room, target, x0, values, counts, reached, curves, places, count):
    """Add the solutions that those of poses beside a target lead to, and these to others; return how many there are.

    Args:
        axes: The machine's axes.
        room: Scratch.
        target: (4, 4) tool in the workpiece frame [m].
        x0: (n,) start in SI; held axes have their values.
        values: (K, ·, COLUMNS) joint values of poses beside the target, see `finished`.
        counts: (K,) how many, as forms tell.
        reached: What is left at a solution at most [m, rad].
        curves: Those of the pose known so far; those found are added.
        places: (·, n + 3) out: solutions in SI, whatever the limits, how far around each Newton's steps lead there,
            what is left of the way to the target, and the first piece of the curve that it is on; -1: none. One of each
            curve. Those found before stand there.
        count: How many these are.
    """
    looked_at = count
    for k in range(len(counts)):
        rows = counts[k] if counts[k] >= 0 else UNSURE - counts[k]
        for i in range(rows):
            write_axis_values(axes, x0, values[k, i], room.x)
            count = _with_place(axes, room, target, reached, curves, places, count, x0, -1.0)
    while looked_at < count and (curves.known[ENDS] == 0 or curves.known[STATE] == ISOLATED):
        count = _around(axes, room, target, curves, places, count, looked_at)
        looked_at += 1
    return count
