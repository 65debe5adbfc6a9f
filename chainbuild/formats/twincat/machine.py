"""A TwinCAT CNC machine: channels, tools and axis lists of a file, and the chain of a kinematic among them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Final

from chainbuild.chain.elements import Chain
from chainbuild.closest import listed
from chainbuild.convention import Choices
from chainbuild.errors import ChainbuildError, MachineDataError, Span
from chainbuild.findings import Collector
from chainbuild.formats.entries import (
    Datum,
    KinematicEntry,
    ParameterRow,
    Selected,
    changed_overlay,
    checked_channel,
    checked_kinematic,
    checked_values,
    matching_id,
)
from chainbuild.formats.machine import Machine
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.twincat.geometry import geometry_data, tool_data, with_tool_values, with_values
from chainbuild.formats.twincat.lists.axislist import AxisList
from chainbuild.formats.twincat.lists.config import UNKNOWN_ID_ALARM, Channel, Trafo
from chainbuild.formats.twincat.lists.source import DIALECT, Source, chain_name
from chainbuild.formats.twincat.lists.toollist import Tool, find_tool
from chainbuild.formats.twincat.parameters import parameter_rows
from chainbuild.formats.twincat.translate import translate
from chainbuild.formats.twincat.types.catalogue import title_of

_COUPLING: Final = 210
_CHANNELS_NAMED: Final = 20  # fit on a line or two of a message
_TOOL_KEYS: Final = ("number",)


@dataclass(frozen=True, slots=True)
class Content:
    """What a file holds."""

    channels: tuple[Channel, ...]
    tools: tuple[Mapping[int, Tool], ...]
    axis_lists: tuple[tuple[AxisList, str], ...]


@dataclass(frozen=True, slots=True)
class _Configured:
    """An entry of the machine with its kinematic."""

    entry: KinematicEntry
    channel: Channel
    trafo: Trafo


class TwinCatMachine(Machine):
    """A TwinCAT CNC machine.

    Attributes:
        channels: Channels in file order.
    """

    dialect = DIALECT

    def __init__(self, file: str, path: Path, overlay: Overlay, collector: Collector, content: Content) -> None:
        super().__init__(file, path, overlay, collector)
        self._content = content
        self.channels = content.channels
        self._tools = content.tools
        self._configured = {channel.index: tuple(_entries(channel)) for channel in content.channels}
        self._listed = tuple(one.entry for here in self._configured.values() for one in here)

    def kinematics(self) -> tuple[KinematicEntry, ...]:
        """Return the kinematics that the file configures, channel by channel."""
        return self._listed

    def parameters(
        self, kinematic: int | str | tuple[int | str, int | str] | None = None, channel: int | None = None
    ) -> tuple[ParameterRow, ...]:
        """Return every parameter of a kinematic with value, meaning and source; the active tool's share is added.

        Of two transformation steps the parameters of step 0 come first; the tool acts there only.
        """
        collector = Collector(strict=False)
        selected = self._select(checked_kinematic(kinematic), checked_channel(channel), collector)
        source = self._source(selected, self.overlay.tool_length_mm)
        rows = parameter_rows(source, collector)
        return rows if source.second is None else (*rows[:-1], *parameter_rows(source.upper(), collector))

    def geometry(
        self, kinematic: int | str | tuple[int | str, int | str] | None = None, channel: int | None = None
    ) -> tuple[Datum, ...]:
        """Return lengths, angles, directions and flags of a kinematic; of a coupling those of its members."""
        selected = self._select(checked_kinematic(kinematic), checked_channel(channel), Collector(strict=False))
        return geometry_data(self._source(selected, 0.0))

    def with_values(self, values: Mapping[Datum, float]) -> TwinCatMachine:
        """Return the machine with other values of some data."""
        checked_values(values)
        channels = tuple(with_values(channel, values) for channel in self.channels)
        collector = Collector(self._collector.strict, list(self._reading))
        tools = tuple({n: with_tool_values(tool, values) for n, tool in own.items()} for own in self._tools)
        content = replace(self._content, channels=channels, tools=tools)
        return TwinCatMachine(self.file, self.path, changed_overlay(self.overlay, values), collector, content)

    def _tool_data(self, selected: Selected) -> Iterator[Datum]:
        return tool_data(self._source(selected, 0.0))

    def _translate(self, selected: Selected, tool_length_mm: float, choose: Choices, collector: Collector) -> Chain:
        source, default = self._source(selected, tool_length_mm), self._default_source
        return translate(source, chain_name(self.name, source, default), self.title, choose, collector)

    @cached_property
    def _default_source(self) -> Source | None:
        """What `chain()` without arguments is built from, without the tool, or None where it finds nothing."""
        try:
            selected = self._select(None, None, Collector(strict=False))
        except ChainbuildError:
            return None
        found, second = self._found(selected.entry), selected.second
        return Source(found.trafo, found.channel, second=self._found(second).trafo if second else None)

    def _source(self, selected: Selected, tool_length_mm: float) -> Source:
        found, second = self._found(selected.entry), selected.second
        tool = self._tool(found.channel)
        return Source(
            trafo=found.trafo,
            channel=found.channel,
            tool=tool,
            tool_length_mm=tool_length_mm + (tool.length_mm if tool else 0.0),
            axis_lists=self._axis_lists_of(found.channel),
            overlay=self.overlay,
            second=self._found(second).trafo if second else None,
            main=self._is_main(selected),
        )

    def _axis_lists_of(self, channel: Channel) -> list[AxisList]:
        """Return the axis lists of a channel and those of any, in file order."""
        places = [n for number in ("", "0", str(channel.index + 1)) for n in self._by_number.get(number, ())]
        return [self._content.axis_lists[n][0] for n in sorted(places)]

    @cached_property
    def _by_number(self) -> Mapping[str, Sequence[int]]:
        """Places of the axis lists by the number of their channel; looked up, since there may be thousands of both."""
        found: dict[str, list[int]] = {}
        for n, (_, number) in enumerate(self._content.axis_lists):
            found.setdefault(number, []).append(n)
        return found

    def _is_main(self, selected: Selected) -> bool:
        """Tell whether the overlay is written for a kinematic: the one it names, else the default of the channel."""
        named = self.overlay.kinematic
        entries = self._entries_of(selected.entry.channel)
        if isinstance(named, tuple):
            try:
                return selected == self._pair(named, entries, Collector(strict=False))
            except MachineDataError:
                return False
        found = self._found(selected.entry)
        matching = [trafo for trafo in found.channel.trafos if named in (trafo.id, trafo.name)]
        if found.trafo is not (matching[0] if matching else _default(found.channel)):
            return False
        return selected.second is None or self._found(selected.second).trafo is found.channel.default_trafo(1)

    def _found(self, entry: KinematicEntry) -> _Configured:
        return next(one for one in self._configured[entry.channel] if one.entry is entry)

    def _channel(self, wanted: int | None, collector: Collector) -> int:
        if wanted is not None:
            if wanted in self._configured:
                return wanted
            known = listed(str(wanted), [str(index) for index in self._configured])
            raise MachineDataError(
                f"the file has no channel {wanted}", span=Span(self.file), parameter="channel", permitted=known,
                code="CB404",
            )  # fmt: skip
        usable = next((channel for channel in self.channels if channel.trafos), None)
        if usable is None:
            raise MachineDataError("the file configures no kinematic", span=Span(self.file), code="CB213")
        if len(self.channels) > 1:
            text = f"the file has {len(self.channels)} channels; channel {usable.index} is taken"
            known = ", ".join(str(channel.index) for channel in self.channels[:_CHANNELS_NAMED])
            known += f", … ({len(self.channels)} in all)" if len(self.channels) > _CHANNELS_NAMED else ""
            collector.add("CB406", text, span=usable.span, hint=f"choose another by its index: {known}")
        return usable.index

    def _named(self, wanted: int | str | None, entries: Sequence[KinematicEntry]) -> KinematicEntry:
        """Return the requested entry; where there is none, raise with the controller's error for an unknown id."""
        try:
            return super()._named(wanted, entries)
        except MachineDataError as error:
            error.code, error.alarm = "CB404", UNKNOWN_ID_ALARM if entries else None
            raise

    def _pair(
        self, wanted: tuple[int | str, int | str], entries: Sequence[KinematicEntry], collector: Collector
    ) -> Selected:
        """Return the requested pair; where there is none, raise with the controller's error for an unknown id."""
        try:
            selected = super()._pair(wanted, entries, collector)
        except MachineDataError as error:
            error.code, error.alarm = "CB404", UNKNOWN_ID_ALARM
            raise
        for part, entry in zip(wanted, (selected.entry, selected.second), strict=True):
            if entry is not None and str(part) != entry.name:
                _tell_apart(matching_id([e for e in entries if e.step == entry.step], part), entry, collector)
        return selected

    def _second(self, entry: KinematicEntry, wanted: int | str | None, collector: Collector) -> KinematicEntry | None:
        """Return the kinematic of the second step on the default one; refuse a default that does not exist."""
        found = self._found(entry)
        channel, trafo = found.channel, found.trafo
        here = self._configured[entry.channel]
        if wanted is not None:
            if str(wanted) != entry.name:
                _tell_apart(matching_id([one.entry for one in here], wanted), entry, collector)
            return None
        default = channel.defaults.get(trafo.step)
        same = [one.entry for one in here if one.trafo.step == trafo.step]
        _tell_apart(matching_id(same, default.id if default and not default.name else None), entry, collector)
        named = channel.defaults.get(0)
        if named is not None and channel.default_trafo() is None:
            text, span, known = named.fault(channel.trafos)
            raise MachineDataError(
                text, span=span, permitted=known, alarm=UNKNOWN_ID_ALARM, code="CB222",
                hint="choose one of the configured kinematics",
            )  # fmt: skip
        second = channel.default_trafo(1)
        _tell_missing_defaults(channel, trafo, second, collector)
        if second is not None and trafo.step == 0:
            return next(one.entry for one in here if one.trafo is second)
        return None

    def _tell_unused(self, names: Sequence[str], asked: Mapping[str, str], collector: Collector) -> None:
        """Note the choices that have no effect, also the overlay's."""
        for name in names:
            collector.add("CB405", f"this kinematic does not use the chosen convention {name}")

    def _tool(self, channel: Channel) -> Tool | None:
        """Return the tool that the overlay's `[tool] number = n` makes active, or None."""
        unknown = [key for key in self.overlay.tool if key not in _TOOL_KEYS]
        number = self.overlay.tool.get("number")
        if unknown or isinstance(number, tuple):
            key = unknown[0] if unknown else "number"
            text = f"the overlay's [tool] has an invalid '{key}' for TwinCAT CNC"
            raise self.overlay.error(text, ("tool", key), "number = n, the i of wz[i]")
        if number is None:
            return None
        own = self._tools[channel.index] if channel.index < len(self._tools) else {}
        tools = own or {n: t for tools in self._tools for n, t in tools.items()}
        return find_tool(tools, number, self.overlay.span("tool", "number") or Span(self.file))


