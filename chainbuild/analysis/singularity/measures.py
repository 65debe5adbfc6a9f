"""Measures of the Jacobian in the controller's task: how close axis values are to a singularity.

Metres and radians cannot be compared, so lengths are divided by a characteristic length L: the rows of J that are
lengths are divided by it, the columns of linear axes multiplied. The scaled singular values have no unit.

The tool of closed loops is lost in two ways: no axis moves it in a direction (the smallest singular value is 0), or it
moves without the axes (the largest has no end). `smallest` is then the lesser of the smallest and 1 over the largest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild.analysis.singularity.jacobians import pose_jacobians
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.elements import Chain
from chainbuild.chain.fold import drawn
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.screws import joints_between_tips
from chainbuild.shown import fields_shown

_SMALLEST_LENGTH: Final = 1e-6  # m: shorter than any machine, and rounding of an offset that is 0


@dataclass(frozen=True, slots=True, eq=False)
class Measures:
    """The Jacobian of a pose in numbers, all scaled by the characteristic length.

    Attributes:
        singular_values: In falling order; as many as the task has freedoms.
        length: Characteristic length [m].
        lost: (6,) unit motion of the tool that is lost first, in the tool frame: shift as a share of the length, then
            turn [rad]. Rows outside the task are 0.
        runaway: (n_axes,) unit motion of the axes (rad; linear axes as a share of the length) that moves the tool
            least.
        loops: Whether the chain has loops, so that the tool may run away as well.
    """

    __repr__ = fields_shown

    singular_values: Vector
    length: float
    lost: Vector
    runaway: Vector
    loops: bool = False

    @property
    def smallest(self) -> float:
        """Smallest singular value: the speed of the tool in the lost direction over the speed of the axes.

        With loops no more than the speed of the axes over that of the tool in the direction in which it runs away.
        """
        return float(least_of(self.singular_values, self.loops))

    @property
    def manipulability(self) -> float:
        """Product of the singular values (Yoshikawa)."""
        return float(np.prod(self.singular_values))

    @property
    def condition(self) -> float:
        """Largest over smallest singular value; inf at a singularity."""
        smallest = self.smallest
        return float(self.singular_values[0]) / smallest if smallest > 0.0 else float("inf")


def least_of(singular_values: NDArray[np.floating[Any]], loops: bool) -> NDArray[np.float64]:
    """Return how close to a singularity (…,) scaled singular values (…, n), in falling order, are.

    Args:
        singular_values: Of one or many Jacobians.
        loops: Whether the chain has loops: what is held by no axis counts, too.
    """
    least = np.asarray(singular_values[..., -1], dtype=np.float64)
    if loops:
        least = np.minimum(least, 1.0 / np.maximum(singular_values[..., 0], np.finfo(float).tiny))
    return least


@dataclass(frozen=True, slots=True, eq=False)
class Scaling:
    """Scaling of a Jacobian to that of the task, without units.

    Attributes:
        rows: Rows of the 6×n Jacobian that belong to the task.
        columns: Axes that move; held ones are left out.
        length: Characteristic length [m].
        factors: (rows, columns) what each element is multiplied with.
        whole: Whether it keeps all rows and columns.
    """

    rows: NDArray[np.intp]
    columns: NDArray[np.intp]
    length: float
    factors: Matrix
    whole: bool

    def apply(self, J: Matrix) -> Matrix:
        """Return the scaled Jacobian (…, rows, columns) of Jacobians (…, 6, n_axes)."""
        if self.whole:
            return np.multiply(J, self.factors)
        picked: Matrix = J[..., self.rows[:, None], self.columns] * self.factors
        return picked


def characteristic_length(chain: Chain) -> float:
    """Return the length [m] that scales a chain by default: from its first joint to the tips, all offsets added up.

    For an arm it is the length of the stretched arm with its tool, without the base it stands on, for closed loops that
    of the longest arm. A chain of linear axes without any offset has the length 1 m.
    """
    branches: dict[str, float] = {}
    # Parents come first. What carries the tips of a parallel kinematic has joints, but no length of its own.
    for n in range(len(chain.joints)) if chain.loops else joints_between_tips(chain):
        joint = chain.joints[n]
        before = branches.get(joint.parent)
        # The offset of the first joint of a branch moves the whole machine and does not affect its size.
        branches[joint.child] = 0.0 if before is None else before + _norm(drawn(joint).T_parent_joint)
    total = sum(
        branches[frame.link] + _norm(frame.T_link_frame)
        for frame in (chain.frame("tool"), chain.frame("workpiece"))
        if frame.link in branches
    )
    ends = {name for loop in chain.loops for name in (loop.frame_a, loop.frame_b)}
    arms = [branches[frame.link] + _norm(frame.T_link_frame) for frame in chain.frames if frame.name in ends]
    total = max([total, *arms])
    return total if total > _SMALLEST_LENGTH else 1.0


def _norm(T: Matrix) -> float:
    return float(np.linalg.norm(T[:3, 3]))


def task_rows(robot: Mechanism) -> tuple[int, ...]:
    """Return the rows of the Jacobian, in the tool frame, that belong to the controller's task."""
    if robot.task == "pose":
        return tuple(range(6))
    if robot.task == "position":
        return 0, 1, 2
    spin = 3 + robot.chain.tool_column
    return tuple(row for row in range(6) if row != spin)


