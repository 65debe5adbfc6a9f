"""Mechanism: a chain that moves, in the controller's axis values and in Pinocchio's joint values.

Solvers, analyses, writers and drawings take a mechanism; `chainbuild.Robot` is one that has its solvers as methods.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import replace
from threading import RLock
from typing import Any, Final, TypeVar

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from chainbuild import frames
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import joint_values
from chainbuild.chain.check import check_chain
from chainbuild.chain.closing import endless_reason
from chainbuild.chain.drives import drive_values
from chainbuild.chain.elements import Axis, Chain, Task
from chainbuild.errors import AxisValueError, ChainbuildError, ChainError
from chainbuild.findings import Collector, Finding, Findings
from chainbuild.html import html_table
from chainbuild.kinematics.evaluation import Kinematics, generic_rank, sampled_jacobians
from chainbuild.kinematics.inputs import axis_rows, axis_vector, real_numbers
from chainbuild.kinematics.limits import Limits
from chainbuild.kinematics.product import poses_at, tip_poses
from chainbuild.shown import number
from chainbuild.units import AxisLabels, Units

_T = TypeVar("_T")

_POSE_FREEDOMS: Final = 6  # position and orientation
_ROTARY_OF_MACHINE_TOOLS: Final = 3  # head or table: two orient the tool, a third is redundant
_NOTHING: Final[Any] = object()
_ENDLESS: Final = 1e10  # rates [m, rad] of closed loops beyond which their maps' 1e12 stands for what has no end


class Mechanism:
    """A chain with its kinematics: poses, Jacobians and limits in the controller's axis values.

    Threads may share a mechanism: each has its own working memory of Pinocchio. It pickles and copies as its chain.

    Attributes:
        chain: What it was built from.
        kinematics: The evaluator that solvers use.
        limits: The limits of axes, of sums of axes and of drives.
        labels: Names and units of its axis values, for results that hold some.
        task: What inverse kinematics solves for: "pose", "direction" or "position".
        prepared: Cache of what is made once for this mechanism, by kind and key; see `Prepared.get`.

    Raises:
        ChainError: the chain contradicts itself, or is something else.
    """

    def __init__(self, chain: Chain) -> None:
        if not isinstance(chain, Chain):
            got, hint = type(chain).__name__, "chainbuild.load(file).chain() returns one, Robot.load(file) a robot"
            raise ChainError(f"expected a Chain, got {got}", parameter="chain", hint=hint)
        check_chain(chain)
        self.chain = chain
        self.kinematics = Kinematics(chain)
        self.limits = Limits.of(chain)
        self.labels = AxisLabels(tuple(axis.name for axis in chain.axes), tuple(axis.kind for axis in chain.axes))
        self.task, lost = choose_task(self.kinematics, np.array([not axis.held for axis in chain.axes]))
        if lost is not None and lost not in chain.findings:
            self.chain = self.kinematics.chain = replace(chain, findings=Findings((*chain.findings, lost)))
        self.prepared = Prepared().get

    def __repr__(self) -> str:
        return repr(self.chain).replace("<Chain", f"<{type(self).__name__}", 1)

    def _repr_html_(self) -> str:
        head = ("Axis", "Kind", "Lower", "Upper", "Unit", "Limits", "Carries")
        rows = []
        for axis in self.axes:
            told = "endless" if axis.endless else "assumed" if axis.assumed else "given"
            told = f"{told}, the others in the middle" if axis.widest is not None else told
            lower, upper = number(axis.lower), number(axis.upper)
            rows.append((axis.name, axis.kind, lower, upper, axis.unit, told, axis.carries))
        sums = [(s.name, "sum", number(s.lower), number(s.upper), "", "given", "") for s in self.limits.plain_sums]
        drives = [
            (self.limits.drive_name(d), "drive", number(d.lower), number(d.upper), self.axes[d.axis].unit, "given", "")
            for d in self.limits.drives
        ]
        return html_table(head, [*rows, *sums, *drives], f"{self.chain.title} ({self.chain.kinematic})")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.chain,)

    @property
    def name(self) -> str:
        """File-system-safe name."""
        return self.chain.name

    @property
    def model(self) -> pin.Model:
        """Pinocchio's model with frames base, flange, tool and workpiece; nq = nv = number of joints."""
        return self.kinematics.model

    @property
    def axes(self) -> tuple[Axis, ...]:
        """The controller's axes in channel order."""
        return self.chain.axes

    def axis_values(self, axes: ArrayLike) -> Vector:
        """Return axis values as a checked float array (n_axes,), mm and degrees.

        Raises:
            AxisValueError: wrong count, not numbers, NaN, inf or absurdly large.
        """
        return axis_vector(self.axes, axes)

    def controller_values(self, axes: ArrayLike, units: Units) -> ArrayLike:
        """Return axis values (…, n_axes) in mm and degrees; what has another shape or is no number is left as it is.

        Args:
            axes: Axis values.
            units: Their units: "controller", mm and degrees, or "si", metres and radians.

        Raises:
            ChainbuildError: there are no such units.
        """
        factors, values = self.labels.to(units).factors, real_numbers(axes)
        return axes if values is None or values.shape[-1:] != (len(factors),) else values / factors

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
        values = real_numbers(q)
        if values is None or values.shape != (self.model.nq,) or not np.isfinite(values).all():
            got = "no numbers" if values is None else f"an array of shape {values.shape}"
            raise AxisValueError(f"expected {self.model.nq} finite joint values, got {got}")
        return self.chain.axis_map.axes(values)

    def fk(self, axes: ArrayLike, *, units: Units = "controller") -> pin.SE3:
        """Return the tool in the workpiece frame [m] at axis values (n_axes,); limits are not looked at.

        Args:
            axes: Axis values.
            units: Theirs: "controller", mm and degrees, or "si", metres and radians.

        Raises:
            AxisValueError: wrong count or not finite.
            ChainbuildError: the kinematic has no pose there, or there are no such units.
        """
        if units != "controller":
            axes = self.controller_values(axes, units)
        if self.chain.loops:
            alone = self.kinematics.tip_pose(self.axis_values(axes))
            if alone is not None:
                return alone
        pose = self.kinematics.pose(self.q(axes))
        if not np.isfinite(pose.homogeneous).all():
            raise ChainbuildError("the kinematic has no finite pose at these axis values")
        return pose

    def drives(self, axes: ArrayLike, *, units: Units = "controller") -> Vector:
        """Return what the drives stand at (n_axes,) at axis values (n_axes,): the same on most machines.

        They part where a gear, spatial angles or a virtual axis lie between the two (KIN_TYP 3, 28, 59, 60, 70, 76).

        Args:
            axes: Axis values.
            units: Those of axis and drive values: "controller", mm and degrees, or "si", metres and radians.

        Raises:
            AxisValueError: wrong count or not finite.
            ChainbuildError: the drives have no place there, or there are no such units.
        """
        if units != "controller":
            axes = self.controller_values(axes, units)
        values = drive_values(self.chain.drives, self.axis_values(axes))
        return values if units == "controller" else values * self.labels.to(units).factors

    def pose_angles(self, axes: ArrayLike) -> tuple[float, float, float]:
        """Return the pose angles A, B, C [deg] of the tool at axis values (n_axes,), mm and degrees.

        They are those of `Chain.angle_mode`, each in (-180, 180]; C may continue over whole turns
        (`Chain.absolute_c`). What the controller shows beside the position is `Robot.display`.

        Raises:
            AxisValueError: wrong count or not finite.
            ChainbuildError: the kinematic has no pose there.
        """
        a, b, c = frames.angles_from_matrix(self.chain.angle_mode, self.fk(axes).rotation)
        total = self.chain.absolute_c
        return a, b, c if total is None else total.value(axes)

    def fk_batch(self, axes: ArrayLike, *, units: Units = "controller") -> Matrix:
        """Return the tool in the workpiece frame (N, 4, 4) [m] at rows of axis values (N, n_axes).

        Args:
            axes: Axis values.
            units: Theirs, as for `fk`.

        Raises:
            AxisValueError: wrong shape or not finite.
            ChainbuildError: the kinematic has no pose there, or there are no such units.
        """
        if units != "controller":
            axes = self.controller_values(axes, units)
        values = axis_rows(self.axes, axes)
        if self.kinematics.tip_product is not None:
            return tip_poses(self.chain, self.kinematics.tip_product, values)
        if self.kinematics.product is None:
            return np.array([self.fk(row).homogeneous for row in values]).reshape(-1, 4, 4)
        return poses_at(self.kinematics.product, values, self.kinematics.si_factors)

    def frame_placements(self, axes: ArrayLike) -> dict[str, pin.SE3]:
        """Return every frame of the model in the base [m] at axis values (n_axes,), mm and degrees."""
        model, data = self.model, self.kinematics.data
        pin.framesForwardKinematics(model, data, self.q(axes))
        return {frame.name: data.oMf[n].copy() for n, frame in enumerate(model.frames)}

    def jacobian(self, axes: ArrayLike, frame: str = "tool", *, units: Units = "controller") -> Matrix:
        """Return the Jacobian (6, n_axes) at axis values (n_axes,).

        Linear rows (velocity of the tool's origin), then angular; tool relative to workpiece; derivative by metres and
        radians of the axes.

        Args:
            axes: Axis values.
            frame: In whose axes it is expressed: "tool" (Pinocchio's LOCAL) or "workpiece".
            units: Those of the axis values, as for `fk`; the derivative is the same in both.

        Raises:
            AxisValueError: wrong count or not finite.
            ChainbuildError: the kinematic has no derivative there, or frame or units are unknown.
        """
        if units != "controller":
            axes = self.controller_values(axes, units)
        if frame not in {"tool", "workpiece"}:
            raise ChainbuildError(f"unknown frame {frame!r}", parameter="frame", permitted="tool, workpiece")
        pose, J = self.kinematics.pose_and_jacobian(self.axis_values(axes) * self.kinematics.si_factors)
        if not float(np.abs(J).max(initial=0.0)) < (_ENDLESS if self.chain.loops else np.inf):  # or not a number
            self.q(axes)  # gives the reason where it is known
            raise ChainbuildError(endless_reason(self.chain.axis_map, self.axis_values(axes)))
        return J if frame == "tool" else np.vstack((pose.rotation @ J[:3], pose.rotation @ J[3:]))

    def violated_limits(self, axes: ArrayLike) -> tuple[str, ...]:
        """Return the names of the axes outside their limits, then of the sums and the drives ("A_drive") that are.

        A value up to `tolerances.LIMIT_SLACK` beyond its limit still counts as inside.

        Raises:
            AxisValueError: wrong count or not finite.
        """
        return self.limits.violated(self.axis_values(axes))


