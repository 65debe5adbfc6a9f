"""Bodies placed by hand, for painters."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from chainbuild.chain.bodies.body import Body, BodyKind
from chainbuild.frames import transform
from chainbuild.painting.stage import PlacedBody
from chainbuild.painting.views import Spot


def placed(
    kind: BodyKind, size: tuple[float, ...], at: Sequence[float], turn: np.ndarray | None = None, grey: float = 0.5
) -> PlacedBody:
    """Return a body at a place [m], turned."""
    T = transform(turn, at)
    return PlacedBody(Body("base", "link", T, kind, size, (grey, grey, grey)), T)


def area(corners: Sequence[Spot]) -> float:
    """Return the area within corners, positive where they run counter-clockwise."""
    ends = [*corners[1:], corners[0]]
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(corners, ends, strict=True)) / 2.0
