"""Two angles that two equations hold, each linear in the cosine and sine of either: by one unknown of degree four.

a·cos s + b·sin s + e = c·cos t + d·sin t, twice. The cosine and sine of one angle follow from those of the other, and
must be the coordinates of a point of the unit circle.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.ik.branches.core.roots import real_angles
from chainbuild.ik.branches.core.subproblems import half_open

Pair = tuple[float, float]
Square = tuple[float, float, float, float]  # of a matrix (2, 2), by rows

# About the ratio of its singular values below which a matrix does not tell one angle from the other.
_DEPENDENT: Final = 1e-6
_VANISHED: Final = 1e-11  # share of its parts below which what they leave is rounding
_ROUNDED: Final = 1e-14  # the same for a polynomial at a multiple root
_CLOSE: Final = 1e-3  # rad: rounding moves a root of multiplicity four by the fourth root of the last digit, 1e-4
_STEPS: Final = 3  # Newton's: roots of a polynomial of degree four have half of the digits or more


class AnglePairs(NamedTuple):
    """The pairs of angles of two equations.

    Attributes:
        pairs: First and second angle.
        free: True where every first angle has a second one: it is the one to keep.
        doubtful: True where the equations hardly tell the angles, so that some may be missing.
    """

    pairs: list[Pair]
    free: bool = False
    doubtful: bool = False


def angle_pairs(A: Square, e: Pair, B: Square, keep: float) -> AnglePairs:
    """Return the angles s and t with A·(cos s, sin s) + e = B·(cos t, sin t).

    Args:
        A: Of the first angle.
        e: The rest.
        B: Of the second angle.
        keep: The first angle where it is free.
    """
    told, back = _independence(B), _independence(A)
    # Solved for the angle that gives the other one with more digits.
    swapped = back > told
    minus = (-e[0], -e[1])
    found = _angles(B, minus, A) if swapped else _angles(A, e, B)
    if found is None:
        return AnglePairs([(keep, _other(A, e, B, keep))], free=True)
    if swapped:
        pairs = [(_other(B, minus, A, angle), angle) for angle in found]
    else:
        pairs = [(angle, _other(A, e, B, angle)) for angle in found]
    return AnglePairs([_refined(A, e, B, *pair) for pair in pairs], doubtful=max(told, back) < _DEPENDENT)


def _determinant(A: Square) -> float:
    return A[0] * A[3] - A[1] * A[2]


def _independence(A: Square) -> float:
    """Return how far a matrix is from a singular one: 1 for a rotation, about the ratio of its singular values."""
    squares = sum(number * number for number in A)
    return 2.0 * abs(_determinant(A)) / squares if squares > 0.0 else 0.0


def _unscaled(B: Square, x: float, y: float) -> Pair:
    """Return the adjugate of a matrix times a vector: what the inverse gives, times the determinant."""
    return B[3] * x - B[1] * y, B[0] * y - B[2] * x


def _angles(A: Square, e: Pair, B: Square) -> list[float] | None:
    """Return the angles t for which A·(cos t, sin t) + e is B times a vector of length 1, or None where all are."""
    x0, x1 = _unscaled(B, A[0], A[2])
    y0, y1 = _unscaled(B, A[1], A[3])
    z0, z1 = _unscaled(B, *e)
    square = _determinant(B) ** 2

    def excess(angles: Vector) -> Vector:
        c, s = np.cos(angles), np.sin(angles)
        value: Vector = (x0 * c + y0 * s + z0) ** 2 + (x1 * c + y1 * s + z1) ** 2 - square
        return value

    # Its mean, its parts once and twice a turn; where all vanish, so does it.
    parts = (
        (x0 * x0 + x1 * x1 + y0 * y0 + y1 * y1) / 2.0 + z0 * z0 + z1 * z1 - square,
        2.0 * (x0 * z0 + x1 * z1), 2.0 * (y0 * z0 + y1 * z1),
        (x0 * x0 + x1 * x1 - y0 * y0 - y1 * y1) / 2.0, x0 * y0 + x1 * y1,
    )  # fmt: skip
    scale = square + max(map(abs, (x0, x1, y0, y1, z0, z1))) ** 2
    if max(map(abs, parts)) < _VANISHED * scale:
        return None
    angles = real_angles(excess, 2)
    # Of a multiple root the mean keeps the digits that its parts lose.
    return angles + [mean for mean in _means(angles) if abs(float(excess(np.array(mean)))) < _ROUNDED * scale]


def _means(angles: list[float]) -> list[float]:
    """Return the means of angles that may be parts of a multiple root."""
    means = []
    for angle in angles:
        ways = [math.remainder(other - angle, math.tau) for other in angles]
        close = [way for way in ways if abs(way) < _CLOSE]
        if len(close) > 1:
            means.append(half_open(angle + sum(close) / len(close)))
    return means


def _other(A: Square, e: Pair, B: Square, angle: float) -> float:
    """Return the angle t with A·(cos s, sin s) + e = B·(cos t, sin t)."""
    c, s = math.cos(angle), math.sin(angle)
    cosine, sine = _unscaled(B, A[0] * c + A[1] * s + e[0], A[2] * c + A[3] * s + e[1])
    sign = math.copysign(1.0, _determinant(B))
    return math.atan2(sign * sine, sign * cosine)


def _refined(A: Square, e: Pair, B: Square, first: float, second: float) -> Pair:
    """Return a pair improved by Newton steps; one where two meet as it is."""
    for _ in range(_STEPS):
        c1, s1, c2, s2 = math.cos(first), math.sin(first), math.cos(second), math.sin(second)
        J = (A[1] * c1 - A[0] * s1, B[0] * s2 - B[1] * c2, A[3] * c1 - A[2] * s1, B[2] * s2 - B[3] * c2)
        if _independence(J) < _DEPENDENT:
            break
        x = B[0] * c2 + B[1] * s2 - A[0] * c1 - A[1] * s1 - e[0]
        y = B[2] * c2 + B[3] * s2 - A[2] * c1 - A[3] * s1 - e[1]
        step = _unscaled(J, x, y)
        first, second = first + step[0] / _determinant(J), second + step[1] / _determinant(J)
    return half_open(first), half_open(second)
