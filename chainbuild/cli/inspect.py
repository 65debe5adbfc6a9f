"""`chainbuild inspect`: an HTML page that shows a robot, and plays back a table."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from chainbuild.cli.show import note, note_undrawn, say
from chainbuild.cli.usage import DEFAULT_OPTIONS, MachineOptions, UsageError

if TYPE_CHECKING:
    from chainbuild.ik.result import IkResult
    from chainbuild.inspect.playback import Playback
    from chainbuild.robot import Robot
    from chainbuild.tables import PoseTable


@Parameter(name="*", group="Playback")
@dataclass(frozen=True, slots=True)
class PlaybackInput:
    """A table that the page plays back; one of the three.

    Attributes:
        axes: CSV table of axis values.
        poses: CSV table of poses; each is solved from the solution before it, as `ik` does. Rows without solution are
            named, and left out.
        recording: CSV table of axis values and the poses that the controller showed for them: the page also draws
            where the tool was measured, and how far from the model.
    """

    axes: Path | None = None
    poses: Path | None = None
    recording: Path | None = None

    def check(self) -> None:
        """Refuse more than one table.

        Raises:
            UsageError: there are several.
        """
        given = [f"--{name}" for name in ("axes", "poses", "recording") if getattr(self, name) is not None]
        if len(given) > 1:
            raise UsageError(f"{' and '.join(given)} exclude one another: expected one table to play back")

    def playback(self, robot: Robot) -> Playback | None:
        """Read the table; None where there is none.

        Raises:
            ChainbuildError: the table cannot be read, or holds no rows.
        """
        from chainbuild.inspect.playback import axes_playback, pose_playback, recording_playback

        bar = sys.stderr.isatty()
        if self.axes is not None:
            return axes_playback(robot, self.axes, progress=bar)
        if self.recording is not None:
            return recording_playback(robot, self.recording, progress=bar)
        if self.poses is not None:
            return pose_playback(robot, self.poses, _solved_rows(robot, self.poses), progress=bar)
        return None


def _solved_rows(robot: Robot, path: Path) -> Iterator[IkResult]:
    """Yield what inverse kinematics finds for a table of poses, and say at the end what was not found."""
    from chainbuild.cli.ik import IkReport, contradicts, solutions
    from chainbuild.cli.show import with_progress
    from chainbuild.tables import PoseForm, PoseTable

    with PoseTable(path, PoseForm.of(robot.chain, robot.task)) as table:
        report = IkReport.of(robot, table)
        report.tell_unused(table)
        _tell_held(robot, table)
        for row, result in with_progress(solutions(robot, table, None, "auto", follow=False), table, "axis values"):
            report.add(row, result, contradicts(robot, table, row, result))
            yield result
    report.finish()


def _tell_held(robot: Robot, table: PoseTable) -> None:
    names = [axis.name for axis in robot.axes if axis.held and axis.name not in table.names]
    if names:
        note(f"{', '.join(names)} held at 0: {table.file} gives no value")


NO_PLAYBACK = PlaybackInput()


def inspect(
    file: str,
    /,
    *,
    export: Path,
    at: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None,
    playback: PlaybackInput = NO_PLAYBACK,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Write an HTML page on which the robot is moved by its axes, its pose or the mouse, or plays back a table.

    The page is a single self-contained HTML file for any browser.

    Example: `chainbuild inspect kr6r900 --export page.html`

    Example: `chainbuild inspect kr6r900 --export page.html --axes path.csv --at 0,-90,90,0,30,0`

    Args:
        file: A machine file, or the name of a shipped machine.
        export: HTML file to write.
        at: Axis values that the page opens at, in channel order, mm and degrees, separated by commas, or a pose that
            the overlay names. Default: a pose in which the machine is seen well.
        playback: A table to play back.
        options: Which kinematic.
    """
    from chainbuild.inspect.export import export_page

    playback.check()
    machine, robot = options.built(file)
    values = None
    if at is not None:
        from chainbuild.cli.axisvalues import values_of

        values = values_of(robot, at)
    shown = playback.playback(robot)
    note_undrawn(robot.chain.geometry)
    say(export_page(robot, export, playback=shown, at=values, dimensions=options.dimensions(machine)))
    return 0
