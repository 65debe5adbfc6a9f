"""The damped search as compiled code: the same steps as the plain path, on arrays.

Nothing here checks its input, and nothing here is called from Python: `entries.py` holds the entry points.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final, NamedTuple

import numba
import numpy as np

from chainbuild.ik.search.compiled.inner import INNER, LEAF

FAST: Final[Mapping[str, Any]] = {"error_model": "numpy", "fastmath": {"contract", "reassoc", "nsz", "arcp"}}
# Functions that make arrays, return some, or are returned some. Without saying so, a function takes over from the first
# one that calls it whether it is put into its callers.
jit: Final[Any] = numba.njit(forceinline=False, **INNER, **FAST)
# The others count no references, which would take as long as kinematics: who calls them holds the arrays. An array that
# such a function is returned would never be freed.
leaf: Final[Any] = numba.njit(forceinline=False, **LEAF, **FAST)
# Likewise, put into their callers: handing over a machine as many arrays takes longer than what is done with it.
inlined: Final[Any] = numba.njit(forceinline=True, **LEAF, **FAST)

_SMALL: Final = 1e-4  # squared sine of a turn: below, three terms of a series are exact but for rounding

# Rows of limits.
LOWER: Final = 0
UPPER: Final = 1
PERIODIC: Final = 2


class Arrays(NamedTuple):
    """A problem as arrays; the names are those of `Product`, `Box`, `Starts` and `Problem`. Flags are 0 or 1.

    Handing over an array takes a compiler as long as seven numbers: what is used together stands together.
    """

    fixed: Any  # (k + 1, 3, 4)
    prismatic: Any  # (k,)
    A: Any  # (k, n) by the free axes
    b: Any  # (k,) with the held axes
    limits: Any  # (3, n) lower and upper limits, whether whole turns lead to the same pose
    sums: Any  # (c, n + 2) coupled limits, each with the lower and the upper one
    weights: Any  # (6,)
    points: Any  # (count, n)
    features: Any  # (12, count)
    scale: Any  # (12,)
    arm: Any  # (2, 4, 4) before and after
    arm_length: Any  # float, infinite where nothing is known
    turned_values: Any  # (points, n), none where there are no turned starts
    turned_maps: Any  # (points, n + 2, 12)
    turned: Any  # (2, 4, 4) before and after
    turned_signs: Any  # (2,)
    turned_rows: Any  # (8, points), single precision; the last are offsets and edges
    turned_scale: Any  # float
    turned_first: Any  # int
    turned_last: Any  # int
    reach: Any  # float, infinite where it does not count
    axis: Any  # int
    shown_axis: Any  # int
    rows: Any  # how many weights are not 0
    weighted: Any  # whether any weight is not 1


class Work(NamedTuple):
    """Scratch of one search."""

    T: Any  # (3, 4) pose of the tool in the workpiece frame
    J: Any  # (6, n), the rows of the task first
    error: Any  # (6,), the rows of the task first
    H: Any  # normal matrix
    g: Any  # right-hand side
    step: Any  # (n,)
    small: Any  # (9,)
    turns: Any  # (k, 2) value of each joint, or its cosine and sine
    features: Any  # (12,)
    W: Any  # (3, 4)
    seen: Any  # (13,) lookup data of turned starts, and the azimuth
    key: Any  # (6,) the same in single precision


@jit
def unpack(data, rows, sizes):
    """Return views of a problem packed in two arrays: passing two costs less than passing twenty.

    sizes: k, n, coupled limits, starts, axis, shown axis, rows, weighted, turned starts, their first and last axis,
    then where each part ends.
    """
    k, n, c, count, turned, e = sizes[0], sizes[1], sizes[2], sizes[3], sizes[8], sizes[11:]
    return Arrays(
        data[: e[0]].reshape((k + 1, 3, 4)), data[e[0] : e[1]], data[e[1] : e[2]].reshape((k, n)), data[e[2] : e[3]],
        data[e[3] : e[4]].reshape((3, n)), data[e[4] : e[5]].reshape((c, n + 2)), data[e[5] : e[6]],
        data[e[6] : e[7]].reshape((count, n)), data[e[7] : e[8]].reshape((12, count)), data[e[8] : e[9]],
        data[e[9] : e[10]].reshape((2, 4, 4)), data[e[10]],
        data[e[11] : e[12]].reshape((turned, n)), data[e[12] : e[13]].reshape((turned, n + 2, 12)),
        data[e[13] : e[14]].reshape((2, 4, 4)), data[e[14] : e[15]],
        rows, data[e[15]], sizes[9], sizes[10], data[e[16]], sizes[4], sizes[5], sizes[6], sizes[7],
    )  # fmt: skip


@jit
def work_of(k, n):
    """Return the scratch for k joints and n axes."""
    size = max(n, 6)
    return Work(
        np.empty((3, 4)), np.empty((6, n)), np.empty(6), np.empty((size, size)),
        np.empty(size), np.empty(n), np.empty(9), np.empty((k, 2)), np.empty(12),
        np.empty((3, 4)), np.empty(13), np.empty(6, np.float32),
    )  # fmt: skip


@leaf
def copy_to(to, values):
    """Write values (n,) to another array; a loop, since numba compiles a text of its error for `to[:] = values`."""
    for n in range(len(to)):
        to[n] = values[n]


@leaf
def _about_z(cosine, sine, v):
    """Return v (3,) turned about z."""
    return cosine * v[0] - sine * v[1], sine * v[0] + cosine * v[1], v[2]


@leaf
def _from_frame(F, v, point):
    """Return a direction, or a point where `point` is 1, by the motion F (3, 4)."""
    return (
        F[0, 0] * v[0] + F[0, 1] * v[1] + F[0, 2] * v[2] + point * F[0, 3],
        F[1, 0] * v[0] + F[1, 1] * v[1] + F[1, 2] * v[2] + point * F[1, 3],
        F[2, 0] * v[0] + F[2, 1] * v[1] + F[2, 2] * v[2] + point * F[2, 3],
    )


@leaf
def pose_and_jacobian(fixed, prismatic, A, b, y, T, J, turns):
    """Write the pose T (3, 4) and the Jacobian J (6, n) in the tool frame; walks from the tool to the workpiece.

    The columns of the pose are tuples, which need no memory; sines come first, since none of them waits for another.
    """
    k, n = A.shape
    for i in range(k):
        u = b[i]
        for m in range(n):
            u += A[i, m] * y[m]
        if prismatic[i] != 0.0:
            turns[i, 0] = u
        else:
            turns[i, 0], turns[i, 1] = math.cos(u), math.sin(u)
    for r in range(6):
        for m in range(n):
            J[r, m] = 0.0
    F = fixed[k]
    X, Y, Z = (F[0, 0], F[1, 0], F[2, 0]), (F[0, 1], F[1, 1], F[2, 1]), (F[0, 2], F[1, 2], F[2, 2])
    tip = F[0, 3], F[1, 3], F[2, 3]
    for i in range(k - 1, -1, -1):
        shift, turn = (X[2], Y[2], Z[2]), (0.0, 0.0, 0.0)
        if prismatic[i] != 0.0:
            tip = tip[0], tip[1], tip[2] + turns[i, 0]
        else:
            cosine, sine = turns[i, 0], turns[i, 1]
            X, Y, Z = _about_z(cosine, sine, X), _about_z(cosine, sine, Y), _about_z(cosine, sine, Z)
            tip, turn = _about_z(cosine, sine, tip), shift
            shift = (
                tip[0] * X[1] - tip[1] * X[0],
                tip[0] * Y[1] - tip[1] * Y[0],
                tip[0] * Z[1] - tip[1] * Z[0],
            )
        for m in range(n):
            slope = A[i, m]
            if slope != 0.0:
                J[0, m] += slope * shift[0]
                J[1, m] += slope * shift[1]
                J[2, m] += slope * shift[2]
                J[3, m] += slope * turn[0]
                J[4, m] += slope * turn[1]
                J[5, m] += slope * turn[2]
        F = fixed[i]
        X, Y, Z = _from_frame(F, X, 0.0), _from_frame(F, Y, 0.0), _from_frame(F, Z, 0.0)
        tip = _from_frame(F, tip, 1.0)
    T[0, 0], T[0, 1], T[0, 2], T[0, 3] = X[0], Y[0], Z[0], tip[0]
    T[1, 0], T[1, 1], T[1, 2], T[1, 3] = X[1], Y[1], Z[1], tip[1]
    T[2, 0], T[2, 1], T[2, 2], T[2, 3] = X[2], Y[2], Z[2], tip[2]


@leaf
def _between(T, target):
    """Return the elements of RᵀS (9,), the turn from tool to target in the tool frame, row by row."""
    X, Y, Z = (T[0, 0], T[1, 0], T[2, 0]), (T[0, 1], T[1, 1], T[2, 1]), (T[0, 2], T[1, 2], T[2, 2])
    U = target[0, 0], target[1, 0], target[2, 0]
    V = target[0, 1], target[1, 1], target[2, 1]
    W = target[0, 2], target[1, 2], target[2, 2]
    return (
        X[0] * U[0] + X[1] * U[1] + X[2] * U[2],
        X[0] * V[0] + X[1] * V[1] + X[2] * V[2],
        X[0] * W[0] + X[1] * W[1] + X[2] * W[2],
        Y[0] * U[0] + Y[1] * U[1] + Y[2] * U[2],
        Y[0] * V[0] + Y[1] * V[1] + Y[2] * V[2],
        Y[0] * W[0] + Y[1] * W[1] + Y[2] * W[2],
        Z[0] * U[0] + Z[1] * U[1] + Z[2] * U[2],
        Z[0] * V[0] + Z[1] * V[1] + Z[2] * V[2],
        Z[0] * W[0] + Z[1] * W[1] + Z[2] * W[2],
    )


@leaf
def rotation_vector(T, target, error, M):
    """Write the rotation vector of the turn from tool to target in the tool frame to error[3:6]."""
    turn = _between(T, target)
    x, y, z = turn[7] - turn[5], turn[2] - turn[6], turn[3] - turn[1]
    square = 0.25 * (x * x + y * y + z * z)
    cosine = 0.5 * (turn[0] + turn[4] + turn[8] - 1.0)
    if cosine > 0.0 and square < _SMALL:
        # The arcsine by the sine as a series: what is left out is less than rounding.
        scale = 0.5 + square * (1.0 / 12.0 + square * (3.0 / 80.0 + square * (5.0 / 224.0)))
        error[3], error[4], error[5] = scale * x, scale * y, scale * z
        return
    sine = math.sqrt(square)
    angle = math.atan2(sine, cosine)
    if cosine > 0.0 or sine > 1e-3:
        scale = 0.5 * angle / sine
        error[3], error[4], error[5] = scale * x, scale * y, scale * z
        return
    # Near half a turn the differences above vanish; the axis is read off the symmetric part, at its largest component.
    for i in range(9):
        M[i] = turn[i]
    a = 0
    if M[4] > M[0]:
        a = 1
    if M[8] > M[4 * a]:
        a = 2
    lead = math.sqrt(max(0.0, (M[4 * a] - cosine) / (1.0 - cosine)))
    skew = x if a == 0 else (y if a == 1 else z)
    signed = -angle if skew < 0.0 else angle
    for i in range(3):
        part = lead if i == a else (M[3 * i + a] + M[3 * a + i]) / (2.0 * (1.0 - cosine) * lead)
        error[3 + i] = signed * part


@leaf
def tilt(T, target, axis, error, d):
    """Write the smallest turn (tool frame) that brings a tool axis to its direction in the target to error[3:6]."""
    for i in range(3):
        d[i] = T[0, i] * target[0, axis] + T[1, i] * target[1, axis] + T[2, i] * target[2, axis]
    i, j = (axis + 1) % 3, (axis + 2) % 3
    sine = math.hypot(d[i], d[j])
    error[3 + axis] = 0.0
    if sine < 1e-15:
        error[3 + i], error[3 + j] = (0.0 if d[axis] > 0.0 else math.pi), 0.0
        return
    scale = math.atan2(sine, d[axis]) / sine
    error[3 + i], error[3 + j] = -d[j] * scale, d[i] * scale


@leaf
def tool_error(T, target, axis, error, small):
    """Write the remaining motion of the tool in its own frame: shift, then rotation (of one axis if `axis` ≥ 0)."""
    x, y, z = target[0, 3] - T[0, 3], target[1, 3] - T[1, 3], target[2, 3] - T[2, 3]
    for i in range(3):
        error[i] = T[0, i] * x + T[1, i] * y + T[2, i] * z
    if axis >= 0:
        tilt(T, target, axis, error, small)
    else:
        rotation_vector(T, target, error, small)


@leaf
def weigh(weights, J, error):
    """Multiply error and Jacobian by the weights and move the rows that count to the front."""
    r = 0
    for row in range(6):
        weight = weights[row]
        if weight > 0.0:
            error[r] = weight * error[row]
            for m in range(J.shape[1]):
                J[r, m] = weight * J[row, m]
            r += 1
