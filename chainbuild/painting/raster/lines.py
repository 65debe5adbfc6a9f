"""Lines and texts into pixels, with smooth edges."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix
from chainbuild.chain.bodies.body import Colour
from chainbuild.painting.colours import GROUND_COLOUR
from chainbuild.painting.marks import HALO, Caption, Marks
from chainbuild.painting.raster.letters import text_strokes, text_width
from chainbuild.painting.raster.png import Pixels
from chainbuild.painting.views import Spot

_THICK: Final = 0.1  # of a text's size: its strokes


def draw_marks(pixels: Pixels, marks: Marks) -> None:
    """Draw lines, then texts, into pixels (rows from above, columns, RGB)."""
    for stroke in marks.strokes:
        if stroke.halo:
            _draw(pixels, [stroke.spots], GROUND_COLOUR, stroke.width + 2.0 * HALO, 0.85)
        _draw(pixels, [stroke.spots], stroke.colour, stroke.width, 1.0)
    for caption in marks.captions:
        _write(pixels, caption)


def _write(pixels: Pixels, caption: Caption) -> None:
    left = caption.x - text_width(caption.text) * caption.size / 2.0
    strokes = list(text_strokes(caption.text, left, caption.y, caption.size))
    _draw(pixels, strokes, GROUND_COLOUR, _THICK * caption.size + 2.0 * HALO, 0.85)
    _draw(pixels, strokes, caption.colour, _THICK * caption.size, 1.0)


def _draw(pixels: Pixels, lines: Sequence[Sequence[Spot]], colour: Colour, width: float, opacity: float) -> None:
    """Draw lines in one colour; where they meet, it is no darker."""
    spots = [spot for line in lines for spot in line]
    if not spots:
        return
    reach = width / 2.0 + 1.0
    rows, columns = pixels.shape[:2]
    x0, x1 = (int(np.clip(f(s[0] for s in spots) + r, 0, columns)) for f, r in ((min, -reach), (max, reach + 1.0)))
    y0, y1 = (int(np.clip(f(s[1] for s in spots) + r, 0, rows)) for f, r in ((min, -reach), (max, reach + 1.0)))
    cover = np.zeros((y1 - y0, x1 - x0))
    for line in lines:
        for (ax, ay), (bx, by) in pairwise(line if len(line) > 1 else [*line, *line]):
            _cover(cover, (ax - x0, ay - y0), (bx - x0, by - y0), width)
    part = pixels[y0:y1, x0:x1]
    share = (opacity * cover)[..., None]
    part[:] = (part + share * (255.0 * np.array(colour) - part) + 0.5).astype(np.uint8)


def _cover(cover: Matrix, one: Spot, other: Spot, width: float) -> None:
    """Add what a line with round ends covers of each pixel."""
    reach = width / 2.0 + 1.0
    rows, columns = cover.shape
    x0, x1 = max(int(min(one[0], other[0]) - reach), 0), min(int(max(one[0], other[0]) + reach + 1.0), columns)
    y0, y1 = max(int(min(one[1], other[1]) - reach), 0), min(int(max(one[1], other[1]) + reach + 1.0), rows)
    if x0 >= x1 or y0 >= y1:
        return
    x = np.arange(x0, x1)[None, :] + 0.5 - one[0]
    y = np.arange(y0, y1)[:, None] + 0.5 - one[1]
    dx, dy = other[0] - one[0], other[1] - one[1]
    square = dx * dx + dy * dy
    along = np.clip((x * dx + y * dy) / square, 0.0, 1.0) if square > 0.0 else np.zeros((y1 - y0, x1 - x0))
    distance = np.sqrt((x - along * dx) ** 2 + (y - along * dy) ** 2)
    part = cover[y0:y1, x0:x1]
    np.maximum(part, np.clip((width + 1.0) / 2.0 - distance, 0.0, 1.0), out=part)
