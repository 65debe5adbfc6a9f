"""TwinCAT projects (.tsproj, .xti): parameter lists inside XML, with the line numbers of the container.

Lists are detected by content. A channel list is the text of an `SdaMds` element, or any text that configures a `trafo`;
an axis list (`AchsMds`) sets `kenngr`, a tool list (`WerkzD`) sets `wz`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, Literal
from xml.parsers import expat

from chainbuild.errors import ParseError, Span
from chainbuild.formats.text import SourceText
from chainbuild.formats.twincat.lists.reader import Line

SectionKind = Literal["channel", "axis", "tool"]

_CHANNEL: Final = re.compile(r"^[ \t]*(trafo(_pcs)?|kin_step|kinematik)[ \t]*\[", re.MULTILINE | re.IGNORECASE)
_AXIS: Final = re.compile(r"^[ \t]*kenngr\.", re.MULTILINE | re.IGNORECASE)
_TOOL: Final = re.compile(r"^[ \t]*wz[ \t]*\[", re.MULTILINE | re.IGNORECASE)
_BY_NAME: Final[Mapping[str, SectionKind]] = {"sdamds": "channel", "achsmds": "axis", "werkzd": "tool"}
_MAX_DEPTH: Final = 200  # far deeper than any project; a bomb of nested elements ends here
_SHORT_TEXT: Final = 200  # characters of a name or number; longer text is a list


@dataclass(frozen=True, slots=True)
class Section:
    """A parameter list inside a container, or a whole plain list.

    Attributes:
        kind: What the list is about.
        lines: Its lines, numbered as in the file.
        facts: Short texts beside it in the XML, by element name: `Name`, `DefaultIndex` … .
    """

    kind: SectionKind
    lines: tuple[Line, ...]
    facts: Mapping[str, str] = field(default_factory=dict)


@dataclass(slots=True)
class _Node:
    """An element that is still open."""

    name: str
    lines: list[Line] = field(default_factory=list)
    facts: dict[str, str] = field(default_factory=dict)
    parent: _Node | None = None
    depth: int = 0


class _Handler:
    """Collects the texts of leaf elements, line by line."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.found: list[tuple[SectionKind, tuple[Line, ...], _Node | None]] = []
        self.node: _Node | None = None
        self.cdata_line = 0
        self.parser = expat.ParserCreate("utf-8")
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = self.end
        self.parser.CharacterDataHandler = self.text
        self.parser.StartCdataSectionHandler = self.cdata
        self.parser.EndCdataSectionHandler = self.end_cdata
        self.parser.StartDoctypeDeclHandler = self.refuse_doctype

    def start(self, name: str, attributes: Mapping[str, str]) -> None:
        depth = 0 if self.node is None else self.node.depth + 1
        if depth > _MAX_DEPTH:
            raise ParseError(
                "the XML is nested too deeply", span=self.span(), permitted=f"{_MAX_DEPTH} levels", code="CB210"
            )
        facts = {"Name": attributes["Name"]} if "Name" in attributes else {}
        self.node = _Node(name, facts=facts, parent=self.node, depth=depth)

    def end(self, _name: str) -> None:
        node = self.node
        assert node is not None  # expat pairs start and end
        self.node = node.parent
        text = "\n".join(line.text for line in node.lines)
        kind = _BY_NAME.get(node.name.lower()) or _kind(text)
        if kind is not None:
            self.found.append((kind, tuple(node.lines), node.parent))
        elif node.parent is not None and len(text) <= _SHORT_TEXT and text.strip():
            node.parent.facts.setdefault(node.name, text.strip())

    def text(self, data: str) -> None:
        if self.node is None:
            return
        first, *rest = data.split("\n")
        number, lines = self.parser.CurrentLineNumber, self.node.lines
        if lines and lines[-1].number == number:
            lines[-1] = Line(number, lines[-1].text + first)
        else:
            lines.append(Line(number, first))
        lines.extend(Line(number + n, piece) for n, piece in enumerate(rest, start=1))

    def cdata(self) -> None:
        self.cdata_line = self.parser.CurrentLineNumber

    def end_cdata(self) -> None:
        self.cdata_line = 0

    def refuse_doctype(self, *_declaration: object) -> None:
        raise ParseError(
            "the XML declares a document type; entities are not expanded", span=self.span(), code="CB211",
            hint="a TwinCAT project has no <!DOCTYPE …>",
        )  # fmt: skip

    def span(self) -> Span:
        return Span(self.file, self.parser.CurrentLineNumber, self.parser.CurrentColumnNumber + 1)


def _kind(text: str) -> SectionKind | None:
    if _CHANNEL.search(text):
        return "channel"
    if _AXIS.search(text):
        return "axis"
    return "tool" if _TOOL.search(text) else None


def read_container(source: SourceText) -> tuple[Section, ...]:
    """Return the parameter lists of a TwinCAT project in document order.

    Raises:
        ParseError: malformed XML, an unfinished CDATA section, a document type declaration, or no list at all.
    """
    handler = _Handler(source.file)
    try:
        # The text is decoded already; what the XML declaration says of its encoding no longer holds.
        handler.parser.Parse(source.text.encode("utf-8"), True)
    except expat.ExpatError as error:
        raise _malformed(handler, error, source) from None
    sections = tuple(Section(kind, lines, _facts(node)) for kind, lines, node in handler.found)
    if not sections:
        raise ParseError(
            "the XML holds no parameter list", span=Span(source.file, 1), code="CB212",
            permitted="a TwinCAT CNC project with channel lists in <SdaMds>",
        )  # fmt: skip
    return sections


def _malformed(handler: _Handler, error: expat.ExpatError, source: SourceText) -> ParseError:
    lines = source.lines()
    text = lines[error.lineno - 1] if 0 < error.lineno <= len(lines) else ""
    if handler.cdata_line:
        return ParseError(
            f"the CDATA section that begins in line {handler.cdata_line} is not closed; the file seems cut off",
            span=Span(source.file, handler.cdata_line, 1, lines[handler.cdata_line - 1]), code="CB210",
        )  # fmt: skip
    return ParseError(
        f"the XML is malformed: {expat.ErrorString(error.code)}", code="CB210",
        span=Span(source.file, error.lineno, error.offset + 1, text),
    )  # fmt: skip


def _facts(node: _Node | None) -> Mapping[str, str]:
    """Return the short texts beside a list and one level up; the nearer one wins."""
    if node is None:
        return {}
    above = node.parent.facts if node.parent is not None else {}
    return {**above, **node.facts}
