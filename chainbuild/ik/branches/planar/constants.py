"""The constants of an arm with three parallel axes for `formulas`, confirmed against its forward kinematics."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.frames import inverse, transform
from chainbuild.ik.branches.arms.parallel_axes import ParallelArm, parallel_arm
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.core.subproblems import cross, norm
from chainbuild.ik.branches.planar.formulas import EFFECT, PLANAR_ROWS, arm_rows, is_confirmed, seen_from_axes
from chainbuild.ik.branches.vectors.axes import axis_constants
from chainbuild.ik.plan import plan_for
from chainbuild.ik.request import IkRequest
from chainbuild.ik.rules import HALF_TURN_NUDGE, HALF_TURN_TOWARDS
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.tolerances import ROTATION_MATRIX

_WHOLE: Final = 1e-9  # a determinant so near to 1 is one but for rounding: axes and joints make the same turns
_SAMPLES: Final = 16  # any wrong constant shows in the first one
_EXACT: Final = 1e-9  # permitted error of samples and of branches [m, rad]: above, digits are lost


def planar_constants(mechanism: Mechanism, *, limits: bool) -> Matrix | None:
    """Return the constants (n, 6) of a robot, see `formulas.PLANAR_ROWS`; None where the formulas do not apply.

    Args:
        mechanism: The mechanism.
        limits: False: ignore the limits.
    """
    axis_map, bounds = mechanism.chain.axis_map, mechanism.limits
    if not isinstance(axis_map, AffineMap) or len(mechanism.axes) != 6 or mechanism.kinematics.has_input_axes:
        return None
    if mechanism.task != "pose" or mechanism.chain.loops or (limits and (bounds.sums or bounds.curved)):
        return None
    query = BranchQuery.of(IkRequest(mechanism, np.eye(4)))
    serial = query.serial()
    arm = parallel_arm(serial) if plan_for(query).name == "three parallel axes" else None
    if arm is None or arm.alone > 1 or not query.periodic.all():
        return None
    joints = [screw.joint for screw in serial.screws][:: -1 if arm.backwards else 1]
    A, b, factors = axis_map.A[joints], axis_map.b[joints], axis_map.si_factors
    # With a gear, whole turns of joints are no whole turns of axes.
    if abs(abs(float(np.linalg.det(A))) - 1.0) > _WHOLE:
        return None
    measures, signs, phases = _measures(arm)
    back, zero = signs[:, None] * A * factors, signs * b + phases
    wanted = query.x0 + np.copysign(HALF_TURN_NUDGE, HALF_TURN_TOWARDS - query.x0)
    parts = {**measures, **axis_constants(query, back, zero, wanted / factors, limits=limits)}
    constants = np.concatenate([np.asarray(parts[name], dtype=float).reshape(-1, 6) for name in PLANAR_ROWS])
    return constants if _meets_forward_kinematics(mechanism, constants) else None


def _measures(arm: ParallelArm) -> tuple[dict[str, object], Vector, Vector]:
    """Return the measures by name, and what leads from joint values to angles: signs and phases (6,)."""
    (first, fifth, last), z = (np.array(axis) for axis in arm.axes), np.array([0.0, 0.0, 1.0])
    on_first, on_fifth, on_last = (np.array(point) for point in arm.points)
    if arm.alone == 0:
        on_fifth = on_last
    inner, outer = arm.links
    elbow, tip = inner * _direction(arm.lead), np.array([arm.tip[0], arm.tip[1], 0.0])
    axes, points = (first, z, z, z, fifth, last), (on_first, np.zeros(3), elbow, tip, on_fifth, on_last)
    # Of what lies between two axes, the x axis that the frames on either side share.
    ways = (
        cross(first, z),
        elbow,
        tip - elbow,
        cross(z, fifth),
        cross(fifth, last) if arm.alone == 0 else on_last - on_fifth,
    )
    between = [way / norm(way) for way in ways]
    before = [_frame(x, axis, point) for x, axis, point in zip((between[0], *between), axes, points, strict=True)]
    behind = [_frame(x, axis, point) for x, axis, point in zip((*between, between[4]), axes, points, strict=True)]
    turns = [(inverse(a) @ b)[:2, 0] for a, b in zip(before, behind, strict=True)]
    X1, X4, X5 = (inverse(behind[n]) @ before[n + 1] for n in (0, 3, 4))
    after = arm.after @ behind[5]
    point = (X4[2, 3] - X1[2, 1] * X1[1, 3], 0.0, X4[2, 1] * X5[0, 3])
    direction = (X4[1, 1] * X5[1, 1], -X4[2, 1] * X5[2, 1], 0.0)
    alone, both = (point, direction) if arm.alone == 0 else (direction, point)
    amplitude = math.hypot(both[1], both[2])
    effect = EFFECT * (arm.size**2 if arm.alone == 0 else 1.0)
    measures: dict[str, object] = {
        "before": (inverse(before[0]) @ arm.before)[:3],
        "after": after[:3],
        "first": _turn_and_shift(X1),
        "fourth": _turn_and_shift(X4),
        "fifth": _turn_and_shift(X5),
        "links": (inner, outer, inner**2 + outer**2, 0.5 / (inner * outer), effect, 0.0),
        "alone": (
            1.0 - arm.alone, alone[0], both[0], both[1] / amplitude, both[2] / amplitude, 1.0 / amplitude
        ),
        "kept": (_EXACT**2, _EXACT**2, float(arm.backwards), ROTATION_MATRIX, 0.0, 0.0),
    }  # fmt: skip
    return measures, np.array([1.0, 1.0, *arm.signs, 1.0, 1.0]), np.array([math.atan2(s, c) for c, s in turns])


def _direction(angle: float) -> Vector:
    return np.array([math.cos(angle), math.sin(angle), 0.0])


def _frame(x: Vector, z: Vector, origin: Vector) -> Matrix:
    return transform(np.column_stack([x, cross(z, x), z]), origin)


def _turn_and_shift(X: Matrix) -> tuple[float, ...]:
    """Return cosine and sine of a turn about the x axis, its shift [m], and 0."""
    return float(X[1, 1]), float(X[2, 1]), *X[:3, 3].tolist(), 0.0


def _meets_forward_kinematics(mechanism: Mechanism, constants: Matrix) -> bool:
    """Return whether the formulas that confirm branches match the robot's forward kinematics, on random axis values."""
    axes = np.random.default_rng(0).uniform(-170.0, 170.0, (_SAMPLES, 6))
    T = mechanism.fk_batch(axes)[:, :3].reshape(_SAMPLES, 12).T
    rows = arm_rows(constants)
    return bool(np.all(is_confirmed(axes.T, seen_from_axes(T, rows), rows[2], rows[4])))
