"""Restrictions of robots with four and five axes (ROBX manual 5.3.3–5.3.5)."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.arrays import Matrix
from chainbuild.chain.assemble import Fixed, Move
from chainbuild.convention import Choices
from chainbuild.formats.sinumerik.geometry.robot_axes import basic_moves
from chainbuild.formats.sinumerik.geometry.tool import Tool, length_transform
from chainbuild.formats.sinumerik.geometry.translate import Translation, flange_frame
from chainbuild.formats.sinumerik.reading.transformations import DatumReport

_CENTRAL: Final = 2  # number of the central wrist, see `robx.WRISTS`
_ANGLE: Final = 1e-9  # sines and cosines below this are 0, but for rounding
_LENGTH_MM: Final = 1e-6  # nanometres: rounding of lengths in mm
_SCARA = ("CC", "SC", "CS")


def check_five_axes(report: DatumReport, tool: Tool, choose: Choices) -> None:
    """Check flange, wrist frame and tool of a 5-axis robot."""
    robx = report.robx
    if not robx.given("TFLWP_RPY"):
        text = "TFLWP_RPY is missing; its default puts X of the flange where a 5-axis robot may not have it"
        permitted = "X of the flange meets axis 5 and is not parallel to it"
        report.add("CB312", text, ("TFLWP_RPY",), permitted=permitted, alarm=75310)
    else:
        _check_flange_x(report, choose)
    _check_wrist_frame(report)
    _check_tool(report, tool, choose)


def _check_flange_x(report: DatumReport, choose: Choices) -> None:
    """X of the flange must meet axis 5 and may not be parallel to it (ROBX manual 5.3.5)."""
    robx = report.robx
    T = flange_frame(robx, choose).T()
    across = np.cross(T[:3, 0], (0.0, 0.0, 1.0))
    permitted = "X of the flange meets axis 5 and is not parallel to it"
    if np.linalg.norm(across) < _ANGLE:
        report.add("CB313", "X of the flange is parallel to axis 5", ("TFLWP_RPY",), permitted=permitted, alarm=75310)
        return
    distance = abs(float(T[:3, 3] @ across)) / float(np.linalg.norm(across))
    if distance > _LENGTH_MM:
        text = f"X of the flange passes axis 5 at a distance of {distance:.6g} mm"
        report.add("CB313", text, ("TFLWP_POS", "TFLWP_RPY"), permitted=permitted, alarm=75310)
    x, y, _ = robx.tflwp.position_mm
    turned = any(robx.tflwp.rpy_deg[1:])
    if robx.arrangement in ("NR", "RR") and (x or y or turned):
        text = "an articulated arm of five axes has TFLWP_POS = (0, 0, Z) and TFLWP_RPY = (A, 0, 0)"
        report.add("CB314", text, ("TFLWP_RPY", "TFLWP_POS") if turned else ("TFLWP_POS", "TFLWP_RPY"))


def _check_wrist_frame(report: DatumReport) -> None:
    """Warn where the manual does not leave TX3P3 free (ROBX manual 5.3.4); it does not print what it then demands."""
    robx = report.robx
    central = robx.wrist == _CENTRAL
    free = {"SS": True, "NN": central}.get(robx.arrangement, central or robx.a4par)
    if not free:
        need = "a central wrist" if robx.arrangement == "NN" else "a central wrist or A4PAR = 1"
        text = f"TX3P3 of a 5-axis {robx.arrangement} is free with {need} only; what else is permitted is not printed"
        report.add("CB315", text, ("TX3P3_RPY", "WRIST_AXES"))


def _check_tool(report: DatumReport, tool: Tool, choose: Choices) -> None:
    """Warn where the tool of an articulated arm leaves the plane that a 5-axis robot can turn it in."""
    robx = report.robx
    if robx.arrangement not in ("NR", "RR"):
        return
    _, y, z = length_transform(robx, tool, 0.0, choose)[:3, 3]
    if y or (z and not robx.a4par):
        form = "(X, 0, Z)" if robx.a4par else "(X, 0, 0)"
        text = f"the tool of an articulated arm of five axes has the form {form} in flange axes"
        report.collector.add("CB316", text, span=tool.span, parameter="$TC_DP3 to $TC_DP5", permitted=form)


def check_four_axes(report: DatumReport, translation: Translation) -> None:
    """Check wrist frame and base of a 4-axis robot."""
    robx = report.robx
    last = np.array(basic_moves(translation.basic)[-1].direction)
    cosine = abs(float(robx.tx3p3.T()[:3, 2] @ last))
    if min(cosine, 1.0 - cosine) > _ANGLE:
        report.add(
            "CB317",
            "Z of the wrist frame X3 is neither parallel nor perpendicular to the last basic axis",
            ("TX3P3_RPY",),
            permitted="axis 4 parallel, antiparallel or perpendicular to the last basic axis",
            alarm=75310,
        )
    _check_base(report, translation)


def _check_base(report: DatumReport, translation: Translation) -> None:
    """The first rotary axis lies along an axis of WO; some arrangements also need Z of IRO along Z of WO."""
    robx = report.robx
    first = _first_rotary(translation)
    if not _along_an_axis(first):
        # What TIRORO alone leaves upright, TROWO has tilted.
        upright = _along_an_axis(robx.trowo.T()[:3, :3].T @ first)
        report.add(
            "CB318",
            "the first rotary axis of a 4-axis robot is not parallel to an axis of the world frame",
            ("TROWO_RPY", "TIRORO_RPY") if upright else ("TIRORO_RPY", "TROWO_RPY"),
            permitted="the first rotary axis parallel or antiparallel to X, Y or Z of WO",
            alarm=75310,
        )
    if robx.arrangement == "SS" or (robx.arrangement in _SCARA and robx.a4par):
        return
    z_iro = (robx.trowo.T() @ robx.tiroro.T())[:3, 2]
    if abs(float(z_iro[2])) < 1.0 - _ANGLE:
        upright = abs(float(robx.tiroro.T()[2, 2])) >= 1.0 - _ANGLE
        report.add(
            "CB318",
            f"Z of IRO is not parallel to Z of the world frame, as a 4-axis {robx.arrangement} needs it",
            ("TROWO_RPY", "TIRORO_RPY") if upright else ("TIRORO_RPY", "TROWO_RPY"),
            permitted="Z of IRO parallel to Z of WO",
            alarm=75310,
        )


def _along_an_axis(direction: Matrix) -> bool:
    return max(abs(float(c)) for c in direction) >= 1.0 - _ANGLE


def _first_rotary(translation: Translation) -> Matrix:
    """Return the direction of the robot's first rotary axis in WO at mathematical zero."""
    rotation = np.eye(3)
    for element in translation.tool:
        if isinstance(element, Fixed):
            rotation = rotation @ element.T[:3, :3]
        elif isinstance(element, Move) and element.kind == "revolute":
            return rotation @ element.direction
    return rotation[:, 2]
