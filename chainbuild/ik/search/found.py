"""The raw outcome of a search, the same for the plain and the compiled path."""

from __future__ import annotations

from typing import NamedTuple

from chainbuild.arrays import Vector


class SearchEnd(NamedTuple):
    """Raw outcome of a search.

    Attributes:
        outcome: OK, LIMITS, STALLED or UNREACHABLE of `rules`.
        iterations: Steps over all starts.
        restarts: Starts after the first.
        distance: Distance left [m].
        angle: Angle left [rad].
        y: (n_free,) the answer, or the nearest found inside the limits [SI].
        outside: (n_free,) with outcome LIMITS a point that meets the pose and violates the limits least.
    """

    outcome: int
    iterations: int
    restarts: int
    distance: float
    angle: float
    y: Vector
    outside: Vector
