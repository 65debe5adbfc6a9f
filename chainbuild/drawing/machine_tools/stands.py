"""What carries the head of a machine tool: ram, carriage, beam, rails, posts or a column, and the bed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import Body, Part
from chainbuild.chain.bodies.geometry import ColumnSide
from chainbuild.chain.elements import BASE_LINK, Joint
from chainbuild.drawing.machine_tools.heads import Head, head_of
from chainbuild.drawing.machine_tools.tables import (
    PART_HEIGHT,
    PART_WIDTH,
    WorkTable,
    leading_slides,
    lowest,
    part_on,
    pedestal,
    plate_radius,
    worktable,
)
from chainbuild.drawing.site import UP, Site

_UPRIGHT: Final = 0.94  # cosine: a steeper slide is a ram
_BEAM_SHARE: Final = 0.04  # half of a beam's width over the longest stroke
_ROOM_SHARE: Final = 0.55  # of the radius a plate would have, between bed and lowest tip: where the part stands
_BED: Final = 0.6  # of the strokes that the bed fills
_JACK: Final = 1.2  # height of a sleeve over the stroke of the pillar that rises from it
_PILLAR: Final = 1.1  # and of the pillar, which must neither leave it nor reach the floor
_BEHIND: Final = (-1.0, 1.0)  # side on which a beam runs, away from whoever looks: -x, +y


def machine_tool_bodies(site: Site) -> list[Body]:
    """Return the bodies of a machine tool: head, slides and what carries the workpiece."""
    slides = leading_slides(site.tool_path)
    head = head_of(site, site.tool_path[len(slides) :])
    table = worktable(site, head.low) if site.workpiece_path else None
    return _Stand(site, slides, head, table).bodies


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

    def __init__(self, site: Site, slides: Sequence[Joint], head: Head, table: WorkTable | None) -> None:
        self.site, self.head, self.table, self.r = site, head, table, head.radius
        self.bodies = [*head.bodies, *(table.bodies if table else [])]
        strokes = [high - low for low, high in map(site.stroke, slides)]
        self.beam = max(0.8 * self.r, _BEAM_SHARE * max(strokes, default=0.0))  # half of a beam's width
        self.R = plate_radius(site)
        self.style = site.chain.geometry.stand.style
        self.behind, self.side = _behind(site.chain.geometry.stand.column)
        self.floor = self._floor()
        self.ground = self._ground(slides)
        cap = np.array([1.6 * self.r, 1.6 * self.r, 0.0])
        self.box, self.is_beam = _Box(head.top - cap, head.top + cap), False
        self.feet: list[_Box] = []
        self.around = _Box(self.box.low.copy(), self.box.high.copy())
        for n, joint in enumerate(reversed(slides)):
            self._slide(joint, moves_on=any(not _rises(site, other) for other in slides[: len(slides) - n - 1]))
        if not self.feet:
            self._still()
        self._bed()

    def add(self, link: str, part: Part, box: _Box) -> None:
        self.bodies.append(self.site.box(link, part, box.low, box.high))
        self.around = _Box(np.minimum(self.around.low, box.low), np.maximum(self.around.high, box.high))

    def _floor(self) -> float:
        """Return the height [m] of the floor: under the table, or below the bed on which the part stands."""
        if self.table is not None:
            return float(self.table.foot[2]) - 0.35 * self.R
        return self._bed_top() - 0.5 * self.R

    def _ground(self, slides: Sequence[Joint]) -> float:
        """Return the height [m] on which rails lie: the floor, or what lifts all that stands on them."""
        for n, joint in enumerate(slides):
            if _rises(self.site, joint) and sum(not _rises(self.site, other) for other in slides[n:]) > 1:
                low, high = self._rise(joint)
                return self.floor + _JACK * (high - low) - low
        return self.floor

    def _rise(self, joint: Joint) -> tuple[float, float]:
        """Return how far [m] an upright slide goes down and up from home."""
        low, high = sorted(float(self.site.direction(joint) @ UP) * value for value in self.site.stroke(joint))
        return low, high

    def _bed_top(self) -> float:
        return lowest(self.site, self.head.low) - max(_ROOM_SHARE * self.R, 4.0 * self.r)

    @property
    def _rail(self) -> float:
        return 0.8 * self.beam  # height of a rail on the floor

    def _slide(self, joint: Joint, *, moves_on: bool) -> None:
        """Draw one slide.

        Args:
            joint: Its joint.
            moves_on: Whether a level slide moves all of it: what stands then stands on rails.
        """
        along, foot = self.site.direction(joint), self.ground + (self._rail if moves_on else 0.0)
        if _rises(self.site, joint):
            if self.feet:
                self._jacks(joint)
            elif self.is_beam:
                self._columns(joint, foot)
            else:
                self._ram(joint)
        elif self.feet:
            self._rails(joint, along)
        elif self.is_beam:
            self._end_posts(joint.child, self.ground + self._rail)
            self._rails(joint, along)
        else:
            self._beam(joint, along)

    def _ram(self, joint: Joint) -> None:
        """Draw a ram over its stroke; what guides it begins above the head at the upper limit."""
        low, high = self._rise(joint)
        bottom = float(self.box.low[2]) + high + 0.5 * self.r
        top = bottom + max(6.0 * self.r, 2.0 * self.beam)
        self.add(joint.child, "ram", self.box.between(2, self.box.low[2], top - low))
        self.box = self.box.between(2, bottom, top)

    def _carriage(self, link: str, behind: int) -> None:
        """Draw the carriage behind what is held, and hold that instead."""
        if self.box.high[2] - self.box.low[2] < self.r:  # a head without ram: the carriage sits on its top
            self.box = self.box.between(2, self.box.low[2], self.box.low[2] + max(4.0 * self.r, 2.0 * self.beam))
        else:
            side = 1 - behind
            for sign in (-1.0, 1.0):  # it clasps the ram
                self.add(link, "carriage", self.box.side(side, sign, 0.8 * self.r, outside=True))
            self.box = self.box.side(behind, self.behind[behind], 1.2 * self.r, outside=True)
            self.box = self.box.between(side, self.box.low[side] - 0.8 * self.r, self.box.high[side] + 0.8 * self.r)
        self.add(link, "carriage", self.box)

    def _beam(self, joint: Joint, along: Vector) -> None:
        """Draw the carriage on the child and the beam over its stroke, behind it, on the parent."""
        axis = int(np.argmax(np.abs(along)))
        self._carriage(joint.child, 1 - axis)
        if self.style == "column":
            self._arm(joint.child, 1 - axis)
        low, high = self.site.stroke(joint)
        room = self.head.half + 1.5 * self.r + 2.0 * self.beam  # for the head beside the posts, and the posts
        self._lay(joint.parent, self.box.moved(along, low - room, high + room), axis)

    def _lay(self, link: str, reach: _Box, axis: int) -> None:
        """Draw a beam along an axis behind what it has to reach, and hold that."""
        box = reach.side(1 - axis, self.behind[1 - axis], 2.0 * self.beam, outside=True)
        box = box.between(axis, *self._beyond_table(axis, box))
        self.add(link, "beam", box)
        self.box, self.is_beam = box, True

    def _arm(self, link: str, axis: int) -> None:
        """Draw an arm from what is held to behind the table, and hold its end."""
        sign = self.behind[axis]
        if self.table is None:
            far = float(self._bed_box().side(axis, sign, 0.0).low[axis])
        else:
            far = float(self.table.foot[axis] + sign * self.table.half[axis])
        face = max(
            far * sign + 0.3 * self.R, float(max(sign * self.box.low[axis], sign * self.box.high[axis])) + self.r
        )
        near = self.box.high[axis] if sign > 0.0 else self.box.low[axis]
        arm = self.box.between(axis, *sorted((float(near), sign * face)))
        self.add(link, "beam", arm)
        self.box = arm.side(axis, sign, self.r)

    def _beyond_table(self, axis: int, box: _Box) -> tuple[float, float]:
        """Return the ends of a beam along an axis, so that posts under them stand beside the table."""
        low, high = float(box.low[axis]), float(box.high[axis])
        if self.table is None:
            return low, high
        middle, half = self.table.foot[axis], self.table.half[axis] + 3.0 * self.beam + 0.1 * self.R
        return min(low, float(middle - half)), max(high, float(middle + half))

    def _end_posts(self, link: str, foot: float) -> None:
        """Draw what carries the beam, down to a height [m]: posts under both ends, or one column in the middle."""
        axis = int(np.argmax((self.box.high - self.box.low)[:2]))
        if self.style == "column":
            middle, half = (self.box.low[axis] + self.box.high[axis]) / 2, 0.15 * (self.box.high - self.box.low)[axis]
            posts = [self.box.between(axis, float(middle - half), float(middle + half))]
        else:
            posts = [self.box.side(axis, sign, 2.0 * self.beam) for sign in (-1.0, 1.0)]
        for post in posts:
            self.feet.append(post.between(2, foot, self.box.low[2]))
            self.add(link, "column" if self.style == "column" else "post", self.feet[-1])

    def _columns(self, joint: Joint, foot: float) -> None:
        """Draw columns at the ends of a beam that rises and falls."""
        high = self._rise(joint)[1]
        axis = int(np.argmax((self.box.high - self.box.low)[:2]))
        for sign in (-1.0, 1.0):
            column = self.box.side(axis, sign, 2.4 * self.beam, outside=True)
            column = column.between(2, foot, self.box.high[2] + high)
            self.add(joint.parent, "column", column)
            self.feet.append(column)

    def _jacks(self, joint: Joint) -> None:
        """Draw a pillar under both ends of every foot, in sleeves that they rise from, on the parent."""
        low, high = self._rise(joint)
        feet, self.feet = self.feet, []
        for foot in feet:
            axis = int(np.argmax((foot.high - foot.low)[:2]))
            for sign in (-1.0, 1.0):
                sleeve = foot.side(axis, sign, 2.0 * self.beam)
                pillar = _Box(sleeve.low + 0.3 * self.beam, sleeve.high - 0.3 * self.beam)
                self.add(joint.child, "slide", pillar.between(2, self.ground - _PILLAR * (high - low), self.ground))
                sleeve = sleeve.between(2, self.floor, self.ground + low)
                self.add(joint.parent, "column", sleeve)
                self.feet.append(sleeve)
        self.ground = self.floor

    def _rails(self, joint: Joint, along: Vector) -> None:
        """Draw rails on the floor under what stands, over the stroke, on the parent."""
        low, high = self.site.stroke(joint)
        feet, self.feet = self.feet, []
        for foot in feet:
            rail = foot.moved(along, low - self.beam, high + self.beam).between(
                2, self.ground, self.ground + self._rail
            )
            self.add(joint.parent, "guide", rail)
            shoe = foot.moved(along, -self.beam, self.beam)
            self.add(joint.child, "slide", shoe.between(2, self.ground + self._rail, self.ground + 1.8 * self._rail))
            self.feet.append(rail.between(2, self.ground, self.ground + self._rail))

    def _still(self) -> None:
        """Draw what carries the last slide where the base does: posts, a portal, or a column with an arm to the ram."""
        if self.is_beam:
            self._end_posts(BASE_LINK, self.floor)
            return
        self._carriage(BASE_LINK, self.side)
        if self.style == "portal":
            room = self.head.half + 1.5 * self.r + 2.0 * self.beam
            self._lay(BASE_LINK, self.box.moved(np.eye(3)[1 - self.side], -room, room), 1 - self.side)
            self._end_posts(BASE_LINK, self.floor)
            return
        self._arm(BASE_LINK, self.side)
        across, held = 1 - self.side, self.box
        wide = max(float((held.high - held.low)[across]) / 2, 0.5 * self.R)
        middle = float((held.low + held.high)[across]) / 2
        column = held.side(self.side, self.behind[self.side], max(6.0 * self.r, self.R), outside=True)
        column = column.between(across, middle - wide, middle + wide)
        self.add(BASE_LINK, "column", column.between(2, self.floor, held.high[2]))

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

    def _bed_box(self) -> _Box:
        """Return the bed where the tip reaches, without its heights."""
        at = np.array([*self.site.tip[:2], 0.0])
        bed = _Box(at - self.R, at + self.R)
        for joint in leading_slides(self.site.tool_path) if self.site.chain.geometry.stand.table is None else ():
            if not _rises(self.site, joint):
                bed = bed.moved(self.site.direction(joint), *(_BED * value for value in self.site.stroke(joint)))
        return bed

    def _part(self) -> None:
        """Draw a bed where the tip reaches, and the part on it under the tip."""
        top = self._bed_top()
        self.add(BASE_LINK, "pedestal", self._bed_box().between(2, self.floor, top))
        room = lowest(self.site, self.head.low) - top
        at = np.array([*self.site.tip[:2], top])
        self.bodies += part_on(self.site, BASE_LINK, at, PART_WIDTH * self.R, PART_HEIGHT * room)


def _behind(column: ColumnSide | None) -> tuple[tuple[float, float], int]:
    """Return the signs of the sides of x and y on which beams run, and the axis on whose side a column stands."""
    signs, axis = list(_BEHIND), 1
    if column is not None:
        axis = "xy".index(column[1])
        signs[axis] = 1.0 if column[0] == "+" else -1.0
    return (signs[0], signs[1]), axis


def _rises(site: Site, joint: Joint) -> bool:
    return abs(float(site.direction(joint) @ UP)) > _UPRIGHT
