"""Axis maps: from the axis values a controller shows to joint values and back."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.errors import ChainbuildError, ChainError
from chainbuild.files import number_text
from chainbuild.shown import fields_shown
from chainbuild.units import AxisKind, si_factor

_DRAWS: Final = 400  # for one closed state: of a small tripod a hundredth of the draws closes


class AxisMap(Protocol):
    """Joint values from axis values and back.

    Axis values are mm and degrees in channel order; joint values SI in the order of the chain's joints.
    """

    def q(self, axes: Vector) -> Vector:
        """Return the joint values (n_q,) of axis values (n_axes,)."""
        ...

    def axes(self, q: Vector) -> Vector:
        """Return the axis values (n_axes,) of joint values (n_q,)."""
        ...

    def dq_daxes(self, axes: Vector) -> Matrix:
        """Return the derivative (n_q, n_axes), SI by SI: metres and radians on both sides."""
        ...

    def q_bounds(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector]:
        """Return bounds of the joint values over the box of axis values given in mm and degrees."""
        ...


@runtime_checkable
class PartialMap(Protocol):
    """An axis map that has no joint values (NaN) at some axis values and can give the reason."""

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return why there are no joint values at axis values (n_axes,), or None where there are."""
        ...


def refusal_of(axis_map: AxisMap, axes: Vector) -> ChainbuildError | None:
    """Return why a map has no joint values at axis values (n_axes,), or None where it gives no reason."""
    return axis_map.refusal(axes) if isinstance(axis_map, PartialMap) else None


@runtime_checkable
class NamingMap(Protocol):
    """An axis map whose refusals name axes."""

    def named(self, names: Sequence[str]) -> AxisMap:
        """Return the map that names its axes, in channel order, by other names."""
        ...


def named_map(axis_map: AxisMap, names: Sequence[str]) -> AxisMap:
    """Return a map whose refusals name the axes by other names."""
    return axis_map.named(names) if isinstance(axis_map, NamingMap) else axis_map


@runtime_checkable
class TurningMap(Protocol):
    """An axis map that is not affine and knows which whole turns lead to the same pose."""

    @property
    def periodic(self) -> tuple[int, ...]:
        """Indices of the axes whose whole turn leads to the same pose."""
        ...


@dataclass(frozen=True, slots=True)
class Formulas:
    """A nonlinear axis map written down: expressions of sin, cos, asin, atan2, min, max, round, copysign, pi.

    Attributes:
        steps: Names and expressions, each of axis values (SI) and of the steps before.
        joints: An expression for each joint value (SI); empty: closing the loops gives it.
    """

    steps: tuple[tuple[str, str], ...]
    joints: tuple[str, ...]


@runtime_checkable
class FormulaMap(Protocol):
    """A nonlinear axis map that can be written down, for readers of files without this library."""

    def formulas(self, symbols: Sequence[str]) -> Formulas | None:
        """Return its formulas, the axes (SI) called by symbols; None where there are none."""
        ...


@runtime_checkable
class ClosingMap(Protocol):
    """An axis map of closed loops that tells every axis value that closes them."""

    def closing(self, q: Vector) -> list[list[float]]:
        """Return for each axis its values, mm and degrees, that close the loops at the joint values between the tips.

        Args:
            q: (n_q,) joint values; only those between the tips count. The loops of each axis close by themselves;
                whether all together close in the assembly mode is left to `q`.
        """
        ...

    def rank(self, axes: Vector) -> int:
        """Return how far axis values are from the branch that is taken without a start: 0 is that one."""
        ...

    def unreached(self, q: Vector) -> str:
        """Return which rod does not reach the joint values between the tips, and by how much; empty: all do."""
        ...


@runtime_checkable
class PosedMap(Protocol):
    """A closing map whose joints between the tips do not move freely: it tells their values by itself."""

    def posed(self, target: Matrix, tool: Matrix, workpiece: Matrix) -> Vector:
        """Return joint values (n_q,) at which those between the tips bring the tool to a pose, as far as they can.

        Args:
            target: (4, 4) tool in the workpiece frame [m].
            tool: (4, 4) the tool's frame on the link that carries it [m].
            workpiece: (4, 4) the workpiece frame on its link [m].
        """
        ...


