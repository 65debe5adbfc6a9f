"""All branches of many poses at once: ortho-parallel arms with a spherical wrist."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.arms.arms import arm_solver
from chainbuild.ik.branches.core.free_axis import placed_branches, solutions_of
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.core.subproblems import ON_AXIS
from chainbuild.ik.branches.opw.constants import opw_constants
from chainbuild.ik.branches.opw.formulas import (
    constant_rows,
    finished,
    flipped,
    upper_branches,
)
from chainbuild.ik.branches.vectors.operands import BRANCHES, affine, product
from chainbuild.ik.branches.vectors.rows import chunks, has_other_last_row, on_cores, refuse_what_is_not_rigid
from chainbuild.ik.request import IkRequest
from chainbuild.ik.search.compiled import packing
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.tolerances import LIMIT_SLACK

Array = NDArray[np.float64]

_STRAIGHT: Final = 2.0 * ON_AXIS  # sine of θ5: what the formulas take for straight, and rounding
_SAME_BRANCH: Final = 1e-3  # degrees: far above rounding, far below the distance of branches


def has_ortho_parallel_batch(mechanism: Mechanism, *, limits: bool) -> bool:
    """Tell whether a mechanism is a six-axis arm with axes at right angles or parallel and a spherical wrist."""
    return _constants(mechanism, limits) is not None


def ortho_parallel_batch(mechanism: Mechanism, targets: Array, *, limits: bool, compiled: bool) -> Array:
    """Return all branches (n, 8, 6) of poses, mm and degrees; see `many.ik_all_batch`.

    Args:
        mechanism: One for which `has_ortho_parallel_batch` holds.
        targets: (n, 4, 4) tool in the workpiece frame [m].
        limits: Whether the limits count.
        compiled: False: NumPy, even where numba is installed.

    Raises:
        ChainbuildError: the mechanism is no such arm, or a pose is no rigid transform.
    """
    constants = _constants(mechanism, limits)
    if constants is None:
        raise ChainbuildError("no ortho-parallel arm with a spherical wrist")
    axes, doubtful = np.empty((len(targets), BRANCHES, 6)), np.zeros(len(targets), dtype=bool)
    if compiled and packing.available():
        from chainbuild.ik.branches.opw.compiled import write_branches

        flat = axes.reshape(-1, BRANCHES * 6)
        on_cores(lambda part: write_branches(targets[part], constants, flat[part], doubtful[part]), len(targets))
    else:
        _write_branches(targets, constants, axes, doubtful)
    refuse_what_is_not_rigid(targets, np.flatnonzero(doubtful))
    if limits and mechanism.limits.sums:
        for chunk in chunks(len(targets)):
            _keep_sums(mechanism, constants, axes[chunk])
    _place_straight_wrists(mechanism, targets, axes)
    return axes


def _constants(mechanism: Mechanism, limits: bool) -> Array | None:
    """Return the constants of a robot, prepared at first use, or None where the formulas do not apply."""
    return mechanism.prepared("OPW constants", lambda: opw_constants(mechanism, limits=limits), limits)


def _write_branches(targets: Array, constants: Array, axes: Array, doubtful: NDArray[np.bool_]) -> None:
    """Write the branches of poses by NumPy; see `compiled_opw.write_branches`."""
    rows = constant_rows(constants)
    for chunk in chunks(len(targets)):
        T = np.ascontiguousarray(targets[chunk, :3].transpose(1, 2, 0)).reshape(12, -1)
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            M, *upper = upper_branches(T, rows)
            every = (*upper, *map(flipped, upper))
            branches, straight = np.array([one[:6] for one in every]), np.array([one[6] for one in every])
            found = finished(branches.swapaxes(0, 1), straight, M, rows)  # six times (8, m)
        axes[chunk] = np.array(found).transpose(2, 1, 0)
        doubtful[chunk] = ~np.isfinite(found[0]).any(axis=0) | has_other_last_row(targets[chunk])


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
    rows, opened = np.flatnonzero(np.isinf(axes[:, :, 0]).any(axis=1)), _constants(mechanism, False)
    if not len(rows) or opened is None:
        return
    loose, _ = np.empty((len(rows), BRANCHES, 6)), np.empty(len(rows), dtype=bool)
    _write_branches(targets[rows], opened, loose, _)
    for row, branches in zip(rows.tolist(), loose, strict=True):
        slots = np.flatnonzero(np.isinf(axes[row, :, 0]))
        axes[row, slots] = np.nan
        query = BranchQuery.of(IkRequest(mechanism, targets[row]))
        known = arm_solver(query.serial(), "pose")
        for at_start, inside in placed_branches(query, solutions_of(known[1])) if known else ():
            turned = np.abs(np.remainder(branches[slots] - at_start + 180.0, 360.0) - 180.0).max(axis=1)
            if np.nanmin(turned, initial=np.inf) < _SAME_BRANCH:
                axes[row, slots[int(np.nanargmin(turned))]] = inside


def wrists_over_first_axis(mechanism: Mechanism, targets: Array, axes: Array) -> NDArray[np.intp]:
    """Return which poses have no branch inside the limits with axis 1 at its start, but their wrist over that axis.

    Args:
        mechanism: One for which `has_ortho_parallel_batch` holds.
        targets: (n, 4, 4) tool in the workpiece frame [m].
        axes: (n, 8, 6) of `ortho_parallel_batch`, with limits.
    """
    constants, without = _constants(mechanism, True), np.flatnonzero(np.isnan(axes[:, :, 0]).all(axis=1))
    if constants is None or not len(without):
        return without[:0]
    base, flange, *_ = constant_rows(constants)
    M = product(product(base, targets[without, :3].reshape(-1, 12).T), flange)
    over: NDArray[np.intp] = without[np.hypot(M[3], M[7]) < ON_AXIS]
    return over


def slots_over_first_axis(mechanism: Mechanism, values: Array) -> NDArray[np.intp]:
    """Return the slots (k,) of branches (k, 6), mm and degrees, whose arm is in front of axis 1 and behind it."""
    constants = _constants(mechanism, True)
    if constants is None:
        raise ChainbuildError("no ortho-parallel arm with a spherical wrist")
    rows = constant_rows(constants)
    theta = affine(values.T, rows[4])
    is_flipped = np.sin(theta[4]) < 0.0
    slots: NDArray[np.intp] = 4 * is_flipped + (np.sin(theta[2] + rows[2][1][0]) < 0.0)
    return slots
