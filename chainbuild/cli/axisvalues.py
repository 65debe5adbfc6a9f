"""Axis values on the command line: `--at 0,-90,90,0,0,0`, `--at park`, or a CSV table."""

from __future__ import annotations

import re
from itertools import chain, islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

from cyclopts import Parameter

from chainbuild.cli.usage import TABLES, UsageError
from chainbuild.errors import AxisValueError, Span, TableError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from chainbuild.robot import Robot
    from chainbuild.tables import AxisTable

# Values with a leading minus sign are values, not options.
At = Annotated[tuple[str, ...], Parameter(negative="", show_default=False, allow_leading_hyphen=True)]

_UNIT: Final = re.compile(r"\d *(mm|m|deg|°|rad|in)\b|°", re.IGNORECASE)


def values_of(robot: Robot, text: str) -> NDArray[np.float64]:
    """Return axis values (n_axes,) given as numbers separated by commas, or as the name of a pose of the overlay.

    Blanks separate numbers, too, and semicolons, between which a comma is a decimal comma; brackets may surround them.

    Raises:
        UsageError: the text is neither.
        AxisValueError: wrong number of values, or a value that is not finite.
    """
    from chainbuild.chain.names import pose_named

    named = pose_named(robot.chain, text)
    if named is not None:
        return named
    try:
        numbers = _numbers(text)
    except ValueError:
        known = ", ".join(pose.name for pose in robot.chain.named_poses)
        or_named = f", or a named pose: {known}" if known else ""
        expected = f"expected numbers separated by commas, such as 0,-90,90{or_named}"
        raise UsageError(f"--at {text}: {expected}{_advice(robot, text)}") from None
    try:
        return robot.axis_values(numbers)
    except AxisValueError as error:
        if len(numbers) == 2 * len(robot.axes):
            error.hint = "a decimal is written with a point"
        raise


def _numbers(text: str) -> list[float]:
    """Return the numbers of a text.

    Raises:
        ValueError: it holds something else.
    """
    bare = text.strip().strip("[]()").replace("\N{MINUS SIGN}", "-")
    if ";" in bare:
        return [float(word.replace(",", ".")) for word in bare.split(";")]
    return [float(word) for word in (bare.split(",") if "," in bare else bare.split())]


def _advice(robot: Robot, text: str) -> str:
    """Return what would help whoever wrote a text that is no list of numbers; empty: nothing more is known."""
    if Path(text).suffix.lower() in TABLES or Path(text).is_file():
        return f"; a table is given with --axes {text}"
    if "=" in text or ":" in text:
        return f"; without names, in the order {', '.join(axis.name for axis in robot.axes)}"
    if _UNIT.search(text):
        return "; without units: linear axes are in mm, rotary ones in degrees"
    if len(text.split()) > 1 and "," in text:
        return "; a decimal is written with a point"
    return ""


def given_rows(robot: Robot, at: tuple[str, ...], axes: Path | None) -> NDArray[np.float64]:
    """Return the axis values (N, n_axes) of --at, then those of the table.

    Raises:
        TableError: the table has no rows.
    """
    import numpy as np

    from chainbuild.tables import AxisTable

    rows = [values_of(robot, text) for text in at]
    if axes is not None:
        with AxisTable(axes, robot.axes) as table:
            found = [values for _, values in table.rows()]
        if not found:
            raise TableError("the table has no rows", span=Span(str(axes)))
        rows += found
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
