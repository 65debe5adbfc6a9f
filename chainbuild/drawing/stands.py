"""What carries the head of a machine tool: ram, carriage, beam, rails, posts or a column, and the bed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import PART_COLOUR, Body, Part
from chainbuild.chain.elements import BASE_LINK, Joint
from chainbuild.drawing.heads import Head, head_of
from chainbuild.drawing.site import UP, Site
from chainbuild.drawing.tables import Table, lowest_tip, pedestal, plate_radius, table_of

_UPRIGHT: Final = 0.94  # cosine: a steeper slide is a ram
_BEAM_SHARE: Final = 0.04  # half of a beam's width over the longest stroke
_ROOM_SHARE: Final = 0.55  # of the radius a plate would have, between bed and lowest tip: where the part stands
_PART_WIDTH: Final = 0.7  # over the radius a plate would have
_PART_HEIGHT: Final = 0.6  # over the room below the lowest tip
_BEHIND: Final = (-1.0, 1.0)  # side on which a beam runs, away from whoever looks: -x, +y


def machine_tool_bodies(site: Site) -> list[Body]:
    """Return the bodies of a machine tool: head, slides and what carries the workpiece."""
    slides = leading_slides(site.tool_path)
    head = head_of(site, site.tool_path[len(slides) :])
    table = table_of(site) if site.workpiece_path else None
    return _Stand(site, slides, head, table).bodies


def leading_slides(path: Sequence[Joint]) -> tuple[Joint, ...]:
    """Return the linear joints at the start of a path."""
    count = next((n for n, joint in enumerate(path) if joint.kind != "prismatic"), len(path))
    return tuple(path[:count])


@dataclass
class _Box:
    """A box along the site's axes: two opposite corners (3,) [m]."""

    low: Vector
    high: Vector

    def side(self, axis: int, sign: float, depth: float, *, outside: bool = False) -> _Box:
        """Return the part of a depth [m] at one end along an axis, inside or just outside the box."""
        low, high = self.low.copy(), self.high.copy()
        edge = high[axis] if sign > 0.0 else low[axis]
        other = edge + (sign if outside else -sign) * depth
        low[axis], high[axis] = min(edge, other), max(edge, other)
        return _Box(low, high)

    def between(self, axis: int, low: float, high: float) -> _Box:
        """Return the box with other ends along an axis."""
        a, b = self.low.copy(), self.high.copy()
        a[axis], b[axis] = low, high
        return _Box(a, b)

    def moved(self, along: Vector, low: float, high: float) -> _Box:
        """Return the box that holds this one while it moves from `low` to `high` along a direction."""
        ends = [corner + along * value for corner in (self.low, self.high) for value in (low, high)]
        return _Box(np.min(ends, axis=0), np.max(ends, axis=0))


