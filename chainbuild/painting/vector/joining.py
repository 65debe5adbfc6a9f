"""Pieces of a face joined again: the border of what is seen of it, and what lies along the border."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import Final

import numpy as np

from chainbuild.painting.views import Spot

Edge = tuple[Spot, Spot, int]  # from, to, what it is

_NEAR: Final = 0.02  # pixels: corners this near are one, and a corner this near to an edge lies on it
_STRAIGHT: Final = 0.06  # pixels that a corner may be off the line between its neighbours to be left out


def border(pieces: Sequence[tuple[Sequence[Spot], Sequence[int]]]) -> list[Edge]:
    """Return the edges around pieces of a face, without those between two of them.

    Every piece runs around once, and so does what is left: as many edges end in a corner as begin there.

    Args:
        pieces: Corners, all in the same sense, and what the edge from each to the next is.
    """
    spots = _joined([spot for corners, _ in pieces for spot in corners])
    edges: list[Edge] = []
    for around, kinds in pieces:
        own = [spots[spot] for spot in around]
        edges += [edge for edge in zip(own, [*own[1:], own[0]], kinds, strict=True) if edge[0] != edge[1]]
    found: dict[tuple[Spot, Spot], list[int]] = {}
    for stops, (_, _, kind) in zip(_with_stops(edges), edges, strict=True):
        for begin, end in pairwise(stops):
            if found.get((end, begin)):
                found[end, begin].pop()
            else:
                found.setdefault((begin, end), []).append(kind)
    return [(begin, end, kind) for (begin, end), kinds in found.items() for kind in kinds]


def _joined(spots: Sequence[Spot]) -> Mapping[Spot, Spot]:
    """Return the corner that stands for each: the first of those that are near."""
    found: dict[Spot, Spot] = {}
    cells: dict[tuple[int, int], Spot] = {}
    for spot in spots:
        if spot in found:
            continue
        column, row = int(spot[0] // _NEAR), int(spot[1] // _NEAR)
        near = [cells.get((column + i, row + j)) for i in (0, -1, 1) for j in (0, -1, 1)]
        known = next((other for other in near if other is not None), None)
        found[spot] = known or spot
        if known is None:
            cells[column, row] = spot
    return found


def _with_stops(edges: Sequence[Edge]) -> list[list[Spot]]:
    """Return edges with the corners that lie on them, the same in both senses."""
    if not edges:
        return []
    corners = sorted({edge[0] for edge in edges})
    x, y = np.array(corners).T
    # Measured from the same end in both senses, to the last bit.
    ends = np.array([sorted(edge[:2]) for edge in edges])
    (x0, y0), (dx, dy) = ends[:, 0].T[:, :, None], (ends[:, 1] - ends[:, 0]).T[:, :, None]
    square = dx * dx + dy * dy
    margin = _NEAR * np.sqrt(square)
    along, off = (x - x0) * dx + (y - y0) * dy, np.abs((x - x0) * dy - (y - y0) * dx)
    rows, columns = np.nonzero((off <= margin) & (along > margin) & (along < square - margin))
    on: dict[int, list[tuple[float, Spot]]] = {}
    for row, column, place in zip(rows.tolist(), columns.tolist(), along[rows, columns].tolist(), strict=True):
        on.setdefault(row, []).append((place, corners[column]))
    return [
        [one, *(spot for _, spot in sorted(on.get(n, ()), reverse=other < one)), other]
        for n, (one, other, _) in enumerate(edges)
    ]


def chained(edges: Iterable[tuple[Spot, Spot]]) -> list[list[Spot]]:
    """Return edges as lines as long as they run on; a closed one ends where it begins."""
    after: dict[Spot, list[Spot]] = {}
    ends = set()
    for a, b in edges:
        after.setdefault(a, []).append(b)
        ends.add(b)
    chains = []
    # Open lines first: from where nothing leads to.
    for start in [*(spot for spot in after if spot not in ends), *after]:
        while after.get(start):
            chain = [start]
            while after.get(chain[-1]):
                chain.append(after[chain[-1]].pop(0))
            chains.append(_straightened(chain))
    return chains


def _straightened(spots: Sequence[Spot]) -> list[Spot]:
    """Return a line without the corners that one would not see."""
    kept = [spots[0]]
    for here, after in pairwise(spots[1:]):
        (ax, ay), (bx, by) = kept[-1], after
        length = ((bx - ax) ** 2 + (by - ay) ** 2) ** 0.5
        off = abs((here[0] - ax) * (by - ay) - (here[1] - ay) * (bx - ax))
        onwards = (here[0] - ax) * (bx - here[0]) + (here[1] - ay) * (by - here[1]) >= 0.0
        if not (onwards and off <= _STRAIGHT * length):
            kept.append(here)
    return [*kept, spots[-1]]
