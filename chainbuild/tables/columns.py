"""Column names of a header as the tables call them: axes by any of their names, with or without unit, in any case."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Final

from chainbuild.chain.elements import Axis
from chainbuild.chain.names import DRIVE_SUFFIX, RESERVED_COLUMNS, axis_index
from chainbuild.errors import TableError

_WITH_UNIT: Final = re.compile(r"([^\[\]]*)\[([^\[\]]*)\]")
_SPELLINGS: Final = {"mm": "mm", "deg": "deg", "degree": "deg", "degrees": "deg", "°": "deg"}

# From the place of a column, what is wrong with it and what is permitted, to an error.
Fault = Callable[[int, str, str], TableError]


def canonical_columns(written: Sequence[str], axes: Sequence[Axis], fault: Fault) -> tuple[str, ...]:
    """Return the names by which tables know the columns of a header.

    An axis' column goes by its name, or by its generic one, in any case and with its unit in brackets, as far as that
    means one axis alone. Columns of drives follow the axes; other columns are known in any case. What is unknown stays
    as it is.

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
    if with_unit is not None and (n := axis_index(axes, with_unit[1].strip())) is not None:
        axis, unit = axes[n], with_unit[2].strip()
        if _SPELLINGS.get(unit.casefold()) != axis.unit:
            text = f"column '{written}': the values of axis {axis.name} are in {axis.unit}"
            raise fault(place, text, f"{axis.name} or {axis.name} [{axis.unit}]")
        return axis.name
    if folded.endswith(DRIVE_SUFFIX) and (n := axis_index(axes, written[: -len(DRIVE_SUFFIX)])) is not None:
        return f"{axes[n].name}{DRIVE_SUFFIX}"
    return written
