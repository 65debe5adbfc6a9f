"""The six equations of an opened loop at a pose, as compiled code: their rows of half the degree and the others.

See `constants` for what is packed; all shapes are those of `elimination.conformal` and `elimination.loop`.
"""

from __future__ import annotations

import math
from typing import Any, Final, NamedTuple

import numpy as np

from chainbuild.ik.branches.compiled.general.constants import (
    ARROWS_BEHIND,
    BACKWARDS,
    BEFORE,
    BEHIND,
    BLOCKS,
    COMBINATIONS,
    EQUATIONS,
    LEFT,
    PAIRS,
    POINT,
    RANGE,
    REST,
    ROWS,
    SIZE,
    STEPS_BEFORE,
)
from chainbuild.ik.branches.compiled.general.eigen import last_rows, lu_in_place, reflect, solve_rows
from chainbuild.ik.search.compiled.kernels import jit

PRODUCTS: Final = COMBINATIONS - 1
_FIRST: Final = np.triu_indices(POINT, 1)[0]
_SECOND: Final = np.triu_indices(POINT, 1)[1]


class Work(NamedTuple):
    """Scratch of one pose."""

    point: Any  # (5, 5) how the pose moves a point
    rest: Any  # (10, 10) and the other numbers of an arrow
    right: Any  # (14, 9) right side; then its reflections
    factors: Any  # (14,) of the reflections
    P: Any  # (6, 14) what the eliminated joints do not reach
    null: Any  # (6, 4) complex
    rows: Any  # (6, 27) equations by the hidden joint and by the others
    low: Any  # (4, 9) of half the degree, of cos(h/2)
    high: Any  # (4, 9) of sin(h/2)
    stack: Any  # (20, 12) lower coefficients
    lead: Any  # (12, 12) leading ones
    companion: Any  # (21, 20)
    order: Any  # (12,) rows swapped
    real: Any  # (20,) eigenvalues
    imaginary: Any  # (20,)
    small: Any  # (6, 14)
    vector: Any  # (20,)


@jit
def work_of():
    """Return the scratch."""
    return Work(
        np.empty((POINT, POINT)), np.empty((REST, REST)), np.empty((ROWS, COMBINATIONS)), np.empty(ROWS),
        np.empty((EQUATIONS, ROWS)), np.empty((EQUATIONS, 4), np.complex128), np.empty((EQUATIONS, 3 * COMBINATIONS)),
        np.empty((4, COMBINATIONS)), np.empty((4, COMBINATIONS)), np.empty((20, 12)), np.empty((12, 12)),
        np.empty((21, 20)), np.empty(12, np.int64), np.empty(20), np.empty(20), np.empty((EQUATIONS, ROWS)),
        np.empty(20),
    )  # fmt: skip


@jit
def motion_blocks(G, backwards, point, rest):
    """Write the two blocks of the matrix by which a motion (3, 4), or its inverse, acts on an arrow."""
    for i in range(3):
        for j in range(3):
            point[i, j] = G[j, i] if backwards else G[i, j]
    for i in range(3):
        if backwards:
            point[i, 4] = -(G[0, i] * G[0, 3] + G[1, i] * G[1, 3] + G[2, i] * G[2, 3])
        else:
            point[i, 4] = G[i, 3]
    for j in range(3):
        point[3, j] = 2.0 * (point[0, 4] * point[0, j] + point[1, 4] * point[1, j] + point[2, 4] * point[2, j])
        point[4, j] = 0.0
        point[j, 3] = 0.0
    point[3, 3], point[4, 3], point[4, 4] = 1.0, 0.0, 1.0
    point[3, 4] = point[0, 4] * point[0, 4] + point[1, 4] * point[1, 4] + point[2, 4] * point[2, 4]
    for i in range(REST):
        one, other = _FIRST[i], _SECOND[i]
        for j in range(REST):
            first, second = _FIRST[j], _SECOND[j]
            rest[i, j] = point[one, first] * point[other, second] - point[one, second] * point[other, first]


@jit
def right_side(part, w):
    """Write the right side (14, 9): by the products of the two joints that are eliminated."""
    before, behind = int(part[BEFORE]), int(part[BEHIND])
    arrows = part[ARROWS_BEHIND : ARROWS_BEHIND + behind * SIZE].reshape((behind, SIZE))
    steps = part[STEPS_BEFORE : STEPS_BEFORE + before * BLOCKS].reshape((before, BLOCKS))
    moved = w.vector
    for b in range(behind):
        for i in range(POINT):
            total = 0.0
            for j in range(POINT):
                total += w.point[i, j] * arrows[b, j]
            moved[i] = total
        for i in range(REST):
            total = 0.0
            for j in range(REST):
                total += w.rest[i, j] * arrows[b, POINT + j]
            moved[POINT + i] = total
        for a in range(before):
            column = b * before + a
            for i in range(POINT - 1):
                total = 0.0
                for j in range(POINT):
                    total += steps[a, POINT * i + j] * moved[j]
                w.right[i, column] = total
            for i in range(REST):
                total = 0.0
                for j in range(REST):
                    total += steps[a, POINT * POINT + REST * i + j] * moved[POINT + j]
                w.right[POINT - 1 + i, column] = total


