"""Redundancy resolution: a preference optimised in the null space of a solution.

A robot with more axes than its task needs can move without moving the tool. From a solution the search descends a
preference in the null space, corrects the pose after every step, and keeps the limits.
The last point that was verified is returned; it is never worse than the solution it started from.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from chainbuild import tolerances
from chainbuild.arrays import Vector
from chainbuild.chain.elements import Task
from chainbuild.errors import ChainbuildError
from chainbuild.ik.region import freedoms_of
from chainbuild.ik.request import IkRequest
from chainbuild.ik.result import IkResult
from chainbuild.kinematics.inputs import Pose
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.newton import Residual, below, newton, shrinking

Preference = Literal["near", "middle", "dexterous"]
Cost = Callable[[Vector], float]

_STEPS: Final = 200  # at most; the stride ends it before
_BACK_STEPS: Final = 8  # at most, back onto the pose after a step in the null space
_MET: Final = below(tolerances.IK_RESIDUAL_SQUARED)
_DAMPING: Final = shrinking(0.0, 1e-12)
_FIRST_STRIDE: Final = 0.3  # [m, rad], over the free axes together
_LAST_STRIDE: Final = 1e-6  # rad or m: finer than any axis is moved
_GROWTH: Final = 2.0  # of the stride after a success; halved after a failure
_DIFFERENCE: Final = 1e-6  # of central differences of the cost: the best between truncation and rounding
_RANK: Final = 1e-9  # share of the largest singular value below which a direction is in the null space
_MIN_GAIN: Final = 1e-12  # share of the cost that a step must gain
_AT_LIMIT: Final = 1e-9  # an axis this close to its limit [m, rad] counts as being at it


def preferred(request: IkRequest, found: IkResult, prefer: Preference | None) -> IkResult:
    """Return a solution moved to the optimum of a preference without moving the tool.

    Args:
        request: The request; "near" refers to its start, else to the middle of the limits.
        found: A solution; a failure is returned as it is.
        prefer: "near": as near to the start as the pose allows [m and rad alike]; "middle": every axis as near to the
            middle of its limits as possible, as a share of their range; "dexterous": away from singularities, where
            the product of the singular values of the Jacobian (metres, radians) is large; None: nothing.

    Raises:
        AxisValueError: held has a wrong number of values, an unknown name or a non-finite value.
        ChainbuildError: an unknown preference.
    """
    if prefer is None:
        return found
    if prefer not in get_args(Preference):
        raise ChainbuildError(
            f"unknown preference {prefer!r}", parameter="prefer", permitted=", ".join(get_args(Preference))
        )
    x0, fixed = request.start_point()
    if not found.success:
        return found
    mechanism = request.mechanism
    x = found.axes * mechanism.kinematics.si_factors
    residual = mechanism.kinematics.residual(request.pose, found.task)
    search = _Search(mechanism, request.pose, residual, found.task, np.flatnonzero(~fixed))
    return search.run(found, x, search.costs(x0)[prefer])


@dataclass(frozen=True, slots=True, eq=False)
class _Search:
    """One descent.

    Attributes:
        mechanism: The mechanism.
        target: Tool in the workpiece frame [m].
        residual: Error and Jacobian of the task.
        task: The task.
        free: Indices of the axes that may move.
    """

    mechanism: Mechanism
    target: Pose
    residual: Residual
    task: Task
    free: NDArray[np.intp]

    def costs(self, x0: Vector) -> dict[str, Cost]:
        """Return the cost function of each preference."""
        axes, factors = self.mechanism.axes, self.mechanism.kinematics.si_factors
        middle = np.array([0.5 * (axis.lower + axis.upper) for axis in axes]) * factors
        half = np.array([0.5 * (axis.upper - axis.lower) for axis in axes]) * factors

        def near(x: Vector) -> float:
            return float(((x - x0) ** 2).sum())

        def centred(x: Vector) -> float:
            return float((((x - middle) / half) ** 2).sum())

        def clumsy(x: Vector) -> float:
            values = np.linalg.svd(self.residual(x)[1][:, self.free], compute_uv=False)
            return -float(np.prod(values))

        return {"near": near, "middle": centred, "dexterous": clumsy}

    def run(self, found: IkResult, x: Vector, cost: Cost) -> IkResult:
        best, stride = cost(x), _FIRST_STRIDE
        begin = best
        steps = 0
        while steps < _STEPS and stride > _LAST_STRIDE:
            steps += 1
            direction = self.downhill(x, cost)
            if direction is None:
                break
            there = self.projected_on_pose(self.clamped(x + stride * direction))
            if there is not None and cost(there) < best - _MIN_GAIN * max(1.0, abs(best)):
                x, best, stride = there, cost(there), stride * _GROWTH
            else:
                stride /= _GROWTH
        if best >= begin:
            return found
        distance, angle = self.mechanism.kinematics.errors(x, self.target, found.task)
        return replace(
            found,
            axes=x / self.mechanism.kinematics.si_factors,
            position_error=distance,
            rotation_error=angle,
            iterations=found.iterations + steps,
        )

    def downhill(self, x: Vector, cost: Cost) -> Vector | None:
        """Return the direction of length 1 that lowers the cost fastest without moving the tool, or None.

        Axes at a limit that would leave it are excluded.
        """
        gradient = np.zeros(len(x))
        for n in self.free:
            step = np.zeros(len(x))
            step[n] = _DIFFERENCE
            gradient[n] = (cost(x + step) - cost(x - step)) / (2.0 * _DIFFERENCE)
        lower, upper = self.limits()
        moving = list(self.free)
        for _ in range(len(self.free)):
            J = self.residual(x)[1][:, moving]
            slope = gradient[moving]
            N = _null_space(J)
            step = -(N @ (N.T @ slope))
            blocked = [
                k for k, n in enumerate(moving)
                if (x[n] <= lower[n] + _AT_LIMIT and step[k] < 0.0) or (x[n] >= upper[n] - _AT_LIMIT and step[k] > 0.0)
            ]  # fmt: skip
            if not blocked:
                length = float(np.linalg.norm(step))
                if length < tolerances.ZERO_VECTOR:
                    return None
                direction = np.zeros(len(x))
                direction[moving] = step / length
                return direction
            moving = [n for k, n in enumerate(moving) if k not in blocked]
            if not moving:
                return None
        return None

    def projected_on_pose(self, x: Vector) -> Vector | None:
        """Return a point near x where the tool is on the target and all limits are kept, or None."""
        ended = newton(self.residual, x, self.free, _MET, _DAMPING, _BACK_STEPS)
        if not ended.met or self.mechanism.limits.violated(ended.x / self.mechanism.kinematics.si_factors):
            return None
        return ended.x

    def clamped(self, x: Vector) -> Vector:
        lower, upper = self.limits()
        moved = x.copy()
        moved[self.free] = np.clip(x[self.free], lower[self.free], upper[self.free])
        return moved

    def limits(self) -> tuple[Vector, Vector]:
        box = freedoms_of(self.mechanism).box
        return box.lower, box.upper


def _null_space(J: Vector) -> Vector:
    """Return orthonormal columns that J maps to zero."""
    _, values, Vt = np.linalg.svd(J)
    rank = int((values > _RANK * values[0]).sum()) if values.size else 0
    null: Vector = Vt[rank:].T
    return null
