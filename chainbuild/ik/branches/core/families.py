"""Families of branches: solutions that form a curve or a surface are told as such, by one of them and free directions.

Only branches with a nearly singular Jacobian are looked at; regular ones are isolated. Two of these that are beside the
same isolated solution, which lost digits there, become one, too.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.ik.branches.core.beside import Beside
from chainbuild.ik.branches.core.branches import BETWEEN_BRANCHES, CLOSE_BRANCHES, Branches, Solutions
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.verify import on_limits

# Singular values below this share of the largest: a solution that lost digits where branches meet has such.
_NEARLY: Final = 1e-3
_MOVED: Final = 1e-9  # m and rad: settling has changed less where nothing was lost


def with_families(query: BranchQuery, found: Solutions) -> Branches:
    """Return branches with their free directions, those of one family reduced to the one nearest to the start.

    Where more axes are free than the task determines, every branch is on a curve: these tell their free directions and
    are not reduced, as each keeps another axis at its start.

    Args:
        query: The query.
        found: Its solutions, nearest first.
    """
    branches = found.branches
    looked_at = np.flatnonzero(_nearly_singular(found.jacobians[:, :, query.structure.free]))
    if not len(looked_at):
        return branches
    beside, factors = Beside(query), query.mechanism.kinematics.si_factors
    places = [row * factors for row in branches.axes]
    directions = list(branches.free_directions)
    for n in looked_at:
        places[n] = beside.settled(places[n])
        directions[n] = beside.directions(places[n])
    kept = np.ones(len(branches), dtype=bool)
    rows = found.jacobians.shape[1]
    if len(query.structure.free) <= rows:
        _reduce(beside, places, directions, looked_at.tolist(), kept)
    settled = _settled(query, branches, places)
    return _chosen(replace(settled, free_directions=tuple(directions)), np.flatnonzero(kept))


def _nearly_singular(J: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which Jacobians (k, rows, n_free) are singular but for digits."""
    count, rows, columns = J.shape
    if not count or not columns:
        return np.zeros(count, dtype=bool)
    finite: NDArray[np.bool_] = np.asarray(np.isfinite(J).reshape(count, -1).all(axis=1))
    if columns > rows:
        return finite
    try:  # quicker than singular values: the traces bound the largest one, and the smallest one by the inverse
        if rows == columns:
            squared = np.square(J).sum(axis=(1, 2)) * np.square(np.linalg.inv(J)).sum(axis=(1, 2))
        else:
            H = np.swapaxes(J, 1, 2) @ J
            squared = np.einsum("kii->k", H) * np.einsum("kii->k", np.linalg.inv(H))
        if ((squared > 0.0) & (squared < _NEARLY**-2)).all():
            return np.zeros(count, dtype=bool)
    except np.linalg.LinAlgError:
        pass
    sizes = np.linalg.svd(np.where(finite[:, None, None], J, 0.0).astype(float), compute_uv=False)
    return np.asarray(finite & (sizes[:, -1] < _NEARLY * sizes[:, 0]), dtype=bool)


def _reduce(
    beside: Beside, places: list[Vector], directions: list[Matrix], looked_at: list[int], kept: NDArray[np.bool_]
) -> None:
    """Clear in `kept` the branches that are the same as, or of the family of, one before them."""
    for place, n in enumerate(looked_at):
        if not kept[n]:
            continue
        later = [m for m in looked_at[place + 1 :] if kept[m]]
        for m in later:
            way = beside.way(places[n], places[m])
            if float(np.abs(way).max()) < CLOSE_BRANCHES and beside.missed(places[n] + 0.5 * way) < BETWEEN_BRANCHES:
                kept[m] = False
        members = [m for m in later if kept[m] and len(directions[m])]
        if len(directions[n]) and members:
            passed = beside.reached(places[n], directions[n], [places[m] for m in members])
            kept[[members[k] for k in passed]] = False


def _settled(query: BranchQuery, branches: Branches, places: list[Vector]) -> Branches:
    """Return branches at the places where they have been settled, if these keep all limits."""
    kinematics, mechanism = query.mechanism.kinematics, query.mechanism
    axes, distances, angles = branches.axes.copy(), branches.position_error.copy(), branches.rotation_error.copy()
    for n, x in enumerate(places):
        shown = query.shown(x)
        if np.abs(x - axes[n] * kinematics.si_factors).max() > _MOVED and not mechanism.limits.violated(shown):
            moved = on_limits(mechanism, query.target, shown, mechanism.task)
            axes[n], distances[n], angles[n] = moved or (shown, *kinematics.errors(x, query.target, mechanism.task))
    return replace(branches, axes=axes, position_error=distances, rotation_error=angles)


def _chosen(branches: Branches, which: NDArray[np.intp]) -> Branches:
    """Return some of the branches."""
    return replace(
        branches,
        axes=branches.axes[which],
        position_error=branches.position_error[which],
        rotation_error=branches.rotation_error[which],
        iterations=branches.iterations[which],
        free_axes=tuple(branches.free_axes[n] for n in which),
        free_directions=tuple(branches.free_directions[n] for n in which),
    )
