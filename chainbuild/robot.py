"""Class Robot: a mechanism with its inverse kinematics."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Self

from chainbuild.ik.showing import DisplayedMechanism

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from chainbuild.coupling.distribution import Distribution
    from chainbuild.ik.branches.core.branches import Branches
    from chainbuild.ik.plan import SolverPlan
    from chainbuild.ik.policies.redundancy import Preference
    from chainbuild.ik.request import Held, IkOptions
    from chainbuild.ik.result import IkResult
    from chainbuild.ik.search.table import IkTable
    from chainbuild.kinematics.inputs import Pose
    from chainbuild.progress import Progress
    from chainbuild.units import Units


@cache
def _solve() -> Callable[..., IkResult]:
    """Return the solver of one pose: where calls take microseconds, an import in each of them counts."""
    from chainbuild.ik.solve import solve

    return solve


@cache
def _ik_all() -> Callable[..., Branches]:
    """Return the solver of all branches, likewise."""
    from chainbuild.ik.branches.every import ik_all

    return ik_all


class Robot(DisplayedMechanism):
    """Forward and inverse kinematics of a chain, in the controller's axis values.

    >>> robot = Robot.load("kr6r900")
    >>> T = robot.fk([0, -90, 90, 0, 30, 0])
    >>> robot.ik(T, start=[5, -80, 80, 0, 20, 0]).axes.round().astype(int).tolist()
    [0, -90, 90, 0, 30, 0]
    """

    # Each method is a signature and one call. Solvers are imported inside, since forward kinematics needs none of them.

    @classmethod
    def load(
        cls,
        path: str | os.PathLike[str],
        kinematic: int | str | tuple[int | str, int | str] | None = None,
        channel: int | None = None,
        tool_length_mm: float = 0.0,
        conventions: Mapping[str, str] | None = None,
        *,
        overlay: str | os.PathLike[str] | None = None,
        tool: str | None = None,
    ) -> Self:
        """Read a machine file, or a shipped machine by name, and build one of its kinematics.

        Args:
            path: A file, or the name of a shipped machine; an existing path wins.
            kinematic: Configured id or name, or a pair of these; None: the default. See `Machine.chain`.
            channel: Channel; None: the first with a transformation.
            tool_length_mm: Length added to the active tool's length [mm].
            conventions: Convention name → choice.
            overlay: An overlay file instead of the one next to the machine file.
            tool: Of a URDF: link whose frame is the tool; see `chainbuild.load`.

        Raises:
            ChainbuildError: the file cannot be read, or describes no machine that can be built.
        """
        from chainbuild.formats.load import load

        return cls(load(path, overlay=overlay, tool=tool).chain(kinematic, channel, tool_length_mm, conventions))

    @classmethod
    def from_urdf(
        cls, path: str | os.PathLike[str], *, tool: str | None = None, overlay: str | os.PathLike[str] | None = None
    ) -> Self:
        """Read a URDF file from its root link to a tool link; see `chainbuild.from_urdf`.

        Raises:
            ChainbuildError: the file is not a URDF, there is no such link, or the overlay does not fit.
        """
        from chainbuild.formats.load import from_urdf

        return cls(from_urdf(path, tool=tool, overlay=overlay))

    def ik(  # noqa: PLR0913 (every option by name)
        self,
        T: Pose | ArrayLike,
        start: ArrayLike | None = None,
        held: Mapping[str, float] | Sequence[float] | None = None,
        *,
        solver: str = "auto",
        absolute_c_deg: float | None = None,
        prefer: Preference | None = None,
        options: IkOptions | None = None,
        status: int | None = None,
        turn: int | None = None,
        units: Units = "controller",
    ) -> IkResult:
        """Find axis values that bring the tool to a pose, inside the limits and verified by forward kinematics.

        ROBX robots with four axes are programmed by position and angle C: A and B of T follow where the robot cannot
        reach them.

        Args:
            T: Tool in the workpiece frame [m]: `pin.SE3` or a (4, 4) array.
            start: Axis values (n_axes,) to start from and stay near; None: zero on machine tools, else near the pose.
            held: Axis name → value to hold, or one value for each input axis (`Axis.held`) in order. Input axes
                not named are taken from `start`, else 0.
            solver: "damped"; "analytic": a closed form; "controller": the iteration budget of the machine data;
                "auto": damped, then a closed form if that finds nothing.
            absolute_c_deg: Angle C including whole turns [degrees], on robots that count them (`Chain.absolute_c`); it
                takes precedence over T's orientation.
            prefer: Redundancy resolution on robots with more axes than the pose needs: "near" the start, in the
                "middle" of the limits, or "dexterous", away from singularities. None: what the solver finds.
            options: Tolerances, weights, restarts and seed of the damped solver.
            status: KIN_TYP 45: only solutions of this pose status (IS, 0 … 7) count.
            turn: Only solutions of this turn (IT, 0 … 63) count, whole turns included; it needs the status.
            units: Those of start, held and the result: "controller", mm and degrees, or "si", metres and radians.

        Returns:
            The solution, or the best axis values found with a status that states the reason of failure.

        Raises:
            AxisValueError: start or held has a wrong number of values, an unknown name or a non-finite value.
            ChainbuildError: T is not a rigid transform, or the robot has no such solver, status or turn.
        """
        solve = _solve()
        if units == "controller":
            return solve(self, T, start, held, solver, absolute_c_deg, prefer, options, (status, turn))
        start, held = self._in_controller_units(start, held, units)
        return solve(self, T, start, held, solver, absolute_c_deg, prefer, options, (status, turn)).to(units)

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
        """Find axis values along a path, each pose starting at the previous one and on the nearest branch.

        A pose that is not reached keeps its status, and the next one starts at the last that was reached. On KIN_TYP 45
        the pose status of the start, else of the first row, is kept where it can be; the table tells where not.

        Args:
            poses: (N, 4, 4) poses or a sequence of `pin.SE3`, tool in the workpiece frame [m].
            start: Axis values (n_axes,) before the first pose; None: any.
            held: As for `ik`, the same along the path.
            progress: True: a bar on standard error; a function: called with the poses done and all poses.
            options: As for `ik`.
            units: As for `ik`, also of the table.

        Raises:
            AxisValueError: start or held has a wrong number of values, an unknown name or a non-finite value.
            ChainbuildError: a pose is not a rigid transform.
        """
        from chainbuild.ik.solve import solve_along

        start, held = self._in_controller_units(start, held, units)
        return solve_along(self, poses, start, held, progress, options).to(units)

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
        """Find axis values for many independent poses, on all cores with the extra `fast`.

        Args:
            poses: (N, 4, 4) poses or a sequence of `pin.SE3`, tool in the workpiece frame [m].
            start: Axis values (n_axes,) for all poses or (N, n_axes); None: sampled configurations with nearby poses.
            held: As for `ik`, the same for all poses.
            progress: True: a bar on standard error; a function: called with the poses done and all poses.
            options: As for `ik`.
            units: As for `ik`, also of the table.

        Raises:
            AxisValueError: start or held has a wrong number of values, an unknown name or a non-finite value.
            ChainbuildError: a pose is not a rigid transform.
        """
        from chainbuild.ik.solve import solve_many

        start, held = self._in_controller_units(start, held, units)
        return solve_many(self, poses, start, held, progress, options).to(units)

    def ik_all(
        self,
        T: Pose | ArrayLike,
        start: ArrayLike | None = None,
        held: Mapping[str, float] | Sequence[float] | None = None,
        *,
        windings: bool = False,
        status: int | None = None,
        turn: int | None = None,
        redundant: str | Sequence[str] | None = None,
        samples: int = 12,
        units: Units = "controller",
    ) -> Branches:
        """Find every branch of a pose inside the limits, nearest to the start first, verified by forward kinematics.

        The result is complete, but for rounding where branches meet, if the plan is (`plan`); else it holds what damped
        descents from many starts find. Of solutions that form a curve there is one branch, with its `free_directions`.

        Args:
            T: Tool in the workpiece frame [m]: `pin.SE3` or a (4, 4) array.
            start: Axis values (n_axes,) that order the branches; axes left free keep theirs as far as limits permit.
            held: As for `ik`.
            windings: True: every whole turn within the limits is a branch of its own, not only the nearest.
            status: Only branches of this status and this turn, as for `ik`; None: all.
            turn: See status.
            redundant: Name of an axis too many, or names of several: the branches at values of it spread over its
                limits, and at that of the start.
            samples: Number of these values.
            units: As for `ik`.

        Raises:
            AxisValueError: start or held of wrong count, unknown name or not finite.
            ChainbuildError: T is no rigid transform, more axes are free than the pose determines, or there are no such
                units, status, turn or redundant axis.
        """
        ik_all = _ik_all()
        if units != "controller":
            start, held = self._in_controller_units(start, held, units)
        found = ik_all(
            self, T, start, held, windings=windings, status=status, turn=turn, redundant=redundant, samples=samples
        )
        return found if units == "controller" else found.to(units)

    def ik_all_batch(
        self,
        poses: Sequence[Pose] | ArrayLike,
        *,
        limits: bool = True,
        compiled: bool = True,
        held: Mapping[str, float] | Sequence[float] | None = None,
        redundant: str | Sequence[str] | None = None,
        samples: int = 12,
        units: Units = "controller",
        progress: Progress = False,
    ) -> NDArray[np.float64]:
        """Return all branches (N, K, n_axes) of many poses; see `chainbuild.ik_all_batch`.

        Args:
            poses: (N, 4, 4) poses or a sequence of `pin.SE3`, tool in the workpiece frame [m].
            limits: False: every branch, whatever the limits.
            compiled: False: plain Python and NumPy, even where numba is installed.
            held: As for `ik`.
            redundant: Name of an axis too many, or names of several: its values are spread over its limits.
            samples: Number of these values.
            units: Those of held and of the result, as for `ik`.
            progress: True: show a progress bar on stderr.

        Raises:
            AxisValueError: held of wrong count, unknown name or not finite.
            ChainbuildError: the plan does not find every branch, a pose is no rigid transform, or there are no such
                units or redundant axis.
        """
        from chainbuild.ik.branches.many import ik_all_batch

        return ik_all_batch(
            self, poses, limits=limits, compiled=compiled, held=held, redundant=redundant, samples=samples,
            units=units, progress=progress,
        )  # fmt: skip

    def _in_controller_units(
        self, start: ArrayLike | None, held: Held | None, units: Units
    ) -> tuple[ArrayLike | None, Held | None]:
        if units == "controller":
            return start, held
        from chainbuild.ik.request import in_controller_units

        return in_controller_units(self, start, held, units)

    def plan(self, held: Mapping[str, float] | Iterable[str] = ()) -> SolverPlan:
        """Return the solver of this robot's poses while some axes are held, its reason, and whether it is complete.

        Args:
            held: Axis name → value, or the name or names of axes held at 0. The value matters: an arm with its
                fourth axis at 0 may be simpler than at 30 degrees.

        Raises:
            AxisValueError: an unknown name, or a value that is not finite.
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
        """Distribute a tool position over the partial kinematics of a composed robot (KIN_TYP 210, `chain.compose`).

        Args:
            tcp: X, Y, Z [mm], A, B, C [degrees] of the tool in the workpiece frame, all six or some by letter.
            axes: Directly programmed coordinates: "PARTIAL.X" or an axis by name → value, or PARTIAL → letter → value.
            locked: Coordinates of partials that keep their values, such as "PARTIAL.X", or axes by name.
            current: PARTIAL → its current values [mm, degrees]; default: all 0.

        Returns:
            Six Cartesian values per partial; `axes()` of the result returns the axis values.

        Raises:
            AxisValueError: an unknown partial or coordinate, or a freedom that a partial does not have.
            ChainbuildError: the free coordinates cannot make the motion.
        """
        from chainbuild.coupling.distribution import distribute

        return distribute(self, tcp, axes=axes, locked=locked, current=current)
