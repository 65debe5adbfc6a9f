"""ROBX robots with four axes: programmed by position and angle C, while A and B follow (ROBX manual 5.3.19).

A pose that the robot can reach is solved unchanged. Else its orientation is replaced by the reachable one with the
same C: axis values are sought with

    position of the tool = the position given      3 equations
    C of the robot       = the C given             1 equation: the pose angle C, or the sum of axes that counts turns

first from the start, then from other starts; the first solution inside the limits is used. If C counts whole turns, the
axis next to the tool then makes as many turns as the given C requires.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Final, Protocol

import numpy as np

from chainbuild import frames, tolerances
from chainbuild.arrays import Indices, Matrix, Vector
from chainbuild.chain.sums import AxisSum
from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.core.axis_values import turned_axes
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.request import IkRequest
from chainbuild.ik.result import IkResult
from chainbuild.ik.verify import is_met
from chainbuild.kinematics.displayed import arm_normal, pitch_and_turn
from chainbuild.kinematics.inputs import Pose
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.newton import below, newton, shrinking
from chainbuild.units import rad_from_deg

Solve = Callable[[IkRequest], IkResult]

_STEPS: Final = 40  # at most, of one descent
_STARTS: Final = 24  # starts of further descents if the first one fails
_DAMPING: Final = shrinking(1e-3, 1e-14)
_MET: Final = below(1e-20)
_BLIND: Final = 1e-6  # an angle that changes less than this with every axis cannot be programmed
_SAME: Final = 1e-6  # solutions closer than this in every axis [m, rad] are one
_FULL_TURN_DEG: Final = 360.0  # places that differ by it are one orientation


class Angles(Protocol):
    """The angles that are programmed, as equations."""

    def rows(self, x: Vector, T: Pose, J: Matrix) -> tuple[Vector, Matrix]:
        """Return what is missing (m,) [rad], within half a turn, and the derivatives (m, n) by the SI axis values."""
        ...


@dataclass(frozen=True, slots=True)
class PoseAngles:
    """Some of the angles A, B, C of the pose; at gimbal lock the first of the three turns is 0.

    Attributes:
        angle_mode: Name in `frames.ANGLE_MODES`.
        wanted: Letter → degrees.
    """

    angle_mode: str
    wanted: Mapping[str, float]

    def rows(self, x: Vector, T: Pose, J: Matrix) -> tuple[Vector, Matrix]:
        """See `Angles`."""
        angles = dict(zip("ABC", frames.angles_from_matrix(self.angle_mode, T.rotation), strict=True))
        rates = _angle_rates(self.angle_mode, angles, tuple(self.wanted))
        missing = [math.remainder(rad_from_deg(self.wanted[n] - angles[n]), math.tau) for n in self.wanted]
        return np.array(missing), rates @ J[3:]


@dataclass(frozen=True, slots=True, eq=False)
class PitchAndTurn:
    """Tilt of the tool in the plane of an arm, and its turn about Z: B and C of Rz(a)·Ry(B)·Rz(C - a) (KIN_TYP 213)."""

    mechanism: Mechanism
    b_deg: float
    c_deg: float

    def rows(self, x: Vector, T: Pose, J: Matrix) -> tuple[Vector, Matrix]:
        """See `Angles`."""
        values, R = x / self.mechanism.kinematics.si_factors, T.rotation
        b, c = pitch_and_turn(self.mechanism, values, R)
        missing = [
            math.remainder(rad_from_deg(wanted - a), math.tau) for wanted, a in ((self.b_deg, b), (self.c_deg, c))
        ]
        # The angular velocity is a'·z + B'·normal + (C' - a')·tool: normal and both others are at right angles.
        turning, level = R @ J[3:], 1.0 + float(R[2, 2])
        sum_of_turns = (np.array([0.0, 0.0, 1.0]) + R[:, 2]) @ turning / max(level, tolerances.GIMBAL_LOCK)
        return np.array(missing), np.vstack((arm_normal(self.mechanism.chain, values) @ turning, sum_of_turns))


@dataclass(frozen=True, slots=True, eq=False)
class RunningAngle:
    """C as a sum of axes."""

    total: AxisSum
    si_factors: Vector
    c_deg: float

    def rows(self, x: Vector, T: Pose, J: Matrix) -> tuple[Vector, Matrix]:
        """See `Angles`."""
        missing = rad_from_deg(self.c_deg - self.total.value(x / self.si_factors))
        return np.array([math.remainder(missing, math.tau)]), np.array([self.total.coefficients])


def _angle_rates(angle_mode: str, angles: Mapping[str, float], letters: tuple[str, ...]) -> Matrix:
    """Return the rows (m, 3) that make the rates of some angles of an angular velocity in the tool frame."""
    R, columns, turning = np.eye(3), [], []
    for axis, letter, sign in reversed(frames.ANGLE_MODES[angle_mode].factors):
        direction = np.eye(3)["xyz".index(axis)] * sign
        columns.append(R.T @ direction)
        turning.append(letter)
        R = frames.rot_about(direction, angles[letter]) @ R
    E = np.column_stack(columns)
    if abs(np.linalg.det(E)) < tolerances.GIMBAL_LOCK:  # the first turn of the three is 0
        E[:, 2] = 0.0
    rates: Matrix = np.linalg.pinv(E)[[turning.index(letter) for letter in letters]]
    return rates


def as_programmed(
    request: IkRequest, solve: Solve, absolute_c_deg: float | None = None, *, from_start: bool = False
) -> tuple[IkRequest, IkResult]:
    """Return the answer for the programmed pose, or for its position and C on robots with four axes.

    Args:
        request: The request.
        solve: The solver for a whole pose.
        absolute_c_deg: See `Robot.ik`.
        from_start: True: `solve` begins at the start of the request for every orientation.

    Returns:
        The request that was answered, with the resulting A and B, and its answer.

    Raises:
        ChainbuildError: an absolute C for a robot whose C does not count turns, or one that is not finite.
    """
    chain = request.mechanism.chain
    if absolute_c_deg is not None:
        return _with_running_c(request, solve, absolute_c_deg, from_start)
    found = solve(request)
    if found.success or found.status == "limits" or not chain.follows_c:
        return request, found
    if float(np.linalg.norm(request.target[:3, 3])) > request.mechanism.kinematics.reach:
        return request, found  # too far for any orientation
    c_deg = frames.angles_from_matrix(chain.angle_mode, request.target[:3, :3])[2]
    followed = with_reachable_orientation(request, PoseAngles(chain.angle_mode, {"C": c_deg}), solve, from_start)
    return followed or (request, found)


def _with_running_c(request: IkRequest, solve: Solve, c_deg: float, from_start: bool) -> tuple[IkRequest, IkResult]:
    mechanism = request.mechanism
    total = mechanism.chain.absolute_c
    if total is None:
        raise ChainbuildError(
            f"the angle C of {mechanism.chain.title} does not count whole turns",
            parameter="absolute_c_deg",
            permitted="robots with an absolute angle C (ROBX 4-axis SCARA with bit 0 of SPECIAL_FEATURE_MASK)",
        )
    if not abs(c_deg) < tolerances.HUGE_AXIS_VALUE:
        raise ChainbuildError(
            "the absolute angle C is not finite", parameter="absolute_c_deg", permitted="a finite number of degrees"
        )

    def turned(asked: IkRequest) -> IkResult:
        found = solve(asked)
        return _with_whole_turns(asked, found, total, c_deg) if found.success else found

    found = turned(request)
    off = rad_from_deg(c_deg - total.value(found.axes))
    if found.success and abs(off) <= tolerances.IK_ROTATION_RAD:
        return request, found
    angles = RunningAngle(total, mechanism.kinematics.si_factors, c_deg)
    return with_reachable_orientation(request, angles, turned, from_start) or (request, found)


def with_reachable_orientation(
    request: IkRequest, angles: Angles, solve: Solve, from_start: bool = False
) -> tuple[IkRequest, IkResult] | None:
    """Return the answer for a reachable orientation with the given angles, or its failure, or None if there is none.

    Args:
        request: The request, of whose target only the position counts.
        angles: The angles that are programmed.
        solve: The solver for a whole pose.
        from_start: True: `solve` begins at the start of the request for every orientation.
    """
    query, failed = BranchQuery.of(request), None
    kinematics = request.mechanism.kinematics
    for x in _orientations_with(query, angles):
        T = kinematics.pose(kinematics.q(x))
        reachable = request.to(
            frames.transform(T.rotation, query.target.translation), request.start if from_start else query.shown(x)
        )
        found = solve(reachable)
        if found.success:
            return reachable, found
        failed = failed or (reachable, found)
    return failed


def _orientations_with(query: BranchQuery, angles: Angles) -> Iterator[Vector]:
    """Yield SI axis values with the given position and angles, with whole turns towards the limits, each once.

    First the result of a descent from the start, then those of other starts, nearest to the start first.
    """
    near = _descend(query, angles, query.x0.copy())
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
        found = _descend(query, angles, x)
        if found is None:
            continue
        found = next(turned_axes(query, found, query.structure.free))
        known = others if near is None else [near, *others]
        if not any(np.abs(found - other).max() < _SAME for other in known):
            others.append(found)
    yield from sorted(others, key=query.distance)


def _descend(query: BranchQuery, angles: Angles, x: Vector, free: Indices | None = None) -> Vector | None:
    """Return SI axis values that meet position and angles, by damped Newton steps of `free` from x, or None."""
    kinematics, free = query.mechanism.kinematics, query.structure.free if free is None else free

    def residual(x: Vector) -> tuple[Vector, Matrix]:
        T, J = kinematics.pose_and_jacobian(x)
        missing, rows = angles.rows(x, T, J)
        if np.abs(rows[:, free]).max(axis=1, initial=0.0).min() < _BLIND:
            missing = missing * math.nan  # ends the descent
        place = T.rotation.T @ (query.target.translation - T.translation)
        return np.concatenate((place, missing)), np.vstack((J[:3], rows))

    ended = newton(residual, x, free, _MET, _DAMPING, _STEPS)
    return ended.x if ended.met else None


def _with_whole_turns(request: IkRequest, found: IkResult, total: AxisSum, c_deg: float) -> IkResult:
    """Return a solution whose last rotary axis makes the whole turns that an absolute C requires."""
    mechanism = request.mechanism
    n = _last_axis(mechanism, total)
    axis, factor = mechanism.axes[n], total.coefficients[n]
    turns = round((c_deg - total.value(found.axes)) / (_FULL_TURN_DEG * factor))
    axes = found.axes.copy()
    axes[n] += turns * _FULL_TURN_DEG
    if n not in mechanism.limits.outside(axes):
        return replace(found, axes=axes)
    at_limit = _at_limit(request, replace(found, axes=mechanism.limits.onto(axes)), total, c_deg, n)
    if at_limit is not None:
        return at_limit
    reason = f"at C = {c_deg:.6g} {mechanism.limits.in_words(n, float(axes[n]))}"
    return replace(found, axes=axes, success=False, status="limits", reason=reason, violated=(axis.name,))


def _at_limit(request: IkRequest, found: IkResult, total: AxisSum, c_deg: float, n: int) -> IkResult | None:
    """Return a solution with axis n where it is, on its limit, or None.

    A stretched arm meets a position to a micrometre with its elbow a thousandth of a degree off, and the axis next to
    the tool, which makes up for it, may then be beyond a limit that the exact solution keeps.
    """
    mechanism = request.mechanism
    kinematics = mechanism.kinematics
    query = BranchQuery.of(request)
    kept = query.structure.free[query.structure.free != n]
    angles = RunningAngle(total, kinematics.si_factors, c_deg)
    x = _descend(query, angles, found.axes * kinematics.si_factors, kept)
    if x is None or mechanism.limits.violated(query.shown(x)):
        return None
    axes, (distance, angle) = query.shown(x), kinematics.errors(x, query.target, found.task)
    off = rad_from_deg(c_deg - total.value(axes))
    if not is_met(found.task, distance, angle) or abs(off) > tolerances.IK_ROTATION_RAD:
        return None
    return replace(found, axes=axes, position_error=distance, rotation_error=angle)


def _last_axis(mechanism: Mechanism, total: AxisSum) -> int:
    """Return the axis of the sum that drives the joint next to the tool."""
    slopes = mechanism.kinematics.dq_dx(np.zeros(len(mechanism.axes)))
    counted = [n for n, coefficient in enumerate(total.coefficients) if coefficient]
    return max(counted, key=lambda n: int(np.flatnonzero(slopes[:, n])[-1]))
