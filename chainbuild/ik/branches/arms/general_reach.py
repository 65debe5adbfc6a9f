"""Three joints without parallel or intersecting axes that bring a point to a place: quartics.

Every solver takes a row of screws, the point at their zero, its place and the values to keep, and returns all joint
values. Two equations without the outer turn — the height along its axis and the distance from a point on it — leave one
unknown, of degree four; the other two joints follow. Reference: Pieper 1968, "The kinematics of manipulators under
computer control".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.ik.branches.core.roots import real_angles, real_lengths
from chainbuild.ik.branches.core.serial import Screw
from chainbuild.ik.branches.core.subproblems import ON_AXIS, cross, norm, perpendicular_part, subproblem_1, subproblem_4

Vectors = NDArray[np.complex128]  # (n, 3)
JointTriple = tuple[float, float, float]

_LEVEL: Final = 1e-9  # cosine below which a slide counts as square to an axis
_NO_TERM: Final = 1e-14  # share of the squared distances below which a coefficient of theirs is rounding
_ANY: Final = np.linspace(-3.0, 3.0, 7)  # more angles than a function of the second degree has zeros


def skew_turns(row: Sequence[Screw], p: Vector, d: Vector, keep: Sequence[float]) -> list[JointTriple]:
    """Return the values for turns a, b on skew axes before a joint c of either kind.

    With c fixed, height and distance are linear in the part of the point's place that b turns, and so give it; what b
    turns must keep its length.
    """
    a, b, c = row
    between, goal = b.point - a.point, d - a.point
    k, inverse = b.direction, skew_inverse(a, b)
    slope_a, slope_m = float(k @ a.direction), float(k @ between)
    height = float(a.direction @ (goal - between))
    square = (float(goal @ goal) - float(between @ between)) / 2.0

    def turned(u: Vectors) -> Vectors:
        """Return the part across b of where b takes u."""
        along = u @ k
        half = (u * u).sum(axis=1) / 2.0
        flat: Vectors = np.stack([height - along * slope_a, square - half - along * slope_m, 0.0 * along], 1)
        return np.asarray(flat @ inverse.T, dtype=complex)

    def miss(u: Vectors) -> NDArray[np.complex128]:
        v, along = turned(u), u @ k
        missing: NDArray[np.complex128] = (v * v).sum(axis=1) - (u * u).sum(axis=1) + along * along
        return missing

    found = []
    for last in _last_joint(c, p, b.point, miss, keep[2]):
        moved = c.move(last, p)
        u = moved - b.point
        place = turned(np.array([u], dtype=complex))[0].real
        second = subproblem_1(k, u, place, keep[1]).angle
        first = subproblem_1(a.direction, b.move(second, moved) - a.point, goal, keep[0]).angle
        found.append((first, second, last))
    return found


def skew_inverse(a: Screw, b: Screw) -> Matrix:
    """Return the matrix (3, 3) from height and distance to the part across axis b of where b takes a point."""
    k, between = b.direction, b.point - a.point
    rows = np.array([perpendicular_part(k, a.direction), perpendicular_part(k, between), k])
    inverse: Matrix = np.linalg.inv(rows)
    return inverse


def turn_slide_turn(row: Sequence[Screw], p: Vector, d: Vector, keep: Sequence[float]) -> list[JointTriple]:
    """Return the values for a slide b between turns a and c, not parallel to a."""
    a, b, c = row
    goal, axis, slide = d - a.point, a.direction, b.direction
    height, square, lifts = float(axis @ goal), float(goal @ goal), float(axis @ slide)
    pairs: list[tuple[float, float]] = []
    if abs(lifts) > _LEVEL:

        def miss(u: Vectors) -> NDArray[np.complex128]:
            reached = u + np.outer((height - u @ axis) / lifts, slide)
            missing: NDArray[np.complex128] = (reached * reached).sum(axis=1) - square
            return missing

        values = _last_joint(c, p, a.point, miss, keep[2])
        pairs += [((height - float(axis @ (c.move(last, p) - a.point))) / lifts, last) for last in values]
    else:
        rest = float(axis @ (d - c.point))
        for turn in subproblem_4(c.direction, p - c.point, axis, rest, keep[2]):
            u = c.move(turn.angle, p) - a.point
            pairs += [(shift, turn.angle) for shift in _to_distance(u, slide, square)]
    found = []
    for shift, last in pairs:
        u = c.move(last, p) - a.point + shift * slide
        found.append((subproblem_1(axis, u, goal, keep[0]).angle, shift, last))
    return found


def slide_turn_slide(row: Sequence[Screw], p: Vector, d: Vector, keep: Sequence[float]) -> list[JointTriple]:
    """Return the values for a turn b between slides a and c that do not both lie across it."""
    a, b, c = row
    k = b.direction
    u, goal = p - b.point, d - b.point
    lift_a, lift_c = float(k @ a.direction), float(k @ c.direction)
    share = float(k @ (goal - u)) / (lift_a * lift_a + lift_c * lift_c)
    # Both slides along the line on which the heights agree: (share·lift_a − t·lift_c, share·lift_c + t·lift_a).
    inner, inner_slope = u + share * lift_c * c.direction, lift_a * c.direction
    outer, outer_slope = goal - share * lift_a * a.direction, lift_c * a.direction
    # The point must be as far from b as its place is on the other side; heights agree already.
    square = float(inner_slope @ inner_slope) - float(outer_slope @ outer_slope)
    linear = float(inner @ inner_slope) - float(outer @ outer_slope)
    constant = float(inner @ inner) - float(outer @ outer)
    size = max(float(inner @ inner), float(outer @ outer))
    lengths = _quadratic(square, linear, constant, size)
    slope = max(float(inner_slope @ inner_slope), float(outer_slope @ outer_slope))
    terms = np.abs([square, linear, constant])
    if (terms <= _NO_TERM * np.array([slope, math.sqrt(size * slope), size])).all():
        # Slides that the turn brings onto one line move against one another: what is kept tells how far.
        kept = lift_c * (share * lift_a - keep[0]) + lift_a * (keep[2] - share * lift_c)
        lengths = [kept / (lift_a * lift_a + lift_c * lift_c)]
    found = []
    for t in lengths:
        turn = subproblem_1(k, inner + t * inner_slope, outer + t * outer_slope, keep[1])
        found.append((share * lift_a - t * lift_c, turn.angle, share * lift_c + t * lift_a))
    return found


def meeting_slide(direction: Vector, point: Vector, centre: Vector, distance: float) -> list[float]:
    """Return how far a slide moves a point to bring it to a distance from a centre."""
    return _to_distance(point - centre, direction, distance * distance)


def _last_joint(
    c: Screw, p: Vector, origin: Vector, miss: Callable[[Vectors], NDArray[np.complex128]], keep: float
) -> list[float]:
    """Return the values of a joint at which a function of the point's place, seen from an origin, vanishes.

    Args:
        c: The joint.
        p: (3,) the point at its zero.
        origin: (3,) where the places are counted from.
        miss: Places (n, 3) → values (n,), of the second degree in the joint's sine and cosine, or of the fourth in its
            shift.
        keep: Its value where the point lies on its axis, or the function vanishes everywhere.
    """
    if c.kind == "prismatic":
        start = p - origin
        scale = norm(start) or 1.0
        return real_lengths(lambda x: miss(start + np.outer(x, c.direction)), 4, scale)
    arm = p - c.point
    swing = perpendicular_part(c.direction, arm)
    if norm(swing) <= ON_AXIS * norm(arm):
        return [keep]
    centre, side = c.point + arm - swing - origin, cross(c.direction, swing)

    def values(t: Vector) -> Vector:
        places = centre + np.outer(np.cos(t), swing) + np.outer(np.sin(t), side)
        return miss(places.astype(complex)).real

    size = float(centre @ centre) + float(swing @ swing)
    if np.abs(values(_ANY)).max() <= _NO_TERM * size:
        return [keep]
    return real_angles(values, 2)


def _to_distance(u: Vector, direction: Vector, square: float) -> list[float]:
    """Return the lengths x with |u + x·direction|² = square."""
    return _quadratic(1.0, float(u @ direction), float(u @ u) - square, max(float(u @ u), square))


def _quadratic(a: float, b: float, c: float, size: float) -> list[float]:
    """Return the real roots of a·x² + 2·b·x + c; slightly complex ones count as touching.

    Args:
        a: Coefficient.
        b: Coefficient.
        c: Coefficient.
        size: Of what c is the difference of: c itself may be nothing but its rounding.
    """
    if abs(a) <= 1e-12 * max(abs(b), abs(c)):
        return [-c / (2.0 * b)] if b else []
    inside = b * b - a * c
    if inside < -1e-9 * max(b * b, abs(a) * size):
        return []
    root = math.sqrt(max(inside, 0.0))
    larger = -(b + math.copysign(root, b))
    return [larger / a, c / larger] if larger else [0.0]
