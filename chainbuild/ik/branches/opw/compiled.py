"""The branches of `formulas` as machine code, in one loop without a jump; see `vectors.compiled`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, Final
from zlib import crc32

import numpy as np

from chainbuild.ik.branches.core import subproblems
from chainbuild.ik.branches.opw import formulas as opw_branches
from chainbuild.ik.branches.opw.formulas import all_branches, constant_rows
from chainbuild.ik.branches.vectors import compiled as vectors
from chainbuild.ik.branches.vectors import operands
from chainbuild.ik.branches.vectors.compiled import LANE, compile_formulas, lane
from chainbuild.ik.search.compiled import kernels as compiled_kernels
from chainbuild.ik.search.compiled.entries import kept_jit
from chainbuild.ik.search.compiled.kernels import FAST, jit

_FORMULAS: Final = (
    "constant_rows", "all_branches", "upper_branches", "shoulders", "elbows", "in_range", "both_elbows", "wrist_angles",
    "flipped", "finished", "confirmed",
)  # fmt: skip
_FINGERPRINT: Final = crc32(
    b"".join(
        Path(str(m.__file__)).read_bytes() for m in (opw_branches, operands, vectors, subproblems, compiled_kernels)
    )
)

compile_formulas(opw_branches, _FORMULAS)


_lane = lane(all_branches, constant_rows)


@jit
def _block(poses, constants, axes, doubtful):
    """Find the branches of poses, lane by lane; intermediate data fit into the processor's nearest cache."""
    found = np.empty(48 * LANE)
    for first in range(0, len(poses), LANE):
        last = min(first + LANE, len(poses))
        _lane(poses[first:last], constants, found)
        for i in range(last - first):
            none = True
            for n in range(48):
                axes[first + i, n] = found[n * LANE + i]
                none &= not math.isfinite(found[n * LANE + i])
            T = poses[first + i]
            doubtful[first + i] = none or T[3, 0] != 0.0 or T[3, 1] != 0.0 or T[3, 2] != 0.0 or T[3, 3] != 1.0


def _all_branches(fingerprint: int) -> Any:
    @kept_jit(nogil=True, **FAST)
    def write_branches(poses, constants, axes, doubtful):
        """Find the branches of poses; threads share them, see `on_all_cores`.

        Args:
            poses: (N, 4, 4) tool in the workpiece frame [m].
            constants: (n, 6), see `opw_branches.CONSTANTS`.
            axes: (N, 48) out: eight times six axis values, mm and degrees; see `opw_branches.finished`.
            doubtful: (N,) out: True where no branch confirms a pose or its last row is not 0 0 0 1.
        """
        if fingerprint >= 0:
            _block(poses, constants, axes, doubtful)

    return write_branches


write_branches: Final = _all_branches(_FINGERPRINT)
