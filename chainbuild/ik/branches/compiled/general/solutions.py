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
from chainbuild.ik.branches.compiled.general.eigen import lu_in_place, null_vector
from chainbuild.ik.branches.compiled.general.equations import PRODUCTS, matrix_at
from chainbuild.ik.search.compiled.kernels import jit

_STEPS: Final = 8  # Newton's: from a few digits, two are usual
_MAX_STEP: Final = 0.3  # rad: a longer step is none towards the solution nearby
_EXACT: Final = 1e-12  # residual [arm lengths, rad] at which no step improves anything


@jit
def pose_and_screws(constants, q, T, J):
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
        x, y, z = T[0, 3], T[1, 3], T[2, 3]
        J[0, n] += y * J[5, n] - z * J[4, n]
        J[1, n] += z * J[3, n] - x * J[5, n]
        J[2, n] += x * J[4, n] - y * J[3, n]
        sine, cosine = math.sin(q[n]), math.cos(q[n])
        versine = 1.0 - cosine
        for i in range(3):
            a, b, c = T[i, 0], T[i, 1], T[i, 2]
            for j in range(4):
                first = sine * constants[at + j] + versine * constants[at + 12 + j]
                second = sine * constants[at + 4 + j] + versine * constants[at + 16 + j]
                third = sine * constants[at + 8 + j] + versine * constants[at + 20 + j]
                T[i, j] += a * first + b * second + c * third


@jit
def rest_of(G, T, e):
    """Write what is left to a pose as a screw (6,), shift and sine of the turn; returns the turn's cosine, all that is left."""
    for i in range(3):
        e[i], e[3 + i] = G[i, 3], 0.0
    largest, trace = 0.0, 0.0
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        along = G[i, 0] * T[i, 0] + G[i, 1] * T[i, 1] + G[i, 2] * T[i, 2]
        above = G[i, 0] * T[j, 0] + G[i, 1] * T[j, 1] + G[i, 2] * T[j, 2]
        below = G[j, 0] * T[i, 0] + G[j, 1] * T[i, 1] + G[j, 2] * T[i, 2]
        e[3 + k] = 0.5 * (below - above)
        e[i] -= along * T[i, 3] + above * T[j, 3]
        e[j] -= below * T[i, 3]
        trace += along
        largest = max(largest, abs(along - 1.0), abs(above), abs(below))
    return 0.5 * (trace - 1.0), max(largest, abs(e[0]), abs(e[1]), abs(e[2]))


@jit
def solve_square(J, e):
    """Solve J·x = e (6) by elimination with pivots, both overwritten; returns the smallest pivot's share."""
    least, most = math.inf, 0.0
    for k in range(JOINTS):
        best = k
        for i in range(k + 1, JOINTS):
            if abs(J[i, k]) > abs(J[best, k]):
                best = i
        if best != k:
            for j in range(k, JOINTS):
                J[k, j], J[best, j] = J[best, j], J[k, j]
            e[k], e[best] = e[best], e[k]
        pivot = J[k, k]
        least, most = min(least, abs(pivot)), max(most, abs(pivot))
        if pivot == 0.0:
            return 0.0
        for i in range(k + 1, JOINTS):
            factor = J[i, k] / pivot
            for j in range(k + 1, JOINTS):
                J[i, j] -= factor * J[k, j]
            e[i] -= factor * e[k]
    for i in range(JOINTS - 1, -1, -1):
        total = e[i]
        for j in range(i + 1, JOINTS):
            total -= J[i, j] * e[j]
        e[i] = total / J[i, i]
    return least / most


@jit
def polish(constants, G, q, T, J, e):
    """Bring joint values (6,) to a pose by Newton steps, in place; returns what they miss [arm lengths, rad]."""
    before = math.inf
    for step in range(_STEPS + 1):
        pose_and_screws(constants, q, T, J)
        _, miss = rest_of(G, T, e)
        if miss < _EXACT or step == _STEPS or (step > 3 and miss > 0.5 * before and miss < 1e-9):
            return miss
        before = miss
        if solve_square(J, e) == 0.0:
            return miss
        longest = 0.0
        for n in range(JOINTS):
            longest = max(longest, abs(e[n]))
        share = 1.0 / max(1.0, longest / _MAX_STEP)
        if not share > 0.0:
            return math.inf
        for n in range(JOINTS):
            q[n] += share * e[n]
    return before


@jit
def values_of(constants, part, G, w, pairs, half, q, T, J, e):
    """Write all six joint values (6,) that go with half the hidden joint's angle; not polished."""
    matrix_at(w, pairs, math.cos(half), math.sin(half))
    lu_in_place(w.lead, 12, w.order)
    v = w.vector
    null_vector(w.lead, 12, w.order, v)
    cosine, sine = 0.0, 0.0
    for m in range(4):
        cosine += v[3 * m] * v[3 * m + 2]
        sine += v[3 * m + 1] * v[3 * m + 2]
    x, y = 2.0 * math.atan2(v[11], v[8]), math.atan2(sine, cosine)
    hidden = 2.0 * half
    _outer(part, w, hidden, x, y, e)
    last = int(part[ROLES + 5])
    q[int(part[ROLES])], q[int(part[ROLES + 1])] = e[0], e[1]
    q[int(part[ROLES + 2])], q[int(part[ROLES + 3])], q[int(part[ROLES + 4])] = hidden, x, y
    q[last] = 0.0
    pose_and_screws(constants, q, T, J)
    turned, _ = rest_of(G, T, e)
    q[last] = math.atan2(J[3, last] * e[3] + J[4, last] * e[4] + J[5, last] * e[5], turned)


@jit
def _outer(part, w, hidden, x, y, found):
    """Write the values of the two joints that were eliminated to the first entries of `found`."""
    left = part[LEFT : LEFT + 3 * ROWS * COMBINATIONS].reshape((3, ROWS, COMBINATIONS))
    by_x, by_y = (math.cos(x), math.sin(x), 1.0), (math.cos(y), math.sin(y), 1.0)
    by_hidden = (math.cos(hidden), math.sin(hidden), 1.0)
    z, products = w.small[0], w.small[1]
    for a in range(3):
        for b in range(3):
            products[3 * a + b] = by_x[a] * by_y[b]
    for k in range(ROWS):
        total = 0.0
        for n in range(3):
            part_ = 0.0
            for c in range(COMBINATIONS):
                part_ += left[n, k, c] * products[c]
            total += by_hidden[n] * part_
        z[k] = total
    for k in range(PRODUCTS):
        total = z[k]
        for i in range(k + 1, ROWS):
            total += w.right[i, k] * z[i]
        total *= w.factors[k]
        z[k] -= total
        for i in range(k + 1, ROWS):
            z[i] -= total * w.right[i, k]
    for k in range(PRODUCTS - 1, -1, -1):
        total = z[k] - w.right[k, PRODUCTS]
        for j in range(k + 1, PRODUCTS):
            total -= w.right[k, j] * z[j]
        z[k] = total / w.right[k, k]
    found[0], found[1] = math.atan2(z[5], z[2]), math.atan2(z[7], z[6])
