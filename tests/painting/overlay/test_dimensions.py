"""Lines of lengths: arrows at both ends, side by side where they would cover each other."""

from __future__ import annotations

import pytest

from chainbuild.painting.overlay.dimensions import _aside, _covers
from chainbuild.painting.overlay.triads import arrow_head

UPRIGHT = ((100.0, 300.0), (100.0, 100.0))


def test_a_line_alone_keeps_its_place() -> None:
    assert _aside(UPRIGHT, []) == UPRIGHT
    assert _aside(UPRIGHT, [((150.0, 300.0), (150.0, 100.0)), ((100.0, 100.0), (100.0, 20.0))]) == UPRIGHT


def test_lines_step_aside_to_the_same_side_whatever_their_sense() -> None:
    first = [((100.0, 250.0), (100.0, 150.0))]
    assert _aside(UPRIGHT, first) == ((114.0, 300.0), (114.0, 100.0))
    assert _aside(UPRIGHT[::-1], first) == ((114.0, 100.0), (114.0, 300.0))
    assert _aside(UPRIGHT, [*first, ((114.0, 250.0), (114.0, 150.0))]) == ((128.0, 300.0), (128.0, 100.0))
    level = ((10.0, 50.0), (90.0, 50.0))
    for line in (level, level[::-1]):
        moved = _aside(line, [level])
        assert {y for _, y in moved} == {36.0}
        assert [x for x, _ in moved] == [x for x, _ in line]


@pytest.mark.parametrize(
    ("other", "covers"),
    [
        (((100.0, 90.0), (100.0, 120.0)), True),
        (((106.0, 200.0), (106.0, 250.0)), True),
        (((110.0, 200.0), (110.0, 250.0)), False),  # beside
        (((100.0, 99.0), (100.0, 20.0)), False),  # behind its end
        (((100.0, 301.0), (100.0, 400.0)), False),
        (((60.0, 200.0), (140.0, 200.0)), False),  # across
    ],
)
def test_lines_that_run_along_each_other(other: tuple, covers: bool) -> None:
    assert _covers(UPRIGHT, other) is covers
    assert _covers(UPRIGHT[::-1], other[::-1]) is covers


def test_heads_of_arrows_point_to_the_end() -> None:
    one, tip, other = arrow_head((0.0, 0.0), (50.0, 0.0), 6.0)
    assert (one, tip, other) == ((44.0, 3.0), (50.0, 0.0), (44.0, -3.0))
    one, tip, other = arrow_head((0.0, 50.0), (0.0, 0.0), 6.0)
    assert (one, tip, other) == ((3.0, 6.0), (0.0, 0.0), (-3.0, 6.0))
    assert arrow_head((0.0, 0.0), (5.0, 0.0)) == ()
