"""Trials of machine data: which single number, with another sign or value, would make the poses agree.

A pose is affine in most lengths and a trigonometric polynomial of degree 1 in most angles, of degree 2 in the tilt of
an axis. A few chains with other values of one datum therefore propose its least-squares value; every proposal is
verified by a chain of its own. Where a datum acts otherwise, secant steps go on from there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.arrays import Matrices, Vector
from chainbuild.comparison.comparison import forward_poses
from chainbuild.comparison.convention_trials import Selection
from chainbuild.comparison.evidence import Evidence
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.progress import Progress, counting
from chainbuild.shown import fields_shown

if TYPE_CHECKING:
    from chainbuild.formats.entries import Datum
    from chainbuild.formats.machine import Machine


_MAX_POSES: Final = 40  # determine one number many times over; a value that fits is tried on all poses
_LEAST_POSES: Final = 3  # fewer fit too much
_STEP_MM: Final = 100.0  # between the two lengths of a line: far from rounding, within any machine
_ANGLES: Final = 5  # evaluations that determine a trigonometric polynomial of degree 2
_GRID: Final = 720  # values of an angle from which the least-squares one is sought: two a degree
_STARTS: Final = 2  # lowest minima of the grid that are tried: where few poses tell, the second may be the right one
_STEPS: Final = 8  # Gauss-Newton or secant in one variable: converges in a few
_STEP_DEG: Final = 1.0  # for secant steps of an angle that permits no whole turn
_DIGITS: Final = 6  # of a value in mm or degrees: a hundredth of what a list counts
_FEW_DIGITS: Final = 3  # of one that agrees as well: recorded poses tell no more
_NO_EFFECT: Final = 1e-3  # change of all poses, as a multiple of the tolerance, below which a datum does not act
_MISSED: Final = 0.5  # difference from what was expected, likewise, from which a datum is not affine or trigonometric


@dataclass(frozen=True, slots=True)
class DataTrial:
    """Other values of machine data and the errors that they leave.

    Attributes:
        values: Datum → value, in the datum's unit: one datum, or two that do the same as another one alone.
        position_error: Worst distance [m].
        rotation_error: Worst angle [rad].
        agrees: Whether all poses are within tolerance.
    """

    __repr__ = fields_shown

    values: Mapping[Datum, float]
    position_error: float
    rotation_error: float
    agrees: bool


def try_data(
    machine: Machine,
    selection: Selection,
    chosen: Mapping[str, str],
    evidence: Evidence,
    progress: Progress = False,
) -> tuple[DataTrial, ...]:
    """Return for every datum that acts on the poses what its sign, another permitted value and its best value leave.

    Args:
        machine: The machine.
        selection: Which kinematic.
        chosen: Choices of conventions made by the user.
        evidence: The poses that disagree.
        progress: A bar, or a function of the data done and all data.

    Returns:
        The trials, those that agree first, a change of sign before another value; for each datum one at most.
    """
    some = evidence.some(_MAX_POSES)
    if len(some.axes) < _LEAST_POSES:
        return ()
    where = selection.kinematic, selection.channel
    data = (*machine.geometry(*where), *machine.tool_data(*where, tool_length_mm=selection.tool_length_mm))
    bench = _Bench(machine, selection, chosen, some)
    before = some.score(bench.trial({}))
    found: list[DataTrial] = []
    with counting(len(data), progress, "machine data") as advance:
        for datum in data:
            best = min(bench.trials(datum), key=some.score, default=None)
            if best is not None and some.score(best) < before:
                found += [best, *(bench.twins(datum, data) if best.agrees else ())]
            advance(1)
    whole = _Bench(machine, selection, chosen, evidence.some(len(evidence.axes)))
    found = [whole.trial(one.values) if one.agrees else one for one in found]
    return tuple(sorted(found, key=lambda one: (not one.agrees, _order(one) if one.agrees else some.score(one))))


def _order(trial: DataTrial) -> int:
    """Return the place of a trial that agrees: a changed sign or flag, two zeros, another value; given data first."""
    (datum, value), *more = trial.values.items()
    kind = 1 if more else 0 if not datum.unit or value == -datum.value else 2
    return 2 * kind + (datum.span is None)


@dataclass(frozen=True, slots=True, eq=False)
class _Fit:
    """What is expected of a datum's value: the features of all poses there."""

    value: float
    expected: Vector


