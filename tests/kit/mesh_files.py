"""Small mesh files: a box as STL, OBJ or DAE, an L, which is not convex, and a URDF that has them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from pathlib import Path

import numpy as np

from chainbuild.meshes import Triangles

# Corners of a box as numbers of the products of (0, 1), x first; counter-clockwise from outside.
BOX_FACES = (
    (0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
    (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3),
)  # fmt: skip
Points = Sequence[Sequence[float]]
Faces = Sequence[Sequence[int]]


def box(low: Sequence[float], high: Sequence[float]) -> tuple[Points, Faces]:
    """Return vertices and triangles of a box between two corners."""
    return [tuple(point) for point in product(*zip(low, high, strict=True))], BOX_FACES


def joined(*parts: tuple[Points, Faces]) -> tuple[Points, Faces]:
    """Return several meshes as one."""
    points: list[Sequence[float]] = []
    faces: list[Sequence[int]] = []
    for own, around in parts:
        faces += [[len(points) + n for n in face] for face in around]
        points += own
    return points, faces


def write_obj(path: Path, mesh: tuple[Points, Faces]) -> Path:
    points, faces = mesh
    lines = [f"v {x} {y} {z}" for x, y, z in points] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    path.write_text("\n".join(lines) + "\n", "utf-8")
    return path


def write_stl(path: Path, mesh: tuple[Points, Faces]) -> Path:
    points, faces = mesh
    lines = ["solid part"]
    for face in faces:
        corners = [f"vertex {' '.join(map(str, points[n]))}" for n in face]
        lines += ["facet normal 0 0 0", "outer loop", *corners, "endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid part"]) + "\n", "utf-8")
    return path


def write_dae(path: Path, mesh: tuple[Points, Faces], asset: str = "") -> Path:
    points, faces = mesh
    numbers = " ".join(str(value) for point in points for value in point)
    corners = " ".join(str(n) for face in faces for n in face)
    axes = "".join(f'<param name="{axis}" type="float"/>' for axis in "XYZ")
    path.write_text(
        f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>{asset}</asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="{3 * len(points)}">{numbers}</float_array><technique_common>
<accessor source="#a" count="{len(points)}" stride="3">{axes}</accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="{len(faces)}"><input semantic="VERTEX" source="#v" offset="0"/><p>{corners}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>""",
        "utf-8",
    )
    return path


def surface(mesh: tuple[Points, Faces]) -> Triangles:
    """Return a mesh as the surface that is drawn."""
    return Triangles(np.array(mesh[0], dtype=float), np.array(mesh[1]))


ARM = """<robot name="arm"><material name="blue"><color rgba="0 0 1 1"/></material>
  <link name="root"><visual><geometry><mesh filename="l.stl"/></geometry></visual></link>
  <link name="one"><visual><origin xyz="0.1 0 0" rpy="0 0 1.5707963267948966"/>
    <geometry><mesh filename="l.stl"/></geometry><material name="blue"/></visual>
    <collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <link name="two"><visual><geometry><sphere radius="0.05"/></geometry></visual>
    <collision><geometry><mesh filename="l.stl"/></geometry></collision></link>
  <joint name="A" type="revolute"><parent link="root"/><child link="one"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
  <joint name="B" type="revolute"><origin xyz="0.5 0 0"/><parent link="one"/><child link="two"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>"""
L_MESH = ((0.0, 0.0, 0.0), (0.3, 0.1, 0.05)), ((0.0, 0.0, 0.05), (0.05, 0.1, 0.3))


def write_arm(folder: Path) -> Path:
    """Write a URDF of two links with an L, a box and a ball to look at and to collide with."""
    write_stl(folder / "l.stl", joined(*(box(low, high) for low, high in L_MESH)))
    (folder / "arm.urdf").write_text(ARM, "utf-8")
    return folder / "arm.urdf"
