"""A task of inverse kinematics without its target: what is asked, of which axes, inside which limits.

Everything here is prepared once for a robot, its held axes and the options, and kept for the next call.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild.chain.elements import Task as TaskKind
from chainbuild.ik.limits import Box, freedoms_of
from chainbuild.ik.options import IkOptions
from chainbuild.ik.search.starts.arm_reach import ArmReach, arm_reach
from chainbuild.ik.search.starts.sampled import Starts, starts_of
from chainbuild.ik.search.starts.turned import TurnedStarts, turned_starts
from chainbuild.ik.start import Held, start_point
from chainbuild.kinematics.product import Product
from chainbuild.kinematics.task_error import Task

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Robot

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

_ROUNDED: Final = 1e-6  # mm or degrees: a held axis this close beyond its limit stands on it
_KEPT: Final = 16  # problems kept a robot: additional axes may take another value with every pose


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """What is asked of which axes.

    Attributes:
        robot: The robot.
        task: "pose", "direction" or "position".
        weights: (6,) weights of the error in the tool frame, 0 where it does not count.
        axis: Tool axis whose direction alone is asked for (0, 1, 2), or -1 where the whole rotation is.
        shown_axis: Tool axis whose direction `rotation_error` is about, or -1.
        free: Indices of the axes that may move.
        x: (n_axes,) SI values of the held axes; the others are 0.
        axes: The same in mm and degrees.
        box: Limits of the free axes.
        middle: (n_free,) near the middle of the limits.
        home: (n_free,) where the search starts without a start given, or None: anywhere in the table. Machine tools
            stand upright most of the time, where an axis is free: it shall stay near its zero.
        factors: (n_free,) mm and degrees to SI.
        reach: Bound on the distance between workpiece and tool [m].
        bounded: Whether the whole distance counts, so that `reach` can refuse a target.
        row: The chain from the workpiece to the tool by the free axes; None where the axis map is not affine.
        arm: How far the turning joints reach, where all six parts of the pose are asked for and there are no others.
        starts: Configurations to start from.
        turns: Whether any turn counts.
        held_beyond: Words for each held axis that stands outside its limits: no answer is one then.
        seed: Seed of the tables.
        turned: The table of turned starts or None, filled in at its first use.
        plain: The task for the plain path, filled in at its first use.
        compiled: The problem in few arrays for the compiled path, filled in at its first use.
    """

    robot: Robot
    task: TaskKind
    weights: Vector
    axis: int
    shown_axis: int
    free: NDArray[np.intp]
    x: Vector
    axes: Vector
    box: Box
    middle: Vector
    home: Vector | None
    factors: Vector
    reach: float
    bounded: bool
    row: Product | None
    arm: ArmReach | None
    starts: Starts
    turns: bool
    held_beyond: tuple[str, ...]
    seed: int = 0
    turned: list[TurnedStarts | None] = field(default_factory=list)
    plain: list[Task] = field(default_factory=list)
    compiled: list[Any] = field(default_factory=list)

    def turned_starts(self) -> TurnedStarts | None:
        """Return the table of turned starts where all six parts of the pose are asked for and the arm has one."""
        if not self.turned:
            row = self.row if _whole(self.weights, self.axis) else None
            made = None if row is None else turned_starts(self.robot, row, self.box, self.middle, self.seed)
            self.turned.append(made)
        return self.turned[0]

    def arm_too_short(self, target: Matrix) -> ArmReach | None:
        """Return the arm where it is certainly too short for a target (4, 4)."""
        return self.arm if self.arm is not None and self.arm.distance(target) > self.arm.length else None

    def full(self, y: Vector) -> Vector:
        """Return the SI values of all axes (n_axes,)."""
        x = self.x.copy()
        x[self.free] = y
        return x

    def shown(self, y: Vector) -> Vector:
        """Return the values of all axes (n_axes,) in mm and degrees."""
        if len(y) == len(self.axes):
            return y / self.factors
        axes = self.axes.copy()
        axes[self.free] = y / self.factors
        return axes

    def free_part(self, axes: Vector) -> Vector:
        """Return the free axes (n_free,) in SI of axis values (n_axes,) in mm and degrees."""
        part: Vector = axes[self.free] * self.factors
        return part


_prepared: WeakKeyDictionary[Robot, dict[object, Problem]] = WeakKeyDictionary()


def problem_of(robot: Robot, start: ArrayLike | None, held: Held | None, options: IkOptions) -> Problem:
    """Return the problem of a robot with its held axes, prepared at first use.

    Args:
        robot: The robot.
        start: Axis values (n_axes,) from which held axes are taken that `held` does not name.
        held: See `Robot.ik`.
        options: Weights and seed.

    Raises:
        AxisValueError: start or held of wrong count, unknown name or not finite.
    """
    known = _prepared.get(robot)
    if known is None:
        known = _prepared[robot] = {}
    if held is None and not robot.kinematics.has_input_axes:
        key: object = (options.weights, options.seed)
        fixed, x = None, None
    else:
        x, fixed = start_point(robot, start, held)
        key = (options.weights, options.seed, fixed.tobytes(), x[fixed].tobytes())
    found = known.get(key)
    if found is None:
        if len(known) >= _KEPT:
            del known[next(iter(known))]
        if x is None or fixed is None:
            x, fixed = start_point(robot, None, None)
        found = known[key] = _prepare(robot, np.where(fixed, x, 0.0), fixed, options)
    return found


def _prepare(robot: Robot, x: Vector, fixed: NDArray[np.bool_], options: IkOptions) -> Problem:
    freedoms = freedoms_of(robot)
    free = np.flatnonzero(~fixed)
    weights, axis = _weights(robot, options)
    box = freedoms.box.restricted(free, x)
    product = robot.kinematics.product
    row = None if product is None else product.by_axes(free, x)
    starts = starts_of(robot, box, freedoms.middle[free], free, x, weights, axis, options.seed)
    return Problem(
        robot=robot,
        task=robot.task,
        weights=weights,
        axis=axis,
        shown_axis=axis if weights[3:].any() else robot.kinematics.tool_axis,
        free=free,
        x=x,
        axes=x / freedoms.si_factors,
        box=box,
        middle=freedoms.middle[free],
        home=None if robot.task == "pose" else box.clamp(np.zeros(len(free))),
        factors=freedoms.si_factors[free],
        reach=freedoms.reach,
        bounded=bool((weights[:3] > 0.0).all()),
        row=row,
        arm=arm_reach(row) if row is not None and _whole(weights, axis) else None,
        starts=starts,
        turns=bool(weights[3:].any()),
        held_beyond=tuple(_held_beyond(robot, x / freedoms.si_factors, fixed)),
        seed=options.seed,
    )


def _whole(weights: Vector, axis: int) -> bool:
    """Return whether all six parts of a pose are asked for."""
    return axis < 0 and bool((weights > 0.0).all())


def _held_beyond(robot: Robot, values: Vector, fixed: NDArray[np.bool_]) -> Iterator[str]:
    for axis, value, held in zip(robot.axes, values.tolist(), fixed.tolist(), strict=True):
        if held and not axis.endless and not axis.lower - _ROUNDED <= value <= axis.upper + _ROUNDED:
            yield f"{axis.name} at {value:.3f} {axis.unit} (limits {axis.lower:g} … {axis.upper:g})"


def _weights(robot: Robot, options: IkOptions) -> tuple[Vector, int]:
    """Return the weights of task and user together, and the tool axis whose direction alone counts."""
    weights = np.array(options.weights)
    if robot.task == "position":
        weights[3:] = 0.0
    elif robot.task == "direction":
        weights[3 + robot.kinematics.tool_axis] = 0.0
    idle = np.flatnonzero(weights[3:] == 0.0)
    return weights, int(idle[0]) if len(idle) == 1 else -1
