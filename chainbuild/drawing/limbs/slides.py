"""Linear axes within an arm: a column on a turntable, a ram through its housing, a slide across the arm."""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, Body
from chainbuild.drawing.limbs.pieces import block, turned
from chainbuild.drawing.limbs.seats import Seat
from chainbuild.drawing.site import Site
from chainbuild.frames import unit

_ABOVE: Final = 2.6  # how far a quill comes out above its arm where it is down, over its radius
_QUILL: Final = 0.6  # radius of a quill over that of its seat
_Z: Final = np.array([0.0, 0.0, 1.0])


def outward(site: Site, seat: Seat) -> tuple[float, float]:
    """Return how far a slide moves from home against and along the axis of its seat, (≤ 0, ≥ 0) [m]."""
    low, high = site.stroke(seat.joint)
    return (low, high) if site.direction(seat.joint) @ seat.axis > 0.0 else (-high, -low)


def slide_start(site: Site, seat: Seat, end: Vector) -> tuple[Vector, list[Body]]:
    """Return where the arm of a link on a slide begins, and the ram, carriage or plate that it begins with.

    Args:
        site: The site.
        seat: The slide that carries it.
        end: (3,) where the link goes on to [m].
    """
    link, r = seat.link, seat.radius
    if seat.kind == "column":
        wide, ends = post_place(seat) + 1.5 * post_radius(seat), (-1.1 * r, 1.1 * r)
        return seat.place, [block(site, link, "carriage", _facing(seat), seat.place, ends, (-wide, wide), ends)]
    if seat.kind == "plate":
        R, step = _stacked(seat)
        return seat.ahead, [block(site, link, "slide", R, seat.place, (0.5 * step, step), (-r, r), (-r, r))]
    _, high = outward(site, seat)
    if seat.kind == "quill":
        top = seat.corner - (high + _ABOVE * r) * seat.axis
        return end, [site.cylinder(link, "spindle", top, end, _QUILL * r)]
    front = float((seat.place - seat.corner) @ seat.axis)
    tip = max(float((end - seat.corner) @ seat.axis), front)
    back = 0.0 if front == 0.0 else -front - 0.3 * r - high  # still held by its housing where it is out
    side = (-ram_half(seat), ram_half(seat))
    return end, [block(site, link, "ram", turned(seat.axis, _Z), seat.corner, (back, tip), side, side)]


def slide_end(site: Site, link: str, end: Seat, root: Vector) -> list[Body]:
    """Return what carries a slide: its posts, housing or guide.

    Args:
        site: The site.
        link: The link that carries it.
        end: The slide.
        root: (3,) where that link begins [m].
    """
    r, (low, high) = end.radius, outward(site, end)
    if end.kind == "column":
        return _posts(site, link, end, root, high)
    if end.kind == "plate":
        R, step = _stacked(end)
        span, wide = (low - r, high + r), (-0.7 * r, 0.7 * r)
        return [block(site, link, "guide", R, end.place, (0.0, 0.5 * step), span, wide, colour=JOINT_COLOUR)]
    front, h = float((end.place - end.corner) @ end.axis), 1.35 * ram_half(end)
    span = (-front, front) if front > 0.0 else (0.0, 0.5 * float(np.linalg.norm(end.ahead - end.place)))
    return [block(site, link, "housing", turned(end.axis, _Z), end.corner, span, (-h, h), (-h, h))]


def _facing(seat: Seat) -> Matrix:
    """Return the turn (3, 3) of a column: z along it, x to where the arm goes on."""
    ahead = seat.ahead - seat.place
    flat = ahead - seat.axis * float(ahead @ seat.axis)
    x = unit(flat) if np.linalg.norm(flat) > 0.1 * seat.radius else turned(seat.axis, np.eye(3)[0])[:, 1]
    return np.column_stack([x, np.cross(seat.axis, x), seat.axis])


def _stacked(seat: Seat) -> tuple[Matrix, float]:
    """Return the turn (3, 3) of a slide across the arm, x along the arm and y along the slide, and its thickness."""
    step = seat.ahead - seat.place
    return turned(step, seat.axis), float(np.linalg.norm(step))


def _posts(site: Site, link: str, end: Seat, root: Vector, high: float) -> list[Body]:
    """Return the two posts of a column, with what joins them on top."""
    R, r, out = _facing(end), end.radius, post_place(end)
    low = float((root - end.place) @ R[:, 2])
    top = high + 1.4 * r
    plate = block(site, link, "plate", R, end.place, (-1.3 * r, 1.3 * r), (-2.0 * out, 2.0 * out), (low, low + 0.3 * r))
    head = block(site, link, "bridge", R, end.place, (-0.6 * r, 0.6 * r), (-1.5 * out, 1.5 * out), (top, top + 0.5 * r))
    bodies = [plate, head]
    for side in (-out, out):
        a, b = (end.place + R @ np.array([0.0, side, z]) for z in (low, top))
        bodies.append(site.cylinder(link, "post", a, b, post_radius(end)))
    return bodies


def ram_half(seat: Seat) -> float:
    """Return half the width of a ram [m]."""
    return 0.75 * seat.radius


def post_place(seat: Seat) -> float:
    """Return how far the posts of a column stand beside its middle [m]: a ram runs between them."""
    return 1.35 * seat.radius


def post_radius(seat: Seat) -> float:
    """Return the radius of a column's posts [m]."""
    return 0.35 * seat.radius
