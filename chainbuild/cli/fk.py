"""`chainbuild fk`: poses of axis values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from chainbuild.cli.axisvalues import At, values_of
from chainbuild.cli.show import note, output, with_progress
from chainbuild.cli.usage import DEFAULT_OPTIONS, MachineOptions, Output, UsageError, held_axes
from chainbuild.errors import ChainbuildError, Span

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from chainbuild.robot import Robot
    from chainbuild.tables import AxisTable

_AT = "--at"


def fk(
    file: str,
    /,
    *,
    axes: Path | None = None,
    at: At = (),
    output_file: Output = None,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Compute the pose of the tool in the workpiece frame for axis values.

    The table has one column an axis, named like the controller's axes, in mm and degrees. The poses are written with
    position in mm, quaternion, tool vector and the angles A, B, C of the controller; where C runs on over whole turns
    c_deg does so, too. Values outside the limits are computed and counted; on a machine with limits on sums of axes,
    such as the angle of a parallelogram, the column violations names what a row violates. Axes that `ik` holds, such as
    a track, follow in columns of their own, so that `ik` finds them there.

    Args:
        file: A machine file, or the name of a shipped machine.
        axes: CSV table of axis values.
        at: Axis values in channel order, mm and degrees, separated by commas; may be repeated. They come before those
            of a table.
        output_file: CSV table of poses to write. Without it: stdout.
        options: Which kinematic.
    """
    from chainbuild.tables import AxisTable, PoseWriter

    if axes is None and not at:
        raise UsageError("--axes or --at is due")
    robot = options.robot(file)
    outside: Counter[tuple[str, str]] = Counter()
    with ExitStack() as stack:
        table = stack.enter_context(AxisTable(axes, robot.axes)) if axes else None
        given = [values_of(robot, text) for text in at]
        stream = stack.enter_context(output(output_file))
        coupled = bool(robot.chain.constraints)
        held = held_axes(robot)
        writer = PoseWriter(
            stream, robot.chain.angle_mode, tool_axis=robot.chain.tool_axis, held=list(held), violations=coupled
        )
        for span, values in _rows(given, table):
            violated = robot.violated_limits(values)
            try:
                T = robot.fk(values).homogeneous
                writer.write(T, _shown_angles(robot, values), violated, [values[n] for n in held.values()])
            except ChainbuildError as error:
                error.span = error.span or span
                raise
            outside.update((span.file, name) for name in violated)
    for (source, name), count in outside.items():
        note(f"{source}: {count} row{'s' * (count != 1)} outside the limits of {name}")
    return 0


def _rows(given: Sequence[NDArray[np.float64]], table: AxisTable | None) -> Iterator[tuple[Span, NDArray[np.float64]]]:
    """Yield axis values (n_axes,) and where they stand: those of the command line, then those of the table."""
    for values in given:
        yield Span(_AT), values
    if table is not None:
        for line, values in with_progress(table.rows(), table, "poses"):
            yield Span(table.file, line), values


def _shown_angles(robot: Robot, axes: NDArray[np.float64]) -> tuple[float, float, float] | None:
    """Return A, B, C where the controller shows others than those of the pose."""
    return robot.pose_angles(axes) if robot.chain.absolute_c else None
