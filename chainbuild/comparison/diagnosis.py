"""Diagnosis of a systematic error: the single change, or pair of changes, that makes two solvers agree.

It tries other readings of the axes (signs, two of them swapped), other readings of the poses (transposed rotation,
inverse pose, other angle convention, other unit), and constants: a tool offset, a base offset, a wrong zero of one
axis. The result is the simplest explanation with a small residual, and that residual.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.arrays import Matrices, Vector
from chainbuild.chain.elements import Task
from chainbuild.closest import and_joined
from chainbuild.comparison.comparison import forward_poses, pose_errors
from chainbuild.comparison.offsets import all_rigid, distinct_angle_modes, mean_transform, mm_text, transform_text
from chainbuild.frames import ANGLE_MODES, angles_from_matrix, inverse, matrix_from_angles
from chainbuild.kinematics.inputs import as_pose
from chainbuild.shown import fields_shown

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism


_MAX_POSES: Final = 16  # enough to tell explanations apart; every one of many is tried on all of them
_EXPLAINED: Final = 0.02  # share of the error that an explanation may leave
_MAX_FLIPPED: Final = 3  # axes at a time: more would be another machine
_MAX_OTHERS: Final = 4  # explanations named beside the best
_ZERO_STEPS: Final = 8  # Gauss-Newton in one variable: converges in a few
_ZERO_STARTS_DEG: Final = (0.0, 90.0, -90.0, 180.0)  # from one of them Gauss-Newton reaches any zero
_TWIN: Final = 1e-9  # [m, 1]: rounding of two ways to the same pose
_NOTHING: Final = 1e-9  # mm, degrees or slopes: rounding
# Factor → mistake. A solver gives metres, a recording mm: they may be confused.
_LENGTH_UNITS: Final = (
    (1e-3, "millimetres taken for metres"),
    (1e3, "metres taken for millimetres"),
    (0.0254, "inches taken for metres"),
    (25.4, "inches taken for millimetres"),
)


@dataclass(frozen=True, slots=True)
class Explanation:
    """A systematic error.

    Attributes:
        kind: "tool offset", "base offset", "flipped axis", "swapped axes", "axis zero", "angle convention",
            "transposed rotation", "inverse pose", "unit of length", "unit of angle", joined by " + "
            where two are needed.
        text: The error as text, with numbers.
        axes: Names of the axes it concerns.
        remaining_position_error: Worst distance that it leaves [m].
        remaining_rotation_error: Worst angle that it leaves [rad].
        others: Other errors, as text, that these poses do not distinguish from it.
    """

    __repr__ = fields_shown

    kind: str
    text: str
    axes: tuple[str, ...]
    remaining_position_error: float
    remaining_rotation_error: float
    others: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class _Reinterpretation:
    """Another reading of axes or poses: axis values and their poses, to be compared."""

    kind: str
    text: str
    axes: Vector
    theirs: Matrices
    names: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class _ConstantOffset:
    """A constant and the poses that it turns chainbuild's into."""

    kind: str
    text: str
    ours: Matrices
    names: tuple[str, ...] = ()


def explain(
    robot: Mechanism, axes: Vector, theirs: Matrices, compared: Task, tolerance: tuple[float, float]
) -> Explanation | None:
    """Return the simplest systematic error that explains the differences, or None.

    Args:
        robot: The robot.
        axes: (n, n_axes) axis values, mm and degrees.
        theirs: (n, 4, 4) poses of the other solver at these values [m].
        compared: Part of the poses that is compared.
        tolerance: Metres and radians within which poses agree.
    """
    finite = np.isfinite(theirs).all(axis=(1, 2))
    rows = np.flatnonzero(finite)
    if len(rows) < 3:
        return None
    chosen = rows[np.unique(np.linspace(0, len(rows) - 1, _MAX_POSES).astype(int))]
    return _Diagnosis(robot, compared, tolerance).run(axes[chosen], theirs[chosen])


