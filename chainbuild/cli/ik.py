"""`chainbuild ik`: axis values of poses."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, Self

from cyclopts import Parameter

from chainbuild import tolerances
from chainbuild.cli.show import note, output, with_progress
from chainbuild.cli.usage import DEFAULT_OPTIONS, REJECTED, MachineOptions, Output
from chainbuild.errors import ChainbuildError, Span
from chainbuild.ik.rules import Solver
from chainbuild.units import deg_from_rad, mm_from_m, rad_from_deg

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from chainbuild.chain.elements import Task
    from chainbuild.cli.axisvalues import GivenStarts
    from chainbuild.ik.result import IkResult
    from chainbuild.robot import Robot
    from chainbuild.tables import AxisTable, PoseRow, PoseTable

    Vector = NDArray[np.float64]
    Matrix = NDArray[np.float64]

PoseAndResult = tuple["PoseRow", "IkResult"]


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
    from chainbuild.cli.axisvalues import GivenStarts

    given = GivenStarts(starts, table.file, only_one=follow) if starts else None
    if table.orientation.source == "vector" and given:
        table.begin(robot.fk(given.first).rotation)
    if follow:
        yield from _followed(robot, table, given.next() if given else None, solver)
    else:
        yield from _one_by_one(robot, table, given, solver)


def _one_by_one(robot: Robot, table: PoseTable, given: GivenStarts | None, solver: Solver) -> Iterator[PoseAndResult]:
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
    watch = None
    if robot.chain.has_status:
        from chainbuild.ik.policies.status_path import StatusWatch

        watch = StatusWatch(robot)
        if last is not None:
            watch.change(last)
    for _, group in groupby(table.rows(), key=_beside):
        part = list(group)
        results: Iterator[IkResult]
        first = part[0]
        alone = first.c_deg is not None or first.shown is not None or first.status is not None
        alone = alone or first.turn is not None or len(part) == 1 or solver not in ("auto", "damped")
        told: Mapping[int, str] = {}
        if alone:
            results = (_solved(robot, table, row, last, solver) for row in part)
        else:
            path = robot.ik_path([row.T for row in part], last, first.held)
            told, results = {change.row: change.words for change in path.status_changes}, iter(path)
        for n, (row, result) in enumerate(zip(part, results, strict=True)):
            if result.success:
                last = result.axes
                change = None if watch is None else watch.change(last)
                words = told.get(n) or (change.words if alone and change else None)
                if words:
                    note(f"{table.file}:{row.line}: {words}")
            yield row, result


def _beside(row: PoseRow) -> tuple[bool, bool, bool, tuple[tuple[str, float], ...]]:
    """Return what a row specifies besides its pose."""
    chosen = row.status is None and row.turn is None
    return row.c_deg is None, row.shown is None, chosen, tuple((row.held or {}).items())


def _solved(robot: Robot, table: PoseTable, row: PoseRow, begin: Vector | None, solver: Solver) -> IkResult:
    try:
        if row.shown is not None:
            from chainbuild.ik.displayed import solve_displayed

            return solve_displayed(robot, row.T[:3, 3], row.shown, begin, row.held, solver)
        result = robot.ik(
            row.T, begin, row.held, solver=solver, absolute_c_deg=row.c_deg, status=row.status, turn=row.turn
        )
    except ChainbuildError as error:
        error.span = error.span or Span(table.file, row.line)
        raise
    return _agreeing(robot, row.T, result) if table.by_quaternion and row.c_deg is not None else result


def contradiction(table: PoseTable) -> str:
    """Return what is said of a row with two orientations that differ."""
    used = "the quaternion, which is" if table.by_quaternion else f"{', '.join(table.orientation.columns)}, which are"
    return f"{', '.join(table.beside)} contradict {used} used"


def contradicts(robot: Robot, table: PoseTable, row: PoseRow, result: IkResult) -> bool:
    """Return whether another orientation stands in a row beside the one that is used."""
    if row.contradictory or row.beside is None or not result.success:
        return row.contradictory
    from chainbuild.chain.programmed.display import QUATERNION_COLUMNS
    from chainbuild.comparison.comparison import pose_errors
    from chainbuild.frames import transform

    ours, theirs = robot.fk(result.axes).homogeneous[None], transform(row.beside)[None]
    compared: Task = "pose" if len(table.beside) == len(QUATERNION_COLUMNS) else "direction"
    angle = pose_errors(ours, theirs, compared, robot.chain.tool_column)[1]
    return bool(angle[0] > rad_from_deg(tolerances.ANGLES_BESIDE_QUATERNION_DEG))


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

    The table has x_mm, y_mm, z_mm and what the controller takes beside them (`info` lists the columns): on RTCP
    kinematics the rotary axes by name, for which the linear axes alone are solved, exactly; on complete ones pose
    angles. A full orientation is taken, too: qx, qy, qz, qw, or, for machines with fewer than six axes, tool_x, tool_y,
    tool_z; then all axes are solved for. Every solution is verified by forward kinematics.
    A row without solution has a status and no axis values; the exit code is then 3, and stderr states each reason once,
    with the first row it applies to.

    ROBX robots with four axes are programmed by position and c_deg: A and B follow where the robot cannot reach them,
    and may be omitted. Where C counts whole turns, c_deg selects the turn, even next to a quaternion.

    Axes programmed in addition to the pose, such as a track or a rotary table (`info`: held by ik), are held, not
    solved for: at the value in the column of their name, as `fk` writes it, else in --start, else at 0.

    Example: `chainbuild ik kr6r900 --poses poses.csv -o axes.csv`

    Args:
        file: A machine file, or the name of a shipped machine.
        poses: CSV table of poses; - is standard input.
        start: CSV table of axis values to start from: one row for all poses, or one row per pose. Default: the
            previous solution.
        follow: Treat the poses as a path: it begins at the single row of --start, and each pose is reached from the
            previous one on the nearest branch, looking a few poses ahead. What happens between the rows, the tip on
            a line, is told on stderr: singularities, limits, where the line leaves the reach.
        solver: damped: damped least squares; analytic: closed form; controller: the iteration limit of the machine
            data; auto: damped, then closed form if that finds nothing.
        output_file: CSV table of axis values to write. Default: stdout.
        options: Which kinematic.
    """
    from chainbuild.tables import AxisTable, IkWriter, PoseForm, PoseTable

    robot = options.robot(file)
    path: list[Vector | None] = []
    with ExitStack() as stack:
        table = stack.enter_context(PoseTable(poses, PoseForm.of(robot.chain, robot.task)))
        report = IkReport.of(robot, table)
        starts = stack.enter_context(AxisTable(start, robot.axes)) if start else None
        report.tell_held(robot, table, starts)
        coupled = bool(robot.limits.sums or robot.limits.drives)
        writer = IkWriter(stack.enter_context(output(output_file)), robot.axes, violations=coupled)
        for row, result in with_progress(solutions(robot, table, starts, solver, follow=follow), table, "axis values"):
            report.add(row, result, contradicts(robot, table, row, result))
            angle = deg_from_rad(result.rotation_error) if table.oriented else None
            axes, distance = result.axes if result.success else None, mm_from_m(result.position_error)
            if follow:
                path.append(axes)
            violated = () if result.success else result.violated or robot.violated_limits(result.axes)
            writer.write(axes, result.status, distance, angle, violated)
    failed = report.finish()
    if follow:
        from chainbuild.cli.pathnotes import tell_between

        tell_between(robot, path, table.file)
    return REJECTED if failed else 0


