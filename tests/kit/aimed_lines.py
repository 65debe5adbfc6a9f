"""Lines of the tip aimed through singularities, the branch kept, by closed forms of single poses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
import pinocchio as pin

import chainbuild
from chainbuild.robot import Robot
from tests.kit.screw_paths import ArmOracle, Array, Screws, dot, meeting

KINDS = ("wrist", "elbow", "shoulder")


def pose_between(first: Array, last: Array, t: float) -> Array:
    """Return the pose (4, 4) at a share of a line: position straight, one turn about one axis."""
    T = np.eye(4)
    T[:3, 3] = first[:3, 3] + t * (last[:3, 3] - first[:3, 3])
    T[:3, :3] = first[:3, :3] @ pin.exp3(t * pin.log3(first[:3, :3].T @ last[:3, :3]))
    return T


@dataclass(frozen=True, slots=True)
class Lines:
    """Lines of one arm: what is aimed, what is checked."""

    robot: Robot
    oracle: ArmOracle
    sizes: dict[str, float]

    @classmethod
    def of(cls, robot: Robot, shoulder_size: float) -> Lines:
        return cls(robot, ArmOracle(Screws.of(robot)), {"wrist": 1.0, "elbow": 1.0, "shoulder": shoulder_size})

    def functions(self, axes: Array) -> Array:
        """Return the three functions (n, 3) at axis values (n, 6), signed, without unit."""
        return np.stack([self.oracle.values(kind, axes) / self.sizes[kind] for kind in KINDS], axis=1)

    def onto(self, kind: str, rng: np.random.Generator) -> Array:
        """Return random axis values in one singularity and away from the others."""
        lower = np.array([max(axis.lower, -180.0) for axis in self.robot.axes])
        upper = np.array([min(axis.upper, 180.0) for axis in self.robot.axes])
        column = {"wrist": 4, "elbow": 2, "shoulder": 1}[kind]
        while True:
            axes = rng.uniform(lower, upper)
            low, high = lower[column], upper[column]
            for _ in range(9):  # grids within grids
                grid = np.repeat(axes[None], 80, axis=0)
                grid[:, column] = np.linspace(low, high, 80)
                signs = np.sign(self.oracle.values(kind, grid))
                (turn,) = np.nonzero(signs[1:] != signs[:-1])
                if not len(turn):
                    break
                axes = grid[turn[0]]
                low, high = grid[turn[0] : turn[0] + 2, column]
            if high - low > 1e-12:
                continue
            others = [n for n, one in enumerate(KINDS) if one != kind]
            if np.abs(self.functions(axes[None])[0, others]).min() > 0.2:
                return axes

    def ends(self, axes: Array, kind: str, share: float, rng: np.random.Generator) -> tuple[Array, Array]:
        """Return the poses at the ends of a random line that has the pose of axis values at a share."""
        T = self.robot.fk(axes).homogeneous
        way, turn = rng.normal(size=3), rng.normal(size=3) * rng.choice([0.0, 0.15])
        a, p, _, _ = self.oracle.screws.lines(axes[None])
        if kind == "shoulder" and abs(self.offset(axes)) > 1e-9:
            # The wrist point cannot come closer to axis 1 than its sideways offset: the line touches that cylinder.
            turn[:] = 0.0
            level = self.wrist_point(axes) - p[0, 0]
            level -= (level @ a[0, 0]) * a[0, 0]
            way -= (way @ level) * level / (level @ level)
        way *= rng.uniform(0.02, 0.15) / np.linalg.norm(way)
        first, last = T.copy(), T.copy()
        first[:3, 3] -= share * way
        last[:3, 3] += (1.0 - share) * way
        first[:3, :3] = T[:3, :3] @ pin.exp3(-share * turn)
        last[:3, :3] = T[:3, :3] @ pin.exp3((1.0 - share) * turn)
        return first, last

    def wrist_point(self, axes: Array) -> Array:
        a, p, _, _ = self.oracle.screws.lines(axes[None])
        return meeting(p[:, 5], a[:, 5], p[:, 4], a[:, 4])[0]

    def offset(self, axes: Array) -> float:
        """Return the offset of the wrist point along axis 2 from axis 1 [m]."""
        a, p, _, _ = self.oracle.screws.lines(axes[None])
        return float(dot(a[:, 1], self.wrist_point(axes)[None] - p[:, 0])[0])

    def bulging(self, rng: np.random.Generator) -> tuple[Array, Array, Array]:
        """Return axes of a stretched arm and poses at both ends of a turn that pushes its wrist point out.

        The tool points back towards the arm: turning it about the tip moves the wrist point on a circle whose farthest
        point from axis 2 is in the middle.
        """
        most = min(self.robot.axes[4].upper, 125.0)
        while True:
            axes = self.onto("elbow", rng)
            axes[4] = rng.choice([-1.0, 1.0]) * rng.uniform(100.0, most)
            values = np.abs(self.functions(axes[None])[0])
            a, p, tip, tool = (part[0] for part in self.oracle.screws.lines(axes[None]))
            W = self.wrist_point(axes)
            out, beside = W - p[1], W - tip
            out = out - (out @ a[1]) * a[1]
            out /= np.linalg.norm(out)
            axis = beside - (beside @ out) * out
            outward = float(beside @ out)
            if values[[0, 2]].min() < 0.2 or outward < 0.01 or np.linalg.norm(axis) < 0.01:
                continue
            axis /= np.linalg.norm(axis)
            turns = rng.uniform(0.3, 0.7, 2) * [-1.0, 1.0]
            T = np.eye(4)
            T[:3, :3], T[:3, 3] = tool, tip + out * rng.uniform(0.05, 0.5) * outward * (1.0 - np.cos(0.3))
            ends = []
            for turn in turns:
                ends.append(T.copy())
                ends[-1][:3, :3] = pin.exp3(turn * axis) @ tool
            return axes, *ends

    def reach(self, axes: Array) -> Callable[[Array], Array]:
        """Return how far [m] the wrist points of poses (n, 4, 4) are out of reach, at the shoulder's side of axes."""
        a, p, tip, tool = (part[0] for part in self.oracle.screws.lines(axes[None]))
        W = self.wrist_point(axes)
        plane = np.stack([np.cross(a[1], a[0]), a[0]])
        upper = np.linalg.norm(plane @ (p[2] - p[1]))
        fore = np.linalg.norm(plane @ (W - p[2]))
        h, (x, y) = self.offset(axes), plane @ (p[1] - p[0])
        own, side = tool.T @ (W - tip), np.sign(plane[0] @ (W - p[0]))

        def beyond(T: Array) -> Array:
            moved = T[:, :3, :3] @ own + T[:, :3, 3] - p[0]
            z = moved @ a[0]
            square = (moved * moved).sum(axis=1) - z * z - h * h
            distance = np.hypot(side * np.sqrt(np.maximum(square, 0.0)) - x, z - y)
            out = np.maximum(distance - upper - fore, abs(upper - fore) - distance)
            return np.where(square < 0.0, np.sqrt(np.maximum(-square, 0.0)), out)

        return beyond

    def rows(self, first: Array, last: Array, shares: Array, signs: Array, near: Array) -> Array | None:
        """Return the axes (n, 6) along a line whose functions keep their signs; None where a pose has none."""
        found = []
        for t in shares:
            known = [b.axes for b in self.robot.ik_all(pose_between(first, last, float(t)))]
            if not known:
                return None
            every = np.array(known)
            every = every[(np.sign(self.functions(every)) == signs).all(axis=1)]
            if not len(every):
                return None
            near = every[np.abs(every - near).max(axis=1).argmin()]
            found.append(near)
        return np.array(found)

    def aimed(self, kind: str, rng: np.random.Generator, count: int) -> tuple[Array, float, Array, Array]:
        """Return rows (count, 6) along a line through a singularity, its share, and the poses at the ends."""
        while True:
            axes = self.onto(kind, rng)
            share = float(rng.uniform(0.1, 0.9))
            signs = np.sign(self.functions(axes[None])[0])
            signs[KINDS.index(kind)] = rng.choice([-1.0, 1.0])
            first, last = self.ends(axes, kind, share, rng)
            rows = self.rows(first, last, np.linspace(0.0, 1.0, count), signs, axes)
            if rows is not None:
                return rows, share, first, last

    def random(self, rng: np.random.Generator, samples: int) -> tuple[Array, Array]:
        """Return two rows of a random line of one branch, and the functions (samples, 3) along it."""
        lower = np.array([max(axis.lower, -180.0) for axis in self.robot.axes])
        upper = np.array([min(axis.upper, 180.0) for axis in self.robot.axes])
        while True:
            axes = rng.uniform(lower, upper)
            signs = np.sign(self.functions(axes[None])[0])
            first, last = self.ends(axes, "wrist", 0.0, rng)
            rows = self.rows(first, last, np.linspace(0.0, 1.0, samples), signs, axes)
            if rows is not None:
                return rows[[0, -1]], self.functions(rows)


def shoulder_size(robot: Robot) -> float:
    """Return the length that scales the shoulder's function, from values of a report and the oracle's."""
    lower = np.array([max(axis.lower, -360.0) for axis in robot.axes])
    upper = np.array([min(axis.upper, 360.0) for axis in robot.axes])
    rows = np.random.default_rng(4).uniform(lower, upper, (36, len(lower)))
    rows[1::3] = rows[::3] + 0.05 * (rows[1::3] - rows[::3])  # short: few of them reach the singularity
    rows[2::3] = np.nan
    report = chainbuild.path_report(robot, rows, options=chainbuild.PathOptions(near=0.9))
    oracle = ArmOracle(Screws.of(robot))
    own = [m for s in report.stretches for m in s.minima if s.kind == "shoulder" and m.value > 0.01]
    sizes = [abs(float(oracle.values("shoulder", m.place.axes[None])[0])) / m.value for m in own]
    assert len(sizes) > 1 and np.ptp(sizes) < 1e-9 * sizes[0]
    return sizes[0]


@cache
def lines_of(name: str) -> Lines:
    """Return the lines of a shipped arm."""
    robot = Robot.load(name)
    return Lines.of(robot, shoulder_size(robot))
