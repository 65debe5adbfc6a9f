"""A machine file of either dialect on the disk, with its overlay beside it."""

from __future__ import annotations

from pathlib import Path


def machine_file(folder: Path, text: str, overlay: str = "") -> Path:
    """Write a machine file whose name does not tell the dialect, and its overlay where there is one."""
    path = folder / "machine.txt"
    path.write_text(text, "utf-8")
    if overlay:
        (folder / "machine.chainbuild.toml").write_text(overlay, "utf-8")
    return path
