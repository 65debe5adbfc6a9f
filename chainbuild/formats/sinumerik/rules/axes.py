"""Rules on axes that need no geometry: assignment, sequence, wrist type, additional axes, gripper-referred motion.

Data that the controller refuses are refused with its alarm; sound data outside the manual's lists leave a warning.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Final

from chainbuild import tolerances
from chainbuild.chain.elements import Axis
from chainbuild.chain.names import channel_names, name_fault
from chainbuild.convention import Choices
from chainbuild.errors import UnsupportedKinematicError
from chainbuild.findings import Collector
from chainbuild.formats.sinumerik.reading.assignment import Assignment
from chainbuild.formats.sinumerik.reading.data_table import DataTable, written_name
from chainbuild.formats.sinumerik.reading.robx import ExtraAxis, ExtraGroup, Robx, inputs_by_default
from chainbuild.formats.sinumerik.reading.transformations import DatumReport
from chainbuild.formats.sinumerik.rules.plausible import check_plausible

_ROBOT_INPUTS: Final = 6  # elements of TRAFO_AXES_IN for the robot's own axes
_USED_INPUTS: Final = 15  # elements of TRAFO_AXES_IN that ROBX reads
_MAX_CHANNEL_AXES: Final = 20  # of a channel of the control
_SPINDLE: Final = 2  # AXES_TYPE of a spindle
_WRISTS_BY_AXES = {4: (1, 2, 3), 5: (2, 3), 6: (2, 3, 5, 6)}
_GRIPPER_ON: Final = 2  # GRIP_REL_RESET_MODE: gripper-referred motion from reset on
_OPTION_BIT: Final = 1 << 16  # of the option's element: the transformation is released
_OPTION_ELEMENT: Final = 3  # of TECHNO_EXTENSION_MASK that holds the option
_TABLE: Final = "AXCONF_CHANAX_NAME_TAB"
_OWN: Final = "a name of its own for each axis"
_LONGEST: Final = 31  # characters of an identifier of NC programs
_IDENTIFIER: Final = re.compile(r"[A-Za-z_]\w*", re.ASCII)


def check_axes(robx: Robx, table: DataTable, collector: Collector) -> None:
    """Check everything that does not depend on conventions.

    Raises:
        MachineDataError: the data describe no machine (strict collector).
        UnsupportedKinematicError: spindle drives.
    """
    report = DatumReport(robx, collector)
    _check_inputs(report)
    _check_spindles(report)
    _check_wrist_type(report)
    _check_sequence(report)
    _check_parallelogram(report)
    for axis in (*robx.base_axes, *robx.table.axes, *robx.flange.axes):
        _check_direction(report, axis)
    _check_offsets(report, robx.table, "workpiece", "EXT_ROT_BASE_OFFSET", "EXT_ROT_JOINT_OFFSET")
    _check_offsets(report, robx.flange, "flange", "EXT_FL_ROT_BASE_OFFSET", "EXT_FL_ROT_JOINT_OFF")
    _check_flange_axes(report)
    _note_gripper(report)
    _check_features(report, table)
    check_plausible(robx, collector)


def _check_inputs(report: DatumReport) -> None:
    robx = report.robx
    name = f"TRAFO_AXES_IN_{robx.transformation}"
    robot = robx.axes_in[:_ROBOT_INPUTS]
    named = sum(1 for axis in robot if axis)
    default = inputs_by_default(robx.data, robx.transformation)
    if default:
        shown = ", ".join(f"[{n}] = {robot[n]}" for n in default)
        report.add("CB124", f"$MC_{name} is given in part: {shown} is the control's default", general=name)
    if named != robx.num_axes or 0 in robot[: robx.num_axes]:
        lacks = "" if robx.given("NUM_AXES") else f" (the default: {robx.parameter('NUM_AXES')} is missing)"
        shown = ", ".join(str(axis) for axis in robot)
        report.add(
            "CB302",
            f"$MC_{name} names {named} robot axes ({shown}), NUM_AXES is {robx.num_axes}{lacks}",
            general=name,
            permitted=f"the first {robx.num_axes} inputs filled, the others of the first six 0",
            alarm=75311,
        )
    used = [axis for axis in robx.axes_in[:_USED_INPUTS] if axis]
    double = sorted({axis for axis in used if used.count(axis) > 1})
    if double:
        text = f"$MC_{name} names channel axis {double[0]} twice"
        report.add("CB302", text, general=name, permitted="each channel axis once", alarm=75311)
    _check_channel_axes(report, used)
    if any(robx.axes_in[_USED_INPUTS:]):
        report.add("CB334", f"$MC_{name} fills inputs beyond 14, which ROBX does not read", general=name)
    tool = f"TRAFO_INCLUDES_TOOL_{robx.transformation}"
    if robx.data.row(tool) is not None and not robx.data.number(tool):
        report.add("CB333", f"$MC_{tool} is 0: ROBX needs 1 to handle the tool itself", general=tool)


def _check_channel_axes(report: DatumReport, used: Sequence[int]) -> None:
    """Warn of axes that the channel does not have: beyond the most that one can have, or without a machine axis."""
    name, data = f"TRAFO_AXES_IN_{report.robx.transformation}", report.robx.data
    beyond = [axis for axis in used if axis > _MAX_CHANNEL_AXES]
    if beyond:
        text = f"$MC_{name} names channel axis {beyond[0]}; a channel has at most {_MAX_CHANNEL_AXES}"
        report.add("CB344", text, general=name, permitted=f"0 to {_MAX_CHANNEL_AXES}")
    for axis in used:
        row = data.row("AXCONF_MACHAX_USED", axis - 1)
        if row is not None and row.value == 0.0:
            text = f"$MC_{name} names channel axis {axis}, which has no machine axis: MACHAX_USED[{axis - 1}] is 0"
            report.collector.add("CB344", text, span=row.span, parameter=f"$MC_AXCONF_MACHAX_USED[{axis - 1}]")


def _check_spindles(report: DatumReport) -> None:
    robx = report.robx
    spindle = [n for n, kind in enumerate(robx.axes_type[: robx.num_axes]) if kind == _SPINDLE]
    if spindle:
        report.add(
            "CB304",
            f"AXES_TYPE[{spindle[0]}] = 2: the transformation does not support triangular or trapezoidal spindles",
            ("AXES_TYPE",),
            permitted="1 linear, 3 rotary, 4 endless rotary",
            error=UnsupportedKinematicError,
        )
    if robx.data.number("ROBX_SPIN_ON"):
        text = "SPIN_ON = 1: the transformation does not support triangular or trapezoidal spindles"
        report.add("CB304", text, ("SPIN_ON",), permitted="0", error=UnsupportedKinematicError)


def _check_wrist_type(report: DatumReport) -> None:
    robx = report.robx
    permitted = _WRISTS_BY_AXES[robx.num_axes]
    lacks = "" if robx.given("WRIST_AXES") else f" (the default: {robx.parameter('WRIST_AXES')} is missing)"
    if robx.wrist not in permitted:
        report.add(
            "CB305",
            f"wrist type {robx.wrist}{lacks} does not fit {robx.num_axes} axes",
            ("WRIST_AXES", "NUM_AXES"),
            permitted=" or ".join(str(wrist) for wrist in permitted),
        )


def _check_sequence(report: DatumReport) -> None:
    robx = report.robx
    used, n = robx.axis_seq[: robx.num_axes], robx.num_axes
    if sorted(used) != list(range(1, n + 1)):
        text = f"AXIS_SEQ {', '.join(map(str, used))} does not name each of the axes 1 to {n} once"
        report.add("CB319", text, ("AXIS_SEQ",), permitted=f"a permutation of 1 to {n}")
        return
    moved = {i + 1 for i, number in enumerate(used) if number != i + 1}
    free = _exchangeable(robx)
    if not moved <= free:
        which = f"axes {', '.join(map(str, sorted(free)))} may change places" if free else "the given order only"
        text = f"AXIS_SEQ {', '.join(map(str, used))} exchanges axes that a {robx.arrangement} cannot exchange"
        report.add("CB320", text, ("AXIS_SEQ",), permitted=which)


def _exchangeable(robx: Robx) -> set[int]:
    """Return the axes that AXIS_SEQ may permute without changing what the machine does (ROBX manual 5.3.15)."""
    if robx.arrangement == "CC" and robx.num_axes == 4 and robx.a4par:
        return {1, 2, 3, 4}
    return {"SS": {1, 2, 3}, "CC": {1, 2, 3}, "SC": {1, 2}, "CS": {2, 3}}.get(robx.arrangement, set())


def _check_parallelogram(report: DatumReport) -> None:
    robx = report.robx
    lower, upper = robx.parallel_limits_deg
    if robx.special_kin == 2 and robx.arrangement != "NR":
        text = f"SPECIAL_KIN 2 couples axis 3 to axis 2 of an articulated arm, not of a {robx.arrangement}"
        report.add("CB321", text, ("SPECIAL_KIN", "MAIN_AXES"), permitted="MAIN_AXES 3 (NR)")
    if robx.special_kin == 2 and lower >= upper:
        text = f"the limit angles of the parallelogram leave no range: {lower:g} to {upper:g}"
        report.add("CB323", text, ("SW_LIMITS_PARALLEL",), permitted="lower below upper")


def _check_direction(report: DatumReport, axis: ExtraAxis) -> None:
    length = math.sqrt(math.fsum(c * c for c in axis.direction))
    name = axis.vector_name.removeprefix("ROBX_")
    if length < tolerances.ZERO_VECTOR:
        text = f"the direction of additional axis {axis.name} is the zero vector"
        report.add("CB324", text, (name,), permitted="a vector of length 1")
    elif abs(length - 1.0) > tolerances.UNIT_VECTOR:
        text = f"the direction of additional axis {axis.name} has length {length:.9g}; it is normalised"
        report.add("CB325", text, (name,), permitted="a vector of length 1")


def _check_offsets(report: DatumReport, group: ExtraGroup, where: str, base: str, joint: str) -> None:
    """Warn where an offset is given but no axis follows on it."""
    slots = {axis.slot for axis in group.axes}
    unused = []
    if any(group.base_mm) and not slots:
        unused.append(base)
    unused += [
        f"{joint}_{n + 1}" for n, offset in enumerate(group.joints_mm) if any(offset) and not max(slots, default=0) > n
    ]
    for name in unused:
        what = "the convention leftover_joint_offset says whether it counts" if slots else "it has no effect"
        report.add("CB335", f"{name} is given, but no additional axis of the {where} follows on it: {what}", (name,))


def _check_flange_axes(report: DatumReport) -> None:
    robx = report.robx
    if robx.flange.axes and robx.num_axes < _ROBOT_INPUTS:
        report.add(
            "CB326",
            f"additional axes at the flange need a robot of six axes, not {robx.num_axes}",
            general=f"TRAFO_AXES_IN_{robx.transformation}",
            permitted="0 in the inputs 12 to 14",
            alarm=75373,
        )


def _note_gripper(report: DatumReport) -> None:
    """Check gripper-referred motion where MD62951 switches it on after a reset: the chain is built without it."""
    robx = report.robx
    if robx.control.grip_reset_mode != _GRIPPER_ON:
        return
    if robx.num_axes < _ROBOT_INPUTS:
        _refuse_few_axes(report)
        return
    text = "after a reset this machine is in gripper-referred motion; the chain is built without it"
    report.add("CB329", text, ("GRIP_REL_RESET_MODE",), hint="choose the kinematic 'gripper' for it")


def check_gripper(robx: Robx, choose: Choices, collector: Collector) -> None:
    """Check gripper-referred motion that is asked for: six axes (ROBX manual 9.2.1).

    9.1.3 names additional axes of the base only; whether those of workpiece and flange are permitted is the convention
    `gripper_extra_axes`.

    Args:
        robx: The transformation.
        choose: Conventions.
        collector: Takes the findings.
    """
    report = DatumReport(robx, collector)
    if robx.num_axes < _ROBOT_INPUTS:
        _refuse_few_axes(report)
    elif (robx.table.axes or robx.flange.axes) and choose["gripper_extra_axes"] == "refused":
        text = "the manual names no gripper-referred motion with additional axes of the workpiece or of the flange"
        permitted = "additional axes of the base only"
        hint = "the convention gripper_extra_axes=built builds it"
        report.add("CB328", text, general=f"TRAFO_AXES_IN_{robx.transformation}", permitted=permitted, hint=hint)


def _refuse_few_axes(report: DatumReport) -> None:
    """Refuse gripper-referred motion with fewer axes than six.

    The alarm's own text (11.5) also speaks of some 5-axis robots; 9.2.1 excludes them, and 9.2.1 is followed.
    """
    hint = "the alarm's text also names 5-axis robots of type SS, CC or SC; section 9.2.1 excludes them"
    text = f"gripper-referred motion needs a robot of six axes, not {report.robx.num_axes}"
    report.add("CB327", text, ("GRIP_REL_RESET_MODE", "NUM_AXES"), permitted="0 or 1", alarm=75321, hint=hint)


def _check_features(report: DatumReport, table: DataTable) -> None:
    robx = report.robx
    if robx.feature_mask & ~1:
        text = f"SPECIAL_FEATURE_MASK 'H{robx.feature_mask:X}' sets bits that the manual does not name; it names bit 0"
        report.add("CB331", text, ("SPECIAL_FEATURE_MASK",))
    option = table.shared("TECHNO_EXTENSION_MASK", _OPTION_ELEMENT)
    if option is not None and not isinstance(option.value, str) and not int(option.value) & _OPTION_BIT:
        text = "bit 16 of TECHNO_EXTENSION_MASK[3] is not set: a control before release 06.01.00 would raise 75319"
        report.collector.add("CB332", text, span=option.span)


def check_axis_names(table: DataTable, collector: Collector) -> None:
    """Refuse names of channel axes that tables could not hold, and those of two axes of a channel."""
    seen: dict[tuple[int, str], Assignment] = {}
    for (channel, _, datum, index), row in table.rows.items():
        name = str(row.value)
        if datum != _TABLE or not name:
            continue
        parameter = written_name(row.datum, False, index)
        fault = name_fault(name)
        first = seen.setdefault((channel, name.casefold()), row)
        if first is not row:
            fault = f"two axes of a channel are called {name!r}, also in line {first.span.line}", _OWN
        if fault is not None:
            collector.add("CB118", fault[0], span=row.span, parameter=parameter, permitted=fault[1])
        elif not _IDENTIFIER.fullmatch(name) or len(name) > _LONGEST:
            text = f"an NC program cannot name the axis {name[:40]!r}"
            permitted = f"a letter, then letters, digits and _, at most {_LONGEST} characters"
            collector.add("CB119", text, span=row.span, parameter=parameter, permitted=permitted)


def names_of_axes(
    axes: Sequence[Axis], channel_axes: Sequence[int], robx: Robx, collector: Collector
) -> tuple[str, ...]:
    """Return the channel's names of the axes of a transformation, the generic one where the file names none.

    Args:
        axes: The axes by their generic names.
        channel_axes: Number of the channel axis of each, from 1.
        robx: The transformation.
        collector: Takes a finding where the channel calls one axis by the generic name of another without a name.
    """
    rows = [robx.data.row(_TABLE, number - 1) for number in channel_axes]
    given = ["" if row is None else str(row.value) for row in rows]
    names, lost = channel_names(axes, given)
    for n in lost:
        generic = axes[n].name
        row = next(row for row in rows if row is not None and str(row.value).casefold() == generic.casefold())
        text = f"{row.value} is the name of another axis than {generic} of the robot, which is called {names[n]}"
        hint = f"name all axes: ${row.datum.prefix}_{_TABLE}[{channel_axes[n] - 1}] is missing"
        collector.add("CB119", text, span=row.span, parameter=written_name(row.datum, False, row.index), hint=hint)
    return names
