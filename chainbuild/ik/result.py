"""What an inverse-kinematics solver returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from chainbuild.chain.elements import Task

Status = Literal["ok", "unreachable", "limits", "stalled"]
STATUSES: Final[tuple[Status, ...]] = ("ok", "limits", "stalled", "unreachable")  # by the outcome of a search


@dataclass(frozen=True, slots=True, eq=False)
class IkResult:
    """Axis values for a pose, or the best found and why it is no solution.

    Attributes:
        success: True where the pose is met within tolerance and all limits are kept.
        axes: (n_axes,) axis values, mm and degrees; on failure the best found.
        status: "ok"; "unreachable": no axis values reach the pose even without limits; "limits": only values
            outside the limits do; "stalled": the budget ended close to the pose.
        position_error: Distance between the pose wanted and the one reached [m].
        rotation_error: Angle between them [rad]; that of the tool vector where the task is not a full pose.
        iterations: Steps taken over all starts.
        restarts: Starts after the first.
        task: "pose", "direction" or "position": what was solved for.
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
    reason: str = ""
    violated: tuple[str, ...] = ()
