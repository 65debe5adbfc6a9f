"""The chapters on the file: which kinematic it configures, and what each of its data means and moves."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.chain.axismap import random_axis_values
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.closest import and_joined
from chainbuild.drawing.site import home_of
from chainbuild.errors import ChainbuildError
from chainbuild.formats.effects import Effect, effect_at, next_value
from chainbuild.formats.entries import TOOL_LENGTH
from chainbuild.formats.listing import array_name, arrays_of, line_of, lines_of
from chainbuild.writers.machine_report.document.blocks import (
    Chapter,
    Heading,
    Paragraph,
    ReportBlock,
    Verbatim,
    table_block,
)
from chainbuild.writers.machine_report.document.numbers import decimal

if TYPE_CHECKING:
    from chainbuild.arrays import Vector
    from chainbuild.chain.elements import Chain
    from chainbuild.comparison.convention_trials import Selection
    from chainbuild.formats.entries import Datum, ParameterRow, Wanted
    from chainbuild.formats.machine import Machine
    from chainbuild.kinematics.mechanism import Mechanism

_PROBES: Final = 3  # positions at which a change is looked for: what moves nothing at one may at another
_TRIES: Final = 40  # drawn for them where loops must close
_COUPLED: Final = 40  # kinematics of a file that are looked through: far more than one couples
_LISTED: Final = 4  # links named one by one
_SEEN: Final = 5e-4  # mm, degrees: what three decimals show


@dataclass(frozen=True, slots=True)
class DataSource:
    """A machine file and which of its kinematics is reported.

    Attributes:
        machine: The file.
        selection: The kinematic.
        conventions: Choices of the user.
    """

    machine: Machine
    selection: Selection
    conventions: Mapping[str, str]

    def chain(self, values: Mapping[Datum, float]) -> Chain:
        """Return the chain with other values of some data, past the rules on its geometry."""
        one = self.selection
        machine = self.machine.with_values(values) if values else self.machine
        return machine.trial_chain(one.kinematic, one.channel, one.tool_length_mm, self.conventions)

    def data(self) -> tuple[Datum, ...]:
        """Return the numbers that may place or direct something, the tool's last."""
        one = self.selection
        tool = self.machine.tool_data(one.kinematic, one.channel, tool_length_mm=one.tool_length_mm)
        return (*self.machine.geometry(one.kinematic, one.channel), *tool)

    def rows(self, wanted: Collection[str]) -> list[ParameterRow]:
        """Return the parameters of the kinematic, and of those that it couples where they hold wanted data."""
        one = self.selection
        found = self._rows(one.kinematic, one.channel)
        missing = set(wanted) - {row.name for row in found}
        for entry in self.machine.kinematics()[:_COUPLED] if missing else ():
            more = self._rows(entry.name or entry.id, entry.channel)
            if not missing.isdisjoint(row.name for row in more):
                known = {row.name for row in found}
                found += [row for row in more if row.name not in known]
        return found

    def _rows(self, kinematic: Wanted | None, channel: int | None) -> list[ParameterRow]:
        try:
            return list(self.machine.parameters(kinematic, channel))
        except ChainbuildError:
            return []  # a kinematic without a table of parameters


def data_chapter(robot: Mechanism, source: DataSource | None) -> Chapter:
    """Return the chapter on the data of the file: those that move the machine, those that choose it, the others."""
    title = "What the file says"
    if source is None:
        return Chapter(title, [Paragraph.of("The report was made from the model alone, without the data of its file.")])
    return Chapter(title, list(_data_blocks(robot, source)))


def _data_blocks(robot: Mechanism, source: DataSource) -> Iterator[ReportBlock]:
    effects = _effects(robot, source)
    rows = source.rows({datum.name for datum in effects})
    names = {row.name for row in rows}
    moving = {datum.name for datum, effect in effects.items() if effect}
    geometric = {datum.name for datum in effects}
    yield Heading(("Data that place and direct",))
    yield Paragraph.of(
        "What one millimetre or one degree more of a datum moves, at home; a direction or a choice is changed to its "
        "next value. Shifts of the tool are seen in the workpiece frame. Compare them with what the drawing of the "
        "machine means by the length: a number that moves something else has the wrong place or the wrong sign."
    )
    given = [datum for datum in effects if datum.name in moving and (datum.span is not None or datum.name not in names)]
    yield table_block(
        ("Name", "Symbol", "Value", "Unit", "Meaning", "Moves", "Line"),
        [_moving_row(datum, effects[datum], rows) for datum in given],
    )
    rest = [row for row in rows if row.given and row.name not in moving]
    choosing = [row for row in rest if row.name not in geometric]
    if choosing:
        yield Heading(("Data that choose what is built, name it or limit it",))
        yield _parameter_table(choosing)
    idle = [row for row in rest if row.name in geometric]
    if idle:
        yield Heading(("Data of the file without effect",))
        yield Paragraph.of(
            "Given in the file and read, but no joint, frame or pose of this kinematic follows them: the arrangement "
            "does not ask for them, or what they act on is 0."
        )
        yield _parameter_table(idle)
    counting = [row for row in rows if not row.given and row.name in moving]
    if counting:
        yield Heading(("Not in the file: default values in force",))
        yield Paragraph.of("Another value of one of these in the file would move the machine.")
        yield _parameter_table(counting)
    others = sum(not row.given for row in rows) - len(counting)
    if others > 0:
        more = f"{others} more parameters are not in the file; at their default values they"
        more = more if others > 1 else "1 more parameter is not in the file; at its default value it"
        yield Paragraph.of(f"{more} {'place and direct' if others > 1 else 'places and directs'} nothing.")


