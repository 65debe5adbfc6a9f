"""What stands on the floor: how low the tip comes, how high the bed is, and the part on it."""

from __future__ import annotations

from itertools import product
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, PART_COLOUR, TOOL_COLOUR, Body
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import BASE_LINK
from chainbuild.chain.poses import link_placements
from chainbuild.drawing.site import Site

_LEAST_ROOM: Final = 0.02  # m: below a tip that comes lower over the bed there is no part
_DROP: Final = 0.09  # of the machine's extent: bed below the lowest tip where the data put the workpiece elsewhere
_PART_HEIGHT: Final = 0.6  # of the room below the lowest tip: no position touches the part
_TOOL: Final = 0.35  # of the way from the tip to what carries it, where the data name no tool length
_SHORT: Final = 1e-6  # m: shorter tools cannot be seen


def tips(site: Site, name: str = "tool") -> Matrix:
    """Return where the tip gets (n, 3): each axis of the tool at its lower end, at home, at its upper end.

    What the closed loops do not reach is left out; home is always there.

    Args:
        site: The machine.
        name: Frame that is looked at.
    """
    chain, frame = site.chain, site.chain.frame(name)
    low, high = shown_limits(chain)
    choices = [
        (home, a, b) if axis.carries == "tool" else (home,)
        for axis, home, a, b in zip(chain.axes, site.home, low, high, strict=True)
    ]
    found: list[Vector] = []
    for axes in product(*choices):
        q = chain.axis_map.q(np.array(axes))
        if np.isfinite(q).all():
            T = site.links[BASE_LINK] @ link_placements(chain, q)[frame.link] @ frame.T_link_frame
            found.append(T[:3, 3])
    return np.array(found)


def bed_height(site: Site, lowest: float) -> float:
    """Return the z of the bed's top: the workpiece's zero where that is below every tip, else a little below them.

    Args:
        site: The machine.
        lowest: z of the lowest tip [m].
    """
    zero = float(site.T_workpiece[2, 3])
    size = extent_of(site)
    return zero if _LEAST_ROOM <= lowest - zero <= size else lowest - _DROP * size


def extent_of(site: Site) -> float:
    """Return the size of a machine or its longest stroke [m], whichever is longer."""
    slides = [joint for joint in site.tool_path if joint.kind == "prismatic"]
    return max(site.size, *(float(np.diff(site.stroke(joint))[0]) for joint in slides), 0.0)


def part_block(site: Site, link: str, top: ArrayLike, width: float, room: float) -> list[Body]:
    """Return the part: a block that stands in the middle of a table or bed; none where less than 20 mm are left.

    Args:
        site: The machine.
        link: Link that carries it.
        top: Where it stands (3,).
        width: Its width [m].
        room: Height [m] that the tool leaves above the table.
    """
    if room < _LEAST_ROOM:
        return []
    x, y, z = np.asarray(top, dtype=float).tolist()
    half, height = width / 2.0, min(_PART_HEIGHT * room, width)
    block = site.box(link, "workpiece", (x - half, y - half, z), (x + half, y + half, z + height), colour=PART_COLOUR)
    return [block]


def tool_start(site: Site, carrier: ArrayLike) -> Vector:
    """Return where the tool begins: at the flange, or on the way from the tip to what carries it where they coincide.

    Args:
        site: The machine.
        carrier: Where what carries the tool ends (3,).
    """
    flange = site.frame("flange")[:3, 3]
    if np.linalg.norm(flange - site.tip) > _SHORT:
        return np.asarray(flange)
    return np.asarray(site.tip + _TOOL * (np.asarray(carrier, dtype=float) - site.tip))


def tool_bodies(site: Site, carrier: ArrayLike, radius: float) -> list[Body]:
    """Return the tool, which ends at the tip, and the spindle that holds it.

    Args:
        site: The machine.
        carrier: Where what carries the spindle ends (3,).
        radius: Of the spindle [m]; the tool is slimmer.
    """
    link, start = site.chain.frame("tool").link, tool_start(site, carrier)
    bodies = []
    if np.linalg.norm(start - site.tip) > _SHORT:
        bodies.append(site.cylinder(link, "tool", start, site.tip, 0.4 * radius, colour=TOOL_COLOUR, origin="data"))
    if np.linalg.norm(np.asarray(carrier) - start) > _SHORT:
        bodies.append(site.cylinder(link, "spindle", start, carrier, radius, colour=JOINT_COLOUR))
    return bodies


def lowest_point(site: Site, bodies: list[Body]) -> float:
    """Return the z [m] of the lowest point of bodies at home."""
    return min(_lowest(site.links[body.link] @ body.T_link_body, body) for body in bodies)


def _lowest(T: Matrix, body: Body) -> float:
    size, up = np.array(body.dimensions), T[2, :3]
    if body.kind == "box":
        half = float(np.abs(up) @ size) / 2.0
    elif body.kind == "sphere":
        half = float(size[0])
    else:
        half = float(size[0] * np.hypot(up[0], up[1]) + abs(up[2]) * size[1] / 2.0)
    return float(T[2, 3]) - half
