"""`chainbuild types`: the KIN_TYPs that can be built."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from chainbuild.cli.show import console, print_json, table
from chainbuild.cli.usage import Json

if TYPE_CHECKING:
    from chainbuild.twincat.catalogue import KinType


def types(*, json: Json = False) -> int:
    """List the TwinCAT kinematics that can be built, by KIN_TYP.

    Args:
        json: Print JSON, with the table of parameters of every type.
    """
    from chainbuild.twincat.catalogue import catalogue

    entries: Mapping[int, KinType] = catalogue()
    if json:
        print_json([_data(entry) for entry in entries.values()])
        return 0
    shown = table("KIN_TYP", "Type", "Title", "Family", "Axes", "Programmed", "Manual")
    for entry in entries.values():
        axes = " ".join(axis.name for axis in entry.axes)
        programmed = "pose" if entry.orientation == "complete" else "position and axes"
        shown.add_row(str(entry.number), entry.title, entry.family, axes, programmed, entry.manual)
    console().print(shown)
    console().print("91 (universal) and 210 (coupling) are built from the axes and the kinematics that a list names.")
    return 0


def _data(entry: KinType) -> dict[str, Any]:
    return {
        "kin_typ": entry.number,
        "title": entry.title,
        "family": entry.family,
        "orientation": entry.orientation,
        "manual": entry.manual,
        "summary": entry.summary,
        "axes": [asdict(axis) for axis in entry.axes],
        "parameters": [asdict(row) for row in entry.hd],
        "conventions": [convention.name for convention in entry.conventions],
    }
