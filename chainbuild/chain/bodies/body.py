"""A body of a drawing: a box, a cylinder, a ball or a mesh fixed to a link, and where its measures come from."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from chainbuild import frames
from chainbuild.arrays import Matrix, Vector
from chainbuild.meshes import Triangles
from chainbuild.shown import fields_shown

Colour = tuple[float, float, float]
BodyKind = Literal["cylinder", "box", "sphere", "mesh"]
Part = Literal[
    "link", "joint", "rail", "lever", "flange", "tool", "table",
    "foot", "arm", "yoke", "neck", "spindle", "ram", "guide", "slide", "bridge", "beam", "post", "column", "bed",
    "plate", "housing", "cradle", "cheek", "pedestal", "workpiece", "rod", "carriage", "platform",
]  # fmt: skip
Origin = Literal["data", "drawn"]

# Red, green, blue in 0…1. Warm: what carries the tool. Cool: what carries the workpiece.
BASE_COLOUR: Final[Colour] = (0.29, 0.32, 0.37)
JOINT_COLOUR: Final[Colour] = (0.20, 0.22, 0.26)
TOOL_COLOUR: Final[Colour] = (0.70, 0.73, 0.78)
PART_COLOUR: Final[Colour] = (0.80, 0.74, 0.58)
TOOL_SIDE: Final[tuple[Colour, Colour]] = ((0.95, 0.52, 0.13), (0.98, 0.69, 0.33))
WORKPIECE_SIDE: Final[tuple[Colour, Colour]] = ((0.10, 0.55, 0.55), (0.33, 0.71, 0.69))


@dataclass(frozen=True, slots=True, eq=False)
class Body:
    """A primitive or a mesh fixed to a link.

    Attributes:
        link: Name of the link that carries it.
        part: What it stands for; "link" for the one body that every link of the skeleton has.
        T_link_body: (4, 4) placement of its centre [m].
        kind: "cylinder" (along its z), "box", "sphere" or "mesh".
        dimensions: (radius, length), (x, y, z) or (radius,) [m]; of a mesh: edges of the box around it.
        colour: Red, green, blue in 0…1.
        origin: "data": it lies where machine data or the overlay put it; "drawn": a rule assumes it to show how
            the machine is built.
        surface: Of a mesh: its triangles, about the middle of the box around it.
    """

    __repr__ = fields_shown

    link: str
    part: Part
    T_link_body: Matrix
    kind: BodyKind
    dimensions: tuple[float, ...]
    colour: Colour
    origin: Origin = "drawn"
    surface: Triangles | None = None


def mesh_body(link: str, T: Matrix, surface: Triangles, colour: Colour) -> Body:
    """Return a mesh that a link carries.

    Args:
        link: The link.
        T: (4, 4) placement of the mesh in it [m].
        surface: The mesh.
        colour: Its colour.
    """
    low, high = surface.points.min(axis=0), surface.points.max(axis=0)
    middle = (low + high) / 2
    centred = Triangles(surface.points - middle, surface.corners)
    place = T @ frames.translation(*middle.tolist())
    return Body(link, "link", place, "mesh", tuple((high - low).tolist()), colour, "data", centred)


def rounded_body(
    link: str, part: Part, T: Matrix, kind: BodyKind, size: tuple[float, ...], colour: Colour, origin: Origin = "drawn"
) -> Body:
    """Return a body with its measures rounded to micrometres.

    That is enough for a drawing, and keeps written files free of the last bit of a square root; nanometres first, or
    half of a length given to the micrometre would fall with its last bit.
    """
    return Body(link, part, T, kind, tuple(round(round(s, 9), 6) for s in size), colour, origin)


def along(direction: Vector, centre: Vector | None = None) -> Matrix:
    """Return a frame whose z points along a direction other than zero, with its origin at `centre`."""
    z = frames.unit(direction)
    helper = np.eye(3)[int(np.argmin(np.abs(z.round(9))))]
    x = frames.unit(np.cross(helper, z))
    return frames.transform(np.column_stack([x, np.cross(z, x), z]), np.zeros(3) if centre is None else centre)


def by_link(bodies: Iterable[Body]) -> dict[str, list[Body]]:
    """Return bodies by the links that carry them, those of links without any left out."""
    found: dict[str, list[Body]] = {}
    for body in bodies:
        found.setdefault(body.link, []).append(body)
    return found
