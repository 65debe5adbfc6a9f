"""Options of the damped solver."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from chainbuild import tolerances
from chainbuild.errors import ChainbuildError
from chainbuild.shown import compact


@compact
@dataclass(frozen=True, slots=True, kw_only=True)
class IkOptions:
    """Options of the damped solver.

    Attributes:
        position_tolerance: Largest permitted distance between answer and pose [m].
        rotation_tolerance: Largest permitted angle between them [rad].
        weights: Six weights of the error in the tool frame: x, y, z [1/m], then about x, y, z [1/rad]. They decide
            what counts if a pose cannot be met exactly; 0 frees a direction. None, one (the direction of that axis
            remains) or all three of the rotations may be free.
        max_restarts: Number of starts after the first.
        seed: Seed of the starts.
        compiled: False: use the plain path even if the compiled one is installed.
        accuracy: (4,) derived: squared error [m², rad²] at which an iteration ends, three digits better than what is
            verified; the tolerances; permitted deviation of a matrix from a rotation.
    """

    position_tolerance: float = tolerances.IK_POSITION_M
    rotation_tolerance: float = tolerances.IK_ROTATION_RAD
    weights: tuple[float, float, float, float, float, float] = (1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
    max_restarts: int = 100
    seed: int = 0
    compiled: bool = True
    accuracy: NDArray[np.float64] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        for name in ("position_tolerance", "rotation_tolerance"):
            if not (1e-12 <= getattr(self, name) <= 1.0):
                raise ChainbuildError(f"{name} is {getattr(self, name)}", parameter=name, permitted="1e-12 … 1")
        if len(self.weights) != 6 or not all(math.isfinite(w) and w >= 0.0 for w in self.weights):
            raise ChainbuildError("wrong weights", parameter="weights", permitted="six finite numbers, none negative")
        if sum(w == 0.0 for w in self.weights[3:]) == 2 or not any(self.weights):
            raise ChainbuildError(
                "the weights define no task",
                parameter="weights",
                permitted="none, one or three free rotations, and at least one weight above 0",
            )
        if self.max_restarts < 0:
            raise ChainbuildError("max_restarts is negative", parameter="max_restarts", permitted="0, 1, …")
        least = min(self.position_tolerance, self.rotation_tolerance)
        accuracy = ((1e-3 * least) ** 2, self.position_tolerance, self.rotation_tolerance, tolerances.ROTATION_MATRIX)
        object.__setattr__(self, "accuracy", np.array(accuracy))


DEFAULT = IkOptions()
