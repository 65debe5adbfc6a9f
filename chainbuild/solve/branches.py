"""From joint values to branches: axis values, whole turns, limits, verification, order."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild import tolerances
from chainbuild.chain.axismap import AffineMap
from chainbuild.robot.kinematics import damped_step
from chainbuild.solve.freedoms import periodic_axes
from chainbuild.solve.result import IkResult
from chainbuild.solve.serial import Indices, Serial, Structure, structure_of, unroll
from chainbuild.solve.start import Held, start_point

if TYPE_CHECKING:
    import pinocchio as pin

    from chainbuild.robot.robot import Robot

Vector = NDArray[np.float64]

_POLISH_FROM: Final = (
    1e-11  # errors above this are polished by Newton steps: closed forms lose digits near singular points
)
_POLISH_STEPS: Final = 3
_POLISH_DAMPING: Final = 1e-14
_MAP_STEPS: Final = 12  # Newton steps that bring a nonlinear axis map to given joint values
_MAP_EXACT: Final = 1e-14
_SAME: Final = 1e-6  # branches closer than this in every axis [m, rad] are one
_LIMIT_SLACK: Final = 1e-9  # a limit [m, rad] is still kept this far beyond it: the answer is rounded
_MOST_TURNS: Final = 4096  # bound on the combinations of whole turns that are looked at for one branch


@dataclass(frozen=True, slots=True, eq=False)
class Branch(IkResult):
    """One of the solutions for a pose.

    Attributes:
        free_axes: Names of axes that have no bearing on this pose; they keep their start value.
        status_bits: Pose status as the controller numbers it (KIN_TYP 45), else None.
        turn_bits: Signs of the axes as the controller numbers them (KIN_TYP 45), else None.
        method: What found it; see `analytic.method_of`.
    """

    free_axes: tuple[str, ...] = ()
    status_bits: int | None = None
    turn_bits: int | None = None
    method: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Query:
    """One question: which axis values bring the tool there?

    Attributes:
        robot: The robot.
        target: Tool in the workpiece frame [m].
        x0: (n_axes,) start in SI; held axes stand at their values.
        structure: Which axes are free and what they move.
        lower: (n_axes,) limits in SI, infinite where endless.
        upper: The same.
        windings: True: every whole turn within the limits is a branch of its own; False: only the nearest one.
    """

    robot: Robot
    target: pin.SE3
    x0: Vector
    structure: Structure
    lower: Vector
    upper: Vector
    windings: bool = False

    @classmethod
    def of(
        cls, robot: Robot, target: pin.SE3, start: ArrayLike | None, held: Held | None, windings: bool = False
    ) -> Query:
        """Build a query; see `Robot.ik` for start and held."""
        x0, fixed = start_point(robot, start, held)
        return cls.at(robot, target, x0, fixed, windings)

    @classmethod
    def at(cls, robot: Robot, target: pin.SE3, x0: Vector, fixed: NDArray[np.bool_], windings: bool = False) -> Query:
        """Build a query from SI start values and a mask of held axes."""
        factors = robot.kinematics.si_factors
        lower = np.array([-math.inf if axis.endless else axis.lower for axis in robot.axes]) * factors
        upper = np.array([math.inf if axis.endless else axis.upper for axis in robot.axes]) * factors
        return cls(robot, target, x0, structure_of(robot, fixed), lower, upper, windings)

    @property
    def q0(self) -> Vector:
        """Joint values at the start."""
        return self.robot.kinematics.q(self.x0)

    def serial(self) -> Serial:
        """Return the chain as screws, held axes at their values."""
        return unroll(self.robot.chain, self.q0, self.structure.moving)

    def axis_names(self, indices: Iterable[int]) -> tuple[str, ...]:
        """Return the names of axes."""
        return tuple(self.robot.axes[n].name for n in indices)

    # From joints to axes ------------------------------------------------------------------------------------------

    def axes_for(self, joints: Indices, values: Vector, columns: Indices) -> list[Vector]:
        """Return the SI axis values that give joint values, with the whole turns the query asks for, inside limits.

        Args:
            joints: Joints whose values are given; they determine the columns.
            values: Their values, up to whole turns where revolute.
            columns: Axes to be found; the others stay at the start.
        """
        if not len(columns):
            return [self.x0.copy()]
        axis_map = self.robot.chain.axis_map
        if not isinstance(axis_map, AffineMap):
            x = self._through_nonlinear_map(joints, values, columns)
            return [] if x is None else list(self._turned_axes(x, columns))
        rows = _independent_rows(axis_map.A[np.ix_(joints, columns)])
        block = axis_map.A[np.ix_(joints[rows], columns)]
        if block.shape[0] < block.shape[1]:
            return []
        others = np.setdiff1d(np.arange(len(self.x0)), columns)
        constant = axis_map.A[np.ix_(joints[rows], others)] @ self.x0[others] + axis_map.b[joints[rows]]
        x = self.x0.copy()
        x[columns] = np.linalg.solve(block, values[rows] - constant)
        if self._turns_are_per_axis(block, columns):
            return list(self._turned_axes(x, columns))
        return self._turned_joints(x, block, joints[rows], columns)

    def _turns_are_per_axis(self, block: Vector, columns: Indices) -> bool:
        """Tell whether whole turns of single axes lead to all equivalent joint values."""
        rotary = [n for n in columns if self.robot.axes[n].kind == "rotary"]
        return bool(periodic_axes(self.robot.chain)[rotary].all()) and abs(abs(np.linalg.det(block)) - 1.0) < 1e-9

    def _through_nonlinear_map(self, joints: Indices, values: Vector, columns: Indices) -> Vector | None:
        """Return SI axis values whose joints stand at the values, by Newton from the map's own inverse."""
        kinematics = self.robot.kinematics
        q = self.q0
        q[joints] = values
        x = self.x0.copy()
        x[columns] = (self.robot.chain.axis_map.axes(q) * kinematics.si_factors)[columns]
        turns = np.array([self.robot.chain.joints[n].kind == "revolute" for n in joints])
        for _ in range(_MAP_STEPS):
            error = values - kinematics.q(x)[joints]
            error[turns] = [math.remainder(e, math.tau) if math.isfinite(e) else e for e in error[turns]]
            if not np.isfinite(error).all():
                return None
            if float(np.abs(error).max(initial=0.0)) < _MAP_EXACT:
                break
            J = kinematics.dq_dx(x)[np.ix_(joints, columns)]
            x[columns] += np.linalg.lstsq(J, error, rcond=None)[0]
        return x if np.isfinite(x).all() else None

    def _turned_axes(self, x: Vector, columns: Indices) -> Iterator[Vector]:
        """Yield x moved by whole turns of single axes, nearest first: all within limits, or the nearest only."""
        periodic = periodic_axes(self.robot.chain)
        choices = []
        for n in columns:
            places = self._places(float(x[n]), int(n)) if periodic[n] else [float(x[n])]
            choices.append(places if self.windings else places[:1])
        for combination in itertools.islice(itertools.product(*choices), _MOST_TURNS):
            turned = x.copy()
            turned[columns] = combination
            yield turned

    def _places(self, value: float, n: int) -> list[float]:
        """Return value + whole turns within the limits of axis n, nearest to the start first; [value] if none is."""
        lower, upper, wanted = float(self.lower[n]), float(self.upper[n]), float(self.x0[n])
        nearest = round((wanted - value) / math.tau)
        first = nearest - 1 if math.isinf(lower) else math.ceil((lower - _LIMIT_SLACK - value) / math.tau)
        last = nearest + 1 if math.isinf(upper) else math.floor((upper + _LIMIT_SLACK - value) / math.tau)
        places = [value + k * math.tau for k in range(first, last + 1)]
        places.sort(key=lambda place: abs(place - wanted))
        return places or [value]

    def _turned_joints(self, x: Vector, block: Vector, joints: Indices, columns: Indices) -> list[Vector]:
        """Return the axis values of joint values moved by whole turns: where a gear makes a turn of no axis whole."""
        chain = self.robot.chain
        low = np.where(np.isfinite(self.lower), self.lower, self.x0 - math.tau)
        high = np.where(np.isfinite(self.upper), self.upper, self.x0 + math.tau)
        factors = self.robot.kinematics.si_factors
        q_low, q_high = chain.axis_map.q_bounds(low / factors, high / factors)
        q = self.robot.kinematics.q(x)
        ranges = []
        for n in joints:
            turns = chain.joints[n].kind == "revolute"
            first = math.ceil((q_low[n] - q[n]) / math.tau - _LIMIT_SLACK) if turns else 0
            last = math.floor((q_high[n] - q[n]) / math.tau + _LIMIT_SLACK) if turns else 0
            ranges.append(range(first, last + 1))
        found = []
        for turns_of_joints in itertools.islice(itertools.product(*ranges), _MOST_TURNS):
            turned = x.copy()
            turned[columns] += np.linalg.solve(block, math.tau * np.array(turns_of_joints, dtype=float))
            if not self.outside(turned, columns):
                found.append(turned)
        found.sort(key=self.distance)
        return found if self.windings else found[:1]

    # Verification -------------------------------------------------------------------------------------------------

    def outside(self, x: Vector, columns: Indices | None = None) -> tuple[str, ...]:
        """Return the names of axes and coupled limits that x violates."""
        look = self.structure.free if columns is None else columns
        names = [
            self.robot.axes[n].name
            for n in look
            if not self.lower[n] - _LIMIT_SLACK <= x[n] <= self.upper[n] + _LIMIT_SLACK
        ]
        if columns is None:
            values = x / self.robot.kinematics.si_factors
            names += [c.name for c in self.robot.chain.constraints if c.margin(values) < -_LIMIT_SLACK]
        return tuple(names)

    def distance(self, x: Vector) -> float:
        """Return the distance to the start [m and rad alike]."""
        return float(np.linalg.norm(x - self.x0))

    def verified(self, x: Vector) -> Branch | None:
        """Return x as a branch if forward kinematics meets the target, polished by Newton steps where it helps."""
        kinematics, task = self.robot.kinematics, self.robot.task
        for attempt in range(_POLISH_STEPS + 1):
            distance, angle = kinematics.errors(x, self.target, task)
            if not math.isfinite(distance + angle):
                return None
            judged = 0.0 if task == "position" else angle
            if max(distance, judged) < _POLISH_FROM or attempt == _POLISH_STEPS:
                break
            x = self._newton(x)
        if distance > tolerances.IK_POSITION_M or judged > tolerances.IK_ROTATION_RAD:
            return None
        return Branch(True, x / kinematics.si_factors, "ok", distance, angle, attempt, 0, task)

    def _newton(self, x: Vector) -> Vector:
        error, J = self.robot.kinematics.residual(self.target, self.robot.task)(x)
        moved = x.copy()
        moved[self.structure.free] += damped_step(J[:, self.structure.free], error, _POLISH_DAMPING)
        return moved

    def collect(self, candidates: Iterable[tuple[Vector, tuple[str, ...]]]) -> Found:
        """Return the candidates that are solutions, once each, sorted by distance to the start.

        Args:
            candidates: SI axis values and the names of axes that are free there.
        """
        inside: list[tuple[float, Branch]] = []
        beyond: list[tuple[float, Branch, tuple[str, ...]]] = []
        factors = self.robot.kinematics.si_factors
        for x, free_axes in candidates:
            branch = self.verified(x)
            if branch is None:
                continue
            reached = branch.axes * factors
            if any(np.abs(reached - other.axes * factors).max() < _SAME for _, other in inside):
                continue
            out = self.outside(reached)
            branch = replace(branch, free_axes=free_axes)
            if out:
                beyond.append((self.distance(reached), branch, out))
            else:
                inside.append((self.distance(reached), branch))
        inside.sort(key=lambda item: item[0])
        nearest = min(beyond, key=lambda item: item[0], default=None)
        outside = () if nearest is None or inside else nearest[2]
        return Found(tuple(branch for _, branch in inside), None if nearest is None else nearest[1], outside)


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What a closed form came up with.

    Attributes:
        branches: Solutions inside all limits, nearest first.
        beyond: The nearest solution outside them, or None.
        outside: Names of the limits in the way where there is no branch inside.
    """

    branches: tuple[Branch, ...]
    beyond: Branch | None
    outside: tuple[str, ...]


def _independent_rows(A: Vector) -> Sequence[int]:
    """Return the first rows of A that determine all columns."""
    rows: list[int] = []
    for n in range(A.shape[0]):
        if len(rows) < A.shape[1] and np.linalg.matrix_rank(A[[*rows, n]]) > len(rows):
            rows.append(n)
    return rows
