"""Bodies that an overlay gives, in place of those drawn for their links."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from chainbuild.chain.bodies.body import Body, Colour, along, rounded_body
from chainbuild.chain.bodies.geometry import Geometry, Shape
from chainbuild.drawing.site import Site
from chainbuild.frames import f_frame, translation


def with_given(site: Site, bodies: Iterable[Body]) -> list[Body]:
    """Return the bodies with those of the overlay in place of the drawn ones of their links.

    Hulls and meshes are no boxes, cylinders or balls: a link of which the overlay gives nothing else is drawn by rule.
    """
    given = {link: _bodies(link, shapes, site.colour(link)) for link, shapes in site.chain.geometry.shapes.items()}
    kept = [body for body in bodies if not given.get(body.link)]
    return [*kept, *(body for found in given.values() for body in found)]


def undrawn_meshes(geometry: Geometry) -> tuple[str, ...]:
    """Return the links whose hulls or meshes a drawing does not show."""
    return tuple(link for link, shapes in geometry.shapes.items() if any(shape.file is not None for shape in shapes))


def _bodies(link: str, shapes: Iterable[Shape], colour: Colour) -> list[Body]:
    return [body for shape in shapes for body in _of_shape(link, shape, colour)]


def _of_shape(link: str, shape: Shape, colour: Colour) -> list[Body]:
    if shape.kind == "box":
        T = f_frame(shape.place[:3], shape.place[3:])
        return [rounded_body(link, "link", T, "box", shape.size, colour, "data")]
    if shape.kind == "sphere":
        return [rounded_body(link, "link", translation(*shape.points), "sphere", (shape.radius,), colour, "data")]
    if shape.file is not None:
        return []
    start, end = np.array(shape.points[:3]), np.array(shape.points[3:])
    size = shape.radius, float(np.linalg.norm(end - start))
    found = [rounded_body(link, "link", along(end - start, (start + end) / 2), "cylinder", size, colour, "data")]
    if shape.kind == "capsule":
        ends = (translation(*point.tolist()) for point in (start, end))
        found += [rounded_body(link, "link", T, "sphere", (shape.radius,), colour, "data") for T in ends]
    return found
