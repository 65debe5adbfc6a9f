"""All branches of poses by descents from everywhere, and what of them each solver has found.

Independent of chainbuild: joint values at random and beside known ones, polished by damped Newton steps of NumPy on the
kinematics of `geometry`. What solvers return is polished the same way, so that whoever has a branch has the same one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from tests.bench.arms.geometry import Arm, errors

RIGHT: Final = 1e-6  # m and rad: a returned row that misses its pose by more is wrong
SAME: Final = 1e-4  # rad, each joint modulo whole turns: closer ones are one branch
ISOLATED: Final = 1e-5  # smallest singular value / largest, lengths in units of the arm's: below, branches touch
STARTS: Final = 80  # random joint values a pose
BESIDE: Final = (3e-4, 3e-3, 3e-2, 0.3)  # rad: joint values beside known ones, each so far off
_STEPS: Final = 30  # Newton steps of a start; those that come to a branch are there after ten or so
_HOPELESS_AFTER: Final = 14  # steps: what is not near by then is given up
_HOPELESS: Final = 0.05
_EXACT: Final = 1e-12  # what is left where a descent has ended, of the arm's length and rad: rounding
_POLISHED: Final = 0.05  # rad: polishing a row that is right does not lead further, unless its branch is not isolated
_LONGEST: Final = 0.8  # rad: longest step
_LEAST_DAMPING: Final = 1e-14  # what keeps singular equations solvable, far below `ISOLATED` squared
_TOGETHER: Final = 4000  # descents at once: the arrays stay small


@dataclass(frozen=True, eq=False)
class Truth:
    """What is known of a pose.

    Attributes:
        branches: (b, 6) isolated branches [rad].
        alone: How many of these the random starts found by themselves: what that says about others that nobody knows.
        touching: Whether there are solutions that are not isolated.
        missed: (solver, ) → indices of the branches that it lacks.
        wrong: (solver, ) → number of rows that miss the pose.
        right: (solver, ) → number of rows that do not.
    """

    branches: np.ndarray
    alone: int
    touching: bool
    missed: list[list[int]]
    wrong: list[int]
    right: list[int]


def truths(
    arm: Arm,
    T: np.ndarray,
    known: np.ndarray,
    answers: Sequence[Sequence[np.ndarray | None]],
    rng: np.random.Generator,
    starts: int = STARTS,
) -> list[Truth]:
    """Return what is known of poses.

    Args:
        arm: The arm.
        T: (n, 4, 4) poses [m].
        known: (n, 6) joint values that lead there.
        answers: For each solver and pose the rows (k, 6) that it returned, or None where it was not asked.
        rng: Where starts are drawn from.
        starts: Random starts a pose.
    """
    begin, pose = [], []
    for i, q in enumerate(known):
        rows = [found[i] for found in answers if found[i] is not None and len(found[i])]
        sure = np.vstack([q[None], *rows])
        single = clusters(sure)
        beside = np.vstack([single + step * rng.choice([-1.0, 1.0], single.shape) for step in BESIDE])
        begin.append(np.vstack([sure, beside, rng.uniform(-np.pi, np.pi, (starts, 6))]))
        pose += [i] * len(begin[-1])
    of = np.array(pose)
    first = np.vstack(begin)
    last, left = descend(arm, first, T[of])
    found = []
    for i in range(len(known)):
        mine = of == i
        rows = [None if one[i] is None else one[i] for one in answers]
        truth = _judged(arm, T[i], first[mine], last[mine], left[mine], rows)
        there = last[mine][-starts:][left[mine][-starts:] < _EXACT]
        alone = sum(bool((distance(there, branch) <= SAME).any()) for branch in truth.branches)
        found.append(replace(truth, alone=alone))
    return found


def _judged(
    arm: Arm, T: np.ndarray, first: np.ndarray, last: np.ndarray, left: np.ndarray, answers: list[np.ndarray | None]
) -> Truth:
    """Judge the answers to one pose; first and last: joint values before and after the descent, left: what is left."""
    there = last[left < _EXACT]
    single = clusters(there)
    sigma = isolation(arm, single) if len(single) else np.empty(0)
    branches = single[sigma > ISOLATED]
    missed, wrong, right = [], [], []
    at = 1  # rows of the answers stand behind the joint values that are known
    for rows in answers:
        if rows is None:
            missed.append([])
            wrong.append(0)
            right.append(0)
            continue
        good = is_right(arm, rows, T)
        polished = last[at : at + len(rows)]
        ends = (left[at : at + len(rows)] < _EXACT) & (distance(first[at : at + len(rows)], polished) < _POLISHED)
        have = np.where(ends[:, None], polished, rows)[good]
        at += len(rows)
        lacks = [b for b, branch in enumerate(branches) if not len(have) or distance(have, branch).min() > SAME]
        missed.append(lacks)
        wrong.append(int(np.count_nonzero(~good)))
        right.append(int(np.count_nonzero(good)))
    return Truth(branches, 0, bool((sigma <= ISOLATED).any()), missed, wrong, right)


def descend(arm: Arm, q: np.ndarray, T: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return joint values (n, 6) after damped Newton steps to poses (n, 4, 4), and what is left, rad and lengths."""
    parts = [_descend(arm, q[i : i + _TOGETHER], T[i : i + _TOGETHER]) for i in range(0, max(len(q), 1), _TOGETHER)]
    return np.vstack([part[0] for part in parts]), np.concatenate([part[1] for part in parts])


