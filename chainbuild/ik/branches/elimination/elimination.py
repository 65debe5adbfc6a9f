"""Six joints of any kind in any arrangement: all solutions, by eliminating all joints but one.

The row of joints closes to a loop (`loop`) whose equations become an eigenvalue problem for one of them (`eliminant`).
The loop may be opened before any joint: where it opens best depends on which axes meet or are parallel, and is found by
trial. At a pose whose equations are singular in themselves — solutions coincide, or are curves — a nearby pose is
solved, and its solutions are brought to the pose by Newton steps.

References: Raghavan and Roth 1990, "Kinematic analysis of the 6R manipulator of general geometry"; Manocha and Canny
1994, "Efficient inverse kinematics for general 6R manipulators".
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Final, TypeVar

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.frames import inverse, transform
from chainbuild.ik.branches.arms.virtual_joints import NO_JOINT
from chainbuild.ik.branches.core.roots import NEARLY_REAL
from chainbuild.ik.branches.core.serial import Screw, Serial, transformed_point
from chainbuild.ik.branches.core.subproblems import cross, rotation
from chainbuild.ik.branches.elimination.conformal import arrow, coefficients, motion
from chainbuild.ik.branches.elimination.cuts import on_curves
from chainbuild.ik.branches.elimination.eliminant import SINGULAR
from chainbuild.ik.branches.elimination.loop import OpenedLoop, closed, eliminant, equations, inner_order

if TYPE_CHECKING:
    from chainbuild.ik.branches.core.serial import ArmSolver, Solution

_Values = TypeVar("_Values", tuple[float, float, float], Vector)
Opening = tuple[int, int]  # the joint before which the loop is opened, and which of the inner joints is solved for

JOINTS: Final = 6  # of the loop: what a pose determines
_TRIED: Final = 4  # the best openings, of which well-conditioned ones are preferred
_TRIALS: Final = 2  # poses on which the openings of the loop are tried
_GOOD: Final = 1e5  # condition up to which one opening of the loop is enough
_MAX_OPENINGS: Final = 3  # solved for one pose before the solutions found so far are taken
# Distances of nearby poses from a singular one [arm lengths, rad]: far enough for equations with some digits left.
_PERTURBATIONS: Final = (1e-3, 1e-2, 1e-4)
# Where two solutions meet, the poses on one side have none: there they are a complex pair, as far beside the real
# numbers as the square root of the distance.
_BESIDE: Final = 1.0
_FAR: Final = 1.0  # the same where no solution is known: a start for Newton's steps
_DIRECTIONS: Final = 12  # of poses around a singular one: one in three has led to solutions
_FEW_DIGITS: Final = 3  # decimals [rad, arm lengths] by which starts of Newton's steps are told apart
_LOST: Final = 1e-5  # singular values below this share of the largest are those of a solution that is not isolated
_BESIDE_CURVE: Final = 1e-2  # step along a curve [arm lengths, rad]: where there is none, the residual is its square
_ON_CURVE: Final = 1e-10  # residual that Newton's steps leave on a curve
_MISSED: Final = 3.0  # times that, what the real parts of such a pair miss the pose by [arm lengths, rad]
_REACHED: Final = 1e-6  # residual of a solution, and twice as much as rounding leaves of it where branches meet
_APART: Final = 1e-4  # half the difference of solutions that are not the same
_NO_SOLUTION: Final = 1e-2  # residuals above this are no solutions
_DEPENDENT: Final = 1e-9  # singular values below this share of the largest are rounding
_STEPS: Final = 8  # Newton's: from a solution of few digits, far more than are needed
_MAX_STEP: Final = 0.3  # rad or arm lengths: a longer step is none towards the solution nearby


class Elimination:
    """All solutions of one row of six joints.

    Args:
        serial: Six screws.
    """

    def __init__(self, serial: Serial) -> None:
        points = np.array([screw.point for screw in serial.screws if screw.kind == "revolute"])
        self.centre = points.mean(axis=0) if len(points) else np.zeros(3)
        ends = [*points, serial.M[:3, 3]]
        self.size = max([float(np.linalg.norm(point - self.centre)) for point in ends]) or 1.0
        self.screws = [Screw(s.kind, s.direction, (s.point - self.centre) / self.size, s.joint) for s in serial.screws]
        self.parts = [coefficients(screw) for screw in self.screws]
        self.serial, self.back = serial, inverse(serial.M)
        self.openings = self._openings()

    def solve(self, target: Matrix, keep: Sequence[float]) -> list[Solution]:
        """Return the joint values of a pose (4, 4); some may be inexact or duplicates."""
        if self._is_beyond(target):
            return []
        G = self._scaled(target @ self.back)
        found, settled = self._found(G)
        if settled:
            return self._unscaled(found)
        reached = [values for values in found if self._miss(G, values) < _REACHED]
        if reached and not any(self._continues(G, values) for values in reached):
            return self._unscaled(found)
        cut = on_curves(self.serial, target, keep, _cut)
        return cut + self._unscaled(found if cut or reached else self._around(G))

    def _is_beyond(self, target: Matrix) -> bool:
        """Return whether rotary joints are certainly too short for a pose: their axes' points keep their distances."""
        real = [screw for screw in self.serial.screws if screw.joint != NO_JOINT]
        if any(screw.kind == "prismatic" for screw in real):
            return False
        points = np.array([*(screw.point for screw in real), self.serial.M[:3, 3]])
        reach = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
        return float(np.linalg.norm(target[:3, 3] - points[0])) > reach + _REACHED * self.size

    def isolated(self, target: Matrix, _keep: Sequence[float]) -> list[Solution]:
        """Return the joint values of a pose (4, 4) without looking for curves."""
        return self._unscaled(self._found(self._scaled(target @ self.back))[0])

    def _found(self, G: Matrix) -> tuple[list[Vector], bool]:
        """Return what the equations of a loop separate (6,), the most exact first, and whether that is all."""
        found, settled = self._solved(G)
        if not settled:
            found += self._beside(G, found)
        # The caller keeps the first of duplicates.
        ranked = sorted(((self._miss(G, values), n) for n, values in enumerate(found)))
        return [found[n] for miss, n in ranked if miss < _NO_SOLUTION], settled

    def _continues(self, G: Matrix, values: Vector) -> bool:
        """Return whether a solution is on a curve: beside it, where its joints move against one another, is another."""
        _, sizes, rows = np.linalg.svd(self._pose_and_jacobian(values)[1])
        for direction in rows[sizes < _LOST * sizes[0]]:
            beside = self._refined(G, values + _BESIDE_CURVE * direction)
            moved = float(np.abs(beside - values).max())
            if moved > _BESIDE_CURVE / 4.0 and self._miss(G, beside) < _ON_CURVE:
                return True
        return False

    def _beside(self, G: Matrix, known: Sequence[Vector]) -> list[Vector]:
        """Return the values (6,) of poses next to a singular one, brought to it.

        Next to it the equations may lose some, too: another distance is tried until one brings nothing new. Solutions
        that have become a complex pair there count by their real parts.
        """
        found: list[Vector] = []
        reached = [values for values in known if self._miss(G, values) < _REACHED]
        for n, distance in enumerate(_PERTURBATIONS):
            beside, _ = self._solved(_perturbed(G, distance), _BESIDE * math.sqrt(distance))
            refined = [self._refined(G, values) for values in _distinct(beside)]
            before = len(reached)
            for values in refined:
                if self._miss(G, values) < _REACHED and not any(self._same(values, one) for one in reached):
                    reached.append(values)
            found += refined
            if n and len(reached) == before:
                break
        return found

    def _around(self, G: Matrix) -> list[Vector]:
        """Return solutions by the poses around a singular one, in the first direction that leads to any.

        Beside a short curve, which none of the values to keep crosses, the poses of some directions have solutions near
        it, those of others only far in the complex numbers.
        """
        for n in range(_DIRECTIONS):
            beside, _ = self._solved(_perturbed(G, _PERTURBATIONS[1], n + 1), _FAR)
            refined = [self._refined(G, values) for values in _distinct(beside)]
            found = [values for values in refined if self._miss(G, values) < _REACHED]
            if found:
                return found
        return []

    def _same(self, values: Vector, others: Vector) -> bool:
        """Return whether two sets of values are the same but for whole turns."""
        turns = [screw.kind == "revolute" for screw in self.screws]
        return float(np.abs(np.where(turns, np.sin((values - others) / 2.0), values - others)).max()) < _APART

    def _miss(self, G: Matrix, values: Vector) -> float:
        """Return how far values miss a pose [arm lengths, rad]."""
        return float(np.abs(self._pose_and_jacobian(values)[0] - G).max())

    def _solved(self, G: Matrix, near: float = NEARLY_REAL) -> tuple[list[Vector], bool]:
        """Return the values (6,) of a loop, by one opening or several, and whether these are certainly all.

        Args:
            G: (4, 4) what the loop closes to.
            near: How far beside the real numbers a solution may lie; what it has of real values then misses G.
        """
        off = 0.0 if near == NEARLY_REAL else _MISSED * near
        found: list[Vector] = []
        opened = 0
        for first, hidden in self.openings:
            loop = self._opened(G, first)
            problem = eliminant(loop, equations(loop), hidden)
            if problem.condition > SINGULAR:
                continue
            inner, settled = problem.solutions(near)
            if off:
                inner = _distinct(inner)
            found += _values(loop, inner, (first, hidden), G, off)
            if settled and problem.condition < _GOOD:
                return found, True
            opened += 1
            if opened == _MAX_OPENINGS:
                break
        return found, False

    def _refined(self, G: Matrix, values: Vector) -> Vector:
        """Return values improved by Newton steps; axes that have no effect keep theirs."""
        for _ in range(_STEPS):
            T, J = self._pose_and_jacobian(values)
            rest = G @ inverse(T)
            turn = np.array([rest[2, 1] - rest[1, 2], rest[0, 2] - rest[2, 0], rest[1, 0] - rest[0, 1]]) / 2.0
            step = np.linalg.lstsq(J, np.concatenate([rest[:3, 3], turn]), rcond=_DEPENDENT)[0]
            values = values + step / max(1.0, float(np.abs(step).max()) / _MAX_STEP)
        return values

    def _pose_and_jacobian(self, values: Vector) -> tuple[Matrix, Matrix]:
        """Return the loop's motion (4, 4) and the screws (6, 6) of its joints there, one a column."""
        T, columns = np.eye(4), []
        for screw, value in zip(self.screws, values, strict=True):
            k = T[:3, :3] @ screw.direction
            point = transformed_point(T, screw.point)
            turns = screw.kind == "revolute"
            columns.append(np.concatenate([cross(point, k), k] if turns else [k, np.zeros(3)]))
            T = T @ screw.T(float(value))
        return T, np.column_stack(columns)

    def _scaled(self, T: Matrix) -> Matrix:
        """Return a motion as seen from the middle of the axes, in units of the arm."""
        shift = transform(None, self.centre)
        seen = inverse(shift) @ T @ shift
        seen[:3, 3] /= self.size
        return seen

    def _unscaled(self, found: Sequence[Vector]) -> list[Solution]:
        factors = np.array([self.size if screw.kind == "prismatic" else 1.0 for screw in self.screws])
        return [(values * factors, (False,) * JOINTS) for values in found]

    def _opened(self, G: Matrix, first: int) -> OpenedLoop:
        """Return the loop opened before a joint: those before it follow after the last, carried there by G⁻¹."""
        back = inverse(G)
        there, here = motion(G), motion(back)
        row = [*self.screws[first:], *(screw.transformed(back) for screw in self.screws[:first])]
        parts = [*self.parts[first:], *(here @ part @ there for part in self.parts[:first])]
        end = arrow(row[-1].point, row[-1].direction)
        return OpenedLoop(row, parts, end, there @ end)

    def _openings(self) -> list[Opening]:
        """Return where the loop may be opened and for which joint solved, the best conditioned leading."""
        rng = np.random.default_rng(20240229)
        poses = []
        for _ in range(_TRIALS):
            G, J = self._pose_and_jacobian(rng.uniform(-2.0, 2.0, JOINTS))
            if np.linalg.cond(J) * _DEPENDENT > 1.0:
                return []  # these joints do not move the tool in all six freedoms
            poses.append(G)
        ranked: list[tuple[float, Opening]] = []
        for first in range(JOINTS):
            if self.screws[first - 1].kind == "prismatic":
                continue
            loops = [self._opened(G, first) for G in poses]
            trials = [(loop, equations(loop)) for loop in loops]
            for hidden in range(3):
                worst = max(eliminant(loop, blocks, hidden).condition for loop, blocks in trials)
                if worst < SINGULAR:
                    ranked.append((worst, (first, hidden)))
        ranked.sort()
        order = [opening for _, opening in ranked]
        # Those whose solutions never share a value of the joint solved for are the quickest.
        return sorted(
            order, key=lambda opening: opening in order[:_TRIED] and not self._is_well_conditioned(opening, poses[0])
        )

    def _is_well_conditioned(self, opening: Opening, G: Matrix) -> bool:
        """Tell whether one opening is enough for a pose."""
        loop = self._opened(G, opening[0])
        return eliminant(loop, equations(loop), opening[1]).solutions()[1]


