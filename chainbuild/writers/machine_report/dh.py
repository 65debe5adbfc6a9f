"""Denavit-Hartenberg rows of joints in a row, standard and modified, from their lines.

The lines are those of the base's z, of the joints, and of the tip's z. Between two that follow one another lies the
common normal X = Tx(a)·Rx(α); along a line, from one normal to the next, Z = Rz(θ)·Tz(d). So the tip in the base is

    Z₀·X₀ · Z₁·X₁ · … · Zₙ·Xₙ · Zₙ₊₁

and both conventions are this product, cut differently: standard rows are Zᵢ·Xᵢ, modified ones Xᵢ₋₁·Zᵢ. What is left
over at base and tip are rows of the same four numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.shown import fields_shown
from chainbuild.units import deg_from_rad, mm_from_m
from chainbuild.writers.machine_report.serial import JointRow

_PARALLEL: Final = 1e-9  # sine: URDF files round right angles to 1e-11, machine data to less; it is 1e-9 m at 1 m
_NEARLY: Final = 1e-3  # sine below which feet of the normal are a thousand times as far as the lines are apart
_TOUCHING: Final = 1e-11  # m: lines this near meet; machine data carry 1e-7


@dataclass(frozen=True, slots=True)
class DhRow:
    """Four numbers: Rz(theta)·Tz(d)·Tx(a)·Rx(alpha), or modified Rx(alpha)·Tx(a)·Rz(theta)·Tz(d); mm and degrees.

    Attributes:
        theta: Turn about z, of a joint that turns what its value is added to.
        d: Shift along z, of a joint that shifts likewise.
        a: Shift along x.
        alpha: Turn about x.
    """

    __repr__ = fields_shown

    theta: float
    d: float
    a: float = 0.0
    alpha: float = 0.0


@dataclass(frozen=True, slots=True)
class DhForm:
    """Rows of a chain: the base's, one for each joint, the tip's.

    Attributes:
        standard: Rz(theta)·Tz(d)·Tx(a)·Rx(alpha) each.
        modified: Rx(alpha)·Tx(a)·Rz(theta)·Tz(d) each.
    """

    __repr__ = fields_shown

    standard: tuple[DhRow, ...]
    modified: tuple[DhRow, ...]


class NearlyParallel(Exception):
    """Two lines in succession are nearly but not exactly parallel.

    Attributes:
        first: Index of the first: 0 is the base's z, then the joints.
        angle_deg: Angle between them.
    """

    def __init__(self, first: int, angle_deg: float) -> None:
        super().__init__(first, angle_deg)
        self.first, self.angle_deg = first, angle_deg


@dataclass(frozen=True, slots=True, eq=False)
class _Normal:
    """The common normal of two lines: its direction, length, the turn about it, its feet."""

    x: Vector
    a: float
    alpha: float
    out: Vector
    into: Vector


def dh_form(row: JointRow) -> DhForm:
    """Return the Denavit-Hartenberg rows of a chain.

    Raises:
        NearlyParallel: two lines in succession are so nearly parallel that feet of their normal lie far away.
    """
    count = len(row.joints)
    z = [np.array([0.0, 0.0, 1.0]), *row.directions, row.T[:3, 2]]
    points = [np.zeros(3), *row.points, row.T[:3, 3]]
    # A slide has a direction and no place: its line is laid through the foot of the normal before it.
    placed = [True, *(joint.turns for joint in row.joints), True]
    x, foot = np.array([1.0, 0.0, 0.0]), points[0]
    along: list[tuple[float, float]] = []
    across: list[tuple[float, float]] = []
    for i in range(count + 1):
        target = points[i + 1] if placed[i + 1] else foot
        normal = _normal(i, z[i], z[i + 1], foot, target, x, row.T[:3, 0] if i == count else None)
        along.append((_turn(x, normal.x, z[i]), float((normal.out - foot) @ z[i])))
        across.append((normal.a, normal.alpha))
        x, foot = normal.x, normal.into
    along.append((_turn(x, row.T[:3, 0], z[-1]), float((points[-1] - foot) @ z[-1])))
    standard = [_dh_row(*pair) for pair in zip(along, [*across, (0.0, 0.0)], strict=True)]
    modified = [_dh_row(*pair) for pair in zip(along, [(0.0, 0.0), *across], strict=True)]
    return DhForm(tuple(standard), tuple(modified))


def _dh_row(along: tuple[float, float], across: tuple[float, float]) -> DhRow:
    return DhRow(deg_from_rad(along[0]), mm_from_m(along[1]), mm_from_m(across[0]), deg_from_rad(across[1]))


def _normal(i: int, z: Vector, after: Vector, foot: Vector, target: Vector, x: Vector, tip_x: Vector | None) -> _Normal:
    """Return the common normal of a line through a foot and the next one through a target.

    Args:
        i: Index of the line.
        z: Its direction.
        after: Direction of the next one.
        foot: Where the normal before meets the line.
        target: A point of the next line; of the tip its origin.
        x: Direction of the normal before.
        tip_x: The tip's x where the next line is the tip's z, else None.
    """
    cross, cosine = np.cross(z, after), float(z @ after)
    sine = float(np.linalg.norm(cross))
    if sine < _PARALLEL:
        # Any normal will do: to the tip's origin the one through it, else the one that goes on from the foot.
        into = target if tip_x is not None else target + after * float((foot - target) @ after)
        out = foot + z * float((into - foot) @ z)
        between = into - out
        alpha = 0.0 if cosine > 0.0 else np.pi
        a = float(np.linalg.norm(between))
        if a > _TOUCHING:
            return _Normal(between / a, a, alpha, out, into)
        return _Normal(x if tip_x is None else tip_x, 0.0, alpha, out, into)
    if sine < _NEARLY:
        raise NearlyParallel(i, deg_from_rad(float(np.arcsin(sine))))
    way = target - foot
    out = foot + z * (float(np.cross(way, after) @ cross) / sine**2)
    into = target + after * (float(np.cross(way, z) @ cross) / sine**2)
    between = into - out
    a = float(np.linalg.norm(between))
    if a > _TOUCHING:
        normal = between / a
    else:
        a, normal = 0.0, cross / sine
        # Of its two senses the one that needs no turn of more than 90 degrees.
        if float(normal @ x) < -_PARALLEL:
            normal = -normal
    return _Normal(normal, a, float(np.arctan2(normal @ cross, cosine)), out, into)


def _turn(begin: Vector, end: Vector, about: Vector) -> float:
    """Return the angle [rad] from one direction to another about a third across both."""
    return float(np.arctan2(about @ np.cross(begin, end), begin @ end))
