"""Axes of a transformation with their software limits and speeds: $MA_POS_LIMIT_MINUS/PLUS, $MA_MAX_AX_VELO."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from chainbuild.chain.assemble import Move
from chainbuild.chain.elements import Axis
from chainbuild.findings import Collector
from chainbuild.formats.sinumerik.geometry.internal_axes import InternalAxes
from chainbuild.formats.sinumerik.reading.assignment import Assignment
from chainbuild.formats.sinumerik.reading.data_table import DataTable, written_name
from chainbuild.formats.sinumerik.reading.robx import Robx
from chainbuild.units import AxisKind, deg_from_rad, m_s_from_mm_min, mm_from_m, rad_s_from_rpm

# The control's own default for an axis without software limits is ±1e8.
_NO_LIMIT = 1e8
_ENDLESS = 4
_LIMIT_DATA = ("POS_LIMIT_MINUS", "POS_LIMIT_PLUS")
_NAMING_DATA = ("AXCONF_MACHAX_NAME_TAB", "AXCONF_LOGIC_MACHAX_TAB", "AXCONF_CHANAX_NAME_TAB")
_PLAIN_AXIS = re.compile(r"AX\d+")


def machine_axes(
    robx: Robx, table: DataTable, internal: InternalAxes, basic: Sequence[Move], gripper: bool, collector: Collector
) -> tuple[Axis, ...]:
    """Return the axes in the order of TRAFO_AXES_IN: A1 … A6, EX, EW, EF, with the limits the file gives.

    Args:
        robx: The transformation.
        table: The file's data.
        internal: The robot axes in the transformation's order.
        basic: Joints of the three basic axes.
        gripper: True where the robot carries the workpiece.
        collector: Takes findings on limits.
    """
    robot: Literal["tool", "workpiece"] = "workpiece" if gripper else "tool"
    kinds: list[AxisKind] = ["rotary" if move.kind == "revolute" else "linear" for move in basic]
    kinds += ["rotary"] * (robx.num_axes - 3)
    kind_of = {axis.name: (kind, i) for i, (axis, kind) in enumerate(zip(internal.math, kinds, strict=True))}
    axes = []
    for number in range(robx.num_axes):
        name = f"A{number + 1}"
        kind, i = kind_of[name]
        axis = _limited(Axis.unlimited(name, kind, robot), robx, table, robx.axes_in[number], collector)
        endless = kind == "rotary" and _ENDLESS in (robx.axes_type[i], robx.axes_type[number])
        axes.append(_endless(axis) if endless else axis)
    for extra in (*robx.base_axes, *robx.table.axes, *robx.flange.axes):
        carries = "workpiece" if extra.name.startswith("EW") else robot
        extra_kind: AxisKind = "linear" if extra.name.startswith("EX") else "rotary"
        axis = replace(Axis.unlimited(extra.name, extra_kind, carries), held=True)
        axes.append(_limited(axis, robx, table, extra.channel_axis, collector))
    return tuple(axes)


def _endless(axis: Axis) -> Axis:
    unlimited = Axis.unlimited(axis.name, axis.kind, axis.carries)
    return replace(unlimited, endless=True, held=axis.held, max_speed=axis.max_speed)


def machine_axis_names(robx: Robx, table: DataTable, channel_axis: int) -> tuple[str, ...]:
    """Return the names under which axis data may stand: AXn, and the machine axis' own name; none without machine axis.

    The channel axis' number is the machine axis' unless $MC_AXCONF_MACHAX_USED says otherwise. Archives may write the
    channel axis' name (MD11230 MD_FILE_STYLE, bit 2); it counts where no machine axis bears it.
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

    Other axes of the machine may have limits, too: what the file itself names as an axis is not doubted, nor AXn
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
        if len(found) > 1 and found[0].value != found[-1].value:
            first, last = (written_name(r.datum, False, r.index) for r in (found[0], found[-1]))
            text = f"{first} in line {found[0].span.line} and {last} are the same axis; the last value counts"
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
