"""A machine's axes as arrays, how far they miss a pose, and how they may move without the tool, compiled."""

from __future__ import annotations

import math
from typing import Any, Final, NamedTuple

import numpy as np

from chainbuild.ik.search.compiled.kernels import PERIODIC, inlined, jit, leaf, pose_and_jacobian, tool_error
from chainbuild.ik.search.compiled.least_squares import solve_again, solve_in_place

TURN: Final = 2.0 * math.pi  # a whole turn
FLOOR: Final = 1e-14  # damping that keeps the factorisation alive at singular points
_ITERATIONS: Final = 4  # inverse ones, each of which gains the squared ratio of two singular values


# Rows of `Axes.each`, behind those of limits.
SLACK: Final = 3
FACTORS: Final = 4
TOGETHER: Final = 5
# Rows of `Axes.joints`.
ROWS_OF: Final = 0
COLUMNS_OF: Final = 1
MOVERS: Final = 2


class Axes(NamedTuple):
    """A machine's axes as few arrays, see `forms._packed`; flags are 0 or 1, columns and rows are indices.

    Handing over an array takes a compiler as long as seven numbers: what is used together stands together.
    """

    fixed: Any  # (k + 1, 3, 4)
    prismatic: Any  # (k,)
    A: Any  # (k, n)
    b: Any  # (k,)
    # (c, c + n + 1) from joint values to axes, what the other axes and the constants of the map take from these
    back: Any
    # (6, n) limits, whether whole turns lead to the same pose, how far beyond them still counts, mm and degrees to SI,
    # whether an axis takes part in limits on sums
    each: Any
    sums: Any  # (s, n + 2) limits on sums of axes, mm or degrees by SI, the lower and the upper one
    # (3, c) which of the joint values determine axes, which axes these are, which axis moves a joint most
    joints: Any
    linear: Any  # (0 or 3,) axes that place the TCP after the others are known
    free: Any  # (f,)
    axis: Any  # tool axis whose direction is the task, or -1


class FinishRoom(NamedTuple):
    """Scratch of one pose."""

    T: Any  # (3, 4)
    J: Any  # (6, n)
    error: Any  # (6,)
    small: Any  # (9,)
    turns: Any  # (k, 2) value of each joint, or its cosine and sine
    Jf: Any  # (6, f) of the free axes, the rows of the task first
    H: Any
    g: Any
    step: Any
    x: Any  # (n,)
    null: Any  # (2, f) directions of the free axes


@jit
def axes_of(data, sizes):
    """Return views of axes packed in two arrays; sizes: k, n, c, linear, f, axis, s, where parts end, then indices."""
    k, n, c, count, f, sums, e = sizes[0], sizes[1], sizes[2], sizes[3], sizes[4], sizes[6], sizes[7:14]
    index = sizes[14:]
    return Axes(
        data[: e[0]].reshape((k + 1, 3, 4)), data[e[0] : e[1]], data[e[1] : e[2]].reshape((k, n)), data[e[2] : e[3]],
        data[e[3] : e[4]].reshape((c, c + n + 1)), data[e[4] : e[5]].reshape((6, n)),
        data[e[5] : e[6]].reshape((sums, n + 2)), index[: 3 * c].reshape((3, c)),
        index[3 * c : 3 * c + count], index[3 * c + count : 3 * c + count + f], sizes[5],
    )  # fmt: skip


@jit
def finish_room(axes):
    """Return the scratch for some axes."""
    n, f = axes.each.shape[1], len(axes.free)
    size = max(f, 6)
    return FinishRoom(
        np.empty((3, 4)), np.empty((6, n)), np.empty(6), np.empty(9), np.empty((len(axes.b), 2)), np.empty((6, f)),
        np.empty((size, size)), np.empty(size), np.empty(f), np.empty(n), np.empty((2, f)),
    )  # fmt: skip


@leaf
def look(axes, room, target):
    """Write pose, Jacobian and remaining motion to the target at room.x; return its distance and angle."""
    pose_and_jacobian(axes.fixed, axes.prismatic, axes.A, axes.b, room.x, room.T, room.J, room.turns)
    tool_error(room.T, target, axes.axis, room.error, room.small)
    e = room.error
    return (
        math.sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]),
        math.sqrt(e[3] * e[3] + e[4] * e[4] + e[5] * e[5]),
    )


@inlined
def way_of(axes, m, start, end):
    """Return how far an axis is from one value to another, but for whole turns that lead to the same pose."""
    way = end - start
    return way - TURN * np.rint(way / TURN) if axes.each[PERIODIC, m] != 0.0 else way


@leaf
def copy_rows(axes, room):
    """Copy the rows of the task and the columns of the free axes of the Jacobian; return how many rows."""
    rows = 0
    for r in range(6):
        if axes.axis < 0 or r != 3 + axes.axis:
            room.error[rows] = room.error[r]
            for m in range(len(axes.free)):
                room.Jf[rows, m] = room.J[r, axes.free[m]]
            rows += 1
    return rows


# Counts that are handed over are no integers: numba compiles a function anew for each integer that is written out.
@leaf
def inverted(room, rows, n, others, count, v):
    """Iterate a unit direction (n,) once towards the weakest but for the first of others; return how weak it is."""
    for i in range(n):
        for j in range(i + 1):
            total = 0.0
            for r in range(rows):
                total += room.Jf[r, i] * room.Jf[r, j]
            for r in range(int(count)):
                total += others[r, i] * others[r, j]
            room.H[i, j] = total
        room.H[i, i] += FLOOR
        room.g[i] = v[i]
    solve_in_place(room.H, room.g, n)
    return _unit_of(room, n, v)


@leaf
def inverted_again(room, n, v):
    """Iterate once more towards the weakest direction, after `inverted`; return how weak it is."""
    for i in range(n):
        room.g[i] = v[i]
    solve_again(room.H, room.g, n)
    return _unit_of(room, n, v)


@leaf
def _unit_of(room, n, v):
    """Write the unit direction of room.g; return the singular value that its length tells."""
    size = 0.0
    for i in range(n):
        size += room.g[i] * room.g[i]
    size = math.sqrt(size)
    for i in range(n):
        v[i] = room.g[i] / size
    return 1.0 / math.sqrt(size)


@leaf
def weakest(room, rows, n, others, count, v):
    """Write the unit direction (n,) that moves the tool least but for the first of others (·, n); return how much."""
    for m in range(n):
        v[m] = 1.0 + 0.3 * m
        for r in range(int(count)):
            v[m] -= others[r, m]
    weak = inverted(room, rows, n, others, count, v)
    for _ in range(_ITERATIONS - 1):
        weak = inverted_again(room, n, v)
    return weak
