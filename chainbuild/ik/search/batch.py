"""Inverse kinematics of many independent poses, on all cores if compiled."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild import tolerances
from chainbuild.arrays import Matrix
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.ik import rules
from chainbuild.ik.request import DEFAULT, Held, IkOptions, IkRequest, matrix_of
from chainbuild.ik.result import STATUSES, IkResult
from chainbuild.ik.search.compiled import packing as compiled
from chainbuild.ik.search.compiled.cores import on_all_cores
from chainbuild.ik.search.problem import Problem, problem_of
from chainbuild.ik.search.solver import find, refusal, search
from chainbuild.ik.search.table import FailureWords, IkTable
from chainbuild.ik.search.words import Failures, Said
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.progress import Progress, counting

if TYPE_CHECKING:
    from chainbuild.kinematics.inputs import Pose


BAR: Final = "inverse kinematics"  # what the progress bar is labelled with
_ALONE: Final = 512  # fewer poses are left to one core: waking another that is busy can take milliseconds
Alone = Callable[[IkRequest], IkResult]

_PART: Final = 256  # poses that one core takes at a time: few, since one that is out of reach takes as long as hundreds
_CHUNK: Final = 8192  # poses between updates of the progress bar and checks for interrupts


@dataclass(frozen=True, slots=True, eq=False)
class Columns:
    """The arrays that rows are written to: free axes in SI, outcome, steps and starts, distance and angle left."""

    y: Matrix
    counts: NDArray[np.int64]
    misses: Matrix

    @classmethod
    def of(cls, rows: int, axes: int) -> Columns:
        """Return empty arrays for so many poses and free axes."""
        return cls(np.zeros((rows, axes)), np.zeros((rows, 3), np.int64), np.zeros((rows, 2)))

    def table(self, problem: Problem, targets: Matrix, starts: Matrix | None, options: IkOptions) -> IkTable:
        """Return the columns as a result that can say why rows failed.

        Args:
            problem: The problem.
            targets: (N, 4, 4) the poses.
            starts: (N or 1, n_free) SI values that rows started from, NaN for none; None: none had any.
            options: Tolerances and budget.
        """
        axes = np.repeat(problem.axes[None], len(self.y), axis=0)
        axes[:, problem.free] = self.y / problem.factors
        failed = np.flatnonzero(self.counts[:, 0] != rules.OK)
        explain = None
        if len(failed):
            begun = starts[failed] if starts is not None and len(starts) > 1 else starts
            explain = Failures(failed, targets[failed], begun, problem, options).explain
        return IkTable(axes, self.counts, self.misses, problem.task, problem.mechanism.labels, explain)


def solve_batch(
    mechanism: Mechanism,
    poses: Sequence[Pose] | ArrayLike,
    start: ArrayLike | None = None,
    held: Held | None = None,
    progress: Progress = False,
    options: IkOptions | None = None,
    solver: Alone | None = None,
) -> IkTable:
    """Find axis values for many poses; see `Robot.ik_batch`.

    Args:
        mechanism: The machine.
        poses: Tool in the workpiece frame [m].
        start: Axis values that the searches start from.
        held: What is held, the same for all poses.
        progress: As `Robot.ik_batch` has it.
        options: Tolerances and budget.
        solver: Solves every row by itself; None: the search of many rows at once.
    """
    options = options or DEFAULT
    targets, begin = pose_array(poses), start_array(mechanism, start)
    if begin is not None and len(begin) not in {1, len(targets)}:
        raise AxisValueError(
            f"expected one row of start values or one per pose ({len(targets)}), got {len(begin)}",
            permitted="one row, or one row per pose",
        )
    with counting(len(targets), progress, BAR) as advance:
        inputs = begin is not None and len(begin) > 1 and mechanism.kinematics.has_input_axes
        if inputs or solver is not None:
            return _row_by_row(mechanism, targets, begin, held, options, solver or search, advance)
        problem = problem_of(mechanism, None if begin is None else begin[0], held, options)
        first = None if problem.home is None else problem.home[None]
        if begin is not None:
            first = np.ascontiguousarray(begin[:, problem.free] * problem.factors)
        columns = Columns.of(len(targets), len(problem.free))
        packed = compiled.packed(problem) if options.compiled and compiled.available() else None
        if packed is None or len(targets) < _ALONE:
            _one_by_one(problem, targets, first, columns, options, advance)
        else:
            _compiled(problem, packed, targets, first, columns, options, advance)
    return columns.table(problem, targets, first, options)


def _compiled(
    problem: Problem,
    packed: compiled.Packed,
    targets: Matrix,
    first: Matrix | None,
    columns: Columns,
    options: IkOptions,
    advance: Any,
) -> None:
    task = (problem.middle, options.accuracy, options.max_restarts)
    starts = problem.middle[None] if first is None else first
    search_many = compiled.entries().search_many
    for begin in range(0, len(targets), _CHUNK):
        chunk = slice(begin, begin + _CHUNK)
        poses, own = targets[chunk], starts if len(starts) == 1 else starts[chunk]
        rows = (columns.y[chunk], columns.counts[chunk], columns.misses[chunk])

        def write(part: slice, poses: Matrix = poses, own: Matrix = own, rows: tuple[Any, ...] = rows) -> None:
            near = own if len(own) == 1 else own[part]
            search_many(*packed.arrays, poses[part], near, first is not None, *task, *(row[part] for row in rows))

        on_all_cores(write, len(poses), _PART)
        bad = np.flatnonzero(rows[1][:, 0] == rules.NOT_RIGID)
        if len(bad):
            raise at_row(refusal(targets[begin + bad[0]]), begin + int(bad[0]))
        if problem.rechecked:
            _recheck(problem, poses, own if first is not None else None, rows, options)
        if problem.held_beyond:
            rows[1][rows[1][:, 0] == rules.OK, 0] = rules.LIMITS
        advance(len(rows[0]))


def _recheck(
    problem: Problem, targets: Matrix, starts: Matrix | None, rows: tuple[Any, ...], options: IkOptions
) -> None:
    """Solve rows again that compiled code left beyond limits of sums or drives that it does not know."""
    y, counts, misses = rows
    for n in np.flatnonzero((counts[:, 0] == rules.OK) | (counts[:, 0] == rules.LIMITS)).tolist():
        if counts[n, 0] == rules.OK and problem.keeps(y[n]):
            continue
        found = find(problem, targets[n], None if starts is None else starts[n % len(starts)], options)
        y[n], misses[n] = found.y, (found.distance, found.angle)
        counts[n] = found.outcome, found.iterations, found.restarts


def _one_by_one(
    problem: Problem, targets: Matrix, first: Matrix | None, columns: Columns, options: IkOptions, advance: Any
) -> None:
    for row, target in enumerate(targets):
        start = None if first is None else first[row if len(first) > 1 else 0]
        try:
            found = find(problem, target, start, options)
        except ChainbuildError as error:
            raise at_row(error, row) from None
        columns.y[row] = found.y
        columns.counts[row] = found.outcome, found.iterations, found.restarts
        columns.misses[row] = found.distance, found.angle
        advance(1)


def _row_by_row(
    mechanism: Mechanism,
    targets: Matrix,
    begin: Matrix | None,
    held: Held | None,
    options: IkOptions,
    solver: Alone,
    advance: Any,
) -> IkTable:
    """Solve rows whose input axes differ, or whose loops have a closed form: each row is a problem of its own."""
    axes, errors = np.empty((len(targets), len(mechanism.axes))), np.empty((len(targets), 2))
    counts = np.empty((len(targets), 3), np.int64)
    words: dict[int, FailureWords] = {}
    for row, target in enumerate(targets):
        start = None if begin is None else begin[row if len(begin) > 1 else 0]
        try:
            found = solver(IkRequest.of(mechanism, target, start, held, options))
        except ChainbuildError as error:
            raise at_row(error, row) from None
        axes[row] = found.axes
        counts[row] = STATUSES.index(found.status), found.iterations, found.restarts
        errors[row] = found.position_error, found.rotation_error
        if not found.success:
            words[row] = FailureWords(found.reason, found.violated)
        advance(1)
    return IkTable(axes, counts, errors, mechanism.task, mechanism.labels, Said(words).explain)


def pose_array(poses: Sequence[Pose] | ArrayLike) -> Matrix:
    """Return poses as an array (N, 4, 4) of floats.

    Raises:
        ChainbuildError: not a sequence of 4×4 arrays or `pin.SE3`.
    """
    if isinstance(poses, np.ndarray) and poses.dtype.kind == "f" and poses.shape[1:] == (4, 4) and poses.ndim == 3:
        return np.ascontiguousarray(poses, dtype=float)
    try:
        rows = list(poses)  # type: ignore[arg-type]
    except TypeError:
        raise ChainbuildError("poses must be an array of shape (N, 4, 4) or a sequence of pin.SE3") from None
    result = np.empty((len(rows), 4, 4))
    for row, pose in enumerate(rows):
        try:
            result[row] = matrix_of(pose)
        except ChainbuildError as error:
            raise at_row(error, row) from None
    return result


def start_array(mechanism: Mechanism, start: ArrayLike | None) -> Matrix | None:
    """Return start values as an array (1 or N, n_axes), mm and degrees, or None.

    Raises:
        AxisValueError: wrong shape, not numbers, or not finite.
    """
    if start is None:
        return None
    try:
        values = np.atleast_2d(np.asarray(start, dtype=float))
    except (TypeError, ValueError):
        raise AxisValueError("start values must be numbers") from None
    n = len(mechanism.axes)
    if values.ndim != 2 or values.shape[1] != n or not (np.abs(values) < tolerances.HUGE_AXIS_VALUE).all():
        permitted = f"finite numbers of shape ({n},) or (N, {n})"
        raise AxisValueError("bad start values", parameter="start", permitted=permitted)
    return values


def at_row(error: ChainbuildError, row: int) -> ChainbuildError:
    """Return an error with the index of its row."""
    return ChainbuildError(f"pose {row}: {error.message}", permitted=error.permitted)
