"""Robots from URDF: the joints between the root link and a tool link become a chain.

The axes are the moving joints in the order of the chain, shown in mm and degrees. A joint that mimics another one is
driven by that one's axis, with multiplier and offset of the file, so that joint values are the file's; its limits bind
the axis, on whatever branch it is. A joint whose limits leave one value is fixed there. Links keep their names, masses,
bodies and places: those that no axis moves are frames, and on other branches (grippers, cameras) joints that no axis
drives are held.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.bodies.geometry import NO_GEOMETRY
from chainbuild.chain.elements import BASE_LINK, Axis, Chain, Joint, JointKind, Link
from chainbuild.chain.names import DRIVE_SUFFIX, RESERVED_COLUMNS, free_name
from chainbuild.closest import closest
from chainbuild.errors import ChainbuildError, ParseError, Span
from chainbuild.findings import Collector, Findings
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.overlay_poses import with_named_poses
from chainbuild.formats.overlay_sums import with_coupling, with_sums
from chainbuild.formats.overlay_useless import OF_CONTROLS, refuse_useless
from chainbuild.formats.urdf.bodies import urdf_bodies
from chainbuild.formats.urdf.joints import Joints, UrdfJoint, shown
from chainbuild.formats.urdf.tree import RESERVED, Tree, link_places
from chainbuild.formats.urdf.xml import Node
from chainbuild.frames import unit
from chainbuild.units import AxisKind

# What an overlay says to machine data alone, and what to a URDF, too.
_USELESS: Final = {**OF_CONTROLS, "tool_length_mm": ("tool_length_mm",)}
_USEFUL: Final = "name, source, kinematic, endless, [limits], [limits.sums], [speeds], [poses], [geometry], [coupling]"
# Words by which a link at the tip is called, the usual ones first: for an example in a message, nothing is chosen so.
_TOOL_NAMES: Final = ("tcp", "tool", "tool0", "ee", "hand", "gripper", "flange")
_KINDS: Final[Mapping[AxisKind, JointKind]] = {"rotary": "revolute", "linear": "prismatic"}


def urdf_chain(
    robot: Node, file: Path, tool: str | None, overlay: Overlay, collector: Collector, *, bodies: bool = True
) -> Chain:
    """Return the chain of a URDF from its root link to a tool link, with its findings.

    Args:
        robot: The element <robot>.
        file: The file: meshes are relative to it.
        tool: Name of the link whose frame is the tool; None: the only link without children.
        overlay: What it adds.
        collector: Takes the findings.
        bodies: False: without shapes and meshes.

    Raises:
        ChainbuildError: as `chainbuild.from_urdf`.
    """
    joints = Joints(robot)
    way = way_to(tool, joints.all, Span(str(file)))
    tree = Tree(robot, joints, way)
    joints.tell((*way, *(joint for joint in tree.moving if joint not in way)), collector)
    names = _names(joints, collector)
    tree.tell(collector)
    axes = tuple(_axis(driver, joints, names) for driver in tree.drivers)
    if not axes:
        text = f"none of the joints on the way to link {way[-1].child} moves: {', '.join(joint.name for joint in way)}"
        raise ChainbuildError(text, span=Span(str(file)), parameter="tool", permitted="a way with a moving joint")
    title = robot.attributes.get("name", file.stem)
    name = "".join(c if c.isascii() and (c.isalnum() or c in "_-") else "_" for c in title) or "robot"
    moving = tuple(_joint(joint, tree, names[joint.name]) for joint in tree.moving)
    links = (Link(BASE_LINK), *(Link(joint.child) for joint in moving))
    body = (links, moving, tree.frames, axes, _axis_map(tree, joints, axes))
    shapes = urdf_bodies(robot, link_places(tree), file, collector) if bodies else NO_GEOMETRY
    geometry = replace(shapes, inertias=tree.inertias(), source=file)
    chain = Chain(name, title, "URDF", "URDF", *body, "orirpy", geometry=geometry)
    chain = _with_overlay(chain, overlay, tree, collector)
    return replace(chain, findings=Findings(collector.findings))


def named_tool(tool: str | None, overlay: Overlay) -> str | None:
    """Return the tool link that is asked for, else the one that the overlay names as its `kinematic`, else None.

    Raises:
        OverlayError: its `kinematic` is no name.
    """
    given = overlay.kinematic
    if given is not None and not isinstance(given, str):
        raise overlay.error("the kinematic of a URDF is its tool link", ("kinematic",), "the name of a link")
    return given if tool is None else tool


def _with_overlay(chain: Chain, overlay: Overlay, tree: Tree, collector: Collector) -> Chain:
    """Return a chain with what an overlay says; links go by the file's names and by the chain's."""
    refuse_useless(overlay, _USELESS, "a URDF", _USEFUL)
    for link in overlay.geometry.links:
        carrier, _ = tree.places.get(link, (link, None))
        if carrier != link:
            text = f"link '{link}' is fixed to link '{carrier}': as a body it is part of that one"
            raise overlay.error(text, ("geometry", link), f"{carrier}, in its axes")
    chain = with_coupling(chain, overlay)
    chain = with_sums(chain.with_axes(overlay.apply_limits(chain.axes)), overlay)
    chain = overlay.apply_geometry(chain, tree.names)
    return with_named_poses(replace(chain, title=overlay.name or chain.title), overlay, collector)


def way_to(tool: str | None, joints: Sequence[UrdfJoint], file: Span) -> list[UrdfJoint]:
    """Return the joints from the root link to the tool link.

    Args:
        tool: Name of the link; None: the only one without children.
        joints: The joints of the file.
        file: Its place, for errors.

    Raises:
        ChainbuildError: there is no such link, or several could be meant.
        ParseError: a link is its own ancestor.
    """
    by_child = {joint.child: joint for joint in joints}
    if not by_child:
        raise ChainbuildError("the file has no joints", span=file, permitted="a robot with at least one")
    leaves = sorted(set(by_child) - {joint.parent for joint in joints})
    if tool is None and len(leaves) != 1:
        raise _unclear(leaves, joints, file)
    link = leaves[0] if tool is None else tool
    if link not in by_child:
        near = closest(link, by_child)
        known = ", ".join(sorted(by_child))
        hint = f"did you mean {near}?" if near else None
        text = f"no joint leads to a link '{link}'"
        raise ChainbuildError(text, span=file, parameter="tool", permitted=known, hint=hint)
    way: list[UrdfJoint] = []
    while link in by_child:
        if by_child[link] in way:
            raise ParseError(f"link {link} is its own ancestor", span=by_child[link].span)
        way.insert(0, by_child[link])
        link = by_child[link].parent
    return way


def moved_leaves(joints: Sequence[UrdfJoint], file: Span) -> list[str]:
    """Return the links without children behind a joint that moves, sorted: a table's top on the base is no tool.

    Raises:
        ParseError: a link is its own ancestor.
    """
    leaves = sorted({joint.child for joint in joints} - {joint.parent for joint in joints})
    return [link for link in leaves if any(joint.moves for joint in way_to(link, joints, file) if not joint.stays)]


def _unclear(leaves: list[str], joints: Sequence[UrdfJoint], file: Span) -> ChainbuildError:
    """Return the error where several links could be the tool: the example is the one that sounds most like it."""
    moved = moved_leaves(joints, file)
    meant = moved if len(moved) > 1 else leaves
    words = [re.sub(r"[^a-z0-9]+", "_", link.casefold()).split("_") for link in meant]
    spoken = [name for name in _TOOL_NAMES if any(name in parts for parts in words)]
    like = [link for name in spoken for link, parts in zip(meant, words, strict=True) if name in parts]
    example = (like or moved or leaves or ["LINK"])[0 if like else -1]
    return ChainbuildError(
        f"{len(meant)} links could be the tool",
        span=file,
        parameter="tool",
        permitted=", ".join(meant),
        hint=f'name the link whose frame is the TCP, such as tool="{example}" (--tool {example})',
    )


def _names(joints: Joints, collector: Collector) -> dict[str, str]:
    """Return names in the file → in the chain: those of frames and of columns of tables are taken."""
    names = {joint.name: joint.name for joint in joints.all}
    for joint in joints.all:
        folded = joint.name.casefold()
        if joint.name in RESERVED or folded in RESERVED_COLUMNS or folded.endswith(DRIVE_SUFFIX):
            names[joint.name] = free_name(f"{joint.name}_joint", names.values())
            text = f"joint {joint.name} is called {names[joint.name]}: every robot has a frame or column {joint.name}"
            collector.add("CB523", text, span=joint.span)
    return names


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


def _joint(joint: UrdfJoint, tree: Tree, name: str) -> Joint:
    """Return a joint of the chain: its value is the file's."""
    parent, T = tree.T_parent_joint(joint)
    direction = unit(joint.direction) + 0.0  # without signed zeros
    return Joint(name, _KINDS[joint.kind], parent, tree.names[joint.child], T, direction, dynamics=joint.dynamics)


def _axis_map(tree: Tree, joints: Joints, axes: Sequence[Axis]) -> AffineMap:
    """Return the map from the axes to the joints, which are driven by one each."""
    A, b = np.zeros((len(tree.moving), len(axes))), np.zeros(len(tree.moving))
    for row, joint in enumerate(tree.moving):
        follows = joints.follows(joint)
        A[row, tree.drivers.index(follows.driver)], b[row] = follows.factor, follows.offset
    return AffineMap.of(A, b, [axis.kind for axis in axes])
