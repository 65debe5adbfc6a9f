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
    """Axis values for a pose, or the best found and the reason of failure.

    Attributes:
        success: True if the pose is met within tolerance and all limits are kept.
        axes: (n_axes,) axis values, mm and degrees; on failure the best found.
        status: "ok"; "unreachable": no axis values reach the pose even without limits; "limits": only values
            outside the limits do; "stalled": the budget ended close to the pose.
        position_error: Distance between the requested and the reached pose [m].
        rotation_error: Angle between them [rad]; that of the tool vector if the task is not a full pose.
        iterations: Steps taken over all starts.
        restarts: Starts after the first.
        task: "pose", "direction" or "position": what was solved for.
        reason: Explanation as text; empty on success.
        violated: Names of the violated limits with status "limits", if known.
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
