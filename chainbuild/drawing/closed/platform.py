"""What rods hold: the platform with its spindle, or a table; and a bridge with the tool above that."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.chain.bodies.body import JOINT_COLOUR, TOOL_SIDE, WORKPIECE_SIDE, Body
from chainbuild.chain.elements import BASE_LINK
from chainbuild.drawing.bed import part_block, tool_bodies
from chainbuild.drawing.closed.struts import Arm
from chainbuild.drawing.site import Site

_SUNK: Final = 0.8  # radii of a rod: how far below the middle of the balls a platform begins
_PLATE: Final = 2.2  # likewise: its thickness
_EDGE: Final = 1.5  # likewise: how far it reaches over the pins
_SPINDLE: Final = 0.5  # of the radius of the pins
_MOTOR: Final = 0.9  # likewise: how high the spindle's motor stands on the platform
_PART: Final = 0.7  # part over radius of the table: room for clamps
_RAM: Final = 0.055  # of the machine's size: radius of the spindle that hangs on a bridge
_HEAD: Final = 4.0  # radii of that spindle: height of the head around it
_NOSE: Final = 2.5  # likewise: how far the tip is below the head at least


def tool_platform(site: Site, platform: str, arms: list[Arm]) -> list[Body]:
    """Return a platform that carries the tool."""
    r = arms[0].radius
    pins = np.array([arm.end for arm in arms])
    middle = site.links[platform][:2, 3]
    reach = max(float(np.linalg.norm(pin[:2] - middle)) for pin in pins)
    top = float(pins[:, 2].min()) - _SUNK * r
    under = top - _PLATE * r
    colour = TOOL_SIDE[0]
    bodies = [
        site.cylinder(platform, "platform", (*middle, under), (*middle, top), reach + _EDGE * r, colour=colour),
        *tool_bodies(site, (*site.tip[:2], under), min(_SPINDLE * reach, 3.0 * r)),
    ]
    motor = (*middle, top), (*middle, top + _MOTOR * reach)
    if arms[0].joint.kind == "prismatic":
        bodies.append(site.cylinder(platform, "housing", *motor, _SPINDLE * reach, colour=JOINT_COLOUR))
    return bodies


def table_platform(site: Site, platform: str, arms: list[Arm]) -> list[Body]:
    """Return a platform that is a table, with the part on it."""
    r, T = arms[0].radius, site.T_workpiece
    pins = np.array([arm.end for arm in arms])
    reach = max(float(np.linalg.norm(pin - site.links[platform][:3, 3])) for pin in pins)
    under = float(pins[:, 2].max()) + _SUNK * r
    top = max(float(T[2, 3]), under + _PLATE * r)
    x, y = T[:2, 3]
    plate = (x, y, under), (x, y, top)
    return [
        site.cylinder(platform, "table", *plate, reach + _EDGE * r, colour=WORKPIECE_SIDE[0]),
        *part_block(site, platform, (x, y, top), _PART * reach, float(site.tip[2]) - top),
    ]


def table_guide(site: Site, arms: list[Arm], floor: float) -> list[Body]:
    """Return the links that keep a table from turning, and the post from which they start; none on most machines.

    Args:
        site: The machine.
        arms: The arms that move the table.
        floor: z of the floor [m].
    """
    chain, r = site.chain, arms[0].radius
    rods = {arm.rod for arm in arms}
    ends = {name for loop in chain.loops for name in (loop.frame_a, loop.frame_b)}
    platform = chain.frame("workpiece").link
    frames = [frame for frame in chain.frames if frame.name in ends and frame.link not in (*rods, platform)]
    bodies = []
    for frame in frames:
        start, end = site.links[frame.link][:3, 3], site.frame(frame.name)[:3, 3]
        bodies.append(site.cylinder(frame.link, "lever", start, end, 0.5 * r, colour=WORKPIECE_SIDE[1], origin="data"))
        bodies.append(site.ball(frame.link, "joint", end, 0.7 * r, colour=JOINT_COLOUR))
        carrier = site.path_to(frame.link)[-1].parent
        if carrier != platform:
            bodies.append(site.cylinder(carrier, "post", (*start[:2], floor), start, 2.0 * r, colour=WORKPIECE_SIDE[0]))
    return bodies


def bridge_bodies(site: Site, floor: float, clear: float) -> list[Body]:
    """Return a bridge on posts that carries the tool on two crossed slides, and the bed on which it stands.

    Args:
        site: The machine.
        floor: z of the floor [m].
        clear: How far from the middle the posts must stand at least [m].
    """
    first, second = site.tool_path[:2]
    r = _RAM * site.size
    d, e = site.direction(first), site.direction(second)
    R = np.column_stack([d, e, np.cross(d, e)])
    x, y = (float(value) for value in (R.T @ site.tip)[:2])
    a, b = (float(value) for value in (R.T @ site.links[BASE_LINK][:3, 3])[:2])
    (x_low, x_high), (y_low, y_high) = site.stroke(first), site.stroke(second)
    wide = 1.3 * r
    under = max(float(site.links[second.child][2, 3]), float(site.tip[2]) + _NOSE * r)
    ends = min(y + y_low - 2.0 * wide, b - clear), max(y + y_high + 2.0 * wide, b + clear)
    rails = min(x + x_low - 4.0 * wide, a - clear), max(x + x_high + 2.0 * wide, a + clear)
    bodies = [
        *tool_bodies(site, (*site.tip[:2], under), 0.6 * r),
        site.box(second.child, "slide", (x - wide, y - wide, under), (x + wide, y + wide, under + _HEAD * r), R),
        site.box(first.child, "bridge", (x - 3.0 * wide, ends[0], under), (x - wide, ends[1], under + 2.0 * r), R),
        site.box(BASE_LINK, "bed", (rails[0], ends[0] - wide, floor - r), (rails[1], ends[1] + wide, floor), R),
    ]
    for end, outer in zip(ends, (ends[0] - wide, ends[1] + wide), strict=True):
        rail = (rails[0], end, under - r), (rails[1], outer, under)
        bodies.append(site.box(BASE_LINK, "guide", *rail, R, colour=JOINT_COLOUR))
        for out, inner in zip(rails, (rails[0] + wide, rails[1] - wide), strict=True):
            bodies.append(site.box(BASE_LINK, "post", (out, end, floor), (inner, outer, under - r), R))
    return bodies
