"""Convex bodies as planes, and as the polygons of theirs that whoever looks can see."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

from chainbuild.painting.stage import PlacedBody
from chainbuild.painting.views import Arrow, View
from chainbuild.shown import fields_shown

Corner = tuple[float, float, float]

# What an edge of a polygon is.
INNER_EDGE: Final = 0  # between two facets of a round face
CREASE_EDGE: Final = 1  # between two faces that are seen
OUTLINE_EDGE: Final = 2  # between a face that is seen and one that is not
CONTACT_EDGE: Final = 3  # where it enters another body
HIDDEN_EDGE: Final = 4  # where another body covers it, whose outline is there

# Sides of round bodies up to a radius in pixels: their outline is exact, what enters them is off by a third of a pixel.
_SIDES: Final = ((12.0, 16), (35.0, 24), (80.0, 32), (math.inf, 48))
_EDGE_ON: Final = 1e-7  # cosine: a face that is seen under less shows nothing
SIDE_FACE: Final = 2  # number of the round face of a cylinder or ball; flat ones are 2 · axis, + 1 on its positive side


class Facet(NamedTuple):
    """A convex polygon of a body, counter-clockwise for whoever looks.

    Attributes:
        face: Number of the face it belongs to; the facets of a round face share one.
        points: Its corners [m].
        edges: What the edge from each corner to the next is.
    """

    face: int
    points: tuple[Corner, ...]
    edges: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Hull:
    """A convex body.

    Attributes:
        facets: What can be seen of it.
        centre: Its centre.
        axes: Its directions x, y, z; for round bodies x runs to the outline.
    """

    __repr__ = fields_shown

    facets: tuple[Facet, ...]
    centre: Corner
    axes: tuple[Corner, Corner, Corner]

    def normal(self, face: int) -> Corner:
        """Return the outward normal of a flat face, by its number."""
        x, y, z = self.axes[face // 2]
        return (x, y, z) if face % 2 else (-x, -y, -z)


def dot(a: Sequence[float], b: Sequence[float]) -> float:
    """Return the scalar product of two vectors (3,), in a fixed order."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def hull_of(placed: PlacedBody, view: View, scale: float = 1000.0) -> Hull:
    """Return a body as a hull.

    Args:
        placed: The body.
        view: From where one looks.
        scale: Pixels per metre, for which round bodies are to look round.
    """
    T = placed.T.tolist()
    centre = T[0][3], T[1][3], T[2][3]
    x, y, z = ((T[0][n], T[1][n], T[2][n]) for n in range(3))
    size = placed.body.dimensions
    if placed.body.kind == "box":
        return _box(centre, (x, y, z), size, view.toward)
    sides = next(count for limit, count in _SIDES if size[0] * scale <= limit)
    if placed.body.kind == "sphere":
        return _ball(centre, size[0], view, sides)
    return _cylinder(centre, z, size[0], size[1] / 2.0, view, sides)


def _box(centre: Corner, axes: tuple[Corner, Corner, Corner], size: Sequence[float], toward: Arrow) -> Hull:
    facets = []
    half = [edge / 2.0 for edge in size]
    cosines = [dot(axis, toward) for axis in axes]
    for face in range(6):
        n, sign = face // 2, 1.0 if face % 2 else -1.0
        if cosines[n] * sign <= _EDGE_ON:
            continue
        a, b = (n + 1) % 3, (n + 2) % 3
        middle = _sum(centre, _scaled(axes[n], sign * half[n]))
        corners = [(-sign, -1.0), (sign, -1.0), (sign, 1.0), (-sign, 1.0)]
        points = [_sum(middle, _scaled(axes[a], half[a] * i), _scaled(axes[b], half[b] * j)) for i, j in corners]
        beside = [-cosines[b], cosines[a] * sign, cosines[b], -cosines[a] * sign]
        edges = tuple(CREASE_EDGE if cosine > _EDGE_ON else OUTLINE_EDGE for cosine in beside)
        facets.append(Facet(face, tuple(points), edges))
    return Hull(tuple(facets), centre, axes)


