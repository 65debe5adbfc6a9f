"""All branches of many poses at once: arms with three parallel axes."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.arrays import Integers, Matrices, Matrix
from chainbuild.ik.branches.planar.constants import planar_constants
from chainbuild.ik.branches.planar.formulas import arm_rows, every_branch_of
from chainbuild.ik.branches.vectors.axes import AXIS_ROWS
from chainbuild.ik.branches.vectors.operands import BRANCHES
from chainbuild.ik.branches.vectors.rows import chunks, has_other_last_row, on_cores, refuse_what_is_not_rigid
from chainbuild.ik.search.compiled import packing
from chainbuild.kinematics.mechanism import Mechanism

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

        on_cores(
            lambda part: write_planar_branches(targets[part], constants, constants[_WANTED], axes[part], counts[part]),
            len(targets),
        )
    else:
        for part in chunks(len(targets)):
            axes[part], counts[part] = _sorted_branches(targets[part], constants)
    # Where a branch is confirmed the rotation is one.
    refuse_what_is_not_rigid(targets, np.flatnonzero((counts <= 0) | has_other_last_row(targets)))
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
