"""The last look at an answer: every axis inside its limits to the last digit, held axes included."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from chainbuild import tolerances
from chainbuild.ik.result import IkResult
from chainbuild.kinematics.inputs import as_pose

if TYPE_CHECKING:
    import pinocchio as pin
    from numpy.typing import ArrayLike

    from chainbuild.kinematics.mechanism import Robot

Vector = NDArray[np.float64]

_ROUNDED: Final = 1e-6  # mm or degrees: an axis this close beyond its limit stands on it, but for rounding

_limits: WeakKeyDictionary[Robot, tuple[Vector, Vector]] = WeakKeyDictionary()


def limits_of(robot: Robot) -> tuple[Vector, Vector]:
    """Return lower and upper limits (n_axes,) in mm and degrees, infinite where an axis is endless."""
    found = _limits.get(robot)
    if found is None:
        lower = np.array([-np.inf if axis.endless else axis.lower for axis in robot.axes])
        upper = np.array([np.inf if axis.endless else axis.upper for axis in robot.axes])
        found = _limits[robot] = (lower, upper)
    return found


def kept_within(robot: Robot, found: IkResult, T: pin.SE3 | ArrayLike) -> IkResult:
    """Return an answer with its axes on the inner side of their limits, or as a failure where they are not.

    Args:
        robot: The robot.
        found: What a solver answered.
        T: The pose asked for.
    """
    if not found.success:
        return found
    lower, upper = limits_of(robot)
    axes = np.minimum(np.maximum(found.axes, lower), upper)
    beyond = np.abs(axes - found.axes)
    worst = float(beyond.max(initial=0.0))
    if worst == 0.0:
        return found
    if worst > _ROUNDED:
        outside = [n for n, far in enumerate(beyond) if far > _ROUNDED]
        return _outside(robot, found, outside)
    x = axes * robot.kinematics.si_factors
    distance, angle = robot.kinematics.errors(x, as_pose(T), found.task)
    met = distance <= tolerances.IK_POSITION_M and (found.task == "position" or angle <= tolerances.IK_ROTATION_RAD)
    return replace(found, axes=axes, position_error=distance, rotation_error=angle) if met else found


def _outside(robot: Robot, found: IkResult, outside: Sequence[int]) -> IkResult:
    names = tuple(robot.axes[n].name for n in outside)
    parts = [
        f"{axis.name} stands at {found.axes[n]:.6g}, outside {axis.lower:g} … {axis.upper:g} {axis.unit}"
        for n, axis in ((n, robot.axes[n]) for n in outside)
    ]
    return replace(found, success=False, status="limits", reason="; ".join(parts), violated=names)
