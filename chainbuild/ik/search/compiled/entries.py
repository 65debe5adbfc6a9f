"""Entry points of the compiled path, kept on disk.

numba compiles an entry point at its first call and keeps the machine code beside this file (or in the user's cache
folder), so that only the first call after an installation takes long. By itself it ends the program if no folder can be
written or if a kept file is damaged: `KeptCode` reads a folder that cannot be written, replaces damaged files, compiles
in memory otherwise, and says on stderr that it compiles.

Stale code is detected by this file and by the variables an entry point closes over, not by the files of the functions
it calls: hence the fingerprint.
"""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any, ClassVar, Final
from zlib import crc32

import numba
import numpy as np
from numba.core import event as numba_events
from numba.core.caching import CompileResultCacheImpl, FunctionCache, InTreeCacheLocator

from chainbuild import tolerances
from chainbuild.ik import rules
from chainbuild.ik.search.compiled import inner
from chainbuild.ik.search.compiled import (
    kernels as compiled_kernels,
)
from chainbuild.ik.search.compiled import (
    least_squares as compiled_least_squares,
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
from chainbuild.progress import above_bars, working


def kept_jit(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """Return a decorator that compiles a function at its first call and keeps the machine code.

    Args:
        options: Those of `numba.njit`, without `cache`.
    """

    def decorate(function: Callable[..., Any]) -> Any:
        dispatcher = numba.njit(**inner.ENTRY, **options)(function)
        dispatcher._cache = KeptCode(function)
        return dispatcher

    return decorate


class KeptCode:
    """The machine code of one function as numba asks for it; nothing here raises.

    Args:
        function: The function that is compiled.
    """

    told: ClassVar[bool] = False

    def __init__(self, function: Callable[..., Any]) -> None:
        self._own: Any = None
        with suppress(RuntimeError, OSError):  # no folder can be written
            self._own = FunctionCache(function)
        installed = _Installed(function)  # what is beside the package is read even where it cannot be written
        same = self._own is not None and self._own.cache_path == installed.cache_path
        self._read: list[Any] = [place for place in (self._own, None if same else installed) if place is not None]

    @property
    def cache_path(self) -> str | None:
        """The folder that is written, if there is one."""
        return None if self._own is None else str(self._own.cache_path)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the kept code of a signature, or None, after a note that it is compiled."""
        damaged = None
        for place in self._read:
            try:
                found = place.load_overload(sig, target_context)
            except Exception:  # a damaged file fails in any way: the code is compiled anew
                damaged = place.cache_path
                _emptied(place)
                continue
            if found is not None:
                return found
        _tell(self._why(damaged))
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the code of a signature where that is possible."""
        if self._own is not None:
            try:
                self._own.save_overload(sig, data)
            except Exception as error:  # a full disk, or a folder that is no longer there
                _tell(f"the compiled solver cannot be kept in {self.cache_path}: {error}", again=True)
                self._own = None

    def flush(self) -> None:
        """Forget what is kept."""
        for place in self._read:
            _emptied(place)

    def _why(self, damaged: str | None) -> str:
        if damaged is not None:
            return f"compiling the solver anew: what was kept in {damaged} is damaged"
        if self._own is None:
            return (
                "compiling the solver in memory, in every process: neither the folder of the package nor a cache "
                "folder of the user can be written; NUMBA_CACHE_DIR names another"
            )
        return "compiling the solver (only once; `chainbuild warm` does it ahead)"


class _ReadableFolder(InTreeCacheLocator):
    """The folder beside the package, which need not be writable."""

    def ensure_cache_path(self) -> None:
        """Nothing is made: what is there is read."""


class _InstalledCode(CompileResultCacheImpl):
    _locator_classes = [_ReadableFolder]  # noqa: RUF012 - as numba declares it


class _Installed(FunctionCache):
    """Machine code beside the package."""

    _impl_class = _InstalledCode


_OBJECTS: Final = 100_000  # new ones after which to look for those in cycles; every 700 or 2000 is usual


def _is_kept(event: Any) -> bool:
    return isinstance(event.data["dispatcher"]._cache, KeptCode)


class _Compiling(numba_events.Listener):
    """Shows on a terminal that an entry point is being compiled, which takes some seconds.

    numba makes millions of objects then, most of which stay: looking for those that do not takes a tenth of the time.
    """

    def __init__(self) -> None:
        self._shown = ExitStack()

    def on_start(self, event: Any) -> None:
        """Begin where it is an entry point."""
        if _is_kept(event):
            often = gc.get_threshold()
            if often[0]:
                self._shown.callback(gc.set_threshold, *often)
                gc.set_threshold(_OBJECTS, often[1], _OBJECTS)
            self._shown.enter_context(working("compiling the solver"))

    def on_end(self, event: Any) -> None:
        """End with the entry point, not with a function that it calls; also after an error or an interrupt."""
        if _is_kept(event):
            self._shown.close()


numba_events.register("numba:compile", _Compiling())


def _emptied(place: Any) -> None:
    try:
        place.flush()
    except OSError:
        place.disable()


def _tell(text: str, *, again: bool = False) -> None:
    """Print a note on stderr, once a process."""
    if KeptCode.told and not again:
        return
    KeptCode.told = True
    if sys.stderr is not None:
        with above_bars():
            print(f"chainbuild: {text}", file=sys.stderr, flush=True)


cached_jit: Final[Any] = kept_jit(nogil=True, **FAST)

_MODULES: Final = (
    inner,
    compiled_kernels,
    compiled_least_squares,
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
    def search_one(data, rows, sizes, target, start, has_start, wanted, accuracy, restarts, y, outside):
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
            y: (n,) out: the answer or the nearest.
            outside: (n,) out: a point outside the limits.
        """
        if fingerprint < 0 or not is_rigid(target, accuracy[3]):
            return rules.NOT_RIGID, 0, 0, np.inf, np.inf
        problem = unpack(data, rows, sizes)
        work = work_of(sizes[0], sizes[1])
        return search(problem, work, target, start, has_start, wanted, accuracy, restarts, y, outside)

    return search_one


def _search_many(fingerprint: int) -> Any:
    @cached_jit
    def search_many(data, rows, sizes, targets, starts, has_start, wanted, accuracy, restarts, y, counts, misses):
        """Search for many targets one after another; threads share them, see `on_all_cores`.

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
        problem, work, outside = unpack(data, rows, sizes), work_of(sizes[0], sizes[1]), np.empty(sizes[1])
        for i in range(len(targets)):
            counts[i, 0] = rules.NOT_RIGID + 0 * fingerprint
            if is_rigid(targets[i], accuracy[3]):
                start = starts[i % len(starts)]  # one for all, or one a pose
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
        return track(
            unpack(data, rows, sizes), work_of(sizes[0], sizes[1]), targets, last, accuracy, most, y, counts, misses
        )

    return track_many


search_one: Final = _search_one(_FINGERPRINT)
search_many: Final = _search_many(_FINGERPRINT)
track_many: Final = _track_many(_FINGERPRINT)
