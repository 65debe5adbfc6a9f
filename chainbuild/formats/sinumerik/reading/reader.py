"""Reader of SINUMERIK machine data: text → assignments with their place in the file."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final

from chainbuild.errors import ChainbuildError, MachineDataError, ParseError, Span
from chainbuild.findings import Collector
from chainbuild.formats.sinumerik.reading.assignment import Assignment
from chainbuild.formats.sinumerik.reading.catalogue import MachineDatum, lookup, lookup_number
from chainbuild.formats.sinumerik.reading.misspelt import (
    TE4_DATUM,
    UnknownDatum,
    has_own_name,
    unknown_datum,
    warn_nameless,
    warn_of_unknown,
)
from chainbuild.formats.sinumerik.reading.sections import (
    Section,
    report_notations,
    report_sections,
    report_tool_offsets,
    section_without_data,
)
from chainbuild.formats.sinumerik.reading.values import (
    ElementIndex,
    Refusal,
    Value,
    check_value,
    elements_of,
    parse_index,
    parse_value,
    printed_elements,
    without_checksum,
)
from chainbuild.formats.text import SourceText

# Blanks only before the words, no line ends: a run of empty lines would be tried again from each of them.
_ANY_CASE = re.IGNORECASE | re.ASCII
_HEADER = re.compile(r"\s*%(?=\w)(?:_N_)?(?:CH(?P<channel>\d{1,2})_|TOA?(?P<area>\d{1,2})_)?\w*", _ANY_CASE)
_CHANDATA = re.compile(r"\s*(?:N\d+\s*)?CHANDATA\b\s*(.*)$", _ANY_CASE)
# The value runs to the end of the line, whose blanks are cut off beforehand: it always fits, nothing is tried twice.
_ASSIGNMENT = re.compile(
    r"""\s*(?:(?P<mark>N|MD|SD|(?=\d+\s*[$A-Z\[=]))\s*(?P<number>\d{1,9})(?!\d)\s*)?
        (?P<name>\$?[A-Z][A-Z0-9_]*)?\s*
        (?:\[(?P<index>[^\]]*)(?P<close>\])?)?\s*
        =?\s*(?P<value>.*)$""",
    _ANY_CASE | re.VERBOSE | re.DOTALL,
)
# Names that no NC program uses for anything else, so that they are known without their $ and prefix, too.
_PLAIN_NAME = re.compile(r"(?:ROBX|TRAFO6|TRAFO_TYPE|TRAFO_AXES_IN|TRAFO_INCLUDES_TOOL|AXCONF)_[A-Z0-9_]+", _ANY_CASE)
_KINEMATIC_CHAIN = re.compile(r"\s*(?:N\d+\s*)?\$NK_", _ANY_CASE)
_TOOL_OFFSETS = re.compile(r"\$TC_(ADPT|CARR|SCP|ECP)", _ANY_CASE)
_BIT = re.compile(r"\.\s*bit\s*(\d{1,2})\s*={0,2}\s*([01]|TRUE|FALSE)", _ANY_CASE)
_MISPRINT = ("ROBX_AXIS_SEQ", "23", "3")  # ROBX manual 5.3.15 prints [23] for [3]
_PROGRAM_END = re.compile(r"\s*(?:N\d+\s*)?(?:M0?2|M17|M30|RET)\s*", _ANY_CASE)
_ESCAPE = re.compile(r"\\([$_\[\]])")
_DATUM_MARKS = ("MD", "SD")
_PARSE_CODES = ("CB101", "CB102", "CB103", "CB104")
_MAX_CHANNEL: Final = 99  # two digits in the header of a file


@dataclass(frozen=True, slots=True)
class Reading:
    """What a file assigns.

    Attributes:
        file: Name for messages.
        assignments: In file order.
        channels: Channels that CHANDATA or headers name, in file order; (1,) where none is named.
        ignored: Number of lines with data that are not used.
        refused: Number of lines that were refused (lenient collector only).
        kinematic_chain: The first line of a kinematic chain ($NK_), or None.
    """

    file: str
    assignments: tuple[Assignment, ...]
    channels: tuple[int, ...]
    ignored: int
    refused: int
    kinematic_chain: Span | None = None


@dataclass(slots=True)
class _State:
    """State while one file is read."""

    file: str
    collector: Collector
    assignments: list[Assignment] = field(default_factory=list)
    channel: int = 1
    channels: tuple[int, ...] = ()
    area: int = 0
    ignored: int = 0
    refused: int = 0
    unknown_data: list[UnknownDatum] = field(default_factory=list)
    section: Section | None = None
    sections: list[Section] = field(default_factory=list)
    notations: list[Span] = field(default_factory=list)
    tool_offsets: dict[str, Span] = field(default_factory=dict)
    kinematic_chain: Span | None = None


def read_assignments(source: SourceText, collector: Collector) -> Reading:
    """Read every assignment of a machine data file.

    Args:
        source: The text.
        collector: Takes the findings; a strict one raises at the first error.

    Raises:
        ParseError: a line with a known datum cannot be read.
        MachineDataError: an index or value outside what the catalogue permits.
    """
    state = _State(source.file, collector)
    for number, raw in enumerate(source.lines(), start=1):
        _read_line(state, number, raw)
    for unknown in state.unknown_data:
        warn_of_unknown(unknown, state.assignments, collector)
    if state.sections:
        report_sections(state.sections, collector)
    if state.notations:
        report_notations(state.notations, collector)
    if state.tool_offsets:
        report_tool_offsets(state.tool_offsets, collector)
    if state.ignored:
        text = f"unrelated lines ignored: {state.ignored}"
        collector.add("CB110", text, span=Span(source.file))
    channels = state.channels or (1,)
    return Reading(source.file, tuple(state.assignments), channels, state.ignored, state.refused, state.kinematic_chain)


def _read_line(state: _State, number: int, raw: str) -> None:
    line = _without_comment(raw)
    if not line.strip():
        return
    if match := _HEADER.match(line):
        _enter_section(state, match, Span(state.file, number, 1, raw))
    elif state.section is not None:
        state.section.own += has_own_name(line)
    elif match := _CHANDATA.match(line):
        _chandata(state, match[1], Span(state.file, number, raw.find("(") + 2, raw))
    elif not _PROGRAM_END.fullmatch(line):
        _assignment(state, Span(state.file, number, 1, raw), _ESCAPE.sub(r"\1", line))


def _without_comment(line: str) -> str:
    """Cut a line at the first semicolon outside double quotes."""
    if '"' not in line:
        return line.partition(";")[0]
    quoted = False
    for position, character in enumerate(line):
        if character == '"':
            quoted = not quoted
        elif character == ";" and not quoted:
            return line[:position]
    return line


def _chandata(state: _State, rest: str, span: Span) -> None:
    match = re.fullmatch(r"\(\s*(\d{1,4})\s*\)", without_checksum(rest.strip()), re.ASCII)
    channel = int(match[1]) if match else 0
    if 1 <= channel <= _MAX_CHANNEL:
        _enter_channel(state, channel)
        return
    state.refused += 1
    text = f"CHANDATA{rest.strip()[:40]} names no channel"
    permitted = f"CHANDATA(1) to CHANDATA({_MAX_CHANNEL})"
    state.collector.add("CB112", text, span=span, permitted=permitted, error=ParseError)


def _enter_section(state: _State, match: re.Match[str], span: Span) -> None:
    """Go on with the channel, tool area and kind of section that a header names."""
    state.section = section_without_data(match[0].strip(), span)
    if state.section is not None:
        state.sections.append(state.section)
        return
    _enter_channel(state, int(match["channel"]) if match["channel"] else None)
    state.area = int(match["area"] or 0)


def _enter_channel(state: _State, channel: int | None) -> None:
    state.channel = 1 if channel is None else channel
    state.area = 0
    if channel is not None and channel not in state.channels:
        state.channels += (channel,)


def _assignment(state: _State, line_span: Span, line: str) -> None:
    match = _ASSIGNMENT.match(line.rstrip())
    datum = _datum(match) if match else None
    if match is None or datum is None:
        _not_ours(state, line_span, line, match)
        return
    te4 = bool(TE4_DATUM.match(match["name"])) if match["name"] else int(match["number"]) == datum.te4_number
    span = _at(line_span, match)
    _compare_number(state, match, datum, te4, span)
    try:
        for index, value in _values(state, datum, match, span):
            state.assignments.append(Assignment(datum, te4, index, value, state.channel, span, state.area))
    except Refusal as refusal:
        _refuse(state, refusal, _designation(datum, te4, match["index"]), span)


def _values(
    state: _State, datum: MachineDatum, match: re.Match[str], span: Span
) -> Iterator[tuple[ElementIndex, Value]]:
    """Yield index and value of what a line assigns: one element, or with SET and REP several from its index on."""
    text = without_checksum(match["value"])
    bit = _BIT.fullmatch(text) if datum.type == "hex" else None
    if bit is not None:
        state.notations.append(span)
        index = _index(datum, match)
        yield index, _with_bit(state, datum, index, bit)
        return
    printed = printed_elements(match["index"], text) if datum.indexed_by == "element" else None
    if printed is not None or (datum.name, match["index"]) == _MISPRINT[:2]:
        state.notations.append(span)
    start = _index(datum, match) if match["index"] is not None and printed is None else None
    first = start if isinstance(start, int) else 0
    elements = elements_of(text, max(datum.dimension - first, 0)) if printed is None else printed
    if elements is None:
        index = _index(datum, match)
        yield index, _checked(datum, index, text)
        return
    if datum.indexed_by != "element":
        raise Refusal("CB105", "SET and REP assign the elements of an array, not axes or tools", "one value a line")
    for n, element in enumerate(elements, start=first):
        index = parse_index(datum, str(n))
        yield index, _checked(datum, index, element)


def _with_bit(state: _State, datum: MachineDatum, index: ElementIndex, bit: re.Match[str]) -> float:
    """Return a mask with one bit changed: that of the file so far, else the default."""
    element = index if isinstance(index, int) else 0
    value = (datum.default or (0.0,) * (element + 1))[element]
    for row in state.assignments:
        if row.datum is datum and (row.index, row.channel) == (index, state.channel):
            value = row.value if isinstance(row.value, float) else value
    mask = 1 << int(bit[1])
    changed = int(value) | mask if bit[2].upper() in ("1", "TRUE") else int(value) & ~mask
    return float(changed)


def _checked(datum: MachineDatum, index: ElementIndex, text: str) -> Value:
    value = parse_value(text, string=datum.type == "string")
    check_value(datum, index if isinstance(index, int) else 0, value)
    return value


def _datum(match: re.Match[str]) -> MachineDatum | None:
    """Find the datum a line assigns: by name, or by number alone after MD or SD."""
    if match["name"]:
        datum = lookup(match["name"])
        # A bare word is a datum only where it cannot be anything else: archives also contain NC programs.
        return datum if match["name"].startswith("$") or _PLAIN_NAME.fullmatch(match["name"]) else None
    if match["number"] and match["mark"].upper() in _DATUM_MARKS:
        return lookup_number(int(match["number"]))
    return None


def _index(datum: MachineDatum, match: re.Match[str]) -> ElementIndex:
    if match["index"] is not None and match["close"] is None:
        raise Refusal("CB101", "the bracket of the index is not closed", "NAME[index]=value")
    name, misprint, meant = _MISPRINT
    return parse_index(datum, meant if (datum.name, match["index"]) == (name, misprint) else match["index"])


def _at(line_span: Span, match: re.Match[str]) -> Span:
    """Return the span of a value in its line, or of the line's first character where there is none."""
    raw, value = line_span.text, match["value"]
    # Escapes come before the value: what they add to the line is the difference to its beginning.
    shift = raw.find(match.string[match.start("value") :], match.start("value")) if value else -1
    column = shift + 1 if shift >= 0 else len(raw) - len(raw.lstrip()) + 1
    return Span(line_span.file, line_span.line, column, raw)