def _values(
    loop: OpenedLoop, solutions: list[tuple[float, float, float]], opening: Opening, G: Matrix, off: float
) -> list[Vector]:
    """Return all joint values (6,) that solutions of the inner joints, the one solved for leading, go with."""
    first, hidden = opening
    found = []
    for solution in solutions:
        inner = [0.0, 0.0, 0.0]
        for place, value in zip(inner_order(hidden), solution, strict=True):
            inner[place] = value
        found += [np.roll(np.array(values), first) for values in closed(loop, (inner[0], inner[1], inner[2]), G, off)]
    return found


def elimination(serial: Serial) -> Elimination | None:
    """Return the solver of a row of six joints, or None if the equations never separate solutions."""
    if len(serial.screws) != JOINTS:
        return None
    solver = Elimination(serial)
    return solver if solver.openings else None


def _distinct(found: Iterable[_Values]) -> list[_Values]:
    """Return sets of values without those that are others but for few digits, which Newton's steps bring back."""
    return list({tuple(np.round(values, _FEW_DIGITS)): values for values in found}.values())


def _cut(serial: Serial) -> ArmSolver | None:
    """Return the solver of a chain with one joint held; it looks for no curves, on which two would have to be."""
    solver = elimination(serial)
    return None if solver is None else solver.isolated


def _perturbed(G: Matrix, distance: float, number: int = 0) -> Matrix:
    """Return a pose next to another, displaced in a generic direction, of each distance and number its own."""
    rng = np.random.default_rng([20240229, round(1.0 / distance), number])
    axis = rng.normal(size=3)
    R = rotation(axis / float(np.linalg.norm(axis)), distance)
    return np.asarray(transform(R, distance * rng.normal(size=3)) @ G, dtype=float)
