"""The data of a machine for the page: each with its line in the file, and what a change of it moves."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from chainbuild import tolerances
from chainbuild.errors import ChainbuildError
from chainbuild.formats.effects import effect_at, next_value
from chainbuild.formats.entries import Datum, datum_name

if TYPE_CHECKING:
    from chainbuild.arrays import Vector
    from chainbuild.chain.elements import Chain
    from chainbuild.comparison.convention_trials import Selection
    from chainbuild.formats.machine import Machine


class DataList:
    """The geometric data of a kinematic and of its tool, by short name.

    Args:
        machine: The machine as its file has it.
        selection: Which kinematic.

    Attributes:
        data: Short name → datum, in the order of the file.
    """

    def __init__(self, machine: Machine, selection: Selection) -> None:
        self._machine, self._selection = machine, selection
        chosen = selection.kinematic, selection.channel
        found = (*machine.geometry(*chosen), *machine.tool_data(*chosen, tool_length_mm=selection.tool_length_mm))
        self.data: dict[str, Datum] = {}
        for datum in found:
            name = datum_name(datum, found)
            self.data[name if name not in self.data else f"{name} ({len(self.data)})"] = datum

    def rows(self) -> list[dict[str, Any]]:
        """Return what the page shows of each datum: name, value and unit, meaning, the line of the file."""
        chosen = self._selection.kinematic, self._selection.channel
        meanings = {row.name: row.meaning for row in self._machine.parameters(*chosen)}
        return [self._row(key, datum, meanings.get(datum.name, "")) for key, datum in self.data.items()]

    def _row(self, key: str, datum: Datum, meaning: str) -> dict[str, Any]:
        span = datum.span
        return {
            "key": key,
            "name": datum.name,
            "symbol": datum.symbol,
            "value": datum.value,
            "unit": datum.unit,
            "choices": [] if datum.unit else sorted({datum.value, *datum.others}),
            "meaning": meaning,
            # Pages are passed on: the name of the file, not its folder.
            "place": f"{PurePath(span.file).name}:{span.line}" if span and span.line else "",
            "line": span.text if span else "",
        }

    def datum(self, key: str) -> Datum:
        """Return the datum of a short name.

        Raises:
            ChainbuildError: there is none.
        """
        datum = self.data.get(key)
        if datum is None:
            raise ChainbuildError(f"the kinematic has no datum '{key}'", permitted=", ".join(self.data))
        return datum

    def permitted(self, key: str, value: float) -> float:
        """Return a value that a datum may be changed to.

        Raises:
            ChainbuildError: there is no such datum, or it cannot have the value.
        """
        datum = self.datum(key)
        if not math.isfinite(value) or abs(value) >= tolerances.HUGE_AXIS_VALUE:
            raise ChainbuildError(
                f"{datum.name} = {value:g}", parameter=key, permitted=f"below {tolerances.HUGE_AXIS_VALUE:g} in size"
            )
        if not datum.unit and value not in (datum.value, *datum.others):
            choices = ", ".join(f"{one:g}" for one in sorted({datum.value, *datum.others}))
            raise ChainbuildError(f"{datum.name} = {value:g}", parameter=key, permitted=choices)
        return value

    def machine(self, values: Mapping[str, float]) -> Machine:
        """Return the machine with other values of some data; none: the machine of the file itself."""
        if not values:
            return self._machine
        return self._machine.with_values({self.data[key]: value for key, value in values.items()})

    def chain(self, values: Mapping[str, float], choices: Mapping[str, str]) -> Chain:
        """Return the chain of the kinematic with other values of some data.

        Raises:
            ChainbuildError: no such machine can be built.
        """
        one = self._selection
        return self.machine(values).chain(one.kinematic, one.channel, one.tool_length_mm, choices)

    def moves(self, key: str, values: Mapping[str, float], choices: Mapping[str, str], axes: Vector) -> dict[str, Any]:
        """Return what one millimetre or degree more of a datum moves at axis values, or its next value.

        Args:
            key: The datum.
            values: Other values of some data.
            choices: Conventions.
            axes: (n_axes,) axis values, mm and degrees.

        Returns:
            Links that stand elsewhere in the base; the tool's shift in the workpiece frame (3,) in mm and its turn in
            degrees, None where there is no pose; the value looked at.

        Raises:
            ChainbuildError: there is no such datum.
        """
        datum = self.datum(key)
        value = values.get(key, datum.value)
        other = next_value(datum, value)
        nothing: dict[str, Any] = {"key": key, "to": other, "links": [], "shift": None, "turn": None}
        try:
            here, there = (self._trial({**values, **one}, choices) for one in ({}, {key: other}))
            found = effect_at(here, there, axes)
        except ChainbuildError:
            return nothing
        if found is None:
            return nothing
        return {**nothing, "links": list(found.links), "shift": list(found.shift_mm), "turn": found.turn_deg}

    def _trial(self, values: Mapping[str, float], choices: Mapping[str, str]) -> Chain:
        one = self._selection
        return self.machine(values).trial_chain(one.kinematic, one.channel, one.tool_length_mm, choices)