def tried_changes(robot: Mechanism, compared: Task) -> tuple[str, ...]:
    """Return which changes `explain` tries, as text.

    Args:
        robot: The robot.
        compared: Part of the poses that is compared.
    """
    kinds = [axis.kind for axis in robot.axes]
    several = [f"up to {min(_MAX_FLIPPED, len(kinds))} axes reversed"] if len(kinds) > 1 else ["the axis reversed"]
    swapped = ["two axes swapped"] if any(kinds.count(kind) > 1 for kind in kinds) else []
    units = ["degrees and radians confused"] if "rotary" in kinds else []
    readings = ["mm, metres and inches confused"]
    if compared == "pose":
        readings += ["the rotation transposed", "the inverse pose", "other meanings of the pose angles"]
    constants = ["a constant offset on the tool or workpiece side", "the zero of each axis"]
    return (*several, *swapped, *units, *readings, *constants, "each of the axes' changes with each of the others")


class _Diagnosis:
    """A search through readings and constants."""

    def __init__(self, robot: Mechanism, compared: Task, tolerance: tuple[float, float]) -> None:
        self.robot, self.compared, self.tolerance = robot, compared, tolerance
        self.column = robot.chain.tool_column

    def run(self, axes: Vector, theirs: Matrices) -> Explanation | None:
        plain = _Reinterpretation("", "", axes, theirs)
        before = self._score(*self._errors(forward_poses(self.robot, axes), theirs))
        if before <= 1.0:
            return None
        limit = max(2.0, _EXPLAINED * before)
        readings = [*self._axis_readings(axes, theirs), *self._pose_readings(axes, theirs)]
        levels: tuple[Callable[[], Iterator[Explanation]], ...] = (
            lambda: (self._as_explanation(reading) for reading in readings),
            lambda: (self._with_constant(plain, constant) for constant in self._constants(plain)),
            lambda: self._two_readings(axes, theirs),
            lambda: (self._with_constant(r, c) for r in readings for c in self._constants(r)),
        )
        for level in levels:
            fitting = sorted((one for one in level() if self._left(one) <= limit), key=self._left)
            if fitting:
                return self._with_others(fitting, axes)
        return None

    def _with_others(self, fitting: list[Explanation], axes: Vector) -> Explanation:
        """Return the simplest of the explanations that fit best, with the others that these poses do not exclude."""
        # Such as a linear axis' zero and an offset along it: equal residuals are equally plausible.
        close = [one for one in fitting if self._left(one) <= max(1.0, self._left(fitting[0]))]
        best = min(close, key=lambda one: len(one.axes))
        more = [one for one in close if one is not best]
        if best.kind == "flipped axis":  # the same and further axes, whose sign the poses do not show
            more = [one for one in more if not (one.kind == best.kind and set(one.axes) > set(best.axes))]
        others = [*self._twins(best, axes), *(one.text for one in more)]
        return replace(best, others=tuple(others[:_MAX_OTHERS]))

    def _twins(self, found: Explanation, axes: Vector) -> Iterator[str]:
        """Yield what is the same arm as a reversed axis of a central wrist: the zeros beside it turned over."""
        kinds = found.kind.split(" + ")
        if kinds[0] != "flipped axis":
            return
        names = [axis.name for axis in self.robot.axes]
        reversed_ = found.axes[: -1 if kinds[-1] == "axis zero" else None]
        flipped = axes * [-1.0 if name in reversed_ else 1.0 for name in names]
        ours = forward_poses(self.robot, flipped)
        for name in reversed_:
            n = names.index(name)
            if not 0 < n < len(names) - 1 or any(self.robot.axes[k].kind != "rotary" for k in (n - 1, n, n + 1)):
                continue
            turned = flipped + 180.0 * np.isin(np.arange(len(names)), (n - 1, n + 1))
            turned[:, n] = axes[:, n]
            if np.abs(forward_poses(self.robot, turned) - ours).max() < _TWIN:
                zeros = f"the zeros of {names[n - 1]} and {names[n + 1]} off by 180 deg"
                yield f"in place of {name} reversed {zeros}, which is the same arm"

    def _errors(self, ours: Matrices, theirs: Matrices) -> tuple[float, float]:
        distance, angle = pose_errors(ours, theirs, self.compared, self.column)
        worst = float(distance.max()), float(angle.max())
        return worst if all(math.isfinite(value) for value in worst) else (math.inf, math.inf)

    def _score(self, distance: float, angle: float) -> float:
        return max(distance / self.tolerance[0], angle / self.tolerance[1])

    def _left(self, explanation: Explanation) -> float:
        return self._score(explanation.remaining_position_error, explanation.remaining_rotation_error)

    def _as_explanation(self, reading: _Reinterpretation) -> Explanation:
        errors = self._errors(forward_poses(self.robot, reading.axes), reading.theirs)
        return Explanation(reading.kind, reading.text, reading.names, *errors)

    def _with_constant(self, reading: _Reinterpretation, constant: _ConstantOffset) -> Explanation:
        errors = self._errors(constant.ours, reading.theirs)
        kind = " + ".join(part for part in (reading.kind, constant.kind) if part)
        text = ", and ".join(part for part in (reading.text, constant.text) if part)
        return Explanation(kind, text, (*reading.names, *constant.names), *errors)

    def _two_readings(self, axes: Vector, theirs: Matrices) -> Iterator[Explanation]:
        for first in self._axis_readings(axes, theirs):
            for second in self._pose_readings(first.axes, theirs):
                kind, text = f"{first.kind} + {second.kind}", f"{first.text}, and {second.text}"
                yield self._as_explanation(_Reinterpretation(kind, text, second.axes, second.theirs, first.names))

    def _axis_readings(self, axes: Vector, theirs: Matrices) -> Iterator[_Reinterpretation]:
        names, kinds = [a.name for a in self.robot.axes], [a.kind for a in self.robot.axes]
        for count in range(1, _MAX_FLIPPED + 1):
            for flipped in itertools.combinations(range(len(names)), count):
                signs = np.ones(len(names))
                signs[list(flipped)] = -1.0
                which = tuple(names[n] for n in flipped)
                text = f"{and_joined(which)} counted in the opposite direction"
                yield _Reinterpretation("flipped axis", text, axes * signs, theirs, which)
        rotary = np.array([kind == "rotary" for kind in kinds])
        for factor, text in (
            (180.0 / math.pi, "radians taken for degrees"),
            (math.pi / 180.0, "degrees taken for radians"),
        ):
            scaled = np.where(rotary, axes * factor, axes)
            yield _Reinterpretation("unit of angle", f"rotary axes: {text}", scaled, theirs)
        for one, other in itertools.combinations(range(len(names)), 2):
            if kinds[one] == kinds[other]:
                swapped = axes.copy()
                swapped[:, [one, other]] = axes[:, [other, one]]
                which = (names[one], names[other])
                yield _Reinterpretation("swapped axes", f"{and_joined(which)} swapped", swapped, theirs, which)

    def _pose_readings(self, axes: Vector, theirs: Matrices) -> Iterator[_Reinterpretation]:
        for factor, text in _LENGTH_UNITS:
            scaled = theirs.copy()
            scaled[:, :3, 3] *= factor
            yield _Reinterpretation("unit of length", f"positions: {text}", axes, scaled)
        if self.compared != "pose":
            return
        turned = theirs.copy()
        turned[:, :3, :3] = np.transpose(theirs[:, :3, :3], (0, 2, 1))
        yield _Reinterpretation("transposed rotation", "the rotation transposed (rows for columns)", axes, turned)
        backwards = np.array([inverse(T) for T in theirs])
        yield _Reinterpretation("inverse pose", "the workpiece seen from the tool", axes, backwards)
        used = self.robot.chain.angle_mode
        angles = [angles_from_matrix(used, T[:3, :3]) for T in theirs]
        # Angles given in radians are small enough for the matrix to preserve them.
        larger = theirs.copy()
        larger[:, :3, :3] = [matrix_from_angles(used, [math.degrees(angle) for angle in triple]) for triple in angles]
        yield _Reinterpretation("unit of angle", "pose angles: radians taken for degrees", axes, larger)
        for same in distinct_angle_modes():
            if used in same:
                continue
            other = theirs.copy()
            other[:, :3, :3] = [matrix_from_angles(same[0], triple) for triple in angles]
            text = f"the angles A, B, C mean {' or '.join(same)}, R = {ANGLE_MODES[same[0]].meaning}, not {used}"
            yield _Reinterpretation("angle convention", text, axes, other)

    def _constants(self, reading: _Reinterpretation) -> Iterator[_ConstantOffset]:
        ours = forward_poses(self.robot, reading.axes)
        if not np.isfinite(ours).all():
            return
        if self.compared == "pose":
            yield self._tool_offset(ours, reading.theirs)
            yield self._base_offset(ours, reading.theirs)
        else:
            yield from self._shifts(ours, reading.theirs)
        for n in range(len(self.robot.axes)):
            zero = self._axis_zero(n, reading)
            if zero is not None:
                yield zero

    def _tool_offset(self, ours: Matrices, theirs: Matrices) -> _ConstantOffset:
        offset = mean_transform(np.array([inverse(F) @ T for F, T in zip(ours, theirs, strict=True)]))
        text = f"a constant offset on the tool side: {transform_text(offset)} in the tool frame"
        return _ConstantOffset("tool offset", text, ours @ offset)

    def _base_offset(self, ours: Matrices, theirs: Matrices) -> _ConstantOffset:
        offset = mean_transform(np.array([T @ inverse(F) for F, T in zip(ours, theirs, strict=True)]))
        text = f"a constant offset on the workpiece side: {transform_text(offset)} in the workpiece frame"
        return _ConstantOffset("base offset", text, offset @ ours)

    def _shifts(self, ours: Matrices, theirs: Matrices) -> Iterator[_ConstantOffset]:
        """Yield constant shifts, for poses without a whole rotation."""
        difference = theirs[:, :3, 3] - ours[:, :3, 3]
        moved = ours.copy()
        moved[:, :3, 3] += difference.mean(axis=0)
        text = f"a constant shift of {mm_text(difference.mean(axis=0))} mm in the workpiece frame"
        yield _ConstantOffset("base offset", text, moved)
        local = np.einsum("nji,nj->ni", ours[:, :3, :3], difference).mean(axis=0)
        moved = ours.copy()
        moved[:, :3, 3] += ours[:, :3, :3] @ local
        yield _ConstantOffset("tool offset", f"a constant shift of {mm_text(local)} mm in the tool frame", moved)

    def _axis_zero(self, n: int, reading: _Reinterpretation) -> _ConstantOffset | None:
        """Return the shift of an axis' zero that fits best."""
        axis, kinematics = self.robot.axes[n], self.robot.kinematics
        factor = kinematics.si_factors[n]
        targets = [as_pose(T) for T in reading.theirs] if all_rigid(reading.theirs) else []
        residuals = [kinematics.residual(target, self.compared) for target in targets]
        starts = [0.0] if axis.kind == "linear" else [math.radians(start) for start in _ZERO_STARTS_DEG]
        best: tuple[float, float, Matrices] | None = None
        for shift in starts if residuals else []:
            found = self._fit_zero(n, reading.axes * kinematics.si_factors, residuals, shift)
            shifted = reading.axes.copy()
            shifted[:, n] += found / factor
            ours = forward_poses(self.robot, shifted)
            left = self._score(*self._errors(ours, reading.theirs))
            if best is None or left < best[0]:
                best = left, found / factor, ours
        if best is None or abs(best[1]) < _NOTHING:
            return None
        value = math.remainder(best[1], 360.0) if axis.kind == "rotary" else best[1]
        text = f"the zero of {axis.name} is off by {value:+.6g} {axis.unit}"
        return _ConstantOffset("axis zero", text, best[2], (axis.name,))

    @staticmethod
    def _fit_zero(n: int, x: Vector, residuals: list[Callable[[Vector], tuple[Vector, Vector]]], shift: float) -> float:
        for _ in range(_ZERO_STEPS):
            top, bottom = 0.0, _NOTHING**2
            for row, residual in zip(x, residuals, strict=True):
                moved = row.copy()
                moved[n] += shift
                error, J = residual(moved)
                if not (np.isfinite(error).all() and np.isfinite(J).all()):
                    return shift
                top += float(J[:, n] @ error)
                bottom += float(J[:, n] @ J[:, n])
            shift += top / bottom
        return shift
