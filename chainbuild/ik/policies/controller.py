"""The controller's own iterative inverse: Newton steps from the last position, as many as its machine data permit.

ITERMAXCOUNT bounds the steps, ITERPRECISION is the residual that ends them (ROBX manual 7.1.7); axis 5 closer to 0
than ITERLIMIT2 raises alarm 75370, 75371 or 75372 (11.5). The manual does not say what is iterated, nor what the
"internal target function" and the two limit angles exactly are. They are interpreted here as:

- Newton steps on the pose error from the start, one start only, over all free axes. The controller may treat a central
  wrist in closed form and then needs fewer steps.
- The target function is the largest component of the error, in mm and radians. A precision finer
  than `tolerances` counts as met if these are met: double precision cannot do better.
- Within ITERLIMIT of axis 5 at 0 the position counts as singular and the steps are damped.
- A start closer to 0 than ITERLIMIT2 is first retracted to it, on its own side.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.elements import ControllerSolver
from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.core.axis_values import turned_axes
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.request import IkRequest
from chainbuild.ik.result import IkResult, Status
from chainbuild.ik.verify import is_met
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.newton import newton
from chainbuild.units import mm_from_m

_FLOOR: Final = 1e-12  # keeps the factorisation alive at singular points
_SINGULAR_DAMPING: Final = 1e-3  # share of the squared error, as in the damped solver
_FULL_TURN_DEG: Final = 360.0  # angles that differ by it are one place
ALARMS_SINGULAR: Final = (75370, 75371, 75372)  # interpreter, block preparation, interpolation


def budget_of(mechanism: Mechanism) -> ControllerSolver:
    """Return the iteration budget in a robot's machine data.

    Raises:
        ChainbuildError: the machine data give no budget.
    """
    budget = mechanism.chain.controller_solver
    if budget is None:
        raise ChainbuildError(
            f"the machine data of {mechanism.chain.title} give no iteration budget for the controller's solver",
            parameter="solver",
            permitted="auto, damped, analytic; controller only for ROBX with ITERMAXCOUNT and ITERPRECISION",
        )
    return budget


def solve_controller(request: IkRequest) -> IkResult:
    """Return what Newton steps from the start reach within the controller's budget: one start, no restarts.

    Raises:
        ChainbuildError: the machine data give no budget.
    """
    mechanism = request.mechanism
    budget, query = budget_of(mechanism), BranchQuery.of(request)
    residual = mechanism.kinematics.residual(query.target, mechanism.task)

    def damping(x: Vector, error: Vector) -> float:
        singular = _SINGULAR_DAMPING * float(error @ error) if _singular(query, x, budget) else 0.0
        return singular + _FLOOR

    ended = newton(
        residual,
        _retracted(query, query.x0.copy(), budget),
        query.structure.free,
        lambda error: _target_function(error) <= budget.precision,
        damping,
        budget.max_count,
    )
    x = ended.x
    if np.isfinite(x).all():
        x = next(turned_axes(query, x, query.structure.free))
    distance, angle = mechanism.kinematics.errors(x, query.target, mechanism.task)
    status, reason = _assessed(query, x, ended.error, (distance, angle), budget)
    return IkResult(
        status == "ok", query.shown(x), status, distance, angle, ended.steps, 0, mechanism.task, mechanism.labels,
        reason, mechanism.limits.violated(query.shown(x)) if status == "limits" else (),
    )  # fmt: skip


def _target_function(error: Vector) -> float:
    """Return the largest component of an error [m, rad], in mm and radians."""
    return max(mm_from_m(float(np.abs(error[:3]).max())), float(np.abs(error[3:]).max(initial=0.0)))


def _hand_deg(query: BranchQuery, x: Vector, budget: ControllerSolver) -> float | None:
    """Return the mathematical angle of axis 5 in (-180, 180]; None where the robot has none."""
    if budget.hand_angle is None:
        return None
    return math.remainder(budget.hand_angle.value(query.shown(x)), _FULL_TURN_DEG)


def _singular(query: BranchQuery, x: Vector, budget: ControllerSolver) -> bool:
    hand = _hand_deg(query, x, budget)
    return hand is not None and abs(hand) < budget.limit_deg


def _retracted(query: BranchQuery, x: Vector, budget: ControllerSolver) -> Vector:
    """Return a start with axis 5 no closer to 0 than ITERLIMIT2."""
    hand = _hand_deg(query, x, budget)
    if budget.hand_angle is None or hand is None or abs(hand) >= budget.limit2_deg:
        return x
    n = int(np.argmax(np.abs(budget.hand_angle.coefficients)))
    if n in query.structure.free:
        away = math.copysign(budget.limit2_deg, hand) - hand
        x[n] += away / budget.hand_angle.coefficients[n] * query.mechanism.kinematics.si_factors[n]
    return x


def _assessed(
    query: BranchQuery, x: Vector, error: Vector, missed: tuple[float, float], budget: ControllerSolver
) -> tuple[Status, str]:
    """Return status and reason at the end of the budget.

    Args:
        query: The query.
        x: SI axis values at the end.
        error: Residual there [m, rad].
        missed: Distance [m] and angle [rad] to the target.
        budget: The controller's budget.
    """
    if not is_met(query.mechanism.task, *missed) and not _target_function(error) <= budget.precision:
        rest = _target_function(error)
        return "stalled", f"the controller's budget of {budget.max_count} iterations leaves {rest:.3g} mm or rad"
    hand = _hand_deg(query, x, budget)
    if hand is not None and abs(hand) < budget.limit2_deg:
        alarms = ", ".join(map(str, ALARMS_SINGULAR))
        text = f"axis 5 is {abs(hand):.4g} degrees from 0, ITERLIMIT2 is {budget.limit2_deg:g} degrees"
        return "limits", f"{text}: alarm {alarms} (interpreter, preparation, interpolation)"
    outside = query.mechanism.limits.violated(query.shown(x))
    if outside:
        return "limits", f"reached only outside the limits of {', '.join(outside)}"
    return "ok", ""
