"""Turns of an arm that do not move the point which the arm places: the orientation determines them, or bounds them.

Where the wrist's point lies on the axis of an arm's joint, the point leaves the joint open and its value is kept. With
it the wrist may not reach the orientation: a single wrist axis reaches one in a circle, oblique ones not all.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.ik.branches.arms.orientation import for_rotation
from chainbuild.ik.branches.core.serial import Screw, Solution
from chainbuild.ik.branches.core.subproblems import norm, perpendicular_part, rotation, subproblem_4

_ON_AXIS: Final = 1e-7  # m: a turn moves a point so near its axis by less than a pose is verified to
_THREE: Final = 3  # axes determine an orientation


def loose_turns(arm: Sequence[Screw], values: Sequence[float], point: Vector) -> list[int]:
    """Return which joints of an arm do not move a point where it is.

    Args:
        arm: The joints that place the point.
        values: Their values.
        point: (3,) at the zero of all joints [m].
    """
    found, moved = [], point
    for n in reversed(range(len(arm))):
        away = perpendicular_part(arm[n].direction, moved - arm[n].point)
        if arm[n].kind == "revolute" and norm(away) < _ON_AXIS:
            found.append(n)
        moved = arm[n].move(values[n], moved)
    return found[::-1]


def with_loose_turns(
    arm: Sequence[Screw],
    values: Sequence[float],
    loose: Sequence[int],
    wrist: Sequence[Vector],
    R: Matrix,
    keep: Sequence[float],
) -> list[Solution]:
    """Return the solutions of arm and wrist whose loose turns give the orientation together with the wrist.

    Args:
        arm: The joints that place the wrist's point.
        values: Their values.
        loose: Which of them do not move it.
        wrist: Directions of the wrist axes, at the zero of all joints.
        R: (3, 3) rotation that all joints together give.
        keep: Values of all joints to keep where they are free.
    """  # fmt: skip
    if len(wrist) >= _THREE:
        return [one for n in loose for one in _bounded(arm, values, n, wrist, R, keep)]
    turning = list(loose)[len(wrist) - _THREE :]
    axes, still = _behind(arm, values, turning, wrist)
    joints = [*turning, *range(len(arm), len(arm) + len(wrist))]
    found: list[Solution] = []
    for turns in for_rotation(axes, R @ still.T, [keep[n] for n in joints]):
        placed, free = np.array([*values, *keep[len(arm) :]]), [False] * len(keep)
        for n, angle, is_free in zip(joints, turns.angles, turns.free, strict=True):
            placed[n], free[n] = angle, is_free
        found.append((placed, tuple(free)))
    return found


def _behind(
    arm: Sequence[Screw], values: Sequence[float], turning: Sequence[int], wrist: Sequence[Vector]
) -> tuple[list[Vector], Matrix]:
    """Return turning axes and wrist axes (3,), turned by the joints that stand still, and the turn (3, 3) of these."""
    axes, still = [], np.eye(3)
    for n, (screw, value) in enumerate(zip(arm, values, strict=True)):
        if n in turning:
            axes.append(still @ screw.direction)
        elif screw.kind == "revolute":
            still = still @ rotation(screw.direction, value)
    return [*axes, *(still @ axis for axis in wrist)], still


def _bounded(
    arm: Sequence[Screw], values: Sequence[float], n: int, wrist: Sequence[Vector], R: Matrix, keep: Sequence[float]
) -> list[Solution]:
    """Return the solutions at which a loose turn has just brought the orientation into the reach of a wrist."""
    (axis, first, second, third), still = _behind(arm, values, [n], wrist)
    bend, twist = (np.arccos(np.clip(float(a @ b), -1.0, 1.0)) for a, b in ((first, second), (second, third)))
    image = R @ still.T @ third
    found: list[Solution] = []
    for limit in (bend + twist, bend - twist):
        for turn in subproblem_4(-axis, image, first, float(np.cos(limit)), keep[n]):
            rest = rotation(-axis, turn.angle) @ R @ still.T
            for turns in for_rotation([first, second, third], rest, keep[len(arm) :]):
                placed = np.array([*values, *turns.angles])
                placed[n] = turn.angle
                found.append((placed, (*(False for _ in arm), *turns.free)))
    return found
