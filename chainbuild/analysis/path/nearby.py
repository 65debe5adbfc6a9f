"""Which parts of blocks are close to a singularity: the functions of the kinds where they tell all, else σ.

| motion | robot                                       | looked at                                   |
|--------|---------------------------------------------|---------------------------------------------|
| ptp    | its factors are its determinant             | sums of cosines: no zero is missed          |
| ptp    | any other, affine axis map                  | smallest singular value, bounded rate       |
| ptp    | nonlinear axis map                          | smallest singular value, sampled            |
| cp     | arm with a wrist point, linear machine      | functions of the pose, bounded rate         |
| cp     | struts below programmed rotary axes         | smallest singular value of struts, sampled  |
| cp     | any other                                   | smallest singular value, sampled            |
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np

from chainbuild.analysis.path.motion import LineMotion, PathMotion, SlidingMotion, StraightMotion
from chainbuild.analysis.singularity.jacobians import pose_jacobians
from chainbuild.analysis.singularity.measures import Scaling, least_of, scaling_of
from chainbuild.analysis.singularity.structure import SingularityKind
from chainbuild.analysis.vanishing.functions import SingularFunctions, singular_functions
from chainbuild.analysis.vanishing.line import LineBlocks, line_geometry
from chainbuild.analysis.vanishing.linetraced import (
    ArmOnLines,
    ElbowTraced,
    PoleTraced,
    ShoulderTraced,
    WristTraced,
    vector_lines,
)
from chainbuild.analysis.vanishing.lows import Low, lows
from chainbuild.analysis.vanishing.rates import SmallestValue
from chainbuild.analysis.vanishing.tracing import Blocks, Traced, bisected_share, traced_lows
from chainbuild.analysis.vanishing.waves import TOUCHES, Waves
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AffineMap
from chainbuild.kinematics.mechanism import Mechanism

SAMPLES: Final = 64  # places a block at which a value without a bound is looked at
_HALVINGS: Final = 3  # of all blocks at once, before those that are left are gone through one by one
_SINGULAR: Final = 1e-7  # sines and shares of the length that a search for a minimum leaves of 0


@dataclass(frozen=True, slots=True, eq=False)
class KindLows:
    """The low parts of one kind.

    Attributes:
        kind: Of the singularity; "other": the smallest singular value.
        proven: Whether none is missed.
        parts: Block → its low parts.
        singular: Values up to this are the singularity.
    """

    kind: SingularityKind
    proven: bool
    parts: dict[int, list[Low]]
    singular: float


@dataclass(frozen=True, slots=True)
class Near:
    """Thresholds.

    Attributes:
        factor: Of functions of named kinds.
        smallest: Of the smallest singular value.
    """

    factor: float
    smallest: float


def nearby(motion: PathMotion, near: Near) -> Iterator[KindLows]:
    """Yield the low parts of each kind along a motion.

    Args:
        motion: Between rows without gaps.
        near: Thresholds.
    """
    robot = motion.robot
    blocks = np.arange(len(motion.rows) - 1)
    if isinstance(motion, StraightMotion):
        known = singular_functions(robot)
        if known.complete:
            yield from _by_waves(robot, known, motion.rows, near.factor)
            return
        traced = SmallestValue.along(robot, motion.rows, near.smallest, 1.0 / SAMPLES)
        proven = isinstance(robot.chain.axis_map, AffineMap)
        yield KindLows("other", proven, traced_lows(traced, blocks), _SINGULAR)
        return
    steady = _held_still(robot, motion.rows)
    yield from _on_lines(motion, blocks[steady], near)
    if not steady.all():
        yield _followed(motion, blocks[~steady], near)


def leaving(motion: PathMotion) -> list[tuple[int, float]]:
    """Return block and share at which a line leaves the reach of an arm, in order."""
    if not isinstance(motion, LineMotion):
        return []
    blocks = np.flatnonzero(_held_still(motion.robot, motion.rows))
    on = _arm_on(motion, motion.lines, blocks, 0.0)
    if on is None:
        return []
    traced = ElbowTraced(on)
    found = []
    for block, parts in traced_lows(traced, blocks).items():
        for part in parts:
            places = np.linspace(part.begin, part.end, SAMPLES)
            beyond = [traced.beyond(block, float(t)) for t in places]
            if any(beyond):
                first = beyond.index(True)
                inside = float(places[max(first - 1, 0)])
                found.append((block, bisected_share(partial(traced.beyond, block), inside, float(places[first]))))
    return sorted(found)


def _by_waves(robot: Mechanism, known: SingularFunctions, rows: Matrix, near: float) -> Iterator[KindLows]:
    axis_map = robot.chain.axis_map
    assert isinstance(axis_map, AffineMap)
    q = axis_map.q_rows(rows)
    for function in known.functions:
        waves = Waves.along(function, q)
        found = {int(n): lows(waves.block(n), near) for n in waves.not_clear(near, _HALVINGS)}
        yield KindLows(function.kind, True, {n: parts for n, parts in found.items() if parts}, TOUCHES)


def _held_still(robot: Mechanism, rows: Matrix) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    held = [axis.held for axis in robot.axes]
    return np.asarray((np.diff(rows[:, held], axis=0) == 0.0).all(axis=1))


def _on_lines(motion: PathMotion, blocks: Blocks, near: Near) -> Iterator[KindLows]:
    if not len(blocks):
        return
    robot = motion.robot
    lines = _lines_of(motion)
    on = _arm_on(motion, lines, blocks, near.factor)
    if on is not None:
        kinds: list[tuple[SingularityKind, Traced]] = [("shoulder", ShoulderTraced(on)), ("elbow", ElbowTraced(on))]
        if on.arm.wrist is not None:
            kinds.append(("wrist", WristTraced(on, on.arm.wrist)))
        for kind, traced in kinds:
            yield KindLows(kind, True, traced_lows(traced, blocks), _SINGULAR)
        return
    if isinstance(motion, SlidingMotion) and robot.chain.loops:
        yield _followed(motion, blocks, near)
        return
    geometry = line_geometry(robot, motion.rows[blocks[0]][[axis.held for axis in robot.axes]])
    if geometry is not None and geometry.bend is not None:
        bent: SingularityKind = "pole" if robot.task == "direction" else "wrist"
        yield KindLows(bent, True, traced_lows(PoleTraced(lines, geometry.bend, near.factor), blocks), _SINGULAR)
    elif not isinstance(motion, SlidingMotion):
        yield _followed(motion, blocks, near)


def _lines_of(motion: PathMotion) -> LineBlocks:
    if isinstance(motion, LineMotion):
        return motion.lines
    poses, robot = motion.robot.fk_batch(motion.rows), motion.robot
    return vector_lines(poses, robot.chain.tool_column) if robot.task == "direction" else LineBlocks.between(poses)


def _arm_on(motion: PathMotion, lines: LineBlocks, blocks: Blocks, near: float) -> ArmOnLines | None:
    """Return an arm along lines, or None where the robot is none whose pose tells all."""
    robot = motion.robot
    known = singular_functions(robot)
    if not known.complete or not len(blocks):
        return None
    held = motion.rows[blocks][:, [axis.held for axis in robot.axes]]
    geometry = line_geometry(robot, held[0])
    shoulder, elbow = known.of_kind("shoulder"), known.of_kind("elbow")
    if geometry is None or geometry.arm is None or shoulder is None or elbow is None or (held != held[0]).any():
        return None
    axis_map = robot.chain.axis_map
    assert isinstance(axis_map, AffineMap)
    q = axis_map.q_rows(motion.rows)
    branch = np.ones((len(q) - 1, 2))
    for column, function in enumerate((shoulder, elbow)):
        values = np.cos(q @ function.multiples.T + function.phases) @ function.amplitudes
        # Where a block begins in the singularity, its end tells the branch.
        branch[:, column] = np.where(np.abs(values[:-1]) > _SINGULAR, np.sign(values[:-1]), np.sign(values[1:]))
    return ArmOnLines(geometry.arm, lines, np.where(branch == 0.0, 1.0, branch), near)


def _followed(motion: PathMotion, blocks: Blocks, near: Near) -> KindLows:
    scaling = _of_struts(motion.robot) if isinstance(motion, SlidingMotion) else scaling_of(motion.robot)
    traced = Followed(motion, scaling, near.smallest)
    return KindLows("other", False, traced_lows(traced, blocks), _SINGULAR)


def _of_struts(robot: Mechanism) -> Scaling:
    """Return the scaling for the position by the struts alone: with the rotary axes programmed no turn is asked."""
    solved = np.array(robot.chain.display.solved, dtype=np.intp)
    return Scaling(np.arange(3), solved, scaling_of(robot).length, np.ones((3, len(solved))), False)


@dataclass(frozen=True, slots=True, eq=False)
class Followed:
    """The smallest singular value along a motion whose axes are solved for, sampled."""

    motion: PathMotion
    scaling: Scaling
    threshold: float

    def margins(self, blocks: Blocks, t: Vector) -> Vector:
        """Return how far the value is above the threshold; inf where there are no axis values."""
        return self.sizes(blocks, t) - self.threshold

    def sizes(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the smallest scaled singular values."""
        motion = self.motion
        axes = motion.direct(blocks, t) if isinstance(motion, LineMotion) else motion.axes(blocks, t)
        found = np.full(len(axes), np.inf)
        known = np.flatnonzero(np.isfinite(axes).all(axis=1))
        for part, _, J in pose_jacobians(self.motion.robot, axes[known]):
            singular = np.linalg.svd(self.scaling.apply(J), compute_uv=False)
            found[known[part]] = least_of(singular, bool(motion.robot.chain.loops))
        return found

    def steps(self, blocks: Blocks, t: Vector, margins: Vector) -> Vector:
        """Return the distance of samples."""
        return np.full(len(blocks), 1.0 / SAMPLES)
