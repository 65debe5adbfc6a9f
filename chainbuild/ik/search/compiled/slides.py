"""Linear axes for given positions as compiled code: the twin of `ik.rtcp`.

Kept on disk like the entry points of the search; it calls no other file, so numba itself sees when it is stale.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

import numba
import numpy as np

from chainbuild.ik.search.compiled.entries import kept_jit
from chainbuild.ik.search.compiled.inner import INNER

_OPTIONS: Final[Mapping[str, Any]] = {"error_model": "numpy"}  # a division by 0 gives infinity, as in NumPy


@kept_jit(**_OPTIONS)
def write_linear_axes(fixed, prismatic, A, b, solved, positions, found, distances):
    """Write the linear axes of each row.

    Args:
        fixed: (k + 1, 4, 4) constant transforms of a `Product`.
        prismatic: (k,) True where a joint shifts along its z.
        A: (k, n) joint values by axis values, which are in mm and degrees.
        b: (k,) joint values where all axes are 0.
        solved: (3,) indices of the linear axes.
        positions: (N, 3) wanted [m].
        found: (N, n) in: axis values, mm and degrees; out: with the linear axes.
        distances: (N,) out: what is missing [m].
    """
    k = len(b)
    T, rates, missing, steps = np.empty((3, 4)), np.empty((3, 3)), np.empty(3), np.empty(3)
    for row in range(len(positions)):
        values = found[row]
        for m in range(3):
            values[solved[m]] = 0.0
        rates[:] = 0.0
        for r in range(3):
            for column in range(4):
                T[r, column] = fixed[0, r, column]
        for n in range(k):
            u = b[n]
            for axis in range(len(values)):
                u += A[n, axis] * values[axis]
            if prismatic[n]:
                for r in range(3):
                    T[r, 3] += u * T[r, 2]
                    for m in range(3):
                        rates[r, m] += A[n, solved[m]] * T[r, 2]
            else:
                c, s = math.cos(u), math.sin(u)
                for r in range(3):
                    x, y = T[r, 0], T[r, 1]
                    T[r, 0], T[r, 1] = c * x + s * y, c * y - s * x
            F = fixed[n + 1]
            for r in range(3):
                x, y, z = T[r, 0], T[r, 1], T[r, 2]
                T[r, 3] += x * F[0, 3] + y * F[1, 3] + z * F[2, 3]
                for column in range(3):
                    T[r, column] = x * F[0, column] + y * F[1, column] + z * F[2, column]
        for r in range(3):
            missing[r] = positions[row, r] - T[r, 3]
        _solve(rates, missing, steps)
        left = 0.0
        for r in range(3):
            gap = missing[r] - rates[r, 0] * steps[0] - rates[r, 1] * steps[1] - rates[r, 2] * steps[2]
            left += gap * gap
        distances[row] = math.sqrt(left)
        for m in range(3):
            values[solved[m]] = steps[m]


@numba.njit(**INNER, **_OPTIONS)
def _solve(M, v, steps):
    """Write the solution of M·steps = v for a (3, 3) matrix by cross products."""
    for m in range(3):
        p, q = (m + 1) % 3, (m + 2) % 3
        x = M[1, p] * M[2, q] - M[2, p] * M[1, q]
        y = M[2, p] * M[0, q] - M[0, p] * M[2, q]
        z = M[0, p] * M[1, q] - M[1, p] * M[0, q]
        steps[m] = (v[0] * x + v[1] * y + v[2] * z) / (M[0, m] * x + M[1, m] * y + M[2, m] * z)
