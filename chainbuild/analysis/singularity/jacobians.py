"""Jacobians of many poses at once, in NumPy; used by maps.

A walk from the tool to the workpiece: the chain behind joint n is the transform G = (R, p), and the joint,
which moves about or along its z, moves the tool by the twist (Rᵀ·(z × p), Rᵀ·z), or (Rᵀ·z, 0) where it shifts.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.product import Product

_CHUNK: Final = 1024  # poses worked on at a time: memory does not grow with the count


def pose_jacobians(robot: Mechanism, axes: Matrix) -> Iterator[tuple[slice, Matrix, Matrix]]:
    """Yield, chunk by chunk, the rows done, positions (n, 3) [m] and Jacobians (n, 6, n_axes) of a robot.

    Jacobians are those of `Robot.jacobian`: linear rows first, in the tool frame, by metres and radians of the axes.

    Args:
        robot: The robot.
        axes: (N, n_axes) axis values, mm and degrees.
    """
    product = robot.kinematics.product
    x = np.asarray(axes, dtype=float) * robot.kinematics.si_factors
    for first in range(0, len(x), _CHUNK):
        part = slice(first, min(first + _CHUNK, len(x)))
        yield (part, *(_chunk(product, x[part]) if product is not None else _singly(robot, x[part])))


def _singly(robot: Mechanism, x: Matrix) -> tuple[Matrix, Matrix]:
    """Evaluate a chain with a nonlinear axis map pose by pose."""
    positions, jacobians = np.empty((len(x), 3)), np.empty((len(x), 6, x.shape[1]))
    for n, values in enumerate(x):
        T, jacobians[n] = robot.kinematics.pose_and_jacobian(values)
        positions[n] = T.translation
    return positions, jacobians


def _chunk(product: Product, x: Matrix) -> tuple[Matrix, Matrix]:
    count, joints = len(x), len(product.prismatic)
    u = product.A @ x.T + product.b[:, None]
    # Rows of G = (R | p): (3, 4, N). Each step multiplies from the left: first the joint, then the constant before it.
    rows = np.repeat(product.fixed[joints, :3, :, None], count, axis=2)
    screws = np.zeros((6, joints, count))
    for n in reversed(range(joints)):
        X, Y, Z = rows
        if product.prismatic[n]:
            screws[:3, n] = Z[:3]
            Z[3] += u[n]
        else:
            screws[:3, n] = X[3] * Y[:3] - Y[3] * X[:3]
            screws[3:, n] = Z[:3]
            c, s = np.cos(u[n]), np.sin(u[n])
            rows[0], rows[1] = c * X - s * Y, s * X + c * Y
        F = product.fixed[n, :3]
        rows = np.matmul(F[:, :3], rows.reshape(3, -1)).reshape(3, 4, count)
        rows[:, 3] += F[:, 3, None]
    jacobians = np.tensordot(screws, product.A, axes=(1, 0))  # (6, N, n_axes)
    return rows[:, 3].T, jacobians.transpose(1, 0, 2)
