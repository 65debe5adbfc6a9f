"""Linear algebra of small matrices, written out: products, Gauss, Householder, and eigenvalues by Francis' steps.

Matrices that need a row of scratch have it behind their last one. Sizes are passed: arrays may be larger.

Reference: Golub and Van Loan, "Matrix Computations", 4th edition, 7.4 and 7.5.
"""

from __future__ import annotations

import math
from typing import Final

from chainbuild.ik.search.compiled.kernels import leaf

_LAST_DIGIT: Final = 2.220446049250313e-16  # of numbers of double precision
_MAX_STEPS: Final = 60  # for one eigenvalue: two or three are usual
_EXCEPTIONAL: Final = 10  # every so many steps without success the shift is another
_SMALLEST: Final = 1e-300  # a column whose entries are smaller counts as 0
_TINY: Final = 1e-17  # a pivot below is rounding: the matrix is singular there


@leaf
def multiply(A, B, product, rows, inner, columns):
    """Write A·B (rows, columns)."""
    for i in range(rows):
        for j in range(columns):
            product[i, j] = 0.0
        for k in range(inner):
            factor = A[i, k]
            for j in range(columns):
                product[i, j] += factor * B[k, j]


@leaf
def gauss(B, n, width):
    """Bring the first n columns of B (n, width) to triangular form, rows swapped; returns the smallest pivot."""
    least = math.inf
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(B[i, k]) > abs(B[best, k]):
                best = i
        if best != k:
            for j in range(k, width):
                B[k, j], B[best, j] = B[best, j], B[k, j]
        least = min(least, abs(B[k, k]))
        if abs(B[k, k]) < _TINY:
            B[k, k] = _TINY
        inverse = 1.0 / B[k, k]
        for i in range(k + 1, n):
            factor = B[i, k] * inverse
            for j in range(k + 1, width):
                B[i, j] -= factor * B[k, j]
    return least


@leaf
def substitute(B, n, width):
    """Solve for the columns behind the first n, in place, after `gauss`."""
    for k in range(n - 1, -1, -1):
        inverse = 1.0 / B[k, k]
        for j in range(n, width):
            B[k, j] *= inverse
        for i in range(k):
            factor = B[i, k]
            for j in range(n, width):
                B[i, j] -= factor * B[k, j]


@leaf
def reflect(A, rows, columns, width):
    """Bring the first columns of A (rows + 1, width) to triangular form by Householder's reflections of whole rows."""
    for k in range(columns):
        total = 0.0
        for i in range(k, rows):
            total += A[i, k] * A[i, k]
        if total < _SMALLEST:
            continue
        length = math.copysign(math.sqrt(total), A[k, k])
        head = A[k, k] + length
        factor = head / length
        for j in range(k + 1, width):
            A[rows, j] = A[k, j]
        for i in range(k + 1, rows):
            v = A[i, k] / head
            for j in range(k + 1, width):
                A[rows, j] += v * A[i, j]
        for j in range(k + 1, width):
            A[rows, j] *= factor
            A[k, j] -= A[rows, j]
        for i in range(k + 1, rows):
            v = A[i, k] / head
            for j in range(k + 1, width):
                A[i, j] -= v * A[rows, j]
            A[i, k] = 0.0
        A[k, k] = -length


@leaf
def to_hessenberg(A, n):
    """Bring the first n rows and columns of A (n + 1, …) to Hessenberg form by Householder's reflections."""
    for k in range(n - 2):
        total, scale = 0.0, 0.0
        for i in range(k + 1, n):
            scale += abs(A[i, k])
        for i in range(k + 1, n):
            total += (A[i, k] / max(scale, _SMALLEST)) ** 2
        if total == 0.0:
            continue
        length = math.copysign(scale * math.sqrt(total), A[k + 1, k])
        head = A[k + 1, k] + length
        factor = head / length
        A[k + 1, k] = head
        for j in range(k + 1, n):
            A[n, j] = 0.0
        for i in range(k + 1, n):
            v = factor * A[i, k] / head
            for j in range(k + 1, n):
                A[n, j] += v * A[i, j]
        for i in range(k + 1, n):
            v = A[i, k] / head
            for j in range(k + 1, n):
                A[i, j] -= v * A[n, j]
        for j in range(k + 1, n):
            A[n, j] = A[j, k] / head
        for i in range(n):
            total = 0.0
            for j in range(k + 1, n):
                total += A[i, j] * A[n, j]
            total *= factor
            for j in range(k + 1, n):
                A[i, j] -= total * A[n, j]
        for i in range(k + 2, n):
            A[i, k] = 0.0
        A[k + 1, k] = -length


