"""Robots from URDF: the joints between the root link and a tool link become a chain.

The axes are the moving joints in the order of the chain, shown in mm and degrees. Other branches (grippers, cameras)
are left out. A joint that mimics another one on the way is driven by that one's axis, with multiplier and offset of the
file, so that joint values are the file's. Meshes and masses are not read.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final
from xml.parsers import expat

from chainbuild import frames, tolerances
from chainbuild.chain.assemble import Element, Fixed, Move, assemble, linear, mark, rotary
from chainbuild.chain.elements import Axis, Chain
from chainbuild.errors import ChainbuildError, ParseError, Span
from chainbuild.formats.text import read_source
from chainbuild.units import AxisKind, deg_from_rad, mm_from_m, unit_of

_KINDS: Final[Mapping[str, AxisKind]] = {"revolute": "rotary", "continuous": "rotary", "prismatic": "linear"}
_MAX_DEPTH: Final = 50  # of XML elements: URDF has five levels


@dataclass(slots=True)
class _Node:
    """One XML element with the line it starts at."""

    name: str
    attributes: Mapping[str, str]
    span: Span
    children: list[_Node] = field(default_factory=list)

    def child(self, name: str) -> _Node | None:
        return next((node for node in self.children if node.name == name), None)

    def text(self, name: str) -> str:
        """Return an attribute that must be there."""
        if name not in self.attributes:
            raise ParseError(f"<{self.name}> lacks the attribute {name}", span=self.span, parameter=name)
        return self.attributes[name]

    def numbers(self, name: str, default: tuple[float, ...]) -> tuple[float, ...]:
        """Return an attribute of as many finite numbers as the default has."""
        if name not in self.attributes:
            return default
        try:
            values = tuple(float(word) for word in self.attributes[name].split())
        except ValueError:
            values = ()
        if len(values) != len(default) or not all(math.isfinite(value) for value in values):
            permitted = f"{len(default)} finite numbers"
            raise ParseError(
                f'{name}="{self.attributes[name]}" in <{self.name}>',
                span=self.span,
                parameter=name,
                permitted=permitted,
            )
        return values


def from_urdf(path: str | os.PathLike[str], *, tool: str | None = None) -> Chain:
    """Read a URDF file into a chain from its root link to a tool link.

    Args:
        path: The file (plain URDF, not xacro).
        tool: Name of the link whose frame is the tool; None: the only link without children.

    Raises:
        FileAccessError: the file cannot be read.
        ParseError: no URDF, a bad number, or a joint type other than revolute, continuous, prismatic, fixed.
        ChainbuildError: the tool link does not exist or is not the only candidate.
    """
    file = Path(path)
    robot = _parse(read_source(file).text, str(path))
    joints = [node for node in robot.children if node.name == "joint" and node.child("parent") is not None]
    way = _way_to(tool, joints, Span(str(path)))
    axes = tuple(_axis(joint) for joint in way if _moves(joint) and joint.child("mimic") is None)
    elements: list[Element] = []
    for joint in way:
        elements += _elements(joint)
    body = assemble(axes, [*elements, mark("flange")])
    title = robot.attributes.get("name", file.stem)
    name = "".join(c if c.isascii() and (c.isalnum() or c in "_-") else "_" for c in title) or "robot"
    chain_axes = (body.links, body.joints, body.frames, axes, body.axis_map)
    return Chain(name, title, "URDF", "URDF", *chain_axes, "orirpy")


def _parse(text: str, file: str) -> _Node:
    parser = expat.ParserCreate("utf-8")
    root = _Node("", {}, Span(file))
    opened = [root]

    def start(name: str, attributes: dict[str, str]) -> None:
        if len(opened) > _MAX_DEPTH:
            raise ParseError("elements nest too deep for a URDF", span=Span(file, parser.CurrentLineNumber))
        node = _Node(name, attributes, Span(file, parser.CurrentLineNumber))
        opened[-1].children.append(node)
        opened.append(node)

    def refuse_doctype(*_: object) -> None:
        raise ParseError("a document type declaration is not permitted", span=Span(file, parser.CurrentLineNumber))

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: opened.pop()
    parser.StartDoctypeDeclHandler = refuse_doctype
    try:
        parser.Parse(text.encode("utf-8"), True)
    except expat.ExpatError as error:
        raise ParseError(
            f"not well-formed XML: {expat.ErrorString(error.code)}", span=Span(file, error.lineno)
        ) from None
    robot = root.child("robot")
    if robot is None:
        raise ParseError("no <robot> element: this is not a URDF file", span=Span(file))
    return robot


def _link(joint: _Node, end: str) -> str:
    node = joint.child(end)
    if node is None:
        raise ParseError(f"joint {joint.text('name')} lacks <{end}>", span=joint.span)
    return node.text("link")


def _way_to(tool: str | None, joints: list[_Node], file: Span) -> list[_Node]:
    """Return the joints from the root link to the tool link."""
    by_child = {_link(joint, "child"): joint for joint in joints}
    parents = {_link(joint, "parent") for joint in joints}
    leaves = sorted(set(by_child) - parents)
    if tool is None and len(leaves) != 1:
        raise ChainbuildError(
            f"{len(leaves)} links could be the tool", span=file, parameter="tool", permitted=", ".join(leaves)
        )
    link = leaves[0] if tool is None else tool
    if link not in by_child:
        known = ", ".join(sorted(by_child))
        raise ChainbuildError(f"no joint leads to a link '{link}'", span=file, parameter="tool", permitted=known)
    way: list[_Node] = []
    while link in by_child:
        if by_child[link] in way:
            raise ParseError(f"link {link} is its own ancestor", span=by_child[link].span)
        way.insert(0, by_child[link])
        link = _link(by_child[link], "parent")
    return way


def _moves(joint: _Node) -> bool:
    kind = joint.text("type")
    if kind != "fixed" and kind not in _KINDS:
        raise ParseError(
            f"joint {joint.text('name')} is of type {kind}", span=joint.span, permitted=", ".join((*_KINDS, "fixed"))
        )
    return kind != "fixed"


def _axis(joint: _Node) -> Axis:
    """Return the axis of a moving joint; where no limits are given they are assumed."""
    name, kind = joint.text("name"), _KINDS[joint.text("type")]
    limit = joint.child("limit")
    speed = None if limit is None else _shown(limit.numbers("velocity", (0.0,))[0], kind) or None
    if joint.text("type") == "continuous":
        bound = tolerances.ASSUMED_ROTARY_LIMIT_DEG
        return Axis(name, kind, unit_of(kind), -bound, bound, True, endless=True, max_speed=speed)
    if limit is None or "lower" not in limit.attributes or "upper" not in limit.attributes:
        return Axis.unlimited(name, kind)
    lower, upper = (_shown(limit.numbers(end, (0.0,))[0], kind) for end in ("lower", "upper"))
    return Axis(name, kind, unit_of(kind), lower, upper, False, max_speed=speed)


def _shown(value: float, kind: AxisKind) -> float:
    return deg_from_rad(value) if kind == "rotary" else mm_from_m(value)


def _elements(joint: _Node) -> list[Element]:
    """Return the fixed placement of a joint and, where it moves, the joint."""
    elements: list[Element] = []
    origin = joint.child("origin")
    if origin is not None:
        roll, pitch, yaw = (deg_from_rad(angle) for angle in origin.numbers("rpy", (0.0, 0.0, 0.0)))
        x, y, z = (mm_from_m(value) for value in origin.numbers("xyz", (0.0, 0.0, 0.0)))
        elements.append(Fixed(frames.f_frame((x, y, z), (yaw, pitch, roll))))
    if _moves(joint):
        elements.append(_move(joint))
    return elements


def _move(joint: _Node) -> Move:
    axis = joint.child("axis")
    direction = (1.0, 0.0, 0.0) if axis is None else axis.numbers("xyz", (1.0, 0.0, 0.0))
    if not any(direction):
        raise ParseError(f"the axis of joint {joint.text('name')} is the zero vector", span=joint.span)
    mimic = joint.child("mimic")
    name, kind = joint.text("name"), _KINDS[joint.text("type")]
    drive = {name: 1.0} if mimic is None else {mimic.text("joint"): mimic.numbers("multiplier", (1.0,))[0]}
    offset = 0.0 if mimic is None else _shown(mimic.numbers("offset", (0.0,))[0], kind)
    place = rotary(name, direction) if kind == "rotary" else linear(name, direction)
    return replace(place, drive=drive, offset=offset, follows=mimic is not None)
