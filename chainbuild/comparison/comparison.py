"""Differences between poses and branches of two solvers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrices, Vector
from chainbuild.chain.elements import Task
from chainbuild.comparison.samples import Samples
from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.every import every_branch
from chainbuild.ik.request import IkRequest
from chainbuild.kinematics.inputs import as_pose
from chainbuild.shown import fields_shown

if TYPE_CHECKING:
    from chainbuild.comparison.other_solvers import OtherSolver
    from chainbuild.kinematics.mechanism import Mechanism


POSITION_TOLERANCE_M: Final = 1e-6  # far above rounding, far below any dimension of a machine
ROTATION_TOLERANCE_RAD: Final = 1e-6  # the same at a reach of 1 m
_SAME_BRANCH: Final = 1e-4  # [m, rad]: near a singularity branches of one pose are only this well defined


def pose_errors(ours: Matrices, theirs: Matrices, compared: Task, column: int = 2) -> tuple[Vector, Vector]:
    """Return distances [m] and angles [rad] between poses (n, 4, 4).

    Args:
        ours: Poses.
        theirs: Poses.
        compared: "pose": angle of the whole rotation; "direction": of the tool direction; "position": 0.
        column: Column of the rotation that is the tool direction.
    """
    distance = np.linalg.norm(ours[:, :3, 3] - theirs[:, :3, 3], axis=1)
    if compared == "position":
        return distance, np.zeros(len(distance))
    if compared == "direction":
        chord = np.linalg.norm(ours[:, :3, column] - theirs[:, :3, column], axis=1) / 2.0
    else:
        chord = np.linalg.norm(ours[:, :3, :3] - theirs[:, :3, :3], axis=(1, 2)) / math.sqrt(8.0)
    return distance, 2.0 * np.arcsin(np.minimum(chord, 1.0))


def forward_poses(robot: Mechanism, axes: Vector) -> Matrices:
    """Return the poses (n, 4, 4) [m] of axis values (n, n_axes); NaN where there is none."""
    kinematics = robot.kinematics
    axis_map = robot.chain.axis_map
    return np.array([kinematics.pose(axis_map.q(row)).homogeneous for row in axes]).reshape(-1, 4, 4)


@dataclass(frozen=True, slots=True, eq=False)
class Forward:
    """Forward kinematics compared.

    Attributes:
        samples: Axis values.
        ours: (n, 4, 4) chainbuild's poses [m].
        theirs: (n, 4, 4) the other solver's; NaN where it gave none.
        compared: Which part of the pose was compared.
        position_error: (n,) [m]; infinite where the other solver gave none.
        rotation_error: (n,) [rad].
        position_tolerance: [m].
        rotation_tolerance: [rad].
    """

    __repr__ = fields_shown

    samples: Samples
    ours: Matrices
    theirs: Matrices
    compared: Task
    position_error: Vector
    rotation_error: Vector
    position_tolerance: float = POSITION_TOLERANCE_M
    rotation_tolerance: float = ROTATION_TOLERANCE_RAD

    @property
    def agrees(self) -> NDArray[np.bool_]:
        """(n,) True where both errors are within tolerance."""
        within: NDArray[np.bool_] = (self.position_error <= self.position_tolerance) & (
            self.rotation_error <= self.rotation_tolerance
        )
        return within

    @property
    def score(self) -> Vector:
        """(n,) the larger error, each as a multiple of its tolerance."""
        return np.maximum(self.position_error / self.position_tolerance, self.rotation_error / self.rotation_tolerance)

    @property
    def difference(self) -> Vector:
        """(n, 3) theirs minus ours [m], along x, y, z of the workpiece frame; NaN where the other solver gave none."""
        moved: Vector = self.theirs[:, :3, 3] - self.ours[:, :3, 3]
        return moved

    @property
    def worst(self) -> int:
        """Index of the sample with the largest error."""
        return int(np.argmax(self.score))


def compare_forward(
    robot: Mechanism,
    samples: Samples,
    theirs: Matrices,
    compared: Task,
    tolerance: tuple[float, float] = (POSITION_TOLERANCE_M, ROTATION_TOLERANCE_RAD),
) -> Forward:
    """Return how far chainbuild's poses are from another solver's.

    Args:
        robot: The robot.
        samples: Axis values.
        theirs: (n, 4, 4) [m]; NaN where there is no pose.
        compared: What to compare.
        tolerance: Metres and radians within which poses agree.
    """
    ours = forward_poses(robot, samples.axes)
    distance, angle = pose_errors(ours, theirs, compared, robot.chain.tool_column)
    distance, angle = (np.where(np.isfinite(e), e, np.inf) for e in (distance, angle))
    return Forward(samples, ours, theirs, compared, distance, angle, *tolerance)


@dataclass(frozen=True, slots=True, eq=False)
class Inverse:
    """Inverse kinematics compared, branch by branch.

    Attributes:
        samples: Axis values of the poses.
        ours: Branches that chainbuild found inside the limits.
        theirs: Answers of the other solver.
        wrong: Answers that miss the pose.
        outside: Right answers that no whole turn brings inside the limits.
        missing: Branches that the other solver did not find.
        extra: Right answers inside the limits that chainbuild did not find.
        unanswered: Poses to which the other solver gave no right answer.
        singular: Poses where an axis is free, so that branches cannot be matched.
        worst_position_error: Of all answers [m].
        worst_rotation_error: Of all answers [rad].
        pairs: Answers with the poses they were given for, wrong ones first: (n, n_axes) and (n, 4, 4).
        complete: False if the other solver gives one answer only, so that none counts as missing.
    """

    __repr__ = fields_shown

    samples: Samples
    ours: int
    theirs: int
    wrong: int
    outside: int
    missing: int
    extra: int
    unanswered: int
    singular: int
    worst_position_error: float
    worst_rotation_error: float
    pairs: tuple[Vector, Matrices]
    complete: bool

    @property
    def agrees(self) -> bool:
        """Whether nothing is wrong, missing, extra or unanswered."""
        return not (self.wrong or self.missing or self.extra or self.unanswered)


@dataclass(slots=True)
class _Tally:
    """Counts while branches are compared."""

    ours: int = 0
    theirs: int = 0
    wrong: int = 0
    outside: int = 0
    missing: int = 0
    extra: int = 0
    unanswered: int = 0
    singular: int = 0
    worst_position_error: float = 0.0
    worst_rotation_error: float = 0.0


def compare_inverse(
    robot: Mechanism,
    samples: Samples,
    reference: OtherSolver,
    tolerance: tuple[float, float] = (POSITION_TOLERANCE_M, ROTATION_TOLERANCE_RAD),
) -> Inverse:
    """Return how the branches of another solver compare with chainbuild's.

    Args:
        robot: The robot.
        samples: Axis values of the poses.
        reference: A solver with an inverse.
        tolerance: Metres and radians within which an answer is right.
    """
    if reference.ik is None:
        raise ChainbuildError(f"{reference.name} has no inverse")
    tally = _Tally()
    wrong: list[tuple[Vector, Vector]] = []
    right: list[tuple[Vector, Vector]] = []
    for row in samples.axes:
        target = robot.fk(row).homogeneous
        answers = reference.answers(target)
        good = []
        for answer in answers:
            distance, angle = _miss(robot, answer, target)
            tally.worst_position_error = max(tally.worst_position_error, distance)
            tally.worst_rotation_error = max(tally.worst_rotation_error, angle)
            hit = distance <= tolerance[0] and angle <= tolerance[1]
            (right if hit else wrong).append((answer, target))
            if hit:
                good.append(answer)
        tally.theirs += len(answers)
        tally.wrong += len(answers) - len(good)
        tally.unanswered += not good
        _count_branches(robot, row, target, good, tally, complete=reference.complete)
    pairs = [*wrong, *right]
    axes = np.array([p[0] for p in pairs]).reshape(-1, len(robot.axes))
    counts = {name: getattr(tally, name) for name in _Tally.__slots__}
    targets = np.array([p[1] for p in pairs]).reshape(-1, 4, 4)
    return Inverse(samples, pairs=(axes, targets), complete=reference.complete, **counts)


def _miss(robot: Mechanism, answer: Vector, target: Vector) -> tuple[float, float]:
    x = answer * robot.kinematics.si_factors
    distance, angle = robot.kinematics.errors(x, as_pose(target), robot.task)
    if not math.isfinite(distance + angle):
        return math.inf, math.inf
    return distance, 0.0 if robot.task == "position" else angle


def _count_branches(
    robot: Mechanism, row: Vector, target: Vector, good: Sequence[Vector], tally: _Tally, *, complete: bool
) -> None:
    """Add up missing and extra branches of one pose."""
    query = BranchQuery.of(IkRequest(robot, target, row))
    found = every_branch(query)
    if any(found.branches.free_axes):
        tally.singular += 1
        return
    factors = robot.kinematics.si_factors
    ours = [axes * factors for axes in found.branches.axes]
    theirs = [answer * factors for answer in good]
    inside = [answer for answer in theirs if not robot.limits.violated(query.shown(_inside_limits(query, answer)))]
    tally.ours += len(ours)
    tally.outside += len(theirs) - len(inside)
    if complete:
        tally.missing += sum(all(_are_distinct(query, mine, other) for other in theirs) for mine in ours)
    tally.extra += sum(all(_are_distinct(query, answer, mine) for mine in ours) for answer in inside)


def _inside_limits(query: BranchQuery, x: Vector) -> Vector:
    """Return x with periodic axes brought inside their limits by whole turns where that is possible."""
    moved = x.copy()
    for n in np.flatnonzero(query.periodic):
        lower, upper = float(query.lower[n]), float(query.upper[n])
        if moved[n] < lower:
            moved[n] += math.tau * math.ceil((lower - moved[n]) / math.tau)
        elif moved[n] > upper:
            moved[n] -= math.tau * math.ceil((moved[n] - upper) / math.tau)
    return moved


def _are_distinct(query: BranchQuery, a: Vector, b: Vector) -> bool:
    """Tell whether two solutions differ by more than whole turns."""
    difference = a - b
    turns = query.periodic
    difference[turns] = np.remainder(difference[turns] + math.pi, math.tau) - math.pi
    return bool(np.abs(difference).max() > _SAME_BRANCH)
