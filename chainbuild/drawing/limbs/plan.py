"""How the joints of a robot are built and how thick, from where they are.

A rotary joint whose axis runs along the arm is an in-line housing (a roll), one across the arm is a hinge. Hinges that
are upright from the base on are those of a SCARA, whose arms lie on one another (stacked).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Final, Literal

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import Joint
from chainbuild.chain.poses import link_placements
from chainbuild.drawing.site import Site

SeatKind = Literal["roll", "hinge", "stack", "column", "ram", "plate", "quill"]

UPRIGHT: Final = 0.99  # cosine: axes that are upright, or parallel, but for a calibration
SAME_LINE: Final = 0.2  # sine: axes closer than this have no useful point of meeting
# Shares that radii are, or are at most, as arms are built.
_STOUT: Final = 0.112  # of the arm's reach: the first one
_STROKE: Final = 0.35  # of a stroke: what it adds to the reach
_LEAST_STOUT: Final = 0.03  # of the machine's size: a wrist on a gantry is no thinner
_BETWEEN: Final = 0.3  # of the way between two hinges
_FOLDED: Final = 0.5  # of the way to a hinge that the arm comes back to
_TO_TIP: Final = 0.5  # of the way from a hinge to the flange, or to what comes next
_SLENDER: Final = 0.42  # of the first one: the last one
_STEP: Final = 2.1  # a radius over the next one at most
_CLEAR: Final = 1.25  # what turns ends this many radii before a hinge
_ACROSS: Final = 0.5  # cosine: a linear axis farther off the arm's direction lies across it
_TOGETHER: Final = 1e-3  # of the machine's size: points closer than this are one
_LEAST: Final = 0.004  # of the machine's size: a radius that can still be seen


def line_point(p: Vector, d: Vector, other: Vector, along: Vector | None = None) -> Vector:
    """Return the point of a line that is closest to a point, or to a line that is not parallel to it.

    Args:
        p: (3,) point of the line.
        d: (3,) its direction, a unit vector.
        other: (3,) the point, or a point of the other line.
        along: (3,) direction of the other line, a unit vector.
    """
    w = other - p
    if along is not None and np.linalg.norm(np.cross(d, along)) > SAME_LINE:
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
    """How the joints of an arm are built, where they are and how thick.

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
            if abs(d[2]) > UPRIGHT and self.kinds[-1:] == ["stack"]:
                return "quill"
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

    def roll_end(self, n: int) -> Vector:
        """Return where what turns about the axis of a roll ends, on the axis."""
        p, d = self.points[n], self.axes[n]
        if n + 1 == len(self.joints):
            return line_point(p, d, self.ends[0])
        for frame in self.site.chain.frames:
            if frame.link == self.joints[n].child and frame.name.endswith("flange"):
                return line_point(p, d, self.site.frame(frame.name)[:3, 3])
        after = self.points[n + 1]
        end = line_point(p, d, after)
        straight = np.linalg.norm(np.cross(self.axes[n + 1], d)) < SAME_LINE
        if self.kinds[n + 1] == "roll" and straight:
            return end
        clear = _CLEAR if np.linalg.norm(after - end) < self.radii[n + 1] else 1.0
        way = end - self.before(n)
        sign = 1.0 if way @ d > -self.near else -1.0
        return end - sign * clear * self.radii[n + 1] * d