def _moving_row(datum: Datum, moves: str, rows: Sequence[ParameterRow]) -> list[str]:
    meaning = next((row.meaning for row in rows if row.name == datum.name), "")
    if datum.name == TOOL_LENGTH:
        meaning = "Added to the length of the active tool."
    symbol = datum.symbol if datum.symbol != datum.name else ""
    line = line_of(datum.span)
    return [
        Verbatim(datum.name),
        symbol,
        decimal(datum.value),
        datum.unit,
        meaning,
        moves,
        "" if line is None else str(line),
    ]


def _effect_in_words(effect: Effect) -> str:
    """Return what a change moves: the links, and what the tool does; empty: nothing."""
    shifts = [
        f"{letter} {'+' if value > 0.0 else ''}{decimal(value, 3)}"
        for letter, value in zip("XYZ", effect.shift_mm, strict=True)
        if abs(value) >= _SEEN
    ]
    tool = [f"{' '.join(shifts)} mm"] if shifts else []
    if effect.turn_deg >= _SEEN:
        tool.append(f"turn {decimal(effect.turn_deg, 3)}°")
    return "; ".join(
        part for part in (_links_in_words(effect.links), f"tool {', '.join(tool)}" if tool else "") if part
    )


def _links_in_words(links: Sequence[str]) -> str:
    if len(links) > _LISTED + 1:
        return f"{', '.join(links[:_LISTED])} and {len(links) - _LISTED} more"
    return and_joined(list(links)) if links else ""


def _parameter_table(rows: Sequence[ParameterRow]) -> ReportBlock:
    cells = []
    for group in arrays_of(rows):
        first = group[0]
        values = ", ".join(_shown(row.value) for row in group)
        name, symbol = array_name(group), first.symbol if first.symbol != first.name else ""
        line = lines_of(group) if first.given else ""
        cells.append([Verbatim(name), symbol, values, first.unit, first.meaning, line])
    return table_block(("Name", "Symbol", "Value", "Unit", "Meaning", "Line"), cells)


def _shown(value: float | int | str | None) -> str:
    if value is None:
        return "–"
    return decimal(value) if isinstance(value, float) else str(value)


def _effects(robot: Mechanism, source: DataSource) -> dict[Datum, str]:
    """Return what a change of each datum moves, in words; empty: nothing anywhere."""
    here = source.chain({})
    home = home_of(robot.chain)
    places = [*([] if home is None else [home]), *_probes(robot)]
    found: dict[Datum, str] = {}
    for datum in source.data():
        if datum not in found:
            found[datum] = _effect_of(source, datum, here, places)
    return found


def _effect_of(source: DataSource, datum: Datum, here: Chain, places: Sequence[Vector]) -> str:
    try:
        there = source.chain({datum: next_value(datum, datum.value)})
    except ChainbuildError:
        return "no such machine can be built with another value"
    for n, axes in enumerate(places):
        try:
            effect = effect_at(here, there, axes)
        except ChainbuildError:
            continue
        if effect is None:
            return "other joints: what is built changes"
        if words := _effect_in_words(effect):
            return words if n == 0 else f"nothing at home; elsewhere {_links_in_words(effect.links)}"
    return ""


def _probes(robot: Mechanism) -> list[Vector]:
    chain, rng = robot.chain, np.random.default_rng(3)
    lower, upper = shown_limits(chain)
    drawn = (random_axis_values(chain.axis_map, rng, lower, upper)[0] for _ in range(_TRIES))
    having = [axes for axes in drawn if np.isfinite(chain.axis_map.q(axes)).all()]
    return having[:_PROBES]


def file_name(machine: Machine) -> str:
    """Return the name of the machine file, and that of its overlay."""
    overlay = machine.overlay.path
    own = machine.path.name
    return own if overlay is None else f"{own}, {PurePath(overlay).name}"
