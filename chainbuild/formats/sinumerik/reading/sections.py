"""What an archive of a whole control holds besides data: programs, tool offsets that are not read; notations."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from chainbuild.errors import Span
from chainbuild.findings import Collector

_KIND: Final = re.compile(r"(?:_|%)([A-Z]{3})\d*$", re.IGNORECASE | re.ASCII)
_NUMBERED: Final = re.compile(r"%\d+", re.ASCII)  # a program by its number
# Kinds of sections of an archive: those with data, and those with programs and their definitions.
_DATA_SECTIONS = ("TEA", "INI", "TOA", "SEA", "UFR")
_PROGRAM_SECTIONS = ("MPF", "SPF", "CYC", "DEF")
_OFFSETS = {
    "ADPT": "tool adapters",
    "CARR": "tool carriers",
    "SCP": "wear that depends on the location",
    "ECP": "setting-up offsets that depend on the location",
}


@dataclass(slots=True)
class Section:
    """A section of an archive that holds no data.

    Attributes:
        name: As its header names it.
        span: The header.
        program: True for programs and definitions, False where the kind is unknown.
        own: Number of its lines that name data of the transformation.
    """

    name: str
    span: Span
    program: bool
    own: int = 0


def section_without_data(header: str, span: Span) -> Section | None:
    """Return the section that a header begins, or None where it holds data.

    Args:
        header: Such as %_N_CH1_TEA.
        span: Its line.
    """
    kind = _KIND.search(header)
    word = kind[1].upper() if kind else ""
    if word in _DATA_SECTIONS:
        return None
    return Section(header, span, word in _PROGRAM_SECTIONS or _NUMBERED.fullmatch(header) is not None)


def report_sections(sections: Sequence[Section], collector: Collector) -> None:
    """Count the programs of an archive; warn of data of the transformation in a section of unknown kind."""
    programs = [section for section in sections if section.program]
    if programs:
        own = sum(section.own for section in programs)
        text = f"programs are not read: {len(programs)}, the first is {programs[0].name}"
        text += f"; lines of them that name data of the transformation: {own}" if own else ""
        collector.add("CB120", text, span=next((s.span for s in programs if s.own), programs[0].span))
    for section in sections:
        if section.own and not section.program:
            text = f"the section {section.name} is not read; lines with data of the transformation: {section.own}"
            permitted = f"%_N_…_{', _'.join(_DATA_SECTIONS)}, or no header"
            collector.add("CB121", text, span=section.span, permitted=permitted)


def report_notations(lines: Sequence[Span], collector: Collector) -> None:
    """Note what is read though no archive writes it so."""
    text = f"lines written as the manual prints them, not as an archive holds them: {len(lines)}"
    collector.add("CB122", text, span=lines[0], hint="one element a line: NAME[index]=value")


def report_tool_offsets(found: Mapping[str, Span], collector: Collector) -> None:
    """Warn of tool data that act on the control but not here, by the beginning of their names."""
    for name, span in found.items():
        what = _OFFSETS[name]
        text = f"the file gives {what} ($TC_{name}…), which are not read: the tool is taken without them"
        hint = "where they act, put the sum of lengths into the overlay: [tool] TC_DP3, TC_DP4, TC_DP5"
        collector.add("CB123", text, span=span, parameter=f"$TC_{name}", hint=hint)
