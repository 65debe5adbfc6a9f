"""From joint values to branches, compiled: axis values, linear axes, proof by forward kinematics, whole turns, limits.

The same steps as `core.axis_values` and `core.branches.collect`. What those treat case by case — an axis on its limit
but for rounding, a solution that Newton steps do not confirm — ends here with the answer that the pose is doubtful.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from chainbuild.ik.branches.compiled.axes import (
    COLUMNS_OF,
    FACTORS,
    FLOOR,
    MOVERS,
    ROWS_OF,
    SLACK,
    TOGETHER,
    TURN,
    copy_rows,
    look,
    way_of,
    weakest,
)
from chainbuild.ik.branches.compiled.constants import ALONG, TOLD
from chainbuild.ik.branches.core.branches import (
    BETWEEN_BRANCHES,
    CLOSE_BRANCHES,
    POLISH_FROM,
    POLISH_STEPS,
    POLISH_TO,
    SAME_BRANCH,
)
from chainbuild.ik.rules import HALF_TURN_NUDGE, HALF_TURN_TOWARDS
from chainbuild.ik.search.compiled.kernels import LOWER, PERIODIC, UPPER, inlined, leaf
from chainbuild.ik.search.compiled.least_squares import damped_step, solve_in_place
from chainbuild.tolerances import IK_POSITION_M, IK_ROTATION_RAD, LIMIT_SLACK

_LINEAR_STEPS: Final = 2  # the second one only corrects the last digits
_DEPENDENT: Final = 1e-6  # share of their product: a determinant below it means slides turned into one plane
_KEPT: Final = 1e-9  # sine of half an angle: a free axis so near to its start has its value
_STILL: Final = 1e-7  # m and rad: what the tool moves along a direction that leaves it where it is
_MOST_MOVED: Final = 0.999  # share of the largest motion that is as large but for rounding
_SEVERAL: Final = 1e-3  # m and rad by unit: what moves the tool less is a second direction that is free


@leaf
def _place_linear(axes, room, target):
    """Move the linear axes to bring the tip to the target's position; return False where they lie in one plane."""
    J, error, H, g, slides = room.J, room.error, room.H, room.g, axes.linear
    for _ in range(_LINEAR_STEPS):
        look(axes, room, target)
        lost = 1.0  # the squares of their lengths by that of the volume they span
        for i in range(len(slides)):
            for j in range(i + 1):
                H[i, j] = 0.0
                for r in range(3):
                    H[i, j] += J[r, slides[i]] * J[r, slides[j]]
            lost *= H[i, i]
            g[i] = 0.0
            for r in range(3):
                g[i] += J[r, slides[i]] * error[r]
        solve_in_place(H, g, len(slides))
        for i in range(len(slides)):
            lost *= H[i, i]
            room.x[slides[i]] += g[i]
        if not 0.0 < _DEPENDENT * _DEPENDENT * lost < 1.0:  # 0: one of them does not move the tip at all
            return False
    return True


@inlined
def _polished(axes, room, target):
    """Improve room.x by Newton steps; return distance, angle and steps, or an infinite distance for no solution."""
    distance, angle = look(axes, room, target)
    steps = 0
    if not max(distance, angle) <= POLISH_TO:  # not a number among them
        return math.inf, angle, 0
    while max(distance, angle) >= POLISH_FROM and steps < POLISH_STEPS:
        rows = copy_rows(axes, room)
        damped_step(rows, room.Jf, room.error, room.H, room.g, room.step, FLOOR)
        for m in range(len(axes.free)):
            room.x[axes.free[m]] += room.step[m]
        distance, angle = look(axes, room, target)
        steps += 1
    return distance, angle, steps


