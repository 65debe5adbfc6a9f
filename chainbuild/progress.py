"""Progress of work that is counted in steps, as whoever started it wants to see it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

# True: a bar on standard error; a function: called with the steps done and all steps; False: nothing.
Progress = bool | Callable[[int, int], None]


@contextmanager
def counting(total: int, progress: Progress, what: str, done: int = 0) -> Iterator[Callable[[int], None]]:
    """Give a function that is told how many steps more are done.

    Args:
        total: Steps in all.
        progress: A bar, a function, or nothing.
        what: What the bar is labelled with.
        done: Steps done before.
    """
    if progress is False:
        yield lambda _: None
        return
    if callable(progress):
        tell, count = progress, done

        def advance(steps: int) -> None:
            nonlocal count
            count += steps
            tell(count, total)

        yield advance
        return
    from rich.console import Console
    from rich.progress import Progress as Bars

    with Bars(console=Console(stderr=True), transient=True) as bars:
        task = bars.add_task(what, total=total, completed=done)
        yield lambda steps: bars.advance(task, steps)
