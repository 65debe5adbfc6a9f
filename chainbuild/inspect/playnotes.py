"""What is said of the rows that a page plays back: limits, singular places, jumps, rows without solution or pose."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from chainbuild.analysis.path.along import path_report
from chainbuild.analysis.path.limitwatch import LimitWatch
from chainbuild.analysis.path.motion import Between
from chainbuild.analysis.path.places import PathPlace, PathReport, PathStretch
from chainbuild.analysis.singularity.measures import characteristic_length
from chainbuild.arrays import Matrix
from chainbuild.chain.axismap import AffineMap
from chainbuild.comparison.comparison import forward_poses, pose_errors
from chainbuild.ik.search.words import kind_of
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.progress import Progress
from chainbuild.shown import fields_shown, number
from chainbuild.tolerances import LIMIT_SLACK
from chainbuild.units import deg_from_rad, mm_from_m

_JUMP: Final = 0.5  # rad, or share of the machine's length: less is a step of a path with few rows
_MORE: Final = 10.0  # times the motion of the tool: no axis needs so much away from a singularity
_SHARE_DIGITS: Final = 9  # of shares of a block: a place next to a row is the row

PlaybackNoteKind = Literal["limit", "singular", "close", "vector", "reach", "jump", "unreachable", "no_pose"]


@dataclass(frozen=True, slots=True)
class PlaybackNote:
    """Something to know about some rows.

    Attributes:
        row: Number of the first row it is about, from 1; the row before it, where it lies between two rows.
        last: Number of the last one.
        kind: "limit": a limit is violated; "singular": the path meets a singularity; "close": it comes close to one;
            "vector": it does so only for a tool vector as the target; "reach": a line leaves the reach; "jump": axes
            move far while the tool hardly moves; "unreachable": no axis values for the pose; "no_pose": no pose of the
            axis values.
        text: In words.
    """

    __repr__ = fields_shown

    row: int
    last: int
    kind: PlaybackNoteKind
    text: str


def playback_notes(
    robot: Mechanism,
    rows: Matrix,
    between: Between,
    reasons: Mapping[int, str],
    without: NDArray[np.bool_],
    progress: Progress,
) -> tuple[list[PlaybackNote], tuple[str, ...]]:
    """Return the notes on rows in their order, and remarks on how they were found.

    Between rows is looked at where that takes bounded time: with an affine axis map, and drives that are sums of axes.

    Args:
        robot: The robot.
        rows: (n, n_axes) mm and degrees; not a number where a pose has no solution.
        between: What the machine does between rows.
        reasons: Why poses have no solution, by index of the row.
        without: (n,) rows whose axis values have no pose.
        progress: As for `path_report`.
    """
    notes = [*_failures(reasons), *_runs(without, "no_pose", lambda _: "the axis values have no pose")]
    notes += _jumps(robot, rows)
    if isinstance(robot.chain.axis_map, AffineMap) and not robot.limits.curved:
        report = path_report(robot, rows, between=between, progress=progress)
        notes += _of_path(report)
        remarks = report.remarks
    else:
        notes += _violated_at_rows(robot, rows)
        remarks = ("axes or drives follow no affine map: between rows nothing was looked at",)
    return sorted(notes, key=lambda note: note.row), remarks


def _failures(reasons: Mapping[int, str]) -> Iterator[PlaybackNote]:
    """Yield one note for rows that follow one another and failed alike."""
    rows = sorted(reasons)
    alike = groupby(enumerate(rows), key=lambda one: (one[1] - one[0], kind_of(reasons[one[1]])))
    for _, group in alike:
        run = [row for _, row in group]
        yield PlaybackNote(run[0] + 1, run[-1] + 1, "unreachable", reasons[run[0]])


def _runs(where: NDArray[np.bool_], kind: PlaybackNoteKind, words: Callable[[slice], str]) -> Iterator[PlaybackNote]:
    """Yield one note for each run of rows (n,), whose text is that of its slice."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], where, [False]]).astype(np.int8)))
    for begin, end in edges.reshape(-1, 2).tolist():
        yield PlaybackNote(begin + 1, end, kind, words(slice(begin, end)))


