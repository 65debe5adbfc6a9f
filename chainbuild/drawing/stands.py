"""What carries the head of a machine tool: ram, carriage, beam, rails, posts or a column, and the bed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.body import PART_COLOUR, Body
from chainbuild.chain.elements import BASE_LINK, Joint
from chainbuild.drawing.heads import Head, head_of
from chainbuild.drawing.site import UP, Site
from chainbuild.drawing.tables import Table, lowest_tip, pedestal, plate_radius, table_of

_UPRIGHT: Final = 0.94  # cosine: a steeper slide is a ram
_ROOM_SHARE: Final = 0.12  # of the shorter stroke, between bed and lowest tip: where the part stands
_PART_WIDTH: Final = 0.7  # over the radius a plate would have
_PART_HEIGHT: Final = 0.6  # over the room below the lowest tip


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
class _Held:
    """A box along the site's axes that has to be held: its corners (3,) [m]."""

    low: Vector
    high: Vector


class _Stand:
    """Builds from the head outwards to the base: each slide holds the box that the one before left."""

    def __init__(self, site: Site, slides: Sequence[Joint], head: Head, table: Table | None) -> None:
        self.site, self.head, self.table = site, head, table
        self.bodies = [*head.bodies, *(table.bodies if table else [])]
        self.r = head.radius
        strokes = [site.stroke(joint) for joint in slides]
        longest = max((high - low for low, high in strokes), default=4 * self.r)
        self.beam = max(1.6 * self.r, 0.055 * longest)  # half of a beam's width
        self.R = plate_radius(site)
        self.floor = self._floor()
        self.held = self._cap()
        self.footprint = [self.held.low.copy(), self.held.high.copy()]
        placed = False
        for n, joint in enumerate(reversed(slides)):
            outer = len(slides) - n - 1
            along = site.direction(joint)
            if abs(along @ UP) > _UPRIGHT:
                self._ram(joint, first=n == 0)
            elif not placed:
                self._beam(joint, along)
                placed = True
            else:
                self._rails(joint, along)
            if outer == 0 and joint.parent == BASE_LINK:
                self._to_floor(along, placed)
        if not slides:
            self._to_floor(UP, placed)
        self._bed()

    def add(self, link: str, part: str, low: Vector, high: Vector) -> None:
        self.bodies.append(self.site.box(link, part, low, high))  # type: ignore[arg-type]

    def _floor(self) -> float:
        """Return the height [m] of the floor: under the table, or below the bed on which the part stands."""
        if self.table is not None:
            return float(self.table.foot[2]) - 0.35 * self.R
        return self._bed_top() - 0.5 * self.R

    def _bed_top(self) -> float:
        room = max(_ROOM_SHARE * 2.0 * self.R / 0.45, 4.0 * self.r)
        return lowest_tip(self.site) - room

    def _cap(self) -> _Held:
        """Return the box on top of the head that slides hold."""
        half = np.array([1.6 * self.r, 1.6 * self.r, 0.0])
        return _Held(self.head.top - half, self.head.top + half + 0.0 * UP)

    def _behind(self, along: Vector) -> Vector:
        """Return the level direction (3,) on whose side a beam runs: behind, as pictures show the machine."""
        side = np.cross(UP, along)
        side = side / np.linalg.norm(side)
        flip: Vector = side if side @ np.array([-0.5, 1.0, 0.0]) > 0.0 else -side
        return flip

    def _ram(self, joint: Joint, *, first: bool) -> None:
        """Draw a ram over its stroke and the carriage beside it; a beam that rises gets two columns."""
        rise = float(self.site.direction(joint) @ UP)
        low, high = sorted(rise * value for value in self.site.stroke(joint))
        if not first:
            self._columns(joint, low, high)
            return
        r, held = self.r, self.held
        bottom = float(held.low[2]) + high + 0.5 * r
        top = bottom + max(6.0 * r, 2.0 * self.beam)
        self.add(joint.child, "ram", held.low, np.array([*held.high[:2], top - low]))
        self.ram = held
        behind = np.array([0.0, 1.0, 0.0])
        self._pending = (joint.parent, bottom, top, behind)
        self.held = _Held(np.array([*held.low[:2], bottom]), np.array([*held.high[:2], top]))

    def _carriage(self, link: str, behind: Vector) -> None:
        """Draw the carriage behind the held box, and hold that instead."""
        r, held = self.r, self.held
        if held.high[2] - held.low[2] < r:  # a head without ram: the carriage sits on its top
            held = _Held(held.low, held.high + max(4.0 * r, 2.0 * self.beam) * UP)
            self.add(link, "carriage", held.low, held.high)
            self.held = held
            return
        centre = (held.low + held.high) / 2
        half = (held.high - held.low) / 2
        reach = float(np.abs(half @ np.abs(behind)))
        side = np.abs(np.cross(UP, behind))
        a = centre + behind * reach - side * 2.4 * r - half[2] * UP
        b = centre + behind * (reach + 1.2 * r) + side * 2.4 * r + half[2] * UP
        low, high = np.minimum(a, b), np.maximum(a, b)
        self.add(link, "carriage", low, high)
        self.held = _Held(low, high)

    def _beam(self, joint: Joint, along: Vector) -> None:
        """Draw the carriage on the child and the beam over its stroke, behind it, on the parent."""
        behind = self._behind(along)
        self._carriage(joint.child, behind)
        low, high = self.site.stroke(joint)
        held = self.held
        clear = self.head.half + 1.2 * self.r
        span = _spanned(held, along, low - clear, high + clear)
        reach = float((np.maximum(held.low * behind, held.high * behind)).sum())
        depth = 2.0 * self.beam
        a, b = span
        flat = 1.0 - np.abs(behind)
        a, b = a * flat + behind * reach, b * flat + behind * (reach + depth)
        box = _Held(np.minimum(a, b), np.maximum(a, b))
        self.add(joint.parent, "beam", box.low, box.high)
        self.held = box
        self._grow(box)

    def _rails(self, joint: Joint, along: Vector) -> None:
        """Draw two rails under the ends of the beam, over the stroke, on the parent."""
        low, high = self.site.stroke(joint)
        held = self.held
        wide = np.abs(self._behind(along))
        b, drop = self.beam, 1.6 * self.beam
        low_end, high_end = _spanned(held, along, low, high)
        self.rails = []
        for sign in (-1.0, 1.0):
            edge = held.low if sign < 0 else held.high
            inner = float((edge * wide).sum())
            # The rail lies under the beam's end, and the beam reaches to its outer edge.
            a = low_end * (1 - wide) + wide * (inner - sign * 0.0)
            c = high_end * (1 - wide) + wide * (inner - sign * 2.0 * b)
            a[2], c[2] = held.low[2] - drop, held.low[2]
            rail = _Held(np.minimum(a, c), np.maximum(a, c))
            self.add(joint.parent, "guide", rail.low, rail.high)
            self.rails.append(rail)
            self._grow(rail)
        self.along = along

    def _columns(self, joint: Joint, low: float, high: float) -> None:
        """Draw two columns at the ends of a beam that rises and falls with a slide."""
        held, b = self.held, 1.2 * self.beam
        axis = int(np.argmax(held.high - held.low))
        for sign in (-1.0, 1.0):
            edge = held.low if sign < 0 else held.high
            a, c = held.low.copy(), held.high.copy()
            a[axis], c[axis] = sorted((edge[axis], edge[axis] + sign * 2.0 * b))
            a[2], c[2] = self.floor, held.high[2] + high
            self.add(joint.parent, "column", a, c)
            self._grow(_Held(a, c))
        self.posted = True

    def _to_floor(self, along: Vector, placed: bool) -> None:
        """Hold what the last slide left by posts under rails, end posts under a beam, or a column behind."""
        if getattr(self, "posted", False):
            return
        rails = getattr(self, "rails", None)
        b = self.beam
        if rails:
            axis = int(np.argmax(np.abs(self.along)))
            for rail in rails:
                for sign in (-1.0, 1.0):
                    a, c = rail.low.copy(), rail.high.copy()
                    if sign < 0:
                        c[axis] = a[axis] + 2.0 * b
                    else:
                        a[axis] = c[axis] - 2.0 * b
                    a[2], c[2] = self.floor, rail.low[2]
                    self.add(BASE_LINK, "post", a, c)
            return
        if placed:
            self._end_posts()
            return
        self._column()

    def _end_posts(self) -> None:
        held, b = self.held, self.beam
        axis = int(np.argmax((held.high - held.low)[:2]))
        for sign in (-1.0, 1.0):
            a, c = held.low.copy(), held.high.copy()
            if sign < 0:
                c[axis] = a[axis] + 2.0 * b
            else:
                a[axis] = c[axis] - 2.0 * b
            a[2], c[2] = self.floor, held.low[2]
            self.add(BASE_LINK, "post", a, c)

    def _column(self) -> None:
        """Draw a column behind the table with an arm to the ram."""
        behind = np.array([0.0, 1.0, 0.0])
        link = BASE_LINK
        self._carriage(link, behind)
        held, r = self.held, self.r
        far = float(self.table.foot[1] + self.table.half[1]) if self.table is not None else float(self.site.tip[1] + self.R)
        face = max(far + 0.3 * self.R, float(held.high[1]) + r)
        deep = max(3.0 * r, 0.5 * self.R)
        self.add(link, "beam", np.array([held.low[0], held.high[1], held.low[2]]), np.array([held.high[0], face, held.high[2]]))
        wide = max(float(held.high[0] - held.low[0]) / 2, 0.5 * self.R)
        centre = float(held.low[0] + held.high[0]) / 2
        a, c = np.array([centre - wide, face, self.floor]), np.array([centre + wide, face + 2 * deep, held.high[2]])
        self.add(link, "column", a, c)
        self._grow(_Held(a, c))

    def _grow(self, box: _Held) -> None:
        self.footprint = [np.minimum(self.footprint[0], box.low), np.maximum(self.footprint[1], box.high)]

    def _bed(self) -> None:
        """Draw the slab everything stands on, and the pedestal of a table or the bed with the part."""
        site, (low, high) = self.site, self.footprint
        if self.table is not None:
            self.bodies += pedestal(site, self.table, self.floor)
            reach = np.append(self.table.half, 0.0)
            low, high = np.minimum(low, self.table.foot - reach), np.maximum(high, self.table.foot + reach)
        thick = max(0.25 * self.R, self.r)
        margin = np.array([self.beam, self.beam, 0.0])
        a, c = low - margin, high + margin
        a[2], c[2] = self.floor - thick, self.floor
        self.add(BASE_LINK, "bed", a, c)
        if self.table is None:
            self._part(a, c)

    def _part(self, low: Vector, high: Vector) -> None:
        tip, R, top = self.site.tip, self.R, self._bed_top()
        half = np.array([1.2 * R, 0.9 * R, 0.0])
        at = np.array([tip[0], tip[1], 0.0])
        self.add(BASE_LINK, "pedestal", at - half + self.floor * UP, at + half + top * UP)
        room = lowest_tip(self.site) - top
        block = np.array([_PART_WIDTH * R / 2, _PART_WIDTH * R / 2, 0.0])
        self.bodies.append(
            self.site.box(
                BASE_LINK, "workpiece", at - block + top * UP, at + block + (top + _PART_HEIGHT * room) * UP,
                colour=PART_COLOUR,
            )  # fmt: skip
        )


def _spanned(held: _Held, along: Vector, low: float, high: float) -> tuple[Vector, Vector]:
    """Return the corners of a box that moves from `low` to `high` along a direction [m]."""
    ends = [corner + along * value for corner in (held.low, held.high) for value in (low, high)]
    return np.min(ends, axis=0), np.max(ends, axis=0)
