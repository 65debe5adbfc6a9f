"""Curves of solutions, followed once: which places they pass, and where they come nearest to the start, compiled.

The twin of `core.beside` for curves. A curve is kept as its points, so that a place found later is told from a new one.
"""

from __future__ import annotations

import math
from typing import Any, Final, NamedTuple

import numpy as np

from chainbuild.ik.branches.compiled.axes import TURN, copy_rows, inverted, inverted_again, way_of, weakest
from chainbuild.ik.branches.compiled.constants import FOLLOWED, PIECES, POINTS, STATE, UNKNOWN
from chainbuild.ik.branches.compiled.doubtful.steps import (
    ARRIVED,
    corrected,
    put,
    short_way,
    weakest_at,
)
from chainbuild.ik.branches.compiled.finish import inside_by_turns
from chainbuild.ik.search.compiled.kernels import LOWER, PERIODIC, UPPER, jit, leaf

_FIRST_STEP: Final = 0.05  # rad or m along a curve
_SHORTEST: Final = 1e-4  # a curve that needs shorter steps ends
_BENT: Final = 0.35  # rad that a curve turns in one step: where it turns more, another one may come close
_LARGEST: Final = 0.5  # rad or m of one step
_MOST: Final = 300  # steps along a curve: twice as many as a turn of all axes takes
_ROOM: Final = 0.5  # m or rad beyond a limit: what leads on from there is left
_THERE: Final = 1e-5  # m and rad: as far apart as solutions that count as one
_SHORT: Final = 0.1  # rad or m: what goes on no farther is no curve
# How following a curve ended: where it began, where steps no longer led on, beyond limits or many turns, without room.
_CLOSED: Final = 1
_ENDED: Final = 0
_BEYOND: Final = 2
_FULL: Final = -1
_ALONG: Final = 0.8  # squared cosine of directions that are one where curves cross
_NEARER: Final = 24  # steps along a curve to where it is nearest to the start, or as near as limits permit
_STILL: Final = 1e-12  # rad or m of such a step that ends them
_ASIDE: Final = 0.1  # share of a step by which a curve, which turns by _BENT at most, may leave the chord
_FINEST: Final = 5e-4  # rad or m: a piece of a curve inside the limits that is shorter may be passed over
_HALVES: Final = 16  # halvings of the longest step to there, and to spare


class Curves(NamedTuple):
    """The curves of one pose."""

    points: Any  # (·, n) solutions one after another
    pieces: Any  # (·,) piece of each: a curve has two, one for each way
    owners: Any  # (·,) curve of a piece
    known: Any  # (5,) POINTS, PIECES, STATE, ENDS and CLUSTERED


@leaf
def _share_of(axes, start, end, other, way):
    """Return how far along a piece of a curve another place is, as a share; not a number where it is not near."""
    short_way(axes, start, other, way)
    along, whole, size = 0.0, 0.0, 0.0
    for m in range(len(axes.free)):
        step = end[axes.free[m]] - start[axes.free[m]]
        along, whole, size = along + way[m] * step, whole + step * step, size + way[m] * way[m]
    share = along / whole
    aside = max(size - share * along, 0.0)
    return share if -0.1 < share < 1.1 and aside < 0.09 * whole else math.nan


@leaf
def _passes(axes, room, target, start, end, other, way, spare):
    """Tell whether the piece of a curve between two of its places passes another one."""
    v = spare[0]
    share = _share_of(axes, start, end, other, way)
    if not share > -1.0:
        return False
    for m in range(len(room.x)):
        room.x[m] = start[m] + share * (end[m] - start[m])
    for _ in range(4):
        if not corrected(axes, room, target) < ARRIVED:
            return False
        left = short_way(axes, room.x, other, way)
        along = 0.0
        if left < _THERE:
            return True
        for m in range(len(axes.free)):
            v[m] = end[axes.free[m]] - start[axes.free[m]]
        rows = copy_rows(axes, room)
        inverted(room, rows, len(axes.free), spare, 0.0, v)
        inverted_again(room, len(axes.free), v)
        for m in range(len(axes.free)):
            along += way[m] * v[m]
        for m in range(len(axes.free)):
            room.x[axes.free[m]] += along * v[m]
    return False


@leaf
def _is_along(axes, start, end, line):
    """Tell whether a piece of a curve goes along a unit direction (f,), or no direction counts, all 0."""
    along, whole, size = 0.0, 0.0, 0.0
    for m in range(len(axes.free)):
        step = end[axes.free[m]] - start[axes.free[m]]
        along, whole, size = along + step * line[m], whole + step * step, size + line[m] * line[m]
    return size == 0.0 or along * along > _ALONG * whole


