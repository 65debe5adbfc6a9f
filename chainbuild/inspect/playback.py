"""Tables of axis values, of poses and recordings as a page plays them back."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, Literal

import numpy as np

from chainbuild.analysis.path.motion import Between
from chainbuild.analysis.singularity.measures import measure_batch
from chainbuild.arrays import Matrix, Vector
from chainbuild.comparison.comparison import forward_poses, pose_errors
from chainbuild.errors import Span, TableError
from chainbuild.ik.result import IkResult
from chainbuild.inspect.chain_data import as_json
from chainbuild.inspect.playnotes import PlaybackNote, playback_notes
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.progress import Progress
from chainbuild.shown import two_lines
from chainbuild.tables import AxisTable
from chainbuild.tables.recording import read_recording
from chainbuild.units import deg_from_rad, mm_from_m

_DECIMALS: Final = 6  # of mm and degrees: finer than controls count, and a page of 50,000 rows stays near 3 MB
_METRE_DECIMALS: Final = 9  # the same in metres
_MEASURE_DIGITS: Final = 8  # of singular values: more than a colour shows
_MEASURE_NOISE: Final = 12  # their decimals beyond which there is only rounding

PlaybackKind = Literal["axes", "poses", "recording"]


@dataclass(frozen=True, slots=True, eq=False)
class Playback:
    """Rows of a table for a page to play back.

    Attributes:
        kind: What the table holds.
        source: File name, without its folder.
        axes: (n, n_axes) mm and degrees; not a number where a pose has no solution.
        smallest: (n,) smallest scaled singular value; not a number where there is no pose.
        notes: What to know about which rows.
        remarks: How the notes were found.
        measured: (n, 3) position of the tool that the controller showed, in the workpiece frame [m]; None: no
            recording.
        errors: (n, 3) measured minus computed position [m]; not a number where there is no pose; None: no recording.
        turns: (n,) angle between the orientations [rad], of the tool vector where that alone was recorded; not a number
            where there is no pose or no orientation was recorded; None: no recording.
    """

    kind: PlaybackKind
    source: str
    axes: Matrix
    smallest: Vector
    notes: tuple[PlaybackNote, ...]
    remarks: tuple[str, ...] = ()
    measured: Matrix | None = None
    errors: Matrix | None = None
    turns: Vector | None = None

    def __repr__(self) -> str:
        return two_lines(f"<Playback of {self.source}: {len(self.axes)} rows ({self.kind}), {len(self.notes)} notes>")

    def data(self) -> dict[str, Any]:
        """Return everything for the page as JSON: rows counted from 1, null for what is not a number.

        Lengths are in mm and angles in degrees, rounded to 1e-6; `measured` is in metres.
        """
        smallest = [float(f"{value:.{_MEASURE_DIGITS}g}") for value in np.round(self.smallest, _MEASURE_NOISE).tolist()]
        return {
            "kind": self.kind,
            "source": self.source,
            "rows": _rounded(self.axes, _DECIMALS),
            "numbers": list(range(1, len(self.axes) + 1)),
            "singular": [value if math.isfinite(value) else None for value in smallest],
            "notes": [{"row": one.row, "last": one.last, "kind": one.kind, "text": one.text} for one in self.notes],
            "remarks": list(self.remarks),
            "measured": None if self.measured is None else _rounded(self.measured, _METRE_DECIMALS),
            "turns": None if self.turns is None else as_json(np.round(deg_from_rad(1.0) * self.turns, _DECIMALS)),
            "errors": None if self.errors is None else _rounded(self.errors * mm_from_m(1.0), _DECIMALS),
        }


def _rounded(rows: Matrix, decimals: int) -> list[list[float] | None]:
    """Return rows as lists, None for those that are not numbers."""
    rounded = (np.round(rows, decimals) + 0.0).tolist()
    return [row if all(map(math.isfinite, row)) else None for row in rounded]


def axes_playback(robot: Mechanism, path: str | os.PathLike[str], *, progress: Progress = False) -> Playback:
    """Return a table of axis values for a page.

    Args:
        robot: The robot.
        path: The CSV file.
        progress: True: a bar on standard error; a function: called with the rows done and all rows.

    Raises:
        ChainbuildError: the table cannot be read, holds no rows, or a row holds no axis values.
    """
    with AxisTable(Path(path), robot.axes) as table:
        parts = [chunk.values for chunk in table.chunks()]
    rows = np.concatenate([np.empty((0, len(robot.axes))), *parts])
    return _playback(robot, "axes", path, rows, {}, None, progress)


def recording_playback(robot: Mechanism, path: str | os.PathLike[str], *, progress: Progress = False) -> Playback:
    """Return a recording for a page, with the positions measured and how far they are from those computed.

    Args:
        robot: The robot.
        path: The CSV file.
        progress: As for `axes_playback`.

    Raises:
        ChainbuildError: the table cannot be read, holds no rows, or a row holds no axis values or pose.
    """
    recording = read_recording(Path(path), robot.chain)
    played = _playback(robot, "recording", path, recording.axes, {}, recording.poses[:, :3, 3].copy(), progress)
    poses = forward_poses(robot, recording.axes)
    turns = pose_errors(poses, recording.poses, recording.compared, robot.chain.tool_column)[1]
    if recording.compared == "position":
        turns = np.full(len(turns), np.nan)
    return replace(played, turns=turns, remarks=(*played.remarks, *_largest(played.errors, turns)))


def _largest(errors: Matrix | None, turns: Vector) -> Iterator[str]:
    """Yield in which rows of a recording the model is farthest off."""
    distances = np.zeros(0) if errors is None else np.linalg.norm(errors, axis=1)
    if np.isfinite(distances).any():
        row = int(np.nanargmax(distances))
        yield f"farthest from the model: row {row + 1}, {mm_from_m(float(distances[row])):.3f} mm"
    if np.isfinite(turns).any():
        row = int(np.nanargmax(turns))
        yield f"turned most against the model: row {row + 1}, {deg_from_rad(float(turns[row])):.3f} deg"


def pose_playback(
    robot: Mechanism, path: str | os.PathLike[str], results: Iterable[IkResult], *, progress: Progress = False
) -> Playback:
    """Return the solved rows of a table of poses for a page.

    Args:
        robot: The robot.
        path: The CSV file, for its name.
        results: What inverse kinematics found for each row; see `Robot.ik`.
        progress: As for `axes_playback`.

    Raises:
        ChainbuildError: there are no rows.
    """
    rows: list[Vector] = []
    reasons: dict[int, str] = {}
    for row, result in enumerate(results):
        found = result.to("controller")
        if not found.success:
            reasons[row] = f"{found.status}: {found.reason}" if found.reason else found.status
        rows.append(found.axes if found.success else np.full(len(robot.axes), np.nan))
    every = np.array(rows).reshape(len(rows), len(robot.axes))
    return _playback(robot, "poses", path, every, reasons, None, progress)


def _playback(
    robot: Mechanism,
    kind: PlaybackKind,
    path: str | os.PathLike[str],
    rows: Matrix,
    reasons: dict[int, str],
    measured: Matrix | None,
    progress: Progress,
) -> Playback:
    if not len(rows):
        raise TableError("the table has no rows", span=Span(os.fspath(path)))
    known = np.isfinite(rows).all(axis=1)
    table = measure_batch(robot, rows[known])
    smallest, positions = np.full(len(rows), np.nan), np.full((len(rows), 3), np.nan)
    smallest[known], positions[known] = table.smallest, table.positions
    without = known & ~np.isfinite(smallest)
    between: Between = "cp" if kind == "poses" else "ptp"
    notes, remarks = playback_notes(robot, rows, between, reasons, without, progress)
    errors = None if measured is None else measured - positions
    return Playback(kind, Path(path).name, rows, smallest, tuple(notes), remarks, measured, errors)
