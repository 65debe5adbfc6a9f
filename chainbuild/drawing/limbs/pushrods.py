"""Crank and rod of a parallelogram arm, and its level linkage, beside the arm on either side.

Machine data give them no place across the arm, and they turn about its axes wherever they lie along these: they are
drawn outside the plates of the arm, crank and rod on the side that the operator sees.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, Body
from chainbuild.chain.bodies.rods import (
    CRANK,
    HEAD_ROD,
    LEVEL_CRANK,
    LEVEL_PLATE,
    LEVEL_ROD,
    ROD,
    ROD_PIN,
    has_rods,
)
from chainbuild.drawing.limbs.pieces import bar
from chainbuild.drawing.limbs.seats import Seat
from chainbuild.drawing.site import Site

_HUB: Final = 0.62  # radius of what turns about a hinge beside its plates, over the hinge's: more than its cover
_BAR: Final = 0.9  # thickness of a crank over the rod's radius
_WIDE: Final = 2.4  # width of a crank likewise
_EYE: Final = 1.5  # radius of a rod's eye likewise
_PIN: Final = 0.7  # radius of a pin likewise
_PIN_END: Final = 2.3  # how far a pin reaches through the rod's eye likewise
_LAYER: Final = 2.5  # from one layer of rods to the next likewise
_CLEAR: Final = 1.75  # outside of a fork with its cover, in plates


def pushrod_bodies(site: Site, seats: Sequence[Seat]) -> list[Body]:
    """Return the bodies of crank, rod, lever and level linkage; none where the chain has no rods.

    Args:
        site: The site.
        seats: Seats of the arm's joints.
    """
    if not has_rods(site.chain):
        return []
    forearm = site.chain.frame(ROD_PIN).link
    n = next(n for n, seat in enumerate(seats) if seat.link == forearm)
    shoulder, elbow = seats[n - 1], seats[n]
    side = -1.0 if shoulder.axis[int(np.argmax(np.abs(shoulder.axis)))] > 0.0 else 1.0
    sideways = site.chain.geometry.rod_data.sideways
    if sideways:
        side = float(np.sign(sideways)) * (1.0 if elbow.axis @ shoulder.axis > 0.0 else -1.0)
    plane = _Plane(site, (shoulder, elbow), side, abs(sideways))
    crank, rod = f"{CRANK}_link", f"{ROD}_link"
    lower, upper = site.origin(site.joints[ROD]), site.frame(ROD_PIN)[:3, 3]
    bodies = [
        *plane.lever(crank, shoulder, lower),
        *plane.rod(rod, lower, upper),
        *plane.lever(forearm, elbow, upper),
    ]
    if LEVEL_CRANK in site.joints:
        bodies.append(plane.pin(f"{LEVEL_CRANK}_link", lower))
    if LEVEL_ROD in site.joints:
        bodies += _level(_Plane(site, (shoulder, elbow), -side, 0.0), shoulder, elbow, seats[n + 1])
    return bodies


def _level(plane: _Plane, shoulder: Seat, elbow: Seat, head: Seat) -> list[Body]:
    """Return the rods that keep the head level, with their plate at the elbow and their levers at both ends."""
    site, plate = plane.site, f"{LEVEL_PLATE}_link"
    low, high = site.origin(site.joints[LEVEL_ROD]), site.frame(f"{LEVEL_ROD}_pin")[:3, 3]
    back, front = site.origin(site.joints[HEAD_ROD]), site.frame(f"{HEAD_ROD}_pin")[:3, 3]
    frame = site.joints[LEVEL_ROD].parent
    return [
        *plane.lever(frame, shoulder, low),
        *plane.rod(f"{LEVEL_ROD}_link", low, high),
        *plane.lever(plate, elbow, high),
        *plane.lever(plate, elbow, back, layer=1),
        *plane.link(plate, high, back),
        *plane.rod(f"{HEAD_ROD}_link", back, front, layer=1),
        *plane.lever(head.link, head, front, layer=1),
    ]


class _Plane:
    """One side of an arm, where levers and, outside them, rods move.

    Args:
        site: The site.
        seats: Shoulder and elbow.
        side: +1 or -1: on which side of the arm, along the axis of the shoulder.
        least: How far outside the middle of the arm the rods lie at least [m].
    """

    def __init__(self, site: Site, seats: Sequence[Seat], side: float, least: float) -> None:
        self.site, self.axis, self.origin = site, side * seats[0].axis, seats[0].place
        self.radius = site.radius(f"{ROD}_link", 0.3 * seats[1].radius)
        self.thick = _BAR * self.radius
        outside = max(seat.half + _CLEAR * seat.plate for seat in seats)
        self.inner = max(outside, least - self.thick - self.radius)
        self.outer = self.inner + self.thick

    def at(self, point: Vector, out: float) -> Vector:
        """Return where a point lies in a plane that is as far outside the middle of the arm."""
        place: Vector = point + self.axis * (out - float((point - self.origin) @ self.axis))
        return place

    def lever(self, link: str, seat: Seat, pin: Vector, layer: int = 0) -> list[Body]:
        """Return a lever from the axis of a hinge to a pin, with its hub."""
        ends = self.at(seat.place, seat.half + 1.15 * seat.plate), self.at(seat.place, self.outer)
        hub = self.site.cylinder(link, "lever", *ends, _HUB * seat.radius)
        return [*self.link(link, seat.place, pin), hub, self.pin(link, pin, layer)]

    def link(self, link: str, a: Vector, b: Vector) -> list[Body]:
        """Return a flat bar between two points in the plane of the levers."""
        half, height = self.thick / 2.0, _WIDE * self.radius
        middle = self.inner + half
        return bar(
            self.site, link, "lever", self.at(a, middle), self.at(b, middle), self.axis, (-half, half), height,
            origin="data",
        )  # fmt: skip

    def rod(self, link: str, a: Vector, b: Vector, layer: int = 0) -> list[Body]:
        """Return a rod between two pins, with its eyes."""
        low, r = self._layer(layer), self.radius
        ends = self.at(a, low + r), self.at(b, low + r)
        bodies = [self.site.cylinder(link, "rod", *ends, r, colour=JOINT_COLOUR, origin="data")]
        for pin in (a, b):
            eye = self.at(pin, low), self.at(pin, low + 2.0 * r)
            bodies.append(self.site.cylinder(link, "rod", *eye, _EYE * r, colour=JOINT_COLOUR))
        return bodies

    def pin(self, link: str, point: Vector, layer: int = 0) -> Body:
        """Return the pin that holds a rod's eye."""
        ends = self.at(point, self.inner), self.at(point, self._layer(layer) + _PIN_END * self.radius)
        return self.site.cylinder(link, "joint", *ends, _PIN * self.radius, colour=JOINT_COLOUR)

    def _layer(self, layer: int) -> float:
        """Return how far outside the middle of the arm the rods of a layer begin [m]: rods may cross."""
        return self.outer + _LAYER * layer * self.radius
