"""A tight spot of a path: the sequence of branches whose largest axis motion is smallest.

Following the nearest branch pose by pose can run into a limit a little later and then needs a whole turn. Over a
stretch of the path around the spot all branches are followed at once, and dynamic programming chooses among them.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.ik import rules
from chainbuild.ik.request import IkOptions
from chainbuild.ik.search.problem import Problem
from chainbuild.ik.search.solver import find

_NEIGHBOURS: Final = 16  # starts around the last solution, at growing distance
_REACH: Final = 3.0  # of the farthest (rad or m)
_TABLE_STARTS: Final = 24  # starts from the table of the problem
_SAME: Final = 1e-6  # solutions closer than this (rad or m) are one
_MAX_BRANCHES: Final = 48  # kept per pose
_SUM_SHARE: Final = 1e-3  # weight of the total motion, for sequences with the same largest motion


def branches(problem: Problem, target: Matrix, last: Vector, options: IkOptions) -> Iterator[Vector]:
    """Yield solutions that starts around the last one, and in the table, lead to; some more than once."""
    for start in _starts(problem, target, last):
        found = find(problem, target, start, replace(options, max_restarts=0))
        if found.outcome == rules.OK:
            yield problem.box.nearest(found.y, last)


def _starts(problem: Problem, target: Matrix, last: Vector) -> Iterator[Vector]:
    rng = np.random.default_rng(0)
    for n in range(_NEIGHBOURS):
        yield problem.box.clamp(last + _REACH * (n + 1) / _NEIGHBOURS * rng.uniform(-1.0, 1.0, len(last)))
    for n in np.argsort(problem.starts.distances(target))[:_TABLE_STARTS]:
        yield problem.starts.points[n]


def best_sequence(problem: Problem, targets: Matrix, last: Vector, spot: int, options: IkOptions) -> Matrix | None:
    """Return one solution per pose (N, n_free) with the smallest largest motion, or None if a pose has none.

    Args:
        problem: The problem.
        targets: (N, 4, 4) a stretch of the path.
        last: (n_free,) axis values before it.
        spot: Index of the critical pose; branches are searched there and followed both ways.
        options: Tolerances.
    """
    layers = _layers(problem, targets, last, spot, options)
    if any(not len(layer) for layer in layers):
        return None
    cost, total = np.zeros(1), np.zeros(1)
    came: list[NDArray[np.intp]] = []
    before = last[None]
    for layer in layers:
        steps = np.abs(layer[:, None] - before[None]).max(axis=2)
        largest, length = np.maximum(steps, cost[None]), steps + total[None]
        chosen = np.argmin(largest + _SUM_SHARE * length, axis=1)
        rows = np.arange(len(layer))
        came.append(chosen)
        cost, total, before = largest[rows, chosen], length[rows, chosen], layer
    n = int(np.argmin(cost + _SUM_SHARE * total))
    sequence = []
    for layer, chosen in zip(reversed(layers), reversed(came), strict=True):
        sequence.append(layer[n])
        n = int(chosen[n])
    return np.array(sequence[::-1])


def _layers(problem: Problem, targets: Matrix, last: Vector, spot: int, options: IkOptions) -> list[Matrix]:
    """Return the solutions of each pose: those found at the spot, followed to both ends, and the one from before."""
    seeds = [*branches(problem, targets[spot], last, options)]
    layers: list[list[Vector]] = [[] for _ in targets]
    for rows in (range(spot, len(targets)), range(spot, -1, -1)):
        here = seeds
        for row in rows:
            here = _distinct(_followed(problem, targets[row], here, options))
            layers[row] += here
    here = [last]
    for row in range(len(targets)):  # the branch the axes are on
        here = _followed(problem, targets[row], here, options) or here
        layers[row] += here
    return [np.array(_distinct(_turned(problem, layer))).reshape(-1, len(last)) for layer in layers]


def _followed(problem: Problem, target: Matrix, before: list[Vector], options: IkOptions) -> list[Vector]:
    one_descent = replace(options, max_restarts=0)
    ended = [find(problem, target, y, one_descent) for y in before]
    return [found.y for found in ended if found.outcome == rules.OK]


def _distinct(found: list[Vector]) -> list[Vector]:
    kept: list[Vector] = []
    for y in found:
        if len(kept) < _MAX_BRANCHES and all(np.abs(y - other).max() > _SAME for other in kept):
            kept.append(y)
    return kept


def _turned(problem: Problem, found: list[Vector]) -> list[Vector]:
    """Return solutions with every whole turn of their periodic axes that keeps the limits."""
    box, result = problem.box, []
    for y in found:
        choices = []
        for n in range(len(y)):
            turns = (-math.tau, 0.0, math.tau) if box.periodic[n] else (0.0,)
            choices.append([y[n] + turn for turn in turns if box.lower[n] <= y[n] + turn <= box.upper[n]])
        result += [np.array(values) for values in itertools.islice(itertools.product(*choices), _MAX_BRANCHES)]
    return [y for y in result if box.inside(y) and problem.keeps(y)]
