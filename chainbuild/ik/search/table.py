"""Results of many poses: columns, one row per pose."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.elements import Task
from chainbuild.ik.result import STATUSES, IkResult, Status


class FailureWords(NamedTuple):
    """Explanation of a failure in `IkResult`: `reason` and the names of the violated limits."""

    reason: str = ""
    violated: tuple[str, ...] = ()


Explain = Callable[[int, IkResult], FailureWords]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class IkTable:
    """Results of many poses; `table[i]` is the i-th as an `IkResult`.

    The reason of a failure is computed when `reason` or `violated` is read, or for all rows by `reasons()`.

    Attributes:
        axes: (N, n_axes) axis values, mm and degrees; the best found if a row failed.
        counts: (N, 3) index of the status in `STATUSES`, steps over all starts, starts after the first.
        misses: (N, 2) distance [m] and angle [rad] between the requested and the reached pose; the angle of the tool
            vector where the task is not a full pose.
        task: "pose", "direction" or "position": what was solved for.
        explain: Returns the explanation of a row that failed; None: not available.
    """

    axes: Matrix
    counts: NDArray[np.int64]
    misses: Matrix
    task: Task
    explain: Explain | None = None

    @property
    def success(self) -> NDArray[np.bool_]:
        """(N,) True if the pose is met within tolerance and all limits are kept."""
        met: NDArray[np.bool_] = self.counts[:, 0] == 0
        return met

    @property
    def status(self) -> list[Status]:
        """Status of each row: ok, limits, stalled or unreachable."""
        return [STATUSES[code] for code in self.counts[:, 0]]

    @property
    def position_error(self) -> Vector:
        """(N,) distances between the requested and the reached poses [m]."""
        return self.misses[:, 0]

    @property
    def rotation_error(self) -> Vector:
        """(N,) angles between them [rad]."""
        return self.misses[:, 1]

    def reasons(self) -> list[str]:
        """Return why each row failed, "" for successes; each failed row takes a search of its own."""
        return [self[row].reason if failed else "" for row, failed in enumerate(self.counts[:, 0] != 0)]

    def __repr__(self) -> str:
        counts = ", ".join(
            f"{count} {STATUSES[code]}" for code, count in enumerate(np.bincount(self.counts[:, 0]).tolist()) if count
        )
        return f"<IkTable of {len(self)} rows: {counts or 'none'}; .axes, .status, .reasons(), [row]>"

    def __len__(self) -> int:
        return len(self.counts)

    def __getitem__(self, row: int) -> IkResult:
        row = range(len(self))[row]
        code, iterations, restarts = (int(count) for count in self.counts[row])
        distance, angle = (float(miss) for miss in self.misses[row])
        values = (code == 0, self.axes[row], STATUSES[code], distance, angle, iterations, restarts, self.task)
        return IkResult(*values) if code == 0 or self.explain is None else FailedRow.of(row, self.explain, *values)

    def __iter__(self) -> Iterator[IkResult]:
        return (self[row] for row in range(len(self)))


class FailedRow(IkResult):
    """A row that failed; `reason` and `violated` are empty slots until one of them is read."""

    __slots__ = ("_explain", "_row")

    @classmethod
    def of(cls, row: int, explain: Explain, *values: Any) -> FailedRow:
        """Return a row of a table with these values of `IkResult`."""
        result = cls(*values)
        for name, value in (("_row", row), ("_explain", explain)):
            object.__setattr__(result, name, value)
        for name in FailureWords._fields:
            object.__delattr__(result, name)
        return result

    def __getattr__(self, name: str) -> Any:
        # Only called where a slot is empty.
        if name not in FailureWords._fields:
            raise AttributeError(f"{type(self).__name__} has no attribute '{name}'")
        words = self._explain(self._row, self)
        for field, value in words._asdict().items():
            object.__setattr__(self, field, value)
        return getattr(words, name)
