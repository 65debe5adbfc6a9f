"""Data of a chain beyond its links: axes, the limit of a parallelogram, the absolute angle C, the control's checks.

Sources: $MA_POS_LIMIT_MINUS/PLUS, $MA_MAX_AX_VELO; ROBX manual 5.3.19–5.3.21, 7.1.7 and 10.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Final, Literal

import numpy as np

from chainbuild.arrays import Matrix
from chainbuild.chain.assemble import Fixed, Mark, Move
from chainbuild.chain.elements import Axis, ControllerSolver, SingularityWatch
from chainbuild.chain.sums import AxisConstraint, AxisSum
from chainbuild.convention import Choices
from chainbuild.findings import Collector
from chainbuild.formats.sinumerik.geometry.robot_axes import InternalAxes, InternalAxis
from chainbuild.formats.sinumerik.geometry.translate import Translation
from chainbuild.formats.sinumerik.reading.assignment import Assignment
from chainbuild.formats.sinumerik.reading.data_table import DataTable, written_name
from chainbuild.formats.sinumerik.reading.robx import Robx
from chainbuild.formats.sinumerik.reading.transformations import DatumReport
from chainbuild.formats.sinumerik.rules.axes import names_of_axes
from chainbuild.frames import angles_from_matrix
from chainbuild.units import AxisKind, deg_from_rad, m_s_from_mm_min, mm_from_m, rad_s_from_rpm

# The control's own default for an axis without software limits is ±1e8.
_NO_LIMIT: Final = 1e8
_ENDLESS: Final = 4  # number of an endless rotary axis in AXES_TYPE
_LIMIT_DATA = ("POS_LIMIT_MINUS", "POS_LIMIT_PLUS")
_NAMING_DATA = ("AXCONF_MACHAX_NAME_TAB", "AXCONF_LOGIC_MACHAX_TAB", "AXCONF_CHANAX_NAME_TAB")
_PLAIN_AXIS = re.compile(r"AX\d+")


def machine_axes(
    robx: Robx, table: DataTable, internal: InternalAxes, basic: Sequence[Move], gripper: bool, collector: Collector
) -> tuple[Axis, ...]:
    """Return the axes in the order of TRAFO_AXES_IN: A1 … A6, EX, EW, EF, with the names and limits the file gives.

    Args:
        robx: The transformation.
        table: The file's data.
        internal: The robot axes in the transformation's order.
        basic: Joints of the three basic axes.
        gripper: True where the robot carries the workpiece.
        collector: Takes findings on names and limits.
    """
    robot: Literal["tool", "workpiece"] = "workpiece" if gripper else "tool"
    kinds: list[AxisKind] = ["rotary" if move.kind == "revolute" else "linear" for move in basic]
    kinds += ["rotary"] * (robx.num_axes - 3)
    kind_of = {axis.name: (kind, i) for i, (axis, kind) in enumerate(zip(internal.math, kinds, strict=True))}
    plain: list[tuple[Axis, int]] = []
    endless: set[str] = set()
    for number in range(robx.num_axes):
        name = f"A{number + 1}"
        kind, i = kind_of[name]
        plain.append((Axis.unlimited(name, kind, robot), robx.axes_in[number]))
        if kind == "rotary" and _ENDLESS in (robx.axes_type[i], robx.axes_type[number]):
            endless.add(name)
    for extra in (*robx.base_axes, *robx.table.axes, *robx.flange.axes):
        other: Literal["tool", "workpiece"] = "tool" if gripper else "workpiece"
        carries = other if extra.name.startswith("EW") else robot
        extra_kind: AxisKind = "linear" if extra.name.startswith("EX") else "rotary"
        axis = replace(Axis.unlimited(extra.name, extra_kind, carries), held=True)
        plain.append((axis, extra.channel_axis))
    axes, numbers = zip(*plain, strict=True)
    found = []
    for axis, number, name in zip(axes, numbers, names_of_axes(axes, numbers, robx, collector), strict=True):
        named = replace(axis, name=name, generic="" if name == axis.name else axis.name)
        limited = _limited(named, robx, table, number, collector)
        _check_kind(named, robx, table, number, collector)
        found.append(_endless(limited) if axis.name in endless else limited)
    return tuple(found)


def _check_kind(axis: Axis, robx: Robx, table: DataTable, channel_axis: int, collector: Collector) -> None:
    """Warn where IS_ROT_AX makes a rotary axis of the robot linear, or the reverse."""
    for name in machine_axis_names(robx, table, channel_axis):
        row = table.axis("IS_ROT_AX", name)
        if row is not None and bool(_number(row)) != (axis.kind == "rotary"):
            parameter = written_name(row.datum, False, row.index)
            text = f"{parameter} is {_number(row):g}, but axis {axis.name} of the transformation is {axis.kind}"
            permitted = "1" if axis.kind == "rotary" else "0"
            collector.add("CB356", text, span=row.span, parameter=parameter, permitted=permitted)
            return


def _endless(axis: Axis) -> Axis:
    unlimited = Axis.unlimited(axis.name, axis.kind, axis.carries)
    return replace(unlimited, endless=True, held=axis.held, max_speed=axis.max_speed, generic=axis.generic)


def machine_axis_names(robx: Robx, table: DataTable, channel_axis: int) -> tuple[str, ...]:
    """Return the names that axis data may use: AXn, and the machine axis' own name; none without machine axis.

    The channel axis' number is the machine axis' unless $MC_AXCONF_MACHAX_USED says otherwise. Archives may write the
    channel axis' name (MD11230 MD_FILE_STYLE, bit 2); it is used where no machine axis has this name.
    """
    used = robx.data.row("AXCONF_MACHAX_USED", channel_axis - 1)
    number = int(used.value) if used is not None and not isinstance(used.value, str) else channel_axis
    if number == 0:
        return ()
    logic = table.shared("AXCONF_LOGIC_MACHAX_TAB", number - 1)
    names = [str(logic.value).upper() if logic is not None and logic.value else f"AX{number}"]
    own = table.shared("AXCONF_MACHAX_NAME_TAB", number - 1)
    if own is not None:
        names.append(str(own.value).upper())
    in_channel = robx.data.row("AXCONF_CHANAX_NAME_TAB", channel_axis - 1)
    if in_channel is not None and str(in_channel.value).upper() not in table.texts("AXCONF_MACHAX_NAME_TAB"):
        names.append(str(in_channel.value).upper())
    return tuple(name for name in dict.fromkeys(names) if name)


def warn_of_orphans(table: DataTable, transformations: Sequence[Robx], collector: Collector) -> None:
    """Warn of software limits of axes that no transformation has, where they may be meant for one of its axes.

    Other axes of the machine may have limits, too: an axis that the file itself names leaves no warning, nor does AXn
    where every axis of the transformations has its limits.
    """
    used = [names for robx in transformations for axis in robx.axes_in if (names := _names_of(robx, table, axis))]
    known = {name for names in used for name in names}
    limits = {str(row.index): row for row in table.rows.values() if row.datum.name in _LIMIT_DATA}
    complete = all(any(name in limits for name in names) for names in used)
    declared = {name for datum in _NAMING_DATA for name in table.texts(datum)}
    orphans = [
        name
        for name in limits
        if name not in known and name not in declared and not (complete and _PLAIN_AXIS.fullmatch(name))
    ]
    if orphans and used:
        axes = ", ".join(dict.fromkeys(" or ".join(names) for names in used))
        text = f"software limits of {', '.join(orphans)}: no axis of a transformation has this name; they are ignored"
        collector.add("CB349", text, span=limits[orphans[0]].span, hint=f"its axes are {axes}")


def _names_of(robx: Robx, table: DataTable, channel_axis: int) -> tuple[str, ...]:
    return machine_axis_names(robx, table, channel_axis) if channel_axis else ()


def _limited(axis: Axis, robx: Robx, table: DataTable, channel_axis: int, collector: Collector) -> Axis:
    names = machine_axis_names(robx, table, channel_axis)

    def row(datum: str) -> Assignment | None:
        found = sorted((r for name in names if (r := table.axis(datum, name))), key=lambda r: r.span.line)
        if other := next((r for r in found if r.value != found[-1].value), None):
            first, last = (written_name(r.datum, False, r.index) for r in (other, found[-1]))
            text = f"{first} in line {other.span.line} and {last} are the same axis; the last value is used"
            collector.add("CB113", text, span=found[-1].span, parameter=last)
        return found[-1] if found else None

    minus, plus, speed = row("POS_LIMIT_MINUS"), row("POS_LIMIT_PLUS"), row("MAX_AX_VELO")
    if speed is not None and _number(speed) > 0:
        rpm = axis.kind == "rotary"
        value = _number(speed)
        axis = replace(
            axis, max_speed=deg_from_rad(rad_s_from_rpm(value)) if rpm else mm_from_m(m_s_from_mm_min(value))
        )
    modulo = row("ROT_IS_MODULO")
    if axis.kind == "rotary" and modulo is not None and _number(modulo):
        return replace(axis, endless=True)
    return _bounded(axis, _limit(minus), _limit(plus), collector)


def _bounded(axis: Axis, minus: Assignment | None, plus: Assignment | None, collector: Collector) -> Axis:
    if minus is None and plus is None:
        return axis
    if minus is None or plus is None:
        present = minus or plus
        side = "lower" if minus else "upper"
        text = f"axis {axis.name} has only the {side} software limit; the other side is assumed"
        collector.add("CB115", text, span=present.span if present else None)
        lower = _number(minus) if minus else min(axis.lower, _number(plus) - 1.0) if plus else axis.lower
        upper = _number(plus) if plus else max(axis.upper, lower + 1.0)
        return replace(axis, lower=lower, upper=upper, assumed=True)
    if _number(minus) >= _number(plus):
        collector.add(
            "CB114",
            f"the software limits of axis {axis.name} leave no range: {_number(minus):g} to {_number(plus):g}",
            span=plus.span,
            parameter="$MA_POS_LIMIT_PLUS",
            permitted=f"more than {_number(minus):g}",
        )
        return axis
    return replace(axis, lower=_number(minus), upper=_number(plus), assumed=False)


def _limit(row: Assignment | None) -> Assignment | None:
    return row if row is not None and abs(_number(row)) < _NO_LIMIT else None


def _number(row: Assignment) -> float:
    return 0.0 if isinstance(row.value, str) else row.value


ALARM_PARALLELOGRAM: Final = 75329
ALARM_EXCESSIVE_SPEED: Final = 75324
_SCARA = ("CC", "SC", "CS")
_ANGLE_DEG: Final = 1e-6  # degrees: far below what machine data are written to
_PARALLEL: Final = 1e-6  # cosine: far below what machine data are written to
_WITH_HAND: Final = 5  # axes: from the fifth on there is an angle of the hand
_HANDLED_AXES: Final = (6, 3)  # robot axes and most additional ones with singularity handling, ROBX manual 10.1.2


def _sum(axes: Sequence[Axis], factors: Mapping[str, float], offset: float) -> AxisSum:
    return AxisSum(tuple(factors.get(axis.name, 0.0) for axis in axes), offset)


def constraints(
    robx: Robx, translation: Translation, axes: Sequence[Axis], choose: Choices
) -> tuple[AxisConstraint, ...]:
    """Return the limit on the parallelogram's angle (MD62964), or nothing.

    Convention: `parallelogram_monitor`.
    """
    if robx.special_kin != 2:
        return ()
    printed, elbow = _parallelogram_angles(translation, axes)
    angle = printed if choose["parallelogram_monitor"] == "mcs" else elbow
    lower, upper = robx.parallel_limits_deg
    return (AxisConstraint("parallelogram angle", angle, lower, upper, ALARM_PARALLELOGRAM),)


def _parallelogram_angles(translation: Translation, axes: Sequence[Axis]) -> tuple[AxisSum, AxisSum]:
    """Return the angle that the manual prints, A2 + A3 + 180°, and the angle between upper arm and forearm."""
    shoulder, pitch = (axis.name for axis in translation.internal.math[1:3])
    elbow = translation.internal.joints[2]
    return (
        _sum(axes, {shoulder: 1.0, pitch: 1.0}, 180.0),
        _sum(axes, {name: -factor for name, factor in elbow.drive.items()}, 180.0 - elbow.offset),
    )


def check_pose_data(
    robx: Robx, translation: Translation, axes: Sequence[Axis], choose: Choices, collector: Collector
) -> None:
    """Note where the printed parallelogram angle is watched and not the elbow's, and a feature bit without effect."""
    report = DatumReport(robx, collector)
    if robx.special_kin == 2 and choose["parallelogram_monitor"] == "mcs":
        printed, elbow = _parallelogram_angles(translation, axes)
        if not np.allclose((*printed.coefficients, printed.offset), (*elbow.coefficients, elbow.offset), atol=1e-9):
            text = "by AXES_DIR and MAMES the angle A2 + A3 + 180 that the limits watch is not the angle of the elbow"
            report.add("CB322", text, ("SW_LIMITS_PARALLEL", "AXES_DIR"))
    if robx.feature_mask & 1 and not shows_absolute_c(robx):
        text = "bit 0 of SPECIAL_FEATURE_MASK acts on 4-axis CC, SC and CS with A4PAR = 1 only; here it has no effect"
        report.add("CB342", text, ("SPECIAL_FEATURE_MASK",))


