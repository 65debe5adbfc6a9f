"""Robot: a mechanism with its inverse kinematics, the roof over the solvers."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Self

from chainbuild.kinematics.mechanism import Mechanism

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from chainbuild.coupling.distribution import Distribution
    from chainbuild.ik.branches.core.branches import Branches
    from chainbuild.ik.options import IkOptions
    from chainbuild.ik.plan import SolverPlan
    from chainbuild.ik.policies.redundancy import Preference
    from chainbuild.ik.request import Held
    from chainbuild.ik.result import IkResult
    from chainbuild.ik.search.table import IkTable
    from chainbuild.kinematics.inputs import Pose
    from chainbuild.progress import Progress
    from chainbuild.units import Units


class Robot(Mechanism):
    """A chain that moves, with forward and inverse kinematics in the controller's axis values.

    >>> robot = Robot.load("kr6r900")
    >>> T = robot.fk([0, -90, 90, 0, 30, 0])
    >>> robot.ik(T, start=[5, -80, 80, 0, 20, 0]).axes.round().astype(int).tolist()
    [0, -90, 90, 0, 30, 0]
    """

    # Each method is a signature and one call; solvers are imported there, for forward kinematics needs none of them.

    @classmethod
    def load(
        cls,
        path: str | os.PathLike[str],
        kinematic: int | str | None = None,
        channel: int | None = None,
        tool_length_mm: float = 0.0,
        conventions: Mapping[str, str] | None = None,
        *,
        overlay: str | os.PathLike[str] | None = None,
    ) -> Self:
        """Read a machine file, or a shipped machine by name, and build one of its kinematics.

        Args:
            path: A file, or the name of a shipped machine; an existing path wins.
            kinematic: Configured id or name; None: the file's default. See `Machine.chain`.
            channel: Channel; None: the first with a transformation.
            tool_length_mm: Added to the active tool's length.
            conventions: Convention name → choice.
            overlay: An overlay file in place of the one beside the machine file.

        Raises:
            ChainbuildError: the file cannot be read, or holds no machine that could be built.
        """
        from chainbuild.formats.load import load

        return cls(load(path, overlay=overlay).chain(kinematic, channel, tool_length_mm, conventions))

    @classmethod
    def from_urdf(cls, path: str | os.PathLike[str], *, tool: str | None = None) -> Self:
        """Read a URDF file from its root link to a tool link; see `chainbuild.from_urdf`.

        Args:
            path: The file (plain URDF, not xacro).
            tool: Name of the link whose frame is the tool; None: the only link without children.

        Raises:
            ChainbuildError: no URDF, or no such link.
        """
        from chainbuild.formats.urdf import from_urdf

        return cls(from_urdf(path, tool=tool))

    def ik(
        self,
        T: Pose | ArrayLike,
        start: ArrayLike | None = None,
        held: Mapping[str, float] | Sequence[float] | None = None,
        *,
        solver: str = "auto",
        absolute_c_deg: float | None = None,
        prefer: Preference | None = None,
        options: IkOptions | None = None,
        units: Units = "controller",
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
            units: Those of start, held and the result: "controller", mm and degrees, or "si", metres and radians.

        ROBX robots of four axes are programmed by position and angle C: where they cannot reach A and B of T, these
        follow.

        Returns:
            The solution, or the best found with a status that says why it is none.

        Raises:
            AxisValueError: start or held of wrong count, unknown name or not finite.
            ChainbuildError: T is no rigid transform, the robot has no such solver, or there are no such units.
        """
        from chainbuild.ik.solve import solve

        if units == "controller":
            return solve(self, T, start, held, solver, absolute_c_deg, prefer, options)
        start, held = self._in_controller_units(start, held, units)
        return solve(self, T, start, held, solver, absolute_c_deg, prefer, options).to(units)

    def ik_path(
        self,
        poses: Sequence[Pose] | ArrayLike,
        start: ArrayLike | None = None,
        held: Mapping[str, float] | Sequence[float] | None = None,
        *,
        progress: Progress = False,
        options: IkOptions | None = None,
        units: Units = "controller",
    ) -> IkTable:
        """Find axis values along a path, each pose from the one before and on the nearest branch.

        Args:
            poses: (N, 4, 4) poses or a sequence of `pin.SE3`, tool in the workpiece frame [m].
            start: Axis values (n_axes,) where the path begins; None: anywhere.
            held: As for `ik`, the same along the path.
            progress: True: a bar on standard error; a function: called with the poses done and all poses.
            options: As for `ik`.
            units: As for `ik`, also of the table.

        A pose that is not met keeps its status, and the next one starts at the last that was.

        Raises:
            AxisValueError: start or held of wrong count, unknown name or not finite.
            ChainbuildError: a pose is no rigid transform, or there are no such units.
        """
        from chainbuild.ik.search.path import follow

        start, held = self._in_controller_units(start, held, units)
        return follow(self, poses, start, held, progress, options).to(units)

    def ik_batch(
        self,
        poses: Sequence[Pose] | ArrayLike,
        start: ArrayLike | None = None,
        held: Mapping[str, float] | Sequence[float] | None = None,
        *,
        progress: Progress = False,
        options: IkOptions | None = None,
        units: Units = "controller",
    ) -> IkTable:
        """Find axis values for many poses that have nothing to do with each other; on all cores with the extra `fast`.

        Args:
            poses: (N, 4, 4) poses or a sequence of `pin.SE3`, tool in the workpiece frame [m].
            start: Axis values (n_axes,) for all poses or (N, n_axes); None: configurations whose poses are near.
            held: As for `ik`, the same for all poses.
            progress: True: a bar on standard error; a function: called with the poses done and all poses.
            options: As for `ik`.
            units: As for `ik`, also of the table.

        Raises:
            AxisValueError: start or held of wrong count, unknown name or not finite.
            ChainbuildError: a pose is no rigid transform, or there are no such units.
        """
        from chainbuild.ik.search.batch import solve_many

        start, held = self._in_controller_units(start, held, units)
        return solve_many(self, poses, start, held, progress, options).to(units)

    def ik_all(
        self,
        T: Pose | ArrayLike,
        start: ArrayLike | None = None,
        held: Mapping[str, float] | Sequence[float] | None = None,
        *,
        windings: bool = False,
        units: Units = "controller",
    ) -> Branches:
        """Find every branch of a pose inside the limits, nearest to the start first, verified by forward kinematics.

        Where the plan is complete (`plan`) none is missing; else they are what damped descents from many starts come
        upon.

        Args:
            T: Tool in the workpiece frame [m]: `pin.SE3` or a (4, 4) array.
            start: Axis values (n_axes,) the order counts from; axes that a singular pose leaves free keep theirs.
            held: As for `ik`.
            windings: True: every whole turn within the limits is a branch of its own, not only the nearest.
            units: As for `ik`.

        Raises:
            AxisValueError: start or held of wrong count, unknown name or not finite.
            ChainbuildError: T is no rigid transform, more axes are free than the pose determines, or there are no such
                units.
        """
        from chainbuild.ik.branches.every import ik_all

        start, held = self._in_controller_units(start, held, units)
        return ik_all(self, T, start, held, windings=windings).to(units)

    def ik_all_batch(
        self,
        poses: Sequence[Pose] | ArrayLike,
        *,
        limits: bool = True,
        compiled: bool = True,
        units: Units = "controller",
    ) -> NDArray[np.float64]:
        """Return all branches (N, 8, 6) of many poses; see `chainbuild.ik_all_batch`.

        Args:
            poses: (N, 4, 4) poses or a sequence of `pin.SE3`, tool in the workpiece frame [m].
            limits: False: every branch, whatever the limits.
            compiled: False: NumPy, even where numba is installed.
            units: Those of the result, as for `ik`.

        Raises:
            ChainbuildError: the robot is no ortho-parallel arm with a spherical wrist, a pose is no rigid transform, or
                there are no such units.
        """
        from chainbuild.ik.branches.opw.batch import ik_all_batch

        return ik_all_batch(self, poses, limits=limits, compiled=compiled, units=units)

    def _in_controller_units(
        self, start: ArrayLike | None, held: Held | None, units: Units
    ) -> tuple[ArrayLike | None, Held | None]:
        if units == "controller":
            return start, held
        from chainbuild.ik.request import in_controller_units

        return in_controller_units(self, start, held, units)

    def plan(self, held: Mapping[str, float] | Iterable[str] = ()) -> SolverPlan:
        """Return how this robot's poses are solved while some axes are held: by what, why, and whether completely.

        Args:
            held: Axis name → value, or names of axes held at 0. A held value can decide: an arm whose fourth axis
                stands at 0 may be simpler than at 30 degrees.

        Raises:
            AxisValueError: an unknown name, or not finite.
        """
        from chainbuild.ik.plan import plan_of

        return plan_of(self, held)

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
