"""Vectors of three numbers as tuples, and the subproblems of `core.subproblems` on them, compiled.

Every subproblem says whether its answers are *sure*: where an angle nearly has no effect the caller leaves the pose to
the plain path, which looks at such cases. Answers that coincide are returned twice.
"""

from __future__ import annotations

import math
from typing import Final

from chainbuild.ik.branches.core.subproblems import ON_AXIS, TOUCH
from chainbuild.ik.search.compiled.kernels import leaf

# A vector whose part across an axis is below this share of its length: its turn keeps half the digits at most.
BARELY: Final = 1e-7
# The same of the end of two turns: the first loses digits that the turn after both, taken from it, gives back. Nearer
# the axis the plain path looks at how far the first may turn.
_BESIDE_AXIS: Final = 2e-8


@leaf
def vector(constants, n):
    """Return three numbers of an array from place n on."""
    return constants[n], constants[n + 1], constants[n + 2]


@leaf
def dot(a, b):
    """Return a·b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@leaf
def across(a, b):
    """Return a × b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@leaf
def minus(a, b):
    """Return a − b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@leaf
def plus(a, factor, b):
    """Return a + factor·b."""
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]


@leaf
def length(a):
    """Return |a|."""
    return math.sqrt(dot(a, a))


@leaf
def turned(k, angle, p):
    """Return Rot(k, angle)·p."""
    c, s = math.cos(angle), math.sin(angle)
    side, along = across(k, p), (1.0 - c) * dot(k, p)
    return (
        c * p[0] + s * side[0] + along * k[0],
        c * p[1] + s * side[1] + along * k[1],
        c * p[2] + s * side[2] + along * k[2],
    )


@leaf
def turned_about(k, point, angle, p):
    """Return where a turn about an axis through a point takes p."""
    return plus(turned(k, angle, minus(p, point)), 1.0, point)


@leaf
def one_turn(k, p, q):
    """Return the turn about k that brings p nearest to q, and whether it is sure (subproblem 1)."""
    flat_p, flat_q = plus(p, -dot(k, p), k), plus(q, -dot(k, q), k)
    shorter = min(dot(flat_p, flat_p), dot(flat_q, flat_q))
    sure = shorter > BARELY * BARELY * max(dot(p, p), dot(q, q))
    return math.atan2(dot(k, across(p, q)), dot(flat_p, flat_q)), sure


@leaf
def either_side(middle, sine_squared, cosine_squared):
    """Return how many angles middle ± spread there are, both, and whether that is sure: two where they coincide."""
    if not min(sine_squared, cosine_squared) >= -TOUCH:
        return 0, 0.0, 0.0, math.isfinite(sine_squared)
    spread = 2.0 * math.atan2(math.sqrt(max(sine_squared, 0.0)), math.sqrt(max(cosine_squared, 0.0)))
    return 2, middle + spread, middle - spread, True


@leaf
def to_distance(k, p, q, distance):
    """Return the turns about k that bring p to a distance from q (subproblem 3): count, both, sure."""
    height_p, height_q = dot(k, p), dot(k, q)
    flat_p, flat_q = plus(p, -height_p, k), plus(q, -height_q, k)
    radius_p, radius_q = length(flat_p), length(flat_q)
    scale = max(dot(p, p), dot(q, q), distance * distance)
    if not min(radius_p, radius_q) > BARELY * math.sqrt(scale):
        return 0, 0.0, 0.0, False
    flat = distance * distance - (height_p - height_q) ** 2
    middle = math.atan2(dot(k, across(p, q)), dot(flat_p, flat_q))
    product = 4.0 * radius_p * radius_q
    return either_side(
        middle, (flat - (radius_p - radius_q) ** 2) / product, ((radius_p + radius_q) ** 2 - flat) / product
    )


@leaf
def to_height(k, p, h, d):
    """Return the turns about k that bring p to height d along h (subproblem 4): count, both, sure."""
    along = dot(k, p)
    in_phase, quadrature = dot(h, p) - along * dot(h, k), dot(h, across(k, p))
    amplitude = math.sqrt(in_phase * in_phase + quadrature * quadrature)
    if not amplitude > BARELY * max(length(p), abs(d)):
        return 0, 0.0, 0.0, False
    cosine = (d - dot(h, k) * along) / amplitude
    return either_side(math.atan2(quadrature, in_phase), (1.0 - cosine) / 2.0, (1.0 + cosine) / 2.0)


@leaf
def to_height_kept(k, p, h, d, keep):
    """Return the turns as `to_height` does; where p lies on k and is at that height, one with its angle kept.

    Returns:
        count, both, whether the turn is free, sure.
    """
    along, scale = dot(k, p), max(length(p), abs(d))
    if length(across(k, p)) <= ON_AXIS * scale:
        return 1, keep, keep, True, abs(d - dot(h, k) * along) <= TOUCH * scale
    count, one, other, sure = to_height(k, p, h, d)
    return count, one, other, False, sure


@leaf
def two_turns(k1, k2, p, q):
    """Return the pairs with Rot(k1, a)·Rot(k2, b)·p = q, |p| = |q| (subproblem 2): count, a, b, a', b', sure."""
    count, first, second, first_too, second_too, sure, certain = _pairs(k1, k2, p, q)
    return count, first, second, first_too, second_too, sure and certain


@leaf
def _pairs(k1, k2, p, q):
    """Return the pairs as `two_turns` does, and whether the second and the first angles are sure."""
    pole_length = math.copysign(length(q), dot(k1, q))
    pole = pole_length * k1[0], pole_length * k1[1], pole_length * k1[2]
    count, one, other, sure = to_distance(k2, p, pole, length(minus(q, pole)))
    if count == 0:
        return 0, 0.0, 0.0, 0.0, 0.0, sure, True
    first, sure_1 = one_turn(k1, turned(k2, one, p), q)
    second, sure_2 = one_turn(k1, turned(k2, other, p), q)
    return 2, first, one, second, other, sure, sure_1 and sure_2


@leaf
def two_turns_kept(k1, k2, p, q, keep1, keep2):
    """Return the pairs as `two_turns` does; where q lies on k1 or p on k2 one pair with that angle kept.

    Returns:
        count, a, b, a', b', which of the two is free (-1: none), sure.
    """
    outer, inner, scale = length(across(k1, q)), length(across(k2, p)), length(q)
    if not (outer > _BESIDE_AXIS * scale and inner > BARELY * scale):
        if inner <= ON_AXIS * scale and outer > BARELY * scale:
            first, sure = one_turn(k1, p, q)
            return 1, first, keep2, 0.0, 0.0, 1, sure
        if outer <= ON_AXIS * scale and inner > BARELY * scale:
            second, sure = one_turn(k2, p, q)
            return 1, keep1, second, 0.0, 0.0, 0, sure
        return 0, 0.0, 0.0, 0.0, 0.0, -1, False
    count, first, second, first_too, second_too, sure, _ = _pairs(k1, k2, p, q)
    return count, first, second, first_too, second_too, -1, sure
