"""Arms with three parallel axes as screws: drawn at random, and as their makers give them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.assemble import Element, Fixed, Mark, Move
from chainbuild.chain.elements import Axis
from chainbuild.ik.branches.core.serial import Screw, Serial
from chainbuild.robot import Robot
from tests.kit.chains import chain_from

WRISTS: Final = ("meeting", "parallel", "apart")

# Denavit-Hartenberg rows d, a [m], alpha [deg] of makers' data sheets.
MADE: Final = {
    "UR5": ((0.089159, 0, 90), (0, -0.425, 0), (0, -0.39225, 0), (0.10915, 0, 90), (0.09465, 0, -90), (0.0823, 0, 0)),
    "UR10e": ((0.1807, 0, 90), (0, -0.6127, 0), (0, -0.57155, 0), (0.17415, 0, 90), (0.11985, 0, -90), (0.11655, 0, 0)),
    "CR5": ((0.147, 0, 90), (0, -0.427, 0), (0, -0.357, 0), (0.141, 0, 90), (0.116, 0, -90), (0.105, 0, 0)),
}  # fmt: skip


def unit(vector: Vector) -> Vector:
    """Return a vector at length 1."""
    scaled: Vector = vector / np.linalg.norm(vector)
    return scaled


def random_pose(rng: np.random.Generator) -> Matrix:
    """Return a rigid transform (4, 4)."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = Rotation.random(random_state=rng).as_matrix(), rng.normal(size=3)
    return T


def random_parallel_arm(rng: np.random.Generator, wrist: str, *, backwards: bool = False) -> Serial:
    """Return an arm in any place, with any tool and any signs.

    Args:
        rng: Where its numbers come from.
        wrist: Whether axes 5 and 6 meet, are parallel or neither.
        backwards: True: axes 3, 4 and 5 are parallel instead of 2, 3 and 4, and the wrist are axes 1 and 2.
    """
    directions = [unit(rng.normal(size=3)) for _ in range(6)]
    for n in (2, 3):
        directions[n] = directions[1] * rng.choice((-1.0, 1.0))
    points = [rng.normal(size=3) for _ in range(6)]
    if wrist == "meeting":
        points[5] = points[4] + rng.normal() * directions[4] + rng.normal() * directions[5]
    if wrist == "parallel":
        directions[5] = directions[4] * rng.choice((-1.0, 1.0))
    screws = [Screw("revolute", k, p, n) for n, (k, p) in enumerate(zip(directions, points, strict=True))]
    serial = Serial(tuple(screws), random_pose(rng))
    return serial.reversed() if backwards else serial


def made_arm(name: str) -> Serial:
    """Return an arm of `MADE`."""
    T, screws = np.eye(4), []
    for n, (d, a, alpha) in enumerate(MADE[name]):
        screws.append(Screw("revolute", T[:3, 2].copy(), T[:3, 3].copy(), n))
        step = np.eye(4)
        step[:3, :3], step[:3, 3] = Rotation.from_euler("x", alpha, degrees=True).as_matrix(), (a, 0.0, d)
        T = T @ step
    return Serial(tuple(screws), T)


def robot_of_screws(serial: Serial, limits: Sequence[tuple[float, float]] | None = None) -> Robot:
    """Return a robot whose axis values are the joint values in degrees; without limits its axes are endless."""
    axes, tool, before = [], list[Element](), np.zeros(3)
    for n, screw in enumerate(serial.screws):
        name, (lower, upper) = f"A{n + 1}", limits[n] if limits else (-180.0, 180.0)
        axes.append(Axis(name, "rotary", "deg", lower, upper, assumed=False, endless=limits is None))
        direction = (float(screw.direction[0]), float(screw.direction[1]), float(screw.direction[2]))
        tool += [Fixed(_shifted(screw.point - before)), Move(name, "revolute", direction, {name: 1.0})]
        before = screw.point
    last = serial.M.copy()
    last[:3, 3] = 1e3 * (serial.M[:3, 3] - before)
    return Robot(chain_from(axes, [*tool, Mark("flange"), Fixed(last)]))


def _shifted(shift: Vector) -> Matrix:
    T = np.eye(4)
    T[:3, 3] = 1e3 * shift
    return T


def with_signs(serial: Serial, signs: Sequence[float]) -> Serial:
    """Return an arm some axes of which count the other way."""
    screws = zip(serial.screws, signs, strict=True)
    return Serial(tuple(replace(screw, direction=sign * screw.direction) for screw, sign in screws), serial.M)


def pose_by_hand(serial: Serial, values: Vector) -> Matrix:
    """Return the pose (4, 4) of joint values (6,) by scipy's rotations."""
    T = np.eye(4)
    for screw, value in zip(serial.screws, values, strict=True):
        step = np.eye(4)
        step[:3, :3] = Rotation.from_rotvec(value * screw.direction).as_matrix()
        step[:3, 3] = screw.point - step[:3, :3] @ screw.point
        T = T @ step
    pose: Matrix = T @ serial.M
    return pose


def smallest_singular_value(serial: Serial, values: Vector) -> float:
    """Return how far joint values are from a singular position."""
    T, columns = np.eye(4), []
    for screw, value in zip(serial.screws, values, strict=True):
        moved = screw.transformed(T)
        columns.append([*np.cross(moved.point, moved.direction), *moved.direction])
        T = T @ screw.T(float(value))
    return float(np.linalg.svd(np.array(columns), compute_uv=False)[-1])


def apart(one: Vector, other: Vector) -> float:
    """Return by how much two sets of angles differ, whole turns apart [rad]."""
    return float(np.abs(2.0 * np.arcsin(np.sin((one - other) / 2.0))).max())


def solutions(serial: Serial, T: Matrix, rows: Iterable[Vector], within: float = 1e-7) -> list[Vector]:
    """Return the rows that give a pose, once each."""
    found: list[Vector] = []
    for row in rows:
        if np.abs(pose_by_hand(serial, row) - T).max() < within and all(apart(row, one) > 1e-5 for one in found):
            found.append(row)
    return found


def same_solutions(ours: Sequence[Vector], theirs: Sequence[Vector], within: float = 1e-6) -> bool:
    """Return whether two sets of solutions are the same."""
    pairs = ((ours, theirs), (theirs, ours))
    return all(any(apart(row, other) < within for other in others) for rows, others in pairs for row in rows)
