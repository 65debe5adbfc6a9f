"""Arms of six rotary joints as screws: as drawn, calibrated (lengths and angles a little off), rounded, at random."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from chainbuild.ik.branches.core.serial import Screw, Serial

Step = tuple[Sequence[float], Sequence[float]]  # shift [m], then fixed angles about x, y, z [rad]; then a turn about z

_RIGHT: Final = math.pi / 2.0
_BEND: Final = math.pi / 3.0


def _dh(rows: Sequence[tuple[float, float, float]]) -> list[Step]:
    """Return the steps of Denavit–Hartenberg rows (a, d, alpha): one before each joint, and the tool's."""
    steps: list[Step] = [((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))]
    steps += [((a, 0.0, d), (alpha, 0.0, 0.0)) for a, d, alpha in rows]
    return steps


DRAWN: Final[dict[str, list[Step]]] = {
    "ur5": _dh([
        (0, 0.089159, _RIGHT), (-0.425, 0, 0), (-0.39225, 0, 0), (0, 0.10915, _RIGHT), (0, 0.09465, -_RIGHT),
        (0, 0.0823, 0),
    ]),
    "kr6": _dh([
        (0.025, 0.4, -_RIGHT), (0.455, 0, 0), (0.035, 0, -_RIGHT), (0, 0.42, _RIGHT), (0, 0, -_RIGHT), (0, 0.08, 0),
    ]),
    "irb120": _dh([
        (0, 0.29, -_RIGHT), (0.27, 0, 0), (0.07, 0, -_RIGHT), (0, 0.302, _RIGHT), (0, 0, -_RIGHT), (0, 0.072, 0),
    ]),
    "jaco": _dh([
        (0, 0.2755, _RIGHT), (0.41, 0, math.pi), (0, -0.0098, _RIGHT), (0, -0.2501, _BEND), (0, -0.0856, _BEND),
        (0, -0.2028, math.pi),
    ]),
    "crx": _dh([
        (0, 0.245, -_RIGHT), (0.71, 0, math.pi), (0, 0, -_RIGHT), (0, -0.54, _RIGHT), (0, 0.15, -_RIGHT),
        (0, -0.16, math.pi),
    ]),
    "gofa": _dh([
        (0, 0.265, -_RIGHT), (0.444, 0, 0), (0.11, 0, -_RIGHT), (0, 0.47, _RIGHT), (0.08, 0, -_RIGHT), (0, 0.101, 0),
    ]),
    "sixteen": _dh([
        (0.3, 0, _RIGHT), (1, 0, math.radians(1)), (0, 0.2, _RIGHT), (1.5, 0, math.radians(1)), (0, 0, _RIGHT),
        (0, 0, math.radians(1)),
    ]),
    "spun": _dh([
        (0.05, 0.3, -_RIGHT), (0.4, 0, 0), (0.35, 0, 0), (0.04, 0.1, _RIGHT), (0, 0.12, -_RIGHT), (0.06, 0.15, 0.3),
    ]),
}  # fmt: skip


def arm_of(steps: Sequence[Step]) -> Serial:
    """Return the screws of joints about z between steps."""
    T, screws = np.eye(4), []
    for n, (shift, angles) in enumerate(steps):
        step = np.eye(4)
        step[:3, :3], step[:3, 3] = Rotation.from_euler("xyz", angles).as_matrix(), shift
        # The shift of a Denavit–Hartenberg row comes first, its twist after.
        T = T @ step
        if n < len(steps) - 1:
            screws.append(Screw("revolute", T[:3, 2].copy(), T[:3, 3].copy(), n))
    return Serial(tuple(screws), T)


def calibrated(
    steps: Sequence[Step], rng: np.random.Generator, length: float = 1e-3, angle: float = math.radians(0.1)
) -> list[Step]:
    """Return steps with all lengths off by a share of the arm's size and all angles off [rad]."""
    size = max(abs(number) for shift, _ in steps for number in shift)
    return [
        (
            [float(number) + size * length * rng.uniform(-1.0, 1.0) for number in shift],
            [float(number) + angle * rng.uniform(-1.0, 1.0) for number in angles],
        )
        for shift, angles in steps
    ]


def rounded(steps: Sequence[Step], digits: int) -> list[Step]:
    """Return steps whose angles keep only some digits behind the point, as files write them."""
    return [(shift, [round(float(number), digits) for number in angles]) for shift, angles in steps]


def at_random(rng: np.random.Generator) -> Serial:
    """Return an arm in no order at all."""
    screws = []
    for n in range(6):
        direction = rng.normal(size=3)
        screws.append(Screw("revolute", direction / np.linalg.norm(direction), rng.normal(size=3), n))
    M = np.eye(4)
    M[:3, :3], M[:3, 3] = Rotation.random(random_state=rng).as_matrix(), rng.normal(size=3)
    return Serial(tuple(screws), M)
