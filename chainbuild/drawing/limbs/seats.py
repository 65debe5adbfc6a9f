"""Where the joints of a robot sit, how each is built and how thick: the plan that its links are drawn from.

A rotary joint whose axis runs along the arm is an in-line housing (a roll): machine data give its axis but not where
along it the one link ends and the next begins. One across the arm is a hinge, at its data. Hinges that are upright
from the base on are those of a SCARA, whose arms lie on one another (stacked).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Final, Literal

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import Joint
from chainbuild.chain.poses import link_placements
from chainbuild.drawing.site import Site
from chainbuild.frames import unit
from chainbuild.shown import fields_shown

SeatKind = Literal["roll", "hinge", "stack", "column", "ram", "plate"]

# Radii as shares of the arm's reach, of the way between hinges, and of the first one at the last joint: arms as built.
_STOUT: Final = 0.112
_STROKE: Final = 0.35  # of a stroke: what it adds to the reach
_LEAST_STOUT: Final = 0.03  # of the machine's size: a wrist on a gantry is no thinner
_BETWEEN: Final = 0.3
_FOLDED: Final = 0.5  # of the way to a hinge that the arm comes back to
_TO_TIP: Final = 0.5
_SLENDER: Final = 0.42
_STEP: Final = 2.1  # a radius over the next one at most
_SLAB: Final = 0.95  # thickness of a SCARA's arm over its radius
_HALF: Final = 0.8  # half the width of a hinge's boss over its radius
_CLEAR: Final = 1.25  # what turns ends this many radii before a hinge
UPRIGHT: Final = 0.99  # cosine: axes that are upright, or parallel, but for a calibration
_ACROSS: Final = 0.5  # cosine: a linear axis farther off the arm's direction lies across it
_SAME_LINE: Final = 0.2  # sine: axes closer than this have no useful point of meeting
_NOSE: Final = 3.0  # radii: what turns at the end of a ram, from its hinge
_THIN: Final = 0.25  # of a radius: the least length of what turns at the end of an arm
_TOGETHER: Final = 1e-3  # of the machine's size: points closer than this are one
_LEAST: Final = 0.004  # of the machine's size: a radius that can still be seen


@dataclass(frozen=True, slots=True, eq=False)
class Seat:
    """Where a joint sits and how it is built.

    Attributes:
        joint: The joint.
        kind: How it is built.
        place: (3,) where its parent ends and its child begins; of a hinge: the middle of its boss [m].
        axis: (3,) unit vector: outward along the arm for a roll or a slide, the joint's direction for a hinge.
        corner: (3,) point on the axis up to which the parent comes; it follows the axis from there.
        radius: Of its housing [m].
        half: Half the width of its boss [m].
        parent_forks: Whether the parent holds the child between its plates; else the child holds the parent.
        ahead: (3,) point that the arm goes on to; of a slide across the arm: where the next joint sits [m].
    """

    __repr__ = fields_shown

    joint: Joint
    kind: SeatKind
    place: Vector
    axis: Vector
    corner: Vector
    radius: float
    half: float
    parent_forks: bool
    ahead: Vector

    @property
    def link(self) -> str:
        """The link that the joint carries."""
        return self.joint.child

    @property
    def plate(self) -> float:
        """Thickness of the plates of its fork, or of the slab of a SCARA [m]."""
        return (_SLAB if self.kind == "stack" else 0.35) * self.radius


def line_point(p: Vector, d: Vector, other: Vector, along: Vector | None = None) -> Vector:
    """Return the point of a line that is closest to a point, or to a line that is not parallel to it.

    Args:
        p: (3,) point of the line.
        d: (3,) its direction, a unit vector.
        other: (3,) the point, or a point of the other line.
        along: (3,) direction of the other line, a unit vector.
    """
    w = other - p
    if along is not None and np.linalg.norm(np.cross(d, along)) > _SAME_LINE:
        c = float(d @ along)
        closest: Vector = p + d * float((w @ d - c * (w @ along)) / (1.0 - c * c))
        return closest
    foot: Vector = p + d * float(w @ d)
    return foot


def _home(site: Site, joint: Joint) -> Vector:
    """Return where a joint is at home: on its axis, or where it has moved its link to."""
    place: Vector = site.links[joint.child][:3, 3] if joint.kind == "prismatic" else site.origin(joint)
    return place


def _ends(site: Site) -> list[Vector]:
    """Return flange and tip at home; the flange only where the last link of the tool has it."""
    tool, flange = site.chain.frame("tool").link, site.chain.frame("flange").link
    return [site.frame("flange")[:3, 3], site.tip] if flange == tool else [site.tip]


class ArmPlan:
    """The rule from joints to seats, with what it looks up.

    Args:
        site: The site.
        joints: Joints of the arm, from the base to the tip.
        mount: (3,) where it stands or hangs [m].

    Attributes:
        points: (3,) where each joint is at home.
        kinds: How each is built.
        radii: Radii of their housings [m].
    """

    def __init__(self, site: Site, joints: Sequence[Joint], mount: Vector) -> None:
        self.site, self.joints, self.mount = site, joints, mount
        self.points = [_home(site, joint) for joint in joints]
        self.axes = [site.direction(joint) for joint in joints]
        self.ends = _ends(site)
        self.near = _TOGETHER * site.size
        self.kinds: list[SeatKind] = []
        for n in range(len(joints)):
            self.kinds.append(self.kind(n))
        self.radii = self._radii()

    def standing_at(self, mount: Vector) -> ArmPlan:
        """Return the plan of the same arm with another mount (3,) [m]."""
        return ArmPlan(self.site, self.joints, mount)

    def before(self, n: int) -> Vector:
        """Return the point that a joint is reached from."""
        return self.points[n - 1] if n else self.mount

    def ahead(self, n: int) -> Vector:
        """Return the first point after a joint that is another one than its own, else its own."""
        later = [*self.points[n + 1 :], *self.ends]
        return next((p for p in later if np.linalg.norm(p - self.points[n]) > self.near), self.points[n])

    def kind(self, n: int) -> SeatKind:
        """Return how a joint is built."""
        p, d, ahead = self.points[n], self.axes[n], self.ahead(n)
        if self.joints[n].kind == "prismatic":
            way = ahead - self.before(n)
            if abs(d[2]) > UPRIGHT and self.kinds == ["roll"] and abs(self.axes[0] @ d) > UPRIGHT:
                return "column"
            length = float(np.linalg.norm(way))
            return "plate" if length < self.near or abs(d @ way) < _ACROSS * length else "ram"
        along = abs(float((ahead - self.before(n)) @ d))
        across = float(np.linalg.norm(np.cross(ahead - p, d)))
        after = self.axes[n + 1] if n + 1 < len(self.axes) and self.joints[n + 1].kind == "prismatic" else None
        if n == 0 and after is not None and abs(after @ d) > UPRIGHT:
            return "roll"  # it turns a column
        if across <= 1.0001 * along:  # an axis at 45° to the arm, but for rounding, runs along it
            return "roll"
        turning = [self.axes[m] for m in range(n + 1) if self.joints[m].kind == "revolute"]
        upright = all(abs(axis[2]) > UPRIGHT for axis in turning) and "roll" not in self.kinds
        return "stack" if upright else "hinge"

    def _radii(self) -> list[float]:
        """Return radii that fall from the base to the tip, small enough for neighbours to stay apart."""
        first = 1 if self.kinds[:1] == ["roll"] else 0  # what turns the whole of an arm is no part of its reach
        points = [*self.points, *self.ends][first:]
        reach = sum(float(np.linalg.norm(b - a)) for a, b in pairwise(points))
        strokes = [end for joint in self.joints if joint.kind == "prismatic" for end in self.site.stroke(joint)]
        reach += _STROKE * sum(map(abs, strokes))
        stout, last = max(_STOUT * reach, _LEAST_STOUT * self.site.size), max(len(self.joints) - 1, 1)
        hinges = [n for n, kind in enumerate(self.kinds) if kind in ("hinge", "stack")]
        radii: list[float] = []
        for n in range(len(self.joints)):
            limits = [stout * (1.0 - (1.0 - _SLENDER) * n / last), *radii[-1:]]
            if n in hinges:
                limits += [_BETWEEN * self._way(self.points[n], self.points[m]) for m in hinges]
                limits += [_FOLDED * way for way in self._folded(n, hinges)]
            if n in hinges[-1:]:
                limits += [_TO_TIP * self._way(self.points[n], end) for end in self.ends]
            if self.kinds[n] == "hinge":
                ends = [self.ahead(n), *self._flanges(n)]
                limits += [_TO_TIP * self._way(self.points[n], end) for end in ends]
            radii.append(max(min(limits), _LEAST * self.site.size))
        for n in range(len(radii) - 2, 0, -1):
            radii[n] = min(radii[n], _STEP * radii[n + 1])
        return [self.site.radius(joint.child, radius) for joint, radius in zip(self.joints, radii, strict=True)]

    def _folded(self, n: int, hinges: Sequence[int]) -> list[float]:
        """Return how close to a hinge those that no link joins to it come in the middle of the axes [m]."""
        chain = self.site.chain
        low, high = shown_limits(chain)
        placed = link_placements(chain, chain.axis_map.q((low + high) / 2.0))
        places = {m: (placed[self.joints[m].parent] @ self.joints[m].T_parent_joint)[:3, 3] for m in hinges}
        return [self._way(places[n], places[m]) for m in hinges if abs(hinges.index(m) - hinges.index(n)) > 1]

    def _flanges(self, n: int) -> list[Vector]:
        """Return the flanges of the link that a joint carries and of those beyond it."""
        links = [joint.child for joint in self.joints[n:]]
        frames = [frame for frame in self.site.chain.frames if frame.link in links and frame.name.endswith("flange")]
        return [self.site.frame(frame.name)[:3, 3] for frame in frames]

    def _way(self, a: Vector, b: Vector) -> float:
        way = float(np.linalg.norm(b - a))
        return way if way > self.near else np.inf

    def seats(self) -> list[Seat]:
        """Return the seats."""
        seats: list[Seat] = []
        for n, kind in enumerate(self.kinds):
            if kind == "roll":
                seats.append(self._roll(n, seats))
            elif kind == "hinge":
                seats.append(self._hinge(n, seats))
            elif kind == "stack":
                seats.append(self._stack(n, seats))
            else:
                seats.append(self._slide(n, seats))
        return seats

    def _hinge(self, n: int, seats: list[Seat]) -> Seat:
        p, d, r = self.points[n], self.axes[n], self.radii[n]
        before = seats[-1] if seats and seats[-1].kind == "hinge" else None
        held = before is not None and not before.parent_forks and abs(before.axis @ d) > UPRIGHT
        half = before.half if held and before is not None else _HALF * r
        return Seat(self.joints[n], "hinge", p, d, p, r, half, not self._holds(n), self.ahead(n))

    def _holds(self, n: int) -> bool:
        """Return whether a hinge's child holds the parent: a shoulder, with an elbow parallel to it."""
        if "hinge" in self.kinds[:n] or self.kinds[n + 1 : n + 2] != ["hinge"]:
            return False
        apart = float(np.linalg.norm(self.points[n + 1] - self.points[n]))
        return abs(float(self.axes[n] @ self.axes[n + 1])) > UPRIGHT and apart > 2.0 * self.radii[n]

    def _stack(self, n: int, seats: list[Seat]) -> Seat:
        """Return the seat of an arm that lies on the one before, on the side away from the tool."""
        p, r = self.points[n], self.radii[n]
        up = np.array([0.0, 0.0, 1.0 if self.site.tip[2] <= p[2] else -1.0])
        before = seats[-1] if seats and seats[-1].kind == "stack" else None
        height = before.place @ up + before.plate if before is not None else p @ up - _SLAB * r / 2.0
        place = p + up * (height - p @ up)
        return Seat(self.joints[n], "stack", place, up, place, r, _HALF * r, True, self.ahead(n))

    def _roll(self, n: int, seats: list[Seat]) -> Seat:
        p, d, r = self.points[n], self.axes[n], self.radii[n]
        before = seats[-1] if seats else None
        if before is None:
            corner = line_point(p, d, self.mount)
        elif before.kind in ("hinge", "roll"):
            corner = line_point(p, d, before.place if before.kind == "roll" else self.points[n - 1], before.axis)
        else:
            corner = line_point(p, d, before.place)
        end = self.roll_end(n)
        d = d if (end - corner) @ d >= 0.0 else -d
        start = 0.0
        if before is not None and before.kind == "hinge":
            beside = float(np.linalg.norm(corner - before.place))
            start = 1.15 * before.radius if beside < before.radius else 0.6 * r  # past the boss, or past the bend
        elif before is not None and before.kind == "roll":
            start = max(0.0, float((before.place - corner) @ d))
        stop = float((end - corner) @ d)
        share = 0.5 if before is None else 0.3  # a foot is half of the way up; what turns is the longer part
        given = self._given_flange(n, d, corner)
        if before is not None and before.kind == "stack":
            at = 0.0
        elif given is not None:
            at = given
        elif before is not None and before.kind == "ram" and np.linalg.norm(np.cross(before.axis, d)) < _SAME_LINE:
            short = np.linalg.norm(before.corner - before.place) == 0.0  # one that begins on a slide across the arm
            at = float((before.ahead - corner) @ d) if short else max(stop - _NOSE * r, 0.5 * stop)
            corner, at = corner + at * d, 0.0  # the ram itself reaches up to what turns
        else:
            at = start + share * (stop - start) if stop - start > _THIN * r else stop - _THIN * r
        return Seat(self.joints[n], "roll", corner + at * d, d, corner, r, _HALF * r, True, self.ahead(n))

    def _given_flange(self, n: int, d: Vector, corner: Vector) -> float | None:
        """Return how far along the axis of a roll a flange of its parent lies, or None where there is none."""
        for frame in self.site.chain.frames if n else ():
            if frame.link == self.joints[n].parent and frame.name.endswith("flange"):
                return float((self.site.frame(frame.name)[:3, 3] - corner) @ d)
        return None

    def roll_end(self, n: int) -> Vector:
        """Return where what turns about the axis of a roll ends, on the axis."""
        p, d = self.points[n], self.axes[n]
        if n + 1 == len(self.joints):
            return line_point(p, d, self.ends[0])
        flange = next(
            (f for f in self.site.chain.frames if f.link == self.joints[n].child and "flange" in f.name), None
        )
        if flange is not None:
            return line_point(p, d, self.site.frame(flange.name)[:3, 3])
        after = self.points[n + 1]
        end = line_point(p, d, after)
        straight = np.linalg.norm(np.cross(self.axes[n + 1], d)) < _SAME_LINE
        if self.kinds[n + 1] == "roll" and straight:
            return end
        clear = _CLEAR if np.linalg.norm(after - end) < self.radii[n + 1] else 1.0
        way = end - self.before(n)
        sign = 1.0 if way @ d >= 0.0 else -1.0
        return end - sign * clear * self.radii[n + 1] * d

    def _slide(self, n: int, seats: list[Seat]) -> Seat:
        joint, d, r, kind, ahead = self.joints[n], self.axes[n], self.radii[n], self.kinds[n], self.ahead(n)
        before = seats[-1].place if seats else self.mount
        if kind == "column":
            place = line_point(seats[-1].place, seats[-1].axis, self.points[n])
            return Seat(joint, kind, place, d, place, r, _HALF * r, True, ahead)
        after_plate = bool(seats) and seats[-1].kind == "plate"
        if kind == "plate" or after_plate:
            place = seats[-1].ahead if after_plate else self.points[n]
            together = sum(1 for p in self.points[n:] if np.linalg.norm(p - self.points[n]) < self.near)
            step = (ahead - place) / (together + 1.0)
            axis = d if kind == "plate" else unit(step)
            return Seat(joint, kind, place, axis, place, r, _HALF * r, True, place + step)
        # The ram runs through what it carries, not through the tool.
        ahead = [*self.points[n + 1 :], *self.ends][0]
        d = d if (ahead - before) @ d >= 0.0 else -d
        corner = line_point(ahead, d, self.before(n))
        room = float((ahead - corner) @ d)
        place = corner + min(1.3 * r, 0.5 * room) * d  # the front of the housing that the ram comes out of
        return Seat(joint, kind, place, d, corner, r, _HALF * r, True, ahead)