class _Bench:
    """Chains of a machine with other values, compared with the evidence."""

    def __init__(self, machine: Machine, selection: Selection, chosen: Mapping[str, str], evidence: Evidence) -> None:
        self.machine, self.selection, self.chosen, self.evidence = machine, selection, chosen, evidence
        built = self.built({})
        self.base = self.features(*built) if built is not None else None

    def built(self, values: Mapping[Datum, float]) -> tuple[Matrices, Matrices, int] | None:
        """Return the poses of a chain with other values, those it should have, and the column of its tool direction.

        None where there is no such chain, or not all poses.
        """
        s = self.selection
        try:
            machine = self.machine.with_values(values)
            chain = machine.trial_chain(s.kinematic, s.channel, s.tool_length_mm, self.chosen)
            ours, theirs = forward_poses(Mechanism(chain), self.evidence.axes), self.evidence.theirs_for(chain)
        except (ChainbuildError, ArithmeticError):
            return None
        return (ours, theirs, chain.tool_column) if np.isfinite(ours).all() else None

    def features(self, ours: Matrices, theirs: Matrices, column: int) -> Vector:
        """Return what is compared of all differences of poses as one vector, in multiples of the tolerance."""
        distance, angle = self.evidence.tolerance
        difference = ours - theirs
        parts = [difference[:, :3, 3].ravel() / distance]
        if self.evidence.compared == "pose":
            parts.append(difference[:, :3, :3].ravel() / (math.sqrt(2.0) * angle))
        elif self.evidence.compared == "direction":
            parts.append(difference[:, :3, column].ravel() / angle)
        return np.concatenate(parts)

    def at(self, datum: Datum, value: float) -> Vector | None:
        """Return the features with another value of one datum."""
        built = self.built({datum: value})
        return self.features(*built) if built is not None else None

    def trial(self, values: Mapping[Datum, float]) -> DataTrial:
        """Return what other values leave."""
        built = self.built(values)
        return DataTrial(values, *(self.evidence.left(*built) if built is not None else (math.inf, math.inf, False)))

    def trials(self, datum: Datum) -> Iterator[DataTrial]:
        """Yield the trials of one datum; a sign that makes the poses agree is the last."""
        if self.base is None:
            return
        fits: list[_Fit] = []
        if datum.unit:
            fits = self.fits(datum, self.base)
            if not fits:
                return  # it does not act on these poses
        others = (-datum.value,) if datum.unit and datum.value else datum.others
        for other in others:
            trial = self.trial({datum: other})
            yield trial
            if trial.agrees:
                return
        for fit in fits:
            value = self.polished(datum, fit, self.base)
            rounded = self.trial({datum: round(value, _FEW_DIGITS)})
            yield rounded if rounded.agrees else self.trial({datum: round(value, _DIGITS)})

    def fits(self, datum: Datum, base: Vector) -> list[_Fit]:
        """Return the values of a length or angle that should be best; none where it does not act."""
        return self.angle_fits(datum, base) if datum.unit == "deg" else self.line_fits(datum, base, _STEP_MM)

    def line_fits(self, datum: Datum, base: Vector, distance: float) -> list[_Fit]:
        """Return the best value of a datum in which the poses are affine, from another one at a distance."""
        moved = self.at(datum, datum.value + distance)
        if moved is None or np.abs(moved - base).max() < _NO_EFFECT:
            return []
        slope = (moved - base) / distance
        step = -float(slope @ base) / float(slope @ slope)
        return [_Fit(datum.value + step, base + slope * step)]

    def angle_fits(self, datum: Datum, base: Vector) -> list[_Fit]:
        """Return the best values of an angle in which the poses are a trigonometric polynomial of degree 2."""
        steps = np.linspace(0.0, math.tau, _ANGLES, endpoint=False)
        values = [base]
        for step in steps[1:]:
            features = self.at(datum, datum.value + math.degrees(step))
            if features is None:
                return self.line_fits(datum, base, _STEP_DEG)
            values.append(features)
            if np.abs(values[1] - base).max() < _NO_EFFECT:
                return []
        coefficients = np.linalg.solve(_waves(steps), np.array(values))
        angles = np.linspace(0.0, math.tau, _GRID, endpoint=False)
        # |waves @ C|², by products that do not grow with the number of poses.
        products = coefficients @ coefficients.T
        waves = _waves(angles)
        costs = np.einsum("ni,ij,nj->n", waves, products, waves)
        lowest = np.flatnonzero((costs <= np.roll(costs, 1)) & (costs <= np.roll(costs, -1)))
        lowest = lowest[np.argsort(costs[lowest], kind="stable")][:_STARTS]
        fitted = np.array([_lowest(float(angles[n]), np.asarray(coefficients)) for n in lowest])
        values_deg = [math.remainder(datum.value + math.degrees(angle), 360.0) for angle in fitted.tolist()]
        return [_Fit(value, one) for value, one in zip(values_deg, _waves(fitted) @ coefficients, strict=True)]

    def polished(self, datum: Datum, fit: _Fit, base: Vector) -> float:
        """Return a fitted value, improved by secant steps where the poses are not what was expected there."""
        before, here = (datum.value, base), (fit.value, self.at(datum, fit.value))
        if here[1] is None or np.abs(here[1] - fit.expected).max() < _MISSED:
            return fit.value
        best = here
        for _ in range(_STEPS):
            found = _secant(before, (here[0], here[1]))
            features = self.at(datum, found) if math.isfinite(found) else None
            if features is None:
                break
            before, here = (here[0], here[1]), (found, features)
            if best[1] is None or np.linalg.norm(features) < np.linalg.norm(best[1]):
                best = here
            if abs(here[0] - before[0]) < _NO_EFFECT / _STEP_MM:
                break
        return best[0]

    def twins(self, datum: Datum, data: tuple[Datum, ...]) -> list[DataTrial]:
        """Return the pair of zeros that does the same as a direction reversed, where it does."""
        zeros = [one for one in data if one.name in datum.twins and one.channel == datum.channel]
        if len(zeros) < 2:
            return []
        trial = self.trial({one: math.remainder(one.value + 180.0, 360.0) for one in zeros})
        return [trial] if trial.agrees else []


