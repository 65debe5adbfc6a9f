"""Three joints that bring a point to a place: the position half of an arm, in closed form.

Solves every sequence of linear and rotary axes that reaches a volume: by subproblems if two axes are parallel or
intersect, else by a quartic (`general_reach`). The equation is
exp(s1·q1)·exp(s2·q2)·exp(s3·q3)·p = d; read backwards, exp(−s3·q3)·exp(−s2·q2)·exp(−s1·q1)·d = p has the same form,
which halves the cases.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.ik.branches.arms.general_reach import (
    JointTriple,
    meeting_slide,
    skew_turns,
    slide_turn_slide,
    turn_slide_turn,
)
from chainbuild.ik.branches.core.serial import Screw
from chainbuild.ik.branches.core.subproblems import (
    cross,
    norm,
    perpendicular_part,
    rotate,
    subproblem_1,
    subproblem_2,
    subproblem_3,
    subproblem_4,
)

Reach = Callable[[Vector, Vector, Sequence[float]], list[JointTriple]]
JointSolver = Callable[[Sequence[Screw], Vector, Vector, Sequence[float]], list[JointTriple]]

PARALLEL: Final = 1e-9  # sine of the angle below which two directions count as parallel
MEETING: Final = 1e-9  # distance [m] below which two axes count as meeting
_ROTATED: Final = 1e-12  # determinant below which directions do not span space


def positioner(screws: Sequence[Screw]) -> Reach | None:
    """Return the function (point, place, kept values) → joint values of three screws, or None if none is known.

    The point is given at the zero of the joints; the values that are free at a singular place are kept.
    """
    row = _slides_first(screws)
    solver = _known(row)
    if solver is None:
        back = [screw.reversed() for screw in reversed(screws)]
        row = _slides_first(back)
        solver = _known(row)
        if solver is None:
            return None
        return _backwards(solver, row, screws)
    return _forwards(solver, row, screws)


def _forwards(solver: JointSolver, row: Sequence[Screw], screws: Sequence[Screw]) -> Reach:
    order = [screws.index(screw) for screw in row]

    def reach(point: Vector, place: Vector, keep: Sequence[float]) -> list[JointTriple]:
        return [_in_order(v, order) for v in solver(row, point, place, [keep[n] for n in order])]

    return reach


def _backwards(solver: JointSolver, row: Sequence[Screw], screws: Sequence[Screw]) -> Reach:
    joints = [screw.joint for screw in screws]
    order = [joints.index(screw.joint) for screw in row]

    def reach(point: Vector, place: Vector, keep: Sequence[float]) -> list[JointTriple]:
        return [_in_order(v, order) for v in solver(row, place, point, [keep[n] for n in order])]

    return reach


def _in_order(values: JointTriple, order: Sequence[int]) -> JointTriple:
    """Return values of the reordered row in the order of the screws."""
    placed = [0.0, 0.0, 0.0]
    for value, n in zip(values, order, strict=True):
        placed[n] = value
    return placed[0], placed[1], placed[2]


def parallel(a: Vector, b: Vector) -> bool:
    """Tell whether two unit vectors are parallel or antiparallel."""
    return norm(cross(a, b)) < PARALLEL


def meeting_point(one: Screw, other: Screw) -> Vector | None:
    """Return the point where the axes of two rotary screws meet, or None."""
    normal = cross(one.direction, other.direction)
    squared = float(normal @ normal)
    if squared < PARALLEL * PARALLEL:
        return None
    between = other.point - one.point
    if abs(float(between @ normal)) / math.sqrt(squared) > MEETING:
        return None
    along = float(cross(between, other.direction) @ normal) / squared
    point: Vector = one.point + along * one.direction
    return point


def _slides_first(screws: Sequence[Screw]) -> list[Screw]:
    """Return the screws with each slide moved before rotary axes parallel to it: the two commute."""
    row = list(screws)
    for n in (1, 2, 1):
        before, after = row[n - 1], row[n]
        commute = before.kind == "revolute" and after.kind == "prismatic"
        if commute and parallel(before.direction, after.direction):
            row[n - 1], row[n] = after, before
    return row


def _known(row: Sequence[Screw]) -> JointSolver | None:
    """Return the solver of a row of screws, or None."""
    kinds = "".join(screw.kind[0] for screw in row)
    a, b, c = row
    slides = [screw.direction for screw in row if screw.kind == "prismatic"]
    if kinds == "ppp":
        return _three_slides if abs(float(np.linalg.det(np.array(slides)))) > _ROTATED else None
    if kinds == "ppr":
        normal = cross(a.direction, b.direction)
        flat = parallel(normal / (norm(normal) or 1.0), c.direction)
        return None if parallel(a.direction, b.direction) or flat else _two_slides_and_turn
    if kinds == "prp":
        level = max(abs(float(a.direction @ b.direction)), abs(float(c.direction @ b.direction))) < PARALLEL
        return None if level else slide_turn_slide
    if kinds == "rpr":
        return None if parallel(a.direction, c.direction) else turn_slide_turn
    if kinds == "prr":
        lifts = abs(float(a.direction @ b.direction)) > PARALLEL
        return _slide_and_parallel_turns if lifts and parallel(b.direction, c.direction) else None
    return _after_two_turns(a, b, c) if kinds in ("rrr", "rrp") else None


def _after_two_turns(a: Screw, b: Screw, c: Screw) -> JointSolver | None:
    """Return the solver of turns a, b before a joint c of either kind, or None."""
    if c.kind == "revolute" and parallel(b.direction, c.direction):
        return None if parallel(a.direction, b.direction) else _turn_and_parallel_turns
    if parallel(a.direction, b.direction):
        return None
    centre = meeting_point(a, b)
    if centre is None:
        return skew_turns
    on_a_sphere = c.kind == "revolute" and norm(perpendicular_part(c.direction, centre - c.point)) < MEETING
    return None if on_a_sphere else _meeting_turns


def _three_slides(row: Sequence[Screw], p: Vector, d: Vector, _keep: Sequence[float]) -> list[JointTriple]:
    x, y, z = np.linalg.solve(np.column_stack([screw.direction for screw in row]), d - p)
    return [(float(x), float(y), float(z))]


def _two_slides_and_turn(row: Sequence[Screw], p: Vector, d: Vector, keep: Sequence[float]) -> list[JointTriple]:
    """Return the values for slides a, b before turn c: the turn brings the point into the slides' plane."""
    a, b, c = row
    normal = cross(a.direction, b.direction)
    normal = normal / norm(normal)
    found = []
    for turn in subproblem_4(c.direction, p - c.point, normal, float(normal @ (d - c.point)), keep[2]):
        rest = d - c.move(turn.angle, p)
        frame = np.column_stack([a.direction, b.direction, normal])
        along_a, along_b, _ = np.linalg.solve(frame, rest)
        found.append((float(along_a), float(along_b), turn.angle))
    return found


