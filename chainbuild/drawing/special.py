"""Machines with a rule of their own: lathes, the eccentric disc, the SCARA, the lever on a slide."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, Body, Part
from chainbuild.chain.elements import BASE_LINK
from chainbuild.drawing.builds.bed import bed_height, level_box, part_block, tips, tool_bodies
from chainbuild.drawing.builds.lathes import disc_bodies, lathe_bodies
from chainbuild.drawing.site import UP, Site

_PART: Final = 0.2  # width of the part over the reach
# Of a SCARA, in half the width of its arms.
_ARM: Final = 0.16  # this half width itself, over the length of the shorter arm
_ARM_HEIGHT: Final = 2.0  # of an arm: as high as wide
_SHOULDER: Final = 1.2  # radius of the column and of the arms' hubs
_QUILL: Final = 0.4  # radius of the quill
_SPINDLE: Final = 0.5  # radius of what turns below it
_MOTOR: Final = (0.7, 1.2)  # radius and height of the motor over the elbow
_FOOT: Final = 2.2  # half the width of the foot
# Of a lever on a slide, in half the section of the lever.
_LEVER: Final = 0.05  # this half section itself, over the length
_PIN: Final = 1.6  # radius of the pin
_FORK: Final = (1.2, 2.4)  # from the middle of the fork to the inside and outside of its cheeks
_CHEEK: Final = 2.0  # half the depth of a cheek, and how far it stands above the pin
_DECK: Final = 3.0  # half the width of the slide
_BED: Final = 5.0  # half the width of the bed
_TIP: Final = 0.8  # of the length: from there on it is tool
_SLIDE: Final = 0.2  # half the length of the slide over that of the lever
_RAIL: Final = 0.13  # of the room below the tip: height of the guide
_STACK: Final = 0.45  # likewise: height of guide and slide, over which the tip passes


def special_bodies(site: Site) -> list[Body]:
    """Return the bodies of a machine with a rule of its own."""
    if site.workpiece_path:
        return lathe_bodies(site)
    if site.tool_path[0].kind == "revolute":
        return _scara(site)
    return _lever(site) if site.tool_path[1].kind == "revolute" else disc_bodies(site)


def _scara(site: Site) -> list[Body]:
    """Return column, two arms and the quill of a SCARA; the arms are above all that the quill lifts."""
    shoulder, elbow, quill, wrist = site.tool_path
    a, b, c = (site.links[joint.child][:3, 3] for joint in (shoulder, elbow, wrist))
    lengths = [float(np.hypot(*(far - near)[:2])) for near, far in ((a, b), (b, c))]
    w, reach = site.radius(shoulder.child, _ARM * min(lengths)), sum(lengths)
    height, (low, high) = _ARM_HEIGHT * w, site.stroke(quill)
    first = float(c[2]) + high + w
    second, over = first + height, first + 2 * height
    lowest = float(tips(site)[:, 2].min())
    bed = bed_height(site, lowest)
    x, y = a[:2]
    foot, motor = _FOOT * w, (b, over, over + _MOTOR[1] * w)
    table = (x - 2 * foot, y - 0.6 * reach, bed - w), (x + reach + foot, y + 0.6 * reach, bed)
    return [
        site.box(BASE_LINK, "bed", *table),
        site.box(BASE_LINK, "foot", (x - foot, y - foot, bed), (x + foot, y + foot, bed + w)),
        _upright(site, BASE_LINK, "column", (a, bed + w, first), _SHOULDER * w),
        *_level_arm(site, shoulder.child, (a, b), (first, second), w),
        *_level_arm(site, elbow.child, (b, c), (second, over), w),
        _upright(site, elbow.child, "housing", motor, _MOTOR[0] * w),
        _upright(site, quill.child, "ram", (c, float(c[2]), over - low + w), _QUILL * w),
        *tool_bodies(site, c, _SPINDLE * w),
        *part_block(site, BASE_LINK, (*site.tip[:2], bed), _PART * reach, lowest - bed),
    ]


def _upright(site: Site, link: str, part: Part, place: tuple[Vector, float, float], radius: float) -> Body:
    """Return a cylinder at a place (3,), seen from above, between two heights [m]."""
    (x, y, _), low, high = place
    colour = JOINT_COLOUR if part == "ram" else None
    return site.cylinder(link, part, (x, y, low), (x, y, high), radius, colour=colour)


def _level_arm(
    site: Site, link: str, ends: tuple[Vector, Vector], heights: tuple[float, float], w: float
) -> list[Body]:
    """Return a level arm with round ends from one upright axis to the next."""
    return [
        level_box(site, link, "arm", ends, w, heights),
        _upright(site, link, "joint", (ends[0], *heights), _SHOULDER * w),
        _upright(site, link, "joint", (ends[1], *heights), w),
    ]


def _lever(site: Site) -> list[Body]:
    """Return a slide with a forked tower, and the lever that swings in the fork."""
    slide, joint = site.tool_path
    pivot, way = site.origin(joint), site.tip - site.origin(joint)
    length = float(np.linalg.norm(way))
    w = site.radius(joint.child, _LEVER * length)
    lowest = float(tips(site)[:, 2].min())
    bed = bed_height(site, lowest)
    along, d = way / length, site.direction(slide)
    (low, high), back = site.stroke(slide), np.cross(UP, d)
    if along @ d < 0.0:  # an arm that points backwards: all as in a mirror
        low, high, d = -high, -low, -d
    R, half, width = np.column_stack([d, back, UP]), _SLIDE * length, _PART * length
    floor, wide, end = bed - float(pivot[2]), _FORK[1] * w, high + half + 1.4 * width
    rail, deck, head = floor + _RAIL * (lowest - bed), floor + _STACK * (lowest - bed), _CHEEK * w

    def box(link: str, part: Part, x: tuple[float, float], y: tuple[float, float], z: tuple[float, float]) -> Body:
        low, high = zip(x, y, z, strict=True)
        return site.box(link, part, low, high, R, pivot, colour=JOINT_COLOUR if part == "guide" else None)

    tower = -_CHEEK * w, _CHEEK * w
    bar = np.column_stack([along, back, np.cross(along, back)])
    place = pivot + R @ (high + half + 0.7 * width, 0.0, floor)
    return [
        site.box(joint.child, "lever", (0.0, -w, -w), (_TIP * length, w, w), bar, pivot, origin="data"),
        site.cylinder(joint.child, "joint", pivot - wide * back, pivot + wide * back, _PIN * w, colour=JOINT_COLOUR),
        *tool_bodies(site, pivot + _TIP * way, 0.7 * w),
        box(slide.child, "cheek", tower, (-wide, -_FORK[0] * w), (deck, head)),
        box(slide.child, "cheek", tower, (_FORK[0] * w, wide), (deck, head)),
        box(slide.child, "carriage", (-half, half), (-_DECK * w, _DECK * w), (rail, deck)),
        box(BASE_LINK, "guide", (low - half, high + half), (-wide, wide), (floor, rail)),
        box(BASE_LINK, "bed", (low - half - w, end), (-_BED * w, _BED * w), (floor - w, floor)),
        *part_block(site, BASE_LINK, place, width, lowest - bed),
    ]
