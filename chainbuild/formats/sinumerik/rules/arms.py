"""Rules on geometry: wrist, parallel axes, 4- and 5-axis restrictions (ROBX manual 5.3.3–5.3.14, 7).

Impossible geometry is refused with the alarm and the datum's name; sound geometry outside the manual's lists is built
with a warning.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from chainbuild import frames
from chainbuild.arrays import Matrix
from chainbuild.convention import Choices
from chainbuild.findings import Collector
from chainbuild.formats.sinumerik.geometry.robot_axes import basic_moves
from chainbuild.formats.sinumerik.geometry.tool import Tool
from chainbuild.formats.sinumerik.geometry.translate import Translation
from chainbuild.formats.sinumerik.reading.robx import WRISTS, Robx
from chainbuild.formats.sinumerik.reading.transformations import DatumReport
from chainbuild.formats.sinumerik.rules.few_axes import check_five_axes, check_four_axes

# Numbers of wrists, see `robx.WRISTS`.
_CENTRAL: Final = 2
_INCLINED: Final = 3
_ANGLED: Final = 5
# Numbers of kinds of axes in AXES_TYPE.
_ENDLESS: Final = 4
_ROTARY: Final = 3
_LINEAR: Final = 1

_RIGHT_ANGLE_DEG: Final = 1e-6  # degrees (of sines, too): far below what machine data are written to
_LENGTH_MM: Final = 1e-9  # shorter than the last digit of any machine datum: rounding
_DEGENERATE_DEG: Final = 10.0  # a wrist with axes closer to parallel hardly turns its hand
_PRINTED_ALPHA: Final = (-90.0, 90.0)  # the angles that the manual draws for wrist axes 4-5 and 5-6


def check_geometry(robx: Robx, translation: Translation, tool: Tool, choose: Choices, collector: Collector) -> None:
    """Check a translated transformation.

    Raises:
        MachineDataError: geometry that the controller refuses or that is impossible (strict collector).
    """
    report = DatumReport(robx, collector)
    _check_lengths(report)
    _check_wrist(report)
    _check_combination(report)
    _check_axis_types(report, translation)
    _check_fourth_axis(report, translation)
    if robx.num_axes == 5:
        check_five_axes(report, tool, choose)
    elif robx.num_axes == 4:
        check_four_axes(report, translation)


def _check_lengths(report: DatumReport) -> None:
    robx = report.robx
    if robx.arrangement in ("NR", "CC") and abs(robx.lengths_mm[1]) < _LENGTH_MM:
        report.add(
            "CB341",
            f"length B is 0: axes 2 and 3 of a {robx.arrangement} would coincide",
            ("MAIN_LENGTH_AB",),
            permitted="a length B other than 0",
            alarm=75310,
        )


def _check_wrist(report: DatumReport) -> None:
    """Check the Denavit-Hartenberg data that count against the wrist's type (ROBX manual 5.3.11–5.3.14)."""
    robx = report.robx
    used = robx.dh[: robx.num_axes - 4]
    a, d, alpha = [link.a_mm for link in used], [link.d_mm for link in used], [link.alpha_deg for link in used]
    if robx.wrist in (_CENTRAL, _INCLINED):
        for name, values in (("DHPAR4_5A", a), ("DHPAR4_5D", d)):
            if any(abs(value) > _LENGTH_MM for value in values):
                text = f"the axes of a {WRISTS[robx.wrist]} meet in one point, but {name} is not 0"
                report.add("CB306", text, (name,), permitted="0, or wrist type 5 or 6 with six axes")
    elif d and abs(d[0]) > _LENGTH_MM:
        report.add("CB358", "the manual requires DHPAR4_5D[0] = 0 for this wrist", ("DHPAR4_5D",), permitted="0")
    if robx.wrist in (_CENTRAL, _ANGLED):
        _check_right_angles(report, alpha)
    _check_slant(report, alpha)


def _check_right_angles(report: DatumReport, alpha: Sequence[float]) -> None:
    robx = report.robx
    if any(abs(abs(angle) - 90.0) > _RIGHT_ANGLE_DEG for angle in alpha):
        text = f"the axes of a {WRISTS[robx.wrist]} are perpendicular, but DHPAR4_5ALPHA is not ±90"
        report.add("CB306", text, ("DHPAR4_5ALPHA",), permitted="(-90, 90), or wrist type 3 or 6")
    elif len(alpha) == 2 and alpha[0] * alpha[1] > 0:
        wrist = f"DHPAR4_5ALPHA is ({alpha[0]:g}, {alpha[1]:g}), but the two angles of a {WRISTS[robx.wrist]}"
        hint = "check the signs"
        text = f"{wrist} are opposite to each other. The chain follows the data"
        report.add("CB345", text, ("DHPAR4_5ALPHA",), permitted="(-90, 90)", hint=hint)
    elif tuple(alpha) != _PRINTED_ALPHA[: len(alpha)]:
        shown = ", ".join(f"{angle:g}" for angle in alpha)
        text = f"DHPAR4_5ALPHA is ({shown}); the manual prints (-90, 90). The chain follows the data"
        report.add("CB307", text, ("DHPAR4_5ALPHA",), permitted="(-90, 90)")


