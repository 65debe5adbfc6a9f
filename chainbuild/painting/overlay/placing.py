"""Labels: each beside what it names, none over another."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

from chainbuild.chain.bodies.body import Colour
from chainbuild.painting.marks import TEXT_SIZE, Caption, Marks, Stroke
from chainbuild.painting.raster.letters import text_width
from chainbuild.painting.views import Spot
from chainbuild.shown import fields_shown

LabelBox = tuple[float, float, float, float]  # left, upper, right, lower border

_DISTANCES: Final = (9.0, 22.0, 40.0, 62.0, 90.0, 125.0, 170.0)  # pixels from what is named, nearest first
_DIRECTIONS: Final = 12  # that are tried at each distance, clockwise from the right
_LED: Final = 15.0  # pixels from which a thin line leads to the label
_GAP: Final = 4.0  # pixels between labels, and to the border of the picture
_RISE: Final = 0.7  # of a text's size: the height of capitals
_DESCENT: Final = 0.2  # likewise what hangs below the line
_CROSSED: Final = 30.0  # pixels farther away are better than a line through the letters
_COVERED: Final = 45.0  # likewise than letters on bodies
_WIDEST: Final = 0.62  # of a text's size a letter: in fonts wider than ours, which an SVG may be shown with


@dataclass(frozen=True, slots=True)
class Wish:
    """A label that wants a place.

    Attributes:
        text: The text.
        spot: What it names, in pixels.
        colour: Red, green, blue in 0…1.
    """

    __repr__ = fields_shown

    text: str
    spot: Spot
    colour: Colour


def place_labels(
    marks: Marks,
    wishes: Iterable[Wish],
    area: LabelBox,
    covered: Callable[[LabelBox], float] = lambda box: 0.0,
    size: float = TEXT_SIZE,
) -> None:
    """Add labels to marks, clear of each other and of the captions there, of lines and bodies where there is room.

    Args:
        marks: Lines that are drawn, captions that have a place; the labels are added.
        wishes: The labels, the most important first.
        area: Part of the picture where labels may be.
        covered: Returns the share of a box that lies on bodies.
        size: Of the text, in pixels.
    """
    taken = [caption_box(caption) for caption in marks.captions]
    segments = [pair for stroke in marks.strokes for pair in pairwise(stroke.spots)]
    for wish in wishes:
        width = label_width(wish.text, size)
        best: tuple[float, LabelBox] | None = None
        for box, distance in _candidates(wish.spot, width, (_RISE + _DESCENT) * size):
            if best is not None and distance >= best[0]:
                break
            if not _inside(box, area) or any(_overlap(box, other) for other in taken):
                continue
            cost = distance + _CROSSED * any(_crosses(segment, box) for segment in segments) + _COVERED * covered(box)
            if best is None or cost < best[0]:
                best = cost, box
        box = best[1] if best is not None else _lowest_free(taken, area, width, (_RISE + _DESCENT) * size)
        taken.append(box)
        x, y = (box[0] + box[2]) / 2.0, box[3] - _DESCENT * size
        marks.captions.append(Caption(wish.text, x, y, wish.colour, size))
        near = min(max(wish.spot[0], box[0]), box[2]), min(max(wish.spot[1], box[1]), box[3])
        if math.dist(near, wish.spot) > _LED:
            marks.strokes.append(Stroke((wish.spot, near), wish.colour, 0.8))


def label_width(text: str, size: float) -> float:
    """Return the pixels that a text takes at most."""
    return size * max(text_width(text), _WIDEST * len(text))


def caption_box(caption: Caption) -> LabelBox:
    """Return what a text covers."""
    half = label_width(caption.text, caption.size) / 2.0
    upper, lower = caption.y - _RISE * caption.size, caption.y + _DESCENT * caption.size
    return caption.x - half, upper, caption.x + half, lower


def _candidates(spot: Spot, width: float, height: float) -> Iterable[tuple[LabelBox, float]]:
    """Yield boxes around a spot and how far they are from it."""
    for distance in _DISTANCES:
        for k in range(_DIRECTIONS):
            c, s = round(math.cos(math.tau * k / _DIRECTIONS), 9), round(math.sin(math.tau * k / _DIRECTIONS), 9)
            x, y = spot[0] + c * (distance + width / 2.0), spot[1] + s * (distance + height / 2.0)
            yield (x - width / 2.0, y - height / 2.0, x + width / 2.0, y + height / 2.0), distance


def _lowest_free(taken: Sequence[LabelBox], area: LabelBox, width: float, height: float) -> LabelBox:
    """Return a place at the left border, over what is there already."""
    lower = area[3] - _GAP
    left = area[0] + _GAP
    while any(_overlap((left, lower - height, left + width, lower), box) for box in taken):
        lower -= 1.0
    return left, lower - height, left + width, lower


def _inside(box: LabelBox, area: LabelBox) -> bool:
    across = box[0] >= area[0] + _GAP and box[2] <= area[2] - _GAP
    return across and box[1] >= area[1] + _GAP and box[3] <= area[3] - _GAP


def _overlap(a: LabelBox, b: LabelBox) -> bool:
    return a[0] < b[2] + _GAP and b[0] < a[2] + _GAP and a[1] < b[3] + _GAP and b[1] < a[3] + _GAP


def _crosses(segment: tuple[Spot, Spot], box: LabelBox) -> bool:
    """Tell whether a line runs through a box."""
    (x, y), (x1, y1) = segment
    begin, end = 0.0, 1.0
    for here, step, low, high in ((x, x1 - x, box[0], box[2]), (y, y1 - y, box[1], box[3])):
        if step == 0.0:
            if not low <= here <= high:
                return False
            continue
        one, other = sorted(((low - here) / step, (high - here) / step))
        begin, end = max(begin, one), min(end, other)
    return begin <= end
