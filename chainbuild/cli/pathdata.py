"""A report on a path as JSON: rows from 1, null for what is not a number or infinite."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from chainbuild.analysis.path.along import PathOptions
    from chainbuild.analysis.path.places import PathMinimum, PathPlace, PathReport, PathSpeed, PathStretch
    from chainbuild.analysis.singularity.speeds import AxisSpeed
    from chainbuild.robot import Robot


def finite(value: float | None) -> float | None:
    """Return a number for JSON, which has no infinite ones."""
    return float(value) if value is not None and math.isfinite(value) else None


class PathData:
    """Turns a report into data.

    Args:
        robot: The robot.
        report: The report.
        options: What it was made with.
    """

    def __init__(self, robot: Robot, report: PathReport, options: PathOptions) -> None:
        self._names = [axis.name for axis in robot.axes]
        self._report, self._options = report, options

    def data(self) -> dict[str, Any]:
        """Return everything that the report holds."""
        report = self._report
        return {
            "between": report.between,
            "near": report.near,
            "near_smallest": self._options.smallest,
            "feed_mm_min": self._options.feed_mm_min,
            "rows": report.rows,
            "length_mm": finite(report.length_mm),
            "seconds": finite(report.seconds),
            "proven": report.proven,
            "stretches": [self._stretch(one) for one in report.stretches],
            "violations": [
                {
                    "name": one.name,
                    "from": self._place(one.begin),
                    "to": self._place(one.end),
                    "worst": self._place(one.worst),
                    "excess": finite(one.excess),
                    "words": one.words,
                    "proven": one.proven,
                }
                for one in report.violations
            ],
            "speeds": [self._speed(one) for one in report.speeds],
            "leaves": [self._place(one) for one in report.leaves],
            "gaps": [row + 1 for row in report.gaps],
            "remarks": list(report.remarks),
            "smallest": [finite(value) for value in report.smallest.tolist()],
        }

    def _stretch(self, stretch: PathStretch) -> dict[str, Any]:
        return {
            "kind": stretch.kind,
            "from": self._place(stretch.begin),
            "to": self._place(stretch.end),
            "length_mm": finite(stretch.length_mm),
            "seconds": finite(stretch.seconds),
            "proven": stretch.proven,
            "throughout": stretch.throughout,
            "of_vector": stretch.of_vector,
            "minima": [self._minimum(one) for one in stretch.minima],
        }

    def _minimum(self, minimum: PathMinimum) -> dict[str, Any]:
        return {
            **self._place(minimum.place),
            "value": finite(minimum.value),
            "smallest": finite(minimum.smallest),
            "singular": minimum.singular,
            "sentence": minimum.sentence,
            "tool_speed": minimum.tool_speed,
            "speeds": _speeds(minimum.speeds),
            "worst": _speeds(minimum.worst),
        }

    def _speed(self, one: PathSpeed) -> dict[str, Any]:
        return {
            "name": one.speed.name,
            "needed": finite(one.speed.needed),
            "limit": finite(one.speed.limit),
            "excessive": one.speed.excessive,
            "at": self._place(one.place),
            "from": None if one.begin is None else self._place(one.begin),
            "to": None if one.end is None else self._place(one.end),
        }

    def _place(self, place: PathPlace) -> dict[str, Any]:
        return {
            "row": place.row + 1,
            "share": place.share,
            "axes": dict(zip(self._names, map(finite, place.axes.tolist()), strict=True)),
            "path_mm": finite(place.path_mm),
            "seconds": finite(place.seconds),
        }


def _speeds(found: Iterable[AxisSpeed]) -> dict[str, float | None]:
    return {one.name: finite(one.needed) for one in found}
