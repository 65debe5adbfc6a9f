"""Of which machine a map is: a short text that another machine, limit or tool changes."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from chainbuild.chain.elements import Chain
from chainbuild.files import number_text

# What the numbers of a map follow from. Titles, findings, conventions and what is displayed do not count by themselves.
_COUNTED: Final = (
    "links", "joints", "frames", "axes", "axis_map", "loops", "task", "constraints", "tool_axis", "drives",
    "drive_limits",
)  # fmt: skip
_NOT_MEASURED: Final = frozenset({"max_speed", "assumed", "generic"})  # of axes and drives
_DIGITS: Final = 32  # hexadecimal: two machines never share that many by chance


def fingerprint(chain: Chain, *, bodies: bool) -> str:
    """Return a text that is the same for chains with the same positions, limits and tips, on any computer.

    Args:
        chain: The chain.
        bodies: Whether the bodies of the overlay count, with the contents of mesh files.

    Raises:
        OSError: a mesh file cannot be read.
    """
    found = hashlib.sha256()
    for name in (*_COUNTED, *(["geometry"] if bodies else [])):
        for word in _words(getattr(chain, name)):
            found.update(word.encode("utf-8", "surrogatepass") + b"\0")
    return found.hexdigest()[:_DIGITS]


def _words(value: Any) -> Iterator[str]:
    """Yield a value in words; numbers are rounded, since their last bit differs between computers."""
    if isinstance(value, Path):
        yield hashlib.sha256(value.read_bytes()).hexdigest()
    elif isinstance(value, float | np.ndarray):
        array = np.asarray(value, dtype=float)
        yield f"{array.shape} " + " ".join(number_text(one) for one in array.ravel().tolist())
    elif isinstance(value, Mapping):
        for key in sorted(value):
            yield from (str(key), *_words(value[key]))
    elif isinstance(value, tuple | list):
        yield str(len(value))
        for one in value:
            yield from _words(one)
    elif is_dataclass(value):
        yield type(value).__qualname__
        for field in fields(value):
            if field.name not in _NOT_MEASURED:
                yield from (field.name, *_words(getattr(value, field.name)))
    else:
        yield repr(value)
