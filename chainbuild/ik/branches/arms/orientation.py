"""Orientation by up to three rotary axes: the angles that give a tool direction or a whole rotation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.ik.branches.core.plain import plain_turned
from chainbuild.ik.branches.core.subproblems import plain_turn, rotate, subproblem_1, subproblem_2


class Turns(NamedTuple):
    """Angles of the rotary joints, in the order of the product, and which of them are free."""

    angles: tuple[float, ...]
    free: tuple[bool, ...]


def for_direction(axes: Sequence[Vector], z0: Vector, d: Vector, keep: Sequence[float]) -> list[Turns]:
    """Return the angles with Rot(w1)·…·Rot(wn)·z0 = d."""
    if not axes:
        return [Turns((), ())]
    if len(axes) == 1:
        turn = subproblem_1(axes[0], z0, d, keep[0])
        return [Turns((turn.angle,), (turn.free,))]
    if len(axes) == 2:
        pairs = subproblem_2(axes[0], axes[1], z0, d, (keep[0], keep[1]))
        return [Turns((p.first, p.second), (p.first_free, p.second_free)) for p in pairs]
    return _with_one_kept(axes, z0, d, keep)


def _with_one_kept(axes: Sequence[Vector], z0: Vector, d: Vector, keep: Sequence[float]) -> list[Turns]:
    """Return the angles of three axes for a direction: each in turn keeps its start value."""
    w1, w2, w3 = axes
    k1, k2, k3 = keep
    outer = subproblem_2(w1, w2, rotate(w3, k3, z0), d, (k1, k2))
    # With the middle angle kept, the outer axis sees w3 and z0 turned by it.
    around = subproblem_2(w1, rotate(w2, k2, w3), rotate(w2, k2, z0), d, (k1, k3))
    inner = subproblem_2(w2, w3, z0, rotate(w1, -k1, d), (k2, k3))
    return [
        *(Turns((p.first, p.second, k3), (p.first_free, p.second_free, True)) for p in outer),
        *(Turns((p.first, k2, p.second), (p.first_free, True, p.second_free)) for p in around),
        *(Turns((k1, p.first, p.second), (True, p.first_free, p.second_free)) for p in inner),
    ]


def for_rotation(axes: Sequence[Vector], R: Matrix, keep: Sequence[float]) -> list[Turns]:
    """Return the angles with Rot(w1)·…·Rot(wn) = R."""
    if not axes:
        return [Turns((), ())]
    last = axes[-1]
    image = R @ last
    if len(axes) == 1:
        heads = [Turns((), ())]
    elif len(axes) == 2:
        turn = subproblem_1(axes[0], last, image, keep[0])
        heads = [Turns((turn.angle,), (turn.free,))]
    else:
        pairs = subproblem_2(axes[0], axes[1], last, image, (keep[0], keep[1]))
        heads = [Turns((p.first, p.second), (p.first_free, p.second_free)) for p in pairs]
    aside, plain = perpendicular(last), [axis.tolist() for axis in axes]
    turned, start = (R @ aside).tolist(), aside.tolist()
    found = []
    for head in heads:
        back = turned
        for w, angle in zip(plain[:-1], head.angles, strict=True):
            back = plain_turned(w, -angle, back)
        found.append(Turns((*head.angles, plain_turn(plain[-1], start, back, keep[-1]).angle), (*head.free, False)))
    return found


def perpendicular(axis: Vector) -> Vector:
    """Return a unit vector at right angles to an axis."""
    k = axis.tolist()
    sizes = [abs(component) for component in k]
    n = sizes.index(min(sizes))
    part = [float(m == n) - k[n] * k[m] for m in range(3)]
    return np.array(part) / math.hypot(*part)
