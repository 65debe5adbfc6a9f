"""Branches: verified, inside the limits, once each, nearest first."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild import tolerances
from chainbuild.ik.branches.core.query import Query
from chainbuild.ik.result import IkResult
from chainbuild.kinematics.evaluation import damped_step

Vector = NDArray[np.float64]

# Errors above this are polished by Newton steps: closed forms lose digits near singular points.
_POLISH_FROM: Final = 1e-11
# Errors above this are no lost digits but another place.
_POLISH_TO: Final = 1e-3
_POLISH_STEPS: Final = 3
_POLISH_DAMPING: Final = 1e-14
_SAME: Final = 1e-5  # branches closer than this in every axis [m, rad] are one


@dataclass(frozen=True, slots=True, eq=False)
class Branch(IkResult):
    """One of the solutions for a pose.

    Attributes:
        free_axes: Names of axes that have no bearing on this pose; they keep their start value.
        status_bits: Pose status as the controller numbers it (KIN_TYP 45), else None.
        turn_bits: Signs of the axes as the controller numbers them (KIN_TYP 45), else None.
        method: What found it; see `analytic.method_of`.
    """

    free_axes: tuple[str, ...] = ()
    status_bits: int | None = None
    turn_bits: int | None = None
    method: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What a closed form came up with.

    Attributes:
        branches: Solutions inside all limits, nearest first.
        beyond: The nearest solution outside them, or None.
        outside: Names of the limits in the way where there is no branch inside.
    """

    branches: tuple[Branch, ...]
    beyond: Branch | None
    outside: tuple[str, ...]


def verified(query: Query, x: Vector) -> Branch | None:
    """Return x as a branch if forward kinematics meets the target, polished by Newton steps where it helps."""
    kinematics, task = query.robot.kinematics, query.robot.task
    for attempt in range(_POLISH_STEPS + 1):
        distance, angle = kinematics.errors(x, query.target, task)
        if not math.isfinite(distance + angle):
            return None
        judged = 0.0 if task == "position" else angle
        if attempt == 0 and max(distance, judged) > _POLISH_TO:
            return None
        if max(distance, judged) < _POLISH_FROM or attempt == _POLISH_STEPS:
            break
        x = _newton(query, x)
    if distance > tolerances.IK_POSITION_M or judged > tolerances.IK_ROTATION_RAD:
        return None
    return Branch(True, x / kinematics.si_factors, "ok", distance, angle, attempt, 0, task)


def _newton(query: Query, x: Vector) -> Vector:
    error, J = query.robot.kinematics.residual(query.target, query.robot.task)(x)
    moved = x.copy()
    moved[query.structure.free] += damped_step(J[:, query.structure.free], error, _POLISH_DAMPING)
    return moved


def collect(query: Query, candidates: Iterable[tuple[Vector, tuple[str, ...]]]) -> Found:
    """Return the candidates that are solutions, once each, sorted by distance to the start.

    Args:
        query: The query.
        candidates: SI axis values and the names of axes that are free there.
    """
    inside: list[tuple[float, Branch]] = []
    beyond: list[tuple[float, Branch, tuple[str, ...]]] = []
    factors = query.robot.kinematics.si_factors
    for x, free_axes in candidates:
        branch = verified(query, x)
        if branch is None:
            continue
        reached = branch.axes * factors
        if any(np.abs(reached - other.axes * factors).max() < _SAME for _, other in inside):
            continue
        out = query.outside(reached)
        branch = replace(branch, free_axes=free_axes)
        if out:
            beyond.append((query.distance(reached), branch, out))
        else:
            inside.append((query.distance(reached), branch))
    inside.sort(key=lambda item: item[0])
    nearest = min(beyond, key=lambda item: item[0], default=None)
    outside = () if nearest is None or inside else nearest[2]
    return Found(tuple(branch for _, branch in inside), None if nearest is None else nearest[1], outside)
