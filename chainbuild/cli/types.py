"""`chainbuild types`: the KIN_TYPs that can be built."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Final

from rich.padding import Padding

from chainbuild.cli.open_points import print_convention
from chainbuild.cli.show import console, empty_table, print_json, shown_number
from chainbuild.cli.usage import Json, Whole

if TYPE_CHECKING:
    from chainbuild.formats.twincat.types.catalogue import KinType

# What is programmed, by the orientation of a type.
_PROGRAMMED: Final = {"complete": "pose", "rtcp": "position and axes", "listed": "as listed"}


def types(kin_typ: Whole | None = None, /, *, json: Json = False) -> int:
    """List the TwinCAT kinematics that can be built, by KIN_TYP, or show one with its parameters.

    Example: `chainbuild types 9`

    Args:
        kin_typ: Number of one type: show its axes, head offsets (HD) and the points that the manuals leave open.
        json: Print JSON, with the table of parameters of every type.
    """
    from chainbuild.formats.twincat.types.catalogue import catalogue

    if kin_typ is not None:
        return _one(kin_typ, json)
    entries = [_data(entry) for entry in catalogue().values()]
    if json:
        print_json("types", entries)
        return 0
    shown = empty_table("KIN_TYP", "Type", "Title", "Family", "Axes", "Programmed", "Manual")
    for entry in entries:
        axes = " ".join(axis["name"] for axis in entry["axes"]) or "as listed"
        programmed = _PROGRAMMED[entry["orientation"]]
        shown.add_row(str(entry["kin_typ"]), entry["title"], entry["family"], axes, programmed, entry["manual"])
    console().print(shown)
    console().print("chainbuild types N shows the parameters of one type.")
    return 0


def _one(kin_typ: int, json: bool) -> int:
    """Show one type.

    Raises:
        UnsupportedKinematicError: the type is unknown or not supported.
    """
    from chainbuild.convention import applying_to
    from chainbuild.formats.twincat.types.catalogue import kin_type

    entry = _data(kin_type(kin_typ))
    if json:
        print_json("types", entry)
        return 0
    out = console()
    out.print(f"KIN_TYP {kin_typ}: {entry['title']} ({entry['manual']})", style="bold")
    out.print(Padding(entry["summary"], (0, 0, 1, 0)))
    if entry["axes"]:
        axes = empty_table("Axes in channel order", "Axis", "Kind", "Carries", "Meaning")
        for axis in entry["axes"]:
            axes.add_row(axis["name"], axis["kind"], axis["carries"], axis["meaning"])
        out.print(axes)
    if entry["parameters"]:
        shown = empty_table("Parameters: HD n is param[n - 1]", "HD", "Name", "Default", "Unit", "Acts on", "Meaning")
        for row in entry["parameters"]:
            unit = row["unit"] or row["kind"]
            meaning = row["meaning"] + _permitted(row["permitted"])
            shown.add_row(str(row["n"]), row["name"], shown_number(row["default_scaled"]), unit, row["effect"], meaning)
        out.print(shown)
    for convention in applying_to(["KIN", f"KIN {kin_typ}"]):
        print_convention(out, convention, convention.default, "default")
    return 0


def _permitted(values: tuple[float, ...]) -> str:
    return f" Permitted: {', '.join(shown_number(float(value)) for value in values)}." if values else ""


def _data(entry: KinType) -> dict[str, Any]:
    return {
        "kin_typ": entry.number,
        "title": entry.title,
        "family": entry.family,
        "orientation": entry.orientation,
        "manual": entry.manual,
        "summary": entry.summary,
        "axes": [asdict(axis) for axis in entry.axes],
        "parameters": [
            {**asdict(row), "unit": row.unit, "default_scaled": float(row.scaled(row.default))} for row in entry.hd
        ],
        "conventions": [convention.name for convention in entry.conventions],
    }
