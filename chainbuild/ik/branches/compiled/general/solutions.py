"""From an eigenvalue to the values of all six joints, brought to the pose by Newton steps: compiled code.

Complex numbers are taken as well: so a complex eigenvalue is shown to be one, however near to the real ones it is.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numba import types
from numba.extending import overload

from chainbuild.ik.branches.compiled.general.constants import (
    ARROW_ROWS,
    COMBINATIONS,
    JOINTS,
    LEFT,
    PER_SCREW,
    ROLES,
    SCREWS,
)
from chainbuild.ik.branches.compiled.general.eigen import gauss, substitute
from chainbuild.ik.branches.compiled.general.equations import PRODUCTS, TERMS, write_kernel
from chainbuild.ik.search.compiled.kernels import leaf

_STEPS: Final = 8  # Newton's: from a few digits, two are usual
_HALF_WAY: Final = 4  # of them, after which less than half has to be left: what converges at all is nearer by then
_MAX_STEP: Final = 0.3  # rad: a longer step is none towards the solution nearby
MET: Final = 1e-10  # residual of a solution [arm lengths, rad]
_REGULAR: Final = 1e-6  # pivot of the Jacobian [arm lengths, rad]: below, solutions may be one, or on a curve
_OFF: Final = 3e-6  # rad by which a solution may be off: far less than what tells two apart
SAME: Final = 1e-4  # rad: solutions nearer than this are one
_EXACT: Final = 1e-12  # residual [arm lengths, rad] at which no step improves anything


@leaf
def _along(row, constants, at):
    """Return a row of a motion (4,) times a vector among the constants."""
    return row[0] * constants[at] + row[1] * constants[at + 1] + row[2] * constants[at + 2]


@leaf
def _turned_row(constants, at, sine, versine):
    """Return a row (4,) of what a turn adds to a motion."""
    return (
        sine * constants[at] + versine * constants[at + 12],
        sine * constants[at + 1] + versine * constants[at + 13],
        sine * constants[at + 2] + versine * constants[at + 14],
        sine * constants[at + 3] + versine * constants[at + 15],
    )


@leaf
def _moved_row(row, first, second, third):
    """Return a row of a motion (4,) with what a turn adds, whose rows are given."""
    a, b, c, shift = row
    return (
        a + a * first[0] + b * second[0] + c * third[0],
        b + a * first[1] + b * second[1] + c * third[1],
        c + a * first[2] + b * second[2] + c * third[2],
        shift + a * first[3] + b * second[3] + c * third[3],
    )


@leaf
def write_screws(constants, q, T, J):
    """Write the loop's motion (3, 4) and the screws (6, 6) of its joints there: shift, then turn, one a column.

    The rows of the motion are tuples, which need no memory.
    """
    one, none = np.cos(0.0 * q[0]), 0.0 * q[0]  # real or complex, as the joint values
    X, Y, Z = (one, none, none, none), (none, one, none, none), (none, none, one, none)
    for n in range(len(q)):
        at = SCREWS + n * PER_SCREW
        x, y, z = _along(X, constants, at + 24), _along(Y, constants, at + 24), _along(Z, constants, at + 24)
        J[0, n] = _along(X, constants, at + 27) + Y[3] * z - Z[3] * y
        J[1, n] = _along(Y, constants, at + 27) + Z[3] * x - X[3] * z
        J[2, n] = _along(Z, constants, at + 27) + X[3] * y - Y[3] * x
        J[3, n], J[4, n], J[5, n] = x, y, z
        sine, versine = np.sin(q[n]), one - np.cos(q[n])
        first, second = _turned_row(constants, at, sine, versine), _turned_row(constants, at + 4, sine, versine)
        third = _turned_row(constants, at + 8, sine, versine)
        X, Y = _moved_row(X, first, second, third), _moved_row(Y, first, second, third)
        Z = _moved_row(Z, first, second, third)
    T[0, 0], T[0, 1], T[0, 2], T[0, 3] = X
    T[1, 0], T[1, 1], T[1, 2], T[1, 3] = Y
    T[2, 0], T[2, 1], T[2, 2], T[2, 3] = Z


@leaf
def write_rest(G, T, J):
    """Write what is left to a pose to column 6 of J: shift, sine of the turn; returns its cosine, the largest part."""
    for i in range(3):
        J[i, JOINTS] = G[i, 3]
    largest, trace = 0.0, 0.0
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        along = G[i, 0] * T[i, 0] + G[i, 1] * T[i, 1] + G[i, 2] * T[i, 2]
        above = G[i, 0] * T[j, 0] + G[i, 1] * T[j, 1] + G[i, 2] * T[j, 2]
        below = G[j, 0] * T[i, 0] + G[j, 1] * T[i, 1] + G[j, 2] * T[i, 2]
        J[3 + k, JOINTS] = 0.5 * (below - above)
        J[i, JOINTS] -= along * T[i, 3] + above * T[j, 3]
        J[j, JOINTS] -= below * T[i, 3]
        trace += along
        largest = max(largest, abs(along - 1.0), abs(above), abs(below))
    return 0.5 * (trace - 1.0), max(largest, abs(J[0, JOINTS]), abs(J[1, JOINTS]), abs(J[2, JOINTS]))


@leaf
def polish(constants, G, q, T, J):
    """Bring joint values (6,) to a pose by Newton steps, in place; returns what they miss [arm lengths, rad]."""
    miss, first = math.inf, math.inf
    for step in range(_STEPS + 1):
        before = miss
        write_screws(constants, q, T, J)
        _, miss = write_rest(G, T, J)
        first = miss if step == 0 else first
        if miss < _EXACT or step == _STEPS or not miss < math.inf or (miss < 1e-9 and miss > 0.5 * before):
            break
        if step == _HALF_WAY and miss > 0.5 * first:
            break
        gauss(J, len(q), len(q) + 1)
        substitute(J, len(q), len(q) + 1)
        longest = _MAX_STEP
        for n in range(JOINTS):
            longest = max(longest, abs(J[n, JOINTS]))
        for n in range(JOINTS):
            q[n] += J[n, JOINTS] * _MAX_STEP / longest
    return miss


@leaf
def is_regular(J):
    """Tell whether a solution is isolated, and nearer than _OFF to where Newton's steps ended; overwrites J.

    How far off it is the next step would tell: pivots may be far larger than the weakest singular value.
    """
    pivot, off = gauss(J, len(J), len(J) + 1), 0.0
    substitute(J, len(J), len(J) + 1)
    for n in range(len(J)):
        off = max(off, abs(J[n, len(J)]))
    return pivot > _REGULAR and off < _OFF


def angle_of(cosine, sine):
    """Return the angle of a cosine and a sine, or of multiples of them."""
    return math.atan2(sine, cosine)


@overload(angle_of)
def _angle_of(cosine, sine):
    if isinstance(cosine, types.Complex):
        # Of complex multiples: one of the two that differ by half a turn.
        return lambda cosine, sine: -1.0j * np.log((cosine + 1.0j * sine) / np.sqrt(cosine * cosine + sine * sine))
    return lambda cosine, sine: math.atan2(sine, cosine)


@leaf
def write_values(constants, part, rows, half, right, hidden, nine, B, G, q, T, J):
    """Write all six joint values (6,) that go with the hidden joint's angle, where the equations are nearly singular.

    The angle and all arrays behind it, but G, are of real or of complex numbers.
    """
    write_kernel(rows, half, np.cos(0.5 * hidden), np.sin(0.5 * hidden), nine, B)
    cosine, sine, one = 0.0 * hidden, 0.0 * hidden, 0.0 * hidden
    for m in range(0, len(B), 3):
        cosine += B[m, 12] * B[m + 2, 12]
        sine += B[m + 1, 12] * B[m + 2, 12]
        one += B[m + 2, 12] * B[m + 2, 12]
    x, y = 2.0 * angle_of(B[8, 12], B[11, 12]), angle_of(cosine / one, sine / one)
    products, reached, z = nine[0], nine[1], nine[2]
    for n in range(len(T)):
        by_y = np.cos(y) if n == 0 else (np.sin(y) if n == 1 else 1.0 + 0.0 * y)
        products[n], products[3 + n], products[6 + n] = np.cos(x) * by_y, np.sin(x) * by_y, by_y
    left = part[LEFT : LEFT + ARROW_ROWS * TERMS].reshape((ARROW_ROWS, TERMS))
    a, b = np.cos(hidden), np.sin(hidden)
    for k in range(len(left)):
        reached[k] = 0.0
        for n in range(rows.shape[1] // 3):
            reached[k] += (a * left[k, n] + b * left[k, 9 + n] + left[k, 18 + n]) * products[n]
    for k in range(PRODUCTS - 1, -1, -1):
        total = 0.0 * hidden - right[k, PRODUCTS]
        for i in range(len(left)):
            total += right[k, COMBINATIONS + i] * reached[i]
        for j in range(k + 1, PRODUCTS):
            total -= right[k, j] * z[j]
        z[k] = total / right[k, k]
    # The products are in the order cosine, sine, 1 of the first joint, and in each the same of the second.
    q[int(part[ROLES])], q[int(part[ROLES + 1])] = angle_of(z[2], z[5]), angle_of(z[6], z[7])
    last = int(part[ROLES + 5])
    q[int(part[ROLES + 2])], q[int(part[ROLES + 3])], q[int(part[ROLES + 4])] = hidden, x, y
    q[last] = 0.0
    write_screws(constants, q, T, J)
    turned, _ = write_rest(G, T, J)
    q[last] = angle_of(turned, J[3, last] * J[3, 6] + J[4, last] * J[4, 6] + J[5, last] * J[5, 6])


@leaf
def largest_imaginary(z):
    """Return the largest imaginary part of complex values (6,)."""
    largest = 0.0
    for n in range(len(z)):
        largest = max(largest, abs(z[n].imag))
    return largest


@leaf
def is_complex_solution(constants, place, hidden, G, z, T, J, others, count):
    """Tell whether Newton steps from complex values (6,) end at complex values with the eigenvalue that led there.

    The hidden joint, at a place among them, must come back to its angle, nearer than that is to real angles. The values
    must be regular and differ from the first rows of others; if so, they are written behind them.
    """
    miss = polish(constants, G, z, T, J)
    if not miss < MET:
        return False
    if not 4.0 * abs(np.sin(0.5 * (z[place] - hidden))) < abs(hidden.imag):
        return False
    if not (largest_imaginary(z) > SAME and is_regular(J) and count < len(others)):
        return False
    for r in range(count):
        one, other = 0.0, 0.0
        for n in range(len(z)):
            one = max(one, abs(np.sin(0.5 * (others[r, n] - z[n]))))
            other = max(other, abs(np.sin(0.5 * (others[r, n].conjugate() - z[n]))))
        if 2.0 * min(one, other) < SAME:
            return False
    for n in range(len(z)):
        others[count, n] = z[n]
    return True
