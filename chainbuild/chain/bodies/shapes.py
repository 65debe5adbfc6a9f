"""Primitive bodies that stand for the links of a chain, for drawings, collision and URDF.

Machine data say where the joints are and nothing about the castings between them. The bodies are therefore drawn:
a cylinder (rotary) or box (linear) from joint to joint, as thick as looks right for a machine of that size.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild import frames
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.body import (
    BASE_COLOUR,
    JOINT_COLOUR,
    TOOL_COLOUR,
    TOOL_SIDE,
    WORKPIECE_SIDE,
    Body,
    Colour,
    Origin,
    along,
    rounded_body,
)
from chainbuild.chain.bodies.rods import CRANK, LEVEL_LINKS, ROD_END, ROD_PIN, has_rods
from chainbuild.chain.closing import strut_range
from chainbuild.chain.elements import BASE_LINK, Axis, Chain, Joint
from chainbuild.chain.fold import drawn, drawn_bounds

# Radius of a link over the size of the machine: at the base and at the tip, where arms are slender.
_STOUT: Final = 0.055
_SLENDER: Final = 0.032
_HUB: Final = 0.5  # of a link's radius: the middle of a platform that hangs on rods, and its arms
_SPECK: Final = 0.01  # likewise: a shift of a platform alone is nothing one could see
_ARM_TURNS: Final = 4  # rotary axes from the base on: tables of machine tools have three at most
# Details of a drawing that are solid and no part of a link's own body.
_SOLID_PARTS: Final = ("lever", "tool", "table")
# A machine with long strokes and small heads is drawn as thick as an arm of this share of its stroke.
_STROKE_SHARE: Final = 0.35
# Without known limits: the range drawn and swept, as a share of the machine's size, and in degrees.
_ASSUMED_STROKE_SHARE: Final = 0.5
_ASSUMED_TURN_DEG: Final = 180.0
# More than one turn either way shows nothing new.
_SHOWN_TURN_DEG: Final = 360.0


def link_bodies(chain: Chain) -> tuple[Body, ...]:
    """Return exactly one body a link, in the order of the chain's links."""
    drawing = _Drawing(chain)
    return tuple(drawing.link_body(link.name) for link in chain.links)


def detail_bodies(chain: Chain) -> tuple[Body, ...]:
    """Return the details of a drawing: joint housings, rails, flange, tool, table and the lever of a rod."""
    drawing = _Drawing(chain)
    drawn_joints = [(n, joint) for n, joint in enumerate(drawing.joints) if joint.child not in drawing.floating]
    bodies = [drawing.joint_body(joint, n) for n, joint in drawn_joints]
    return (*bodies, *drawing.lever_bodies(), *drawing.platform_bodies(), *drawing.tip_bodies())


def solid_bodies(chain: Chain) -> tuple[Body, ...]:
    """Return the bodies that collision counts: what the data carry, without what is drawn only.

    A linear link is drawn: where along its line it is, and how far it extends, no data say. So are a bed, the foot of a
    machine tool, and level links, which represent angles. A radius in the overlay makes a link count.
    """
    details = (body for body in detail_bodies(chain) if body.part in _SOLID_PARTS and body.link not in LEVEL_LINKS)
    return tuple(body for body in (*link_bodies(chain), *details) if body.origin == "data")


def machine_size(chain: Chain) -> float:
    """Return the size [m] that drawings are scaled by: the longest arm, or a share of the longest known stroke."""
    reach = {BASE_LINK: 0.0}
    for joint in chain.joints:
        reach[joint.child] = reach[joint.parent] + _length(drawn(joint).T_parent_joint)
    tips = [reach[frame.link] + _length(frame.T_link_frame) for frame in chain.frames]
    strokes = [(axis.upper - axis.lower) / 1000.0 for axis in chain.axes if axis.kind == "linear" and not axis.assumed]
    size = max(*tips, *(_STROKE_SHARE * stroke for stroke in strokes), 0.0)
    return size if size > 1e-6 else 1.0


def shown_limits(chain: Chain, *, at_middle: bool = False) -> tuple[Vector, Vector]:
    """Return the axis range (n_axes,) that is drawn, sampled and swept, mm and degrees.

    It is what the limits ever leave, whatever the other axes, but: where nobody limits an axis of closed loops its
    struts do; other assumed linear limits shrink to the size of the machine around 0, assumed and endless rotary axes
    to half a turn either way, and no rotary axis is shown over more than a turn either way.

    Args:
        chain: The chain.
        at_middle: True: what the limits leave with the other axes in the middle of theirs.
    """
    size_mm = 1000.0 * machine_size(chain)
    ranges = [
        strut_range(chain, n) or _shown(axis, (axis.lower, axis.upper) if at_middle else axis.range, size_mm)
        for n, axis in enumerate(chain.axes)
    ]
    return np.array([low for low, _ in ranges]), np.array([high for _, high in ranges])