class _Stand:
    """Builds from the head outwards to the base: every slide holds what the one before left.

    What is left is a box that has no stand yet (`box`), or feet that stand on a link (`feet`).
    """

    def __init__(self, site: Site, slides: Sequence[Joint], head: Head, table: Table | None) -> None:
        self.site, self.head, self.table, self.r = site, head, table, head.radius
        self.bodies = [*head.bodies, *(table.bodies if table else [])]
        strokes = [high - low for low, high in map(site.stroke, slides)]
        self.beam = max(0.8 * self.r, _BEAM_SHARE * max(strokes, default=0.0))  # half of a beam's width
        self.R = plate_radius(site)
        self.floor = self._floor()
        cap = np.array([1.6 * self.r, 1.6 * self.r, 0.0])
        self.box, self.is_beam = _Box(head.top - cap, head.top + cap), False
        self.feet: list[_Box] = []
        self.around = _Box(self.box.low.copy(), self.box.high.copy())
        for n, joint in enumerate(reversed(slides)):
            self._slide(joint, moves_on=any(not _rises(site, other) for other in slides[: len(slides) - n - 1]))
        if not self.feet:
            self._end_posts(BASE_LINK, self.floor) if self.is_beam else self._column()
        self._bed()

    def add(self, link: str, part: Part, box: _Box) -> None:
        self.bodies.append(self.site.box(link, part, box.low, box.high))
        self.around = _Box(np.minimum(self.around.low, box.low), np.maximum(self.around.high, box.high))

    def _floor(self) -> float:
        """Return the height [m] of the floor: under the table, or below the bed on which the part stands."""
        if self.table is not None:
            return float(self.table.foot[2]) - 0.35 * self.R
        return self._bed_top() - 0.5 * self.R

    def _bed_top(self) -> float:
        return lowest_tip(self.site) - max(_ROOM_SHARE * self.R, 4.0 * self.r)

    @property
    def _rail(self) -> float:
        return 0.8 * self.beam  # height of a rail on the floor

    def _slide(self, joint: Joint, *, moves_on: bool) -> None:
        """Draw one slide.

        Args:
            joint: Its joint.
            moves_on: Whether a level slide moves all of it: what stands then stands on rails.
        """
        along, foot = self.site.direction(joint), self.floor + (self._rail if moves_on else 0.0)
        if _rises(self.site, joint):
            if self.is_beam:
                self._columns(joint, foot)
            elif not self.feet:
                self._ram(joint)
        elif self.feet:
            self._rails(joint, along)
        elif self.is_beam:
            self._end_posts(joint.child, self.floor + self._rail)
            self._rails(joint, along)
        else:
            self._beam(joint, along)

    def _ram(self, joint: Joint) -> None:
        """Draw a ram over its stroke; what guides it begins above the head at the upper limit."""
        low, high = sorted(float(self.site.direction(joint) @ UP) * value for value in self.site.stroke(joint))
        bottom = float(self.box.low[2]) + high + 0.5 * self.r
        top = bottom + max(6.0 * self.r, 2.0 * self.beam)
        self.add(joint.child, "ram", self.box.between(2, self.box.low[2], top - low))
        self.box = self.box.between(2, bottom, top)

    def _carriage(self, link: str, behind: int) -> None:
        """Draw the carriage behind what is held, and hold that instead."""
        if self.box.high[2] - self.box.low[2] < self.r:  # a head without ram: the carriage sits on its top
            self.box = self.box.between(2, self.box.low[2], self.box.low[2] + max(4.0 * self.r, 2.0 * self.beam))
        else:
            self.box = self.box.side(behind, _BEHIND[behind], 1.2 * self.r, outside=True)
            side = 1 - behind
            self.box = self.box.between(side, self.box.low[side] - 0.8 * self.r, self.box.high[side] + 0.8 * self.r)
        self.add(link, "carriage", self.box)

    def _beam(self, joint: Joint, along: Vector) -> None:
        """Draw the carriage on the child and the beam over its stroke, behind it, on the parent."""
        axis = int(np.argmax(np.abs(along)))
        self._carriage(joint.child, 1 - axis)
        low, high = self.site.stroke(joint)
        room = self.head.half + 1.5 * self.r + 2.0 * self.beam  # for the head beside the posts, and the posts
        box = self.box.moved(along, low - room, high + room).side(
            1 - axis, _BEHIND[1 - axis], 2.0 * self.beam, outside=True
        )
        self.add(joint.parent, "beam", box)
        self.box, self.is_beam = box, True

    def _end_posts(self, link: str, foot: float) -> None:
        """Draw posts under both ends of the beam, down to a height [m]."""
        axis = int(np.argmax((self.box.high - self.box.low)[:2]))
        for sign in (-1.0, 1.0):
            post = self.box.side(axis, sign, 2.0 * self.beam).between(2, foot, self.box.low[2])
            self.add(link, "post", post)
            self.feet.append(post)

    def _columns(self, joint: Joint, foot: float) -> None:
        """Draw columns at the ends of a beam that rises and falls."""
        rise = float(self.site.direction(joint) @ UP)
        high = max(rise * value for value in self.site.stroke(joint))
        axis = int(np.argmax((self.box.high - self.box.low)[:2]))
        for sign in (-1.0, 1.0):
            column = self.box.side(axis, sign, 2.4 * self.beam, outside=True)
            column = column.between(2, foot, self.box.high[2] + high)
            self.add(joint.parent, "column", column)
            self.feet.append(column)

    def _rails(self, joint: Joint, along: Vector) -> None:
        """Draw rails on the floor under what stands, over the stroke, on the parent."""
        low, high = self.site.stroke(joint)
        feet, self.feet = self.feet, []
        for foot in feet:
            rail = foot.moved(along, low, high).between(2, self.floor, self.floor + self._rail)
            self.add(joint.parent, "guide", rail)
            self.feet.append(rail)

    def _column(self) -> None:
        """Draw a column behind the table with an arm to the ram."""
        self._carriage(BASE_LINK, 1)
        far = self.site.tip[1] + self.R if self.table is None else self.table.foot[1] + self.table.half[1]
        face = max(float(far) + 0.3 * self.R, float(self.box.high[1]) + self.r)
        arm = self.box.between(1, self.box.high[1], face)
        self.add(BASE_LINK, "beam", arm)
        wide, centre = max(float(arm.high[0] - arm.low[0]) / 2, 0.5 * self.R), (arm.low[0] + arm.high[0]) / 2
        deep = max(6.0 * self.r, self.R)
        column = arm.between(0, centre - wide, centre + wide).between(1, face, face + deep)
        self.add(BASE_LINK, "column", column.between(2, self.floor, arm.high[2]))

    def _bed(self) -> None:
        """Draw the slab everything stands on, and the pedestal of a table or the bed with the part."""
        if self.table is None:
            self._part()
        else:
            self.bodies += pedestal(self.site, self.table, self.floor)
            reach = np.append(self.table.half, 0.0)
            low, high = self.table.foot - reach, self.table.foot + reach
            self.around = _Box(np.minimum(self.around.low, low), np.maximum(self.around.high, high))
        margin = np.array([self.beam, self.beam, 0.0])
        slab = _Box(self.around.low - margin, self.around.high + margin)
        self.add(BASE_LINK, "bed", slab.between(2, self.floor - max(0.2 * self.R, self.r), self.floor))

    def _part(self) -> None:
        """Draw a bed where the tip reaches, and the part on it under the tip."""
        site, R, top = self.site, self.R, self._bed_top()
        at = np.array([*site.tip[:2], 0.0])
        bed = _Box(at - R, at + R)
        for joint in leading_slides(site.tool_path):
            if not _rises(site, joint):
                bed = bed.moved(site.direction(joint), *(0.6 * value for value in site.stroke(joint)))
        self.add(BASE_LINK, "pedestal", bed.between(2, self.floor, top))
        half, room = _PART_WIDTH * R / 2, lowest_tip(site) - top
        part = _Box(at - half, at + half).between(2, top, top + _PART_HEIGHT * room)
        self.bodies.append(site.box(BASE_LINK, "workpiece", part.low, part.high, colour=PART_COLOUR))


def _rises(site: Site, joint: Joint) -> bool:
    return abs(float(site.direction(joint) @ UP)) > _UPRIGHT
