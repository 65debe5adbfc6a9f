"""The error of a task in the tool frame and its Jacobian, by Pinocchio: what the plain search iterates on.

Calls are kept few here: a step costs a few microseconds, most of them Python's.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from threading import local
from typing import Final

import eigenpy
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.kinematics.evaluation import Kinematics, frame_jacobian, tilt

ToolError = Callable[[Vector], tuple[Vector, Matrix]]

_UNDAMPED: Final = 0.01  # share of a step that damping may take away without being asked


class TaskError:
    """The task of the free axes: the part of the error that is the same for every target.

    Args:
        kinematics: The chain's evaluator.
        free: Indices of the free axes, whose SI values are y.
        x: (n_axes,) SI values of the held axes.
        weights: (6,) weights of shift and turn in the tool frame.
        axis: Tool axis whose direction alone counts, or -1 for the whole turn.
        shown_axis: Tool axis that the angle in `misses` is about, or -1 for the whole turn.
    """

    def __init__(
        self, kinematics: Kinematics, free: NDArray[np.intp], x: Vector, weights: Vector, axis: int, shown_axis: int
    ) -> None:
        self._kinematics = kinematics
        self._joints = _joints(kinematics, free, x)
        self._rows = np.flatnonzero(weights > 0.0)
        self._weights = weights[self._rows]
        self._whole = len(self._rows) == 6
        self._even = bool((self._weights == 1.0).all())
        self._shifts = weights[:3] > 0.0
        self._axis, self._shown_axis = axis, shown_axis
        self._memory = _Memory(len(self._rows), len(free))

    @property
    def damping(self) -> DampedSteps:
        """The step solver, one for each thread."""
        return self._memory.damping

    def error_of(self, target: Matrix) -> ToolError:
        """Return the function y → (error, Jacobian), one row for each weight that is not 0.

        Args:
            target: (4, 4) tool in the workpiece frame [m].
        """
        placed, joints, axis = _placed(self._kinematics, pin.SE3(target)), self._joints, self._axis
        rows, weights, whole, even = self._rows, self._weights, self._whole, self._even

        def error_and_jacobian(y: Vector) -> tuple[Vector, Matrix]:
            q, slopes = joints(y)
            T_tool_target, J = placed(q)
            if slopes is not None:
                J = J.dot(slopes)
            error = pin.log6(T_tool_target).np
            error[:3] = T_tool_target.translation
            if axis >= 0:
                error[3:] = tilt(T_tool_target.rotation[:, axis], axis)
            if not whole:
                error, J = error[rows], J[rows]
            if not even:
                error, J = weights * error, weights[:, None] * J
            return error, J

        return error_and_jacobian

    def misses(self, y: Vector, target: Matrix, error: Vector | None) -> tuple[float, float]:
        """Return the distance [m] and the angle [rad] by which the pose at y misses a target (4, 4).

        Shifts of weight 0 do not count; the angle is that of the whole turn, or of one tool axis.

        Args:
            y: SI values of the free axes.
            target: (4, 4) tool in the workpiece frame [m].
            error: The error at y where it is known already.
        """
        if error is not None and self._whole and self._even and self._shown_axis == self._axis:
            a, b, c, d, e, f = error.tolist()
            return math.sqrt(a * a + b * b + c * c), math.sqrt(d * d + e * e + f * f)
        T_tool_target = self._kinematics.pose(self._joints(y)[0]).actInv(pin.SE3(target))
        shift, axis = T_tool_target.translation * self._shifts, self._shown_axis
        turn = pin.log3(T_tool_target.rotation) if axis < 0 else tilt(T_tool_target.rotation[:, axis], axis)
        return math.sqrt(shift.dot(shift)), math.sqrt(turn.dot(turn))


class DampedSteps:
    """Damped least-squares steps; keeps the factorisation's memory between calls.

    Args:
        rows: Rows of the Jacobian.
        columns: Its columns.
    """

    def __init__(self, rows: int, columns: int) -> None:
        self._short = rows < columns
        size = min(rows, columns)
        self._square = np.empty((size, size))
        self._diagonal = self._square.reshape(-1)[:: size + 1]
        self._factor = eigenpy.LLT(size)
        self._whole_factor = eigenpy.PartialPivLU(size)
        self._is_square, self._is_single = rows == columns, size == 1

    def step(self, J: Matrix, error: Vector, damping: float) -> Vector:
        """Return (JᵀJ + damping·1)⁻¹·Jᵀ·error, by way of the smaller of JᵀJ and JJᵀ."""
        if self._is_single:  # eigenpy gives solutions of one number a shape of their own
            single: Vector = J.T.dot(error) / (float((J * J).sum()) + damping)
            return single
        if self._is_square:
            # Where J⁻¹·error is short, damping changes next to nothing: λ/(σ² + λ) of its part along each singular
            # vector, and σ² is at least error²/step².
            step = self._whole_factor.compute(J).solve(error)
            if damping * step.dot(step) < _UNDAMPED * error.dot(error):
                return step
        Jt, square, diagonal = J.T, self._square, self._diagonal
        if self._short:
            J.dot(Jt, out=square)
            diagonal += damping
            return Jt.dot(self._factor.compute(square).solve(error))
        Jt.dot(J, out=square)
        diagonal += damping
        return self._factor.compute(square).solve(Jt.dot(error))


class _Memory(local):
    """A `DampedSteps` for each thread: its factorisation works in place."""

    def __init__(self, rows: int, columns: int) -> None:
        self.damping = DampedSteps(rows, columns)


def _placed(kinematics: Kinematics, target: pin.SE3) -> Callable[[Vector], tuple[pin.SE3, Matrix]]:
    """Return the function q → target in the tool frame, Jacobian (6, n_q) of the tool against the workpiece."""
    model, data = kinematics.model, kinematics.data
    tool, workpiece = kinematics.tool_id, kinematics.workpiece_id
    jacobians, frame, jacobian = pin.computeJointJacobians, pin.updateFramePlacement, frame_jacobian
    if kinematics.workpiece_fixed:
        T_base_target = kinematics.T_base_workpiece * target

        def against_base(q: Vector) -> tuple[pin.SE3, Matrix]:
            jacobians(model, data, q)
            return frame(model, data, tool).actInv(T_base_target), jacobian(model, data, tool)

        return against_base

    def against_workpiece(q: Vector) -> tuple[pin.SE3, Matrix]:
        jacobians(model, data, q)
        T = frame(model, data, workpiece).actInv(frame(model, data, tool))
        J = jacobian(model, data, tool)
        J -= T.toActionMatrixInverse().dot(jacobian(model, data, workpiece))
        return T.actInv(target), J

    return against_workpiece


def _joints(
    kinematics: Kinematics, free: NDArray[np.intp], x: Vector
) -> Callable[[Vector], tuple[Vector, Matrix | None]]:
    """Return the function y → joint values, their derivative by y (None: the identity)."""
    affine = kinematics.affine
    if affine is None:
        full = x.copy()

        def mapped(y: Vector) -> tuple[Vector, Matrix | None]:
            full[free] = y
            return kinematics.q(full), kinematics.dq_dx(full)[:, free]

        return mapped
    A, b = np.ascontiguousarray(affine.A[:, free]), affine.b + affine.A.dot(x)
    if A.shape[0] == A.shape[1] and (np.eye(len(A)) == A).all() and not b.any():
        return lambda y: (y, None)
    return lambda y: (A.dot(y) + b, A)
