"""Tool lists: `wz[i].*`, added to the parameters of a kinematic while the tool is active."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Final

from chainbuild.errors import MachineDataError, Span
from chainbuild.findings import Collector
from chainbuild.formats.twincat.lists.config import (
    MAX_PARAM,
    RawValue,
    Trafo,
    checked_index,
    errors_collected_by,
    short_name,
)
from chainbuild.formats.twincat.lists.counts import Unit, check_lengths, check_number
from chainbuild.formats.twincat.lists.reader import Assignment, ParameterList
from chainbuild.units import mm_from_tenth_um

_MAX_AXIS: Final = 31  # a channel has 32 axes at most (P-TOOL-00006)
_MAX_TOOL: Final = 65535  # largest tool number: 16 bits
_MILLIMETRES: Final = 0  # value of mass_einheit; any other is inches
# Tool parameters that act on a kinematic, and the similarity from which another name is taken as misspelt.
_NAMES: Final = ("laenge", "radius", "kin_id", "kin_name", "mass_einheit", "kinematic", "kinematik", "wz_kopf_versatz",
                 "ax_versatz")  # fmt: skip
_MISSPELT: Final = 0.8  # likeness by difflib


@dataclass(frozen=True, slots=True)
class Tool:
    """A tool of the list.

    Attributes:
        number: i of wz[i].
        span: Where it is configured.
        length_mm: P-TOOL-00003.
        radius_mm: P-TOOL-00004.
        params: j → kinematic.param[j], the list's counts (P-TOOL-00009).
        kin_name: Partial kinematic that carries it (P-TOOL-00148), or an empty string.
        kin_id: Kinematic to be used with it (P-TOOL-00011); 0: the channel's default.
        axis_offsets: j → ax_versatz[j], the list's counts (P-TOOL-00006).
        places: "laenge" and "radius" → where the list gives them.
        inches: True where the list counts it in inches (P-TOOL-00008), which is not read.
    """

    number: int
    span: Span
    length_mm: float = 0.0
    radius_mm: float = 0.0
    params: Mapping[int, RawValue] = field(default_factory=dict)
    kin_name: str = ""
    kin_id: int = 0
    axis_offsets: Mapping[int, RawValue] = field(default_factory=dict)
    places: Mapping[str, Span] = field(default_factory=dict)
    inches: bool = False


def read_tools(parameters: ParameterList, collector: Collector) -> dict[int, Tool]:
    """Return the tools of a list by number.

    Raises:
        ParseError: a value is not a number or string.
        MachineDataError: an index or value is out of range.
    """
    grouped: dict[int, list[Assignment]] = {}
    for entry in parameters.under("wz"):
        with errors_collected_by(collector):
            grouped.setdefault(checked_index(entry, entry.keys[0][1], _MAX_TOOL), []).append(entry)
    return {number: _tool(number, entries, collector) for number, entries in grouped.items()}


def _tool(number: int, entries: Iterable[Assignment], collector: Collector) -> Tool:
    values: dict[str, float] = {}
    lengths: dict[str, RawValue] = {}
    params: dict[int, RawValue] = {}
    offsets: dict[int, RawValue] = {}
    kin_name, span = "", None
    for entry in entries:
        span = span or entry.span
        with errors_collected_by(collector):
            match entry.keys[1:]:
                # kinematic.wz_kopf_versatz is the spelling of versions up to 2.60.
                case (("kinematic" | "kinematik", None), ("param" | "wz_kopf_versatz", j)) | (("wz_kopf_versatz", j),):
                    params[checked_index(entry, j, MAX_PARAM)] = RawValue(
                        entry.number(), entry.name, entry.span, entry.raw
                    )
                case (("ax_versatz", j),):
                    value = RawValue(entry.number(), entry.name, entry.span, entry.raw)
                    offsets[checked_index(entry, j, _MAX_AXIS)] = value
                    check_number(value.value, entry.raw, entry.name, entry.span, "mm or deg", collector)
                case (("kin_name", None),):
                    kin_name = short_name(entry, collector)
                case ((("laenge" | "radius" | "kin_id" | "mass_einheit") as key, None),):
                    values[key] = entry.number()
                    unit: Unit = "mm" if key in ("laenge", "radius") else ""
                    check_number(values[key], entry.raw, entry.name, entry.span, unit, collector)
                    if unit:
                        lengths[key] = RawValue(values[key], entry.name, entry.span, entry.raw)
                case _:
                    _warn_misspelt(entry, collector)
    check_lengths(list(lengths.values()), f"length and radius of tool {number} are", "mm", collector)
    assert span is not None  # a tool exists by its entries
    return Tool(
        number=number,
        span=span,
        length_mm=mm_from_tenth_um(values.get("laenge", 0.0)),
        radius_mm=mm_from_tenth_um(values.get("radius", 0.0)),
        params=params,
        kin_name=kin_name,
        axis_offsets=offsets,
        kin_id=int(values.get("kin_id", 0)),
        places={key: entry.span for key, entry in lengths.items()},
        inches=values.get("mass_einheit", _MILLIMETRES) != _MILLIMETRES,
    )


def _warn_misspelt(entry: Assignment, collector: Collector) -> None:
    """Warn of an entry that looks like geometry but is not read; most entries of a tool do not concern its geometry."""
    name = entry.keys[1][0] if len(entry.keys) > 1 else ""
    close = difflib.get_close_matches(name[:80], _NAMES, 1, _MISSPELT)
    if close:
        meant = {"kinematic": "kinematic.param[k]", "kinematik": "kinematic.param[k]"}.get(close[0], close[0])
        text = f"{entry.name[:80]} is not a tool parameter that is read; it is ignored"
        hint = f"did you mean wz[{entry.keys[0][1]}].{meant}?"
        collector.add("CB245", text, span=entry.span, parameter=entry.name[:80], hint=hint)


def find_tool(tools: Mapping[int, Tool], number: float, span: Span) -> Tool:
    """Return a tool by number.

    Args:
        tools: The tools of the file.
        number: Its number.
        span: Place of the number.

    Raises:
        MachineDataError: the list has no such tool, or counts it in inches.
    """
    tool = tools.get(int(number)) if number == int(number) else None
    if tool is None:
        known = ", ".join(str(n) for n in sorted(tools)) or "none: the file holds no wz[i] entries"
        raise MachineDataError(
            f"the file has no tool {number:g}", span=span, parameter="tool.number", permitted=known, code="CB240"
        )
    if tool.inches:
        raise MachineDataError(
            f"tool {tool.number} is given in inches (mass_einheit), which is not read", span=tool.span,
            parameter=f"wz[{tool.number}].mass_einheit", permitted="0 (mm)", code="CB241",
        )  # fmt: skip
    return tool


def acting_params(tool: Tool | None, trafo: Trafo, collector: Collector) -> Mapping[int, RawValue]:
    """Return what a tool adds to the parameters of a kinematic: nothing in the second step (P-CHAN-00263)."""
    if tool is None:
        return {}
    if tool.kin_id not in (0, trafo.id):
        text = f"tool {tool.number} is meant for the kinematic with id {tool.kin_id}, not {trafo.id}"
        collector.add("CB244", text, span=tool.span)
    if not tool.params:
        return {}
    if trafo.step > 0:
        collector.add("CB242", "tool parameters act in the first transformation step only", span=tool.span)
        return {}
    if tool.kin_name and tool.kin_name != trafo.name:
        text = f"tool {tool.number} belongs to the kinematic {tool.kin_name!r}; its parameters are not added here"
        collector.add("CB243", text, span=tool.span)
        return {}
    return tool.params
