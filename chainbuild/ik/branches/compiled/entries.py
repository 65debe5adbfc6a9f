"""Entry points of compiled closed forms: one pose, and many on all cores.

Each form has its own, so that nobody waits for the compilation of another. numba keeps the code of an entry point by
what it closes over; a form among that would never be found again: forms are globals, their files in the fingerprint.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final
from zlib import crc32

import numba
import numpy as np

from chainbuild import tolerances
from chainbuild.ik.branches.compiled import constants as form_constants
from chainbuild.ik.branches.compiled import direct, finish, small, spherical
from chainbuild.ik.branches.compiled.constants import DOUBTFUL, REFUSED
from chainbuild.ik.branches.compiled.finish import axes_of, finished, room_of
from chainbuild.ik.branches.core import branches
from chainbuild.ik.search.compiled import kernels as compiled_kernels
from chainbuild.ik.search.compiled import search as compiled_search
from chainbuild.ik.search.compiled.entries import kept_jit
from chainbuild.ik.search.compiled.kernels import FAST, jit
from chainbuild.ik.search.compiled.search import is_rigid

_ROWS: Final = 32  # joint values that a form may write: twice as many as six joints have branches
_BLOCK: Final = 64  # poses that one core takes at a time
_FILES: Final = (
    small,
    finish,
    form_constants,
    spherical,
    direct,
    branches,
    compiled_kernels,
    compiled_search,
    tolerances,
)
_FINGERPRINT: Final = crc32(b"".join(Path(str(module.__file__)).read_bytes() for module in _FILES))


@jit
def _one(solve, constants, data, sizes, target, x0, rigid, out):
    """Write the branches of a pose; return how many there are, DOUBTFUL or REFUSED.

    Args:
        solve: The form.
        constants: Its constants.
        data: The axes in one array,
        sizes: and their sizes, see `axes_of`.
        target: (4, 4) tool in the workpiece frame [m].
        x0: (n,) start in SI; held axes have their values.
        rigid: Permitted deviation of a matrix from a rotation.
        out: (·, n + 4) out, see `finished`.
    """
    if not is_rigid(target, rigid):
        return REFUSED
    axes, values = axes_of(data, sizes), np.empty((_ROWS, 6))
    count, sure = solve(constants, target, values)
    if not sure:
        return DOUBTFUL
    kept, sure = finished(axes, room_of(axes), target, x0, values, count, out)
    return kept if sure else DOUBTFUL


@jit
def _some(solve, constants, data, sizes, targets, x0, rigid, found, counts):
    """Write the branches of poses (N, 4, 4) to found (N, ·, n), SI, and what `_one` returns to counts (N,).

    Where there are more branches than room, counts says DOUBTFUL.
    """
    axes = axes_of(data, sizes)
    room, values, out = room_of(axes), np.empty((_ROWS, 6)), np.empty((_ROWS, len(x0) + 4))
    for i in range(len(targets)):
        if not is_rigid(targets[i], rigid):
            counts[i] = REFUSED
            continue
        counts[i] = DOUBTFUL
        count, sure = solve(constants, targets[i], values)
        if not sure:
            continue
        kept, sure = finished(axes, room, targets[i], x0, values, count, out)
        if sure and kept <= found.shape[1]:
            counts[i] = kept
            for r in range(kept):
                for m in range(len(x0)):
                    found[i, r, m] = out[r, m]


def _spherical(fingerprint: int) -> tuple[Any, Any]:
    @kept_jit(**FAST)
    def spherical_one(constants, data, sizes, target, x0, rigid, out):
        return _one(spherical.spherical_branches, constants, data, sizes, target, x0, rigid, out) + 0 * fingerprint

    @kept_jit(parallel=True, **FAST)
    def spherical_many(constants, data, sizes, targets, x0, rigid, found, counts):
        for n in numba.prange((len(targets) + _BLOCK - 1) // _BLOCK + 0 * fingerprint):
            part = slice(np.int64(n) * _BLOCK, min((np.int64(n) + 1) * _BLOCK, len(targets)))
            _some(
                spherical.spherical_branches,
                constants,
                data,
                sizes,
                targets[part],
                x0,
                rigid,
                found[part],
                counts[part],
            )

    return spherical_one, spherical_many


def _direct(fingerprint: int) -> tuple[Any, Any]:
    @kept_jit(**FAST)
    def direct_one(constants, data, sizes, target, x0, rigid, out):
        return _one(direct.direct_branches, constants, data, sizes, target, x0, rigid, out) + 0 * fingerprint

    @kept_jit(parallel=True, **FAST)
    def direct_many(constants, data, sizes, targets, x0, rigid, found, counts):
        for n in numba.prange((len(targets) + _BLOCK - 1) // _BLOCK + 0 * fingerprint):
            part = slice(np.int64(n) * _BLOCK, min((np.int64(n) + 1) * _BLOCK, len(targets)))
            _some(direct.direct_branches, constants, data, sizes, targets[part], x0, rigid, found[part], counts[part])

    return direct_one, direct_many


# Form → its entry points for one pose and for many.
ENTRIES: Final = {"spherical": _spherical(_FINGERPRINT), "direct": _direct(_FINGERPRINT)}