def _waves(angles: Vector) -> Vector:
    """Return 1, cos, sin, cos 2, sin 2 of angles: (n, 5)."""
    return np.column_stack(
        [np.ones_like(angles), np.cos(angles), np.sin(angles), np.cos(2.0 * angles), np.sin(2.0 * angles)]
    )


def _lowest(angle: float, coefficients: Vector) -> float:
    """Return the angle near a given one at which the sum of squares of waves is lowest: Gauss-Newton."""
    for _ in range(_STEPS):
        c, s, c2, s2 = math.cos(angle), math.sin(angle), math.cos(2.0 * angle), math.sin(2.0 * angle)
        residual = np.array([1.0, c, s, c2, s2]) @ coefficients
        slope = np.array([0.0, -s, c, -2.0 * s2, 2.0 * c2]) @ coefficients
        angle -= float(slope @ residual) / max(float(slope @ slope), np.finfo(float).tiny)
    return angle


def _secant(one: tuple[float, Vector], other: tuple[float, Vector]) -> float:
    """Return the value at which a line through two others is nearest to zero."""
    slope = (other[1] - one[1]) / (other[0] - one[0]) if other[0] != one[0] else np.zeros_like(one[1])
    square = float(slope @ slope)
    return other[0] - float(slope @ other[1]) / square if square > 0.0 else math.nan
