"""What a chain needs to know beyond its links: limit of the parallelogram, absolute angle C, the control's own checks.

Sources: ROBX manual 5.3.19–5.3.21, 7.1.7 and 10.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from chainbuild.chain.assemble import Fixed, Mark, Move
from chainbuild.chain.elements import Axis, AxisConstraint, AxisSum, ControllerSolver, SingularityWatch
from chainbuild.convention import Choices
from chainbuild.findings import Collector
from chainbuild.formats.sinumerik.geometry.internal_axes import InternalAxis
from chainbuild.formats.sinumerik.geometry.translate import Translation
from chainbuild.formats.sinumerik.reading.data_table import DataTable
from chainbuild.formats.sinumerik.reading.report import Report
from chainbuild.formats.sinumerik.reading.robx import Robx
from chainbuild.frames import Matrix

ALARM_PARALLELOGRAM = 75329
ALARM_EXCESSIVE_SPEED = 75324
_SCARA = ("CC", "SC", "CS")
_PARALLEL = 1e-6
_WITH_HAND = 5


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


def check_pose_data(robx: Robx, translation: Translation, axes: Sequence[Axis], collector: Collector) -> None:
    """Note where the printed parallelogram angle is not the elbow's, and a feature bit that has no effect."""
    report = Report(robx, collector)
    if robx.special_kin == 2:
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


def absolute_c(robx: Robx, translation: Translation, axes: Sequence[Axis], choose: Choices) -> AxisSum | None:
    """Return the absolute angle C as a sum of the rotary axes, or None where C is an angle of the pose.

    Conventions: `c_sum`, `c_offset`.
    """
    if not shows_absolute_c(robx):
        return None
    signs = _turning_signs(translation) if choose["c_sum"] == "signed" else {}
    factors: dict[str, float] = {}
    offset = 0.0
    for axis in _rotary(translation):
        sign = signs.get(axis.name, 1.0)
        offset += sign * axis.offset
        for name, factor in axis.drive.items():
            factors[name] = factors.get(name, 0.0) + sign * factor
    given = robx.c_angle_offset_deg
    return _sum(axes, factors, offset + (given if choose["c_offset"] == "add" else -given))


def controller_solver(robx: Robx, translation: Translation, axes: Sequence[Axis]) -> ControllerSolver:
    """Return the budget of the control's iterative inverse, with the angle of axis 5 that its alarms watch."""
    if robx.num_axes < _WITH_HAND:
        return robx.control.solver
    hand = translation.internal.math[_WITH_HAND - 1]
    return replace(robx.control.solver, hand_angle=_sum(axes, hand.drive, hand.offset))


def singularity_watch(table: DataTable) -> SingularityWatch:
    """Return the setting data on singularities, as far as the file gives them."""
    threshold, clearance = (table.shared(name, None) for name in ("SINGULARITY_THRESHOLD", "MIN_DIST_TO_SINGULARITY"))
    return SingularityWatch(
        threshold=None if threshold is None else float(threshold.value),
        clearance=None if clearance is None else float(clearance.value),
        speed_alarm=ALARM_EXCESSIVE_SPEED,
    )


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
