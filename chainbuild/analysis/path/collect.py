"""Low parts of blocks put together to stretches of a path, each with its places."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from chainbuild.analysis.path.motion import PathMotion
from chainbuild.analysis.path.nearby import KindLows
from chainbuild.analysis.path.places import PathPlace
from chainbuild.analysis.singularity.structure import SingularityKind
from chainbuild.analysis.vanishing.lows import Low
from chainbuild.analysis.vanishing.waves import TOUCHES
from chainbuild.arrays import Matrix, Vector

MOST_MINIMA: Final = 100  # of one stretch: a path that oscillates through a singularity has thousands
_SEARCHED: Final = 1e-3  # of a block: zeros that a search leaves at values of 1e-7 are one up to this distance
_JOINED: Final = 1e-9  # of a block: ends of parts this close to a row continue beyond it


@dataclass(frozen=True, slots=True, eq=False)
class Point:
    """A place with the motion there.

    Attributes:
        place: The place.
        value: The function of the kind.
        rates: (n_axes,) what the axes change over a block at their speed there, mm and degrees.
        tip_mm: The way of the tip over it.
        turn_deg: The turn of the tool over it.
    """

    place: PathPlace
    value: float
    rates: Vector
    tip_mm: float
    turn_deg: float


@dataclass(slots=True, eq=False)
class Growing:
    """A stretch that may go on beyond the last row looked at."""

    kind: SingularityKind
    proven: bool
    begin: PathPlace
    end: PathPlace
    least: Point
    zeros: list[Point] = field(default_factory=list)
    held: bool = True
    apart: float = _JOINED

    def add(self, end: PathPlace, least: Point, zeros: list[Point], held: bool) -> None:
        """Add a part that follows."""
        self.end, self.held = end, self.held and held
        if least.value < self.least.value:
            self.least = least
        for one in zeros:
            last = self.zeros[-1].place if self.zeros else None
            again = last is not None and one.place.row + one.place.share - last.row - last.share < self.apart
            if again and one.value < self.zeros[-1].value:
                self.zeros[-1] = one
            elif not again and len(self.zeros) < MOST_MINIMA:
                self.zeros.append(one)

    @property
    def minima(self) -> list[Point]:
        """The places reported: where it is singular, else the one closest to it."""
        return self.zeros or [self.least]


@dataclass(frozen=True, slots=True, eq=False)
class BlockRun:
    """Some blocks of a path.

    Attributes:
        motion: Along them.
        first: Row at the begin of the first one, from 0.
        begins_mm: (N,) way of the tip to the begin of each.
        mm_per_second: Feed; None: not given.
    """

    motion: PathMotion
    first: int
    begins_mm: Vector
    mm_per_second: float | None

    def places(self, blocks: list[int], shares: list[float], known: Matrix | None = None) -> list[PathPlace]:
        """Return places of blocks, counted from the first of the chunk.

        Args:
            blocks: Their blocks.
            shares: Their shares.
            known: (n, n_axes) axis values there; None: they are found.
        """
        index, t = np.array(blocks, dtype=np.intp), np.array(shares)
        axes = self.motion.axes(index, t) if known is None else known
        ways = self.begins_mm[index] + self.motion.lengths(index, t)
        return [
            PathPlace(self.first + block, share, row, float(way), self.seconds(float(way)))
            for block, share, row, way in zip(blocks, shares, axes, ways, strict=True)
        ]

    def seconds(self, way_mm: float) -> float | None:
        """Return the time to a way of the tip, or None where no feed is given."""
        return None if self.mm_per_second is None else way_mm / self.mm_per_second

    def points(self, blocks: list[int], shares: list[float], values: list[float]) -> list[Point]:
        """Return places with the motion there."""
        places = self.places(blocks, shares)
        rates, tips, turns = self.motion.speeds(np.array(blocks, dtype=np.intp), np.array(shares))
        rows = zip(places, values, rates, tips.tolist(), turns.tolist(), strict=True)
        return [Point(*row) for row in rows]


class StretchCollector:
    """Puts parts of one kind together, chunk by chunk."""

    def __init__(self, kind: SingularityKind) -> None:
        self.kind = kind
        self._open: Growing | None = None

    def take(self, chunk: BlockRun, found: KindLows) -> Iterator[Growing]:
        """Take the parts of a chunk and yield the stretches that have ended."""
        parts = [(block, part) for block in sorted(found.parts) for part in found.parts[block]]
        if self._open is not None and not (parts and _continues(self._open, chunk.first + parts[0][0], parts[0][1])):
            yield self._open
            self._open = None
        if not parts:
            return
        ends = chunk.places([b for b, _ in parts for _ in range(2)], [t for _, p in parts for t in (p.begin, p.end)])
        least = chunk.points([b for b, _ in parts], [p.least for _, p in parts], [p.value for _, p in parts])
        singular = [
            part.zeros or ((part.least,) if part.value <= found.singular else ()) for _, part in parts
        ]  # fmt: skip
        values = [part.value for (_, part), places in zip(parts, singular, strict=True) for _ in places]
        flat = [(block, t) for (block, _), places in zip(parts, singular, strict=True) for t in places]
        zeros = iter(chunk.points([b for b, _ in flat], [t for _, t in flat], values) if flat else ())
        for n, (block, part) in enumerate(parts):
            own = [next(zeros) for _ in singular[n]]
            if self._open is not None and not _continues(self._open, chunk.first + block, part):
                yield self._open
                self._open = None
            if self._open is None:
                apart = _JOINED if found.singular <= TOUCHES else _SEARCHED
                self._open = Growing(self.kind, found.proven, ends[2 * n], ends[2 * n + 1], least[n], apart=apart)
            self._open.add(ends[2 * n + 1], least[n], own, part.held)

    def finish(self) -> Iterator[Growing]:
        """Yield the stretch that the path ends in."""
        if self._open is not None:
            yield self._open
            self._open = None


def _continues(before: Growing, row: int, part: Low) -> bool:
    """Return whether a part begins at the row at which a stretch has ended."""
    return part.begin <= _JOINED and before.end.row == row - 1 and before.end.share >= 1.0 - _JOINED