@inlined
def inside_by_turns(axes, x, x0):
    """Move periodic axes by whole turns into their limits, near to x0: 1 inside, 0 outside, -1 only just inside."""
    inside = 1
    for n in range(len(x)):
        lower, upper, slack, value = axes.each[LOWER, n], axes.each[UPPER, n], axes.each[SLACK, n], x[n]
        wanted = x0[n] + math.copysign(HALF_TURN_NUDGE, HALF_TURN_TOWARDS - x0[n])
        settled = lower <= value <= upper and abs(wanted - value) <= 0.5 * TURN  # most are
        if not settled and axes.each[PERIODIC, n] != 0.0:
            low, high = (lower - slack - value) / TURN, (upper + slack - value) / TURN
            turns = min(max(np.rint((wanted - value) / TURN), np.ceil(low)), np.floor(high))
            value += TURN * turns
            x[n] = value
        if not lower - slack <= value <= upper + slack:
            return 0
        if not lower <= value <= upper:
            inside = -1
    return min(inside, _keeps_sums(axes, x))


@inlined
def _keeps_sums(axes, x):
    """Tell whether x keeps the limits on sums of axes: 1, 0, or -1 only just, or where another whole turn might."""
    for i in range(len(axes.sums)):
        total = 0.0
        for m in range(len(x)):
            total += axes.sums[i, m] * x[m]
        beyond = max(axes.sums[i, len(x)] - total, total - axes.sums[i, len(x) + 1])
        if 0.0 < beyond <= LIMIT_SLACK:
            return -1
        if not beyond <= 0.0:
            for n in range(len(x)):
                if axes.each[TOGETHER, n] != 0.0 and axes.each[PERIODIC, n] != 0.0:
                    slack = axes.each[SLACK, n]
                    low, high = axes.each[LOWER, n] - slack, axes.each[UPPER, n] + slack
                    if low <= x[n] - TURN or x[n] + TURN <= high:
                        return -1
            return 0
    return 1


@leaf
def _goes_along(axes, room, target, along):
    """Write the unit direction in which a solution goes on; return whether there is that one only.

    The first of the axes that move most goes forward.
    """
    look(axes, room, target)
    rows, n, null, most = copy_rows(axes, room), len(axes.free), room.null, 0.0
    v = null[0]
    weakest(room, rows, n, null, 0.0, v)
    for m in range(n):
        most = max(most, abs(v[m]))
    for m in range(n):
        if abs(v[m]) > _MOST_MOVED * most:
            most = math.inf
            sign = math.copysign(1.0, v[m])
            for k in range(n):
                v[k] *= sign
    rest = 0.0
    for r in range(rows):
        total = 0.0
        for m in range(n):
            total += room.Jf[r, m] * v[m]
        rest = max(rest, abs(total))
    for m in range(len(along)):
        along[m] = 0.0
    for m in range(n):
        along[axes.free[m]] = v[m]
    return rest < _STILL and weakest(room, rows, n, null, 1.0, null[1]) > _SEVERAL


@inlined
def finished(axes, room, target, x0, values, count, found, left, along):
    """Write the branches among joint values, nearest to x0 first.

    Args:
        axes: The machine's axes.
        room: Scratch.
        target: (4, 4) tool in the workpiece frame [m].
        x0: (n,) start in SI; held axes have their values.
        values: (·, COLUMNS) joint values in the order of the screws, which of them is free, and which rows are of one
            family; -1: none. Without a free one it is on a curve along which several joints move.
        count: How many rows of them.
        found: (·, n) out: axis values, mm and degrees.
        left: (·, TOLD) out: distance, angle, steps, squared distance to x0, free axis, family; -1: none, ALONG: no axis
            is free, but it is on a curve.
        along: (·, n) out: unit direction in which such a solution goes on.

    Returns:
        How many branches, and whether no row was left in doubt.
    """
    kept = 0 * count
    for i in range(count):
        x, loose = room.x, int(values[i, 6])
        axis = axes.joints[MOVERS, loose] if loose >= 0 else (ALONG if values[i, 7] >= 0.0 else -1)
        write_axis_values(axes, x0, values[i], x)
        if loose >= 0 and abs(math.sin(0.5 * (x[axis] - x0[axis]))) < _KEPT:
            x[axis] = x0[axis]  # without what the form rounded
        if len(axes.linear) and not _place_linear(axes, room, target):
            return 0, False
        distance, angle, steps = _polished(axes, room, target)
        if not math.isfinite(distance):
            continue
        if not (distance <= IK_POSITION_M and angle <= IK_ROTATION_RAD):
            return 0, False
        side = inside_by_turns(axes, x, x0)
        if side < 0 or (side == 0 and axis != -1):
            return 0, False
        if side == 0:
            continue
        if axis != -1 and not _goes_along(axes, room, target, along[kept]):
            return 0, False
        known = _known(axes, room, target, found, left, kept, axis)
        if known < 0:
            return 0, False
        if known == 0:
            _sort_in(axes, x0, x, (distance, angle, steps, axis, values[i, 7]), found, left, along, kept)
            kept += 1
    return _one_of_each(found, left, along, kept), True