def _entries(channel: Channel) -> list[_Configured]:
    """Return the kinematics of a channel with their entries."""
    default = _default(channel)
    return [
        _Configured(
            KinematicEntry(
                id=trafo.id,
                name=trafo.name,
                type=f"KIN_TYP {trafo.type}",
                title=title_of(trafo.type),
                channel=channel.index,
                default=trafo is default,
                span=trafo.span,
                step=trafo.step,
            ),
            channel,
            trafo,
        )
        for trafo in channel.trafos
    ]


def _default(channel: Channel) -> Trafo | None:
    """Return the kinematic that `chain()` takes: the list's default, else the only coupling, else the first."""
    named = channel.default_trafo()
    if named is not None:
        return named
    couplings = [trafo for trafo in channel.trafos if trafo.type == _COUPLING]
    return couplings[0] if len(couplings) == 1 else next(iter(channel.trafos), None)


def _tell_missing_defaults(channel: Channel, first: Trafo, second: Trafo | None, collector: Collector) -> None:
    """Note a step without default where two are configured: the controller then refuses #TRAFO (P-CHAN-00452)."""
    steps = [[trafo for trafo in channel.trafos if trafo.step == step] for step in (0, 1)]
    if not (steps[0] and steps[1]):
        return
    missing = [n for n, default in enumerate((channel.default_trafo(), second)) if default is None]
    if missing:
        which = "neither transformation step has" if len(missing) == 2 else f"transformation step {missing[0]} has no"
        which += " a default kinematic" if len(missing) == 2 else " default kinematic"
        built = f"only {first.id} of step {first.step} is built" if second is None else f"{first.id} is taken"
        pair = f"{(first if first.step == 0 else steps[0][0]).id},{(second or steps[1][0]).id}"
        keys = " and ".join(f"default_id_of_kin_step[{n}]" for n in missing)
        collector.add(
            "CB412", f"{which}: the controller refuses #TRAFO until #KIN ID chooses both; {built}",
            span=steps[missing[0]][0].span, parameter=keys,
            hint=f"choose a pair: --kinematic {pair}, kinematic=({pair.replace(',', ', ')})",
        )  # fmt: skip


def _tell_apart(same: Sequence[KinematicEntry], taken: KinematicEntry, collector: Collector) -> None:
    """Warn where an id stands for several kinematics, which only their names tell apart."""
    others = [entry for entry in same if entry is not taken]
    if others:
        names = ", ".join(repr(entry.name) if entry.name else "one without a name" for entry in same)
        which = f"{taken.name!r} is" if taken.name else "the one without a name is"
        text = f"the id {taken.id} is that of {len(same)} kinematics: {names}; {which} taken"
        collector.add("CB411", text, span=taken.span, hint="choose another by its name")
