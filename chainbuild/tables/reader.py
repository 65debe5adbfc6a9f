"""The reader of CSV tables: header by name, rows in chunks, every fault with its line and column."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import suppress
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
from chainbuild.errors import FileAccessError, Span, TableError

_CHUNK_ROWS: Final = 1024  # arrays of so many rows cost less than the rows' text
_SEPARATORS: Final = {";": "semicolons", "\t": "tabs"}

# From the column names of a header: the required columns in order, and all that are permitted.
Choice = tuple[Sequence[str], Sequence[str]]
_WITH_UNIT: Final = re.compile(r"([^\[\]]*)\[([^\[\]]*)\]")
_SPELLINGS: Final = {"mm": "mm", "deg": "deg", "degree": "deg", "degrees": "deg", "°": "deg"}
# From the place of a column, what is wrong with it and what is permitted, to an error.
Fault = Callable[[int, str, str], TableError]


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
        path: The file.
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
        path = Path(path)
        self.file = str(path)
        try:
            self._bytes = path.open("rb")
            self.size = path.stat().st_size
        except FileNotFoundError as error:
            # Shows a user without a table what one looks like.
            expected = f"a table whose first line is {','.join(choose(())[0])}"
            raise _unreadable(error, Span(self.file), expected) from None
        except (OSError, ValueError) as error:
            raise _unreadable(error, Span(self.file)) from None
        self._stream = io.TextIOWrapper(self._bytes, encoding="utf-8-sig")
        self._lines = self._numbered_lines()
        try:
            self.written, self.header_span = self._header()
            self.names = canonical_columns(self.written, axes, self._header_fault)
            self.wanted, permitted = choose(self.names)
            self.beside = self._beside_columns()
            self._check_header(permitted, {f"{axis.name}{DRIVE_SUFFIX}" for axis in axes})
        except BaseException:
            self._stream.close()
            raise
        self._places = [self.names.index(name) for name in self.wanted]
        self._beside_places = [self.names.index(name) for name in self.beside]

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stream.close()

    @property
    def position(self) -> int:
        """Bytes read so far; 0 where the file is a pipe."""
        return self._bytes.tell() if self.size else 0

    def chunks(self) -> Iterator[Chunk]:
        """Read the rows that are left.

        Raises:
            TableError: a row is too short or too long, or a field is not a finite number.
        """
        lines: list[int] = []
        rows: list[list[float]] = []
        for number, line in self._lines:
            if line.strip():
                lines.append(number)
                rows.append(self._row(number, line))
            if len(rows) == _CHUNK_ROWS:
                yield Chunk(tuple(lines), np.array(rows))
                lines, rows = [], []
        if rows:
            yield Chunk(tuple(lines), np.array(rows))

    def error_at(self, number: int, text: str, permitted: str | None = None) -> TableError:
        """Return an error that points at a line by its number."""
        return TableError(text, span=Span(self.file, number), permitted=permitted)

    def _numbered_lines(self) -> Iterator[tuple[int, str]]:
        limit, number = tolerances.MAX_LINE_CHARACTERS, 0
        while True:
            number += 1
            try:
                # With a bound, so that a file without line ends cannot fill the memory.
                line = self._stream.readline(limit + 1)
            except UnicodeDecodeError:
                place = max(number, _first_undecodable_line(self.file)) if self.size else number
                raise TableError("the table is not UTF-8 text: save it as UTF-8", span=Span(self.file, place)) from None
            except OSError as error:
                raise _unreadable(error, Span(self.file, number)) from None
            if not line:
                return
            if len(line) > limit:
                span = Span(self.file, number, 1, line[:80])
                raise TableError("the line is too long", span=span, permitted=f"at most {limit} characters a line")
            yield number, line.rstrip("\n")

    def _header(self) -> tuple[tuple[str, ...], Span]:
        for number, line in self._lines:
            if not line.strip():
                continue
            span = Span(self.file, number, 1, line)
            for separator, words in _SEPARATORS.items():
                if separator in line:
                    raise TableError(f"the columns are separated by {words}", span=span, permitted="commas")
            return tuple(name.strip() for name in _quoted_fields(line, span)), span
        raise TableError("the table is empty: its first line must name the columns", span=Span(self.file))

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
                hint = hint if _field_fault(name) else "the first line must name the columns"
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
        return _spot(self.header_span, self.header_span.text.split(","), place)

    def _row(self, number: int, line: str) -> list[float]:
        fields = line.split(",") if '"' not in line else _quoted_fields(line, Span(self.file, number, 1, line))
        if len(fields) != len(self.names):
            raise self._wrong_count(Span(self.file, number, 1, line), len(fields))
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
            fault = _field_fault(fields[place])
            if fault:
                raise TableError(
                    f"column {self.written[place]}: {fault}",
                    span=_spot(span, fields, place),
                    parameter=self.written[place],
                    permitted=f"numbers with a decimal point, below {tolerances.HUGE_AXIS_VALUE:.0e}",
                )

    def _wrong_count(self, span: Span, count: int) -> TableError:
        many = count > len(self.names)
        return TableError(
            f"the row has {count} value{'s' * (count != 1)}, the header {len(self.names)} columns",
            span=span,
            permitted=f"one value each for {', '.join(self.written)}",
            hint="decimals are written with a point, not with a comma" if many else None,
        )


def _first_undecodable_line(file: str) -> int:
    """Return the line that is not UTF-8; the decoder works ahead of the lines and does not report it."""
    number = 0
    with Path(file).open("rb") as stream, suppress(UnicodeDecodeError):
        while line := stream.readline(tolerances.MAX_LINE_CHARACTERS):
            number += 1
            line.decode("utf-8")
    return number


def _quoted_fields(line: str, span: Span) -> list[str]:
    try:
        return next(csv.reader([line], strict=True))
    except csv.Error as error:
        raise TableError(f"the line is not valid CSV: {error}", span=span) from None


def _field_fault(field: str) -> str:
    """Return what is wrong with a field that should hold a number, or an empty string."""
    text = field.strip()
    if not text:
        return "no value"
    if "," in text or ";" in text:
        return f"'{text[:40]}' is not a number: decimals are written with a point, columns are separated by commas"
    try:
        value = float(text)
    except ValueError:
        value = math.nan
        if not text.isascii() or text.lower().lstrip("+-") != "nan":
            return f"'{text[:40]}' is not a number"
    if "_" in text or not text.isascii():
        return f"'{text[:40]}' is not a number"
    if not math.isfinite(value):
        return f"'{text[:40]}' is not finite"
    return "" if abs(value) < tolerances.HUGE_AXIS_VALUE else f"{text[:40]} is too large"


def _number_or_nan(field: str) -> float:
    try:
        return float(field)
    except ValueError:
        return math.nan


def _spot(span: Span, fields: Sequence[str], place: int) -> Span:
    """Return the span of one field of a line."""
    return Span(span.file, span.line, 1 + sum(len(field) + 1 for field in fields[:place]), span.text)


def _unreadable(error: OSError | ValueError, span: Span, permitted: str | None = None) -> FileAccessError:
    reason = error.strerror if isinstance(error, OSError) else None
    return FileAccessError(f"the table cannot be read: {reason or error}", span=span, permitted=permitted)


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
