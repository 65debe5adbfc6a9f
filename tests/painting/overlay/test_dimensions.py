"""Lines of lengths: arrows at both ends, side by side where they would cover each other."""

from __future__ import annotations

import pytest

import chainbuild
from chainbuild import Robot
from chainbuild.painting.marks import Marks
from chainbuild.painting.overlay.dimensions import _aside, _covers, draw_dimensions
from chainbuild.painting.overlay.triads import arrow_head
from chainbuild.painting.stage import Stage
from chainbuild.painting.views import VIEWS, Window

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


def test_slanted_lines_cover_each_other_too() -> None:
    line = ((0.0, 0.0), (100.0, 100.0))
    assert _covers(line, ((20.0, 20.0), (60.0, 60.0)))
    assert not _covers(line, ((20.0, 40.0), (60.0, 80.0)))


def test_heads_of_arrows_point_to_the_end() -> None:
    one, tip, other = arrow_head((0.0, 0.0), (50.0, 0.0), 6.0)
    assert (one, tip, other) == ((44.0, 3.0), (50.0, 0.0), (44.0, -3.0))
    one, tip, other = arrow_head((0.0, 50.0), (0.0, 0.0), 6.0)
    assert (one, tip, other) == ((3.0, 6.0), (0.0, 0.0), (-3.0, 6.0))
    assert arrow_head((0.0, 0.0), (5.0, 0.0)) == ()
    assert arrow_head((100.0, 30.0), (100.0, 80.0), 6.0) == ((97.0, 74.0), (100.0, 80.0), (103.0, 74.0))


def test_lines_and_labels_of_an_arm() -> None:
    stage = Stage(Robot.load("kr6r900"))
    marks = Marks()
    found = [one for one in chainbuild.dimensions(chainbuild.load("kr6r900")) if one.places in ("A1", "A2")]
    wishes = draw_dimensions(marks, found, stage, VIEWS["front"], Window(-1.0, 2.0, 300.0, 900, 900))
    # Up from the base by 400 mm, then 25 mm to the right; the short one first.
    assert [(wish.text, wish.spot) for wish in wishes] == [
        ("MAIN_LENGTH_AB[0] = 25 mm", pytest.approx((303.75, 480.0), abs=1e-3)),
        ("TIRORO_POS[2] = 400 mm", pytest.approx((300.0, 540.0), abs=1e-3)),
    ]
    lines = [stroke.spots for stroke in marks.strokes if stroke.halo]
    assert lines[1] == (pytest.approx((300.0, 600.0), abs=1e-3), pytest.approx((300.0, 480.0), abs=1e-3))
    assert sum(len(stroke.spots) == 1 for stroke in marks.strokes) == 2  # dots: too short for arrows
    assert sum(len(stroke.spots) == 3 for stroke in marks.strokes) == 2
