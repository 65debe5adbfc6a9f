"""The direct solution of machines with three linear axes and up to three rotary ones, in any order.

The rotary axes alone decide the orientation; the linear axes then place the TCP exactly, because the position is an
affine function of them. One solver covers heads, tables and mixed machines: it uses the chain, not the type.

    tool direction d:   Rot(w1)·Rot(w2)·z0 = d          two pairs of angles, or one and a free axis (singular)
    full pose R:        Rot(w1)·Rot(w2)·Rot(w3) = R·R0ᵀ  the same for w3, then the last angle

w are the rotary axes and z0 the tool direction, both seen from the workpiece where all rotary joints are 0.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild import tolerances
from chainbuild.arrays import Matrix, Vector
from chainbuild.errors import ChainbuildError
from chainbuild.frames import transform
from chainbuild.ik.branches.arms.orientation import Turns, for_direction, for_rotation
from chainbuild.ik.branches.core.axis_values import axes_for
from chainbuild.ik.branches.core.branches import Solutions, collect, verified
from chainbuild.ik.branches.core.free_axis import with_free_axes_inside
from chainbuild.ik.branches.core.plain import plain_cross, plain_dot, plain_length
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.request import IkRequest
from chainbuild.ik.result import IkResult
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.newton import below, newton, shrinking

_LINEAR_STEPS: Final = 2  # the second one only corrects the last digits
_SPAN: Final = 1e-3  # share of their product: slides that span less are moved by least squares
_TURN_STEPS: Final = 40  # far more than a turn about one axis needs
_MET: Final = below(1e-22)  # as good as a polished solution
_DAMPING: Final = shrinking(1e-3, 1e-12)
_MAX_ROTARY: Final = 3  # more revolute joints leave the direction open


def query_is_direct(query: BranchQuery) -> bool:
    """Tell whether the direct solver answers a query."""
    structure, chain = query.structure, query.mechanism.chain
    if chain.loops or len(structure.linear) != 3 or len(structure.revolute) > _MAX_ROTARY:
        return False
    if len(structure.rotary) < len(structure.revolute):
        return False
    _, J = query.mechanism.kinematics.pose_and_jacobian(query.x0)
    block = J[:3, structure.linear]
    return bool(np.isfinite(block).all()) and abs(float(np.linalg.det(block))) > tolerances.RANK


def find_direct(query: BranchQuery) -> Solutions:
    """Return the direct solutions of a query for which `query_is_direct` holds."""
    return collect(query, with_free_axes_inside(query, _candidates))


def linear_axes_for(mechanism: Mechanism, position: ArrayLike, axes: ArrayLike) -> IkResult:
    """Return axis values that bring the TCP to a position with the rotary axes unchanged: RTCP programming.

    Args:
        mechanism: One with three independent linear axes.
        position: (3,) tip in the workpiece frame [m].
        axes: (n_axes,) mm and degrees; rotary values count, linear ones are replaced.

    Raises:
        ChainbuildError: the robot has no direct solution, or a value is not finite.
    """
    values = mechanism.axis_values(axes)
    T = mechanism.fk(values)
    target = transform(T.rotation, np.asarray(position, dtype=float))
    query = BranchQuery.of(IkRequest(mechanism, target, values))
    if not query_is_direct(query):
        raise ChainbuildError("this kinematic has no direct solution")
    x = _with_linear_axes(query, query.x0.copy())
    row = None if x is None else verified(query, x)
    if row is None:
        reason = "no pose at these rotary angles"
        return IkResult(False, values, "unreachable", np.inf, np.inf, 1, 0, "position", mechanism.labels, reason)
    outside = mechanism.limits.violated(row.axes)
    if outside:
        reason = f"reached only outside the limits of {', '.join(outside)}"
        labels = mechanism.labels
        return IkResult(False, row.axes, "limits", row.distance, 0.0, 1, 0, "position", labels, reason, outside)
    return row.branch("position", mechanism.labels)


def _candidates(query: BranchQuery) -> Iterator[tuple[Vector, list[int]]]:
    """Yield SI axis values that may be solutions, with their free axes."""
    structure = query.structure
    columns = structure.rotary[: len(structure.revolute)]  # axes beyond these (a virtual one) stay at the start
    for turns, joints in _rotary_solutions(query):
        free = query.undetermined_axes(joints, turns.free, columns)
        for x in axes_for(query, joints, np.array(turns.angles), columns):
            for full in _placed(query, x, free):
                yield full, free


def _placed(query: BranchQuery, x: Vector, free: list[int]) -> Iterator[Vector]:
    """Yield x with its linear axes in place; free axes are put back to exactly their start first."""
    if free:
        kept = x.copy()
        kept[free] = query.x0[free]
        placed = _with_linear_axes(query, kept)
        if placed is not None and verified(query, placed) is not None:
            yield placed
            return
    placed = _with_linear_axes(query, x)
    if placed is not None:
        yield placed
        yield from _turned_into_reach(query, placed, free)


def _turned_into_reach(query: BranchQuery, placed: Vector, free: list[int]) -> Iterator[Vector]:
    """Yield x with its free axes turned so that slides that have come to lie in a plane reach the place in it."""
    if not free or not _are_dependent(query, placed) or verified(query, placed) is not None:
        return
    residual = query.mechanism.kinematics.residual(query.target, query.mechanism.task)
    for quarter in range(4):
        start = placed.copy()
        start[free[0]] += quarter * math.pi / 2.0
        ended = newton(residual, start, query.structure.free, _MET, _DAMPING, _TURN_STEPS)
        if ended.met:
            yield ended.x


def _are_dependent(query: BranchQuery, x: Vector) -> bool:
    """Tell whether the rotary axes have turned one slide into the plane of the others."""
    _, J = query.mechanism.kinematics.pose_and_jacobian(x)
    return abs(float(np.linalg.det(J[:3, query.structure.linear]))) < tolerances.RANK


def _with_linear_axes(query: BranchQuery, x: Vector) -> Vector | None:
    """Return x with the linear axes that bring the tip to the target's position."""
    linear, target = query.structure.linear, query.target
    for _ in range(_LINEAR_STEPS):
        T, J = query.mechanism.kinematics.pose_and_jacobian(x)
        error = T.rotation.T @ (target.translation - T.translation)
        if not np.isfinite(error).all():
            return None
        # A rotary axis may have turned one slide into the plane of the others, but for rounding.
        x[linear] += _moved_by(J[:3, linear], error)
        if query.mechanism.kinematics.affine is not None:
            break  # slides keep their directions
    return x


