"""Evidence: axis values and poses that disagree, and what a chain that is tried leaves of their difference."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrices, Vector
from chainbuild.comparison.comparison import pose_errors
from chainbuild.shown import fields_shown

if TYPE_CHECKING:
    from chainbuild.chain.elements import Chain, Task
    from chainbuild.tables.recording import Recording


class Errors(Protocol):
    """What a trial leaves."""

    @property
    def position_error(self) -> float:
        """Worst distance [m]."""

    @property
    def rotation_error(self) -> float:
        """Worst angle [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """Axis values and the other solver's poses that disagree.

    Attributes:
        axes: (n, n_axes) mm and degrees.
        theirs: (n, 4, 4) poses [m]; of a recording as the chain that was compared means them.
        compared: Part of the poses that is compared.
        tolerance: Metres and radians within which poses agree.
        recording: Where the poses come from: another chain may mean other poses by its columns.
        rows: (n,) indices of the poses in the recording; None: all.
    """

    __repr__ = fields_shown

    axes: Vector
    theirs: Matrices
    compared: Task
    tolerance: tuple[float, float]
    recording: Recording | None = None
    rows: NDArray[np.int_] | None = None

    def some(self, count: int, *, posed: bool = True) -> Evidence:
        """Return at most so many rows, spread over all or over those that have a pose."""
        rows = np.flatnonzero(np.isfinite(self.theirs).all(axis=(1, 2)) | (not posed))
        chosen = rows[np.unique(np.linspace(0, len(rows) - 1, min(len(rows), count)).astype(int))]
        return replace(
            self,
            axes=self.axes[chosen],
            theirs=self.theirs[chosen],
            rows=chosen if self.rows is None else self.rows[chosen],
        )

    def theirs_for(self, chain: Chain) -> Matrices:
        """Return the poses as a chain means them: what a recording leaves out follows from the chain that is tried.

        Raises:
            ChainbuildError: the recording has no such columns.
        """
        return self.theirs if self.recording is None else self.recording.read_for(chain, rows=self.rows)

    def left(self, ours: Matrices, theirs: Matrices, column: int) -> tuple[float, float, bool]:
        """Return the worst distance [m] and angle [rad] between poses, and whether all agree.

        Args:
            ours: (n, 4, 4) poses of a chain [m].
            theirs: (n, 4, 4) poses that it should have.
            column: Column of the rotation that is the tool direction.
        """
        errors = pose_errors(ours, theirs, self.compared, column)
        distance, angle = (float(np.where(np.isfinite(e), e, np.inf).max()) for e in errors)
        return distance, angle, distance <= self.tolerance[0] and angle <= self.tolerance[1]

    def score(self, left: Errors) -> float:
        """Return the larger error that a trial leaves, each as a multiple of its tolerance."""
        return max(left.position_error / self.tolerance[0], left.rotation_error / self.tolerance[1])
