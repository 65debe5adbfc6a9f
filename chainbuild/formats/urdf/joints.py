"""The joints of a URDF file: which link carries which, which joint follows which, and what limits leave of their range.

Values are SI here, as in the file.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild import frames, tolerances
from chainbuild.arrays import Matrix
from chainbuild.chain.bodies.inertia import JointDynamics
from chainbuild.errors import ParseError, Span
from chainbuild.findings import Collector
from chainbuild.formats.urdf.xml import Node
from chainbuild.units import AxisKind, deg_from_rad, m_from_mm, mm_from_m, rad_from_deg

Bounds = tuple[float, float]

_KINDS: Final[Mapping[str, AxisKind]] = {"revolute": "rotary", "continuous": "rotary", "prismatic": "linear"}
_STAYING: Final = ("floating", "planar")  # types of URDF with several degrees of freedom
_ENDLESS: Final = (-math.inf, math.inf)
_ONE_VALUE: Final = 1e-9  # m and rad: limits with rounded digits that leave one value miss each other by so much


def placement(origin: Node | None, owner: str) -> Matrix:
    """Return the (4, 4) placement [m] that an <origin> gives; None: the identity.

    Args:
        origin: The element.
        owner: What is placed, for errors: "joint A1".

    Raises:
        ParseError: numbers that are none, or too large for the arithmetic.
    """
    if origin is None:
        return np.eye(4)
    roll, pitch, yaw = (deg_from_rad(angle) for angle in origin.numbers("rpy", (0.0, 0.0, 0.0)))
    if max(abs(roll), abs(pitch), abs(yaw)) > tolerances.HUGE_AXIS_VALUE:
        permitted = f"up to {tolerances.HUGE_AXIS_VALUE:.0e} degrees, in radians"
        raise ParseError(f"{owner} is turned by too much", span=origin.span, parameter="rpy", permitted=permitted)
    place = origin.numbers("xyz", (0.0, 0.0, 0.0))
    if max(map(abs, place)) > tolerances.HUGE_POSITION_M:
        permitted = f"up to {tolerances.HUGE_POSITION_M:g} m"
        raise ParseError(f"{owner} is too far away", span=origin.span, parameter="xyz", permitted=permitted)
    return frames.f_frame(place, (yaw, pitch, roll))


def shown(value: float, kind: AxisKind) -> float:
    """Return a joint value, m or rad, in mm or degrees."""
    return deg_from_rad(value) if kind == "rotary" else mm_from_m(value)


@dataclass(frozen=True, slots=True, eq=False)
class UrdfJoint:
    """A joint as the file gives it; its elements are checked when they are read.

    Attributes:
        name: Its name.
        parent: Link that carries it.
        child: Link that it moves.
        node: Its element.
    """

    name: str
    parent: str
    child: str
    node: Node

    @property
    def span(self) -> Span:
        """Where it is."""
        return self.node.span

    @property
    def type(self) -> str:
        """Its type: one of those that chains have."""
        kind = self.node.text("type")
        if kind != "fixed" and kind not in _KINDS:
            text = f"joint {self.name} is of type {kind}"
            raise ParseError(text, span=self.span, permitted=", ".join((*_KINDS, "fixed")))
        return kind

    @property
    def moves(self) -> bool:
        """Whether it is of a type that moves."""
        return self.type != "fixed"

    @property
    def stays(self) -> bool:
        """Whether it is of a type that chains do not have: beside the way to the tool it stays at its origin."""
        return self.node.text("type") in _STAYING

    @property
    def kind(self) -> AxisKind:
        """How it moves."""
        return _KINDS[self.type]

    @property
    def mimic(self) -> Node | None:
        """What it follows, if anything."""
        return self.node.child("mimic") if self.moves else None

    @property
    def T(self) -> Matrix:
        """(4, 4) its placement in the parent link [m]."""
        return placement(self.node.child("origin"), f"joint {self.name}")

    def T_at(self, value: float) -> Matrix:
        """Return the child link in the parent link [m] at a joint value, m or rad."""
        T = self.T
        if not value or self.stays:
            return T
        if self.kind == "linear":
            return T @ frames.transform(None, frames.unit(self.direction) * value)
        return T @ frames.transform(frames.rot_about(self.direction, deg_from_rad(value)))

    @property
    def direction(self) -> tuple[float, float, float]:
        """Direction of its axis, its largest component 1 or -1."""
        axis = self.node.child("axis")
        x, y, z = (1.0, 0.0, 0.0) if axis is None else axis.numbers("xyz", (1.0, 0.0, 0.0))
        largest = max(abs(x), abs(y), abs(z))
        if largest < tolerances.ZERO_VECTOR:
            raise ParseError(f"the axis of joint {self.name} is the zero vector", span=self.span)
        return x / largest, y / largest, z / largest

    @property
    def own_bounds(self) -> Bounds:
        """Its limits in the file; infinite where it has none."""
        limit = self.node.child("limit")
        if self.type == "continuous" or limit is None or not {"lower", "upper"} & limit.attributes.keys():
            return _ENDLESS
        lower, upper = (limit.numbers(end, (0.0,))[0] for end in ("lower", "upper"))
        if lower > upper:
            text = f"the limits of joint {self.name} leave nothing: {lower:g} … {upper:g}"
            raise ParseError(text, span=limit.span, parameter="lower, upper", permitted="lower up to upper")
        huge = tolerances.HUGE_AXIS_VALUE  # files say 1e16 where nothing limits a joint
        return (lower if lower > -huge else -math.inf), (upper if upper < huge else math.inf)

    @property
    def missing_end(self) -> str | None:
        """Return the end of its range that the file leaves out, where it gives the other."""
        limit = self.node.child("limit")
        if limit is None or self.type in {"continuous", "fixed"}:
            return None
        missing = [end for end in ("lower", "upper") if end not in limit.attributes]
        return missing[0] if len(missing) == 1 else None

    @property
    def own_speed(self) -> float:
        """Its highest speed; infinite where the file gives none."""
        limit = self.node.child("limit")
        speed = 0.0 if limit is None else limit.numbers("velocity", (0.0,))[0]
        if limit is not None and speed < 0.0:
            text = f"the highest speed of joint {self.name} is {speed:g}"
            raise ParseError(text, span=limit.span, parameter="velocity", permitted="0 and more")
        return speed or math.inf

    @property
    def dynamics(self) -> JointDynamics:
        """Its largest effort, its damping and its friction."""
        limit, given = self.node.child("limit"), self.node.child("dynamics")
        effort = None if limit is None or "effort" not in limit.attributes else self._at_least_0(limit, "effort")
        if given is None:
            return JointDynamics(effort)
        return JointDynamics(effort, self._at_least_0(given, "damping"), self._at_least_0(given, "friction"))

    def _at_least_0(self, node: Node, name: str) -> float:
        value = node.numbers(name, (0.0,))[0]
        if value < 0.0:
            text = f"the {name} of joint {self.name} is {value:g}"
            raise ParseError(text, span=node.span, parameter=name, permitted="0 and more")
        return value


@dataclass(frozen=True, slots=True, eq=False)
class Follows:
    """What drives a joint: its value is factor · driver's + offset, SI."""

    driver: UrdfJoint
    factor: float
    offset: float


