"""A loop of six joints, opened before one of them: its equations, and its outer joints from the inner ones.

E1·E2·E3·E4·E5·E6 = G. An arrow on the axis of joint 6 is not changed by it: E3·E4·E5·arrow = E2⁻¹·E1⁻¹·G·arrow are
fourteen equations. Without the eight products of joints 1 and 2 on the right, six are left for joints 3, 4 and 5.
"""

from __future__ import annotations

import cmath
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np

from chainbuild.arrays import Complex, Matrix, Vector
from chainbuild.ik.branches.arms.orientation import perpendicular
from chainbuild.ik.branches.arms.positioner import parallel
from chainbuild.ik.branches.arms.two_joints import JointPair, reach_by_two
from chainbuild.ik.branches.core.serial import Screw, rotation_seen_from, transformed_point
from chainbuild.ik.branches.core.subproblems import rotate, subproblem_1, subproblem_2
from chainbuild.ik.branches.elimination.conformal import ONE, SIZE, arrow, backwards
from chainbuild.ik.branches.elimination.eliminant import Eliminant

_EQUATIONS: Final = np.array([n for n in range(SIZE) if n != ONE])
_PRODUCTS: Final = 8  # of joints 1 and 2: nine combinations without the constant one
_DEPENDENT: Final = 1e-7  # singular values below this share of the largest leave the outer joints open
_ROUNDING: Final = 1e-14  # below this share they are rounding
_MET: Final = 1e-5  # an arrow that misses its goal by less [arm lengths, rad] meets it
_NEAR: Final = 1e-2  # the same for solutions by geometry, which lose digits; the caller verifies all


class _RightSide(NamedTuple):
    """The right side of the equations: of the eight products of joints 1 and 2, and constant.

    Attributes:
        constant: (14,) what stands beside the products.
        u: (14, 14) left singular vectors of the coefficients of the products.
        sizes: (8,) their singular values.
        solved: (8, 14) the products from the other side.
    """

    constant: Complex
    u: Complex
    sizes: Vector
    solved: Complex


@dataclass(frozen=True, eq=False)
class OpenedLoop:
    """The loop opened before one of its joints.

    Attributes:
        row: The six joints in the order of the loop.
        parts: Their coefficients, (3, 15, 15) each; see `conformal.coefficients`.
        end: (15,) the arrow on the last joint.
        goal: (15,) its place in the closed loop.
    """

    row: list[Screw]
    parts: list[Complex]
    end: Vector
    goal: Vector

    @cached_property
    def right_side(self) -> _RightSide:
        """The right side of the equations."""
        one, two = (backwards(self.row[n], self.parts[n]) for n in (0, 1))
        products = np.einsum("aij,bj->iab", two, one @ self.goal).reshape(SIZE, -1)[_EQUATIONS]
        constant = _constant(self.row[1]) * 3 + _constant(self.row[0])
        u, sizes, rows = np.linalg.svd(np.delete(products, constant, axis=1))
        kept = sizes > _ROUNDING * sizes[0]
        solved = (rows.conj().T * (kept / np.where(kept, sizes, 1.0))) @ u[:, :_PRODUCTS].conj().T
        return _RightSide(products[:, constant], u, sizes, solved)


def _constant(screw: Screw) -> int:
    """Return which coefficient of a joint stands for 1."""
    return 0 if screw.kind == "prismatic" else 1


def equations(loop: OpenedLoop) -> Complex:
    """Return the six equations for joints 3, 4, 5: (6, 3, 3, 3), the coefficients of their products."""
    right = loop.right_side
    three, four, five = loop.parts[2:5]
    left = np.einsum("cij,j->ci", five, loop.end)
    left = np.einsum("bij,cj->bci", four, left)
    left = np.einsum("aij,bcj->iabc", three, left)[_EQUATIONS]
    a, b, c = (_constant(screw) for screw in loop.row[2:5])
    left[:, a, b, c] -= right.constant
    return np.asarray(np.tensordot(right.u[:, _PRODUCTS:].conj().T, left, 1), dtype=complex)


def eliminant(loop: OpenedLoop, blocks: Complex, hidden: int) -> Eliminant:
    """Return the eigenvalue problem for one of the joints 3, 4, 5.

    Args:
        loop: The opened loop.
        blocks: What `equations` returns.
        hidden: 0, 1 or 2.
    """
    order = inner_order(hidden)
    kinds = [screw.kind for screw in loop.row[2:5]]
    axes = (order[0] + 1, 0, order[1] + 1, order[2] + 1)
    return Eliminant.of(blocks.transpose(axes), (kinds[order[0]], kinds[order[1]], kinds[order[2]]))


