"""What is told of a machine's data, by commands and in reports: where limits come from, which data belong together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING, Final

_WITHOUT_CONTROL: Final = ("URDF", "Denavit-Hartenberg")  # dialects

if TYPE_CHECKING:
    from chainbuild.chain.elements import Chain
    from chainbuild.errors import Span
    from chainbuild.formats.entries import ParameterRow
    from chainbuild.formats.machine import Machine


def limits_source(machine: Machine, chain: Chain, n: int) -> str:
    """Return where the limits of the n-th axis come from.

    "machine data", of a URDF and of DH parameters "file"; "overlay", "assumed", or "limits together": what limits of
    the axis and its drive, or the reach of a head, leave together.
    """
    axis, overlay = chain.axes[n], machine.overlay
    if axis.assumed:
        return "assumed"
    given = [overlay.limits_of(chain.axes, n), overlay.limits_of(chain.axes, n, drives=True)]
    if (axis.lower, axis.upper) in given:
        return "overlay"
    own = "file" if chain.dialect in _WITHOUT_CONTROL else "machine data"
    return "limits together" if any(given) else own


def axis_meanings(chain: Chain) -> list[str]:
    """Return the meaning of each axis if the chain is one KIN_TYP whose table states it, else an empty list."""
    from chainbuild.formats.twincat.lists.hdtable import type_data

    number_text = chain.kinematic.removeprefix("KIN_TYP ")
    data = type_data().get(int(number_text)) if number_text.isdigit() else None
    if data is None or len(data.axes) != len(chain.axes):
        return []
    return [row.meaning for row in data.axes]


def arrays_of(rows: Sequence[ParameterRow]) -> Iterator[list[ParameterRow]]:
    """Yield parameters that belong together: the elements of an array, each other parameter by itself."""
    for _, group in groupby(rows, key=_kept_together):
        yield list(group)


def _kept_together(row: ParameterRow) -> tuple[object, ...]:
    """Return what the elements of one array have in common."""
    array = row.name.rpartition("[")[0] if row.name.startswith("$") and row.name.endswith("]") else row.name
    return (row.symbol, array, row.unit, row.meaning, row.source, row.given)


def array_name(group: Sequence[ParameterRow]) -> str:
    """Return the name of parameters that belong together: "$MC_ROBX_TX3P3_POS[0…2]"."""
    first, last = group[0], group[-1]
    return first.name if first is last else f"{first.name.removesuffix(']')}…{last.name.rpartition('[')[2]}"


def lines_of(group: Sequence[ParameterRow]) -> str:
    """Return the lines of the file that give parameters: "12–17", or that they have their default values."""
    if not group[0].given:
        return "default"
    first, last = line_of(group[0].span), line_of(group[-1].span)
    return "" if first is None else str(first) if first == last else f"{first}–{last}"


def line_of(span: Span | None) -> int | None:
    """Return the line of a span, or None."""
    return span.line or None if span else None
