"""`chainbuild ik`: axis values of poses."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace
from itertools import chain, groupby, islice
from pathlib import Path
from threading import Timer
from typing import TYPE_CHECKING, Annotated, Final

from cyclopts import Parameter

from chainbuild import tolerances
from chainbuild.cli.show import note, output, with_progress
from chainbuild.cli.usage import DEFAULT_OPTIONS, REJECTED, MachineOptions, Output, held_axes
from chainbuild.errors import ChainbuildError, Span, TableError
from chainbuild.ik.rules import Solver
from chainbuild.units import deg_from_rad, mm_from_m

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from chainbuild.ik.result import IkResult
    from chainbuild.robot import Robot
    from chainbuild.tables import AxisTable, PoseRow, PoseTable

    Vector = NDArray[np.float64]
    Matrix = NDArray[np.float64]

PoseAndResult = tuple["PoseRow", "IkResult"]

_PATIENCE_S: Final = 2.0  # seconds: compiled code that is kept loads in less


def solutions(
    robot: Robot, table: PoseTable, starts: AxisTable | None, solver: Solver, *, follow: bool
) -> Iterator[PoseAndResult]:
    """Solve the rows of a table; without start values each row starts at the last solution.

    Args:
        robot: The robot.
        table: The poses.
        starts: Axis values to start from: one row, or one per pose.
        solver: As for `Robot.ik`.
        follow: True: the poses are a path, and the table of starts has one row.

    Raises:
        TableError: a row holds no pose, or the number of starts does not match.
    """
    given = _Starts(starts, table.file, only_one=follow) if starts else None
    with _compilation_notice():
        begin = given.next() if follow and given else None
        rows = _followed(robot, table, begin, solver) if follow else _one_by_one(robot, table, given, solver)
        first = next(rows, None)
    if first is not None:
        yield first
    yield from rows


def _one_by_one(robot: Robot, table: PoseTable, given: _Starts | None, solver: Solver) -> Iterator[PoseAndResult]:
    last: Vector | None = None
    for row in table.rows():
        result = _solved(robot, table, row, given.next() if given else last, solver)
        if result.success:
            last = result.axes
        yield row, result
    if given:
        given.finish()


def _followed(robot: Robot, table: PoseTable, last: Vector | None, solver: Solver) -> Iterator[PoseAndResult]:
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
    """Return what a row specifies besides its pose."""
    return row.c_deg is None, tuple((row.held or {}).items())


def _solved(robot: Robot, table: PoseTable, row: PoseRow, begin: Vector | None, solver: Solver) -> IkResult:
    try:
        result = robot.ik(row.T, start=begin, held=row.held, solver=solver, absolute_c_deg=row.c_deg)
    except ChainbuildError as error:
        error.span = error.span or Span(table.file, row.line)
        raise
    return _agreeing(robot, row.T, result) if table.by_quaternion and row.c_deg is not None else result


@contextmanager
def _compilation_notice() -> Iterator[None]:
    """Note on stderr that numba compiles the solver at its first use; the result is cached."""
    from chainbuild.ik.search.compiled import packing as compiled

    timer = Timer(_PATIENCE_S, note, ["compiling the solver (only once)"])
    timer.daemon = True
    if compiled.available():
        timer.start()
    try:
        yield
    finally:
        timer.cancel()


def _agreeing(robot: Robot, T: Matrix, result: IkResult) -> IkResult:
    """Return a result, as a failure if c_deg led to another orientation than the quaternion of its row."""
    from chainbuild.kinematics.inputs import as_pose

    if not result.success:
        return result
    angle = robot.kinematics.errors(result.axes * robot.kinematics.si_factors, as_pose(T), "pose")[1]
    if angle <= tolerances.IK_ROTATION_RAD:
        return result
    reason = "c_deg contradicts the quaternion of the row"
    return replace(result, success=False, status="unreachable", rotation_error=angle, reason=reason)


class _Starts:
    """Start values: the single row of a table for every pose, or one row per pose.

    Args:
        starts: The table.
        poses: Name of the table of poses, for messages.
        only_one: Whether a second row is an error.

    Raises:
        TableError: the table has no row, or too many.
    """

    def __init__(self, starts: AxisTable, poses: str, *, only_one: bool = False) -> None:
        self._file, self._poses = starts.file, poses
        rows = (values for _, values in starts.rows())
        ahead = list(islice(rows, 2))
        if not ahead:
            raise TableError("the table of start values has no rows", span=Span(self._file))
        if only_one and len(ahead) > 1:
            raise TableError(
                "--follow: expected one row of start values, got more", span=Span(self._file), permitted="one row"
            )
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
            permitted="one row, or one row per pose",
        )


_REASONS_SHOWN: Final = 10  # fit on a screen; the others are counted
# Poses of an arm that are all nearer than this to its base are likely in metres; on a mill they are plausible.
_SMALL_MM: Final = 10.0


def ik(
    file: str,
    /,
    *,
    poses: Path,
    start: Path | None = None,
    follow: Annotated[bool, Parameter(negative="")] = False,
    solver: Solver = "auto",
    output_file: Output = None,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Compute axis values that bring the tool to poses, inside the limits.

    The table has x_mm, y_mm, z_mm and an orientation: qx, qy, qz, qw, or the controller's angles a_deg, b_deg, c_deg,
    or, for machines with fewer than six axes, tool_x, tool_y, tool_z. Every solution is verified by forward kinematics.
    A row without solution has a status and no axis values; the exit code is then 3, and stderr states each reason once,
    with the first row it applies to.

    ROBX robots with four axes are programmed by position and c_deg: A and B follow where the robot cannot reach them,
    and may be omitted. Where C counts whole turns, c_deg selects the turn, even next to a quaternion.

    Axes programmed in addition to the pose, such as a track or a rotary table (`info`: held by ik), are held, not
    solved for: at the value in the column of their name, as `fk` writes it, else in --start, else at 0.

    Example: `chainbuild ik kr6r900 --poses poses.csv -o axes.csv`

    Args:
        file: A machine file, or the name of a shipped machine.
        poses: CSV table of poses.
        start: CSV table of axis values to start from: one row for all poses, or one row per pose. Default: the
            previous solution.
        follow: Treat the poses as a path: it begins at the single row of --start, and each pose is reached from the
            previous one on the nearest branch, looking a few poses ahead.
        solver: damped: damped least squares; analytic: closed form; controller: the iteration limit of the machine
            data; auto: damped, then closed form if that finds nothing.
        output_file: CSV table of axis values to write. Default: stdout.
        options: Which kinematic.
    """
    from chainbuild.tables import AxisTable, IkWriter

    robot = options.robot(file)
    with ExitStack() as stack:
        table = stack.enter_context(_pose_table(robot, poses))
        report = _Report(table.file, all(axis.kind == "rotary" for axis in robot.axes))
        starts = stack.enter_context(AxisTable(start, robot.axes)) if start else None
        report.tell_held([name for name in held_axes(robot) if name not in table.held and not starts])
        coupled = bool(robot.limits.sums or robot.limits.drives)
        writer = IkWriter(stack.enter_context(output(output_file)), robot.axes, violations=coupled)
        for row, result in with_progress(solutions(robot, table, starts, solver, follow=follow), table, "axis values"):
            report.add(row, result)
            angle = deg_from_rad(result.rotation_error) if table.oriented else None
            axes, distance = result.axes if result.success else None, mm_from_m(result.position_error)
            violated = () if result.success else result.violated or robot.violated_limits(result.axes)
            writer.write(axes, result.status, distance, angle, violated)
    return REJECTED if report.finish() else 0


