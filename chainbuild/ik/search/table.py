"""Results of many poses: columns, one row per pose."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.elements import Task
from chainbuild.errors import ChainbuildError
from chainbuild.html import SHOWN_ROWS, html_table
from chainbuild.ik.result import STATUSES, AxisValues, IkResult, Status, axes_rows, html_caption
from chainbuild.shown import fields_shown
from chainbuild.units import M_PER_MM, RAD_PER_DEG, AxisLabels

if TYPE_CHECKING:
    import pandas

# As in tables written by `chainbuild ik`.
POSITION_MM: Final = "position_error_mm"
ROTATION_DEG: Final = "rotation_error_deg"


class FailureWords(NamedTuple):
    """Explanation of a failure in `IkResult`: `reason` and the names of the violated limits."""

    reason: str = ""
    violated: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class StatusChange:
    """A row of a path whose nearest way leads to another pose status, which the control does not change on its way.

    Attributes:
        row: Index of the row, from 0.
        old: Pose status before it.
        new: Pose status that the nearest way leads to.
        kept: True: the row stays in the old status, and the axes jump; False: it has the new one.
    """

    __repr__ = fields_shown

    row: int
    old: int
    new: int
    kept: bool

    @property
    def words(self) -> str:
        """What happens, as a sentence."""
        way = f"between this pose and the one before lies a singular position, beyond which the status is {self.new}"
        if self.kept:
            return f"{way}: status {self.old} is kept, and the axes jump"
        return f"{way} instead of {self.old}, which the controller does not change along a path"


Explain = Callable[[int, IkResult], FailureWords]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class IkTable(AxisValues):
    """Results of many poses; `table[i]` is the i-th as an `IkResult`.

    The reason of a failure is computed when `reason` or `violated` is read, or for all rows by `reasons()`.

    Attributes:
        axes: (N, n_axes) axis values, mm and degrees; the best found if a row failed.
        counts: (N, 3) index of the status in `STATUSES`, steps over all starts, starts after the first.
        misses: (N, 2) distance [m] and angle [rad] between the requested and the reached pose; the angle of the tool
            vector where the task is not a full pose.
        task: "pose", "direction" or "position": what was solved for.
        labels: Names and units of the axis values.
        explain: Gives words for a row that failed; None: none are known.
        status_changes: Of a path of KIN_TYP 45: where its pose status cannot be kept, or only by a jump of the axes.
    """

    axes: Matrix
    counts: NDArray[np.int64]
    misses: Matrix
    task: Task
    labels: AxisLabels
    explain: Explain | None = None
    status_changes: tuple[StatusChange, ...] = ()

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
        return f"<IkTable of {len(self)} rows: {self._tally() or 'none'}; .axes, .status, .reasons(), [row]>"

    def _tally(self) -> str:
        counts = enumerate(np.bincount(self.counts[:, 0]).tolist())
        return ", ".join(f"{count} {STATUSES[code]}" for code, count in counts if count)

    def _repr_html_(self) -> str:
        first = [self[row] for row in range(min(len(self), SHOWN_ROWS))]
        caption = html_caption(f"{len(self)} rows", self._tally())
        return html_table(*axes_rows(self.labels, first), caption, len(self) - len(first))

    def to_pandas(self) -> pandas.DataFrame:
        """Return the table as a pandas DataFrame, one row a pose.

        The columns are the axes by name, in the units of the table, `status`, the errors as `position_error_mm` and
        `rotation_error_deg` (with units "si" `position_error_m` and `rotation_error_rad`), and `reason`, empty where
        the pose is met; finding it costs a search for each row that failed.

        Raises:
            ChainbuildError: pandas is not installed.
        """
        try:
            import pandas
        except ImportError:
            text = "pandas is not installed: it is no dependency of chainbuild"
            raise ChainbuildError(text, hint="pip install pandas") from None
        si = self.units == "si"
        distance = ("position_error_m", self.position_error) if si else (POSITION_MM, self.position_error / M_PER_MM)
        angle = ("rotation_error_rad", self.rotation_error) if si else (ROTATION_DEG, self.rotation_error / RAD_PER_DEG)
        axes = {name: self.axes[:, n] for n, name in enumerate(self.labels.names)}
        said = {"status": self.status, **dict([distance, angle]), "reason": self.reasons()}
        return pandas.DataFrame({**axes, **said})

    def __len__(self) -> int:
        return len(self.counts)

    def __getitem__(self, row: int) -> IkResult:
        row = range(len(self))[row]
        code, iterations, restarts = (int(count) for count in self.counts[row])
        distance, angle = (float(miss) for miss in self.misses[row])
        values = (
            code == 0,
            self.axes[row],
            STATUSES[code],
            distance,
            angle,
            iterations,
            restarts,
            self.task,
            self.labels,
        )
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


def _words_at(words: Sequence[FailureWords], row: int, _result: IkResult) -> FailureWords:
    return words[row]


def table_of(results: Sequence[IkResult], task: Task, labels: AxisLabels) -> IkTable:
    """Return single results as a table."""
    axes = np.array([one.axes for one in results]).reshape(-1, len(labels.names))
    counts = np.array([(STATUSES.index(one.status), one.iterations, one.restarts) for one in results], dtype=np.int64)
    misses = np.array([(one.position_error, one.rotation_error) for one in results]).reshape(-1, 2)

    words = [FailureWords(one.reason, one.violated) for one in results]
    return IkTable(axes, counts.reshape(-1, 3), misses, task, labels, partial(_words_at, words))
