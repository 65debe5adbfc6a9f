"""What is hidden: each polygon without what lies behind another body.

A convex body hides what is in its shadow, the space behind it for whoever looks, which is convex, too: behind the faces
that are seen, and within the planes through its outline. A polygon minus such a space is cut into convex pieces.
Nothing has to be sorted, and bodies may enter each other.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from chainbuild.arrays import Matrix
from chainbuild.painting.vector.facets import CONTACT_EDGE, HIDDEN_EDGE, OUTLINE_EDGE, Corner, Facet, Hull, crossed, dot
from chainbuild.painting.views import Arrow

_EPS: Final = 2e-6  # m: corners that lie this near to a plane lie in it
_FLUSH: Final = 4e-6  # m: of faces that lie in each other the one of the first body is seen; more than the above


class _Shadow(NamedTuple):
    """The space that a body hides: normal · point ≤ offset for all its planes.

    Attributes:
        planes: (n, 4) outward normals and offsets.
        faces: How many of them, from the first, are faces of the body; the others go through its outline.
    """

    planes: Matrix
    faces: int


def seen_pieces(hulls: Sequence[Hull], toward: Arrow) -> list[list[Facet]]:
    """Return of every body the pieces of its facets that no other body hides.

    Args:
        hulls: The bodies.
        toward: Direction towards whoever looks.
    """
    numbers = [n for n, hull in enumerate(hulls) for _ in hull.facets]
    facets = [facet for hull in hulls for facet in hull.facets]
    if not facets:
        return [[] for _ in hulls]
    x, y, z = np.array([point for facet in facets for point in facet.points]).T
    starts = np.cumsum([0, *(len(facet.points) for facet in facets[:-1])])
    owner = np.array(numbers)
    alive = np.full(len(facets), True)
    cutters: list[list[tuple[_Shadow, list[int]]]] = [[] for _ in facets]
    for n, hull in enumerate(hulls):
        if not hull.facets:
            continue
        shadow = _shadow(hull, toward)
        a, b, c, offset = shadow.planes.T[:, :, None]
        distance = a * x + b * y + c * z - offset
        # How far into a face's plane counts as behind it: flush faces belong to the first body.
        flush = np.where(owner > n, _FLUSH, -_FLUSH)
        low, high = np.minimum.reduceat(distance, starts, axis=1), np.maximum.reduceat(distance, starts, axis=1)
        low[: shadow.faces] -= flush
        high[: shadow.faces] -= flush
        meets = (low < -_EPS).all(axis=0) & (owner != n) & alive
        crossing = high > _EPS
        alive &= ~(meets & ~crossing.any(axis=0))
        for m in np.flatnonzero(meets & alive).tolist():
            cutters[m].append((shadow, np.flatnonzero(crossing[:, m]).tolist()))
    found: list[list[Facet]] = [[] for _ in hulls]
    for facet, n, living, own in zip(facets, numbers, alive.tolist(), cutters, strict=True):
        if living:
            found[n] += _remaining(facet, own)
    return found


def _shadow(hull: Hull, toward: Arrow) -> _Shadow:
    planes: list[tuple[float, float, float, float]] = []
    for facet in hull.facets:
        normal = _normal(facet)
        planes.append((*normal, dot(normal, facet.points[0])))
    sides = []
    for facet in hull.facets:
        for k, kind in enumerate(facet.edges):
            if kind == OUTLINE_EDGE:
                one, other = facet.points[k], facet.points[(k + 1) % len(facet.points)]
                edge = other[0] - one[0], other[1] - one[1], other[2] - one[2]
                normal = _unit(crossed(edge, toward))
                sides.append((*normal, dot(normal, one)))
    return _Shadow(np.array([*planes, *sides]), len(planes))


def _normal(facet: Facet) -> Corner:
    """Return the normal of a facet, from corners far apart."""
    a, b, c = facet.points[0], facet.points[len(facet.points) // 3], facet.points[2 * len(facet.points) // 3]
    return _unit(crossed((b[0] - a[0], b[1] - a[1], b[2] - a[2]), (c[0] - a[0], c[1] - a[1], c[2] - a[2])))


def _unit(vector: Corner) -> Corner:
    length = math.sqrt(dot(vector, vector))
    return vector[0] / length, vector[1] / length, vector[2] / length


def _remaining(facet: Facet, cutters: Sequence[tuple[_Shadow, list[int]]]) -> list[Facet]:
    """Return the pieces of a facet outside some shadows, each with the planes that cross the facet."""
    pieces = [facet]
    for shadow, crossing in cutters:
        planes = [(shadow.planes[k].tolist(), k < shadow.faces) for k in crossing]
        pieces = [part for piece in pieces for part in _without(piece, planes)]
    return pieces


def _without(piece: Facet, planes: Sequence[tuple[list[float], bool]]) -> list[Facet]:
    """Return the convex pieces of a polygon outside a shadow."""
    measured = []
    for (a, b, c, offset), face in planes:
        distances = [a * x + b * y + c * z - offset for x, y, z in piece.points]
        if min(distances) >= -_EPS:
            return [piece]
        if max(distances) > _EPS:
            measured.append(((a, b, c), offset, CONTACT_EDGE if face else HIDDEN_EDGE))
    parts: list[Facet] = []
    inside: Facet | None = piece
    for normal, offset, kind in measured:
        if inside is None:
            break
        distances = [dot(normal, point) - offset for point in inside.points]
        if max(distances) <= _EPS:
            continue
        if min(distances) >= -_EPS:
            # The rest misses the shadow: what was cut off before belongs to it.
            return [piece]
        outer = _half(inside, distances, 1.0, kind)
        inside = _half(inside, distances, -1.0, kind)
        if outer is not None:
            parts.append(outer)
    return parts


def _half(facet: Facet, distances: Sequence[float], sign: float, cut: int) -> Facet | None:
    """Return the part of a facet on one side of a plane that crosses it.

    Args:
        facet: The facet.
        distances: Of its corners from the plane [m].
        sign: Side that is kept.
        cut: What the new edge is.
    """
    points: list[Corner] = []
    edges: list[int] = []
    count = len(facet.points)
    for k, (point, distance) in enumerate(zip(facet.points, distances, strict=True)):
        after = (k + 1) % count
        here, there = sign * distance, sign * distances[after]
        if here >= -_EPS:
            points.append(point)
            # From a corner in the plane the border may run on along the cut.
            edges.append(cut if here <= _EPS and there < -_EPS else facet.edges[k])
        if (here > _EPS and there < -_EPS) or (here < -_EPS and there > _EPS):
            points.append(_crossing(point, here, facet.points[after], there))
            edges.append(facet.edges[k] if here < 0.0 else cut)
    return Facet(facet.face, tuple(points), tuple(edges)) if len(points) > 2 else None


def _crossing(one: Corner, here: float, other: Corner, there: float) -> Corner:
    """Return where the line between two points on both sides of a plane meets it, the same from either end."""
    if other < one:
        one, here, other, there = other, there, one, here
    share = here / (here - there)
    x, y, z = (a + share * (b - a) for a, b in zip(one, other, strict=True))
    return x, y, z
