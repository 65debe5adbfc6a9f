"""The damped search on Pinocchio, without compiled code; it works with every axis map.

Each step solves (JᵀJ + λ·1)·dy = Jᵀ·e with λ proportional to the squared error (Sugihara 2011): far away the step is
short and safe, nearby it is Newton's. Axes that would leave their limits are turned back by whole turns; where that
does not help they stop at the limit and the others take over what is left of the step. A descent that stalls is
abandoned for another start.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.errors import ChainbuildError
from chainbuild.ik import rules
from chainbuild.ik.search.found import SearchEnd
from chainbuild.kinematics.task_error import TaskError

if TYPE_CHECKING:
    from chainbuild.ik.request import IkOptions
    from chainbuild.ik.search.problem import Problem
    from chainbuild.ik.search.starts.turned import TableKey


def plain_search(
    problem: Problem, target: Matrix, start: Vector | None, wanted: Vector, options: IkOptions
) -> SearchEnd:
    """Search from the start, then from the table of starts.

    Args:
        problem: The problem.
        target: (4, 4) tool in the workpiece frame [m].
        start: (n_free,) first point, or None.
        wanted: (n_free,) where whole turns shall end near to.
        options: Tolerances and budget.
    """
    return _Search(problem, target, wanted, options).run(start, options.max_restarts)


class _Search:
    """One search: the state its descents share."""

    def __init__(self, problem: Problem, target: Matrix, wanted: Vector, options: IkOptions) -> None:
        self.problem, self.box, self.target, self.wanted = problem, problem.box, target, wanted
        self.task = task_of(problem)
        self.error, self.damping = self.task.error_of(target), self.task.damping
        self.coupled, self.rechecked = len(self.box.sums) > 0, problem.rechecked
        self.goal, self.position_tolerance, self.rotation_tolerance, _ = options.accuracy.tolist()
        self.close_enough = min(self.position_tolerance, self.rotation_tolerance) ** 2
        self.iterations = 0
        self.last: Vector | None = None

    def run(self, start: Vector | None, restarts: int) -> SearchEnd:
        """Search until a descent ends inside the limits, the starts are used up or the pose counts as unreachable."""
        nearest, least = math.inf, math.inf
        best = outside = self.wanted
        starts = None
        for attempt in range(restarts + 1):
            if attempt == 0 and start is not None:
                y = start
            else:
                starts = starts or _Starts(self.problem, self.target, self.wanted)
                y = starts.next(attempt)
            inside = attempt % rules.FREE_EVERY != rules.FREE_EVERY - 1
            met, y, squared = self.descend(y, inside, rules.MAX_STEPS, rules.STALL_SHARE)
            if met:
                found, y = y, self.wound(self.box.into(y))
                beyond = 0.0 if y is found and not self.coupled and inside else self.box.excess(y)
                if beyond <= rules.INSIDE_SLACK:
                    # To the last digit: a start, or a free descent, may be beyond a limit by rounding.
                    y = self.wound(self.box.nearest(self.box.onto_limits(y) if beyond > 0.0 else y, self.wanted))
                    # The last step was forward kinematics at `found`; what whole turns moved is checked again.
                    distance, angle = self.task.misses(y, self.target, self.last if y is found else None)
                    if self.verified(distance, angle) and self.problem.keeps(y):
                        return SearchEnd(rules.OK, self.iterations, attempt, distance, angle, y, y)
                if beyond < least:
                    least, outside = beyond, y
            elif inside and squared < nearest:
                nearest, best = squared, y
            if least == math.inf and (
                attempt + 1 >= rules.MAX_FAILED_DESCENTS
                or (attempt == 0 and self.problem.arm_too_short(self.target) is not None)
            ):
                break
            if attempt == 0 and self.problem.beyond_bound(self.target):
                break
        if start is not None and least < math.inf:
            # The branch of the start shows best which limit is violated.
            met, y, _ = self.descend(start, False, rules.MAX_STEPS, rules.STALL_SHARE)
            outside = self.box.into(y) if met else outside
        best, nearest = self.approach(best)
        outcome = rules.STALLED if nearest < rules.STALLED_BELOW**2 else rules.UNREACHABLE
        if least < math.inf:
            outcome = rules.LIMITS
        misses = self.task.misses(best, self.target, None)
        misses = misses if math.isfinite(sum(misses)) else (math.inf, math.inf)
        return SearchEnd(outcome, self.iterations, attempt, *misses, best, outside)

    def wound(self, y: Vector) -> Vector:
        """Return y by the whole turns that limits of sums and drives ask for."""
        return self.problem.wound(y, self.wanted) if self.rechecked else y

    def descend(self, y: Vector, inside: bool, steps: int, stall_share: float) -> tuple[bool, Vector, float]:
        """Iterate from one start; return whether the pose is met, where, and the squared error."""
        mark, since, before, step = math.inf, 0, math.inf, y
        good, squared, halvings = y, math.inf, 0
        for taken in range(1, steps + 1):
            try:
                error, J = self.error(y)
                there = float(error.dot(error))
            except ChainbuildError:  # a nonlinear axis map has no joint values there
                there = math.inf
            if not there < math.inf:
                # The step left what the axes have a pose in; half of it may not.
                halvings += 1
                if taken == 1 or halvings > rules.MOST_HALVINGS:
                    break
                y = (good + y) / 2.0
                continue
            good, squared, halvings = y, there, 0
            self.last = error
            self.iterations += 1
            if squared < self.goal and (before < self.goal or _is_sharp(step, squared / before)):
                return True, y, squared
            if squared > stall_share * mark:
                since += 1
            else:
                mark, since = squared, 0
            if since >= rules.STALL_STEPS or taken == steps:
                break
            before, damping = squared, rules.DAMPING * squared + rules.DAMPING_FLOOR
            step = self.damping.step(J, error, damping)
            moved = y + step
            if inside and self.box.leaves(moved):
                moved = self._stop_at_limits(y, step, J, error, damping)
            y = self.box.onto_sums(moved) if inside and self.coupled else moved
        return squared < self.close_enough, good, squared

    def approach(self, y: Vector) -> tuple[Vector, float]:
        """Return where the error is smallest near by, and the squared error there."""
        error, J = self.error(y)
        squared, damping = float(error.dot(error)), rules.NEAREST_DAMPING
        if not squared < math.inf:  # loops that do not close there
            return y, math.inf
        for _ in range(rules.NEAREST_STEPS):
            self.iterations += 1
            step = self.damping.step(J, error, damping)
            moved = self.box.onto_sums(self._stop_at_limits(y, step, J, error, damping))
            try:
                error_there, J_there = self.error(moved)
            except ChainbuildError:
                break
            squared_there = float(error_there.dot(error_there))
            if squared_there < squared:
                gain, squared, damping = squared - squared_there, squared_there, damping * rules.NEAREST_SHRINK
                y, error, J = moved, error_there, J_there
                if gain <= rules.NEAREST_GAIN * squared:
                    break
            elif damping < 1.0 / rules.DAMPING_FLOOR:
                damping *= rules.NEAREST_GROWTH
            else:
                break
        return y, squared

    def _stop_at_limits(self, y: Vector, step: Vector, J: Matrix, error: Vector, damping: float) -> Vector:
        """Return y moved by the step; axes that would leave their limits stop there, the others take over the rest."""
        y, J, error, box = y.copy(), J.copy(), error.copy(), self.box
        for _ in range(len(y)):
            moved = box.into(y + step)
            beyond = box.outside(moved)
            if not beyond:
                break
            for n in beyond:
                limit = min(max(moved[n], box.lower[n]), box.upper[n])
                error -= J[:, n] * (limit - y[n])
                J[:, n] = 0.0
                y[n] = limit
            step = self.damping.step(J, error, damping)
        return box.clamp(box.into(y + step))

    def verified(self, distance: float, angle: float) -> bool:
        """Return whether an answer is within tolerance."""
        return distance <= self.position_tolerance and (angle <= self.rotation_tolerance or not self.problem.turns)


def task_of(problem: Problem) -> TaskError:
    """Return a problem's task, prepared at first use."""

    def made(own: Problem) -> TaskError:
        return TaskError(own.mechanism.kinematics, own.free, own.x, own.weights, own.axis, own.shown_axis)

    return problem.prepared("plain task", made)


