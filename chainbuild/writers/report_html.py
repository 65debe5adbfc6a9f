"""A cross-check as one self-contained HTML page: text, tables, and plots of the error as inline SVG."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.comparison.crosscheck import CrossCheck
from chainbuild.files import printable_tree, write_text
from chainbuild.units import deg_from_rad, mm_from_m
from chainbuild.writers.machine_report.document.style import BASE_STYLE
from chainbuild.writers.report import DIFFERENCE_COLUMNS, crosscheck_text, difference_mm
from chainbuild.writers.svg_plots import Points, histogram, scatter

_SHOWN_ROWS: Final = 20  # fit on a page
_FLOOR: Final = 1e-13  # [mm, deg] errors below, which are rounding, are drawn at this value
_STYLE: Final = f"""{BASE_STYLE}
pre {{ background: #f4f6f8; padding: .8rem 1rem; overflow-x: auto; white-space: pre-wrap; }}
.plots {{ display: flex; flex-wrap: wrap; gap: 1rem; }}
.verdict {{ font-weight: 600; }} .agrees {{ color: #116329; }} .differs {{ color: #a40e26; }}
"""


def write_crosscheck_page(check: CrossCheck, path: Path) -> Path:
    """Write a cross-check as an HTML page and return its path.

    Raises:
        FileAccessError: the file cannot be written.
    """
    write_text(path, crosscheck_page(check))
    return path


def crosscheck_page(check: CrossCheck) -> str:
    """Return a cross-check as an HTML page."""
    html = ET.Element("html", lang="en")
    head = ET.SubElement(html, "head")
    ET.SubElement(head, "meta", charset="utf-8")
    ET.SubElement(head, "title").text = f"Cross-check: {check.title}"
    ET.SubElement(head, "style").text = _STYLE
    body = ET.SubElement(html, "body")
    ET.SubElement(body, "h1").text = f"{check.title}: cross-check with {check.reference}"
    verdict = "agrees" if check.agrees else "differs"
    ET.SubElement(body, "p", {"class": f"verdict {verdict}"}).text = verdict.capitalize()
    ET.SubElement(body, "pre").text = crosscheck_text(check)
    if check.forward is not None:
        _add_plots(body, check)
        _add_worst_rows(body, check)
    if check.conventions:
        rows = [[name, choice] for name, choice in sorted(check.conventions.items())]
        _add_table(body, "Conventions in force", ("name", "choice"), rows)
    return "<!DOCTYPE html>\n" + ET.tostring(printable_tree(html), encoding="unicode", method="html") + "\n"


def _errors(check: CrossCheck) -> list[tuple[str, Vector, float]]:
    """Return name, values and tolerance of each error: mm and degrees."""
    forward = check.forward
    if forward is None:
        return []
    finite = np.isfinite(forward.position_error)
    mm = np.where(finite, mm_from_m(1.0) * forward.position_error, np.nan)
    found = [("position error [mm]", mm, mm_from_m(forward.position_tolerance))]
    if forward.compared != "position":
        deg = np.where(finite, deg_from_rad(1.0) * forward.rotation_error, np.nan)
        found.append(("rotation error [deg]", deg, deg_from_rad(forward.rotation_tolerance)))
    return found


def _add_plots(body: ET.Element, check: CrossCheck) -> None:
    forward = check.forward
    if forward is None:
        return
    for name, values, tolerance in _errors(check):
        ET.SubElement(body, "h2").text = name
        box = ET.SubElement(body, "div", {"class": "plots"})
        logs = np.log10(np.maximum(values, _FLOOR))
        box.append(histogram(logs[np.isfinite(logs)], "all poses", f"log10 {name}", mark=math.log10(tolerance)))
        for n, axis in enumerate(check.axes):
            points = Points(forward.samples.axes[:, n], logs, forward.samples.kinds)
            box.append(scatter(points, f"over {axis}", axis, f"log10 {name}", mark=math.log10(tolerance)))


def _add_worst_rows(body: ET.Element, check: CrossCheck) -> None:
    forward = check.forward
    if forward is None:
        return
    order = np.argsort(-np.where(np.isfinite(forward.score), forward.score, np.inf))[:_SHOWN_ROWS]
    errors = _errors(check)
    moved = difference_mm(forward)
    rows = [
        [
            str(n + 1),
            *(f"{value:.6g}" for value in forward.samples.axes[n]),
            forward.samples.kinds[n],
            *(f"{value:+.3f}" if math.isfinite(value) else "no pose" for value in moved[n]),
            *(f"{values[n]:.3g}" if np.isfinite(values[n]) else "no pose" for _, values, _ in errors),
        ]
        for n in order
    ]
    _add_table(
        body,
        "Largest errors",
        ("row", *check.axes, "drawn as", *DIFFERENCE_COLUMNS, *(name for name, _, _ in errors)),
        rows,
    )


def _add_table(body: ET.Element, title: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    ET.SubElement(body, "h2").text = title
    table = ET.SubElement(body, "table")
    header = ET.SubElement(table, "tr")
    for column in columns:
        ET.SubElement(header, "th").text = column
    for row in rows:
        line = ET.SubElement(table, "tr")
        for cell in row:
            ET.SubElement(line, "td").text = cell
