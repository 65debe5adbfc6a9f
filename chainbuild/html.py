"""Tables for notebooks: HTML without style sheets, everything that comes from a file escaped.

>>> html_table(("Axis", "Limit"), [("<A1>", "170")])
'<table><thead><tr><th>Axis</th><th>Limit</th></tr></thead><tbody><tr><td>&lt;A1&gt;</td><td>170</td></tr></tbody></table>'
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import Final

SHOWN_ROWS: Final = 10  # of a long table


def html_table(head: Sequence[str], rows: Iterable[Sequence[object]], caption: str = "", rows_left: int = 0) -> str:
    """Return a table.

    Args:
        head: Column titles.
        rows: Cells of each row.
        caption: Text above.
        rows_left: Rows that are not shown, said below.
    """
    told = f"<caption>{escape(caption)}</caption>" if caption else ""
    body = "".join(f"<tr>{_cells('td', row)}</tr>" for row in rows)
    more = f'<tr><td colspan="{len(head)}">… {rows_left} more</td></tr>' if rows_left > 0 else ""
    return f"<table>{told}<thead><tr>{_cells('th', head)}</tr></thead><tbody>{body}{more}</tbody></table>"


def html_text(text: str) -> str:
    """Return a paragraph."""
    return f"<p>{escape(text)}</p>"


def _cells(tag: str, values: Iterable[object]) -> str:
    return "".join(f"<{tag}>{escape(str(value))}</{tag}>" for value in values)
