"""Axis values of the rows of a table of poses: each from a start of its own, or along a path."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import chain, groupby, islice
from threading import Timer
from typing import TYPE_CHECKING, Literal

from chainbuild import tolerances
from chainbuild.cli.show import note
from chainbuild.errors import ChainbuildError, Span, TableError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from chainbuild.ik.result import IkResult
    from chainbuild.robot import Robot
    from chainbuild.tables import AxisTable, PoseRow, PoseTable

    Vector = NDArray[np.float64]
    Matrix = NDArray[np.float64]

Solver = Literal["auto", "damped", "analytic", "controller"]
Row = tuple["PoseRow", "IkResult"]

_PATIENCE_S = 2.0


def solutions(
    robot: Robot, table: PoseTable, starts: AxisTable | None, solver: Solver, *, follow: bool
) -> Iterator[Row]:
    """Solve the rows of a table; without start values each begins where the last solution ended.

    Args:
        robot: The robot.
        table: The poses.
        starts: Axis values to start from: one row, or one a pose.
        solver: As for `Robot.ik`.
        follow: True: the poses are a path, and the table of starts has one row.

    Raises:
        TableError: a row holds no pose, or the starts are not as many as they should be.
    """
    given = _Starts(starts, table.file, only_one=follow) if starts else None
    with _telling_of_compilation():
        begin = given.next() if follow and given else None
        rows = _followed(robot, table, begin, solver) if follow else _one_by_one(robot, table, given, solver)
        first = next(rows, None)
    if first is not None:
        yield first
    yield from rows


def _one_by_one(robot: Robot, table: PoseTable, given: _Starts | None, solver: Solver) -> Iterator[Row]:
    last: Vector | None = None
    for row in table.rows():
        result = _solved(robot, table, row, given.next() if given else last, solver)
        if result.success:
            last = result.axes
        yield row, result
    if given:
        given.finish()


def _followed(robot: Robot, table: PoseTable, last: Vector | None, solver: Solver) -> Iterator[Row]:
    """Solve a path: as a whole where nothing but the pose changes, else row by row from the solution before."""
    for _, group in groupby(table.rows(), key=_beside):
        part = list(group)
        results: Iterator[IkResult]
        if len(part) == 1 or part[0].c_deg is not None or solver not in ("auto", "damped"):
            results = (_solved(robot, table, row, last, solver) for row in part)
        else:
            results = iter(robot.ik_path([row.T for row in part], last, part[0].held))
        for row, result in zip(part, results, strict=True):
            if result.success:
                last = result.axes
            yield row, result


def _beside(row: PoseRow) -> tuple[bool, tuple[tuple[str, float], ...]]:
    """Return what a row asks for beside its pose."""
    return row.c_deg is None, tuple((row.held or {}).items())


def _solved(robot: Robot, table: PoseTable, row: PoseRow, begin: Vector | None, solver: Solver) -> IkResult:
    try:
        result = robot.ik(row.T, start=begin, held=row.held, solver=solver, absolute_c_deg=row.c_deg)
    except ChainbuildError as error:
        error.span = error.span or Span(table.file, row.line)
        raise
    return _agreeing(robot, row.T, result) if table.by_quaternion and row.c_deg is not None else result


@contextmanager
def _telling_of_compilation() -> Iterator[None]:
    """Say what takes so long: with numba the solver is compiled at its first use and cached from then on."""
    from chainbuild.ik.search.compiled import packing as compiled

    timer = Timer(_PATIENCE_S, note, ["compiling the solver; this happens once"])
    timer.daemon = True
    if compiled.available():
        timer.start()
    try:
        yield
    finally:
        timer.cancel()


def _agreeing(robot: Robot, T: Matrix, result: IkResult) -> IkResult:
    """Return a result, failed where c_deg has led to another orientation than the quaternion beside it."""
    from chainbuild.kinematics.inputs import as_pose

    if not result.success:
        return result
    angle = robot.kinematics.errors(result.axes * robot.kinematics.si_factors, as_pose(T), "pose")[1]
    if angle <= tolerances.IK_ROTATION_RAD:
        return result
    reason = "the angle C given does not go with the quaternion"
    return replace(result, success=False, status="unreachable", rotation_error=angle, reason=reason)


class _Starts:
    """Start values: the only row of a table again and again, or row by row.

    Args:
        starts: The table.
        poses: Name of the table of poses, for messages.
        only_one: Whether a second row is one too many.

    Raises:
        TableError: the table has no row, or one too many.
    """

    def __init__(self, starts: AxisTable, poses: str, *, only_one: bool = False) -> None:
        self._file, self._poses = starts.file, poses
        rows = (values for _, values in starts.rows())
        ahead = list(islice(rows, 2))
        if not ahead:
            raise TableError("the table of start values has no row", span=Span(self._file))
        if only_one and len(ahead) > 1:
            raise TableError("--follow starts at one place", span=Span(self._file), permitted="one row")
        self._only = ahead[0] if len(ahead) == 1 else None
        self._rows = chain(ahead, rows)

    def next(self) -> NDArray[np.float64]:
        """Return the start of the next pose."""
        if self._only is not None:
            return self._only
        values = next(self._rows, None)
        if values is None:
            raise self._wrong_count("fewer")
        return values

    def finish(self) -> None:
        """Refuse rows that are left when all poses are done."""
        if self._only is None and next(self._rows, None) is not None:
            raise self._wrong_count("more")

    def _wrong_count(self, comparison: str) -> TableError:
        return TableError(
            f"the table of start values has {comparison} rows than {self._poses}",
            span=Span(self._file),
            permitted="one row, or one row a pose",
        )
