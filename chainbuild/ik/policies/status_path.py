"""The pose status along a path: under an active transformation it stays as it is (KIN_TYP manual 3.3.3).

The path is solved as for any robot. Where a row then has another status than those before it, the arm is on the
other side of a singular position, where the control does not go. From there each row is the nearest solution
that has kept the status, until the path as it was solved has it again. Rows that can only be reached with another
status go on with that one. Either is told: `IkTable.status_changes`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.arrays import Integers, Matrix, Vector
from chainbuild.ik import rules
from chainbuild.ik.branches.every import ik_all
from chainbuild.ik.branches.status_turn import has_status, require_status, status_and_decided
from chainbuild.ik.request import Held, IkOptions
from chainbuild.ik.search.batch import pose_array, start_array
from chainbuild.ik.search.path import solve_path
from chainbuild.ik.search.table import IkTable, StatusChange
from chainbuild.kinematics.inputs import axis_rows
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.progress import Progress

if TYPE_CHECKING:
    from chainbuild.kinematics.inputs import Pose

_SAME_DEG: Final = 1e-5  # axis values closer than this are the same solution: both are verified to less


def follow_path(
    mechanism: Mechanism,
    poses: Sequence[Pose] | ArrayLike,
    start: ArrayLike | None = None,
    held: Held | None = None,
    progress: Progress = False,
    options: IkOptions | None = None,
) -> IkTable:
    """Find axis values along a path; see `Robot.ik_path`."""
    targets = pose_array(poses)
    table = solve_path(mechanism, targets, start, held, progress, options)
    if not has_status(mechanism):
        return table
    begin = start_array(mechanism, start)
    walk = _Walk(mechanism, targets, held, table, table.axes.copy(), table.counts.copy(), table.misses.copy())
    walk.run(None if begin is None else begin[0])
    changes = tuple(walk.changes)
    return replace(table, axes=walk.axes, counts=walk.counts, misses=walk.misses, status_changes=changes)


def status_changes(robot: Mechanism, axes: ArrayLike) -> list[StatusChange]:
    """Return where the pose status changes between rows of axis values (KIN_TYP 45).

    A bit counts as changed once the arm is clear of the singular position: a path may touch it, or begin there.

    Args:
        robot: A robot of KIN_TYP 45.
        axes: (N, 6) axis values in degrees, in the order of the path.

    Raises:
        ChainbuildError: the controller defines no status for this kinematic.
        AxisValueError: wrong shape, or a value that is not finite.
    """
    require_status(robot)
    watch = StatusWatch(robot)
    changes = (watch.change(values) for values in axis_rows(robot.axes, axes))
    return [change for change in changes if change is not None]


class StatusWatch:
    """The pose status from row to row of a path that is solved one pose after the other.

    Args:
        mechanism: A robot of KIN_TYP 45.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        self._mechanism, self._kept, self._row = mechanism, _Kept(), -1

    def change(self, axes: Vector) -> StatusChange | None:
        """Return the change that the next row, axis values (6,) in degrees, makes, or None."""
        self._row += 1
        bits, decided = next(_statuses(self._mechanism, axes[None]))
        before, self._kept = self._kept, self._kept.following(bits, decided)
        if not before.departs(bits, decided):
            return None
        return StatusChange(self._row, before.bits, before.after(bits, decided), kept=False)


def _statuses(mechanism: Mechanism, values: Matrix) -> Iterator[tuple[int, int]]:
    bits, decided = status_and_decided(mechanism, values)
    yield from zip(bits.tolist(), decided.tolist(), strict=True)


@dataclass(frozen=True, slots=True)
class _Kept:
    """The status of the rows so far.

    Attributes:
        bits: The status.
        decided: Which of its bits a row has decided.
    """

    bits: int = 0
    decided: int = 0

    def departs(self, bits: int, decided: int) -> bool:
        """Return whether a row has another status."""
        return bool((bits ^ self.bits) & decided & self.decided)

    def after(self, bits: int, decided: int) -> int:
        """Return the status after a row: its own where it decides, else as before."""
        return (self.bits & ~decided) | (bits & decided)

    def following(self, bits: int, decided: int) -> _Kept:
        """Return the status of the rows up to this one."""
        return _Kept(self.after(bits, decided), self.decided | decided)


@dataclass(slots=True, eq=False)
class _Walk:
    """A path as it was solved, and as it keeps its status.

    Attributes:
        mechanism: The robot.
        targets: (N, 4, 4) its poses.
        held: Axis name → value to hold, or None.
        solved: The path as it was solved.
        axes: (N, 6) axis values, written here where a row has to differ.
        counts: (N, 3) as in `IkTable`, written likewise.
        misses: (N, 2) as in `IkTable`, written likewise.
        changes: What is told.
    """

    mechanism: Mechanism
    targets: Matrix
    held: Held | None
    solved: IkTable
    axes: Matrix
    counts: Integers
    misses: Matrix
    changes: list[StatusChange] = field(default_factory=list)

    def run(self, begin: Vector | None) -> None:
        """Go along the path, from axis values (6,) before it where there are some."""
        kept, last, as_solved = _Kept(), begin, True
        if begin is not None:
            kept = kept.following(*next(_statuses(self.mechanism, begin[None])))
        met = self.solved.success.tolist()
        for row, (bits, decided) in enumerate(_statuses(self.mechanism, self.solved.axes)):
            if not met[row]:
                continue
            if last is None or (as_solved and not kept.departs(bits, decided)):
                kept = kept.following(bits, decided)
            else:
                kept = self.place(row, kept, last)
                as_solved = bool(np.abs(self.axes[row] - self.solved.axes[row]).max() < _SAME_DEG)
            last = self.axes[row]

    def place(self, row: int, kept: _Kept, last: Vector) -> _Kept:
        """Put a row on the solution nearest to the last one that keeps the status, if any; return what is then kept."""
        there = ik_all(self.mechanism, self.targets[row], last, self.held)
        rows = there.axes if len(there) else self.axes[row : row + 1]
        statuses = list(_statuses(self.mechanism, rows))
        stays = [not kept.departs(*status) for status in statuses]
        chosen = stays.index(True) if any(stays) else 0
        if not stays[0]:
            self.changes.append(StatusChange(row, kept.bits, kept.after(*statuses[0]), kept=any(stays)))
        if len(there):
            self.axes[row] = there.axes[chosen]
            self.counts[row] = rules.OK, there.iterations[chosen], 0
            self.misses[row] = there.position_error[chosen], there.rotation_error[chosen]
        return kept.following(*statuses[chosen])