@dataclass(slots=True)
class _Group:
    """Rows that failed for the same reason: their number, and line and text of the first."""

    line: int
    words: str
    count: int = 0


class _Report:
    """Reports on stderr how many rows failed and why, and which values of the table were not used.

    Args:
        file: Name of the table of poses.
        arm: Whether all axes are rotary.
    """

    def __init__(self, file: str, arm: bool) -> None:
        self._file, self._arm = file, arm
        self._statuses: Counter[str] = Counter()
        self._groups: dict[str, _Group] = {}
        self._contradictory = 0
        self._first_contradictory = 0
        self._farthest_mm = 0.0

    def tell_held(self, names: Sequence[str]) -> None:
        """Name the input axes that are held at 0 because the input gives no value for them."""
        if names:
            note(f"{', '.join(names)} held at 0: neither {self._file} nor --start gives a value")

    def add(self, row: PoseRow, result: IkResult) -> None:
        """Count a row."""
        self._statuses[result.status] += 1
        self._farthest_mm = max(self._farthest_mm, *(abs(mm_from_m(float(value))) for value in row.T[:3, 3]))
        if row.contradictory:
            self._contradictory += 1
            self._first_contradictory = self._first_contradictory or row.line
        if not result.success:
            from chainbuild.ik.search.words import kind_of

            words = f"{result.status}: {result.reason}" if result.reason else result.status
            self._groups.setdefault(kind_of(words), _Group(row.line, words)).count += 1

    def finish(self) -> int:
        """Print the report and return how many rows failed."""
        if self._contradictory:
            more = f" ({self._contradictory} rows in all)" if self._contradictory > 1 else ""
            first = f"{self._file}:{self._first_contradictory}"
            note(f"{first}: a_deg, b_deg, c_deg contradict the quaternion, which is used{more}")
        self._tell_reasons()
        failed = self._statuses.total() - self._statuses["ok"]
        if failed:
            counts = ", ".join(f"{n} {status}" for status, n in sorted(self._statuses.items()) if status != "ok")
            note(f"{self._file}: {failed} of {self._statuses.total()} poses failed: {counts}")
        if (failed or self._arm) and self._farthest_mm < _SMALL_MM:
            note(f"{self._file}: no coordinate is above {self._farthest_mm:.3g} mm: are these metres?")
        return failed

    def _tell_reasons(self) -> None:
        """Print each reason once, at the first row it applies to, the most frequent first."""
        groups = sorted(self._groups.values(), key=lambda group: (-group.count, group.line))
        for group in groups[:_REASONS_SHOWN]:
            more = f" ({group.count} rows like this)" if group.count > 1 else ""
            note(f"{self._file}:{group.line}: {group.words}{more}")
        rest = groups[_REASONS_SHOWN:]
        if rest:
            others = "1 other reason" if len(rest) == 1 else f"{len(rest)} other reasons"
            note(f"… and {sum(group.count for group in rest)} more, for {others}")


def _pose_table(robot: Robot, poses: Path) -> PoseTable:
    from chainbuild.tables import PoseTable

    chain = robot.chain
    return PoseTable(
        poses,
        chain.angle_mode,
        robot.task,
        follows_c=chain.follows_c,
        running_c=chain.absolute_c is not None,
        tool_axis=robot.chain.tool_axis,
        held=list(held_axes(robot)),
    )