def shows_absolute_c(robx: Robx) -> bool:
    """Tell whether C runs on beyond ±180°: a 4-axis SCARA with A4 parallel and bit 0 of the feature mask."""
    return bool(robx.feature_mask & 1) and robx.num_axes == 4 and robx.a4par and robx.arrangement in _SCARA


def absolute_c(
    robx: Robx, translation: Translation, axes: Sequence[Axis], choose: Choices, collector: Collector
) -> AxisSum | None:
    """Return the absolute angle C as a sum of the rotary axes, or None where C is an angle of the pose.

    Conventions: `c_sum`, `c_offset`.
    """
    if not shows_absolute_c(robx):
        return None
    signs = _turning_signs(translation) if choose["c_sum"] == "signed" else {}
    _check_c_offset(robx, translation, collector)
    factors: dict[str, float] = {}
    offset = 0.0
    for axis in _rotary(translation):
        sign = signs.get(axis.name, 1.0)
        offset += sign * axis.offset
        for name, factor in axis.drive.items():
            factors[name] = factors.get(name, 0.0) + sign * factor
    given = robx.c_angle_offset_deg
    return _sum(axes, factors, offset + (given if choose["c_offset"] == "add" else -given))


def _check_c_offset(robx: Robx, translation: Translation, collector: Collector) -> None:
    """Warn where C_ANGLE_OFFSET is missing and the pose at mathematical zero shows a C (ROBX manual 5.3.20)."""
    if robx.given("C_ANGLE_OFFSET"):
        return
    T: Matrix = np.eye(4)
    for element in translation.tool:
        T = T @ element.T if isinstance(element, Fixed) else T
    shown = angles_from_matrix("orirpy2" if robx.tool_dir == 1 else "orirpy", T[:3, :3])[2]
    if abs(shown) > _ANGLE_DEG:
        text = f"C_ANGLE_OFFSET is missing, but the pose at mathematical zero shows C = {shown:.6g}: the absolute C"
        hint = f"ROBX manual 5.3.20: {robx.parameter('C_ANGLE_OFFSET')} = {-shown:.6g}"
        DatumReport(robx, collector).add("CB357", f"{text} starts at 0 there", ("C_ANGLE_OFFSET",), hint=hint)


