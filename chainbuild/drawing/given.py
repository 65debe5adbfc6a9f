"""Bodies that an overlay or a URDF gives, in place of those drawn for their links."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import numpy as np

from chainbuild.chain.bodies.body import Body, Colour, along, mesh_body, rounded_body
from chainbuild.chain.bodies.geometry import Geometry, Shape
from chainbuild.drawing.site import Site
from chainbuild.errors import ChainbuildError
from chainbuild.frames import f_frame, translation
from chainbuild.meshes import read_triangles


def with_given(site: Site, draw: Callable[[Site], list[Body]]) -> list[Body]:
    """Return the bodies that are given, and those that a rule draws for the other links.

    A link of which a mesh cannot be read is drawn by rule.

    Args:
        site: The machine.
        draw: The rule.
    """
    given = {}
    for link, shapes in _looks(site.chain.geometry).items():
        bodies = _bodies(link, shapes, site.colour(link))
        if bodies is not None:
            given[link] = bodies
    complete = all(link.name in given for link in site.chain.links)
    kept = [] if complete else [body for body in draw(site) if body.link not in given]
    return [*kept, *(body for found in given.values() for body in found)]


def undrawn_meshes(geometry: Geometry) -> tuple[str, ...]:
    """Return the links whose hulls or meshes cannot be read, so that a drawing does not show them."""
    grey = (0.5, 0.5, 0.5)  # nobody sees it
    return tuple(link for link, shapes in _looks(geometry).items() if _bodies(link, shapes, grey) is None)


def _looks(geometry: Geometry) -> Mapping[str, tuple[Shape, ...]]:
    return {**geometry.shapes, **geometry.visuals}


def _bodies(link: str, shapes: Iterable[Shape], colour: Colour) -> list[Body] | None:
    """Return the bodies of a link; None: a mesh cannot be read."""
    try:
        return [body for shape in shapes for body in _of_shape(link, shape, shape.colour or colour)]
    except ChainbuildError:
        return None


def _of_shape(link: str, shape: Shape, colour: Colour) -> list[Body]:
    if shape.kind == "box":
        T = f_frame(shape.place[:3], shape.place[3:])
        return [rounded_body(link, "link", T, "box", shape.size, colour, "data")]
    if shape.kind == "sphere":
        return [rounded_body(link, "link", translation(*shape.points), "sphere", (shape.radius,), colour, "data")]
    if shape.file is not None:
        surface = read_triangles(shape.file, shape.scale, hull=shape.kind == "hull")
        return [mesh_body(link, f_frame(shape.place[:3], shape.place[3:]), surface, colour)]
    start, end = np.array(shape.points[:3]), np.array(shape.points[3:])
    size = shape.radius, float(np.linalg.norm(end - start))
    found = [rounded_body(link, "link", along(end - start, (start + end) / 2), "cylinder", size, colour, "data")]
    if shape.kind == "capsule":
        ends = (translation(*point.tolist()) for point in (start, end))
        found += [rounded_body(link, "link", T, "sphere", (shape.radius,), colour, "data") for T in ends]
    return found
