"""Parameter lists of TwinCAT CNC: `name value` lines become assignments with their place in the file."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Final

from chainbuild.errors import ChainbuildError, ParseError, Span
from chainbuild.findings import Collector
from chainbuild.formats.text import TWINCAT_ROOTS
from chainbuild.formats.twincat.lists import values

_PART: Final = r"[A-Za-z_]\w*(?:\[[^\]\s]*\])*"
# The manuals print a blank after a dot in places; it is tolerated.
_ASSIGNMENT: Final = re.compile(rf"\s*(?P<name>{_PART}(?:\.[ \t]*{_PART})*)(?:[ \t]+(?P<value>.*))?$", re.ASCII)
# A second index makes a key without a name: linkage[0][3].
_KEY: Final = re.compile(r"([A-Za-z_]\w*)(?:\[([^\]]*)\])?|()\[([^\]]*)\]", re.ASCII)
_ROOT: Final = re.compile(r"\s*([A-Za-z_]\w*)", re.ASCII)
_INDEX_DIGITS: Final = 9
# Names with blanks where none belong: before or within brackets, or before a dot.
_SPACED: Final = re.compile(r"\s*[A-Za-z_]\w*(?:[ \t]*\[[ \t]*\d+[ \t]*\]|[ \t]*\.[ \t]*[A-Za-z_]\w*)+", re.ASCII)
_BROKEN: Final = re.compile(r"(?<=\S)[ \t]+[\[.\]]|\[[ \t]")
_MISSPELT_ROOTS: Final = TWINCAT_ROOTS - {"gruppe", "kenngr", "kopf", "kinematic_id", "ori"}
_ALIKE: Final = 0.75  # likeness by difflib: of four letters one may be wrong
_NAMED: Final = 3  # of the entries that are not read; the others are counted
_NAME_SHOWN: Final = 60  # characters of a name in a message

Key = tuple[str, int | None]


@dataclass(frozen=True, slots=True)
class Line:
    """A line of a list: its number in the file and its text."""

    number: int
    text: str


@dataclass(frozen=True, slots=True)
class Assignment:
    """One `name value` line.

    Attributes:
        name: Name as written, without blanks.
        keys: Name in parts, lower case: (("trafo", 0), ("param", 3)).
        raw: Everything after the name, comments included.
        span: Place of the name.
        value_column: Column of the value.
    """

    name: str
    keys: tuple[Key, ...]
    raw: str
    span: Span
    value_column: int

    def number(self) -> float:
        """Return the value as a finite number; raises ParseError."""
        return values.real_number(self.raw, self.name, self._value_span())

    def integer(self, lowest: int, highest: int) -> int:
        """Return the value as a whole number within bounds; raises ParseError or MachineDataError."""
        return values.whole_number(self.raw, self.name, self._value_span(), lowest, highest)

    def text(self) -> str:
        """Return the value as a string; raises ParseError."""
        return values.text(self.raw, self.name, self._value_span())

    def _value_span(self) -> Span:
        return Span(self.span.file, self.span.line, self.value_column, self.span.text)


@dataclass(frozen=True, slots=True)
class ParameterList:
    """A list as read.

    Attributes:
        assignments: Canonical name → the assignment that counts (the last one).
        ignored: How many entries have nothing to do with kinematics.
        ignored_names: The names of the first of them.
        span: Where the list begins.
    """

    assignments: Mapping[str, Assignment]
    ignored: int = 0
    span: Span | None = None
    ignored_names: tuple[str, ...] = ()

    def get(self, name: str) -> Assignment | None:
        """Return an assignment by its canonical name."""
        return self.assignments.get(name)

    def under(self, root: str) -> list[Assignment]:
        """Return the assignments whose first key is `root`, in file order."""
        return [entry for entry in self.assignments.values() if entry.keys[0][0] == root]


def canonical(keys: Iterable[Key]) -> str:
    """Return a name in its one spelling.

    >>> canonical((("param", 3), ("x", None)))
    'param[3].x'
    >>> canonical((("linkage", 0), ("", 3)))
    'linkage[0][3]'
    """
    parts = (name if index is None else f"{name}[{index}]" for name, index in keys)
    return ".".join(parts).replace(".[", "[")


@dataclass(slots=True)
class _Reading:
    """A list while it is read."""

    file: str
    collector: Collector
    found: dict[str, Assignment] = field(default_factory=dict)
    ignored: int = 0
    ended: bool = False
    late: Span | None = None
    strange: list[Line] = field(default_factory=list)
    unread: list[str] = field(default_factory=list)
    misspelt: dict[str, list[Line]] = field(default_factory=dict)
    equal: list[Span] = field(default_factory=list)

    def line(self, line: Line) -> None:
        text = line.text.strip()
        if not text or text[0] in "#(":
            return
        root = _root(line.text)
        if self.ended:
            self.late = self.late or (self.span(line) if root in TWINCAT_ROOTS else None)
        elif text.lower() == "ende":
            self.ended = True
        elif root in TWINCAT_ROOTS:
            self.assignment(line)
        else:
            self.unrelated(line)

    def unrelated(self, line: Line) -> None:
        match = _ASSIGNMENT.match(line.text)
        name = _squeezed(line.text) or (re.sub(r"\s", "", match["name"]) if match else None)
        if name is None:
            self.strange.append(line)
            return
        root = _root(line.text)
        if _nearest_root(root):
            self.misspelt.setdefault(root, []).append(line)
            return
        self.ignored += 1
        if len(self.unread) < _NAMED:
            self.unread.append(name[:_NAME_SHOWN])

    def assignment(self, line: Line) -> None:
        match = _ASSIGNMENT.match(line.text)
        squeezed = _squeezed(line.text)
        if match is None or squeezed:
            hint = "name and value are separated by blanks, without `=`" if "=" in line.text else None
            hint = f"a name holds no blanks; did you mean {squeezed}?" if squeezed else hint
            self.collector.add(
                "CB201", "the line is not a `name value` assignment", span=self.span(line), hint=hint, error=ParseError
            )
            return
        written = re.sub(r"\s", "", match["name"])
        span = self.span(line, match.start("name") + 1)
        keys = self.keys(written, span)
        if keys is not None:
            column = match.start("value") + 1 if match["value"] else match.end("name") + 1
            self.keep(Assignment(written, keys, (match["value"] or "").strip(), span, column))

    def keys(self, written: str, span: Span) -> tuple[Key, ...] | None:
        keys: list[Key] = []
        for part in _KEY.finditer(written):
            name, index = (part[1], part[2]) if part[1] else ("", part[4])
            if index is not None and not (index.isascii() and index.isdigit() and len(index) <= _INDEX_DIGITS):
                self.collector.add(
                    "CB203", f"the index in {written} is not a plain number", span=span, parameter=written,
                    permitted=f"at most {_INDEX_DIGITS} digits, such as [0]", error=ParseError,
                )  # fmt: skip
                return None
            keys.append((name.lower(), None if index is None else int(index)))
        return tuple(keys)

    def keep(self, entry: Assignment) -> None:
        keys = entry.keys
        if keys[0][0] == "trafo":  # trafo[j].* is short for kin_step[0].trafo[j].*
            keys = (("kin_step", 0), *keys)
        name = canonical(keys)
        earlier = self.found.get(name)
        if earlier is not None and _same_value(earlier, entry):
            self.equal.append(entry.span)
        elif earlier is not None:
            self.collector.add(
                "CB205", f"{entry.name} is assigned twice; this value is used, not the one in line {earlier.span.line}",
                span=entry.span, parameter=entry.name,
            )  # fmt: skip
        self.found[name] = Assignment(entry.name, keys, entry.raw, entry.span, entry.value_column)

    def span(self, line: Line, column: int = 1) -> Span:
        return Span(self.file, line.number, column, line.text)


@cache
def _nearest_root(root: str) -> str | None:
    """Return the structure that a first word was probably meant to be, or None."""
    close = difflib.get_close_matches(root[:_NAME_SHOWN], sorted(_MISSPELT_ROOTS), 1, _ALIKE)
    return close[0] if close else None


def _squeezed(text: str) -> str | None:
    """Return a name that blanks at its brackets or dots break apart, without them; None where none do.

    >>> _squeezed("trafo[ 0 ].param [6] 5"), _squeezed("trafo[0]. param[6] .5")
    ('trafo[0].param[6]', None)
    """
    match = _SPACED.match(text)
    if match is None or not _BROKEN.search(match[0]):
        return None
    return re.sub(r"\s", "", match[0])[:_NAME_SHOWN]


def _same_value(first: Assignment, second: Assignment) -> bool:
    if first.raw == second.raw:
        return True
    try:
        return first.number() == second.number()
    except ChainbuildError:
        return False


def _root(text: str) -> str:
    match = _ROOT.match(text)
    return match[1].lower() if match else ""


def read_list(lines: Iterable[Line], file: str, collector: Collector) -> ParameterList:
    """Read a parameter list.

    Args:
        lines: The list's lines with their numbers in the file.
        file: File name for messages.
        collector: Takes findings; strict: the first error is raised.

    Raises:
        ParseError: a line about kinematics, tools or axes is not an assignment, or an index is not a number.
    """
    reading = _Reading(file, collector)
    first: Span | None = None
    for line in lines:
        first = first or Span(file, line.number)
        reading.line(line)
    if reading.strange:
        line = reading.strange[0]
        text = f"{len(reading.strange)} line(s) are not parameters, first {line.text.strip()[:60]!r}"
        collector.add("CB207", text, span=reading.span(line))
    for root, where in reading.misspelt.items():
        text = f"entries that begin with '{root[:_NAME_SHOWN]}' are not read: {len(where)}"
        hint = f"did you mean {_nearest_root(root)}?"
        collector.add("CB215", text, span=reading.span(where[0]), parameter=root[:_NAME_SHOWN], hint=hint)
    if reading.equal:
        text = f"entries repeated with the same value: {len(reading.equal)}"
        collector.add("CB214", text, span=reading.equal[0])
    if reading.late is not None:
        collector.add("CB208", "the list continues after `Ende`; nothing behind it is read", span=reading.late)
    return ParameterList(reading.found, reading.ignored, first, tuple(reading.unread))
