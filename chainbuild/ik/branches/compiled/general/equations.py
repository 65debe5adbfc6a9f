"""The six equations of an opened loop at a pose, and their eigenvalue problem, as compiled code.

See `constants` for what is packed, `elimination.conformal` and `elimination.loop` for the numbers of an arrow.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from chainbuild.ik.branches.compiled.general.constants import (
    ARROW_ROWS,
    ARROWS_BEHIND,
    BACKWARDS,
    BEFORE,
    BEHIND,
    COMBINATIONS,
    LEFT,
    PAIRS,
    RANGE,
    STEPS_BEFORE,
    VIEWS,
)
from chainbuild.ik.branches.compiled.general.eigen import gauss, multiply, reflect, substitute
from chainbuild.ik.branches.elimination.conformal import SIZE
from chainbuild.ik.search.compiled.kernels import leaf

PRODUCTS: Final = COMBINATIONS - 1  # without that of 1 and 1, which is known
TERMS: Final = 3 * COMBINATIONS  # of the left side: by the hidden joint and two others
_GOOD: Final = 60.0  # entries of the matrix up to which no better view is looked for
_FIRST, _SECOND = np.triu_indices(5, 1)


@leaf
def write_motion(G, backwards, motion):
    """Write the transposed matrix (15, 15) by which a motion (3, 4), or its inverse, acts on an arrow."""
    for i in range(SIZE):
        for j in range(SIZE):
            motion[i, j] = 0.0
    for i in range(3):
        shift = G[i, 3]
        if backwards:
            shift = -(G[0, i] * G[0, 3] + G[1, i] * G[1, 3] + G[2, i] * G[2, 3])
        for j in range(3):
            motion[j, i] = G[j, i] if backwards else G[i, j]
            motion[j, 3] += 2.0 * shift * motion[j, i]
        motion[4, i] = shift
        motion[4, 3] += shift * shift
    motion[3, 3] = motion[4, 4] = 1.0
    for i in range(10):
        for j in range(10):
            one, other, first, second = _FIRST[j], _SECOND[j], _FIRST[i], _SECOND[i]
            crossed = motion[second, one] * motion[first, other]
            motion[5 + i, 5 + j] = motion[first, one] * motion[second, other] - crossed


@leaf
def write_unit(A, n, first):
    """Write the unit matrix (n, n) to the columns of A from one on, and 0 to everything else."""
    flat = A.reshape(A.size)
    for i in range(A.size):
        flat[i] = 0.0
    for i in range(n):
        A[i, first + i] = 1.0


@leaf
def write_right_side(part, motion, moved, sides, right):
    """Write the right side (14, 9), by the products of the joints to eliminate, and behind it the unit matrix."""
    before, behind = int(part[BEFORE]), int(part[BEHIND])
    size, rows = moved.shape[1], right.shape[0] - 1
    arrows = part[ARROWS_BEHIND : ARROWS_BEHIND + behind * SIZE].reshape((behind, SIZE))
    steps = part[STEPS_BEFORE : STEPS_BEFORE + SIZE * ARROW_ROWS * before].reshape((SIZE, ARROW_ROWS * before))
    multiply(arrows, motion, moved, behind, size, size)
    multiply(moved, steps, sides, behind, size, rows * before)
    write_unit(right, rows, COMBINATIONS)
    for i in range(rows):
        for b in range(behind):
            for a in range(before):
                right[i, b * before + a] = sides[b, i * before + a]


@leaf
def choose_pair(null):
    """Put one pair of rows (a, b) and (−b, a), a and b most nearly at right angles and of one length, to the front.

    The rows stand for a + i·b and span two complex ones, of which one may be nearly real: of four at most two are so.
    """
    best, least = 8, math.inf
    for k in range(8, len(null) - 1):
        squares, product = 0.0, 0.0
        for i in range(8, 14):
            squares += null[k, i] * null[k, i] - null[k, 6 + i] * null[k, 6 + i]
            product += null[k, i] * null[k, 6 + i]
        size = squares * squares + 4.0 * product * product
        if size < least:
            best, least = k, size
    for i in range(8, 14):
        a, b = null[best, i], null[best, 6 + i]
        null[8, i], null[8, 6 + i], null[9, i], null[9, 6 + i] = a, b, -b, a


@leaf
def write_combinations(part, P, product, null, T):
    """Write real combinations (…, 6) of the equations; returns how many are of half the degree.

    Rows (a, b) with (a + i·b)·P·range = 0 have no part of exp(i·h): first all a, then all b, then the combinations
    at right angles to all of them, which keep the whole degree.
    """
    count, rows = P.shape
    range_ = part[RANGE : RANGE + 8 * ARROW_ROWS].reshape((ARROW_ROWS, 8))
    multiply(P, range_, product, count, rows, range_.shape[1])
    write_unit(null, 2 * count, 8)
    for i in range(count):
        for j in range(4):
            null[i, j] = null[6 + i, 4 + j] = product[i, j]
            null[i, 4 + j] = product[i, 4 + j]
            null[6 + i, j] = -product[i, 4 + j]
    reflect(null, 2 * count, range_.shape[1], null.shape[1])
    half = 4
    if part[PAIRS] == 1.0:
        half = 2
        choose_pair(null)
    side = product
    write_unit(side, count, half)
    for i in range(count):
        for r in range(half):
            T[r, i], T[half + r, i] = null[8 + r, 8 + i], null[8 + r, 14 + i]
            side[i, r] = T[r, i]
    reflect(side, count, half, half + count)
    for r in range(half, count):
        for i in range(count):
            T[half + r, i] = side[r, half + i]
    return half


@leaf
def write_equations(part, G, right, P, product, motion, null, T, rows, nine):
    """Write the six equations at a pose to `rows`; returns how many are of half the degree, how well P is determined.

    Those of half the degree: their parts of cos(h/2) and sin(h/2); the others: of cos h, sin h and 1.
    """
    equations, width = P.shape
    terms = rows.shape[1]
    write_motion(G, part[BACKWARDS] != 0.0, motion)
    write_right_side(part, motion, product, nine, right)
    reflect(right, width, width - equations, right.shape[1])
    least, most = math.inf, 0.0
    for k in range(width - equations):
        least, most = min(least, abs(right[k, k])), max(most, abs(right[k, k]))
    for i in range(equations):
        for j in range(width):
            P[i, j] = right[PRODUCTS + i, COMBINATIONS + j]
    half = write_combinations(part, P, product, null, T)
    multiply(T, P, product, equations + half, equations, width)
    left = part[LEFT : LEFT + ARROW_ROWS * TERMS].reshape((ARROW_ROWS, TERMS))
    multiply(product, left, rows, equations + half, width, terms)
    for r in range(equations + half):
        for i in range(equations):
            rows[r, TERMS - 1] -= T[r, i] * right[PRODUCTS + i, PRODUCTS]
    for r in range(half):
        for c in range(terms // 3):
            rows[r, c] += rows[r, 18 + c]
            rows[r, 9 + c] -= rows[half + r, 18 + c]
    for r in range(half, equations):
        for c in range(terms):
            rows[r, c] = rows[half + r, c]
    return half, least / most


@leaf
def write_times_x(nine, count, B):
    """Write equations (count, 9) times cos(x/2) and sin(x/2) to columns of B (12, 2·count)."""
    for r in range(count):
        for n in range(3):
            c, s, one = 0.5 * nine[r, n], 0.5 * nine[r, 3 + n], nine[r, 6 + n]
            k = 2 * r
            B[n, k], B[3 + n, k], B[6 + n, k], B[9 + n, k] = c, s, c + one, s
            B[n, k + 1], B[3 + n, k + 1], B[6 + n, k + 1], B[9 + n, k + 1] = -s, c, s, one - c


@leaf
def write_companion(rows, half, angle, nine, B, A):
    """Write the matrix whose eigenvalues are tan((h − angle)/2); returns its size and its largest entry."""
    monomials = B.shape[0]
    equations, columns = monomials // 2, rows.shape[1] // 3
    linear, square = 2 * half, monomials - 2 * half
    c, s = math.cos(0.5 * angle), math.sin(0.5 * angle)
    for r in range(half):
        for k in range(columns):
            nine[equations + r, k] = c * rows[r, k] + s * rows[r, 9 + k]
            nine[r, k] = c * rows[r, 9 + k] - s * rows[r, k]
    c, s = math.cos(angle), math.sin(angle)
    for r in range(half, equations):
        for k in range(columns):
            along = c * rows[r, k] + s * rows[r, 9 + k]
            nine[r, k] = rows[r, 18 + k] - along
            nine[equations + r, k] = 2.0 * (c * rows[r, 9 + k] - s * rows[r, k])
            nine[2 * equations - half + r, k] = rows[r, 18 + k] + along
    write_times_x(nine, 3 * equations - half, B)
    size = monomials + square
    gauss(B, monomials, monomials + size)
    substitute(B, monomials, monomials + size)
    largest = 0.0
    for i in range(size):
        for j in range(monomials):
            A[i, j] = -B[j, monomials + i]
            largest = max(largest, abs(A[i, j]))
        for j in range(monomials, size):
            A[i, j] = 0.0
    for k in range(square):
        A[linear + k, monomials + k] = 1.0
    return size, largest


@leaf
def write_best_companion(rows, half, nine, B, A, kept):
    """Write the eigenvalue problem seen from where it is conditioned best; returns the angle, size, largest entry."""
    best, least, size = 0, math.inf, 0
    for k in range(len(VIEWS)):
        size, largest = write_companion(rows, half, VIEWS[k], nine, B, A)
        if largest < _GOOD:
            return VIEWS[k], size, largest
        if largest < least:
            best, least = k, largest
            for i in range(size):
                for j in range(size):
                    kept[i, j] = A[i, j]
    for i in range(size):
        for j in range(size):
            A[i, j] = kept[i, j]
    return VIEWS[best], size, least


@leaf
def write_kernel(rows, half, c, s, nine, B):
    """Write to column 12 of B what the equations' matrix shrinks most where h/2 has cosine c and sine s."""
    monomials = B.shape[0]
    equations, columns = monomials // 2, rows.shape[1] // 3
    for r in range(half):
        for k in range(columns):
            nine[r, k] = c * rows[r, k] + s * rows[r, 9 + k]
    a, b = c * c - s * s, 2.0 * c * s
    for r in range(half, equations):
        for k in range(columns):
            nine[r, k] = a * rows[r, k] + b * rows[r, 9 + k] + rows[r, 18 + k]
    write_times_x(nine, equations, B)
    for i in range(monomials):
        for j in range(i):
            B[i, j], B[j, i] = B[j, i], B[i, j]
    gauss(B, monomials, monomials)
    for i in range(monomials):
        B[i, monomials] = 1.0
    substitute(B, monomials, monomials + 1)
