"""One inverse kinematics problem, the input of every stage of the pipeline, and the options of its search."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from numbers import Real
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild import tolerances
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.names import axis_index
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.ik.region import freedoms_of
from chainbuild.kinematics.inputs import Pose, as_pose
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.shown import fields_shown
from chainbuild.units import Units

Held = Mapping[str, float] | Sequence[float]


@dataclass(frozen=True, slots=True, kw_only=True)
class IkOptions:
    """Options of the damped solver.

    Attributes:
        position_tolerance: Largest permitted distance between answer and pose [m].
        rotation_tolerance: Largest permitted angle between them [rad].
        weights: Six weights of the error in the tool frame: x, y, z [1/m], then about x, y, z [1/rad]. They decide
            what counts if a pose cannot be met exactly; 0 frees a direction. None, one (the direction of that axis
            remains) or all three of the rotations may be free.
        max_restarts: Number of starts after the first.
        seed: Seed of the starts.
        compiled: False: use the plain path even if the compiled one is installed.
        accuracy: (4,) derived: squared error [m², rad²] at which an iteration ends, three digits better than what is
            verified; the tolerances; permitted deviation of a matrix from a rotation.
    """

    __repr__ = fields_shown

    position_tolerance: float = tolerances.IK_POSITION_M
    rotation_tolerance: float = tolerances.IK_ROTATION_RAD
    weights: tuple[float, float, float, float, float, float] = (1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
    max_restarts: int = 100
    seed: int = 0
    compiled: bool = True
    accuracy: NDArray[np.float64] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        for name in ("position_tolerance", "rotation_tolerance"):
            if not (1e-12 <= getattr(self, name) <= 1.0):
                raise ChainbuildError(f"{name} is {getattr(self, name)}", parameter=name, permitted="1e-12 … 1")
        if len(self.weights) != 6 or not all(math.isfinite(w) and w >= 0.0 for w in self.weights):
            raise ChainbuildError("wrong weights", parameter="weights", permitted="six finite numbers, none negative")
        if sum(w == 0.0 for w in self.weights[3:]) == 2 or not any(self.weights):
            raise ChainbuildError(
                "the weights define no task",
                parameter="weights",
                permitted="none, one or three free rotations, and at least one weight above 0",
            )
        if self.max_restarts < 0:
            raise ChainbuildError("max_restarts is negative", parameter="max_restarts", permitted="0, 1, …")
        least = min(self.position_tolerance, self.rotation_tolerance)
        accuracy = ((1e-3 * least) ** 2, self.position_tolerance, self.rotation_tolerance, tolerances.ROTATION_MATRIX)
        object.__setattr__(self, "accuracy", np.array(accuracy))


DEFAULT = IkOptions()


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
    for name, value in held_by_name(mechanism, held).items():
        n = mechanism.labels.names.index(name)
        values[n], fixed[n] = _number(name, value), True
    if held is not None:
        values = mechanism.axis_values(values)
    return values * freedoms.si_factors, fixed


def held_by_name(mechanism: Mechanism, held: Held | None) -> dict[str, float]:
    """Return held values by the names of their axes.

    Args:
        mechanism: The mechanism.
        held: Axis name → value to hold, or one value for each input axis in order; None: none.

    Raises:
        AxisValueError: held has a wrong number of values, an unknown name, or names an axis twice.
    """
    told: dict[str, str] = {}
    values: dict[str, float] = {}
    for name, value in _by_name(mechanism, held).items():
        n = axis_index(mechanism.axes, name) if isinstance(name, str) else None
        if n is None:
            names = ", ".join(mechanism.labels.names)
            raise AxisValueError(f"there is no axis '{name}' to hold", parameter="held", permitted=names)
        axis = mechanism.labels.names[n]
        if axis in told:
            text = f"'{told[axis]}' and '{name}' are the same axis {axis}"
            raise AxisValueError(text, parameter="held", permitted="one of the two")
        values[axis], told[axis] = value, name
    return values


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