def _designation(datum: MachineDatum, te4: bool, index: str | None) -> str:
    """Return the designation of a datum in messages: number, name and index."""
    number, name = (datum.te4_number, datum.te4_name) if te4 else (datum.number, datum.name)
    head = f"MD{number} " if number else ""
    return f"{head}${datum.prefix}_{name}" + (f"[{index.strip()}]" if index is not None else "")


def _refuse(state: _State, refusal: Refusal, parameter: str, span: Span) -> None:
    state.refused += 1
    error: type[ChainbuildError] = ParseError if refusal.code in _PARSE_CODES else MachineDataError
    text = f"{parameter}: {refusal.text}"
    state.collector.add(refusal.code, text, span=span, parameter=parameter, permitted=refusal.permitted, error=error)


def _compare_number(state: _State, match: re.Match[str], datum: MachineDatum, te4: bool, span: Span) -> None:
    """Warn where the number before a name, with or without a mark, is another datum's.

    An N may also be a plain block number.
    """
    if not match["name"] or not match["number"]:
        return
    number, own = int(match["number"]), datum.te4_number if te4 else datum.number
    if own is None or number == own or (match["mark"].upper() == "N" and lookup_number(number) is None):
        return
    text = f"{match['mark'].upper()}{number} is not the number of {_designation(datum, te4, None)}; the name is used"
    state.collector.add("CB109", text, span=span)


def _not_ours(state: _State, span: Span, line: str, match: re.Match[str] | None) -> None:
    """Count a line that assigns no known datum; warn where it nevertheless names one of the transformation."""
    state.ignored += 1
    if state.kinematic_chain is None and _KINEMATIC_CHAIN.match(line):
        state.kinematic_chain = span
    if offsets := _TOOL_OFFSETS.search(line):
        state.tool_offsets.setdefault(offsets[1].upper(), span)
    if not has_own_name(line):
        warn_nameless(match, span, state.collector)
    elif unknown := unknown_datum(line, state.channel, span, state.collector):
        state.unknown_data.append(unknown)
