"""Verification of answers: the pose is met, and axes that rounding put beyond a limit are moved onto it."""

from __future__ import annotations

from chainbuild.arrays import Vector
from chainbuild.chain.elements import Task
from chainbuild.kinematics.inputs import Pose
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.tolerances import IK_POSITION_M, IK_ROTATION_RAD


def is_met(task: Task, distance: float, angle: float) -> bool:
    """Return whether a distance [m] and an angle [rad] to a pose are within tolerance."""
    return distance <= IK_POSITION_M and (task == "position" or angle <= IK_ROTATION_RAD)


def on_limits(mechanism: Mechanism, target: Pose, axes: Vector, task: Task) -> tuple[Vector, float, float] | None:
    """Return axis values moved onto the limits that rounding put them beyond, with the errors they then have.

    Args:
        mechanism: Whose axes.
        target: Tool in the workpiece frame [m].
        axes: (n_axes,) mm and degrees, none farther beyond its limit than `tolerances.LIMIT_SLACK`.
        task: What was solved for.

    Returns:
        Axis values, distance [m], angle [rad]; None if no axis has to move, or the pose would not be met then.
    """
    if not mechanism.limits.is_beyond(axes):
        return None
    moved = mechanism.limits.onto(axes)
    distance, angle = mechanism.kinematics.errors(moved * mechanism.kinematics.si_factors, target, task)
    return (moved, distance, angle) if is_met(task, distance, angle) else None
