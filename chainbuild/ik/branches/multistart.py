"""Branches by damped descent from many starts, for chains without a closed form.

The result may be incomplete, unlike that of a closed form: the search ends when a number of starts in a row find
nothing new. `Branch.method` names the solver that found a branch.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.ik.branches.core.axis_values import turned_axes
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.kinematics.newton import Stall, below, newton, shrinking

_MAX_STARTS: Final = 400  # bound on the time
_IDLE_STARTS: Final = 60  # starts in a row without a new branch that end the search
_STEPS: Final = 40  # at most, of one descent
_STALL: Final = Stall(5, 0.9)
_SAME: Final = 1e-5  # solutions closer than this in every axis [m, rad] are one
_SINGULAR: Final = 1e-5  # singular values below this share of the largest may belong to a curve
_MET: Final = below(1e-16)
_DAMPING: Final = shrinking(1e-3, 1e-12)


def multistart_branches(query: BranchQuery) -> Iterator[Vector]:
    """Yield SI axis values of distinct branches, the one near the start first."""
    rng = np.random.default_rng(20240229)
    free = query.structure.free
    lower = np.where(np.isfinite(query.lower), query.lower, -np.pi)[free]
    upper = np.where(np.isfinite(query.upper), query.upper, np.pi)[free]
    # One turn is enough: whole turns are added to what is found.
    rotary = np.array([query.mechanism.axes[n].kind == "rotary" for n in free], dtype=bool)
    lower[rotary] = np.maximum(lower[rotary], -np.pi)
    upper[rotary] = np.minimum(upper[rotary], np.pi)
    known: list[Vector] = []
    idle = 0
    start = query.x0
    for _ in range(_MAX_STARTS):
        found = _descend(query, start)
        fresh = found is not None and all(_largest_difference(found, other, query) > _SAME for other in known)
        if found is not None and fresh:
            known.append(found)
            yield from turned_axes(query, found, free)
        # Of a curve of solutions every start finds another one: these do not keep the search going.
        idle = 0 if found is not None and fresh and _is_isolated(query, found) else idle + 1
        if idle >= _IDLE_STARTS:
            return
        start = query.x0.copy()
        start[free] = lower + (upper - lower) * rng.random(len(free))


def _largest_difference(a: Vector, b: Vector, query: BranchQuery) -> float:
    """Return the largest difference, whole turns of periodic axes not counted."""
    difference = a - b
    turns = query.periodic
    difference[turns] = np.remainder(difference[turns] + np.pi, 2.0 * np.pi) - np.pi
    return float(np.abs(difference).max())


def _is_isolated(query: BranchQuery, x: Vector) -> bool:
    """Return whether the Jacobian tells that there are no solutions beside one."""
    _, J = query.mechanism.kinematics.residual(query.target, query.mechanism.task)(x)
    sizes = np.linalg.svd(J[:, query.structure.free], compute_uv=False)
    return len(query.structure.free) <= len(J) and bool((sizes > _SINGULAR * sizes.max(initial=0.0)).all())


def _descend(query: BranchQuery, start: Vector) -> Vector | None:
    """Return the axis values where the residual vanishes, or None."""
    residual = query.mechanism.kinematics.residual(query.target, query.mechanism.task)
    ended = newton(residual, start, query.structure.free, _MET, _DAMPING, _STEPS, _STALL)
    return ended.x if ended.met else None
