"""Parts of blocks on which a function is at or below a threshold."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from chainbuild.analysis.vanishing.waves import TOUCHES, Wave, throughout, zeros

_NARROW: Final = 1e-9  # of a block: parts are told apart down to this, places are promised to 1e-6


@dataclass(frozen=True, slots=True)
class Low:
    """Part of a block on which |f| is at or below a threshold.

    Attributes:
        begin: Share of the block.
        end: Share of the block.
        zeros: Shares at which f is 0; the begin alone where it is 0 throughout.
        least: Share at which |f| is least.
        value: |f| there.
        held: Whether f is 0 throughout the part.
    """

    begin: float
    end: float
    zeros: tuple[float, ...]
    least: float
    value: float
    held: bool = False


def lows(wave: Wave, near: float) -> list[Low]:
    """Return the parts of a block on which |f| ≤ near, in order.

    Args:
        wave: f.
        near: Threshold above 0.
    """
    inner = zeros(wave)
    if throughout(wave, near):
        ends: Sequence[float] = (0.0, 1.0)
    else:
        edges = sorted({0.0, *zeros(wave.shifted(-near)), *zeros(wave.shifted(near)), 1.0})
        ends = [edges[0]]
        for low, high in itertools.pairwise(edges):
            ends = [*ends, high] if high - low > _NARROW or high == 1.0 else ends
    turns = None
    found: list[Low] = []
    for low, high in itertools.pairwise(ends):
        if abs(wave.at((low + high) / 2.0)) > near:
            continue
        crossed = [t for t in inner if low - _NARROW <= t <= high + _NARROW]
        if not crossed and turns is None:
            turns = zeros(wave.slope())
        places = crossed or [low, high, *(t for t in turns or () if low < t < high)]
        least = min(places, key=lambda t: abs(wave.at(t)))
        if abs(wave.at(least)) <= TOUCHES and not crossed:
            crossed = [least]
        begin = low
        if found and found[-1].end == low:  # it touches the threshold from below, and is one part
            before = found.pop()
            begin, crossed = before.begin, [*before.zeros, *crossed]
            least = min(before.least, least, key=lambda t: abs(wave.at(t)))
        held = not wave.terms and bool(crossed)
        found.append(Low(begin, high, tuple(dict.fromkeys(crossed)), least, abs(wave.at(least)), held))
    return found
