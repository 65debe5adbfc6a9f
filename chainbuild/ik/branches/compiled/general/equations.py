"""The six equations of an opened loop at a pose, and their eigenvalue problem, as compiled code.

See `constants` for what is packed, `elimination.conformal` and `elimination.loop` for the numbers of an arrow.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from chainbuild.ik.branches.compiled.general.constants import (
    ARROWS_BEHIND,
    BACKWARDS,
    BEFORE,
    BEHIND,
    COMBINATIONS,
    EQUATIONS,
    LEFT,
    PAIRS,
    RANGE,
    ROWS,
    SIZE,
    STEPS_BEFORE,
    VIEWS,
)
from chainbuild.ik.branches.compiled.general.eigen import gauss, multiply, reflect, substitute
from chainbuild.ik.search.compiled.kernels import jit

PRODUCTS: Final = COMBINATIONS - 1
MONOMIALS: Final = 12  # cosine and sine of 3·x/2 and of x/2, times cosine and sine of y and 1
TERMS: Final = 3 * COMBINATIONS
_GOOD: Final = 60.0  # entries of the matrix up to which no better view is looked for
_FIRST, _SECOND = np.triu_indices(5, 1)


@jit
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
            motion[5 + i, 5 + j] = motion[first, one] * motion[second, other] - motion[second, one] * motion[first, other]


@jit
def write_right_side(part, motion, moved, sides, right):
    """Write the right side (14, 9), by the products of the joints to eliminate, and behind it the unit matrix."""
    before, behind = int(part[BEFORE]), int(part[BEHIND])
    arrows = part[ARROWS_BEHIND : ARROWS_BEHIND + behind * SIZE].reshape((behind, SIZE))
    steps = part[STEPS_BEFORE : STEPS_BEFORE + SIZE * ROWS * before].reshape((SIZE, ROWS * before))
    multiply(arrows, motion, moved, behind, SIZE, SIZE)
    multiply(moved, steps, sides, behind, SIZE, ROWS * before)
    for i in range(ROWS):
        for b in range(behind):
            for a in range(before):
                right[i, b * before + a] = sides[b, i * before + a]
        for j in range(ROWS):
            right[i, COMBINATIONS + j] = 1.0 if i == j else 0.0


@jit
def at_right_angles(null):
    """Combine the rows (a, b), standing for a + i·b, behind the eighth: a and b are at right angles and of one length.

    Of the four rows, which span two complex ones, the first and the one that is least a multiple of it are taken.
    """
    best, least = 9, math.inf
    for k in range(9, MONOMIALS):
        along = 0.0
        for i in range(EQUATIONS):
            along += null[8, 8 + i] * null[k, 14 + i] - null[8, 14 + i] * null[k, 8 + i]
        if abs(along) < least:
            best, least = k, abs(along)
    a, b, e = 0.0j, 0.0j, 0.0j
    for i in range(EQUATIONS):
        one, other = complex(null[8, 8 + i], null[8, 14 + i]), complex(null[best, 8 + i], null[best, 14 + i])
        a, b, e = a + one * one, b + one * other, e + other * other
    root = np.sqrt(b * b - a * e)
    larger = b + root if abs(b + root) > abs(b - root) else b - root
    first, second = (-e, larger) if abs(e) > abs(a) else (larger, -a)
    length = math.sqrt(abs(first) ** 2 + abs(second) ** 2)
    if length == 0.0:
        first, length = 1.0 + 0.0j, 1.0
    for i in range(EQUATIONS):
        one, other = complex(null[8, 8 + i], null[8, 14 + i]), complex(null[best, 8 + i], null[best, 14 + i])
        row = (first * one + second * other) / length
        null[8, 8 + i], null[8, 14 + i] = row.real, row.imag
        null[9, 8 + i], null[9, 14 + i] = -row.imag, row.real


@jit
def write_combinations(part, P, product, null, T):
    """Write real combinations (…, 6) of the equations; returns how many are of half the degree.

    Rows (a, b) with (a + i·b)·P·range = 0 have no part of exp(i·h): first all a, then all b, then the combinations
    at right angles to all of them, which keep the whole degree.
    """
    multiply(P, part[RANGE : RANGE + 8 * ROWS].reshape((ROWS, 8)), product, EQUATIONS, ROWS, 8)
    for i in range(EQUATIONS):
        for j in range(4):
            null[i, j] = null[6 + i, 4 + j] = product[i, j]
            null[i, 4 + j] = product[i, 4 + j]
            null[6 + i, j] = -product[i, 4 + j]
    for i in range(MONOMIALS):
        for j in range(MONOMIALS):
            null[i, 8 + j] = 1.0 if i == j else 0.0
    reflect(null, MONOMIALS, 8, 20)
    half = 4
    if part[PAIRS] == 1.0:
        half = 2
        at_right_angles(null)
    side = product
    for i in range(EQUATIONS):
        for r in range(half):
            T[r, i], T[half + r, i] = null[8 + r, 8 + i], null[8 + r, 14 + i]
            side[i, r] = T[r, i]
        for j in range(EQUATIONS):
            side[i, half + j] = 1.0 if i == j else 0.0
    reflect(side, EQUATIONS, half, half + EQUATIONS)
    for r in range(half, EQUATIONS):
        for i in range(EQUATIONS):
            T[half + r, i] = side[r, half + i]
    return half


@jit
def write_equations(part, G, right, P, product, null, T, rows, nine):
    """Write the six equations at a pose to `rows`; returns how many are of half the degree, how well P is determined.

    Those of half the degree: their parts of cos(h/2) and sin(h/2); the others: of cos h, sin h and 1.
    """
    write_motion(G, part[BACKWARDS] != 0.0, null)
    write_right_side(part, null, product, nine, right)
    reflect(right, ROWS, PRODUCTS, COMBINATIONS + ROWS)
    least, most = math.inf, 0.0
    for k in range(PRODUCTS):
        least, most = min(least, abs(right[k, k])), max(most, abs(right[k, k]))
    for i in range(EQUATIONS):
        for j in range(ROWS):
            P[i, j] = right[PRODUCTS + i, COMBINATIONS + j]
    half = write_combinations(part, P, product, null, T)
    count = EQUATIONS + half
    multiply(T, P, product, count, EQUATIONS, ROWS)
    multiply(product, part[LEFT : LEFT + ROWS * TERMS].reshape((ROWS, TERMS)), rows, count, ROWS, TERMS)
    for r in range(count):
        for i in range(EQUATIONS):
            rows[r, TERMS - 1] -= T[r, i] * right[PRODUCTS + i, PRODUCTS]
    for r in range(half):
        for c in range(COMBINATIONS):
            rows[r, c] += rows[r, 18 + c]
            rows[r, 9 + c] -= rows[half + r, 18 + c]
    for r in range(half, EQUATIONS):
        for c in range(TERMS):
            rows[r, c] = rows[half + r, c]
    return half, least / most


@jit
def write_times_x(nine, count, B):
    """Write equations (count, 9) times cos(x/2) and sin(x/2) to columns of B (12, 2·count)."""
    for r in range(count):
        for n in range(3):
            c, s, one = 0.5 * nine[r, n], 0.5 * nine[r, 3 + n], nine[r, 6 + n]
            k = 2 * r
            B[n, k], B[3 + n, k], B[6 + n, k], B[9 + n, k] = c, s, c + one, s
            B[n, k + 1], B[3 + n, k + 1], B[6 + n, k + 1], B[9 + n, k + 1] = -s, c, s, one - c


@jit
def write_companion(rows, half, angle, nine, B, A):
    """Write the matrix whose eigenvalues are tan((h − angle)/2); returns its size and its largest entry."""
    linear, square = 2 * half, MONOMIALS - 2 * half
    c, s = math.cos(0.5 * angle), math.sin(0.5 * angle)
    for r in range(half):
        for k in range(COMBINATIONS):
            nine[EQUATIONS + r, k] = c * rows[r, k] + s * rows[r, 9 + k]
            nine[r, k] = c * rows[r, 9 + k] - s * rows[r, k]
    c, s = math.cos(angle), math.sin(angle)
    for r in range(half, EQUATIONS):
        for k in range(COMBINATIONS):
            along = c * rows[r, k] + s * rows[r, 9 + k]
            nine[r, k] = rows[r, 18 + k] - along
            nine[EQUATIONS + r, k] = 2.0 * (c * rows[r, 9 + k] - s * rows[r, k])
            nine[2 * EQUATIONS - half + r, k] = rows[r, 18 + k] + along
    write_times_x(nine, 3 * EQUATIONS - half, B)
    size = MONOMIALS + square
    width = MONOMIALS + size
    gauss(B, MONOMIALS, width)
    substitute(B, MONOMIALS, width)
    largest = 0.0
    for i in range(size):
        for j in range(MONOMIALS):
            A[i, j] = -B[j, MONOMIALS + i]
            largest = max(largest, abs(A[i, j]))
        for j in range(MONOMIALS, size):
            A[i, j] = 1.0 if i == linear + j - MONOMIALS else 0.0
    return size, largest


@jit
def write_best_companion(rows, half, nine, B, A):
    """Write the eigenvalue problem seen from where it is conditioned best; returns the angle, size, largest entry."""
    best, least, k = 0, math.inf, 0
    while True:
        size, largest = write_companion(rows, half, VIEWS[k], nine, B, A)
        if largest < _GOOD or k == best and largest == least:
            return VIEWS[k], size, largest
        if largest < least:
            best, least = k, largest
        k += 1
        if k == len(VIEWS):
            if not least < math.inf:
                return 0.0, size, math.inf
            k = best


@jit
def write_kernel(rows, half, c, s, nine, B):
    """Write to column 12 of B what the equations' matrix shrinks most where h/2 has cosine c and sine s."""
    for r in range(half):
        for k in range(COMBINATIONS):
            nine[r, k] = c * rows[r, k] + s * rows[r, 9 + k]
    a, b = c * c - s * s, 2.0 * c * s
    for r in range(half, EQUATIONS):
        for k in range(COMBINATIONS):
            nine[r, k] = a * rows[r, k] + b * rows[r, 9 + k] + rows[r, 18 + k]
    write_times_x(nine, EQUATIONS, B)
    for i in range(MONOMIALS):
        for j in range(i):
            B[i, j], B[j, i] = B[j, i], B[i, j]
    gauss(B, MONOMIALS, MONOMIALS)
    for i in range(MONOMIALS):
        B[i, MONOMIALS] = 1.0
    substitute(B, MONOMIALS, MONOMIALS + 1)
