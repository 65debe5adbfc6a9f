"""What a report consists of: chapters of paragraphs, lists, tables and drawings, without any markup."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from chainbuild.shown import fields_shown


class Verbatim(str):
    """A text that stands in a file as it is written here: a name of a datum, a choice, a file."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Paragraph:
    """A paragraph.

    Attributes:
        parts: Its texts one behind the other.
    """

    __repr__ = fields_shown

    parts: tuple[str, ...]

    @classmethod
    def of(cls, *parts: str) -> Paragraph:
        """Return a paragraph of texts."""
        return cls(parts)


@dataclass(frozen=True, slots=True)
class Bullets:
    """A list of paragraphs."""

    __repr__ = fields_shown

    items: tuple[Paragraph, ...]


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading within a chapter."""

    __repr__ = fields_shown

    parts: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class TableBlock:
    """A table.

    Attributes:
        head: Titles of the columns.
        rows: Cells of each row.
        kind: "form": empty cells are to be filled in; "facts": the first column names what the others say; "rows":
            cells are numbers and sums, but for the first.
    """

    __repr__ = fields_shown

    head: tuple[str, ...]
    rows: Sequence[Sequence[str]]
    kind: Literal["plain", "form", "facts", "rows"] = "plain"


@dataclass(frozen=True, slots=True)
class Drawing:
    """A picture.

    Attributes:
        name: End of its file's name: "front".
        title: What it shows.
        svg: The picture.
    """

    __repr__ = fields_shown

    name: str
    title: str
    svg: str


@dataclass(frozen=True, slots=True)
class Drawings:
    """Pictures side by side."""

    __repr__ = fields_shown

    drawings: tuple[Drawing, ...]


ReportBlock = Paragraph | Bullets | Heading | TableBlock | Drawings


@dataclass(frozen=True, slots=True)
class Chapter:
    """A chapter.

    Attributes:
        title: Its heading.
        blocks: What it consists of.
    """

    __repr__ = fields_shown

    title: str
    blocks: Sequence[ReportBlock]


@dataclass(frozen=True, slots=True)
class Report:
    """A report.

    Attributes:
        title: Its heading.
        name: Beginning of the names of its files.
        chapters: The chapters.
    """

    __repr__ = fields_shown

    title: str
    name: str
    chapters: tuple[Chapter, ...] = field(default=())

    @property
    def drawings(self) -> tuple[Drawing, ...]:
        """All pictures."""
        blocks = (block for chapter in self.chapters for block in chapter.blocks)
        return tuple(one for block in blocks if isinstance(block, Drawings) for one in block.drawings)

    def file_of_drawing(self, drawing: Drawing) -> str:
        """Return the name of the file of a picture."""
        return f"{self.name}_{drawing.name}.svg"


def table_block(
    head: Sequence[str], rows: Sequence[Sequence[str]], kind: Literal["plain", "form", "facts", "rows"] = "plain"
) -> TableBlock:
    """Return a table without the columns that are empty in every row."""
    if kind == "form" or not rows:
        return TableBlock(tuple(head), rows, kind)
    kept = [n for n in range(len(head)) if any(row[n] for row in rows)]
    return TableBlock(tuple(head[n] for n in kept), [[row[n] for n in kept] for row in rows], kind)
