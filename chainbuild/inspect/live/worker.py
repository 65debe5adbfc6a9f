"""A thread that computes for a live page, and gives up what it computes when the page ends."""

from __future__ import annotations

import asyncio
import ctypes
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Final, TypeVar

Found = TypeVar("Found")

_AGAIN_S: Final = 0.02  # seconds until a thread that still computes is told again: not felt


class _Over(BaseException):
    """Ends what a thread computes: no `except Exception` on the way may keep it."""


class Worker:
    """A thread that computes one thing after another.

    Args:
        name: Of the thread.
    """

    def __init__(self, name: str) -> None:
        self._pool = ThreadPoolExecutor(1, name)
        self._computing: threading.Thread | None = None

    async def __call__(self, act: Callable[[], Found]) -> Found:
        """Return what a function returns; it is called in the thread after all that was asked for before."""
        try:
            return await asyncio.get_running_loop().run_in_executor(self._pool, self._run, act)
        except _Over:
            raise asyncio.CancelledError from None

    def _run(self, act: Callable[[], Found]) -> Found:
        self._computing = threading.current_thread()
        try:
            return act()
        finally:
            self._computing = None

    async def end(self) -> None:
        """Give up what waits and what is being computed, and return when the thread has left it."""
        self._pool.shutdown(wait=False, cancel_futures=True)
        # The interpreter would wait for the thread: a section takes seconds, a compiled search up to a minute.
        while (thread := self._computing) is not None and thread.is_alive() and thread.ident is not None:
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread.ident), ctypes.py_object(_Over))
            await asyncio.sleep(_AGAIN_S)
