"""Axis values on the command line: `--at 0,-90,90,0,0,0`, or a CSV table."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from chainbuild.cli.usage import UsageError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from chainbuild.robot import Robot

# Values with a leading minus sign are values, not options.
At = Annotated[tuple[str, ...], Parameter(negative="", show_default=False, allow_leading_hyphen=True)]


def values_of(robot: Robot, text: str) -> NDArray[np.float64]:
    """Return axis values (n_axes,) given as numbers separated by commas.

    Raises:
        UsageError: the text is not a list of numbers.
        AxisValueError: wrong number of values, or a value that is not finite.
    """
    try:
        numbers = [float(word) for word in text.split(",")]
    except ValueError:
        raise UsageError(f"--at {text}: expected numbers separated by commas, such as 0,-90,90") from None
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
