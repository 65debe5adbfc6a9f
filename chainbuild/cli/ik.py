"""`chainbuild ik`: axis values of poses."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack
from itertools import chain, islice
from pathlib import Path
from typing import TYPE_CHECKING

from chainbuild.cli.show import note, output, with_progress
from chainbuild.cli.usage import DEFAULT_OPTIONS, MachineOptions, Output
from chainbuild.errors import ChainbuildError, Span, TableError
from chainbuild.units import deg_from_rad, mm_from_m

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from chainbuild.robot.robot import Robot
    from chainbuild.solve.result import IkResult
    from chainbuild.tables import AxisTable, PoseTable

_ROWS_FAILED = 3


def ik(
    file: str,
    /,
    *,
    poses: Path,
    start: Path | None = None,
    output_file: Output = None,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Compute axis values that bring the tool to poses, inside the limits.

    The table has x_mm, y_mm, z_mm and an orientation: qx, qy, qz, qw, or a_deg, b_deg, c_deg in the angles of the
    controller; for machines of fewer than six axes also tool_x, tool_y, tool_z. Every answer is verified by forward
    kinematics. A row without solution keeps its status and no axis values; the command then ends with 3.

    Args:
        file: A machine file, or the name of a shipped machine.
        poses: CSV table of poses.
        start: CSV table of axis values to start from: one row, or one a pose. Without it: the solution before.
        output_file: CSV table of axis values to write. Without it: stdout.
        options: Which kinematic.
    """
    from chainbuild.tables import AxisTable, IkWriter, PoseTable

    robot = options.robot(file)
    statuses: Counter[str] = Counter()
    with ExitStack() as stack:
        table = stack.enter_context(PoseTable(poses, robot.chain.angle_mode, robot.task))
        starts = stack.enter_context(AxisTable(start, robot.axes)) if start else None
        writer = IkWriter(stack.enter_context(output(output_file)), robot.axes)
        for result in with_progress(_solutions(robot, table, starts), table, "axis values"):
            statuses[result.status] += 1
            angle = deg_from_rad(result.rotation_error) if table.oriented else None
            axes, distance = result.axes if result.success else None, mm_from_m(result.position_error)
            writer.write(axes, result.status, distance, angle)
    failed = statuses.total() - statuses["ok"]
    if failed:
        reasons = ", ".join(f"{count} {status}" for status, count in sorted(statuses.items()) if status != "ok")
        note(f"{table.file}: {failed} of {statuses.total()} poses failed: {reasons}")
    return _ROWS_FAILED if failed else 0


def _solutions(robot: Robot, table: PoseTable, starts: AxisTable | None) -> Iterator[IkResult]:
    """Solve pose by pose; without start values each begins where the last solution ended."""
    given = _Starts(starts, table.file) if starts else None
    last: NDArray[np.float64] | None = None
    for row in table.rows():
        begin = given.next() if given else last
        try:
            result = robot.ik(row.T, start=begin)
        except ChainbuildError as error:
            error.span = error.span or Span(table.file, row.line)
            raise
        if result.success:
            last = result.axes
        yield result
    if given:
        given.finish()


class _Starts:
    """Start values: the only row of a table again and again, or row by row.

    Args:
        starts: The table.
        poses: Name of the table of poses, for messages.

    Raises:
        TableError: the table has no row.
    """

    def __init__(self, starts: AxisTable, poses: str) -> None:
        self._file, self._poses = starts.file, poses
        rows = (values for _, values in starts.rows())
        ahead = list(islice(rows, 2))
        if not ahead:
            raise TableError("the table of start values has no row", span=Span(self._file))
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
