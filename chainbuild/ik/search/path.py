"""Inverse kinematics along a path: every pose starts at the previous one, on the nearest branch.

Most poses are one short descent from the last. Where that ends outside the limits, or an axis would move far (near a
singularity, or where a limit forces a whole turn), the branches found from several starts are compared and the
one with the smallest largest axis motion is taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.arrays import Matrix, Vector
from chainbuild.ik import rules
from chainbuild.ik.request import DEFAULT, Held, IkOptions
from chainbuild.ik.search.batch import BAR, Columns, pose_array, start_array
from chainbuild.ik.search.compiled import packing as compiled
from chainbuild.ik.search.found import SearchEnd
from chainbuild.ik.search.lookahead import best_sequence, branches
from chainbuild.ik.search.problem import Problem, problem_of
from chainbuild.ik.search.solver import find
from chainbuild.ik.search.table import IkTable
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.progress import Progress, counting

if TYPE_CHECKING:
    from chainbuild.kinematics.inputs import Pose


_MAX_STEP: Final = 0.2  # axis motion (rad or m) beyond which other branches are compared
_JUMP: Final = 0.5  # axis motion beyond which the path around it is solved as a whole
_BACK: Final = 60  # so many poses before it
_AHEAD: Final = 60  # and after it
_CHUNK: Final = 4096  # poses between two looks at the progress bar and the keyboard


def solve_path(
    mechanism: Mechanism,
    poses: Sequence[Pose] | ArrayLike,
    start: ArrayLike | None = None,
    held: Held | None = None,
    progress: Progress = False,
    options: IkOptions | None = None,
) -> IkTable:
    """Find axis values along a path, whatever the pose status; see `Robot.ik_path`."""
    options = options or DEFAULT
    targets, begin = pose_array(poses), start_array(mechanism, start)
    problem = problem_of(mechanism, None if begin is None else begin[0], held, options)
    columns = Columns.of(len(targets), len(problem.free))
    begin_part = None if begin is None else problem.free_part(begin[0])
    last = begin_part
    row = 0
    with counting(len(targets), progress, BAR) as advance:
        while row < len(targets):
            done = (
                0
                if last is None or problem.held_beyond
                else _track_rows(problem, targets[row:], last, columns, row, options)
            )
            if done == 0:
                done = _resolve_jump(problem, targets, row, begin_part, columns, last, options)
            row += done
            good = np.flatnonzero(columns.counts[:row, 0] == rules.OK)
            # A pose that cannot be met does not move the machine: the next one starts at the last solution.
            last = columns.y[good[-1]] if len(good) else last
            advance(done)
    return columns.table(problem, targets, _start_rows(columns, begin_part), options)


def _start_rows(columns: Columns, start: Vector | None) -> Matrix | None:
    """Return the axis values before each pose: the last solution, else the start, else NaN."""
    met = columns.counts[:, 0] == rules.OK
    if met.all():
        return None
    before = np.maximum.accumulate(np.concatenate(([-1], np.where(met, np.arange(len(met)), -1)[:-1])))
    first = np.full(columns.y.shape[1], np.nan) if start is None else start
    return np.where(before[:, None] < 0, first, columns.y[before])


def _resolve_jump(
    problem: Problem,
    targets: Matrix,
    row: int,
    start: Vector | None,
    columns: Columns,
    last: Vector | None,
    options: IkOptions,
) -> int:
    """Fill the row by the nearest branch, or the path around it by the best sequence; return the rows done after it."""
    found = _nearest_branch(problem, targets[row], last, options)
    _write(columns, row, found)
    if last is None or found.outcome != rules.OK or _largest(found.y - last) <= _JUMP:
        return 1
    first, end = row, min(row + _AHEAD, len(targets))
    while first > max(0, row - _BACK) and columns.counts[first - 1, 0] == rules.OK:
        first -= 1
    if first > 0 and columns.counts[first - 1, 0] != rules.OK:
        return 1
    before = columns.y[first - 1] if first else start
    if before is None:
        return 1
    sequence = best_sequence(problem, targets[first:end], before, row - first, options)
    if sequence is None:
        return 1
    one_descent = replace(options, max_restarts=0)
    verified = [find(problem, T, y, one_descent) for T, y in zip(targets[first:end], sequence, strict=True)]
    if any(answer.outcome != rules.OK for answer in verified):
        return 1
    for n, answer in enumerate(verified):
        _write(columns, first + n, answer)
    return end - row


def _track_rows(problem: Problem, targets: Matrix, last: Vector, columns: Columns, row: int, options: IkOptions) -> int:
    """Fill rows while each pose is one short descent from the previous one; return how many."""
    targets = targets[:_CHUNK]
    packed = compiled.packed(problem) if options.compiled and compiled.available() else None
    part = slice(row, row + len(targets))
    if packed is not None:
        rows = (columns.y[part], columns.counts[part], columns.misses[part])
        done: int = compiled.entries().track_many(*packed.arrays, targets, last, options.accuracy, _MAX_STEP, *rows)
        broken = (n for n in range(done if problem.curved else 0) if not problem.keeps(columns.y[row + n]))
        return next(broken, done)
    one_descent = replace(options, max_restarts=0)
    for n, target in enumerate(targets):
        guess = last if n < 2 else 2.0 * columns.y[row + n - 1] - columns.y[row + n - 2]
        found = find(problem, target, problem.box.clamp(guess), one_descent)
        if found.outcome != rules.OK or _largest(found.y - last) > _MAX_STEP:
            return n
        _write(columns, row + n, found)
        last = found.y
    return len(targets)


def _nearest_branch(problem: Problem, target: Matrix, last: Vector | None, options: IkOptions) -> SearchEnd:
    """Return the solution nearest to the current axis values, over the branches found from many starts."""
    best = find(problem, target, last, options)
    if last is None or best.outcome not in {rules.OK, rules.LIMITS}:
        return best
    for y in branches(problem, target, last, options):
        if best.outcome != rules.OK or _largest(y - last) < _largest(best.y - last):
            best = find(problem, target, y, replace(options, max_restarts=0))
    if best.outcome != rules.OK and problem.rechecked:  # whole turns away there may be one inside the common limits
        return find(problem, target, None, options)
    return best


def _write(columns: Columns, row: int, found: SearchEnd) -> None:
    columns.y[row] = found.y
    columns.counts[row] = found.outcome, found.iterations, found.restarts
    columns.misses[row] = found.distance, found.angle


def _largest(motion: Vector) -> float:
    return float(np.abs(motion).max(initial=0.0))