def controller_solver(robx: Robx, translation: Translation, axes: Sequence[Axis]) -> ControllerSolver:
    """Return the budget of the control's iterative inverse, with the angle of axis 5 that its alarms watch."""
    if robx.num_axes < _WITH_HAND:
        return robx.control.solver
    hand = translation.internal.math[_WITH_HAND - 1]
    return replace(robx.control.solver, hand_angle=_sum(axes, hand.drive, hand.offset))


def singularity_watch(robx: Robx, choose: Choices) -> SingularityWatch:
    """Return the data on singularities, as far as the file gives them."""
    names = "SINGULARITY_THRESHOLD", "MIN_DIST_TO_SINGULARITY"
    threshold, clearance = (robx.data.table.shared(name, None) for name in names)
    row = robx.data.row("MM_NUM_SINGULARITY_BLOCKS")
    handled = None if row is None else bool(row.value)
    lacks = _lacks_handling(robx, handled)
    return SingularityWatch(
        threshold=None if threshold is None else float(threshold.value),
        clearance=None if clearance is None else float(clearance.value),
        speed_alarm=ALARM_EXCESSIVE_SPEED,
        handled=handled,
        measure=choose["singularity_measure"],
        block="whole_block" if lacks else choose["singular_block"],
        lacks=lacks,
    )


