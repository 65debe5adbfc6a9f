"""Points and directions at points as 15 numbers on which every joint acts linearly and of the first degree.

A point p is (p, p·p, 1), a direction l at it is (l, 2·p·l, 0): the conformal model. An arrow is the point together with
the ten products of the two: l, p·l, p × l and (p·p)·l − 2·(p·l)·p, up to sign and order. A rigid motion acts on these
15 numbers as one matrix; that of a rotary joint is A·exp(−i·q) + B + C·exp(i·q), without higher harmonics, that of a
slide A + B·q + C·q². These are the fourteen equations of Raghavan and Roth (1990), here without a choice of frames.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.arrays import Complex, Matrix, Vector
from chainbuild.ik.branches.core.serial import Screw

SIZE: Final = 15  # numbers of an arrow: the 5 of its point and the 10 products of point and direction
ONE: Final = 4  # the entry of an arrow that is always 1
_FIRST, _SECOND = np.triu_indices(5, 1)


def motion(T: Matrix) -> Matrix:
    """Return the (15, 15) matrix of a rigid motion (4, 4)."""
    R, t = T[:3, :3], T[:3, 3]
    point = np.eye(5)
    point[:3, :3], point[:3, 4] = R, t
    point[3, :3], point[3, 4] = 2.0 * (t @ R), float(t @ t)
    whole = np.zeros((SIZE, SIZE))
    whole[:5, :5] = point
    one, other = point[_FIRST], point[_SECOND]
    whole[5:, 5:] = one[:, _FIRST] * other[:, _SECOND] - one[:, _SECOND] * other[:, _FIRST]
    return whole


def arrow(point: Vector, direction: Vector) -> Vector:
    """Return the 15 numbers of a direction (3,) at a point (3,)."""
    place = np.array([*point, float(point @ point), 1.0])
    tangent = np.array([*direction, 2.0 * float(point @ direction), 0.0])
    products = place[_FIRST] * tangent[_SECOND] - place[_SECOND] * tangent[_FIRST]
    return np.concatenate([place, products])


def coefficients(screw: Screw) -> Complex:
    """Return A, B, C (3, 15, 15) of a joint's motion: of exp(−i·q), 1, exp(i·q), or of 1, q, q² for a slide."""
    if screw.kind == "prismatic":
        still, ahead, back = (motion(screw.T(value)) for value in (0.0, 1.0, -1.0))
        return np.stack([still, (ahead - back) / 2.0, (ahead + back) / 2.0 - still]).astype(complex)
    third = 2.0 * np.pi / 3.0
    samples = np.stack([motion(screw.T(n * third)) for n in range(3)])
    spectrum = np.fft.fft(samples, axis=0) / 3.0
    return np.asarray(spectrum[[2, 0, 1]], dtype=complex)


def backwards(screw: Screw, parts: Complex) -> Complex:
    """Return the coefficients (3, 15, 15) of a joint's inverse motion from those of its motion."""
    if screw.kind == "prismatic":
        return np.asarray(parts * np.array([1.0, -1.0, 1.0])[:, None, None], dtype=complex)
    return np.asarray(parts[::-1], dtype=complex)
