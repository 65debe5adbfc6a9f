"""Robots from URDF: the joints between the root link and a tool link become a chain.

The axes are the moving joints in the order of the chain, shown in mm and degrees. Other branches (grippers, cameras)
are left out. A joint that mimics another one is driven by that one's axis, with multiplier and offset of the file, so
that joint values are the file's; its limits bind the axis, on whatever branch it is. A joint whose limits leave one
value is fixed there. Meshes and masses are not read.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from chainbuild import frames
from chainbuild.chain.assemble import Element, Fixed, Move, assemble, linear, mark, rotary
from chainbuild.chain.elements import FRAME_NAMES, Axis, Chain
from chainbuild.chain.names import DRIVE_SUFFIX, RESERVED_COLUMNS, free_name
from chainbuild.errors import ChainbuildError, ParseError, Span
from chainbuild.findings import Collector, Findings
from chainbuild.formats.text import read_source
from chainbuild.formats.urdf_joints import Joints, UrdfJoint, shown
from chainbuild.formats.urdf_xml import parse

_FRAMES: Final = (*FRAME_NAMES, "universe")  # of every model: a joint of such a name could not be told from them


def from_urdf(path: str | os.PathLike[str], *, tool: str | None = None) -> Chain:
    """Read a URDF file into a chain from its root link to a tool link.

    Args:
        path: The file (plain URDF, not xacro).
        tool: Name of the link whose frame is the tool; None: the only link without children.

    Raises:
        FileAccessError: the file cannot be read.
        ParseError: no URDF, a bad number, a link with two parents, limits that leave nothing, or a joint type other
            than revolute, continuous, prismatic, fixed.
        ChainbuildError: the tool link does not exist or is not the only candidate, or no joint on the way moves.
    """
    file = Path(path)
    robot = parse(read_source(file).text, str(path))
    collector = Collector()
    joints = Joints(robot)
    way = _way_to(tool, joints.all, Span(str(path)))
    joints.tell(way, collector)
    names = _names(joints, collector)
    elements: list[Element] = []
    for joint in way:
        elements += _elements(joint, joints, names)
    axes = _axes(way, joints, names)
    if not axes:
        text = f"none of the joints on the way to link {way[-1].child} moves: {', '.join(joint.name for joint in way)}"
        raise ChainbuildError(text, span=Span(str(path)), parameter="tool", permitted="a way with a moving joint")
    body = assemble(axes, [*elements, mark("flange")])
    title = robot.attributes.get("name", file.stem)
    name = "".join(c if c.isascii() and (c.isalnum() or c in "_-") else "_" for c in title) or "robot"
    chain_axes = (body.links, body.joints, body.frames, axes, body.axis_map)
    return Chain(name, title, "URDF", "URDF", *chain_axes, "orirpy", findings=Findings(collector.findings))


def _way_to(tool: str | None, joints: Sequence[UrdfJoint], file: Span) -> list[UrdfJoint]:
    """Return the joints from the root link to the tool link."""
    by_child = {joint.child: joint for joint in joints}
    if not by_child:
        raise ChainbuildError("the file has no joints", span=file, permitted="a robot with at least one")
    leaves = sorted(set(by_child) - {joint.parent for joint in joints})
    if tool is None and len(leaves) != 1:
        raise ChainbuildError(
            f"{len(leaves)} links could be the tool", span=file, parameter="tool", permitted=", ".join(leaves)
        )
    link = leaves[0] if tool is None else tool
    if link not in by_child:
        known = ", ".join(sorted(by_child))
        raise ChainbuildError(f"no joint leads to a link '{link}'", span=file, parameter="tool", permitted=known)
    way: list[UrdfJoint] = []
    while link in by_child:
        if by_child[link] in way:
            raise ParseError(f"link {link} is its own ancestor", span=by_child[link].span)
        way.insert(0, by_child[link])
        link = by_child[link].parent
    return way


def _names(joints: Joints, collector: Collector) -> dict[str, str]:
    """Return names in the file → in the chain: those of frames and of columns of tables are taken."""
    names = {joint.name: joint.name for joint in joints.all}
    for joint in joints.all:
        folded = joint.name.casefold()
        if joint.name in _FRAMES or folded in RESERVED_COLUMNS or folded.endswith(DRIVE_SUFFIX):
            names[joint.name] = free_name(f"{joint.name}_joint", names.values())
            text = f"joint {joint.name} is called {names[joint.name]}: every robot has a frame or column {joint.name}"
            collector.add("CB523", text, span=joint.span)
    return names


def _axes(way: Iterable[UrdfJoint], joints: Joints, names: Mapping[str, str]) -> tuple[Axis, ...]:
    """Return the axes that drive the joints on the way, in the order in which they come there first."""
    moving = (joint for joint in way if joint.moves and joints.fixed_at(joint) is None)
    drivers = dict.fromkeys(joints.follows(joint).driver for joint in moving)
    return tuple(_axis(driver, joints, names) for driver in drivers)


def _axis(joint: UrdfJoint, joints: Joints, names: Mapping[str, str]) -> Axis:
    """Return the axis of a driving joint; where no limits are given they are assumed."""
    name, kind = names[joint.name], joint.kind
    bounds, speed = joints.bounds(joint), joints.speed(joint)
    axis = Axis.unlimited(name, kind)
    if bounds is None:
        axis = replace(axis, endless=joint.type == "continuous")
    else:
        lower, upper = (shown(value, kind) for value in bounds)
        axis = replace(axis, lower=lower, upper=upper, assumed=False)
    max_speed = None if speed is None else shown(speed, kind)
    return replace(axis, max_speed=max_speed, generic="" if name == joint.name else joint.name)


def _elements(joint: UrdfJoint, joints: Joints, names: Mapping[str, str]) -> list[Element]:
    """Return the fixed placement of a joint and, where it moves, the joint."""
    elements: list[Element] = [] if joint.T_mm is None else [Fixed(joint.T_mm)]
    if not joint.moves:
        return elements
    value = joints.fixed_at(joint)
    if value is None:
        return [*elements, _move(joint, joints, names)]
    if joint.kind == "rotary":
        return [*elements, Fixed(frames.transform(frames.rot_about(joint.direction, shown(value, "rotary"))))]
    along = frames.unit(joint.direction) * shown(value, "linear")
    return [*elements, Fixed(frames.translation(*along.tolist()))]


def _move(joint: UrdfJoint, joints: Joints, names: Mapping[str, str]) -> Move:
    follows = joints.follows(joint)
    name = names[joint.name]
    place = rotary(name, joint.direction) if joint.kind == "rotary" else linear(name, joint.direction)
    drive = {names[follows.driver.name]: follows.factor}
    return replace(place, drive=drive, offset=shown(follows.offset, joint.kind), follows=joint.mimic is not None)
