"""The one damped descent: Newton steps on a residual, as long as they get better.

Everything but the search itself (`ik.search`, whose plain and compiled twins take such steps at a tenth of the cost)
descends by this function: the polish of closed forms, the control's own budget, what a four-axis robot is programmed
by, the null-space search, the branches that many starts lead to.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import eigenpy
import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector

Residual = Callable[[Vector], tuple[Vector, Matrix]]
Damping = Callable[[Vector, Vector], float]


class Descent(NamedTuple):
    """Where a descent ended.

    Attributes:
        x: (n,) SI values.
        error: (k,) the residual there.
        steps: Steps taken.
        met: True where the residual is small enough there.
    """

    x: Vector
    error: Vector
    steps: int
    met: bool


class Stall(NamedTuple):
    """When a descent is given up: after so many steps in a row that leave more than this share of the squared error."""

    steps: int
    share: float


def newton(
    residual: Residual,
    x: Vector,
    free: NDArray[np.intp],
    met: Callable[[Vector], bool],
    damping: Damping,
    steps: int,
    stall: Stall | None = None,
) -> Descent:
    """Descend by damped Newton steps until the residual is met, the steps are used up or nothing gets better.

    Args:
        residual: x → error (k,) and its Jacobian (k, n), SI; the error is the remaining motion.
        x: (n,) SI values to start from; left as they are.
        free: Indices of the values that may move.
        met: Whether an error is small enough.
        damping: x, error → the damping λ of the step (JᵀJ + λ·1)·dx = Jᵀ·error; see `shrinking`.
        steps: Steps at most.
        stall: When to give up before; None: never.
    """
    mark, since = np.inf, 0
    error, J = residual(x)
    for taken in range(steps):
        squared = float(error @ error)
        if not np.isfinite(squared) or met(error):
            return Descent(x, error, taken, bool(np.isfinite(squared)))
        if stall is not None and squared > stall.share * mark:
            since += 1
            if since >= stall.steps:
                return Descent(x, error, taken, False)
        else:
            mark, since = squared, 0
        x = x.copy()
        x[free] += damped_step(J[:, free], error, damping(x, error))
        error, J = residual(x)
    return Descent(x, error, steps, bool(np.isfinite(error).all()) and met(error))


def below(squared: float) -> Callable[[Vector], bool]:
    """Return the test whether the squared length of an error is below a number."""
    return lambda error: float(error @ error) < squared


def shrinking(share: float, floor: float) -> Damping:
    """Return a damping that follows the squared error: far away steps are short and safe, close by they are Newton's.

    Args:
        share: Of the squared error.
        floor: What keeps the factorisation alive at singular points.
    """
    return lambda x, error: share * float(error @ error) + floor


def damped_step(J: Matrix, error: Vector, damping: float) -> Vector:
    """Return the damped least-squares step (JᵀJ + damping·1)⁻¹·Jᵀ·error."""
    rows, columns = J.shape
    if rows == 1 or columns == 1:  # eigenpy gives solutions of one number a shape of their own
        single: Vector = J.T @ error / (float((J * J).sum()) + damping)
        return single
    if rows < columns:
        H = J @ J.T
        H.flat[:: rows + 1] += damping
        short: Vector = J.T @ eigenpy.LLT(H).solve(error)
        return short
    H = J.T @ J
    H.flat[:: columns + 1] += damping
    step: Vector = eigenpy.LLT(H).solve(J.T @ error)
    return step
