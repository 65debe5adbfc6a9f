"""Robot: a chain that moves, in the controller's axis values and in Pinocchio's joint values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from chainbuild import frames, tolerances
from chainbuild.chain.axismap import joint_values
from chainbuild.chain.check import check_chain
from chainbuild.chain.elements import Axis, Chain, Task
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.kinematics.evaluation import Kinematics
from chainbuild.kinematics.inputs import as_pose, axis_rows, axis_vector, numbers, outside_limits
from chainbuild.kinematics.product import poses_at
from chainbuild.kinematics.task import choose_task

if TYPE_CHECKING:
    from chainbuild.coupling.distribution import Distribution
    from chainbuild.ik.branches.core.branches import Branch
    from chainbuild.ik.options import IkOptions
    from chainbuild.ik.policies.redundancy import Preference
    from chainbuild.ik.result import IkResult
    from chainbuild.ik.search.table import IkTable

__all__ = ["Robot", "as_pose"]

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


class Robot:
    """A built chain: forward and inverse kinematics in the controller's axis values.

    Attributes:
        chain: What it was built from.
        model: Pinocchio's model with frames base, flange, tool and workpiece; nq = nv = number of joints.
        kinematics: The evaluator that solvers use.

    Raises:
        ChainError: the chain contradicts itself.
    """

    def __init__(self, chain: Chain) -> None:
        check_chain(chain)
        self.chain = chain
        self.kinematics = Kinematics(chain)

    def __repr__(self) -> str:
        return repr(self.chain).replace("<Chain", "<Robot", 1)

    @property
    def name(self) -> str:
        """File-system-safe name."""
        return self.chain.name

    @property
    def model(self) -> pin.Model:
        """Pinocchio's model."""
        return self.kinematics.model

    @property
    def axes(self) -> tuple[Axis, ...]:
        """The controller's axes in channel order."""
        return self.chain.axes

    @cached_property
    def task(self) -> Task:
        """What inverse kinematics solves for: "pose", "direction" or "position"."""
        return choose_task(self.kinematics, np.array([not axis.held for axis in self.axes]))

    def axis_values(self, axes: ArrayLike) -> Vector:
        """Return axis values as a checked float array (n_axes,), mm and degrees.

        Raises:
            AxisValueError: wrong count, not numbers, NaN, inf or absurdly large.
        """
        return axis_vector(self.axes, axes)

    def q(self, axes: ArrayLike) -> Vector:
        """Return Pinocchio's joint values (nq,), SI, of axis values (n_axes,), mm and degrees.

        Raises:
            AxisValueError: wrong count or not finite.
            ChainbuildError: a nonlinear axis map has no joint values there.
        """
        return joint_values(self.chain.axis_map, self.axis_values(axes))

    def axes_from_q(self, q: ArrayLike) -> Vector:
        """Return axis values (n_axes,), mm and degrees, of Pinocchio's joint values (nq,).

        Raises:
            AxisValueError: wrong count or not finite.
        """
        values = numbers(q)
        if values is None or values.shape != (self.model.nq,) or not np.isfinite(values).all():
            raise AxisValueError(f"{self.model.nq} finite joint values are due")
        return self.chain.axis_map.axes(values)

    def fk(self, axes: ArrayLike) -> pin.SE3:
        """Return the tool in the workpiece frame [m] at axis values (n_axes,), mm and degrees.

        Limits are not looked at.

        Raises:
            AxisValueError: wrong count or not finite.
            ChainbuildError: the kinematic has no pose there.
        """
        T = self.kinematics.pose(self.q(axes))
        if not np.isfinite(T.homogeneous).all():
            raise ChainbuildError("the kinematic has no finite pose at these axis values")
        return T

    def pose_angles(self, axes: ArrayLike) -> tuple[float, float, float]:
        """Return the pose angles A, B, C [deg] that the controller shows at axis values (n_axes,), mm and degrees.

        They are those of `Chain.angle_mode`, each in (-180, 180]; C runs on over whole turns where the machine says so
        (`Chain.absolute_c`).

        Raises:
            AxisValueError: wrong count or not finite.
            ChainbuildError: the kinematic has no pose there.
        """
        a, b, c = frames.angles_from_matrix(self.chain.angle_mode, self.fk(axes).rotation)
        total = self.chain.absolute_c
        return a, b, c if total is None else total.value(axes)

    def fk_batch(self, axes: ArrayLike) -> Matrix:
        """Return the tool in the workpiece frame (N, 4, 4) [m] at rows of axis values (N, n_axes), mm and degrees.

        Raises:
            AxisValueError: wrong shape or not finite.
            ChainbuildError: the kinematic has no pose there.
        """
        values = axis_rows(self.axes, axes)
        if self.kinematics.product is None:
            return np.array([self.fk(row).homogeneous for row in values]).reshape(-1, 4, 4)
        return poses_at(self.kinematics.product, values, self.kinematics.si_factors)

    def frame_placements(self, axes: ArrayLike) -> dict[str, pin.SE3]:
        """Return every frame of the model in the base [m] at axis values (n_axes,), mm and degrees."""
        model, data = self.model, self.kinematics.data
        pin.framesForwardKinematics(model, data, self.q(axes))
        return {frame.name: data.oMf[n].copy() for n, frame in enumerate(model.frames)}

    def jacobian(self, axes: ArrayLike) -> Matrix:
        """Return the Jacobian (6, n_axes) at axis values (n_axes,), mm and degrees.

        Linear rows, then angular; tool relative to workpiece, expressed in the tool frame (Pinocchio's LOCAL);
        derivative by metres and radians of the axes.

        Raises:
            AxisValueError: wrong count or not finite.
            ChainbuildError: the kinematic has no derivative there.
        """
        J = self.kinematics.pose_and_jacobian(self.axis_values(axes) * self.kinematics.si_factors)[1]
        if not np.isfinite(J).all():
            self.q(axes)  # says why where it knows
            raise ChainbuildError("the kinematic has no finite derivative at these axis values")
        return J

    def ik(
        self,
        T: pin.SE3 | ArrayLike,
        start: ArrayLike | None = None,
        held: Mapping[str, float] | Sequence[float] | None = None,
        *,
        solver: str = "auto",
        absolute_c_deg: float | None = None,
        prefer: Preference | None = None,
        options: IkOptions | None = None,
    ) -> IkResult:
        """Find axis values that bring the tool to a pose, inside the limits and verified by forward kinematics.

        Args:
            T: Tool in the workpiece frame [m]: `pin.SE3` or a (4, 4) array.
            start: Axis values (n_axes,) to start from and stay near; None: zero on machine tools, else near the pose.
            held: Axis name → value to hold, or one value for each input axis (`Axis.held`) in order. Input axes
                not named are taken from `start`, else 0.
            solver: "damped"; "analytic": a closed form; "controller": the iteration budget of the machine data;
                "auto": damped, and a closed form where that finds nothing.
            absolute_c_deg: Angle C over whole turns, on robots where it runs on (`Chain.absolute_c`); it decides where
                T's orientation does not go with it.
            prefer: On robots with more axes than the pose needs: "near" the start, in the "middle" of the limits, or
                "dexterous", away from singular positions. None: whatever the solver finds.
            options: Tolerances, weights, restarts and seed of the damped solver.

        ROBX robots of four axes are programmed by position and angle C: where they cannot reach A and B of T, these
        follow.

        Returns:
            The solution, or the best found with a status that says why it is none.

        Raises:
            AxisValueError: start or held of wrong count, unknown name or not finite.
            ChainbuildError: T is no rigid transform, or the robot has no such solver.
        """
        from chainbuild.ik.solve import inverse

        return inverse(self, T, start, held, solver, absolute_c_deg, prefer, options)

    def ik_path(
        self,
        poses: Sequence[pin.SE3] | ArrayLike,
        start: ArrayLike | None = None,
        held: Mapping[str, float] | Sequence[float] | None = None,
        *,
        progress: bool = False,
        options: IkOptions | None = None,
    ) -> IkTable:
        """Find axis values along a path, each pose from the one before and on the nearest branch.

        Args:
            poses: (N, 4, 4) poses or a sequence of `pin.SE3`, tool in the workpiece frame [m].
            start: Axis values (n_axes,) where the path begins; None: anywhere.
            held: As for `ik`, the same along the path.
            progress: True: a progress bar on standard error.
            options: As for `ik`.

        A pose that is not met keeps its status, and the next one starts at the last that was.

        Raises:
            AxisValueError: start or held of wrong count, unknown name or not finite.
            ChainbuildError: a pose is no rigid transform.
        """
        from chainbuild.ik.search.path import follow

        return follow(self, poses, start, held, progress, options)

    def ik_batch(
        self,
        poses: Sequence[pin.SE3] | ArrayLike,
        starts: ArrayLike | None = None,
        held: Mapping[str, float] | Sequence[float] | None = None,
        progress: bool = False,
        *,
        options: IkOptions | None = None,
    ) -> IkTable:
        """Find axis values for many poses that have nothing to do with each other; on all cores with the extra `fast`.

        Args:
            poses: (N, 4, 4) poses or a sequence of `pin.SE3`, tool in the workpiece frame [m].
            starts: Axis values (n_axes,) for all poses or (N, n_axes); None: configurations whose poses are near.
            held: As for `ik`, the same for all poses.
            progress: True: a progress bar on standard error.
            options: As for `ik`.

        Raises:
            AxisValueError: starts or held of wrong count, unknown name or not finite.
            ChainbuildError: a pose is no rigid transform.
        """
        from chainbuild.ik.search.batch import solve_many

        return solve_many(self, poses, starts, held, progress, options)

    def ik_all(
        self,
        T: pin.SE3 | ArrayLike,
        start: ArrayLike | None = None,
        held: Mapping[str, float] | Sequence[float] | None = None,
        *,
        windings: bool = False,
    ) -> tuple[Branch, ...]:
        """Find every branch of a pose inside the limits, nearest to the start first, verified by forward kinematics.

        Where a closed form is known (`chainbuild.ik.branches.analytic.method_of` tells) none is missing; else they
        are what damped descents from many starts come upon.

        Args:
            T: Tool in the workpiece frame [m]: `pin.SE3` or a (4, 4) array.
            start: Axis values (n_axes,) the order counts from; axes that a singular pose leaves free keep theirs.
            held: As for `ik`.
            windings: True: every whole turn within the limits is a branch of its own, not only the nearest.

        Raises:
            ChainbuildError: T is no rigid transform, or more axes are free than the pose determines.
        """
        from chainbuild.ik.branches.analytic import ik_all

        return ik_all(self, as_pose(T), start, held, windings=windings)

    def distribute(
        self,
        tcp: Mapping[str, float] | Sequence[float] | None = None,
        *,
        axes: Mapping[str, float | Mapping[str, float]] | None = None,
        locked: Iterable[str] = (),
        current: Mapping[str, Mapping[str, float] | Sequence[float]] | None = None,
    ) -> Distribution:
        """Hand a tool position out to the partial kinematics of a composed robot (KIN_TYP 210, `chain.compose`).

        Args:
            tcp: X, Y, Z [mm], A, B, C [degrees] of the tool in the workpiece frame, all six or some by letter.
            axes: Directly programmed coordinates: "PARTIAL.X" → value, or PARTIAL → letter → value.
            locked: Coordinates of partials that keep their values, such as "PARTIAL.X".
            current: PARTIAL → values it has now; without it all are 0.

        Returns:
            Six Cartesian values a partial; its `axes()` are the second step.

        Raises:
            AxisValueError: an unknown partial or coordinate, or a freedom that a partial does not have.
            ChainbuildError: the free coordinates cannot make the motion.
        """
        from chainbuild.coupling.distribution import distribute

        return distribute(self, tcp, axes=axes, locked=locked, current=current)

    def violated_limits(self, axes: ArrayLike) -> tuple[str, ...]:
        """Return the names of the axes outside their limits, then of the limits on sums of axes that are violated."""
        values = self.axis_values(axes)
        sums = [limit.name for limit in self.chain.constraints if limit.margin(values) < -tolerances.LIMIT_SUM_DEG]
        return (*outside_limits(self.axes, values), *sums)
