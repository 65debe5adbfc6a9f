"""What the solvers of many poses return: columns of results, one row a pose."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.chain.elements import Task
from chainbuild.solve.result import IkResult, Status

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

STATUSES: Final[tuple[Status, ...]] = ("ok", "limits", "stalled", "unreachable")


@dataclass(frozen=True, slots=True, eq=False)
class IkTable:
    """Results of many poses; `table[i]` is the i-th as an `IkResult`, without words for a failure.

    Attributes:
        axes: (N, n_axes) axis values, mm and degrees; where a row failed the best found.
        counts: (N, 3) index of the status in `STATUSES`, steps over all starts, starts after the first.
        misses: (N, 2) distance [m] and angle [rad] between the pose wanted and the one reached; the angle of the tool
            vector where the task is not a full pose.
        task: "pose", "direction" or "position": what was solved for.
    """

    axes: Matrix
    counts: NDArray[np.int64]
    misses: Matrix
    task: Task

    @property
    def success(self) -> NDArray[np.bool_]:
        """(N,) True where the pose is met within tolerance and all limits are kept."""
        met: NDArray[np.bool_] = self.counts[:, 0] == 0
        return met

    @property
    def status(self) -> list[Status]:
        """Status of each row: ok, limits, stalled or unreachable."""
        return [STATUSES[code] for code in self.counts[:, 0]]

    @property
    def position_error(self) -> Vector:
        """(N,) distances between the poses wanted and those reached [m]."""
        return self.misses[:, 0]

    @property
    def rotation_error(self) -> Vector:
        """(N,) angles between them [rad]."""
        return self.misses[:, 1]

    def __len__(self) -> int:
        return len(self.counts)

    def __getitem__(self, row: int) -> IkResult:
        code, iterations, restarts = (int(count) for count in self.counts[row])
        distance, angle = (float(miss) for miss in self.misses[row])
        return IkResult(code == 0, self.axes[row], STATUSES[code], distance, angle, iterations, restarts, self.task)

    def __iter__(self) -> Iterator[IkResult]:
        return (self[row] for row in range(len(self)))
