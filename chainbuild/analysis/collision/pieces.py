"""The way of a tip along lines, cut into pieces along which the axes are nearly straight."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.analysis.path.motion import PathMotion, motion_of
from chainbuild.arrays import Matrix, Vector
from chainbuild.kinematics.mechanism import Mechanism

_STRAIGHT: Final = 1e-4  # rad, m: off the straight line in the middle of a piece; a tenth of a millimetre at 1 m
_COARSEST: Final = 8  # pieces a block at least: a bend that the middle does not show is seen by others
_FINEST: Final = 512  # pieces a block at most: next to a singularity axes turn over at once
_BLOCKS: Final = 256  # cut at a time: the first contact is found before a long path is all solved for


@dataclass(frozen=True, slots=True, eq=False)
class LinePieces:
    """A part of a block cut into pieces.

    Attributes:
        block: The block, by its first row from 0.
        shares: (n,) shares of the block at the ends of the pieces.
        axes: (n, n_axes) axis values there, mm and degrees.
    """

    block: int
    shares: Vector
    axes: Matrix


def line_pieces(robot: Mechanism, rows: Matrix) -> Iterator[LinePieces]:
    """Yield the pieces of a path, the tip on lines between its rows; parts without axis values are left out.

    Args:
        robot: The robot.
        rows: (N, n_axes) axis values, mm and degrees.
    """
    for first in range(0, len(rows) - 1, _BLOCKS):
        motion = motion_of(robot, rows[first : first + _BLOCKS + 1], "cp")
        for block in range(len(motion.rows) - 1):
            shares, axes = _cut(motion, block)
            known = np.atleast_1d(np.isfinite(axes).all(axis=1))
            ends = np.flatnonzero(known[1:] != known[:-1]) + 1
            for part in np.split(np.arange(len(shares)), ends):
                if known[part[0]] and len(part) > 1:
                    yield LinePieces(first + block, shares[part], axes[part])


def _cut(motion: PathMotion, block: int) -> tuple[Vector, Matrix]:
    """Return shares (n,) of a block and axis values (n, n_axes) there, between which the axes are nearly straight."""
    factors = motion.robot.kinematics.si_factors
    places = np.linspace(0.0, 1.0, _COARSEST + 1)
    axes = motion.axes(np.full(len(places), block), places)
    going = np.ones(_COARSEST, dtype=bool)
    for _ in range((_FINEST // _COARSEST).bit_length() - 1):
        if not going.any():
            break
        at = np.flatnonzero(going)
        middles = (places[at] + places[at + 1]) / 2.0
        found = motion.axes(np.full(len(middles), block), middles)
        off = np.abs((found - (axes[at] + axes[at + 1]) / 2.0) * factors).max(axis=1)
        # Where no axis values are found the edge of what is known is sought, too.
        one_sided = np.isnan(axes[at]).any(axis=1) != np.isnan(axes[at + 1]).any(axis=1)
        bent = (off > _STRAIGHT) | one_sided | np.isnan(found).any(axis=1)
        places, axes = np.insert(places, at + 1, middles), np.insert(axes, at + 1, found, axis=0)
        going = np.insert(going, at + 1, bent)
        going[at + np.arange(len(at))] = bent
    return places, axes
