"""Additional axes: linear ones under the robot, rotary ones under the workpiece and at the flange (ROBX manual 8)."""

from __future__ import annotations

from collections.abc import Sequence

from chainbuild.chain.assemble import Element, linear, rotary, shift
from chainbuild.convention import Choices
from chainbuild.formats.sinumerik.reading.robx import ExtraAxis, ExtraGroup, Robx


def base_axes(robx: Robx, suffix: str = "") -> list[Element]:
    """Return the linear axes that carry the robot: Trans(Σ v·(e − offset)), directions in WO.

    Args:
        robx: The transformation.
        suffix: Added to the joint names where the same axes move a second body.
    """
    return [
        linear(axis.name + suffix, axis.direction, drive={axis.name: 1.0}, offset_mm=-axis.offset)
        for axis in robx.base_axes
    ]


def table(robx: Robx, choose: Choices) -> list[Element]:
    """Return the axes that turn the workpiece, from WO to the workpiece frame; nothing where there are none.

    Convention: `table_origin`.
    """
    if not robx.table.axes:
        return []
    origin = choose["table_origin"]
    start: list[Element] = []
    if origin == "riding":
        start = base_axes(robx, suffix="_table")
    if origin != "wo":
        start.append(shift(*robx.trowo.position_mm))
    return [*start, *_group(robx.table), shift(*robx.table.part_mm)]


def flange_axes(robx: Robx) -> list[Element]:
    """Return the axes that turn the tool, from FL on; nothing where there are none."""
    return _group(robx.flange) if robx.flange.axes else []


def _group(group: ExtraGroup) -> list[Element]:
    """Return Trans(base)·R(1)·Trans(joint 1)·R(2)·Trans(joint 2)·R(3); an axis that does not exist does not turn."""
    by_slot = {axis.slot: axis for axis in group.axes}
    elements: list[Element] = [shift(*group.base_mm)]
    for slot in range(3):
        elements += _turn(by_slot.get(slot))
        if slot < len(group.joints_mm):
            elements.append(shift(*group.joints_mm[slot]))
    return elements


def _turn(axis: ExtraAxis | None) -> Sequence[Element]:
    return [] if axis is None else [rotary(axis.name, axis.direction, offset_deg=-axis.offset)]