@leaf
def _one_of_each(found, left, along, kept):
    """Leave of every family the branch nearest to x0; return how many branches are left."""
    n = found.shape[1]
    count = 0
    for i in range(kept):
        known = False
        for k in range(count):
            known |= left[i, 5] >= 0.0 and left[k, 5] == left[i, 5]
        if known:
            continue
        if count < i:
            for m in range(n):
                found[count, m], along[count, m] = found[i, m], along[i, m]
            for m in range(TOLD):
                left[count, m] = left[i, m]
        count += 1
    return count


@inlined
def write_axis_values(axes, x0, values, x):
    """Write the axis values of joint values."""
    n = len(x0)
    for m in range(n):
        x[m] = x0[m]
    c = len(axes.back)
    for r in range(c):
        value = -axes.back[r, c + n]
        for m in range(n):
            value -= axes.back[r, c + m] * x0[m]
        for m in range(c):
            value += axes.back[r, m] * values[axes.joints[ROWS_OF, m]]
        x[axes.joints[COLUMNS_OF, r]] = value


@inlined
def _sort_in(axes, x0, x, row, found, left, along, kept):
    """Write a branch to where its distance to x0 puts it among those before; its direction stands behind them."""
    n, far = len(x0), 0.0
    for m in range(n):
        far += (x[m] - x0[m]) ** 2
    at = kept
    while at > 0 and left[at - 1, 3] > far:
        at -= 1
    for k in range(kept, at, -1):
        for m in range(n):
            found[k, m] = found[k - 1, m]
            along[k, m], along[k - 1, m] = along[k - 1, m], along[k, m]
        for m in range(TOLD):
            left[k, m] = left[k - 1, m]
    for m in range(n):
        found[at, m] = x[m] / axes.each[FACTORS, m]
    left[at, 0], left[at, 1], left[at, 2] = row[0], row[1], row[2]
    left[at, 3], left[at, 4], left[at, 5] = far, row[3], row[4]


@inlined
def _known(axes, room, target, found, left, kept, axis):
    """Tell whether room.x is a branch that is known: 1, 0, or -1 where it lies in the middle of what lost its digits.

    Two that are close to each other are one where the place between them is as good.
    """
    x = room.x
    for i in range(kept):
        apart = 0.0
        for m in range(len(x)):
            apart = max(apart, abs(way_of(axes, m, found[i, m] * axes.each[FACTORS, m], x[m])))
            if apart >= CLOSE_BRANCHES:
                break
        if apart < SAME_BRANCH:
            return 1
        if apart < CLOSE_BRANCHES:
            if axis != -1 or left[i, 4] != -1.0:
                return -1
            for m in range(len(x)):
                x[m] -= 0.5 * way_of(axes, m, found[i, m] * axes.each[FACTORS, m], x[m])
            distance, angle = look(axes, room, target)
            if max(distance, angle) < BETWEEN_BRANCHES:
                return 1
            for m in range(len(x)):
                x[m] += way_of(axes, m, found[i, m] * axes.each[FACTORS, m], x[m])
    return 0
