"""A TwinCAT CNC machine: channels, tools and axis lists of a file, and the chain of a kinematic among them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from chainbuild.chain.elements import Chain
from chainbuild.errors import ChainbuildError, MachineDataError, Span
from chainbuild.findings import Collector
from chainbuild.formats.machine import (
    KinematicEntry,
    Machine,
    ParameterRow,
    blame_channel,
    checked_channel,
    checked_kinematic,
    choose_kinematic,
    finite_length_mm,
    matching_id,
)
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.twincat.lists.axislist import AxisList
from chainbuild.formats.twincat.lists.config import UNKNOWN_ID_ALARM, Channel, Trafo
from chainbuild.formats.twincat.lists.source import DIALECT, Source, chain_name
from chainbuild.formats.twincat.lists.toollist import Tool, find_tool
from chainbuild.formats.twincat.parameters import parameter_rows
from chainbuild.formats.twincat.translate import translate
from chainbuild.formats.twincat.types.catalogue import title_of

_COUPLING: Final = 210
_TOOL_KEYS: Final = ("number",)


@dataclass(frozen=True, slots=True)
class Content:
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

    def __init__(self, file: str, path: Path, overlay: Overlay, collector: Collector, content: Content) -> None:
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
        name = chain_name(self.name, source, self._default_source())
        return translate(source, name, self.title, self.chosen_conventions(conventions), collector)

    def _default_source(self) -> Source | None:
        """Return what `chain()` without arguments is built from, or None where it finds nothing."""
        try:
            return self._source(None, None, 0.0, Collector(strict=False))
        except ChainbuildError:
            return None

    def _source(
        self, kinematic: int | str | None, channel: int | None, tool_length_mm: float, collector: Collector
    ) -> Source:
        chosen = self._channel(checked_channel(channel), collector)
        trafo, second = self._trafo(chosen, checked_kinematic(kinematic), collector)
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
        pairs = self._entries(channel)
        entries = [entry for entry, _ in pairs]
        by_overlay = wanted is None and self.overlay.kinematic is not None
        sought = self.overlay.kinematic if by_overlay else wanted
        try:
            entry = choose_kinematic(entries, sought, self.file)
        except MachineDataError as error:
            blame_channel(error, self.kinematics(), sought, channel.index)
            if by_overlay:
                error = self.overlay.blamed(error, "kinematic")
            # The controller's error for an id that the list does not configure.
            raise _with_alarm(error, UNKNOWN_ID_ALARM if pairs else None) from None
        trafo = next(trafo for known, trafo in pairs if known is entry)
        if sought is None:
            default = channel.defaults.get(trafo.step)
            here = [known for known, one in pairs if one.step == trafo.step]
            _tell_apart(matching_id(here, default.id if default and not default.name else None), entry, collector)
            return trafo, self._second(channel, trafo, collector)
        if str(sought) != entry.name:
            _tell_apart(matching_id(entries, sought), entry, collector)
        return trafo, None

    def _second(self, channel: Channel, trafo: Trafo, collector: Collector) -> Trafo | None:
        """Return what stands on the default kinematic in the second step; refuse a default that does not exist."""
        named = channel.defaults.get(0)
        if named is not None and channel.default_trafo() is None:
            text, span, known = named.fault(channel.trafos)
            raise MachineDataError(
                text, span=span, permitted=known, alarm=UNKNOWN_ID_ALARM, code="CB222",
                hint="choose one of the configured kinematics",
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
            text = f"the overlay's tool table cannot hold '{key}' like this for TwinCAT CNC"
            raise self.overlay.error(text, ("tool", key), "number = n, the i of wz[i]")
        if number is None:
            return None
        own = self._tools[channel.index] if channel.index < len(self._tools) else {}
        tools = own or {n: t for tools in self._tools for n, t in tools.items()}
        return find_tool(tools, number, self.overlay.span("tool", "number") or Span(self.file))


def _tell_apart(same: Sequence[KinematicEntry], taken: KinematicEntry, collector: Collector) -> None:
    """Warn where an id stands for several kinematics, which only their names tell apart."""
    others = [entry for entry in same if entry is not taken]
    if others:
        names = ", ".join(repr(entry.name) if entry.name else "one without a name" for entry in same)
        which = f"{taken.name!r} is" if taken.name else "the one without a name is"
        text = f"the id {taken.id} stands for {len(same)} kinematics: {names}; {which} taken"
        collector.add("CB411", text, span=taken.span, hint="choose another by its name")


def _with_alarm(error: MachineDataError, alarm: int | None) -> MachineDataError:
    return MachineDataError(
        error.message, span=error.span, parameter=error.parameter, permitted=error.permitted, alarm=alarm,
        hint=error.hint, code="CB404",
    )  # fmt: skip