def scaling_of(robot: Mechanism, length: float | None = None) -> Scaling:
    """Return the scaling of a robot's task; that of the default length is prepared once.

    Raises:
        ChainbuildError: the length is not a finite number above 0.
    """
    if length is None:
        return robot.prepared("scaling", lambda: scaling_of(robot, characteristic_length(robot.chain)))
    if not (np.isfinite(length) and length > 0.0):
        raise ChainbuildError("wrong characteristic length", parameter="length", permitted="a finite number above 0 m")
    rows = np.array(task_rows(robot))
    columns = np.array([n for n, axis in enumerate(robot.axes) if not axis.held])
    factors = np.ones((len(rows), len(columns)))
    factors[rows < 3] /= length
    factors[:, [robot.axes[n].kind == "linear" for n in columns]] *= length
    return Scaling(rows, columns, length, factors, factors.shape == (6, len(robot.axes)))


def measure(robot: Mechanism, axes: ArrayLike, length: float | None = None) -> Measures:
    """Return the measures at axis values (n_axes,), mm and degrees.

    Args:
        robot: The robot.
        axes: Axis values; limits are ignored.
        length: Characteristic length [m]; None: `characteristic_length`.

    Raises:
        AxisValueError: wrong number of values, or a non-finite value.
    """
    scaling = scaling_of(robot, length)
    U, values, Vt = np.linalg.svd(scaling.apply(jacobian_at(robot, axes)), full_matrices=False)
    lost, runaway = np.zeros(6), np.zeros(len(robot.axes))
    lost[scaling.rows], runaway[scaling.columns] = U[:, -1], Vt[-1]
    return Measures(values, scaling.length, lost, runaway, bool(robot.chain.loops))


def jacobian_at(robot: Mechanism, axes: ArrayLike) -> Matrix:
    """Return `Mechanism.jacobian`; where the platform of closed loops is loose and that is refused, one of 1e12.

    Raises:
        AxisValueError: wrong number of values, or a non-finite value.
        ChainbuildError: there is no pose there.
    """
    if not robot.chain.loops:
        return robot.jacobian(axes)
    robot.q(axes)  # raises where nothing closes
    return robot.kinematics.pose_and_jacobian(robot.axis_values(axes) * robot.kinematics.si_factors)[1]


def smallest_value(robot: Mechanism, axes: ArrayLike) -> float:
    """Return the smallest scaled singular value at axis values (n_axes,): the quick form of `measure`.

    Not a number where there is no pose.
    """
    values = np.asarray(axes, dtype=float)
    if values.shape != robot.kinematics.si_factors.shape or not math.isfinite(values.sum()):
        values = robot.axis_values(axes)  # raises if the values are wrong
    J = scaling_of(robot).apply(robot.kinematics.pose_and_jacobian(values * robot.kinematics.si_factors)[1])
    if not math.isfinite(J.sum()):
        return math.nan
    return float(least_of(np.linalg.svd(J, compute_uv=False), bool(robot.chain.loops)))


@dataclass(frozen=True, slots=True, eq=False)
class MeasureTable:
    """Measures of many poses.

    Attributes:
        positions: (N, 3) tool in the workpiece frame [m].
        smallest: (N,) smallest scaled singular value, with loops as `Measures.smallest` says; like the other columns
            not a number where a row has no pose.
        manipulability: (N,) product of the scaled singular values.
        condition: (N,) largest over smallest; inf at a singularity.
    """

    positions: Matrix
    smallest: Vector
    manipulability: Vector
    condition: Vector

    def __repr__(self) -> str:
        least = (
            f", smallest {self.smallest.min():.3g} at row {int(self.smallest.argmin())}" if len(self.smallest) else ""
        )
        return f"<MeasureTable of {len(self.smallest)} rows{least}; .smallest, .manipulability, .condition>"


def measure_batch(robot: Mechanism, axes: ArrayLike, *, length: float | None = None) -> MeasureTable:
    """Return the measures at many axis values (N, n_axes), mm and degrees.

    Memory beyond the result does not depend on N.
    """
    values = np.asarray(axes, dtype=float)
    if values.ndim != 2 or values.shape[1] != len(robot.axes) or not np.isfinite(values).all():
        raise ChainbuildError(f"expected finite axis values of shape (N, {len(robot.axes)})")
    scaling = scaling_of(robot, length)
    count = len(values)
    table = MeasureTable(np.empty((count, 3)), np.empty(count), np.empty(count), np.empty(count))
    for part, positions, J in pose_jacobians(robot, values):
        scaled = scaling.apply(J)
        without = ~np.isfinite(scaled.reshape(len(scaled), -1)).all(axis=1)
        scaled[without] = 0.0
        singular = np.linalg.svd(scaled, compute_uv=False)
        singular[without], positions[without] = np.nan, np.nan
        table.positions[part] = positions
        table.smallest[part] = least_of(singular, bool(robot.chain.loops))
        table.manipulability[part] = singular.prod(axis=1)
        with np.errstate(divide="ignore"):
            table.condition[part] = singular[:, 0] / singular[:, -1]
    return table
