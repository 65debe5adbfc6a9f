"""The XML of a URDF file: elements with the line each starts at, and attributes that are checked when they are read."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final
from xml.parsers import expat

from chainbuild.errors import ParseError, Span

_MAX_DEPTH: Final = 50  # of XML elements: URDF has five levels
_XACRO: Final = "the file is xacro, a template of URDF"
_OF_SRDF: Final = ("group", "group_state", "disable_collisions", "virtual_joint", "end_effector")


@dataclass(slots=True)
class Node:
    """One XML element.

    Attributes:
        name: Its name.
        attributes: Its attributes as text.
        span: The line it starts at.
        children: The elements inside it.
    """

    name: str
    attributes: Mapping[str, str]
    span: Span
    children: list[Node] = field(default_factory=list)

    def child(self, name: str) -> Node | None:
        """Return the first element of a name inside this one."""
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
            values = tuple(float(word) for word in self.attributes[name].replace("_", "?").split())
        except ValueError:
            values = ()
        if len(values) != len(default) or not all(math.isfinite(value) for value in values):
            permitted = "a finite number" if len(default) == 1 else f"{len(default)} finite numbers"
            raise ParseError(
                f'{name}="{self.attributes[name]}" in <{self.name}>',
                span=self.span,
                parameter=name,
                permitted=permitted,
            )
        return values


def parse(text: str, file: str) -> Node:
    """Return the element <robot> of a URDF file.

    Args:
        text: What the file holds.
        file: Its name, for errors.

    Raises:
        ParseError: the text is no URDF, or xacro that is not expanded.
    """
    parser = expat.ParserCreate("utf-8")
    root = Node("", {}, Span(file))
    opened = [root]

    def start(name: str, attributes: dict[str, str]) -> None:
        if len(opened) > _MAX_DEPTH:
            raise ParseError("elements nest too deep for a URDF", span=Span(file, parser.CurrentLineNumber))
        node = Node(name, attributes, Span(file, parser.CurrentLineNumber))
        if name.startswith("xacro:") or any("${" in value for value in attributes.values()):
            target = "expanded.urdf" if file.endswith("robot.urdf") else "robot.urdf"
            expand = f"expand it first: xacro {file} > {target}"
            raise ParseError(_XACRO, span=node.span, permitted="plain URDF", hint=expand)
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
    if not robot.child("joint") and any(robot.child(name) for name in _OF_SRDF):
        raise ParseError("this is SRDF, which says more of a URDF", span=robot.span, hint="give the URDF")
    return robot
