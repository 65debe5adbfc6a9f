"""A TwinCAT CNC machine: channels, tools and axis lists of a file, and the chain of a kinematic among them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from chainbuild.chain.elements import Chain
from chainbuild.errors import MachineDataError, OverlayError, Span
from chainbuild.findings import Collector
from chainbuild.machine import KinematicEntry, Machine, ParameterRow, choose_kinematic, finite_length_mm
from chainbuild.overlay import Overlay
from chainbuild.text import SourceText, read_source
from chainbuild.twincat.axislist import AxisList, read_axis_list
from chainbuild.twincat.catalogue import title_of, why_unsupported
from chainbuild.twincat.channel import read_channel
from chainbuild.twincat.config import UNKNOWN_ID_ALARM, Channel, Trafo, kept_by
from chainbuild.twincat.container import Section, is_container, read_container
from chainbuild.twincat.parameters import parameter_rows
from chainbuild.twincat.reader import ROOTS, Line, read_list
from chainbuild.twincat.source import DIALECT, Source
from chainbuild.twincat.toollist import Tool, find_tool, read_tools
from chainbuild.twincat.translate import translate

_TEXT: Final = re.compile(rf"^[ \t]*(?:{'|'.join(sorted(ROOTS))})(?=[ \t\[.]|$)", re.MULTILINE | re.IGNORECASE)
_COUPLING: Final = 210
_TOOL_KEYS: Final = ("number",)


def is_twincat(text: str) -> bool:
    """Return True where a text is a TwinCAT CNC parameter list, or XML: a project that may hold one."""
    return is_container(text) or _TEXT.search(text) is not None


@dataclass(frozen=True, slots=True)
class _Content:
    """What a file holds."""

    channels: tuple[Channel, ...]
    tools: tuple[Mapping[int, Tool], ...]
    axis_lists: tuple[tuple[AxisList, str], ...]


class TwinCatMachine(Machine):
    """A TwinCAT CNC machine.

    Attributes:
        channels: Channels in file order.
    """

    dialect = DIALECT

    def __init__(self, file: str, path: Path, overlay: Overlay, collector: Collector, content: _Content) -> None:
        super().__init__(path, overlay, collector)
        self.file = file
        self.channels = content.channels
        self._tools = content.tools
        self._axis_lists = content.axis_lists

    def kinematics(self) -> tuple[KinematicEntry, ...]:
        """Return the kinematics that the file configures, channel by channel."""
        return tuple(entry for channel in self.channels for entry, _ in self._entries(channel))

    def parameters(self, kinematic: int | str | None = None, channel: int | None = None) -> tuple[ParameterRow, ...]:
        """Return every parameter of a kinematic with value, meaning and source; the active tool's share is added."""
        collector = Collector(strict=False)
        source = self._source(kinematic, channel, 0.0, collector)
        return parameter_rows(source, collector)

    def chain(
        self,
        kinematic: int | str | None = None,
        channel: int | None = None,
        tool_length_mm: float = 0.0,
        conventions: Mapping[str, str] | None = None,
    ) -> Chain:
        """Translate a kinematic into a chain (see `Machine.chain`)."""
        collector = Collector(strict=self._collector.strict, findings=list(self.findings))
        source = self._source(kinematic, channel, tool_length_mm, collector)
        return translate(source, self.name, self.title, self.chosen_conventions(conventions), collector)

    def _source(
        self, kinematic: int | str | None, channel: int | None, tool_length_mm: float, collector: Collector
    ) -> Source:
        chosen = self._channel(channel, collector)
        trafo, second = self._trafo(chosen, kinematic, collector)
        tool = self._tool(chosen)
        length = finite_length_mm(tool_length_mm) + self.overlay.tool_length_mm + (tool.length_mm if tool else 0.0)
        lists = [entry for entry, number in self._axis_lists if number in ("", "0", str(chosen.index + 1))]
        return Source(trafo, chosen, tool, length, lists, self.overlay, second, trafo is self._main(chosen))

    def _main(self, channel: Channel) -> Trafo | None:
        """Return the kinematic that the overlay is written for: the one it names, else the default."""
        named = [trafo for trafo in channel.trafos if self.overlay.kinematic in (trafo.id, trafo.name)]
        return named[0] if named else self._default(channel)

    def _entries(self, channel: Channel) -> list[tuple[KinematicEntry, Trafo]]:
        default = self._default(channel)
        return [
            (
                KinematicEntry(
                    id=trafo.id,
                    name=trafo.name,
                    type=f"KIN_TYP {trafo.type}",
                    title=title_of(trafo.type),
                    channel=channel.index,
                    default=trafo is default,
                    span=trafo.span,
                ),
                trafo,
            )
            for trafo in channel.trafos
        ]

    def _default(self, channel: Channel) -> Trafo | None:
        """Return what `chain()` takes: the list's default, else the only coupling, else the first."""
        named = channel.default_trafo()
        if named is not None:
            return named
        couplings = [trafo for trafo in channel.trafos if trafo.type == _COUPLING]
        return couplings[0] if len(couplings) == 1 else next(iter(channel.trafos), None)

    def _channel(self, wanted: int | None, collector: Collector) -> Channel:
        indices = ", ".join(str(channel.index) for channel in self.channels)
        if wanted is not None:
            for channel in self.channels:
                if channel.index == wanted:
                    return channel
            raise MachineDataError(
                f"the file has no channel {wanted}", span=Span(self.file), parameter="channel", permitted=indices,
                code="CB404",
            )  # fmt: skip
        usable = [channel for channel in self.channels if channel.trafos]
        if not usable:
            raise MachineDataError("the file configures no kinematic", span=Span(self.file), code="CB213")
        if len(self.channels) > 1:
            text = f"the file has {len(self.channels)} channels; channel {usable[0].index} is taken"
            collector.add("CB406", text, span=usable[0].span, hint=f"choose another by its index: {indices}")
        return usable[0]

    def _trafo(self, channel: Channel, wanted: int | str | None, collector: Collector) -> tuple[Trafo, Trafo | None]:
        """Return a kinematic, and the one of the second step that stands on it by default."""
        if wanted is None:
            wanted = self.overlay.kinematic
        pairs = self._entries(channel)
        try:
            entry = choose_kinematic([entry for entry, _ in pairs], wanted, self.file)
        except MachineDataError as error:
            # The controller's error for an id that the list does not configure.
            raise _with_alarm(error, UNKNOWN_ID_ALARM if pairs else None) from None
        trafo = next(trafo for known, trafo in pairs if known is entry)
        if wanted is None:
            return trafo, self._second(channel, trafo, collector)
        return trafo, None

    def _second(self, channel: Channel, trafo: Trafo, collector: Collector) -> Trafo | None:
        """Return what stands on the default kinematic in the second step; refuse a default that does not exist."""
        named = channel.defaults.get(0)
        if named is not None and channel.default_trafo() is None:
            known = ", ".join(str(t.id) for t in channel.trafos)
            raise MachineDataError(
                f"the default kinematic {named.id or named.name!r} is not configured", span=named.span,
                permitted=known, alarm=UNKNOWN_ID_ALARM, code="CB222", hint="choose one of the configured kinematics",
            )  # fmt: skip
        second = channel.default_trafo(1)
        if second is not None and trafo.step == 0:
            return second
        if any(t.step == 1 for t in channel.trafos):
            collector.add("CB412", "the second transformation step has no default; only the first is built")
        return None

    def _tool(self, channel: Channel) -> Tool | None:
        """Return the tool that the overlay's `[tool] number = n` makes active, or None."""
        unknown = [key for key in self.overlay.tool if key not in _TOOL_KEYS]
        number = self.overlay.tool.get("number")
        if unknown or isinstance(number, tuple):
            key = unknown[0] if unknown else "number"
            file = str(self.overlay.path or self.file)
            raise OverlayError(
                f"the overlay's tool table cannot hold '{key}' like this for TwinCAT CNC", span=Span(file),
                parameter=f"tool.{key}", permitted="number = n, the i of wz[i]",
            )  # fmt: skip
        if number is None:
            return None
        own = self._tools[channel.index] if channel.index < len(self._tools) else {}
        return find_tool(own or {n: t for tools in self._tools for n, t in tools.items()}, number, self.file)


