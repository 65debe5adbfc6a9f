"""A chain as Pinocchio's model, and its pose, Jacobian and residuals in SI axis coordinates: what solvers iterate on.

`x` are the controller's axes in SI (metres, radians); `q = map(x)` are Pinocchio's. The solvers see only `x`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from threading import local
from typing import Final

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from chainbuild import tolerances
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AffineMap, random_axis_values
from chainbuild.chain.bodies.inertia import Inertia
from chainbuild.chain.closing import TipMap
from chainbuild.chain.elements import BASE_LINK, Axis, Chain, Joint, Task
from chainbuild.chain.fold import reach
from chainbuild.kinematics.newton import Residual
from chainbuild.kinematics.product import product_of, tip_product_of
from chainbuild.units import si_factor

_SAMPLES: Final = 8  # configurations in which the rank of a Jacobian is looked at
_DRAWN: Final = 170.0  # mm or degrees either way: what lines up at half a turn does not there
_TRIES: Final = 50  # for one of them with a pose: enough where a tenth of the range has poses

_LOCAL = pin.ReferenceFrame.LOCAL
_ALIGNED = {
    ("revolute", (1.0, 0.0, 0.0)): pin.JointModelRX,
    ("revolute", (0.0, 1.0, 0.0)): pin.JointModelRY,
    ("revolute", (0.0, 0.0, 1.0)): pin.JointModelRZ,
    ("prismatic", (1.0, 0.0, 0.0)): pin.JointModelPX,
    ("prismatic", (0.0, 1.0, 0.0)): pin.JointModelPY,
    ("prismatic", (0.0, 0.0, 1.0)): pin.JointModelPZ,
}
_UNALIGNED = {"revolute": pin.JointModelRevoluteUnaligned, "prismatic": pin.JointModelPrismaticUnaligned}


class _Scratch(local):
    """Pinocchio's scratch data, each thread's own: what one computes would overwrite what another still reads."""

    def __init__(self, model: pin.Model) -> None:
        self.data = model.createData()


def frame_jacobian(model: pin.Model, data: pin.Data, frame: int) -> Matrix:
    """Return the Jacobian (6, n_q) of a frame in its own axes, linear rows first, after `computeJointJacobians`."""
    J: Matrix = pin.getFrameJacobian(model, data, frame, _LOCAL)
    return J if J.ndim == 2 else J.reshape(6, 1)  # for one joint Pinocchio returns a vector


class Kinematics:
    """Evaluates one chain; holds Pinocchio's model and scratch data. Threads may share it.

    Args:
        chain: A checked chain.
    """

    def __init__(self, chain: Chain) -> None:
        self.chain = chain
        self.model = build_model(chain)
        self._scratch = _Scratch(self.model)
        self.si_factors = np.array([si_factor(axis.kind) for axis in chain.axes])
        self.tool_id = self.model.getFrameId("tool")
        self.workpiece_id = self.model.getFrameId("workpiece")
        self.workpiece_fixed = self.model.frames[self.workpiece_id].parentJoint == 0
        self.T_base_workpiece = self.model.frames[self.workpiece_id].placement.copy()
        self._map = chain.axis_map
        self._tips = self._map if isinstance(self._map, TipMap) else None
        self.tool_axis = chain.tool_column
        self.has_input_axes = any(axis.held for axis in chain.axes)
        self.product, self.tip_product = product_of(chain), tip_product_of(chain)
        # One rounding more: a target at full reach is not beyond it.
        self.reach = reach(chain, self.model.lowerPositionLimit, self.model.upperPositionLimit) * (1.0 + 1e-9) + 1e-9
        self.affine = self._map if isinstance(self._map, AffineMap) else None

    @property
    def data(self) -> pin.Data:
        """The calling thread's scratch data."""
        return self._scratch.data

    def q(self, x: Vector) -> Vector:
        """Return Pinocchio's joint values of SI axis values."""
        if self.affine is not None:
            result: Vector = self.affine.A @ x + self.affine.b
            return result
        return self._map.q(x / self.si_factors)

    def dq_dx(self, x: Vector) -> Matrix:
        """Return the derivative of the joint values by the SI axis values."""
        return self.affine.A if self.affine is not None else self._map.dq_daxes(x / self.si_factors)

    def pose(self, q: Vector) -> pin.SE3:
        """Return the tool in the workpiece frame [m] at joint values."""
        model, data = self.model, self._scratch.data
        pin.forwardKinematics(model, data, q)
        tool = pin.updateFramePlacement(model, data, self.tool_id)
        if self.workpiece_fixed:
            return self.T_base_workpiece.actInv(tool)
        workpiece = pin.updateFramePlacement(model, data, self.workpiece_id)
        return workpiece.actInv(tool)

    def tip_pose(self, axes: Vector) -> pin.SE3 | None:
        """Return the pose at axis values (n_axes,), mm and degrees, without the struts of closed loops.

        None where nothing closes, or where the axis map does not give the joints between the tips alone.
        """
        values = None if self._tips is None else self._tips.tip_values(axes)
        if values is None:
            return None
        q = np.zeros(self.model.nq)
        q[: len(values)] = values
        return self.pose(q)

    def pose_and_jacobian(self, x: Vector) -> tuple[pin.SE3, Matrix]:
        """Return pose and Jacobian (6, n_axes), linear rows first, tool frame, by SI axis values."""
        model, data = self.model, self._scratch.data
        pin.computeJointJacobians(model, data, self.q(x))
        tool = pin.updateFramePlacement(model, data, self.tool_id)
        J = frame_jacobian(model, data, self.tool_id)
        if self.workpiece_fixed:
            return self.T_base_workpiece.actInv(tool), J @ self.dq_dx(x)
        workpiece = pin.updateFramePlacement(model, data, self.workpiece_id)
        T = workpiece.actInv(tool)
        J = J - T.toActionMatrixInverse() @ frame_jacobian(model, data, self.workpiece_id)
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
        axis, position = self.tool_axis, target.translation.copy()
        direction, rows = target.rotation[:, axis].copy(), [n for n in range(6) if n != 3 + axis]

        def residual(x: Vector) -> tuple[Vector, Matrix]:
            T, J = self.pose_and_jacobian(x)
            back = T.rotation.T
            error = np.concatenate([back @ (position - T.translation), tilt(back @ direction, axis)])
            return error[rows], J[rows]

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
        return self._missed(self.pose(self.q(x)), target, task)

    def errors_and_jacobian(self, x: Vector, target: pin.SE3, task: Task) -> tuple[float, float, Matrix]:
        """Return `errors`, and the rows of the Jacobian (k, n_axes) that the task determines, as `residual` does."""
        T, J = self.pose_and_jacobian(x)
        if task != "pose":
            J = J[:3] if task == "position" else J[[n for n in range(6) if n != 3 + self.tool_axis]]
        return *self._missed(T, target, task), J

    def _missed(self, T: pin.SE3, target: pin.SE3, task: Task) -> tuple[float, float]:
        distance = math.dist(T.translation.tolist(), target.translation.tolist())
        if task == "pose":
            return distance, math.hypot(*pin.log3(T.rotation.T @ target.rotation).tolist())
        direction = T.rotation.T @ target.rotation[:, self.tool_axis]
        return distance, math.hypot(*tilt(direction, self.tool_axis).tolist())


