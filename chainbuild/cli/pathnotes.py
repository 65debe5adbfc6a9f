"""What `ik --follow` says on stderr about a path between its rows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.analysis.path.along import path_report
from chainbuild.cli.pathreport import left_words, span, vector_notice, violation_words
from chainbuild.cli.show import note
from chainbuild.progress import bars_shown

if TYPE_CHECKING:
    from chainbuild.analysis.path.places import PathReport, PathStretch
    from chainbuild.arrays import Vector
    from chainbuild.robot import Robot

_NOTES_SHOWN: Final = 10  # fit on a screen; the others are counted


def tell_between(robot: Robot, path: Sequence[Vector | None], file: str) -> None:
    """Say what happens between the rows of a path, the tip on lines; nothing where nothing does.

    Args:
        robot: The robot.
        path: Axis values of each row; None: not found.
        file: Name of the table, for messages.
    """
    gap = np.full(len(robot.axes), np.nan)
    rows = np.array([gap if axes is None else axes for axes in path]).reshape(len(path), len(robot.axes))
    notes = _notes(robot, path_report(robot, rows, between="cp", progress=bars_shown()))
    for text in notes[:_NOTES_SHOWN]:
        note(f"{file}: {text}")
    if len(notes) > _NOTES_SHOWN:
        note(f"… and {len(notes) - _NOTES_SHOWN} more: `chainbuild singularity --poses` lists them")


def _notes(robot: Robot, report: PathReport) -> list[str]:
    """Return the notes, what ends a motion first."""
    notes = [left_words(place) for place in report.leaves]
    notes += [f"limit violated {violation_words(one)}" for one in report.violations]
    at_rows = [one for one in report.stretches if not one.of_vector]
    singular = [one for one in at_rows if any(minimum.singular for minimum in one.minima)]
    notes += [_stretch_words(one) for one in singular]
    notes += [_stretch_words(one) for one in at_rows if one not in singular]
    notes += [f"{span(one.begin, one.end)}: {vector_notice(robot, one)}" for one in report.stretches if one.of_vector]
    return notes


def _stretch_words(stretch: PathStretch) -> str:
    least = next((one for one in stretch.minima if one.singular), stretch.minima[0])
    how = "singular" if least.singular else "close to singular"
    sampled = "" if stretch.proven else " (sampled)"
    part = span(stretch.begin, stretch.end)
    return f"{how} ({stretch.kind}) at {least.place.label}, close {part}: {least.sentence}{sampled}"
