"""The panel next to the picture: axes, frames, conventions, findings, and the limits of the drawing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from html import escape
from pathlib import PurePath

from chainbuild.chain.bodies.body import BASE_COLOUR, TOOL_SIDE, WORKPIECE_SIDE, Colour
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import Axis, Chain
from chainbuild.convention import UsedConvention
from chainbuild.files import printable
from chainbuild.findings import Finding
from chainbuild.frames import ANGLE_MODES

_MARKS = {"I": "inferred", "?": "open"}


def html_escaped(text: str) -> str:
    """Return a text as HTML: no markup, no control characters."""
    return escape(printable(text))


def panel_html(chain: Chain, grid_cell: float) -> str:
    """Return the panel as HTML.

    Args:
        chain: The chain.
        grid_cell: Side of a grid square [m].
    """
    parts = [
        f"<p>{html_escaped(chain.dialect)} · {html_escaped(chain.kinematic)}</p>",
        _tool(chain),
        _axes(chain),
        _legend(chain, grid_cell),
        _conventions(chain.conventions),
        _findings(chain.findings),
    ]
    return "\n".join(parts)


def _tool(chain: Chain) -> str:
    """Return the table for the pose of the tool, which the page fills."""
    shown = [_column_title(chain, column) for column in chain.display_columns]
    titles = ("X mm", "Y mm", "Z mm", *shown)
    head = "".join(f'<th class="number">{html_escaped(text)}</th>' for text in titles)
    cells = '<td class="number"></td>' * len(titles)
    return (
        f'<h2>Tool in the workpiece frame</h2><table id="tcp"><thead><tr>{head}</tr></thead><tbody><tr>{cells}</tr>'
        f'</tbody></table><p class="soft">{html_escaped(_displayed_meaning(chain))}</p>'
    )


def _column_title(chain: Chain, column: str) -> str:
    """Return the heading of a displayed column."""
    if chain.display.kind == "vector":
        return column.replace("_", " ")
    return f"{column.removesuffix('_deg').upper() if column.endswith('_deg') else column}°"


def _displayed_meaning(chain: Chain) -> str:
    """Return what the controller displays, as a sentence."""
    display = chain.display
    if display.kind == "angles":
        return f"Angles of the controller: R = {ANGLE_MODES[chain.angle_mode].meaning}"
    if display.kind == "axes":
        return "As the controller displays it: the tool tip and the rotary axes that are programmed."
    if display.kind == "direction":
        turns = "·".join(f"R({letter})" for letter in display.letters)
        return f"Angles of the controller: tool vector = {turns}·e_{display.along}"
    if display.kind == "pitch":
        return "Angles of the controller: R = Rz(a)·Ry(B)·Rz(C - a), a being the turn of the arm"
    if display.kind == "plane":
        return "As the controller displays it: the tool tip and the tool's angle in the XY plane."
    return "As the controller displays it: the tool tip" + (" and the tool vector." if display.columns else ".")


def _axes(chain: Chain) -> str:
    rows = [
        f"<tr><td>{html_escaped(axis.name)}{' *' if axis.assumed else ''}</td><td>{axis.kind}</td>"
        f'<td class="number">{_number(axis.lower)}</td><td class="number">{_number(axis.upper)}</td>'
        f'<td>{"°" if axis.unit == "deg" else axis.unit}</td><td class="number value"></td></tr>'
        for axis in chain.axes
    ]
    head = (
        '<h2>Axes, swept in this order</h2><table id="axes"><thead><tr><th>Axis</th><th>Kind</th>'
        '<th class="number">Lower</th><th class="number">Upper</th><th></th><th class="number">Now</th></tr></thead>'
    )
    notes = "".join(f'<p class="soft">{html_escaped(note)}</p>' for note in _axis_notes(chain))
    return f"{head}<tbody>{''.join(rows)}</tbody></table>{notes}"


def _axis_notes(chain: Chain) -> Iterable[str]:
    if any(axis.assumed for axis in chain.axes):
        yield "* Assumed limits: the machine data contain none."
    shortened = [
        f"{axis.name} {_number(low)} … {_number(high)}{'°' if axis.unit == 'deg' else ' mm'}"
        for axis, low, high in zip(chain.axes, *shown_limits(chain), strict=True)
        if not _whole(axis, float(low), float(high))
    ]
    if shortened:
        yield f"Shown over part of the range only: {', '.join(shortened)}."


def _whole(axis: Axis, low: float, high: float) -> bool:
    return low <= axis.lower and high >= axis.upper


def _legend(chain: Chain, grid_cell: float) -> str:
    swatches = [("base", BASE_COLOUR), ("carries the tool", TOOL_SIDE[0])]
    if any(axis.carries == "workpiece" for axis in chain.axes):
        swatches.append(("carries the workpiece", WORKPIECE_SIDE[0]))
    keys = "".join(f'<span class="key"><i style="background:{_css(c)}"></i>{text}</span>' for text, c in swatches)
    return (
        "<h2>Drawing</h2><p><strong>The bodies are drawn, not measured.</strong> Machine data contain only the place "
        "and direction of the joints; all else is assumed by rule to show how the machine is built, so clearances "
        "cannot be read from this page.</p>"
        f'<p class="soft">Frames: x red, y green, z blue. A grid square is {_length(grid_cell)}.</p>'
        f"<p>{keys}</p>"
    )


def _conventions(used: Sequence[UsedConvention]) -> str:
    if not used:
        return "<h2>Conventions</h2><p>The chain uses no open convention.</p>"
    rows = [
        f"<dt>{html_escaped(u.convention.name)} = {html_escaped(u.choice)}</dt>"
        f"<dd>{html_escaped(u.convention.choices.get(u.choice, ''))} "
        f'<span class="soft">({_MARKS[u.convention.mark]}; {"chosen by you" if u.by_user else "default"})</span></dd>'
        for u in used
    ]
    return (
        '<h2>Conventions used</h2><p class="soft">The manuals leave these points open; verify them on the controller '
        f"(chainbuild info shows how).</p><dl>{''.join(rows)}</dl>"
    )


def _findings(findings: Sequence[Finding]) -> str:
    if not findings:
        return ""
    rows = "".join(f"<li>{html_escaped(_finding(finding))}</li>" for finding in findings)
    return f"<h2>Findings</h2><ul>{rows}</ul>"


def _finding(finding: Finding) -> str:
    # Pages are passed on: show the name of the file, not its folder.
    where = ""
    if finding.span is not None:
        where = f" ({replace(finding.span, file=PurePath(finding.span.file).name)})"
    return f"{finding.code} {finding.severity}: {finding.text}{where}"


def _number(value: float) -> str:
    return f"{round(value, 3):.10g}".replace("-", "\u2212")  # more digits than a display has would widen the table


def _length(value: float) -> str:
    return f"{value:g}\u00a0m" if value >= 1.0 else f"{1000 * value:g}\u00a0mm"


def _css(colour: Colour) -> str:
    return "rgb({}, {}, {})".format(*(round(255 * part) for part in colour))