class Joints:
    """All joints of a file: a tree of links, and who follows whom.

    Args:
        robot: The element <robot>.

    Raises:
        ParseError: joints that make no tree, or a name that is empty or occurs twice.
    """

    def __init__(self, robot: Node) -> None:
        self.all = tuple(_joint(node) for node in robot.children if node.name == "joint")
        self._named = {joint.name: joint for joint in self.all}
        _check_names(self.all)
        _check_tree(self.all, robot.span)

    def follows(self, joint: UrdfJoint) -> Follows:
        """Return what drives a moving joint in the end: itself, or what it mimics, also by way of others.

        Raises:
            ParseError: it follows itself, a fixed joint or one that the file does not have.
        """
        driver, factor, offset = joint, 1.0, 0.0
        for _ in self.all:
            mimic = driver.mimic
            if mimic is None:
                return Follows(driver, factor, offset)
            target = self._named.get(mimic.text("joint"))
            if target is None or not target.moves:
                wrong = "which the file does not have" if target is None else "which is fixed"
                moving = ", ".join(sorted(other.name for other in self.all if other.type != "fixed"))
                text = f"joint {driver.name} mimics joint {mimic.text('joint')}, {wrong}"
                raise ParseError(text, span=mimic.span, parameter="joint", permitted=moving)
            offset += factor * mimic.numbers("offset", (0.0,))[0]
            factor *= mimic.numbers("multiplier", (1.0,))[0]
            driver = target
        raise ParseError(f"joint {joint.name} mimics itself, by way of others", span=joint.span, parameter="mimic")

    def bounds(self, driver: UrdfJoint) -> Bounds | None:
        """Return what its own limits and those of the joints that follow it leave to a driving joint; None: no limits.

        Raises:
            ParseError: they leave nothing.
        """
        lower, upper = driver.own_bounds
        for follower, follows in self._followers(driver):
            low, high = follower.own_bounds
            if not follows.factor:
                if not low - _ONE_VALUE <= follows.offset <= high + _ONE_VALUE:
                    text = f"joint {follower.name} stands at {follows.offset:g}, outside its limits {low:g} … {high:g}"
                    raise ParseError(text, span=follower.span)
                continue
            ends = sorted((end - follows.offset) / follows.factor for end in (low, high))
            lower, upper = max(lower, ends[0]), min(upper, ends[1])
            if lower > upper + _ONE_VALUE:
                text = f"the limits of joint {follower.name} leave joint {driver.name}, which it follows, no value"
                raise ParseError(text, span=follower.span, parameter="limit", permitted="limits that overlap")
        if (lower, upper) == _ENDLESS:
            return None
        widest = self._assumed(driver.kind)
        # With one end alone, the other is assumed as if there were none.
        lower = lower if math.isfinite(lower) else min(-widest, upper - widest)
        return lower, max(upper, lower) if math.isfinite(upper) else max(widest, lower + widest)

    @staticmethod
    def _assumed(kind: AxisKind) -> float:
        if kind == "rotary":
            return rad_from_deg(tolerances.ASSUMED_ROTARY_LIMIT_DEG)
        return m_from_mm(tolerances.ASSUMED_LINEAR_LIMIT_MM)

    def speed(self, driver: UrdfJoint) -> float | None:
        """Return the highest speed of a driving joint at which no follower exceeds its own; None: none is known."""
        shares = (f.own_speed / abs(by.factor) for f, by in self._followers(driver) if by.factor)
        speed = min((driver.own_speed, *shares))
        return speed if math.isfinite(speed) else None

    def _followers(self, driver: UrdfJoint) -> list[tuple[UrdfJoint, Follows]]:
        mimics = [joint for joint in self.all if joint.node.child("mimic") is not None and joint.mimic is not None]
        found = [(joint, self.follows(joint)) for joint in mimics]
        return [(joint, follows) for joint, follows in found if follows.driver is driver]

    def fixed_at(self, joint: UrdfJoint) -> float | None:
        """Return the one value that limits leave to a moving joint, or None where it can move."""
        follows = self.follows(joint)
        bounds = self.bounds(follows.driver)
        if not follows.factor:
            return follows.offset
        if bounds is None or bounds[1] - bounds[0] > _ONE_VALUE:
            return None
        return follows.factor * bounds[0] + follows.offset

    def tell(self, way: Iterable[UrdfJoint], collector: Collector) -> None:
        """Record which joints on a way lack one end of their limits, and which are fixed by theirs."""
        moving = [joint for joint in way if joint.moves]
        for joint in dict.fromkeys((*moving, *(self.follows(joint).driver for joint in moving))):
            missing = joint.missing_end
            if missing is not None:
                text = f"joint {joint.name} has no {missing} limit: it is 0, as URDF specifies"
                collector.add("CB521", text, span=joint.span, parameter=missing)
        for joint in moving:
            value = self.fixed_at(joint)
            if value is not None:
                unit = "rad" if joint.kind == "rotary" else "m"
                text = f"joint {joint.name} is fixed at {value:g} {unit}: no limits leave it another value"
                collector.add("CB522", text, span=joint.span)


