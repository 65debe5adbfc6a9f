"""From where a machine is looked at: orthographic views with z up, and what of the world fills the picture."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal

from chainbuild.shown import fields_shown

ViewName = Literal["iso", "front", "top", "right"]
PictureView = Literal["iso", "front", "top", "right", "sheet", "detail"]
Arrow = tuple[float, float, float]
Spot = tuple[float, float]  # pixels to the right and down

# Degrees: the operator stands at −Y; from his right, and low enough to see what hangs over a table.
_TURN: Final = 32.0
_RISE: Final = 26.0


@dataclass(frozen=True, slots=True)
class View:
    """An orthographic view.

    Attributes:
        right: Arrow in the site that is to the right in the picture, a unit vector.
        up: Arrow that is upwards in the picture.
        toward: Arrow towards who looks.
    """

    __repr__ = fields_shown

    right: Arrow
    up: Arrow
    toward: Arrow


def _iso(turn: float = 0.0) -> View:
    angle = math.radians(_TURN + turn)
    ct, st = math.cos(angle), math.sin(angle)
    cr, sr = math.cos(math.radians(_RISE)), math.sin(math.radians(_RISE))
    return View(_short(ct, st, 0.0), _short(-sr * st, sr * ct, cr), _short(cr * st, -cr * ct, sr))


def _short(x: float, y: float, z: float) -> Arrow:
    """Return a direction without the last bits of its cosines, in which processors differ."""
    return round(x, 12), round(y, 12), round(z, 12)


# The signs of the plain ones are those of a drawing: from the front X to the right, from above Y upwards.
VIEWS: Final[dict[ViewName, View]] = {
    "iso": _iso(),
    "front": View((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0)),
    "top": View((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
    "right": View((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)),
}


BACK: Final = _iso(180.0)  # from behind, the left and above: for what points away from whoever looks


@dataclass(frozen=True, slots=True)
class Window:
    """What of a view fills a picture.

    Attributes:
        left: Coordinate along `right` at the left border [m].
        top: Coordinate along `up` at the upper border [m].
        scale: Pixels per metre.
        width: Pixels.
        height: Pixels.
    """

    __repr__ = fields_shown

    left: float
    top: float
    scale: float
    width: int
    height: int

    def spot(self, view: View, point: Sequence[float]) -> Spot:
        """Return where a point (3,) of the site is seen, in pixels from the upper left corner."""
        x, y, z = point[0], point[1], point[2]
        u = x * view.right[0] + y * view.right[1] + z * view.right[2]
        v = x * view.up[0] + y * view.up[1] + z * view.up[2]
        return (u - self.left) * self.scale, (self.top - v) * self.scale

    def rescaled(self, scale: float) -> Window:
        """Return a window of the same size and middle with another scale."""
        less = (1.0 / self.scale - 1.0 / scale) / 2.0
        return Window(self.left + less * self.width, self.top - less * self.height, scale, self.width, self.height)

    def moved(self, x: int, y: int) -> Window:
        """Return the same part of the view further right and down, within a larger picture."""
        return Window(self.left - x / self.scale, self.top + y / self.scale, self.scale, self.width, self.height)

    def coarser(self, times: int) -> Window:
        """Return the same part of the view with fewer pixels."""
        return Window(self.left, self.top, self.scale / times, self.width // times, self.height // times)

    def finer(self, times: int) -> Window:
        """Return the same part of the view with more pixels."""
        return Window(self.left, self.top, self.scale * times, self.width * times, self.height * times)


def window_around(low: tuple[float, float], high: tuple[float, float], width: int, height: int, margin: int) -> Window:
    """Return the window that shows a rectangle of a view in the middle of a picture.

    Args:
        low: Its lowest coordinates along `right` and `up` [m].
        high: Its highest ones.
        width: Pixels.
        height: Pixels.
        margin: Pixels left free on each side at least.
    """
    spans = [max(b - a, 1e-6) for a, b in zip(low, high, strict=True)]
    scale = min((width - 2 * margin) / spans[0], (height - 2 * margin) / spans[1])
    left = (low[0] + high[0] - width / scale) / 2.0
    top = (low[1] + high[1] + height / scale) / 2.0
    return Window(left, top, scale, width, height)
