"""What a chain can do: full pose, position and tool vector, or position alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from chainbuild import tolerances
from chainbuild.chain.elements import Task
from chainbuild.kinematics.evaluation import Kinematics

_SAMPLES = 8


def choose_task(kinematics: Kinematics, free: NDArray[np.bool_]) -> Task:
    """Return the task of a chain from the ranks of its Jacobian.

    A chain of six freedoms is given a full pose. With fewer, position and tool vector are given where they
    determine all axes, position alone where that does; else (a SCARA: the tool vector never changes and the turn
    about it matters) the full pose again, of which only what the chain can reach will be met.

    Args:
        kinematics: The chain's evaluator.
        free: (n_axes,) True for the axes that the solver may move.
    """
    task = kinematics.chain.task
    if task != "auto":
        return task
    shift, turn = [0, 1, 2], [n for n in (3, 4, 5) if n != 3 + kinematics.tool_axis]
    ranks = {len(rows): _generic_rank(kinematics, free, rows) for rows in (shift, shift + turn, list(range(6)))}
    if ranks[6] == 6:
        return "pose"
    if ranks[3] == ranks[6]:
        return "position"
    return "direction" if ranks[5] == ranks[6] else "pose"


def _generic_rank(kinematics: Kinematics, free: NDArray[np.bool_], rows: list[int]) -> int:
    """Return the largest rank of some rows of the Jacobian over a few fixed configurations."""
    rng = np.random.default_rng(0)
    axes = kinematics.chain.axes
    lower = np.array([max(axis.lower, -170.0) for axis in axes]) * kinematics.si_factors
    upper = np.array([min(axis.upper, 170.0) for axis in axes]) * kinematics.si_factors
    best = 0
    for _ in range(_SAMPLES):
        _, J = kinematics.pose_and_jacobian(lower + (upper - lower) * rng.random(len(axes)))
        values = np.linalg.svd(J[rows][:, free], compute_uv=False)
        if values.size and values[0] > 0.0:
            best = max(best, int((values > tolerances.RANK * values[0]).sum()))
    return best
