"""A report as one HTML page: no scripts, the pictures inside, everything that comes from a file escaped."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from html import escape
from typing import Final

from chainbuild.files import printable
from chainbuild.writers.machine_report.document.blocks import (
    Bullets,
    Drawing,
    Drawings,
    Heading,
    Paragraph,
    Report,
    ReportBlock,
    TableBlock,
    Verbatim,
)
from chainbuild.writers.machine_report.document.style import REPORT_STYLE

TICK: Final = "☐"
_NUMBER: Final = re.compile(r"[+-]?\d[\d.]*(e-?\d+)?|–|")
_SHORT: Final = 16  # characters of a cell that is not folded
_GRADIENT: Final = re.compile(r'(id="|url\(#)(g\d+)')  # names within an SVG: a page has several


def page_text(report: Report) -> str:
    """Return a report as an HTML page."""
    title = _text(report.title)
    links = "".join(f'<a href="#c{n}">{n}. {_text(one.title)}</a>' for n, one in enumerate(report.chapters, 1))
    body = [f"<h1>{title}</h1>", f"<nav>{links}</nav>"]
    for n, chapter in enumerate(report.chapters, 1):
        body.append(f'<section>\n<h2 id="c{n}">{n}. {_text(chapter.title)}</h2>')
        body += [_block(block) for block in chapter.blocks]
        body.append("</section>")
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{title}</title>'
    lines = "\n".join(body)
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>{head}<style>{REPORT_STYLE}</style></head>\n'
        f"<body>\n{lines}\n</body>\n</html>\n"
    )


def _block(block: ReportBlock) -> str:
    if isinstance(block, Paragraph):
        return f"<p>{_line(block.parts)}</p>"
    if isinstance(block, Heading):
        return f"<h3>{_line(block.parts)}</h3>"
    if isinstance(block, Bullets):
        return f"<ul>{''.join(f'<li>{_line(item.parts)}</li>' for item in block.items)}</ul>"
    if isinstance(block, Drawings):
        return f'<div class="drawings">{"".join(map(_figure, block.drawings))}</div>'
    return _table(block)


def _figure(drawing: Drawing) -> str:
    svg = _GRADIENT.sub(rf"\g<1>{drawing.name}-\g<2>", drawing.svg.strip())
    title = _text(drawing.title)
    svg = svg.replace("<svg ", f'<svg role="img" aria-label="{title}" ', 1)
    return f"<figure>{svg}<figcaption>{title}</figcaption></figure>"


def _table(block: TableBlock) -> str:
    numeric = [_is_numeric([row[n] for row in block.rows]) for n in range(len(block.head))]
    pairs = zip(block.head, numeric, strict=True)
    titles = "".join(f"<th{_class('n' if right else '')}>{_text(title)}</th>" for title, right in pairs)
    head = f"<thead><tr>{titles}</tr></thead>" if any(block.head) else ""
    if block.kind == "form":
        body = "".join(_form_rows(block, numeric))
    else:
        body = f"<tbody>{''.join(_row(row, numeric) for row in block.rows)}</tbody>"
    return f'<div class="wide"><table class="{block.kind}">{head}{body}</table></div>'


def _row(row: Sequence[str], numeric: Sequence[bool]) -> str:
    return f"<tr>{''.join(_cell(cell, right) for cell, right in zip(row, numeric, strict=True))}</tr>"


def _form_rows(block: TableBlock, numeric: Sequence[bool]) -> Iterator[str]:
    """Yield the rows of a form in pairs: what is said once for both stands across them."""
    for upper, lower in zip(block.rows[::2], block.rows[1::2], strict=True):
        labels = range(next(n for n, cell in enumerate(lower) if cell))
        once = {*labels, *(n for n, cell in enumerate(upper) if cell == TICK)}
        cells = [_cell(cell, numeric[n], ' rowspan="2"' if n in once else "") for n, cell in enumerate(upper)]
        yield f"<tbody><tr>{''.join(cells)}</tr>"
        rest = [(cell, numeric[n]) for n, cell in enumerate(lower) if n not in once]
        below = "".join(_cell(cell, right) if cell else '<td class="blank"></td>' for cell, right in rest)
        yield f"<tr>{below}</tr></tbody>"


def _cell(cell: str, right: bool, span: str = "") -> str:
    kind = "tick" if cell == TICK else "n" if right else "short" if len(cell) <= _SHORT else ""
    return f"<td{_class(kind)}{span}>{_span(cell)}</td>"


def _is_numeric(cells: Sequence[str]) -> bool:
    return any(cells) and all(_NUMBER.fullmatch(cell) for cell in cells)


def _class(name: str) -> str:
    return f' class="{name}"' if name else ""


def _line(parts: Iterable[str]) -> str:
    return "".join(_span(part) for part in parts)


def _span(text: str) -> str:
    if not isinstance(text, Verbatim) or not text:
        return _text(text)
    # A long name may be folded behind its underscores, and nowhere else.
    return f"<code>{_text(text).replace('_', '_<wbr>')}</code>"


def _text(text: str) -> str:
    return escape(printable(text, lines=False))
