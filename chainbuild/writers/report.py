"""A cross-check as text and as JSON data."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from chainbuild.comparison.comparison import Forward, Inverse
from chainbuild.comparison.convention_trials import Trial
from chainbuild.comparison.crosscheck import CrossCheck
from chainbuild.comparison.data_trials import DataTrial
from chainbuild.comparison.diagnosis import Explanation
from chainbuild.files import printable
from chainbuild.formats.entries import TOOL_LENGTH
from chainbuild.units import deg_from_rad, mm_from_m

DIFFERENCE_COLUMNS: Final = ("dx_mm", "dy_mm", "dz_mm")  # theirs minus ours
_MM_DIGITS: Final = 9  # a picometre: the rest is rounding
_SHOWN_ROWS: Final = 12  # fit on a line
_LEAST_ROWS: Final = 3  # the diagnosis needs as many


def crosscheck_text(check: CrossCheck) -> str:
    """Return a cross-check as text, one finding per line."""
    lines = [f"Cross-check of {check.title} ({check.kinematic}) with {check.reference}"]
    if check.note and check.note != "recorded":
        lines.append(f"  {check.note}")
    if check.forward is not None:
        lines += _forward_lines(check.forward, check.axes)
    if check.inverse is not None:
        lines += _inverse_lines(check.inverse, check.complete)
    lines += _structure_lines(check)
    lines.append("Result: agrees" if check.agrees else "Result: differs")
    return "".join(f"{printable(line, lines=False)}\n" for line in lines)


def _forward_lines(forward: Forward, axes: Sequence[str]) -> list[str]:
    total, agree = len(forward.samples), int(forward.agrees.sum())
    worst = forward.worst
    within = f"{distance_text(forward.position_tolerance)}, {degrees_text(forward.rotation_tolerance)}"
    kinds = Counter(forward.samples.kinds)
    lines = [
        f"Forward: {agree} of {total} poses agree within {within}"
        f" ({', '.join(f'{count} {kind}' for kind, count in kinds.items())}); compared: {forward.compared}",
        f"  worst: {distance_text(float(forward.position_error[worst]))}"
        f"{'' if forward.compared == 'position' else f', {degrees_text(float(forward.rotation_error[worst]))}'}"
        f" at {'row ' + str(worst + 1) + ': ' if _recorded(forward) else ''}"
        f"{axes_text(axes, forward.samples.axes[worst].tolist())}",
    ]
    if 0 < agree < total and _recorded(forward):
        lines.append(f"  differing: {_rows_text(np.flatnonzero(~forward.agrees).tolist())}")
    elif agree < total:
        failed = Counter(kind for kind, ok in zip(forward.samples.kinds, forward.agrees, strict=True) if not ok)
        lines.append("  differing: " + ", ".join(f"{count} {kind}" for kind, count in failed.items()))
    return lines + _difference_lines(forward)


def _difference_lines(forward: Forward) -> list[str]:
    """Return theirs minus ours for the rows that differ: of a recording the first, else the worst."""
    rows = np.flatnonzero(~forward.agrees & np.isfinite(forward.difference).all(axis=1))
    if not (forward.position_error[rows] > forward.position_tolerance).any():
        return []
    if not _recorded(forward):
        rows = rows[np.argsort(-forward.score[rows], kind="stable")]
    head, moved = ("row", *DIFFERENCE_COLUMNS), difference_mm(forward)
    table = [(str(n + 1), *(f"{round(value, 3) + 0.0:+.3f}" for value in moved[n])) for n in rows[:_SHOWN_ROWS]]
    widths = [max(map(len, column)) for column in zip(head, *table, strict=True)]
    more = f"; {len(table)} of {len(rows)} rows" if len(table) < len(rows) else ""
    return [
        f"  theirs minus ours, in the workpiece frame{more}:",
        *("    " + "  ".join(f"{cell:>{w}}" for cell, w in zip(row, widths, strict=True)) for row in (head, *table)),
    ]


def difference_mm(forward: Forward) -> list[list[float]]:
    """Return theirs minus ours in mm, row by row; NaN where the other solver gave no pose."""
    rows: list[list[float]] = (np.round(mm_from_m(1.0) * forward.difference, _MM_DIGITS) + 0.0).tolist()
    return rows


def _recorded(forward: Forward) -> bool:
    """Return whether the samples are the rows of a recording, in its order."""
    return set(forward.samples.kinds) == {"recorded"}


def _rows_text(rows: Sequence[int]) -> str:
    """Return row indices (from 0) as numbers from 1 below the header; only the first of many."""
    more = f", … ({len(rows)} in all)" if len(rows) > _SHOWN_ROWS else ""
    return f"row{'s' * (len(rows) > 1)} {', '.join(str(row + 1) for row in rows[:_SHOWN_ROWS])}{more}"


def _inverse_lines(inverse: Inverse, complete: bool) -> list[str]:
    missing = str(inverse.missing) if inverse.complete else "not counted: one answer per pose"
    lines = [
        f"Inverse: {inverse.theirs} answers to {len(inverse.samples)} poses, {inverse.wrong} wrong,"
        f" {inverse.unanswered} poses without a right answer",
        f"  worst answer: {distance_text(inverse.worst_position_error)}, {degrees_text(inverse.worst_rotation_error)}",
        f"  branches: {inverse.ours} of ours inside the limits; missing in theirs: {missing}; extra in theirs:"
        f" {inverse.extra}",
        f"  limits ignored: {inverse.outside} right answers outside the limits",
    ]
    if inverse.singular:
        lines.append(f"  {inverse.singular} singular poses, where branches are not compared")
    if not complete:
        lines.append("  our branches come from a search, not from a closed form: an extra one may be right")
    return lines


def _structure_lines(check: CrossCheck) -> list[str]:
    if check.agrees:
        return []
    lines = []
    if check.explanation is not None:
        left = check.explanation
        rest = f"{distance_text(left.remaining_position_error)}, {degrees_text(left.remaining_rotation_error)}"
        lines.append(f"Structure: {left.kind}: {left.text} (leaves {rest})")
        lines += [f"  or, not distinguishable at these poses: {other}" for other in left.others]
    elif check.forward is not None and len(check.forward.samples) < _LEAST_ROWS:
        lines.append(f"Structure: needs at least {_LEAST_ROWS} poses: record more")
    elif check.tried:
        most = check.forward is not None and 2 * int(check.forward.agrees.sum()) > len(check.forward.samples)
        lines.append("Structure: none found" + ("; most poses agree: check those that differ" if most else ""))
        lines.append(f"  tried: {'; '.join(check.tried)}")
    lines = [*lines, *_data_lines(check)] if not _simpler(check) else [*_data_lines(check), *lines]
    if check.trials:
        deciding = check.deciding
        lines.append("Conventions that would make it agree:" if deciding else "Conventions tried, none agrees:")
        lines += [f"  {_trial_text(trial)}" for trial in (deciding or check.trials)]
    return lines


def _simpler(check: CrossCheck) -> bool:
    """Tell whether one number of the machine data does what takes two changes of axes and poses."""
    return bool(check.explanation and " + " in check.explanation.kind and check.deciding_data)


def _data_lines(check: CrossCheck) -> list[str]:
    lines = []
    if check.data:
        agreeing = check.deciding_data
        what = "would make it agree" if agreeing else "tried one by one, none agrees; the best"
        lines.append(f"Machine data that {what}:" if agreeing else f"Machine data {what}:")
        lines += [f"  {'or ' if n and agreeing else ''}{_data_text(one)}" for n, one in enumerate(check.data)]
    return lines


def _data_text(trial: DataTrial) -> str:
    """Return the old and new values of data, where they stand, and what is left."""
    parts = []
    for datum, value in trial.values.items():
        symbol = f"{datum.symbol} " if datum.symbol else ""
        default = "as given" if datum.key[0] == TOOL_LENGTH and datum.value else "not given, default"
        place = f"line {datum.span.line}" if datum.span is not None else default
        unit = f" {datum.unit}" if datum.unit else ""
        counted = f", in the list {value * datum.counts:.10g}" if datum.counts != 1.0 else ""
        parts.append(f"{symbol}{datum.name} ({place}): {datum.value:.10g} to {value:.10g}{unit}{counted}")
    left = f"leaves {distance_text(trial.position_error)}, {degrees_text(trial.rotation_error)}"
    return f"{' and '.join(parts)} ({left})"


def _trial_text(trial: Trial) -> str:
    named = ", ".join(f"{name}={choice}" for name, choice in trial.choices.items())
    if math.isinf(trial.position_error):
        return f"{named}: cannot be built"
    return f"{named}: {distance_text(trial.position_error)}, {degrees_text(trial.rotation_error)}"


def distance_text(metres: float) -> str:
    """Return a distance in mm with three digits."""
    return f"{mm_from_m(metres):.3g} mm" if math.isfinite(metres) else "no pose"


def degrees_text(radians: float) -> str:
    """Return an angle in degrees with three digits."""
    return f"{deg_from_rad(radians):.3g} deg" if math.isfinite(radians) else "no rotation"


def axes_text(names: Sequence[str], values: Sequence[float]) -> str:
    """Return axis values with their names."""
    return ", ".join(f"{name} {value:.6g}" for name, value in zip(names, values, strict=True))


def crosscheck_data(check: CrossCheck) -> dict[str, Any]:
    """Return a cross-check for JSON: mm and degrees, null for missing numbers."""
    return {
        "machine": check.title,
        "kinematic": check.kinematic,
        "axes": list(check.axes),
        "judge": check.reference,
        "note": check.note,
        "agrees": check.agrees,
        "conventions": dict(check.conventions),
        "forward": None if check.forward is None else _forward_data(check.forward),
        "inverse": None if check.inverse is None else _inverse_data(check.inverse, check.complete),
        "structure": None if check.explanation is None else _explanation_data(check.explanation),
        "tried": list(check.tried),
        "data": [_data_data(trial) for trial in check.data],
        "trials": [_trial_data(trial) for trial in check.trials],
    }


def _forward_data(forward: Forward) -> dict[str, Any]:
    worst = forward.worst
    return {
        "poses": len(forward.samples),
        "agree": int(forward.agrees.sum()),
        "compared": forward.compared,
        "position_tolerance_mm": mm_from_m(forward.position_tolerance),
        "rotation_tolerance_deg": deg_from_rad(forward.rotation_tolerance),
        "worst": {
            "row": worst + 1,
            "axes": forward.samples.axes[worst].tolist(),
            "kind": forward.samples.kinds[worst],
            "position_error_mm": _finite(mm_from_m(float(forward.position_error[worst]))),
            "rotation_error_deg": _finite(deg_from_rad(float(forward.rotation_error[worst]))),
        },
        "rows": [
            {
                "row": row,
                "axes": axes,
                "kind": kind,
                **{name: _finite(value) for name, value in zip(DIFFERENCE_COLUMNS, moved, strict=True)},
                "position_error_mm": _finite(mm_from_m(distance)),
                "rotation_error_deg": _finite(deg_from_rad(angle)),
            }
            for row, axes, kind, moved, distance, angle in zip(
                range(1, len(forward.samples) + 1),
                forward.samples.axes.tolist(),
                forward.samples.kinds,
                difference_mm(forward),
                forward.position_error.tolist(),
                forward.rotation_error.tolist(),
                strict=True,
            )
        ],
    }


def _inverse_data(inverse: Inverse, complete: bool) -> dict[str, Any]:
    return {
        "poses": len(inverse.samples),
        "answers": inverse.theirs,
        "our_branches": inverse.ours,
        "our_branches_complete": complete,
        "wrong": inverse.wrong,
        "unanswered": inverse.unanswered,
        "missing": inverse.missing if inverse.complete else None,
        "extra": inverse.extra,
        "outside_limits": inverse.outside,
        "singular": inverse.singular,
        "worst_position_error_mm": _finite(mm_from_m(inverse.worst_position_error)),
        "worst_rotation_error_deg": _finite(deg_from_rad(inverse.worst_rotation_error)),
    }


def _explanation_data(found: Explanation) -> dict[str, Any]:
    return {
        "kind": found.kind,
        "text": found.text,
        "axes": list(found.axes),
        "others": list(found.others),
        "remaining_position_error_mm": _finite(mm_from_m(found.remaining_position_error)),
        "remaining_rotation_error_deg": _finite(deg_from_rad(found.remaining_rotation_error)),
    }


def _data_data(trial: DataTrial) -> dict[str, Any]:
    return {
        "values": [
            {
                "name": datum.name,
                "symbol": datum.symbol,
                "line": datum.span.line if datum.span is not None else None,
                "unit": datum.unit,
                "old": datum.value,
                "new": value,
            }
            for datum, value in trial.values.items()
        ],
        "agrees": trial.agrees,
        "position_error_mm": _finite(mm_from_m(trial.position_error)),
        "rotation_error_deg": _finite(deg_from_rad(trial.rotation_error)),
    }


def _trial_data(trial: Trial) -> dict[str, Any]:
    return {
        "choices": dict(trial.choices),
        "agrees": trial.agrees,
        "position_error_mm": _finite(mm_from_m(trial.position_error)),
        "rotation_error_deg": _finite(deg_from_rad(trial.rotation_error)),
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
