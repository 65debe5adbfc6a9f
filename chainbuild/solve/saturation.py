"""Limits kept by robots with more axes than their task needs: what is beyond a limit is put there and left alone.

A solution found without regard to limits is mended axis by axis: whatever lies outside its limits is fixed at the
nearer one, and the remaining axes are brought back to the pose, until nothing lies outside or too few axes are left.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild import tolerances
from chainbuild.robot.kinematics import Residual, damped_step
from chainbuild.solve.freedoms import Box, freedoms_of
from chainbuild.solve.result import IkResult
from chainbuild.solve.start import Held, start_point

if TYPE_CHECKING:
    import pinocchio as pin

    from chainbuild.robot.robot import Robot

Vector = NDArray[np.float64]

_ROWS: Final = {"pose": 6, "direction": 5, "position": 3}
_STARTS: Final = 60
_NEWTON_STEPS: Final = 25
_DAMPING: Final = 1e-3  # share of the squared error
_FLOOR: Final = 1e-12
_ENDLESS: Final = np.pi  # random starts of axes without end are drawn from ± this


def within_limits(
    robot: Robot, found: IkResult, target: pin.SE3, start: ArrayLike | None = None, held: Held | None = None
) -> IkResult:
    """Return a solution inside the limits in place of one that was found outside only, where there is one.

    Args:
        robot: The robot.
        found: What a solver came up with; anything but a failure by limits is returned as it is.
        target: Tool in the workpiece frame [m].
        start: See `Robot.ik`.
        held: See `Robot.ik`.
    """
    if found.success or found.status != "limits":
        return found
    x0, fixed = start_point(robot, start, held)
    free = np.flatnonzero(~fixed)
    if len(free) <= _ROWS[found.task]:
        return found
    residual = robot.kinematics.residual(target, found.task)
    box = freedoms_of(robot).box
    first = x0.copy()
    first[free] = (found.axes * robot.kinematics.si_factors)[free]
    for x in _starts(box, first, free):
        mended = _mended(residual, box, x, free)
        if mended is None:
            continue
        axes = mended / robot.kinematics.si_factors
        distance, angle = robot.kinematics.errors(mended, target, found.task)
        met = distance <= tolerances.IK_POSITION_M and (found.task == "position" or angle <= tolerances.IK_ROTATION_RAD)
        if met and not robot.violated_limits(axes):
            mended_result = replace(found, success=True, status="ok", axes=axes, reason="", violated=())
            return replace(mended_result, position_error=distance, rotation_error=angle)
    return found


def _starts(box: Box, first: Vector, free: NDArray[np.intp]) -> Iterator[Vector]:
    yield first
    rng = np.random.default_rng(20240229)
    lower = np.where(np.isfinite(box.lower), box.lower, -_ENDLESS)[free]
    upper = np.where(np.isfinite(box.upper), box.upper, _ENDLESS)[free]
    for _ in range(_STARTS):
        x = first.copy()
        x[free] = lower + (upper - lower) * rng.random(len(free))
        yield x


def _mended(residual: Residual, box: Box, x: Vector, free: NDArray[np.intp]) -> Vector | None:
    """Return a point of the task inside the limits, or None where this start leads to none."""
    moving = list(free)
    for _ in range(len(free)):
        met = _brought(residual, x, moving)
        if met is None:
            return None
        x = box.into(met)
        outside = [n for n in moving if not box.lower[n] <= x[n] <= box.upper[n]]
        if not outside:
            return x
        x[outside] = np.clip(x[outside], box.lower[outside], box.upper[outside])
        moving = [n for n in moving if n not in outside]
    return None


def _brought(residual: Residual, x: Vector, moving: list[int]) -> Vector | None:
    """Return x with some axes moved so that the task is met, or None."""
    x = x.copy()
    for _ in range(_NEWTON_STEPS):
        error, J = residual(x)
        squared = float(error @ error)
        if squared < tolerances.IK_RESIDUAL_SQUARED:
            return x
        if not moving:
            return None
        x[moving] += damped_step(J[:, moving], error, _DAMPING * squared + _FLOOR)
    return None
