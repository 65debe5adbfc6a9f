"""Explanations of failed rows of a table, computed on request so that a large batch does not wait for them."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Matrix, Vector
from chainbuild.ik import rules
from chainbuild.ik.request import IkOptions
from chainbuild.ik.result import STATUSES, IkResult
from chainbuild.ik.search.found import SearchEnd
from chainbuild.ik.search.problem import Problem
from chainbuild.ik.search.solver import find, result_of
from chainbuild.ik.search.table import FailureWords

_NUMBER: Final = re.compile(r"(?<![\w.])[-+−]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


@dataclass(frozen=True, slots=True, eq=False)
class Failures:
    """Input of the failed rows.

    Attributes:
        rows: (M,) their indices in the table, ascending.
        targets: (M, 4, 4) tool in the workpiece frame [m].
        starts: (M or 1, n_free) SI values the search started from, NaN for none; None: none had any.
        problem: The problem.
        options: Tolerances and budget.
        known: Row → explanation, of those computed already.
    """

    rows: NDArray[np.intp]
    targets: Matrix
    starts: Matrix | None
    problem: Problem
    options: IkOptions
    known: dict[int, FailureWords] = field(default_factory=dict)

    def explain(self, row: int, result: IkResult) -> FailureWords:
        """Return why a row failed.

        Args:
            row: Its index in the table.
            result: Its result in the table.
        """
        words = self.known.get(row)
        if words is None:
            words = self.known[row] = self._words(int(np.searchsorted(self.rows, row)), result)
        return words

    def _words(self, n: int, result: IkResult) -> FailureWords:
        problem, target = self.problem, self.targets[n]
        outcome, y = STATUSES.index(result.status), problem.free_part(result.axes / result.labels.factors)
        left = (result.position_error, result.rotation_error)
        found = SearchEnd(outcome, result.iterations, result.restarts, *left, y, y)
        if outcome == rules.LIMITS and not problem.held_beyond:
            # The point outside the limits is not kept: the same search finds it again.
            again = find(problem, target, self._start(n), self.options)
            if again.outcome != rules.LIMITS:
                return FailureWords("reached only outside the limits")
            found = found._replace(outside=again.outside)
        said = result_of(problem, target, found, self.options)
        return FailureWords(said.reason, said.violated)

    def _start(self, n: int) -> Vector | None:
        if self.starts is None:
            return None
        start: Vector = self.starts[n % len(self.starts)]
        return None if np.isnan(start).any() else start


@dataclass(frozen=True, slots=True, eq=False)
class Said:
    """Explanations that are known because every row was a search of its own.

    Attributes:
        words: Row → explanation.
    """

    words: dict[int, FailureWords]

    def explain(self, row: int, result: IkResult) -> FailureWords:
        """Return why a row failed; see `Failures.explain`."""
        return self.words[row]


def kind_of(reason: str) -> str:
    """Return a reason without its numbers, equal for rows that failed for the same reason.

    >>> kind_of("reached only outside the limits: A3 at 170.123 deg (limit 155.000)")
    'reached only outside the limits: A3 at … deg (limit …)'
    """
    return _NUMBER.sub("…", reason)