def _joint(node: Node) -> UrdfJoint:
    name = node.text("name")
    parent, child = (_link(node, name, end) for end in ("parent", "child"))
    return UrdfJoint(name, parent, child, node)


def _link(node: Node, name: str, end: str) -> str:
    element = node.child(end)
    if element is None:
        raise ParseError(f"joint {name} lacks <{end}>", span=node.span)
    return element.text("link")


def _check_names(joints: Iterable[UrdfJoint]) -> None:
    seen: set[str] = set()
    for joint in joints:
        if not joint.name.strip():
            raise ParseError("a joint has no name", span=joint.span, parameter="name")
        if joint.name in seen:
            raise ParseError(f"joint {joint.name} occurs twice", span=joint.span, parameter="name")
        seen.add(joint.name)


def _check_tree(joints: Sequence[UrdfJoint], file: Span) -> None:
    carriers: dict[str, UrdfJoint] = {}
    for joint in joints:
        if joint.child in carriers:
            text = f"link {joint.child} has two parents: joints {carriers[joint.child].name} and {joint.name}"
            hint = "URDF has no closed loops: leave one of them out"
            raise ParseError(text, span=joint.span, parameter="child", permitted="one joint for each link", hint=hint)
        carriers[joint.child] = joint
    roots = sorted({joint.parent for joint in joints} - carriers.keys())
    if len(roots) > 1:
        text = f"{len(roots)} links have no parent: {', '.join(roots)}"
        raise ParseError(text, span=Span(file.file), permitted="one root link")