def _jumps(robot: Mechanism, rows: Matrix) -> Iterator[PlaybackNote]:
    """Yield the rows to which axes move far while the tool hardly moves: another branch, or a whole turn."""
    length = characteristic_length(robot.chain)
    linear = np.array([axis.kind == "linear" for axis in robot.axes])
    moves = np.diff(rows, axis=0) * robot.kinematics.si_factors / np.where(linear, length, 1.0)
    most = np.abs(moves).max(axis=1, initial=0.0)
    for n in np.flatnonzero(most > _JUMP).tolist():
        before, behind = forward_poses(robot, rows[[n, n + 1]])
        shift, turn = (float(one[0]) for one in pose_errors(before[None], behind[None], "pose"))
        if most[n] > _MORE * max(shift / length, turn):  # not where one of the rows has no pose
            far = int(np.abs(moves[n]).argmax())
            axis, way = robot.axes[far], float(rows[n + 1, far] - rows[n, far])
            tool = f"the tool moves {number(mm_from_m(shift))} mm and turns {number(deg_from_rad(turn))} deg"
            text = f"{axis.name} moves {number(way)} {axis.unit} from {n + 1} to {n + 2} while {tool}"
            yield PlaybackNote(n + 2, n + 2, "jump", text)


def _violated_at_rows(robot: Mechanism, rows: Matrix) -> Iterator[PlaybackNote]:
    """Yield the limits that rows violate, each run of rows once, with what is wrong in the worst of them."""
    watch = LimitWatch(robot.limits)
    excess = watch.excess(rows)
    for n, name in enumerate(watch.names):

        def words(run: slice, n: int = n, name: str = name) -> str:
            worst = run.start + int(excess[run, n].argmax())
            text = dict(robot.limits.violations(rows[worst])).get(name, name)
            return f"{text}, {_span(f'{run.start + 1}', f'{run.stop}')}{_most(run, worst)}"

        yield from _runs(excess[:, n] > LIMIT_SLACK, "limit", words)


def _most(run: slice, worst: int) -> str:
    return f", most at {worst + 1}" if run.stop - run.start > 1 else ""


def _of_path(report: PathReport) -> Iterator[PlaybackNote]:
    for violation in report.violations:
        begin, end = violation.begin, violation.end
        most = f", most at {violation.worst.label}" if begin.label != end.label else ""
        text = f"{violation.words}, {_span(begin.label, end.label)}{most}{_sampled(violation.proven)}"
        yield PlaybackNote(*_rows_of(begin, end), "limit", text)
    for stretch in report.stretches:
        yield _of_stretch(stretch)
    for place in report.leaves:
        text = f"the line leaves the reach of the arm at {place.label}"
        yield PlaybackNote(*_rows_of(place, place), "reach", text)


def _of_stretch(stretch: PathStretch) -> PlaybackNote:
    least, *more = stretch.minima  # the closest place, or all that are singular
    rows, where = _rows_of(stretch.begin, stretch.end), _span(stretch.begin.label, stretch.end.label)
    if stretch.of_vector:
        text = f"{least.sentence}, {where}; rotary axes as programmed lose nothing there"
        return PlaybackNote(*rows, "vector", text)
    how = "singular" if least.singular else "close to singular"
    places = f"{least.place.label} and {len(more)} more" if more else least.place.label
    at = f" at {places}, close" if stretch.begin.label != stretch.end.label else ""
    text = f"{how} ({stretch.kind}){at} {where}: {least.sentence}{_sampled(stretch.proven)}"
    return PlaybackNote(*rows, "singular" if least.singular else "close", text)


def _rows_of(begin: PathPlace, end: PathPlace) -> tuple[int, int]:
    """Return the numbers of the first and last row on a part of a path; of one between two rows the row before it."""
    first = begin.row + math.ceil(round(begin.share, _SHARE_DIGITS))
    last = end.row + math.floor(round(end.share, _SHARE_DIGITS))
    return (first + 1, last + 1) if first <= last else (begin.row + 1, begin.row + 1)


def _span(begin: str, end: str) -> str:
    return f"at {begin}" if begin == end else f"from {begin} to {end}"


def _sampled(proven: bool) -> str:
    return "" if proven else " (sampled)"