def _descend(arm: Arm, q: np.ndarray, T: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    q, best, least = q.copy(), q.copy(), np.full(len(q), np.inf)
    on = np.arange(len(q))
    for step in range(_STEPS + 1):
        e, J = scaled(arm, q[on], T[on])
        size = np.linalg.norm(e, axis=1)
        better = size < least[on]
        best[on[better]], least[on[better]] = q[on[better]], size[better]
        # A descent goes on while it gains: at the end rounding alone decides, and more steps do no good.
        go = (better | (size > 1e-9)) & (size > 1e-16)
        if step >= _HOPELESS_AFTER:
            go &= size < _HOPELESS
        on, e, J, size = on[go], e[go], J[go], size[go]
        if not len(on) or step == _STEPS:
            break
        Jt = J.transpose(0, 2, 1)
        damping = np.clip(0.1 * size**2, _LEAST_DAMPING, 0.01)[:, None, None] * np.eye(6)
        change = np.linalg.solve(Jt @ J + damping, Jt @ e[:, :, None])[:, :, 0]
        longest = np.abs(change).max(axis=1)
        q[on] += change * np.minimum(1.0, _LONGEST / np.maximum(longest, 1e-300))[:, None]
    return best, least


def scaled(arm: Arm, q: np.ndarray, T: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return what is left to poses as (n, 6) and the Jacobians (n, 6, 6), positions in units of the arm's length."""
    place, turn, J = errors(arm, q, T)
    J[:, :3] /= arm.length
    return np.concatenate([place / arm.length, turn], axis=1), J


def isolation(arm: Arm, q: np.ndarray) -> np.ndarray:
    """Return smallest singular value / largest of the Jacobians at joint values (n, 6)."""
    J = arm.kinematics(q)[2]
    J[:, :3] /= arm.length
    values = np.linalg.svd(J, compute_uv=False)
    ratios: np.ndarray = values[:, -1] / values[:, 0]
    return ratios


def is_right(arm: Arm, q: np.ndarray, T: np.ndarray) -> np.ndarray:
    """Return which joint values (n, 6) lead to a pose (4, 4) to 1e-6 m and 1e-6 rad."""
    if not len(q):
        return np.zeros(0, dtype=bool)
    place, turn, _ = errors(arm, q, np.broadcast_to(T, (len(q), 4, 4)))
    good: np.ndarray = (np.linalg.norm(place, axis=1) <= RIGHT) & (np.linalg.norm(turn, axis=1) <= RIGHT)
    return good


def distance(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the largest difference of joint values (…, 6) modulo whole turns [rad]."""
    away: np.ndarray = np.abs((one - other + np.pi) % (2.0 * np.pi) - np.pi).max(axis=-1)
    return away


def clusters(q: np.ndarray) -> np.ndarray:
    """Return joint values (n, 6) without those closer than `SAME` to one before."""
    single: list[np.ndarray] = []
    while len(q):
        single.append(q[0])
        q = q[distance(q, q[0]) > SAME]
    return np.array(single).reshape(-1, 6)