@jit
def complex_null(part, w):
    """Bring P·range (6, 4) to triangular form by reflections and write the two rows it leaves, conjugated, to `null`."""
    W = w.null
    for i in range(EQUATIONS):
        for j in range(4):
            real, imaginary = 0.0, 0.0
            for k in range(ROWS):
                real += w.P[i, k] * part[RANGE + 8 * k + j]
                imaginary += w.P[i, k] * part[RANGE + 8 * k + 4 + j]
            W[i, j] = complex(real, imaginary)
    for k in range(4):
        total = 0.0
        for i in range(k, EQUATIONS):
            total += W[i, k].real ** 2 + W[i, k].imag ** 2
        size = abs(W[k, k])
        length = math.sqrt(total)
        turn = W[k, k] / size if size > 0.0 else complex(1.0, 0.0)
        W[k, k] += turn * length
        # |v|² is 2·(total + size·length); the reflection is 1 − 2·v·v*/|v|².
        w.factors[8 + k] = 1.0 / (total + size * length) if total > 0.0 else 0.0
        for j in range(k + 1, 4):
            product = complex(0.0, 0.0)
            for i in range(k, EQUATIONS):
                product += W[i, k].conjugate() * W[i, j]
            product *= w.factors[8 + k]
            for i in range(k, EQUATIONS):
                W[i, j] -= W[i, k] * product


@jit
def null_row(w, r, out):
    """Write one of the two last columns of Q that `complex_null` left, conjugated, to `out` (6,)."""
    W = w.null
    for i in range(EQUATIONS):
        out[i] = complex(0.0, 0.0)
    out[4 + r] = complex(1.0, 0.0)
    for k in range(3, -1, -1):
        product = complex(0.0, 0.0)
        for i in range(k, EQUATIONS):
            product += W[i, k].conjugate() * out[i]
        product *= w.factors[8 + k]
        for i in range(k, EQUATIONS):
            out[i] -= W[i, k] * product
    for i in range(EQUATIONS):
        out[i] = out[i].conjugate()


@jit
def right_angled(one, other):
    """Write to `one` the combination of two complex rows whose real and imaginary parts are at right angles."""
    a, b, e = complex(0.0, 0.0), complex(0.0, 0.0), complex(0.0, 0.0)
    for i in range(EQUATIONS):
        a += one[i] * one[i]
        b += one[i] * other[i]
        e += other[i] * other[i]
    root = np.sqrt(b * b - a * e)
    larger = b + root if abs(b + root) > abs(b - root) else b - root
    first, second = (-e, larger) if abs(e) > abs(a) else (larger, -a)
    length = math.sqrt(abs(first) ** 2 + abs(second) ** 2)
    if length > 0.0:
        for i in range(EQUATIONS):
            one[i] = (first * one[i] + second * other[i]) / length


@jit
def combinations(part, w, one, other):
    """Write the (6, 6) real combinations of the equations to `companion`: of half the degree in pairs, then the rest."""
    pairs = int(part[PAIRS])
    complex_null(part, w)
    null_row(w, 0, one)
    null_row(w, 1, other)
    if pairs == 1:
        right_angled(one, other)
    T, columns = w.companion, w.small
    for i in range(EQUATIONS):
        T[0, i], T[pairs, i] = one[i].real, one[i].imag
        if pairs == 2:
            T[1, i], T[3, i] = other[i].real, other[i].imag
    for i in range(EQUATIONS):
        for r in range(2 * pairs):
            columns[i, r] = T[r, i]
    reflect(columns, EQUATIONS, 2 * pairs, 2 * pairs, w.factors[8:])
    last_rows(columns, EQUATIONS, 2 * pairs, w.factors[8:], T[2 * pairs :])
    return pairs


