"""The table of a robot's Denavit-Hartenberg parameters: one row a joint, lengths in mm, angles in degrees.

A comment before the header says which of the two conventions it has; without one nothing is read, since the same
numbers are two different robots.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from chainbuild import tolerances
from chainbuild.chain.elements import JointKind
from chainbuild.chain.names import name_fault
from chainbuild.closest import closest
from chainbuild.errors import ParseError, Span
from chainbuild.tables.sheet import TableText, is_number, spot

DhConvention = Literal["standard", "modified"]

FORMULAS: Final[Mapping[DhConvention, str]] = {
    "standard": "T = Rz(theta) Tz(d) Tx(a) Rx(alpha)",
    "modified": "T = Rx(alpha) Tx(a) Rz(theta) Tz(d)",
}
_WORDS: Final[Mapping[str, DhConvention]] = {
    "standard": "standard", "classic": "standard", "distal": "standard",
    "modified": "modified", "craig": "modified", "proximal": "modified",
}  # fmt: skip
_EXPLAINED: Final = (
    "write it as a first line: '# standard' where a and alpha of a row act behind its joint "
    f"({FORMULAS['standard']}), '# modified' where they act before it (Craig: {FORMULAS['modified']}, "
    "a and alpha of the link before); the same numbers are two different robots"
)
_UNITS: Final = {"a": "mm", "d": "mm", "alpha": "deg", "theta": "deg"}
_ENDS: Final = ("lower", "upper")
_COLUMNS: Final = (*_UNITS, "kind", *_ENDS, "name")
_SPELLINGS: Final = {
    "α": "alpha",
    "θ": "theta",
    "type": "kind",
    "min": "lower",
    "max": "upper",
    "joint": "name",
    "i": "name",
    "link": "name",
    "no": "name",
    "no.": "name",
    "nr": "name",
    "nr.": "name",
}
_UNIT_NAMES: Final = {"mm": "mm", "deg": "deg", "degree": "deg", "degrees": "deg", "°": "deg"}
_HEADING: Final = re.compile(r"([^\[\]()]*?)\s*(?:[\[(]([^\])]*)[\])]|_(mm|deg|m|rad))?")
# The index that books write: a(i-1), α_i-1, d_i; the one of the link before is Craig's notation.
_INDEX: Final = re.compile(
    r"\s*(alpha|theta|[adαθ])\s*_?\s*[({]?\s*[ijn]\s*(?P<before>[-−–]\s*1)?\s*[)}]?\s*(?=[\[(]|_|$)", re.IGNORECASE
)
_OFFSET: Final = "add it to theta of the row, of a prismatic joint to d: theta and d are the values at axis value 0"
_KINDS: Final[Mapping[str, JointKind | Literal["fixed"]]] = {
    "revolute": "revolute", "rotary": "revolute", "r": "revolute",
    "prismatic": "prismatic", "linear": "prismatic", "p": "prismatic",
    "fixed": "fixed",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class DhJoint:
    """One row: a joint, or a constant transform.

    Attributes:
        name: Name of its axis; empty for a constant transform.
        kind: "revolute": the axis turns about z, added to theta; "prismatic": it shifts along z, added to d; "fixed".
        values: "a", "d" in mm and "alpha", "theta" in degrees.
        limits: (lower, upper) in degrees or mm, where given.
        spans: Where each value is.
    """

    name: str
    kind: JointKind | Literal["fixed"]
    values: Mapping[str, float]
    limits: tuple[float, float] | None
    spans: Mapping[str, Span]


@dataclass(frozen=True, slots=True)
class DhTable:
    """The rows of a file.

    Attributes:
        convention: "standard" or "modified".
        rows: Its rows, from the base.
        span: Where the convention is given.
    """

    convention: DhConvention
    rows: tuple[DhJoint, ...]
    span: Span


def read_table(path: Path) -> DhTable:
    """Read a table of Denavit-Hartenberg parameters.

    Raises:
        FileAccessError: the file cannot be read.
        TableError: it is no table.
        ParseError: it does not say its convention, a column is missing or unknown, or a row makes no sense.
    """
    sheet = TableText(path)
    try:
        convention, place = _convention(sheet)
        columns = _columns(sheet, convention)
        lines = [_Line(sheet, columns, number, text, fields) for number, text, fields in sheet.rows()]
    finally:
        sheet.close()
    rows = tuple(_rows(lines))
    if not any(row.name for row in rows):
        raise ParseError("the table has no joints", span=Span(str(path)), permitted="a row for each joint")
    return DhTable(convention, rows, place)


def _convention(sheet: TableText) -> tuple[DhConvention, Span]:
    """Return the convention that the comments before the header name, and where.

    Raises:
        ParseError: none, or both.
    """
    found: dict[DhConvention, Span] = {}
    for number, line in sheet.comments:
        for word in re.findall(r"[a-z]+", line.casefold()):
            if word in _WORDS:
                found.setdefault(_WORDS[word], Span(sheet.file, number, 1, line))
    if len(found) > 1:
        raise ParseError("the comments name both conventions", span=[*found.values()][1], permitted="one of them")
    if not found:
        text = "the table does not say which Denavit-Hartenberg convention it has"
        raise ParseError(text, span=sheet.header_span, permitted="# standard or # modified", hint=_EXPLAINED)
    return next(iter(found.items()))


def _columns(sheet: TableText, convention: DhConvention) -> dict[str, int]:
    """Return where each column is.

    Raises:
        ParseError: one is missing, unknown, there twice, in another unit, or of the link before in a standard table.
    """
    found: dict[str, int] = {}
    parts = sheet.header_span.text.split(sheet.separator)
    for place, written in enumerate(sheet.header):
        index = _INDEX.match(written)
        name, unit = _named(written if index is None else index[1] + written[index.end() :])
        where = spot(sheet.header_span, parts, place)
        if index is not None and index["before"] and convention == "standard":
            text = f"column '{written}' is of the link before, as in a modified table, but the comment says standard"
            raise ParseError(text, span=where, parameter=written, permitted=f"{name}, or # modified", hint=_EXPLAINED)
        if name not in _COLUMNS:
            near = closest(name, _COLUMNS)
            raise ParseError(
                f"unknown column '{written}'", span=where, parameter=written, permitted=", ".join(_COLUMNS),
                hint=_OFFSET if name.casefold() == "offset" else f"did you mean {near}?" if near else None,
            )  # fmt: skip
        wanted = _UNITS.get(name)
        if unit and _UNIT_NAMES.get(unit) != wanted:
            text = f"column '{written}': {name} is in {wanted or 'the unit of its joint, which its kind tells'}"
            raise ParseError(text, span=where, parameter=written, permitted=f"{name} [{wanted}]" if wanted else name)
        if name in found:
            raise ParseError(f"column '{name}' occurs twice", span=where, parameter=written)
        found[name] = place
    missing = [name for name in _UNITS if name not in found]
    if missing:
        text = f"missing column{'s' * (len(missing) > 1)} {', '.join(missing)}"
        raise ParseError(text, span=sheet.header_span, parameter=missing[0], permitted=", ".join(_COLUMNS))
    return found


def _named(written: str) -> tuple[str, str]:
    """Return the name of a column without its unit, and the unit."""
    match = _HEADING.fullmatch(written.strip())
    name, *units = ("", "") if match is None else (part.strip().casefold() for part in match.groups(""))
    return _SPELLINGS.get(name, name) or written, "".join(units)


class _Line:
    """A row of the file while it is read."""

    def __init__(self, sheet: TableText, columns: Mapping[str, int], number: int, text: str, fields: list[str]) -> None:
        self.span = Span(sheet.file, number, 1, text)
        fields += [""] * (len(sheet.header) - len(fields))
        if len(fields) > len(sheet.header):
            wrong = f"the row has {len(fields)} values, the header {len(sheet.header)} columns"
            raise ParseError(wrong, span=self.span, permitted=f"one value each for {', '.join(sheet.header)}")
        self._raw = fields
        self._fields = sheet.with_points(fields, self.span, sheet.header)
        self._columns = columns

    def text(self, name: str) -> str:
        """Return the text of a column; an empty string where there is none."""
        return self._fields[self._columns[name]].strip() if name in self._columns else ""

    def spot(self, name: str) -> Span:
        """Return where a column is; the line where there is none."""
        return spot(self.span, self._raw, self._columns[name]) if name in self._columns else self.span

    def number(self, name: str) -> float:
        """Return a number.

        Raises:
            ParseError: the field holds none.
        """
        text = self.text(name)
        value = float(text) if is_number(text) and text.isascii() and "_" not in text else math.nan
        if abs(value) < tolerances.HUGE_AXIS_VALUE:
            return value
        unit = _UNITS.get(name, "mm or deg")
        wrong = "no value" if not text else f"'{text[:40]}' is not a number"
        variable = name in ("d", "theta") and text
        hint = f"{name} is the value at axis value 0: where a table has a variable, write 0" if variable else None
        permitted = f"a number in {unit}, without thousands separators, below {tolerances.HUGE_AXIS_VALUE:g}"
        raise ParseError(
            f"column {name}: {wrong}", span=self.spot(name), parameter=name, permitted=permitted, hint=hint
        )

    def kind(self) -> JointKind | Literal["fixed"]:
        """Return the kind of the joint; without the column it is revolute.

        Raises:
            ParseError: it is none.
        """
        if "kind" not in self._columns:
            return "revolute"
        text = self.text("kind")
        if text.casefold() not in _KINDS:
            permitted = "revolute (R), prismatic (P), or fixed for a row without joint"
            wrong = f"'{text[:40]}' is no kind of a joint" if text else "the row has no kind"
            raise ParseError(wrong, span=self.spot("kind"), parameter="kind", permitted=permitted)
        return _KINDS[text.casefold()]

    def limits(self) -> tuple[float, float] | None:
        """Return the limits; None where both fields are empty.

        Raises:
            ParseError: one alone, or lower not below upper.
        """
        given = [name for name in _ENDS if self.text(name)]
        if not given:
            return None
        lower, upper = (self.number(name) for name in _ENDS)
        if not lower < upper:
            text = f"the limits leave no range: {lower:g} to {upper:g}"
            raise ParseError(text, span=self.spot("lower"), parameter="lower", permitted="lower below upper")
        return lower, upper


def _rows(lines: Sequence[_Line]) -> Iterator[DhJoint]:
    """Yield the rows; joints without a name are A1, A2, … .

    Raises:
        ParseError: a row that makes no sense, or a name that another has.
    """
    names: dict[str, Span] = {}
    for number, line in enumerate(lines, start=1):
        kind = line.kind()
        values = {name: line.number(name) for name in _UNITS}
        spans = {name: line.spot(name) for name in _UNITS}
        given = line.text("name")
        if given == str(number):  # a column that counts the rows
            given = ""
        if kind == "fixed":
            if given or line.limits():
                raise ParseError("a fixed row has no axis: it has no name and no limits", span=line.span)
            yield DhJoint("", kind, values, None, spans)
            continue
        name = given or f"A{len(names) + 1}"
        fault = name_fault(name)
        if fault is not None:
            raise ParseError(fault[0], span=line.spot("name"), parameter="name", permitted=fault[1])
        if name.casefold() in names:
            text = f"two axes are called {name}"
            raise ParseError(text, span=line.spot("name"), parameter="name", permitted="a name of its own for each")
        names[name.casefold()] = line.span
        yield DhJoint(name, kind, values, line.limits(), spans)
