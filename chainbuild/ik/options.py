"""What a user may ask of the damped solver."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from chainbuild import tolerances
from chainbuild.errors import ChainbuildError
from chainbuild.shown import fields_shown


@dataclass(frozen=True, slots=True, kw_only=True)
class IkOptions:
    """Options of the damped solver.

    Attributes:
        position_tolerance: Distance by which an answer may miss the pose [m].
        rotation_tolerance: Angle by which it may [rad].
        weights: Six weights of the error in the tool frame: x, y, z [1/m], then about x, y, z [1/rad]. They decide
            what counts where a pose cannot be met exactly; 0 frees a direction for good. Of the turns either none,
            one (what remains is the direction of that axis) or all three may be free.
        max_restarts: Starts after the first before the search gives up.
        seed: Seed of the starts.
        compiled: False: use the plain path even where the compiled one is installed.
        accuracy: (4,) follows: squared error [m², rad²] at which an iteration ends, three digits better than what is
            verified; the tolerances; how far a rotation may be from one.
    """

    position_tolerance: float = tolerances.IK_POSITION_M
    rotation_tolerance: float = tolerances.IK_ROTATION_RAD
    weights: tuple[float, float, float, float, float, float] = (1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
    max_restarts: int = 100
    seed: int = 0
    compiled: bool = True
    accuracy: NDArray[np.float64] = field(init=False, repr=False, compare=False)

    __repr__ = fields_shown

    def __post_init__(self) -> None:
        for name in ("position_tolerance", "rotation_tolerance"):
            if not (1e-12 <= getattr(self, name) <= 1.0):
                raise ChainbuildError(f"{name} is {getattr(self, name)}", parameter=name, permitted="1e-12 … 1")
        if len(self.weights) != 6 or not all(math.isfinite(w) and w >= 0.0 for w in self.weights):
            raise ChainbuildError("bad weights", parameter="weights", permitted="six finite numbers, none negative")
        if sum(w == 0.0 for w in self.weights[3:]) == 2 or not any(self.weights):
            raise ChainbuildError(
                "these weights leave no task",
                parameter="weights",
                permitted="none, one or three free turns, and something to do",
            )
        if self.max_restarts < 0:
            raise ChainbuildError("max_restarts is negative", parameter="max_restarts", permitted="0, 1, …")
        least = min(self.position_tolerance, self.rotation_tolerance)
        accuracy = ((1e-3 * least) ** 2, self.position_tolerance, self.rotation_tolerance, tolerances.ROTATION_MATRIX)
        object.__setattr__(self, "accuracy", np.array(accuracy))


DEFAULT = IkOptions()