def inner_order(hidden: int) -> tuple[int, int, int]:
    """Return the inner joints, the hidden one first."""
    others = [n for n in range(3) if n != hidden]
    return hidden, others[0], others[1]


def closed(loop: OpenedLoop, inner: tuple[float, float, float], G: Matrix, off: float = 0.0) -> list[list[float]]:
    """Return all six values, given those of joints 3, 4, 5; several if several outer joints fit.

    Args:
        loop: The opened loop.
        inner: Values of joints 3, 4, 5.
        G: (4, 4) what the loop closes to.
        off: By how much these values may be off, so that the arrow misses its goal.
    """
    three, four, five = (screw.T(value) for screw, value in zip(loop.row[2:5], inner, strict=True))
    middle, (one, two, *_, last) = three @ four @ five, loop.row
    aside = perpendicular(last.direction)
    found = []
    for first, second in _outer_pairs(loop, middle, G, off):
        R = middle[:3, :3].T @ rotation_seen_from((one, two), (first, second), G[:3, :3])
        found.append([first, second, *inner, subproblem_1(last.direction, aside, R @ aside).angle])
    return found


def _outer_pairs(loop: OpenedLoop, middle: Matrix, G: Matrix, off: float) -> list[JointPair]:
    """Return the values of joints 1 and 2 that bring the arrow behind them to its goal."""
    right = loop.right_side
    last = loop.row[5]
    moved = arrow(transformed_point(middle, last.point), middle[:3, :3] @ last.direction)
    solved = right.solved @ (moved[_EQUATIONS] - right.constant)
    constant = _constant(loop.row[1]) * 3 + _constant(loop.row[0])
    table = np.concatenate([solved[:constant], [1.0], solved[constant:]]).reshape(3, 3)
    second = _value(loop.row[1], table[:2].ravel(), table[1:].ravel())
    first = _value(loop.row[0], table[:, :2].ravel(), table[:, 1:].ravel())
    if right.sizes[-1] > _DEPENDENT * right.sizes[0] and _miss(loop, (first, second), middle, G) < max(_MET, off):
        return [(first, second)]
    # At this pose the products do not separate the two joints: solve by geometry.
    candidates = [(first, second), *_by_geometry(loop, middle, G)]
    return [pair for pair in candidates if _miss(loop, pair, middle, G) < max(_NEAR, off)]


def _by_geometry(loop: OpenedLoop, middle: Matrix, G: Matrix) -> list[JointPair]:
    one, two, last = loop.row[0], loop.row[1], loop.row[5]
    direction, wanted = middle[:3, :3] @ last.direction, G[:3, :3] @ last.direction
    pairs: list[JointPair] = []
    if one.kind == two.kind == "revolute" and not parallel(one.direction, two.direction):
        turns = subproblem_2(one.direction, two.direction, direction, wanted)
        pairs += [(turn.first, turn.second) for turn in turns]
    for along in (0.0, 1.0):
        point = last.point + along * last.direction
        pairs += reach_by_two(one, two, transformed_point(middle, point), transformed_point(G, point), (0.0, 0.0))
    return pairs


def _miss(loop: OpenedLoop, pair: JointPair, middle: Matrix, G: Matrix) -> float:
    """Return how far the arrow misses its goal [arm lengths, rad]."""
    one, two, last = loop.row[0], loop.row[1], loop.row[5]
    place = one.move(pair[0], two.move(pair[1], transformed_point(middle, last.point))) - transformed_point(
        G, last.point
    )
    direction = middle[:3, :3] @ last.direction
    for screw, value in ((two, pair[1]), (one, pair[0])):
        if screw.kind == "revolute":
            direction = rotate(screw.direction, value, direction)
    off = direction - G[:3, :3] @ last.direction
    return float(np.abs(place).max() + np.abs(off).max())


def _value(screw: Screw, low: Complex, high: Complex) -> float:
    """Return a joint's value from products without and with it."""
    length = np.vdot(low, low).real
    share = complex(np.vdot(low, high) / length) if length else 0j
    return share.real if screw.kind == "prismatic" else cmath.phase(share)
