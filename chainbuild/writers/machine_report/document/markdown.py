"""A report as Markdown; the pictures are files beside it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Final

from chainbuild.files import printable
from chainbuild.writers.machine_report.document.blocks import (
    Bullets,
    Chapter,
    Drawings,
    Heading,
    Paragraph,
    Report,
    ReportBlock,
    TableBlock,
    Verbatim,
)

# What Markdown would take for markup: brackets of links only, underscores at the ends of words.
_MARKUP: Final = re.compile(r"[\\`*|]|~(?=~)|\](?=[\[(:])|^#|(?<!\w)_|_(?!\w)")
_ENTITIES: Final = {"&": "&amp;", "<": "&lt;", ">": "&gt;"}


def markdown_text(report: Report) -> str:
    """Return a report as Markdown."""
    parts = [f"# {_plain(report.title)}"]
    for chapter in report.chapters:
        parts += _chapter(report, chapter)
    return "\n\n".join(parts) + "\n"


def _chapter(report: Report, chapter: Chapter) -> list[str]:
    return [f"## {_plain(chapter.title)}", *(_block(report, block) for block in chapter.blocks)]


def _block(report: Report, block: ReportBlock) -> str:
    if isinstance(block, Paragraph):
        return _line(block.parts)
    if isinstance(block, Heading):
        return f"### {_line(block.parts)}"
    if isinstance(block, Bullets):
        return "\n".join(f"- {_line(item.parts)}" for item in block.items)
    if isinstance(block, Drawings):
        return "\n\n".join(f"![{_plain(one.title)}]({report.file_of_drawing(one)})" for one in block.drawings)
    return _table(block)


def _table(block: TableBlock) -> str:
    lines = [_row(block.head), "|" + "---|" * len(block.head)]
    return "\n".join([*lines, *(_row(row) for row in block.rows)])


def _row(cells: Sequence[str]) -> str:
    return f"| {' | '.join(_span(cell) for cell in cells)} |"


def _line(parts: Iterable[str]) -> str:
    return "".join(_span(part) for part in parts)


def _span(text: str) -> str:
    """Return a text in which nothing is markup, a verbatim one as code."""
    if not isinstance(text, Verbatim):
        return _plain(text)
    inside = printable(_one_line(text), lines=False).replace("`", "'").replace("|", "\\|")
    return f"`{inside}`" if inside else ""


def _plain(text: str) -> str:
    escaped = _MARKUP.sub(lambda found: f"\\{found[0]}", printable(_one_line(text), lines=False))
    return "".join(_ENTITIES.get(letter, letter) for letter in escaped)


def _one_line(text: str) -> str:
    return text.replace("\r", " ").replace("\n", " ")
