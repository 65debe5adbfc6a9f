"""The names of columns: which axis a header means, with units in brackets, in any case."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Final

from chainbuild.chain.elements import Axis
from chainbuild.chain.names import DRIVE_SUFFIX, RESERVED_COLUMNS, axis_index
from chainbuild.errors import TableError

_WITH_UNIT: Final = re.compile(r"([^\[\]()]*)(?:\[([^\[\]()]*)\]|\(([^\[\]()]*)\))")
_SPELLINGS: Final = {"mm": "mm", "deg": "deg", "degree": "deg", "degrees": "deg", "°": "deg"}
# Other units that people have, of axes of each unit: what one of them is there.
_OTHER_UNITS: Final = {
    "mm": {"m": "1000", "cm": "10", "µm": "0.001", "um": "0.001", "in": "25.4", "inch": "25.4"},
    "deg": {"rad": "57.29577951308232", "radian": "57.29577951308232", "radians": "57.29577951308232"},
}
# From the place of a column, what is wrong with it and what is permitted, to an error.
Fault = Callable[[int, str, str], TableError]


def canonical_columns(written: Sequence[str], axes: Sequence[Axis], fault: Fault) -> tuple[str, ...]:
    """Return the names by which tables know the columns of a header.

    An axis' column goes by its name, or by its generic one, in any case and with its unit in brackets, as far as that
    means one axis alone. Columns of drives follow the axes; other columns are known in any case, x_mm also as `x [mm]`.
    What is unknown stays as it is. Another unit is refused, not converted: a table would have two.

    Args:
        written: The names as they are in the file.
        axes: The axes.
        fault: Makes the error of a column.

    Raises:
        TableError: the unit in brackets is not that of the axis, or two columns mean the same axis.
    """
    first: dict[str, str] = {}
    columns: list[str] = []
    for place, name in enumerate(written):
        column = _known(name, place, axes, fault)
        other = first.setdefault(column, name)
        if other != name:
            raise fault(place, f"columns '{other}' and '{name}' are the same: {column}", "one of the two")
        columns.append(column)
    return tuple(columns)


def _known(written: str, place: int, axes: Sequence[Axis], fault: Fault) -> str:
    n, folded = axis_index(axes, written), written.casefold()
    if n is not None:
        return axes[n].name
    if folded in RESERVED_COLUMNS:
        return folded
    with_unit = _WITH_UNIT.fullmatch(written)
    if with_unit is not None:
        return _with_unit(
            written, with_unit[1].strip(), (with_unit[2] or with_unit[3] or "").strip(), place, axes, fault
        )
    if folded.endswith(DRIVE_SUFFIX) and (n := axis_index(axes, written[: -len(DRIVE_SUFFIX)])) is not None:
        return f"{axes[n].name}{DRIVE_SUFFIX}"
    return written


def _with_unit(written: str, name: str, given: str, place: int, axes: Sequence[Axis], fault: Fault) -> str:
    """Return the column of a name with a unit behind it: that of an axis, else one whose name ends with the unit."""
    unit = _SPELLINGS.get(given.casefold())
    n = axis_index(axes, name)
    if n is not None:
        axis, own = axes[n], axes[n].unit
        if unit == own:
            return axis.name
        text = f"column '{written}': the values of axis {axis.name} are in {own}{_factor(given, own)}"
        raise fault(place, text, f"{axis.name} or {axis.name} [{own}]")
    for ending in _OTHER_UNITS:
        if (column := f"{name.casefold()}_{ending}") in RESERVED_COLUMNS:
            if unit == ending:
                return column
            text = f"column '{written}': {column} is in {ending}{_factor(given, ending)}"
            raise fault(place, text, f"{column} or {name} [{ending}]")
    return written


def _factor(given: str, own: str) -> str:
    """Return what one of another unit is in an axis' own, in brackets; an empty string where it is none."""
    factor = _OTHER_UNITS[own].get(given.casefold())
    return f" (1 {given} is {factor} {own})" if factor else ""
