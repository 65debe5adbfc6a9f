"""Findings on lines that look like the transformation's data but assign none: a misspelt or missing name."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final

from chainbuild.errors import Span
from chainbuild.findings import Collector
from chainbuild.formats.sinumerik.reading.assignment import Assignment
from chainbuild.formats.sinumerik.reading.catalogue import MachineDatum, catalogue, lookup, lookup_number
from chainbuild.formats.sinumerik.reading.values import ElementIndex, Value

_ANY_CASE = re.IGNORECASE | re.ASCII
OWN_DATUM: Final = re.compile(r"(?:\$MC_)?(?:ROBX|TRAFO6)_[A-Z0-9_]+", _ANY_CASE)
TE4_DATUM: Final = re.compile(r"(?:\$MC_)?TRAFO6_", _ANY_CASE)
_ASSIGNED: Final = re.compile(r"\s*(?:\[[^\]]*\])?\s*=(?!=)\s*\S")
_SHOWN: Final = 60  # characters of a name in a message


@dataclass(frozen=True, slots=True)
class UnknownDatum:
    """A line that names an unknown datum of the transformation.

    Attributes:
        name: The name as written, shortened.
        channel: Channel of the line.
        span: The line.
    """

    name: str
    channel: int
    span: Span


def unknown_datum(line: str, channel: int, span: Span, collector: Collector) -> UnknownDatum | None:
    """Return the unknown datum that a line names; warn of a line that names a known one but assigns nothing."""
    named = OWN_DATUM.search(line)
    if named is None:
        return None
    if lookup(named[0].upper()) is None:
        return UnknownDatum(named[0][:_SHOWN], channel, span)
    if _ASSIGNED.match(line, named.end()):
        text = f"the line assigns {named[0]}, but other text stands before it; it was ignored"
        collector.add("CB111", text, span=span, hint=f"begin the line with the name, not with '{line.strip()[:20]}…'")
    else:
        collector.add("CB111", f"the line names {named[0]} but assigns nothing; it was ignored", span=span)
    return None


def has_own_name(line: str) -> bool:
    """Tell whether a line holds a name of the transformation's data, known or not."""
    return OWN_DATUM.search(line) is not None


def warn_of_unknown(unknown: UnknownDatum, assignments: list[Assignment], collector: Collector) -> None:
    """Warn of a misspelt datum: the nearest name, and the value that counts in its place.

    Args:
        unknown: What the line names.
        assignments: Everything the file assigns.
        collector: Takes the finding.
    """
    te4 = TE4_DATUM.match(unknown.name) is not None
    known = {(datum.te4_name or datum.name) if te4 else datum.name: datum for datum in _own_data()}
    bare = unknown.name.upper().removeprefix("$MC_")
    close = difflib.get_close_matches(bare, known, 1)
    text, hint = f"{unknown.name} is not a known machine datum; it was ignored", None
    if close:
        datum = known[close[0]]
        given = {
            row.index: row.value
            for row in assignments
            if row.datum is datum and row.te4 == te4 and row.channel == unknown.channel
        }
        short = close[0].partition("_")[2]
        text += f", and {short} keeps {'the value' if given else 'its default'} {_shown(datum, given)}"
        hint = f"did you mean $MC_{close[0]}?"
    collector.add("CB108", text, span=unknown.span, parameter=unknown.name, hint=hint)


def _shown(datum: MachineDatum, given: Mapping[ElementIndex, Value]) -> str:
    """Return the values of a datum in force, as a list: the file's, else the default, else a question mark."""
    return ", ".join(_elements(datum, given))


def _elements(datum: MachineDatum, given: Mapping[ElementIndex, Value]) -> Iterator[str]:
    default = datum.default or datum.default_known
    for n in range(datum.dimension):
        value = given.get(None if datum.dimension == 1 else n)
        if value is None and n < len(default):
            value = default[n]
        yield "?" if value is None else f"{value:.10g}" if isinstance(value, float | int) else value


def warn_nameless(match: re.Match[str] | None, span: Span, collector: Collector) -> None:
    """Warn where a block number is that of a datum of the transformation and a value follows, but no name."""
    if match is None or not match["number"] or match["name"] or not match["value"]:
        return
    datum = lookup_number(int(match["number"]))
    if datum is None or not datum.te4_name:
        return
    te4 = int(match["number"]) == datum.te4_number
    name = f"$MC_{datum.te4_name}" if te4 else datum.identifier
    text = f"{match['mark'].upper()}{match['number']} is the number of {name}, but the line names no datum; ignored"
    collector.add("CB116", text, span=span, hint=f"write MD{match['number']}, or the name")


def _own_data() -> list[MachineDatum]:
    return [datum for datum in catalogue().values() if datum.te4_name]
