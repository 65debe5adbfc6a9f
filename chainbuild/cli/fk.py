"""`chainbuild fk`: poses of axis values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

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
    drives: Annotated[bool, Parameter(negative="")] = False,
    output_file: Output = None,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Compute the pose of the tool in the workpiece frame for axis values.

    The table has one column per axis, named like the controller's axes, in mm and degrees. Each pose is written with
    position in mm, quaternion, tool vector and the controller's angles A, B, C; where C counts whole turns, so does
    c_deg. Rows outside the limits are computed and counted; on a machine with limits on sums of axes, such as the angle
    of a parallelogram, the column violations names what a row violates. Axes that `ik` holds, such as a track, follow
    in columns of their own, where `ik` reads them.

    Example: `chainbuild fk kr6r900 --at 0,-90,90,0,0,0 -o poses.csv`

    Args:
        file: A machine file, or the name of a shipped machine.
        axes: CSV table of axis values.
        at: Axis values in channel order, mm and degrees, separated by commas; may be repeated. They come before the
            rows of the table.
        drives: Add what each drive stands at, mm and degrees, in columns NAME_drive behind all others.
        output_file: CSV table of poses to write. Default: stdout.
        options: Which kinematic.
    """
    from chainbuild.kinematics.limits import drive_name
    from chainbuild.tables import AxisTable, PoseWriter

    if axes is None and not at:
        raise UsageError("expected --axes or --at")
    robot = options.robot(file)
    outside: Counter[tuple[str, str]] = Counter()
    with ExitStack() as stack:
        table = stack.enter_context(AxisTable(axes, robot.axes)) if axes else None
        given = [values_of(robot, text) for text in at]
        stream = stack.enter_context(output(output_file))
        coupled = bool(robot.limits.sums or robot.limits.drives)
        held = held_axes(robot)
        writer = PoseWriter(
            stream, robot.chain.angle_mode, tool_axis=robot.chain.tool_axis, held=list(held), violations=coupled,
            drives=[drive_name(axis) for axis in robot.axes] if drives else (),
        )  # fmt: skip
        for span, values in _rows(given, table):
            violated = robot.violated_limits(values)
            try:
                T = robot.fk(values).homogeneous
                behind = robot.drives(values).tolist() if drives else ()
                writer.write(T, _shown_angles(robot, values), violated, [values[n] for n in held.values()], behind)
            except ChainbuildError as error:
                error.span = error.span or span
                raise
            outside.update((span.file, name) for name in violated)
    for (source, name), count in outside.items():
        note(f"{source}: {count} row{'s' * (count != 1)} outside the limits of {name}")
    return 0


def _rows(given: Sequence[NDArray[np.float64]], table: AxisTable | None) -> Iterator[tuple[Span, NDArray[np.float64]]]:
    """Yield axis values (n_axes,) and their place in the input: those of the command line, then those of the table."""
    for values in given:
        yield Span(_AT), values
    if table is not None:
        for line, values in with_progress(table.rows(), table, "poses"):
            yield Span(table.file, line), values


def _shown_angles(robot: Robot, axes: NDArray[np.float64]) -> tuple[float, float, float] | None:
    """Return A, B, C where the controller shows angles other than the pose's, else None."""
    return robot.pose_angles(axes) if robot.chain.absolute_c else None
