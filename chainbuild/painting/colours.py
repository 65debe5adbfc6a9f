"""Colours of a picture beside those of the bodies, and how light changes them."""

from __future__ import annotations

from typing import Final

from chainbuild.chain.bodies.body import Colour
from chainbuild.painting.views import Arrow

# Red, green, blue in 0…1: a light ground, lines almost black.
GROUND_COLOUR: Final[Colour] = (0.975, 0.98, 0.985)
INK_COLOUR: Final[Colour] = (0.16, 0.18, 0.21)

# Right, up and towards whoever looks: light from above, left and before him; a box shows three shades.
LIGHT: Final[Arrow] = (-0.36, 0.74, 0.57)
MIDDLE: Final = 0.80  # brightness of a colour where the light passes by
_OFF_HALF: Final = 0.4871  # rounds up from here: a half would be up to the last bit of a product
GAIN: Final = 0.32  # more of it towards the light, less away from it; above 1 the colour pales


def lit(colour: Colour, shade: float) -> Colour:
    """Return a colour in the light: darker below a shade of 1, paler above it."""
    if shade > 1.0:
        red, green, blue = (1.0 - (1.0 - part) * (2.0 - shade) for part in colour)
    else:
        red, green, blue = (part * shade for part in colour)
    return red, green, blue


def hex_colour(colour: Colour) -> str:
    """Return a colour as #rrggbb."""
    return "#" + "".join(f"{int(255.0 * min(max(part, 0.0), 1.0) + _OFF_HALF):02x}" for part in colour)