def tilt(direction: Vector, axis: int) -> Vector:
    """Return the smallest turn, as a rotation vector (3,), that brings a coordinate axis to a direction of length 1."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    sine = math.hypot(direction[i], direction[j])
    turn = np.zeros(3)
    if sine < 1e-15:
        # Exactly opposite: any turn by 180° will do.
        turn[i] = 0.0 if direction[axis] > 0.0 else math.pi
        return turn
    scale = math.atan2(sine, direction[axis]) / sine
    turn[i], turn[j] = -direction[j] * scale, direction[i] * scale
    return turn


def joint_bounds(chain: Chain) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return lower and upper joint values (n_q,), SI, over the box of the axis limits."""
    lower, upper = np.array([axis.range for axis in chain.axes]).T
    return chain.axis_map.q_bounds(lower, upper)


def joint_speed_limits(chain: Chain) -> Vector:
    """Return the highest speed of every joint (n_q,), m/s or rad/s, by those of its axes; infinite: one is not known.

    Args:
        chain: The chain.
    """
    if not isinstance(chain.axis_map, AffineMap):
        return np.full(len(chain.joints), np.inf)
    A = np.abs(chain.axis_map.A)
    known = [np.inf if axis.max_speed is None else axis.max_speed * si_factor(axis.kind) for axis in chain.axes]
    speeds: Vector = np.where(A > 0.0, A, 1.0) * known
    limits: Vector = np.where(A > 0.0, speeds, 0.0).sum(axis=1)
    return np.where(A.any(axis=1), limits, np.inf)


