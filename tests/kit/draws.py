"""What is drawn at random: seeds from names, axis values within limits, directions."""

from __future__ import annotations

import zlib

import numpy as np

from chainbuild.chain.elements import Chain
from chainbuild.robot import Robot


def seed_of(*parts: object) -> int:
    """Return a seed that is the same in every run."""
    return zlib.crc32(repr(parts).encode())


def random_axes(machine: Robot | Chain, rng: np.random.Generator) -> np.ndarray:
    """Return axis values anywhere within the limits."""
    lower = np.array([axis.lower for axis in machine.axes])
    upper = np.array([axis.upper for axis in machine.axes])
    return lower + (upper - lower) * rng.random(len(lower))


def unit(rng: np.random.Generator) -> np.ndarray:
    """Return a direction in space."""
    v = rng.normal(size=3)
    return v / np.linalg.norm(v)
