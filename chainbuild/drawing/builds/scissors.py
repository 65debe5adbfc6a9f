"""Two slides with crossing rods: the lambda kinematic, which moves a ram in a plane.

The data place the rods of a plane in it and say nothing of their height: they are drawn above what hangs from the ram.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, Body
from chainbuild.chain.elements import BASE_LINK, Joint
from chainbuild.drawing.builds.bed import bed_height, level_box, part_block, tips, tool_bodies
from chainbuild.drawing.site import Site, upright_frame
from chainbuild.shown import fields_shown

_ROD: Final = 0.022  # radius of a rod over the length of the arm up to it: it carries the ram alone
_PART: Final = 6.0  # radii of a rod: width of the part
# In radii of a rod.
_BALL: Final = 2.0  # of the ball on which the rods meet
_ARM: Final = 1.3  # half the section of the arm that carries the ram
_PIVOT: Final = 2.2  # the pivot on a carriage
_CARRIAGE: Final = 3.0  # half its width, and its length over 2
_TOP: Final = -2.0  # top of the carriages, from the middle of the rods
_UNDER: Final = -4.5  # their underside
_GUIDE: Final = -5.5  # underside of the guides, top of the beam
_BEAM: Final = -10.0  # underside of the beam
_RAIL: Final = 0.6  # width of a guide over that of its carriage
_HAND: Final = 1.2  # half the section of the hand that holds the tool beside the ram
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
    """Return the bodies of a machine with two slides whose rods meet, and a ram at the end of the first."""
    loop = site.chain.loops[0]
    main, other = (_slide(site, name) for name in (loop.frame_a, loop.frame_b))
    ram = next(joint for joint in site.tool_path if joint.parent == main.rod)
    r = site.radius(other.rod, _ROD * float(np.linalg.norm(main.end - main.foot)))
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
    heights = plane - _ARM * r, plane + _ARM * r
    rod = _raised(other.foot, plane), _raised(other.end, plane)
    bodies = [
        level_box(site, main.rod, "arm", (main.foot, main.end), _ARM * r, heights),
        level_box(site, main.rod, "arm", (main.end, carried), _ARM * r, heights),
        site.cylinder(other.rod, "rod", *rod, r),
        site.ball(other.rod, "joint", rod[1], _BALL * r, colour=JOINT_COLOUR),
    ]
    for slide in (main, other):
        pivot = _raised(slide.foot, plane + _TOP * r), _raised(slide.foot, plane + _PIVOT * r)
        bodies.append(site.cylinder(slide.rod, "joint", *pivot, _PIVOT * r, colour=JOINT_COLOUR))
    return bodies


def _ram(site: Site, ram: Joint, plane: float, r: float) -> list[Body]:
    """Return the housing at the end of the arm, the ram through it, and what turns below with the tool."""
    link, place = ram.child, site.links[ram.child][:3, 3]
    x, y, z = place
    wide, slim = _HOUSING * r, _RAM * r
    top = plane + 2 * wide - site.stroke(ram)[0]
    bodies = [
        site.box(ram.parent, "housing", (x - wide, y - wide, plane - wide), (x + wide, y + wide, plane + wide)),
        site.box(link, "ram", (x - slim, y - slim, z), (x + slim, y + slim, top)),
    ]
    tool = site.chain.frame("tool").link
    under = (z + float(site.tip[2])) / 2
    elbow = _raised(place, under - _HAND * r)
    bodies.append(site.cylinder(tool, "joint", elbow, place, slim, colour=JOINT_COLOUR))
    if np.hypot(*(site.tip - place)[:2]) > slim:
        heights = under - _HAND * r, under + _HAND * r
        bodies.append(level_box(site, tool, "arm", (place, site.tip), _HAND * r, heights))
    return [*bodies, *tool_bodies(site, _raised(site.tip, under), _HAND * r)]


def _gantry(site: Site, slides: tuple[_Slide, _Slide], plane: float, bed: float, r: float) -> list[Body]:
    """Return carriages, the guides on which they ride, the beam under these, its legs and the bed."""
    R = upright_frame(site.direction(slides[0].joint))
    half, (top, under, guide, beam) = _CARRIAGE * r, (plane + z * r for z in (_TOP, _UNDER, _GUIDE, _BEAM))
    bodies: list[Body] = []
    lows: list[float] = []
    highs: list[float] = []
    sides: list[float] = []
    for slide in slides:
        x, y, _ = R.T @ slide.foot
        low, high = site.stroke(slide.joint)
        low, high, slim = x + low - half, x + high + half, _RAIL * half
        rail = (low, y - slim, guide), (high, y + slim, under)
        bodies += [
            site.box(slide.joint.child, "carriage", (x - half, y - half, under), (x + half, y + half, top), R),
            site.box(BASE_LINK, "guide", *rail, R, colour=JOINT_COLOUR),
        ]
        lows, highs, sides = [*lows, low], [*highs, high], [*sides, y - half, y + half]
    leg = _LEG * r
    left, right, back, front = min(lows) - leg, max(highs) + leg, min(sides), max(sides)
    bodies.append(site.box(BASE_LINK, "beam", (left, back, beam), (right, front, guide), R))
    for a, b in ((left, left + leg), (right - leg, right)):
        bodies.append(site.box(BASE_LINK, "post", (a, back, bed), (b, front, beam), R))
    across = tips(site) @ R[:, 1]
    near, far = min(back, float(across.min()) - leg), max(front, float(across.max()) + leg)
    bodies.append(site.box(BASE_LINK, "bed", (left, near, bed - leg), (right, far, bed), R))
    return bodies
