"""Poses that an arm certainly cannot reach: even stretched out it is too short.

With T = F·M₀(u₀)·…·Mₖ(uₖ)·E, first and last joint included, the origin of W = F⁻¹·T·E⁻¹ is not farther away than the
sum of all lengths in between. This includes the orientation, since E⁻¹ removes the tool: many poses that only their
orientation puts out of reach are detected, too. What lies along the first or the last axis is moved to F and E. Where
axes are parallel, what lies along them adds up with its signs and stands square to what lies across: an arm of two
lengths l and m with its parts stepping aside by a and back by b reaches the diagonal of l + m and a − b.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild import frames
from chainbuild.arrays import Matrix
from chainbuild.kinematics.product import Product, poses_at

_PARALLEL: Final = 1e-12  # sine: axes are parallel but for rounding
_ROUNDED: Final = 1e-9  # m: a stretched arm reaches its own length, rounding included


@dataclass(frozen=True, slots=True, eq=False)
class Ends:
    """Constant transforms before the first and after the last joint that the free axes move.

    Attributes:
        begin: Index of the first such joint.
        end: Index of the last.
        before: (4, 4) F⁻¹ [m].
        after: (4, 4) E⁻¹ [m].
    """

    begin: int
    end: int
    before: Matrix
    after: Matrix


@dataclass(frozen=True, slots=True, eq=False)
class ArmReach:
    """The length of an arm.

    Attributes:
        before: (4, 4) F⁻¹ [m].
        after: (4, 4) E⁻¹ [m].
        length: Bound on the distance of the origin of W [m].
    """

    before: Matrix
    after: Matrix
    length: float

    def distance(self, target: Matrix) -> float:
        """Return the distance of the last joint that a target (4, 4) requires [m]."""
        x, y, z = self.before.dot(target).dot(self.after)[:3, 3].tolist()
        return math.sqrt(x * x + y * y + z * z)


def ends_of(arm: Product) -> Ends | None:
    """Return the ends of an arm, or None where no joint moves.

    Args:
        arm: From the workpiece to the tool, by the free axes.
    """
    moved = np.flatnonzero(arm.A.any(axis=1))
    if not len(moved):
        return None
    begin, end = int(moved[0]), int(moved[-1])
    before, after = frames.inverse(_held(arm, 0, begin)), frames.inverse(_held(arm, end + 1, len(arm.b)))
    return Ends(begin, end, before, after)


def _held(arm: Product, begin: int, end: int) -> Matrix:
    """Return the constant transform (4, 4) of the joints from `begin` up to `end`, which no free axis moves."""
    rows = slice(begin, end)
    part = Product(arm.fixed[begin : end + 1], arm.prismatic[rows], arm.A[rows], arm.b[rows])
    count = arm.A.shape[1]
    T: Matrix = poses_at(part, np.zeros((1, count)), np.ones(count))[0]
    return T


def arm_reach(arm: Product) -> ArmReach | None:
    """Return the reach of an arm of rotary joints, or None if one is linear or there are fewer than two.

    Args:
        arm: From the workpiece to the tool, by the free axes.
    """
    ends = ends_of(arm)
    if ends is None or ends.end == ends.begin or arm.prismatic[ends.begin : ends.end + 1].any():
        return None
    between = arm.fixed[ends.begin + 1 : ends.end + 1]
    shifts, normals = between[:, :3, 3].copy(), between[:, :3, 2]
    first = float(shifts[0, 2])
    shifts[0, 2] = 0.0
    last = float(shifts[-1] @ normals[-1])
    shifts[-1] -= last * normals[-1]
    before, after = frames.translation(z=-first) @ ends.before, ends.after @ frames.translation(z=-last)
    return ArmReach(before, after, _length(shifts, normals) * (1.0 + _ROUNDED) + _ROUNDED)


def _length(shifts: Matrix, normals: Matrix) -> float:
    """Return the bound on the sum of shifts (k, 3), each in the frame of the joint before it.

    Args:
        shifts: What is between one joint, which turns about z, and the next.
        normals: (k, 3) the axis of the next joint.
    """
    total, along, across, sign = 0.0, 0.0, 0.0, 1.0
    parallel = [*(np.abs(normals[:, :2]).max(axis=1) < _PARALLEL).tolist(), False]
    for k, (shift, normal) in enumerate(zip(shifts, normals, strict=True)):
        if parallel[k]:
            along += sign * float(shift[2])
            across += math.hypot(*shift[:2])
            sign *= math.copysign(1.0, normal[2])
            continue
        rest = shift.copy()
        if k and parallel[k - 1]:  # what lies along the axes that end here adds up with theirs
            along += sign * float(rest[2])
            rest[2] = 0.0
        total += math.hypot(along, across)
        along, across, sign = 0.0, 0.0, 1.0
        if parallel[k + 1]:  # and with those that begin here
            along = float(rest @ normal)
            rest -= along * normal
        total += float(np.linalg.norm(rest))
    return total + math.hypot(along, across)
