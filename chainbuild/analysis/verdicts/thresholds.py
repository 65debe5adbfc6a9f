"""The ROBX transformation's singularity thresholds: SD41670, SD41671, ITERLIMIT (ROBX manual 10.2, 5.3, MD62968).

The manual gives the two setting data without unit and does not say which quantity they are compared with: convention
`singularity_measure`. Whole paths are judged by `chainbuild.analysis.verdicts`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

from numpy.typing import ArrayLike

from chainbuild.analysis.verdicts.controlmeasure import control_values, measure_in_force
from chainbuild.arrays import Vector
from chainbuild.kinematics.mechanism import Mechanism

if TYPE_CHECKING:
    from chainbuild.chain.elements import Chain


Level = Literal["singular", "watched", "clear"]

RECOMMENDED_THRESHOLD: Final = 2e-6  # SD41670, ROBX manual 10.2.2
RECOMMENDED_CLEARANCE: Final = 1e-3  # SD41671, ROBX manual 10.2.3


@dataclass(frozen=True, slots=True)
class Thresholds:
    """Thresholds of a control.

    Attributes:
        threshold: SD41670: at and below it a position is singular.
        clearance: SD41671: between the two a position is watched.
        iter_limit_deg: MD62968: an angle of axis 5 below this counts as singular for the iterative inverse.
        given: Which of the two setting data the file gives; the others are the manual's recommendations.
        measure: Choice of convention `singularity_measure`.
        block: Choice of convention `singular_block`.
        lacks: Why the control does not handle singular blocks of this kinematic; empty: it does.
    """

    threshold: float = RECOMMENDED_THRESHOLD
    clearance: float = RECOMMENDED_CLEARANCE
    iter_limit_deg: float = 3.0
    given: tuple[str, ...] = ()
    measure: str = "one_minus_cosine"
    block: str = "whole_block"
    lacks: str = ""


@dataclass(frozen=True, slots=True)
class Assessment:
    """Judgement of a position by the control.

    Attributes:
        value: What is compared with the thresholds.
        measure: Which quantity it is, of those of convention `singularity_measure`.
        level: "singular" (SD41670), "watched" (SD41671) or "clear".
        hand_deg: Distance of axis 5 from 0 or 180° by its mathematical angle [degrees]; None if there is no axis 5.
        hand_limit: Whether it is below ITERLIMIT.
    """

    value: float
    measure: str
    level: Level
    hand_deg: float | None
    hand_limit: bool


def thresholds_of(chain: Chain) -> Thresholds | None:
    """Return the thresholds of the control of a chain, with the manual's recommendations for missing values.

    None if the control has no known thresholds, or the chain is composed of several.
    """
    watch, solver = chain.singularity_watch, chain.controller_solver
    if watch is None or solver is None:
        return None
    given = {"SINGULARITY_THRESHOLD": watch.threshold, "MIN_DIST_TO_SINGULARITY": watch.clearance}
    return Thresholds(
        RECOMMENDED_THRESHOLD if watch.threshold is None else watch.threshold,
        RECOMMENDED_CLEARANCE if watch.clearance is None else watch.clearance,
        solver.limit_deg,
        tuple(name for name, value in given.items() if value is not None),
        watch.measure,
        watch.block,
        watch.lacks,
    )


def assess(robot: Mechanism, axes: ArrayLike, limits: Thresholds) -> Assessment:
    """Return the control's judgement of axis values (n_axes,), mm and degrees.

    Where singular blocks are not handled (`Thresholds.lacks`), SD41671 means nothing: no position is watched.
    """
    values = robot.axis_values(axes)
    measure = measure_in_force(robot, limits.measure)
    value = float(control_values(robot, measure, values[None, :])[0])
    level = _level(value, limits)
    if limits.lacks and level == "watched":
        level = "clear"
    angle = _hand_angle(robot, values)
    return Assessment(value, measure, level, angle, angle is not None and angle < limits.iter_limit_deg)


def _level(value: float, limits: Thresholds) -> Level:
    if value <= limits.threshold:
        return "singular"
    return "watched" if value < limits.clearance else "clear"


def _hand_angle(robot: Mechanism, axes: Vector) -> float | None:
    """Return how far axis 5 is from 0 or half a turn [deg], or None where there is no such axis."""
    solver = robot.chain.controller_solver
    if solver is None or solver.hand_angle is None:
        return None
    return abs((solver.hand_angle.value(axes) + 90.0) % 180.0 - 90.0)
