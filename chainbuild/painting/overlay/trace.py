"""The trace of the tool on the workpiece."""

from __future__ import annotations

from typing import Final

from chainbuild.arrays import Matrix
from chainbuild.chain.bodies.body import Colour
from chainbuild.painting.marks import Marks, Stroke
from chainbuild.painting.views import Spot, View, Window

_COLOUR: Final[Colour] = (0.78, 0.08, 0.42)  # as no body and no axis
_DENSE: Final = 0.5  # pixels between corners: nearer ones cannot be told apart


def draw_trace(marks: Marks, points: Matrix, view: View, window: Window) -> None:
    """Add a line through points (n, 3) [m] to marks, with a dot where it begins."""
    spots: list[Spot] = []
    for point in points.tolist():
        spot = window.spot(view, point)
        if not spots or max(abs(spot[0] - spots[-1][0]), abs(spot[1] - spots[-1][1])) >= _DENSE:
            spots.append(spot)
    marks.strokes.append(Stroke(tuple(spots), _COLOUR, 2.0, halo=True))
    marks.strokes.append(Stroke(tuple(spots[:1]), _COLOUR, 7.0))