@jit
def piece_through(axes, room, target, curves, place, line, first):
    """Return the piece of a curve, not before the first, that passes a place (n,) along a direction (f,), or -1."""
    way, spare = np.empty(len(axes.free)), np.empty((1, len(axes.free)))
    for i in range(curves.known[POINTS] - 1):
        if (
            curves.pieces[i] >= first
            and curves.pieces[i] == curves.pieces[i + 1]
            and _is_along(axes, curves.points[i], curves.points[i + 1], line)
            and _passes(axes, room, target, curves.points[i], curves.points[i + 1], place, way, spare)
        ):
            return curves.pieces[i]
    return -1


@leaf
def _kept(curves, x, piece):
    """Write a point behind the others; return False where there is no room."""
    n = curves.known[POINTS]
    if n == len(curves.points):
        return False
    for m in range(curves.points.shape[1]):
        curves.points[n, m] = x[m]
    curves.pieces[n] = piece
    curves.known[POINTS] = n + 1
    return True


@leaf
def _beyond(axes, x):
    """Return how far the axis that is farthest beyond its limits is; not above 0 inside them."""
    farthest = -math.inf
    for m in range(axes.each.shape[1]):
        if axes.each[PERIODIC, m] == 0.0:
            farthest = max(farthest, axes.each[LOWER, m] - x[m], x[m] - axes.each[UPPER, m])
    return farthest


@jit
def _followed(axes, room, target, place, direction, sign, curves, piece):
    """Follow a curve from a place; return how that ended.

    Where steps no longer lead on: what is nearly a curve is as good as one for a piece.
    """
    f, n = len(axes.free), len(room.x)
    at, ahead, tangent, turned = place.copy(), place.copy(), sign * direction, direction.copy()
    way, spare, w = np.empty(f), np.empty((1, f)), np.empty(f)
    length, passed, apart = _FIRST_STEP, 0.0, math.inf
    fits = _kept(curves, at, piece)
    for _ in range(_MOST):
        put(axes, room, at, length, tangent)
        bend, aside, size = math.inf, math.inf, 0.0
        if corrected(axes, room, target) < ARRIVED:
            bend, aside = 0.0, 0.0
            for m in range(f):
                turned[m] = room.x[axes.free[m]] - at[axes.free[m]]
                aside += (turned[m] - length * tangent[m]) ** 2
            rows = copy_rows(axes, room)
            inverted(room, rows, f, spare, 0.0, turned)
            inverted_again(room, f, turned)
            for m in range(f):
                bend += (turned[m] - tangent[m]) ** 2
            bend, aside = math.sqrt(bend), math.sqrt(aside)
        if bend > _BENT or aside > _BENT * length:
            length /= 2.0
            if length < _SHORTEST:
                return _ENDED
            continue
        # Towards a crossing of curves the next singular value vanishes: another curve may pass close by instead.
        for m in range(f):
            spare[0, m] = turned[m]
        last, apart = apart, weakest(room, copy_rows(axes, room), f, spare, 1.0, w)
        for m in range(n):
            ahead[m] = room.x[m]
        passed += length
        if passed > 3.0 * length and _passes(axes, room, target, at, ahead, place, way, spare):
            for m in range(n):
                ahead[m] = at[m]
            for m in range(f):
                ahead[axes.free[m]] += way_of(axes, axes.free[m], at[axes.free[m]], place[axes.free[m]])
            return _CLOSED if _kept(curves, ahead, piece) and fits else _FULL
        fits = _kept(curves, ahead, piece) and fits
        if not fits:
            return _FULL
        far, near = _beyond(axes, ahead), _beyond(axes, at)
        if far > _ROOM and far > near:
            return _BEYOND
        crossing = 0.5 * length * apart / (last - apart) if apart < last < math.inf else math.inf
        size = length * (2.0 if bend < 0.3 * _BENT else 1.0)
        length = max(min(size, _LARGEST, crossing), _SHORTEST)
        for m in range(n):
            at[m] = ahead[m]
        for m in range(f):
            tangent[m] = turned[m]
    return _BEYOND


@leaf
def follow_curve(axes, room, target, curves, place, direction):
    """Follow a curve through a place (n,) both ways, behind those known; return its first piece, or -1: it is none.

    What ends on either side after a short way is a solution beside which the pose is nearly kept.
    """
    piece, first = curves.known[PIECES], curves.known[POINTS]
    if piece + 2 > len(curves.owners):
        curves.known[STATE] = UNKNOWN
        return -1
    curves.known[PIECES] = piece + 2
    curves.owners[piece], curves.owners[piece + 1] = piece, piece
    longest, ended, other = 0.0, _ENDED, _ENDED
    for side in range(2):
        if ended != _CLOSED:
            other = ended
            ended = _followed(axes, room, target, place, direction, 1.0 - 2.0 * side, curves, piece + side)
    for i in range(first, curves.known[POINTS]):
        for m in range(curves.points.shape[1]):
            longest = max(longest, abs(curves.points[i, m] - place[m]))
    if ended == _ENDED and other == _ENDED and longest < _SHORT:
        curves.known[PIECES], curves.known[POINTS] = piece, first
        return -1
    full = _FULL in (ended, other)
    curves.known[STATE] = UNKNOWN if full else max(curves.known[STATE], FOLLOWED)
    return piece


