"""Lengths of the machine data as lines with arrows and labels."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

from chainbuild.chain.bodies.body import Colour
from chainbuild.frames import translation
from chainbuild.painting.marks import Marks, Stroke
from chainbuild.painting.overlay.measures import Dimension
from chainbuild.painting.overlay.placing import Wish
from chainbuild.painting.overlay.triads import arrow_head
from chainbuild.painting.stage import Stage
from chainbuild.painting.views import View, Window

_COLOUR: Final[Colour] = (0.05, 0.28, 0.62)  # as no body
_SEEN: Final = 2.0  # pixels: a length along the line of sight cannot be shown
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
    wishes = []
    for one in found:
        start, end = (
            window.spot(view, stage.place(one.link, translation(*point))[:3, 3].tolist())
            for point in (one.start, one.end)
        )
        length = ((end[0] - start[0]) ** 2 + (end[1] - start[1]) ** 2) ** 0.5
        if length < _SEEN:
            continue
        marks.strokes.append(Stroke((start, end), _COLOUR, 1.4, halo=True))
        if length >= _ROOM:
            heads = [arrow_head(start, end), arrow_head(end, start)]
            marks.strokes += [Stroke(head, _COLOUR, 1.4) for head in heads]
        else:
            marks.strokes += [Stroke((spot,), _COLOUR, 4.0) for spot in (start, end)]
        middle = (start[0] + end[0]) / 2.0, (start[1] + end[1]) / 2.0
        wishes.append(Wish(one.label, middle, _COLOUR))
    return wishes
