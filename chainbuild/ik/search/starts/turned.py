"""Starts for arms whose first axis turns the whole arm and whose last one turns the tool.

These two axes need no search: of the six freedoms of a pose they leave four, and a table of a thousand points is
dense in four. A point is looked up by the key of the target (below), moved by one Newton step towards
it, and turned: by the first axis into the plane of the target, by the last one upright.

With T = F·Rz(u)·M·Rz(v)·E the matrix W = F⁻¹·T·E⁻¹ is M up to a rotation about z on either side. The invariants of such
rotations, in the plane through z and the origin of W, are five numbers, the key:

        z ▲        ╱ direction of the last axis (3 numbers of length 1)
          │      ●
          │      │ height
          └──────┘
           radius
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.ik.region import Box
from chainbuild.ik.search.starts.arm_reach import ends_of
from chainbuild.ik.search.starts.sampled import off_middle, points_inside
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.product import Product, poses_at

COUNT: Final = 1024  # of points: dense in four dimensions, and ranked in some microseconds
DIRECTION_SHARE: Final = 0.4  # weight of the direction, as a share of the spread of radius and height
NO_RADIUS: Final = 1e-9  # m: on the first axis any plane fits

_STEP: Final = 1e-6  # rad or m, of the derivatives
_DAMPING: Final = 1e-5  # share of the squared spread
_STIFF: Final = 0.05  # share of the spread: lower bound of how much a point's key follows its axes
_EDGE: Final = 0.2  # share of the spread: distance added to a point for each axis at the edge of its range
_NEAR_AXIS: Final = 0.3  # of the spread: points of a smaller radius are also seen from behind
_FREEDOMS: Final = 4  # of a key: its direction is of length 1


@dataclass(frozen=True, slots=True, eq=False)
class TablePoints:
    """Points of an arm, independent of its base and its tool.

    Attributes:
        values: (count, n_free) SI values; that of the axis which turns the arm less what it takes to azimuth 0.
        scale: What makes directions comparable with lengths [m].
        rows: (8, count) of the weighted squared distance to a key k: (k, k·k, 1, 1)·rows. The last row is added to
            points whose axes are at the edge of their ranges: of points about as near, the first start is one in the
            middle. In single precision.
        maps: (count, n_free + 2, 12) applied to (key, X and Y of W in its plane, 1): how far each axis moves towards
            the key, then cosine and sine of the turn of the last axis, which comes on top.
    """

    values: Matrix
    scale: float
    rows: NDArray[np.float32]
    maps: NDArray[np.float64]


def table_points(
    arm: Product,
    ends: tuple[Matrix, Matrix],
    box: Box,
    middle: Vector,
    turning: tuple[int, int],
    signs: tuple[float, float],
    seed: int,
) -> TablePoints:
    """Draw the points and measure how their keys follow their axes.

    Args:
        arm: From the workpiece to the tool, by the free axes.
        ends: F⁻¹ and E⁻¹ (4, 4).
        box: Limits of the free axes.
        middle: (n_free,) near the middle of the limits.
        turning: Indices of the axes that turn the arm and the tool.
        signs: How they turn, 1 or −1.
        seed: Seed.
    """
    values, facing = _points_facing(arm, ends, points_inside(box, middle, np.random.default_rng(seed), COUNT))
    keys, azimuths, planar = _seen(arm, ends, values, facing)
    spread = _spread(keys)
    scale = DIRECTION_SHARE * math.sqrt(spread)
    keys[:, 2:] *= scale
    X, Y = planar[:, :3], planar[:, 3:]
    uprights = np.stack([np.hstack([X, Y]), np.hstack([Y, -X])], axis=1)

    between = [n for n in range(values.shape[1]) if n not in turning]
    slopes, turns = np.empty((len(values), 5, len(between))), np.empty((len(values), 2, len(between)))
    for column, n in enumerate(between):
        moved = values.copy()
        moved[:, n] += _STEP
        there, azimuths_there, planar_there = _seen(arm, ends, moved, facing)
        there[:, 2:] *= scale
        slopes[:, :, column] = (there - keys) / _STEP
        turns[:, 0, column] = -signs[0] * _half_turn(azimuths_there - azimuths) / _STEP
        c, s = np.einsum("nij,nj->in", uprights, planar_there)
        turns[:, 1, column] = -signs[1] * np.arctan2(s, c) / _STEP

    square = slopes @ slopes.transpose(0, 2, 1)
    gains = np.empty((len(values), values.shape[1], 5))
    gains[:, between] = slopes.transpose(0, 2, 1) @ np.linalg.inv(square + _DAMPING * spread * np.eye(5))
    gains[:, list(turning)] = turns @ gains[:, between]
    least = np.linalg.eigvalsh(square)[:, 5 - min(_FREEDOMS, len(between))]
    weights = 1.0 / np.sqrt(np.maximum(least, _STIFF**2 * spread))
    offsets = weights * (keys**2).sum(axis=1)
    edges = _EDGE * math.sqrt(spread) * (off_middle(box, middle, values)[:, between] ** 4).sum(axis=1)
    rows = np.vstack([-2.0 * weights * keys.T, weights, offsets, edges]).astype(np.float32)

    maps = np.zeros((len(values), values.shape[1] + 2, 12))
    maps[:, :-2, :5] = gains
    maps[:, :-2, 11] = -np.einsum("nij,nj->ni", gains, keys)
    maps[:, -2:, 5:11] = uprights
    values[:, turning[0]] -= signs[0] * azimuths
    return TablePoints(values, scale, rows, maps)


def _points_facing(arm: Product, ends: tuple[Matrix, Matrix], values: Matrix) -> tuple[Matrix, Vector]:
    """Return points and their viewing sides: those near the first axis also from behind.

    An arm that reaches just behind the first axis is next to one that reaches just before it, half a turn away.
    """
    keys, _, _ = _seen(arm, ends, values, np.ones(len(values)))
    near = np.flatnonzero(keys[:, 0] < _NEAR_AXIS * math.sqrt(_spread(keys)))
    return np.vstack([values, values[near]]), np.concatenate([np.ones(len(values)), -np.ones(len(near))])


def _spread(keys: Matrix) -> float:
    """Return the mean squared deviation of radius and height of keys (N, 5) [m²]."""
    return float(((keys[:, :2] - keys[:, :2].mean(axis=0)) ** 2).sum(axis=1).mean()) or 1.0


def _seen(arm: Product, ends: tuple[Matrix, Matrix], values: Matrix, facing: Vector) -> tuple[Matrix, Vector, Matrix]:
    """Return keys (N, 5) without scale, azimuths (N,) and X and Y of W turned into the plane of azimuth 0 (N, 6).

    Where `facing` (N,) is −1, not 1, the plane is looked at from behind: the radius is negative.
    """
    W = ends[0] @ poses_at(arm, values, np.ones(values.shape[1])) @ ends[1]
    x, y, z = W[:, 0, 3], W[:, 1, 3], W[:, 2, 3]
    radius = np.hypot(x, y)
    off = radius > NO_RADIUS
    azimuths = np.where(off, np.arctan2(facing * y, facing * x), 0.0)
    c, s = np.cos(azimuths), np.sin(azimuths)
    turned = W[:, :3, :3].copy()
    turned[:, 0] = c[:, None] * W[:, 0, :3] + s[:, None] * W[:, 1, :3]
    turned[:, 1] = c[:, None] * W[:, 1, :3] - s[:, None] * W[:, 0, :3]
    keys = np.column_stack([facing * radius, z, turned[:, :, 2]])
    return keys, azimuths, np.hstack([turned[:, :, 0], turned[:, :, 1]])


def _half_turn(angles: Vector) -> Vector:
    """Return angles as −π … π."""
    turned: Vector = angles - math.tau * np.round(angles / math.tau)
    return turned


LARGEST_STEP: Final = 0.5  # rad or m that an axis moves from its point to the start

_MIN_JOINTS: Final = 4  # fewer do not need a table
_MAX_TABLES: Final = 2  # tables per robot: if axes in between are held at ever new values, a table does not pay


@dataclass(frozen=True, slots=True, eq=False)
class TableKey:
    """Lookup data of a target.

    Attributes:
        key: (8,) its key, the key's square, 1 and 1, in single precision.
        azimuth: Of its plane [rad].
        view: (12,) key, X and Y of W in its plane, 1.
    """

    key: NDArray[np.float32]
    azimuth: float
    view: Vector


@dataclass(frozen=True, slots=True, eq=False)
class TurnedStarts:
    """The table of an arm with its base and tool.

    Attributes:
        points: The table.
        before: (4, 4) F⁻¹ [m].
        after: (4, 4) E⁻¹ [m].
        first: Index of the free axis that turns the arm.
        last: Index of the one that turns the tool.
        signs: How they turn: 1 or −1.
    """

    points: TablePoints
    before: Matrix
    after: Matrix
    first: int
    last: int
    signs: tuple[float, float]

    def query(self, target: Matrix) -> TableKey:
        """Return the lookup data of a target (4, 4)."""
        (a, b, dx, x), (d, e, dy, y), (g, h, dz, z), _ = self.before.dot(target).dot(self.after).tolist()
        radius = math.hypot(x, y)
        c, s = (x / radius, y / radius) if radius > NO_RADIUS else (1.0, 0.0)
        scale = self.points.scale
        key = (radius, z, scale * (c * dx + s * dy), scale * (c * dy - s * dx), scale * dz)
        planar = (c * a + s * d, c * d - s * a, g, c * b + s * e, c * e - s * b, h)
        square = radius * radius + z * z + scale * scale
        own = np.array((*key, square, 1.0, 1.0), np.float32)
        return TableKey(own, math.atan2(s, c), np.array((*key, *planar, 1.0)))

    def distances(self, query: TableKey) -> NDArray[np.float32]:
        """Return how far each point (count,) is, weighted by how much its axes have to move for it, edges included."""
        squared: NDArray[np.float32] = query.key.dot(self.points.rows)
        return squared

    def start(self, n: int, query: TableKey, box: Box, wanted: Vector) -> Vector | None:
        """Return the n-th point moved and turned towards the target, or None where limits forbid the turns.

        Args:
            n: Index of the point.
            query: What `query` returned.
            box: The limits.
            wanted: (n_free,) where whole turns shall end near to.
        """
        *steps, c, s = self.points.maps[n].dot(query.view).tolist()
        largest = max(map(abs, steps))
        share = LARGEST_STEP / largest if largest > LARGEST_STEP else 1.0
        y = [value + share * step for value, step in zip(self.points.values[n].tolist(), steps, strict=True)]
        y[self.first] += self.signs[0] * query.azimuth
        y[self.last] += self.signs[1] * math.atan2(s, c)
        return box.turned_to(y, (self.first, self.last), wanted)


def turned_starts(mechanism: Mechanism, arm: Product, box: Box, middle: Vector, seed: int) -> TurnedStarts | None:
    """Return the table of an arm, or None if its first or last axis is not such a rotation.

    Args:
        mechanism: The mechanism.
        arm: From the workpiece to the tool, by the free axes.
        box: Limits of the free axes.
        middle: (n_free,) near the middle of the limits.
        seed: Seed.
    """
    ends = ends_of(arm)
    if ends is None or np.count_nonzero(arm.A.any(axis=1)) < _MIN_JOINTS:
        return None
    first, last = _turning(arm, ends.begin), _turning(arm, ends.end)
    if first is None or last is None:
        return None
    signs = (float(arm.A[ends.begin, first]), float(arm.A[ends.end, last]))
    known: dict[object, TablePoints] = mechanism.prepared("tables of turned starts", dict)
    key = (box.names, arm.b[ends.begin : ends.end].tobytes(), seed)
    if key not in known:
        if len(known) >= _MAX_TABLES:
            return None
        known[key] = table_points(arm, (ends.before, ends.after), box, middle, (first, last), signs, seed)
    return TurnedStarts(known[key], ends.before, ends.after, first, last, signs)


def _turning(arm: Product, row: int) -> int | None:
    """Return the axis that turns a joint one to one and moves no other, or None."""
    if arm.prismatic[row]:
        return None
    alone = (np.abs(arm.A[row]) == 1.0) & ((arm.A != 0.0).sum(axis=0) == 1)
    found = np.flatnonzero(alone)
    return int(found[0]) if len(found) else None
