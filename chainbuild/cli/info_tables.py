"""The tables of `chainbuild info`, for terminals of 80 columns and more."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from rich.console import Console
from rich.table import Table

from chainbuild.cli.open_points import print_convention
from chainbuild.cli.show import empty_table, lines_shown, shown_number
from chainbuild.formats.listing import array_name, arrays_of, axis_meanings, limits_source, lines_of
from chainbuild.kinematics.limits import drive_name

if TYPE_CHECKING:
    from chainbuild.chain.elements import Axis, Chain
    from chainbuild.convention import UsedConvention
    from chainbuild.formats.entries import KinematicEntry, ParameterRow
    from chainbuild.formats.machine import Machine

_KINEMATICS_SHOWN: Final = 200  # far more than a machine has; a table of thousands takes seconds
_WIDE: Final = 120  # columns of a terminal on which long texts fit side by side


def kinematics_table(entries: Sequence[KinematicEntry]) -> Table:
    """Return the kinematics that a file configures, with the option that chooses each."""
    shown = empty_table("Kinematics", "Id", "Name", "Type", "Title", "Chosen by")
    default = next((entry for entry in entries if entry.default), None)
    taken: set[tuple[int, int]] = set()
    for entry in entries[:_KINEMATICS_SHOWN]:
        key = (entry.channel, entry.id)
        # Kinematics that share an id are selected by name.
        id_shown = "" if key in taken and entry.name else str(entry.id)
        taken.add(key)
        chosen = f"--tool {entry.name}" if entry.type == "URDF" else f"--kinematic {id_shown or entry.name}"
        if default is not None and entry.channel != default.channel:
            chosen += f" --channel {entry.channel}"
        kind = f"{entry.type}, step {entry.step}" if entry.step else entry.type
        shown.add_row(id_shown, entry.name, kind, entry.title, "default" if entry is default else chosen)
    if len(entries) > _KINEMATICS_SHOWN:
        shown.add_row("…", "", "", f"{len(entries) - _KINEMATICS_SHOWN} more: --json lists them", "")
    return shown


def axes_table(machine: Machine, chain: Chain) -> Table:
    """Return the axes with their limits; columns that are empty for every axis are left out."""
    meanings = axis_meanings(chain)
    remarks = [_remarks(axis) for axis in chain.axes]
    generic = [axis.generic for axis in chain.axes]
    optional: dict[str, list[str]] = {
        "Generic": generic if any(generic) else [],
        "Carries": [axis.carries for axis in chain.axes] if len({a.carries for a in chain.axes}) > 1 else [],
        "Remarks": remarks if any(remarks) else [],
        "Meaning": meanings,
    }
    columns = {name: cells for name, cells in optional.items() if cells}
    shown = empty_table("Axes", "Axis", "Unit", "Lower", "Upper", "Limits from", "Speed", *columns)
    for n, axis in enumerate(chain.axes):
        speed = f"{shown_number(axis.max_speed)} {axis.unit}/s" if axis.max_speed is not None else "–"
        limits = (shown_number(axis.lower), shown_number(axis.upper), limits_source(machine, chain, n))
        shown.add_row(axis.name, axis.unit, *limits, speed, *(cells[n] for cells in columns.values()))
    return shown


def drives_table(chain: Chain) -> Table | None:
    """Return the limits of drives that do not stand at their axis values; None where there are none."""
    if not chain.drive_limits:
        return None
    shown = empty_table("Drives that do not stand at their axis value", "Drive", "Unit", "Lower", "Upper", "Speed")
    for limit in chain.drive_limits:
        axis = chain.axes[limit.axis]
        speed = f"{shown_number(limit.max_speed)} {axis.unit}/s" if limit.max_speed is not None else "–"
        ends = [shown_number(end) if math.isfinite(end) else "–" for end in (limit.lower, limit.upper)]
        shown.add_row(drive_name(axis), axis.unit, *ends, speed)
    return shown


def poses_table(chain: Chain) -> Table:
    """Return the poses that the overlay names, as `--at` takes axis values."""
    shown = empty_table("Named poses", "Pose", "Axis values")
    for pose in chain.named_poses:
        shown.add_row(pose.name, ",".join(shown_number(value) for value in pose.axes))
    return shown


def _remarks(axis: Axis) -> str:
    remarks = {"endless": axis.endless, "held by ik": axis.held, "others in the middle": axis.widest is not None}
    return ", ".join(text for text, on in remarks.items() if on)


def parameters_table(rows: Sequence[ParameterRow], width: int) -> Table:
    """Return parameters with meaning and line, each array in one row; on a wide terminal with their source."""
    wide = width >= _WIDE
    columns = ("Symbol", "Name", "Value", "Unit", "Meaning", "Source", "Line")
    shown = empty_table("Parameters", *(columns if wide else ("Symbol, name", "Value", "Meaning", "Line")))
    if not wide:
        shown.columns[0].min_width, shown.columns[1].max_width = 24, 16
    shown.columns[-1].no_wrap = True
    for group in arrays_of(rows):
        first, name = group[0], array_name(group)
        values = ", ".join(shown_number(row.value) for row in group)
        meaning = f"{first.meaning}{_in_si(group)}"
        if wide:
            shown.add_row(first.symbol, name, values, first.unit, meaning, first.source, lines_of(group))
        else:
            called = lines_shown([first.symbol, name]) if first.symbol else name
            shown.add_row(called, f"{values} {first.unit}".rstrip(), meaning, lines_of(group))
    return shown


def _in_si(group: Sequence[ParameterRow]) -> str:
    """Return the values of an array in SI units if the file uses others."""
    if not group[0].si_unit:
        return ""
    return f" In SI: {', '.join(f'{row.si:.6g}' for row in group)} {group[0].si_unit}."


def conventions_shown(out: Console, used: Sequence[UsedConvention]) -> None:
    """Print the conventions of a chain: as a table on a wide terminal, else one paragraph each."""
    title = "Conventions: open in the manuals ([I] inferred, [?] open); --convention NAME=CHOICE changes one"
    if out.width < _WIDE:
        out.print(title, style="bold")
        for one in used:
            print_convention(out, one.convention, one.choice, "chosen" if one.by_user else "default")
        out.print()
        return
    shown = empty_table(title, "Name", "Choice", "Mark", "Meaning", "Alternatives", "How to verify")
    for one in used:
        convention = one.convention
        others = [f"{name}: {meaning}" for name, meaning in convention.choices.items() if name != one.choice]
        shown.add_row(
            convention.name,
            one.choice + (" (chosen)" if one.by_user else " (default)"),
            f"[{convention.mark}]",
            convention.choices[one.choice],
            lines_shown(others),
            convention.verify,
        )
    out.print(shown)
