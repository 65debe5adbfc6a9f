"""What stands on the floor, the part on it, the tool above: how low the tip comes, and how high the bed is."""

from __future__ import annotations

from itertools import product
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, TOOL_COLOUR, Body, Colour, Part
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import BASE_LINK
from chainbuild.chain.poses import link_placements
from chainbuild.drawing.machine_tools.tables import PART_HEIGHT, part_on
from chainbuild.drawing.site import Site, upright_frame

_LEAST_ROOM: Final = 0.02  # m: below a tip that comes lower over the bed there is no part
_DROP: Final = 0.09  # of the machine's extent: bed below the lowest tip where the data put the workpiece elsewhere
_TOOL: Final = 0.35  # of the way from the tip to what carries it, where the data name no tool length
_SLIM: Final = 0.4  # radius of the tool over that of the spindle
_SHORT: Final = 1e-6  # m: shorter spindles cannot be seen


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
    zero, size = float(site.T_workpiece[2, 3]), extent_of(site)
    return zero if _LEAST_ROOM <= lowest - zero <= size else lowest - _DROP * size


def extent_of(site: Site) -> float:
    """Return the size of a machine or its longest stroke [m], whichever is longer."""
    driven = [axis.name for axis in site.chain.axes]
    slides = [joint for joint in site.tool_path if joint.kind == "prismatic" and joint.name in driven]
    return max([site.size, *(high - low for low, high in map(site.stroke, slides))])


def part_block(site: Site, link: str, top: ArrayLike, width: float, room: float, R: Matrix | None = None) -> list[Body]:
    """Return the part: what the overlay says, else a block; none where less than 20 mm are left.

    Args:
        site: The machine.
        link: Link that carries it.
        top: Where it stands (3,).
        width: Its width [m].
        room: Height [m] that the tool leaves above the table.
        R: (3, 3) axes of a table that is not level; None: the site's.
    """
    return part_on(site, link, np.asarray(top, dtype=float), width, min(PART_HEIGHT * room, width), R)


def tool_bodies(site: Site, carrier: ArrayLike, radius: float) -> list[Body]:
    """Return the tool, which ends at the tip, and the spindle that holds it.

    The tool begins at the flange; where that is the tip, on the way from there to what carries the spindle.

    Args:
        site: The machine.
        carrier: Where what carries the spindle ends (3,).
        radius: Of the spindle [m]; the tool is slimmer.
    """
    link, end = site.chain.frame("tool").link, np.asarray(carrier, dtype=float)
    flange = site.frame("flange")[:3, 3]
    start = flange if np.linalg.norm(flange - site.tip) > _SHORT else site.tip + _TOOL * (end - site.tip)
    tool = site.cylinder(link, "tool", start, site.tip, _SLIM * radius, colour=TOOL_COLOUR, origin="data")
    if np.linalg.norm(end - start) < _SHORT:
        return [tool]
    return [tool, site.cylinder(link, "spindle", start, end, radius, colour=JOINT_COLOUR)]


def level_box(
    site: Site, link: str, part: Part, ends: tuple[Vector, Vector], half: float, heights: tuple[float, float], *,
    colour: Colour | None = None,
) -> Body:  # fmt: skip
    """Return a box over the line between two places (3,), seen from above.

    Args:
        site: The machine.
        link: Link that carries it.
        part: What it stands for.
        ends: Where it begins and ends; their heights do not matter.
        half: Half its width [m].
        heights: z of its underside and of its top [m].
        colour: None: the link's.
    """
    start, along = ends[0], ends[1] - ends[0]
    length = float(np.hypot(along[0], along[1]))
    if length < _SHORT:  # no way to go: a block about the place
        at = np.array([start[0], start[1], 0.0])
        return site.box(link, part, (-half, -half, heights[0]), (half, half, heights[1]), at=at, colour=colour)
    d = np.array([along[0], along[1], 0.0]) / length
    at = np.array([start[0], start[1], 0.0])
    return site.box(
        link, part, (0.0, -half, heights[0]), (length, half, heights[1]), upright_frame(d), at, colour=colour
    )
