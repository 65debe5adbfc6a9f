"""Frames as triads with names: red, green, blue for x, y, z."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix
from chainbuild.chain.bodies.body import Colour
from chainbuild.chain.elements import FRAME_NAMES
from chainbuild.painting.colours import INK_COLOUR
from chainbuild.painting.marks import Marks, Stroke
from chainbuild.painting.overlay.placing import Wish
from chainbuild.painting.stage import Stage, coordinate
from chainbuild.painting.views import Spot, View, Window

# As everywhere.
_COLOURS: Final[tuple[Colour, Colour, Colour]] = ((0.86, 0.16, 0.16), (0.13, 0.62, 0.20), (0.13, 0.33, 0.87))
_LENGTH: Final = 42.0  # pixels of an arm that is seen in full
_SAME: Final = 2e-6  # m and in directions: frames this near are in one place
_HEAD: Final = 6.0  # pixels of an arrow's head
_SHORT: Final = 8.0  # pixels of an arm below which it has no head


def draw_triads(
    marks: Marks, stage: Stage, view: View, window: Window, called: Mapping[str, str] | None = None
) -> list[Wish]:
    """Add the named frames of a machine to marks, and return their labels; frames in one place share one.

    Args:
        marks: Where to.
        stage: The machine.
        view: From where one looks.
        window: What of it fills the picture.
        called: Name of a frame → its label, where that is another.
    """
    places = {name: stage.frame(name) for name in FRAME_NAMES}
    drawn: list[Matrix] = []
    labels: list[tuple[Matrix, list[str]]] = []
    for name, T in places.items():
        if not any(np.abs(T - other).max() <= _SAME for other in drawn):
            drawn.append(T)
            _draw(marks, T, view, window)
        named = next((names for other, names in labels if np.abs(T - other)[:3, 3].max() <= _SAME), None)
        if named is None:
            labels.append((T, [name]))
        else:
            named.append(name)
    said = called or {}
    return [
        Wish(" = ".join(said.get(name, name) for name in names), window.spot(view, T[:3, 3].tolist()), INK_COLOUR)
        for T, names in labels
    ]


def _draw(marks: Marks, T: Matrix, view: View, window: Window) -> None:
    """Add a triad, the arm that points farthest away first."""
    origin = T[:3, 3].tolist()
    start = window.spot(view, origin)
    arms = []
    for n in range(3):
        direction = T[:3, n].tolist()
        end = window.spot(view, [a + b * _LENGTH / window.scale for a, b in zip(origin, direction, strict=True)])
        arms.append((coordinate(direction, view.toward), n, end))
    for _, n, end in sorted(arms):
        marks.strokes.append(Stroke((start, end), _COLOURS[n], 2.2, halo=True))
        head = arrow_head(start, end)
        if head:
            marks.strokes.append(Stroke(head, _COLOURS[n], 2.2))


def arrow_head(start: Spot, end: Spot, size: float = _HEAD) -> tuple[Spot, ...]:
    """Return the two strokes of an arrow's head at the end of a line; nothing for a line that is too short."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = (dx * dx + dy * dy) ** 0.5
    if length < _SHORT:
        return ()
    u, v = size * dx / length, size * dy / length
    one = end[0] - u - 0.5 * v, end[1] - v + 0.5 * u
    other = end[0] - u + 0.5 * v, end[1] - v - 0.5 * u
    return one, end, other