def _slide_and_parallel_turns(row: Sequence[Screw], p: Vector, d: Vector, keep: Sequence[float]) -> list[JointTriple]:
    """Return the values for slide a before parallel turns b, c: the slide alone changes the height along them."""
    a, b, c = row
    height = float(b.direction @ (d - p)) / float(b.direction @ a.direction)
    pairs = two_parallel_turns(b, c, p, d - height * a.direction, keep[1:])
    return [(height, first, second) for first, second in pairs]


def _turn_and_parallel_turns(row: Sequence[Screw], p: Vector, d: Vector, keep: Sequence[float]) -> list[JointTriple]:
    """Return the values for turn a before parallel turns b, c, which do not change the coordinate along them."""
    a, b, c = row
    level = float(b.direction @ (p - a.point))
    found = []
    for turn in subproblem_4(-a.direction, d - a.point, b.direction, level, keep[0]):
        place = a.move(-turn.angle, d)
        found += [(turn.angle, *pair) for pair in two_parallel_turns(b, c, p, place, keep[1:])]
    return found


def _meeting_turns(row: Sequence[Screw], p: Vector, d: Vector, keep: Sequence[float]) -> list[JointTriple]:
    """Return the values for turns a, b that meet before a joint c: it alone changes the distance from their meeting."""
    a, b, c = row
    centre = meeting_point(a, b)
    if centre is None:
        return []
    distance = norm(d - centre)
    if c.kind == "prismatic":
        values = meeting_slide(c.direction, p, centre, distance)
    else:
        turns = subproblem_3(c.direction, p - c.point, centre - c.point, distance, keep[2])
        values = [turn.angle for turn in turns]
    found = []
    for last in values:
        moved = c.move(last, p) - centre
        pairs = subproblem_2(a.direction, b.direction, moved, d - centre, (keep[0], keep[1]))
        found += [(pair.first, pair.second, last) for pair in pairs]
    return found


def two_parallel_turns(b: Screw, c: Screw, p: Vector, d: Vector, keep: Sequence[float]) -> list[tuple[float, float]]:
    """Return the angles of two parallel axes that bring p to d: elbow up and elbow down."""
    w = b.direction
    flat_p = p - float(w @ (p - b.point)) * w
    flat_d = d - float(w @ (d - b.point)) * w
    pivot = c.point - float(w @ (c.point - b.point)) * w
    found = []
    for turn in subproblem_3(c.direction, flat_p - pivot, b.point - pivot, norm(flat_d - b.point), keep[1]):
        moved = pivot + rotate(c.direction, turn.angle, flat_p - pivot)
        found.append((subproblem_1(w, moved - b.point, flat_d - b.point, keep[0]).angle, turn.angle))
    return found
