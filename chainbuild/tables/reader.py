"""The reader of CSV tables: header by name, rows in chunks, every fault with its line and column."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from chainbuild import tolerances
from chainbuild.chain.elements import Axis
from chainbuild.chain.names import DRIVE_SUFFIX, RESERVED_COLUMNS, axis_index
from chainbuild.closest import closest
from chainbuild.errors import Span, TableError
from chainbuild.tables.sheet import TableText, is_number, spot

_CHUNK_ROWS: Final = 1024  # arrays of so many rows cost less than the rows' text
_GROUPED: Final = re.compile(r"[+-]?\d{1,3}(?:[.,'’\s]\d{3})+(?:[.,]\d*)?")
_MEASURE: Final = re.compile(r"[+-]?[\d.,]+ *(?:mm|m|deg|rad|°)", re.IGNORECASE)

_WITH_UNIT: Final = re.compile(r"([^\[\]()]*)(?:\[([^\[\]()]*)\]|\(([^\[\]()]*)\))")
_SPELLINGS: Final = {"mm": "mm", "deg": "deg", "degree": "deg", "degrees": "deg", "°": "deg"}
# Other units that people have, of axes of each unit: what one of them is there.
_OTHER_UNITS: Final = {
    "mm": {"m": "1000", "cm": "10", "µm": "0.001", "um": "0.001", "in": "25.4", "inch": "25.4"},
    "deg": {"rad": "57.29577951308232", "radian": "57.29577951308232", "radians": "57.29577951308232"},
}
# From the place of a column, what is wrong with it and what is permitted, to an error.
Fault = Callable[[int, str, str], TableError]
# From the column names of a header: the required columns in order, and all that are permitted.
Choice = tuple[Sequence[str], Sequence[str]]


@dataclass(frozen=True, slots=True, eq=False)
class Chunk:
    """Some rows of a table.

    Attributes:
        lines: (n,) line numbers, from 1.
        values: (n, columns) numbers of the wanted columns, in their order; behind them those of
            `Table.beside`, NaN where the file gives no number.
    """

    lines: tuple[int, ...]
    values: NDArray[np.float64]


class Table:
    """An open CSV table: the header is checked at once, rows are read on demand.

    Args:
        path: The file; "-" is standard input.
        choose: Takes the column names of the header and returns the wanted and the permitted ones.
        axes: Axes whose columns may go by another of their names, with a unit, or in another case.

    Attributes:
        file: File name for messages.
        size: Bytes of the file; 0 where it is a pipe.
        written: Column names as the header has them.
        names: Column names as `choose` knows them: those of `axes` by the axes' names.
        wanted: Column names in the order of `Chunk.values`.
        beside: Columns that are also read and may hold anything.

    Raises:
        FileAccessError: the file cannot be read.
        TableError: the header is missing, or names a column that is unknown or duplicate, or is incomplete, or gives
            an axis another unit than its own.
    """

    def __init__(self, path: Path | str, choose: Callable[[Sequence[str]], Choice], axes: Sequence[Axis] = ()) -> None:
        self._sheet = TableText(path, lambda: f"a table whose first line is {','.join(choose(())[0])}")
        self.file, self.size = self._sheet.file, self._sheet.size
        try:
            self.written, self.header_span = self._sheet.header, self._sheet.header_span
            self.names = canonical_columns(self.written, axes, self._header_fault)
            self.wanted, permitted = choose(self.names)
            self.beside = self._beside_columns()
            self._check_header(permitted, {f"{axis.name}{DRIVE_SUFFIX}" for axis in axes})
        except BaseException:
            self._sheet.close()
            raise
        self._places = [self.names.index(name) for name in self.wanted]
        self._beside_places = [self.names.index(name) for name in self.beside]

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._sheet.close()

    @property
    def position(self) -> int:
        """Bytes read so far; 0 where the file is a pipe."""
        return self._sheet.position

    def chunks(self) -> Iterator[Chunk]:
        """Read the rows that are left.

        Raises:
            TableError: a row is too short or too long, or a field is not a finite number.
        """
        lines: list[int] = []
        rows: list[list[float]] = []
        for number, line, fields in self._sheet.rows():
            lines.append(number)
            rows.append(self._row(number, line, fields))
            if len(rows) == _CHUNK_ROWS:
                yield Chunk(tuple(lines), np.array(rows))
                lines, rows = [], []
        if rows:
            yield Chunk(tuple(lines), np.array(rows))

    def error_at(self, number: int, text: str, permitted: str | None = None) -> TableError:
        """Return an error that points at a line by its number."""
        return TableError(text, span=Span(self.file, number), permitted=permitted)

    def _beside_columns(self) -> tuple[str, ...]:
        """Return the columns of the header that are read although nothing depends on them."""
        return ()

    def _shown_columns(self, permitted: Sequence[str]) -> Sequence[str]:
        """Return the permitted columns that messages name."""
        return permitted

    def _alternatives(self, missing: Sequence[str]) -> str:
        """Return the alternatives to missing columns, as the end of a sentence."""
        return ""

    def _hint(self, name: str) -> str | None:
        """Return what to say of a column that is not permitted, where there is more to say than its name."""
        return None

    def _check_header(self, permitted: Sequence[str], drives: Collection[str]) -> None:
        """Refuse wrong columns; those of drives, which fk writes and no command reads, may stand in every table."""
        shown = self._shown_columns(permitted)
        listed = ", ".join(shown)
        for place, (name, known) in enumerate(zip(self.written, self.names, strict=True)):
            if known not in permitted and known not in drives:
                text = f"unknown column '{name}'" if name else f"column {place + 1} has no name"
                near = closest(name, shown)
                hint = f"did you mean {near}?" if near else None
                hint = hint if _field_fault(name.replace(",", "."), "") else "the first line must name the columns"
                hint = self._hint(name) or hint
                raise TableError(text, span=self._header_spot(place), parameter=name, permitted=listed, hint=hint)
            if known in self.names[:place]:
                raise TableError(f"column '{name}' occurs twice", span=self._header_spot(place), parameter=name)
        missing = [name for name in self.wanted if name not in self.names]
        if missing:
            text = f"missing column{'s' * (len(missing) > 1)} {', '.join(missing)}{self._alternatives(missing)}"
            hint = self._hint(missing[0])
            raise TableError(text, span=self.header_span, parameter=missing[0], permitted=listed, hint=hint)

    def _header_fault(self, place: int, text: str, permitted: str) -> TableError:
        name = self.written[place]
        return TableError(text, span=self._header_spot(place), parameter=name, permitted=permitted)

    def _header_spot(self, place: int) -> Span:
        return spot(self.header_span, self.header_span.text.split(self._sheet.separator), place)

    def _row(self, number: int, line: str, fields: list[str]) -> list[float]:
        if len(fields) != len(self.names):
            raise self._wrong_count(Span(self.file, number, 1, line), len(fields))
        if self._sheet.separator != ",":
            fields = self._sheet.with_points(fields, Span(self.file, number, 1, line), self.written)
        fields = self._translated(number, fields)
        try:
            values = [float(fields[place]) for place in self._places]
        except ValueError:
            values = [math.nan]
        # float() also reads 1_000, digits of other scripts, nan and infinity: look closer where a row may hold some.
        if not line.isascii() or "_" in line or not all(abs(v) < tolerances.HUGE_AXIS_VALUE for v in values):
            self._refuse_faults(Span(self.file, number, 1, line), fields)
        return [*values, *(_number_or_nan(fields[place]) for place in self._beside_places)]

    def _translated(self, number: int, fields: list[str]) -> list[str]:
        """Return the fields of a row with those that are no plain numbers written as such."""
        return fields

    def _refuse_faults(self, span: Span, fields: Sequence[str]) -> None:
        for place in sorted(self._places):
            fault = _field_fault(fields[place], self._sheet.separator)
            if fault:
                raise TableError(
                    f"column {self.written[place]}: {fault}",
                    span=spot(span, fields, place),
                    parameter=self.written[place],
                    permitted=f"{self._numbers}, below {tolerances.HUGE_AXIS_VALUE:.0e}",
                )

    @property
    def _numbers(self) -> str:
        return "numbers with a decimal point" if self._sheet.separator == "," else "numbers with one decimal mark"

    def _wrong_count(self, span: Span, count: int) -> TableError:
        many = count > len(self.names) and self._sheet.separator == ","
        return TableError(
            f"the row has {count} value{'s' * (count != 1)}, the header {len(self.names)} columns",
            span=span,
            permitted=f"one value each for {', '.join(self.written)}",
            hint="where columns are separated by commas, decimals are written with a point" if many else None,
        )


def _field_fault(field: str, separator: str = ",") -> str:
    """Return what is wrong with a field that should hold a number, or an empty string."""
    text = field.strip()
    if not text:
        return "no value"
    named, value = f"'{text[:40]}'", float(text) if is_number(text) else math.nan
    known = text.isascii() and "_" not in text and is_number(text)
    wrong = (
        (_GROUPED.fullmatch(text) and not known, f"{named} has thousands separators: numbers are written without them"),
        (_MEASURE.fullmatch(text), f"{named} is no bare number: units stand in the header, as in X [mm]"),
        (
            separator == "," and ("," in text or ";" in text),
            f"{named} is not a number: decimals are written with a point, columns are separated by commas",
        ),
        (not known, f"{named} is not a number"),
        (not math.isfinite(value), f"{named} is not finite"),
        (abs(value) >= tolerances.HUGE_AXIS_VALUE, f"{text[:40]} is too large"),
    )
    return next((words for holds, words in wrong if holds), "")


def _number_or_nan(field: str) -> float:
    try:
        return float(field)
    except ValueError:
        return math.nan


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
