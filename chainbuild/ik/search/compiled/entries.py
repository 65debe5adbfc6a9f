"""Entry points of the compiled path, kept on disk.

numba compiles an entry point at its first call and keeps the machine code beside this file (or in the user's cache
folder), so that only the first call after an installation takes long. It detects stale code by this file and by the
variables an entry point closes over, not by the files of the functions it calls: hence the fingerprint.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final
from zlib import crc32

import numba
import numpy as np

from chainbuild import tolerances
from chainbuild.ik import rules
from chainbuild.ik.search.compiled import (
    kernels as compiled_kernels,
)
from chainbuild.ik.search.compiled import (
    limits as compiled_limits,
)
from chainbuild.ik.search.compiled import (
    search as compiled_search,
)
from chainbuild.ik.search.compiled import (
    starts as compiled_starts,
)
from chainbuild.ik.search.compiled.kernels import FAST, unpack, work_of
from chainbuild.ik.search.compiled.search import is_rigid, search, track
from chainbuild.ik.search.starts import turned as turned_starts
from chainbuild.ik.search.starts import turned as turned_table

cached_jit: Final[Any] = numba.njit(cache=True, **FAST)
cached_parallel_jit: Final[Any] = numba.njit(cache=True, parallel=True, **FAST)

_MODULES: Final = (
    compiled_kernels,
    compiled_limits,
    compiled_search,
    compiled_starts,
    rules,
    tolerances,
    turned_starts,
    turned_table,
)
_FINGERPRINT: Final = crc32(b"".join(Path(str(module.__file__)).read_bytes() for module in _MODULES))


def _search_one(fingerprint: int) -> Any:
    @cached_jit
    def search_one(data, rows, sizes, target, start, has_start, wanted, accuracy, restarts, answer):
        """Check the target, then search; see `compiled_search.search`.

        Args:
            data: The problem in one array,
            rows: but for what is in single precision.
            sizes: Its sizes, see `unpack`.
            target: (4, 4) tool in the workpiece frame.
            start: (n,) first point.
            has_start: Whether it counts.
            wanted: (n,) where whole turns shall end near to.
            accuracy: (4,) squared error, distance, angle, and how far the rotation may be from one.
            restarts: Starts after the first.
            answer: (2, n) out: the answer or the nearest, and a point outside the limits.
        """
        if fingerprint < 0 or not is_rigid(target, accuracy[3]):
            return rules.NOT_RIGID, 0, 0, np.inf, np.inf
        problem = unpack(data, rows, sizes)
        work, outside = work_of(sizes[1]), answer[1]
        return search(problem, work, target, start, has_start, wanted, accuracy, restarts, answer[0], outside)

    return search_one


def _search_many(fingerprint: int) -> Any:
    @cached_parallel_jit
    def search_many(data, rows, sizes, targets, starts, has_start, wanted, accuracy, restarts, y, counts, misses):
        """Search for many targets on all cores.

        Args:
            data: The problem in one array,
            rows: but for what is in single precision.
            sizes: Its sizes, see `unpack`.
            targets: (N, 4, 4).
            starts: (N, n) or (1, n) for all.
            has_start: Whether the starts count.
            wanted: (n,) where whole turns shall end near to without a start.
            accuracy: (4,) see `search_one`.
            restarts: Starts after the first.
            y: (N, n) out: the answers or the nearest.
            counts: (N, 3) out: outcome, steps, starts after the first.
            misses: (N, 2) out: distance and angle left.
        """
        for i in numba.prange(len(targets)):
            counts[i, 0] = rules.NOT_RIGID + 0 * fingerprint
            if is_rigid(targets[i], accuracy[3]):
                problem, work, outside = unpack(data, rows, sizes), work_of(sizes[1]), np.empty(sizes[1])
                start = starts[np.int64(i) % len(starts)]  # one for all, or one a pose
                near_to = start if has_start else wanted
                ended = search(problem, work, targets[i], start, has_start, near_to, accuracy, restarts, y[i], outside)
                counts[i, 0], counts[i, 1], counts[i, 2], misses[i, 0], misses[i, 1] = ended

    return search_many


def _track_many(fingerprint: int) -> Any:
    @cached_jit
    def track_many(data, rows, sizes, targets, last, accuracy, most, y, counts, misses):
        """Follow a path; see `compiled_search.track`."""
        if fingerprint < 0:
            return 0
        return track(unpack(data, rows, sizes), work_of(sizes[1]), targets, last, accuracy, most, y, counts, misses)

    return track_many


search_one: Final = _search_one(_FINGERPRINT)
search_many: Final = _search_many(_FINGERPRINT)
track_many: Final = _track_many(_FINGERPRINT)
