"""Inverse kinematics without self-collision: solve, check, and solve again from another start."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.analysis.collision.paths import check_clearance
from chainbuild.chain.axismap import random_axis_values
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.collision.model import CollisionModel, bodies_of
from chainbuild.ik.solve import solve
from chainbuild.kinematics.mechanism import Mechanism

if TYPE_CHECKING:
    from chainbuild.ik.result import IkResult
    from chainbuild.kinematics.inputs import Pose

_ATTEMPTS: Final = 40  # an arm has up to 8 branches: several starts for each of them
_SEED: Final = 5  # any: the same question gets the same answer


def collision_free_ik(
    robot: Mechanism,
    T: Pose | ArrayLike,
    start: ArrayLike | None = None,
    held: Mapping[str, float] | Sequence[float] | None = None,
    *,
    bodies: CollisionModel | None = None,
    clearance: float = 0.0,
    attempts: int = _ATTEMPTS,
) -> IkResult:
    """Find axis values for a pose at which no checked pair is closer than a clearance.

    A solution that collides is rejected and the pose solved again from another start; a start leads to its nearest
    branch, so the other branches of the arm are tried in turn.

    Args:
        robot: The robot.
        T: Tool in the workpiece frame [m].
        start: Axis values to start from.
        held: As in `Robot.ik`.
        bodies: Its bodies and the pairs watched; None: all pairs that can collide.
        clearance: Smallest distance permitted [m].
        attempts: Number of starts after the first.

    Returns:
        The first solution that is free, as `Robot.ik` gives it; else the failure of `Robot.ik`, or "limits" with the
        pair that is in the way as its reason.

    Raises:
        AxisValueError: start or held of wrong count, unknown name or not finite.
        ChainbuildError: T is no rigid transform, the clearance is negative or not finite, or the bodies are another
            robot's.
    """
    check_clearance(clearance)
    model = bodies_of(robot, bodies)
    lower, upper = shown_limits(robot.chain)
    rng = np.random.default_rng(_SEED)
    result = solve(robot, T, start, held)
    if not result.success:
        return result
    blocked: IkResult | None = None
    for attempt in range(attempts + 1):
        if result.success:
            nearest = model.nearest(result.axes)
            if nearest is None or nearest.distance > clearance:
                return replace(result, restarts=result.restarts + attempt)
            if blocked is None:
                pair = " and ".join(nearest.pair)
                reason = f"every solution found collides: {pair} are {1000.0 * nearest.distance:.3g} mm apart"
                blocked = replace(result, success=False, status="limits", reason=reason)
        if attempt < attempts:
            elsewhere = random_axis_values(robot.chain.axis_map, rng, lower, upper)[0]
            for n, axis in enumerate(robot.axes):
                if axis.held:
                    elsewhere[n] = result.axes[n]
            result = solve(robot, T, elsewhere, held)
    return blocked if blocked is not None else result
