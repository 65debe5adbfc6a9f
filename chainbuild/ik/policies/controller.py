"""The controller's own iterative inverse: as many steps from the last position as its machine data grant.

ITERMAXCOUNT bounds the steps, ITERPRECISION the rest at which they end (ROBX manual 7.1.7); axis 5 closer to 0 than
ITERLIMIT2 is refused with alarm 75370, 75371 or 75372 (11.5). The manual does not say what is iterated, nor what the
"internal target function" and the two limit angles exactly are. Read here as:

- Newton steps on the pose error from the start, one start only, over all free axes. The controller may treat a central
  wrist in closed form and then needs fewer steps.
- The target function is the largest component of the error, in mm and radians. A precision below what
  `tolerances` verify is met where these are: double precision cannot do better.
- Within ITERLIMIT of axis 5 at 0 the position counts as singular and the steps are damped.
- A start closer to 0 than ITERLIMIT2 is first retracted to it, on its own side.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild import tolerances
from chainbuild.chain.elements import ControllerSolver
from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.core.axis_values import turned_axes
from chainbuild.ik.branches.core.query import Query
from chainbuild.ik.result import IkResult, Status
from chainbuild.ik.start import Held
from chainbuild.kinematics.evaluation import damped_step
from chainbuild.units import mm_from_m

if TYPE_CHECKING:
    import pinocchio as pin

    from chainbuild.kinematics.mechanism import Robot

Vector = NDArray[np.float64]

_FLOOR: Final = 1e-12
_SINGULAR_DAMPING: Final = 1e-3  # share of the squared error, as in the damped solver
_FULL_TURN_DEG: Final = 360.0
ALARMS_SINGULAR: Final = (75370, 75371, 75372)  # interpreter, block preparation, interpolation


def budget_of(robot: Robot) -> ControllerSolver:
    """Return the budget that a robot's machine data grant.

    Raises:
        ChainbuildError: the data name none.
    """
    budget = robot.chain.controller_solver
    if budget is None:
        raise ChainbuildError(
            f"the machine data of {robot.chain.title} grant the controller no iteration budget",
            parameter="solver",
            permitted="auto, damped, analytic; controller only for ROBX with ITERMAXCOUNT and ITERPRECISION",
        )
    return budget


def solve_controller(
    robot: Robot, target: pin.SE3, start: ArrayLike | None, held: Held | None, budget: ControllerSolver
) -> IkResult:
    """Return what Newton steps from the start reach within the controller's budget: one start, no restarts.

    Args:
        robot: The robot.
        target: Tool in the workpiece frame [m].
        start: See `Robot.ik`; where the controller stands.
        held: See `Robot.ik`.
        budget: The controller's budget.
    """
    query = Query.of(robot, target, start, held)
    residual = robot.kinematics.residual(target, robot.task)
    free, steps = query.structure.free, 0
    x = _retracted(query, query.x0.copy(), budget)
    error, J = residual(x)
    while steps < budget.max_count and _target_function(error) > budget.precision and np.isfinite(error).all():
        damping = _SINGULAR_DAMPING * float(error @ error) if _singular(query, x, budget) else 0.0
        x = x.copy()
        x[free] += damped_step(J[:, free], error, damping + _FLOOR)
        steps += 1
        error, J = residual(x)
    if np.isfinite(x).all():
        x = next(turned_axes(query, x, free))
    distance, angle = robot.kinematics.errors(x, target, robot.task)
    status, reason = _judge(query, x, error, (distance, angle), budget)
    values = x / robot.kinematics.si_factors
    return IkResult(status == "ok", values, status, distance, angle, steps, 0, robot.task, reason)


def _target_function(error: Vector) -> float:
    """Return the largest component of an error [m, rad], in mm and radians."""
    return max(mm_from_m(float(np.abs(error[:3]).max())), float(np.abs(error[3:]).max(initial=0.0)))


def _hand_deg(query: Query, x: Vector, budget: ControllerSolver) -> float | None:
    """Return the mathematical angle of axis 5 in (-180, 180]; None where the robot has none."""
    if budget.hand_angle is None:
        return None
    return math.remainder(budget.hand_angle.value(x / query.robot.kinematics.si_factors), _FULL_TURN_DEG)


def _singular(query: Query, x: Vector, budget: ControllerSolver) -> bool:
    hand = _hand_deg(query, x, budget)
    return hand is not None and abs(hand) < budget.limit_deg


def _retracted(query: Query, x: Vector, budget: ControllerSolver) -> Vector:
    """Return a start whose axis 5 is not closer to 0 than ITERLIMIT2."""
    hand = _hand_deg(query, x, budget)
    if budget.hand_angle is None or hand is None or abs(hand) >= budget.limit2_deg:
        return x
    n = int(np.argmax(np.abs(budget.hand_angle.coefficients)))
    if n in query.structure.free:
        away = math.copysign(budget.limit2_deg, hand) - hand
        x[n] += away / budget.hand_angle.coefficients[n] * query.robot.kinematics.si_factors[n]
    return x


def _judge(
    query: Query, x: Vector, error: Vector, missed: tuple[float, float], budget: ControllerSolver
) -> tuple[Status, str]:
    """Return status and reason of where the budget ended.

    Args:
        query: The query.
        x: SI axis values at the end.
        error: Residual there [m, rad].
        missed: Distance [m] and angle [rad] to the target.
        budget: The controller's budget.
    """
    angle = 0.0 if query.robot.task == "position" else missed[1]
    close = missed[0] <= tolerances.IK_POSITION_M and angle <= tolerances.IK_ROTATION_RAD
    if not close and not _target_function(error) <= budget.precision:
        rest = _target_function(error)
        return "stalled", f"the controller's budget of {budget.max_count} iterations ends at {rest:.3g} mm or rad"
    hand = _hand_deg(query, x, budget)
    if hand is not None and abs(hand) < budget.limit2_deg:
        alarms = ", ".join(map(str, ALARMS_SINGULAR))
        text = f"axis 5 comes within {abs(hand):.4g} degrees of 0, ITERLIMIT2 is {budget.limit2_deg:g}"
        return "limits", f"{text}: alarm {alarms} (interpreter, preparation, interpolation)"
    outside = query.outside(x)
    if outside:
        return "limits", f"only reached outside the limits of {', '.join(outside)}"
    return "ok", ""
