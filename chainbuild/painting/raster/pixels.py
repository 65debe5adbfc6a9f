"""A picture of pixels: colours in the light, outlines, a light ground, four samples a pixel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.painting.colours import GROUND_COLOUR, INK_COLOUR
from chainbuild.painting.raster.png import Pixels
from chainbuild.painting.raster.sight import Buffers, render
from chainbuild.painting.stage import PlacedBody
from chainbuild.painting.views import View, Window

_SAMPLES: Final = 2  # a pixel and direction: edges without steps
_OUTLINE: Final = 0.80  # share of ink where a body ends before what is far behind it or nothing
_CREASE: Final = 0.30  # likewise where two faces meet
_STEP: Final = 0.006  # of the picture's height [m]: a jump in depth that ends a body


def painted(solids: Sequence[PlacedBody], view: View, window: Window) -> Pixels:
    """Return the pixels (rows from above, columns, RGB) of a window.

    Args:
        solids: The bodies.
        view: From where one looks.
        window: What of it fills the picture.
    """
    fine = window.finer(_SAMPLES)
    buffers = render(solids, view, fine)
    colours = np.array([*(solid.body.colour for solid in solids), GROUND_COLOUR], dtype=np.float32)
    ink = _ink(buffers, _STEP * window.height / window.scale)
    shade = buffers.shade[..., None]
    plain = colours[np.maximum(buffers.bodies, -1)]
    lit = np.where(shade > 1.0, 1.0 - (1.0 - plain) * (2.0 - shade), plain * shade)
    lit += (np.array(INK_COLOUR, dtype=np.float32) - lit) * ink[..., None]
    joined = lit.reshape(window.height, _SAMPLES, window.width, _SAMPLES, 3).mean(axis=(1, 3))
    result: Pixels = (255.0 * np.clip(joined, 0.0, 1.0) + 0.5).astype(np.uint8)
    return result


def _ink(buffers: Buffers, step: float) -> NDArray[np.float32]:
    """Return how much of the ink every pixel has: outlines dark and creases light."""
    ink = np.zeros(buffers.depth.shape, dtype=np.float32)
    with np.errstate(invalid="ignore"):
        for axis in (0, 1):
            one, other = (_shifted(axis, end) for end in (slice(None, -1), slice(1, None)))
            differs = buffers.face[one] != buffers.face[other]
            gap = np.abs(buffers.depth[one] - buffers.depth[other])
            strength = np.where(gap > step, np.float32(_OUTLINE), np.float32(_CREASE)) * differs
            # The line lies on both sides of the border, so that outlines are as thick everywhere.
            for side in (one, other):
                ink[side] = np.maximum(ink[side], strength)
    return ink


def _shifted(axis: int, part: slice) -> tuple[slice, slice]:
    return (part, slice(None)) if axis == 0 else (slice(None), part)
