"""A link of a robot: what lies between the joint that carries it and the next one."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, Body
from chainbuild.drawing.limbs.pieces import bar, boss, cheeks, fork, fork_root, plates, ring, tube
from chainbuild.drawing.limbs.seats import Seat
from chainbuild.drawing.limbs.slides import slide_end, slide_start
from chainbuild.drawing.site import Site

_TUBE: Final = 1.12  # radius of what ends at a roll over the roll's own: housings fall towards the tip
_FIT: Final = 0.97  # of the room in a fork: what runs through it
_MOTORS: Final = 0.8  # a forearm as many radii beside the elbow, or more, has its motors behind it
_BEND: Final = 0.2  # sine: a link bends where its joints' axes part by more
_BESIDE: Final = 0.4  # of a hinge's radius: an arm shorter than this lies within its boss
_DISC: Final = 0.25  # what a turntable rises above the foot of its neck, over its radius


def limb(site: Site, start: Seat, end: Seat) -> list[Body]:
    """Return the bodies of the link between two joints.

    Args:
        site: The site.
        start: The joint that carries the link.
        end: The next joint towards the tool.
    """
    link = start.link
    if start.kind == "stack":
        hood = _hood(site, start, end) if end.kind in ("roll", "quill") else []
        return [*slab(site, start, end.place), *hood]
    if start.kind == "hinge" and not start.parent_forks:
        return _twin(site, start, end)
    root, bodies = _start(site, link, start, end)
    return [*bodies, *_between(site, link, start, end, root), *_end(site, link, start, end, root)]


def arm_to(site: Site, link: str, root: Vector, end: Seat) -> list[Body]:
    """Return the arm from a point of what carries a robot to its first joint.

    Args:
        site: The site.
        link: Link that carries it.
        root: (3,) the point [m].
        end: Seat of the first joint.
    """
    wide = (end.half + end.plate if end.parent_forks else end.half) * _FIT
    neck = bar(site, link, "neck", root, _target(end, root), end.axis, (-wide, wide), 1.5 * end.radius)
    if end.kind == "hinge":
        return [*neck, *(fork(site, link, end, root) if end.parent_forks else boss(site, link, end))]
    if end.kind == "roll":
        turning = tube(site, link, "housing", end.corner, end.place, _TUBE * end.radius)
        return [*neck, site.ball(link, "housing", end.corner, _TUBE * end.radius), *turning]
    return [*neck, *slide_end(site, link, end, root)]


def _start(site: Site, link: str, start: Seat, end: Seat) -> tuple[Vector, list[Body]]:
    """Return where a link's arm begins, and what surrounds the joint that carries it."""
    if start.kind == "hinge":
        return start.place, boss(site, link, start)
    if start.kind == "roll":
        root, disc = _turntable(site, start, end)
        return root, [ring(site, link, start, 1.04 * start.radius), *disc]
    return slide_start(site, start, end.corner)


def _leans(start: Seat, end: Seat) -> bool:
    """Return whether the arm on a roll leaves its axis, or has to fit between plates."""
    if end.kind != "hinge":
        return end.kind in ("column", "stack")
    beside = float(np.linalg.norm(np.cross(end.place - start.place, start.axis)))
    return beside > 0.2 * start.radius or not end.parent_forks


def _turntable(site: Site, start: Seat, end: Seat) -> tuple[Vector, list[Body]]:
    """Return where a leaning neck or a column begins, and the disc that it stands on."""
    if not _leans(start, end):
        return start.place, []
    way = end.place - start.place
    lean = float(np.linalg.norm(np.cross(way, start.axis)) / np.linalg.norm(way)) if end.kind == "hinge" else 0.0
    root = start.place + 0.75 * end.radius * lean * start.axis  # its lower edge comes down to the disc's foot
    top = root + _DISC * start.radius * start.axis
    return root, tube(site, start.link, "housing", start.place, top, 1.08 * start.radius)


def _twin(site: Site, start: Seat, end: Seat) -> list[Body]:
    """Return an upper arm of two plates that hold the shoulder, and the elbow; filled between the two."""
    link, way = start.link, end.place - start.place
    e = way / float(np.linalg.norm(way))
    flat = e - start.axis * float(e @ start.axis)
    a, b = start.place + 1.12 * start.radius * flat, end.place - 1.12 * end.radius * flat
    middle = start.place + 0.5 * way
    thick = 0.5 * (start.radius + end.radius)
    wide = start.half
    return [
        *plates(site, link, start, start.place, middle, 1.62 * thick, "data"),
        *plates(site, link, end, middle, end.place, 1.5 * end.radius, "data"),
        *bar(site, link, "arm", a, b, start.axis, (-wide, wide), 1.3 * end.radius),
        *cheeks(site, link, start),
        *cheeks(site, link, end),
    ]


