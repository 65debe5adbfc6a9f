"""A ram on a cross slide before a column: lathes, upright as up is the z of their spindle, and the eccentric disc."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, PART_COLOUR, Body
from chainbuild.chain.elements import BASE_LINK
from chainbuild.drawing.builds.bed import bed_height, extent_of, part_block, tips, tool_bodies
from chainbuild.drawing.site import UP, Site, upright_frame
from chainbuild.frames import rot_z
from chainbuild.shown import fields_shown

_SPINDLE: Final = 0.06  # of the machine's extent: radius of the spindle or turret in the head
_TURNING: Final = 0.015  # m: a level tool that stays as far from the workpiece's axis turns it from outside
_OUTSIDE: Final = 0.6  # of that way: radius of the part, so that no position touches it
_FACE: Final = 0.4  # of the largest way from the axis: radius of a part that is worked on from above
_GAP: Final = 0.01  # m: between the lowest tip or turret and what is below it
_SLENDER: Final = 9.0  # length over radius of a turned part: longer ones need a tailstock
_CHUCK: Final = 1.9  # radius of the chuck over that of the part, and over that of the spindle at least
_JAW: Final = 0.25  # width and height of a jaw over the radius of the chuck
_JAWS: Final = 3  # as most chucks have
_HEADSTOCK: Final = 1.1  # half the width of the headstock, and its height, over the radius of the chuck
_DISC: Final = 1.35  # radius of an eccentric disc over how far off its middle the tool sits
_TURRET: Final = 0.45  # radius of a turret over the way to the tip, at most
# In radii of the spindle.
_RAM: Final = 1.3  # half the section of the ram
_NOSE: Final = 2.5  # from the tip to the ram at least
_SADDLE: Final = 4.0  # height of the saddle
_RAIL: Final = 0.8  # depth of the guide
_COLUMN: Final = 3.0  # depth of the column
_BED: Final = 1.5  # height of the bed


@dataclass(frozen=True, slots=True, eq=False)
class _Below:
    """What stands below the tool.

    Attributes:
        floor: z of the floor [m].
        middle: Its middle (3,).
        half: Half its width [m].
    """

    __repr__ = fields_shown

    floor: float
    middle: Vector
    half: float


def lathe_bodies(site: Site) -> list[Body]:
    """Return an upright lathe: headstock with chuck and part, and the tool on a ram before a column."""
    r = _SPINDLE * extent_of(site)
    head, foot = _head(site, r)
    hangs = float(site.tip[2]) - min(float(site.bounds(body)[0, 2]) for body in head)
    stock, below = _headstock(site, float(tips(site)[:, 2].min()) - hangs, r)
    return [*head, *_ram(site, foot, float(foot[2]), r, below), *stock]


def disc_bodies(site: Site) -> list[Body]:
    """Return an eccentric disc on a ram before a column, and the part on the bed."""
    r, joint = _SPINDLE * extent_of(site), site.tool_path[-1]
    flange, centre, away = site.frame("flange")[:3, 3], site.origin(joint), site.direction(joint)
    back = centre + r * away
    radius = max(_DISC * float(np.linalg.norm(flange - centre)), 2.0 * r)
    upright = abs(float(away[2])) > 0.5
    foot = back if upright else back + _RAM * r * (away - UP)
    lowest = float(tips(site)[:, 2].min())
    bed = bed_height(site, lowest if upright else min(lowest, float(centre[2]) + _drop(site) - radius))
    place = np.array([*site.tip[:2], bed])
    return [
        site.cylinder(joint.child, "plate", centre, back, radius),
        *tool_bodies(site, flange + r * away, r),
        *_ram(site, foot, float(foot[2] if upright else centre[2] + radius), r, _Below(bed, centre, radius)),
        *part_block(site, BASE_LINK, place, 2.0 * r, lowest - bed),
    ]


def _drop(site: Site) -> float:
    """Return how far the second slide moves down from home, negative [m]."""
    joint = site.tool_path[1]
    return min(float(site.direction(joint)[2]) * end for end in site.stroke(joint))


def _head(site: Site, r: float) -> tuple[list[Body], Vector]:
    """Return spindle or turret with the tool, and the middle of the ram's underside above it."""
    last, tip = site.tool_path[-1], site.tip
    if last.kind == "prismatic":
        x, y, _ = site.frame("flange")[:3, 3]
        foot = np.array([x, y, max(float(site.links[last.child][2, 3]), float(tip[2]) + _NOSE * r)])
        return tool_bodies(site, foot, r), foot
    axis = site.links[last.child][:3, 3]
    way = float(np.linalg.norm((tip - axis)[:2]))
    half = min(r, _TURRET * way)
    x, y, z = axis[0], axis[1], tip[2]
    foot = np.array([x, y, z + half])
    turret = site.cylinder(last.child, "housing", (x, y, z - half), foot, 1.2 * half)
    return [turret, *tool_bodies(site, (x, y, z), 0.6 * half)], foot


