"""Trials of conventions: which choices would make a recording agree."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from chainbuild.comparison.comparison import forward_poses
from chainbuild.comparison.evidence import Evidence
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.progress import Progress, counting
from chainbuild.shown import fields_shown

if TYPE_CHECKING:
    from chainbuild.chain.elements import Chain
    from chainbuild.formats.machine import Machine


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
    evidence: Evidence,
    progress: Progress = False,
) -> tuple[Trial, ...]:
    """Return the errors for each other choice of the machine's conventions, the best first.

    If no single choice makes the poses agree, pairs are tried.

    Args:
        machine: The machine.
        selection: Which kinematic.
        chosen: Choices made by the user.
        evidence: The poses that disagree.
        progress: A bar, or a function of the choices done and all choices; pairs are counted anew.
    """
    some = evidence.some(_MAX_POSES, posed=False)
    bench = _TrialRun(machine, selection, chosen, some)
    alternatives = bench.alternatives()
    singles = bench.trials([dict([choice]) for choice in alternatives], progress, "conventions")
    if not any(trial.agrees for trial in singles):
        singles += bench.trials(_pairs(alternatives), progress, "pairs of conventions")
    return tuple(sorted(singles, key=some.score))


def _pairs(alternatives: list[tuple[str, str]]) -> list[dict[str, str]]:
    """Return pairs of alternatives of two different conventions."""
    pairs = (dict(pair) for pair in itertools.combinations(alternatives, 2) if pair[0][0] != pair[1][0])
    return list(itertools.islice(pairs, _MAX_PAIRS))


@dataclass(frozen=True, slots=True)
class _TrialRun:
    """Data that all trials share."""

    machine: Machine
    selection: Selection
    chosen: Mapping[str, str]
    evidence: Evidence

    def alternatives(self) -> list[tuple[str, str]]:
        """Return every (name, choice) that is not in force and can change a pose."""
        used = [one for one in self._chain({}).conventions if one.convention.poses]
        return [
            (one.convention.name, choice) for one in used for choice in one.convention.choices if choice != one.choice
        ]

    def _chain(self, choices: Mapping[str, str]) -> Chain:
        s = self.selection
        return self.machine.chain(s.kinematic, s.channel, s.tool_length_mm, {**self.chosen, **choices})

    def trials(self, tried: Sequence[Mapping[str, str]], progress: Progress, what: str) -> list[Trial]:
        """Return the trial of each set of choices."""
        found = []
        with counting(len(tried), progress, what) as advance:
            for choices in tried:
                found.append(self._trial(choices))
                advance(1)
        return found

    def _trial(self, choices: Mapping[str, str]) -> Trial:
        try:
            robot = Mechanism(self._chain(choices))
            ours, theirs = forward_poses(robot, self.evidence.axes), self.evidence.theirs_for(robot.chain)
        except ChainbuildError:
            return Trial(choices, math.inf, math.inf, False)
        return Trial(choices, *self.evidence.left(ours, theirs, robot.chain.tool_column))
