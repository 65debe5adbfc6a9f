"""RTCP programming: position and rotary axes are given, the linear axes alone are found, exactly.

With the rotary axes fixed the position is an affine function of the linear ones: one 3×3 system a pose.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.errors import ChainbuildError
from chainbuild.ik.result import STATUSES, IkResult, Status
from chainbuild.ik.search.compiled import packing
from chainbuild.ik.search.table import FailureWords, IkTable
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.kinematics.product import Product, slides_at
from chainbuild.tolerances import IK_POSITION_M

_POSITION: Final = 3  # linear axes that a position determines
_RCOND: Final = 1e-9  # directions of slides closer to parallel than this count as one
_SWEEPS: Final = 2  # the system is affine: the second takes off what rounding left of large offsets


def linear_axes(mechanism: Mechanism, position: Vector, axes: Vector) -> IkResult:
    """Return the linear axes for a position, all other axes staying where they are.

    Args:
        mechanism: The mechanism; `Display.solved` names the linear axes.
        position: (3,) tool tip in the workpiece frame [m].
        axes: (n_axes,) axis values, mm and degrees; those of the linear axes are where a slide starts that no position
            determines.
    """
    kinematics, solved = mechanism.kinematics, list(mechanism.chain.display.solved)
    x = axes * kinematics.si_factors
    try:
        mechanism.q(axes)
    except ChainbuildError as error:
        return _result(mechanism, axes, "unreachable", float("inf"), error.message)
    for _ in range(_SWEEPS):
        T, J = kinematics.pose_and_jacobian(x)
        missing = T.rotation.T @ (position - T.translation)
        x[solved] += np.linalg.lstsq(J[:3, solved], missing, rcond=_RCOND)[0]
    distance = float(np.linalg.norm(kinematics.pose(kinematics.q(x)).translation - position))
    found = axes.copy()
    found[solved] = (x / kinematics.si_factors)[solved]
    return judged(mechanism, found, distance)


def judged(mechanism: Mechanism, axes: Vector, distance: float) -> IkResult:
    """Return axis values (n_axes,) as a result: met or not, inside the limits or not."""
    if not distance <= IK_POSITION_M:
        reason = "the linear axes cannot reach the position with the rotary axes given"
        return _result(mechanism, axes, "unreachable", distance, reason)
    violated = mechanism.limits.violated(axes)
    if violated:
        reason = mechanism.limits.words(axes)
        return _result(mechanism, axes, "limits", distance, reason, violated)
    return _result(mechanism, mechanism.limits.onto(axes), "ok", distance)


def _result(
    mechanism: Mechanism,
    axes: Vector,
    status: Status,
    distance: float,
    reason: str = "",
    violated: tuple[str, ...] = (),
) -> IkResult:
    return IkResult(
        status == "ok", axes, status, distance, 0.0, 1, 0, "position", mechanism.labels, reason, violated
    )  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class _Explain:
    """States why a row failed, when it is asked for."""

    mechanism: Mechanism
    positions: Matrix
    axes: Matrix

    def __call__(self, row: int, result: IkResult) -> FailureWords:
        again = linear_axes(self.mechanism, self.positions[row], self.axes[row])
        return FailureWords(again.reason, again.violated)


def linear_axes_batch(mechanism: Mechanism, positions: Matrix, axes: Matrix, *, compiled: bool = True) -> IkTable:
    """Return the linear axes for many positions; see `linear_axes`.

    Args:
        mechanism: The mechanism.
        positions: (N, 3) tool tip in the workpiece frame [m].
        axes: (N, n_axes) axis values, mm and degrees.
        compiled: False: NumPy, even where numba is installed.
    """
    product, solved = mechanism.kinematics.product, mechanism.chain.display.solved
    found, distances = axes.copy(), np.empty(len(axes))
    if product is None or len(solved) != _POSITION:
        for n, (position, row) in enumerate(zip(positions, axes, strict=True)):
            one = linear_axes(mechanism, position, row)
            found[n], distances[n] = one.axes, one.position_error
    elif compiled and packing.available():
        from chainbuild.ik.search.compiled.slides import write_linear_axes

        write_linear_axes(
            product.fixed, product.prismatic, product.A * mechanism.kinematics.si_factors, product.b,
            np.array(solved, dtype=np.int64), positions, found, distances,
        )  # fmt: skip
    else:
        _write_linear_axes(mechanism, product, positions, found, distances)
    counts = np.zeros((len(axes), 3), dtype=np.int64)
    counts[~mechanism.limits.inside_rows(found), 0] = STATUSES.index("limits")
    counts[~(distances <= IK_POSITION_M), 0] = STATUSES.index("unreachable")
    misses = np.column_stack((distances, np.zeros(len(axes))))
    explain = _Explain(mechanism, positions, axes)
    return IkTable(found, counts, misses, "position", mechanism.labels, explain)


def _write_linear_axes(
    mechanism: Mechanism, product: Product, positions: Matrix, found: Matrix, distances: Vector
) -> None:
    """Write the linear axes by NumPy; see `compiled.slides.write_linear_axes`."""
    solved, factors = np.array(mechanism.chain.display.solved), mechanism.kinematics.si_factors
    found[:, solved] = 0.0
    places, rates = slides_at(product, found, factors, solved)
    missing = positions - places
    steps = _solved(rates, missing)
    distances[:] = np.linalg.norm(np.einsum("nij,nj->ni", rates, steps) - missing, axis=1)
    found[:, solved] = steps / factors[solved]


def _solved(rates: Matrix, missing: Matrix) -> Matrix:
    """Return the solutions (N, 3) of 3×3 systems by cross products: a third of the time of a general solver."""
    a, b, c = rates[:, :, 0], rates[:, :, 1], rates[:, :, 2]
    across = np.cross(b, c)
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = 1.0 / np.einsum("ni,ni->n", a, across)
        found = np.stack(
            [
                np.einsum("ni,ni->n", missing, across),
                np.einsum("ni,ni->n", missing, np.cross(c, a)),
                np.einsum("ni,ni->n", missing, np.cross(a, b)),
            ],
            axis=1,
        )
        steps: Matrix = found * scale[:, None]
    return steps