@runtime_checkable
class SamplingMap(Protocol):
    """An axis map of closed loops that knows where they close."""

    def drawn_axes(self, rng: np.random.Generator, lower: Vector, upper: Vector) -> Vector | None:
        """Return random axis values (n_axes,) that are likely to close inside limits, or None: draw again."""
        ...


def random_axis_values(
    axis_map: AxisMap, rng: np.random.Generator, lower: Vector, upper: Vector, count: int = 1
) -> Matrix:
    """Return axis values (count, n_axes) drawn from a box; where loops must close, from where they do.

    Values of a map that knows where it closes are inside the box, too, unless hardly anything in it closes.
    """
    if not isinstance(axis_map, SamplingMap):
        values: Matrix = lower + (upper - lower) * rng.random((count, len(lower)))
        return values
    rows = []
    for _ in range(count):
        drawn = (axis_map.drawn_axes(rng, lower, upper) for _ in range(_DRAWS))
        closing = (row for row in drawn if row is not None and ((row >= lower) & (row <= upper)).all())
        rows.append(next(closing, lower + (upper - lower) * rng.random(len(lower))))
    return np.array(rows).reshape(-1, len(lower))


def periodic_of(axis_map: AxisMap) -> tuple[int, ...]:
    """Return the indices of the axes whose whole turn leads to the same pose, as far as the map tells."""
    return axis_map.periodic if isinstance(axis_map, TurningMap) else ()


@dataclass(frozen=True, slots=True, eq=False)
class AffineMap:
    """q = A·(axes in SI) + b: sign, zero offset, unit, gear and absolute-angle coupling in one matrix.

    Attributes:
        A: (n_q, n_axes), SI by SI.
        b: (n_q,), SI.
        si_factors: (n_axes,) factors from axis values to SI.
        back: (n_axes, n_q) left inverse of A.
    """

    __repr__ = fields_shown

    A: Matrix
    b: Vector
    si_factors: Vector
    back: Matrix

    @classmethod
    def of(cls, A: Matrix, b: Vector, kinds: Sequence[AxisKind]) -> AffineMap:
        """Build the map of a coupling matrix.

        Args:
            A: (n_q, n_axes), SI by SI.
            b: (n_q,), SI.
            kinds: "linear" or "rotary" for each axis.

        Raises:
            ChainError: two different sets of axis values give the same joint values.
        """
        if np.linalg.matrix_rank(A) < A.shape[1]:
            raise ChainError("the axis map is singular: different axis values would give the same joint values")
        back = np.linalg.inv(A) if A.shape[0] == A.shape[1] else np.linalg.pinv(A)
        factors = np.array([si_factor(kind) for kind in kinds])
        return cls(A, b, factors, back.astype(np.float64))

    def q(self, axes: Vector) -> Vector:
        """Return the joint values of axis values."""
        result: Vector = self.A @ (axes * self.si_factors) + self.b
        return result

    def q_rows(self, rows: Matrix) -> Matrix:
        """Return the joint values (N, n_q) of rows of axis values (N, n_axes)."""
        result: Matrix = rows @ (self.A * self.si_factors).T + self.b
        return result

    def sums(self, symbols: Sequence[str]) -> tuple[str, ...]:
        """Return each joint value (SI) as a sum, the axes (SI) called by symbols."""
        rows = zip(self.A.tolist(), self.b.tolist(), strict=True)
        return tuple(_sum(zip(symbols, factors, strict=True), offset) for factors, offset in rows)

    def axes(self, q: Vector) -> Vector:
        """Return the axis values of joint values."""
        result: Vector = (self.back @ (q - self.b)) / self.si_factors
        return result

    def dq_daxes(self, axes: Vector) -> Matrix:
        """Return A: the same everywhere."""
        return self.A

    def q_bounds(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector]:
        """Return the joint bounds by interval arithmetic; exact, because the map is affine."""
        low, high = lower * self.si_factors, upper * self.si_factors
        positive, negative = np.maximum(self.A, 0.0), np.minimum(self.A, 0.0)
        return positive @ low + negative @ high + self.b, positive @ high + negative @ low + self.b


