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
from chainbuild.formats.sinumerik.reading.catalogue import catalogue
from chainbuild.formats.sinumerik.reading.robx import Robx
from chainbuild.formats.sinumerik.reading.transformations import DatumReport

_LETTERS = "XYZ"
_USE_LENGTH_B = ("NR", "CC", "NN")
_BEND = ("NR", "CC", "SC")
_REACH = ("NR", "CC", "NN")
_QUARTER: Final = math.pi / 2.0  # rad
_MAX_QUARTERS: Final = 4  # a whole turn; larger values are no angles in radians
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


def _check_radians(report: DatumReport) -> None:
    """Warn of angles that are quarter turns in radians, to the digits given: machine data are in degrees."""
    data = report.robx.data
    for row in data.package_rows(te4=data.te4):
        if row.datum.unit != "deg" or isinstance(row.value, str):
            continue
        quarters = round(row.value / _QUARTER)
        if quarters and abs(quarters) <= _MAX_QUARTERS and abs(row.value - quarters * _QUARTER) < _RADIAN_DIGITS:
            name = row.datum.name.removeprefix("ROBX_")
            element = "" if row.index is None else f"[{row.index}]"
            text = f"{name}{element} is {row.value:g}: machine data give angles in degrees; is {90 * quarters}° meant?"
            report.collector.add("CB350", text, span=row.span, parameter=report.robx.parameter(name))


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
