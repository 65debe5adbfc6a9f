"""Input of a robot: axis values and poses as checked arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final, TypeAlias

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from chainbuild import tolerances
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.elements import Axis
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.frames import is_rigid

Pose: TypeAlias = pin.SE3  # what the other rooms call it, which import no Pinocchio
_IDENTITY: Final = np.eye(3)  # RᵀR of a rotation
_HUGE: Final = tolerances.HUGE_AXIS_VALUE**2  # as the sum of squares of axis values


def axis_vector(axes: Sequence[Axis], given: ArrayLike) -> Vector:
    """Return axis values as a checked float array (n_axes,), mm and degrees.

    Raises:
        AxisValueError: wrong count, not numbers, NaN, inf or absurdly large.
    """
    values = real_numbers(given)
    if values is None:
        raise AxisValueError("axis values must be real numbers", permitted=_names(axes))
    if values.shape != (len(axes),):
        got = len(values) if values.ndim == 1 else f"an array of shape {values.shape}"
        message = f"expected {len(axes)} axis values, got {got}"
        raise AxisValueError(message, permitted=_names(axes))
    if values.dot(values) < _HUGE:  # then each of them is small, and none is not a number
        return values
    for axis, value in zip(axes, values.tolist(), strict=True):
        if not -tolerances.HUGE_AXIS_VALUE < value < tolerances.HUGE_AXIS_VALUE:
            raise AxisValueError(
                f"axis {axis.name} has the value {value}",
                parameter=axis.name,
                permitted=f"finite numbers below {tolerances.HUGE_AXIS_VALUE:.0e}",
            )
    return values


def _names(axes: Sequence[Axis]) -> str:
    return ", ".join(axis.name for axis in axes)


def axis_rows(axes: Sequence[Axis], given: ArrayLike) -> Matrix:
    """Return rows of axis values as a checked float array (N, n_axes), mm and degrees.

    Raises:
        AxisValueError: wrong shape, not numbers, NaN, inf or absurdly large.
    """
    values = real_numbers(given)
    if values is None or values.ndim != 2 or values.shape[1] != len(axes):
        what = "values that are not real numbers" if values is None else f"an array of shape {values.shape}"
        raise AxisValueError(f"expected rows of axis values, got {what}", permitted=f"shape (N, {len(axes)})")
    kept = (np.abs(values) < tolerances.HUGE_AXIS_VALUE).all(axis=1)
    if not kept.all():
        axis_vector(axes, values[int(np.argmin(kept))])
    return values


def as_pose(T: pin.SE3 | ArrayLike) -> pin.SE3:
    """Return a pose as `pin.SE3`.

    Raises:
        ChainbuildError: not a rigid 4×4 transform of finite numbers.
    """
    matrix = T.homogeneous if isinstance(T, pin.SE3) else real_numbers(T)
    if matrix is None:
        raise ChainbuildError("a pose must be pin.SE3 or a 4×4 array of numbers")
    if matrix.shape != (4, 4) or not is_rigid(matrix):
        raise ChainbuildError(
            "a pose must be a rigid 4×4 transform: finite, with a right-handed rotation and the last row 0 0 0 1",
            permitted=f"positions below {tolerances.HUGE_POSITION_M:.0e} m",
        )
    square = matrix[:3, :3].T @ matrix[:3, :3]
    if np.abs(square - _IDENTITY).max() > tolerances.EXACT_ROTATION:
        # Of few digits, as in 32 bits: the nearest rotation is meant.
        matrix = matrix.copy()
        matrix[:3, :3] = matrix[:3, :3] @ (1.5 * _IDENTITY - 0.5 * square)  # Newton's step squares what it is off by
    return pin.SE3(np.ascontiguousarray(matrix))


def real_numbers(values: ArrayLike) -> Vector | None:
    """Return real numbers as a float array, or None for anything else (masked, complex, dates, text)."""
    if type(values) is np.ndarray and values.dtype == np.float64:  # most calls, in a third of the time
        return values.copy()
    if isinstance(values, np.ma.MaskedArray):
        return None
    try:
        raw = np.asarray(values)
        return raw.astype(float) if raw.dtype.kind in "biufO" else None
    except (TypeError, ValueError, OverflowError):
        return None