class Prepared:
    """A cache by kind and key: each thing is made at its first use; threads may share it.

    A thing that two threads request at once is made once, under one lock for all of them; returning it again takes no
    lock.
    """

    def __init__(self) -> None:
        self._kinds: dict[str, dict[Hashable, Any]] = {}
        self._lock = RLock()  # making one thing may request others

    def get(self, kind: str, make: Callable[[], _T], key: Hashable = None, most: int | None = None) -> _T:
        """Return a thing, made now or before.

        Args:
            kind: What it is.
            make: Makes it.
            key: Which one of its kind.
            most: Number of the newest of the kind that are kept; None: all.
        """
        known = self._kinds.get(kind)
        found = _NOTHING if known is None else known.get(key, _NOTHING)
        return self._made(kind, make, key, most) if found is _NOTHING else found

    def _made(self, kind: str, make: Callable[[], _T], key: Hashable, most: int | None) -> _T:
        with self._lock:
            known = self._kinds.setdefault(kind, {})
            found: _T = known.get(key, _NOTHING)
            if found is _NOTHING:
                found = make()
                if most is not None and len(known) >= most:
                    del known[next(iter(known))]
                known[key] = found
            return found


def choose_task(kinematics: Kinematics, free: NDArray[np.bool_]) -> tuple[Task, Finding | None]:
    """Return the task of a chain from the ranks of its Jacobian, and what there is to say about it.

    A chain of six freedoms is given a full pose. With fewer, position and tool vector are given where they
    determine all axes, position alone where that does; else (a SCARA: the tool vector never changes and the turn
    about it matters) the full pose again, of which only what the chain can reach will be met. So is an arm of six
    axes that is singular in every position: it was built for poses, and an orientation that it cannot reach is no
    success.

    Args:
        kinematics: The chain's evaluator.
        free: (n_axes,) True for the axes that the solver may move.
    """
    task = kinematics.chain.task
    if task != "auto":
        return task, None
    free_J = sampled_jacobians(kinematics, free)
    turn = [n for n in (3, 4, 5) if n != 3 + kinematics.tool_axis]
    whole = generic_rank(free_J, list(range(6)))
    if whole == 6:
        return "pose", None
    if _is_arm(kinematics.chain, free):
        return "pose", _lost_freedom(whole, kinematics.chain) if whole else None
    if generic_rank(free_J, [0, 1, 2]) == whole:
        return "position", None
    return "direction" if generic_rank(free_J, [0, 1, 2, *turn]) == whole else "pose", None


def _is_arm(chain: Chain, free: NDArray[np.bool_]) -> bool:
    """Return whether a chain has axes for a pose: a machine tool with an axis too many has fewer rotary ones."""
    rotary = sum(axis.kind == "rotary" for axis, moves in zip(chain.axes, free, strict=True) if moves)
    return int(free.sum()) >= _POSE_FREEDOMS and rotary > _ROTARY_OF_MACHINE_TOOLS


def _lost_freedom(rank: int, chain: Chain) -> Finding:
    collector = Collector()
    hint = "check directions and lengths of the axes: one moves only what the others move already"
    text = f"the axes of {chain.title} give {rank} of the 6 freedoms of a pose in every position"
    collector.add("CB601", text, hint=hint)
    return collector.findings[0]
