"""URDF: the tree of a chain with limits and primitive bodies; joint values are Pinocchio's q."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final

from chainbuild import tolerances
from chainbuild.arrays import Matrix
from chainbuild.chain.bodies.body import BASE_COLOUR, TOOL_COLOUR, WORKPIECE_SIDE, Body, Colour, by_link
from chainbuild.chain.bodies.geometry import Shape
from chainbuild.chain.bodies.inertia import Inertia
from chainbuild.chain.bodies.shapes import machine_size, solid_bodies
from chainbuild.chain.elements import BASE_LINK, Chain, Frame, Joint
from chainbuild.chain.followers import followers
from chainbuild.comparison.convention_trials import Selection
from chainbuild.drawing.machine import drawn_bodies
from chainbuild.errors import ChainError
from chainbuild.files import angle_text, number_text, numbers_text, xml_text
from chainbuild.frames import inverse, translation, urdf_rpy
from chainbuild.kinematics.evaluation import joint_speed_limits
from chainbuild.units import m_from_mm, rad_from_deg
from chainbuild.writers.models import notes
from chainbuild.writers.models.loops import loop_files
from chainbuild.writers.models.masses import holding_efforts, link_inertias
from chainbuild.writers.models.meshes import Meshes, add_origin
from chainbuild.writers.models.notes import urdf_limitations
from chainbuild.writers.models.robotfiles import RobotFiles, check_robot, write_robot_files

if TYPE_CHECKING:
    from chainbuild.formats.machine import Machine
    from chainbuild.kinematics.mechanism import Mechanism

__all__ = ["urdf_files", "urdf_limitations", "urdf_text", "write_urdf"]

# Machine data hold no drive data. Readers demand the numbers, and 0 would stop a simulated joint.
_DEFAULT_SPEED: Final = {"revolute": math.pi, "prismatic": 1.0}  # rad/s, m/s
_DEFAULT_EFFORT: Final = {"revolute": 1000.0, "prismatic": 10_000.0}  # N·m, N
_MARGIN: Final = 1.6  # over what holds the estimated masses: to move them, too; checkers ask for 1.5
_MOMENTS: Final = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))  # as URDF names them
# Which part of the skeleton is the solid body of which tip, and the colour and size of the mark that shows a tip.
_TIPS: Final = {"tool": "tool", "table": "workpiece"}
_MARKS: Final = {"tool": TOOL_COLOUR, "workpiece": WORKPIECE_SIDE[0]}
_MARK_SHARE: Final = 0.01  # of the machine's size: seen, and in nobody's way


def write_urdf(
    robot: Mechanism,
    folder: Path | str = "urdf_out",
    *,
    inertia: bool = True,
    machine: Machine | None = None,
    selection: Selection | None = None,
) -> Path:
    """Write a robot as folder/NAME/NAME.urdf and return that path.

    The same robot gives the same bytes on every machine. Links and joints carry the names of the chain, fixed joints
    carry the tips `flange`, `tool` and `workpiece`. `urdf_limitations` returns what the file cannot
    express; the header comment lists it. What it takes to drive loops and couplings by axis values is in
    NAME.loops.yaml beside it, meshes are in a folder `meshes`.

    Args:
        robot: The robot.
        folder: Folder in which the folder NAME is created.
        inertia: False: leave out masses, which are estimates where no URDF gives any.
        machine: The file that the robot was built from: its data are in the head.
        selection: Which kinematic of the file the robot is; None: the default.

    Raises:
        ChainbuildError: the argument is not a robot.
        FileAccessError: the folder is not a path, a file cannot be written, or a mesh cannot be read.
    """
    check_robot(robot)
    data = () if machine is None else notes.machine_data(machine, selection or Selection())
    return write_robot_files(robot, folder, urdf_files(robot, inertia=inertia, data=data))[f"{robot.name}.urdf"]


def urdf_text(robot: Mechanism, *, inertia: bool = True) -> str:
    """Return the URDF of a robot, with or without masses."""
    return str(urdf_files(robot, inertia=inertia)[f"{robot.name}.urdf"])


def urdf_files(robot: Mechanism, *, inertia: bool = True, data: Sequence[str] = ()) -> RobotFiles:
    """Return the URDF of a robot and the files that belong to it: meshes, and loops and couplings if it has any.

    Args:
        robot: The robot.
        inertia: Whether to write masses.
        data: Machine data for the head, a line each.
    """
    chain = robot.chain
    root = ET.Element("robot", name=chain.name)
    beside = loop_files(robot)
    head = notes.header(chain, inertia=inertia, data=data, loops=next(iter(beside), ""))
    root.append(ET.Comment(f"\n{head}\n"))
    bodies, meshes = drawn_bodies(chain), Meshes()
    inertias = link_inertias(chain, bodies)
    drawn = _Bodies(chain, bodies, meshes)
    for link in chain.links:
        element = ET.SubElement(root, "link", name=link.name)
        # What stands fast needs no estimate, and some readers want none of a root.
        if inertia and link.name in inertias and (link.name != BASE_LINK or chain.geometry.inertias):
            _add_inertia(element, inertias[link.name])
        drawn.add_to(element, link.name)
    lower, upper = robot.model.lowerPositionLimit, robot.model.upperPositionLimit
    masters = followers(chain)
    efforts = holding_efforts(chain, inertias)
    for n, (joint, speed) in enumerate(zip(chain.joints, joint_speeds(chain), strict=True)):
        ends = _bound(joint, float(lower[n]), -1.0), _bound(joint, float(upper[n]), 1.0)
        element = _add_joint(root, joint, *ends, speed, float(efforts[n]))
        if joint.name in masters:
            master, factor, offset = masters[joint.name]
            multiplier = number_text(factor)
            ET.SubElement(element, "mimic", joint=master, multiplier=multiplier, offset=angle_text(offset))
    _add_tips(root, chain, drawn)
    return {f"{robot.name}.urdf": xml_text(root), **beside, **meshes.files}


def joint_speeds(chain: Chain) -> tuple[float, ...]:
    """Return the speed limit of every joint [m/s, rad/s]: by the axes' speeds if all are known, else a default."""
    known = zip(joint_speed_limits(chain).tolist(), chain.joints, strict=True)
    return tuple(speed if math.isfinite(speed) else _DEFAULT_SPEED[joint.kind] for speed, joint in known)