def _lacks_handling(robx: Robx, handled: bool | None) -> str:
    """Return why singularities in blocks are not handled, or an empty string (ROBX manual 10.1.2, 10.2.1)."""
    additional = len(robx.base_axes) + len(robx.table.axes) + len(robx.flange.axes)
    if robx.data.te4:
        return "the package TE4 does not have it"
    if robx.num_axes != _HANDLED_AXES[0]:
        return f"it needs {_HANDLED_AXES[0]} robot axes, here are {robx.num_axes}"
    if additional > _HANDLED_AXES[1]:
        return f"it permits {_HANDLED_AXES[1]} additional axes, here are {additional}"
    if handled is None:
        return "MD28592 $MC_MM_NUM_SINGULARITY_BLOCKS = 1 switches it on, and is not in the file"
    return "" if handled else "MD28592 $MC_MM_NUM_SINGULARITY_BLOCKS is 0"


def _rotary(translation: Translation) -> list[InternalAxis]:
    kinds = [move.kind for move in translation.basic if isinstance(move, Move)] + ["revolute"]
    return [axis for axis, kind in zip(translation.internal.math, kinds, strict=True) if kind == "revolute"]


def _turning_signs(translation: Translation) -> dict[str, float]:
    """Return −1 for each axis whose direction at mathematical zero is antiparallel to X of the flange, else +1."""
    T: Matrix = np.eye(4)
    directions: dict[str, Matrix] = {}
    flange_x = T[:3, 0]
    for element in translation.tool:
        if isinstance(element, Fixed):
            T = T @ element.T
        elif isinstance(element, Move):
            directions[element.name] = T[:3, :3] @ element.direction
        elif isinstance(element, Mark) and element.frame == "flange":
            flange_x = T[:3, 0]
    return {name: -1.0 if direction @ flange_x < _PARALLEL - 1.0 else 1.0 for name, direction in directions.items()}
