"""`chainbuild fk`: poses of axis values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from chainbuild.cli.axisvalues import At, values_of
from chainbuild.cli.show import note, output, with_progress
from chainbuild.cli.usage import DEFAULT_OPTIONS, MachineOptions, Output, UsageError
from chainbuild.errors import ChainbuildError, Span

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from chainbuild.robot import Robot
    from chainbuild.tables import AxisTable

    Values = NDArray[np.float64]
    StatusOf = Callable[[Sequence[Values] | Values], list[Sequence[int]]]

_AT = "--at"


def fk(
    file: str,
    /,
    *,
    axes: Path | None = None,
    at: At = (),
    quaternion: Annotated[bool, Parameter(negative="")] = False,
    angles: str | None = None,
    drives: Annotated[bool, Parameter(negative="")] = False,
    output_file: Output = None,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Compute the pose of the tool in the workpiece frame for axis values, as the controller displays it.

    The table has one column per axis, named like the controller's axes, in mm and degrees. Each pose is written with
    position in mm, the tool vector and what the controller displays beside the position: on RTCP kinematics the rotary
    axes by name, on complete ones pose angles, with the quaternion. Where C counts whole turns, so does c_deg. Rows
    outside the limits are computed and counted; on a machine with limits on sums of axes, such as the angle of a
    parallelogram, or of drives, the column violations names what a row violates. Axes that `ik` holds, such as a track,
    follow in columns of their own, where `ik` reads them.

    Example: `chainbuild fk kr6r900 --at 0,-90,90,0,0,0 -o poses.csv`

    Args:
        file: A machine file, or the name of a shipped machine.
        axes: CSV table of axis values; - is standard input.
        at: Axis values in channel order, mm and degrees, separated by commas; may be repeated. They come before the
            rows of the table.
        quaternion: Also write qx, qy, qz, qw on RTCP kinematics.
        angles: Also write all of a_deg, b_deg, c_deg; "own": in the machine's angle mode, the only one of a complete
            kinematic; else ypr, cba, cab, cba_std, abc, euler_c_first, euler_a_first, orirpy, orirpy2, ab or ba.
        drives: Add what each drive stands at, mm and degrees, in columns NAME_drive behind all others.
        output_file: CSV table of poses to write. Default: stdout.
        options: Which kinematic.
    """
    from chainbuild.ik.branches.status_turn import status_turn_rows
    from chainbuild.kinematics.displayed import displayed
    from chainbuild.kinematics.limits import drive_name
    from chainbuild.tables import AxisTable, PoseForm, PoseWriter

    if axes is None and not at:
        raise UsageError("expected axis values: --at 0,-90,90, or a table: --axes TABLE.csv")
    robot = options.robot(file)
    mode = _angle_mode(robot, angles)
    outside: Counter[tuple[str, str]] = Counter()
    with ExitStack() as stack:
        table = stack.enter_context(AxisTable(axes, robot.axes)) if axes else None
        given = [values_of(robot, text) for text in at]
        stream = stack.enter_context(output(output_file))
        form, shown = PoseForm.of(robot.chain, robot.task), None
        writer = PoseWriter(
            stream, form, quaternion=quaternion, angles=mode, more=form.held,
            violations=bool(robot.limits.sums or robot.limits.drives),
            drives=[drive_name(axis) for axis in robot.axes] if drives else (),
        )  # fmt: skip
        status_of: StatusOf = (lambda rows: status_turn_rows(robot, rows).tolist()) if form.status else _no_status
        count = 0
        for span, values, status in _rows(given, table, status_of):
            count += 1
            violated = robot.violated_limits(values)
            try:
                T = robot.fk(values)
                shown = displayed(robot, values, near=shown, at=T)
                inputs, behind = [shown[name] for name in form.held], robot.drives(values).tolist() if drives else ()
                writer.write(T.homogeneous, shown, inputs, status, violated, behind)
            except ChainbuildError as error:
                error.span = error.span or span
                raise
            outside.update((span.file, name) for name in violated)
        if table is not None and not count:
            note(f"{table.file}: the table has no rows")
    for (source, name), count in outside.items():
        note(f"{source}: {count} row{'s' * (count != 1)} outside the limits of {name}")
    return 0


def _angle_mode(robot: Robot, name: str | None) -> str | None:
    """Return the mode of the angles that --angles requests, or None.

    Raises:
        UsageError: no such mode, or one that would give columns two meanings.
    """
    from chainbuild import frames
    from chainbuild.chain.programmed.display import ANGLE_COLUMNS

    own, display = robot.chain.angle_mode, robot.chain.display
    if name is None:
        return None
    other = [column for column in robot.chain.display_columns if column in ANGLE_COLUMNS and display.kind != "angles"]
    if other:
        raise UsageError(f"--angles: this kinematic displays {', '.join(other)}, which are no pose angles")
    if name in ("own", own):
        return own
    if name not in frames.ANGLE_MODES:
        raise UsageError(f"--angles {name}: expected own, {', '.join(frames.ANGLE_MODES)}")
    if not display.rtcp:
        raise UsageError(f"--angles {name}: the angles of this kinematic are {own}")
    return name


def _no_status(rows: Sequence[Values] | Values) -> list[Sequence[int]]:
    return [()] * len(rows)


def _rows(
    given: Sequence[Values], table: AxisTable | None, status_of: StatusOf
) -> Iterator[tuple[Span, Values, Sequence[int]]]:
    """Yield place, axis values (n_axes,), status and turn of rows: those of the command line, then those of the table.

    Args:
        given: Axis values of the command line.
        table: The table.
        status_of: Gives status and turn of many rows, which takes little longer than of one.
    """
    for number, (values, status) in enumerate(zip(given, status_of(given) if given else (), strict=True), start=1):
        yield Span(_AT, number if len(given) > 1 else 0), values, status
    if table is not None:
        rows = (row for c in table.chunks() for row in zip(c.lines, c.values, status_of(c.values), strict=True))
        for line, values, status in with_progress(rows, table, "poses"):
            yield Span(table.file, line), values, status
