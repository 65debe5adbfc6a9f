"""From an eigenvalue to the values of all six joints, brought to the pose by Newton steps: compiled code."""

from __future__ import annotations

import math
from typing import Final

from chainbuild.ik.branches.compiled.general.constants import (
    COMBINATIONS,
    JOINTS,
    LEFT,
    PER_SCREW,
    ROLES,
    ROWS,
    SCREWS,
)
from chainbuild.ik.branches.compiled.general.eigen import gauss, substitute
from chainbuild.ik.branches.compiled.general.equations import PRODUCTS, TERMS
from chainbuild.ik.search.compiled.kernels import jit

_STEPS: Final = 8  # Newton's: from a few digits, two are usual
_MAX_STEP: Final = 0.3  # rad: a longer step is none towards the solution nearby
_EXACT: Final = 1e-12  # residual [arm lengths, rad] at which no step improves anything


@jit
def write_screws(constants, q, T, J):
    """Write the loop's motion (3, 4) and the screws (6, 6) of its joints there: shift, then turn, one a column."""
    for i in range(3):
        for j in range(4):
            T[i, j] = 1.0 if i == j else 0.0
    for n in range(JOINTS):
        at = SCREWS + n * PER_SCREW
        for i in range(3):
            turn, moment = 0.0, 0.0
            for j in range(3):
                turn += T[i, j] * constants[at + 24 + j]
                moment += T[i, j] * constants[at + 27 + j]
            J[3 + i, n], J[i, n] = turn, moment
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            J[i, n] += T[j, 3] * J[3 + k, n] - T[k, 3] * J[3 + j, n]
        sine, versine = math.sin(q[n]), 1.0 - math.cos(q[n])
        for i in range(3):
            a, b, c = T[i, 0], T[i, 1], T[i, 2]
            for j in range(4):
                first = sine * constants[at + j] + versine * constants[at + 12 + j]
                second = sine * constants[at + 4 + j] + versine * constants[at + 16 + j]
                third = sine * constants[at + 8 + j] + versine * constants[at + 20 + j]
                T[i, j] += a * first + b * second + c * third


@jit
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


@jit
def polish(constants, G, q, T, J):
    """Bring joint values (6,) to a pose by Newton steps, in place; returns what they miss [arm lengths, rad]."""
    miss = math.inf
    for step in range(_STEPS + 1):
        before = miss
        write_screws(constants, q, T, J)
        _, miss = write_rest(G, T, J)
        if miss < _EXACT or step == _STEPS or not miss < math.inf or (miss < 1e-9 and miss > 0.5 * before):
            break
        gauss(J, len(q), len(q) + 1)
        substitute(J, len(q), len(q) + 1)
        longest = _MAX_STEP
        for n in range(JOINTS):
            longest = max(longest, abs(J[n, JOINTS]))
        for n in range(JOINTS):
            q[n] += J[n, JOINTS] * _MAX_STEP / longest
    return miss


@jit
def write_values(constants, part, G, right, B, half_angle, sides, q, T, J):
    """Write all six joint values (6,) that go with a kernel, see `write_kernel`, and half the hidden joint's angle."""
    cosine, sine = 0.0, 0.0
    for m in range(4):
        cosine += B[3 * m, 12] * B[3 * m + 2, 12]
        sine += B[3 * m + 1, 12] * B[3 * m + 2, 12]
    x, y = 2.0 * math.atan2(B[11, 12], B[8, 12]), math.atan2(sine, cosine)
    hidden = 2.0 * half_angle
    write_eliminated(part, right, hidden, x, y, sides, q)
    last = int(part[ROLES + 5])
    q[int(part[ROLES + 2])], q[int(part[ROLES + 3])], q[int(part[ROLES + 4])] = hidden, x, y
    q[last] = 0.0
    write_screws(constants, q, T, J)
    turned, _ = write_rest(G, T, J)
    q[last] = math.atan2(J[3, last] * J[3, 6] + J[4, last] * J[4, 6] + J[5, last] * J[5, 6], turned)


@jit
def write_eliminated(part, right, hidden, x, y, sides, q):
    """Write the values of the two joints that were eliminated, from the products that the other joints leave them."""
    left = part[LEFT : LEFT + ROWS * TERMS].reshape((ROWS, TERMS))
    terms, reached, z = sides[0], sides[1], sides[2]
    for c in range(TERMS):
        a, b, e = c // COMBINATIONS, c // 3 % 3, c % 3
        by_hidden = math.cos(hidden) if a == 0 else (math.sin(hidden) if a == 1 else 1.0)
        by_x = math.cos(x) if b == 0 else (math.sin(x) if b == 1 else 1.0)
        terms[c] = by_hidden * by_x * (math.cos(y) if e == 0 else (math.sin(y) if e == 1 else 1.0))
    for k in range(ROWS):
        reached[k] = 0.0
        for c in range(TERMS):
            reached[k] += left[k, c] * terms[c]
    for k in range(PRODUCTS - 1, -1, -1):
        total = -right[k, PRODUCTS]
        for i in range(ROWS):
            total += right[k, COMBINATIONS + i] * reached[i]
        for j in range(k + 1, PRODUCTS):
            total -= right[k, j] * z[j]
        z[k] = total / right[k, k]
    # The products are in the order cosine, sine, 1 of the first joint, and in each the same of the second.
    q[int(part[ROLES])], q[int(part[ROLES + 1])] = math.atan2(z[5], z[2]), math.atan2(z[7], z[6])
