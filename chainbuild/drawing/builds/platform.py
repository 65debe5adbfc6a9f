"""What rods hold: the platform with its spindle, or a table; and a bridge with the tool above that."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, TOOL_SIDE, WORKPIECE_SIDE, Body
from chainbuild.chain.elements import BASE_LINK
from chainbuild.drawing.builds.bed import level_box, part_block, tool_bodies
from chainbuild.drawing.builds.struts import Arm
from chainbuild.drawing.site import Site, upright_frame

# In radii of a rod.
_SUNK: Final = 0.8  # from the middle of the balls to where a platform begins
_PLATE: Final = 2.2  # thickness of a platform
_EDGE: Final = 1.5  # how far it reaches over the pins
_HUB: Final = 0.62  # over the radius of the pins: between the arms to them the tool is seen
_NECK: Final = 3.0  # radius of the spindle at most
_LINK: Final = 0.5  # radius of the links that guide a table
_KNEE: Final = 0.7  # of the ball between them: clear of the table
_POST: Final = 2.0  # of the post on which they stand

_SPINDLE: Final = 0.5  # of the radius of the pins: radius of the spindle and of its motor
_MOTOR: Final = 0.9  # likewise: how high the motor stands on the platform
_PART: Final = 0.7  # part over radius of the table: room for clamps
# In the radius of a spindle that hangs on a bridge.
_RAM: Final = 0.055  # this radius itself, over the machine's size
_HEAD: Final = 4.0  # height of the head around it
_HALF: Final = 1.3  # half the width of head and beam, width of rails and posts
_NOSE: Final = 2.5  # how far the tip is below the head at least
_BEAM: Final = 2.0  # height of the beam


def tool_platform(site: Site, platform: str, arms: list[Arm]) -> list[Body]:
    """Return a platform that carries the tool; beside its middle, the spindle hangs on a bracket."""
    r, middle, tip = arms[0].radius, site.links[platform][:3, 3], site.tip
    reach = float(np.hypot(*(arms[0].end - middle)[:2]))
    top = float(arms[0].end[2]) - _SUNK * r
    under, radius = top - _PLATE * r, min(_SPINDLE * reach, _NECK * r)
    colour = TOOL_SIDE[0]
    low, high = (*middle[:2], under), (*middle[:2], top)
    edge, heights = _EDGE * r, (under, top)
    arms_to_pins = [
        level_box(site, platform, "lever", (middle, _beyond(middle, arm.end, edge)), edge, heights, colour=colour)
        for arm in arms
    ]
    bodies = [
        site.cylinder(platform, "platform", low, high, _HUB * reach, colour=colour),
        *arms_to_pins,
        *tool_bodies(site, (*tip[:2], under), radius),
    ]
    if np.hypot(*(tip - middle)[:2]) > reach:
        bodies.append(level_box(site, platform, "arm", (middle, tip), radius, (under, top), colour=colour))
    if arms[0].joint.kind == "prismatic":
        motor = (*middle[:2], top + _MOTOR * reach)
        bodies.append(site.cylinder(platform, "housing", high, motor, _SPINDLE * reach, colour=JOINT_COLOUR))
    return bodies


def _beyond(start: Vector, end: Vector, by: float) -> Vector:
    """Return the point (3,) that lies some way [m] behind the end of a level line."""
    along = (end - start) * (1.0, 1.0, 0.0)
    beyond: Vector = end + along * (by / float(np.linalg.norm(along)))
    return beyond


def table_platform(site: Site, platform: str, arms: list[Arm]) -> list[Body]:
    """Return a platform that is a table, with the part on it; at home it may be tilted."""
    r, T = arms[0].radius, site.T_workpiece
    R, place = T[:3, :3], T[:3, 3]
    x, y, z = R.T @ (arms[0].end - place)
    reach, under = float(np.hypot(x, y)), float(z) + _SUNK * r
    top = max(0.0, under + _PLATE * r)
    low, high = place + under * R[:, 2], place + top * R[:, 2]
    room = float(site.tip[2] - high[2])
    return [
        site.cylinder(platform, "table", low, high, reach + _EDGE * r, colour=WORKPIECE_SIDE[0]),
        *part_block(site, platform, high, _PART * reach, room, R),
    ]


def table_guide(site: Site, arms: list[Arm], floor: float) -> list[Body]:
    """Return the links that keep a table from turning, and the post from which they start; none on most machines.

    Args:
        site: The machine.
        arms: The arms that move the table.
        floor: z of the floor [m].
    """
    chain, r = site.chain, arms[0].radius
    platform = chain.frame("workpiece").link
    ends = {name for loop in chain.loops for name in (loop.frame_a, loop.frame_b)}
    held = {platform, *(arm.rod for arm in arms)}
    bodies = []
    for frame in chain.frames:
        if frame.name not in ends or frame.link in held:
            continue
        start, end = site.links[frame.link][:3, 3], site.frame(frame.name)[:3, 3]
        colour = WORKPIECE_SIDE[1]
        bodies.append(site.cylinder(frame.link, "lever", start, end, _LINK * r, colour=colour, origin="data"))
        bodies.append(site.ball(frame.link, "joint", end, _KNEE * r, colour=JOINT_COLOUR))
        post = site.path_to(frame.link)[-1].parent
        if post != platform:
            bodies.append(site.cylinder(post, "post", (*start[:2], floor), start, _POST * r, colour=WORKPIECE_SIDE[0]))
    return bodies


def bridge_bodies(site: Site, floor: float, clear: float) -> list[Body]:
    """Return a bridge on posts that carries the tool on two crossed slides, and the bed on which it stands.

    Args:
        site: The machine.
        floor: z of the floor [m].
        clear: How far from the middle the posts must stand at least [m].
    """
    first, second = site.tool_path[:2]
    r, R = _RAM * site.size, upright_frame(site.direction(first))
    wide = _HALF * r
    x, y = (float(value) for value in (R.T @ site.tip)[:2])
    (x_low, x_high), (y_low, y_high) = site.stroke(first), site.stroke(second)
    under = max(float(site.links[second.child][2, 3]), float(site.tip[2]) + _NOSE * r)
    left, right = min(x + x_low - 4 * wide, -clear), max(x + x_high + 2 * wide, clear)
    front, back = min(y + y_low - 2 * wide, -clear), max(y + y_high + 2 * wide, clear)
    beam = (x - 3 * wide, front, under), (x - wide, back, under + _BEAM * r)
    bodies = [
        *tool_bodies(site, (*site.tip[:2], under), r / 2),
        site.box(second.child, "slide", (x - wide, y - wide, under), (x + wide, y + wide, under + _HEAD * r), R),
        site.box(first.child, "bridge", *beam, R),
        site.box(BASE_LINK, "bed", (left, front - wide, floor - r), (right, back + wide, floor), R),
    ]
    for inner, outer in ((front, front - wide), (back, back + wide)):
        rail = (left, inner, under - r), (right, outer, under)
        bodies.append(site.box(BASE_LINK, "guide", *rail, R, colour=JOINT_COLOUR))
        for a, b in ((left, left + wide), (right - wide, right)):
            bodies.append(site.box(BASE_LINK, "post", (a, inner, floor), (b, outer, under - r), R))
    return bodies
