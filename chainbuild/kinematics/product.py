"""A chain as one sequence of matrices from the workpiece to the tool: the form that array code works on.

A tree with two tips needs no reversed joints: walking from the workpiece frame down to the base turns a joint round,
which is the same as its value with the other sign. Every joint frame is laid so that the joint moves about or along
its z. What remains is T = F₀·M₀(u₀)·F₁·M₁(u₁)·…·F_k with u = A·x + b, x being axis values in SI.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AffineMap, AxisMap, refusal_of
from chainbuild.chain.closing import TipMap
from chainbuild.chain.elements import BASE_LINK, Chain, Joint
from chainbuild.errors import ChainbuildError
from chainbuild.frames import inverse

# Poses worked on at a time: the arrays of one chunk stay in the processor's cache, and memory does not grow.
_CHUNK: Final = 2048


@dataclass(frozen=True, slots=True, eq=False)
class Product:
    """A chain with an affine axis map, from the workpiece frame to the tool frame.

    Attributes:
        fixed: (k + 1, 4, 4) constant transforms F [m].
        prismatic: (k,) True where the joint shifts along its z, False where it turns about it.
        A: (k, n_axes) joint values by SI axis values.
        b: (k,) joint values where all axes are zero.
    """

    fixed: NDArray[np.float64]
    prismatic: NDArray[np.bool_]
    A: Matrix
    b: Vector

    def by_axes(self, free: NDArray[np.intp], x: Vector) -> Product:
        """Return the same chain by some of its axes (n_free,), the others held at SI values x (n_axes,).

        Where x holds values for the free axes, too, they have to be 0.
        """
        return Product(self.fixed, self.prismatic, self.A[:, free], self.b + self.A @ x)


def product_of(chain: Chain) -> Product | None:
    """Return the matrix product of a chain, or None where its axis map is not affine."""
    if not isinstance(chain.axis_map, AffineMap):
        return None
    fixed, prismatic, joints, sign = _laid(chain)
    A = sign[:, None] * chain.axis_map.A[joints]
    return Product(fixed, prismatic, A, sign * chain.axis_map.b[joints])


def tip_product_of(chain: Chain) -> Product | None:
    """Return the matrix product by the joints between the tips, or None where the axis map does not give them alone."""
    if not isinstance(chain.axis_map, TipMap):
        return None
    fixed, prismatic, joints, sign = _laid(chain)
    return Product(fixed, prismatic, sign[:, None] * np.eye(len(joints))[joints], np.zeros(len(joints)))


def _laid(chain: Chain) -> tuple[NDArray[np.float64], NDArray[np.bool_], list[int], Vector]:
    """Return constant transforms, which joints shift, their indices and signs, from the workpiece to the tool."""
    tool, workpiece = chain.frame("tool"), chain.frame("workpiece")
    down, up = _branch(chain, workpiece.link), _branch(chain, tool.link)
    while down and up and down[0] == up[0]:  # a joint that carries both tips moves neither against the other
        del down[0], up[0]
    fixed, joints, signs = [inverse(workpiece.T_link_frame)], [], []
    for n in reversed(down):
        # The inverse of F·M(u) is M(−u)·F⁻¹.
        along_z = _turn_to_z(chain.joints[n].direction)
        fixed[-1] = fixed[-1] @ along_z
        fixed.append(inverse(chain.joints[n].T_parent_joint @ along_z))
        joints.append(n)
        signs.append(-1.0)
    for n in up:
        along_z = _turn_to_z(chain.joints[n].direction)
        fixed[-1] = fixed[-1] @ chain.joints[n].T_parent_joint @ along_z
        fixed.append(inverse(along_z))
        joints.append(n)
        signs.append(1.0)
    fixed[-1] = fixed[-1] @ tool.T_link_frame
    prismatic = np.array([chain.joints[n].kind == "prismatic" for n in joints], dtype=bool)
    return np.array(fixed), prismatic, joints, np.array(signs)


def _branch(chain: Chain, link: str) -> list[int]:
    """Return the indices of the joints from the base to a link."""
    by_child: dict[str, tuple[int, Joint]] = {joint.child: (n, joint) for n, joint in enumerate(chain.joints)}
    way: list[int] = []
    while link != BASE_LINK:
        n, joint = by_child[link]
        way.insert(0, n)
        link = joint.parent
    return way


def _turn_to_z(direction: Vector) -> Matrix:
    """Return a rotation (4, 4) whose z column is a direction of length 1, exact for directions along an axis."""
    x, y, z = (float(component) for component in direction)
    T = np.eye(4)
    if z < -0.5:  # away from the opposite direction, where the formula below has no value
        T[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ _turn_to_z(np.array([x, -y, -z]))[:3, :3]
        return T
    cross = np.array([[0.0, 0.0, x], [0.0, 0.0, y], [-x, -y, 0.0]])
    T[:3, :3] += cross + cross @ cross / (1.0 + z)
    return T


def poses_at(product: Product, values: Matrix, factors: Vector) -> Matrix:
    """Return the tool in the workpiece frame (N, 4, 4) [m] at axis values (N, n_axes).

    Memory beyond the result does not depend on N.

    Args:
        product: The chain.
        values: Axis values in any unit.
        factors: (n_axes,) what makes them SI.
    """
    A = product.A * factors
    result = np.zeros((len(values), 4, 4))
    result[:, 3, 3] = 1.0
    for first in range(0, len(values), _CHUNK):
        part = slice(first, first + _CHUNK)
        result[part, :3] = _chunk(product, A @ values[part].T + product.b[:, None]).transpose(2, 1, 0)
    return result


def tip_poses(chain: Chain, product: Product, values: Matrix) -> Matrix:
    """Return the tool in the workpiece frame (N, 4, 4) [m] of a chain with loops at axis values (N, n_axes).

    Args:
        chain: The chain.
        product: That of `tip_product_of`.
        values: Axis values, mm and degrees.

    Raises:
        ChainbuildError: nothing closes at a row; the first one is named.
    """
    axis_map = chain.axis_map
    assert isinstance(axis_map, TipMap)
    result = np.empty((len(values), 4, 4))
    for first in range(0, len(values), _CHUNK):
        part = slice(first, first + _CHUNK)
        q = axis_map.tip_rows(values[part])
        open_rows = np.flatnonzero(~np.isfinite(q).all(axis=1))
        if len(open_rows):
            raise refused_row(axis_map, values[part][open_rows[0]], first + int(open_rows[0]))
        result[part] = poses_at(product, q, np.ones(q.shape[1]))
    return result


def refused_row(axis_map: AxisMap, axes: Vector, row: int) -> ChainbuildError:
    """Return the refusal of axis values (n_axes,) with the index of their row."""
    told = refusal_of(axis_map, axes) or ChainbuildError("the kinematic has no joint values at these axis values")
    told.message = f"row {row}: {told.message}"
    return told


def slides_at(product: Product, values: Matrix, factors: Vector, slides: Vector) -> tuple[Matrix, NDArray[np.float64]]:
    """Return positions (N, 3) [m] and their derivatives (N, 3, m) by m axes that drive prismatic joints only.

    A position is an affine function of such axes: position + derivative · change of the axes is exact.

    Args:
        product: The chain.
        values: (N, n_axes) axis values in any unit.
        factors: (n_axes,) what makes them SI.
        slides: (m,) indices of the axes.
    """
    A = product.A * factors
    places, rates = np.empty((len(values), 3)), np.zeros((len(values), 3, len(slides)))
    for first in range(0, len(values), _CHUNK):
        part = slice(first, first + _CHUNK)
        found: list[Matrix] = []
        places[part] = _chunk(product, A @ values[part].T + product.b[:, None], found)[3].T
        for n, direction in zip(np.flatnonzero(product.prismatic), found, strict=True):
            for m, axis in enumerate(slides):
                if product.A[n, axis]:
                    rates[part, :, m] += product.A[n, axis] * direction.T
    return places, rates


def _chunk(product: Product, u: Matrix, slides: list[Matrix] | None = None) -> NDArray[np.float64]:
    """Return x, y, z column and position of the poses at joint values (k, N) as an array (4, 3, N).

    Args:
        product: The chain.
        u: (k, N) joint values.
        slides: Takes the direction (3, N) of every prismatic joint in the workpiece frame; None: not wanted.
    """
    count = u.shape[1]
    columns = np.repeat(product.fixed[0, :3].T[:, :, None], count, axis=2)
    other = np.empty_like(columns)
    work = np.empty((3, count))
    for n, prismatic in enumerate(product.prismatic):
        X, Y, Z, p = columns
        if prismatic:
            p += np.multiply(u[n], Z, out=work)
            if slides is not None:
                slides.append(Z.copy())
        else:
            c, s = np.cos(u[n]), np.sin(u[n])
            np.multiply(s, X, out=work)
            X *= c
            X += np.multiply(s, Y, out=other[0])
            Y *= c
            Y -= work
        np.matmul(product.fixed[n + 1].T, columns.reshape(4, -1), out=other.reshape(4, -1))
        columns, other = other, columns
    return columns