def _between(site: Site, link: str, start: Seat, end: Seat, root: Vector) -> list[Body]:
    """Return the arm from where a link begins to where its end begins."""
    if end.kind == "column":
        return []
    target = _target(end, root)
    wide = (end.half + end.plate if end.kind == "hinge" and end.parent_forks else end.half) * _FIT
    if start.kind == "roll":
        if end.kind != "hinge" or not _leans(start, end):
            radius = max(0.95 * start.radius, wide if end.kind == "hinge" else 0.0)
            return tube(site, link, "arm", root, target, radius, origin="data")
        # A neck that leans out, as wide as what it carries.
        return bar(site, link, "neck", root, target, end.axis, (-wide, wide), 1.5 * end.radius)
    if start.kind != "hinge":
        return bar(site, link, "arm", root, target, end.axis, (-wide, wide), 1.5 * end.radius)
    if np.linalg.norm(target - root) < _BESIDE * start.radius:
        return []
    half = start.half * _FIT
    return bar(site, link, "arm", root, target, start.axis, (-half, half), _bar_height(start, end), origin="data")


def _target(end: Seat, root: Vector) -> Vector:
    """Return the point that a link's arm runs to."""
    if end.kind == "hinge":
        return fork_root(end, root) if end.parent_forks else end.place
    return end.corner


def _end(site: Site, link: str, start: Seat, end: Seat, root: Vector) -> list[Body]:
    """Return what surrounds the next joint as far as a link carries it."""
    if end.kind == "hinge":
        return fork(site, link, end, root) if end.parent_forks else boss(site, link, end)
    if end.kind == "roll":
        return _collar(site, link, start, end)
    if end.kind in ("stack", "quill"):
        return []
    return slide_end(site, link, end, root)


def _collar(site: Site, link: str, start: Seat, end: Seat) -> list[Body]:
    """Return the housing that a roll turns in, and the motors behind it."""
    room = start.half * _FIT if start.kind == "hinge" else 0.95 * start.radius
    radius = min(_TUBE * end.radius, room)
    beside = float(np.linalg.norm(end.corner - start.place))
    # A housing beside its hinge covers the end of the bar that it is fixed to.
    bend = end.corner - (_bar_height(start, end) / 2.0 if beside > _BESIDE * start.radius else 0.0) * end.axis
    bodies = tube(site, link, "housing", bend, end.place, radius, origin="data")
    if start.kind == "hinge" and beside > _MOTORS * start.radius and start.parent_forks:
        back = bend - 0.9 * radius * end.axis
        cover = back - 0.25 * radius * end.axis
        bodies += tube(site, link, "housing", bend, back, 0.9 * radius)
        bodies.append(site.cylinder(link, "joint", back, cover, 0.75 * radius, colour=JOINT_COLOUR))
    elif start.kind in ("roll", "ram") and np.linalg.norm(np.cross(start.axis, end.axis)) > _BEND:
        bodies.append(site.ball(link, "housing", end.corner, radius))
    return bodies


def _bar_height(start: Seat, end: Seat) -> float:
    """Return the height of the bar from a hinge to the next joint [m]."""
    return 1.5 * min(start.radius, max(end.radius, 0.7 * start.radius))


def slab(site: Site, start: Seat, to: Vector) -> list[Body]:
    """Return the arm of a SCARA: a slab with rounded ends, that lies on the arm before."""
    link, up, thick = start.link, start.axis, start.plate
    low = start.place
    far = to - up * float((to - low) @ up)
    rise = up * thick
    r, end = start.radius, 0.88 * start.radius
    middle = up * thick / 2.0
    across = np.cross(up, far - low)
    cap = low + rise
    return [
        site.cylinder(link, "arm", low, low + rise, r),
        site.cylinder(link, "joint", cap, cap + 0.2 * rise, 0.6 * r, colour=JOINT_COLOUR),
        site.cylinder(link, "arm", far, far + rise, end),
        *bar(site, link, "arm", low + middle, far + middle, across, (-end, end), thick, origin="data"),
    ]


def _hood(site: Site, start: Seat, end: Seat) -> list[Body]:
    """Return the hood on the last arm of a SCARA, which holds the motors of its quill."""
    up = start.axis
    a = start.place + up * start.plate
    b = end.corner + up * float((a - end.corner) @ up)
    way = b - a
    if np.linalg.norm(way) < 2.5 * start.radius:
        return []
    e, half = way / float(np.linalg.norm(way)), 0.62 * start.radius
    rise = up * 0.45 * start.plate
    a, b = a + 1.2 * start.radius * e + rise, b + half * e + rise
    return bar(site, start.link, "housing", a, b, np.cross(up, e), (-half, half), 0.9 * start.plate)
