"""What the command needs of its process: streams that may be missing, and signals that end it in good order."""

from __future__ import annotations

import errno
import io
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Final

_SIGNALS: Final = ("SIGTERM", "SIGHUP")  # the second is unknown on Windows


class Terminated(KeyboardInterrupt):
    """The process was asked to end; like an interrupt it passes everything that cleans up.

    Args:
        number: The signal.
    """

    def __init__(self, number: int) -> None:
        super().__init__()
        self.number = number


class _NoStream(io.TextIOBase):
    """Stands for a stream that was closed before the program began: nothing can be written to it."""

    def write(self, _text: str) -> int:
        """Fail as a closed descriptor does."""
        raise OSError(errno.EBADF, os.strerror(errno.EBADF))


@contextmanager
def standard_streams() -> Iterator[None]:
    """Stand in for a missing stdout or stderr, whose descriptors no file opened later may take."""
    before = sys.stdout, sys.stderr
    if None not in before:
        yield
        return
    nowhere = Path(os.devnull)
    # Two of them: each takes one free descriptor.
    with nowhere.open("w", encoding="utf-8"), nowhere.open("w", encoding="utf-8") as silent:
        sys.stdout = before[0] or _NoStream()
        sys.stderr = before[1] or silent
        try:
            yield
        finally:
            sys.stdout, sys.stderr = before


@contextmanager
def ending_signals() -> Iterator[None]:
    """Turn signals that would end the process on the spot into `Terminated`, so that half-written files go."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    numbers = [getattr(signal, name) for name in _SIGNALS if hasattr(signal, name)]
    taken = [number for number in numbers if signal.getsignal(number) is signal.SIG_DFL]
    for number in taken:
        signal.signal(number, _terminate)
    try:
        yield
    finally:
        for number in taken:
            with suppress(ValueError, OSError):
                signal.signal(number, signal.SIG_DFL)


def _terminate(number: int, _frame: FrameType | None) -> None:
    raise Terminated(number)
