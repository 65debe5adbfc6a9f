"""Bodies of an overlay or a URDF as URDF elements, and the meshes they are made of, copied beside the file."""

from __future__ import annotations

import struct
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from pathlib import Path
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix
from chainbuild.chain.bodies.body import along
from chainbuild.chain.bodies.geometry import Shape
from chainbuild.errors import FileAccessError, Span
from chainbuild.files import number_text, numbers_text
from chainbuild.frames import f_frame, translation
from chainbuild.meshes import Triangles, dae_unit, read_triangles
from chainbuild.writers.models.robotfiles import RobotFiles, rpy_texts

_FOLDER: Final = "meshes"
_HEADER: Final = b"chainbuild: convex hull".ljust(80)  # binary STL begins with 80 bytes that nobody reads
_LONGEST: Final = 80  # letters of a mesh's name: files have 255 at most, and a number is added
_UNSCALED: Final = (1.0, 1.0, 1.0)  # hulls are written in metres


class Meshes:
    """Collects the meshes of one file.

    Attributes:
        files: Path beside the file → content.
    """

    def __init__(self) -> None:
        self.files: RobotFiles = {}
        self._names: dict[tuple[Path, str, object], str] = {}

    def add_bodies(self, link: ET.Element, tag: str, shapes: Iterable[Shape]) -> list[tuple[ET.Element, Shape]]:
        """Write the bodies of a link and return their elements.

        Args:
            link: Its element.
            tag: "visual" or "collision".
            shapes: Its bodies.
        """
        found = []
        for shape in shapes:
            for T, kind, attributes in self._parts(shape):
                element = ET.SubElement(link, tag)
                add_origin(element, T)
                ET.SubElement(ET.SubElement(element, "geometry"), kind, attributes)
                found.append((element, shape))
        return found

    def _parts(self, shape: Shape) -> list[tuple[Matrix, str, dict[str, str]]]:
        """Return placement, kind and measures of what a body is in a URDF: a capsule is a cylinder and two balls."""
        if shape.kind == "box":
            return [(_place(shape), "box", {"size": numbers_text(shape.size)})]
        radius = number_text(shape.radius)
        if shape.kind == "sphere":
            return [(translation(*shape.points), "sphere", {"radius": radius})]
        if shape.file is not None:
            # Who reads the file multiplies by its own unit.
            unit = dae_unit(shape.file)
            scale = [factor / unit for factor in shape.scale] if shape.kind == "mesh" else _UNSCALED
            return [(_place(shape), "mesh", {"filename": self._name(shape), "scale": numbers_text(scale)})]
        start, end = np.array(shape.points[:3]), np.array(shape.points[3:])
        length = number_text(float(np.linalg.norm(end - start)))
        found = [(along(end - start, (start + end) / 2), "cylinder", {"radius": radius, "length": length})]
        if shape.kind == "capsule":
            found += [(translation(*point.tolist()), "sphere", {"radius": radius}) for point in (start, end)]
        return found

    def _name(self, shape: Shape) -> str:
        """Return the path of a body's mesh, relative to the file that refers to it; it is added to the files."""
        assert shape.file is not None
        hull = shape.kind == "hull"
        key = (shape.file.resolve(), shape.kind, shape.scale if hull else None)
        if key not in self._names:
            stem = "".join(c if c.isascii() and (c.isalnum() or c in "_-") else "_" for c in shape.file.stem[:_LONGEST])
            suffix = "_hull.stl" if hull else shape.file.suffix.lower()
            taken, number = {name.lower() for name in self.files}, 1
            name = f"{_FOLDER}/{stem}{suffix}"
            while name.lower() in taken:
                number += 1
                name = f"{_FOLDER}/{stem}_{number}{suffix}"
            self.files[name] = (
                _hull_stl(read_triangles(shape.file, shape.scale, hull=True)) if hull else _content(shape.file)
            )
            self._names[key] = name
        return self._names[key]


def add_origin(element: ET.Element, T: Matrix) -> None:
    """Write the place of an element: T (4, 4) [m]."""
    ET.SubElement(element, "origin", xyz=numbers_text(T[:3, 3].tolist()), rpy=" ".join(rpy_texts(T)))


def _hull_stl(hull: Triangles) -> bytes:
    """Return a convex body as binary STL, its triangles in an order that does not depend on how it was made."""
    turned = []
    for triangle in hull.points.astype(np.float32)[hull.corners].tolist():
        first = triangle.index(min(triangle))
        turned.append(triangle[first:] + triangle[:first])
    facets = (
        struct.pack("<12fH", 0, 0, 0, *(x for corner in triangle for x in corner), 0) for triangle in sorted(turned)
    )
    return _HEADER + struct.pack("<I", len(turned)) + b"".join(facets)


def _content(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except OSError as error:
        raise FileAccessError(f"the mesh cannot be read: {error.strerror or error}", span=Span(str(file))) from None


def _place(shape: Shape) -> Matrix:
    return f_frame(shape.place[:3], shape.place[3:])
