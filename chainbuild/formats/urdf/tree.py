"""The links of a URDF file on a chain: which of them the chain moves, where the others stand on these, names, masses.

A link moves where its joint does: on the way from the root to the tool, or beside it where an axis of the way drives
it. Every other link stands still on one of these, or on the root. Values are SI, as in the file.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Final

import numpy as np

from chainbuild import tolerances
from chainbuild.arrays import Matrix
from chainbuild.chain.bodies.inertia import Inertia, lumped
from chainbuild.chain.elements import BASE_LINK, FRAME_NAMES, Frame
from chainbuild.chain.names import free_name
from chainbuild.errors import ParseError, Span
from chainbuild.findings import Collector
from chainbuild.formats.urdf.joints import Joints, UrdfJoint, placement
from chainbuild.formats.urdf.xml import Node

RESERVED: Final = (*FRAME_NAMES, "universe")  # of every model: what else is called so could not be told from them
_SAME: Final = 1e-12  # m and in directions: written to 15 digits, one place differs from itself by so much
_MOMENTS: Final = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_ROUNDED: Final = 1e-12  # kg·m²: CAD programs write moments of 0 that far below it

_Place = tuple[str, Matrix]


class Tree:
    """The links of a file, seen from a chain.

    Args:
        robot: The element <robot>.
        joints: All joints of the file.
        way: Those from the root link to the tool link.

    Attributes:
        root: The root link.
        moving: The joints of the chain: those on the way, then those beside it.
        held: The other joints of moving types → the value at which they are held, m or rad.
        places: Link → the root or the link of a joint of the chain that carries it, and its (4, 4) place in that [m].
        names: Links of the chain → their names in it.
        frames: Frames of the chain: base, flange, tool, workpiece, and the links that it does not move.

    Raises:
        ParseError: a link that no joint holds or that occurs twice, or a number that makes no sense.
    """

    def __init__(self, robot: Node, joints: Joints, way: Sequence[UrdfJoint]) -> None:
        self.root = way[0].parent
        self._links = _links(robot, joints)
        self._tool, self._joints = way[-1].child, joints
        free = [joint for joint in way if joint.moves and joints.fixed_at(joint) is None]
        self.drivers = tuple(dict.fromkeys(joints.follows(joint).driver for joint in free))
        self.held: dict[UrdfJoint, float] = {}
        self.places: dict[str, _Place] = {self.root: (self.root, np.eye(4))}
        self.moving = self._walk(way)
        self._renamed: dict[str, str] = {}
        self.names, self.frames = self._named()

    def _walk(self, way: Sequence[UrdfJoint]) -> tuple[UrdfJoint, ...]:
        """Place every link, and return the joints of the chain.

        Depth first, as Pinocchio wants the joints of its models; of the joints on a link that on the way comes first.
        """
        below: dict[str, list[UrdfJoint]] = {}
        for joint in (*way, *(joint for joint in self._joints.all if joint not in way)):
            below.setdefault(joint.parent, []).append(joint)
        found: list[UrdfJoint] = []
        ahead = below[self.root][::-1]
        while ahead:
            joint = ahead.pop()
            value = self._value(joint, on_way=joint in way)
            if value is None:
                self.places[joint.child] = joint.child, np.eye(4)
                found.append(joint)
            else:
                carrier, T = self.places[joint.parent]
                self.places[joint.child] = carrier, T @ joint.T_at(value)
            ahead += below.get(joint.child, [])[::-1]
        for joint in self._joints.all:
            if joint.child not in self.places:
                raise ParseError(f"link {joint.child} is its own ancestor", span=joint.span)
        return tuple(found)

    def _value(self, joint: UrdfJoint, *, on_way: bool) -> float | None:
        """Return the value at which a joint stands still [m, rad]; None: it is one of the chain."""
        if not on_way and joint.stays:
            self.held[joint] = 0.0
            return 0.0
        if not joint.moves:
            return 0.0
        value, follows = self._joints.fixed_at(joint), self._joints.follows(joint)
        if value is None and (on_way or follows.driver in self.drivers):
            return None
        if value is None:
            bounds = self._joints.bounds(follows.driver)
            nearest = 0.0 if bounds is None else min(max(0.0, bounds[0]), bounds[1])
            value = follows.factor * nearest + follows.offset
        if not on_way:
            self.held[joint] = value
        return value

    def T_parent_joint(self, joint: UrdfJoint) -> tuple[str, Matrix]:
        """Return the link of the chain that carries a joint, by its name there, and where: (4, 4) [m]."""
        carrier, T = self.places[joint.parent]
        return self.names[carrier], T @ joint.T

    def _named(self) -> tuple[dict[str, str], tuple[Frame, ...]]:
        """Return the names of the links that the chain has, and its frames."""
        own = self._own_frames()
        taken = {*self.places, *RESERVED}
        names, frames = {self.root: BASE_LINK}, [Frame(name, *place) for name, place in own.items()]
        for link, (carrier, T) in self.places.items():
            stands = link in own and own[link][0] == carrier and bool(np.abs(own[link][1] - T).max() < _SAME)
            name = link
            if link in RESERVED:
                name = free_name(f"{link}_link", taken)
                taken.add(name)
                if not stands:
                    self._renamed[link] = name
            if link == carrier and link != self.root:
                names[link] = name
            elif not stands:
                frames.append(Frame(name, carrier, T))
        return names, tuple(Frame(frame.name, names[frame.link], frame.T_link_frame) for frame in frames)

    def _own_frames(self) -> dict[str, _Place]:
        """Return where the frames stand that every chain has."""
        base, tool = self.places[self.root], self.places[self._tool]
        flange = self.places.get("flange", tool)
        return {"base": base, "tool": tool, "workpiece": base, "flange": flange if flange[0] == tool[0] else tool}

    def inertias(self) -> dict[str, Inertia]:
        """Return link of the chain → inertia of all that it carries; empty where the file gives none.

        Raises:
            ParseError: a mass or a moment that is missing, none, negative or huge.
        """
        parts: dict[str, list[Inertia]] = {}
        for link, (carrier, T) in self.places.items():
            own = _inertia(link, self._links.get(link))
            if own is not None:
                parts.setdefault(self.names[carrier], []).append(own.seen_from(T))
        return {link: lumped(found) for link, found in parts.items()}

    def tell(self, collector: Collector) -> None:
        """Record which links have other names in the chain, and which joints beside the way are held."""
        for link, name in self._renamed.items():
            text = f"link {link} is called {name}: every robot has a frame {link} of its own"
            collector.add("CB524", text, span=self._span(link))
        if self.held:
            text = f"joints beside the way to link {self._tool} are held: {', '.join(self._held_words())}"
            collector.add("CB525", text, span=next(iter(self.held)).span)

    def _span(self, link: str) -> Span:
        """Return where a link is given, else a joint that names it."""
        named = (joint.span for joint in self._joints.all if link in (joint.parent, joint.child))
        return self._links[link].span if link in self._links else next(named)

    def _held_words(self) -> Iterable[str]:
        for joint, value in self.held.items():
            unit = "" if joint.stays else " rad" if joint.kind == "rotary" else " m"
            yield f"{joint.name} at {value:g}{unit}" if value else joint.name


def link_places(tree: Tree) -> dict[str, _Place]:
    """Return for every link of a file the link of the chain that carries it, and its (4, 4) place there [m].

    Args:
        tree: The links of the file, seen from the chain.
    """
    return {link: (tree.names[carrier], T) for link, (carrier, T) in tree.places.items()}


def _links(robot: Node, joints: Joints) -> Mapping[str, Node]:
    """Return the elements <link> by name; a file may leave out those that only joints name."""
    held = {link for joint in joints.all for link in (joint.parent, joint.child)}
    found: dict[str, Node] = {}
    for node in robot.children:
        if node.name != "link":
            continue
        name = node.text("name")
        if name in found:
            raise ParseError(f"link {name} occurs twice", span=node.span, parameter="name")
        if name not in held:
            raise ParseError(f"no joint holds link {name}", span=node.span, permitted="one root link")
        found[name] = node
    return found


def _inertia(link: str, node: Node | None) -> Inertia | None:
    """Return the inertia of a link in its own axes; None: it has none."""
    inertial = None if node is None else node.child("inertial")
    if inertial is None:
        return None
    mass = _number(_inside(inertial, "mass", link), "value", f"the mass of link {link}", least=0.0)
    given = _inside(inertial, "inertia", link)
    xx, xy, xz, yy, yz, zz = (
        _number(given, name, f"{name} of link {link}", least=-_ROUNDED if name[1] == name[2] else None)
        for name in _MOMENTS
    )
    moments = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    T = placement(inertial.child("origin"), f"the centre of mass of link {link}")
    return Inertia(mass, np.zeros(3), moments).seen_from(T)


def _inside(inertial: Node, name: str, link: str) -> Node:
    found = inertial.child(name)
    if found is None:
        raise ParseError(f"the inertial of link {link} lacks <{name}>", span=inertial.span, parameter=name)
    return found


def _number(node: Node, name: str, what: str, *, least: float | None) -> float:
    node.text(name)
    value = node.numbers(name, (0.0,))[0]
    if (least is not None and value < least) or abs(value) > tolerances.HUGE_INERTIA:
        low = f"{-tolerances.HUGE_INERTIA:.0e}" if least is None else "0"
        permitted = f"{low} up to {tolerances.HUGE_INERTIA:.0e}"
        raise ParseError(f"{what} is {value:g}", span=node.span, parameter=name, permitted=permitted)
    return value
