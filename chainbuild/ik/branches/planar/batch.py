"""All branches of many poses at once: arms with three parallel axes."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.arrays import Integers, Matrices, Matrix
from chainbuild.frames import rigid_rows
from chainbuild.ik.branches.planar.constants import planar_constants
from chainbuild.ik.branches.planar.formulas import arm_rows, every_branch_of
from chainbuild.ik.branches.vectors.axes import AXIS_ROWS
from chainbuild.ik.branches.vectors.operands import BRANCHES
from chainbuild.ik.search.batch import at_row
from chainbuild.ik.search.compiled import packing
from chainbuild.ik.search.compiled.cores import on_all_cores
from chainbuild.ik.search.solver import refusal
from chainbuild.kinematics.mechanism import Mechanism

_PART: Final = 1024  # poses that one core takes at a time
_ALONE: Final = 8192  # fewer poses are left to one core: waking another that is busy can take milliseconds
_CHUNK: Final = 2048  # poses at a time: their data stay in the processor's cache
_LAST_ROW: Final = (0.0, 0.0, 0.0, 1.0)  # of a rigid transform
_WANTED: Final = AXIS_ROWS.index("wanted") - len(AXIS_ROWS)  # row of the constants, from behind


def planar_batch(
    mechanism: Mechanism, targets: Matrices, *, limits: bool, compiled: bool
) -> tuple[Matrices, Integers] | None:
    """Return the branches (n, 8, 6) of poses, mm and degrees, and their counts (n,).

    Those nearest to the middle of the limits stand first, NaN behind them. A count of -1 says that the pose is in
    doubt: branches nearly meet, an axis nearly has no effect or is on its limit.

    Args:
        mechanism: The mechanism.
        targets: (n, 4, 4) tool in the workpiece frame [m].
        limits: Whether the limits count.
        compiled: False: NumPy, even where numba is installed.

    Returns:
        None where the formulas do not apply to the mechanism.

    Raises:
        ChainbuildError: a pose is no rigid transform.
    """
    constants = mechanism.prepared("planar constants", lambda: planar_constants(mechanism, limits=limits), limits)
    if constants is None:
        return None
    axes, counts = np.empty((len(targets), BRANCHES, 6)), np.empty(len(targets), dtype=np.int64)
    if compiled and packing.available():
        from chainbuild.ik.branches.planar.compiled import write_planar_branches

        on_all_cores(
            lambda part: write_planar_branches(targets[part], constants, constants[_WANTED], axes[part], counts[part]),
            len(targets),
            _PART if len(targets) >= _ALONE else _ALONE,
        )
    else:
        for first in range(0, len(targets), _CHUNK):
            part = slice(first, first + _CHUNK)
            axes[part], counts[part] = _sorted_branches(targets[part], constants)
    # Where a branch is confirmed the pose is rigid.
    unconfirmed = np.flatnonzero((counts <= 0) | (targets[:, 3] != _LAST_ROW).any(axis=1))
    rigid = rigid_rows(targets[unconfirmed])
    if not rigid.all():
        row = int(unconfirmed[np.argmin(rigid)])
        raise at_row(refusal(targets[row]), row)
    return axes, counts


def _sorted_branches(targets: Matrices, constants: Matrix) -> tuple[Matrices, Integers]:
    """Return the branches of poses and their counts by NumPy; see `compiled.write_planar_branches`."""
    T = np.ascontiguousarray(targets[:, :3].transpose(1, 2, 0)).reshape(12, -1)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        axes = np.array(every_branch_of(T, arm_rows(constants))).transpose(2, 0, 1)
        far = ((axes - constants[_WANTED]) ** 2).sum(axis=2)  # not a number sorts to the end
    axes = np.take_along_axis(axes, np.argsort(far, axis=1, kind="stable")[:, :, None], axis=1)
    counts = np.where(np.isinf(axes[:, :, 0]).any(axis=1), -1, np.isfinite(axes[:, :, 0]).sum(axis=1))
    return axes, counts
