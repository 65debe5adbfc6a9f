"""Limits of axes, sums of axes and drives along a path, between its rows, too.

Along straight axes a sum of axes is linear: it is beyond a limit between two rows only if it is at one of them. Along
lines, and for drives behind a map that is no sum of axes, the path is looked at in between.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.analysis.path.collect import BlockRun
from chainbuild.analysis.path.motion import LineMotion, PathMotion, StraightMotion
from chainbuild.analysis.path.places import PathPlace, PathViolation
from chainbuild.analysis.vanishing.tracing import Blocks
from chainbuild.arrays import Matrix, Vector
from chainbuild.kinematics.limits import Limits
from chainbuild.tolerances import LIMIT_SLACK

_REFINED: Final = 2  # parabolas through the places looked at: after two a top is known to 1e-3 of a sample and better
_FALSE: Final = 40  # steps of false position: some 8 do
_SAMPLES: Final = 16  # places a block that is looked at in between
_BULGE: Final = (
    2.0  # times its change to the middle of a block: an axis that comes no closer to a limit is taken to stay inside
)


@dataclass(slots=True, eq=False)
class _Open:
    begin: PathPlace
    end: PathPlace
    worst: PathPlace
    excess: float


class LimitWatch:
    """Follows all limits along a path, chunk by chunk."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        drives = set(limits.from_drives.values())
        own = [(n, side) for n in range(len(limits.axes)) for side in (-1, 1) if (n, side) not in limits.from_drives]
        # An end of an axis that is the limit of its drive is watched there; without drives of its own it is the axis'.
        self.ends = [one for one in own if np.isfinite((limits.lower if one[1] < 0 else limits.upper)[one[0]])]
        self.names = [limits.axes[n].name for n, _ in self.ends]
        self.names += [one.name for one in limits.sums for _ in range(2)]
        self.curved = limits.drives if limits.curved else ()
        self.names += [limits.drive_name(one) for one in self.curved for _ in range(2)]
        assert drives <= set(self.names)
        self._open: dict[int, _Open] = {}
        self._sampled = False

    def excess(self, rows: Matrix) -> Matrix:
        """Return how far (N, limits) rows (N, n_axes) are beyond each limit; negative inside."""
        columns = [(rows[:, n] - self._end(n, side)) * side for n, side in self.ends]
        for one in self.limits.sums:
            total = rows @ np.array(one.sum.coefficients) + one.sum.offset
            columns += [one.lower - total, total - one.upper]
        if self.curved and self.limits.drive_map is not None:
            at = np.array([self.limits.drive_map.drives(row) for row in rows])
            for limit in self.curved:
                columns += [limit.lower - at[:, limit.axis], at[:, limit.axis] - limit.upper]
        return np.stack(columns, axis=1) if columns else np.empty((len(rows), 0))

    def _end(self, n: int, side: int) -> float:
        return float((self.limits.lower if side < 0 else self.limits.upper)[n])

    def take(self, chunk: BlockRun, close: Blocks) -> Iterator[PathViolation]:
        """Take a chunk and yield the violations that have ended.

        Args:
            chunk: The blocks.
            close: Those that come close to a singularity: along a line axes do not change evenly there.
        """
        blocks, shares, axes = self._looked_at(chunk, close)
        excess = self.excess(axes)
        for _ in range(_REFINED if self.curved or not isinstance(chunk.motion, StraightMotion) else 0):
            blocks, shares, axes, excess = self._with_tops(chunk, blocks, shares, axes, excess)
        for limit in range(len(self.names)):
            outside = excess[:, limit] > LIMIT_SLACK
            if limit in self._open or outside.any():
                yield from self._follow(chunk, limit, (blocks, shares, axes), excess[:, limit], outside)

    def finish(self) -> Iterator[PathViolation]:
        """Yield the violations that the path ends in."""
        for limit in sorted(self._open):
            yield self._done(limit)
        self._open.clear()

    def _looked_at(self, chunk: BlockRun, close: Blocks) -> tuple[Blocks, Vector, Matrix]:
        """Return block, share and axis values of the places of a chunk that are looked at, in order."""
        rows, count = chunk.motion.rows, len(chunk.motion.rows) - 1
        between = np.empty(0, dtype=np.intp)
        if self.curved:
            between = np.arange(count)
        elif not isinstance(chunk.motion, StraightMotion):
            margins = -self.excess(rows)
            middle = -self.excess(chunk.motion.axes(np.arange(count), np.full(count, 0.5)))
            # The rows alone would not do: an axis can leave and come back to where it was.
            change = np.maximum(np.abs(middle - margins[:-1]), np.abs(middle - margins[1:]))
            least = np.minimum(np.minimum(margins[:-1], margins[1:]), middle)
            near = ~(least >= _BULGE * change).all(axis=1)  # where nothing is found in the middle, too
            between = np.unique(np.concatenate([np.flatnonzero(near), close]))
        self._sampled |= bool(self.curved) or not isinstance(chunk.motion, StraightMotion)
        inner = np.arange(1, _SAMPLES) / _SAMPLES
        blocks = np.concatenate([np.arange(count), np.repeat(between, len(inner)), [count - 1]])
        shares = np.concatenate([np.zeros(count), np.tile(inner, len(between)), [1.0]])
        order = np.lexsort((shares, blocks))
        blocks, shares = blocks[order], shares[order]
        axes = chunk.motion.axes(blocks, shares)
        known = np.isfinite(axes).all(axis=1)
        return blocks[known], shares[known], axes[known]

    def _follow(
        self,
        chunk: BlockRun,
        limit: int,
        looked_at: tuple[Blocks, Vector, Matrix],
        excess: Vector,
        outside: NDArray[np.bool_],
    ) -> Iterator[PathViolation]:
        blocks, shares, axes = looked_at
        changes = np.flatnonzero(np.diff(outside)) + 1
        for begin, end in itertools.pairwise([0, *changes.tolist(), len(blocks)]):
            if not outside[begin]:
                if limit in self._open:  # since the chunk before, or the part before
                    if begin:
                        self._open[limit].end = self._crossing(chunk, looked_at, excess, begin, limit)
                    yield self._done(limit)
                    del self._open[limit]
                continue
            most = begin + int(excess[begin:end].argmax())
            both = [most, end - 1]
            worst, last = chunk.places(blocks[both].tolist(), shares[both].tolist(), axes[both])
            known = self._open.get(limit)
            if known is None:
                first = self._crossing(chunk, looked_at, excess, begin, limit) if begin else None
                first = first or chunk.places(blocks[:1].tolist(), shares[:1].tolist(), axes[:1])[0]
                self._open[limit] = _Open(first, last, worst, float(excess[most]))
                continue
            known.end = last
            if excess[most] > known.excess:
                known.worst, known.excess = worst, float(excess[most])

    def _with_tops(
        self, chunk: BlockRun, blocks: Blocks, shares: Vector, axes: Matrix, excess: Matrix
    ) -> tuple[Blocks, Vector, Matrix, Matrix]:
        """Return the places looked at with those added at which a limit may be violated most, between them."""
        at = blocks + shares
        before, top, behind = excess[:-2], excess[1:-1], excess[2:]
        may = (
            (top >= before) & (top >= behind) & (2.0 * top > np.minimum(before, behind)) & (top + top > before + behind)
        )
        n, limit = np.nonzero(may)
        left, right = (at[n + 1] - at[n]), (at[n + 2] - at[n + 1])
        down, up = (top - before)[n, limit] / left, (behind - top)[n, limit] / right
        tops = np.unique(
            at[n + 1] + (down * right + up * left) / (down - up) / 2.0
        )  # of the parabola through all three
        tops = tops[(tops > at[0]) & (tops < at[-1]) & ~np.isin(tops, at)] if len(at) else tops
        if not len(tops):
            return blocks, shares, axes, excess
        new = tops.astype(np.intp)
        found = chunk.motion.axes(new, tops - new)
        known = np.isfinite(found).all(axis=1)
        blocks, shares = np.concatenate([blocks, new[known]]), np.concatenate([shares, (tops - new)[known]])
        axes, excess = np.concatenate([axes, found[known]]), np.concatenate([excess, self.excess(found[known])])
        order = np.lexsort((shares, blocks))
        return blocks[order], shares[order], axes[order], excess[order]

    def _crossing(
        self, chunk: BlockRun, looked_at: tuple[Blocks, Vector, Matrix], excess: Vector, n: int, limit: int
    ) -> PathPlace:
        """Return where a limit is crossed between two places that follow one another."""
        blocks, shares, axes = looked_at
        low, high = (float(blocks[k] + shares[k]) for k in (n - 1, n))
        below, above = float(excess[n - 1]), float(excess[n])
        at = min(max(low + (high - low) * below / (below - above), low), high)
        # Along straight axes that is it; else by false position, an end that stays counted half (Illinois).
        for _ in range(_FALSE if self._sampled and (below > 0.0) != (above > 0.0) else 0):
            block = min(int(at), len(chunk.motion.rows) - 2)
            reached = _near(chunk.motion, block, at - block, axes[n])
            value = float(self.excess(reached[None])[0, limit])
            if not abs(value) > LIMIT_SLACK:
                break
            if (value > 0.0) == (above > 0.0):
                high, above, below = at, value, below / 2.0
            else:
                low, below, above = at, value, above / 2.0
            at = low + (high - low) * below / (below - above)
        block = min(int(at), len(chunk.motion.rows) - 2)
        reached = _near(chunk.motion, block, at - block, axes[n])
        return chunk.places([block], [at - block], reached[None])[0]

    def _done(self, limit: int) -> PathViolation:
        found, name = self._open[limit], self.names[limit]
        words = dict(self.limits.violations(found.worst.axes)).get(name, name)
        return PathViolation(name, found.begin, found.end, found.worst, found.excess, words, not self._sampled)


def _near(motion: PathMotion, block: int, t: float, start: Vector) -> Vector:
    """Return the axis values (n_axes,) at a place next to one whose values are known."""
    if isinstance(motion, LineMotion):
        return motion.near(block, t, start)
    found: Vector = motion.axes(np.array([block]), np.array([t]))[0]
    return found
