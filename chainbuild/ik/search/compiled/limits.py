"""The damped search as compiled code: limits, coupled limits, whole turns. See `freedoms.Box` for the same in NumPy."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from chainbuild.ik import rules
from chainbuild.ik.search.compiled.kernels import LOWER, PERIODIC, UPPER, copy_to, jit, leaf

_TURN: Final = 2.0 * math.pi  # rad


@leaf
def turned_inside(problem, n, value):
    """Return the value moved by whole turns to the nearest place inside the limits, or as it is where there is none."""
    lower, upper = problem.limits[LOWER, n], problem.limits[UPPER, n]
    if problem.limits[PERIODIC, n] == 0.0 or (lower <= value <= upper):
        return value
    gap = lower - value if value < lower else upper - value
    moved = value + math.copysign(math.ceil(abs(gap) / _TURN) * _TURN, gap)
    return moved if lower <= moved <= upper else value


@leaf
def turn_inside(problem, y):
    """Move what is outside its limits by whole turns where that helps; return whether anything was outside."""
    outside = False
    for n in range(len(y)):
        if not problem.limits[LOWER, n] <= y[n] <= problem.limits[UPPER, n]:
            y[n] = turned_inside(problem, n, y[n])
            outside = True
    return outside


@leaf
def onto_sums(problem, y):
    """Move y onto each coupled limit it violates, by axes that their own limits leave room to move."""
    lower, upper = problem.limits[LOWER], problem.limits[UPPER]
    for c in range(len(problem.sums)):
        g = problem.sums[c]
        for _ in range(len(y)):
            value, length = 0.0, 0.0
            for n in range(len(y)):
                value += g[n] * y[n]
            gap = min(max(value, g[len(y)]), g[len(y) + 1]) - value
            for n in range(len(y)):
                if (y[n] < upper[n] and gap * g[n] > 0.0) or (y[n] > lower[n] and gap * g[n] < 0.0):
                    length += g[n] * g[n]
            if length == 0.0:
                break
            for n in range(len(y)):
                if (y[n] < upper[n] and gap * g[n] > 0.0) or (y[n] > lower[n] and gap * g[n] < 0.0):
                    y[n] = min(max(y[n] + gap / length * g[n], lower[n]), upper[n])


@leaf
def excess(problem, y):
    """Return by how much y violates its limits, coupled ones included; 0 inside."""
    total, lower, upper = 0.0, problem.limits[LOWER], problem.limits[UPPER]
    for n in range(len(y)):
        total += max(lower[n] - y[n], y[n] - upper[n], 0.0)
    for c in range(len(problem.sums)):
        value = 0.0
        for n in range(len(y)):
            value += problem.sums[c, n] * y[n]
        total += max(problem.sums[c, len(y)] - value, value - problem.sums[c, len(y) + 1], 0.0)
    return total


@jit
def near(problem, y, wanted):
    """Move periodic axes by whole turns as near to `wanted` as all limits allow; return whether any moved."""
    lower, upper = problem.limits[LOWER], problem.limits[UPPER]
    periodic, any_turned = problem.limits[PERIODIC], False
    for n in range(len(y)):
        any_turned |= periodic[n] != 0.0 and abs(wanted[n] - y[n]) > math.pi
    if not any_turned:
        return False
    moved = y.copy()
    for n in range(len(y)):
        if periodic[n] != 0.0:
            turns = np.rint((wanted[n] - y[n]) / _TURN)
            back = -1.0 if turns > 0.0 else 1.0
            while turns != 0.0 and not (lower[n] <= y[n] + turns * _TURN <= upper[n]):
                turns += back
            moved[n] += turns * _TURN
    if len(problem.sums) > 0 and excess(problem, moved) > rules.INSIDE_SLACK:
        return False
    copy_to(y, moved)
    return True
