"""An inverse kinematics problem without its target: task, free axes, limits.

Everything here is prepared once for a robot, its held axes and the options, and kept for the next call.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any, Final, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.elements import Task as TaskKind
from chainbuild.ik.region import Box, freedoms_of
from chainbuild.ik.request import Held, IkOptions, IkRequest, start_point
from chainbuild.ik.search.starts.arm_reach import ArmReach, arm_reach
from chainbuild.ik.search.starts.sampled import Starts, starts_of
from chainbuild.ik.search.starts.turned import TurnedStarts, turned_starts
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.product import Product

_T = TypeVar("_T")

_MOST_TURNS: Final = 256  # combinations of whole turns tried: more than the rotary axes of a head have
MAX_PREPARED: Final = 16  # problems kept per mechanism: additional axes may take another value with every pose


@dataclass(frozen=True, slots=True, eq=False)
class Problem:
    """An inverse kinematics problem without its target.

    Attributes:
        mechanism: The mechanism.
        task: "pose", "direction" or "position".
        weights: (6,) weights of the error in the tool frame, 0 where it does not count.
        axis: Tool axis whose direction is the task (0, 1, 2), or -1 if the whole rotation is.
        shown_axis: Tool axis whose direction `rotation_error` is about, or -1.
        free: Indices of the axes that may move.
        x: (n_axes,) SI values of the held axes; the others are 0.
        axes: The same in mm and degrees.
        box: Limits of the free axes.
        middle: (n_free,) near the middle of the limits.
        home: (n_free,) default start of the search, or None: any start of the table. Machine tools are mostly upright,
            where an axis is free: it stays near its zero.
        factors: (n_free,) mm and degrees to SI.
        reach: Bound on the distance between workpiece and tool [m].
        bounded: Whether the whole distance counts, so that `reach` can refuse a target.
        row: The chain from the workpiece to the tool by the free axes; None where the axis map is not affine.
        arm: Reach of the rotary joints, if the task is the whole pose and there are no other joints.
        starts: Configurations to start from.
        turns: Whether the task includes any rotation.
        held_beyond: Text for each held axis outside its limits: every pose then fails.
        winding: Indices into the free axes of those whose whole turns decide about limits of sums or drives.
        curved: Whether drives have limits that only their map knows: what a search finds is then checked by it.
        seed: Seed of the tables.
        made: What was made for this problem, by its kind.
    """

    mechanism: Mechanism
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
    winding: tuple[int, ...] = ()
    curved: bool = False
    seed: int = 0
    made: dict[str, Any] = field(init=False, default_factory=dict)

    @property
    def rechecked(self) -> bool:
        """Whether the limits of the free axes and their sums are not all that a search has to know."""
        return self.curved or bool(self.winding)

    def keeps(self, y: Vector) -> bool:
        """Return whether the drives are inside limits that only their map knows."""
        return not self.curved or not self.mechanism.limits.broken_drives(self.shown(y))

    def wound(self, y: Vector, wanted: Vector) -> Vector:
        """Return y (n_free,) by whole turns inside all limits, as near as possible to another place; y if none is."""
        if self.box.inside(y) and self.keeps(y):
            return y
        choices = []
        for n, value in enumerate(y.tolist()):
            low, high = float(self.box.lower[n]), float(self.box.upper[n])
            turns = range(math.ceil((low - value) / math.tau), math.floor((high - value) / math.tau) + 1)
            choices.append([value + k * math.tau for k in turns] if n in self.winding else [value])
        places = [np.array(place) for place in itertools.islice(itertools.product(*choices), _MOST_TURNS)]
        places.sort(key=lambda place: float(np.abs(place - wanted).max()))
        return next((place for place in places if self.box.inside(place) and self.keeps(place)), y)

    def prepared(self, kind: str, make: Callable[[Problem], _T]) -> _T:
        """Return what was made once for this problem; see `Mechanism.prepared`, whose lock it takes."""
        if kind not in self.made:
            self.made[kind] = self.mechanism.prepared(kind, lambda: make(self), self, MAX_PREPARED)
        found: _T = self.made[kind]
        return found

    def turned_starts(self) -> TurnedStarts | None:
        """Return the table of turned starts if the task is the whole pose and the arm has one."""
        row = self.row
        if row is None or not _whole(self.weights, self.axis):
            return None
        return self.prepared(
            "turned starts", lambda own: turned_starts(own.mechanism, row, own.box, own.middle, own.seed)
        )

    def position_only(self) -> Problem:
        """Return the problem without its rotations."""
        return self.prepared("position only", Problem._without_turns)

    def _without_turns(self) -> Problem:
        weights, scale = self.weights.copy(), self.starts.scale.copy()
        weights[3:] = 0.0
        scale.reshape(3, 4)[:, :3] = 0.0
        return replace(self, weights=weights, axis=-1, starts=self.starts.scaled(scale), turns=False, arm=None)

    def beyond_bound(self, target: Matrix) -> bool:
        """Return whether a target (4, 4) is beyond the stretched chain, its linear axes inside their limits."""
        x, y, z = target[:3, 3].tolist()
        return bool(self.bounded and x * x + y * y + z * z > self.reach**2)

    def arm_too_short(self, target: Matrix) -> ArmReach | None:
        """Return the arm if it is certainly too short for a target (4, 4)."""
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
        part: Vector = (axes if len(self.free) == len(axes) else axes[self.free]) * self.factors
        return part


def problem_of(mechanism: Mechanism, start: ArrayLike | None, held: Held | None, options: IkOptions) -> Problem:
    """Return the problem of a mechanism with its held axes, prepared at first use.

    Args:
        mechanism: The mechanism.
        start: Axis values (n_axes,) from which held axes are taken that `held` does not name.
        held: See `Robot.ik`.
        options: Weights and seed.

    Raises:
        AxisValueError: start or held has a wrong number of values, an unknown name or a non-finite value.
    """
    if held is None and not mechanism.kinematics.has_input_axes:
        return mechanism.prepared(
            "problem", lambda: _prepare(mechanism, None, options), (options.weights, options.seed), MAX_PREPARED
        )
    x, fixed = start_point(mechanism, start, held)
    key = (options.weights, options.seed, fixed.tobytes(), x[fixed].tobytes())
    return mechanism.prepared("problem", lambda: _prepare(mechanism, (x, fixed), options), key, MAX_PREPARED)


def asked(request: IkRequest) -> Problem:
    """Return the problem of a request; see `problem_of`."""
    return problem_of(request.mechanism, request.start, request.held, request.options)


def _prepare(mechanism: Mechanism, held: tuple[Vector, NDArray[np.bool_]] | None, options: IkOptions) -> Problem:
    """Build a problem.

    Args:
        mechanism: Whose.
        held: SI values (n_axes,) and which of them are held; None: no axis is.
        options: Weights and seed.
    """
    freedoms = freedoms_of(mechanism)
    count = len(mechanism.axes)
    values, fixed = (np.zeros(count), np.zeros(count, dtype=bool)) if held is None else held
    x, free = np.where(fixed, values, 0.0), np.flatnonzero(~fixed)
    weights, axis = _weights(mechanism, options)
    box = freedoms.box.restricted(free, x)
    product = mechanism.kinematics.product
    row = None if product is None else product.by_axes(free, x)
    starts = starts_of(mechanism, box, freedoms.middle[free], free, x, weights, axis, options.seed)
    return Problem(
        mechanism=mechanism,
        task=mechanism.task,
        weights=weights,
        axis=axis,
        shown_axis=axis if weights[3:].any() else mechanism.kinematics.tool_axis,
        free=free,
        x=x,
        axes=x / freedoms.si_factors,
        box=box,
        middle=freedoms.middle[free],
        home=None if mechanism.task == "pose" else box.clamp(np.zeros(len(free))),
        factors=freedoms.si_factors[free],
        reach=mechanism.kinematics.reach,
        bounded=bool((weights[:3] > 0.0).all()),
        row=row,
        arm=arm_reach(row) if row is not None and _whole(weights, axis) else None,
        starts=starts,
        turns=bool(weights[3:].any()),
        held_beyond=tuple(_held_beyond(mechanism, x / freedoms.si_factors, fixed)) if fixed.any() else (),
        winding=_winding(mechanism, box, free),
        curved=mechanism.limits.curved,
        seed=options.seed,
    )


def _winding(mechanism: Mechanism, box: Box, free: NDArray[np.intp]) -> tuple[int, ...]:
    """Return which free axes have whole turns within their limits and a part in sums or drives."""
    wide = box.periodic & (box.upper - box.lower >= math.tau) & np.isfinite(box.upper - box.lower)
    return tuple(n for n, axis in enumerate(free.tolist()) if wide[n] and axis in mechanism.limits.together)


def _whole(weights: Vector, axis: int) -> bool:
    """Return whether the task is the whole pose."""
    return axis < 0 and bool((weights > 0.0).all())


def _held_beyond(mechanism: Mechanism, values: Vector, fixed: NDArray[np.bool_]) -> Iterator[str]:
    for n in mechanism.limits.outside(values):
        if fixed[n]:
            yield mechanism.limits.in_words(n, float(values[n]))


def _weights(mechanism: Mechanism, options: IkOptions) -> tuple[Vector, int]:
    """Return the weights of task and user together, and the tool axis whose direction alone counts."""
    weights = np.array(options.weights)
    if mechanism.task == "position":
        weights[3:] = 0.0
    elif mechanism.task == "direction":
        weights[3 + mechanism.kinematics.tool_axis] = 0.0
    idle = np.flatnonzero(weights[3:] == 0.0)
    return weights, int(idle[0]) if len(idle) == 1 else -1
