"""What is drawn over the bodies: lines and texts, in pixels of the picture, y downwards."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

from chainbuild.chain.bodies.body import Colour
from chainbuild.painting.colours import INK_COLOUR
from chainbuild.painting.views import Spot
from chainbuild.shown import fields_shown

TEXT_SIZE: Final = 13.0  # pixels
HALO: Final = 2.0  # pixels of ground on each side of what is set off from the bodies


@dataclass(frozen=True, slots=True)
class Stroke:
    """A line through points.

    Attributes:
        spots: Its corners.
        colour: Red, green, blue in 0…1.
        width: Pixels.
        halo: Whether a light border sets it off.
    """

    __repr__ = fields_shown

    spots: tuple[Spot, ...]
    colour: Colour = INK_COLOUR
    width: float = 1.5
    halo: bool = False


@dataclass(frozen=True, slots=True)
class Caption:
    """A text.

    Attributes:
        text: The text.
        x: Its middle.
        y: Where its letters stand.
        colour: Red, green, blue in 0…1.
        size: Pixels.
    """

    __repr__ = fields_shown

    text: str
    x: float
    y: float
    colour: Colour = INK_COLOUR
    size: float = TEXT_SIZE


@dataclass(slots=True)
class Marks:
    """Lines and texts; the texts are drawn over the lines."""

    __repr__ = fields_shown

    strokes: list[Stroke] = field(default_factory=list)
    captions: list[Caption] = field(default_factory=list)
