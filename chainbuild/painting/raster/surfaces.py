"""Meshes as pixels: every triangle over the pixels whose centres it covers, lit as the round body it stands for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Indices, Matrix, Vector
from chainbuild.meshes import Triangles, creased
from chainbuild.painting.colours import GAIN, LIGHT, MIDDLE
from chainbuild.painting.stage import PlacedBody
from chainbuild.painting.views import Arrow, View, Window

_AT_ONCE: Final = 2_000_000  # pixels of triangles that are worked on together: some 200 MB
_THIN: Final = 1e-9  # twice the area in pixels: a triangle seen from its edge covers none


class MeshPixels(NamedTuple):
    """What pixels show of a mesh, each once.

    Attributes:
        place: (n,) number of the pixel, row by row.
        depth: (n,) coordinate towards who looks [m].
        shade: (n,) brightness of its colour.
    """

    place: Indices
    depth: NDArray[np.floating[Any]]
    shade: NDArray[np.floating[Any]]


def mesh_pixels(placed: PlacedBody, surface: Triangles, view: View, window: Window) -> MeshPixels:
    """Return the pixels of a window that show a mesh: of its points in line the nearest one.

    Args:
        placed: The body.
        surface: Its triangles.
        view: From where one looks.
        window: What of it fills the picture.
    """
    surface = creased(surface)
    x = (_coordinates(surface.points, placed.T, view.right) - window.left) * window.scale - 0.5
    y = (window.top - _coordinates(surface.points, placed.T, view.up)) * window.scale - 0.5
    depth = _coordinates(surface.points, placed.T, view.toward)
    light: Arrow = tuple(LIGHT[0] * view.right[n] + LIGHT[1] * view.up[n] + LIGHT[2] * view.toward[n] for n in range(3))  # type: ignore[assignment]
    turn = placed.T.copy()
    turn[:3, 3] = 0.0
    cosine = _coordinates(_vertex_normals(surface), turn, light)
    best = np.full(window.width * window.height, -np.inf)
    shade = np.ones(len(best))
    for place, near, lit in _covered(surface.corners, x, y, depth, cosine, window):
        np.maximum.at(best, place, near)
        seen = near == best[place]
        shade[place[seen]] = MIDDLE + GAIN * lit[seen]
    found = np.flatnonzero(best > -np.inf)
    return MeshPixels(found, best[found], shade[found])


def _coordinates(points: Matrix, T: Matrix, along: Arrow) -> Vector:
    """Return the coordinates (n,) of placed points (n, 3) along a direction, summed in a fixed order."""
    a, b, c, d = (sum(along[n] * T[n, k] for n in range(3)) for k in range(4))
    result: Vector = points[:, 0] * a + points[:, 1] * b + points[:, 2] * c + d
    return result


def _vertex_normals(surface: Triangles) -> Matrix:
    """Return unit normals (n, 3) of vertices: the mean of those of their triangles, by area."""
    own = surface.normals
    total = np.zeros_like(surface.points)
    for corner in surface.corners.T:
        np.add.at(total, corner, own)
    lengths = np.sqrt((total * total).sum(axis=1, keepdims=True))
    normals: Matrix = np.divide(total, lengths, out=np.zeros_like(total), where=lengths > 0.0)
    return normals


def _covered(
    corners: Indices, x: Vector, y: Vector, depth: Vector, cosine: Vector, window: Window
) -> Iterator[tuple[Indices, Vector, Vector]]:
    """Yield pixels that triangles cover, with depth and cosine there; a pixel may come several times."""
    ax, ay, bx, by, cx, cy = (plane[corners[:, n]] for n in range(3) for plane in (x, y))
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    first = np.maximum(np.ceil(np.minimum(np.minimum(ay, by), cy)), 0.0)
    last = np.minimum(np.floor(np.maximum(np.maximum(ay, by), cy)), window.height - 1.0)
    rows = np.where(np.abs(area) > _THIN, np.maximum(last - first + 1.0, 0.0), 0.0).astype(np.intp)
    triangle, number = _spread(rows)
    row: Vector = first[triangle] + number
    begin, end = _crossed(row, (ax, bx, cx), (ay, by, cy), triangle)
    begin, end = np.maximum(np.ceil(begin), 0.0), np.minimum(np.floor(end), window.width - 1.0)
    columns = np.maximum(end - begin + 1.0, 0.0).astype(np.intp)
    for group in np.split(np.arange(len(columns)), np.flatnonzero(np.diff(np.cumsum(columns) // _AT_ONCE)) + 1):
        own, number = _spread(columns[group])
        line = group[own]
        here, i, j = triangle[line], begin[line] + number, row[line]
        a, b, c = corners[here].T
        # Shares of the second and the third corner.
        u, v = i - ax[here], j - ay[here]
        of_b = np.clip((u * (cy - ay)[here] - v * (cx - ax)[here]) / area[here], 0.0, 1.0)
        of_c = np.clip((v * (bx - ax)[here] - u * (by - ay)[here]) / area[here], 0.0, 1.0 - of_b)
        of_a = 1.0 - of_b - of_c
        # Rows run downwards: a triangle that runs the other way around is seen from outside.
        facing = np.where(area[here] < 0.0, 1.0, -1.0)
        yield (
            (j * window.width + i).astype(np.intp),
            of_a * depth[a] + of_b * depth[b] + of_c * depth[c],
            facing * (of_a * cosine[a] + of_b * cosine[b] + of_c * cosine[c]),
        )


def _spread(counts: Indices) -> tuple[Indices, Indices]:
    """Return every index as often as its count says, and how often it came before."""
    index = np.repeat(np.arange(len(counts)), counts)
    return index, np.arange(len(index)) - np.repeat(np.cumsum(counts) - counts, counts)


def _crossed(row: Vector, x: Sequence[Vector], y: Sequence[Vector], triangle: Indices) -> tuple[Vector, Vector]:
    """Return from where to where rows run within triangles."""
    low, high = np.full(len(row), np.inf), np.full(len(row), -np.inf)
    for p, q in ((0, 1), (1, 2), (2, 0)):
        from_y, to_y = y[p][triangle], y[q][triangle]
        meets = (np.minimum(from_y, to_y) <= row) & (row <= np.maximum(from_y, to_y)) & (from_y != to_y)
        share = np.divide(row - from_y, to_y - from_y, out=np.zeros_like(row), where=meets)
        at = x[p][triangle] + share * (x[q][triangle] - x[p][triangle])
        low, high = np.where(meets, np.minimum(low, at), low), np.where(meets, np.maximum(high, at), high)
    return low, high
