"""Pieces of a face, joined: the border is closed, encloses the same area, and has no corners in between."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from chainbuild.painting.vector.joining import border, chained
from chainbuild.painting.views import Spot
from tests.kit.placed import area

# A square of 10 with a hole in the middle of its lower half, cut into convex pieces that do not share corners.
PIECES: list[tuple[list[Spot], list[int]]] = [
    ([(0, 0), (4, 0), (4, 10), (0, 10)], [2, 4, 2, 2]),
    ([(6, 0), (10, 0), (10, 10), (6, 10)], [2, 2, 2, 4]),
    ([(4, 0), (6, 0), (6, 2), (4, 2)], [2, 4, 3, 4]),
    ([(4, 5), (6, 5), (6, 10), (4, 10)], [3, 4, 2, 4]),
]


def test_pieces_that_share_no_corners_are_joined() -> None:
    edges = border(PIECES)
    loops = sorted(chained((a, b) for a, b, _ in edges), key=lambda loop: abs(area(loop[:-1])))
    assert [loop[0] == loop[-1] for loop in loops] == [True, True]
    corners = [set(loop) for loop in loops]
    assert corners == [{(4, 2), (4, 5), (6, 2), (6, 5)}, {(0, 0), (10, 0), (10, 10), (0, 10)}]
    assert sum(area(loop[:-1]) for loop in loops) == pytest.approx(100.0 - 6.0)
    kinds = {(a, b): kind for a, b, kind in edges}
    assert kinds[(6.0, 2.0), (4.0, 2.0)] == 3
    assert kinds[(0.0, 10.0), (0.0, 0.0)] == 2


def test_corners_that_differ_by_rounding_are_one() -> None:
    shaken = [([(x + 1e-6 * n, y - 1e-6 * n) for x, y in spots], kinds) for n, (spots, kinds) in enumerate(PIECES)]
    assert len(border(shaken)) == len(border(PIECES))


def test_what_is_left_always_closes() -> None:
    rng = np.random.default_rng(5)
    pieces = []
    for _ in range(60):
        angles = np.sort(rng.uniform(0, 2 * np.pi, 5))
        middle, radius = rng.uniform(0, 3, 2), rng.uniform(0.01, 2)
        spots = [(float(middle[0] + radius * np.cos(t)), float(middle[1] + radius * np.sin(t))) for t in angles]
        pieces.append((spots, [0] * 5))
    edges = border(pieces)
    begins, ends = sorted(a for a, _, _ in edges), sorted(b for _, b, _ in edges)
    assert begins == ends
    assert sum((a[0] * b[1] - a[1] * b[0]) / 2 for a, b, _ in edges) == pytest.approx(
        sum(area(spots) for spots, _ in pieces), abs=0.5
    )


def test_corners_on_the_way_are_left_out_and_turns_stay() -> None:
    def line(*spots: Spot) -> list[Spot]:
        (found,) = chained(pairwise(spots))
        return found

    assert line((0.0, 0.0), (5.0, 5.0), (10.0, 10.0)) == [(0.0, 0.0), (10.0, 10.0)]
    assert line((0.0, 0.0), (5.0, -5.0), (10.0, -10.0)) == [(0.0, 0.0), (10.0, -10.0)]
    assert line((0.0, 0.0), (-5.0, 2.5), (-10.0, 5.0)) == [(0.0, 0.0), (-10.0, 5.0)]
    assert line((0.0, 0.0), (5.0, 6.0), (10.0, 10.0)) == [(0.0, 0.0), (5.0, 6.0), (10.0, 10.0)]
    spike: list[Spot] = [(0.0, 0.0), (10.0, 10.0), (5.0, 5.0)]
    assert line(*spike) == spike
    spike = [(0.0, 0.0), (10.0, -4.0), (5.0, -2.0)]
    assert line(*spike) == spike
