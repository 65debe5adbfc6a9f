"""The controller's own budget: as many steps from the last position as its machine data allow (ROBX manual 7.1.7)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np
from numpy.typing import ArrayLike

from chainbuild import tolerances
from chainbuild.errors import ChainbuildError
from chainbuild.robot.kinematics import damped_step
from chainbuild.solve.branches import verified
from chainbuild.solve.query import Query
from chainbuild.solve.result import IkResult, Status
from chainbuild.solve.start import Held
from chainbuild.units import mm_from_m, rad_from_deg

if TYPE_CHECKING:
    import pinocchio as pin

    from chainbuild.robot.robot import Robot

_FLOOR: Final = 1e-12
_HAND_AXIS: Final = 4
ALARM_SINGULAR: Final = 75370


class Budget(Protocol):
    """What the controller grants its iterative inverse.

    Attributes:
        max_count: Largest number of steps.
        precision: Bound of what may remain; read here as the larger of mm and radians, for the manual names no unit.
        limit2_deg: With |A5| below this the controller raises an alarm; 0 switches it off.
    """

    @property
    def max_count(self) -> int: ...  # noqa: D102

    @property
    def precision(self) -> float: ...  # noqa: D102

    @property
    def limit2_deg(self) -> float: ...  # noqa: D102


def budget_of(robot: Robot) -> Budget:
    """Return the budget that a robot's machine data grant.

    Raises:
        ChainbuildError: the data name none.
    """
    budget: Budget | None = getattr(robot.chain, "controller_solver", None)
    if budget is None:
        raise ChainbuildError(
            f"the machine data of {robot.chain.title} grant the controller no iteration budget",
            parameter="solver",
            permitted="auto, damped, analytic; controller only for ROBX with ITERMAXCOUNT and ITERPRECISION",
        )
    return budget


def solve_controller(
    robot: Robot, target: pin.SE3, start: ArrayLike | None, held: Held | None, budget: Budget
) -> IkResult:
    """Return what Newton steps from the start reach within the controller's budget: one start, no restarts.

    Args:
        robot: The robot.
        target: Tool in the workpiece frame [m].
        start: See `Robot.ik`.
        held: See `Robot.ik`.
        budget: The controller's budget.
    """
    query = Query.of(robot, target, start, held)
    residual = robot.kinematics.residual(target, robot.task)
    free, x, steps = query.structure.free, query.x0.copy(), 0
    error, J = residual(x)
    while steps < budget.max_count and not _met(error, budget.precision):
        x[free] += damped_step(J[:, free], error, _FLOOR)
        steps += 1
        error, J = residual(x)
    x = _near_zero_turns(query, x)
    distance, angle = robot.kinematics.errors(x, target, robot.task)
    status, reason = _judge(query, x, error, budget)
    values = x / query.robot.kinematics.si_factors
    return IkResult(status == "ok", values, status, distance, angle, steps, 0, robot.task, reason)


def _met(error: np.ndarray, precision: float) -> bool:
    """Tell whether the error [m, rad] is within the precision, lengths counted in mm."""
    return bool(max(mm_from_m(np.abs(error[:3]).max()), np.abs(error[3:]).max(initial=0.0)) <= precision)


def _near_zero_turns(query: Query, x: np.ndarray) -> np.ndarray:
    """Return x with axes outside their limits moved back inside by whole turns where that does not change the pose."""
    moved = x.copy()
    for n in np.flatnonzero(query.periodic):
        if not query.lower[n] <= x[n] <= query.upper[n]:
            moved[n] = math.remainder(float(x[n]), math.tau)
    return moved


def _judge(query: Query, x: np.ndarray, error: np.ndarray, budget: Budget) -> tuple[Status, str]:
    """Return status and reason of where the budget ended."""
    axes = query.robot.axes
    if len(axes) > _HAND_AXIS and abs(x[_HAND_AXIS]) < rad_from_deg(budget.limit2_deg):
        return "stalled", f"{axes[_HAND_AXIS].name} is within ITERLIMIT2: the controller raises alarm {ALARM_SINGULAR}"
    close = np.isfinite(error).all() and np.linalg.norm(error[:3]) < tolerances.IK_POSITION_M
    if not close or verified(query, x) is None:
        return "stalled", f"the controller's budget of {budget.max_count} iterations ends before the pose is met"
    outside = query.outside(x)
    if outside:
        return "limits", f"only reached outside the limits of {', '.join(outside)}"
    return "ok", ""