@dataclass(slots=True)
class _Group:
    """Rows that failed for the same reason: their number, and line and text of the first."""

    line: int
    words: str
    count: int = 0


class IkReport:
    """Reports on stderr how many rows failed and why, and which values of the table were not used.

    Args:
        file: Name of the table of poses.
        contradiction: What is said of a row with two orientations that differ.
        arm: Whether all axes are rotary.
    """

    def __init__(self, file: str, contradiction: str, arm: bool) -> None:
        self._file, self._words, self._arm = file, contradiction, arm
        self._statuses: Counter[str] = Counter()
        self._groups: dict[str, _Group] = {}
        self._contradictory = 0
        self._first_contradictory = 0
        self._farthest_mm = 0.0

    @classmethod
    def of(cls, robot: Robot, table: PoseTable) -> Self:
        """Return the report on the rows of a table."""
        return cls(table.file, contradiction(table), all(axis.kind == "rotary" for axis in robot.axes))

    def tell_held(self, robot: Robot, table: PoseTable, starts: AxisTable | None) -> None:
        """Name unused columns, and the input axes that are held at 0 because nothing gives a value for them."""
        self.tell_unused(table)
        names = [axis.name for axis in robot.axes if axis.held and axis.name not in table.names and not starts]
        if names:
            note(f"{', '.join(names)} held at 0: neither {self._file} nor --start gives a value")

    def tell_unused(self, table: PoseTable) -> None:
        """Name unused columns."""
        if table.unused:
            used = ", ".join(table.orientation.columns) or "the position alone"
            note(f"{table.file}: {', '.join(table.unused)} not used: {used} counts")

    def add(self, row: PoseRow, result: IkResult, contradictory: bool) -> None:
        """Count a row; `contradictory`: another orientation stands beside the one that is used."""
        self._statuses[result.status] += 1
        self._farthest_mm = max(self._farthest_mm, *(abs(mm_from_m(float(value))) for value in row.T[:3, 3]))
        if contradictory:
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
            note(f"{first}: {self._words}{more}")
        self._tell_reasons()
        if not self._statuses:
            note(f"{self._file}: the table has no rows")
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
