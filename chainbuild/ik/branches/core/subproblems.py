"""Paden–Kahan subproblems: the turns about given axes that bring a vector to a place, all of them.

    1  Rot(k, θ)·p = q                      at most one turn
    2  Rot(k1, θ1)·Rot(k2, θ2)·p = q        at most two pairs
    3  |q − Rot(k, θ)·p| = δ                at most two turns
    4  h·Rot(k, θ)·p = d                    at most two turns

Axes are unit vectors through the origin, angles radians in (−π, π]. Where an angle does not affect the equation
(the vector lies on the axis) it is *free*: the value to keep is returned and the angle is marked.

References: Paden 1986, "Kinematics and Control of Robot Manipulators"; Murray, Li, Sastry 1994, section 3.3;
the fourth is known from the inverse kinematics of arms with parallel axes.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Vector
from chainbuild.ik.branches.core.plain import (
    PlainVector,
    across_axis,
    plain_cross,
    plain_dot,
    plain_length,
    plain_turned,
)

# A vector whose part across an axis is below this share of its length lies on the axis: its turn has no effect.
ON_AXIS: Final = 1e-9
# How far beyond its range a cosine may be, or a height off its plane, and still count as touching.
TOUCH: Final = 1e-9


class Turn(NamedTuple):
    """A turn about one axis.

    Attributes:
        angle: Radians; the value to keep where it is free.
        free: True where every angle does the same.
        miss: What remains between the turned vector and its goal, in the vectors' unit.
    """

    angle: float
    free: bool = False
    miss: float = 0.0


class TwoTurns(NamedTuple):
    """Turns about two axes, the first one outside."""

    first: float
    second: float
    first_free: bool = False
    second_free: bool = False


def half_open(angle: float) -> float:
    """Return an angle moved by whole turns into (−π, π].

    >>> half_open(-math.pi) == math.pi
    True
    """
    wrapped = math.remainder(angle, math.tau)
    return math.pi if wrapped == -math.pi else wrapped + 0.0


def cross(a: Vector, b: Vector) -> Vector:
    """Return a × b; quicker than `np.cross` on single vectors."""
    ax, ay, az = a.tolist()
    bx, by, bz = b.tolist()
    return np.array((ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx))


def rotate(k: Vector, angle: float, p: Vector) -> Vector:
    """Return Rot(k, angle)·p by Rodrigues' formula."""
    return np.array(plain_turned(k.tolist(), angle, p.tolist()))


def rotation(k: Vector, angle: float) -> NDArray[np.float64]:
    """Return the matrix Rot(k, angle)."""
    x, y, z = k.tolist()
    c, s = math.cos(angle), math.sin(angle)
    u, v, w = (1.0 - c) * x, (1.0 - c) * y, (1.0 - c) * z
    sx, sy, sz = s * x, s * y, s * z
    return np.array((
        (c + u * x, u * y - sz, u * z + sy), (v * x + sz, c + v * y, v * z - sx), (w * x - sy, w * y + sx, c + w * z)
    ))  # fmt: skip


def norm(vector: Vector) -> float:
    """Return the length of a vector."""
    return math.sqrt(float(vector @ vector))


def perpendicular_part(axis: Vector, vector: Vector) -> Vector:
    """Return the part of a vector at right angles to an axis of length 1."""
    part: Vector = vector - float(axis @ vector) * axis
    return part


def subproblem_1(k: Vector, p: Vector, q: Vector, keep: float = 0.0) -> Turn:
    """Return the turn about k that brings p to q, or as near as a turn can.

    >>> subproblem_1(np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), np.array([0.0, 2.0, 0.0])).angle
    1.5707963267948966

    Args:
        k: (3,) axis.
        p: (3,) vector that turns.
        q: (3,) goal.
        keep: Angle to return where p or q lies on the axis.
    """
    return plain_turn(k.tolist(), p.tolist(), q.tolist(), keep)


def plain_turn(k: PlainVector, p: PlainVector, q: PlainVector, keep: float) -> Turn:
    """Return the turn of `subproblem_1` by plain numbers."""
    (height_p, across_p), (height_q, across_q) = across_axis(k, p), across_axis(k, q)
    radius_p, radius_q = plain_length(across_p), plain_length(across_q)
    miss = math.hypot(height_p - height_q, radius_p - radius_q)
    if min(radius_p, radius_q) <= ON_AXIS * max(plain_length(p), plain_length(q)):
        return Turn(keep, True, miss)
    return Turn(math.atan2(plain_dot(k, plain_cross(p, q)), plain_dot(across_p, across_q)), False, miss)


def subproblem_2(
    k1: Vector, k2: Vector, p: Vector, q: Vector, keep: tuple[float, float] = (0.0, 0.0)
) -> tuple[TwoTurns, ...]:
    """Return the pairs of turns with Rot(k1, θ1)·Rot(k2, θ2)·p = q.

    Args:
        k1: (3,) outer axis.
        k2: (3,) inner axis.
        p: (3,) vector that turns.
        q: (3,) goal, as long as p.
        keep: Angles to return where they are free.

    Returns:
        None, one (touching or singular) or two pairs.
    """
    one, two, start, end = k1.tolist(), k2.tolist(), p.tolist(), q.tolist()
    size_p, size_q = plain_length(start), plain_length(end)
    length = max(size_p, size_q)
    if abs(size_p - size_q) > TOUCH * length:
        return ()
    if plain_length(plain_cross(one, two)) <= ON_AXIS:
        return _parallel_axes(one, two, start, end, keep)
    if plain_length(plain_cross(two, start)) <= ON_AXIS * length:
        turn = plain_turn(one, start, end, keep[0])
        return (TwoTurns(turn.angle, keep[1], turn.free, True),) if turn.miss <= TOUCH * length else ()
    if plain_length(plain_cross(one, end)) <= ON_AXIS * length:
        turn = plain_turn(two, start, end, keep[1])
        return (TwoTurns(keep[0], turn.angle, True, turn.free),) if turn.miss <= TOUCH * length else ()
    return _crossing_axes(one, two, start, end)


