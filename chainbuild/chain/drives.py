"""Drives: what they stand at, from the axis values a controller shows, and their software limits.

On most machines a drive stands at its axis value; on some a gear, spatial angles or a virtual axis lie between the two.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.sums import AxisSum
from chainbuild.errors import ChainbuildError
from chainbuild.shown import fields_shown


class DriveMap(Protocol):
    """Drive values from axis values, both mm and degrees in channel order, one drive for each axis."""

    @property
    def follows(self) -> NDArray[np.bool_]:
        """(n_axes, n_axes) True where a drive (row) moves with an axis (column)."""
        ...

    @property
    def differing(self) -> tuple[int, ...]:
        """Indices of the drives that do not simply stand at their axis value."""
        ...

    @property
    def turning(self) -> tuple[int, ...]:
        """Indices of the drives that turn on and on with their own axis, also over whole turns."""
        ...

    @property
    def reach(self) -> Mapping[int, tuple[float, float]]:
        """Index of an axis → the values beyond which the drives have no place, whatever the other axes."""
        ...

    def drives(self, axes: Vector) -> Vector:
        """Return the drive values (n_axes,) of axis values (n_axes,), not a number where there are none."""
        ...

    def derivative(self, axes: Vector) -> Matrix:
        """Return the derivative (n_axes, n_axes), SI by SI: metres and radians on both sides."""
        ...

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return why there are no drive values at axis values (n_axes,), or None where there are."""
        ...


@runtime_checkable
class NamingDrives(Protocol):
    """Drives whose refusals name axes."""

    def named(self, names: Sequence[str]) -> DriveMap:
        """Return the drives that name the axes, in channel order, by other names."""
        ...


def named_drives(drives: DriveMap, names: Sequence[str]) -> DriveMap:
    """Return drives whose refusals name the axes by other names."""
    return drives.named(names) if isinstance(drives, NamingDrives) else drives


@dataclass(frozen=True, slots=True)
class DriveLimit:
    """Software limits and speed of a drive that does not stand at its axis value.

    Attributes:
        axis: Index of its axis.
        lower: Lower limit, mm or degrees; -inf where none is known.
        upper: Upper limit; inf where none is known.
        max_speed: mm/s or deg/s, where known.
    """

    __repr__ = fields_shown

    axis: int
    lower: float = -math.inf
    upper: float = math.inf
    max_speed: float | None = None

    @property
    def bounded(self) -> bool:
        """Whether it limits the drive's place, not its speed alone."""
        return math.isfinite(self.lower) or math.isfinite(self.upper)


