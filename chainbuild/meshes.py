"""Triangles of mesh files, STL, OBJ, DAE or whatever else coal's reader knows; and made lighter, or ready to be lit."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, Final

import numpy as np

from chainbuild import tolerances
from chainbuild.arrays import Indices, Matrix
from chainbuild.errors import FileAccessError, FileContentError, Span
from chainbuild.shown import fields_shown

Scale = tuple[float, float, float]

FLAT: Final = 1e-6  # share of the largest width: the hull of a flatter body crashes, and files hold six digits
_KEPT: Final = 256  # meshes in memory: some robots
_CREASE: Final = 0.82  # cosine of 35°: faces that meet under more are not one round face
_HEAD: Final = 8192  # bytes in which a DAE names its unit
_UNIT: Final = re.compile(rb"<unit\b[^>]*\bmeter\s*=\s*[\"']([^\"']+)[\"']")
_GROWTH: Final = 1.25  # of the cells by which a mesh is made lighter, from one trial to the next


@dataclass(frozen=True, slots=True, eq=False)
class Triangles:
    """A surface of triangles.

    Attributes:
        points: (n, 3) vertices [m].
        corners: (m, 3) numbers of the vertices of each triangle, counter-clockwise as seen from outside.
    """

    __repr__ = fields_shown

    points: Matrix
    corners: Indices

    @property
    def normals(self) -> Matrix:
        """(m, 3) twice the area of each triangle along its normal [m²]."""
        a, b, c = (self.points[self.corners[:, n]] for n in range(3))
        normals: Matrix = np.cross(b - a, c - a)
        return normals

    @property
    def closed(self) -> bool:
        """Whether every edge of a triangle is one of another that runs along it the other way."""
        number = np.unique(self.points, axis=0, return_inverse=True)[1].ravel()  # files repeat vertices
        ends = number[self.corners]
        start, end = ends.ravel(), np.roll(ends, -1, axis=1).ravel()
        count = len(self.points)
        return np.array_equal(np.sort(start * count + end), np.sort(end * count + start))


def read_triangles(file: Path | str, scale: Scale, *, hull: bool = False) -> Triangles:
    """Return the surface of a mesh file.

    Args:
        file: The file.
        scale: Metres per unit of the file along its x, y, z; a negative one mirrors.
        hull: Its convex hull instead.

    Raises:
        FileAccessError: the file is missing, or no mesh.
        FileContentError: it has vertices that are no places, or is flat and meant as a hull.
    """
    return _surface(str(file), scale, hull, _stamp(file))


def check_mesh(file: Path | str, scale: Scale) -> None:
    """Read a mesh file without its triangles, which takes most of the time.

    Raises:
        FileAccessError: the file is missing, or no mesh.
        FileContentError: it has vertices that are no places.
    """
    _read(str(file), scale, _stamp(file))


def _stamp(file: Path | str) -> tuple[int, int]:
    """Return what tells a file from a later one of its name."""
    try:
        found = Path(file).stat()
    except (OSError, ValueError):
        raise _unread(file) from None
    return found.st_mtime_ns, found.st_size


@lru_cache(maxsize=_KEPT)
def _read(file: str, scale: Scale, _stamp: tuple[int, int]) -> tuple[Any, Matrix]:
    """Return coal's mesh of a file, and its vertices (n, 3) [m]."""
    import coal

    # Boxes are the tree of bounds that is built fastest; nobody asks it for anything.
    try:
        mesh = coal.MeshLoader(coal.NODE_TYPE.BV_AABB).load(file, np.array(scale))
    except ValueError:
        raise _unread(file) from None
    if not mesh.num_tris:
        raise _unread(file)
    points = np.array(mesh.vertices(), dtype=float)
    if not np.isfinite(points).all() or not np.abs(points).max() < tolerances.HUGE_POSITION_M:
        permitted = f"vertices within {tolerances.HUGE_POSITION_M:g} m"
        raise FileContentError("vertices are not finite or too far away", span=Span(file), permitted=permitted)
    return mesh, points


@lru_cache(maxsize=_KEPT)
def _surface(file: str, scale: Scale, hull: bool, stamp: tuple[int, int]) -> Triangles:
    mesh, points = _read(file, scale, stamp)
    if hull:
        widths = principal_widths(points)
        if min(widths) <= FLAT * max(widths):
            raise FileContentError(
                "the mesh is flat: it has no hull", span=Span(file), permitted="a body with a volume"
            )
        convex = convex_of(mesh)
        if convex is None:
            text = "the mesh has no hull: more than 255 edges meet in one of its corners"
            raise FileContentError(text, span=Span(file), permitted="fewer corners")
        return _of_hull(convex)
    corners = np.array([(t[0], t[1], t[2]) for t in map(mesh.tri_indices, range(mesh.num_tris))], dtype=np.intp)
    return Triangles(points, corners[:, ::-1] if np.prod(scale) < 0.0 else corners)


def _unread(file: Path | str) -> FileAccessError:
    return FileAccessError("the mesh cannot be read (missing, or not STL, OBJ or DAE)", span=Span(str(file)))


