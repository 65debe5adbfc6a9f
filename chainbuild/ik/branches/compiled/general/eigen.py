"""Linear algebra of small matrices, written out: eigenvalues by Hessenberg form and Francis' steps, LU, Householder.

Reference: Golub and Van Loan, "Matrix Computations", 4th edition, 7.4 and 7.5.
"""

from __future__ import annotations

import math
from typing import Final

from chainbuild.ik.search.compiled.kernels import jit

_LAST_DIGIT: Final = 2.220446049250313e-16
_MAX_STEPS: Final = 30  # for one eigenvalue: two or three are usual
_EXCEPTIONAL: Final = 10  # every so many steps without success the shift is another


@jit
def to_hessenberg(A, n):
    """Bring the first n rows and columns of a matrix to Hessenberg form by Householder's reflections, in place."""
    for k in range(n - 2):
        scale = 0.0
        for i in range(k + 1, n):
            scale = max(scale, abs(A[i, k]))
        if scale == 0.0:
            continue
        total = 0.0
        for i in range(k + 1, n):
            A[i, k] /= scale
            total += A[i, k] * A[i, k]
        length = math.copysign(math.sqrt(total), A[k + 1, k])
        head = A[k + 1, k] + length
        factor = head / length
        for i in range(k + 2, n):
            A[i, k] /= head
        A[k + 1, k] = 1.0
        # The reflection is 1 − factor·v·vᵀ with v in column k, 1 on top.
        for j in range(k + 1, n):
            A[n, j] = 0.0
        for i in range(k + 1, n):
            v = factor * A[i, k]
            for j in range(k + 1, n):
                A[n, j] += v * A[i, j]
        for i in range(k + 1, n):
            v = A[i, k]
            for j in range(k + 1, n):
                A[i, j] -= v * A[n, j]
        for i in range(k + 1, n):
            A[n, i] = A[i, k]
        for i in range(n):
            total = 0.0
            for j in range(k + 1, n):
                total += A[i, j] * A[n, j]
            total *= factor
            for j in range(k + 1, n):
                A[i, j] -= total * A[n, j]
        A[k + 1, k] = -scale * length
        for i in range(k + 2, n):
            A[i, k] = 0.0


@jit
def francis_step(H, low, high, s, t):
    """Do one double step on the rows low … high of a Hessenberg matrix, with shifts of sum s and product t."""
    x = H[low, low] * (H[low, low] - s) + t + H[low, low + 1] * H[low + 1, low]
    y = H[low + 1, low] * (H[low, low] + H[low + 1, low + 1] - s)
    z = H[low + 1, low] * H[low + 2, low + 1] if low + 2 <= high else 0.0
    for k in range(low, high):
        wide = k + 2 <= high
        if k > low:
            x, y = H[k, k - 1], H[k + 1, k - 1]
            z = H[k + 2, k - 1] if wide else 0.0
        scale = abs(x) + abs(y) + abs(z)
        if scale == 0.0:
            continue
        x, y, z = x / scale, y / scale, z / scale
        length = math.copysign(math.sqrt(x * x + y * y + z * z), x)
        if k > low:
            H[k, k - 1] = -scale * length
            H[k + 1, k - 1] = 0.0
            if wide:
                H[k + 2, k - 1] = 0.0
        head = x + length
        factor, y, z = head / length, y / head, z / head
        last = min(k + 3, high)
        if wide:
            fy, fz = factor * y, factor * z
            for j in range(k, high + 1):
                total = H[k, j] + y * H[k + 1, j] + z * H[k + 2, j]
                H[k, j] -= factor * total
                H[k + 1, j] -= fy * total
                H[k + 2, j] -= fz * total
            for i in range(low, last + 1):
                total = H[i, k] + y * H[i, k + 1] + z * H[i, k + 2]
                H[i, k] -= factor * total
                H[i, k + 1] -= fy * total
                H[i, k + 2] -= fz * total
        else:
            for j in range(k, high + 1):
                total = factor * (H[k, j] + y * H[k + 1, j])
                H[k, j] -= total
                H[k + 1, j] -= y * total
            for i in range(low, last + 1):
                total = factor * (H[i, k] + y * H[i, k + 1])
                H[i, k] -= total
                H[i, k + 1] -= y * total


@jit
def pair_of(a, b, c, d):
    """Return the eigenvalues of a matrix ((a, b), (c, d)): two real parts, the imaginary part of the first."""
    half = 0.5 * (a - d)
    square = half * half + b * c
    if square < 0.0:
        return d + half, d + half, math.sqrt(-square)
    far = half + math.copysign(math.sqrt(square), half)
    return d + far, (d - b * c / far if far != 0.0 else d), 0.0