def _bound(joint: Joint, value: float, sign: float) -> float:
    """Return a joint bound; a nonlinear map may know none, and URDF needs a finite one."""
    if math.isfinite(value):
        return value
    if joint.kind == "revolute":
        return sign * rad_from_deg(tolerances.ASSUMED_ROTARY_LIMIT_DEG)
    return sign * m_from_mm(tolerances.ASSUMED_LINEAR_LIMIT_MM)


class _Bodies:
    """Writes what is seen of a link, and what counts in collisions.

    Args:
        chain: The chain.
        bodies: What is drawn of it.
        meshes: Takes the meshes.
    """

    def __init__(self, chain: Chain, bodies: Iterable[Body], meshes: Meshes) -> None:
        self._given, self._meshes = chain.geometry, meshes
        self._drawn = by_link(bodies)
        own = [body for body in solid_bodies(chain) if body.link not in chain.geometry.shapes]
        self._solid = by_link(body for body in own if body.part not in _TIPS)
        self.tips = {_TIPS[body.part]: body for body in own if body.part in _TIPS}

    def add_to(self, element: ET.Element, link: str) -> None:
        """Write the bodies of a link of the chain."""
        drawn, given = self._drawn.get(link, []), self._given.shapes.get(link)
        seen = self._given.visuals.get(link)
        if seen is None and any(shape.file is not None for shape in given or ()):
            seen = given
        if seen is None:
            _add_visuals(element, drawn)
        else:
            self._add_seen(element, seen, drawn[0].colour if drawn else TOOL_COLOUR)
        if given is None:
            _add_solids(element, self._solid.get(link, ()))
        else:
            self._meshes.add_bodies(element, "collision", given)

    def _add_seen(self, element: ET.Element, shapes: Iterable[Shape], colour: Colour) -> None:
        for n, (visual, shape) in enumerate(self._meshes.add_bodies(element, "visual", shapes), 1):
            _add_colour(visual, element.attrib["name"], n, shape.colour or colour)


