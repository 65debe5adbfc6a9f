"""Reading a TwinCAT CNC file: its lists become channels, tools and axis lists of a machine."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Final

from chainbuild.errors import Span
from chainbuild.findings import Collector
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.text import SourceText, is_xml, read_source
from chainbuild.formats.twincat.lists.axislist import AxisList, read_axis_list
from chainbuild.formats.twincat.lists.channel import read_channel
from chainbuild.formats.twincat.lists.config import Channel, errors_collected_by
from chainbuild.formats.twincat.lists.container import Section, read_container
from chainbuild.formats.twincat.lists.reader import Line, read_list
from chainbuild.formats.twincat.lists.toollist import Tool, read_tools
from chainbuild.formats.twincat.machine import Content, TwinCatMachine
from chainbuild.formats.twincat.types.catalogue import why_unsupported

_TOOLS_NAMED: Final = 8  # fit on a line; the others are counted


def read_machine(source: SourceText, path: Path, overlay: Overlay, collector: Collector) -> TwinCatMachine:
    """Read a TwinCAT CNC file: a parameter list (.lis) or a project with lists (.tsproj, .xti).

    Args:
        source: The file's text.
        path: The file.
        overlay: What the file beside it adds; `axis_lists` names files with one axis list each, in channel order
            where they have no names, and `tool.number` the active tool of the list.
        collector: Takes findings; strict: the first error is raised.

    Raises:
        ParseError: syntax of a list or of the container.
        MachineDataError: a value or index out of range, a missing or repeated id, no kinematic at all.
    """
    sections: Sequence[Section] = ()
    with errors_collected_by(collector):
        sections = _sections(source)
    channels, tools = _channels(sections, source.file, collector)
    lists = [
        (read_axis_list(read_list(section.lines, source.file, collector), section.facts, collector), _number(section))
        for section in sections
        if section.kind == "axis"
    ]
    for name in overlay.axis_lists:
        lists.extend((entry, "") for entry in _axis_lists(name, collector))
    if not any(channel.trafos for channel in channels) and not _has_errors(collector):
        slip = next((finding for finding in collector.findings if finding.code == "CB215"), None)
        hint = f"line {slip.span.line}: {slip.hint}" if slip is not None and slip.span is not None else None
        collector.add(
            "CB213", "the file configures no kinematic", span=Span(source.file), hint=hint,
            permitted="trafo[0].id and the like",
        )  # fmt: skip
    _note_tools(tools, overlay, source.file, collector)
    content = Content(channels, tools, tuple(lists))
    _warn_unsupported(channels, collector)
    return TwinCatMachine(source.file, path, overlay, collector, content)


def _sections(source: SourceText) -> tuple[Section, ...]:
    if is_xml(source.text):
        return read_container(source)
    lines = tuple(Line(number, text) for number, text in enumerate(source.lines(), start=1))
    return (Section("channel", lines),)


def _channels(
    sections: Sequence[Section], file: str, collector: Collector
) -> tuple[tuple[Channel, ...], tuple[Mapping[int, Tool], ...]]:
    """Return channels and their tools; a tool list belongs to the channel list before it, else to the first."""
    channels: list[Channel] = []
    tools: list[dict[int, Tool]] = [{}]
    for section in sections:
        if section.kind == "axis":
            continue
        parameters = read_list(section.lines, file, collector)
        if section.kind == "channel":
            channels.append(read_channel(parameters, collector, len(channels), section.facts.get("Name", "")))
            if len(channels) > len(tools):
                tools.append({})
        tools[-1].update(read_tools(parameters, collector))
    return tuple(channels), tuple(tools)


def _note_tools(tools: Iterable[Mapping[int, Tool]], overlay: Overlay, file: str, collector: Collector) -> None:
    """Note that a file holds tools of which none is active."""
    found = [tool for of_channel in tools for tool in of_channel.values()]
    if found and "number" not in overlay.tool:
        names = ", ".join(f"wz[{tool.number}] ({tool.length_mm:g} mm)" for tool in found[:_TOOLS_NAMED])
        more = f" and {len(found) - _TOOLS_NAMED} more" if len(found) > _TOOLS_NAMED else ""
        hint = f"choose one in the overlay: [tool] number = {found[0].number}"
        collector.add("CB246", f"no tool is active; the file holds {names}{more}", span=found[0].span, hint=hint)


def _number(section: Section) -> str:
    """Return the channel number, from 1, that an axis of a project belongs to; empty or 0: any."""
    return section.facts.get("DefaultChannel", "")


def _axis_lists(path: Path, collector: Collector) -> list[AxisList]:
    """Return the axis lists of a file that the overlay names."""
    with errors_collected_by(collector):
        source = read_source(path)
        sections = _sections(source)
        if not is_xml(source.text):
            sections = (Section("axis", sections[0].lines),)
        found = [
            read_axis_list(read_list(section.lines, source.file, collector), section.facts, collector)
            for section in sections
            if section.kind == "axis"
        ]
        if not any(entry.lower is not None or entry.upper is not None for entry in found):
            collector.add("CB231", "the axis list sets no software limits", span=Span(source.file))
        return found
    return []


def _has_errors(collector: Collector) -> bool:
    return any(finding.severity == "error" for finding in collector.findings)


def _warn_unsupported(channels: Iterable[Channel], collector: Collector) -> None:
    for channel in channels:
        for trafo in channel.trafos:
            reason = why_unsupported(trafo.type)
            if reason is not None:
                collector.add("CB223", reason, span=trafo.span)
