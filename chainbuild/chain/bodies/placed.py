"""Shapes seen from elsewhere, and the bodies of two chains that become one."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from chainbuild.arrays import Matrix
from chainbuild.chain.bodies.geometry import Geometry, Numbers, Shape
from chainbuild.frames import f_frame, urdf_rpy
from chainbuild.units import deg_from_rad

Shapes = Mapping[str, tuple[Shape, ...]]


def shape_place(T: Matrix) -> Numbers:
    """Return a placement (4, 4) as shapes hold it: x, y, z [m] and A, B, C [deg]."""
    roll, pitch, yaw = (deg_from_rad(angle) for angle in urdf_rpy(T[:3, :3]))
    return (*T[:3, 3].tolist(), yaw, pitch, roll)


def moved_shape(shape: Shape, T: Matrix) -> Shape:
    """Return a shape in other axes.

    Args:
        shape: The shape.
        T: (4, 4) its axes in the others [m].
    """
    if shape.points:
        points = (shape.points[n : n + 3] for n in range(0, len(shape.points), 3))
        return replace(shape, points=tuple(x for point in points for x in (T[:3, :3] @ point + T[:3, 3]).tolist()))
    return replace(shape, place=shape_place(T @ f_frame(shape.place[:3], shape.place[3:])))


def joined_geometry(
    host: Geometry, guest: Geometry, names: Mapping[str, str], places: Mapping[str, Matrix], root: str
) -> Geometry:
    """Return what overlays and URDFs say about the bodies of two chains that become one.

    Args:
        host: Of the chain that is grafted on.
        guest: Of the chain that is grafted.
        names: The guest's links → their names in both.
        places: The guest's links whose axes are others now → (4, 4) the old ones in the new [m]: of these radii are
            those of the rule again, for drawn bodies are others, too.
        root: The guest's link that becomes a part of one of the host. Its bodies join those given there; a link whose
            body is drawn keeps that alone.
    """

    def placed(link: str, shapes: tuple[Shape, ...]) -> tuple[Shape, ...]:
        return tuple(moved_shape(shape, places[link]) for shape in shapes) if link in places else shapes

    def renamed(shapes: Shapes) -> dict[str, tuple[Shape, ...]]:
        return {names[link]: placed(link, own) for link, own in shapes.items() if link != root}

    shapes = {**renamed(guest.shapes), **host.shapes}
    visuals = {**renamed(guest.visuals), **host.visuals}
    link, bodies = names[root], guest.shapes.get(root, ())
    if link in host.shapes:
        shapes[link] = (*host.shapes[link], *placed(root, bodies))
    if link in host.visuals or (link in host.shapes and root in guest.visuals):
        seen = host.visuals.get(link, host.shapes.get(link, ()))
        visuals[link] = (*seen, *placed(root, guest.visuals.get(root, bodies)))
    radii = {names[link]: radius for link, radius in guest.radii.items() if link not in places}
    ignore = (*host.ignore, *((names[a], names[b]) for a, b in guest.ignore))
    return replace(host, radii={**radii, **host.radii}, shapes=shapes, visuals=visuals, ignore=ignore)
