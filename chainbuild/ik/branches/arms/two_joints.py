"""Two joints that bring a point to a place they can reach: every solution, and near misses for the caller to judge."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.ik.branches.arms.positioner import meeting_point, parallel, two_parallel_turns
from chainbuild.ik.branches.core.serial import Screw
from chainbuild.ik.branches.core.subproblems import cross, norm, subproblem_1, subproblem_2, subproblem_4

JointPair = tuple[float, float]

_BETWEEN: Final = 1e-12  # sine: slide and axis are parallel but for rounding


def reach_by_two(a: Screw, b: Screw, p: Vector, d: Vector, keep: Sequence[float]) -> list[JointPair]:
    """Return joint values with a·b·p = d, wherever there are any; the caller verifies them.

    Args:
        a: Outer joint.
        b: Inner joint.
        p: (3,) the point at the zero of both [m].
        d: (3,) its place [m].
        keep: Values of joints on whose axis the point lies.
    """
    if a.kind == b.kind == "prismatic":
        return [] if parallel(a.direction, b.direction) else [_two_slides(a, b, d - p)]
    if a.kind == "prismatic":
        return _slide_and_turn(a, b, p, d, keep)
    if b.kind == "prismatic":
        backwards = _slide_and_turn(b.reversed(), a.reversed(), d, p, keep[::-1])
        return [(turn, shift) for shift, turn in backwards]
    if parallel(a.direction, b.direction):
        return two_parallel_turns(a, b, p, d, keep)
    return _two_turns(a, b, p, d, keep)


def _two_slides(a: Screw, b: Screw, way: Vector) -> JointPair:
    solved = np.linalg.lstsq(np.column_stack([a.direction, b.direction]), way, rcond=None)[0]
    return float(solved[0]), float(solved[1])


def _slide_and_turn(a: Screw, b: Screw, p: Vector, d: Vector, keep: Sequence[float]) -> list[JointPair]:
    """Return the values for slide a before turn b: square to both, only the turn moves the point."""
    side = cross(a.direction, b.direction)
    if norm(side) <= _BETWEEN:
        turns = [subproblem_1(b.direction, p - b.point, d - b.point, keep[1])]
    else:
        side = side / norm(side)
        turns = list(subproblem_4(b.direction, p - b.point, side, float(side @ (d - b.point)), keep[1]))
    return [(float(a.direction @ (d - b.move(turn.angle, p))), turn.angle) for turn in turns]


def _two_turns(a: Screw, b: Screw, p: Vector, d: Vector, keep: Sequence[float]) -> list[JointPair]:
    """Return the values for two turns: about meeting axes, or by the height along the outer one."""
    centre = meeting_point(a, b)
    if centre is not None:
        pairs = subproblem_2(a.direction, b.direction, p - centre, d - centre, (keep[0], keep[1]))
        return [(pair.first, pair.second) for pair in pairs]
    height = float(a.direction @ (d - b.point))
    found = []
    for turn in subproblem_4(b.direction, p - b.point, a.direction, height, keep[1]):
        moved = b.move(turn.angle, p) - a.point
        found.append((subproblem_1(a.direction, moved, d - a.point, keep[0]).angle, turn.angle))
    return found
