"""`chainbuild inspect`: a page that shows a robot, and plays back a table; live, or as a file."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from chainbuild.cli.show import note, note_lighter, note_undrawn, say
from chainbuild.cli.usage import DEFAULT_OPTIONS, MachineOptions, UsageError, Whole
from chainbuild.progress import bars_shown, without_bars

if TYPE_CHECKING:
    from chainbuild.arrays import Vector
    from chainbuild.formats.machine import Machine
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

        bar = bars_shown()
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


@Parameter(name="*", group="Live page")
@dataclass(frozen=True, slots=True)
class LiveOptions:
    """How the page is served, where it is not exported.

    Attributes:
        no_open: Do not open the page in a browser.
        port: Port of the server on this computer. Default: the first free one from 7421.
        token: Token in the address, 16 to 128 letters, digits, - and _. Default: that of an earlier run on the port,
            else a new one. Other users of the computer see what is given here in the list of processes.
        beside: A second machine file, or the name of a shipped machine, shown as a ghost moved by the same axis values.
    """

    no_open: Annotated[bool, Parameter(negative="")] = False
    port: Whole | None = None
    token: str | None = None
    beside: str | None = None

    def check(self, export: Path | None) -> None:
        """Refuse what an exported page cannot have.

        Raises:
            UsageError: an option of a live page with --export.
        """
        given = [name for name in ("port", "token", "beside") if getattr(self, name) is not None]
        if export is not None and (given or self.no_open):
            raise UsageError(f"--export excludes --{given[0] if given else 'no-open'}: an exported page has no server")


LIVE = LiveOptions()


def inspect(
    file: str,
    /,
    *,
    export: Path | None = None,
    at: Annotated[str | None, Parameter(allow_leading_hyphen=True)] = None,
    playback: PlaybackInput = NO_PLAYBACK,
    live: LiveOptions = LIVE,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Show a page on which the robot is moved by its axes, its pose or the mouse, or plays back a table.

    With Python behind it the page also changes machine data and conventions and shows collisions. It is served to this
    computer alone, at an address with a token, which is the only line on stdout; Ctrl-C ends it. An exported page is a
    single self-contained HTML file for any browser.

    Example: `chainbuild inspect kr6r900`

    Example: `chainbuild inspect kr6r900 --beside irb2600`

    Example: `chainbuild inspect kr6r900 --export page.html --axes path.csv --at 0,-90,90,0,30,0`

    Args:
        file: A machine file, or the name of a shipped machine.
        export: HTML file to write, instead of serving the page.
        at: Axis values that the page opens at, in channel order, mm and degrees, separated by commas, or a pose that
            the overlay names. Default: a pose in which the machine is seen well.
        playback: A table to play back.
        live: How the page is served.
        options: Which kinematic.
    """
    playback.check()
    live.check(export)
    machine, robot = options.built(file)
    values = None
    if at is not None:
        from chainbuild.cli.axisvalues import values_of

        values = values_of(robot, at)
    shown = playback.playback(robot)
    note_undrawn(robot.chain.geometry)
    note_lighter(robot.chain)
    if export is None:
        return _serve(machine, options, values, shown, live)
    from chainbuild.inspect.export import export_page

    say(export_page(robot, export, playback=shown, at=values, dimensions=options.dimensions(machine)))
    return 0


def _serve(
    machine: Machine, options: MachineOptions, at: Vector | None, playback: Playback | None, live: LiveOptions
) -> int:
    from chainbuild.inspect.live.server import serve
    from chainbuild.inspect.live.session import Session
    from chainbuild.inspect.live.tokens import checked_token

    token = None if live.token is None else checked_token(live.token)
    beside = None if live.beside is None else DEFAULT_OPTIONS.robot(live.beside)
    selection = options.selection(machine)
    session = Session(machine, selection, conventions=options.choices(), at=at, playback=playback, beside=beside)

    def ready(address: str, _end: Callable[[], None]) -> None:
        say(address)
        sys.stdout.flush()
        if not live.no_open:
            _open(address)

    with without_bars():
        refused = serve(session, ready, port=live.port, token=token)
    if refused:
        note(f"{refused} message{'s were' if refused > 1 else ' was'} refused")
    return 0


def _open(address: str) -> None:
    """Open the page in a browser that has a window; one of the terminal would take the terminal."""
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        note("no display: open the address in a browser on this computer")
        return
    # Some browsers return when they have shown the page, which is not served before this function does.
    threading.Thread(target=_browse, args=[address], daemon=True).start()


def _browse(address: str) -> None:
    import webbrowser

    if not webbrowser.open(address):
        note("no browser was found: open the address in one on this computer")
