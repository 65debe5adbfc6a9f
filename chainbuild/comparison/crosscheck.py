"""Cross-check: chainbuild's model against another solver or against poses recorded on the controller."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from chainbuild.comparison.comparison import (
    POSITION_TOLERANCE_M,
    ROTATION_TOLERANCE_RAD,
    Forward,
    Inverse,
    compare_forward,
    compare_inverse,
)
from chainbuild.comparison.convention_trials import Selection, Trial, try_conventions
from chainbuild.comparison.data_trials import DataTrial, try_data
from chainbuild.comparison.diagnosis import Explanation, explain, tried_changes
from chainbuild.comparison.evidence import Evidence
from chainbuild.comparison.other_solvers import (
    CallableKind,
    OtherSolver,
    other_solver_by_name,
    other_solver_from_function,
)
from chainbuild.comparison.samples import MADE_KINDS, SampleKind, Samples, make_samples
from chainbuild.errors import ChainbuildError
from chainbuild.ik.plan import plan_of
from chainbuild.progress import Progress
from chainbuild.shown import fields_shown, two_lines
from chainbuild.tables.recording import Recording

if TYPE_CHECKING:
    from chainbuild.formats.machine import Machine
    from chainbuild.kinematics.mechanism import Mechanism


_RECORDED_POSITION_M: Final = 1e-5  # controllers show micrometres or tenths
_RECORDED_ROTATION_RAD: Final = 1e-4  # controllers show thousandths of a degree or hundredths
_MAX_TRIALS: Final = 8  # of those that do not agree, in the result
_MAX_DATA: Final = 3  # likewise of machine data: every one has a best value


@dataclass(frozen=True, slots=True, eq=False)
class CrossCheck:
    """Result of a cross-check.

    Attributes:
        title: The machine.
        kinematic: "ROBX NR", "KIN_TYP 45", … .
        axes: Axis names.
        reference: Name of the other solver or recording.
        note: Its source.
        forward: Forward kinematics compared, or None.
        inverse: Inverse kinematics compared, or None.
        complete: Whether chainbuild's own branches come from a closed form.
        explanation: Structure of the error, or None.
        tried: The changes tried, as text; empty if nothing disagrees systematically.
        trials: Conventions tried, the best first; empty if none was open.
        data: Machine data with another sign or value: all that would make the poses agree, else the best.
        conventions: Name → choice in force.
    """

    title: str
    kinematic: str
    axes: tuple[str, ...]
    reference: str
    note: str
    forward: Forward | None = None
    inverse: Inverse | None = None
    complete: bool = True
    explanation: Explanation | None = None
    tried: tuple[str, ...] = ()
    trials: tuple[Trial, ...] = ()
    data: tuple[DataTrial, ...] = ()
    conventions: Mapping[str, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        parts = []
        if self.forward is not None:
            parts.append(f"{int(self.forward.agrees.sum())} of {len(self.forward.samples)} poses agree")
        if self.inverse is not None:
            parts.append(f"{self.inverse.wrong} of {self.inverse.theirs} answers wrong")
        if self.explanation is not None:
            parts.append(self.explanation.text)
        verdict = "agrees" if self.agrees else "differs"
        return two_lines(f"<CrossCheck of {self.title} with {self.reference}: {verdict}; {'; '.join(parts)}>")

    @property
    def agrees(self) -> bool:
        """Whether everything compared agrees."""
        forward = self.forward is None or bool(self.forward.agrees.all())
        return forward and (self.inverse is None or self.inverse.agrees)

    @property
    def deciding(self) -> tuple[Trial, ...]:
        """The trials of conventions that would make everything agree."""
        return tuple(trial for trial in self.trials if trial.agrees)

    @property
    def deciding_data(self) -> tuple[DataTrial, ...]:
        """The machine data that would make everything agree: one of them is wrong, and the poses do not tell which."""
        return tuple(trial for trial in self.data if trial.agrees)


@dataclass(frozen=True, slots=True)
class CheckOptions:
    """How to cross-check.

    Attributes:
        count: Number of poses, shared among the kinds.
        samples: Of "random", "grid", "singular".
        seed: Seed of the samples.
        position_tolerance: [m]; None: 1e-6, for recordings 1e-5.
        rotation_tolerance: [rad]; None: 1e-6, for recordings 1e-4.
        kind: What a callable is: "fk", "ik" or "auto".
    """

    __repr__ = fields_shown

    count: int = 300
    samples: Sequence[str] = MADE_KINDS
    seed: int = 0
    position_tolerance: float | None = None
    rotation_tolerance: float | None = None
    kind: CallableKind = "auto"

    def tolerance(self, recorded: bool) -> tuple[float, float]:
        """Return metres and radians within which poses agree.

        Raises:
            ChainbuildError: a tolerance is not a positive number.
        """
        defaults = (
            (_RECORDED_POSITION_M, _RECORDED_ROTATION_RAD)
            if recorded
            else (POSITION_TOLERANCE_M, ROTATION_TOLERANCE_RAD)
        )
        given = (self.position_tolerance, self.rotation_tolerance)
        distance, angle = (default if g is None else g for g, default in zip(given, defaults, strict=True))
        if not (0.0 < distance < 1.0 and 0.0 < angle < 1.0):
            raise ChainbuildError("a tolerance is out of range", permitted="more than 0, less than 1 m or rad")
        return distance, angle


def crosscheck(
    robot: Mechanism,
    solver: str | Callable[..., Any] | Recording,
    *,
    options: CheckOptions | None = None,
    machine: Machine | None = None,
    selection: Selection | None = None,
    conventions: Mapping[str, str] | None = None,
    progress: Progress = False,
) -> CrossCheck:
    """Compare a robot with another solver or with a recording, and diagnose differences.

    Args:
        robot: The robot.
        solver: "eaik", "opw", "roboticstoolbox", "module:function", a function (axis values (n,) in mm and degrees →
            pose (4, 4) in metres, or pose → rows of axis values), or a `Recording`.
        options: Samples and tolerances.
        machine: The machine the robot was built from; its data and conventions are tried if poses differ.
        selection: Which kinematic of it.
        conventions: Choices made by the user when the robot was built.
        progress: Bars for the trials of conventions, their pairs and machine data, or a function that is called for
            each with the trials done and all trials.

    Raises:
        ChainbuildError: the solver is unknown, not installed, unfit for this kinematic, or returns invalid values.
    """
    options = options or CheckOptions()
    trials = _Trials(machine, selection or Selection(), conventions or {}, progress)
    if isinstance(solver, Recording):
        tolerance = options.tolerance(recorded=True)
        samples = _recorded_samples(robot, solver)
        forward = compare_forward(robot, samples, solver.poses.copy(), solver.compared, tolerance)
        return _result(robot, OtherSolver(solver.name, note="recorded"), forward, None, trials, solver)
    reference = (
        other_solver_by_name(robot, solver, options.kind)
        if isinstance(solver, str)
        else other_solver_from_function(robot, solver, kind=options.kind)
    )
    tolerance = options.tolerance(recorded=False)
    samples = make_samples(robot, options.count, options.samples, options.seed)
    forward_or_none = _forward(robot, samples, reference, tolerance)
    inverse = compare_inverse(robot, samples, reference, tolerance) if reference.ik else None
    return _result(robot, reference, forward_or_none, inverse, trials)


@dataclass(frozen=True, slots=True)
class _Trials:
    """What is tried where poses differ: other data and conventions of a machine; and who sees the progress."""

    machine: Machine | None
    selection: Selection
    chosen: Mapping[str, str]
    progress: Progress

    def conventions(self, evidence: Evidence) -> tuple[Trial, ...]:
        """Return the conventions that would make the poses agree, else the best."""
        if self.machine is None:
            return ()
        tried = try_conventions(self.machine, self.selection, self.chosen, evidence, self.progress)
        return tuple([trial for trial in tried if trial.agrees] or tried[:_MAX_TRIALS])

    def data(self, evidence: Evidence) -> tuple[DataTrial, ...]:
        """Return the machine data that would make the poses agree, else the best."""
        if self.machine is None:
            return ()
        tried = try_data(self.machine, self.selection, self.chosen, evidence, self.progress)
        return tuple([trial for trial in tried if trial.agrees] or tried[:_MAX_DATA])


def _recorded_samples(robot: Mechanism, recording: Recording) -> Samples:
    if len(recording.axes) == 0:
        raise ChainbuildError("the recording has no rows", parameter=recording.name)
    for row in recording.axes:
        robot.axis_values(row)
    kinds: list[SampleKind] = ["recorded" for _ in recording.axes]
    return Samples(recording.axes.copy(), tuple(kinds))


def _forward(
    robot: Mechanism, samples: Samples, reference: OtherSolver, tolerance: tuple[float, float]
) -> Forward | None:
    if reference.fk is None:
        return None
    theirs = np.array([reference.pose(row) for row in samples.axes])
    return compare_forward(robot, samples, theirs, "pose", tolerance)


def _result(
    robot: Mechanism,
    reference: OtherSolver,
    forward: Forward | None,
    inverse: Inverse | None,
    trials: _Trials,
    recording: Recording | None = None,
) -> CrossCheck:
    """Return the result with the diagnosis of differences, and the conventions and data that would resolve them."""
    evidence = _evidence(robot, forward, inverse, recording)
    explanation: Explanation | None = None
    tried: tuple[str, ...] = ()
    if evidence is not None:
        explanation = explain(robot, evidence.axes, evidence.theirs, evidence.compared, evidence.tolerance)
        tried = tried_changes(robot, evidence.compared)
    return CrossCheck(
        title=robot.chain.title,
        kinematic=robot.chain.kinematic,
        axes=tuple(axis.name for axis in robot.axes),
        reference=reference.name,
        note=reference.note,
        forward=forward,
        inverse=inverse,
        complete=inverse is None or plan_of(robot).complete,
        explanation=explanation,
        tried=tried,
        trials=() if evidence is None else trials.conventions(evidence),
        data=() if evidence is None else trials.data(evidence),
        conventions={used.convention.name: used.choice for used in robot.chain.conventions},
    )


def _evidence(
    robot: Mechanism, forward: Forward | None, inverse: Inverse | None, recording: Recording | None
) -> Evidence | None:
    """Return axis values and poses of the other solver that disagree, or None if there are none."""
    if forward is not None:
        if forward.agrees.all():
            return None
        tolerance = (forward.position_tolerance, forward.rotation_tolerance)
        return Evidence(forward.samples.axes, forward.theirs, forward.compared, tolerance, recording)
    if inverse is None or not inverse.wrong:
        return None
    # Wrong answers come first; right ones would only hide their common error.
    axes, poses = (part[: inverse.wrong] for part in inverse.pairs)
    return Evidence(axes, poses, robot.task, (POSITION_TOLERANCE_M, ROTATION_TOLERANCE_RAD))
