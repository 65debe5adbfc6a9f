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

from chainbuild.arrays import Matrices, Matrix, Vector
from chainbuild.frames import inverse, transform
from chainbuild.ik.branches.arms.virtual_joints import NO_JOINT
from chainbuild.ik.branches.core.roots import NEARLY_REAL
from chainbuild.ik.branches.core.serial import Screw, Serial
from chainbuild.ik.branches.core.subproblems import rotation
from chainbuild.ik.branches.elimination.conformal import arrow, coefficients, motion
from chainbuild.ik.branches.elimination.cuts import on_curves
from chainbuild.ik.branches.elimination.eliminant import SINGULAR, is_among
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
        self.turns = np.array([screw.kind == "revolute" for screw in self.screws])
        across = [np.cross(screw.direction, np.eye(3)).T for screw in self.screws]  # K·v is direction × v
        self._turning = [(K, K @ K) for K in across]
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
        reached = self._reaching(G, found)
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
        ranked = sorted((miss, n) for n, miss in enumerate(self._misses(G, found)))
        return [found[n] for miss, n in ranked if miss < _NO_SOLUTION], settled

    def _continues(self, G: Matrix, values: Vector) -> bool:
        """Return whether a solution is on a curve: beside it, where its joints move against one another, is another."""
        _, (J,) = self._poses_and_screws([values])
        _, sizes, rows = np.linalg.svd(J)
        beside = self._refined(G, [values + _BESIDE_CURVE * direction for direction in rows[sizes < _LOST * sizes[0]]])
        moved = [float(np.abs(one - values).max()) > _BESIDE_CURVE / 4.0 for one in beside]
        return any(far and miss < _ON_CURVE for far, miss in zip(moved, self._misses(G, beside), strict=True))

    def _beside(self, G: Matrix, known: Sequence[Vector]) -> list[Vector]:
        """Return the values (6,) of poses next to a singular one, brought to it.

        Next to it the equations may lose some, too: another distance is tried until one brings nothing new. Solutions
        that have become a complex pair there count by their real parts.
        """
        found: list[Vector] = []
        reached = self._reaching(G, known)
        for n, distance in enumerate(_PERTURBATIONS):
            beside, _ = self._solved(_perturbed(G, distance), _BESIDE * math.sqrt(distance))
            refined = self._refined(G, _distinct(beside))
            before = len(reached)
            reached += [one for one in self._reaching(G, refined) if not is_among(one, reached, self.turns, _APART)]
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
            found = self._reaching(G, self._refined(G, _distinct(beside)))
            if found:
                return found
        return []

    def _reaching(self, G: Matrix, rows: Sequence[Vector]) -> list[Vector]:
        """Return the sets of values that meet a pose."""
        return [values for values, miss in zip(rows, self._misses(G, rows), strict=True) if miss < _REACHED]

    def _misses(self, G: Matrix, rows: Sequence[Vector]) -> list[float]:
        """Return how far sets of values miss a pose [arm lengths, rad]."""
        T, _ = self._poses_and_screws(rows)
        misses: list[float] = np.abs(T - G).max(axis=(1, 2)).tolist()
        return misses

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

    def _refined(self, G: Matrix, rows: Sequence[Vector]) -> list[Vector]:
        """Return sets of values improved by Newton steps; axes that have no effect keep theirs."""
        values = np.reshape(rows, (-1, JOINTS))
        for _ in range(_STEPS):
            T, J = self._poses_and_screws(values)
            R = G[:3, :3] @ T[:, :3, :3].transpose(0, 2, 1)
            shift = G[:3, 3] - (R @ T[:, :3, 3:])[:, :, 0]
            turn = np.stack([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]], axis=1) / 2.0
            u, sizes, vt = np.linalg.svd(J)
            along = (np.concatenate([shift, turn], axis=1)[:, None] @ u)[:, 0]
            kept = sizes > _DEPENDENT * sizes[:, :1]
            steps = ((along * kept / np.where(kept, sizes, 1.0))[:, None] @ vt)[:, 0]
            values = values + steps / np.maximum(1.0, np.abs(steps).max(axis=1, keepdims=True) / _MAX_STEP)
        return list(values)

    def _poses_and_screws(self, rows: Sequence[Vector] | Matrix) -> tuple[Matrices, Matrices]:
        """Return the loop's motions (N, 4, 4) and the screws (N, 6, 6) of its joints there, one a column."""
        values = np.reshape(rows, (-1, JOINTS))
        T, J = np.tile(np.eye(4), (len(values), 1, 1)), np.zeros((len(values), 6, JOINTS))
        for n, screw in enumerate(self.screws):
            k = T[:, :3, :3] @ screw.direction
            if screw.kind == "prismatic":
                J[:, :3, n] = k
                T[:, :3, 3] += values[:, n, None] * k
                continue
            point = T[:, :3, :3] @ screw.point + T[:, :3, 3]
            J[:, 0, n] = point[:, 1] * k[:, 2] - point[:, 2] * k[:, 1]
            J[:, 1, n] = point[:, 2] * k[:, 0] - point[:, 0] * k[:, 2]
            J[:, 2, n] = point[:, 0] * k[:, 1] - point[:, 1] * k[:, 0]
            J[:, 3:, n] = k
            K, K_squared = self._turning[n]
            turn = np.sin(values[:, n, None, None]) * K + (1.0 - np.cos(values[:, n, None, None])) * K_squared
            T[:, :3, :3] += T[:, :3, :3] @ turn
            T[:, :3, 3] = point - T[:, :3, :3] @ screw.point
        return T, J

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
            (G,), (J,) = self._poses_and_screws(rng.uniform(-2.0, 2.0, (1, JOINTS)))
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
        every = closed(loop, (inner[0], inner[1], inner[2]), G, off)
        # In the order of the chain.
        found += [np.array(values[JOINTS - first :] + values[: JOINTS - first]) for values in every]
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
