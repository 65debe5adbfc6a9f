"""Damped inverse kinematics on Pinocchio's Jacobians.

Each step solves (JᵀJ + λ·1)·dx = Jᵀ·e with λ proportional to the squared error (Sugihara 2011): far away the step is
short and safe, close by it is Newton's. A start that stops getting better is left for another one; steps that end
outside a limit are first wrapped by whole turns, then clamped. Every answer is verified by forward kinematics.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild import tolerances
from chainbuild.errors import AxisValueError
from chainbuild.robot.kinematics import Residual, Vector, damped_step
from chainbuild.solve.freedoms import Freedoms, freedoms_of
from chainbuild.solve.result import IkResult, Status

if TYPE_CHECKING:
    import pinocchio as pin

    from chainbuild.robot.robot import Robot

_DAMPING: Final = 1e-3  # share of the squared error; 1e-3…1e-1 works, a constant loses targets
_DAMPING_FLOOR: Final = 1e-12  # keeps the factorisation alive at singular points
_MAX_STEPS: Final = 60
_STALL_STEPS: Final = 4
_STALL_SHARE: Final = 0.9
_RESTARTS: Final = 60
_FREE_RESTARTS: Final = 12  # starts without limits, once those within them have failed
_CLOSE: Final = 1e-3  # a remaining error below this is called "stalled", not "unreachable"


@dataclass(slots=True)
class _Best:
    """The best point seen, by its residual norm."""

    x: Vector
    error: float = math.inf


def solve(
    robot: Robot,
    target: pin.SE3,
    start: ArrayLike | None = None,
    held: Mapping[str, float] | Sequence[float] | None = None,
) -> IkResult:
    """Find axis values for a pose.

    Args:
        robot: The robot.
        target: Tool in the workpiece frame [m].
        start: Axis values (n_axes,), mm and degrees; None: near the middle of the limits.
        held: See `Robot.ik`.

    Raises:
        AxisValueError: start or held of wrong count, unknown name or not finite.
    """
    freedoms = freedoms_of(robot)
    x0, fixed = _start_point(robot, freedoms, start, held)
    search = _Search(robot, freedoms, target, x0, fixed)
    return search.run()


def _start_point(
    robot: Robot,
    freedoms: Freedoms,
    start: ArrayLike | None,
    held: Mapping[str, float] | Sequence[float] | None,
) -> tuple[Vector, NDArray[np.bool_]]:
    """Return the SI start values and which axes are fixed at them."""
    axes = robot.axes
    values = freedoms.middle / freedoms.si_factors if start is None else robot.axis_values(start).copy()
    fixed = np.array([axis.held for axis in axes])
    if start is None:
        values[fixed] = 0.0
    for name, value in _held_values(robot, held).items():
        index = next((n for n, axis in enumerate(axes) if axis.name == name), None)
        if index is None:
            known = ", ".join(axis.name for axis in axes)
            raise AxisValueError(f"there is no axis '{name}' to hold", parameter="held", permitted=known)
        values[index], fixed[index] = value, True
    return robot.axis_values(values) * freedoms.si_factors, fixed


def _held_values(robot: Robot, held: Mapping[str, float] | Sequence[float] | None) -> Mapping[str, float]:
    if held is None:
        return {}
    if isinstance(held, Mapping):
        return held
    names = [axis.name for axis in robot.axes if axis.held]
    if len(held) != len(names):
        raise AxisValueError(
            f"{len(held)} held values are given, the robot has {len(names)} input axes",
            parameter="held",
            permitted=", ".join(names) or "a mapping of axis name to value",
        )
    return dict(zip(names, held, strict=True))


class _Search:
    """One inverse-kinematics search: the state that restarts share."""

    def __init__(self, robot: Robot, freedoms: Freedoms, target: pin.SE3, x0: Vector, fixed: NDArray[np.bool_]) -> None:
        self.robot = robot
        self.freedoms = freedoms
        self.target = target
        self.x0 = x0
        self.free = np.flatnonzero(~fixed)
        self.task = robot.task
        self.residual = self._over_free_axes(robot.kinematics.residual(target, self.task))
        self.best = _Best(x0)
        self.iterations = 0

    def _over_free_axes(self, residual: Residual) -> Residual:
        """Restrict a residual to the free axes."""
        if len(self.free) == len(self.x0):
            return residual
        full, free = self.x0.copy(), self.free

        def restricted(y: Vector) -> tuple[Vector, NDArray[np.float64]]:
            full[free] = y
            error, J = residual(full)
            return error, J[:, free]

        return restricted

    def run(self) -> IkResult:
        """Search from the start, then from random starts, then say why nothing was found."""
        reason = self.freedoms.out_of_reach(self.target)
        if reason:
            return self._failure("unreachable", 0, reason)
        rng = np.random.default_rng(20240229)
        limits = self.freedoms.within(self.free)
        start = self.x0[self.free]
        for attempt in range(_RESTARTS + 1):
            found = self._descend(start, clamp=attempt % 2 == 0, wrap=limits.into)
            if found is not None:
                inside = limits.into(found)
                if limits.inside(inside) and self._verified(inside):
                    return self._success(limits.nearest(inside, self.x0[self.free]), attempt)
            start = limits.random(rng)
        return self._explain(rng)

    def _descend(self, y: Vector, clamp: bool, wrap: object = None) -> Vector | None:
        """Iterate from one start; return the free axes where the residual vanishes, else None."""
        limits = self.freedoms.within(self.free)
        mark, since = math.inf, 0
        for _ in range(_MAX_STEPS):
            error, J = self.residual(y)
            squared = float(error @ error)
            self.iterations += 1
            if squared < self.best.error:
                self.best = _Best(self._full(y), squared)
            if squared < tolerances.IK_RESIDUAL_SQUARED:
                return y
            if squared > _STALL_SHARE * mark:
                since += 1
                if since >= _STALL_STEPS:
                    return None
            else:
                mark, since = squared, 0
            y = y + damped_step(J, error, _DAMPING * squared + _DAMPING_FLOOR)
            if clamp:
                y = limits.clamp(limits.into(y))
        return None

    def _full(self, y: Vector) -> Vector:
        x = self.x0.copy()
        x[self.free] = y
        return x

    def _verified(self, y: Vector) -> bool:
        """Return whether forward kinematics meets the target at the free axes y."""
        distance, angle = self.robot.kinematics.errors(self._full(y), self.target, self.task)
        return distance <= tolerances.IK_POSITION_M and (self.task == "position" or angle <= tolerances.IK_ROTATION_RAD)

    def _success(self, y: Vector, restarts: int) -> IkResult:
        x = self._full(y)
        distance, angle = self.robot.kinematics.errors(x, self.target, self.task)
        axes = x / self.freedoms.si_factors
        return IkResult(True, axes, "ok", distance, angle, self.iterations, restarts, self.task)

    def _explain(self, rng: np.random.Generator) -> IkResult:
        """Find out whether the limits or the geometry are in the way."""
        limits = self.freedoms.within(self.free)
        best = self.best
        for _ in range(_FREE_RESTARTS):
            found = self._descend(limits.random(rng), clamp=False)
            if found is not None:
                outside = limits.names_outside(limits.into(found))
                x = self._full(limits.into(found))
                self.best = _Best(x, 0.0)
                reason = f"only reached outside the limits of {', '.join(outside)}" if outside else "limits"
                return self._failure("limits", _RESTARTS, reason)
        self.best = best if best.error <= self.best.error else self.best
        if math.sqrt(self.best.error) < _CLOSE:
            return self._failure("stalled", _RESTARTS, "the search ended close to the pose without meeting it")
        return self._failure(
            "unreachable", _RESTARTS, "the search found no axis values that bring the tool there, even without limits"
        )

    def _failure(self, status: Status, restarts: int, reason: str) -> IkResult:
        x = self.best.x
        distance, angle = self.robot.kinematics.errors(x, self.target, self.task)
        axes = x / self.freedoms.si_factors
        return IkResult(False, axes, status, distance, angle, self.iterations, restarts, self.task, reason)
