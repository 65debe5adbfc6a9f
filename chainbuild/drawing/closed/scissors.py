"""Two slides with crossing rods: the lambda kinematic, which moves a ram in a plane.

The data place the rods of a plane in it and say nothing of their height: they are drawn above what hangs from the ram.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, Body, Part
from chainbuild.chain.elements import BASE_LINK, Joint
from chainbuild.drawing.bed import bed_height, part_block, tips, tool_bodies
from chainbuild.drawing.site import UP, Site
from chainbuild.shown import fields_shown

_ROD: Final = 0.022  # radius of a rod over the length of the longest: it carries the ram alone
_PART: Final = 6.0  # radii of a rod: width of the part
# In radii of a rod.
_BALL: Final = 1.5
_ARM: Final = 1.3  # half the section of the arm that carries the ram
_PIVOT: Final = 2.2  # the pivot on a carriage
_CARRIAGE: Final = 3.0  # half its width, and its length over 2
_TOP: Final = -2.0  # top of the carriages, from the middle of the rods
_UNDER: Final = -4.5  # their underside
_GUIDE: Final = -5.5  # underside of the guides, top of the beam
_BEAM: Final = -10.0  # underside of the beam
_HOUSING: Final = 3.0  # half the height of the ram's housing, and how far the ram hangs below it at least
_RAM: Final = 1.8  # half the section of the ram
_LEG: Final = 4.0  # width of the legs beyond the guides, height of the bed


@dataclass(frozen=True, slots=True, eq=False)
class _Slide:
    """A slide with the rod that it swings.

    Attributes:
        joint: The joint of its axis.
        rod: Link of the rod.
        foot: Where the rod is hinged on it at home (3,).
        end: Where the two rods meet (3,).
    """

    __repr__ = fields_shown

    joint: Joint
    rod: str
    foot: Vector
    end: Vector


def scissor_bodies(site: Site) -> list[Body]:
    """Return the bodies of a machine with two slides whose rods meet, and a ram at the end of one."""
    chain = site.chain
    loop = chain.loops[0]
    slides = [_slide(site, name) for name in (loop.frame_a, loop.frame_b)]
    main, other = slides if slides[0].joint in site.tool_path else slides[::-1]
    ram = next(joint for joint in site.tool_path if joint.parent == main.rod)
    r = site.radius(other.rod, _ROD * max(float(np.linalg.norm(slide.end - slide.foot)) for slide in slides))
    lowest = float(tips(site)[:, 2].min())
    bed = bed_height(site, lowest)
    plane = float(site.links[ram.child][2, 3]) + site.stroke(ram)[1] + 2.0 * _HOUSING * r
    return [
        *_rods(site, main, other, site.links[ram.child][:3, 3], plane, r),
        *_ram(site, ram, plane, r),
        *_gantry(site, (main, other), plane, bed, r),
        *part_block(site, BASE_LINK, (*site.tip[:2], bed), _PART * r, lowest - bed),
    ]


def _slide(site: Site, name: str) -> _Slide:
    rod = site.chain.frame(name).link
    path = site.path_to(rod)
    return _Slide(path[0], rod, site.links[path[1].child][:3, 3], site.frame(name)[:3, 3])


def _raised(place: Vector, z: float) -> Vector:
    return np.array([place[0], place[1], z])


def _rods(site: Site, main: _Slide, other: _Slide, carried: Vector, plane: float, r: float) -> list[Body]:
    """Return the arm that carries the ram, the rod that steers it, and their pivots on the carriages."""
    foot, end, ram = (_raised(place, plane) for place in (main.foot, main.end, carried))
    bodies = [
        _beam(site, main.rod, "arm", foot, end, _ARM * r),
        _beam(site, main.rod, "arm", end, ram, _ARM * r),
        site.cylinder(other.rod, "rod", _raised(other.foot, plane), _raised(other.end, plane), r),
        site.ball(other.rod, "joint", _raised(other.end, plane), _BALL * _ARM * r, colour=JOINT_COLOUR),
    ]
    for slide in (main, other):
        pivot = _raised(slide.foot, plane + _TOP * r), _raised(slide.foot, plane + _PIVOT * r)
        bodies.append(site.cylinder(slide.rod, "joint", *pivot, _PIVOT * r, colour=JOINT_COLOUR))
    return bodies


def _beam(site: Site, link: str, part: Part, a: Vector, b: Vector, half: float) -> Body:
    """Return a level beam of square section from one place to another (3,)."""
    length = float(np.linalg.norm(b - a))
    along = (b - a) / length
    R = np.column_stack([along, np.cross(UP, along), UP])
    x, y, z = R.T @ a
    return site.box(link, part, (x, y - half, z - half), (x + length, y + half, z + half), R)


def _ram(site: Site, ram: Joint, plane: float, r: float) -> list[Body]:
    """Return the housing at the end of the arm, the ram through it, and what turns below with the tool."""
    link, place = ram.child, site.links[ram.child][:3, 3]
    half, wide = _HOUSING * r, _HOUSING * r
    x, y, z = place
    top = plane + half - site.stroke(ram)[0] + half
    bodies = [
        site.box(ram.parent, "housing", (x - wide, y - wide, plane - half), (x + wide, y + wide, plane + half)),
        site.box(link, "ram", (x - _RAM * r, y - _RAM * r, z), (x + _RAM * r, y + _RAM * r, top)),
    ]
    tool = site.chain.frame("tool").link
    if tool == link:
        return [*bodies, *tool_bodies(site, place, _RAM * r)]
    tip = site.tip
    under = 0.5 * float(z + tip[2])
    hand = _raised(place, under), _raised(tip, under)
    bodies.append(site.cylinder(tool, "joint", _raised(place, under - _ARM * r), place, _RAM * r, colour=JOINT_COLOUR))
    if np.linalg.norm(hand[1] - hand[0]) > _RAM * r:
        bodies.append(_beam(site, tool, "arm", *hand, 0.8 * _ARM * r))
    return [*bodies, *tool_bodies(site, hand[1], _ARM * r)]


def _gantry(site: Site, slides: tuple[_Slide, _Slide], plane: float, bed: float, r: float) -> list[Body]:
    """Return carriages, the guides on which they ride, the beam under these, its legs and the bed."""
    d = site.direction(slides[0].joint)
    across = np.cross(UP, d)
    if float((site.tip - slides[0].foot) @ across) < 0.0:
        d, across = -d, -across
    R = np.column_stack([d, across, UP])
    half, (top, under, guide, beam) = _CARRIAGE * r, (plane + z * r for z in (_TOP, _UNDER, _GUIDE, _BEAM))
    bodies, ends = [], []
    for slide in slides:
        x, y, _ = R.T @ slide.foot
        sense = float(site.direction(slide.joint) @ d)
        stroke = [sense * end for end in site.stroke(slide.joint)]
        low, high, slim = x + min(stroke) - half, x + max(stroke) + half, 0.6 * half
        rail = (low, y - slim, guide), (high, y + slim, under)
        bodies += [
            site.box(slide.joint.child, "carriage", (x - half, y - half, under), (x + half, y + half, top), R),
            site.box(BASE_LINK, "guide", *rail, R, colour=JOINT_COLOUR),
        ]
        ends.append((low, high, y - half, y + half))
    lows, highs, backs, fronts = (np.array(values) for values in zip(*ends, strict=True))
    leg = _LEG * r
    x0, x1, back, front = lows.min() - leg, highs.max() + leg, backs.min(), fronts.max()
    bodies.append(site.box(BASE_LINK, "beam", (x0, back, beam), (x1, front, guide), R))
    for a, b in ((x0, x0 + leg), (x1 - leg, x1)):
        bodies.append(site.box(BASE_LINK, "post", (a, back, bed), (b, front, beam), R))
    reach = max(float(across @ tip) for tip in tips(site)) + leg
    bodies.append(site.box(BASE_LINK, "bed", (x0, back, bed - leg), (x1, reach, bed), R))
    return bodies
