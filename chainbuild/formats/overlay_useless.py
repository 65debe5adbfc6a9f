"""What of an overlay a file without a control has no use for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from chainbuild.formats.overlay import NO_OVERLAY, Overlay
from chainbuild.formats.text import DRIVES

# What an overlay says of controls alone: attribute → keys in the file.
OF_CONTROLS: Final[Mapping[str, tuple[str, ...]]] = {
    "conventions": ("conventions",),
    "tool": ("tool",),
    "axis_lists": ("axis_lists",),
    "drive_limits": ("limits", DRIVES),
    "drive_speeds": ("speeds", DRIVES),
}


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
