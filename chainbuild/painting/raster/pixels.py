"""A picture of pixels: colours in the light, outlines, a light ground, four samples a pixel."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.painting.colours import GROUND_COLOUR, INK_COLOUR
from chainbuild.painting.raster.png import Pixels
from chainbuild.painting.raster.sight import Buffers, Plane, render
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
    ink = _ink(buffers, _STEP * window.height / window.scale)
    # Most of a picture is ground: only the rest is worked on.
    drawn = np.flatnonzero((buffers.face >= 0) | (ink > 0.0))
    numbers, share = buffers.bodies.ravel()[drawn], ink.ravel()[drawn]
    shade = buffers.shade.ravel()[drawn]
    dark, pale = np.minimum(shade, 1.0), np.maximum(shade - 1.0, 0.0)
    result = np.empty((window.height, window.width, 3), dtype=np.uint8)
    for channel, (ground, black) in enumerate(zip(GROUND_COLOUR, INK_COLOUR, strict=True)):
        palette = np.array([*(placed.body.colour[channel] for placed in solids), ground], dtype=np.float32)
        light = palette[numbers] * dark
        light += (1.0 - light) * pale
        light += (np.float32(black) - light) * share
        plane = np.full(fine.height * fine.width, ground, dtype=np.float32)
        plane[drawn] = light
        result[..., channel] = (255.0 * _joined(plane.reshape(fine.height, fine.width)) + 0.5).astype(np.uint8)
    return result


def _joined(plane: Plane) -> Plane:
    """Return the means of the samples of each pixel."""
    upper, lower = plane[::_SAMPLES], plane[1::_SAMPLES]
    across = upper + lower
    joined: Plane = (across[:, ::_SAMPLES] + across[:, 1::_SAMPLES]) / np.float32(_SAMPLES * _SAMPLES)
    return joined


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