def build_model(chain: Chain) -> pin.Model:
    """Return the Pinocchio model of a chain.

    Joint n of the chain is joint n + 1 of the model and has one coordinate, so nq = nv = number of joints.
    Every link is a BODY frame, every frame of the chain an operational frame. Inertias, efforts and dampings are those
    of a URDF; machine data hold none, and inertias are zero then. Speeds are infinite where they are not known.

    Args:
        chain: A checked chain.
    """
    model = pin.Model()
    model.name = chain.name
    lower, upper = joint_bounds(chain)
    speeds = joint_speed_limits(chain)
    ids = {BASE_LINK: 0}
    for n, joint in enumerate(chain.joints):
        limits = (np.array([np.inf]), speeds[n : n + 1], lower[n : n + 1], upper[n : n + 1])
        placement = pin.SE3(joint.T_parent_joint)
        index = model.addJoint(ids[joint.parent], _joint_model(joint), placement, joint.name, *limits)
        ids[joint.child] = index
        model.addJointFrame(index)
        given = joint.dynamics
        if given.effort is not None:
            model.lowerEffortLimit[n], model.upperEffortLimit[n] = -given.effort, given.effort
        model.lowerDryFrictionLimit[n], model.upperDryFrictionLimit[n] = -given.friction, given.friction
        model.damping[n] = given.damping
    for name, own in chain.geometry.inertias.items():
        model.appendBodyToJoint(ids[name], _pin_inertia(own), pin.SE3.Identity())
    for link in chain.links:
        if link.name != BASE_LINK:
            model.addBodyFrame(link.name, ids[link.name], pin.SE3.Identity(), -1)
    for frame in chain.frames:
        joint_id = ids[frame.link]
        model.addFrame(pin.Frame(frame.name, joint_id, pin.SE3(frame.T_link_frame), pin.FrameType.OP_FRAME))
    return model


def _pin_inertia(own: Inertia) -> pin.Inertia:
    """Return an inertia as the file gives it: the constructor refuses moments that rounding left below 0."""
    found = pin.Inertia.Zero()
    found.mass, found.lever, found.inertia = own.mass, own.centre, own.moments
    return found


def _joint_model(joint: Joint) -> pin.JointModel:
    x, y, z = (float(component) for component in joint.direction)
    aligned = _ALIGNED.get((joint.kind, (x, y, z)))
    return aligned() if aligned else _UNALIGNED[joint.kind](x, y, z)


def usual_range(axis: Axis) -> tuple[float, float]:
    """Return the range of an axis in which positions are drawn: its limits, no wider than about half a turn."""
    low, high = max(axis.lower, -_DRAWN), min(axis.upper, _DRAWN)
    return (low, high) if low < high else (axis.lower, axis.upper)


def sampled_jacobians(kinematics: Kinematics, free: NDArray[np.bool_]) -> Callable[[int], Matrix]:
    """Return the function n → Jacobian by the free axes at the n-th of a few fixed configurations, each made once."""
    axes = kinematics.chain.axes
    lower, upper = np.array([usual_range(axis) for axis in axes]).T
    rng = np.random.default_rng(0)
    made: list[Matrix] = []

    def sample(n: int) -> Matrix:
        while len(made) <= n:
            J = np.zeros((6, len(axes)))
            for _ in range(_TRIES):  # limits may be wider than what the axis map has joint values for
                values = random_axis_values(kinematics.chain.axis_map, rng, lower, upper)[0]
                there = kinematics.pose_and_jacobian(values * kinematics.si_factors)[1]
                if np.isfinite(there).all():
                    J = there
                    break
            made.append(J[:, free])
        return made[n]

    return sample


def generic_rank(sample: Callable[[int], Matrix], rows: list[int]) -> int:
    """Return the largest rank of some rows of the Jacobian over the samples; one of full rank is enough."""
    best, most = 0, min(len(rows), sample(0).shape[1])
    for n in range(_SAMPLES):
        if best == most:
            break
        values = np.linalg.svd(sample(n)[rows], compute_uv=False)
        # By the size of all rows: those asked for may be nothing but rounding.
        best = max(best, int((values > tolerances.RANK * float(np.linalg.norm(sample(n)))).sum()))
    return best
