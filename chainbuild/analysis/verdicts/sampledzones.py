"""Parts of blocks on which a measure without a bound is low: searched within wider parts that certainly hold them.

Samples start from the zeros and minima of what the wider parts were found by, then from the measure's own minima: a
zone is found however narrow it is if it has one of them, and its ends by bisection.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.analysis.path.motion import PathMotion
from chainbuild.analysis.vanishing.lows import Low
from chainbuild.analysis.vanishing.tracing import Blocks, lowest_places, traced_lows
from chainbuild.analysis.verdicts.controlmeasure import control_values
from chainbuild.arrays import Vector

_SAMPLES: Final = 33  # places a piece at which minima are looked for: about four a singularity of the three kinds
_JOINED: Final = 1e-9  # of a block: parts this close are one


@dataclass(frozen=True, slots=True, eq=False)
class ZoneSearch:
    """What is looked for.

    Attributes:
        motion: Between rows.
        measure: Of `measure_in_force`.
        limit: Largest value of the measure.
    """

    motion: PathMotion
    measure: str
    limit: float

    def values(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the measure (n,) at shares of blocks; inf where no axis values are found."""
        return control_values(self.motion.robot, self.measure, self.motion.axes(blocks, t))


def low_within(low: Low, begin: float, end: float) -> Low:
    """Return a part of a piece as a part of the block that the piece lies in from `begin` to `end`."""

    def share(t: float) -> float:
        return end if t == 1.0 else begin + t * (end - begin)

    return Low(share(low.begin), share(low.end), tuple(map(share, low.zeros)), share(low.least), low.value, low.held)


def joined(parts: Iterable[Low]) -> list[Low]:
    """Return parts of one block in order, those that overlap or touch put together."""
    found: list[Low] = []
    for low in sorted(parts, key=lambda one: (one.begin, one.end)):
        before = found[-1] if found else None
        if before is None or low.begin > before.end + _JOINED:
            found.append(low)
            continue
        best = min(before, low, key=lambda one: one.value)
        zeros = tuple(sorted({*before.zeros, *low.zeros}))
        end = max(before.end, low.end)
        found[-1] = Low(before.begin, end, zeros, best.least, best.value, before.held and low.held)
    return found


@dataclass(frozen=True, slots=True, eq=False)
class _Pieces:
    """The measure along pieces of blocks, as blocks of their own; see `Traced`."""

    search: ZoneSearch
    blocks: Blocks
    begins: Vector
    ends: Vector

    @classmethod
    def between(cls, search: ZoneSearch, places: Mapping[int, Iterable[Iterable[float]]]) -> _Pieces:
        """Return the pieces between the shares of each part of each block."""
        pieces = [
            (block, begin, end)
            for block, parts in places.items()
            for part in parts
            for begin, end in _pairs(sorted(set(part)))
        ]
        begins, ends = (np.array([piece[n] for piece in pieces], dtype=float) for n in (1, 2))
        return cls(search, np.array([piece[0] for piece in pieces], dtype=np.intp), begins, ends)

    def shares(self, pieces: Blocks, t: Vector) -> Vector:
        """Return shares of the blocks at shares of pieces."""
        return self.begins[pieces] + t * (self.ends[pieces] - self.begins[pieces])

    def margins(self, blocks: Blocks, t: Vector) -> Vector:
        """Return how far the measure is above its limit."""
        return self.sizes(blocks, t) - self.search.limit

    def sizes(self, blocks: Blocks, t: Vector) -> Vector:
        """Return the measure."""
        return self.search.values(self.blocks[blocks], self.shares(blocks, t))

    def steps(self, blocks: Blocks, t: Vector, margins: Vector) -> Vector:
        """Return the distance of samples."""
        return np.full(len(blocks), 1.0 / (_SAMPLES - 1))

    def minima(self) -> dict[int, list[float]]:
        """Return the shares of blocks at which the measure has minima, by piece."""
        count = len(self.blocks)
        every = np.repeat(np.arange(count), _SAMPLES)
        grid = np.tile(np.linspace(0.0, 1.0, _SAMPLES), count)
        sizes = self.sizes(every, grid).reshape(count, _SAMPLES)
        padded = np.pad(sizes, ((0, 0), (1, 1)), constant_values=np.inf)
        valley = (sizes <= padded[:, :-2]) & (sizes <= padded[:, 2:]) & np.isfinite(sizes)
        valley[:, 1:] &= sizes[:, 1:] != sizes[:, :-1]  # a flat part is one valley
        piece, column = np.nonzero(valley)
        step = 1.0 / (_SAMPLES - 1)
        start = np.asarray(column * step, dtype=float)
        low, high = np.maximum(start - step, 0.0), np.minimum(start + step, 1.0)
        t, _ = lowest_places(self, piece, low, high, start, sizes[piece, column])
        found: dict[int, list[float]] = {}
        for n, share in zip(piece.tolist(), self.shares(piece, t).tolist(), strict=True):
            found.setdefault(n, []).append(share)
        return found


def _pairs(shares: list[float]) -> Iterable[tuple[float, float]]:
    return itertools.pairwise(shares) if len(shares) > 1 else [(shares[0], shares[0])]


def sampled_parts(search: ZoneSearch, wider: Mapping[int, Iterable[Low]]) -> dict[int, list[Low]]:
    """Return the parts of blocks on which the measure is at most its limit.

    Args:
        search: Measure and limit.
        wider: Block → parts outside of which it is certainly above.
    """
    apart = {
        block: [
            {low.begin, low.end, *(t for one in parts for t in (one.least, *one.zeros) if low.begin <= t <= low.end)}
            for low in joined(parts)
        ]
        for block, parts in ((block, list(parts)) for block, parts in wider.items())
    }
    pieces = _Pieces.between(search, apart)
    if not len(pieces.blocks):
        return {}
    split: dict[int, list[list[float]]] = {}
    minima = pieces.minima()
    for n, block in enumerate(pieces.blocks.tolist()):
        split.setdefault(block, []).append([pieces.begins[n], *minima.get(n, ()), pieces.ends[n]])
    finer = _Pieces.between(search, split)
    found: dict[int, list[Low]] = {}
    for n, parts in traced_lows(finer, np.arange(len(finer.blocks))).items():
        begin, end = float(finer.begins[n]), float(finer.ends[n])
        found.setdefault(int(finer.blocks[n]), []).extend(low_within(low, begin, end) for low in parts)
    return {block: joined(parts) for block, parts in found.items()}