def _moved_by(slides: Matrix, error: Vector) -> Vector:
    """Return how far slides (3, 3) move to move the tip by a vector, the least where one lies in a plane of others."""
    a, b, c = slides.T.tolist()
    normal = plain_cross(b, c)
    volume = plain_dot(a, normal)
    if not abs(volume) > _SPAN * plain_length(a) * plain_length(b) * plain_length(c):
        return np.asarray(np.linalg.lstsq(slides, error, rcond=tolerances.RANK)[0], dtype=float)
    e = error.tolist()
    along = plain_dot(e, normal), plain_dot(a, plain_cross(e, c)), plain_dot(a, plain_cross(b, e))
    return np.array(along) / volume


def _rotary_solutions(query: BranchQuery) -> Iterator[tuple[Turns, NDArray[np.intp]]]:
    """Yield the angles of the rotary joints that give the target's orientation, and those joints' indices."""
    serial = query.serial()
    screws = [screw for screw in serial.screws if screw.kind == "revolute"]
    joints = np.array([screw.joint for screw in screws], dtype=np.intp)
    keep = tuple(float(value) for value in query.q0[joints])
    axes = [screw.direction for screw in screws]
    R = query.target.rotation @ serial.M[:3, :3].T
    task = query.mechanism.task
    column = query.mechanism.chain.tool_column
    if task == "position":
        found = [Turns(keep, (True,) * len(axes))] if axes else [Turns((), ())]
    elif task == "direction":
        found = for_direction(axes, serial.M[:3, column], query.target.rotation[:, column], keep)
    else:
        found = for_rotation(axes, R, keep)
    for turns in found:
        yield turns, joints
