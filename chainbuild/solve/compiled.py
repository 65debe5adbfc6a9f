"""The door to the compiled path: is it there, and problems as its arrays."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from chainbuild import tolerances
from chainbuild.solve.found import Found
from chainbuild.solve.options import IkOptions

if TYPE_CHECKING:
    from chainbuild.solve.problem import Problem

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


@cache
def available() -> bool:
    """Return whether numba is installed (extra `fast`) and goes with the NumPy there is."""
    try:
        import_module("numba")
    except ImportError:
        return False
    return True


def search(packed: Packed, target: Matrix, start: Vector | None, wanted: Vector, options: IkOptions) -> Found:
    """Search by compiled code; see `plain.search`. The outcome may be NOT_RIGID."""
    data, sizes = packed.data, packed.sizes
    points = np.array((wanted if start is None else start, wanted))
    answer = np.empty(points.shape)
    ended: tuple[int, int, int, float, float] = entries().search_one(
        data, sizes, target, points, start is not None, accuracy_of(options), options.max_restarts, answer
    )
    return Found(*ended, answer[0], answer[1])


@cache
def accuracy_of(options: IkOptions) -> Vector:
    """Return what the compiled code takes for tolerances."""
    tolerances_ = (options.position_tolerance, options.rotation_tolerance, tolerances.ROTATION_MATRIX)
    return np.array([options.residual_squared, *tolerances_])


@cache
def entries() -> Any:
    """Return the module of compiled entry points; numba is imported here, not before it is needed."""
    from chainbuild.solve import compiled_entries

    return compiled_entries


@dataclass(frozen=True, slots=True, eq=False)
class Packed:
    """A problem in one array, as `compiled_kernels.unpack` takes it apart."""

    data: NDArray[np.float64]
    sizes: NDArray[np.int64]


def packed(problem: Problem) -> Packed | None:
    """Return a problem in one array, or None where its axis map is not affine."""
    if not problem.compiled:
        problem.compiled.append(_pack(problem))
    found: Packed | None = problem.compiled[0]
    return found


def _pack(problem: Problem) -> Packed | None:
    product = problem.robot.kinematics.product
    if product is None:
        return None
    box, starts, A = problem.box, problem.starts, product.A[:, problem.free]
    weights = problem.weights
    parts = (
        product.fixed[:, :3], product.prismatic, A, product.b + product.A @ problem.x,
        box.lower, box.upper, box.periodic, box.sums, box.sum_lower, box.sum_upper,
        weights, starts.points, starts.features, starts.scale,
    )  # fmt: skip
    flat = [np.asarray(part, dtype=float).ravel() for part in parts]
    task = (problem.axis, problem.shown_axis, np.count_nonzero(weights), (weights != 1.0).any())
    sizes = (*A.shape, len(box.sums), len(starts.points), *task, *np.cumsum([len(part) for part in flat]))
    return Packed(np.concatenate(flat), np.array(sizes, dtype=np.int64))
