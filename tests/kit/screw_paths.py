"""Singular functions along paths by products of exponentials, and their zeros by dense search.

All that is known of a robot are one pose and one Jacobian of it, and which of its axes are which. Nothing of
`chainbuild.analysis` is used.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from chainbuild.robot import Robot

Array = np.ndarray
SAMPLES = 601  # a block: functions of degree 1 in three joints that turn by some revolutions a block


def skew(v: Array) -> Array:
    """Return the matrices (…, 3, 3) of the cross products with vectors (…, 3)."""
    z = np.zeros(v.shape[:-1])
    x, y, w = v[..., 0], v[..., 1], v[..., 2]
    rows = [np.stack(row, -1) for row in ((z, -w, y), (w, z, -x), (-y, x, z))]
    return np.stack(rows, -2)


def turning(axis: Array, angle: Array) -> Array:
    """Return the rotations (n, 3, 3) about a unit axis (3,) by angles (n,) [rad]."""
    K = skew(axis)
    s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.eye(3) + s * K + (1.0 - c) * (K @ K)


@dataclass(frozen=True, slots=True)
class Screws:
    """A robot whose axes turn or shift one after the other, all before the tool.

    Attributes:
        mixed: (n, n) joint values of axis values, mm and degrees, against `home`.
        home: (n,) axis values at which the lines were read.
        turns: (n,) whether a joint turns.
        directions: (n, 3) of the joints at `home`.
        points: (n, 3) of their lines [m].
        tip: (3,) the tool point at `home` [m].
        tool: (3, 3) its orientation.
    """

    mixed: Array
    home: Array
    turns: Array
    directions: Array
    points: Array
    tip: Array
    tool: Array

    @classmethod
    def of(cls, robot: Robot) -> Screws:
        """Read the lines of a robot at one position; axes that drive several joints are told apart."""
        home = np.array([7.0, -31.0, 43.0, 17.0, 29.0, -11.0, 5.0, 3.0][: len(robot.axes)])
        T, J = robot.fk(home).homogeneous, robot.jacobian(home)
        turns = np.array([axis.kind == "rotary" for axis in robot.axes])
        mixed = np.asarray(robot.chain.axis_map.dq_daxes(home))  # joint over axis, SI
        scale = np.where(turns, np.pi / 180.0, 1e-3)
        J = J @ np.linalg.inv(mixed)
        w, v = T[:3, :3] @ J[3:], T[:3, :3] @ J[:3]
        directions = np.where(turns, w, v).T
        points = np.where(turns[:, None], T[:3, 3] + np.cross(w.T, v.T), 0.0)
        return cls(mixed * scale, home, turns, directions, points, T[:3, 3], T[:3, :3])

    def lines(self, axes: Array) -> tuple[Array, Array, Array, Array]:
        """Return directions and points (n, joints, 3), tip (n, 3) and tool (n, 3, 3) at axis values (n, n_axes)."""
        q = (axes - self.home) @ self.mixed.T
        R, p = np.broadcast_to(np.eye(3), (len(q), 3, 3)), np.zeros((len(q), 3))
        directions, points = [], []
        for n in range(q.shape[1]):
            directions.append(R @ self.directions[n])
            points.append(R @ self.points[n] + p)
            if self.turns[n]:
                G = turning(self.directions[n], q[:, n])
                p = p + np.einsum("nij,nj->ni", R, self.points[n] - G @ self.points[n])
                R = R @ G
            else:
                p = p + q[:, n, None] * (R @ self.directions[n])
        return np.stack(directions, 1), np.stack(points, 1), R @ self.tip + p, R @ self.tool


def crossed(a: Array, b: Array) -> Array:
    return np.cross(a, b)


def dot(a: Array, b: Array) -> Array:
    return np.einsum("ni,ni->n", a, b)


def meeting(p: Array, a: Array, o: Array, b: Array) -> Array:
    """Return where lines p + s·a and o + t·b (n, 3) meet."""
    n = crossed(a, b)
    s = dot(crossed(o - p, b), n) / dot(n, n)
    return p + s[:, None] * a


@dataclass(frozen=True, slots=True)
class ArmOracle:
    """The three singular functions of a six-axis arm with a wrist whose lines meet in a point."""

    screws: Screws
    first: int = 0  # joint that turns the arm

    def values(self, kind: str, axes: Array) -> Array:
        """Return a function (n,) at axis values, signed, shoulder in metres."""
        a, p, _, _ = self.screws.lines(axes)
        a1, a2, _, a4, a5, a6 = (a[:, self.first + n] for n in range(6))
        p1, p2, p3, _, p5, p6 = (p[:, self.first + n] for n in range(6))
        if kind == "wrist":
            four, six = crossed(a4, a5), crossed(a5, a6)
            return dot(a4, six) / np.linalg.norm(four, axis=1) / np.linalg.norm(six, axis=1)
        W = meeting(p6, a6, p5, a5)
        if kind == "shoulder":
            return dot(a2, crossed(a1, W - p1))
        upper, fore = p3 - p2, W - p3
        upper, fore = upper - dot(upper, a2)[:, None] * a2, fore - dot(fore, a2)[:, None] * a2
        return dot(a2, crossed(upper, fore)) / np.linalg.norm(upper, axis=1) / np.linalg.norm(fore, axis=1)


Function = Callable[[Array], Array]


@dataclass(frozen=True, slots=True)
class Blocks:
    """Straight blocks of axis values: begins and ends (n, n_axes)."""

    begins: Array
    ends: Array

    def axes(self, block: Array, t: Array) -> Array:
        return self.begins[block] + t[:, None] * (self.ends[block] - self.begins[block])

    def rows(self) -> Array:
        """Return them as one path: rows 3n and 3n + 1 are block n, a gap follows."""
        gap = np.full_like(self.begins, np.nan)
        return np.stack([self.begins, self.ends, gap], 1).reshape(-1, self.begins.shape[1])


def dense(value: Function, blocks: Blocks, samples: int = SAMPLES) -> Array:
    """Return a function (n, samples) evenly along blocks."""
    t = np.linspace(0.0, 1.0, samples)
    found = np.empty((len(blocks.begins), samples))
    for n in range(0, len(found), 100):
        some = np.arange(n, min(n + 100, len(found)))
        index = np.repeat(some, samples)
        found[some] = value(blocks.axes(index, np.tile(t, len(some)))).reshape(len(some), samples)
    return found


def dense_zeros(value: Function, blocks: Blocks, samples: int = SAMPLES) -> list[tuple[int, float]]:
    """Return (block, share) of every change of sign, in order; extrema between samples are refined first."""
    f, t = dense(value, blocks, samples), np.linspace(0.0, 1.0, samples)
    block, n = np.nonzero(np.sign(f[:, 1:]) != np.sign(f[:, :-1]))
    brackets = [(block, t[n], t[n + 1])]
    # A pair of zeros between samples: an extremum towards 0 whose sign differs once it is refined.
    g = np.abs(f)
    inner = (g[:, 1:-1] <= g[:, :-2]) & (g[:, 1:-1] <= g[:, 2:])
    inner &= (np.sign(f[:, 1:-1]) == np.sign(f[:, :-2])) & (np.sign(f[:, 1:-1]) == np.sign(f[:, 2:]))
    block, n = np.nonzero(inner)
    if len(block):
        sign = np.sign(f[block, n + 1])
        low, high = t[n], t[n + 2]
        for _ in range(60):
            a, b = low + (high - low) / 3.0, high - (high - low) / 3.0
            left = sign * value(blocks.axes(block, a)) < sign * value(blocks.axes(block, b))
            low, high = np.where(left, low, a), np.where(left, b, high)
        turn = (low + high) / 2.0
        pair = sign * value(blocks.axes(block, turn)) < 0.0
        brackets += [(block[pair], t[n[pair]], turn[pair]), (block[pair], turn[pair], t[n[pair] + 2])]
    block, low, high = (np.concatenate(part) for part in zip(*brackets, strict=True))
    if not len(block):
        return []
    sign = np.sign(value(blocks.axes(block, low)))
    for _ in range(50):
        middle = (low + high) / 2.0
        same = np.sign(value(blocks.axes(block, middle))) == sign
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return sorted(zip(block.tolist(), ((low + high) / 2.0).tolist(), strict=True))


def pole_sine(robot: Robot) -> Function:
    """Return the sine of the last rotary axis from its pole, signed, for a head or table whose pole is at one value.

    Read from Jacobians: the first rotary axis moves the tool direction by the sine of the angle between both, which is
    even in the other axis.
    """
    first, last = [n for n, axis in enumerate(robot.axes) if axis.kind == "rotary"]
    column = robot.chain.tool_column
    grid = np.zeros((2, len(robot.axes)))
    grid[1] = 50.0
    counts = []
    for moving, other in ((first, last), (last, first)):
        swing = [np.linalg.norm(np.delete(robot.jacobian(row)[3:, other], column)) for row in grid]
        counts.append((abs(swing[1] - swing[0]), moving))
    bending = max(counts)[1]
    other = first if bending == last else last
    angles = np.radians(np.arange(0.0, 360.0, 30.0))
    squares = []
    for angle in angles:
        row = np.zeros(len(robot.axes))
        row[bending] = np.degrees(angle)
        squares.append(1.0 - float(robot.jacobian(row)[3 + column, other]) ** 2)
    # sin²(x - x0) = (1 - cos 2(x - x0)) / 2: both axes are at right angles
    second = np.mean(np.array(squares) * np.exp(-2j * angles))
    pole = np.angle(-np.conj(second)) / 2.0
    assert np.abs(np.sin(angles - pole) ** 2 - squares).max() < 1e-12
    return lambda axes: np.sin(np.radians(axes[:, bending]) - pole)


def touching(
    value: Function, limits: tuple[Array, Array], rng: np.random.Generator, count: int, depth: float
) -> tuple[Blocks, Array]:
    """Return blocks along which |value| has a least value `depth` with the sign of the rest (negative: crossed).

    Args:
        value: A function of axes A2 and A3.
        limits: Of the axes.
        rng: Where numbers come from.
        count: Number of blocks.
        depth: The least value; below 0 the function changes its sign and comes back.
    """
    found: list[tuple[Array, Array, Array]] = []
    while sum(len(part[2]) for part in found) < count:
        axes = rng.uniform(*limits, (3 * count, len(limits[0])))
        way = rng.uniform(-60.0, 60.0, axes.shape)
        sign = np.where(_second(value, axes, way) > 0.0, 1.0, -1.0)
        for _ in range(25):
            miss = _touch(value, axes, way, sign * depth)
            J = np.empty((len(axes), 2, 2))
            for k in (1, 2):
                moved = axes + 1e-3 * np.eye(axes.shape[1])[k]
                J[:, :, k - 1] = (_touch(value, moved, way, sign * depth) - miss) / 1e-3
            J += 1e-14 * np.eye(2)
            axes[:, [1, 2]] += np.clip(np.linalg.solve(J, -miss[:, :, None])[:, :, 0], -5.0, 5.0)
        miss = np.abs(_touch(value, axes, way, sign * depth))
        good = (sign * _second(value, axes, way) > 0.05) & (miss[:, 0] < 1e-14) & (miss[:, 1] < 1e-11)
        good &= np.abs(axes).max(axis=1) < 720.0
        share = rng.uniform(0.2, 0.8, len(axes))
        found.append(((axes - share[:, None] * way)[good], (axes + (1.0 - share)[:, None] * way)[good], share[good]))
    begins, ends, shares = (np.concatenate(part)[:count] for part in zip(*found, strict=True))
    return Blocks(begins, ends), shares


def _second(value: Function, axes: Array, way: Array) -> Array:
    h = 0.05
    found: Array = (value(axes + h * way) - 2.0 * value(axes) + value(axes - h * way)) / h**2
    return found


def _touch(value: Function, axes: Array, way: Array, wanted: Array) -> Array:
    """Return (n, 2) what an extremum of a wanted value misses: value and slope, a difference of fourth order."""
    h = 1e-2
    f = [value(axes + k * h * way) for k in (-2, -1, 1, 2)]
    return np.stack([value(axes) - wanted, (f[0] - 8.0 * f[1] + 8.0 * f[2] - f[3]) / (12.0 * h)], axis=1)
