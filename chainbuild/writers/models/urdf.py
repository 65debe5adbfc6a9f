"""URDF: the tree of a chain with limits and primitive bodies; joint values are Pinocchio's q."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from chainbuild import tolerances
from chainbuild.arrays import Matrix
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.bodies.body import BASE_COLOUR, TOOL_COLOUR, WORKPIECE_SIDE, Body
from chainbuild.chain.bodies.shapes import machine_size, solid_bodies
from chainbuild.chain.elements import BASE_LINK, Chain, Frame, Joint
from chainbuild.chain.followers import followers
from chainbuild.drawing.machine import drawn_bodies
from chainbuild.errors import ChainbuildError, ChainError
from chainbuild.files import angle_text, file_of, number_text, numbers_text, write_text, xml_text
from chainbuild.frames import inverse, translation, urdf_rpy
from chainbuild.units import m_from_mm, rad_from_deg, si_factor
from chainbuild.writers.models import notes
from chainbuild.writers.models.notes import urdf_limitations

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism

__all__ = ["urdf_limitations", "urdf_text", "write_urdf"]

# Machine data hold no drive data. Readers demand the numbers, and 0 would stop a simulated joint.
_DEFAULT_SPEED: Final = {"revolute": math.pi, "prismatic": 1.0}  # rad/s, m/s
_DEFAULT_EFFORT: Final = {"revolute": 1000.0, "prismatic": 10_000.0}  # N·m, N
# Which part of the skeleton is the solid body of which tip, and the colour and size of the mark that shows a tip.
_TIPS: Final = {"tool": "tool", "table": "workpiece"}
_MARKS: Final = {"tool": TOOL_COLOUR, "workpiece": WORKPIECE_SIDE[0]}
_MARK_SHARE: Final = 0.01  # of the machine's size: seen, and in nobody's way


def write_urdf(robot: Mechanism, folder: Path | str = "urdf_out") -> Path:
    """Write a robot as folder/NAME/NAME.urdf and return that path.

    The same robot gives the same bytes on every machine. Links and joints carry the names of the chain, fixed joints
    carry the tips `flange`, `tool` and `workpiece`. `urdf_limitations` returns what the file cannot
    express; the header comment lists it.

    Args:
        robot: The robot.
        folder: Folder in which the folder NAME is created.

    Raises:
        ChainbuildError: the argument is not a robot.
        FileAccessError: the folder is not a path, or the file cannot be written.
    """
    return write_robot_file(robot, folder, "urdf", urdf_text)


def write_robot_file(robot: Mechanism, folder: Path | str, suffix: str, make: Callable[[Mechanism], str]) -> Path:
    """Write a text made of a robot as folder/NAME/NAME.suffix and return that path.

    Raises:
        ChainbuildError: the argument is not a robot.
        FileAccessError: the folder is not a path, or the file cannot be written.
    """
    check_robot(robot)
    text = make(robot)
    path = file_of(folder, robot.name, suffix)
    write_text(path, text)
    return path


def check_robot(robot: object) -> None:
    """Refuse what is no robot.

    Raises:
        ChainbuildError: it is none.
    """
    from chainbuild.kinematics.mechanism import Mechanism

    if not isinstance(robot, Mechanism):
        raise ChainbuildError(f"expected a robot, got {type(robot).__name__}", permitted="a chainbuild.Robot")


def urdf_text(robot: Mechanism) -> str:
    """Return the URDF of a robot."""
    chain = robot.chain
    root = ET.Element("robot", name=chain.name)
    root.append(ET.Comment(f"\n{notes.header(chain)}\n"))
    shown, solid = (
        _by_link(body for body in drawn_bodies(chain) if body.kind != "mesh"),
        _by_link(body for body in solid_bodies(chain) if body.part not in _TIPS),
    )
    for link in chain.links:
        _add_link(root, link.name, shown.get(link.name, ()), solid.get(link.name, ()))
    lower, upper = robot.model.lowerPositionLimit, robot.model.upperPositionLimit
    masters = followers(chain)
    for n, (joint, speed) in enumerate(zip(chain.joints, joint_speeds(chain), strict=True)):
        element = _add_joint(
            root, joint, _bound(joint, float(lower[n]), -1.0), _bound(joint, float(upper[n]), 1.0), speed
        )
        if joint.name in masters:
            master, factor, offset = masters[joint.name]
            multiplier = number_text(factor)
            ET.SubElement(element, "mimic", joint=master, multiplier=multiplier, offset=angle_text(offset))
    _add_tips(root, chain)
    return xml_text(root)


def joint_speeds(chain: Chain) -> tuple[float, ...]:
    """Return the speed limit of every joint [m/s, rad/s]: by the axes' speeds if all are known, else a default."""
    defaults = tuple(_DEFAULT_SPEED[joint.kind] for joint in chain.joints)
    if not isinstance(chain.axis_map, AffineMap):
        return defaults
    speeds = []
    for factors, default in zip(chain.axis_map.A, defaults, strict=True):
        driving = [(axis, abs(float(f))) for axis, f in zip(chain.axes, factors, strict=True) if f != 0.0]
        known = [axis.max_speed * si_factor(axis.kind) * f for axis, f in driving if axis.max_speed is not None]
        speeds.append(sum(known) if known and len(known) == len(driving) else default)
    return tuple(speeds)


