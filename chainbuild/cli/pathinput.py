"""The rows of a path: a table of axis values or of poses, and how it is looked at."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from chainbuild.cli.show import with_progress
from chainbuild.cli.usage import BetweenRows, UsageError

if TYPE_CHECKING:
    from chainbuild.analysis.path.along import PathOptions
    from chainbuild.arrays import Vector
    from chainbuild.robot import Robot
    from chainbuild.tables import AxisTable, PoseTable


@Parameter(name="*", group="Path")
@dataclass(frozen=True, slots=True)
class PathInput:
    """A path and what is asked of it.

    Attributes:
        axes: CSV table of axis values: a path, the axes even between rows.
        poses: CSV table of poses: a path, the tip on a straight line between rows; axis values as `ik --follow` finds
            them.
        start: CSV table with one row of axis values that --poses begins at.
        between: What the machine does between rows. ptp: all axes change evenly; cp: the tip moves along a straight
            line; rows: only the rows are looked at. Default: ptp for --axes, cp for --poses.
        feed: Speed of the tip in mm/min: adds times and the largest speed of each axis.
        near: What counts as close: the function of a named singularity at or below it. Default: 0.1, a wrist axis
            within 5.7 degrees.
    """

    axes: Path | None = None
    poses: Path | None = None
    start: Path | None = None
    between: BetweenRows | None = None
    feed: Annotated[float | None, Parameter(allow_leading_hyphen=True)] = None
    near: Annotated[float | None, Parameter(allow_leading_hyphen=True)] = None

    @property
    def given(self) -> bool:
        """Whether there is a table."""
        return self.axes is not None or self.poses is not None

    @property
    def motion(self) -> BetweenRows:
        """What the machine does between rows."""
        return self.between or ("cp" if self.poses else "ptp")

    def check(self, at: bool) -> None:
        """Refuse options that do not go together.

        Args:
            at: Whether positions are given on the command line.

        Raises:
            UsageError: they do not.
        """
        if at + (self.axes is not None) + (self.poses is not None) != 1:
            raise UsageError("expected --at, --axes or --poses, one of them")
        if self.start is not None and self.poses is None:
            raise UsageError("--start requires --poses")
        if at and self.between is not None:
            raise UsageError("--between requires --axes or --poses")
        for name, value in (("--feed", self.feed), ("--near", self.near)):
            if value is not None and (at or self.motion == "rows"):
                raise UsageError(f"{name} requires a path with --between ptp or cp")

    def path_options(self, tool_speed_mm: float) -> PathOptions:
        """Return the thresholds and speeds of the path.

        Raises:
            ChainbuildError: a value out of range.
        """
        from chainbuild.analysis.path.along import DEFAULT_PATH, PathOptions

        near = DEFAULT_PATH.near if self.near is None else self.near
        asked = PathOptions(near=near, feed_mm_min=self.feed, tool_speed_mm=tool_speed_mm)
        asked.check()
        return asked

    @contextmanager
    def rows(self, robot: Robot) -> Iterator[Iterator[Vector]]:
        """Open the table and give its rows one by one; a pose without solution is a row of NaN.

        Why poses have no solution is said on stderr at the end.

        Raises:
            ChainbuildError: a table that cannot be read.
        """
        from chainbuild.tables import AxisTable, PoseForm, PoseTable

        with ExitStack() as stack:
            if self.axes is not None:
                given = stack.enter_context(AxisTable(self.axes, robot.axes))
                yield with_progress((values for _, values in given.rows()), given, "rows")
                return
            assert self.poses is not None
            table = stack.enter_context(PoseTable(self.poses, PoseForm.of(robot.chain, robot.task)))
            starts = stack.enter_context(AxisTable(self.start, robot.axes)) if self.start else None
            yield _followed_rows(robot, table, starts)


def _followed_rows(robot: Robot, table: PoseTable, starts: AxisTable | None) -> Iterator[Vector]:
    """Yield the axis values of poses as `ik --follow` finds them, and say at the end what was not found."""
    import numpy as np

    from chainbuild.cli.ik import IkReport, contradicts, solutions

    report = IkReport.of(robot, table)
    report.tell_held(robot, table, starts)
    for row, result in with_progress(solutions(robot, table, starts, "auto", follow=True), table, "rows"):
        report.add(row, result, contradicts(robot, table, row, result))
        yield result.axes if result.success else np.full(len(robot.axes), np.nan)
    report.finish()
