"""Damped Newton steps to solutions that may be singular, and the directions in which these are, compiled."""

from __future__ import annotations

import math
from typing import Final

from chainbuild.ik.branches.compiled.axes import FLOOR, copy_rows, look, way_of, weakest
from chainbuild.ik.search.compiled.kernels import leaf
from chainbuild.ik.search.compiled.least_squares import damped_step

ARRIVED: Final = 1e-11  # m and rad: a place on a curve, or an isolated one: along a valley much is nearly a solution
_LONGEST: Final = 0.8  # rad or m of one step
_TRIED: Final = 1e-2  # rad or m along a lost direction: there the residual of an isolated solution is far from rounding
_CORRECTIONS: Final = 24  # to a curve that is followed
_BROUGHT_BACK: Final = 8  # those after which a step has come to a curve, for which three are enough, or not


@leaf
def stepped(axes, room, damping, factor):
    """Move room.x by a damped Newton step of its Jacobian and remaining motion, times a factor."""
    rows, longest = copy_rows(axes, room), _LONGEST
    damped_step(rows, room.Jf, room.error, room.H, room.g, room.step, damping)
    for m in range(len(axes.free)):
        longest = max(longest, abs(room.step[m]))
    for m in range(len(axes.free)):
        room.x[axes.free[m]] += room.step[m] * (factor * _LONGEST / longest)


@leaf
def weakest_at(axes, room, target, others):
    """Write the unit direction (f,) that moves the tool least at room.x to the first row of others.

    Returns how much it moves the tool, how many rows the task has, and the size of the Jacobian.
    """
    look(axes, room, target)
    rows, size = copy_rows(axes, room), 0.0
    for r in range(rows):
        for m in range(len(axes.free)):
            size = max(size, abs(room.Jf[r, m]))
    return weakest(room, rows, len(axes.free), others, 0.0, others[0]), rows, size


@leaf
def put(axes, room, place, step, direction):
    """Write the place a step along a direction (f,) of the free axes to room.x."""
    for m in range(len(room.x)):
        room.x[m] = place[m]
    for m in range(len(axes.free)):
        room.x[axes.free[m]] += step * direction[m]


@leaf
def short_way(axes, start, end, way):
    """Write the way (f,) of the free axes between two places, by whole turns as short as possible; return how long."""
    longest = 0.0
    for m in range(len(axes.free)):
        way[m] = way_of(axes, axes.free[m], start[axes.free[m]], end[axes.free[m]])
        longest = max(longest, abs(way[m]))
    return longest


@leaf
def corrected(axes, room, target):
    """Bring room.x back to the curve of solutions nearby, along which it stays; return what is left."""
    left = math.inf
    for _ in range(_CORRECTIONS):
        left = max(look(axes, room, target))
        if not left >= ARRIVED:
            break
        stepped(axes, room, left * left + FLOOR, 1.0)
    return left


@leaf
def goes_on(axes, room, target, place, direction, null, count, line):
    """Write the unit direction in which solutions go on beside a direction; return whether there is one.

    A step is brought back nearly across a curve, on either side, by steps damped by what is left. If there is none, the
    direction leads towards where these have brought it.

    Args:
        axes: The machine's axes.
        room: Scratch.
        target: (4, 4) tool in the workpiece frame [m].
        place: (n,) the solution.
        direction: (f,) unit direction of the step.
        null: (·, f) directions at right angles that do not move the tool,
        count: and how many.
        line: (f,) out: among these.
    """
    f = len(axes.free)
    longest, secant = 0.0, 0.0
    for m in range(f):
        line[m] = 0.0
    for side in range(2):
        sign = 1.0 - 2.0 * side
        put(axes, room, place, sign * _TRIED, direction)
        left, way = math.inf, math.inf
        for _ in range(_BROUGHT_BACK):
            left, way = max(look(axes, room, target)), 0.0
            for m in range(f):
                way += (room.x[axes.free[m]] - place[axes.free[m]]) ** 2
            if not left >= ARRIVED or way < 0.25 * _TRIED * _TRIED:
                break
            stepped(axes, room, left + FLOOR, 1.0)
        longest = max(longest, math.sqrt(way) if left < ARRIVED else 0.0)
        for r in range(count):
            along = 0.0
            for m in range(f):
                along += null[r, m] * (room.x[axes.free[m]] - place[axes.free[m]])
            for m in range(f):
                line[m] += sign * along * null[r, m]
    for m in range(f):
        secant += line[m] * line[m]
    secant = math.sqrt(secant)
    for m in range(f):
        line[m] /= secant if secant > 0.0 else 1.0
    return longest >= 0.5 * _TRIED and secant >= 0.4 * _TRIED
