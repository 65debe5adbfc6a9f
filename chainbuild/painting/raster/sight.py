"""Bodies as pixels: along the line of sight of every pixel, the nearest point of boxes, cylinders and balls, exactly.

None of these is cut into facets: the line of sight meets each body where an equation says, so round bodies are round.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.painting.colours import GAIN, LIGHT, MIDDLE
from chainbuild.painting.raster.surfaces import MeshPixels, mesh_pixels
from chainbuild.painting.stage import PlacedBody, coordinate, half_span
from chainbuild.painting.views import View, Window
from chainbuild.shown import fields_shown

Plane = NDArray[np.floating[Any]]
FaceNumbers = NDArray[np.int32]

_NEARER: Final = 2e-5  # m: where faces lie in each other, the first body stays
_EDGE_ON: Final = 1e-7  # cosine below which the line of sight runs along a face
_FACES: Final = 8  # faces a body has at most, rounded up
NOTHING: Final = -1  # number of the body where there is none


@dataclass(frozen=True, slots=True, eq=False)
class Buffers:
    """What every pixel shows.

    Attributes:
        depth: (rows, columns) coordinate towards who looks [m]; -inf where nothing is.
        face: (rows, columns) 8 · number of the body + number of its face; negative where nothing is.
        shade: (rows, columns) brightness of its colour.
    """

    __repr__ = fields_shown

    depth: Plane
    face: FaceNumbers
    shade: Plane

    @property
    def bodies(self) -> FaceNumbers:
        """(rows, columns) number of the body that each pixel shows, `NOTHING` where there is none."""
        return self.face // _FACES


class _Sight:
    """Lines of sight through the pixels around one body, in the frame of the body.

    Args:
        solid: The body.
        view: From where one looks.
        window: What fills the picture.
    """

    def __init__(self, solid: PlacedBody, view: View, window: Window) -> None:
        T, s = solid.T, window.scale
        u, v = coordinate(T[:3, 3], view.right), coordinate(T[:3, 3], view.up)
        du, dv = half_span(solid, view.right), half_span(solid, view.up)
        first = max(int((u - du - window.left) * s - 1), 0), max(int((window.top - v - dv) * s - 1), 0)
        last = (
            min(int((u + du - window.left) * s + 2), window.width),
            min(int((window.top - v + dv) * s + 2), window.height),
        )
        self.place = slice(first[1], max(last[1], first[1])), slice(first[0], max(last[0], first[0]))
        columns = (np.arange(first[0], last[0]) + 0.5) / s + window.left - u
        rows = window.top - (np.arange(first[1], last[1]) + 0.5) / s - v
        self._u = columns[None, :].astype(np.float32)
        self._v = rows[:, None].astype(np.float32)
        self.depth = coordinate(T[:3, 3], view.toward)
        axes = [T[:3, n] for n in range(3)]
        self.right = [coordinate(axis, view.right) for axis in axes]
        self.up = [coordinate(axis, view.up) for axis in axes]
        self.toward = [coordinate(axis, view.toward) for axis in axes]

    @property
    def empty(self) -> bool:
        return self._u.size == 0 or self._v.size == 0

    def at(self, n: int) -> Plane:
        """Return coordinate n of where the lines cross the plane through the centre."""
        result: Plane = self._u * np.float32(self.right[n]) + self._v * np.float32(self.up[n])
        return result

    def slab(self, n: int, half: float) -> tuple[Plane, Plane]:
        """Return where the lines enter (nearest to who looks) and leave what is within ±half along axis n."""
        t, here = self.toward[n], self.at(n)
        if abs(t) < _EDGE_ON:
            return _all_or_nothing(np.asarray(np.abs(here) <= half))
        a, b = (half - here) / np.float32(t), (-half - here) / np.float32(t)
        return (a, b) if t > 0.0 else (b, a)

    def round(self, axes: Sequence[int], radius: float) -> tuple[Plane, Plane]:
        """Return where the lines enter and leave what is within a radius across some axes."""
        square = sum(self.toward[n] ** 2 for n in axes)
        points = [self.at(n) for n in axes]
        across = sum(point * point for point in points) - np.float32(radius * radius)
        if square < _EDGE_ON:
            return _all_or_nothing(np.asarray(across <= 0.0))
        half = sum(point * np.float32(self.toward[n]) for n, point in zip(axes, points, strict=True))
        inner = half * half - np.float32(square) * across
        root = np.sqrt(np.maximum(inner, 0.0))
        near = np.where(inner >= 0.0, (root - half) / np.float32(square), np.float32(-np.inf))
        return near, (-root - half) / np.float32(square)

    def lit(self, normal: Sequence[Plane | float]) -> Plane:
        """Return the cosine between a normal, in the frame of the body, and the light."""
        x, y, z = normal
        a, b, c = (
            np.float32(LIGHT[0] * self.right[n] + LIGHT[1] * self.up[n] + LIGHT[2] * self.toward[n]) for n in range(3)
        )
        return np.asarray(x * a + y * b + z * c)


def _all_or_nothing(inside: NDArray[np.bool_]) -> tuple[Plane, Plane]:
    """Return where lines enter and leave that lie within all along, or outside."""
    near = np.where(inside, np.float32(np.inf), np.float32(-np.inf))
    return near, -near


def render(solids: Sequence[PlacedBody], view: View, window: Window) -> Buffers:
    """Return what every pixel of a window shows.

    Args:
        solids: The bodies; the number of one is its place here.
        view: From where one looks.
        window: What of it fills the picture.
    """
    shape = window.height, window.width
    buffers = Buffers(
        np.full(shape, -np.inf, dtype=np.float32), np.full(shape, -1, dtype=np.int32), np.ones(shape, dtype=np.float32)
    )
    for number, solid in enumerate(solids):
        if solid.body.surface is not None:
            _draw_mesh(buffers, number, mesh_pixels(solid, solid.body.surface, view, window))
            continue
        sight = _Sight(solid, view, window)
        if not sight.empty:
            _draw(buffers, number, solid, sight)
    return buffers


def _draw_mesh(buffers: Buffers, number: int, found: MeshPixels) -> None:
    depth = found.depth.astype(np.float32)
    seen = depth > buffers.depth.ravel()[found.place] + np.float32(_NEARER)
    place = found.place[seen]
    for plane, values in ((buffers.depth, depth), (buffers.shade, found.shade.astype(np.float32))):
        plane.ravel()[place] = values[seen]
    buffers.face.ravel()[place] = number * _FACES


def _draw(buffers: Buffers, number: int, solid: PlacedBody, sight: _Sight) -> None:
    size = solid.body.dimensions
    if solid.body.kind == "box":
        spans = [sight.slab(n, size[n] / 2.0) for n in range(3)]
    elif solid.body.kind == "sphere":
        spans = [sight.round((0, 1, 2), size[0])]
    else:
        spans = [sight.round((0, 1), size[0]), sight.slab(2, size[1] / 2.0)]
    near, far, side = spans[0][0], spans[0][1], np.zeros(spans[0][0].shape, dtype=np.int32)
    for n, (a, b) in enumerate(spans[1:], start=1):
        side[a < near] = n
        near, far = np.minimum(near, a), np.maximum(far, b)
    place = sight.place
    seen = (near >= far) & (near + np.float32(sight.depth) > buffers.depth[place] + np.float32(_NEARER))
    if not seen.any():
        return
    near, side = near[seen], side[seen]
    buffers.depth[place][seen] = near + np.float32(sight.depth)
    buffers.face[place][seen] = number * _FACES + side
    buffers.shade[place][seen] = MIDDLE + GAIN * _cosines(solid, sight, near, side, seen)


def _cosines(solid: PlacedBody, sight: _Sight, near: Plane, side: FaceNumbers, seen: NDArray[np.bool_]) -> Plane:
    """Return the cosine to the light where the lines of sight meet a body."""
    kind, size = solid.body.kind, solid.body.dimensions
    signs = [1.0 if part > 0.0 else -1.0 for part in sight.toward]
    if kind == "box":
        faces = [sight.lit([signs[n] if n == m else 0.0 for m in range(3)]) for n in range(3)]
        return np.array(faces, dtype=np.float32)[side]
    points = [(sight.at(n)[seen] + near * np.float32(sight.toward[n])) / np.float32(size[0]) for n in range(3)]
    if kind == "sphere":
        return np.asarray(sight.lit(points), dtype=np.float32)
    around = np.asarray(sight.lit([points[0], points[1], 0.0]), dtype=np.float32)
    cap = np.float32(sight.lit([0.0, 0.0, signs[2]]))
    return np.where(side == 1, cap, around)