def convex_of(mesh: Any) -> Any:
    """Return the convex hull of coal's mesh, or None where more edges meet in a corner than coal can count."""
    # Of faces with many corners some triangulations are fans: with corners moved by rounding there are others.
    for how in ("Qt", "QJ"):
        if mesh.convex is None:
            with suppress(RuntimeError):
                mesh.buildConvexHull(True, how)
    return mesh.convex


def _of_hull(convex: Any) -> Triangles:
    points = np.array(convex.points(), dtype=float)
    found = (convex.polygons(n) for n in range(convex.num_polygons))
    corners = np.array([(face[0], face[1], face[2]) for face in found], dtype=np.intp)
    surface = Triangles(points, corners)
    # The sense in which a hull's faces run is not told; its middle is inside.
    outwards = np.einsum("ij,ij->i", surface.normals, points[corners].mean(axis=1) - points.mean(axis=0))
    corners[outwards < 0.0] = corners[outwards < 0.0][:, ::-1]
    return surface


def dae_unit(file: Path) -> float:
    """Return the metres a unit of a DAE file has, 1 for other files.

    A URDF means these: the viewers of ROS heed them. coal reads the numbers as they are, like trimesh. Which way is up
    neither heeds, nor do those viewers.
    """
    if file.suffix.lower() != ".dae":
        return 1.0
    try:
        with file.open("rb") as stream:
            found = _UNIT.search(stream.read(_HEAD))
        unit = float(found[1]) if found else 1.0
    except (OSError, ValueError):
        return 1.0
    return unit if 0.0 < unit < math.inf else 1.0


def principal_widths(points: Matrix) -> tuple[float, ...]:
    """Return how wide points (n, 3) lie along their three principal axes [m]; infinite where one is no place."""
    if not np.isfinite(points).all() or not np.abs(points).max() < tolerances.HUGE_POSITION_M:
        return (np.inf,) * 3
    directions = np.linalg.eigh(np.cov(points.T))[1]
    return tuple(np.ptp(points @ directions, axis=0).tolist())


def creased(surface: Triangles) -> Triangles:
    """Return the same surface with a vertex for each side of every crease, so that no light runs around an edge.

    Of the corners that meet in a vertex those stay one whose triangles follow one another without a crease.
    """
    count = 3 * len(surface.corners)
    normals = surface.normals
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0.0)
    # Every edge of every triangle, with the corners at its ends; edges between the same vertices come together.
    own = np.arange(count).reshape(-1, 3)
    first, second = own.ravel(), np.roll(own, -1, axis=1).ravel()
    ends = np.sort(np.column_stack([surface.corners.ravel()[first], surface.corners.ravel()[second]]), axis=1)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    same = (ends[order[:-1]] == ends[order[1:]]).all(axis=1)
    one, other = order[:-1][same], order[1:][same]
    smooth = np.einsum("ij,ij->i", normals[one // 3], normals[other // 3]) > _CREASE
    one, other = one[smooth], other[smooth]
    # The far end of one edge is the near end of the other where the two triangles run the same way around.
    vertex = surface.corners.ravel()
    turned = vertex[first[one]] != vertex[first[other]]
    a = np.concatenate([first[one], second[one]])
    b = np.concatenate([np.where(turned, second[other], first[other]), np.where(turned, first[other], second[other])])
    labels = _joined(count, a, b)
    kept, corners = np.unique(labels, return_inverse=True)
    return Triangles(surface.points[vertex[kept]], corners.reshape(-1, 3))


def _joined(count: int, a: Indices, b: Indices) -> Indices:
    """Return of every one of some things the lowest that it is joined to, by way of others, too."""
    labels = np.arange(count)
    while True:
        before = labels.copy()
        np.minimum.at(labels, a, labels[b])
        np.minimum.at(labels, b, labels[a])
        labels = labels[labels]
        if (labels == before).all():
            return labels


def lighter(surfaces: Sequence[Triangles], most: int) -> list[Triangles]:
    """Return surfaces of so few triangles together, where there are more with vertices that are near made one.

    Args:
        surfaces: The surfaces.
        most: Triangles permitted for all.
    """
    count = sum(len(one.corners) for one in surfaces)
    if count <= most:
        return list(surfaces)
    area = sum(float(np.linalg.norm(one.normals, axis=1).sum()) for one in surfaces) / 2.0
    cell = math.sqrt(area / most) / 8.0  # far below the edge of triangles of that number: the search begins here
    found = list(surfaces)
    while sum(len(one.corners) for one in found) > most:
        cell *= _GROWTH
        found = [_merged(one, cell) for one in surfaces]
    return found


def _merged(surface: Triangles, cell: float) -> Triangles:
    """Return a surface whose vertices within one cell of a grid are one, where their middle is."""
    _, number = np.unique(np.floor(surface.points / cell), axis=0, return_inverse=True)
    number = number.ravel()
    count = np.bincount(number)
    points = np.column_stack([np.bincount(number, surface.points[:, n]) / count for n in range(3)])
    corners = number[surface.corners]
    a, b, c = corners.T
    corners = corners[(a != b) & (b != c) & (c != a)]
    # Triangles that fell on one another are one.
    _, alone = np.unique(np.sort(corners, axis=1), axis=0, return_index=True)
    return Triangles(points, corners[np.sort(alone)])
