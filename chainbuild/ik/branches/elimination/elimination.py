"""Six joints of any kind in any arrangement: all solutions, by eliminating all joints but one.

The row of joints closes to a loop (`loop`) whose equations become an eigenvalue problem for one of them (`eliminant`).
The loop may be opened before any joint: where it opens best depends on which axes meet or are parallel, and is found by
trial. At a pose whose equations are singular in themselves — solutions coincide, or are curves — a nearby pose is
solved, and its solutions are brought to the pose by Newton steps.

References: Raghavan and Roth 1990, "Kinematic analysis of the 6R manipulator of general geometry"; Manocha and Canny
1994, "Efficient inverse kinematics for general 6R manipulators".
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.arrays import Matrices, Matrix, Vector
from chainbuild.frames import inverse, transform
from chainbuild.ik.branches.core.serial import Screw, Serial
from chainbuild.ik.branches.core.subproblems import rotation
from chainbuild.ik.branches.elimination.conformal import arrow, coefficients, motion
from chainbuild.ik.branches.elimination.eliminant import SINGULAR
from chainbuild.ik.branches.elimination.loop import OpenedLoop, closed, eliminant, equations, inner_order

if TYPE_CHECKING:
    from chainbuild.ik.branches.core.serial import Solution

Opening = tuple[int, int]  # the joint before which the loop is opened, and which of the inner joints is solved for

JOINTS: Final = 6  # of the loop: what a pose determines
_TRIED: Final = 4  # the best openings, of which well-conditioned ones are preferred
_TRIALS: Final = 2  # poses on which the openings of the loop are tried
_GOOD: Final = 1e5  # condition up to which one opening of the loop is enough
_MAX_OPENINGS: Final = 3  # solved for one pose before the solutions found so far are taken
# Distances of nearby poses from a singular one [arm lengths, rad]: far enough for equations with some digits left.
_PERTURBATIONS: Final = (1e-3, 1e-2, 1e-4)
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
        self.back = inverse(serial.M)
        self.openings = self._openings()

    def solve(self, target: Matrix, _keep: Sequence[float]) -> list[Solution]:
        """Return the joint values of a pose (4, 4); some may be inexact or duplicates."""
        G = self._scaled(target @ self.back)
        found, settled = self._solved(G)
        if not settled:
            found += self._beside(G, found)
        # The most exact first: the caller keeps the first of duplicates.
        ranked = sorted((miss, n) for n, miss in enumerate(self._misses(G, found)))
        return [(self._unscaled(found[n]), (False,) * JOINTS) for miss, n in ranked if miss < _NO_SOLUTION]

    def _beside(self, G: Matrix, known: Sequence[Vector]) -> list[Vector]:
        """Return the values (6,) of poses next to a singular one, brought to it.

        Next to it the equations may lose some, too: another distance is tried until one brings nothing new.
        """
        found: list[Vector] = []
        reached = [values for values, miss in zip(known, self._misses(G, known), strict=True) if miss < _REACHED]
        for n, distance in enumerate(_PERTURBATIONS):
            beside, _ = self._solved(_perturbed(G, distance))
            refined = self._refined(G, beside)
            before = len(reached)
            for values, miss in zip(refined, self._misses(G, refined), strict=True):
                if miss < _REACHED and not self._is_among(values, reached):
                    reached.append(values)
            found += refined
            if n and len(reached) == before:
                break
        return found

    def _is_among(self, values: Vector, others: Sequence[Vector]) -> bool:
        """Return whether one of some sets of values is the same but for whole turns."""
        turns = [screw.kind == "revolute" for screw in self.screws]
        off = np.reshape(others, (-1, JOINTS)) - values
        return bool((np.abs(np.where(turns, np.sin(off / 2.0), off)).max(axis=1) < _APART).any())

    def _misses(self, G: Matrix, rows: Sequence[Vector]) -> list[float]:
        """Return how far sets of values miss a pose [arm lengths, rad]."""
        T, _ = self._poses_and_screws(rows)
        misses: list[float] = np.abs(T - G).max(axis=(1, 2)).tolist()
        return misses

    def _solved(self, G: Matrix) -> tuple[list[Vector], bool]:
        """Return the values (6,) of a loop, by one opening or several, and whether these are certainly all."""
        found: list[Vector] = []
        opened = 0
        for first, hidden in self.openings:
            loop = self._opened(G, first)
            problem = eliminant(loop, equations(loop), hidden)
            if problem.condition > SINGULAR:
                continue
            inner, settled = problem.solutions()
            found += _values(loop, inner, (first, hidden), G)
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
            J[:, :3, n], J[:, 3:, n] = np.cross(point, k), k
            K = np.cross(screw.direction, np.eye(3)).T  # K·v is direction × v
            turn = np.sin(values[:, n, None, None]) * K + (1.0 - np.cos(values[:, n, None, None])) * (K @ K)
            T[:, :3, :3] += T[:, :3, :3] @ turn
            T[:, :3, 3] = point - T[:, :3, :3] @ screw.point
        return T, J

    def _scaled(self, T: Matrix) -> Matrix:
        """Return a motion as seen from the middle of the axes, in units of the arm."""
        shift = transform(None, self.centre)
        seen = inverse(shift) @ T @ shift
        seen[:3, 3] /= self.size
        return seen

    def _unscaled(self, values: Vector) -> Vector:
        factors = np.array([self.size if screw.kind == "prismatic" else 1.0 for screw in self.screws])
        unscaled: Vector = values * factors
        return unscaled

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


def _values(loop: OpenedLoop, solutions: list[tuple[float, float, float]], opening: Opening, G: Matrix) -> list[Vector]:
    """Return all joint values (6,) that solutions of the inner joints, the one solved for leading, go with."""
    first, hidden = opening
    found = []
    for solution in solutions:
        inner = [0.0, 0.0, 0.0]
        for place, value in zip(inner_order(hidden), solution, strict=True):
            inner[place] = value
        found += [np.roll(np.array(values), first) for values in closed(loop, (inner[0], inner[1], inner[2]), G)]
    return found


def elimination(serial: Serial) -> Elimination | None:
    """Return the solver of a row of six joints, or None if the equations never separate solutions."""
    if len(serial.screws) != JOINTS:
        return None
    solver = Elimination(serial)
    return solver if solver.openings else None


def _perturbed(G: Matrix, distance: float) -> Matrix:
    """Return a pose next to another, displaced in a generic direction, which each distance has for itself."""
    rng = np.random.default_rng([20240229, round(1.0 / distance)])
    axis = rng.normal(size=3)
    R = rotation(axis / float(np.linalg.norm(axis)), distance)
    return np.asarray(transform(R, distance * rng.normal(size=3)) @ G, dtype=float)
