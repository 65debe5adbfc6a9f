"""The text of a table as people and programs write it: encoding, separators, decimal marks, comments, blank rows.

Commas, semicolons or tabs separate the columns, whichever the header has; beside semicolons and tabs decimals may have
a comma, one mark in the whole table. Everything is read line by line, in constant memory, also from standard input.
"""

from __future__ import annotations

import csv
import io
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import BinaryIO, Final, Protocol, cast

from chainbuild import tolerances
from chainbuild.errors import FileAccessError, Span, TableError
from chainbuild.filekinds import binary_kind

STANDARD_INPUT: Final = "-"  # in place of a file name
_HEAD_BYTES: Final = 4096  # enough to tell what a file is
_SEPARATORS: Final = {",": "commas", ";": "semicolons", "\t": "tabs"}
_PERMITTED: Final = "commas, semicolons or tabs"
_EXCEL_LINE: Final = re.compile(r'"?sep=(.)"?[,;]*', re.IGNORECASE)  # tells Excel the separator of the file
_IN_BRACKETS: Final = re.compile(r"[\[(][^\[\]()]*[\])]")
_EXCEL_ERROR: Final = re.compile(r"\s*#(?:[A-ZÄÖÜ/0]+[!?]|N/A|NV\b)")  # a value that could not be computed, no comment
_BLANK: Final = re.compile(r'[\s;,"]*')
_BYTES_KEPT: Final = re.compile("[\udc80-\udcff]")  # what `surrogateescape` makes of bytes that are no UTF-8
_MARKS: Final = {",": "a comma", ".": "a point"}


class _Peekable(Protocol):
    def peek(self, size: int = 0, /) -> bytes: ...


