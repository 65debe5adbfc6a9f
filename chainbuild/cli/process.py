"""Standard streams that may be missing, and signals that end the process cleanly."""

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
from typing import Any, Final

INTERRUPTED: Final = 130  # exit code: 128 and the number of the signal, as a shell reports it
_ENDING: Final = ("SIGTERM", "SIGHUP")  # the second is unknown on Windows
_IMPORTING: Final = "<frozen importlib._bootstrap>"  # file of the frames of an import
# What the compiler calls from C when it loads what it has kept: an exception there is printed and dropped.
_CALLED_FROM_C: Final = "llvmlite/binding/executionengine.py"
_AGAIN_S: Final = 0.02  # seconds until an interrupt that had to wait comes again: not felt


class _NoStream(io.TextIOBase):
    """Replaces a stream that was closed before the program began; every write fails."""

    def write(self, _text: str) -> int:
        """Fail as a closed descriptor does."""
        raise OSError(errno.EBADF, os.strerror(errno.EBADF))


@contextmanager
def standard_streams() -> Iterator[None]:
    """Replace a missing stdout or stderr and keep its descriptor from files opened later."""
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


_interrupted = False
_again: threading.Timer | None = None  # brings back an interrupt that had to wait


@contextmanager
def signals() -> Iterator[None]:
    """Remove half-written files when a signal ends the process, and record every interrupt.

    An interrupt while a library is imported takes effect when that is done: libraries in C++ do not survive an
    exception in their initialisation. So does one in what the compiler calls from C, where it would be dropped.
    """
    global _interrupted, _again  # noqa: PLW0603 - signals belong to the process
    _interrupted = False
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    ending = [getattr(signal, name) for name in _ENDING if hasattr(signal, name)]
    handlers: dict[int, tuple[Any, Any]] = dict.fromkeys(ending, (signal.SIG_DFL, _end))
    handlers[signal.SIGINT] = (signal.default_int_handler, _interrupt)
    taken = {number: before for number, (before, _) in handlers.items() if signal.getsignal(number) is before}
    for number in taken:
        signal.signal(number, handlers[number][1])
    try:
        yield
    finally:
        if _again is not None:
            _again.cancel()
            _again = None
        for number, before in taken.items():
            with suppress(ValueError, OSError):
                signal.signal(number, before)


@contextmanager
def loading() -> Iterator[None]:
    """Let an interrupt during the import of the command line end the process when that is done, in one line."""
    with signals():
        yield
        if _interrupted:
            with suppress(OSError):
                os.write(2, b"chainbuild: interrupted\n")
            raise SystemExit(INTERRUPTED)


def check_interrupt() -> None:
    """Raise KeyboardInterrupt if an interrupt was lost: C++ code drops exceptions of the Python it calls."""
    if _interrupted:
        raise KeyboardInterrupt


def _interrupt(number: int, frame: FrameType | None) -> None:
    global _interrupted, _again  # noqa: PLW0603
    _interrupted = True
    if not _has_to_wait(frame):
        raise KeyboardInterrupt
    if _again is None:
        _again = threading.Timer(_AGAIN_S, _send_again, [number])
        _again.daemon = True
        _again.start()


def _send_again(number: int) -> None:
    global _again  # noqa: PLW0603
    _again = None  # before the signal: where that has to wait once more, it needs another
    main = threading.main_thread().ident
    if main is None or not hasattr(signal, "pthread_kill"):  # Windows
        signal.raise_signal(number)
    else:
        signal.pthread_kill(main, number)  # also wakes it where it waits


def _has_to_wait(frame: FrameType | None) -> bool:
    """Return whether an exception would be lost, or break a library: in an import, in what C calls."""
    while frame is not None:
        file = frame.f_code.co_filename
        if file == _IMPORTING or file.replace(os.sep, "/").endswith(_CALLED_FROM_C):
            return True
        frame = frame.f_back
    return False


def _end(number: int, _frame: FrameType | None) -> None:
    """Remove half-written files and end as the signal does without a handler."""
    # This file loads no other of the package, so that signals are taken care of as early as possible.
    discard = getattr(sys.modules.get("chainbuild.files"), "discard_parts", None)
    if discard is not None:
        discard()
    with suppress(OSError):
        os.write(2, b"chainbuild: terminated\n")
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
