"""Where three pairs of rods are singular, from the directions of the rods.

u_i are unit vectors along the rods, t_i the direction in which the rods of a pair stand apart: level, across the arm.
Every rod keeps its length, so the platform's point moves by dp and the platform turns by w with

    u_i · dp = what its axis moves       a rod across its axis' motion: the axis moves nothing      "strut"
                                         the u_i in a plane or parallel: dp is free                 "platform"
    (t_i × u_i) · w = 0                  the normals of the pairs in a plane: w is free             "twist"

As measures serve the cosine of the angle between a rod and its axis' motion, and the smallest singular value of three
unit vectors: 0 there, 1 where they are at right angles.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix
from chainbuild.chain.closing import Loss
from chainbuild.closest import and_joined

Vector3 = tuple[float, float, float]

_ALIKE: Final = 0.2  # sine of the angle between rods that are called parallel: 11 degrees, nearly


def strut_losses(struts: Sequence[tuple[float, str]], names: Sequence[str]) -> Iterator[Loss]:
    """Yield for each arm where its axis moves the platform no more.

    Args:
        struts: Value and words of each arm, with a place {name}.
        names: Names of the axes.
    """
    for n, ((value, words), name) in enumerate(zip(struts, names, strict=False)):
        yield Loss("strut", value, (n,), words.replace("{name}", name))


def rod_losses(
    rods: Sequence[Vector3], arms: Sequence[tuple[float, float]], names: Sequence[str], count: int
) -> Iterator[Loss]:
    """Yield where the rods hold the platform no more, and where they let it turn.

    Args:
        rods: u_i.
        arms: Cosine and sine of each arm's azimuth.
        names: Names of the axes.
        count: Joints of the chain, the platform's three first.
    """
    every, along = tuple(range(len(rods))), np.array(rods)
    value, free = _least(along)
    rates = np.zeros(count)
    rates[:3] = free
    yield Loss("platform", value, every, _standing(along, names), rates=rates)
    # t × u for t = (-y, x, 0)
    normals = np.array([(x * u[2], y * u[2], -(x * u[0] + y * u[1])) for u, (x, y) in zip(rods, arms, strict=True)])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.finfo(float).tiny)
    value, free = _least(normals)
    words = f"the planes of the pairs of rods of {and_joined(names)} are {{nearly}}parallel to one line"
    yield Loss("twist", value, every, words, about=free)


def _least(rows: Matrix) -> tuple[float, Matrix]:
    """Return the smallest singular value of three unit vectors, signed as their determinant, and its direction."""
    _, values, Vt = np.linalg.svd(rows)
    return float(np.copysign(values[-1], np.linalg.det(rows))), Vt[-1]


def _standing(rods: Matrix, names: Sequence[str]) -> str:
    """Return how rods stand where they hold nothing: two in one line or parallel, or all of them in a plane."""
    pairs = [(n, m) for n in range(len(rods)) for m in range(n)]
    alike = [pair for pair in pairs if np.linalg.norm(np.cross(*rods[list(pair)])) < _ALIKE]
    if len(alike) == 1:
        first, last = sorted(alike[0])
        how = "parallel" if float(rods[first] @ rods[last]) > 0.0 else "in one line"
        return f"the rods of {names[first]} and {names[last]} are {{nearly}}{how}"
    how = "parallel" if alike else "in a plane"
    return f"the rods of {and_joined(names)} are {{nearly}}{how}"
