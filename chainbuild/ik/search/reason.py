"""Why a pose was not reached, as text."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Final

from chainbuild.arrays import Matrix, Vector
from chainbuild.ik import rules
from chainbuild.ik.request import IkOptions
from chainbuild.ik.search.found import SearchEnd
from chainbuild.ik.search.problem import Problem

Search = Callable[[Problem, Matrix, Vector | None, IkOptions], SearchEnd]

_RESTARTS: Final = 8  # enough for the position alone


def reason_of(problem: Problem, target: Matrix, found: SearchEnd, options: IkOptions, search: Search) -> str:
    """Return why a search did not reach the target.

    Args:
        problem: The problem.
        target: (4, 4) tool in the workpiece frame [m].
        found: The outcome of the search, not OK.
        options: The options it had.
        search: The search to use for the position alone.
    """
    if problem.held_beyond:
        return "an axis is held outside its limits: " + ", ".join(problem.held_beyond)
    if found.outcome == rules.LIMITS:
        return "reached only outside the limits: " + ", ".join(_violations(problem, found.outside))
    if found.outcome == rules.STALLED:
        return f"the search ended {_gap(found)} from the pose"
    return _unreachable(problem, target, found, options, search)


def _unreachable(problem: Problem, target: Matrix, found: SearchEnd, options: IkOptions, search: Search) -> str:
    """Separate a pose that is too far or too near from one whose orientation cannot be reached."""
    if problem.beyond_bound(target):
        distance = math.dist(target[:3, 3], (0.0, 0.0, 0.0))
        reach = f"the kinematic reaches {problem.reach * 1000:.1f} mm"
        within = " with its linear axes inside their limits" if "mm" in problem.mechanism.labels.units_of_axes else ""
        return f"too far: {distance * 1000:.1f} mm from the workpiece frame, {reach}{within}"
    place = found
    if problem.turns and problem.weights[:3].any():
        place = search(problem.position_only(), target, found.y, replace(options, max_restarts=_RESTARTS))
        if place.outcome == rules.OK:
            what = "orientation" if problem.axis < 0 else "tool direction"
            words = f"the position can be reached, but not with this {what}; the nearest pose is {_gap(found)} away"
            return words + _arm_too_short(problem, target)
        if place.outcome == rules.LIMITS:
            limits = ", ".join(_violations(problem, place.outside))
            return f"the position is reached only outside the limits ({limits}), the orientation not at all"
    words = f"{_far_or_near(problem, target, place)}: the tool ends {place.distance * 1000:.3f} mm off"
    return words + _arm_too_short(problem, target)


def _arm_too_short(problem: Problem, target: Matrix) -> str:
    """Return the proof if there is one: the length of the arm between its first and its last axis."""
    arm = problem.arm_too_short(target)
    if arm is None:
        return ""
    return f" (the arm would have to be {arm.distance(target) * 1000:.1f} mm long, it is {arm.length * 1000:.1f} mm)"


def _violations(problem: Problem, y: Vector) -> list[str]:
    limits, values = problem.mechanism.limits, problem.shown(y)
    words = []
    for n in limits.own_outside(values):
        axis, value = limits.axes[n], float(values[n])
        bound = float(limits.lower[n] if value < limits.lower[n] else limits.upper[n])
        words.append(f"{axis.name} at {value:.3f} {axis.unit} (limit {bound:.3f})")
    return words + [text for _, text in limits.joint_violations(values)]


def _gap(found: SearchEnd) -> str:
    return f"{found.distance * 1000:.3f} mm and {math.degrees(found.angle):.3f}°"


def _far_or_near(problem: Problem, target: Matrix, place: SearchEnd) -> str:
    """Return the side of the reachable positions on which a target lies, seen from their middle."""
    kinematics, centre = problem.mechanism.kinematics, problem.starts.centre
    nearest = kinematics.pose(kinematics.q(problem.full(place.y))).translation
    far = math.dist(target[:3, 3], centre) > math.dist(nearest, centre)
    return "too far" if far else "too near"
