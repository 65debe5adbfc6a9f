"""The bodies of a machine at axis values, placed in the site: z up."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.body import Body
from chainbuild.chain.bodies.shapes import detail_bodies, link_bodies
from chainbuild.chain.elements import Chain
from chainbuild.chain.poses import link_placements
from chainbuild.drawing.machine import drawn_bodies
from chainbuild.painting.views import Arrow, View, Window, window_around
from chainbuild.shown import fields_shown


@dataclass(frozen=True, slots=True, eq=False)
class PlacedBody:
    """A body placed in the site.

    Attributes:
        body: The body.
        T: (4, 4) placement of its centre [m].
    """

    __repr__ = fields_shown

    body: Body
    T: Matrix


def placed_bodies(
    chain: Chain, q: Vector, T_site_base: Matrix, bodies: Iterable[Body] | None = None
) -> list[PlacedBody]:
    """Return the bodies of a machine at joint values (n_q,), SI, in the site.

    Args:
        chain: The chain.
        q: Joint values.
        T_site_base: (4, 4) base in the site.
        bodies: What to place; None: what the rules of drawing give.
    """
    placed = link_placements(chain, q)
    return [
        PlacedBody(body, T_site_base @ placed[body.link] @ body.T_link_body)
        for body in (shown_bodies(chain) if bodies is None else bodies)
    ]


def shown_bodies(chain: Chain) -> tuple[Body, ...]:
    """Return the bodies that a picture shows."""
    try:
        return drawn_bodies(chain)
    except NotImplementedError:
        return (*link_bodies(chain), *detail_bodies(chain))


def coordinate(vector: Sequence[float] | Vector, direction: Arrow) -> float:
    """Return the coordinate of a vector (3,) along a direction."""
    x, y, z = (float(part) for part in vector)
    return x * direction[0] + y * direction[1] + z * direction[2]


def half_span(solid: PlacedBody, direction: Arrow) -> float:
    """Return how far [m] a body extends from its centre in a direction, given as a unit vector."""
    a, b, c = (coordinate(solid.T[:3, n], direction) for n in range(3))
    size = solid.body.dimensions
    if solid.body.kind == "box":
        return (abs(a) * size[0] + abs(b) * size[1] + abs(c) * size[2]) / 2.0
    if solid.body.kind == "sphere":
        return size[0]
    return float(size[0] * max(a * a + b * b, 0.0) ** 0.5 + abs(c) * size[1] / 2.0)


def extent(solids: Sequence[PlacedBody], direction: Arrow) -> tuple[float, float]:
    """Return the lowest and the highest coordinate [m] of bodies along a direction."""
    spans = [(coordinate(solid.T[:3, 3], direction), half_span(solid, direction)) for solid in solids]
    return min(middle - half for middle, half in spans), max(middle + half for middle, half in spans)


_MARGIN_SHARE: Final = 0.05  # of the picture's shorter side


def framed(solids: Sequence[PlacedBody], view: View, width: int, height: int) -> Window:
    """Return the window that shows bodies as large as they fit."""
    (left, right), (low, high) = extent(solids, view.right), extent(solids, view.up)
    return window_around((left, low), (right, high), width, height, round(_MARGIN_SHARE * min(width, height)))
