"""A table of Denavit-Hartenberg parameters as a machine, and its chain."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from chainbuild.arrays import Matrix
from chainbuild.chain.assemble import Element, Fixed, assemble, linear, mark, rotary, shift, turn
from chainbuild.chain.check import check_reach_magnitude
from chainbuild.chain.elements import Axis, Chain
from chainbuild.convention import Choices
from chainbuild.errors import MachineDataError, Span
from chainbuild.findings import Collector
from chainbuild.formats.dh.rows import FORMULAS, DhJoint, DhTable, read_table
from chainbuild.formats.entries import Datum, KinematicEntry, ParameterRow, Selected, changed_overlay, checked_values
from chainbuild.formats.machine import Machine
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.overlay_poses import with_named_poses
from chainbuild.formats.overlay_sums import with_coupling, with_sums
from chainbuild.formats.overlay_useless import OF_CONTROLS, refuse_useless
from chainbuild.frames import rot_x, rot_z, translation

_CHANNEL: Final = 1  # a table has none
_UNITS: Final = {"a": "mm", "d": "mm", "alpha": "deg", "theta": "deg"}
_MEANINGS: Final = {
    "a": "shift along x",
    "d": "shift along z, at axis value 0",
    "alpha": "turn about x",
    "theta": "turn about z, at axis value 0",
}
_USELESS: Final = {**OF_CONTROLS, "kinematic": ("kinematic",)}
_USEFUL: Final = (
    "name, source, tool_length_mm, endless, [limits], [limits.sums], [speeds], [poses], [geometry], [coupling]"
)
_RIGHT_ANGLES: Final = (1.5708, 3.1416, 4.7124)  # radians as people write them
_ROUNDED: Final = 1e-3  # radians: with so many digits
_FULL_TURN: Final = 6.29  # radians, and a little more


class DhMachine(Machine):
    """A table of Denavit-Hartenberg parameters, read.

    The base is the frame before the first row, the flange the frame behind the last. A tool length shifts the tool
    along the flange's z.

    Args:
        path: The file.
        overlay: What the file beside it adds.
        collector: Takes the findings.
        table: Its rows.

    Attributes:
        table: Its rows.
    """

    dialect = "Denavit-Hartenberg"

    def __init__(self, path: Path, overlay: Overlay, collector: Collector, table: DhTable) -> None:
        super().__init__(str(path), path, overlay, collector)
        self.table = table

    @property
    def _type(self) -> str:
        return f"DH {self.table.convention}"

    def kinematics(self) -> tuple[KinematicEntry, ...]:
        """Return the one kinematic of the table."""
        title = f"{self.table.convention} convention, a row is {FORMULAS[self.table.convention]}"
        return (KinematicEntry(1, "", self._type, title, _CHANNEL, default=True, span=self.table.span),)

    def parameters(
        self, kinematic: int | str | tuple[int | str, int | str] | None = None, channel: int | None = None
    ) -> tuple[ParameterRow, ...]:
        """Return every number of the table, row by row."""
        return tuple(
            ParameterRow(
                one.name, "", one.value, one.unit, _MEANINGS[one.key[0]], given=True,
                source=self._type, span=one.span,
            )
            for one in self.geometry(kinematic, channel)
        )  # fmt: skip

    def geometry(
        self, kinematic: int | str | tuple[int | str, int | str] | None = None, channel: int | None = None
    ) -> tuple[Datum, ...]:
        """Return every number of the table: a1 is a of row 1."""
        return tuple(
            Datum(f"{name}{n}", "", row.values[name], unit, row.spans[name], _CHANNEL, (name, n))
            for n, row in enumerate(self.table.rows, start=1)
            for name, unit in _UNITS.items()
        )

    def with_values(self, values: Mapping[Datum, float]) -> DhMachine:
        """Return the machine with other numbers."""
        checked_values(values)
        new = {datum.key: value for datum, value in values.items() if datum.key[0] in _UNITS}
        rows = tuple(
            replace(row, values={name: new.get((name, n), value) for name, value in row.values.items()})
            for n, row in enumerate(self.table.rows, start=1)
        )
        collector = Collector(self._collector.strict, list(self._reading))
        return DhMachine(self.path, changed_overlay(self.overlay, values), collector, replace(self.table, rows=rows))

    def _tool_data(self, selected: Selected) -> Iterable[Datum]:
        return ()

    def _channel(self, wanted: int | None, collector: Collector) -> int:
        if wanted not in (None, _CHANNEL):
            text = f"there is no channel {wanted!r}: a table of DH parameters has none"
            raise MachineDataError(text, span=Span(self.file), parameter="channel", permitted="no channel")
        return _CHANNEL

    def _tell_unused(self, names: Sequence[str], asked: Mapping[str, str], collector: Collector) -> None:
        for name in names:
            text = f"a table of DH parameters leaves nothing open: convention {name} has no effect"
            collector.add("CB528", text, span=Span(self.file))

    def _translate(self, selected: Selected, tool_length_mm: float, choose: Choices, collector: Collector) -> Chain:
        overlay, rows = self.overlay, self.table.rows
        refuse_useless(overlay, _USELESS, "a table of DH parameters", _USEFUL)
        _warn_of_radians(rows, collector)
        reach = sum(abs(row.values[name]) for row in rows for name in ("a", "d"))
        check_reach_magnitude(reach, rows[0].spans["a"], "lengths are in mm", collector)
        axes = tuple(_axis(row) for row in rows if row.name)
        elements = [element for row in rows for element in _elements(row, self.table.convention == "standard")]
        body = assemble(axes, [*elements, mark("flange"), shift(z=tool_length_mm)])
        chain = Chain(
            self.name, self.title, self.dialect, self._type, body.links, body.joints, body.frames, axes, body.axis_map,
            "orirpy",
        )  # fmt: skip
        chain = with_coupling(chain, overlay)
        chain = with_sums(chain.with_axes(overlay.apply_limits(chain.axes)), overlay)
        return with_named_poses(chain, overlay, collector)


def read_dh(path: Path, overlay: Overlay, collector: Collector) -> DhMachine:
    """Read a table of Denavit-Hartenberg parameters.

    Args:
        path: The file.
        overlay: What the file beside it adds.
        collector: Takes the findings.

    Raises:
        ChainbuildError: it does not say its convention, or a column or a row makes no sense.
    """
    return DhMachine(path, overlay, collector, read_table(path))


def _axis(row: DhJoint) -> Axis:
    axis = Axis.unlimited(row.name, "linear" if row.kind == "prismatic" else "rotary")
    if row.limits is None:
        return axis
    return replace(axis, lower=row.limits[0], upper=row.limits[1], assumed=False)


def _elements(row: DhJoint, standard: bool) -> Iterator[Element]:
    """Yield what a row is from one frame to the next: about and along z with its joint, about and along x."""
    x = Fixed(_shifted(row.values["a"], 0.0) @ turn(rot_x(row.values["alpha"])).T)
    theta, d = turn(rot_z(row.values["theta"])), Fixed(_shifted(0.0, row.values["d"]))
    if not standard:
        yield x
    yield theta
    yield d
    if row.kind == "revolute":
        yield rotary(row.name, "z")
    elif row.kind == "prismatic":
        yield linear(row.name, "z")
    if standard:
        yield x


def _shifted(x: float, z: float) -> Matrix:
    return translation(x, 0.0, z)


def _warn_of_radians(rows: Sequence[DhJoint], collector: Collector) -> None:
    """Warn where no angle is larger than a turn in radians and some are right angles in them."""
    angles = [(row, name, abs(row.values[name])) for row in rows for name in ("alpha", "theta")]
    right = [one for one in angles if any(abs(one[2] - turned) < _ROUNDED for turned in _RIGHT_ANGLES)]
    if right and max(angle for *_, angle in angles) < _FULL_TURN:
        row, name, _ = right[0]
        text = f"{name} {row.values[name]:g} and all other angles look like radians: they are read as degrees"
        collector.add("CB531", text, span=row.spans[name], parameter=name, hint="write 90 for 1.5708")