def _parallel_axes(
    k1: PlainVector, k2: PlainVector, p: PlainVector, q: PlainVector, keep: tuple[float, float]
) -> tuple[TwoTurns, ...]:
    """Return the pair for (anti)parallel axes: only the sum of the turns counts, the inner one is kept."""
    turn = plain_turn(k1, plain_turned(k2, keep[1], p), q, keep[0])
    if turn.miss > TOUCH * plain_length(q):
        return ()
    return (TwoTurns(turn.angle, keep[1], turn.free, True),)


def _crossing_axes(k1: PlainVector, k2: PlainVector, p: PlainVector, q: PlainVector) -> tuple[TwoTurns, ...]:
    """Return the pairs by the outer axis' pole: turns about k1 keep the distance from it, so θ2 alone must reach it.

    The pole nearer to q is taken: close to it a distance keeps the digits that a height along k1 loses.
    """
    far = math.copysign(plain_length(q), plain_dot(k1, q))
    pole = (far * k1[0], far * k1[1], far * k1[2])
    between = plain_length((q[0] - pole[0], q[1] - pole[1], q[2] - pole[2]))
    return tuple(
        TwoTurns(plain_turn(k1, plain_turned(k2, inner.angle, p), q, 0.0).angle, inner.angle)
        for inner in _to_distance(k2, p, pole, between, 0.0)
    )


def subproblem_3(k: Vector, p: Vector, q: Vector, distance: float, keep: float = 0.0) -> tuple[Turn, ...]:
    """Return the turns about k that bring p to a given distance from q.

    Args:
        k: (3,) axis.
        p: (3,) vector that turns.
        q: (3,) fixed vector.
        distance: What |q − Rot(k, θ)·p| shall be.
        keep: Angle to return where it is free.
    """
    return _to_distance(k.tolist(), p.tolist(), q.tolist(), distance, keep)


def _to_distance(k: PlainVector, p: PlainVector, q: PlainVector, distance: float, keep: float) -> tuple[Turn, ...]:
    (height_p, across_p), (height_q, across_q) = across_axis(k, p), across_axis(k, q)
    radius_p, radius_q = plain_length(across_p), plain_length(across_q)
    scale = max(plain_length(p), plain_length(q), distance)
    flat = distance * distance - (height_p - height_q) ** 2
    if min(radius_p, radius_q) <= ON_AXIS * scale:
        reached = math.hypot(height_p - height_q, radius_p - radius_q)
        return (Turn(keep, True),) if abs(reached - distance) <= TOUCH * scale else ()
    middle = math.atan2(plain_dot(k, plain_cross(p, q)), plain_dot(across_p, across_q))
    # By half angles, which are exact near both ends of the range.
    product = 4.0 * radius_p * radius_q
    return _either_side(
        middle, (flat - (radius_p - radius_q) ** 2) / product, ((radius_p + radius_q) ** 2 - flat) / product
    )


def subproblem_4(k: Vector, p: Vector, h: Vector, d: float, keep: float = 0.0) -> tuple[Turn, ...]:
    """Return the turns about k that bring p to height d along h: h·Rot(k, θ)·p = d.

    Args:
        k: (3,) axis.
        p: (3,) vector that turns.
        h: (3,) unit direction the height is measured along.
        d: Height.
        keep: Angle to return where it is free.
    """
    axis, start, up = k.tolist(), p.tolist(), h.tolist()
    along, across = across_axis(axis, start)
    in_phase, quadrature = plain_dot(up, across), plain_dot(up, plain_cross(axis, start))
    amplitude, rest, size = math.hypot(in_phase, quadrature), d - plain_dot(up, axis) * along, plain_length(start)
    if amplitude <= ON_AXIS * max(size, abs(d)):
        return (Turn(keep, True),) if abs(rest) <= TOUCH * max(size, abs(d)) else ()
    cosine = rest / amplitude
    return _either_side(math.atan2(quadrature, in_phase), (1.0 - cosine) / 2.0, (1.0 + cosine) / 2.0)


def _either_side(middle: float, sine_squared: float, cosine_squared: float) -> tuple[Turn, ...]:
    """Return middle ± spread; one turn where the two coincide, none where the spread is out of range.

    Args:
        middle: Angle between the two turns.
        sine_squared: sin²(spread/2); slightly negative where rounding took it out of range.
        cosine_squared: cos²(spread/2).
    """
    if min(sine_squared, cosine_squared) < -TOUCH:
        return ()
    spread = 2.0 * math.atan2(math.sqrt(max(sine_squared, 0.0)), math.sqrt(max(cosine_squared, 0.0)))
    if spread in (0.0, math.pi):
        return (Turn(half_open(middle + spread)),)
    return Turn(half_open(middle + spread)), Turn(half_open(middle - spread))
