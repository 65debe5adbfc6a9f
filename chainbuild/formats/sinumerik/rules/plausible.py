"""Plausibility of a sound transformation: vectors given in part, unexpected defaults, unusual lengths.

All of them are warnings or remarks: the chain follows the data.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final

from chainbuild import tolerances
from chainbuild.chain.check import ArmLength, check_length_magnitudes, check_reach_magnitude
from chainbuild.findings import Collector
from chainbuild.formats.sinumerik.reading.assignment import Assignment
from chainbuild.formats.sinumerik.reading.catalogue import catalogue
from chainbuild.formats.sinumerik.reading.robx import Robx
from chainbuild.formats.sinumerik.reading.transformations import DatumReport

_LETTERS = "XYZ"
_TURNS: Final = "ORIAX_TURN_TAB_1"
_TOOL_ANGLES: Final = 3  # $TC_DPC parameters with the angles A, B, C
_WITH_NORMAL: Final = 3  # MM_ENABLE_TOOL_ORIENT with which $TC_DPVN exists
_MOST_INDICES: Final = 10  # elements of a datum whose dimension no source states
_BASIC_AXES: Final = 3  # axes before the wrist
_ROTARY_BASIC = {
    "NR": (0, 1, 2),
    "NN": (0, 1, 2),
    "CC": (1, 2),
    "SC": (2,),
    "CS": (0,),
}  # RR: its order is a convention
_USE_LENGTH_B = ("NR", "CC", "NN")
_BEND = ("NR", "CC", "SC")
_REACH = ("NR", "CC", "NN")
_QUARTER: Final = math.pi / 2.0  # rad
_MAX_QUARTERS: Final = 4  # a whole turn; larger values are no angles in radians
_STEP: Final = math.pi / 12.0  # rad
_STEP_DIGITS: Final = 5e-5  # 0.7854 is 45° in radians, 0.785 may be an angle
_RADIAN_DIGITS: Final = 5e-4  # 1.571, 1.5708 and 1.570796 are quarter turns, 1.57 may be an angle


def check_plausible(robx: Robx, collector: Collector) -> None:
    """Note data that are sound but probably not intended."""
    report = DatumReport(robx, collector)
    _check_extra_vectors(report)
    for name in _other_vectors(robx):
        _check_parts(report, name)
    _check_forearm_frame(report)
    _check_upper_arm(report)
    _check_lengths(report)
    _check_radians(report)
    _check_orientation_axes(report)
    _check_tool_parameters(report)
    _check_block_elements(report)


def _check_radians(report: DatumReport) -> None:
    """Warn of angles that are whole parts of a turn in radians, to the digits given: machine data are in degrees."""
    data = report.robx.data
    for row in data.package_rows(te4=data.te4):
        if isinstance(row.value, str) or not (row.datum.unit == "deg" or _is_zero_of_rotary(report, row)):
            continue
        degrees = _meant_by_radians(row.value)
        if degrees is not None:
            name = row.datum.name.removeprefix("ROBX_")
            element = "" if row.index is None else f"[{row.index}]"
            text = f"{name}{element} is {row.value:g}: machine data give angles in degrees; is {degrees}° meant?"
            report.collector.add("CB350", text, span=row.span, parameter=report.robx.parameter(name))


def _is_zero_of_rotary(report: DatumReport, row: Assignment) -> bool:
    """Tell whether a row is the zero offset (MAMES) of a rotary axis."""
    if row.datum.name != "ROBX_MAMES" or not isinstance(row.index, int):
        return False
    arrangement = report.robx.arrangement
    return row.index >= _BASIC_AXES or row.index in _ROTARY_BASIC.get(arrangement, ())


def _meant_by_radians(value: float) -> int | None:
    """Return the degrees of an angle in radians: quarter turns to three digits, other multiples of 15° to four."""
    quarters = round(value / _QUARTER)
    if quarters and abs(quarters) <= _MAX_QUARTERS and abs(value - quarters * _QUARTER) < _RADIAN_DIGITS:
        return 90 * quarters
    steps = round(value / _STEP)
    near = abs(value - steps * _STEP) < _STEP_DIGITS
    return 15 * steps if near and steps and abs(value) <= _MAX_QUARTERS * _QUARTER else None


def _check_orientation_axes(report: DatumReport) -> None:
    """Warn where MD21120 turns the orientation axes in another sequence than TOOL_DIR (ROBX manual 6.1.3)."""
    robx = report.robx
    wanted = (1, 2, 3) if robx.tool_dir == 1 else (3, 2, 1)
    rows = [robx.data.row(_TURNS, n) for n in range(len(wanted))]
    for row, axis in zip(rows, wanted, strict=True):
        if row is not None and row.value != axis:
            order = ", ".join(str(number) for number in wanted)
            text = f"$MC_{_TURNS} contradicts TOOL_DIR = {robx.tool_dir}, by which it is {order}; TOOL_DIR is used"
            report.add("CB352", text, general=_TURNS, permitted=order)
            return


def _check_tool_parameters(report: DatumReport) -> None:
    """Warn of tool angles and vectors that the control has not reserved (ROBX manual 6.1.1, 6.1.2)."""
    robx, start = report.robx, report.robx.toa_start
    table = robx.data.table
    reserved, enabled = (table.shared(name, None) for name in ("MM_NUM_CC_TOA_PARAM", "MM_ENABLE_TOOL_ORIENT"))
    if start > 0 and reserved is not None and isinstance(reserved.value, float):
        last = start + _TOOL_ANGLES - 1
        if reserved.value < last:
            text = f"CC_TOA_START_NUM = {start} reads $TC_DPC{start} to $TC_DPC{last}, but $MN_MM_NUM_CC_TOA_PARAM"
            text += f" reserves {reserved.value:g}"
            report.add("CB353", text, ("CC_TOA_START_NUM",), permitted=f"MM_NUM_CC_TOA_PARAM of {last} or more")
    if start < 0 and enabled is not None and enabled.value != _WITH_NORMAL:
        text = f"CC_TOA_START_NUM = -1 reads $TC_DPV and $TC_DPVN, but $MN_MM_ENABLE_TOOL_ORIENT is {enabled.value:g}"
        report.collector.add(
            "CB354", text, span=enabled.span, parameter="$MN_MM_ENABLE_TOOL_ORIENT", permitted=str(_WITH_NORMAL)
        )


def _check_block_elements(report: DatumReport) -> None:
    """Warn where no block elements are reserved for compile cycles: ROBX needs one (ROBX manual 5.1.1)."""
    data, name = report.robx.data, "MM_NUM_CC_BLOCK_ELEMENTS"
    rows = [row for n in (None, *range(_MOST_INDICES)) if (row := data.row(name, n)) is not None]
    if rows and all(row.value == 0.0 for row in rows):
        text = f"$MC_{name} is 0: the transformation needs a block element of compile cycles"
        report.collector.add("CB355", text, span=rows[0].span, parameter=f"$MC_{name}", permitted="1 or more")


def _check_extra_vectors(report: DatumReport) -> None:
    """Warn of a direction of an additional axis given in part, and note one that is all default."""
    robx = report.robx
    for axis in (*robx.base_axes, *robx.table.axes, *robx.flange.axes):
        name = axis.vector_name.removeprefix("ROBX_")
        if robx.given(name):
            _check_parts(report, name)
            continue
        verb = "moves along" if axis.name.startswith("EX") else "turns about"
        letter = _LETTERS[axis.direction.index(1.0)] if sorted(axis.direction) == [0.0, 0.0, 1.0] else "its default"
        shown = ", ".join(f"{c:g}" for c in axis.direction)
        report.add("CB347", f"{axis.name} {verb} {letter}: {name} has its default ({shown})", (name,))


def _other_vectors(robx: Robx) -> Iterator[str]:
    """Yield the data whose default is not zero, so that an element left out is not a harmless zero."""
    if robx.arrangement in _USE_LENGTH_B:
        yield "MAIN_LENGTH_AB"
    if robx.num_axes == 6:
        yield "DHPAR4_5ALPHA"
    yield "TFLWP_RPY"


def _check_parts(report: DatumReport, name: str) -> None:
    """Warn of a vector of which the file gives some elements only."""
    datum, data = catalogue()[f"ROBX_{name}"], report.robx.data
    missing = [n for n in range(datum.dimension) if data.row(datum.name, n) is None]
    if not 0 < len(missing) < datum.dimension:
        return
    default = datum.default or datum.default_known
    shown = ", ".join(f"[{n}] = {default[n]:g}" if n < len(default) else f"[{n}]" for n in missing)
    count = "the default is used" if len(missing) == 1 else "the defaults are used"
    report.add("CB346", f"{name} is given in part: for {shown} {count}", (name,))


def _check_forearm_frame(report: DatumReport) -> None:
    """Warn of an arm with a wrist whose TX3P3_RPY is missing: axis 4 then lies across the forearm."""
    robx = report.robx
    if robx.arrangement == "NR" and robx.num_axes > 4 and not robx.given("TX3P3_RPY"):
        text = f"{robx.parameter('TX3P3_RPY')} is missing: its default 0, 0, 0 lays axis 4 across the forearm"
        report.add("CB348", text, ("TX3P3_RPY", "TX3P3_POS"), hint="0, 90, 0 is usual: axis 4 along the forearm")


def _check_upper_arm(report: DatumReport) -> None:
    """Warn of an arm whose lengths the file leaves to the default: 500 mm are rarely right."""
    robx = report.robx
    if robx.arrangement in _USE_LENGTH_B and not robx.given("MAIN_LENGTH_AB"):
        shown = ", ".join(f"{length:g}" for length in robx.lengths_mm[:2])
        text = f"{robx.parameter('MAIN_LENGTH_AB')} is missing: its default {shown} mm is used"
        report.add("CB351", text, ("MAIN_LENGTH_AB",))


def _check_lengths(report: DatumReport) -> None:
    robx = report.robx
    if robx.arrangement in _BEND:
        check_length_magnitudes(_arms(robx), report.collector)
    links = [value for link in robx.dh[: max(robx.num_axes - 4, 0)] for value in (link.a_mm, link.d_mm)]
    main = robx.lengths_mm if robx.arrangement in _USE_LENGTH_B else robx.lengths_mm[:1]
    reach = math.fsum(abs(length) for length in (*main, *links))
    reach += math.hypot(*robx.tx3p3.position_mm) + math.hypot(*robx.tflwp.position_mm)
    # Linear axes reach by their travel: what is short here says nothing there.
    if robx.arrangement in _REACH or reach > tolerances.ARM_REACH_MM[1]:
        span = robx.span("MAIN_LENGTH_AB", "TX3P3_POS")
        check_reach_magnitude(reach, span, "machine data are in mm: check for metres or micrometres", report.collector)


def _arms(robx: Robx) -> Sequence[ArmLength]:
    """Return the lengths between the parallel axes of an arm and its wrist; length B = 0 is refused elsewhere."""
    x, _, z = robx.tx3p3.position_mm
    parameter = robx.parameter("TX3P3_POS")
    arms = [ArmLength("the forearm", parameter, math.hypot(x, z), robx.span("TX3P3_POS"))]
    upper = abs(robx.lengths_mm[1])
    if robx.arrangement != "SC" and upper:
        parameter = f"{robx.parameter('MAIN_LENGTH_AB')}[1]"
        arms.insert(0, ArmLength("the upper arm", parameter, upper, robx.span("MAIN_LENGTH_AB")))
    return arms
