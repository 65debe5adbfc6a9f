"""Shipped machines whose channel has names of its own for its axes."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path

from chainbuild.machines import shipped_path

# German names for every letter of the types, as a builder of machines gives them; none is the letter itself.
GERMAN = {"X": "X_BETT", "Y": "Y_SUPPORT", "Z": "Z_PINOLE", "A": "A_SCHWENK", "B": "B_KIPP", "C": "C_DREH"}


def german(names: Sequence[str]) -> list[str]:
    """Return a name for each axis, by its first letter and its place, which no other axis has."""
    return [f"{GERMAN.get(name[0], 'Q_' + name[0])}{n}" for n, name in enumerate(names)]


def bezeichnungen(names: Mapping[int, str]) -> str:
    """Return the lines of a channel list that name axes by their indices."""
    return "".join(f"gruppe[0].achse[{n}].bezeichnung {name}\n" for n, name in names.items())


def channel_axis_names(names: Mapping[int, str]) -> str:
    """Return the lines of an archive that name channel axes by their numbers, from 1."""
    return "".join(f'N20080 $MC_AXCONF_CHANAX_NAME_TAB[{n - 1}]="{name}"\n' for n, name in names.items())


def named_machine(folder: Path, machine: str, names: Mapping[int, str]) -> Path:
    """Write a shipped machine with its overlay, its channel axes named by index (TwinCAT) or number (SINUMERIK)."""
    source = shipped_path(machine)
    assert source is not None
    path = folder / f"named_{source.name}"
    text = source.read_text("utf-8")
    if source.suffix == ".lis":
        text = text.replace("Ende", "") + "\n" + bezeichnungen(names) + "Ende\n"
    else:
        text = text.replace("CHANDATA(1)\n", f"CHANDATA(1)\n{channel_axis_names(names)}", 1)
    path.write_text(text, "utf-8")
    shutil.copy(source.with_suffix(".chainbuild.toml"), path.with_suffix(".chainbuild.toml"))
    return path
