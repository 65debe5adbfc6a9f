"""What is worked out once for a mechanism and kept: the one memory for everything that solvers and analyses prepare."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from threading import RLock
from typing import Any, Final, TypeVar

T = TypeVar("T")

_NOTHING: Final[Any] = object()


class Prepared:
    """Things by kind and key, each made at its first use; threads may share it.

    A thing that two threads ask for at once is made once, under one lock for all of them; handing it out again takes
    none.
    """

    def __init__(self) -> None:
        self._kinds: dict[str, dict[Hashable, Any]] = {}
        self._lock = RLock()  # what is made may itself ask for other things

    def get(self, kind: str, make: Callable[[], T], key: Hashable = None, most: int | None = None) -> T:
        """Return a thing, made now or before.

        Args:
            kind: What it is.
            make: Makes it.
            key: Which one of its kind.
            most: So many of the kind are kept, the newest; None: all.
        """
        known = self._kinds.get(kind)
        found = _NOTHING if known is None else known.get(key, _NOTHING)
        return self._made(kind, make, key, most) if found is _NOTHING else found

    def _made(self, kind: str, make: Callable[[], T], key: Hashable, most: int | None) -> T:
        with self._lock:
            known = self._kinds.setdefault(kind, {})
            found: T = known.get(key, _NOTHING)
            if found is _NOTHING:
                found = make()
                if most is not None and len(known) >= most:
                    del known[next(iter(known))]
                known[key] = found
            return found
