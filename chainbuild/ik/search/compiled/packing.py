"""Entry to the compiled path: whether it is installed, and problems packed as its arrays."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.ik.request import IkOptions
from chainbuild.ik.search.found import SearchEnd
from chainbuild.ik.search.problem import Problem
from chainbuild.ik.search.starts.turned import TurnedStarts


@cache
def available() -> bool:
    """Return whether numba is installed (extra `fast`) and supports the installed NumPy."""
    try:
        import_module("numba")
    except ImportError:
        return False
    return True


def compiled_search(
    packed: Packed, target: Matrix, start: Vector | None, wanted: Vector, options: IkOptions
) -> SearchEnd:
    """Search by compiled code; see `plain_search`. The outcome may be NOT_RIGID."""
    y, outside = np.empty(len(wanted)), np.empty(len(wanted))
    begin = wanted if start is None else start
    outcome, iterations, restarts, distance, angle = entries().search_one(
        *packed.arrays, target, begin, start is not None, wanted, options.accuracy, options.max_restarts, y, outside
    )
    return SearchEnd(outcome, iterations, restarts, distance, angle, y, outside)


@cache
def entries() -> Any:
    """Return the module of compiled entry points; numba is imported here, at first use."""
    from chainbuild.ik.search.compiled import entries as compiled_entries

    return compiled_entries


@dataclass(frozen=True, slots=True, eq=False)
class Packed:
    """A problem in few arrays, as `compiled_kernels.unpack` takes it apart."""

    arrays: tuple[NDArray[np.float64], NDArray[np.float32], NDArray[np.int64]]


def packed(problem: Problem) -> Packed | None:
    """Return a problem in few arrays, or None where its axis map is not affine."""
    return problem.prepared("packed", _pack)


def _pack(problem: Problem) -> Packed | None:
    row = problem.row
    if row is None:
        return None
    box, starts, weights = problem.box, problem.starts, problem.weights
    known = problem.arm
    arm = (np.eye(4), np.eye(4), np.inf) if known is None else (known.before, known.after, known.length)
    own, rows, turned = _turned(problem.turned_starts(), row.A.shape[1])
    parts = (
        row.fixed[:, :3], row.prismatic, row.A, row.b,
        (box.lower, box.upper, box.periodic), np.column_stack([box.sums, box.sum_lower, box.sum_upper]),
        weights, starts.points, starts.features, starts.scale, arm[:2], arm[2:], *turned,
        (problem.reach if problem.bounded else np.inf,),
    )  # fmt: skip
    flat = [np.asarray(part, dtype=float).ravel() for part in parts]
    task = (problem.axis, problem.shown_axis, np.count_nonzero(weights), (weights != 1.0).any())
    sizes = (*row.A.shape, len(box.sums), len(starts.points), *task, *own, *np.cumsum([len(part) for part in flat]))
    return Packed((np.concatenate(flat), rows, np.array(sizes, dtype=np.int64)))


def _turned(
    starts: TurnedStarts | None, n: int
) -> tuple[tuple[int, int, int], NDArray[np.float32], tuple[ArrayLike, ...]]:
    """Return sizes, single-precision and double-precision data of turned starts, empty if there are none."""
    if starts is None:
        parts = (np.empty((0, n)), np.empty((0, n + 2, 12)), (np.eye(4), np.eye(4)), (1.0, 1.0), (1.0,))
        return (0, 0, 0), np.empty((8, 0), np.float32), parts
    points = starts.points
    parts = (points.values, points.maps, (starts.before, starts.after), starts.signs, (points.scale,))
    return (len(points.values), starts.first, starts.last), points.rows, parts