def _bound(joint: Joint, value: float, sign: float) -> float:
    """Return a joint bound; a nonlinear map may know none, and URDF needs a finite one."""
    if math.isfinite(value):
        return value
    if joint.kind == "revolute":
        return sign * rad_from_deg(tolerances.ASSUMED_ROTARY_LIMIT_DEG)
    return sign * m_from_mm(tolerances.ASSUMED_LINEAR_LIMIT_MM)


def _by_link(bodies: Iterable[Body]) -> dict[str, list[Body]]:
    """Return bodies by their link."""
    found: dict[str, list[Body]] = {}
    for body in bodies:
        found.setdefault(body.link, []).append(body)
    return found


def _add_link(root: ET.Element, name: str, shown: Iterable[Body], solid: Iterable[Body]) -> None:
    """Write a link: the bodies to look at, and those that count in collisions."""
    link = ET.SubElement(root, "link", name=name)
    for n, body in enumerate(shown, 1):
        visual = ET.SubElement(link, "visual")
        _add_body(visual, body)
        # One material a body and link: some readers do not support colours defined elsewhere.
        colour = f"{name}_colour" if n == 1 else f"{name}_colour{n}"
        material = ET.SubElement(visual, "material", name=colour)
        ET.SubElement(material, "color", rgba=numbers_text((*body.colour, 1.0)))
    for body in solid:
        _add_body(ET.SubElement(link, "collision"), body)


def _add_body(parent: ET.Element, body: Body) -> None:
    T = body.T_link_body
    xyz, rpy = _drawn(T[:3, 3].tolist()), _drawn(urdf_rpy(T[:3, :3]))
    ET.SubElement(parent, "origin", xyz=xyz, rpy=rpy)
    geometry = ET.SubElement(parent, "geometry")
    if body.kind == "box":
        ET.SubElement(geometry, "box", size=_drawn(body.dimensions))
    elif body.kind == "cylinder":
        radius, length = body.dimensions
        ET.SubElement(geometry, "cylinder", radius=_drawn([radius]), length=_drawn([length]))
    else:
        ET.SubElement(geometry, "sphere", radius=_drawn(body.dimensions))


def _drawn(values: Iterable[float]) -> str:
    """Return numbers of a drawing: rounded to micrometres."""
    # Nanometres first: half of a length given to the micrometre would fall with its last bit.
    return numbers_text(round(round(value, 9), 6) for value in values)


def _add_joint(root: ET.Element, joint: Joint, lower: float, upper: float, speed: float) -> ET.Element:
    element = ET.SubElement(root, "joint", name=joint.name, type=joint.kind)
    _add_connection(element, joint.T_parent_joint, joint.parent, joint.child)
    ET.SubElement(element, "axis", xyz=numbers_text(joint.direction.tolist()))
    write = angle_text if joint.kind == "revolute" else number_text
    ET.SubElement(
        element,
        "limit",
        lower=write(lower),
        upper=write(upper),
        velocity=write(speed),
        effort=number_text(_DEFAULT_EFFORT[joint.kind]),
    )
    return element


def _add_tips(root: ET.Element, chain: Chain) -> None:
    """Write the frames as links on fixed joints; frame `base` is the root link itself."""
    links = {link.name for link in chain.links}
    solid = {_TIPS[body.part]: body for body in solid_bodies(chain) if body.part in _TIPS}
    size = _MARK_SHARE * machine_size(chain)
    for frame in chain.frames:
        if frame.name == BASE_LINK:
            continue
        if frame.name in links:
            raise ChainError(f"frame {frame.name} has the name of a link: a URDF needs different names")
        mark = Body(frame.name, "joint", translation(), "sphere", (size,), _MARKS.get(frame.name, BASE_COLOUR))
        body = solid.get(frame.name)
        own = [_in_frame(body, frame)] if body is not None and body.link == frame.link else []
        _add_link(root, frame.name, (mark,), own)
        element = ET.SubElement(root, "joint", name=f"{frame.name}_fixed", type="fixed")
        _add_connection(element, frame.T_link_frame, frame.link, frame.name)


def _in_frame(body: Body, frame: Frame) -> Body:
    """Return a body of the frame's link as one of the frame's own link."""
    return replace(body, link=frame.name, T_link_body=inverse(frame.T_link_frame) @ body.T_link_body)


def _as_written(angle: float) -> float:
    return float(angle_text(angle))


def _add_connection(element: ET.Element, T: Matrix, parent: str, child: str) -> None:
    rpy = " ".join(angle_text(angle) for angle in urdf_rpy(T[:3, :3], _as_written))
    ET.SubElement(element, "origin", xyz=numbers_text(T[:3, 3].tolist()), rpy=rpy)
    ET.SubElement(element, "parent", link=parent)
    ET.SubElement(element, "child", link=child)
