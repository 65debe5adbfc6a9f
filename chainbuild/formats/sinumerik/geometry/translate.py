"""Translation of a ROBX transformation into a chain recipe (ROBX manual 5.3.1: the modular principle).

    WO → TROWO → RO → TIRORO → IRO → A1 A2 A3 → P3 → TX3P3 → X3 → A4 A5 A6 → WP → TFLWP → FL
       → flange axes → TTCFL → TC → TFL_EXT → lengths → tool rotation → TCP

In gripper-referred motion the robot carries the workpiece and the tool is fixed in WO.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from chainbuild import frames
from chainbuild.arrays import Matrix
from chainbuild.chain.assemble import Element, Fixed, linear, mark, rotary, shift
from chainbuild.convention import Choices
from chainbuild.formats.sinumerik.geometry.robot_axes import RECIPES, ArmData, InternalAxes, internal_axes, wrist
from chainbuild.formats.sinumerik.geometry.tool import Tool, length_transform, turn_transform
from chainbuild.formats.sinumerik.reading.robx import ExtraAxis, ExtraGroup, FrameData, Robx


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


def table_axes(robx: Robx, choose: Choices) -> list[Element]:
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
    return [*start, *_group(robx.table, choose), shift(*robx.table.part_mm)]


def flange_axes(robx: Robx, choose: Choices) -> list[Element]:
    """Return the axes that turn the tool, from FL on; nothing where there are none."""
    return _group(robx.flange, choose) if robx.flange.axes else []


def _group(group: ExtraGroup, choose: Choices) -> list[Element]:
    """Return Trans(base)·R(1)·Trans(joint 1)·R(2)·Trans(joint 2)·R(3); an axis that does not exist does not turn.

    Convention: `leftover_joint_offset`, where an offset is given but no axis follows on it.
    """
    by_slot = {axis.slot: axis for axis in group.axes}
    elements: list[Element] = [shift(*group.base_mm)]
    for slot in range(3):
        elements += _turn(by_slot.get(slot))
        if slot < len(group.joints_mm):
            leftover = slot >= max(by_slot) and any(group.joints_mm[slot])
            if not leftover or choose["leftover_joint_offset"] == "counts":
                elements.append(shift(*group.joints_mm[slot]))
    return elements


def _turn(axis: ExtraAxis | None) -> Sequence[Element]:
    return [] if axis is None else [rotary(axis.name, axis.direction, offset_deg=-axis.offset)]


@dataclass(frozen=True, slots=True, eq=False)
class Translation:
    """A transformation as two branches of `assemble`, both from WO.

    Attributes:
        tool: Branch to the tool.
        workpiece: Branch to the workpiece.
        internal: The robot axes in the transformation's order.
        basic: Elements of the basic axes, IRO to P3.
    """

    tool: tuple[Element, ...]
    workpiece: tuple[Element, ...]
    internal: InternalAxes
    basic: tuple[Element, ...]


def translate(robx: Robx, tool: Tool, tool_length_mm: float, gripper: bool, choose: Choices) -> Translation:
    """Translate a transformation.

    Args:
        robx: The transformation, checked.
        tool: The active tool.
        tool_length_mm: Added to tool length 1.
        gripper: True for gripper-referred motion (ROBX manual 9).
        choose: Conventions.
    """
    internal = internal_axes(robx, choose)
    basic = tuple(RECIPES[robx.main_axes](ArmData(internal, *robx.lengths_mm, choose)))
    arm = [
        Fixed(robx.tiroro.T()),
        *basic,
        Fixed(robx.tx3p3.T()),
        *wrist(robx, internal),
        Fixed(flange_frame(robx, choose).T()),
        mark("flange"),
    ]
    length, turn = length_transform(robx, tool, tool_length_mm, choose), turn_transform(robx, tool, choose)
    if gripper:
        return Translation(*_gripper(robx, arm, length, turn, choose), internal, basic)
    tool_branch = [*base_axes(robx), Fixed(robx.trowo.T()), *arm, *_from_flange(robx, length, turn, choose)]
    return Translation(tuple(tool_branch), tuple(table_axes(robx, choose)), internal, basic)


def flange_frame(robx: Robx, choose: Choices) -> FrameData:
    """Return TFLWP with its third angle's default settled (convention `tflwp_default_c`)."""
    if robx.tflwp_c_given:
        return robx.tflwp
    a, b, _ = robx.tflwp.rpy_deg
    return FrameData(robx.tflwp.position_mm, (a, b, float(choose["tflwp_default_c"])))


def _from_flange(robx: Robx, length: Matrix, turn: Matrix, choose: Choices) -> list[Element]:
    """Return the elements behind FL; the place of TFL_EXT is the convention `tfl_ext`."""
    before, carrier, after = _carrier(robx, choose)
    return [Fixed(before), *flange_axes(robx, choose), Fixed(carrier), Fixed(length), Fixed(after), Fixed(turn)]


def _carrier(robx: Robx, choose: Choices) -> tuple[Matrix, Matrix, Matrix]:
    """Return the transforms directly on FL, of the carrier behind the flange axes, and behind the tool lengths."""
    ext = frames.f_frame((0.0, 0.0, 0.0), robx.tfl_ext_rpy_deg)
    ttcfl = robx.ttcfl.T()
    if not any(robx.tfl_ext_rpy_deg):
        return np.eye(4), ttcfl, np.eye(4)
    place = choose["tfl_ext"]
    if place == "after_ttcfl":
        return np.eye(4), ttcfl @ ext, np.eye(4)
    if place == "after_fl":
        return ext, ttcfl, np.eye(4)
    return np.eye(4), ttcfl, ext


def _gripper(
    robx: Robx, arm: list[Element], length: Matrix, turn: Matrix, choose: Choices
) -> tuple[tuple[Element, ...], tuple[Element, ...]]:
    """Return both branches of gripper-referred motion: the robot carries the workpiece, WO the tool.

    Axes of the flange then turn the workpiece that the robot carries, those of the workpiece the fixed tool; whether
    this is permitted at all, `rules.axes` decides.

    Conventions: `gripper_trowo` and `gripper_flange_data`, each where its data are not zero.
    """
    trowo = robx.trowo.T()
    if not np.allclose(trowo, np.eye(4), atol=0.0) and choose["gripper_trowo"] == "inverse":
        trowo = frames.inverse(trowo)
    table, turned, tip = table_axes(robx, choose), flange_axes(robx, choose), length @ turn
    robot_side: list[Element] = turned
    tool_side = np.eye(4)
    if not np.allclose(robx.ttcfl.T(), np.eye(4), atol=0.0) or any(robx.tfl_ext_rpy_deg):
        used = choose["gripper_flange_data"]
        if used != "unused":
            before, carrier, after = _carrier(robx, choose)
            tip = length @ after @ turn
            if used == "tool_side":
                tool_side = before @ carrier
            else:
                robot_side = [Fixed(before), *turned, Fixed(carrier)]
    robot = [*base_axes(robx), Fixed(trowo), *arm, *robot_side]
    return (*table, Fixed(tool_side @ tip)), tuple(robot)
