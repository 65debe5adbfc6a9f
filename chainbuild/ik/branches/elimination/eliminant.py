"""Six bilinear equations in two joints whose coefficients depend on a third: all common solutions, as eigenvalues.

With x, y, h standing for exp(i·q) of a rotary joint (for q of a slide), the equations are sums of hᵃ·xᵇ·yᶜ with a, b, c
from 0 to 2. Multiplied by x they are twelve equations in the twelve products 1…x³ × 1…y²: for a solution the matrix
of their coefficients, quadratic in h, must be singular. That is an eigenvalue problem of size 24 and includes every
solution. For the values of h that are real joints, x and y are read from the kernel of the matrix.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Complex, Vector
from chainbuild.chain.elements import JointKind
from chainbuild.ik.branches.core.roots import NEARLY_REAL

Kinds = tuple[JointKind, JointKind, JointKind]
_Triple = tuple[float, float, float]

SINGULAR: Final = 1e12  # condition above which the equations do not separate solutions
# Singular values below such a share of the largest belong to the kernel: where solutions nearly coincide, one threshold
# merges two of them, another separates them.
_KERNELS: Final = (1e-8, 1e-6, 1e-4)
_MAX_NULLITY: Final = 6  # of a kernel: as many solutions with one value of the joint are told apart
_AT_INFINITY: Final = 1e-7  # singular values below this share of the largest belong to solutions without finite x or y
_MAX_DISTANCE: Final = 1e6  # linear joints beyond this many arm lengths count as infinite
_MIX: Final = 0.7317  # an arbitrary weight: separates solutions that share x
_EXACT: Final = 1e-8  # share of the equations' size: what misses them by less is read with many digits
_ALIKE: Final = 5e-7  # half the difference of such that are one; of arms nearly at a form two may be as near as 1e-3
_LOOKED_FROM: Final = (0.3, 1.5, 2.7, -0.9, -2.1)  # angles of the views, of which the best conditioned is taken


@dataclass(frozen=True, slots=True, eq=False)
class Eliminant:
    """Six equations.

    Attributes:
        blocks: (3, 6, 3, 3) coefficients: power of h, equation, power of x, power of y.
        kinds: Kinds of the joints h, x, y.
        view: Möbius map (a, b, c, e) that leads from a real number w to h = (a·w + b)/(c·w + e).
        condition: Of the eigenvalue problem; above SINGULAR its solutions are meaningless.
        quadratic: (3, 12, 12) coefficients of the powers of w.
    """

    blocks: Complex
    kinds: Kinds
    view: tuple[complex, complex, complex, complex]
    condition: float
    quadratic: Complex

    @classmethod
    def of(cls, blocks: Complex, kinds: Kinds) -> Eliminant:
        """Return the equations as seen from where they are conditioned best."""
        whole = np.stack([_multiplied(block, once=True) for block in blocks])
        views = [_view(kinds[0], angle) for angle in _LOOKED_FROM]
        leading = np.stack([c * c * whole[0] + a * c * whole[1] + a * a * whole[2] for a, _, c, _ in views])
        sizes = np.linalg.svd(leading, compute_uv=False)
        conditions = sizes[:, 0] / np.maximum(sizes[:, -1], 1e-300)
        best = int(np.argmin(conditions))
        a, b, c, e = views[best]
        middle = 2.0 * c * e * whole[0] + (a * e + b * c) * whole[1] + 2.0 * a * b * whole[2]
        lowest = e * e * whole[0] + b * e * whole[1] + b * b * whole[2]
        quadratic = np.stack([lowest, middle, leading[best]])
        return cls(blocks, kinds, views[best], float(conditions[best]), quadratic)

    def solutions(self, near: float = NEARLY_REAL) -> tuple[list[_Triple], bool]:
        """Return the real joint values (h, x, y), some of them perhaps twice, and whether these are all.

        They may be incomplete where several solutions share h and others tend to infinity.

        Args:
            near: How far beside the real numbers a solution may lie; its real part is returned.
        """
        readings: list[tuple[float, _Triple]] = []
        settled, hidden = True, self._hidden_values(near)
        values = {h: value for h in hidden if (value := _joint_value(h, self.kinds[0], near)) is not None}
        powers = np.array([(1.0, h, h * h) for h in values]).reshape(-1, 3)
        matrices = np.tensordot(powers, self.blocks, 1)
        whole = np.array([_multiplied(matrix, once=False) for matrix in matrices]).reshape(-1, 24, 16)
        _, every_size, every_row = np.linalg.svd(whole, full_matrices=False)
        for value, matrix, sizes, rows in zip(values.values(), matrices, every_size, every_row, strict=True):
            pairs, apart = _kernel_pairs(sizes, rows)
            settled = settled and apart
            for x, y in pairs:
                first, second = _joint_value(x, self.kinds[1], near), _joint_value(y, self.kinds[2], near)
                if first is not None and second is not None:
                    left = np.abs(matrix @ (1.0, y, y * y) @ (1.0, x, x * x)).max()
                    readings.append((float(left / np.abs(matrix).max()), (value, first, second)))
        if settled and near == NEARLY_REAL:
            exact = self._exact(readings)
            if len(exact) >= len(hidden):  # else some are read with few digits only: Newton's steps sort them out
                return exact, settled
        return [solution for _, solution in readings], settled

    def _exact(self, readings: list[tuple[float, _Triple]]) -> list[_Triple]:
        """Return the solutions that are read with many digits, once each."""
        turns = np.array([kind == "revolute" for kind in self.kinds])
        kept: list[_Triple] = []
        for miss, solution in sorted(readings):
            if miss < _EXACT and not is_among(np.array(solution), kept, turns, _ALIKE):
                kept.append(solution)
        return kept

    def _hidden_values(self, near: float) -> list[complex]:
        """Return the values of h that a real joint has, but for rounding."""
        half = self.quadratic.shape[1]
        companion = np.zeros((2 * half, 2 * half), dtype=complex)
        companion[:half, half:] = np.eye(half)
        companion[half:] = -np.linalg.solve(self.quadratic[2], np.concatenate([*self.quadratic[:2]], axis=1))
        a, b, c, e = self.view
        values = []
        for w in np.linalg.eigvals(companion):
            if abs(w.imag) < near * (1.0 + abs(w) ** 2):
                h = (a * w.real + b, c * w.real + e)
                if abs(h[0]) < _MAX_DISTANCE * abs(h[1]):
                    values.append(complex(h[0] / h[1]))
        return values


def is_among(values: Vector, others: Sequence[Sequence[float] | Vector], turns: NDArray[np.bool_], half: float) -> bool:
    """Return whether one of some sets of values is the same but for whole turns.

    Args:
        values: (n,) joint values.
        others: (k, n) the others.
        turns: (n,) which of the joints are rotary.
        half: What half the difference is less than [rad], of slides the whole one [arm lengths].
    """
    off = np.reshape(np.array(others), (-1, len(turns))) - values
    return bool((np.abs(np.where(turns, np.sin(off / 2.0), off)).max(axis=1) < half).any())


def _view(kind: JointKind, angle: float) -> tuple[complex, complex, complex, complex]:
    """Return a map of the real line onto the real joint values: onto the unit circle, or onto itself."""
    if kind == "prismatic":
        cos, sin = math.cos(angle), math.sin(angle)
        return cos, sin, -sin, cos
    turn = cmath.exp(1j * angle)
    return 1j * turn, turn, -1j, 1.0


def _multiplied(block: Complex, *, once: bool) -> Complex:
    """Return equations (6, 3, 3) times 1 and x (12, 12), or times 1, x, y and x·y (24, 16)."""
    count, width = len(block), 3 if once else 4
    rows = []
    for n, m in ((0, 0), (1, 0)) if once else ((0, 0), (1, 0), (0, 1), (1, 1)):
        row = np.zeros((count, 4, width), dtype=complex)
        row[:, n : n + 3, m : m + 3] = block
        rows.append(row.reshape(count, -1))
    return np.concatenate(rows)


def _kernel_pairs(sizes: Vector, rows: Complex) -> tuple[list[tuple[complex, complex]], bool]:
    """Return the pairs (x, y) whose products lie in the kernel of a matrix (24, 16), and whether it holds no others.

    Args:
        sizes: (16,) singular values of the matrix,
        rows: (16, 16) and right singular vectors.
    """
    counts = {min(max(int((sizes < share * sizes[0]).sum()), 1), _MAX_NULLITY) for share in _KERNELS}
    readings = [_pairs_of(rows, count) for count in sorted(counts)]
    return [pair for pairs, _ in readings for pair in pairs], all(apart for _, apart in readings)


def _pairs_of(rows: Complex, count: int) -> tuple[list[tuple[complex, complex]], bool]:
    """Return the pairs of a kernel spanned by the last rows of a matrix (16, 16), by its shifts along x and y."""
    kernel = rows[-count:].conj().T.reshape(4, 4, count)
    low = kernel[:3, :3].reshape(9, count)
    shifted = np.concatenate([kernel[1:, :3].reshape(9, count), kernel[:3, 1:].reshape(9, count)], axis=1)
    if count == 1:  # most are
        column = low[:, 0].conj()
        square = float(np.vdot(low, low).real)
        if square > 0.0:
            x, y = (column @ shifted / square).tolist()
            return [(x, y)], True
    times, _, _, sizes = np.linalg.lstsq(low, shifted, rcond=_AT_INFINITY)
    times_x, times_y = times[:, :count], times[:, count:]
    _, vectors = np.linalg.eig(times_x + _MIX * times_y)
    pairs = []
    for vector in vectors.T:
        n = int(np.argmax(np.abs(vector)))
        pairs.append((complex((times_x @ vector)[n] / vector[n]), complex((times_y @ vector)[n] / vector[n])))
    return pairs, bool(count < _MAX_NULLITY and sizes[-1] > _AT_INFINITY * sizes[0])


def _joint_value(number: complex, kind: JointKind, near: float) -> float | None:
    """Return the joint value of x, y or h, or None if it is not real."""
    if not cmath.isfinite(number):
        return None
    if kind == "prismatic":
        return number.real if abs(number.imag) < max(near, 10.0 * NEARLY_REAL) * (1.0 + abs(number)) else None
    return cmath.phase(number) if abs(abs(number) - 1.0) < max(near, 10.0 * NEARLY_REAL) else None
