"""Labels: beside what they name, none over another, none outside."""

from __future__ import annotations

import math
from itertools import combinations, pairwise

import numpy as np
import pytest

from chainbuild.painting.marks import Caption, Marks, Stroke
from chainbuild.painting.overlay.placing import Wish, _crosses, caption_box, place_labels

AREA = (0.0, 0.0, 400.0, 300.0)
RED = (1.0, 0.0, 0.0)


def overlapping(marks: Marks) -> list[tuple[str, str]]:
    """Return the texts that cover each other."""
    found = []
    for one, other in combinations(marks.captions, 2):
        a, b = caption_box(one), caption_box(other)
        if a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]:
            found.append((one.text, other.text))
    return found


def test_a_label_stands_beside_what_it_names() -> None:
    marks = Marks()
    place_labels(marks, [Wish("flange", (200.0, 100.0), RED)], AREA)
    (caption,) = marks.captions
    left, upper, right, lower = caption_box(caption)
    assert left == pytest.approx(209.0)
    assert (upper, lower) == pytest.approx((100.0 - 0.45 * 13.0, 100.0 + 0.45 * 13.0))
    assert caption.y == pytest.approx(lower - 0.2 * 13.0)
    assert right == pytest.approx(209.0 + 0.62 * 13.0 * 6)
    assert (caption.colour, marks.strokes) == (RED, [])


def test_many_labels_in_one_place_stand_apart_and_lines_lead_to_them() -> None:
    marks = Marks(captions=[Caption("front", 200.0, 104.0)])
    place_labels(marks, [Wish(f"HD{n} = −45 mm", (200.0, 100.0), RED) for n in range(12)], AREA)
    assert len(marks.captions) == 13
    assert overlapping(marks) == []
    for caption in marks.captions:
        left, upper, right, lower = caption_box(caption)
        assert 0.0 <= left < right <= 400.0
        assert 0.0 <= upper < lower <= 300.0
    for stroke in marks.strokes:
        assert stroke.spots[0] == (200.0, 100.0)
        assert math.dist(*stroke.spots) > 15.0


def test_labels_stay_clear_of_the_border_and_of_lines() -> None:
    marks = Marks([Stroke(((0.0, 100.0), (400.0, 100.0)))])
    place_labels(marks, [Wish("tool", (395.0, 100.0), RED), Wish("base", (2.0, 298.0), RED)], AREA)
    for caption in marks.captions:
        left, upper, right, lower = caption_box(caption)
        assert 4.0 <= left < right <= 396.0
        assert 4.0 <= upper < lower <= 296.0
    upper, lower = caption_box(marks.captions[0])[1::2]
    assert not upper < 100.0 < lower


def test_without_room_nearby_labels_go_to_the_border() -> None:
    marks = Marks()
    place_labels(marks, [Wish("a name", (60.0, 30.0), RED) for _ in range(12)], (0.0, 0.0, 120.0, 500.0))
    assert overlapping(marks) == []
    boxes = [caption_box(caption) for caption in marks.captions]
    assert min(box[0] for box in boxes) == pytest.approx(4.0)
    assert max(box[3] for box in boxes) == pytest.approx(496.0)
    rng = np.random.default_rng(4)
    for _ in range(5):
        marks = Marks([Stroke(tuple(map(tuple, rng.uniform(0, 300, (4, 2)).tolist())))])
        wishes = [
            Wish("word " * int(rng.integers(1, 4)), tuple(rng.uniform(0, 300, 2).tolist()), RED) for _ in range(15)
        ]
        place_labels(marks, wishes, AREA)
        assert overlapping(marks) == []
        assert all(len(list(pairwise(stroke.spots))) >= 1 for stroke in marks.strokes)


def test_labels_stand_beside_bodies_where_there_is_room() -> None:
    marks = Marks()
    place_labels(marks, [Wish("tool", (200.0, 100.0), RED)], AREA, lambda box: float(box[2] > 200.0))
    (caption,) = marks.captions
    assert caption_box(caption)[2] <= 200.0
    marks = Marks()  # all of it is covered: as near as without bodies
    place_labels(marks, [Wish("tool", (200.0, 100.0), RED)], AREA, lambda box: 1.0)
    assert caption_box(marks.captions[0])[0] == pytest.approx(209.0)


def test_labels_step_off_a_line_clockwise() -> None:
    marks = Marks([Stroke(((200.0, 100.0), (400.0, 100.0)))])
    place_labels(marks, [Wish("tool", (200.0, 100.0), RED)], AREA)
    left, upper, _, lower = caption_box(marks.captions[0])
    # A turn of 30° down: half as far down as away, and clear of the line.
    assert (upper + lower) / 2.0 == pytest.approx(100.0 + 0.5 * (9.0 + 0.45 * 13.0))
    assert upper > 100.0
    assert left > 200.0
    marks = Marks()
    place_labels(marks, [Wish("tool", (200.0, 3.0), RED)], AREA)
    assert caption_box(marks.captions[0])[1] >= 4.0


@pytest.mark.parametrize(
    ("segment", "crosses"),
    [
        (((0, 20), (50, 20)), True),
        (((20, 0), (20, 50)), True),
        (((50, 20), (0, 20)), True),
        (((0, 0), (9, 9)), False),
        (((31, 0), (31, 50)), False),
        (((0, 31), (50, 31)), False),
        (((0, 35), (35, 0)), True),
        (((0, 15), (15, 0)), False),
        (((25, 45), (45, 25)), False),
        (((15, 15), (16, 16)), True),
    ],
)
def test_lines_through_a_box(segment: tuple, crosses: bool) -> None:
    assert _crosses(segment, (10.0, 10.0, 30.0, 30.0)) is crosses