def _sum(terms: Iterable[tuple[str, float]], offset: float) -> str:
    parts = [name if factor == 1.0 else f"{number_text(factor)}*{name}" for name, factor in terms if factor != 0.0]
    if offset != 0.0 or not parts:
        parts.append(number_text(offset))
    return " + ".join(parts)


def joint_values(axis_map: AxisMap, axes: Vector) -> Vector:
    """Return the joint values (n_q,) of axis values (n_axes,), mm and degrees.

    Raises:
        ChainbuildError: the map has none there; its own error where it knows the reason.
    """
    q = axis_map.q(axes)
    if not isinstance(axis_map, AffineMap) and not np.isfinite(q).all():
        unnamed = ChainbuildError("the kinematic has no joint values at these axis values")
        raise refusal_of(axis_map, axes) or unnamed
    return q


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """One map of a `BlockMap`.

    Attributes:
        axis_map: The map.
        axes: Which axes it takes.
        joints: Place of each of its joints among all joints.
    """

    __repr__ = fields_shown

    axis_map: AxisMap
    axes: slice
    joints: NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class BlockMap:
    """Maps side by side: each takes its own axes and drives its own joints.

    Attributes:
        blocks: The maps.
        shape: (n_q, n_axes).
    """

    __repr__ = fields_shown

    blocks: tuple[Block, ...]
    shape: tuple[int, int]

    def q(self, axes: Vector) -> Vector:
        """Return the joint values of axis values."""
        q = np.empty(self.shape[0])
        for block in self.blocks:
            q[block.joints] = block.axis_map.q(axes[block.axes])
        return q

    def axes(self, q: Vector) -> Vector:
        """Return the axis values of joint values."""
        axes = np.empty(self.shape[1])
        for block in self.blocks:
            axes[block.axes] = block.axis_map.axes(q[block.joints])
        return axes

    def dq_daxes(self, axes: Vector) -> Matrix:
        """Return the derivative, SI by SI."""
        result = np.zeros(self.shape)
        for block in self.blocks:
            result[block.joints, block.axes] = block.axis_map.dq_daxes(axes[block.axes])
        return result

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return why one of the maps has no joint values, or None."""
        found = (refusal_of(block.axis_map, axes[block.axes]) for block in self.blocks)
        return next((error for error in found if error is not None), None)

    def named(self, names: Sequence[str]) -> BlockMap:
        """Return the maps that name their axes by other names."""
        blocks = (replace(block, axis_map=named_map(block.axis_map, names[block.axes])) for block in self.blocks)
        return replace(self, blocks=tuple(blocks))

    def q_bounds(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector]:
        """Return the joint bounds over the box of axis values."""
        low, high = np.empty(self.shape[0]), np.empty(self.shape[0])
        for block in self.blocks:
            low[block.joints], high[block.joints] = block.axis_map.q_bounds(lower[block.axes], upper[block.axes])
        return low, high


def side_by_side(blocks: Sequence[Block], shape: tuple[int, int]) -> AxisMap:
    """Return the maps of a composed chain as one: affine where all of them are."""
    if not all(isinstance(block.axis_map, AffineMap) for block in blocks):
        return BlockMap(tuple(blocks), shape)
    A, b, back = np.zeros(shape), np.zeros(shape[0]), np.zeros(shape[::-1])
    si_factors = np.ones(shape[1])
    for block in blocks:
        assert isinstance(block.axis_map, AffineMap)
        A[block.joints, block.axes] = block.axis_map.A
        b[block.joints] = block.axis_map.b
        si_factors[block.axes] = block.axis_map.si_factors
        back[block.axes, block.joints] = block.axis_map.back
    return AffineMap(A, b, si_factors, back)
