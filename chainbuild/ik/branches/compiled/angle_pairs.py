"""Two angles that two equations hold, as compiled code: the twin of `arms.angle_pairs`.

The polynomial of degree four is one in the tangent of half the angle, counted from where it is far from 0, so that no
root is far away. It is solved by Ferrari's way: two quadratics by the largest root of a cubic, then Newton steps.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from chainbuild.ik.branches.core.subproblems import TOUCH
from chainbuild.ik.search.compiled.kernels import leaf

_HALF: Final = math.sqrt(0.5)
# Cosines and sines of multiples of 45 degrees, and of their doubles.
_EIGHTHS: Final = np.array(
    [
        (1.0, 0.0, 1.0, 0.0), (_HALF, _HALF, 0.0, 1.0), (0.0, 1.0, -1.0, 0.0), (-_HALF, _HALF, 0.0, -1.0),
        (-1.0, 0.0, 1.0, 0.0), (-_HALF, -_HALF, 0.0, 1.0), (0.0, -1.0, -1.0, 0.0), (_HALF, -_HALF, 0.0, -1.0),
    ]
)  # fmt: skip
# About the ratio of its singular values below which a matrix does not tell one angle from the other with all digits.
_DEPENDENT: Final = 1e-5
# Share of its parts below which a discriminant is in doubt: where roots nearly meet, the cubic has half of the digits.
_MEETING: Final = 1e-7
_SYMMETRIC: Final = 3.0  # times the coefficient that is not symmetric: more than it moves a squared root
_CLOSE: Final = 1e-8  # squared distance of points of the unit circle that may be one
VANISHED: Final = 1e-7  # share of its parts below which what they leave has lost too many digits
MERGED: Final = 1e-14  # squared sine of half the difference of two angles: less is what rounding makes of one
_OFF: Final = 1e-7  # how far from the unit circle the other angle's point may be computed
_STEPS: Final = 2  # Newton's: from half of the digits to all of them


@leaf
def sinusoid_roots(a, b, c, roots):
    """Write the cosines and sines of the angles t with a·cos t + b·sin t = c; a and b of size 1.

    Args:
        a: Of the cosine.
        b: Of the sine.
        c: The level.
        roots: (2, 2) out.

    Returns:
        How many angles there are, and whether this is sure.
    """
    square = a * a + b * b
    left = square - c * c
    if not square > 1e-10:
        return 0, False
    share = 1.0 / square
    if left <= MERGED * square:
        if left < -2.0 * TOUCH * square:
            return 0, True
        size = math.copysign(math.sqrt(share), c)
        roots[0, 0], roots[0, 1] = a * size, b * size
        return 1, True
    wide = math.sqrt(left)
    roots[0, 0], roots[0, 1] = (a * c - b * wide) * share, (b * c + a * wide) * share
    roots[1, 0], roots[1, 1] = (a * c + b * wide) * share, (b * c - a * wide) * share
    return 2, True


@leaf
def _independence(a, b, c, d):
    squares = a * a + b * b + c * c + d * d
    return 2.0 * abs(a * d - b * c) / squares if squares > 0.0 else 0.0


@leaf
def paired_roots(rows, pairs, work):
    """Write cosine and sine of angle 1 and of angle 5, of every pair that two equations hold.

    Args:
        rows: (2, 6) a, b, e, c, d, f of a·cos q1 + b·sin q1 + e = c·cos q5 + d·sin q5 + f.
        pairs: (4, 4) out.
        work: (4, 2) scratch.

    Returns:
        How many pairs there are, and whether this is sure.
    """
    told = _independence(rows[0, 3], rows[0, 4], rows[1, 3], rows[1, 4])
    back = _independence(rows[0, 0], rows[0, 1], rows[1, 0], rows[1, 1])
    if not max(told, back) > _DEPENDENT:
        return 0, False
    # Solved for the angle that gives the other one with more digits.
    one, other = (3, 0) if back > told else (0, 3)
    a, b, c, d = rows[0, other], rows[0, other + 1], rows[1, other], rows[1, other + 1]
    determinant = a * d - b * c
    x, y = rows[0, one], rows[1, one]
    x0, x1 = d * x - b * y, a * y - c * x
    x, y = rows[0, one + 1], rows[1, one + 1]
    y0, y1 = d * x - b * y, a * y - c * x
    x, y = rows[0, one + 2] - rows[0, other + 2], rows[1, one + 2] - rows[1, other + 2]
    z0, z1 = d * x - b * y, a * y - c * x
    xx, yy, zz, square = x0 * x0 + x1 * x1, y0 * y0 + y1 * y1, z0 * z0 + z1 * z1, determinant * determinant
    count, sure = wave_roots(
        0.5 * (xx + yy) + zz - square, 2.0 * (x0 * z0 + x1 * z1), 2.0 * (y0 * z0 + y1 * z1), 0.5 * (xx - yy),
        x0 * y0 + x1 * y1, VANISHED * (xx + yy + zz + square), work,
    )  # fmt: skip
    share = 1.0 / determinant
    for n in range(count):
        cosine, sine = work[n, 0], work[n, 1]
        x, y = (x0 * cosine + y0 * sine + z0) * share, (x1 * cosine + y1 * sine + z1) * share
        length = math.sqrt(x * x + y * y)
        if not abs(length - 1.0) < _OFF:
            sure = False
        first, second = (0, 2) if one == 0 else (2, 0)
        pairs[n, first], pairs[n, first + 1] = cosine, sine
        pairs[n, second], pairs[n, second + 1] = x / length, y / length
    return count, sure


@leaf
def wave_roots(m, a1, b1, a2, b2, nothing, roots):
    """Write cosine and sine of the angles where m + a1·cos t + b1·sin t + a2·cos 2t + b2·sin 2t is 0; how many, sure.

    Sure it is not where the wave is nowhere larger than `nothing`.
    """
    best, most = 0, -1.0
    for n in range(8):
        c, s, c2, s2 = _EIGHTHS[n, 0], _EIGHTHS[n, 1], _EIGHTHS[n, 2], _EIGHTHS[n, 3]
        size = abs(m + a1 * c + b1 * s + a2 * c2 + b2 * s2)
        if size > most:
            best, most = n, size
    # Angles are counted from the opposite of the place where the wave is far from 0.
    c, s, c2, s2 = -_EIGHTHS[best, 0], -_EIGHTHS[best, 1], _EIGHTHS[best, 2], _EIGHTHS[best, 3]
    a1, b1, a2, b2 = a1 * c + b1 * s, b1 * c - a1 * s, a2 * c2 + b2 * s2, b2 * c2 - a2 * s2
    lead = m - a1 + a2
    if not abs(lead) > nothing:
        return 0, False
    share = 1.0 / lead
    k3, k2 = (2.0 * b1 - 4.0 * b2) * share, (2.0 * m - 6.0 * a2) * share
    k1, k0 = (2.0 * b1 + 4.0 * b2) * share, (m + a1 + a2) * share
    count, sure = _quartic_roots(k3, k2, k1, k0, roots)
    for n in range(count):
        t = roots[n, 0]
        for _ in range(_STEPS):
            value = (((t + k3) * t + k2) * t + k1) * t + k0
            slope = ((4.0 * t + 3.0 * k3) * t + 2.0 * k2) * t + k1
            t -= value / slope
        share = 1.0 / (1.0 + t * t)
        x, y = (1.0 - t * t) * share, 2.0 * t * share
        roots[n, 0], roots[n, 1] = c * x - s * y, s * x + c * y
    for n in range(count):
        for k in range(n):
            x, y = roots[n, 0] - roots[k, 0], roots[n, 1] - roots[k, 1]
            if not x * x + y * y > _CLOSE:
                sure = False
    return count, sure


@leaf
def _quartic_roots(k3, k2, k1, k0, roots):
    """Write the real roots of t⁴ + k3·t³ + k2·t² + k1·t + k0 in the first column; how many, and whether it is sure."""
    shift = 0.25 * k3
    square = shift * shift
    p = k2 - 6.0 * square
    q = k1 - 2.0 * k2 * shift + 8.0 * square * shift
    r = k0 - k1 * shift + k2 * square - 3.0 * square * square
    U = _largest_root(2.0 * p, p * p - 4.0 * r, -q * q)
    # Not less than 1: where all roots nearly meet, the digits of the given numbers count, not those of p, q and r.
    doubtful = _MEETING * max(1.0, abs(p), math.sqrt(abs(r)), U)
    if not doubtful < U:
        return _symmetric_roots(p, r, shift, doubtful + _SYMMETRIC * abs(q), roots)
    u = math.sqrt(U)
    ratio = q / u
    count, sure = 0, True
    for n in range(2):
        sign = 1.0 - 2.0 * n
        left = U - 2.0 * (p + U - sign * ratio)
        if not abs(left) > doubtful:
            sure = False
        if left > 0.0:
            wide = math.sqrt(left)
            roots[count, 0] = 0.5 * (wide - sign * u) - shift
            roots[count + 1, 0] = 0.5 * (-wide - sign * u) - shift
            count += 2
    return count, sure


@leaf
def _symmetric_roots(p, r, shift, doubtful, roots):
    """Write the real roots y - shift of y⁴ + p·y² + r; Newton steps bring them to those of a quartic nearly like it."""
    left = p * p - 4.0 * r
    if abs(left) <= doubtful:
        return 0, False
    if left < 0.0:
        return 0, True
    count, sure, wide = 0, True, math.sqrt(left)
    for n in range(2):
        square = 0.5 * ((1.0 - 2.0 * n) * wide - p)
        if not abs(square) > doubtful:
            sure = False
        if square > 0.0:
            roots[count, 0], roots[count + 1, 0] = math.sqrt(square) - shift, -math.sqrt(square) - shift
            count += 2
    return count, sure


@leaf
def _largest_root(a, b, c):
    """Return the largest real root of x³ + a·x² + b·x + c."""
    third = a / 3.0
    Q = third * third - b / 3.0
    R = third * third * third - 0.5 * third * b + 0.5 * c
    left = R * R - Q * Q * Q
    if left < 0.0:
        root = math.sqrt(Q)
        x = -2.0 * root * math.cos((math.acos(max(-1.0, min(1.0, R / (Q * root)))) + 2.0 * math.pi) / 3.0) - third
    else:
        size = (abs(R) + math.sqrt(left)) ** (1.0 / 3.0)
        part = -math.copysign(size, R)
        x = part + (Q / part if size > 0.0 else 0.0) - third
    for _ in range(_STEPS):
        slope = (3.0 * x + 2.0 * a) * x + b
        if slope > 0.0:
            x -= (((x + a) * x + b) * x + c) / slope
    return x
