"""Configurations to start a search from: a fixed table whose poses are known.

The search begins where the table comes nearest to the target. With a few hundred points most searches end in
the first descent, and a lookup costs less than one of its steps.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.errors import ChainbuildError
from chainbuild.ik.region import Box, finite_span
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.product import poses_at

_COUNT: Final = 256  # points: ranked in a few microseconds
_TURN_SHARE: Final = 0.3  # weight of a squared rotation as a share of the squared spread of the positions
_KEPT_TRIES: Final = 8  # candidates drawn per point if coupled limits exclude some


@dataclass(frozen=True, slots=True, eq=False)
class Starts:
    """Points of the region and features of their poses.

    Attributes:
        points: (count, n_free) SI values.
        features: (12, count) rotation and position of each pose, row by row, scaled to be compared.
        scale: (12,) the scale.
        centre: (3,) mean position [m].
        offsets: (count,) squared length of each start's features.
        doubled: (12,) twice the scale.
        rows: (count, 12) the features by start.
    """

    points: Matrix
    features: Matrix
    scale: Vector
    centre: Vector
    offsets: Vector
    doubled: Vector
    rows: Matrix

    def scaled(self, scale: Vector) -> Starts:
        """Return the same starts compared by fewer features: the scale (12,) is 0 where one does not count."""
        features = self.features * (scale != 0.0)[:, None]
        return _starts(self.points, features, scale, self.centre)

    def distances(self, target: Matrix) -> Vector:
        """Return how far each start's pose (count,) is from a target (4, 4), up to a common constant."""
        squared: Vector = self.offsets - self.rows.dot(target[:3].ravel() * self.doubled)
        return squared


def _features(T: Matrix) -> Matrix:
    """Return the upper three rows of poses (N, 4, 4) as columns (12, N)."""
    return T[:, :3].reshape(-1, 12).T


def starts_of(
    mechanism: Mechanism,
    box: Box,
    middle: Vector,
    free: NDArray[np.intp],
    x: Vector,
    weights: Vector,
    axis: int,
    seed: int,
) -> Starts:
    """Draw the table of starts.

    Args:
        mechanism: The mechanism.
        box: Limits of the free axes.
        middle: (n_free,) near the middle of the limits.
        free: Indices of the free axes.
        x: (n_axes,) SI values of the held axes.
        weights: (6,) weights of the task.
        axis: Tool axis whose direction alone counts, or -1.
        seed: Seed.
    """
    points = points_inside(box, middle, np.random.default_rng(seed), _COUNT)
    full = np.repeat(x[None], len(points), axis=0)
    full[:, free] = points
    T, known = _poses(mechanism, full)
    points, T = points[known], T[known]
    position = T[:, :3, 3]
    centre = position.mean(axis=0) if len(T) else np.zeros(3)
    spread = float(((position - centre) ** 2).sum(axis=1).mean()) if len(T) else 1.0
    scale = np.zeros((3, 4))
    scale[:, 3] = weights[:3] > 0.0
    if weights[3:].any():
        turn = np.sqrt(0.5 * _TURN_SHARE * max(spread, 1e-6))
        scale[:, :3] = turn * (np.ones(3) if axis < 0 else np.eye(3)[axis] * np.sqrt(2.0))
    return _starts(points, np.ascontiguousarray(scale.reshape(12, 1) * _features(T)), scale.ravel(), centre)


def _starts(points: Matrix, features: Matrix, scale: Vector, centre: Vector) -> Starts:
    rows = np.ascontiguousarray(features.T)
    return Starts(points, features, scale, centre, (rows**2).sum(axis=1), 2.0 * scale, rows)


def points_inside(box: Box, middle: Vector, rng: np.random.Generator, count: int) -> Matrix:
    """Draw up to so many points (count, n) inside limits and coupled limits, none a whole turn from the middle."""
    lower, upper = _one_turn(box, middle)
    drawn = count * (_KEPT_TRIES if len(box.sums) else 1)
    points = lower + (upper - lower) * rng.random((drawn, len(lower)))
    if len(box.sums):
        value = points @ box.sums.T
        kept = points[((value >= box.sum_lower) & (value <= box.sum_upper)).all(axis=1)]
        points = kept if len(kept) else points
    return points[:count]


def off_middle(box: Box, middle: Vector, points: Matrix) -> Matrix:
    """Return how far points (count, n) are from the middle of what `points_inside` draws from: 1 at its edges."""
    lower, upper = _one_turn(box, middle)
    half = np.maximum((upper - lower) / 2.0, np.finfo(float).tiny)
    off: Matrix = np.abs(points - (lower + upper) / 2.0) / half
    return off


def _one_turn(box: Box, middle: Vector) -> tuple[Vector, Vector]:
    """Return limits to draw from: at most one turn of a rotary axis, about the middle."""
    lower, upper = finite_span(box.lower, box.upper)
    most = np.where(box.periodic, math.pi, math.inf)
    return np.maximum(lower, middle - most), np.minimum(upper, middle + most)


def _poses(mechanism: Mechanism, x: Matrix) -> tuple[Matrix, NDArray[np.bool_]]:
    """Return the poses (N, 4, 4) and which of them exist."""
    product = mechanism.kinematics.product
    if product is not None:
        return poses_at(product, x, np.ones(x.shape[1])), np.ones(len(x), dtype=bool)
    T = np.full((len(x), 4, 4), np.nan)
    for row, values in zip(T, x, strict=True):
        try:
            row[:] = mechanism.kinematics.pose(mechanism.kinematics.q(values)).homogeneous
        except ChainbuildError:
            continue
    return T, np.isfinite(T).all(axis=(1, 2))
