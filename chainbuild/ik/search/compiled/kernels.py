"""The damped search as compiled code: the same steps as the plain path, on arrays.

Nothing here checks its input, and nothing here is called from Python: `entries.py` holds the entry points.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final, NamedTuple

import numba
import numpy as np

from chainbuild.ik.search.compiled.inner import INNER

FAST: Final[Mapping[str, Any]] = {"error_model": "numpy", "fastmath": {"contract", "reassoc", "nsz", "arcp"}}
# Without saying so, a function takes over from the first one that calls it whether it is put into its callers.
jit: Final[Any] = numba.njit(forceinline=False, **INNER, **FAST)
# Code put into its callers: handing over a machine as many arrays takes longer than what is done with it.
inlined: Final[Any] = numba.njit(forceinline=True, **INNER, **FAST)


class Arrays(NamedTuple):
    """A problem as arrays; the names are those of `Product`, `Box`, `Starts` and `Problem`. Flags are 0 or 1."""

    fixed: Any  # (k + 1, 3, 4)
    prismatic: Any  # (k,)
    A: Any  # (k, n) by the free axes
    b: Any  # (k,) with the held axes
    lower: Any  # (n,)
    upper: Any  # (n,)
    periodic: Any  # (n,)
    sums: Any  # (c, n)
    sum_lower: Any  # (c,)
    sum_upper: Any  # (c,)
    weights: Any  # (6,)
    points: Any  # (count, n)
    features: Any  # (12, count)
    scale: Any  # (12,)
    arm_before: Any  # (4, 4)
    arm_after: Any  # (4, 4)
    arm_length: Any  # float, infinite where nothing is known
    turned_values: Any  # (points, n), none where there are no turned starts
    turned_maps: Any  # (points, n + 2, 12)
    turned_before: Any  # (4, 4)
    turned_after: Any  # (4, 4)
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
        data[e[3] : e[4]], data[e[4] : e[5]], data[e[5] : e[6]],
        data[e[6] : e[7]].reshape((c, n)), data[e[7] : e[8]], data[e[8] : e[9]],
        data[e[9] : e[10]], data[e[10] : e[11]].reshape((count, n)), data[e[11] : e[12]].reshape((12, count)),
        data[e[12] : e[13]],
        data[e[13] : e[14]].reshape((4, 4)), data[e[14] : e[15]].reshape((4, 4)), data[e[15]],
        data[e[16] : e[17]].reshape((turned, n)), data[e[17] : e[18]].reshape((turned, n + 2, 12)),
        data[e[18] : e[19]].reshape((4, 4)), data[e[19] : e[20]].reshape((4, 4)), data[e[20] : e[21]],
        rows, data[e[21]], sizes[9], sizes[10], data[e[22]], sizes[4], sizes[5], sizes[6], sizes[7],
    )  # fmt: skip


@jit
def work_of(n):
    """Return the scratch for n axes."""
    size = max(n, 6)
    return Work(
        np.empty((3, 4)), np.empty((6, n)), np.empty(6), np.empty((size, size)),
        np.empty(size), np.empty(n), np.empty(9), np.empty(12),
        np.empty((3, 4)), np.empty(13), np.empty(6, np.float32),
    )  # fmt: skip


@jit
def copy_to(to, values):
    """Write values (n,) to another array; a loop, since numba compiles a text of its error for `to[:] = values`."""
    for n in range(len(to)):
        to[n] = values[n]


@jit
def pose_and_jacobian(fixed, prismatic, A, b, y, T, J, column):
    """Write the pose T (3, 4) and the Jacobian J (6, n) in the tool frame; walks from the tool to the workpiece."""
    k, n = A.shape
    for r in range(3):
        for c in range(4):
            T[r, c] = fixed[k, r, c]
    for r in range(6):
        for m in range(n):
            J[r, m] = 0.0
    for i in range(k - 1, -1, -1):
        u = b[i]
        for m in range(n):
            u += A[i, m] * y[m]
        if prismatic[i] != 0.0:
            T[2, 3] += u
            for c in range(3):
                column[c] = T[2, c]
                column[3 + c] = 0.0
        else:
            cosine, sine = math.cos(u), math.sin(u)
            for c in range(4):
                T[0, c], T[1, c] = cosine * T[0, c] - sine * T[1, c], sine * T[0, c] + cosine * T[1, c]
            for c in range(3):
                column[c] = T[0, 3] * T[1, c] - T[1, 3] * T[0, c]
                column[3 + c] = T[2, c]
        for m in range(n):
            slope = A[i, m]
            if slope != 0.0:
                for r in range(6):
                    J[r, m] += slope * column[r]
        for c in range(4):
            x, y_, z = T[0, c], T[1, c], T[2, c]
            for r in range(3):
                T[r, c] = fixed[i, r, 0] * x + fixed[i, r, 1] * y_ + fixed[i, r, 2] * z
        for r in range(3):
            T[r, 3] += fixed[i, r, 3]


@jit
def rotation_vector(T, target, error, M):
    """Write the rotation vector of RᵀS, the turn from tool to target in the tool frame, to error[3:6]."""
    for i in range(3):
        for j in range(3):
            M[3 * i + j] = T[0, i] * target[0, j] + T[1, i] * target[1, j] + T[2, i] * target[2, j]
    x, y, z = M[7] - M[5], M[2] - M[6], M[3] - M[1]
    sine = 0.5 * math.sqrt(x * x + y * y + z * z)
    cosine = 0.5 * (M[0] + M[4] + M[8] - 1.0)
    angle = math.atan2(sine, cosine)
    if cosine > 0.0 or sine > 1e-3:
        scale = 0.5 * angle / sine if sine > 1e-9 else 0.5
        error[3], error[4], error[5] = scale * x, scale * y, scale * z
        return
    # Near half a turn the differences above vanish; the axis is read off the symmetric part, at its largest component.
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


@jit
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


@jit
def tool_error(T, target, axis, error, small):
    """Write the remaining motion of the tool in its own frame: shift, then rotation (of one axis if `axis` ≥ 0)."""
    x, y, z = target[0, 3] - T[0, 3], target[1, 3] - T[1, 3], target[2, 3] - T[2, 3]
    for i in range(3):
        error[i] = T[0, i] * x + T[1, i] * y + T[2, i] * z
    if axis >= 0:
        tilt(T, target, axis, error, small)
    else:
        rotation_vector(T, target, error, small)


@jit
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


@jit
def solve_in_place(H, g, n):
    """Solve H·x = g by Cholesky, H (lower half) and g overwritten; x is left in g."""
    for j in range(n):
        pivot = H[j, j]
        for k in range(j):
            pivot -= H[j, k] * H[j, k]
        inverse = 1.0 / math.sqrt(max(pivot, 1e-300))
        H[j, j] = inverse
        for i in range(j + 1, n):
            rest = H[i, j]
            for k in range(j):
                rest -= H[i, k] * H[j, k]
            H[i, j] = rest * inverse
    for i in range(n):
        rest = g[i]
        for k in range(i):
            rest -= H[i, k] * g[k]
        g[i] = rest * H[i, i]
    for i in range(n - 1, -1, -1):
        rest = g[i]
        for k in range(i + 1, n):
            rest -= H[k, i] * g[k]
        g[i] = rest * H[i, i]


@jit
def damped_step(rows, J, error, H, g, step, damping):
    """Write the damped least-squares step of error and Jacobian (their first `rows`) to step."""
    n = len(step)
    if rows < n:
        for i in range(rows):
            for j in range(i + 1):
                total = 0.0
                for m in range(n):
                    total += J[i, m] * J[j, m]
                H[i, j] = total
            H[i, i] += damping
            g[i] = error[i]
        solve_in_place(H, g, rows)
        for m in range(n):
            total = 0.0
            for i in range(rows):
                total += J[i, m] * g[i]
            step[m] = total
        return
    for i in range(n):
        for j in range(i + 1):
            total = 0.0
            for r in range(rows):
                total += J[r, i] * J[r, j]
            H[i, j] = total
        H[i, i] += damping
        total = 0.0
        for r in range(rows):
            total += J[r, i] * error[r]
        step[i] = total
    solve_in_place(H, step, n)
