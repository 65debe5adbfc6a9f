"""Many poses: on all cores by compiled formulas, in pieces by NumPy, and refused by number."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Indices, Matrices
from chainbuild.frames import rigid_rows
from chainbuild.ik.search.batch import at_row
from chainbuild.ik.search.compiled.cores import on_all_cores
from chainbuild.ik.search.solver import refusal

_PART: Final = 1024  # poses that one core takes at a time
_ALONE: Final = 8192  # fewer poses are left to one core: waking another that is busy can take milliseconds
_CHUNK: Final = 2048  # poses at a time: their data stay in the processor's cache
_LAST_ROW: Final = (0.0, 0.0, 0.0, 1.0)  # of a rigid transform


def on_cores(write: Callable[[slice], object], count: int) -> None:
    """Call a function for all parts of some poses, at once on all cores where that is worth it."""
    on_all_cores(write, count, _PART if count >= _ALONE else _ALONE)


def chunks(count: int) -> Iterator[slice]:
    """Yield the parts of some poses that NumPy takes at a time."""
    for first in range(0, count, _CHUNK):
        yield slice(first, first + _CHUNK)


def has_other_last_row(targets: Matrices) -> NDArray[np.bool_]:
    """Return which poses (n, 4, 4) do not end with 0 0 0 1, which no formula reads."""
    return np.asarray((targets[:, 3] != _LAST_ROW).any(axis=1), dtype=bool)


def refuse_what_is_not_rigid(targets: Matrices, doubtful: Indices) -> None:
    """Raise for the first pose that is not a rigid transform; only poses without a confirmed branch are checked."""
    for part in chunks(len(doubtful)):
        rows = doubtful[part]
        good = rigid_rows(targets[rows])
        if not good.all():
            row = int(rows[np.argmin(good)])
            raise at_row(refusal(targets[row]), row)