def _with_alarm(error: MachineDataError, alarm: int | None) -> MachineDataError:
    return MachineDataError(
        error.message, span=error.span, parameter=error.parameter, permitted=error.permitted, alarm=alarm, code="CB404"
    )


def read_machine(source: SourceText, path: Path, overlay: Overlay, collector: Collector) -> TwinCatMachine:
    """Read a TwinCAT CNC file: a parameter list (.lis) or a project with lists (.tsproj, .xti).

    Args:
        source: The file's text.
        path: The file.
        overlay: What the file beside it adds; `axis_lists` names files with one axis list each, in channel order
            where they bear no names, and `tool.number` the active tool of the list.
        collector: Takes findings; strict: the first error is raised.

    Raises:
        ParseError: syntax of a list or of the container.
        MachineDataError: a value or index out of range, a missing or repeated id, no kinematic at all.
    """
    sections: Sequence[Section] = ()
    with kept_by(collector):
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
        collector.add(
            "CB213", "the file configures no kinematic", span=Span(source.file), permitted="trafo[0].id and the like"
        )
    content = _Content(channels, tools, tuple(lists))
    machine = TwinCatMachine(source.file, path, overlay, collector, content)
    _warn_unsupported(machine, collector)
    return machine


def _sections(source: SourceText) -> tuple[Section, ...]:
    if is_container(source.text):
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


def _number(section: Section) -> str:
    """Return the channel number, from 1, that an axis of a project belongs to; empty or 0: any."""
    return section.facts.get("DefaultChannel", "")


def _axis_lists(path: Path, collector: Collector) -> list[AxisList]:
    """Return the axis lists of a file that the overlay names."""
    with kept_by(collector):
        source = read_source(path)
        sections = _sections(source)
        if not is_container(source.text):
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


def _warn_unsupported(machine: TwinCatMachine, collector: Collector) -> None:
    for channel in machine.channels:
        for trafo in channel.trafos:
            reason = why_unsupported(trafo.type)
            if reason is not None:
                collector.add("CB223", reason, span=trafo.span)
