"""The damped search as compiled code: descent, restarts, paths.

See `plain.py` for the same search step by step on Pinocchio.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from chainbuild import tolerances
from chainbuild.ik import rules
from chainbuild.ik.search.compiled.kernels import LOWER, UPPER, copy_to, jit, leaf, pose_and_jacobian, tool_error, weigh
from chainbuild.ik.search.compiled.least_squares import damped_step
from chainbuild.ik.search.compiled.limits import excess, near, onto_sums, turn_inside, turned_inside
from chainbuild.ik.search.compiled.starts import next_start, rank_starts, remove_edge_penalty

_OK: Final = rules.OK
_LIMITS: Final = rules.LIMITS
_STALLED: Final = rules.STALLED
_UNREACHABLE: Final = rules.UNREACHABLE
_SLACK: Final = rules.INSIDE_SLACK


@leaf
def stop_at_limits(problem, y, work, damping):
    """Move y by the step; axes that would leave their limits stop there and the others take over what is left."""
    lower, upper = problem.limits[LOWER], problem.limits[UPPER]
    step, J, error, H, g = work.step, work.J, work.error, work.H, work.g
    for _ in range(len(y)):
        stopped = False
        for n in range(len(y)):
            value = turned_inside(problem, n, y[n] + step[n])
            limit = min(max(value, lower[n]), upper[n])
            if limit != value:
                for r in range(problem.rows):
                    error[r] -= J[r, n] * (limit - y[n])
                    J[r, n] = 0.0
                y[n] = limit
                stopped = True
        if not stopped:
            break
        damped_step(problem.rows, J, error, H, g, step, damping)
    for n in range(len(y)):
        y[n] = min(max(turned_inside(problem, n, y[n] + step[n]), lower[n]), upper[n])


@leaf
def descend(problem, target, y, work, inside, goal, close_enough, steps, stall_share):
    """Iterate y from one start; return whether the pose is met, the squared error and the steps taken.

    The arrays are named once here: every tuple access counts references, which costs more than the arithmetic.
    """
    fixed, prismatic, A, b, weights = problem.fixed, problem.prismatic, problem.A, problem.b, problem.weights
    lower, upper = problem.limits[LOWER], problem.limits[UPPER]
    axis, rows, weighted = problem.axis, problem.rows, problem.weighted
    T, J, error, H, g, step = work.T, work.J, work.error, work.H, work.g, work.step
    small, turns = work.small, work.turns
    coupled = len(problem.sums) > 0
    mark, since, taken, before, length = np.inf, 0, 0, np.inf, 0.0
    while True:
        pose_and_jacobian(fixed, prismatic, A, b, y, T, J, turns)
        tool_error(T, target, axis, error, small)
        if weighted:
            weigh(weights, J, error)
        squared = 0.0
        for r in range(rows):
            squared += error[r] * error[r]
        taken += 1
        if squared < goal and (before < goal or length * (squared / before) <= rules.SHARP**2):
            return True, squared, taken
        if squared > stall_share * mark:
            since += 1
        else:
            mark, since = squared, 0
        if since >= rules.STALL_STEPS or taken >= steps or not squared < np.inf:
            return squared < close_enough, squared, taken
        before, damping = squared, rules.DAMPING * squared + rules.DAMPING_FLOOR
        damped_step(rows, J, error, H, g, step, damping)
        length = 0.0
        for n in range(len(y)):
            length += step[n] * step[n]
        leaves = False
        for n in range(len(y)):
            leaves |= not lower[n] <= y[n] + step[n] <= upper[n]
        if leaves and inside:
            stop_at_limits(problem, y, work, damping)
        else:
            for n in range(len(y)):
                y[n] += step[n]
        if coupled and inside:
            onto_sums(problem, y)


@leaf
def squared_error(problem, target, y, work):
    """Fill error and Jacobian of the task at y and return the squared error."""
    pose_and_jacobian(problem.fixed, problem.prismatic, problem.A, problem.b, y, work.T, work.J, work.turns)
    tool_error(work.T, target, problem.axis, work.error, work.small)
    if problem.weighted:
        weigh(problem.weights, work.J, work.error)
    squared = 0.0
    for r in range(problem.rows):
        squared += work.error[r] * work.error[r]
    return squared


@jit
def approach(problem, target, y, work):
    """Move y to where the error is smallest near by; return the squared error and the steps taken."""
    squared, damping, taken = squared_error(problem, target, y, work), rules.NEAREST_DAMPING, 0
    kept = y.copy()
    while taken < rules.NEAREST_STEPS and damping < 1.0 / rules.DAMPING_FLOOR:
        taken += 1
        damped_step(problem.rows, work.J, work.error, work.H, work.g, work.step, damping)
        stop_at_limits(problem, y, work, damping)
        onto_sums(problem, y)
        moved = squared_error(problem, target, y, work)
        if moved < squared:
            gain, squared, damping = squared - moved, moved, damping * rules.NEAREST_SHRINK
            copy_to(kept, y)
            if gain <= rules.NEAREST_GAIN * squared:
                break
        else:
            damping *= rules.NEAREST_GROWTH
            copy_to(y, kept)
            squared_error(problem, target, y, work)
    copy_to(y, kept)
    return squared, taken


@leaf
def errors(problem, target, y, work):
    """Return the distance [m] and the angle [rad] by which forward kinematics at y misses the target."""
    pose_and_jacobian(problem.fixed, problem.prismatic, problem.A, problem.b, y, work.T, work.J, work.turns)
    tool_error(work.T, target, problem.shown_axis, work.error, work.small)
    return lengths(problem.weights, work.error)


@leaf
def lengths(weights, error):
    """Return distance and angle of an error (6,) without weights; shifts of weight 0 do not count."""
    distance, angle = 0.0, 0.0
    for r in range(3):
        if weights[r] > 0.0:
            distance += error[r] * error[r]
        angle += error[3 + r] * error[3 + r]
    return math.sqrt(distance), math.sqrt(angle)


@leaf
def is_rigid(T, tolerance):
    """Return whether T (4, 4) has a right-handed rotation and finite numbers."""
    for i in range(3):
        for j in range(i + 1):
            product = T[0, i] * T[0, j] + T[1, i] * T[1, j] + T[2, i] * T[2, j]
            if not abs(product - (1.0 if i == j else 0.0)) < tolerance:
                return False
        if not abs(T[i, 3]) < tolerances.HUGE_POSITION_M:
            return False
    normal = T[0, 2] * (T[1, 0] * T[2, 1] - T[2, 0] * T[1, 1])
    normal += T[1, 2] * (T[2, 0] * T[0, 1] - T[0, 0] * T[2, 1])
    normal += T[2, 2] * (T[0, 0] * T[1, 1] - T[1, 0] * T[0, 1])
    return normal > 0.0 and T[3, 0] == 0.0 and T[3, 1] == 0.0 and T[3, 2] == 0.0 and T[3, 3] == 1.0


@jit
def search(problem, work, target, start, has_start, wanted, accuracy, restarts, y, outside):
    """Search from the start, then from the table.

    Args:
        problem: Arrays.
        work: Scratch.
        target: (4, 4) tool in the workpiece frame.
        start: (n,) first point where `has_start`.
        has_start: Whether there is one.
        wanted: (n,) where whole turns shall end near to.
        accuracy: (3,) squared error at which an iteration ends, permitted distance and angle.
        restarts: Starts after the first.
        y: (n,) out: the answer, or the nearest found inside the limits.
        outside: (n,) out: with outcome LIMITS a point that meets the pose and violates them least.

    Returns:
        Outcome, steps over all starts, starts after the first, distance and angle left at y.
    """
    turned = len(problem.turned_values)
    distances = np.empty(turned if turned > 0 else len(problem.points), np.float32)
    close_enough = min(accuracy[1], accuracy[2]) ** 2
    nearest, least, iterations = np.inf, np.inf, 0
    best = wanted.copy()
    for attempt in range(restarts + 1):
        if attempt == 0 and has_start:
            copy_to(y, start)
        else:
            if attempt == (1 if has_start else 0):
                rank_starts(problem, work, target, distances)
            elif attempt == (2 if has_start else 1):
                remove_edge_penalty(problem.turned_rows, distances)
            next_start(problem, work, distances, attempt, wanted, y)
        inside = attempt % rules.FREE_EVERY != rules.FREE_EVERY - 1
        met, squared, taken = descend(
            problem, target, y, work, inside, accuracy[0], close_enough, rules.MAX_STEPS, rules.STALL_SHARE
        )
        iterations += taken
        if met:
            turned = turn_inside(problem, y)
            beyond = excess(problem, y)
            if beyond <= _SLACK:
                if beyond > 0.0:  # to the last digit; a start, or a free descent, may be beyond by rounding
                    for n in range(len(y)):
                        y[n] = min(max(y[n], problem.limits[LOWER, n]), problem.limits[UPPER, n])
                    onto_sums(problem, y)
                    turned = True
                # The last step of the descent was forward kinematics at y; only what moved since is checked again.
                if near(problem, y, wanted) or turned or problem.weighted or problem.axis != problem.shown_axis:
                    distance, angle = errors(problem, target, y, work)
                else:
                    distance, angle = lengths(problem.weights, work.error)
                if distance <= accuracy[1] and (angle <= accuracy[2] or not turns_count(problem)):
                    return _OK, iterations, attempt, distance, angle
            if beyond < least:
                least = beyond
                copy_to(outside, y)
        elif inside and squared < nearest:
            nearest = squared
            copy_to(best, y)
        if given_up(problem, target, attempt, least):
            break
    if has_start and least < np.inf:
        # The branch of the start shows best which limit is violated.
        copy_to(y, start)
        inside = attempt < 0  # numba would compile the descent once more for a literal
        met, _, taken = descend(
            problem, target, y, work, inside, accuracy[0], close_enough, rules.MAX_STEPS, rules.STALL_SHARE
        )
        iterations += taken
        if met:
            turn_inside(problem, y)
            copy_to(outside, y)
    copy_to(y, best)
    nearest, taken = approach(problem, target, y, work)
    distance, angle = errors(problem, target, y, work)
    outcome = _STALLED if nearest < rules.STALLED_BELOW**2 else _UNREACHABLE
    return (_LIMITS if least < np.inf else outcome), iterations + taken, attempt, distance, angle


@leaf
def given_up(problem, target, attempt, least):
    """Return whether no other start is tried after one of them; see `Problem.beyond_bound`."""
    squared = 0.0
    for k in range(3):
        squared += target[k, 3] * target[k, 3]
    if attempt == 0 and squared > problem.reach * problem.reach:
        return True
    return least == np.inf and (attempt + 1 >= rules.MAX_FAILED_DESCENTS or (attempt == 0 and too_far(problem, target)))


@leaf
def too_far(problem, target):
    """Return whether the arm is certainly too short; see `arm_reach.py`."""
    before, after, squared = problem.arm[0], problem.arm[1], 0.0
    for r in range(3):
        away = before[r, 3]
        for k in range(3):
            held = target[k, 3]
            for m in range(3):
                held += target[k, m] * after[m, 3]
            away += before[r, k] * held
        squared += away * away
    return squared > problem.arm_length * problem.arm_length


@leaf
def turns_count(problem):
    """Return whether the task includes any rotation."""
    return problem.weights[3] + problem.weights[4] + problem.weights[5] > 0.0


@leaf
def track(problem, work, targets, last, accuracy, most, y, counts, misses):
    """Follow a path, each pose from the previous one, while single short descents suffice.

    Args:
        problem: Arrays.
        work: Scratch.
        targets: (N, 4, 4) poses.
        last: (n,) axis values before the first pose.
        accuracy: (4,) see `search`.
        most: Largest step of an axis that is accepted without a search for a nearer branch.
        y: (N, n) out: answers.
        counts: (N, 3) out: outcome, steps, starts after the first.
        misses: (N, 2) out: distance and angle left.

    Returns:
        How many poses were met, each within `most` of the one before.
    """
    close_enough = min(accuracy[1], accuracy[2]) ** 2
    inside = len(targets) > 0
    for i in range(len(targets)):
        now = y[i]
        copy_to(now, last)
        if i >= 2:  # extrapolated axis values
            for n in range(len(now)):
                ahead = 2.0 * last[n] - y[i - 2, n]
                now[n] = min(max(ahead, problem.limits[LOWER, n]), problem.limits[UPPER, n])
        met, _, taken = descend(
            problem, targets[i], now, work, inside, accuracy[0], close_enough, rules.MAX_STEPS, rules.STALL_SHARE
        )
        largest = 0.0
        for n in range(len(now)):
            largest = max(largest, abs(now[n] - last[n]))
        if not met or largest > most or excess(problem, now) > rules.ROUNDING:
            return i
        distance, angle = errors(problem, targets[i], now, work)
        if not (distance <= accuracy[1] and (angle <= accuracy[2] or not turns_count(problem))):
            return i
        counts[i, 0], counts[i, 1], counts[i, 2] = _OK, taken, 0
        misses[i, 0], misses[i, 1] = distance, angle
        last = now
    return len(targets)