@leaf
def _nearer(x, x0, nearest, best):
    """Return the squared distance of a place to the start if it is nearer, and write it, else that of the best one."""
    far = 0.0
    for m in range(len(x)):
        far += (x[m] - x0[m]) ** 2
    if not far < nearest:
        return nearest
    for m in range(len(x)):
        best[m] = x[m]
    return far


@leaf
def _may_pass(axes, start, end, size):
    """Tell whether a step along a curve may have places inside all limits, a share that is every axis's."""
    first, last = 0.0, 1.0
    for m in range(len(start)):
        lower, upper = axes.each[LOWER, m] - _ASIDE * size, axes.each[UPPER, m] + _ASIDE * size
        low, high, turns = min(start[m], end[m]), max(start[m], end[m]), 0.0
        if axes.each[PERIODIC, m] != 0.0 and lower > -math.inf and upper < math.inf:
            turns = TURN * np.ceil((lower - high) / TURN)
        if low + turns > upper or high + turns < lower:
            return False
        if high - low > _ASIDE * size:
            one, other = (
                (lower - turns - start[m]) / (end[m] - start[m]),
                (upper - turns - start[m]) / (end[m] - start[m]),
            )
            first, last = max(first, min(one, other)), min(last, max(one, other))
    return first <= last


@leaf
def _between(axes, room, target, x0, stack, nearest, best):
    """Look for places inside the limits between two of a curve that are outside; return how near the nearest one is.

    Args:
        axes: The machine's axes.
        room: Scratch.
        target: (4, 4) tool in the workpiece frame [m].
        x0: (n,) start in SI.
        stack: (·, 2, n) the two places, then scratch: steps that are still to be halved.
        nearest: Squared distance to x0 of what is known,
        best: (n,) in and out: and where it is.
    """
    n, count = len(x0), 1
    while count > 0:
        count -= 1
        start, end, size = stack[count, 0], stack[count, 1], 0.0
        for m in range(n):
            size = max(size, abs(end[m] - start[m]))
        if size < _FINEST or not _may_pass(axes, start, end, size) or count + 2 > len(stack):
            continue
        for m in range(n):
            room.x[m] = 0.5 * (start[m] + end[m])
        if not corrected(axes, room, target) < ARRIVED:
            continue
        for m in range(n):
            stack[count + 1, 1, m], stack[count + 1, 0, m], end[m] = end[m], room.x[m], room.x[m]
        count += 2
        if inside_by_turns(axes, room.x, x0) > 0:
            nearest = _nearer(room.x, x0, nearest, best)
    return nearest


@jit
def nearest_on_curve(axes, room, target, x0, curves, owner, best):
    """Write the place of a curve inside all limits that is nearest to the start; return whether there is one.

    Args:
        axes: The machine's axes.
        room: Scratch.
        target: (4, 4) tool in the workpiece frame [m].
        x0: (n,) start in SI.
        curves: The curves.
        owner: Which of them.
        best: (n,) out [SI].
    """
    nearest, spare, x = math.inf, np.empty((1, len(axes.free))), room.x
    v, was_inside, share, stack = spare[0], True, 1.0, np.empty((_HALVES, 2, len(x0)))
    for i in range(curves.known[POINTS]):
        if curves.owners[curves.pieces[i]] == owner:
            for m in range(len(x)):
                x[m] = curves.points[i, m]
            is_inside = inside_by_turns(axes, x, x0) > 0
            if is_inside:
                nearest = _nearer(x, x0, nearest, best)
            if not (was_inside or is_inside) and curves.pieces[i - 1] == curves.pieces[i]:
                for m in range(len(x)):
                    stack[0, 0, m], stack[0, 1, m] = curves.points[i - 1, m], curves.points[i, m]
                nearest = _between(axes, room, target, x0, stack, nearest, best)
            was_inside = is_inside
        else:
            was_inside = True
    for _ in range(_NEARER if nearest < math.inf else 0):
        put(axes, room, best, 0.0, v)
        weakest_at(axes, room, target, spare)
        along = 0.0
        for m in range(len(axes.free)):
            along += (x0[axes.free[m]] - best[axes.free[m]]) * v[m]
        if abs(share * along) < _STILL:
            break
        put(axes, room, best, share * max(-_LARGEST, min(_LARGEST, along)), v)
        before = nearest
        if corrected(axes, room, target) < ARRIVED and inside_by_turns(axes, x, x0) > 0:
            nearest = _nearer(x, x0, nearest, best)
        if not nearest < before:
            share *= 0.5  # towards a limit
    return nearest < math.inf
