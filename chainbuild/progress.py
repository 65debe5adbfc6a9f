"""Progress of work, as whoever started it wants to see it: bars on standard error, or a function that is told.

A bar is one line of text, redrawn by a carriage return and wiped when the work ends: no escape sequence is needed, so
that it looks the same under NO_COLOR. The innermost of several is drawn. Whatever prints while one may be drawn does so
inside `above_bars`.
"""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import Final, TypeVar

Item = TypeVar("Item")

# True: a bar on standard error; a function: called with the steps done and all steps; False: nothing.
Progress = bool | Callable[[int, int], None]

_UNSEEN_S: Final = 0.5  # shorter work ends before a bar would be read
_WAIT_S: Final = 2.0  # of work that is not counted: longer ones are taken for a hang
_REDRAW_S: Final = 0.2  # smooth to the eye, and costs nothing
_CELLS: Final = 30  # characters of the bar itself
_COLUMNS: Final = 80  # of a terminal that does not tell its width
DUMB: Final = ("dumb", "unknown")  # values of TERM of terminals that know no control characters

_lock = threading.RLock()  # one writer on the terminal at a time
_bars: list[_Bar] = []  # the last is drawn
_silenced = 0  # how many want none to be drawn


def bars_shown() -> bool:
    """Return whether standard error is a terminal that a bar can be drawn on."""
    stream = sys.stderr
    return stream is not None and stream.isatty() and os.environ.get("TERM", "") not in DUMB


def _in_notebook() -> bool:
    """Return whether standard error is the output of a cell, which knows how to go back in a line."""
    return type(sys.stderr).__module__.startswith("ipykernel.")


@contextmanager
def counting(total: int, progress: Progress, what: str, done: int = 0) -> Iterator[Callable[[int], None]]:
    """Give a function that is told how many steps more are done.

    Args:
        total: Steps in all; 0: their number is not known.
        progress: A bar, a function, or nothing.
        what: What the bar is labelled with.
        done: Steps done before.
    """
    if progress is False or (progress is True and not (bars_shown() or _in_notebook())):
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
    with _drawn(_Bar(what, total, done, _UNSEEN_S)) as bar:
        yield bar.advance


def counted(items: Iterable[Item], total: int, progress: Progress, what: str) -> Iterator[Item]:
    """Yield items and count each when the next is asked for; arguments as for `counting`."""
    with counting(total, progress, what) as advance:
        for item in items:
            yield item
            advance(1)


@contextmanager
def working(what: str) -> Iterator[None]:
    """Show that work goes on whose steps nobody counts, once it takes long, on a terminal."""
    if not bars_shown():
        yield
        return
    with _drawn(_Bar(what, 0, 0, _WAIT_S)):
        yield


@contextmanager
def above_bars() -> Iterator[None]:
    """Wipe the bar while something is printed."""
    with _lock:
        if _bars:
            _bars[-1].wipe()
        yield


@contextmanager
def without_bars() -> Iterator[None]:
    """Draw no bar while the terminal shows something else, such as the rows of a table."""
    global _silenced  # noqa: PLW0603 - there is one terminal
    with above_bars():
        _silenced += 1
    try:
        yield
    finally:
        _silenced -= 1


@contextmanager
def _drawn(bar: _Bar) -> Iterator[_Bar]:
    with above_bars():
        _bars.append(bar)
    painter = threading.Thread(target=bar.paint, daemon=True)
    painter.start()
    try:
        yield bar
    finally:
        bar.ended.set()
        with above_bars():
            _bars.remove(bar)


class _Bar:
    """A line that says how far some work is.

    Args:
        what: What is done.
        total: Steps in all; 0: not known.
        done: Steps done before.
        after: Seconds until it is drawn.
    """

    def __init__(self, what: str, total: int, done: int, after: float) -> None:
        self._what, self._total, self._begun_with, self._after = what, total, done, after
        self._done, self._begin = done, time.monotonic()
        self._width = 0  # characters that are drawn
        self.ended = threading.Event()

    def advance(self, steps: int) -> None:
        """Count steps."""
        self._done += steps

    def paint(self) -> None:
        """Draw until the work has ended."""
        pause = self._after
        while not self.ended.wait(pause):
            pause = _REDRAW_S
            with _lock:
                if _bars and _bars[-1] is self and not _silenced and not self.ended.is_set():
                    self._draw(self.text(time.monotonic() - self._begin))

    def wipe(self) -> None:
        """Remove what is drawn."""
        if self._width:
            self._write(f"\r{' ' * self._width}\r")
            self._width = 0

    def text(self, seconds: float) -> str:
        """Return the line after a time in seconds."""
        full, empty = _signs()
        if not self._total:
            at = int(seconds / _REDRAW_S) % _CELLS
            return f"{self._what} {empty * at}{full}{empty * (_CELLS - 1 - at)} {_clock(seconds)}"
        share = min(max(self._done / self._total, 0.0), 1.0)
        cells = int(share * _CELLS)
        line = f"{self._what} {full * cells}{empty * (_CELLS - cells)} {share:4.0%} {_clock(seconds)}"
        moved = (self._done - self._begun_with) / self._total
        return f"{line}, {_clock(seconds / moved * (1.0 - share))} left" if moved > 0.0 and share < 1.0 else line

    def _draw(self, text: str) -> None:
        shown = text[: _columns() - 1]  # the last column would begin a new line
        self._write(f"\r{shown}{' ' * (self._width - len(shown))}")
        self._width = len(shown)

    @staticmethod
    def _write(text: str) -> None:
        with suppress(OSError, ValueError):  # a terminal that is gone
            sys.stderr.write(text)
            sys.stderr.flush()


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"


def _signs() -> tuple[str, str]:
    """Return what a bar is made of, as far as the terminal has it."""
    encoding = (getattr(sys.stderr, "encoding", None) or "ascii").lower().replace("-", "")
    return ("━", "─") if encoding.startswith("utf") else ("#", "-")


def _columns() -> int:
    try:
        return os.get_terminal_size(sys.stderr.fileno()).columns or _COLUMNS
    except (OSError, ValueError, AttributeError):
        return _COLUMNS
