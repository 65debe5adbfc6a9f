"""The parameters of a kinematic as a table: value, unit, meaning, source and place."""

from __future__ import annotations

from dataclasses import replace

from chainbuild import frames
from chainbuild.chain.programmed.vectors import FIXED_AXIS_INDEX
from chainbuild.errors import ChainbuildError
from chainbuild.findings import Collector
from chainbuild.formats.entries import ParameterRow
from chainbuild.formats.twincat.lists.config import Orientation
from chainbuild.formats.twincat.lists.hdtable import type_data
from chainbuild.formats.twincat.lists.named_parameters import named_parameter, slot_name
from chainbuild.formats.twincat.lists.reader import Assignment
from chainbuild.formats.twincat.lists.source import Source
from chainbuild.formats.twincat.lists.toollist import acting_params
from chainbuild.formats.twincat.types.catalogue import why_unsupported
from chainbuild.formats.twincat.types.draft import SIX_AXIS_ARM
from chainbuild.formats.twincat.universal.universal import UNIVERSAL

_ANGLE_MEANING = "Order of the pose angles A, B, C"
_PLANES = {0: "none", 1: "Z of the tool, ZX plane", 2: "Y of the tool, YZ plane"}


def parameter_rows(source: Source, collector: Collector) -> tuple[ParameterRow, ...]:
    """Return every parameter of a kinematic: HD table first, then what the list gives beyond it.

    Args:
        source: The kinematic, its channel and the active tool, whose share is added.
        collector: Takes findings about the tool.
    """
    trafo = source.trafo
    raw = {k: entry.value for k, entry in acting_params(source.tool, trafo, collector).items()}
    for k, entry in trafo.params.items():
        raw[k] = raw.get(k, 0.0) + entry.value
    data = type_data().get(trafo.type)
    rows = []
    table = {row.n: row for row in data.hd} if data else {}
    for n in sorted({*table, *(k + 1 for k in raw)}):
        row, entry_ = table.get(n), trafo.params.get(n - 1)
        value = raw.get(n - 1, row.default if row else 0.0)
        rows.append(
            ParameterRow(
                name=f"{trafo.prefix}.param[{n - 1}]",
                symbol=f"HD{n}",
                value=row.scaled(value) if row else value,
                unit=row.unit if row else "",
                meaning=row.meaning if row else "not in the table of this type; the list's own count",
                given=n - 1 in raw,
                source=data.manual if data else "",
                span=entry_.span if entry_ else None,
            )
        )
    if trafo.type == UNIVERSAL:
        rows = [_slot_row(row) for row in rows]
    rows.extend(_named_row(name, entry) for name, entry in trafo.extras.items())
    if why_unsupported(trafo.type):
        return tuple(rows)
    return (
        *rows,
        _angle_row(source),
        *(_vector_rows(source.channel.orientation) if trafo.type == SIX_AXIS_ARM else ()),
    )


def _named_row(name: str, entry: Assignment) -> ParameterRow:
    """Return a parameter that the list gives by name."""
    known, value = named_parameter(name), _shown(entry)
    if known is None:
        return ParameterRow(entry.name, "", value, "", "", True, "", entry.span)
    return ParameterRow(entry.name, "", known.scaled(value), known.unit, known.meaning, True, known.source, entry.span)


def _slot_row(row: ParameterRow) -> ParameterRow:
    """Return a PARAM[] slot of KIN_TYP 91 as what it stands for."""
    name = slot_name(int(row.symbol.removeprefix("HD")) - 1)
    known = named_parameter(name)
    if known is None or not isinstance(row.value, float | int):
        return row
    meaning = f"{name}: {known.meaning}"
    return replace(row, value=known.scaled(row.value), unit=known.unit, meaning=meaning, source=known.source)


def _shown(entry: Assignment) -> float | str:
    """Return a value without its comment: a number where it is one."""
    for read in (entry.number, entry.text):
        try:
            return read()
        except ChainbuildError:
            continue
    return entry.raw


def _angle_row(source: Source) -> ParameterRow:
    given = source.channel.angle_mode
    number = int(given.value) if given else 0
    mode = frames.ANGLE_MODE_NUMBERS.get(number)
    product = f": {frames.ANGLE_MODES[mode].meaning}" if mode else ""
    return ParameterRow(
        name="ori_rotation_angle",
        symbol="P-CHAN-00112",
        value=number,
        unit="",
        meaning=_ANGLE_MEANING + product,
        given=given is not None,
        source="P-CHAN-00112",
        span=given.span if given else None,
    )


def _vector_rows(given: Orientation) -> tuple[ParameterRow, ...]:
    """Return what says how a program states orientations, as it acts."""
    fixed = FIXED_AXIS_INDEX[given.fixed] if given.fixed else 0
    kept = f"angle {given.fixed}" if given.fixed else "the one that leaves the vector free, unless a plane is given"
    rows: tuple[tuple[str, str, int | str, str], ...] = (
        ("mode", "P-CHAN-00177", given.mode.upper(), "How a program states orientations: angles or vectors"),
        ("fixed_axis_index", "P-CHAN-00178", fixed, f"Rotary axis that vector programming keeps: {kept}"),
        ("tool_ax_in_plane", "P-CHAN-00436", given.plane, f"Tool axis in a plane: {_PLANES[given.plane]}"),
    )
    return tuple(
        ParameterRow(f"ori.{name}", number, value, "", meaning, name in given.spans, number, given.spans.get(name))
        for name, number, value, meaning in rows
    )
