"""The numbers that place and direct a kinematic and its tool, and channel and tool with other values of them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Final

from chainbuild.errors import ChainbuildError
from chainbuild.findings import Collector
from chainbuild.formats.entries import Datum
from chainbuild.formats.twincat.coupling.coupling_groups import COUPLING, read_groups
from chainbuild.formats.twincat.lists.config import Channel, RawValue, Trafo
from chainbuild.formats.twincat.lists.hdtable import HdRow, type_data
from chainbuild.formats.twincat.lists.named_parameters import named_parameter, slot_name
from chainbuild.formats.twincat.lists.source import Source
from chainbuild.formats.twincat.lists.toollist import Tool, acting_params
from chainbuild.formats.twincat.universal.universal import UNIVERSAL

_COUNTS: Final = 1e4  # of a list for one mm or degree
_VECTORS: Final = re.compile(r"zero_orientation|axis\[\d+\]\.orientation|linkage")
_DIRECTION, _ZERO = "direction_", "offset_"  # what HD tables call the direction and the zero of an axis


def geometry_data(source: Source) -> tuple[Datum, ...]:
    """Return the data of a kinematic: of both steps, of a coupling those of its members."""
    trafos = [source.trafo, *([source.second] if source.second is not None else [])]
    if source.trafo.type == COUPLING:
        groups = read_groups(source.trafo, source.channel.trafos, Collector(strict=False))
        trafos += [member for group in groups for member in group.members]
    return tuple(one for trafo in trafos for one in (*_numbered(source, trafo), *_named(source, trafo)))


def tool_data(source: Source) -> Iterator[Datum]:
    """Yield the numbers of the active tool: its length, given or not, its radius, and what it adds to the kinematic."""
    tool = source.tool
    if tool is None:
        return
    index, name = source.channel.index, f"wz[{tool.number}]"
    for key, number, value in (("laenge", "P-TOOL-00003", tool.length_mm), ("radius", "P-TOOL-00004", tool.radius_mm)):
        if key == "laenge" or value:
            place = f"{name}.{key}"
            yield Datum(place, number, value, "mm", tool.places.get(key), index, (place, None), counts=_COUNTS)
    for entry, symbol, unit in _added_by_tool(source, tool):
        value, key_ = entry.value / _COUNTS, (entry.name, None)
        yield Datum(entry.name, symbol, value, unit, entry.span, index, key_, counts=_COUNTS)


def _added_by_tool(source: Source, tool: Tool) -> Iterator[tuple[RawValue, str, str]]:
    """Yield what a tool adds to the parameters and axes of the kinematic that carries it: entry, symbol, unit."""
    trafo = source.trafo
    if trafo.type == COUPLING:
        groups = read_groups(trafo, source.channel.trafos, Collector(strict=False))
        members = [member for group in groups for member in group.members]
        last = groups[0].members[-1] if groups else trafo
        trafo = next((one for one in members if tool.kin_name and one.name == tool.kin_name), last)
    rows = {row.n: row for row in type_data()[trafo.type].hd} if trafo.type in type_data() else {}
    for k, entry in acting_params(tool, trafo, Collector(strict=False)).items():
        row, known = rows.get(k + 1), named_parameter(slot_name(k)) if trafo.type == UNIVERSAL else None
        unit = row.unit if row is not None else known.unit if known is not None else ""
        if unit:
            yield entry, f"HD{k + 1}", unit
    for entry in tool.axis_offsets.values():
        yield entry, "P-TOOL-00006", "deg"


def with_tool_values(tool: Tool, values: Mapping[Datum, float]) -> Tool:
    """Return a tool with other values of some data."""
    changed = {one.key[0]: value for one, value in values.items()}
    name = f"wz[{tool.number}]"

    def entries(given: Mapping[int, RawValue]) -> dict[int, RawValue]:
        new = {k: changed.get(one.name) for k, one in given.items()}
        return {
            k: one if (value := new[k]) is None else replace(one, value=value * _COUNTS, raw=f"{value * _COUNTS!r}")
            for k, one in given.items()
        }

    return replace(
        tool,
        length_mm=changed.get(f"{name}.laenge", tool.length_mm),
        radius_mm=changed.get(f"{name}.radius", tool.radius_mm),
        params=entries(tool.params),
        axis_offsets=entries(tool.axis_offsets),
    )


def with_values(channel: Channel, values: Mapping[Datum, float]) -> Channel:
    """Return a channel with other values of some data."""
    changed = {one.key: value * one.counts for one, value in values.items() if one.channel == channel.index}
    return replace(channel, trafos=tuple(_changed(trafo, changed) for trafo in channel.trafos))


def _changed(trafo: Trafo, values: Mapping[tuple[str, int | tuple[int, int] | None], float]) -> Trafo:
    params, extras = dict(trafo.params), dict(trafo.extras)
    for (name, k), value in values.items():
        if name == trafo.prefix and isinstance(k, int):
            old = params.get(k) or RawValue(0.0, f"{name}.param[{k}]", trafo.span)
            params[k] = replace(old, value=value, raw=f"{value!r}")
        for key, entry in trafo.extras.items():
            if k is None and name == f"{trafo.prefix}.{key}":
                extras[key] = replace(entry, raw=f"{value!r}")
    return replace(trafo, params=params, extras=extras)


def _numbered(source: Source, trafo: Trafo) -> Iterator[Datum]:
    """Yield the head offsets that act on poses; of KIN_TYP 91 the slots of its parameters."""
    data = type_data().get(trafo.type)
    for row in data.hd if data else ():
        entry = trafo.params.get(row.n - 1)
        counted = entry.value if entry else row.default
        others = _others(row, counted)
        if row.effect == "pose" and (row.unit or others):
            yield Datum(
                name=f"{trafo.prefix}.param[{row.n - 1}]",
                symbol=f"HD{row.n}",
                value=row.scaled(counted),
                unit=row.unit,
                span=entry.span if entry else None,
                channel=source.channel.index,
                key=(trafo.prefix, row.n - 1),
                others=others,
                counts=_COUNTS if row.unit else 1.0,
                twins=_twins(trafo, row),
            )
    for k, entry in trafo.params.items() if trafo.type == UNIVERSAL else ():
        place = replace(entry, name=f"{trafo.prefix}.param[{k}]")
        yield from _one(source, slot_name(k), place, (trafo.prefix, k))


def _named(source: Source, trafo: Trafo) -> Iterator[Datum]:
    """Yield the parameters that have a name."""
    for key, entry in trafo.extras.items():
        try:
            value = entry.number()
        except ChainbuildError:
            continue  # a name or an id
        place = RawValue(value, entry.name, entry.span)
        yield from _one(source, key, place, (f"{trafo.prefix}.{key}", None))


def _one(source: Source, name: str, place: RawValue, key: tuple[str, int | None]) -> Iterator[Datum]:
    """Yield a named parameter if it is a length, an angle or part of a vector."""
    known = named_parameter(name)
    unit = known.unit if known is not None else ""
    if not unit and not (_VECTORS.match(name) and place.value):
        return
    counts, others = (_COUNTS, ()) if unit else (1.0, (-place.value,))
    yield Datum(place.name, "", place.value / counts, unit, place.span, source.channel.index, key, others, counts)


def _others(row: HdRow, value: float) -> tuple[float, ...]:
    """Return the other values that a bare number may have."""
    if row.unit or row.kind == "count":
        return ()
    return tuple(one for one in row.permitted if one != value) or ((-value,) if value else ())


def _twins(trafo: Trafo, row: HdRow) -> tuple[str, ...]:
    """Return the zeros of the axes before and behind the one whose direction this is."""
    names = [axis.name.lower() for axis in type_data()[trafo.type].axes]
    axis = row.name.removeprefix(_DIRECTION)
    if axis == row.name or axis not in names[1:-1]:
        return ()
    n = names.index(axis)
    zeros = {one.name: one.n for one in type_data()[trafo.type].hd}
    found = [zeros.get(f"{_ZERO}{names[k]}") for k in (n - 1, n + 1)]
    return tuple(f"{trafo.prefix}.param[{k - 1}]" for k in found if k is not None) if None not in found else ()
