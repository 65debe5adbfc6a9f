"""What the links of robots are put together from: bars, bosses, forks, rings."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, Body, Colour, Origin, Part
from chainbuild.drawing.limbs.seats import Seat
from chainbuild.drawing.site import Site
from chainbuild.frames import unit

Extent = tuple[float, float]

_SHORT: Final = 1e-6  # m: what is shorter cannot be seen
_BOSS: Final = 0.92  # radius of what a fork holds, over the fork's
_PROUD: Final = 1.15  # thickness of a fork's rounded end over its plate's
_CAP: Final = 0.55  # radius of the cover on an axis, over the fork's
_EDGE: Final = 1.25  # where a fork ends, in its radii from the axis
_WEB: Final = 0.35  # thickness of what joins the plates of a fork, over the radius
_RING: Final = 0.22  # length of the ring between two housings, over the radius


def turned(along: Vector, across: Vector) -> Matrix:
    """Return the turn (3, 3) with x along one direction and y along another, as far as it is square to the first."""
    x = unit(along)
    rest = across - x * float(across @ x)
    if np.linalg.norm(rest) < _SHORT:
        rest = np.eye(3)[int(np.argmin(np.abs(x)))]
        rest = rest - x * float(rest @ x)
    y = unit(rest)
    return np.column_stack([x, y, np.cross(x, y)])


def upright(along: Vector) -> Matrix:
    """Return the turn (3, 3) with z up and x along the level part of a direction; the site's where it has none."""
    length = float(np.hypot(along[0], along[1]))
    if length < _SHORT:
        return np.eye(3)
    x = np.array([along[0] / length, along[1] / length, 0.0])
    z = np.array([0.0, 0.0, 1.0])
    return np.column_stack([x, np.cross(z, x), z])


def bar(
    site: Site, link: str, part: Part, a: Vector, b: Vector, across: Vector, width: tuple[float, float], height: float,
    *, origin: Origin = "drawn",
) -> list[Body]:  # fmt: skip
    """Return a bar from one point to another: a box, or nothing where they are one.

    Args:
        site: The site.
        link: Link that carries it.
        part: What it stands for.
        a: (3,) where it begins.
        b: (3,) where it ends.
        across: (3,) direction that its width counts along.
        width: From and to along it, from the line between the points [m].
        height: The third edge [m].
        origin: Where its measures come from.
    """
    length = float(np.linalg.norm(b - a))
    if length < _SHORT or width[1] - width[0] < _SHORT:
        return []
    R = turned(b - a, across)
    start, half = R.T @ a, height / 2.0
    low, high = np.array([0.0, width[0], -half]), np.array([length, width[1], half])
    return [site.box(link, part, start + low, start + high, R, origin=origin)]


def block(
    site: Site, link: str, part: Part, R: Matrix, at: Vector, x: Extent, y: Extent, z: Extent, *,
    colour: Colour | None = None,
) -> Body:  # fmt: skip
    """Return a box by what it spans about a point, along the axes of a turn.

    Args:
        site: The site.
        link: Link that carries it.
        part: What it stands for.
        R: (3, 3) turn of the box.
        at: (3,) the point, in the site.
        x: From and to along the first axis of R, from the point [m].
        y: Along the second one.
        z: Along the third one.
        colour: None: the link's.
    """
    spans = np.array([x, y, z])
    middle = R.T @ at
    return site.box(link, part, middle + spans[:, 0], middle + spans[:, 1], R, colour=colour)


def tube(
    site: Site, link: str, part: Part, a: Vector, b: Vector, radius: float, *, origin: Origin = "drawn"
) -> list[Body]:
    """Return a cylinder from one point to another, or nothing where they are one."""
    return [site.cylinder(link, part, a, b, radius, origin=origin)] if np.linalg.norm(b - a) > _SHORT else []


def boss(site: Site, link: str, seat: Seat) -> list[Body]:
    """Return what a fork holds: a cylinder about the axis of a hinge."""
    a, b = seat.place - seat.half * seat.axis, seat.place + seat.half * seat.axis
    return [site.cylinder(link, "housing", a, b, _BOSS * seat.radius)]


def cheeks(site: Site, link: str, seat: Seat) -> list[Body]:
    """Return the rounded ends of a fork's plates, and the covers on the axis."""
    bodies = []
    inner, outer = seat.half, seat.half + _PROUD * seat.plate
    for side in (-1.0, 1.0):
        d = side * seat.axis
        bodies.append(site.cylinder(link, "yoke", seat.place + inner * d, seat.place + outer * d, seat.radius))
        cap = outer + (0.5 if side > 0.0 else 0.15) * seat.plate
        bodies.append(
            site.cylinder(
                link, "joint", seat.place + outer * d, seat.place + cap * d, _CAP * seat.radius, colour=JOINT_COLOUR
            )
        )
    return bodies


def plates(
    site: Site, link: str, seat: Seat, a: Vector, b: Vector, height: float, origin: Origin = "drawn"
) -> list[Body]:
    """Return the two plates of a fork from one point to another, beside the boss of a hinge."""
    bodies = []
    for width in ((seat.half, seat.half + seat.plate), (-seat.half - seat.plate, -seat.half)):
        bodies += bar(site, link, "yoke", a, b, seat.axis, width, height, origin=origin)
    return bodies


def fork_root(seat: Seat, start: Vector) -> Vector:
    """Return where the fork of a hinge begins, on the way to it from a point; that point where it is near."""
    way = start - seat.place
    length = float(np.linalg.norm(way))
    return start if length < _EDGE * seat.radius else seat.place + way * (_EDGE * seat.radius / length)


def fork(site: Site, link: str, seat: Seat, start: Vector) -> list[Body]:
    """Return a fork, on an arm from a point, to the hinge whose boss it holds."""
    root = fork_root(seat, start)
    flat = root - seat.axis * float((root - seat.place) @ seat.axis)
    way = seat.place - flat
    room = min(_WEB * seat.radius, float(np.linalg.norm(root - start))) if np.linalg.norm(way) > _SHORT else 0.0
    back = flat - room * unit(way) if room > _SHORT else flat
    wide = seat.half + seat.plate
    return [
        *bar(site, link, "yoke", back, flat, seat.axis, (-wide, wide), 1.5 * seat.radius),
        *plates(site, link, seat, flat, seat.place, 1.5 * seat.radius),
        *cheeks(site, link, seat),
    ]


def ring(site: Site, link: str, seat: Seat, radius: float) -> Body:
    """Return the dark ring where what turns in line begins."""
    end = seat.place + _RING * seat.radius * seat.axis
    return site.cylinder(link, "joint", seat.place, end, radius, colour=JOINT_COLOUR)
