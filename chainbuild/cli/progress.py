"""Progress of work in steps, on stderr if that is a terminal."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console

from chainbuild.progress import Progress


@contextmanager
def counted(what: str, total: int) -> Iterator[Progress]:
    """Yield a function that takes the number of steps done.

    Args:
        what: What is being done.
        total: Steps in all.
    """
    if not sys.stderr.isatty():
        yield False
        return
    from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bars

    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    with Bars(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(what, total=total)
        yield lambda count, _: bar.update(task, completed=count)