@dataclass(frozen=True, slots=True, eq=False)
class AffineDrives:
    """drives = A·axes + b: gears, couplings and offsets between axes of one kind.

    Attributes:
        A: (n_axes, n_axes), mm by mm or degrees by degrees; it couples no linear axis with a rotary one.
        b: (n_axes,) mm and degrees.
    """

    __repr__ = fields_shown

    A: Matrix
    b: Vector

    @classmethod
    def shifted(cls, count: int, shifts: Mapping[int, float]) -> AffineDrives:
        """Return the map of drives that stand off their axis values by constants, by index of the axis."""
        return cls(np.eye(count), np.array([shifts.get(n, 0.0) for n in range(count)]))

    @property
    def follows(self) -> NDArray[np.bool_]:
        """(n_axes, n_axes) True where a drive moves with an axis."""
        follows: NDArray[np.bool_] = self.A != 0.0
        return follows

    @property
    def differing(self) -> tuple[int, ...]:
        """Indices of the drives that do not stand at their axis value."""
        unlike = (np.eye(len(self.b)) != self.A).any(axis=1) | (self.b != 0.0)
        return tuple(int(n) for n in np.flatnonzero(unlike))

    @property
    def turning(self) -> tuple[int, ...]:
        """Indices of the drives that turn on with their own axis."""
        return tuple(int(n) for n in np.flatnonzero(np.diag(self.A)))

    @property
    def reach(self) -> Mapping[int, tuple[float, float]]:
        """Nothing: every axis value has a drive value."""
        return {}

    def total(self, n: int) -> AxisSum:
        """Return drive n as a sum of axes."""
        return AxisSum(tuple(self.A[n].tolist()), float(self.b[n]))

    def drives(self, axes: Vector) -> Vector:
        """Return the drive values of axis values."""
        result: Vector = self.A @ axes + self.b
        return result

    def derivative(self, axes: Vector) -> Matrix:
        """Return A: the same everywhere, and in SI too, as it couples axes of one kind."""
        return self.A

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return None: every axis value has a drive value."""
        return None


@dataclass(frozen=True, slots=True, eq=False)
class DrivesSideBySide:
    """Drives of two chains that are composed: each follows its own axes.

    Attributes:
        first: Map of the first axes.
        second: Map of those behind them.
        count: Number of the first axes.
    """

    __repr__ = fields_shown

    first: DriveMap
    second: DriveMap
    count: int

    @property
    def follows(self) -> NDArray[np.bool_]:
        """(n_axes, n_axes) True where a drive moves with an axis."""
        follows: NDArray[np.bool_] = _diagonal(self.first.follows, self.second.follows) != 0.0
        return follows

    @property
    def differing(self) -> tuple[int, ...]:
        """Indices of the drives that do not stand at their axis value."""
        return (*self.first.differing, *(n + self.count for n in self.second.differing))

    @property
    def turning(self) -> tuple[int, ...]:
        """Indices of the drives that turn on with their own axis."""
        return (*self.first.turning, *(n + self.count for n in self.second.turning))

    @property
    def reach(self) -> Mapping[int, tuple[float, float]]:
        """Index of an axis → the values beyond which the drives have no place."""
        return {**self.first.reach, **{n + self.count: ends for n, ends in self.second.reach.items()}}

    def drives(self, axes: Vector) -> Vector:
        """Return the drive values of axis values."""
        n = self.count
        return np.concatenate([self.first.drives(axes[:n]), self.second.drives(axes[n:])])

    def derivative(self, axes: Vector) -> Matrix:
        """Return the derivative, SI by SI."""
        n = self.count
        return _diagonal(self.first.derivative(axes[:n]), self.second.derivative(axes[n:]))

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return why there are no drive values, or None."""
        return self.first.refusal(axes[: self.count]) or self.second.refusal(axes[self.count :])

    def named(self, names: Sequence[str]) -> DrivesSideBySide:
        """Return the drives that name the axes by other names."""
        first = named_drives(self.first, names[: self.count])
        second = named_drives(self.second, names[self.count :])
        return replace(self, first=first, second=second)


def _diagonal(first: Matrix | NDArray[np.bool_], second: Matrix | NDArray[np.bool_]) -> Matrix:
    """Return a block-diagonal matrix."""
    n, m = len(first), len(second)
    result: Matrix = np.zeros((n + m, n + m))
    result[:n, :n], result[n:, n:] = first, second
    return result


def joined_drives(first: DriveMap | None, count: int, second: DriveMap | None, more: int) -> DriveMap | None:
    """Return the drives of two chains as one map; None where all stand at their axis values.

    Args:
        first: Of the chain whose axes come first.
        count: Number of its axes.
        second: Of the other chain.
        more: Number of its axes.
    """
    if first is None and second is None:
        return None
    one = first or AffineDrives.shifted(count, {})
    other = second or AffineDrives.shifted(more, {})
    if isinstance(one, AffineDrives) and isinstance(other, AffineDrives):
        return AffineDrives(_diagonal(one.A, other.A), np.concatenate([one.b, other.b]))
    return DrivesSideBySide(one, other, count)


def drive_values(drives: DriveMap | None, axes: Vector) -> Vector:
    """Return the drive values (n_axes,) of axis values (n_axes,), mm and degrees.

    Raises:
        ChainbuildError: the drives have no place there.
    """
    if drives is None:
        return axes.copy()
    values = drives.drives(axes)
    if not np.isfinite(values).all():
        unnamed = ChainbuildError("the drives have no values at these axis values")
        raise drives.refusal(axes) or unnamed
    return values
