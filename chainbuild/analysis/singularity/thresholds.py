"""The ROBX transformation's singularity thresholds: SD41670, SD41671, ITERLIMIT (ROBX manual 10.2, 5.3, MD62968).

The manual gives the two setting data without unit and does not say which quantity they are compared with. Here it is
the smallest scaled singular value or, optionally, the product of all of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild.analysis.singularity.measures import measure_batch
from chainbuild.arrays import Vector
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.units import mm_from_m

if TYPE_CHECKING:
    from chainbuild.chain.elements import Chain


Level = Literal["singular", "watched", "clear"]
Quantity = Literal["smallest", "product"]

RECOMMENDED_THRESHOLD: Final = 2e-6  # SD41670, ROBX manual 10.2.2
RECOMMENDED_CLEARANCE: Final = 1e-3  # SD41671, ROBX manual 10.2.3
LONGEST_SINGULAR_MM: Final = 30.0  # ROBX manual 10.3: alarm 75327
BLOCK_TOO_LONG_ALARM: Final = 75327


@dataclass(frozen=True, slots=True)
class Thresholds:
    """Thresholds of a control.

    Attributes:
        threshold: SD41670: at and below it a position is singular.
        clearance: SD41671: between the two a position is watched.
        iter_limit_deg: MD62968: an angle of axis 5 below this counts as singular for the iterative inverse.
        given: Which of the two setting data the file gives; the others are the manual's recommendations.
    """

    threshold: float = RECOMMENDED_THRESHOLD
    clearance: float = RECOMMENDED_CLEARANCE
    iter_limit_deg: float = 3.0
    given: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Assessment:
    """Judgement of a position by the control.

    Attributes:
        value: The quantity compared with the thresholds.
        level: "singular" (SD41670), "watched" (SD41671) or "clear".
        hand_deg: Distance of axis 5 from 0 or 180° by its mathematical angle [degrees]; None if there is no axis 5.
        hand_limit: Whether it is below ITERLIMIT.
    """

    value: float
    level: Level
    hand_deg: float | None
    hand_limit: bool


@dataclass(frozen=True, slots=True)
class PathSection:
    """A run of rows of a path that a control calls singular or watches.

    Attributes:
        first: First row, from 0.
        last: Last row.
        level: The worst level in it.
        length_mm: Path length of the tool from the first to the last row [mm].
        alarm: 75327 if it is singular throughout and too long, else None.
    """

    first: int
    last: int
    level: Level
    length_mm: float
    alarm: int | None


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
    )


def assess(robot: Mechanism, axes: ArrayLike, limits: Thresholds, quantity: Quantity = "smallest") -> Assessment:
    """Return the control's judgement of axis values (n_axes,), mm and degrees."""
    values = robot.axis_values(axes)
    value = float(_values(robot, values[None, :], quantity)[0])
    angle = _hand_angle(robot, values)
    return Assessment(value, _level(value, limits), angle, angle is not None and angle < limits.iter_limit_deg)


def assess_path(
    robot: Mechanism, path: ArrayLike, limits: Thresholds, quantity: Quantity = "smallest"
) -> Iterator[PathSection]:
    """Yield the stretches of a path (N, n_axes) that a control calls singular or watches.

    Only the rows are checked: give them as densely as the control interpolates.
    """
    rows = np.atleast_2d(np.asarray(path, dtype=float))
    table = measure_batch(robot, rows)
    levels = [_level(value, limits) for value in _pick(table.smallest, table.manipulability, quantity).tolist()]
    first = 0
    while first < len(levels):
        if levels[first] == "clear":
            first += 1
            continue
        last = first
        while last + 1 < len(levels) and levels[last + 1] != "clear":
            last += 1
        run = levels[first : last + 1]
        way = np.linalg.norm(np.diff(table.positions[first : last + 1], axis=0), axis=1).sum()
        length = mm_from_m(float(way))
        singular = all(level == "singular" for level in run)
        alarm = BLOCK_TOO_LONG_ALARM if singular and length >= LONGEST_SINGULAR_MM else None
        yield PathSection(first, last, "singular" if "singular" in run else "watched", length, alarm)
        first = last + 1


def _values(robot: Mechanism, rows: NDArray[np.float64], quantity: Quantity) -> Vector:
    table = measure_batch(robot, rows)
    return _pick(table.smallest, table.manipulability, quantity)


def _pick(smallest: Vector, product: Vector, quantity: Quantity) -> Vector:
    if quantity not in ("smallest", "product"):
        raise ChainbuildError(f"unknown quantity '{quantity}'", parameter="quantity", permitted="smallest, product")
    return smallest if quantity == "smallest" else product


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
