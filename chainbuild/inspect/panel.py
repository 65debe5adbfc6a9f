"""The panel next to the picture: axes, frames, conventions, findings, and the limits of the drawing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from html import escape
from pathlib import PurePath
from typing import Final

from chainbuild.chain.bodies.body import BASE_COLOUR, TOOL_SIDE, WORKPIECE_SIDE, Colour
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.elements import Axis, Chain
from chainbuild.convention import UsedConvention
from chainbuild.files import printable
from chainbuild.findings import Finding
from chainbuild.frames import ANGLE_MODES

_MARKS = {"I": "inferred", "?": "open"}
_UNITS = {"mm": "mm", "deg": "°", "": ""}
_SHORT_NAME: Final = 7  # characters that stand beside a slider
_SPOKEN = {"mm": "millimetres", "deg": "degrees"}


def html_escaped(text: str) -> str:
    """Return a text as HTML: no markup, no control characters."""
    return escape(printable(text))


def panel_html(chain: Chain, grid_cell: float, *, varying: bool = True) -> str:
    """Return the panel as HTML: all that does not change; the page's scripts fill in what does.

    Args:
        chain: The chain.
        grid_cell: Side of a grid square [m].
        varying: False: without conventions and findings.
    """
    parts = [
        f'<p class="soft">{" · ".join(map(html_escaped, dict.fromkeys((chain.dialect, chain.kinematic))))}</p>',
        _state(),
        '<section id="playback" hidden></section>',
        _pose(chain),
        _axes(chain),
        '<section id="bars" hidden><h2>Sums of axes, drives</h2><div class="rows"></div></section>',
        '<section id="solutions"><h2>Solutions of this pose</h2><p class="words soft"></p><div class="rows"></div>'
        "</section>",
        '<section id="presets"><h2>Poses</h2><div class="rows"></div><p class="note soft" aria-live="polite"></p>'
        "</section>",
        _keys(),
        _legend(chain, grid_cell),
    ]
    if varying:
        parts += [conventions_html(chain.conventions), findings_html(chain.findings)]
    return "\n".join(parts)


def _state() -> str:
    """Return what tells the state of the pose: its status, and how close it is to a singular one."""
    return (
        '<section id="state" aria-label="State of the pose"><p data-status="ok" role="status"></p>'
        '<div data-singular><div class="scale"><i class="level"></i></div>'
        '<p><b class="number"></b> <span class="sentence"></span></p></div></section>'
    )


def _pose(chain: Chain) -> str:
    """Return the fields of the pose as the controller displays it."""
    shown = [
        *(_field("data-pose", f"{letter}_mm", letter.upper(), "mm") for letter in "xyz"),
        *(_field("data-pose", column, *_column_title(chain, column)) for column in chain.display_columns),
    ]
    meaning = html_escaped(_displayed_meaning(chain))
    return (
        f'<section id="pose"><h2>Tool in the workpiece frame</h2><div class="fields">{"".join(shown)}</div>'
        f'<p class="soft">{meaning}</p></section>'
    )


def _field(attribute: str, name: str, title: str, unit: str) -> str:
    """Return a number field with its title, its unit and a name that says both."""
    spoken = f"{title} in {_SPOKEN[unit]}" if unit else title
    return (
        f'<label class="field"><span class="name">{html_escaped(title)}</span>'
        f'<input type="number" step="any" {attribute}="{html_escaped(name)}" aria-label="{html_escaped(spoken)}">'
        f'<span class="unit">{_UNITS[unit]}</span></label>'
    )


def _column_title(chain: Chain, column: str) -> tuple[str, str]:
    """Return the heading and the unit of a displayed column."""
    if chain.display.kind == "vector":
        return column.replace("_", " "), ""
    unit = {axis.name: axis.unit for axis in chain.axes}.get(column, "deg")
    return (column.removesuffix("_deg").upper() if column.endswith("_deg") else column), unit


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
    rows = "".join(
        _axis_row(axis, low, high) for axis, (low, high) in zip(chain.axes, _slider_ends(chain), strict=True)
    )
    notes = "".join(f'<p class="soft">{html_escaped(note)}</p>' for note in _axis_notes(chain))
    return (
        '<section id="axes"><h2>Axes <label class="step">step <select aria-label="Step of the arrow keys, mm or '
        'degrees"><option>0.1</option><option selected>1</option></select></label></h2>'
        f'<div class="rows">{rows}</div>{notes}</section>'
    )


def _slider_ends(chain: Chain) -> list[tuple[float, float]]:
    """Return the ends of every slider: the limits; where there are none, what is drawn."""
    drawn = zip(*(ends.tolist() for ends in shown_limits(chain)), strict=True)
    return [ends if axis.assumed or axis.endless else axis.range for axis, ends in zip(chain.axes, drawn, strict=True)]


def _axis_row(axis: Axis, low: float, high: float) -> str:
    """Return a slider over the range shown, with marks at the limits, and a number field."""
    name, unit = html_escaped(axis.name), _SPOKEN[axis.unit]
    marks = [end for end in axis.range if not axis.endless and low <= end <= high]
    ticks = "".join(f'<i class="limit" style="--at: {_share(end, low, high)}"></i>' for end in marks)
    ends = "".join(f"<span>{_number(end)}</span>" for end in (low, high))
    limits = "endless" if axis.endless else f"limits {_number(axis.range[0])} … {_number(axis.range[1])} {unit}"
    held = '<span class="held">held</span>' if axis.held else ""
    kind = "axis long" if len(axis.name) > _SHORT_NAME else "axis"
    return (
        f'<div class="{kind}" role="group" aria-label="Axis {name}" title="{axis.kind}, {limits}">'
        f'<span class="name">{name}{" *" if axis.assumed else ""}{held}</span>'
        f'<span class="track"><input type="range" data-axis="{name}" min="{low:.12g}" max="{high:.12g}" step="any" '
        f'aria-label="{name} slider, {unit}">{ticks}<span class="ends">{ends}</span></span>'
        f'<input type="number" data-axis="{name}" step="any" aria-label="{name} in {unit}, {limits}">'
        f'<span class="unit">{_UNITS[axis.unit]}</span></div>'
    )


def _share(value: float, low: float, high: float) -> str:
    return f"{(value - low) / (high - low) if high > low else 0.0:.4f}"


def _axis_notes(chain: Chain) -> Iterable[str]:
    if any(axis.assumed for axis in chain.axes):
        yield "* Assumed limits: the machine data contain none."
    shortened = [
        f"{axis.name} {_number(low)} … {_number(high)}{'°' if axis.unit == 'deg' else ' mm'}"
        for axis, (low, high) in zip(chain.axes, _slider_ends(chain), strict=True)
        if not _whole(axis, low, high)
    ]
    if shortened:
        yield f"Shown over part of the range only: {', '.join(shortened)}."


def _whole(axis: Axis, low: float, high: float) -> bool:
    return low <= axis.lower and high >= axis.upper


def _keys() -> str:
    return (
        '<p class="soft keys"><kbd>↑</kbd> <kbd>↓</kbd> choose an axis, <kbd>←</kbd> <kbd>→</kbd> step it, with '
        "<kbd>Shift</kbd> ten steps. Drag the arrows in the picture to move the tool.</p>"
    )


def _legend(chain: Chain, grid_cell: float) -> str:
    swatches = [("base", BASE_COLOUR), ("carries the tool", TOOL_SIDE[0])]
    if any(axis.carries == "workpiece" for axis in chain.axes):
        swatches.append(("carries the workpiece", WORKPIECE_SIDE[0]))
    keys = "".join(f'<span class="key"><i style="background:{_css(c)}"></i>{text}</span>' for text, c in swatches)
    return (
        "<details><summary>Drawing</summary><p><strong>The bodies are drawn, not measured.</strong> Machine data "
        "contain only the place and direction of the joints; all else is assumed by rule to show how the machine is "
        "built, so clearances cannot be read from this page.</p>"
        f'<p class="soft">Frames: x red, y green, z blue. A grid square is {_length(grid_cell)}.</p>'
        f"<p>{keys}</p></details>"
    )


def conventions_html(used: Sequence[UsedConvention]) -> str:
    """Return the conventions of a chain as HTML."""
    if not used:
        told = "<summary>Conventions</summary><p>The chain uses no open convention.</p>"
        return f'<details id="conventions">{told}</details>'
    rows = [
        f'<dt data-convention="{html_escaped(u.convention.name)}">{html_escaped(u.convention.name)} = '
        f"{html_escaped(u.choice)}</dt>"
        f"<dd>{html_escaped(u.convention.choices.get(u.choice, ''))} "
        f'<span class="soft">({_MARKS[u.convention.mark]}; {"chosen by you" if u.by_user else "default"})</span></dd>'
        for u in used
    ]
    return (
        f'<details id="conventions"><summary>Conventions used ({len(used)})</summary><p class="soft">The manuals leave '
        f"these points open; verify them on the controller (chainbuild info shows how).</p><dl>{''.join(rows)}</dl>"
        "</details>"
    )


def findings_html(findings: Sequence[Finding]) -> str:
    """Return the findings on a chain as HTML; hidden where there are none."""
    if not findings:
        return '<details id="findings" hidden></details>'
    rows = "".join(f"<li>{html_escaped(_finding(finding))}</li>" for finding in findings)
    return f'<details id="findings"><summary>Findings ({len(findings)})</summary><ul>{rows}</ul></details>'


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
