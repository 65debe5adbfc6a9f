"""Starts for arms whose first axis turns the whole arm and whose last one turns the tool.

What the two can do needs no search: of the six freedoms of a pose they leave four, and a table of a thousand points
is dense in four. A point is looked up by the key of the target (see `turned_table`), moved by one Newton step towards
it, and turned: by the first axis into the plane of the target, by the last one upright.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.ik.region import Box
from chainbuild.ik.search.starts.arm_reach import ends_of
from chainbuild.ik.search.starts.turned_table import NO_RADIUS, Points, points_of
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.product import Product

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

LARGEST_STEP: Final = 0.5  # rad or m that an axis goes from its point to the start handed out

_FEWEST_JOINTS: Final = 4  # below that nothing is worth a table
_KEPT: Final = 2  # tables a robot: where axes between are held at ever other values, none is worth its making


@dataclass(frozen=True, slots=True, eq=False)
class Query:
    """What is looked up for a target.

    Attributes:
        key: (6,) its key and the key's square, in single precision.
        azimuth: Of its plane [rad].
        view: (12,) key, X and Y of W in its plane, 1.
    """

    key: NDArray[np.float32]
    azimuth: float
    view: Vector


@dataclass(frozen=True, slots=True, eq=False)
class TurnedStarts:
    """The table of an arm as it stands.

    Attributes:
        points: The table.
        before: (4, 4) F⁻¹ [m].
        after: (4, 4) E⁻¹ [m].
        first: Index of the free axis that turns the arm.
        last: Index of the one that turns the tool.
        signs: How they turn: 1 or −1.
    """

    points: Points
    before: Matrix
    after: Matrix
    first: int
    last: int
    signs: tuple[float, float]

    def query(self, target: Matrix) -> Query:
        """Return what is looked up for a target (4, 4)."""
        (a, b, dx, x), (d, e, dy, y), (g, h, dz, z), _ = self.before.dot(target).dot(self.after).tolist()
        radius = math.hypot(x, y)
        c, s = (x / radius, y / radius) if radius > NO_RADIUS else (1.0, 0.0)
        scale = self.points.scale
        key = (radius, z, scale * (c * dx + s * dy), scale * (c * dy - s * dx), scale * dz)
        planar = (c * a + s * d, c * d - s * a, g, c * b + s * e, c * e - s * b, h)
        square = radius * radius + z * z + scale * scale
        return Query(np.array((*key, square), np.float32), math.atan2(s, c), np.array((*key, *planar, 1.0)))

    def distances(self, query: Query) -> NDArray[np.float32]:
        """Return how far each point (count,) is, weighted by how much its axes have to move for it."""
        squared: NDArray[np.float32] = query.key.dot(self.points.rows)
        squared += self.points.offsets
        return squared

    def start(self, n: int, query: Query, box: Box, wanted: Vector) -> Vector | None:
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
    """Return the table of an arm, or None where its first or last axis is no such turn.

    Args:
        mechanism: The mechanism.
        arm: From the workpiece to the tool, by the free axes.
        box: Limits of the free axes.
        middle: (n_free,) near the middle of the limits.
        seed: Seed.
    """
    ends = ends_of(arm)
    if ends is None or np.count_nonzero(arm.A.any(axis=1)) < _FEWEST_JOINTS:
        return None
    first, last = _turning(arm, ends.begin), _turning(arm, ends.end)
    if first is None or last is None:
        return None
    signs = (float(arm.A[ends.begin, first]), float(arm.A[ends.end, last]))
    known: dict[object, Points] = mechanism.prepared("tables of turned starts", dict)
    key = (box.names, arm.b[ends.begin : ends.end].tobytes(), seed)
    if key not in known:
        if len(known) >= _KEPT:
            return None
        known[key] = points_of(arm, (ends.before, ends.after), box, middle, (first, last), signs, seed)
    return TurnedStarts(known[key], ends.before, ends.after, first, last, signs)


def _turning(arm: Product, row: int) -> int | None:
    """Return the axis that turns a joint one to one and moves no other, or None."""
    if arm.prismatic[row]:
        return None
    alone = (np.abs(arm.A[row]) == 1.0) & ((arm.A != 0.0).sum(axis=0) == 1)
    found = np.flatnonzero(alone)
    return int(found[0]) if len(found) else None