def _cylinder(centre: Corner, z: Corner, radius: float, half: float, view: View, count: int) -> Hull:
    """Return a cylinder whose first corner lies on its outline."""
    toward = dot(z, view.toward)
    lying = 1.0 - toward * toward > _EDGE_ON
    x = _unit(crossed(view.toward, z)) if lying else _unit(crossed(view.up, z))
    y = crossed(z, x)
    rings = [
        _ring(_sum(centre, _scaled(z, sign * half)), _scaled(x, radius), _scaled(y, radius), count)
        for sign in (-1.0, 1.0)
    ]
    seen = [lying and 2 * k < count for k in range(count)]
    first = SIDE_FACE + 2
    cap = first + 1 if toward > _EDGE_ON else first if toward < -_EDGE_ON else None
    facets = []
    for k in range(count):
        if seen[k]:
            after = (k + 1) % count
            points = (rings[0][k], rings[0][after], rings[1][after], rings[1][k])
            ends = [CREASE_EDGE if cap == first + end else OUTLINE_EDGE for end in (0, 1)]
            sides = [INNER_EDGE if seen[other] else OUTLINE_EDGE for other in (after, k - 1)]
            facets.append(Facet(SIDE_FACE, points, (ends[0], sides[0], ends[1], sides[1])))
    if cap is not None:
        upper = cap > first
        order = range(count) if upper else range(count - 1, -1, -1)
        # The edge that leaves corner k on the way back is that of side k - 1.
        edges = tuple(CREASE_EDGE if seen[k if upper else k - 1] else OUTLINE_EDGE for k in order)
        facets.append(Facet(cap, tuple(rings[upper][k] for k in order), edges))
    return Hull(tuple(facets), centre, (x, y, z))


def _ball(centre: Corner, radius: float, view: View, count: int) -> Hull:
    """Return a ball whose rings lie around the line of sight: its outline is a circle."""
    x, y, z = view.right, view.up, view.toward
    steps = count // 4
    heights = [_turned(k, count) for k in range(steps)]  # radius and height of the rings
    rings = [
        _ring(_sum(centre, _scaled(z, radius * h)), _scaled(x, radius * r), _scaled(y, radius * r), count)
        for r, h in heights
    ]
    facets = []
    for k in range(count):
        after = (k + 1) % count
        for n in range(steps - 1):
            points = (rings[n][k], rings[n][after], rings[n + 1][after], rings[n + 1][k])
            facets.append(
                Facet(SIDE_FACE, points, (INNER_EDGE if n else OUTLINE_EDGE, INNER_EDGE, INNER_EDGE, INNER_EDGE))
            )
    facets.append(Facet(SIDE_FACE, tuple(rings[-1]), (INNER_EDGE,) * count))
    return Hull(tuple(facets), centre, (x, y, z))


def _ring(centre: Corner, x: Corner, y: Corner, count: int) -> list[Corner]:
    """Return the corners of a ring, from its centre and two radii."""
    return [_sum(centre, _scaled(x, c), _scaled(y, s)) for c, s in (_turned(k, count) for k in range(count))]


def _turned(k: int, sides: int) -> tuple[float, float]:
    """Return cosine and sine of k steps of a turn, exact on the axes, the last bits of others rounded away."""
    angle = 2.0 * math.pi * (k % sides) / sides
    return round(math.cos(angle), 12), round(math.sin(angle), 12)


def _unit(vector: Corner) -> Corner:
    return _scaled(vector, 1.0 / math.sqrt(dot(vector, vector)))


def _scaled(vector: Corner, factor: float) -> Corner:
    return vector[0] * factor, vector[1] * factor, vector[2] * factor


def _sum(*vectors: Corner) -> Corner:
    x, y, z = vectors[0]
    for a, b, c in vectors[1:]:
        x, y, z = x + a, y + b, z + c
    return x, y, z


def crossed(a: Sequence[float], b: Sequence[float]) -> Corner:
    """Return the vector product of two vectors (3,)."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]
