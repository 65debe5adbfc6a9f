"""`chainbuild types`: the KIN_TYPs that can be built."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Final

from rich.padding import Padding

from chainbuild.cli.open_points import print_convention
from chainbuild.cli.show import console, empty_table, print_json, shown_number
from chainbuild.cli.usage import Json

if TYPE_CHECKING:
    from chainbuild.formats.twincat.types.catalogue import KinType

# Types that are a list of axes or of kinematics, without a table of head offsets: family, orientation, source.
_LISTED: Final = {
    91: ("universal", "rtcp", "P-CHAN-00292", "The list gives the direction and a point of every axis."),
    210: ("coupling", "complete", "Couple kinematics 3.1", "The list names the kinematics that carry each other."),
}


def types(kin_typ: int | None = None, /, *, json: Json = False) -> int:
    """List the TwinCAT kinematics that can be built, by KIN_TYP, or show one with its parameters.

    Example: `chainbuild types 9`

    Args:
        kin_typ: Number of one type: show its axes, head offsets (HD) and the points that the manuals leave open.
        json: Print JSON, with the table of parameters of every type.
    """
    from chainbuild.formats.twincat.types.catalogue import catalogue

    if kin_typ is not None:
        return _one(kin_typ, json)
    rows = {**{number: _data(entry) for number, entry in catalogue().items()}, **{n: _listed(n) for n in _LISTED}}
    entries = [rows[number] for number in sorted(rows)]
    if json:
        print_json(entries)
        return 0
    shown = empty_table("KIN_TYP", "Type", "Title", "Family", "Axes", "Programmed", "Manual")
    for entry in entries:
        axes = " ".join(axis["name"] for axis in entry["axes"]) or "as listed"
        programmed = "pose" if entry["orientation"] == "complete" else "position and axes"
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

    entry = _listed(kin_typ) if kin_typ in _LISTED else _data(kin_type(kin_typ))
    if json:
        print_json(entry)
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


def _listed(kin_typ: int) -> dict[str, Any]:
    """Return the row of a type that has no table of head offsets."""
    from chainbuild.convention import applying_to
    from chainbuild.formats.twincat.types.catalogue import title_of

    family, orientation, manual, summary = _LISTED[kin_typ]
    return {
        "kin_typ": kin_typ,
        "title": title_of(kin_typ),
        "family": family,
        "orientation": orientation,
        "manual": manual,
        "summary": f"{summary} See docs/coupling.md.",
        "axes": [],
        "parameters": [],
        "conventions": [convention.name for convention in applying_to(["KIN", f"KIN {kin_typ}"])],
    }
