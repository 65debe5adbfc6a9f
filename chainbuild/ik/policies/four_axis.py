"""What a ROBX robot of four axes is programmed by: position and angle C, while A and B follow (ROBX manual 5.3.19).

A pose that the robot reaches as it is given is solved as it is. Else its orientation is replaced by the reachable one
with the same C: the axes are sought where

    position of the tool = the position given      3 equations
    C of the robot       = the C given             1 equation: the pose angle C, or the sum of axes that runs on

first from the start, then from elsewhere, and the first such place that keeps the limits counts. Where C runs on, the
axis next to the tool then makes as many whole turns as the C given asks for.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild import frames, tolerances
from chainbuild.chain.elements import AxisSum
from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.core.axis_values import turned_axes
from chainbuild.ik.branches.core.query import LIMIT_SLACK, Query
from chainbuild.ik.limits import freedoms_of
from chainbuild.ik.result import IkResult
from chainbuild.ik.start import Held
from chainbuild.kinematics.evaluation import damped_step
from chainbuild.kinematics.mechanism import as_pose
from chainbuild.units import deg_from_rad, rad_from_deg

if TYPE_CHECKING:
    import pinocchio as pin

    from chainbuild.kinematics.mechanism import Robot

Vector = NDArray[np.float64]
Solve = Callable[["pin.SE3", ArrayLike | None], IkResult]

_STEPS: Final = 40
_STARTS: Final = 24
_DAMPING: Final = 1e-3  # share of the squared error
_FLOOR: Final = 1e-14
_MET: Final = 1e-20  # squared error [m², rad²]
_BLIND: Final = 1e-6  # a C that moves less than this with any axis is not what can be programmed
_SAME: Final = 1e-6
_FULL_TURN_DEG: Final = 360.0


class Angle(Protocol):
    """The angle C as an equation."""

    def row(self, x: Vector, T: pin.SE3, J: Vector) -> tuple[float, Vector]:
        """Return how far C still has to go [rad], within half a turn, and its derivative by the SI axis values."""
        ...


@dataclass(frozen=True, slots=True)
class PoseAngle:
    """C as the last angle of the pose; where A and C cannot be told apart (B = ±90) A is 0."""

    angle_mode: str
    c_deg: float

    def row(self, x: Vector, T: pin.SE3, J: Vector) -> tuple[float, Vector]:
        """See `Angle`."""
        angles = frames.angles_from_matrix(self.angle_mode, T.rotation)
        rates = _angle_rates(self.angle_mode, angles)
        return math.remainder(rad_from_deg(self.c_deg - angles[2]), math.tau), rates @ J[3:]


@dataclass(frozen=True, slots=True, eq=False)
class RunningAngle:
    """C as a sum of axes."""

    total: AxisSum
    si_factors: Vector
    c_deg: float

    def row(self, x: Vector, T: pin.SE3, J: Vector) -> tuple[float, Vector]:
        """See `Angle`."""
        missing = rad_from_deg(self.c_deg - self.total.value(x / self.si_factors))
        return math.remainder(missing, math.tau), np.array(self.total.coefficients)


def _angle_rates(angle_mode: str, angles: tuple[float, float, float]) -> Vector:
    """Return the row (3,) that makes the rate of C of an angular velocity in the tool frame."""
    R, columns = np.eye(3), []
    factors = frames.ANGLE_MODES[angle_mode].factors
    for (letter, _, sign), angle in zip(reversed(factors), reversed(angles), strict=True):
        direction = np.eye(3)["xyz".index(letter)] * sign
        columns.append(R.T @ direction)
        R = frames.rot_about(direction, angle) @ R
    locked = abs(math.cos(rad_from_deg(angles[1]))) < tolerances.GIMBAL_LOCK
    E = np.column_stack(columns[:2] if locked else columns)
    row: Vector = np.linalg.pinv(E)[0]
    return row


def solve_programmed(
    robot: Robot,
    target: pin.SE3,
    start: ArrayLike | None,
    held: Held | None,
    solve: Solve,
    absolute_c_deg: float | None = None,
) -> IkResult:
    """Return axis values for what is programmed: the pose, or on robots that follow C its position and C.

    Args:
        robot: The robot.
        target: Tool in the workpiece frame [m].
        start: See `Robot.ik`.
        held: See `Robot.ik`.
        solve: The solver for a whole pose: target and start → result.
        absolute_c_deg: See `Robot.ik`.

    Raises:
        ChainbuildError: an absolute C for a robot whose C does not run on, or one that is not finite.
    """
    chain = robot.chain
    if absolute_c_deg is not None:
        return _with_running_c(robot, target, start, held, solve, absolute_c_deg)
    found = solve(target, start)
    if found.success or found.status == "limits" or not chain.follows_c:
        return found
    if float(np.linalg.norm(target.translation)) > freedoms_of(robot).reach:
        return found  # too far for any orientation
    c_deg = frames.angles_from_matrix(chain.angle_mode, target.rotation)[2]
    return _following(Query.of(robot, target, start, held), PoseAngle(chain.angle_mode, c_deg), solve) or found


def _with_running_c(
    robot: Robot, target: pin.SE3, start: ArrayLike | None, held: Held | None, solve: Solve, c_deg: float
) -> IkResult:
    total = robot.chain.absolute_c
    if total is None:
        raise ChainbuildError(
            f"the angle C of {robot.chain.title} does not run on beyond a turn",
            parameter="absolute_c_deg",
            permitted="robots with an absolute angle C (ROBX 4-axis SCARA with bit 0 of SPECIAL_FEATURE_MASK)",
        )
    if not abs(c_deg) < tolerances.HUGE_AXIS_VALUE:
        raise ChainbuildError("the absolute angle C is not finite", parameter="absolute_c_deg", permitted="degrees")

    def turned(target: pin.SE3, begin: ArrayLike | None) -> IkResult:
        found = solve(target, begin)
        return _wound(robot, found, total, c_deg) if found.success else found

    found = turned(target, start)
    off = rad_from_deg(c_deg - total.value(found.axes))
    if found.success and abs(off) <= tolerances.IK_ROTATION_RAD:
        return found
    query = Query.of(robot, target, start, held)
    return _following(query, RunningAngle(total, robot.kinematics.si_factors, c_deg), turned) or found


def _following(query: Query, angle: Angle, solve: Solve) -> IkResult | None:
    """Return the answer for a reachable orientation with the C given, or a failure of one, or None: there is none."""
    failed = None
    for x in _places(query, angle):
        T = query.robot.kinematics.pose(query.robot.kinematics.q(x))
        reachable = as_pose(frames.transform(T.rotation, query.target.translation))
        found = solve(reachable, x / query.robot.kinematics.si_factors)
        if found.success:
            return found
        failed = failed or found
    return failed


def _places(query: Query, angle: Angle) -> Iterator[Vector]:
    """Yield SI axis values with the position and the C wanted, with whole turns towards the limits, each once.

    First comes where a descent from the start leads, then what other starts find, nearest to the start first.
    """
    near = _descend(query, angle, query.x0.copy())
    if near is not None:
        near = next(turned_axes(query, near, query.structure.free))
        yield near
    rng = np.random.default_rng(0)
    low = np.where(np.isfinite(query.lower), query.lower, query.x0 - math.pi)
    high = np.where(np.isfinite(query.upper), query.upper, query.x0 + math.pi)
    others: list[Vector] = []
    for _ in range(_STARTS):
        x = query.x0.copy()
        x[query.structure.free] = (low + (high - low) * rng.random(len(low)))[query.structure.free]
        found = _descend(query, angle, x)
        if found is None:
            continue
        found = next(turned_axes(query, found, query.structure.free))
        known = others if near is None else [near, *others]
        if not any(np.abs(found - other).max() < _SAME for other in known):
            others.append(found)
    yield from sorted(others, key=query.distance)


def _descend(query: Query, angle: Angle, x: Vector) -> Vector | None:
    """Return SI axis values that meet position and C, by damped Newton steps from x, or None."""
    free, error = query.structure.free, np.empty(4)
    for _ in range(_STEPS):
        T, J = query.robot.kinematics.pose_and_jacobian(x)
        error[:3] = T.rotation.T @ (query.target.translation - T.translation)
        error[3], row = angle.row(x, T, J)
        if not np.isfinite(error).all() or np.abs(row[free]).max(initial=0.0) < _BLIND:
            return None
        squared = float(error @ error)
        if squared < _MET:
            return x
        x = x.copy()
        x[free] += damped_step(np.vstack((J[:3, free], row[free])), error, _DAMPING * squared + _FLOOR)
    return None


def _wound(robot: Robot, found: IkResult, total: AxisSum, c_deg: float) -> IkResult:
    """Return a solution whose last rotary axis has made the whole turns that an absolute C asks for."""
    n = _last_axis(robot, total)
    axis, factor = robot.axes[n], total.coefficients[n]
    turns = round((c_deg - total.value(found.axes)) / (_FULL_TURN_DEG * factor))
    axes = found.axes.copy()
    axes[n] += turns * _FULL_TURN_DEG
    if axis.endless or axis.lower - _slack_deg() <= axes[n] <= axis.upper + _slack_deg():
        return replace(found, axes=axes)
    reason = f"C = {c_deg:.6g} needs {axis.name} = {axes[n]:.6g}, outside its limits {axis.lower:g} … {axis.upper:g}"
    return replace(found, axes=axes, success=False, status="limits", reason=reason, violated=(axis.name,))


def _slack_deg() -> float:
    return deg_from_rad(LIMIT_SLACK)


def _last_axis(robot: Robot, total: AxisSum) -> int:
    """Return the axis of the sum that drives the joint next to the tool."""
    slopes = robot.kinematics.dq_dx(np.zeros(len(robot.axes)))
    counted = [n for n, coefficient in enumerate(total.coefficients) if coefficient]
    return max(counted, key=lambda n: int(np.flatnonzero(slopes[:, n])[-1]))
