"""The branches of `formulas` as machine code, in one loop without a jump, then in the order of `ik_all`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, Final
from zlib import crc32

import numpy as np

from chainbuild.ik.branches.planar import formulas
from chainbuild.ik.branches.planar.formulas import arm_rows, every_branch_of
from chainbuild.ik.branches.vectors import compiled as vectors
from chainbuild.ik.branches.vectors import operands
from chainbuild.ik.branches.vectors.compiled import LANE, compile_formulas, lane
from chainbuild.ik.branches.vectors.operands import BRANCHES
from chainbuild.ik.search.compiled import kernels as compiled_kernels
from chainbuild.ik.search.compiled.entries import kept_jit
from chainbuild.ik.search.compiled.kernels import FAST, jit, leaf

_FORMULAS: Final = (
    "arm_rows", "every_branch_of", "nearest_rotation", "seen_from_axes", "first_angles", "chosen", "fifth_angles",
    "links", "turned_back", "completed", "among_limits", "is_confirmed", "missed",
)  # fmt: skip
_FINGERPRINT: Final = crc32(
    b"".join(Path(str(m.__file__)).read_bytes() for m in (formulas, operands, vectors, compiled_kernels))
)

compile_formulas(formulas, _FORMULAS)
_lane = lane(every_branch_of, arm_rows)


@leaf
def _write_distances(found, wanted, far):
    """Write the squared distances to the start of every branch of a lane."""
    for slot in range(BRANCHES):
        x0, x1, x2, x3, x4, x5 = wanted[0], wanted[1], wanted[2], wanted[3], wanted[4], wanted[5]
        for i in range(LANE):
            at = slot * 6 * LANE + i
            far[slot * LANE + i] = (
                (found[at] - x0) ** 2 + (found[at + LANE] - x1) ** 2 + (found[at + 2 * LANE] - x2) ** 2
                + (found[at + 3 * LANE] - x3) ** 2 + (found[at + 4 * LANE] - x4) ** 2 + (found[at + 5 * LANE] - x5) ** 2
            )  # fmt: skip


@leaf
def _write_sorted(found, far, i, order, axes):
    """Write the branches of a pose in a lane, nearest to the start first; return how many, -1 where there is doubt."""
    count = 0
    for slot in range(BRANCHES):
        apart = far[slot * LANE + i]
        if math.isinf(apart):
            return -1
        if not math.isfinite(apart):
            continue
        place = count
        while place > 0 and far[order[place - 1] * LANE + i] > apart:
            order[place] = order[place - 1]
            place -= 1
        order[place] = slot
        count += 1
    for place in range(count):
        at = order[place] * 6 * LANE + i
        for n in range(6):
            axes[place, n] = found[at + n * LANE]
    for place in range(count, BRANCHES):
        for n in range(6):
            axes[place, n] = np.nan
    return count


@jit
def _block(poses, constants, wanted, axes, counts):
    """Find the branches of poses, lane by lane."""
    found, far, order = np.zeros(6 * BRANCHES * LANE), np.empty(BRANCHES * LANE), np.empty(BRANCHES, np.int64)
    for first in range(0, len(poses), LANE):
        last = min(first + LANE, len(poses))
        _lane(poses[first:last], constants, found)
        _write_distances(found, wanted, far)
        for i in range(last - first):
            counts[first + i] = _write_sorted(found, far, i, order, axes[first + i])


def _every_branch(fingerprint: int) -> Any:
    @kept_jit(nogil=True, **FAST)
    def write_planar_branches(poses, constants, wanted, axes, counts):
        """Find the branches of poses; threads share them, see `on_all_cores`.

        Args:
            poses: (N, 4, 4) tool in the workpiece frame [m].
            constants: (n, 6), see `formulas.PLANAR_ROWS`.
            wanted: (6,) axis values at the start, mm and degrees.
            axes: (N, 8, 6) out: axis values, mm and degrees, nearest to the start first; NaN where there is none.
            counts: (N,) out: how many branches, -1 where there is doubt.
        """
        if fingerprint >= 0:
            _block(poses, constants, wanted, axes, counts)

    return write_planar_branches


write_planar_branches: Final = _every_branch(_FINGERPRINT)
