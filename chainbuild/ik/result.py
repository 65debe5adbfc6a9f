"""What an inverse-kinematics solver returns."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, Literal, Self

import numpy as np
from numpy.typing import NDArray

from chainbuild.chain.elements import Task
from chainbuild.units import AxisLabels, Units

Status = Literal["ok", "unreachable", "limits", "stalled"]
STATUSES: Final[tuple[Status, ...]] = ("ok", "limits", "stalled", "unreachable")  # by the outcome of a search


class AxisValues:
    """Axis values that know whose they are: what results of one pose and of many have in common."""

    __slots__ = ()

    axes: NDArray[np.float64]
    labels: AxisLabels

    @property
    def units(self) -> Units:
        """Those of `axes`: "controller", mm and degrees, or "si", metres and radians."""
        return self.labels.units

    def to(self, units: Units) -> Self:
        """Return the same with its axis values in other units.

        Raises:
            ChainbuildError: there are no such units.
        """
        labels = self.labels.to(units)
        if labels is self.labels:
            return self
        factors = np.divide(labels.factors, self.labels.factors)
        return replace(self, axes=self.axes * factors, labels=labels)  # type: ignore[type-var]


@dataclass(frozen=True, slots=True, eq=False)
class IkResult(AxisValues):
    """Axis values for a pose, or the best found and why it is no solution.

    Attributes:
        success: True where the pose is met within tolerance and all limits are kept.
        axes: (n_axes,) axis values, in `units`; on failure the best found.
        status: "ok"; "unreachable": no axis values reach the pose even without limits; "limits": only values
            outside the limits do; "stalled": the budget ended close to the pose.
        position_error: Distance between the pose wanted and the one reached [m].
        rotation_error: Angle between them [rad]; that of the tool vector where the task is not a full pose.
        iterations: Steps taken over all starts.
        restarts: Starts after the first.
        task: "pose", "direction" or "position": what was solved for.
        labels: Names and units of the axis values.
        reason: Words for people; empty on success.
        violated: With status "limits", where it is known: the names of the limits in the way.
    """

    success: bool
    axes: NDArray[np.float64]
    status: Status
    position_error: float
    rotation_error: float
    iterations: int
    restarts: int
    task: Task
    labels: AxisLabels
    reason: str = ""
    violated: tuple[str, ...] = ()
