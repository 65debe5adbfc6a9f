"""Where a search starts, and which axes it leaves alone."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild.errors import AxisValueError
from chainbuild.ik.limits import freedoms_of

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Robot

Vector = NDArray[np.float64]
Held = Mapping[str, float] | Sequence[float]


def start_point(robot: Robot, start: ArrayLike | None, held: Held | None) -> tuple[Vector, NDArray[np.bool_]]:
    """Return the SI start values (n_axes,) and which axes are held at them.

    Args:
        robot: The robot.
        start: Axis values (n_axes,), mm and degrees; None: near the middle of the limits, input axes at 0.
        held: Axis name → value to hold, or one value for each input axis in order.

    Raises:
        AxisValueError: start or held of wrong count, unknown name or not finite.
    """
    freedoms = freedoms_of(robot)
    fixed = np.array([axis.held for axis in robot.axes])
    if start is None:
        values = freedoms.middle / freedoms.si_factors
        values[fixed] = 0.0
    else:
        values = robot.axis_values(start).copy()
    names = [axis.name for axis in robot.axes]
    for name, value in _by_name(robot, held).items():
        if name not in names:
            raise AxisValueError(f"there is no axis '{name}' to hold", parameter="held", permitted=", ".join(names))
        values[names.index(name)], fixed[names.index(name)] = _number(name, value), True
    return robot.axis_values(values) * freedoms.si_factors, fixed


def _by_name(robot: Robot, held: Held | None) -> Mapping[str, float]:
    if held is None:
        return {}
    if isinstance(held, Mapping):
        return held
    names = [axis.name for axis in robot.axes if axis.held]
    permitted = ", ".join(names) or "a mapping of axis name to value"
    if not isinstance(held, Sequence | np.ndarray) or isinstance(held, str | bytes):
        text = "held is neither a mapping nor a sequence of numbers"
        raise AxisValueError(text, parameter="held", permitted=permitted)
    if len(held) != len(names):
        raise AxisValueError(
            f"{len(held)} held values are given, the robot has {len(names)} input axes",
            parameter="held",
            permitted=permitted,
        )
    return dict(zip(names, held, strict=True))


def _number(name: str, value: object) -> float:
    """Return a held value; whether it is finite is looked at with the others."""
    if not isinstance(value, Real):
        text = f"axis {name} is held at {value!r}"
        raise AxisValueError(text, parameter="held", permitted="a number in mm or degrees")
    try:
        return float(value)
    except OverflowError:
        return math.inf