def _add_visuals(element: ET.Element, bodies: Iterable[Body]) -> None:
    """Write bodies to look at."""
    for n, body in enumerate(bodies, 1):
        visual = ET.SubElement(element, "visual")
        _add_body(visual, body)
        _add_colour(visual, element.attrib["name"], n, body.colour)


def _add_solids(element: ET.Element, bodies: Iterable[Body]) -> None:
    """Write bodies that count in collisions."""
    for body in bodies:
        _add_body(ET.SubElement(element, "collision"), body)


def _add_colour(visual: ET.Element, link: str, n: int, colour: Colour) -> None:
    # One material a body and link: some readers do not support colours defined elsewhere.
    material = ET.SubElement(visual, "material", name=f"{link}_colour" if n == 1 else f"{link}_colour{n}")
    ET.SubElement(material, "color", rgba=numbers_text((*colour, 1.0)))


def _add_inertia(element: ET.Element, inertia: Inertia) -> None:
    inertial = ET.SubElement(element, "inertial")
    ET.SubElement(inertial, "origin", xyz=numbers_text(inertia.centre.tolist()), rpy="0 0 0")
    ET.SubElement(inertial, "mass", value=f"{inertia.mass:.15g}")
    moments = {f"i{'xyz'[i]}{'xyz'[k]}": f"{float(inertia.moments[i, k]) + 0.0:.15g}" for i, k in _MOMENTS}
    ET.SubElement(inertial, "inertia", moments)


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


def _add_joint(root: ET.Element, joint: Joint, lower: float, upper: float, speed: float, holding: float) -> ET.Element:
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
        effort=number_text(_effort(joint, holding)),
    )
    losses = {"damping": joint.dynamics.damping, "friction": joint.dynamics.friction}
    if any(losses.values()):
        ET.SubElement(element, "dynamics", {name: number_text(loss) for name, loss in losses.items()})
    return element


def _effort(joint: Joint, holding: float) -> float:
    """Return the effort of a joint: that of a URDF, else a default, or what it takes to hold estimated masses."""
    if joint.dynamics.effort is not None:
        return joint.dynamics.effort
    wanted = _MARGIN * holding
    if wanted <= _DEFAULT_EFFORT[joint.kind]:
        return _DEFAULT_EFFORT[joint.kind]
    step = 10.0 ** (math.floor(math.log10(wanted)) - 1)
    return math.ceil(wanted / step) * step


def _add_tips(root: ET.Element, chain: Chain, bodies: _Bodies) -> None:
    """Write the frames as links on fixed joints; frame `base` is the root link itself."""
    links = {link.name for link in chain.links}
    size = _MARK_SHARE * machine_size(chain)
    for frame in chain.frames:
        if frame.name == BASE_LINK:
            continue
        if frame.name in links:
            raise ChainError(f"frame {frame.name} has the name of a link: a URDF needs different names")
        element = ET.SubElement(root, "link", name=frame.name)
        if not chain.geometry.visuals:
            colour = _MARKS.get(frame.name, BASE_COLOUR)
            _add_visuals(element, [Body(frame.name, "joint", translation(), "sphere", (size,), colour)])
        body = bodies.tips.get(frame.name)
        if body is not None and body.link == frame.link:
            _add_solids(element, [_in_frame(body, frame)])
        fixed = ET.SubElement(root, "joint", name=f"{frame.name}_fixed", type="fixed")
        _add_connection(fixed, frame.T_link_frame, frame.link, frame.name)


def _in_frame(body: Body, frame: Frame) -> Body:
    """Return a body of the frame's link as one of the frame's own link."""
    return replace(body, link=frame.name, T_link_body=inverse(frame.T_link_frame) @ body.T_link_body)


def _add_connection(element: ET.Element, T: Matrix, parent: str, child: str) -> None:
    add_origin(element, T)
    ET.SubElement(element, "parent", link=parent)
    ET.SubElement(element, "child", link=child)
