"""Arms in closed form: three joints for the position, the others for the orientation.

- *Spherical wrist*: the last three axes meet in a point, whatever their angles.
- *Single wrist axis*: a point on the fourth axis is placed, the fourth turns (SCARA, four-axis arms).
- *Parallel arm*: a column, three parallel axes and a hand axis across them (palletisers).
- *Position*: two or three axes and nothing else.

A robot that carries the workpiece is such an arm reversed; it is solved from the other end.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Final, Literal

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.elements import Task
from chainbuild.frames import inverse
from chainbuild.ik.branches.arms.loose_turns import loose_turns, with_loose_turns
from chainbuild.ik.branches.arms.orientation import for_rotation, perpendicular
from chainbuild.ik.branches.arms.positioner import MEETING, meeting_point, parallel, positioner, two_parallel_turns
from chainbuild.ik.branches.arms.two_joints import reach_by_two
from chainbuild.ik.branches.core.serial import ArmSolver, Screw, Serial, Solution, rotation_seen_from, transformed_point
from chainbuild.ik.branches.core.subproblems import norm, perpendicular_part, rotate, subproblem_1, subproblem_4

if TYPE_CHECKING:
    from chainbuild.ik.branches.arms.positioner import Reach

ArmName = Literal["spherical wrist", "single wrist axis", "parallel arm", "position"]

# The reason of each, for `SolverPlan`.
ARMS: Final[Mapping[str, str]] = {
    "spherical wrist": "the wrist axes meet in a point: three joints place it, three turn about it",
    "single wrist axis": "three joints place a point of the fourth axis, the fourth turns about it",
    "parallel arm": "a column, three parallel axes and a hand axis across them",
    "position": "two or three axes that place the TCP, without orientation",
}

_ACROSS: Final = 1e-9  # cosine of two axes at right angles, but for rounding
_TILTED: Final = 1e-3  # rad: what is left to the last axis is no turn about it; less is lost digits
_ALONG: Final = (0.0, 0.25, -0.25, 0.4)  # m


def arm_solver(serial: Serial, task: Task) -> tuple[ArmName, ArmSolver] | None:
    """Return name and solver of an arm, or None if no closed form is known.

    Args:
        serial: The chain as screws.
        task: What is solved for. The solvers for "direction" take the whole rotation of the target.
    """
    for candidate, backwards in ((serial, False), (serial.reversed(), True)):
        found = _forward_solver(candidate, task)
        if found is not None:
            name, solver = found
            return name, _solved_from_tool(solver) if backwards else solver
    return None


def _forward_solver(serial: Serial, task: Task) -> tuple[ArmName, ArmSolver] | None:
    screws = serial.screws
    if task == "position":
        return _position_solver(serial)
    if len(screws) not in (4, 5, 6):
        return None
    if len(screws) == 5:
        return ("parallel arm", _ParallelArm(serial).solve) if _is_parallel_arm(screws) else None
    centre = wrist_centre(screws[3:]) if len(screws) == 6 else None
    single = len(screws) == 4 and screws[3].kind == "revolute"
    reach = positioner(screws[:3]) if single or centre is not None else None
    if reach is None:
        return None
    if centre is None:
        return "single wrist axis", _SingleWrist(serial, reach).solve
    return "spherical wrist", _SphericalWrist(serial, reach, centre).solve


def _position_solver(serial: Serial) -> tuple[ArmName, ArmSolver] | None:
    if len(serial.screws) == 2:
        return "position", _TwoJoints(serial).solve
    reach = positioner(serial.screws) if len(serial.screws) == 3 else None
    return ("position", _Position(serial, reach).solve) if reach else None


def _solved_from_tool(solver: ArmSolver) -> ArmSolver:
    def solve(target: Matrix, keep: Sequence[float]) -> list[Solution]:
        return [(values[::-1], free[::-1]) for values, free in solver(inverse(target), keep[::-1])]

    return solve


def wrist_centre(screws: Sequence[Screw]) -> Vector | None:
    """Return the point where three rotary axes meet, or None."""
    if any(screw.kind != "revolute" for screw in screws):
        return None
    a, b, c = screws
    point = meeting_point(a, b)
    if point is None or parallel(b.direction, c.direction):
        return None
    return point if norm(perpendicular_part(c.direction, point - c.point)) < MEETING else None


class _Position:
    """Three axes that place the tip."""

    def __init__(self, serial: Serial, reach: Reach) -> None:
        self.tip, self.reach = serial.M[:3, 3], reach

    def solve(self, target: Matrix, keep: Sequence[float]) -> list[Solution]:
        return [(np.array(v), (False,) * 3) for v in self.reach(self.tip, target[:3, 3], keep)]


class _TwoJoints:
    """Two axes that place the tip on a surface."""

    def __init__(self, serial: Serial) -> None:
        self.screws, self.tip = serial.screws, serial.M[:3, 3]

    def solve(self, target: Matrix, keep: Sequence[float]) -> list[Solution]:
        pairs = reach_by_two(self.screws[0], self.screws[1], self.tip, target[:3, 3], keep)
        return [(np.array(pair), (False,) * 2) for pair in pairs]


class _SphericalWrist:
    """Three joints that place the wrist centre, three axes through it."""

    def __init__(self, serial: Serial, reach: Reach, centre: Vector) -> None:
        self.serial, self.reach, self.centre = serial, reach, centre
        self.back = inverse(serial.M)
        self.wrist = [screw.direction for screw in serial.screws[3:]]

    def solve(self, target: Matrix, keep: Sequence[float]) -> list[Solution]:
        motion = target @ self.back
        found: list[Solution] = []
        for arm in self.reach(self.centre, transformed_point(motion, self.centre), keep[:3]):
            R = rotation_seen_from(self.serial.screws[:3], arm, motion[:3, :3])
            solutions = for_rotation(self.wrist, R, keep[3:])
            found += [(np.array((*arm, *t.angles)), (False, False, False, *t.free)) for t in solutions]
            if not solutions:
                loose = loose_turns(self.serial.screws[:3], arm, self.centre)
                found += with_loose_turns(self.serial.screws[:3], arm, loose, self.wrist, motion[:3, :3], keep)
        return found


class _SingleWrist:
    """Three joints that place a point of the fourth axis; the fourth turns about it."""

    def __init__(self, serial: Serial, reach: Reach) -> None:
        self.serial, self.reach = serial, reach
        self.back = inverse(serial.M)
        self.point = _point_off_other_axes(serial.screws)

    def solve(self, target: Matrix, keep: Sequence[float]) -> list[Solution]:
        motion = target @ self.back
        last = self.serial.screws[3]
        aside = perpendicular(last.direction)
        found: list[Solution] = []
        for arm in self.reach(self.point, transformed_point(motion, self.point), keep[:3]):
            R = rotation_seen_from(self.serial.screws[:3], arm, motion[:3, :3])
            if norm(R @ last.direction - last.direction) > _TILTED:
                loose = loose_turns(self.serial.screws[:3], arm, self.point)
                found += with_loose_turns(self.serial.screws[:3], arm, loose, [last.direction], motion[:3, :3], keep)
                continue
            turn = subproblem_1(last.direction, aside, R @ aside, keep[3])
            found.append((np.array((*arm, turn.angle)), (False,) * 4))
        return found


def _point_off_other_axes(screws: Sequence[Screw]) -> Vector:
    """Return a point of the last axis that is on no other axis, or on few: there it does not determine their angles.

    An axis that coincides with the last one at zero has all of these points on it.
    """
    *others, last = screws
    axes = [screw for screw in others if screw.kind == "revolute"]
    points = [last.point + along * last.direction for along in _ALONG]

    def room(point: Vector) -> tuple[int, float]:
        rooms = [norm(perpendicular_part(a.direction, point - a.point)) for a in axes]
        off = [one for one in rooms if one > MEETING]
        return len(off), min(off, default=math.inf)

    return max(points, key=room)


def _is_parallel_arm(screws: Sequence[Screw]) -> bool:
    """Tell whether five rotary axes are a column, three parallel axes and a hand axis across them."""
    if any(screw.kind != "revolute" for screw in screws):
        return False
    column, a, b, c, hand = (screw.direction for screw in screws)
    return parallel(a, b) and parallel(b, c) and not parallel(column, a) and abs(float(hand @ a)) < _ACROSS


class _ParallelArm:
    """A column, three parallel axes, a hand axis across them."""

    def __init__(self, serial: Serial) -> None:
        self.screws = serial.screws
        self.back = inverse(serial.M)

    def solve(self, target: Matrix, keep: Sequence[float]) -> list[Solution]:
        motion = target @ self.back
        column, shoulder, elbow, tilt, hand = self.screws
        found: list[Solution] = []
        for first in self._columns(motion, keep[0]):
            seen = column.T(-first) @ motion
            pitch = subproblem_1(shoulder.direction, hand.direction, seen[:3, :3] @ hand.direction).angle
            arm = rotate(shoulder.direction, pitch, hand.point - tilt.point)
            wrist = transformed_point(seen, hand.point) - arm
            for pair in two_parallel_turns(shoulder, elbow, tilt.point, wrist, keep[1:3]):
                sense_b = float(shoulder.direction @ elbow.direction)
                sense_c = float(shoulder.direction @ tilt.direction)
                third = sense_c * (pitch - pair[0] - sense_b * pair[1])
                R = rotation_seen_from(self.screws[:4], (first, *pair, third), motion[:3, :3])
                aside = perpendicular(hand.direction)
                last = subproblem_1(hand.direction, aside, R @ aside, keep[4]).angle
                found.append((np.array((first, *pair, third, last)), (False,) * 5))
        return found

    def _columns(self, motion: Matrix, keep: float) -> list[float]:
        """Return the angles of the column that put the hand axis into the arm's plane."""
        column, shoulder, hand = self.screws[0], self.screws[1], self.screws[4]
        across_plane = shoulder.direction
        level = float(across_plane @ (hand.point - column.point))
        place = transformed_point(motion, hand.point) - column.point
        turns = subproblem_4(-column.direction, place, across_plane, level, keep)
        if any(turn.free for turn in turns):
            turned = motion[:3, :3] @ hand.direction
            turns = subproblem_4(-column.direction, turned, across_plane, 0.0, keep)
        return [turn.angle for turn in turns]
