"""`chainbuild ik`: axis values of poses."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

from cyclopts import Parameter

from chainbuild.cli.show import note, output, with_progress
from chainbuild.cli.solutions import Solver, solutions
from chainbuild.cli.usage import DEFAULT_OPTIONS, MachineOptions, Output, held_axes, pointed_axis
from chainbuild.units import deg_from_rad, mm_from_m

if TYPE_CHECKING:
    from chainbuild.ik.result import IkResult
    from chainbuild.robot import Robot
    from chainbuild.tables import PoseRow, PoseTable

_ROWS_FAILED = 3
_REASONS_SHOWN = 10
# An arm whose poses are all nearer than this to its base got them in metres; a mill may well cut a part this small.
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

    The table has x_mm, y_mm, z_mm and an orientation: qx, qy, qz, qw, or a_deg, b_deg, c_deg in the angles of the
    controller; for machines of fewer than six axes also tool_x, tool_y, tool_z. Every answer is verified by forward
    kinematics. A row without solution keeps its status and no axis values; the command then ends with 3, and stderr
    says why: each reason once, with the first row it holds for.

    ROBX robots of four axes are programmed by position and c_deg: where a row's A and B cannot be reached they follow,
    and c_deg may stand alone. Where C runs on over whole turns, c_deg says which turn is meant, also beside a
    quaternion.

    Axes that are programmed beside the pose, such as a track or a rotary table (`info`: held by ik), are held, not
    solved for: at the value of a column of their name, as `fk` writes it, else at that of --start, else at 0.

    Args:
        file: A machine file, or the name of a shipped machine.
        poses: CSV table of poses.
        start: CSV table of axis values to start from: one row that every pose starts from, or one a pose. Without it:
            the solution before.
        follow: The poses are a path: it begins at the only row of --start, and each pose is reached from the one before
            on the nearest branch, a few poses looked ahead.
        solver: damped; analytic: a closed form; controller: within the iterations that the machine data grant; auto:
            damped, and a closed form where that finds nothing.
        output_file: CSV table of axis values to write. Without it: stdout.
        options: Which kinematic.
    """
    from chainbuild.tables import AxisTable, IkWriter

    robot = options.robot(file)
    with ExitStack() as stack:
        table = stack.enter_context(_pose_table(robot, poses))
        report = _Report(table.file, all(axis.kind == "rotary" for axis in robot.axes))
        starts = stack.enter_context(AxisTable(start, robot.axes)) if start else None
        report.tell_held([name for name in held_axes(robot) if name not in table.held and not starts])
        coupled = bool(robot.chain.constraints)
        writer = IkWriter(stack.enter_context(output(output_file)), robot.axes, violations=coupled)
        for row, result in with_progress(solutions(robot, table, starts, solver, follow=follow), table, "axis values"):
            report.add(row, result)
            angle = deg_from_rad(result.rotation_error) if table.oriented else None
            axes, distance = result.axes if result.success else None, mm_from_m(result.position_error)
            violated = () if result.success else result.violated or robot.violated_limits(result.axes)
            writer.write(axes, result.status, distance, angle, violated)
    return _ROWS_FAILED if report.finish() else 0


@dataclass(slots=True)
class _Group:
    """Rows that failed for the same reason: how many, and the first one's line number and own words."""

    line: int
    words: str
    count: int = 0


class _Report:
    """Says on stderr how many rows failed and why, and what was not taken as the table says it.

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
        """Say which input axes stand at 0 because nothing gives their values."""
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
        """Print what there is to say and return how many rows failed."""
        if self._contradictory:
            more = f" ({self._contradictory} rows in all)" if self._contradictory > 1 else ""
            first = f"{self._file}:{self._first_contradictory}"
            note(f"{first}: a_deg, b_deg, c_deg contradict the quaternion, which counts{more}")
        self._tell_reasons()
        failed = self._statuses.total() - self._statuses["ok"]
        if failed:
            counts = ", ".join(f"{n} {status}" for status, n in sorted(self._statuses.items()) if status != "ok")
            note(f"{self._file}: {failed} of {self._statuses.total()} poses failed: {counts}")
        if (failed or self._arm) and self._farthest_mm < _SMALL_MM:
            note(f"{self._file}: no coordinate is above {self._farthest_mm:.3g} mm: are these metres?")
        return failed

    def _tell_reasons(self) -> None:
        """Print each reason once, at the first row it holds for; the most frequent before the others."""
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
        tool_axis=pointed_axis(robot),
        held=list(held_axes(robot)),
    )