def _headstock(site: Site, low: float, r: float) -> tuple[list[Body], _Below]:
    """Return part, chuck and headstock below a height [m] that tool and turret never leave downwards."""
    joint = site.workpiece_path[-1]
    x, y, _ = site.origin(joint)
    places = tips(site)
    ways = _ways(places[:, :2], tips(site, "flange")[:, :2], np.array([x, y]))
    turned = site.tool_path[-1].kind == "revolute" and bool(ways.min() > _TURNING)
    radius = float(_OUTSIDE * ways.min() if turned else _FACE * ways.max())
    chuck = _CHUCK * max(radius, r)
    jaw, wide = _JAW * chuck, _HEADSTOCK * chuck
    face = low - _GAP - (jaw if turned else radius)
    top = face + min(_SLENDER * radius, float(np.ptp(places[:, 2])) + 2.0 * radius) if turned else low - _GAP
    under = face - 0.5 * chuck
    floor = under - wide
    link = joint.child
    bodies = [
        site.cylinder(link, "workpiece", (x, y, face), (x, y, top), radius, colour=PART_COLOUR),
        site.cylinder(link, "table", (x, y, under), (x, y, face), chuck),
        site.box(BASE_LINK, "housing", (x - wide, y - wide, floor), (x + wide, y + wide, under)),
    ]
    for n in range(_JAWS):
        R = rot_z(360.0 * n / _JAWS)
        a, b, _ = R.T @ (x, y, 0.0)
        inner, outer = (a + radius, b - 0.5 * jaw, face), (a + 0.95 * chuck, b + 0.5 * jaw, face + jaw)
        bodies.append(site.box(link, "cheek", inner, outer, R, colour=JOINT_COLOUR))
    return bodies, _Below(floor, np.array([x, y, floor]), wide)


def _ways(tip: Matrix, flange: Matrix, axis: Matrix) -> Matrix:
    """Return how near (n,) tools from a flange to a tip (n, 2) come to an upright axis, seen from above [m]."""
    along, away = tip - flange, axis - flange
    square = np.maximum((along**2).sum(axis=1), 1e-12)
    share = np.clip((along * away).sum(axis=1) / square, 0.0, 1.0)
    return np.asarray(np.linalg.norm(away - share[:, None] * along, axis=1))


def _ram(site: Site, foot: Vector, over: float, r: float, below: _Below) -> list[Body]:
    """Return the ram, the saddle that holds it, and the column behind with its guide and bed.

    Args:
        site: The machine.
        foot: Middle of the ram's underside (3,).
        over: z at home of what moves with the ram and stays below the saddle [m].
        r: Radius of the spindle [m].
        below: What the column stands behind.
    """
    cross, slide = site.tool_path[:2]
    R = upright_frame(site.direction(cross))
    x, y, z = R.T @ foot
    middle, half = R.T @ below.middle, _RAM * r
    rises = [float(site.direction(slide)[2]) * end for end in site.stroke(slide)]
    low, high = over + max(rises) + 0.5 * r, over + max(rises) + (0.5 + _SADDLE) * r
    face = max(y + half + (1.5 + _RAIL) * r, middle[1] + below.half + _GAP)
    wide = 1.8 * half
    near, far = site.stroke(cross)
    left, right = x + near - wide, x + far + wide
    rail, back = face - _RAIL * r, face + _COLUMN * r
    edges = min(left, middle[0] - below.half) - r, max(right, middle[0] + below.half) + r
    front = middle[1] - below.half - r
    return [
        site.box(slide.child, "ram", (x - half, y - half, z), (x + half, y + half, high - min(rises) + r), R),
        site.box(cross.child, "slide", (x - wide, y + half, low), (x + wide, rail, high), R),
        site.box(BASE_LINK, "guide", (left, rail, low + r), (right, face, high - r), R, colour=JOINT_COLOUR),
        site.box(BASE_LINK, "column", (left, face, below.floor), (right, back, high), R),
        site.box(BASE_LINK, "bed", (edges[0], front, below.floor - _BED * r), (edges[1], back, below.floor), R),
    ]
