"""`chainbuild fk`: poses of axis values."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from chainbuild.cli.show import note, output, with_progress
from chainbuild.cli.usage import DEFAULT_OPTIONS, MachineOptions, Output
from chainbuild.errors import ChainbuildError, Span


def fk(file: str, /, *, axes: Path, output_file: Output = None, options: MachineOptions = DEFAULT_OPTIONS) -> int:
    """Compute the pose of the tool in the workpiece frame for axis values.

    The table has one column an axis, named like the controller's axes, in mm and degrees. The poses are written with
    position in mm, quaternion, tool vector and the angles A, B, C of the controller. Values outside the limits are
    computed and counted.

    Args:
        file: A machine file, or the name of a shipped machine.
        axes: CSV table of axis values.
        output_file: CSV table of poses to write. Without it: stdout.
        options: Which kinematic.
    """
    from chainbuild.tables import AxisTable, PoseWriter

    robot = options.robot(file)
    outside: Counter[str] = Counter()
    with AxisTable(axes, robot.axes) as table, output(output_file) as stream:
        writer = PoseWriter(stream, robot.chain.angle_mode)
        for line, values in with_progress(table.rows(), table, "poses"):
            try:
                writer.write(robot.fk(values).homogeneous)
            except ChainbuildError as error:
                error.span = error.span or Span(table.file, line)
                raise
            outside.update(robot.violated_limits(values))
    for name, count in outside.items():
        note(f"{table.file}: {count} row{'s' * (count != 1)} outside the limits of {name}")
    return 0