class TableText:
    """An open table: its column names at once, its rows on demand.

    Args:
        path: The file; "-" is standard input.
        expected: Returns what a table looks like, for the error of a missing file.

    Attributes:
        file: File name for messages.
        size: Bytes of the file; 0 where it is a pipe.
        comments: The `#` lines before the header: number and text.
        separator: What separates the columns.
        header: The column names as they are written, without empty ones at the end.
        header_span: Where they are.

    Raises:
        FileAccessError: the file cannot be read.
        TableError: it is no text, or has no header.
    """

    def __init__(self, path: Path | str, expected: Callable[[], str] = str) -> None:
        self._owned = str(path) != STANDARD_INPUT
        self.file = str(path) if self._owned else "standard input"
        self._bytes, self.size = _opened(Path(path), self.file, expected) if self._owned else _standard_input()
        self._mark = ""  # the decimal mark of the table, once a number has shown it
        self._ahead: tuple[int, str] | None = None
        self.comments: list[tuple[int, str]] = []
        try:
            self._stream = self._text_stream()
            self._lines = self._numbered_lines()
            self.separator, self.header, self.header_span = self._read_header()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Close the file; standard input stays open."""
        if self._owned:
            self._bytes.close()
        elif hasattr(self, "_stream"):
            self._stream.detach()

    @property
    def position(self) -> int:
        """Bytes read so far; 0 where the file is a pipe."""
        return self._bytes.tell() if self.size else 0

    def rows(self) -> Iterator[tuple[int, str, list[str]]]:
        """Read the rows that are left: line number, the line as written, its fields; blank ones are left out.

        Raises:
            TableError: a line that is too long, or that is no CSV.
        """
        if self._ahead is not None:
            number, line = self._ahead
            yield number, line, self._fields(number, line)
        for number, line in self._lines:
            if line and not _is_comment(line) and not (line[0] in ' \t,;"' and _BLANK.fullmatch(line)):
                yield number, line, self._fields(number, line)

    def with_points(self, fields: list[str], span: Span, written: Sequence[str]) -> list[str]:
        """Return the fields of a row with decimal points for decimal commas.

        A table has one decimal mark: what may be a thousands separator, as in "1.234" below "1,5", is not read.

        Raises:
            TableError: numbers with both marks.
        """
        if self.separator == ",":
            return fields
        found = list(fields)
        for place, field in enumerate(fields):
            mark = "," if "," in field else "." if "." in field else ""
            if not mark or not is_number(pointed := field.replace(",", ".")):
                continue
            if self._mark and mark != self._mark:
                text = f"column {written[place]}: '{field.strip()[:40]}' has {_MARKS[mark]}, numbers before it have "
                text += f"{_MARKS[self._mark]}: one of the two may be a thousands separator"
                permitted = "one decimal mark in the whole table, and no thousands separators"
                raise TableError(text, span=spot(span, fields, place), parameter=written[place], permitted=permitted)
            self._mark, found[place] = mark, pointed
        return found

    def _fields(self, number: int, line: str) -> list[str]:
        """Return the fields of a row; empty ones behind the last column, which Excel writes, are left out."""
        if '"' in line:
            fields = quoted_fields(line, self.separator, Span(self.file, number, 1, line))
        else:
            fields = line.split(self.separator)
        while len(fields) > len(self.header) and not fields[-1].strip():
            fields.pop()
        return fields

    def _text_stream(self) -> io.TextIOWrapper:
        try:
            head = cast("_Peekable", self._bytes).peek(_HEAD_BYTES)[:_HEAD_BYTES]
        except OSError as error:
            raise unreadable_table(error, Span(self.file)) from None
        kind = binary_kind(head) if b"\0" in head or not head.isascii() else None
        if kind is not None:
            raise TableError(f"this is {kind.name}, no table", span=Span(self.file), permitted="CSV", hint=kind.table)
        encoding = _encoding(head)
        # Bytes that are no UTF-8 are kept, and their line is read as Latin-1: Excel writes the sign ° so.
        return io.TextIOWrapper(
            self._bytes, encoding=encoding, errors="strict" if encoding.startswith("utf-16") else "surrogateescape"
        )

    def _numbered_lines(self) -> Iterator[tuple[int, str]]:
        limit, number = tolerances.MAX_LINE_CHARACTERS, 0
        while True:
            number += 1
            try:
                # With a bound, so that a file without line ends cannot fill the memory.
                line = self._stream.readline(limit + 1)
            except UnicodeError:
                raise TableError("the text is not UTF-16 to its end", span=Span(self.file, number)) from None
            except OSError as error:
                raise unreadable_table(error, Span(self.file, number)) from None
            if not line:
                return
            if not line.isascii() and _BYTES_KEPT.search(line):
                line = line.encode("utf-8", "surrogateescape").decode("latin-1")
            if len(line) > limit:
                span = Span(self.file, number, 1, line[:80])
                raise TableError("the line is too long", span=span, permitted=f"at most {limit} characters a line")
            yield number, line.rstrip("\n")

    def _read_header(self) -> tuple[str, tuple[str, ...], Span]:
        given = ""
        for number, line in self._lines:
            span = Span(self.file, number, 1, line)
            if _BLANK.fullmatch(line):
                continue
            if _is_comment(line):
                self.comments.append((number, line))
            elif not given and (excel := _EXCEL_LINE.fullmatch(line.strip())) is not None:
                given = excel[1]
                if given not in _SEPARATORS:
                    raise TableError(f"the columns are separated by '{given}'", span=span, permitted=_PERMITTED)
            else:
                return self._named(line, given, span)
        raise TableError("the table is empty: its first line must name the columns", span=Span(self.file))

    def _named(self, line: str, given: str, span: Span) -> tuple[str, tuple[str, ...], Span]:
        """Return separator, names and place of a header.

        Where the first line has numbers alone, the comment before it names the columns, as numpy writes it.
        """
        separator = given or next((one for one in "\t;" if one in line), ",")
        names = _trimmed(quoted_fields(line, separator, span))
        place, comment = self.comments[-1] if self.comments else (0, "")
        above = _trimmed(comment.strip().lstrip("#").split(separator))
        numbers = all(is_number(name.replace(",", ".")) for name in names)
        if numbers and place and len(above) == len(names):
            self._ahead = span.line, line
            return separator, above, Span(self.file, place, 1, comment)
        inside = next((one for one in _SEPARATORS if any(one in name for name in names)), None)
        if inside is not None and not numbers:
            text = f"the header has {_SEPARATORS[separator]} and {_SEPARATORS[inside]}: one separates the columns"
            raise TableError(text, span=span, permitted=_PERMITTED)
        if len(names) == 1 and len(_IN_BRACKETS.sub(" ", names[0]).split()) > 1:
            raise TableError("the columns are separated by blanks", span=span, permitted=_PERMITTED)
        return separator, names, span


def is_number(field: str) -> bool:
    """Return True where a field is a number with a decimal point, or none."""
    try:
        float(field)
    except ValueError:
        return False
    return True


def spot(span: Span, fields: Sequence[str], place: int) -> Span:
    """Return the span of one field of a line."""
    return Span(span.file, span.line, 1 + sum(len(field) + 1 for field in fields[:place]), span.text)


def quoted_fields(line: str, separator: str, span: Span) -> list[str]:
    """Return the fields of a line, some of which may be in quotation marks.

    Raises:
        TableError: a quotation mark that is not closed.
    """
    try:
        return next(csv.reader([line], strict=True, delimiter=separator))
    except csv.Error as error:
        raise TableError(f"the line is not valid CSV: {error}", span=span) from None


def unreadable_table(error: OSError | ValueError, span: Span, permitted: str | None = None) -> FileAccessError:
    """Return the error of a table that the system does not read."""
    reason = error.strerror if isinstance(error, OSError) else None
    return FileAccessError(f"the table cannot be read: {reason or error}", span=span, permitted=permitted)


def _trimmed(names: Sequence[str]) -> tuple[str, ...]:
    """Return the names of columns without blanks around them, and without empty ones at the end."""
    found = [name.strip() for name in names]
    while len(found) > 1 and not found[-1]:
        found.pop()
    return tuple(found)


def _is_comment(line: str) -> bool:
    if "#" not in line:
        return False
    bare = line.lstrip(' \t"')  # a comment with a separator in it is a quoted cell to a spreadsheet
    return bare.startswith("#") and not _EXCEL_ERROR.match(bare)


def _encoding(head: bytes) -> str:
    """Return the encoding of a text by its mark, or by the zero bytes that UTF-16 has without one."""
    if head.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    zeros = [head[n::2].count(0) * 2 > len(head[n::2]) for n in (0, 1)]
    if any(zeros) and not all(zeros):
        return "utf-16-be" if zeros[0] else "utf-16-le"
    return "utf-8-sig"


def _opened(path: Path, file: str, expected: Callable[[], str]) -> tuple[BinaryIO, int]:
    """Return a file and its size in bytes, 0 for a pipe."""
    try:
        return path.open("rb"), path.stat().st_size
    except FileNotFoundError as error:
        # Shows a user without a table what one looks like.
        raise unreadable_table(error, Span(file), expected() or None) from None
    except (OSError, ValueError) as error:
        raise unreadable_table(error, Span(file)) from None


def _standard_input() -> tuple[BinaryIO, int]:
    stream = getattr(sys.stdin, "buffer", None)
    if stream is None or stream.closed:
        raise FileAccessError("standard input is closed: there is no table to read", span=Span("standard input"))
    return (stream if hasattr(stream, "peek") else io.BufferedReader(stream)), 0
