"""Curves of solutions, cut by holding one joint: what is left of a chain has isolated solutions.

Where the solutions of a pose form curves, the equations separate none of them, and poses beside it may have none at
all. But a curve along which a joint moves crosses each value of that joint in its range at single points, and these
are solutions of the chain whose joint stands still. The joint that is gone is supplemented by an idle one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix
from chainbuild.ik.branches.arms.virtual_joints import NO_JOINT, with_virtual_joints
from chainbuild.ik.branches.core.serial import ArmSolver, Serial, Solution

# An idle joint that turns less than this [rad] stands still: the digits that a singular pose loses.
_STANDS: Final = 1e-3


def on_curves(
    serial: Serial, target: Matrix, keep: Sequence[float], solver: Callable[[Serial], ArmSolver | None]
) -> list[Solution]:
    """Return solutions at which a joint has its value to keep, each joint in turn.

    Args:
        serial: The chain as screws.
        target: (4, 4) the pose.
        keep: Values to keep.
        solver: Returns the solver of a chain of as many screws, or None.
    """
    joints = [n for n, screw in enumerate(serial.screws) if screw.joint != NO_JOINT]
    return [one for n in joints for one in _held(serial, n, target, keep, solver)]


def _held(
    serial: Serial, n: int, target: Matrix, keep: Sequence[float], solver: Callable[[Serial], ArmSolver | None]
) -> Iterator[Solution]:
    """Yield the solutions of a chain at the value to keep of a joint: those at which the idle joint stands still."""
    count, value = len(serial.screws), keep[n]
    still = serial.screws[n].T(value)
    rest = (*serial.screws[:n], *(screw.transformed(still) for screw in serial.screws[n + 1 :]))
    solve = solver(with_virtual_joints(Serial(rest, still @ serial.M), 1))
    if solve is None:
        return
    for values, free in solve(target, [*keep[:n], *keep[n + 1 :], 0.0]):
        if abs(math.remainder(float(values[-1]), math.tau)) < _STANDS:
            yield np.insert(values[: count - 1], n, value), (*free[:n], False, *free[n : count - 1])
