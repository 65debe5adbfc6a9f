"""All branches of many poses at once: ortho-parallel arms with a spherical wrist."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild.errors import ChainbuildError
from chainbuild.frames import rigid_rows
from chainbuild.ik.branches.arms.arms import arm_solver
from chainbuild.ik.branches.core.free_axis import placed_branches, solutions_of
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.core.subproblems import ON_AXIS
from chainbuild.ik.branches.opw.constants import opw_constants
from chainbuild.ik.branches.opw.formulas import (
    BRANCHES,
    affine,
    constant_rows,
    finished,
    flipped,
    upper_branches,
)
from chainbuild.ik.request import IkRequest
from chainbuild.ik.search.batch import at_row, pose_array
from chainbuild.ik.search.compiled import packing
from chainbuild.ik.search.solver import refusal
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.tolerances import LIMIT_SLACK
from chainbuild.units import Units

if TYPE_CHECKING:
    from chainbuild.kinematics.inputs import Pose

Array = NDArray[np.float64]

_STRAIGHT: Final = 2.0 * ON_AXIS  # sine of θ5: what the formulas take for straight, and rounding
_SAME_BRANCH: Final = 1e-3  # degrees: far above rounding, far below the distance of branches
_CHUNK: Final = 2048  # poses at a time: their data stay in the processor's cache
_LAST_ROW: Final = (0.0, 0.0, 0.0, 1.0)  # of a rigid transform


def ik_all_batch(
    robot: Mechanism,
    poses: Sequence[Pose] | ArrayLike,
    *,
    limits: bool = True,
    compiled: bool = True,
    units: Units = "controller",
) -> Array:
    """Return all branches (n, 8, 6) of poses, mm and degrees; NaN where a branch does not exist.

    They are the branches of `ik_all` without a start: whole turns end near the middle of the limits, and an axis that
    does not affect a pose is placed where all limits hold, as near to there as possible. Every row of numbers was
    confirmed by forward kinematics to 1e-6 m and 1e-6 rad. Slot 4·flip + 2·shoulder + elbow is the same branch in every
    pose: flip 0 has θ5 ≥ 0 (the wrist turned from straight in the one sense), shoulder 0 the arm in front of axis 1,
    elbow 0 and 1 its two bends. Branches that coincide fill the first of their slots.

    Args:
        robot: A six-axis arm whose axes stand at right angles or parallel, with a spherical wrist.
        poses: (n, 4, 4) tool in the workpiece frame [m], or `pin.SE3`.
        limits: True: axes are moved by whole turns into their limits, and branches outside them left out; False:
            every branch, whatever the limits.
        compiled: False: NumPy, even where numba is installed.
        units: Those of the result: "controller", mm and degrees, or "si", metres and radians.

    Raises:
        ChainbuildError: the robot is no such arm, a pose is no rigid transform, or there are no such units.
    """
    factors, targets = robot.labels.to(units).factors, pose_array(poses)
    constants = _constants(robot, limits)
    axes, doubtful = np.empty((len(targets), BRANCHES, 6)), np.empty(len(targets), dtype=bool)
    if compiled and packing.available():
        from chainbuild.ik.branches.opw.compiled import write_branches

        write_branches(targets, constants, axes.reshape(-1, BRANCHES * 6), doubtful)
    else:
        _write_branches(targets, constants, axes, doubtful)
    _refuse_what_is_not_rigid(targets, np.flatnonzero(doubtful))
    if limits and robot.limits.sums:
        for chunk in _chunks(len(targets)):
            _keep_sums(robot, constants, axes[chunk])
    _place_straight_wrists(robot, targets, axes)
    return axes if units == "controller" else axes * factors


def _constants(mechanism: Mechanism, limits: bool) -> Array:
    """Return the constants of a robot, prepared at first use."""
    constants = mechanism.prepared("OPW constants", lambda: opw_constants(mechanism, limits=limits), limits)
    if constants is None:
        raise ChainbuildError(
            "ik_all_batch does not support this kinematic",
            permitted="six-axis arms with axes at right angles or parallel and a spherical wrist",
        )
    return constants


def _chunks(count: int) -> Iterator[slice]:
    for first in range(0, count, _CHUNK):
        yield slice(first, first + _CHUNK)


def _write_branches(targets: Array, constants: Array, axes: Array, doubtful: NDArray[np.bool_]) -> None:
    """Write the branches of poses by NumPy; see `compiled_opw.write_branches`."""
    rows = constant_rows(constants)
    for chunk in _chunks(len(targets)):
        T = np.ascontiguousarray(targets[chunk, :3].transpose(1, 2, 0)).reshape(12, -1)
        with np.errstate(invalid="ignore", divide="ignore"):
            M, *upper = upper_branches(T, rows)
            every = (*upper, *map(flipped, upper))
            branches, straight = np.array([one[:6] for one in every]), np.array([one[6] for one in every])
            found = finished(branches.swapaxes(0, 1), straight, M, rows)  # six times (8, m)
        axes[chunk] = np.array(found).transpose(2, 1, 0)
        doubtful[chunk] = ~np.isfinite(found[0]).any(axis=0) | (targets[chunk, 3] != _LAST_ROW).any(axis=1)


def _keep_sums(mechanism: Mechanism, constants: Array, axes: Array) -> None:
    """Leave out branches (m, 8, 6) that break a limit on a sum of axes; with a straight wrist they become infinite."""
    backward = constant_rows(constants)[4]
    for constraint in mechanism.limits.sums:
        with np.errstate(invalid="ignore"):
            total = axes @ np.array(constraint.sum.coefficients) + constraint.sum.offset
        kept = (total >= constraint.lower - LIMIT_SLACK) & (total <= constraint.upper + LIMIT_SLACK)
        broken = ~kept & np.isfinite(axes[:, :, 0])
        straight = np.abs(np.sin(affine(axes[broken].T, backward)[4])) < _STRAIGHT
        axes[broken] = np.where(straight, np.inf, np.nan)[:, None]


def _place_straight_wrists(mechanism: Mechanism, targets: Array, axes: Array) -> None:
    """Place the free axis of infinite branches (n, 8, 6) where all limits hold, as `ik_all` does; else NaN."""
    rows = np.flatnonzero(np.isinf(axes[:, :, 0]).any(axis=1))
    if not len(rows):
        return
    loose, _ = np.empty((len(rows), BRANCHES, 6)), np.empty(len(rows), dtype=bool)
    _write_branches(targets[rows], _constants(mechanism, False), loose, _)
    for row, branches in zip(rows.tolist(), loose, strict=True):
        slots = np.flatnonzero(np.isinf(axes[row, :, 0]))
        axes[row, slots] = np.nan
        query = BranchQuery.of(IkRequest(mechanism, targets[row]))
        known = arm_solver(query.serial(), "pose")
        for at_start, inside in placed_branches(query, solutions_of(known[1])) if known else ():
            turned = np.abs(np.remainder(branches[slots] - at_start + 180.0, 360.0) - 180.0).max(axis=1)
            if np.nanmin(turned, initial=np.inf) < _SAME_BRANCH:
                axes[row, slots[int(np.nanargmin(turned))]] = inside


def _refuse_what_is_not_rigid(targets: Array, doubtful: NDArray[np.intp]) -> None:
    """Raise for the first pose that is not a rigid transform; only poses without a confirmed branch are checked."""
    for first in range(0, len(doubtful), _CHUNK):
        rows = doubtful[first : first + _CHUNK]
        T = targets[rows]
        good = rigid_rows(T)
        if not good.all():
            row = int(rows[np.argmin(good)])
            raise at_row(refusal(targets[row]), row)
