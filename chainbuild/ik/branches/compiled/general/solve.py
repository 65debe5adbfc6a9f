"""All branches of one pose of six rotary joints in any arrangement: compiled code.

Of the eigenvalues (see `equations`) each real one must lead to a solution of its own, and each other one must be
complex beyond doubt: only then are the solutions certainly all.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from chainbuild.ik.branches.compiled.general.constants import (
    BACK,
    CENTRE,
    JOINTS,
    OPENINGS,
    PER_OPENING,
    SCALE,
    VIEWS,
)
from chainbuild.ik.branches.compiled.general.eigen import eigenvalues_of
from chainbuild.ik.branches.compiled.general.equations import companion_of, equations_of, work_of
from chainbuild.ik.branches.compiled.general.solutions import polish, values_of
from chainbuild.ik.search.compiled.kernels import jit

_GOOD: Final = 60.0  # entries of the matrix up to which no better view is looked for
_USELESS: Final = 1e7  # entries of the matrix above which its eigenvalues have no digits
_APART: Final = 1e-9  # share below which the eliminated joints are not told apart
_NOISE: Final = 1e-15  # times the square of the largest entry: what rounding moves a simple eigenvalue by, at most
_CERTAIN: Final = 10.0  # times that: an eigenvalue so far from the real ones is complex
_MET: Final = 1e-10  # residual of a solution [arm lengths, rad]
_SAME: Final = 1e-4  # rad: solutions nearer than this are one


@jit
def scaled(constants, T, G):
    """Write the loop's motion (3, 4) at a pose (4, 4): as seen from the middle of the axes, in units of the arm."""
    for i in range(3):
        for j in range(4):
            total = 0.0
            for k in range(3):
                total += T[i, k] * constants[BACK + 4 * k + j]
            G[i, j] = total
        G[i, 3] = (G[i, 3] + T[i, 3] - constants[CENTRE + i]) / constants[SCALE]


@jit
def is_complex(real, imaginary, size, k, noise):
    """Tell whether an eigenvalue is complex beyond doubt.

    The characteristic polynomial at the real number next to it is the product of the distances to all eigenvalues: if
    that is more than rounding makes of 0, no real eigenvalue was meant.
    """
    half = 0.5 * math.atan2(2.0 * real[k], 1.0 - real[k] * real[k] - imaginary[k] * imaginary[k])
    c, s = math.cos(half), math.sin(half)
    product = 1.0
    for n in range(size):
        across, along = c * real[n] - s, c * imaginary[n]
        square = (across * across + along * along) / (1.0 + real[n] * real[n] + imaginary[n] * imaginary[n])
        product *= min(1.0, 16.0 * square)
    return product > noise * noise


@jit
def is_new(values, count, q):
    """Tell whether joint values differ from the first rows of others by more than whole turns."""
    for r in range(count):
        largest = 0.0
        for n in range(JOINTS):
            largest = max(largest, abs(math.sin(0.5 * (values[r, n] - q[n]))))
        if 2.0 * largest < _SAME:
            return False
    return True


@jit
def best_view(w, pairs):
    """Write the eigenvalue problem seen from where it is conditioned best; returns angle, size, largest entry."""
    best, least, size, largest = 0, math.inf, 0, 0.0
    for k in range(len(VIEWS)):
        size, largest = companion_of(w, pairs, VIEWS[k])
        if largest < least:
            best, least = k, largest
        if largest < _GOOD:
            return VIEWS[k], size, largest
    if best != len(VIEWS) - 1:
        size, largest = companion_of(w, pairs, VIEWS[best])
    return VIEWS[best], size, largest


@jit
def solve(constants, T, values):
    """Write the solutions of a pose (4, 4) to the rows of `values` (32, 6); returns how many, whether certainly all."""
    w = work_of()
    G, pose, J = np.empty((3, 4)), np.empty((3, 4)), np.empty((JOINTS, JOINTS))
    q, e = np.empty(JOINTS), np.empty(JOINTS)
    one, other = np.empty(JOINTS, np.complex128), np.empty(JOINTS, np.complex128)
    scaled(constants, T, G)
    found = 0
    for n in range(int(constants[0])):
        part = constants[OPENINGS + n * PER_OPENING : OPENINGS + (n + 1) * PER_OPENING]
        pairs, apart = equations_of(part, G, w, one, other)
        if not apart > _APART:
            continue
        angle, size, largest = best_view(w, pairs)
        if not largest < _USELESS or not eigenvalues_of(w.companion, size, w.real, w.imaginary):
            continue
        noise = _CERTAIN * _NOISE * largest * largest
        perhaps = 0
        for k in range(size):
            if w.imaginary[k] != 0.0 and is_complex(w.real, w.imaginary, size, k, noise):
                continue
            perhaps += 1
            values_of(constants, part, G, w, pairs, 0.5 * angle + math.atan(w.real[k]), q, pose, J, e)
            if polish(constants, G, q, pose, J, e) < _MET and is_new(values, found, q) and found < len(values):
                for i in range(JOINTS):
                    values[found, i] = q[i]
                found += 1
        if 0 < perhaps <= found:
            return found, perhaps == found
    return found, False
