"""Limits on sums of axes, such as the angle of a parallelogram: no answer that violates one leaves the solvers."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from chainbuild import tolerances
from chainbuild.chain.elements import AxisConstraint
from chainbuild.ik.branches.analytic import in_closed_form
from chainbuild.ik.result import IkResult
from chainbuild.ik.start import Held

if TYPE_CHECKING:
    import pinocchio as pin

    from chainbuild.kinematics.mechanism import Robot


def violated(robot: Robot, axes: ArrayLike) -> tuple[AxisConstraint, ...]:
    """Return the limits on sums of axes that axis values (n_axes,) violate."""
    return tuple(c for c in robot.chain.constraints if c.margin(axes) < -tolerances.LIMIT_SUM_DEG)


def kept(
    robot: Robot, found: IkResult, target: pin.SE3, start: ArrayLike | None, held: Held | None, solver: str
) -> IkResult:
    """Return an answer that keeps the limits on sums of axes: the one found, another branch, or a refusal.

    Args:
        robot: The robot.
        found: What a solver came up with.
        target: Tool in the workpiece frame [m].
        start: See `Robot.ik`.
        held: See `Robot.ik`.
        solver: What was asked for; "auto" looks for another branch where a closed form is known.
    """
    broken = violated(robot, found.axes) if found.success else ()
    if not broken:
        return found
    other = in_closed_form(robot, target, start, held) if solver == "auto" else None
    if other is not None and other.success:
        return other
    names = ", ".join(c.name if c.alarm is None else f"{c.name} (alarm {c.alarm})" for c in broken)
    reason = f"only reached outside the limits of {names}"
    return replace(found, success=False, status="limits", reason=reason, violated=tuple(c.name for c in broken))
