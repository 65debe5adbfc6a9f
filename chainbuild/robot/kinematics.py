"""Pose, Jacobian and residuals of a model in SI axis coordinates: the maths that solvers iterate on.

`x` are the controller's axes in SI (metres, radians); `q = map(x)` are Pinocchio's. The solvers see only `x`.
"""

from __future__ import annotations

from collections.abc import Callable

import eigenpy
import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.elements import Chain, Task
from chainbuild.robot.model import build_model
from chainbuild.units import si_factor

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Residual = Callable[[Vector], tuple[Vector, Matrix]]

_LOCAL = pin.ReferenceFrame.LOCAL
_Z = np.array([0.0, 0.0, 1.0])


class Kinematics:
    """Evaluates one chain; holds Pinocchio's model and scratch data.

    Args:
        chain: A checked chain.
    """

    def __init__(self, chain: Chain) -> None:
        self.chain = chain
        self.model = build_model(chain)
        self.data = self.model.createData()
        self.si_factors = np.array([si_factor(axis.kind) for axis in chain.axes])
        self._tool = self.model.getFrameId("tool")
        self._workpiece = self.model.getFrameId("workpiece")
        self._workpiece_fixed = self.model.frames[self._workpiece].parentJoint == 0
        self._T_base_workpiece = self.model.frames[self._workpiece].placement.copy()
        self._map = chain.axis_map
        self._affine = self._map if isinstance(self._map, AffineMap) else None

    def q(self, x: Vector) -> Vector:
        """Return Pinocchio's joint values of SI axis values."""
        if self._affine is not None:
            result: Vector = self._affine.A @ x + self._affine.b
            return result
        return self._map.q(x / self.si_factors)

    def dq_dx(self, x: Vector) -> Matrix:
        """Return the derivative of the joint values by the SI axis values."""
        return self._affine.A if self._affine is not None else self._map.dq_daxes(x / self.si_factors)

    def pose(self, q: Vector) -> pin.SE3:
        """Return the tool in the workpiece frame [m] at joint values."""
        pin.forwardKinematics(self.model, self.data, q)
        tool = pin.updateFramePlacement(self.model, self.data, self._tool)
        if self._workpiece_fixed:
            return self._T_base_workpiece.actInv(tool)
        workpiece = pin.updateFramePlacement(self.model, self.data, self._workpiece)
        return workpiece.actInv(tool)

    def pose_and_jacobian(self, x: Vector) -> tuple[pin.SE3, Matrix]:
        """Return pose and Jacobian (6, n_axes), linear rows first, tool frame, by SI axis values."""
        model, data = self.model, self.data
        pin.computeJointJacobians(model, data, self.q(x))
        tool = pin.updateFramePlacement(model, data, self._tool)
        J = pin.getFrameJacobian(model, data, self._tool, _LOCAL)
        if self._workpiece_fixed:
            return self._T_base_workpiece.actInv(tool), J @ self.dq_dx(x)
        workpiece = pin.updateFramePlacement(model, data, self._workpiece)
        T = workpiece.actInv(tool)
        J = J - T.toActionMatrixInverse() @ pin.getFrameJacobian(model, data, self._workpiece, _LOCAL)
        return T, J @ self.dq_dx(x)

    def residual(self, target: pin.SE3, task: Task) -> Residual:
        """Return the function x → (error, Jacobian) of a task.

        The error is expressed in the tool frame: what the tool still has to move.

        Args:
            target: Tool in the workpiece frame [m].
            task: "pose" (6 rows), "direction" (position and tool vector, 5 rows) or "position" (3 rows).
        """
        if task == "pose":
            return self._pose_residual(target)
        if task == "direction":
            return self._direction_residual(target)
        return self._position_residual(target)

    def _pose_residual(self, target: pin.SE3) -> Residual:
        def residual(x: Vector) -> tuple[Vector, Matrix]:
            T, J = self.pose_and_jacobian(x)
            return pin.log6(T.actInv(target)).vector, J

        return residual

    def _direction_residual(self, target: pin.SE3) -> Residual:
        direction, position = target.rotation[:, 2].copy(), target.translation.copy()

        def residual(x: Vector) -> tuple[Vector, Matrix]:
            T, J = self.pose_and_jacobian(x)
            back = T.rotation.T
            error = np.empty(5)
            error[:3] = back @ (position - T.translation)
            error[3:] = tilt(back @ direction)
            return error, J[:5]

        return residual

    def _position_residual(self, target: pin.SE3) -> Residual:
        position = target.translation.copy()

        def residual(x: Vector) -> tuple[Vector, Matrix]:
            T, J = self.pose_and_jacobian(x)
            return T.rotation.T @ (position - T.translation), J[:3]

        return residual

    def errors(self, x: Vector, target: pin.SE3, task: Task) -> tuple[float, float]:
        """Return the distance [m] and angle [rad] that a solution misses the target by.

        The angle is that of the whole rotation for a full pose, else that of the tool vector.
        """
        T = self.pose(self.q(x))
        distance = float(np.linalg.norm(T.translation - target.translation))
        if task == "pose":
            return distance, float(np.linalg.norm(pin.log3(T.rotation.T @ target.rotation)))
        return distance, float(np.linalg.norm(tilt(T.rotation.T @ target.rotation[:, 2])))


def tilt(direction: Vector) -> Vector:
    """Return the rotation vector (x, y parts) that turns the z axis into a direction of length 1."""
    sine = float(np.hypot(direction[0], direction[1]))
    if sine < 1e-15:
        # Exactly opposite: any turn by 180° will do.
        return np.array([0.0 if direction[2] > 0 else np.pi, 0.0])
    scale = float(np.arctan2(sine, direction[2])) / sine
    return np.array([-direction[1] * scale, direction[0] * scale])


def damped_step(J: Matrix, error: Vector, damping: float) -> Vector:
    """Return the damped least-squares step (JᵀJ + damping·1)⁻¹·Jᵀ·error."""
    rows, columns = J.shape
    if rows < columns:
        H = J @ J.T
        H.flat[:: rows + 1] += damping
        short: Vector = J.T @ eigenpy.LLT(H).solve(error)
        return short
    H = J.T @ J
    H.flat[:: columns + 1] += damping
    step: Vector = eigenpy.LLT(H).solve(J.T @ error)
    return step
