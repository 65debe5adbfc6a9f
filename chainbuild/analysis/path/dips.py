"""The smallest singular value between rows where it is small, for pictures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from chainbuild.analysis.path.motion import motion_of
from chainbuild.analysis.path.places import PathReport, PathStretch
from chainbuild.analysis.singularity.measures import measure_batch
from chainbuild.arrays import Matrix, Vector
from chainbuild.kinematics.mechanism import Mechanism

_PLACES: Final = 96  # of a stretch: the dip of one row to the next is as smooth as a picture shows it
_LEAST: Final = 2  # of each of its blocks: a stretch over many rows is smooth enough with few


def dips_of(robot: Mechanism, rows: Sequence[Vector], report: PathReport) -> Matrix:
    """Return places (n, 2) inside stretches: row and share from 0, and the smallest singular value there, in order.

    The minima are among them. Places without axis values are left out.

    Args:
        robot: The robot.
        rows: The rows of the path.
        report: The report on it.
    """
    found = [_dip(robot, rows, report, one) for one in report.stretches if not one.of_vector]
    places = np.concatenate([np.empty((0, 2)), *found])
    return np.asarray(places[np.argsort(places[:, 0], kind="stable")])


def _dip(robot: Mechanism, rows: Sequence[Vector], report: PathReport, stretch: PathStretch) -> Matrix:
    minima = [[one.place.row + one.place.share, one.smallest] for one in stretch.minima]
    known = np.array(minima)[~np.isnan([value for _, value in minima])]
    if report.between == "rows":
        return known
    first, last = stretch.begin.row, min(stretch.end.row + 1, len(rows) - 1)
    begin, end = stretch.begin.row + stretch.begin.share, stretch.end.row + stretch.end.share
    blocks = last - first
    count = max(_PLACES // blocks, _LEAST)
    at = np.linspace(begin, end, count * blocks + 1)
    index = np.clip(np.floor(at).astype(np.intp) - first, 0, blocks - 1)
    motion = motion_of(robot, np.array(rows[first : last + 1]), report.between)
    axes = motion.axes(index, at - first - index)
    inside = np.isfinite(axes).all(axis=1)
    values = measure_batch(robot, axes[inside]).smallest
    return np.concatenate([known, np.stack([at[inside], values], axis=1)])
