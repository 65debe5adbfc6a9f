"""Feet, tracks on the floor or on one another, and columns that lift an arm."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, Body
from chainbuild.chain.elements import BASE_LINK, Joint
from chainbuild.drawing.limbs.links import arm_to
from chainbuild.drawing.limbs.pieces import Extent, bar, block, tube, turned, upright
from chainbuild.drawing.limbs.seats import Seat
from chainbuild.drawing.site import Site

# Shares of the radius of the arm's first joint, as robots are built.
STAGE: Final = 1.0  # height of a track with its carriage
_PLATE: Final = 0.25  # thickness of the plate under a foot
_FOOT: Final = 1.45  # half the width of that plate
_RAILS: Final = 0.3  # of the height of a track: carriage, and the same from the edge to the rail
_BED: Final = 0.55  # likewise: carriage and rails
_APART: Final = 4.5  # a track wider than this lies on two beams
_COLUMN: Final = 0.8  # half the width of a lifting column
_SLEEVE: Final = 1.35  # of the column's width: what rides on it
_SLIM: Final = 2.6  # halves of a column to the arm beside it, at least
_CONSOLE: Final = 0.55  # thickness of what carries the arm on it
_RIDE: Final = 1.9  # height of what rides on it
_HEAD: Final = 1.5  # a column above the highest place of the arm's foot
_Z: Final = np.array([0.0, 0.0, 1.0])
_NEAR: Final = 1e-6  # m: shorter ways have no direction


def stand(site: Site, link: str, mount: Vector, seat: Seat) -> list[Body]:
    """Return the foot of an arm, up to its first joint.

    Args:
        site: The site.
        link: Link that carries the arm.
        mount: (3,) where the arm stands or hangs [m].
        seat: Seat of its first joint.
    """
    r = seat.radius
    up = seat.axis if seat.kind == "roll" else _Z
    if seat.kind == "stack":
        mount = np.array([*seat.place[:2], mount[2]])  # a pillar right under the arm
    elif seat.kind == "roll":
        mount = seat.corner
    side = (-_FOOT * r, _FOOT * r)
    plate = block(site, link, "foot", turned(up, np.eye(3)[1]), mount, (0.0, _PLATE * r), side, side)
    top = mount + up * _PLATE * r
    if seat.kind == "roll":
        return [plate, *tube(site, link, "foot", top, seat.place, 1.12 * r)]
    if seat.kind == "stack":
        return [plate, *tube(site, link, "foot", top, seat.place, 1.05 * r)]
    return [plate, *arm_to(site, link, top, seat)]


def tracks(site: Site, slides: Sequence[Joint], top: Vector, carriage: tuple[Extent, Extent], r: float) -> list[Body]:
    """Return tracks on the floor, or on one another, with their carriages.

    Args:
        site: The site.
        slides: Their joints, from the floor up; all level.
        top: (3,) point on the upper carriage's top [m].
        carriage: What that carriage spans about it, along the first track and across it [m].
        r: Radius that their thickness is scaled by [m].
    """
    bodies: list[Body] = []
    if not slides:
        return bodies
    R = upright(site.direction(slides[0]))
    spans, h, z = [*carriage], STAGE * r, 0.0
    for joint in reversed(slides):
        bodies.append(block(site, joint.child, "carriage", R, top, spans[0], spans[1], (z - _RAILS * h, z)))
        d = R.T @ site.direction(joint)
        n = int(np.argmax(np.abs(d[:2])))
        low, high = sorted(end * float(d[n]) for end in site.stroke(joint))
        along = (spans[n][0] + low, spans[n][1] + high)
        (left, right), w = spans[1 - n], _RAILS * h
        beams = [(left, right)] if right - left < _APART * r else [(left, left + r), (right - r, right)]
        rails = [(left + w, left + 2.0 * w), (right - 2.0 * w, right - w)]
        for edge in rails:
            x, y = (along, edge) if n == 0 else (edge, along)
            heights = (z - _BED * h, z - _RAILS * h)
            bodies.append(block(site, joint.parent, "rail", R, top, x, y, heights, colour=JOINT_COLOUR))
        for edge in beams:
            x, y = (along, edge) if n == 0 else (edge, along)
            bodies.append(block(site, joint.parent, "bed", R, top, x, y, (z - h, z - _BED * h)))
        spans[n] = along
        z -= h
    return bodies


class LiftColumn:
    """A column, and what rides up and down on it with the arm.

    Args:
        site: The site.
        slides: Tracks under it, and the lifting axis.
        mount: (3,) where the arm stands [m].
        seat: Seat of the arm's first joint.
        beside: True: the arm is held beside the column; False: it stands on a console, and the column beside it.

    Attributes:
        half: Half the column's width [m].
        foot: (3,) where the column stands [m].
    """

    def __init__(self, site: Site, slides: Sequence[Joint], mount: Vector, seat: Seat, *, beside: bool) -> None:
        self.site, self.lift, self.seat, self.beside, self.mount = site, slides[-1], seat, beside, mount
        r = seat.radius
        self.half = _COLUMN * r
        low, self.high = sorted(end * float(site.direction(self.lift)[2]) for end in site.stroke(self.lift))
        if beside:
            pole = site.links[self.lift.child][:3, 3]
            way = _level(seat.place - pole)
            if np.linalg.norm(way) > _NEAR:
                self.half = min(self.half, float(np.linalg.norm(way)) / _SLIM)
        else:
            across = np.cross(_Z, site.direction(slides[-2])) if len(slides) > 1 else np.eye(3)[1]
            pole = mount + (1.1 * _FOOT * r + _SLEEVE * self.half) * across
            way = _level(mount - pole)
        self.level = float(seat.place[2] if beside else mount[2])
        self.low = self.level - _CONSOLE * r  # of what rides on it, at home
        self.R = upright(way)
        floor = min(STAGE * r * (len(slides) - 1), self.low + low - 0.3 * r)
        self.foot = np.array([pole[0], pole[1], floor])

    def bodies(self) -> list[Body]:
        """Return the bodies of column and carriage, and what holds the arm."""
        site, r, h, s, floor = self.site, self.seat.radius, self.half, _SLEEVE * self.half, float(self.foot[2])
        link = self.lift.child
        tall = self.level + self.high + _HEAD * r - floor
        ride = (self.low - floor, self.low + _RIDE * r - floor)
        bodies = [
            block(site, self.lift.parent, "column", self.R, self.foot, (-h, h), (-h, h), (0.0, tall)),
            block(site, link, "carriage", self.R, self.foot, (-s, s), (-s, s), ride),
        ]
        if self.lift.parent == BASE_LINK:
            wide = (-2.2 * h, 2.2 * h)
            bodies.append(block(site, BASE_LINK, "foot", self.R, self.foot, wide, wide, (0.0, 0.3 * r)))
        return [*bodies, *self._console(link)]

    def _console(self, link: str) -> list[Body]:
        site, seat, r = self.site, self.seat, self.seat.radius
        pole, y = np.array([*self.foot[:2], self.level]), self.R[:, 1]
        down = _CONSOLE * r / 2.0 * _Z
        if not self.beside:
            far = self.mount + _FOOT * r * self.R[:, 0] - down
            return bar(site, link, "carriage", pole - down, far, y, (-_FOOT * r, _FOOT * r), _CONSOLE * r)
        if seat.kind != "stack":
            return arm_to(site, link, pole, seat)
        arm = bar(site, link, "arm", pole - down, seat.place - down, y, (-0.9 * r, 0.9 * r), _CONSOLE * r)
        return [*arm, site.cylinder(link, "arm", seat.place - 2.0 * down, seat.place, r)]


def _level(way: Vector) -> Vector:
    return np.array([way[0], way[1], 0.0])