def _shown(axis: Axis, ends: tuple[float, float], size_mm: float) -> tuple[float, float]:
    if axis.kind == "linear":
        bound = float(f"{_ASSUMED_STROKE_SHARE * size_mm:.1g}") if axis.assumed else np.inf
    else:
        bound = _ASSUMED_TURN_DEG if axis.assumed or axis.endless else _SHOWN_TURN_DEG
    low, high = max(ends[0], -bound), min(ends[1], bound)
    return (low, high) if low < high else ends


class _Drawing:
    """The rule from chain to bodies, with what it needs to look up.

    Its joints are those that the recipe draws: the sign and zero of an axis do not change what a machine looks like.
    """

    def __init__(self, chain: Chain) -> None:
        self.chain = chain
        self.size = machine_size(chain)
        self.joints = tuple(drawn(joint) for joint in chain.joints)
        self.carrier = {joint.child: joint for joint in self.joints}
        self.children: dict[str, list[Joint]] = {link.name: [] for link in chain.links}
        depth = {BASE_LINK: 0}
        for joint in self.joints:
            self.children[joint.parent].append(joint)
            depth[joint.child] = depth[joint.parent] + 1
        self.depth = depth
        self.low, self.high = drawn_bounds(chain.joints, *chain.axis_map.q_bounds(*shown_limits(chain)))
        self.workpiece_side = self._path(chain.frame("workpiece").link) - self._path(chain.frame("tool").link)
        self.given = {link.name: link.radius for link in chain.links}
        # What no slide carries: the shifts of a platform that hangs on the rods of closed loops.
        axes = {axis.name for axis in chain.axes}
        passive = [joint for joint in self.joints if chain.loops and joint.name not in axes]
        self.floating = {joint.child for joint in passive if joint.kind == "prismatic"}
        self.loop_ends = {name: loop.name for loop in chain.loops for name in (loop.frame_a, loop.frame_b)}
        ends = [frame.link for frame in chain.frames if frame.name in self.loop_ends]
        self.platforms = {link for link in ends if ends.count(link) > 1}
        self.below = self.workpiece_side | (self._below_workpiece() if chain.loops else set())

    def _below_workpiece(self) -> set[str]:
        """Return the links of arms whose axes carry the workpiece, or that start from what does."""
        carrying = {axis.name for axis in self.chain.axes if axis.carries == "workpiece"}
        first = {joint.child for joint in self.joints if joint.name in carrying} | self.workpiece_side
        return {link.name for link in self.chain.links if self._path(link.name) & first}

    def _path(self, link: str) -> set[str]:
        path = set()
        while link in self.carrier:
            path.add(link)
            link = self.carrier[link].parent
        return path

    def radius(self, link: str) -> float:
        """Return the radius [m] of a link's body."""
        given = self.given[link]
        if given is not None:
            return given
        last = max(*self.depth.values(), 1)
        return self.size * (_STOUT + (_SLENDER - _STOUT) * self.depth[link] / last)

    def colour(self, link: str) -> Colour:
        if link == BASE_LINK:
            return BASE_COLOUR
        pair = WORKPIECE_SIDE if link in self.below else TOOL_SIDE
        return pair[(self.depth[link] - 1) % 2]

    def end(self, link: str) -> Vector:
        """Return the point (3,) [m] up to which a link's body reaches from the link's origin."""
        points = [joint.T_parent_joint[:3, 3] for joint in self.children[link]]
        if not points:
            ends = {f.name: f.T_link_frame[:3, 3] for f in self.chain.frames if f.link == link}
            known = (*self.loop_ends, ROD_END, "flange", "tool", "workpiece")
            points = [ends[name] for name in known if name in ends][:1]
        return max(points, key=lambda p: round(float(np.linalg.norm(p)), 9), default=np.zeros(3))

    def link_body(self, link: str) -> Body:
        """Return the body from a link's origin to its end, or a lump where the two coincide."""
        joint = self.carrier.get(link)
        if joint is None:
            return self._base_body()
        radius, end, colour = self.radius(link), self.end(link), self.colour(link)
        if link in self.floating:
            carries = any(frame.link == link and frame.name in self.loop_ends for frame in self.chain.frames)
            size = ((_HUB if carries else _SPECK) * radius,)
            return rounded_body(link, "link", np.eye(4), "sphere", size, colour, "data" if carries else "drawn")
        length, origin = float(np.linalg.norm(end)), self.origin(link)
        if joint.kind == "prismatic":
            long = length > 0.5 * radius
            T = along(end, end / 2) if long else along(joint.direction)
            edges = (2.4 * radius, 2.4 * radius, length if long else 2.8 * radius)
            return rounded_body(link, "link", T, "box", edges, colour, origin)
        if length > 0.5 * radius:
            return rounded_body(link, "link", along(end, end / 2), "cylinder", (radius, length), colour, origin)
        T = frames.translation(*self._below_table(link))
        return rounded_body(link, "link", T, "sphere", (1.25 * radius,), colour, origin)

    def origin(self, link: str) -> Origin:
        """Return whether data put the body of a link where it is, or a drawing assumes it."""
        linear = self.carrier[link].kind == "prismatic" and link not in self.chain.geometry.radii
        return "drawn" if linear or link in LEVEL_LINKS else "data"

    def _is_arm(self, joint: Joint) -> bool:
        """Return whether the joint is the first of an arm: a column of the base carries it."""
        turning = [
            other for other in self.joints if other.kind == "revolute" and joint.child in self._path(other.child)
        ]
        return joint.kind == "revolute" and len(turning) >= _ARM_TURNS

    def _base_body(self) -> Body:
        """Return a bed under the table, a column up to the first rotary joint, or a foot at the origin."""
        radius, colour, children = self.radius(BASE_LINK), BASE_COLOUR, self.children[BASE_LINK]
        given: Origin = "data" if BASE_LINK in self.chain.geometry.radii else "drawn"
        arm = any(self._is_arm(joint) for joint in children)
        for joint in children:
            if joint.child in self.workpiece_side and joint.child not in self.floating and not arm:
                side = 6 * radius
                T = frames.translation(*joint.T_parent_joint[:3, 3]) @ frames.translation(z=-3 * radius)
                return rounded_body(BASE_LINK, "link", T, "box", (side, side, radius), colour, given)
        turning = [joint.T_parent_joint[:3, 3] for joint in children if joint.kind == "revolute"]
        end = max(turning, key=lambda point: round(float(np.linalg.norm(point)), 9), default=np.zeros(3))
        length = float(np.linalg.norm(end))
        if length > 0.5 * radius:
            return rounded_body(BASE_LINK, "link", along(end, end / 2), "cylinder", (radius, length), colour, "data")
        foot, size = frames.translation(z=-0.4 * radius), (1.5 * radius, 0.8 * radius)
        return rounded_body(BASE_LINK, "link", foot, "cylinder", size, colour, "data" if turning else given)

    def joint_body(self, joint: Joint, n: int) -> Body:
        """Return the housing of a rotary joint or the rail of a linear one."""
        radius = self.radius(joint.child)
        if joint.kind == "revolute":
            dimensions = (1.12 * radius, 2.4 * radius)
            T = along(joint.direction, self._below_table(joint.child))
            return rounded_body(joint.child, "joint", T, "cylinder", dimensions, JOINT_COLOUR)
        low, high = min(float(self.low[n]), 0.0), max(float(self.high[n]), 0.0)
        T = joint.T_parent_joint @ along(joint.direction, joint.direction * (low + high) / 2)
        edges = (0.9 * radius, 0.9 * radius, high - low + 2 * radius)
        return rounded_body(joint.parent, "rail", T, "box", edges, JOINT_COLOUR)

    def _below_table(self, link: str) -> Vector:
        """Return where lumps of a link are centred [m]: its origin, but clear of the top of the table."""
        workpiece = self.chain.frame("workpiece")
        down: Vector = -1.45 * self.radius(link) * workpiece.T_link_frame[:3, 2]
        return down if workpiece.link == link else np.zeros(3)

    def lever_bodies(self) -> list[Body]:
        """Return the lever that carries the pin of a parallelogram's rod on the forearm."""
        if not has_rods(self.chain):
            return []
        pin = self.chain.frame(ROD_PIN)
        end, radius = pin.T_link_frame[:3, 3], self.radius(f"{CRANK}_link")
        length = float(np.linalg.norm(end))
        return [
            rounded_body(
                pin.link, "lever", along(end, end / 2), "cylinder", (radius, length), self.colour(pin.link), "data"
            )
        ]

    def platform_bodies(self) -> list[Body]:
        """Return the arms of a platform, from its middle to the pins of the rods."""
        bodies = []
        for frame in self.chain.frames:
            end = frame.T_link_frame[:3, 3]
            length = float(np.linalg.norm(end))
            if frame.name in self.loop_ends and frame.link in self.platforms and length > 0.0:
                size = _HUB * self.radius(frame.link), length
                T = along(end, end / 2)
                bodies.append(rounded_body(frame.link, "lever", T, "cylinder", size, self.colour(frame.link), "data"))
        return bodies

    def tip_bodies(self) -> list[Body]:
        chain, bodies = self.chain, []
        flange, tool, workpiece = (chain.frame(name) for name in ("flange", "tool", "workpiece"))
        radius = self.radius(flange.link)
        disc = flange.T_link_frame @ frames.translation(z=-0.15 * radius)
        bodies.append(rounded_body(flange.link, "flange", disc, "cylinder", (0.9 * radius, 0.3 * radius), JOINT_COLOUR))
        if tool.link == flange.link:
            start, end = flange.T_link_frame[:3, 3], tool.T_link_frame[:3, 3]
            length = float(np.linalg.norm(end - start))
            if length > 0.05 * radius:
                T = along(end - start, (start + end) / 2)
                bodies.append(
                    rounded_body(tool.link, "tool", T, "cylinder", (0.35 * radius, length), TOOL_COLOUR, "data")
                )
        if workpiece.link != BASE_LINK:
            radius = self.radius(workpiece.link)
            T = workpiece.T_link_frame @ frames.translation(z=-0.2 * radius)
            size, colour = (3 * radius, 0.4 * radius), self.colour(workpiece.link)
            bodies.append(rounded_body(workpiece.link, "table", T, "cylinder", size, colour, "data"))
        return bodies


def _length(T: Matrix) -> float:
    return float(np.linalg.norm(T[:3, 3]))
