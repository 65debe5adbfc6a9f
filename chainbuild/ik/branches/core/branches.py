"""Branches: verified, inside the limits, once each, nearest first."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, NamedTuple, overload

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Integers, Matrix, Vector
from chainbuild.chain.elements import Task
from chainbuild.html import SHOWN_ROWS, html_table
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.result import AxisValues, IkResult, axes_rows, quick_constructor
from chainbuild.ik.verify import is_met, on_limits
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.newton import below, newton, shrinking
from chainbuild.shown import two_lines
from chainbuild.units import AxisLabels

Candidate = tuple[Vector, tuple[str, ...]]  # SI axis values, and the names of axes that are free there

# Errors above this are polished by Newton steps: closed forms lose digits near singular points.
POLISH_FROM: Final = 1e-11
# Errors above this mean another position, not lost digits.
POLISH_TO: Final = 1e-3
POLISH_STEPS: Final = 3  # from a thousandth, Newton needs two
_POLISH: Final = shrinking(0.0, 1e-14)
_SHARE: Final = 1e-6  # an axis with a smaller share of a direction stands still
CLOSE_BRANCHES: Final = 1e-2  # m and rad: branches so close to each other may be one where digits are lost
BETWEEN_BRANCHES: Final = 1e-10  # m and rad: the pose half-way between two is as good as theirs: they are one
SAME_BRANCH: Final = 1e-5  # branches closer than this in every axis [m, rad] are one


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Branch(IkResult):
    """One of the solutions for a pose.

    Attributes:
        free_axes: Names of axes that do not affect this pose; they keep their start value, or are as near to it as all
            limits permit.
        status_bits: Pose status as the controller numbers it (KIN_TYP 45), else None.
        turn_bits: Signs of the axes as the controller numbers them (KIN_TYP 45), else None.
        method: What found it; the name of a `SolverPlan`.
        free_directions: (m, n_axes) unit directions in axis values, m and rad whatever the `units`, in which the
            solutions go on: none where this one is isolated, one on a curve, two or more that span a surface, one of
            each curve where curves cross.
    """

    free_axes: tuple[str, ...] = ()
    status_bits: int | None = None
    turn_bits: int | None = None
    method: str = ""
    free_directions: Matrix = field(default_factory=lambda: np.empty((0, 0)))

    def _in_words(self) -> str:
        bits = "" if self.status_bits is None else f"; status {self.status_bits}, turn {self.turn_bits}"
        free = f"; free: {', '.join(self.free_axes)}" if self.free_axes else ""
        along = "".join(f"; goes on along {words}" for words in directions_shown(self.labels, self.free_directions))
        return f"{IkResult._in_words(self)}{bits}{free}{along}; by {self.method or 'candidates'}"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Branches(AxisValues, Sequence[Branch]):
    """All solutions for a pose, nearest to the start first: arrays, of which `branches[n]` is the n-th as a `Branch`.

    Attributes:
        axes: (k, n_axes) axis values, in `units`.
        position_error: (k,) distances to the pose wanted [m].
        rotation_error: (k,) angles to it [rad]; of the tool vector where the task is not a full pose.
        iterations: (k,) polishing steps.
        free_axes: For each the names of axes that do not affect the pose.
        status_bits: (k,) pose status as the controller numbers it (KIN_TYP 45), else None.
        turn_bits: (k,) signs of the axes as the controller numbers them (KIN_TYP 45), else None.
        task: "pose", "direction" or "position": what was solved for.
        labels: Names and units of the axis values.
        method: What found them; the name of a `SolverPlan`.
        free_directions: For each (m, n_axes) unit directions in which the solutions go on, m and rad; see `Branch`.
    """

    axes: Matrix
    position_error: Vector
    rotation_error: Vector
    iterations: Integers
    free_axes: tuple[tuple[str, ...], ...]
    task: Task
    labels: AxisLabels
    status_bits: Integers | None = None
    turn_bits: Integers | None = None
    method: str = ""
    free_directions: tuple[Matrix, ...] = ()

    def __len__(self) -> int:
        return len(self.axes)

    @overload
    def __getitem__(self, index: int) -> Branch: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[Branch, ...]: ...

    def __getitem__(self, index: int | slice) -> Branch | tuple[Branch, ...]:
        if isinstance(index, slice):
            return tuple(self[n] for n in range(len(self))[index])
        n = range(len(self))[index]
        left = float(self.position_error[n]), float(self.rotation_error[n])
        return Branch(
            True, self.axes[n], "ok", *left, int(self.iterations[n]), 0, self.task, self.labels,
            free_axes=self.free_axes[n], status_bits=_at(self.status_bits, n), turn_bits=_at(self.turn_bits, n),
            method=self.method, free_directions=(self.free_directions or (isolated(self.labels),) * len(self))[n],
        )  # fmt: skip

    def __iter__(self) -> Iterator[Branch]:
        return (self[n] for n in range(len(self)))

    def __repr__(self) -> str:
        bits = "" if self.status_bits is None else ", .status_bits, .turn_bits"
        return two_lines(f"<Branches of a pose: {self._counted()}; .axes{bits}, [n]>")

    def _counted(self) -> str:
        families = sum(1 for directions in self.free_directions if len(directions))
        told = f", {families} of {'it' if len(self) == 1 else 'them'} not isolated" if families else ""
        return f"{len(self)} by {self.method or 'candidates'}{told}"

    def _repr_html_(self) -> str:
        head, rows = axes_rows(self.labels, self[:SHOWN_ROWS])
        if self.status_bits is not None and self.turn_bits is not None:
            head = (*head, "Status bits", "Turn bits")
            bits = zip(rows, self.status_bits.tolist(), self.turn_bits.tolist(), strict=False)
            rows = [(*row, str(status), str(turn)) for row, status, turn in bits]
        if any(len(directions) for directions in self.free_directions):
            head = (*head, "Goes on along")
            along = [", ".join(directions_shown(self.labels, one)) for one in self.free_directions]
            rows = [(*row, words) for row, words in zip(rows, along, strict=False)]
        caption = f"{len(self)} branches by {self.method or 'candidates'}"
        return html_table(head, rows, caption, len(self) - len(rows))


quick_made: Final = quick_constructor(Branches)


def directions_shown(labels: AxisLabels, directions: Matrix) -> list[str]:
    """Return directions (m, n_axes) in words: the shares of the axes, where these are not rounding."""
    rows = []
    for direction in directions:
        parts = [
            (share, name) for share, name in zip(direction.tolist(), labels.names, strict=True) if abs(share) > _SHARE
        ]
        words = " ".join(f"{'-' if share < 0.0 else '+'} {abs(share):.3g} {name}" for share, name in parts)
        rows.append(
            words.removeprefix("+ ").replace("- ", "-", 1) if words.startswith("-") else words.removeprefix("+ ")
        )
    return rows


def isolated(labels: AxisLabels) -> Matrix:
    """Return the free directions (0, n_axes) of a branch that has none."""
    return np.empty((0, len(labels.names)))


def _at(column: Integers | None, n: int) -> int | None:
    return None if column is None else int(column[n])


class VerifiedRow(NamedTuple):
    """A solution by itself: axis values in mm and degrees, distance [m], angle [rad], steps, Jacobian, free axes."""

    axes: Vector
    distance: float
    angle: float
    steps: int
    jacobian: Matrix
    free_axes: tuple[str, ...] = ()

    def branch(self, task: Task, labels: AxisLabels) -> Branch:
        """Return it as a branch by itself."""
        return Branch(
            True, self.axes, "ok", self.distance, self.angle, self.steps, 0, task, labels, free_axes=self.free_axes
        )


@dataclass(frozen=True, slots=True, eq=False)
class Solutions:
    """The result of a closed form.

    Attributes:
        branches: Solutions inside all limits, nearest first.
        beyond: The nearest solution outside them, or None.
        outside: Names of the violated limits if there is no branch inside.
        all_beyond: (n_axes,) each [SI], all solutions outside the limits, nearest first.
        jacobians: (k, rows, n_axes) of the task in SI, of each branch.
    """

    branches: Branches
    beyond: Branch | None
    outside: tuple[str, ...]
    all_beyond: tuple[Vector, ...]
    jacobians: NDArray[np.float64]


def verified(query: BranchQuery, x: Vector) -> VerifiedRow | None:
    """Return x as a solution if forward kinematics meets the target, polished by Newton steps where it helps."""
    kinematics, task = query.mechanism.kinematics, query.mechanism.task
    distance, angle, J = kinematics.errors_and_jacobian(x, query.target, task)
    largest = distance if task == "position" else max(distance, angle)
    if not largest <= POLISH_TO:  # not a number among them
        return None
    steps = 0
    if largest >= POLISH_FROM:
        residual = kinematics.residual(query.target, task)
        ended = newton(residual, x, query.structure.free, below(POLISH_FROM**2), _POLISH, POLISH_STEPS)
        ends = kinematics.errors_and_jacobian(ended.x, query.target, task)
        if not max(distance, angle) <= max(ends[0], ends[1]):  # singular several times over, steps may lead away
            x, steps, (distance, angle, J) = ended.x, ended.steps, ends
    if not (math.isfinite(distance + angle) and is_met(task, distance, angle)):
        return None
    return VerifiedRow(query.shown(x), distance, angle, steps, J)


def collect(query: BranchQuery, candidates: Iterable[Candidate]) -> Solutions:
    """Return the candidates that are solutions, once each, sorted by distance to the start."""
    mechanism = query.mechanism
    inside: list[tuple[float, VerifiedRow]] = []
    beyond: list[tuple[float, VerifiedRow, tuple[str, ...]]] = []
    factors = mechanism.kinematics.si_factors
    known: list[list[float]] = []
    for x, free_axes in candidates:
        row = verified(query, x)
        if row is None or not (query.keeps is None or query.keeps(row.axes)):
            continue
        reached = row.axes * factors
        if _is_known(query, known, reached.tolist()):
            continue
        if free_axes:
            row = row._replace(free_axes=free_axes)
        out = mechanism.limits.violated(row.axes)
        if out:
            beyond.append((query.distance(reached), row, out))
            continue
        moved = on_limits(mechanism, query.target, row.axes, mechanism.task)
        if moved is not None:
            row = row._replace(axes=moved[0], distance=moved[1], angle=moved[2])
        inside.append((query.distance(reached), row))
        known.append(reached.tolist())
    inside.sort(key=lambda item: item[0])
    beyond.sort(key=lambda item: item[0])
    nearest = beyond[0] if beyond else None
    outside = () if nearest is None or inside else nearest[2]
    branches = _as_arrays([row for _, row in inside], mechanism)
    first = None if nearest is None else nearest[1].branch(mechanism.task, mechanism.labels)
    jacobians = [row.jacobian for _, row in inside]
    others = tuple(row.axes * factors for _, row, _ in beyond)
    J = np.array(jacobians) if inside else np.empty((0, 0, len(factors)))
    return Solutions(branches, first, outside, others, J)


def _is_known(query: BranchQuery, known: Sequence[Sequence[float]], reached: Sequence[float]) -> bool:
    """Return whether SI axis values are those of a known branch, but for whole turns if these do not count.

    Half a turn from the start both ways are as near, and rounding decides: two solutions may have gone both.
    """
    periodic = query.periodic.tolist()
    for other in known:
        for n, value in enumerate(reached):
            way = abs(value - other[n])
            if way > math.pi and periodic[n] and not query.windings:
                way = abs(math.remainder(way, math.tau))
            if not way < SAME_BRANCH:
                break
        else:
            return True
    return False


def _as_arrays(rows: Sequence[VerifiedRow], mechanism: Mechanism) -> Branches:
    axes = np.array([row.axes for row in rows]).reshape(-1, len(mechanism.axes))
    left = np.array([(row.distance, row.angle) for row in rows]).reshape(-1, 2)
    steps = np.array([row.steps for row in rows], dtype=np.int64)
    free_axes = tuple(row.free_axes for row in rows)
    directions = (isolated(mechanism.labels),) * len(rows)
    left_over = left[:, 0], left[:, 1]
    return Branches(axes, *left_over, steps, free_axes, mechanism.task, mechanism.labels, free_directions=directions)


def named(branches: Branches, method: str, bits: Integers | None) -> Branches:
    """Return branches with what found them, and with status and turn where the controller numbers them.

    Args:
        branches: The branches.
        method: Name of a `SolverPlan`.
        bits: (k, 2) status and turn of each, or None.
    """
    if bits is None:
        return replace(branches, method=method)
    return replace(branches, method=method, status_bits=bits[:, 0], turn_bits=bits[:, 1])
