"""Axes of a transformation with their software limits and speeds: $MA_POS_LIMIT_MINUS/PLUS, $MA_MAX_AX_VELO."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal

from chainbuild.chain.assemble import Move
from chainbuild.chain.elements import Axis
from chainbuild.findings import Collector
from chainbuild.sinumerik.data_table import DataTable, written_name
from chainbuild.sinumerik.internal_axes import InternalAxes
from chainbuild.sinumerik.reader import Assignment
from chainbuild.sinumerik.robx import Robx
from chainbuild.units import AxisKind, deg_from_rad, m_s_from_mm_min, mm_from_m, rad_s_from_rpm

# The control's own default for an axis without software limits is ±1e8.
_NO_LIMIT = 1e8
_ENDLESS = 4


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

    The channel axis' number is the machine axis' unless $MC_AXCONF_MACHAX_USED says otherwise.
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
    return tuple(dict.fromkeys(names))


def _limited(axis: Axis, robx: Robx, table: DataTable, channel_axis: int, collector: Collector) -> Axis:
    names = machine_axis_names(robx, table, channel_axis)

    def row(datum: str) -> Assignment | None:
        found = sorted((r for name in names if (r := table.axis(datum, name))), key=lambda r: r.span.line)
        if len(found) > 1:
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
