"""One inverse kinematics problem: the input of every stage of the pipeline."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.names import axis_index
from chainbuild.errors import AxisValueError
from chainbuild.ik.options import DEFAULT, IkOptions
from chainbuild.ik.region import freedoms_of
from chainbuild.kinematics.inputs import Pose, as_pose
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.units import Units

Held = Mapping[str, float] | Sequence[float]


class IkRequest(NamedTuple):
    """One inverse kinematics problem; a named tuple, since one is made per call and dataclasses take longer.

    Attributes:
        mechanism: Whose axis values.
        target: (4, 4) tool in the workpiece frame [m]; the solver checks whether it is rigid.
        start: (n_axes,) axis values to start from, mm and degrees, or None.
        held: Axis name → value to hold, or one value for each input axis in order, or None.
        options: Options of the damped search.
    """

    mechanism: Mechanism
    target: Matrix
    start: Vector | None = None
    held: Held | None = None
    options: IkOptions = DEFAULT

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        T: Pose | ArrayLike,
        start: ArrayLike | None = None,
        held: Held | None = None,
        options: IkOptions | None = None,
    ) -> IkRequest:
        """Return a request from the arguments of `Robot.ik`.

        Raises:
            AxisValueError: start has a wrong number of values or a non-finite value.
            ChainbuildError: T is not 4×4 real numbers.
        """
        begin = None if start is None else mechanism.axis_values(start)
        return cls(mechanism, matrix_of(T), begin, held, options or DEFAULT)

    def to(self, target: Matrix, start: Vector | None) -> IkRequest:
        """Return the same problem with another target (4, 4) and start (n_axes,)."""
        return self._replace(target=target, start=start)

    @property
    def pose(self) -> Pose:
        """The target as a pose.

        Raises:
            ChainbuildError: it is not a rigid transform.
        """
        return as_pose(self.target)

    def start_point(self) -> tuple[Vector, NDArray[np.bool_]]:
        """Return the SI start values (n_axes,) and which axes are held at them; see `start_point`."""
        return start_point(self.mechanism, self.start, self.held)


def matrix_of(target: Pose | ArrayLike) -> Matrix:
    """Return a pose as a (4, 4) array; the search checks whether it is rigid.

    Raises:
        ChainbuildError: not 4×4 real numbers.
    """
    T = getattr(target, "homogeneous", target)
    if type(T) is np.ndarray and T.dtype == np.float64 and T.shape == (4, 4):
        return np.ascontiguousarray(T)
    matrix: Matrix = np.ascontiguousarray(as_pose(target).homogeneous)
    return matrix


def start_point(mechanism: Mechanism, start: ArrayLike | None, held: Held | None) -> tuple[Vector, NDArray[np.bool_]]:
    """Return the SI start values (n_axes,) and which axes are held at them.

    Args:
        mechanism: The mechanism.
        start: Axis values (n_axes,), mm and degrees; None: near the middle of the limits, input axes at 0.
        held: Axis name → value to hold, or one value for each input axis in order.

    Raises:
        AxisValueError: start or held has a wrong number of values, an unknown name or a non-finite value.
    """
    freedoms = freedoms_of(mechanism)
    fixed = np.array([axis.held for axis in mechanism.axes])
    if start is None:
        values = freedoms.middle / freedoms.si_factors
        values[fixed] = 0.0
    else:
        values = mechanism.axis_values(start).copy()
    told: dict[int, str] = {}
    for name, value in _by_name(mechanism, held).items():
        n = axis_index(mechanism.axes, name) if isinstance(name, str) else None
        if n is None:
            names = ", ".join(mechanism.labels.names)
            raise AxisValueError(f"there is no axis '{name}' to hold", parameter="held", permitted=names)
        if n in told:
            text = f"'{told[n]}' and '{name}' are the same axis {mechanism.axes[n].name}"
            raise AxisValueError(text, parameter="held", permitted="one of the two")
        values[n], fixed[n], told[n] = _number(name, value), True, name
    if held is not None:
        values = mechanism.axis_values(values)
    return values * freedoms.si_factors, fixed


def in_controller_units(
    mechanism: Mechanism, start: ArrayLike | None, held: Held | None, units: Units
) -> tuple[ArrayLike | None, Held | None]:
    """Return start and held in mm and degrees; what is wrong with them is said where they are used.

    Args:
        mechanism: Whose axis values.
        start: Axis values (…, n_axes), or None.
        held: Axis name → value, or one value for each input axis in order, or None.
        units: Theirs.

    Raises:
        ChainbuildError: there are no such units.
    """
    factors = [float(factor) for factor in mechanism.labels.to(units).factors]
    begin = None if start is None else mechanism.controller_values(start, units)
    if isinstance(held, Mapping):
        places = {name: axis_index(mechanism.axes, name) if isinstance(name, str) else None for name in held}
        return begin, {
            name: value if (n := places[name]) is None else _divided(value, factors[n]) for name, value in held.items()
        }
    if isinstance(held, Sequence | np.ndarray) and not isinstance(held, str | bytes):
        own = [factor for axis, factor in zip(mechanism.axes, factors, strict=True) if axis.held]
        if len(held) == len(own):
            return begin, [_divided(value, factor) for value, factor in zip(held, own, strict=True)]
    return begin, held


def _divided(value: Any, factor: float) -> Any:
    if not isinstance(value, Real):
        return value
    try:
        return float(value) / factor
    except OverflowError:
        return math.inf


def _by_name(mechanism: Mechanism, held: Held | None) -> Mapping[str, float]:
    if held is None:
        return {}
    if isinstance(held, Mapping):
        return held
    names = [axis.name for axis in mechanism.axes if axis.held]
    permitted = ", ".join(names) or "a mapping of axis name to value"
    if not isinstance(held, Sequence | np.ndarray) or isinstance(held, str | bytes):
        text = "held must be a mapping of axis name to value or a sequence of numbers"
        raise AxisValueError(text, parameter="held", permitted=permitted)
    if len(held) != len(names):
        raise AxisValueError(
            f"expected {len(names)} held values, one for each input axis, got {len(held)}",
            parameter="held",
            permitted=permitted,
        )
    return dict(zip(names, held, strict=True))


def _number(name: str, value: object) -> float:
    """Return a held value as a number; finiteness is checked later."""
    if not isinstance(value, Real):
        text = f"axis {name} is held at {value!r}"
        raise AxisValueError(text, parameter="held", permitted="a number in mm or degrees")
    try:
        return float(value)
    except OverflowError:
        return math.inf
