"""Lengths of the machine data as lines with arrows and labels."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Final

from chainbuild.chain.bodies.body import Colour
from chainbuild.frames import translation
from chainbuild.painting.marks import Marks, Stroke
from chainbuild.painting.overlay.measures import Dimension
from chainbuild.painting.overlay.placing import Wish
from chainbuild.painting.overlay.triads import arrow_head
from chainbuild.painting.stage import Stage
from chainbuild.painting.views import Spot, View, Window

_Line = tuple[Spot, Spot]

_COLOUR: Final[Colour] = (0.05, 0.28, 0.62)  # as no body
_SEEN: Final = 2.0  # pixels: a length along the line of sight cannot be shown
_STEP: Final = 14.0  # pixels between lines side by side
_BESIDE: Final = 8.0  # pixels: lines nearer than this are taken for one
_UPRIGHT: Final = 1e-6  # horizontal share of a direction that counts as none
_ROOM: Final = 22.0  # pixels from which arrows fit between the ends


def draw_dimensions(marks: Marks, found: Iterable[Dimension], stage: Stage, view: View, window: Window) -> list[Wish]:
    """Add lengths to marks, and return their labels.

    Args:
        marks: Where to.
        found: The lengths.
        stage: The machine they are of.
        view: From where one looks.
        window: What of it fills the picture.
    """
    lines = []
    for one in found:
        start, end = (
            window.spot(view, stage.place(one.link, translation(*point))[:3, 3].tolist())
            for point in (one.start, one.end)
        )
        if math.dist(start, end) >= _SEEN:
            lines.append((math.dist(start, end), (start, end), one.label))
    drawn: list[_Line] = []
    wishes = []
    # The short ones keep their place, longer ones that would cover them step aside.
    for _, line, label in sorted(lines):
        aside = _aside(line, drawn)
        for spot, other in zip(line, aside, strict=True):
            if spot != other:
                marks.strokes.append(Stroke((spot, other), _COLOUR, 0.8))
        drawn.append(aside)
        _draw(marks, *aside)
        middle = (aside[0][0] + aside[1][0]) / 2.0, (aside[0][1] + aside[1][1]) / 2.0
        wishes.append(Wish(label, middle, _COLOUR))
    return wishes


def _draw(marks: Marks, start: Spot, end: Spot) -> None:
    marks.strokes.append(Stroke((start, end), _COLOUR, 1.4, halo=True))
    if math.dist(start, end) >= _ROOM:
        marks.strokes += [Stroke(arrow_head(*ends), _COLOUR, 1.4) for ends in ((start, end), (end, start))]
    else:
        marks.strokes += [Stroke((spot,), _COLOUR, 4.0) for spot in (start, end)]


def _aside(line: _Line, drawn: Sequence[_Line]) -> _Line:
    """Return a line moved sideways until it covers none of those that are drawn."""
    (ax, ay), (bx, by) = line
    length = math.dist(*line)
    u, v = (bx - ax) / length, (by - ay) / length
    if u < -_UPRIGHT or (abs(u) <= _UPRIGHT and v < 0.0):
        u, v = -u, -v  # so that all of one direction step to the same side
    steps = 0
    while any(_covers(((ax, ay), (bx, by)), other) for other in drawn):
        steps += 1
        dx, dy = _STEP * steps * v, -_STEP * steps * u
        (ax, ay), (bx, by) = ((x + dx, y + dy) for x, y in line)
    return (ax, ay), (bx, by)


def _covers(line: _Line, other: _Line) -> bool:
    """Tell whether two lines run along each other."""
    (ax, ay), (bx, by) = line
    length = math.dist(*line)
    u, v = (bx - ax) / length, (by - ay) / length
    along = sorted((x - ax) * u + (y - ay) * v for x, y in other)
    beside = max(abs((y - ay) * u - (x - ax) * v) for x, y in other)
    return beside < _BESIDE and along[1] > _SEEN and along[0] < length - _SEEN
