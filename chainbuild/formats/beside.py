"""What stands beside a machine file: its overlay; and what of an overlay a file without a control has no use for."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from chainbuild.errors import FileAccessError, Span
from chainbuild.formats.overlay import NO_OVERLAY, Overlay, overlay_path, read_overlay
from chainbuild.formats.text import DRIVES

# What an overlay says of controls alone: attribute → keys in the file.
OF_CONTROLS: Final[Mapping[str, tuple[str, ...]]] = {
    "conventions": ("conventions",),
    "tool": ("tool",),
    "axis_lists": ("axis_lists",),
    "drive_limits": ("limits", DRIVES),
    "drive_speeds": ("speeds", DRIVES),
}


def as_path(path: str | os.PathLike[str]) -> Path:
    """Return a path.

    Raises:
        FileAccessError: it is none.
    """
    try:
        return Path(path)
    except TypeError as error:
        raise FileAccessError(f"not a path: {error}") from None


def find_overlay(machine_file: Path, named: Path | None = None) -> Overlay:
    """Return the overlay named, else the one beside the machine file, else an empty one."""
    if named is not None:
        return read_overlay(named)
    beside = overlay_path(machine_file)
    try:
        present = beside.is_file()
    except OSError as error:
        raise FileAccessError(f"cannot look for the overlay: {error}", span=Span(str(beside))) from None
    return read_overlay(beside) if present else Overlay()


def refuse_useless(overlay: Overlay, useless: Mapping[str, tuple[str, ...]], what: str, useful: str) -> None:
    """Refuse what an overlay says and nothing reads.

    Args:
        overlay: The overlay.
        useless: Its attributes that nothing reads, with their keys in the file.
        what: What has no use for them: "a URDF".
        useful: The keys that are read.

    Raises:
        OverlayError: one of them is given.
    """
    for attribute, keys in useless.items():
        if getattr(overlay, attribute) != getattr(NO_OVERLAY, attribute):
            raise overlay.error(f"{what} has no use for '{'.'.join(keys)}'", keys, useful)
