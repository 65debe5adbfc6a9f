"""From bodies and overlay shapes to coal geometry: capsules where the rule draws cylinders."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Any, Literal

import coal
import numpy as np

from chainbuild import frames, tolerances
from chainbuild.arrays import Matrix
from chainbuild.chain.bodies.body import Body, along
from chainbuild.chain.bodies.geometry import Shape
from chainbuild.chain.bodies.shapes import solid_bodies
from chainbuild.chain.elements import Chain
from chainbuild.errors import FileAccessError, FileContentError, Span
from chainbuild.meshes import FLAT, Scale, convex_of, principal_widths


@dataclass(frozen=True, slots=True, eq=False)
class Solid:
    """One body for collision.

    Attributes:
        name: Unique name: the link's, with a number where it has several.
        link: Link that carries it.
        kind: "capsule", "sphere", "box", "cylinder", "hull" or "mesh".
        T_link_solid: (4, 4) placement [m].
        reach: Radius [m] of a ball about the link's origin that holds it.
        size: Capsule and cylinder: (radius, length of the axis); sphere: (radius,); box: edges; else empty [m].
        geometry: Coal's geometry.
        around: Of a mesh: its convex hull, if it has one, which coal measures many times faster; else the geometry.
    """

    name: str
    link: str
    kind: Literal["capsule", "sphere", "box", "cylinder", "hull", "mesh"]
    T_link_solid: Matrix
    reach: float
    size: tuple[float, ...]
    geometry: Any
    around: Any


def solids_of(chain: Chain) -> tuple[Solid, ...]:
    """Return the bodies of a chain: those of the overlay, else capsules, spheres and boxes where the data put them.

    Raises:
        FileAccessError: a mesh cannot be read, has vertices that are no places, or is flat and meant as a hull.
    """
    shapes = chain.geometry.shapes
    found = [_drawn(body) for body in solid_bodies(chain) if body.link not in shapes]
    for link, own in shapes.items():
        found.extend(_given(link, shape) for shape in own)
    return tuple(_numbered(found))


def _numbered(solids: list[Solid]) -> list[Solid]:
    counts: dict[str, int] = {}
    named = []
    for solid in solids:
        count = counts[solid.link] = counts.get(solid.link, 0) + 1
        named.append(solid if count == 1 else replace(solid, name=f"{solid.link}.{count}"))
    return named


def _drawn(body: Body) -> Solid:
    if body.kind == "cylinder" and body.part != "table":
        radius, length = body.dimensions
        return _solid(body.link, "capsule", body.T_link_body, (radius, length), coal.Capsule(radius, length))
    if body.kind == "cylinder":
        radius, length = body.dimensions
        return _solid(body.link, "cylinder", body.T_link_body, (radius, length), coal.Cylinder(radius, length))
    if body.kind == "sphere":
        return _solid(body.link, "sphere", body.T_link_body, body.dimensions, coal.Sphere(body.dimensions[0]))
    return _solid(body.link, "box", body.T_link_body, body.dimensions, coal.Box(*body.dimensions))


def _given(link: str, shape: Shape) -> Solid:
    if shape.kind == "sphere":
        T = frames.translation(*shape.points)
        return _solid(link, "sphere", T, (shape.radius,), coal.Sphere(shape.radius))
    if shape.kind in ("capsule", "cylinder"):
        start, end = np.array(shape.points[:3]), np.array(shape.points[3:])
        length = float(np.linalg.norm(end - start))
        make = coal.Capsule if shape.kind == "capsule" else coal.Cylinder
        T = along(end - start, (start + end) / 2)
        return _solid(link, shape.kind, T, (shape.radius, length), make(shape.radius, length))
    T = frames.f_frame(shape.place[:3], shape.place[3:])
    if shape.kind == "box":
        return _solid(link, "box", T, shape.size, coal.Box(*shape.size))
    return _solid(link, shape.kind, T, (), *_mesh(link, str(shape.file), shape.scale, shape.kind == "hull"))


def _mesh(link: str, file: str, scale: Scale, hull: bool) -> tuple[Any, Any]:
    """Return a mesh or its hull, and its hull; of a mesh that has none, such as a flat one, itself."""
    body = f"{'hull' if hull else 'mesh'} of link {link}"
    try:
        mesh, extents = _loaded(file, scale)
    except ValueError:
        text = f"the {body} cannot be read (missing, or not STL, OBJ or DAE)"
        raise FileAccessError(text, span=Span(file), parameter=link) from None
    if not max(extents) < tolerances.HUGE_POSITION_M:
        permitted = f"vertices within {tolerances.HUGE_POSITION_M:g} m"
        raise FileContentError(
            f"the {body} has vertices that are not finite or too far away",
            span=Span(file), parameter=link, permitted=permitted,
        )  # fmt: skip
    flat = min(extents) <= FLAT * max(extents)
    if flat and hull:
        hint = 'a flat body can be given as "mesh" or as a thin box'
        raise FileContentError(
            f"the {body} is flat: its {len(mesh.vertices())} vertices lie in a plane",
            span=Span(file), parameter=link, permitted="a body with a volume", hint=hint,
        )  # fmt: skip
    around = None if flat else convex_of(mesh)
    if hull and around is None:
        text = f"the {body} has a corner in which more than 255 edges meet"
        raise FileContentError(
            text, span=Span(file), parameter=link, permitted="fewer corners", hint='it can be given as "mesh"'
        )
    around = around or mesh
    return around if hull else mesh, around


@cache
def _loaded(file: str, scale: Scale) -> tuple[Any, tuple[float, ...]]:
    """Return a mesh and its three widths [m] along its principal axes; infinite where a vertex is no place."""
    mesh = coal.MeshLoader().load(file, np.array(scale))
    return mesh, principal_widths(np.array(mesh.vertices()))


def _solid(link: str, kind: Any, T: Matrix, size: tuple[float, ...], geometry: Any, around: Any = None) -> Solid:
    geometry.computeLocalAABB()
    centre = T[:3, :3] @ np.asarray(geometry.aabb_center) + T[:3, 3]
    reach = float(np.linalg.norm(centre)) + float(geometry.aabb_radius)
    return Solid(link, link, kind, T, reach, tuple(size), geometry, around or geometry)