def _check_slant(report: DatumReport, alpha: Sequence[float]) -> None:
    for n, angle in enumerate(alpha):
        sine = abs(frames.cos_sin_deg(angle)[1])
        if sine < _RIGHT_ANGLE_DEG and report.robx.wrist == _INCLINED:
            text = f"DHPAR4_5ALPHA[{n}] = {angle:g} makes axes {4 + n} and {5 + n} coincide"
            report.add("CB309", text, ("DHPAR4_5ALPHA",), permitted="other than 0 and ±180")
        elif sine < frames.cos_sin_deg(_DEGENERATE_DEG)[1]:
            text = f"DHPAR4_5ALPHA[{n}] = {angle:g} is within 10 degrees of parallel: the wrist is nearly degenerate"
            report.add("CB308", text, ("DHPAR4_5ALPHA",))


def _check_combination(report: DatumReport) -> None:
    """Warn where the manual does not list basic axes and wrist of six axes together (ROBX manual 7)."""
    robx = report.robx
    if robx.num_axes != 6 or robx.wrist not in WRISTS:
        return
    limits = _listed(robx)
    if limits is not None:
        name = f"{robx.arrangement} with {WRISTS[robx.wrist]} (type {robx.wrist})"
        report.add("CB310", f"{name}: {limits}; the geometry is sound and is built", ("WRIST_AXES", "MAIN_AXES"))


def _listed(robx: Robx) -> str | None:
    """Return what the manual says against a combination, or None where it lists it."""
    if robx.arrangement not in ("NR", "SC", "CC"):
        return "the manual describes no six-axis robot of this arrangement"
    if robx.wrist in (_CENTRAL, _INCLINED):
        return None
    if robx.wrist == _ANGLED:
        return "the manual does not list this wrist for it"
    a, d = any(link.a_mm for link in robx.dh), any(link.d_mm for link in robx.dh)
    if robx.arrangement == "NR":
        return "the manual requires DHPAR4_5A = 0" if a else None
    if robx.arrangement == "SC":
        return "the manual requires DHPAR4_5D = 0" if d else None
    first, second = robx.dh
    fits = not a and first.d_mm == 0.0 and (first.alpha_deg, second.alpha_deg) == _PRINTED_ALPHA
    return None if fits else "the manual requires DHPAR4_5A = 0, DHPAR4_5D[0] = 0 and DHPAR4_5ALPHA = (-90, 90)"


def _check_axis_types(report: DatumReport, translation: Translation) -> None:
    """Warn where AXES_TYPE fits the arrangement neither before nor after AXIS_SEQ; the arrangement is used."""
    robx = report.robx
    kinds = [move.kind for move in basic_moves(translation.basic)] + ["revolute"] * (robx.num_axes - 3)

    def fits(types: list[int]) -> bool:
        pairs = zip(kinds, types, strict=True)
        return all(kind == _LINEAR if joint == "prismatic" else kind in (_ROTARY, _ENDLESS) for joint, kind in pairs)

    internal = list(robx.axes_type[: robx.num_axes])
    by_input = [robx.axes_type[number - 1] for number in robx.axis_seq[: robx.num_axes]]
    if fits(internal) or fits(by_input):
        return
    expected = ", ".join("1" if kind == "prismatic" else "3" for kind in kinds)
    shown = ", ".join(str(kind) for kind in internal)
    state = f"is {shown}" if robx.given("AXES_TYPE") else f"is missing (its default is {shown})"
    text = f"AXES_TYPE {state}, but a {robx.arrangement} has {expected}; the arrangement is used"
    report.add("CB330", text, ("AXES_TYPE", "MAIN_AXES"), permitted=expected)


def last_rotary_direction(translation: Translation) -> Matrix | None:
    """Return the direction of the last rotary basic axis in P3, or None for a gantry."""
    rotary = [move for move in basic_moves(translation.basic) if move.kind == "revolute"]
    return np.array(rotary[-1].direction) if rotary else None


def _check_fourth_axis(report: DatumReport, translation: Translation) -> None:
    """Warn where A4PAR contradicts the geometry; for a gantry it says nothing."""
    robx = report.robx
    direction = last_rotary_direction(translation)
    if direction is None:
        return
    z3 = robx.tx3p3.T()[:3, 2]
    parallel = abs(float(z3 @ direction)) > 1.0 - 1e-9
    if parallel != robx.a4par:
        word = "parallel" if parallel else "not parallel"
        text = f"A4PAR is {int(robx.a4par)}, but by TX3P3_RPY axis 4 is {word} to the last rotary basic axis"
        report.add("CB311", text, ("A4PAR", "TX3P3_RPY"), permitted=str(int(parallel)))
