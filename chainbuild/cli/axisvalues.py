"""Axis values on the command line: `--at 0,-90,90,0,0,0`, `--at park`, or a CSV table."""

from __future__ import annotations

from itertools import chain, islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from chainbuild.cli.usage import UsageError
from chainbuild.errors import Span, TableError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from chainbuild.robot import Robot
    from chainbuild.tables import AxisTable

# Values with a leading minus sign are values, not options.
At = Annotated[tuple[str, ...], Parameter(negative="", show_default=False, allow_leading_hyphen=True)]


def values_of(robot: Robot, text: str) -> NDArray[np.float64]:
    """Return axis values (n_axes,) given as numbers separated by commas, or as the name of a pose of the overlay.

    Raises:
        UsageError: the text is neither.
        AxisValueError: wrong number of values, or a value that is not finite.
    """
    from chainbuild.chain.names import pose_named

    named = pose_named(robot.chain, text)
    if named is not None:
        return named
    try:
        numbers = [float(word) for word in text.split(",")]
    except ValueError:
        known = ", ".join(pose.name for pose in robot.chain.named_poses)
        or_named = f", or a named pose: {known}" if known else ""
        expected = f"expected numbers separated by commas, such as 0,-90,90{or_named}"
        raise UsageError(f"--at {text}: {expected}") from None
    return robot.axis_values(numbers)


def given_rows(robot: Robot, at: tuple[str, ...], axes: Path | None) -> NDArray[np.float64]:
    """Return the axis values (N, n_axes) of --at, then those of the table."""
    import numpy as np

    from chainbuild.tables import AxisTable

    rows = [values_of(robot, text) for text in at]
    if axes is not None:
        with AxisTable(axes, robot.axes) as table:
            rows.extend(values for _, values in table.rows())
    return np.array(rows).reshape(len(rows), len(robot.axes))


class GivenStarts:
    """Start values: the single row of a table for every pose, or one row per pose; `first` is the first of them.

    Args:
        starts: The table.
        poses: Name of the table of poses, for messages.
        only_one: Whether a second row is an error.

    Raises:
        TableError: the table has no row, or too many.
    """

    def __init__(self, starts: AxisTable, poses: str, *, only_one: bool = False) -> None:
        self._file, self._poses = starts.file, poses
        rows = (values for _, values in starts.rows())
        ahead = list(islice(rows, 2))
        if not ahead:
            raise TableError("the table of start values has no rows", span=Span(self._file))
        if only_one and len(ahead) > 1:
            raise TableError(
                "--follow: expected one row of start values, got more", span=Span(self._file), permitted="one row"
            )
        self.first = ahead[0]
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
            permitted="one row, or one row per pose",
        )
