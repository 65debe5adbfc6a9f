"""What formulas need to know of axes: how they and the angles give each other, whole turns, limits."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.tolerances import LIMIT_SLACK

_NO_LIMIT: Final = 1e300  # infinity times zero turns would be no number

# The last rows of an array of constants (n, 6), by name; see `operands.rows_of_axes`.
AXIS_ROWS: Final = (
    "turn",  # (6, 6) axis values = turn·θ + shift, mm and degrees
    "shift",
    "back",  # (6, 6) θ = back·axes + zero
    "zero",
    "wanted",  # axis values at the start: whole turns end near to them
    "period",  # a whole turn
    "per_turn",  # its inverse
    "lower",  # limits, large numbers where there are none
    "upper",
    "slack",  # how far beyond a limit rounding may be
)


def axis_constants(
    query: BranchQuery, back: Matrix, zero: Vector, wanted: Vector, *, limits: bool
) -> dict[str, object]:
    """Return the rows of `AXIS_ROWS` by name.

    Args:
        query: The machine.
        back: (6, 6) from axis values, mm and degrees, to angles,
        zero: (6,) and where these are 0 [rad].
        wanted: (6,) axis values at the start.
        limits: False: ignore the limits.
    """
    factors, turn = query.mechanism.kinematics.si_factors, np.linalg.inv(back)
    lower, upper = (np.clip(values / factors, -_NO_LIMIT, _NO_LIMIT) for values in (query.lower, query.upper))
    return {
        "turn": turn,
        "shift": -turn @ zero,
        "back": back,
        "zero": zero,
        "wanted": wanted,
        "period": math.tau / factors,
        "per_turn": factors / math.tau,
        "lower": lower if limits else np.full(6, -_NO_LIMIT),
        "upper": upper if limits else np.full(6, _NO_LIMIT),
        "slack": np.full(6, LIMIT_SLACK),
    }
