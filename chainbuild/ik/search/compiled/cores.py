"""Rows of a table on all cores, by threads: compiled code runs without Python's lock.

numba's own parallel loops take three times as long to compile, and end the process where two threads call them at once
and none of the better ways to share work is installed.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor


def on_all_cores(write: Callable[[slice], object], count: int, part: int) -> None:
    """Call a function for all parts of some rows, at once on as many cores as numba may take.

    Args:
        write: Writes the rows of a slice; releases Python's lock, else nothing is gained.
        count: How many rows there are.
        part: How many of them a call takes at most.
    """
    if count <= part:
        if count:
            write(slice(0, count))
        return
    from numba import config

    parts = [slice(first, min(first + part, count)) for first in range(0, count, part)]
    cores = min(len(parts), config.NUMBA_NUM_THREADS)  # type: ignore[attr-defined]
    if cores <= 1:
        for each in parts:
            write(each)
        return
    with ThreadPoolExecutor(cores) as threads:
        for _ in threads.map(write, parts):  # raises what a call has raised; an interrupt leaves the others undone
            pass