def _is_sharp(step: Vector, share: float) -> bool:
    """Return whether the axes are settled: the last step, shrunk as the squared error did, is short."""
    return float(step.dot(step)) * share <= rules.SHARP**2


class _Starts:
    """Returns the starts of the table: the nearest in turn, later alternating with any other."""

    def __init__(self, problem: Problem, target: Matrix, wanted: Vector) -> None:
        self.problem, self.wanted, self.turned = problem, wanted, problem.turned_starts()
        self.query: TableKey | None = None
        self.given = 0
        self.left: NDArray[np.floating]
        if self.turned is None:
            self.left = problem.starts.distances(target)
        else:
            self.query = self.turned.query(target)
            self.left = self.turned.distances(self.query)

    def next(self, attempt: int) -> Vector:
        """Return a start not yet taken."""
        left, points = self.left, self.problem.starts.points
        self.given += 1
        if self.given == 2 and self.turned is not None:
            left -= self.turned.points.rows[-1]  # edges are for the first start alone
        if not len(left):
            return self.wanted
        for _ in range(rules.TURN_TRIES):
            n = attempt % len(left)
            if attempt < rules.NEAREST_FIRST or attempt % 2 == 0 or left[n] == math.inf:
                n = int(left.argmin())
            left[n] = math.inf
            if self.turned is None or self.query is None:
                break
            start = self.turned.start(n, self.query, self.problem.box, self.wanted)
            if start is not None:
                return start
        point: Vector = points[n % len(points)]
        return point
