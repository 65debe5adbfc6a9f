"""Parts below a threshold by steps that a bound of the rate proves: sphere tracing, for many blocks at once.

A value whose rate along a block is at most B cannot reach its threshold within |value - threshold| / B. Each step is
that long, inside a low part as outside. Close to the threshold steps would become endless: they have a least length,
over which a value can dip below the threshold by at most B times that length without being noticed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from chainbuild.analysis.vanishing.lows import Low
from chainbuild.analysis.vanishing.waves import TOUCHES
from chainbuild.arrays import Vector

Blocks = NDArray[np.intp]

LEAST_STEP: Final = 1.0 / 512.0  # of a block: where a bound tells nothing, so many places are looked at
_HALVINGS: Final = 34  # of a step: ends to 1e-10 of a block
_SECTIONS: Final = 44  # golden ones: minima to 1e-10 of a block
_GOLDEN: Final = 0.6180339887498949  # share of a bracket that golden-section search keeps
_FEWEST: Final = 33  # places at which a low part is looked at for its minima


class Traced(Protocol):
    """A value along blocks that is low where its margin is 0 or less."""

    def margins(self, blocks: Blocks, t: Vector) -> Vector:
        """Return how far (n,) the value is above its threshold at shares t (n,) of blocks (n,); inf: no value."""
        ...

    def sizes(self, blocks: Blocks, t: Vector) -> Vector:
        """Return what is reported (n,): 0 at a singularity, and least where the margin is."""
        ...

    def steps(self, blocks: Blocks, t: Vector, margins: Vector) -> Vector:
        """Return shares (n,) of the blocks over which the margins certainly change by no more than `margins` (n,)."""
        ...


def traced_lows(traced: Traced, blocks: Blocks) -> dict[int, list[Low]]:
    """Return the parts of blocks on which a value is low, by block; blocks without are left out.

    Args:
        traced: The value.
        blocks: Indices of the blocks that are looked at, each once.
    """
    places = _places(traced, blocks)
    if not len(places.blocks):
        return {}
    parts = _parts(traced, places)
    return _with_minima(traced, *parts) if len(parts[0]) else {}


@dataclass(frozen=True, slots=True, eq=False)
class _Places:
    """Where blocks were looked at, block by block in rising order, and whether the value is low there."""

    blocks: Blocks
    t: Vector
    low: NDArray[np.bool_]


def _places(traced: Traced, blocks: Blocks) -> _Places:
    """Walk along all blocks and return the places of those that have a low one."""
    t = np.zeros(len(blocks))
    samples: list[tuple[Blocks, Vector, NDArray[np.bool_]]] = []
    while len(blocks):
        margins = traced.margins(blocks, t)
        samples.append((blocks, t, margins <= 0.0))
        going = t < 1.0
        blocks, t, margins = blocks[going], t[going], margins[going]
        if len(blocks):
            steps = traced.steps(blocks, t, np.abs(margins))
            t = np.minimum(t + np.maximum(steps, LEAST_STEP), 1.0)
    if not samples:
        return _Places(blocks, t, np.zeros(0, bool))
    every, shares = np.concatenate([s[0] for s in samples]), np.concatenate([s[1] for s in samples])
    low = np.concatenate([s[2] for s in samples])
    order = np.lexsort((shares, every))
    order = order[np.isin(every[order], every[low])]
    return _Places(every[order], shares[order], low[order])


def _parts(traced: Traced, places: _Places) -> tuple[Blocks, Vector, Vector]:
    """Return block, begin and end of each low part."""
    blocks, t, low = places.blocks, places.t, places.low
    first, last = np.diff(blocks, prepend=-1) != 0, np.diff(blocks, append=-1) != 0
    changes = np.flatnonzero((low[1:] != low[:-1]) & ~first[1:])
    edges = _bisected(traced, blocks[changes], t[changes], t[changes + 1], low[changes])
    begins, ends = low[changes + 1], low[changes]
    at_begin, at_end = blocks[first & low], blocks[last & low]
    starts = np.concatenate([at_begin, blocks[changes][begins]]), np.concatenate([0.0 * at_begin, edges[begins]])
    stops = np.concatenate([at_end, blocks[changes][ends]]), np.concatenate([0.0 * at_end + 1.0, edges[ends]])
    order, other = (np.lexsort((part[1], part[0])) for part in (starts, stops))
    return starts[0][order], starts[1][order], stops[1][other]


def _bisected(traced: Traced, blocks: Blocks, low: Vector, high: Vector, first: NDArray[np.bool_]) -> Vector:
    """Return the shares between two at which being low changes."""
    for _ in range(_HALVINGS if len(blocks) else 0):
        middle = (low + high) / 2.0
        same = (traced.margins(blocks, middle) <= 0.0) == first
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return (low + high) / 2.0


def _with_minima(traced: Traced, blocks: Blocks, begins: Vector, ends: Vector) -> dict[int, list[Low]]:
    """Return the low parts, each with its zeros and its least value."""
    shares = begins[:, None] + (ends - begins)[:, None] * np.linspace(0.0, 1.0, _FEWEST)
    sizes = traced.sizes(np.repeat(blocks, _FEWEST), shares.ravel()).reshape(shares.shape)
    padded = np.pad(sizes, ((0, 0), (1, 1)), constant_values=np.inf)
    valley = (sizes <= padded[:, :-2]) & (sizes <= padded[:, 2:])
    # Only valleys that may hold a zero or the least value; a flat part is one valley.
    least, most = sizes.min(axis=1, keepdims=True), sizes.max(axis=1, keepdims=True)
    valley &= sizes <= least + (most - least) / 4.0
    valley[:, 1:] &= sizes[:, 1:] != sizes[:, :-1]
    part, column = np.nonzero(valley)
    low, high = shares[part, np.maximum(column - 1, 0)], shares[part, np.minimum(column + 1, _FEWEST - 1)]
    t, values = lowest_places(traced, blocks[part], low, high, shares[part, column], sizes[part, column])
    found: dict[int, list[Low]] = {}
    for n, block in enumerate(blocks.tolist()):
        mine = part == n
        own, reached = t[mine], values[mine]
        best = int(reached.argmin())
        zeros = tuple(sorted({float(v) for v in own[reached <= TOUCHES]}))
        held = bool(sizes[n].max() <= TOUCHES)
        one = Low(float(begins[n]), float(ends[n]), zeros, float(own[best]), float(reached[best]), held)
        found.setdefault(block, []).append(one)
    return found


def lowest_places(
    traced: Traced, blocks: Blocks, low: Vector, high: Vector, start: Vector, known: Vector
) -> tuple[Vector, Vector]:
    """Return shares and sizes of the minima in brackets, by golden-section search; no worse than those known."""
    a, b = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_a, at_b = traced.sizes(blocks, a), traced.sizes(blocks, b)
    for _ in range(_SECTIONS):
        left = at_a < at_b
        low, high = np.where(left, low, a), np.where(left, b, high)
        a, b = np.where(left, high - _GOLDEN * (high - low), b), np.where(left, a, low + _GOLDEN * (high - low))
        fresh = traced.sizes(blocks, np.where(left, a, b))
        at_a, at_b = np.where(left, fresh, at_b), np.where(left, at_a, fresh)
    middle = (low + high) / 2.0
    reached = traced.sizes(blocks, middle)
    better = reached < known
    return np.where(better, middle, start), np.where(better, reached, known)


def bisected_share(holds: Callable[[float], bool], low: float, high: float) -> float:
    """Return the share of a block, between one at which a condition does not hold and one at which it does."""
    for _ in range(_HALVINGS):
        middle = (low + high) / 2.0
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high
