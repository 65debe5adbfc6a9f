"""Finding the ROBX and TE4 transformations of a channel: TRAFO_TYPE_x, package and refusals (ROBX manual 5.1.3).

A `DatumReport` adds findings on one, with number, name and place of a datum in the same form everywhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from chainbuild.errors import ChainbuildError, MachineDataError, Span, UnsupportedKinematicError
from chainbuild.findings import Collector
from chainbuild.formats.sinumerik.reading.data_table import ChannelData, DataTable, written_name
from chainbuild.formats.sinumerik.reading.robx import Robx, read_robx


@dataclass(frozen=True, slots=True)
class DatumReport:
    """A transformation and the collector of its findings."""

    robx: Robx
    collector: Collector

    def add(
        self,
        code: str,
        text: str,
        data: Sequence[str] = (),
        *,
        general: str | None = None,
        permitted: str | None = None,
        alarm: int | None = None,
        hint: str | None = None,
        error: type[ChainbuildError] = MachineDataError,
    ) -> None:
        """Add a finding.

        Args:
            code: Finding number.
            text: What is wrong.
            data: Names without ROBX_: the first is the parameter at fault, the first that the file gives the place.
            general: Name of a datum that is not ROBX's, in place of `data`.
            permitted: What would be accepted.
            alarm: The controller's alarm.
            hint: What to do.
            error: Class that a strict collector raises.
        """
        span = self.robx.span(*data)
        parameter = self.robx.parameter(data[0]) if data else None
        if general is not None:
            span = self.robx.data.span(general) or span
            parameter = f"$MC_{general}"
        self.collector.add(
            code, text, span=span, parameter=parameter, permitted=permitted, alarm=alarm, hint=hint, error=error
        )


ROBX_TYPE: Final = 4100
TE4_TYPE: Final = 4099
_DATA_SETS = range(1, 21)
# Transformations that the control has without a compile cycle. Of orientation transformations: who is turned, by which
# of its rotary axes (SINUMERIK function manual Transformations, MD24100).
_CARDANIC: Final = 148  # no axes in its number
_TRAORI: Final = {
    **dict.fromkeys((16, 18, 20, 21), "the head turns the tool"),
    **dict.fromkeys((32, 33, 34, 35), "the table turns the workpiece"),
    **dict.fromkeys((48, 49, 50, 51), "the head turns the tool, the table the workpiece"),
    24: "the head turns the tool, its axes in any directions",
    40: "the table turns the workpiece, its axes in any directions",
    56: "the head turns the tool, the table the workpiece, their axes in any directions",
    _CARDANIC: "a cardanic head turns the tool",
}
_ORDERS: Final = {0: "A and B", 1: "A and C", 2: "B and A", 3: "B and C", 4: "C and A", 5: "C and B"}
_OTHER_TYPES: Final = {
    range(16, 72): "an orientation transformation (TRAORI)",
    range(72, 73): "an orientation transformation (TRAORI) whose data stand in a tool carrier",
    range(148, 149): "an orientation transformation (TRAORI)",
    range(256, 259): "a polar transformation (TRANSMIT)",
    range(512, 516): "a cylinder transformation (TRACYL)",
    range(1024, 1025): "the transformation of an inclined axis (TRAANG)",
    range(8192, 8193): "a chain of transformations (TRACON)",
}
_TRAORI_HINT: Final = (
    "describe its axes as a TwinCAT list of a machine of this kind: `chainbuild types`; one with directions and "
    "offsets as in $MC_TRAFO5_AXIS1, …JOINT_OFFSET, …PART_OFFSET and …BASE_TOOL is KIN_TYP 91: `chainbuild types 91`"
)


def find_transformations(table: DataTable, collector: Collector) -> tuple[Robx, ...]:
    """Return the transformations of all channels, in the order of channels and data sets.

    Raises:
        MachineDataError: a wrong TRAFO_TYPE (alarm 75312), or no transformation at all.
    """
    _refuse_inches(table, collector)
    found: list[Robx] = []
    refused = False
    for channel in sorted({row.channel for row in table.reading.assignments if row.datum.prefix == "MC"}):
        here = [robx for n in _DATA_SETS if (robx := _transformation(table, channel, n)) is not None]
        found += here
        _warn_of_other_package(table, channel, here, collector)
        refused = _refuse_untransformed(table, channel, here, collector) or refused
    if not found and not refused:
        text, span, hint = _what_it_is(table)
        behind = [finding for finding in collector.findings if finding.code == "CB111" and finding.hint]
        if behind and hint is None:  # a quoted mail, a listing with line numbers
            span = behind[0].span or span
            hint = f"lines with other text before such data were ignored, {len(behind)} of them: remove it"
        collector.add(
            "CB303",
            f"the file configures no ROBX transformation{text}",
            span=span,
            parameter="$MC_TRAFO_TYPE_1",
            permitted=f"{ROBX_TYPE} with $MC_ROBX_… data, {TE4_TYPE} with $MC_TRAFO6_… data",
            hint=hint,
            error=UnsupportedKinematicError,
        )
    return tuple(found)


def _what_it_is(table: DataTable) -> tuple[str, Span, str | None]:
    """Say what a file without ROBX describes instead: text, place, and what could be done with it."""
    file = table.reading.file
    rows = (row for row in table.reading.assignments if row.datum.family == "TRAFO_TYPE_{n}" and row.value)
    row = next(rows, None)
    kind = int(row.value) if row is not None and isinstance(row.value, float) else 0
    name = next((words for numbers, words in _OTHER_TYPES.items() if kind in numbers), None)
    if row is not None and name is not None:
        turned = f": {_TRAORI[kind]}{_axes_of(kind)}" if kind in _TRAORI else ""
        return f": TRAFO_TYPE {kind} is {name} of the control itself{turned}", row.span, _TRAORI_HINT
    if row is not None:
        return f": TRAFO_TYPE {kind} is another one", row.span, None
    if table.reading.kinematic_chain is not None:
        text = ": its kinematic is a chain of $NK_ elements"
        hint = "enter offsets and directions of its axes as a universal kinematic 91: `chainbuild types 91`"
        return text, table.reading.kinematic_chain, hint
    return "", Span(file), None


def _axes_of(kind: int) -> str:
    """Return the rotary axes that the number of an orientation transformation names: the fourth and the fifth."""
    return f", by its axes {_ORDERS[kind % 16]}" if kind % 16 in _ORDERS and kind < _CARDANIC else ""


def _refuse_inches(table: DataTable, collector: Collector) -> None:
    """Refuse a file whose control counts lengths in inches: everything here reads mm."""
    row = table.shared("SCALING_SYSTEM_IS_METRIC", None)
    if row is not None and row.value == 0.0:
        name = "$MN_SCALING_SYSTEM_IS_METRIC"
        text = f"{name} is 0: the lengths of this file are inches, which is not read"
        hint = "convert machine data and tool data to the metric system on the control (or all lengths by 25.4)"
        collector.add("CB125", text, span=row.span, parameter=name, permitted="1", hint=hint)


def _transformation(table: DataTable, channel: int, n: int) -> Robx | None:
    """Return the transformation in data set n, or None where the set has another kind or none."""
    data = table.channel(channel)
    kind = int(data.number(f"TRAFO_TYPE_{n}"))
    if kind == ROBX_TYPE and (data.package_rows(te4=False) or not data.package_rows(te4=True)):
        return read_robx(data, n)
    if kind == TE4_TYPE and data.package_rows(te4=True):
        return read_robx(table.channel(channel, te4=True), n)
    return None


def _refuse_untransformed(table: DataTable, channel: int, found: list[Robx], collector: Collector) -> bool:
    """Refuse a channel with data but no transformation of their type; tell whether anything was refused."""
    if found:
        return False
    data = table.channel(channel)
    refused = False
    for te4, wanted, package in ((False, ROBX_TYPE, "$MC_ROBX_…"), (True, TE4_TYPE, "$MC_TRAFO6_…")):
        rows = data.package_rows(te4=te4)
        if not rows:
            continue
        span, present = _type_span(data)
        state = f"is {present}" if present is not None else "is missing"
        collector.add(
            "CB301",
            f"channel {channel} holds {package} data, but $MC_TRAFO_TYPE_x {state}",
            span=span or rows[0].span,
            parameter="$MC_TRAFO_TYPE_1",
            permitted=str(wanted),
            alarm=75312,
            hint=f"set $MC_TRAFO_TYPE_1={wanted}",
        )
        refused = True
    return refused


def _warn_of_other_package(table: DataTable, channel: int, here: list[Robx], collector: Collector) -> None:
    """Warn of ROBX_* data in a channel whose transformations are TE4's, and the reverse: nothing reads them."""
    packages = {robx.package for robx in here}
    if len(packages) != 1:
        return
    te4 = "TE4" in packages
    rows = table.channel(channel).package_rows(te4=not te4)
    if rows:
        first = written_name(rows[0].datum, not te4, rows[0].index)
        names = "$MC_TRAFO6_…" if te4 else "$MC_ROBX_…"
        text = f"channel {channel} has a {'TE4' if te4 else 'ROBX'} transformation, which reads {names} only"
        more = f" and {len(rows) - 1} more" if len(rows) > 1 else ""
        hint = f"TRAFO_TYPE_x {ROBX_TYPE} reads $MC_ROBX_…, {TE4_TYPE} reads $MC_TRAFO6_…"
        collector.add("CB343", f"{text}: {first}{more} ignored", span=rows[0].span, parameter=first, hint=hint)


def _type_span(data: ChannelData) -> tuple[Span | None, int | None]:
    rows = (data.row(f"TRAFO_TYPE_{n}") for n in _DATA_SETS)
    row = next((row for row in rows if row is not None), None)
    return (row.span, int(row.value)) if row is not None and not isinstance(row.value, str) else (None, None)