@leaf
def francis_step(H, low, high, s, t):
    """Do one double step on the rows low … high of a Hessenberg matrix, with shifts of sum s and product t.

    It may begin behind two entries below the diagonal that are small together. The last reflection is of two rows: the
    third one's share is 0.
    """
    first = high - 1
    x = y = z = 0.0
    while first > low:
        first -= 1
        m = first
        x = H[m, m] * (H[m, m] - s) + t + H[m, m + 1] * H[m + 1, m]
        y = H[m + 1, m] * (H[m, m] + H[m + 1, m + 1] - s)
        z = H[m + 1, m] * H[m + 2, m + 1]
        if m > low:
            near = abs(H[m - 1, m - 1]) + abs(H[m, m]) + abs(H[m + 1, m + 1])
            if abs(H[m, m - 1]) * (abs(y) + abs(z)) <= _LAST_DIGIT * abs(x) * near:
                break
    for k in range(first, high):
        if k > first:
            x, y = H[k, k - 1], H[k + 1, k - 1]
            z = H[k + 2, k - 1] if k + 2 <= high else 0.0
        scale = abs(x) + abs(y) + abs(z)  # squares of the smallest numbers have no digits
        if scale == 0.0:
            continue
        x, y, z = x / scale, y / scale, z / scale
        length = math.copysign(math.sqrt(x * x + y * y + z * z), x)
        if k > first:
            H[k, k - 1], H[k + 1, k - 1] = -scale * length, 0.0
            if k + 2 <= high:
                H[k + 2, k - 1] = 0.0
        elif k > low:
            H[k, k - 1] = -H[k, k - 1]
        head = x + length
        factor, y, z = head / length, y / head, z / head
        fy, fz = factor * y, factor * z
        for j in range(k, high + 1):
            total = H[k, j] + y * H[k + 1, j] + z * H[k + 2, j]
            H[k, j] -= factor * total
            H[k + 1, j] -= fy * total
            H[k + 2, j] -= fz * total
        for i in range(low, min(k + 3, high) + 1):
            total = H[i, k] + y * H[i, k + 1] + z * H[i, k + 2]
            H[i, k] -= factor * total
            H[i, k + 1] -= fy * total
            H[i, k + 2] -= fz * total


@leaf
def pair_of(a, b, c, d):
    """Return the eigenvalues of a matrix ((a, b), (c, d)): two real parts, the imaginary part of the first."""
    half = 0.5 * (a - d)
    square = half * half + b * c
    if square < 0.0:
        return d + half, d + half, math.sqrt(-square)
    far = half + math.copysign(math.sqrt(square), half)
    return d + far, (d - b * c / far if far != 0.0 else d), 0.0


@leaf
def eigenvalues_of(A, n, real, imaginary):
    """Write the eigenvalues of the first n rows and columns of A (n + 1, n + 1); False if they do not settle.

    A is overwritten. Complex eigenvalues stand next to their conjugates.
    """
    for i in range(n):
        A[i, n] = 0.0
    to_hessenberg(A, n)
    size = 0.0
    for i in range(n):
        A[n, i] = 0.0
        for j in range(max(i - 1, 0), n):
            size = max(size, abs(A[i, j]))
    A[n, n] = 0.0
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
            continue
        a, b, c, d = A[high - 1, high - 1], A[high - 1, high], A[high, high - 1], A[high, high]
        if low == high - 1:
            one, other, turn = pair_of(a, b, c, d)
            real[low], real[high], imaginary[low], imaginary[high] = one, other, turn, -turn
            high, steps = high - 2, 0
            continue
        steps += 1
        if steps > _MAX_STEPS:
            return False
        s, t = a + d, a * d - b * c
        if steps % _EXCEPTIONAL == 0:
            away = abs(c) + abs(A[high - 1, high - 2])
            s, t = 2.0 * d + 1.5 * away, d * d + 1.5 * d * away + away * away
        francis_step(A, low, high, s, t)
    return True