@jit
def equations_of(part, G, w, one, other):
    """Write the equations at a pose; returns how many pairs are of half the degree, and how well P is determined."""
    motion_blocks(G, part[BACKWARDS] != 0.0, w.point, w.rest)
    right_side(part, w)
    reflect(w.right, ROWS, PRODUCTS, COMBINATIONS, w.factors)
    last_rows(w.right, ROWS, PRODUCTS, w.factors, w.P)
    least, most = math.inf, 0.0
    for k in range(PRODUCTS):
        least, most = min(least, abs(w.right[k, k])), max(most, abs(w.right[k, k]))
    pairs = combinations(part, w, one, other)
    T, TP = w.companion, w.small
    left = part[LEFT : LEFT + 3 * ROWS * COMBINATIONS].reshape((3, ROWS, COMBINATIONS))
    for r in range(EQUATIONS):
        for k in range(ROWS):
            total = 0.0
            for i in range(EQUATIONS):
                total += T[r, i] * w.P[i, k]
            TP[r, k] = total
        for n in range(3):
            for c in range(COMBINATIONS):
                w.rows[r, COMBINATIONS * n + c] = 0.0
            for k in range(ROWS):
                factor = TP[r, k]
                for c in range(COMBINATIONS):
                    w.rows[r, COMBINATIONS * n + c] += factor * left[n, k, c]
        constant = 0.0
        for i in range(EQUATIONS):
            constant += T[r, i] * w.right[PRODUCTS + i, PRODUCTS]
        w.rows[r, 3 * COMBINATIONS - 1] -= constant
    for p in range(pairs):
        for c in range(COMBINATIONS):
            cosine, sine = w.rows[p, c], w.rows[p, COMBINATIONS + c]
            one_, turned = w.rows[p, 2 * COMBINATIONS + c], w.rows[pairs + p, 2 * COMBINATIONS + c]
            w.low[p, c], w.low[pairs + p, c] = one_ + cosine, turned + sine
            w.high[p, c], w.high[pairs + p, c] = sine - turned, one_ - cosine
    return pairs, least / most


@jit
def times_x(cosine, sine, one, out, r, n):
    """Write an equation's part of one y-column n times cos(x/2) and sin(x/2) to two rows of `out` (…, 12)."""
    c, s = 0.5 * cosine, 0.5 * sine
    out[r, n], out[r, 3 + n], out[r, 6 + n], out[r, 9 + n] = c, s, c + one, s
    out[r + 1, n], out[r + 1, 3 + n], out[r + 1, 6 + n], out[r + 1, 9 + n] = -s, c, s, one - c


@jit
def companion_of(w, pairs, angle):
    """Write the matrix whose eigenvalues are tan((h − angle)/2); returns its size and its largest entry."""
    half = 2 * pairs
    linear, square = 4 * pairs, 12 - 4 * pairs
    stack, lead = w.stack, w.lead
    c, s = math.cos(0.5 * angle), math.sin(0.5 * angle)
    for r in range(half):
        for n in range(3):
            a, b, e = w.low[r, n], w.low[r, 3 + n], w.low[r, 6 + n]
            f, g, h = w.high[r, n], w.high[r, 3 + n], w.high[r, 6 + n]
            times_x(c * a + s * f, c * b + s * g, c * e + s * h, stack, 2 * r, n)
            times_x(c * f - s * a, c * g - s * b, c * h - s * e, lead, 2 * r, n)
    c, s = math.cos(angle), math.sin(angle)
    for r in range(half, EQUATIONS):
        row, k = w.rows[r], 2 * (r - half)
        for n in range(3):
            a, b, e = c * row[n] + s * row[9 + n], c * row[3 + n] + s * row[12 + n], c * row[6 + n] + s * row[15 + n]
            f, g, h = row[18 + n], row[21 + n], row[24 + n]
            times_x(f - a, g - b, h - e, lead, linear + k, n)
            times_x(f + a, g + b, h + e, stack, 12 + k, n)
            a, b, e = c * row[9 + n] - s * row[n], c * row[12 + n] - s * row[3 + n], c * row[15 + n] - s * row[6 + n]
            times_x(2.0 * a, 2.0 * b, 2.0 * e, stack, linear + k, n)
    least, _ = lu_in_place(lead, 12, w.order)
    size = 12 + square
    if not least > 0.0:
        return size, math.inf
    solve_rows(lead, 12, w.order, stack, size)
    A, largest = w.companion, 0.0
    for i in range(size):
        for j in range(12):
            A[i, j] = -stack[i, j]
            largest = max(largest, abs(stack[i, j]))
        for j in range(12, size):
            A[i, j] = 0.0
    for k in range(square):
        A[linear + k, 12 + k] = 1.0
    return size, largest


@jit
def matrix_at(w, pairs, c, s):
    """Write the matrix (12, 12) of the equations where the half of the hidden joint's angle has cosine c and sine s."""
    half = 2 * pairs
    M = w.lead
    for r in range(half):
        for n in range(3):
            times_x(
                c * w.low[r, n] + s * w.high[r, n], c * w.low[r, 3 + n] + s * w.high[r, 3 + n],
                c * w.low[r, 6 + n] + s * w.high[r, 6 + n], M, 2 * r, n,
            )  # fmt: skip
    a, b = c * c - s * s, 2.0 * c * s
    for r in range(half, EQUATIONS):
        row = w.rows[r]
        for n in range(3):
            times_x(
                a * row[n] + b * row[9 + n] + row[18 + n], a * row[3 + n] + b * row[12 + n] + row[21 + n],
                a * row[6 + n] + b * row[15 + n] + row[24 + n], M, 2 * r, n,
            )  # fmt: skip
