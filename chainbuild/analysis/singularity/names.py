"""Singularities by name, each with a sentence."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.analysis.singularity import locks, words
from chainbuild.analysis.singularity.factors import Factor, factors
from chainbuild.analysis.singularity.loops import losses_at, named_loss
from chainbuild.analysis.singularity.measures import Measures, measure, measure_batch, smallest_value
from chainbuild.analysis.singularity.singularity import Singularity
from chainbuild.analysis.singularity.speeds import SpeedReport, speeds
from chainbuild.analysis.singularity.structure import CartesianForm, SingularityKind, lines_at, singular_structure
from chainbuild.arrays import Vector
from chainbuild.chain.closing import Loss
from chainbuild.closest import and_joined
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.shown import number, two_lines

# A name is given only where the smallest scaled singular value is below this …
NEAR: Final = 0.05
# … and the function that the name stands for is below this: 0.1 is a wrist axis within 5.7 degrees of the singularity.
NEAR_FACTOR: Final = 0.1
# A second name is given only where its function is small by itself.
_SECOND: Final = 0.01
# A singularity without a name is reported only this close to it.
_NEAR_UNNAMED: Final = 0.005
# Share of shifts in the lost motion below which the sentence speaks of the speed of turns.
_NO_SHIFT: Final = 1e-3
_EXACT_DEG: Final = 1e-5  # what a search for a minimum leaves of 0
_ALIASES: Final = {"wrist": "alpha5", "elbow": "alpha2", "shoulder": "alpha1"}


@dataclass(frozen=True, slots=True, eq=False)
class SingularityReport:
    """Report on one position.

    Attributes:
        axes: (n_axes,) axis values, mm and degrees.
        measures: The numbers.
        names: Singularities at or close to it, the closest first.
        notices: Gimbal lock and dead points: no motion is lost, but programs or drives are affected.
        speed: Axis speeds at the given tool speed.
    """

    axes: Vector
    measures: Measures
    names: tuple[Singularity, ...]
    notices: tuple[Singularity, ...]
    speed: SpeedReport

    def __repr__(self) -> str:
        found = ", ".join((*kinds(self.names), *kinds(self.notices))) or "no singularity near"
        axes = ", ".join(f"{s.axis.name} {number(float(v))}" for s, v in zip(self.speed.axes, self.axes, strict=True))
        smallest = f"smallest singular value {self.measures.smallest:.3g}"
        return two_lines(f"<SingularityReport at {axes}: {found}; {smallest}>")


def examine(
    robot: Mechanism, axes: ArrayLike, *, tool_speed_mm: float = 10.0, length: float | None = None
) -> SingularityReport:
    """Return measures, names and speeds at axis values (n_axes,), mm and degrees.

    Args:
        robot: The robot.
        axes: Axis values; limits are ignored.
        tool_speed_mm: Speed of the tool in the sentences [mm/s; deg/s if only rotations are lost].
        length: Characteristic length [m] of the measures; None: the default. Names always use the default.

    Raises:
        AxisValueError: wrong number of values, or a non-finite value.
    """
    values = robot.axis_values(axes)
    measures = measure(robot, values, length)
    gate = measures if length is None else measure(robot, values)
    speed = speeds(robot, values, tool_speed_mm)
    losses = tuple(loss for loss in losses_at(robot, values) if abs(loss.value) <= NEAR_FACTOR)
    names = tuple(_names(robot, values, gate, speed, losses)) if losses or gate.smallest <= NEAR else ()
    return SingularityReport(values, measures, names, tuple(locks.notices(robot, values)), speed)


def names_at(robot: Mechanism, axes: ArrayLike) -> tuple[Singularity, ...]:
    """Return the singularities at or close to axis values (n_axes,), the closest first."""
    values = robot.axis_values(axes)
    return examine(robot, values).names if robot.chain.loops or smallest_value(robot, values) <= NEAR else ()


def sentence_at(robot: Mechanism, axes: ArrayLike, kind: SingularityKind, tool_speed: float) -> str:
    """Return the sentence on one kind of singularity at axis values (n_axes,), however far it is.

    Args:
        robot: The robot.
        axes: Axis values.
        kind: Of the singularity; "other": the closest one.
        tool_speed: Speed of the tool in the sentence [mm/s; deg/s if only rotations are lost].
    """
    values = robot.axis_values(axes)
    report = examine(robot, values, tool_speed_mm=tool_speed)
    wanted = ("pole", "tilt_end") if kind == "pole" else (kind,)
    for found in report.names:
        if found.kind in wanted or kind == "other":
            return found.sentence
    direction = np.eye(3)[robot.chain.tool_column]
    for factor in factors(singular_structure(robot), lines_at(robot, values), robot.task, direction):
        if factor.kind in wanted:
            return words.condition(robot, values, factor)[0]
    if losses := losses_at(robot, values):
        return losses[0].condition(nearly=True)
    return "the axes work against one another"


def vector_words(robot: Mechanism, sine: float) -> str:
    """Return what a tool vector meets on its way where the rotary axes are not programmed.

    Args:
        robot: A machine with linear axes and a pole.
        sine: Of the angle between the tool and the pole's axis, or of the turn that brings it into the plane of both.
    """
    form = singular_structure(robot).form
    names = [robot.chain.joints[n].name for n in form.rotary] if isinstance(form, CartesianForm) else []
    angle = math.degrees(math.asin(min(sine, 1.0)))
    how = "through" if angle < _EXACT_DEG else f"within {angle:.3g}° of"
    return f"a tool vector as the target would pass {how} the singular position of {and_joined(names)}"


def examine_path(
    robot: Mechanism, path: ArrayLike, *, tool_speed_mm: float = 10.0
) -> Iterator[tuple[int, SingularityReport]]:
    """Yield (row, report) of the rows (N, n_axes) of a path that are singular, nearly so, or deserve a notice.

    The measures of all rows are computed at once; only rows below `NEAR` are examined by name, and those at which a
    function of closed loops is close to 0.
    """
    values = np.atleast_2d(np.asarray(path, dtype=float))
    smallest = measure_batch(robot, values).smallest
    close = smallest <= NEAR
    if robot.chain.loops:
        close |= [any(abs(loss.value) <= NEAR_FACTOR for loss in losses_at(robot, row)) for row in values]
    for row in np.flatnonzero(close).tolist():
        report = examine(robot, values[row], tool_speed_mm=tool_speed_mm)
        if report.names or report.notices:
            yield row, report


def kinds(singularities: Iterable[Singularity]) -> tuple[SingularityKind, ...]:
    """Return the kinds of singularities, in their order."""
    return tuple(found.kind for found in singularities)


def _names(
    robot: Mechanism, axes: Vector, measures: Measures, speed: SpeedReport, losses: tuple[Loss, ...]
) -> Iterator[Singularity]:
    direction = np.eye(3)[robot.chain.tool_column]
    near: list[Factor | Loss] = [
        factor
        for factor in factors(singular_structure(robot), lines_at(robot, axes), robot.task, direction)
        if factor.value <= NEAR_FACTOR and measures.smallest <= NEAR
    ]
    near = sorted([*near, *losses], key=lambda one: abs(one.value))
    lost = words.lost_motion(robot, measures, turn_first=bool(near) and near[0].kind == "wrist")
    # Where shifts cost nothing the turns do: the pole of a head.
    turns = float(np.linalg.norm(measures.lost[:3])) < _NO_SHIFT
    turning = speeds(robot, axes, speed.tool_speed, motion="turn") if turns else speed
    cost = words.cost(turning, measures)
    if not near:
        if measures.smallest <= _NEAR_UNNAMED:
            running = words.runaway_axes(robot, measures)
            condition = f"{and_joined(running)} {'works' if len(running) == 1 else 'work'} against one another"
            if len(running) == 1:
                condition = f"{running[0]} hardly moves the tool"
            sentence = f"{condition}: {lost}; {cost}"
            yield Singularity("other", "", measures.smallest, running, condition, sentence, words.rtcp_remark(robot))
        return
    for rank, one in enumerate(near):
        if rank and abs(one.value) > _SECOND:
            break
        if isinstance(one, Loss):
            yield named_loss(robot, axes, one, lost, cost)
        else:
            yield _named(robot, axes, one, lost, cost)


def _named(robot: Mechanism, axes: Vector, factor: Factor, lost: str, cost: str) -> Singularity:
    condition, names = words.condition(robot, axes, factor)
    is_arm = robot.chain.kinematic.endswith(" NR")
    alias = _ALIASES.get(factor.kind, "") if is_arm and robot.chain.singularity_watch is not None else ""
    remark = words.elbow_remark(robot, axes, factor) if factor.kind == "elbow" else words.rtcp_remark(robot)
    value = 0.0 if math.isclose(factor.value, 0.0, abs_tol=1e-15) else factor.value
    return Singularity(factor.kind, alias, value, names, condition, f"{condition}: {lost}; {cost}", remark)
