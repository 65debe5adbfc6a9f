"""Table of a file's machine data: the last assignment of each element wins, defaults come from the catalogue."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Final

from chainbuild.errors import Span
from chainbuild.findings import Collector
from chainbuild.formats.sinumerik.reading.assignment import Assignment
from chainbuild.formats.sinumerik.reading.catalogue import MachineDatum, catalogue
from chainbuild.formats.sinumerik.reading.reader import Reading
from chainbuild.formats.sinumerik.reading.values import ElementIndex, Value

_SHARED: Final = 0  # stands for "no channel" in keys: NC, axis and tool data are the same for all channels
DatumKey = tuple[int, bool, str, ElementIndex]


@dataclass(frozen=True, slots=True)
class DataTable:
    """The assignments of a file that are in force.

    Attributes:
        reading: What was read.
        rows: (channel, tool area or 0, TE4 name?, datum name, index) → the assignment that won.
    """

    reading: Reading
    rows: Mapping[DatumKey, Assignment]

    def channel(self, number: int, *, te4: bool = False) -> ChannelData:
        """Return the data of one channel, under ROBX's names or under TE4's."""
        return ChannelData(self, number, te4)

    def axis(self, name: str, machine_axis: str) -> Assignment | None:
        """Return the assignment of an axis datum such as POS_LIMIT_MINUS, or None."""
        return self.rows.get((_SHARED, False, name, machine_axis))

    def shared(self, name: str, index: int | None) -> Assignment | None:
        """Return the assignment of an NC or option datum, or None."""
        return self.rows.get((_SHARED, False, name, index))

    def texts(self, name: str) -> set[str]:
        """Return all strings of a datum in capitals, those of all channels together."""
        return {str(row.value).upper() for row in self.rows.values() if row.datum.name == name}

    def tool_areas(self) -> tuple[int, ...]:
        """Return the tool areas that sections of the file name."""
        return tuple(sorted({row.area for row in self.rows.values() if row.datum.prefix == "TC" and row.area}))

    def tools(self, area: int) -> Mapping[tuple[int, int], Mapping[str, Assignment]]:
        """Return the tool data of an area by (tool, cutting edge) and name, with those of no area."""
        result: dict[tuple[int, int], dict[str, Assignment]] = {}
        for row in sorted(self.rows.values(), key=lambda row: row.area):
            if isinstance(row.index, tuple) and row.area in (_SHARED, area):
                result.setdefault(row.index, {})[row.datum.name] = row
        return result


@dataclass(frozen=True, slots=True)
class ChannelData:
    """The data of one channel as one package sees them.

    Attributes:
        table: The file's table.
        channel_number: Channel.
        te4: True where the package is TE4: its TRAFO6_* data are read in place of ROBX_*.
    """

    table: DataTable
    channel_number: int
    te4: bool

    def row(self, name: str, index: int | None = None) -> Assignment | None:
        """Return the assignment of a channel datum, or None; `name` is ROBX's also where TE4 is read."""
        te4 = self.te4 and catalogue()[name].te4_name is not None
        return self.table.rows.get((self.channel_number, te4, name, index))

    def number(self, name: str, index: int | None = None) -> float:
        """Return the value of an element: the file's, else the default, else 0."""
        row = self.row(name, index)
        if row is not None and not isinstance(row.value, str):
            return row.value
        default = catalogue()[name].default or catalogue()[name].default_known
        element = index or 0
        return default[element] if element < len(default) else 0.0

    def numbers(self, name: str) -> tuple[float, ...]:
        """Return all elements of a datum."""
        return tuple(self.number(name, n) for n in range(catalogue()[name].dimension))

    def integers(self, name: str) -> tuple[int, ...]:
        """Return all elements of an integer datum."""
        return tuple(int(value) for value in self.numbers(name))

    def vector(self, name: str) -> tuple[float, float, float]:
        """Return a datum of three elements."""
        x, y, z = self.numbers(name)
        return x, y, z

    def given(self, name: str) -> bool:
        """Tell whether the file gives any element of a datum."""
        return self.span(name) is not None

    def span(self, name: str) -> Span | None:
        """Return where the file gives a datum, its last element first, or None."""
        dimension = catalogue()[name].dimension
        indices: Iterable[int | None] = (None,) if dimension == 1 else reversed(range(dimension or 100))
        rows = (self.row(name, index) for index in indices)
        return next((row.span for row in rows if row is not None), None)

    def package_rows(self, *, te4: bool) -> list[Assignment]:
        """Return the assignments of one package's data in this channel."""
        return [
            row
            for (channel, row_te4, _, _), row in self.table.rows.items()
            if channel == self.channel_number and row_te4 == te4 and row.datum.te4_name
        ]


def tabulate(reading: Reading, collector: Collector) -> DataTable:
    """Build the table of a file; a repeated assignment is replaced, with a warning where the values differ."""
    rows: dict[DatumKey, Assignment] = {}
    equal: list[Assignment] = []
    for row in reading.assignments:
        channel = row.channel if row.datum.prefix == "MC" else row.area if row.datum.prefix == "TC" else _SHARED
        key = (channel, row.te4, row.datum.name, row.index)
        before = rows.pop(key, None)
        if before is not None and before.value == row.value:
            equal.append(row)
        elif before is not None:
            name = written_name(row.datum, row.te4, row.index)
            text = f"{name} is assigned in line {before.span.line}, too; the last value, {_shown(row.value)}, is used"
            collector.add("CB113", text, span=row.span, parameter=name)
        rows[key] = row
    if equal:
        first = written_name(equal[0].datum, equal[0].te4, equal[0].index)
        text = f"assignments repeated with the same value: {len(equal)}, the first is {first}"
        collector.add("CB117", text, span=equal[0].span)
    return DataTable(reading, rows)


def with_values(table: DataTable, values: Mapping[DatumKey, tuple[float, Span]]) -> DataTable:
    """Return a table with other values of some channel and tool data.

    Args:
        table: The table.
        values: (channel or tool area, TE4 name?, datum name, index) → value, and the place of one that the file
            does not give.
    """
    rows = dict(table.rows)
    for key, (value, span) in values.items():
        channel, te4, name, index = key
        row = rows.get(key)
        if row is None:
            area = channel if isinstance(index, tuple) else _SHARED
            row = Assignment(catalogue()[name], te4, index, value, channel, span, area)
        rows[key] = replace(row, value=value)
    return DataTable(table.reading, rows)


def _shown(value: Value) -> str:
    return f'"{value}"' if isinstance(value, str) else f"{value:.10g}"


def written_name(datum: MachineDatum, te4: bool, index: ElementIndex = None) -> str:
    """Return a datum's name as written in a file."""
    name = f"${datum.prefix}_{datum.te4_name if te4 else datum.name}"
    if index is None:
        return name
    return f"{name}[{','.join(str(i) for i in index) if isinstance(index, tuple) else index}]"
