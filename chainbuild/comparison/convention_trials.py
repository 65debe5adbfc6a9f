"""Trials of conventions: which choices would make a recording agree."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Vector
from chainbuild.comparison.comparison import forward_poses, pose_errors
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.shown import fields_shown

if TYPE_CHECKING:
    from chainbuild.chain.elements import Chain, Task
    from chainbuild.formats.machine import Machine
    from chainbuild.tables.recording import Recording


_MAX_PAIRS: Final = 400  # bound on the time: a trial builds a chain
_MAX_POSES: Final = 200  # more of them tell nothing new about a choice


@dataclass(frozen=True, slots=True)
class Selection:
    """Selected kinematic of a machine; see `Machine.chain`."""

    __repr__ = fields_shown

    kinematic: int | str | tuple[int | str, int | str] | None = None
    channel: int | None = None
    tool_length_mm: float = 0.0


@dataclass(frozen=True, slots=True)
class Trial:
    """Choices of conventions and the resulting errors.

    Attributes:
        choices: Convention name → choice; empty for those in force.
        position_error: Worst distance [m]; infinite if the chain cannot be built.
        rotation_error: Worst angle [rad].
        agrees: Whether all poses are within tolerance.
    """

    __repr__ = fields_shown

    choices: Mapping[str, str]
    position_error: float
    rotation_error: float
    agrees: bool


def try_conventions(
    machine: Machine,
    selection: Selection,
    chosen: Mapping[str, str],
    axes: Vector,
    theirs: NDArray[np.float64],
    compared: Task,
    tolerance: tuple[float, float],
    recording: Recording | None = None,
) -> tuple[Trial, ...]:
    """Return the errors for each other choice of the machine's conventions, the best first.

    If no single choice makes the poses agree, pairs are tried.

    Args:
        machine: The machine.
        selection: Which kinematic.
        chosen: Choices made by the user.
        axes: (n, n_axes) axis values, mm and degrees.
        theirs: (n, 4, 4) poses [m].
        compared: Part of the poses that is compared.
        tolerance: Metres and radians within which poses agree.
        recording: Where the poses come from: a choice may give its columns another meaning.
    """
    some = np.unique(np.linspace(0, len(axes) - 1, min(len(axes), _MAX_POSES)).astype(int))
    bench = _TrialRun(machine, selection, chosen, axes[some], theirs[some], compared, tolerance, recording, some)
    singles = [bench.trial(dict([choice])) for choice in bench.alternatives()]
    if not any(trial.agrees for trial in singles):
        singles += [bench.trial(dict(pair)) for pair in itertools.islice(bench.pairs(), _MAX_PAIRS)]
    singles.sort(key=bench.score)
    return tuple(singles)


@dataclass(frozen=True, slots=True)
class _TrialRun:
    """Data that all trials share."""

    machine: Machine
    selection: Selection
    chosen: Mapping[str, str]
    axes: Vector
    theirs: NDArray[np.float64]
    compared: Task
    tolerance: tuple[float, float]
    recording: Recording | None
    some: NDArray[np.int_]

    def score(self, trial: Trial) -> float:
        return max(trial.position_error / self.tolerance[0], trial.rotation_error / self.tolerance[1])

    def alternatives(self) -> list[tuple[str, str]]:
        """Return every (name, choice) that is not in force and can change a pose."""
        used = [one for one in self._chain({}).conventions if one.convention.poses]
        return [
            (one.convention.name, choice) for one in used for choice in one.convention.choices if choice != one.choice
        ]

    def pairs(self) -> Iterator[tuple[tuple[str, str], tuple[str, str]]]:
        """Yield pairs of alternatives of two different conventions."""
        for one, other in itertools.combinations(self.alternatives(), 2):
            if one[0] != other[0]:
                yield one, other

    def _chain(self, choices: Mapping[str, str]) -> Chain:
        s = self.selection
        return self.machine.chain(s.kinematic, s.channel, s.tool_length_mm, {**self.chosen, **choices})

    def trial(self, choices: Mapping[str, str]) -> Trial:
        """Return the trial of a set of choices."""
        try:
            robot = Mechanism(self._chain(choices))
            ours = forward_poses(robot, self.axes)
            theirs = self.theirs if self.recording is None else self.recording.read_for(robot.chain)[self.some]
        except ChainbuildError:
            return Trial(choices, np.inf, np.inf, False)
        column = robot.chain.tool_column
        distance, angle = pose_errors(ours, theirs, self.compared, column)
        worst = [float(np.where(np.isfinite(e), e, np.inf).max()) for e in (distance, angle)]
        agrees = worst[0] <= self.tolerance[0] and worst[1] <= self.tolerance[1]
        return Trial(choices, worst[0], worst[1], agrees)
