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
)
from chainbuild.ik.branches.compiled.general.eigen import eigenvalues_of, gauss
from chainbuild.ik.branches.compiled.general.equations import write_best_companion, write_equations, write_kernel
from chainbuild.ik.branches.compiled.general.solutions import polish, write_values
from chainbuild.ik.search.compiled.kernels import jit

_USELESS: Final = 1e7  # entries of the matrix above which its eigenvalues have no digits
_APART: Final = 1e-9  # share below which the eliminated joints are not told apart
_NOISE: Final = 1e-13  # times the square of the largest entry: 10 to 100 times what rounding was seen to make of 0
_BESIDE: Final = 1e-2  # half the angle from the real ones: complex eigenvalues that are nearer are tried nevertheless
_MET: Final = 1e-10  # residual of a solution [arm lengths, rad]
_REGULAR: Final = 1e-4  # pivot of the Jacobian [arm lengths, rad]: below, branches meet, or solutions are a curve
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
def distances(real, imaginary, size, x, y):
    """Return the product of a number's distances to all eigenvalues, on the sphere; those above a quarter are 1."""
    product, length = 1.0, 1.0 + x * x + y * y
    for n in range(size):
        across, along = real[n] - x, imaginary[n] - y
        other = 1.0 + real[n] * real[n] + imaginary[n] * imaginary[n]
        product *= min(1.0, 16.0 * (across * across + along * along) / (length * other))
    return math.sqrt(product)


@jit
def is_complex(real, imaginary, size, k, noise):
    """Tell whether an eigenvalue is complex beyond doubt.

    The product of the distances to all eigenvalues is the characteristic polynomial. Rounding moves eigenvalues only to
    where it is small: to none on the real line if it is not small on a line between that and the eigenvalue.
    """
    half = 0.5 * math.atan2(2.0 * real[k], 1.0 - real[k] * real[k] - imaginary[k] * imaginary[k])
    if distances(real, imaginary, size, math.tan(half), 0.0) > noise:
        return True
    # Tangents of h/2 with one imaginary part of h/2: half that of the eigenvalue.
    a, b = real[k], abs(imaginary[k])
    high = 0.125 * math.log((a * a + (1.0 + b) * (1.0 + b)) / (a * a + (1.0 - b) * (1.0 - b)))
    t = math.tanh(high)
    for n in range(size):
        half = 0.5 * math.atan2(2.0 * real[n], 1.0 - real[n] * real[n] - imaginary[n] * imaginary[n])
        c, s = math.cos(half), math.sin(half)
        below = c * c + s * s * t * t
        if not distances(real, imaginary, size, c * s * (1.0 - t * t) / below, t / below) > noise:
            return False
    return True


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
def general_branches(constants, T, values):
    """Write the solutions of a pose (4, 4) to the rows of `values` (32, 6); returns how many, whether certainly all."""
    G, pose, J, q = np.empty((3, 4)), np.empty((3, 4)), np.empty((JOINTS, JOINTS + 1)), np.empty(JOINTS)
    right, P, product, null = np.empty((15, 23)), np.empty((6, 14)), np.empty((10, 15)), np.empty((13, 20))
    motion = np.empty((15, 15))
    combined, rows, nine, B = np.empty((10, 6)), np.empty((10, 27)), np.empty((16, 126)), np.empty((12, 32))
    A, real, imaginary = np.empty((21, 21)), np.empty(20), np.empty(20)
    scaled(constants, T, G)
    found = 0
    for n in range(int(constants[0])):
        part = constants[OPENINGS + n * PER_OPENING : OPENINGS + (n + 1) * PER_OPENING]
        half, apart = write_equations(part, G, right, P, product, motion, null, combined, rows, nine)
        angle, size, largest = write_best_companion(rows, half, nine, B, A)
        if not (apart > _APART and largest < _USELESS and eigenvalues_of(A, size, real, imaginary)):
            continue
        noise = _NOISE * largest * largest
        perhaps = 0
        for k in range(size):
            beside = abs(imaginary[k]) / (1.0 + real[k] * real[k] + imaginary[k] * imaginary[k])
            certain = beside > 0.0 and is_complex(real, imaginary, size, k, noise)
            if certain and (beside > _BESIDE or imaginary[k] < 0.0):
                continue
            if not certain:
                perhaps += 1
            half_angle = 0.5 * angle + math.atan(real[k])
            write_kernel(rows, half, math.cos(half_angle), math.sin(half_angle), nine, B)
            write_values(constants, part, G, right, B, half_angle, nine, q, pose, J)
            if not (polish(constants, G, q, pose, J) < _MET and is_new(values, found, q) and found < len(values)):
                continue
            for i in range(JOINTS):
                values[found, i] = q[i]
            found += 1
            # A complex eigenvalue leads to no new solution, unless rounding moved it farther than it is known to do.
            if certain or gauss(J, len(q), len(q)) < _REGULAR:
                return found, False
        if 0 < perhaps <= found:
            return found, perhaps == found
    return found, False
