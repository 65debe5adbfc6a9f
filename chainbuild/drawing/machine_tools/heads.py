"""Heads of machine tools, from the tip up: tool, spindle, then a yoke, a disc or a slanted housing for every axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.body import JOINT_COLOUR, TOOL_COLOUR, Body
from chainbuild.chain.elements import Joint
from chainbuild.drawing.site import UP, Site, upright_frame
from chainbuild.frames import rot_x, unit

# Sines: an axis nearer to upright turns a disc, one nearer to level turns in a yoke, others in slanted housings.
_UPRIGHT: Final = 0.94
_LEVEL: Final = 0.35
# The radius of the spindle, which everything else is a multiple of.
_REACH_SHARE: Final = 0.22  # of the distance from the last axis to the tip
_OFFSET_SHARE: Final = 0.3  # of the smallest distance between two axes: yokes fit between them
_THICK: Final = 0.09  # m: no thicker than that
_THIN: Final = 0.012  # m: what would be thinner measures a head whose axes meet at the tip
_STUB: Final = 0.3  # of the spindle's radius: a shorter tool cannot be seen, and is drawn longer
_ARC_PIECES: Final = 7  # straight pieces of an arc
_TOWARDS: Final = np.array([0.5, -0.7, 0.5])  # direction from which pictures show a machine, roughly
_UNKNOWN: Final = 0.05  # m: where nothing tells
_STROKE_SHARE: Final = 0.08  # of the shortest slide, likewise
_TOOL_SHARE: Final = 0.35  # of the way to the last axis, where no tool is named: the tool


@dataclass
class Head:
    """What hangs below the slides.

    Attributes:
        radius: Radius of the spindle [m].
        link: Link that carries the head.
        top: Point (3,) where it is fixed.
        half: Half of its width across any horizontal direction [m].
        low: Height of its lowest point at home [m].
        bodies: Its bodies.
    """

    radius: float
    link: str
    top: Vector
    half: float = 0.0
    low: float = 0.0
    bodies: list[Body] = field(default_factory=list)


def head_of(site: Site, joints: Sequence[Joint]) -> Head:
    """Return the head of a machine tool.

    Args:
        site: The machine.
        joints: The joints after the slides, in order from the base to the tool.
    """
    return _Drawing(site, joints).head


def spindle_radius(site: Site, joints: Sequence[Joint]) -> float:
    """Return the radius [m] of the spindle: by the distances between rotary axes and from the last to the tip."""
    points = [site.origin(joint) for joint in joints if joint.kind == "revolute"]
    shares = [_OFFSET_SHARE * float(np.linalg.norm(b - a)) for a, b in pairwise(points)]
    shares += [_REACH_SHARE * float(np.linalg.norm(site.tip - points[-1]))] if points else []
    known = [share for share in shares if share > _THIN]
    if known:
        return min(*known, _THICK)
    strokes = [
        high - low for low, high in (site.stroke(joint) for joint in site.tool_path if joint.kind == "prismatic")
    ]
    return min([_UNKNOWN, *(_STROKE_SHARE * stroke for stroke in strokes)])


class _Drawing:
    """Builds a head from the tip up. `top` is where the part drawn last has to be held."""

    def __init__(self, site: Site, joints: Sequence[Joint]) -> None:
        self.site = site
        self.r = spindle_radius(site, joints)
        tool = site.chain.frame("tool").link
        self.head = Head(self.r, tool, site.tip)
        self.top = self._spindle(joints)
        self.half = 1.2 * self.r
        for joint in reversed(joints):
            self._joint(joint)
        self.head.link = joints[0].parent if joints else tool
        self.head.top, self.head.half = self.top, self.half
        self.head.low = min(float(site.bounds(body)[0, 2]) for body in self.head.bodies)

    def add(self, *bodies: Body) -> None:
        self.head.bodies.extend(bodies)

    def _spindle(self, joints: Sequence[Joint]) -> Vector:
        """Draw tool and spindle; return the point of the spindle next to the last axis."""
        site, r, link = self.site, self.r, self.head.link
        tip, flange = site.tip, site.frame("flange")
        back = site.tool_direction
        nose = flange[:3, 3]
        last = next((joint for joint in reversed(joints) if joint.kind == "revolute"), None)
        reach = float((site.origin(last) - tip) @ back) if last is not None else 0.0
        same = site.chain.frame("flange").link == link
        if not same or np.linalg.norm(nose - tip) < _STUB * r:
            nose = tip + back * (_TOOL_SHARE * reach if reach > 2.0 * r else 1.5 * r)
        self.add(site.cylinder(link, "tool", tip, nose, 0.3 * r, colour=TOOL_COLOUR, origin="data"))
        length = float((site.origin(last) - nose) @ back) if last is not None else 2.5 * r
        end = nose + back * (length if length > 1.2 * r else 3.0 * r)
        step = nose + 0.35 * (end - nose)
        self.add(site.cylinder(link, "flange", nose, step, 0.68 * r, colour=JOINT_COLOUR))
        self.add(site.cylinder(link, "spindle", step, end, r))
        return end

    def _joint(self, joint: Joint) -> None:
        if joint.kind == "prismatic":
            self._slide(joint)
            return
        rise = abs(float(self.site.direction(joint) @ UP))
        if rise > _UPRIGHT:
            self._disc(joint)
        elif rise < _LEVEL:
            self._yoke(joint)
        else:
            self._slanted(joint)

    def _bar(self, link: str, start: Vector, end: Vector, width: float) -> None:
        """Draw a bar between two points, none where they coincide."""
        if np.linalg.norm(end - start) > 1e-4:
            self.add(self.site.cylinder(link, "neck", start, end, width))

    def _disc(self, joint: Joint) -> None:
        """Draw a disc about an upright axis, above what it carries."""
        site, r = self.site, self.r
        axis = site.origin(joint)
        below = np.array([axis[0], axis[1], self.top[2]])
        lift = max(self.top[2] + 1.4 * r, min(axis[2], self.top[2] + 6.0 * r))
        if np.linalg.norm(below - self.top) > 0.3 * r:
            self._bar(joint.child, self.top, below, 0.8 * r)
            self.add(site.ball(joint.child, "neck", below, 0.8 * r))
        under, over = (np.array([axis[0], axis[1], z]) for z in (lift, lift + 0.6 * r))
        self._bar(joint.child, below, under, 1.0 * r)
        self.add(site.cylinder(joint.child, "plate", under, over, 1.9 * r))
        seam, housing = over + 0.14 * r * UP, over + 1.0 * r * UP
        self.add(site.cylinder(joint.child, "joint", over, seam, 1.66 * r, colour=JOINT_COLOUR))
        self.add(site.cylinder(joint.parent, "housing", seam, housing, 1.6 * r))
        self.half = max(1.9 * r, self.half + float(np.linalg.norm(below[:2] - self.top[:2])))
        self.top = housing

    def _yoke(self, joint: Joint) -> None:
        """Draw two cheeks and a bridge on the parent, an axle on the child."""
        site, r = self.site, self.r
        axis, along = site.origin(joint), site.direction(joint)
        foot = axis + along * float((self.top - axis) @ along)
        reach = float(np.linalg.norm(self.top - foot))
        beside = float(np.linalg.norm(np.cross(self.top - foot, UP)))
        low = float((foot - self.top) @ UP) < -0.6 * r and beside < 0.3 * r
        if low and reach > 1.2 * r and not self._is_inner(joint):
            self._arc(joint, foot)
            return
        side = max(self.half if self._is_inner(joint) else 1.0 * r, 1.0 * r) + 0.25 * r
        if self._is_inner(joint) and self.top[2] > axis[2] + 0.5 * r:
            self._ears(joint, foot, side)
            rise = self.top[2] - axis[2] + 0.6 * r
        else:
            self._bar(joint.child, self.top, foot, 0.8 * r)
            rise = 1.9 * r
        pin = (side + 0.6 * r) * along  # through the cheeks: it is seen from outside
        self.add(site.cylinder(joint.child, "joint", foot - pin, foot + pin, 0.6 * r, colour=JOINT_COLOUR))
        R = upright_frame(along)
        for sign in (-1.0, 1.0):
            a = [sign * side, -0.85 * r, -0.85 * r]
            b = [sign * (side + 0.5 * r), 0.85 * r, rise + 0.5 * r]
            self.add(site.box(joint.parent, "cheek", a, b, R, foot))
        a = [-side - 0.5 * r, -0.85 * r, rise]
        b = [side + 0.5 * r, 0.85 * r, rise + 0.55 * r]
        self.add(site.box(joint.parent, "bridge", a, b, R, foot))
        self.half = max(self.half, side + 0.6 * r)
        self.top = foot + (rise + 0.55 * r) * R[:, 2]

    def _is_inner(self, joint: Joint) -> bool:
        """Return whether what hangs in a yoke carries a yoke of its own."""
        path = self.site.tool_path
        place = next(n for n, other in enumerate(path) if other.name == joint.name)
        return any(other.kind == "revolute" for other in path[place + 1 :])

    def _ears(self, joint: Joint, foot: Vector, side: float) -> None:
        """Draw what holds the axle where the inner yoke reaches above it: a crossbar with ears."""
        site, r = self.site, self.r
        R = upright_frame(site.direction(joint))
        over = float((self.top - foot) @ R[:, 2])
        for sign in (-1.0, 1.0):
            a = [sign * (side - 0.25 * r), -0.5 * r, -0.5 * r]
            b = [sign * (side - 0.02 * r), 0.5 * r, over]
            self.add(site.box(joint.child, "cheek", a, b, R, foot))
        a = [-side, -0.5 * r, over - 0.4 * r]
        b = [side, 0.5 * r, over]
        self.add(site.box(joint.child, "bridge", a, b, R, foot))

    def _arc(self, joint: Joint, foot: Vector) -> None:
        """Draw an arc beside a spindle that swings about its tip, and the carriage that runs on it."""
        site, r = self.site, self.r
        along = site.direction(joint)
        R = upright_frame(-along if along @ _TOWARDS > 0.0 else along)  # the plate behind, the spindle seen
        reach = float((self.top - foot) @ R[:, 2])
        low, high = site.stroke(joint)
        swing = min(max(-low, high), np.pi / 3)
        half = (reach + r) * float(np.sin(swing)) + r
        a, b = [0.5 * r, -0.7 * r, reach - 1.4 * r], [1.3 * r, 0.7 * r, reach]
        self.add(site.box(joint.child, "carriage", a, b, R, foot, colour=JOINT_COLOUR))
        middle, step = reach - 0.7 * r, 2.0 * swing / _ARC_PIECES
        chord = (middle + 0.6 * r) * float(np.tan(step / 2.0))
        for n in range(_ARC_PIECES):
            turned = R @ rot_x(float(np.degrees(-swing + (n + 0.5) * step)))
            a, b = [1.3 * r, -chord, middle - 0.6 * r], [1.9 * r, chord, middle + 0.6 * r]
            self.add(site.box(joint.parent, "guide", a, b, turned, foot))
        self.add(
            site.box(joint.parent, "cheek", [1.3 * r, -0.8 * r, middle], [1.9 * r, 0.8 * r, reach + 0.9 * r], R, foot)
        )
        a, b = [-0.9 * r, -0.9 * r, reach + 0.3 * r], [1.9 * r, 0.9 * r, reach + 0.9 * r]
        self.add(site.box(joint.parent, "bridge", a, b, R, foot))
        self.half = max(self.half, half)
        self.top = foot + (reach + 0.9 * r) * R[:, 2]

    def _slanted(self, joint: Joint) -> None:
        """Draw a disc on the child and a housing on the parent, both about a slanted axis."""
        site, r = self.site, self.r
        axis, along = site.origin(joint), site.direction(joint)
        along = along if along @ UP > 0.0 else -along
        centre = axis + along * max(float((self.top - axis) @ UP) / float(along @ UP), 0.0)
        self._bar(joint.child, self.top, centre - 0.3 * r * along, 0.9 * r)
        seam, end = centre + 0.16 * r * along, centre + 1.4 * r * along
        self.add(site.cylinder(joint.child, "plate", centre - 0.8 * r * along, centre, 1.3 * r))
        self.add(site.cylinder(joint.child, "joint", centre, seam, 1.36 * r, colour=JOINT_COLOUR))
        self.add(site.cylinder(joint.parent, "housing", seam, end, 1.3 * r))
        self.half = max(self.half, 1.3 * r + float(np.linalg.norm((end - self.top)[:2])))
        self.top = centre + 0.9 * r * along

    def _slide(self, joint: Joint) -> None:
        """Draw a short slide within a head: a carriage on the child, a guide over the stroke on the parent."""
        site, r, at = self.site, self.r, self.top
        along = site.direction(joint)
        low, high = site.stroke(joint)
        if abs(along @ UP) < _LEVEL:
            R = upright_frame(along)
            self.add(site.box(joint.child, "carriage", [-r, -0.8 * r, -0.6 * r], [r, 0.8 * r, 0.6 * r], R, at,
                              colour=JOINT_COLOUR))  # fmt: skip
            a, b = [low - r, -0.6 * r, 0.6 * r], [high + r, 0.6 * r, 1.1 * r]
            self.add(site.box(joint.parent, "guide", a, b, R, at))
            self.top = at + 1.1 * r * R[:, 2]
            return
        rise = along if along @ UP > 0.0 else -along
        R = upright_frame(unit(np.cross(rise, [1.0, 0.0, 0.0])))  # x level, z along the slide
        length = high - low
        self.add(site.box(joint.child, "carriage", [-0.7 * r, -0.7 * r, 0.0], [0.7 * r, 0.7 * r, length + r], R, at,
                          colour=JOINT_COLOUR))  # fmt: skip
        a, b = [-r, -r, 0.5 * r + length], [r, r, 2.0 * length + 1.5 * r]
        self.add(site.box(joint.parent, "guide", a, b, R, at))
        self.top = at + (2.0 * length + 1.2 * r) * R[:, 2]