@jit
def eigenvalues_of(A, n, real, imaginary):
    """Write the eigenvalues of the first n rows and columns of A (n + 1 rows, overwritten); False if they do not settle.

    Complex ones stand next to their conjugates.
    """
    to_hessenberg(A, n)
    size = 0.0
    for i in range(n):
        for j in range(max(i - 1, 0), n):
            size = max(size, abs(A[i, j]))
    if not math.isfinite(size):
        return False
    high, steps = n - 1, 0
    while high >= 0:
        low = high
        while low > 0:
            near = abs(A[low - 1, low - 1]) + abs(A[low, low])
            if abs(A[low, low - 1]) <= _LAST_DIGIT * (near if near > 0.0 else size):
                break
            low -= 1
        if low == high:
            real[high], imaginary[high] = A[high, high], 0.0
            high, steps = high - 1, 0
        elif low == high - 1:
            one, other, turn = pair_of(A[low, low], A[low, high], A[high, low], A[high, high])
            real[low], real[high], imaginary[low], imaginary[high] = one, other, turn, -turn
            high, steps = high - 2, 0
        else:
            steps += 1
            if steps > _MAX_STEPS:
                return False
            a, b, c, d = A[high - 1, high - 1], A[high - 1, high], A[high, high - 1], A[high, high]
            s, t = a + d, a * d - b * c
            if steps % _EXCEPTIONAL == 0:
                away = abs(c) + abs(A[high - 1, high - 2])
                s, t = 1.5 * away, away * away
            francis_step(A, low, high, s, t)
    return True


@jit
def lu_in_place(A, n, order):
    """Factor the first n rows and columns as P·A = L·U, rows swapped; returns the smallest and the largest pivot."""
    smallest, largest = math.inf, 0.0
    for k in range(n):
        best, size = k, abs(A[k, k])
        for i in range(k + 1, n):
            if abs(A[i, k]) > size:
                best, size = i, abs(A[i, k])
        order[k] = best
        if best != k:
            for j in range(n):
                A[k, j], A[best, j] = A[best, j], A[k, j]
        smallest, largest = min(smallest, size), max(largest, size)
        if size > 0.0:
            inverse = 1.0 / A[k, k]
            for i in range(k + 1, n):
                factor = A[i, k] * inverse
                A[i, k] = factor
                for j in range(k + 1, n):
                    A[i, j] -= factor * A[k, j]
    return smallest, largest


@jit
def solve_rows(A, n, order, rows, count):
    """Solve x·A = row for each of some rows, in place, by what `lu_in_place` left."""
    for r in range(count):
        for k in range(n):
            x = rows[r, k] / A[k, k]
            rows[r, k] = x
            for j in range(k + 1, n):
                rows[r, j] -= x * A[k, j]
        for k in range(n - 1, 0, -1):
            x = rows[r, k]
            for j in range(k):
                rows[r, j] -= x * A[k, j]
        for k in range(n - 1, -1, -1):
            j = order[k]
            rows[r, k], rows[r, j] = rows[r, j], rows[r, k]


@jit
def null_vector(A, n, order, v):
    """Write the vector that a nearly singular matrix shrinks most, by two inverse steps on what `lu_in_place` left."""
    for i in range(n):
        v[i] = 1.0
    for step in range(2):
        if step:
            for k in range(n):
                j = order[k]
                v[k], v[j] = v[j], v[k]
            for i in range(1, n):
                total = v[i]
                for j in range(i):
                    total -= A[i, j] * v[j]
                v[i] = total
        for i in range(n - 1, -1, -1):
            total = v[i]
            for j in range(i + 1, n):
                total -= A[i, j] * v[j]
            pivot = A[i, i]
            v[i] = total / (pivot if abs(pivot) > 1e-17 else 1e-17)
        size = 0.0
        for i in range(n):
            size = max(size, abs(v[i]))
        for i in range(n):
            v[i] /= size


@jit
def reflect(A, rows, columns, width, factors):
    """Bring the first columns of A (rows, width) to triangular form; the reflections stay below it, 1 on top left out."""
    for k in range(columns):
        total = 0.0
        for i in range(k, rows):
            total += A[i, k] * A[i, k]
        if total == 0.0:
            factors[k] = 0.0
            continue
        length = math.copysign(math.sqrt(total), A[k, k])
        head = A[k, k] + length
        factors[k] = head / length
        for i in range(k + 1, rows):
            A[i, k] /= head
        A[k, k] = -length
        for j in range(k + 1, width):
            total = A[k, j]
            for i in range(k + 1, rows):
                total += A[i, k] * A[i, j]
            total *= factors[k]
            A[k, j] -= total
            for i in range(k + 1, rows):
                A[i, j] -= total * A[i, k]


@jit
def last_rows(A, rows, columns, factors, P):
    """Write the last rows of Qᵀ, which the first columns of A (see `reflect`) do not reach: (rows − columns, rows)."""
    count = rows - columns
    for r in range(count):
        for j in range(rows):
            P[r, j] = 0.0
        P[r, columns + r] = 1.0
    for k in range(columns - 1, -1, -1):
        for r in range(count):
            total = P[r, k]
            for i in range(k + 1, rows):
                total += P[r, i] * A[i, k]
            total *= factors[k]
            P[r, k] -= total
            for i in range(k + 1, rows):
                P[r, i] -= total * A[i, k]
