"""Example machine files shipped with the package, found by name."""

from __future__ import annotations

from functools import cache
from pathlib import Path

_SUFFIXES = (".tea", ".lis", ".ini", ".xti")
_FOLDER = Path(__file__).parent / "files"


@cache
def shipped() -> tuple[str, ...]:
    """Return the names of the shipped machines in alphabetical order."""
    return tuple(sorted(path.stem for path in _FOLDER.iterdir() if path.suffix in _SUFFIXES))


def shipped_path(name: str) -> Path | None:
    """Return the file of a shipped machine, or None where there is none of that name."""
    return next((path for path in _FOLDER.iterdir() if path.stem == name and path.suffix in _SUFFIXES), None)
