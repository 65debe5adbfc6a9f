"""What a path does between its rows, for people: singularities, limits, speeds, the reach, gaps."""

from __future__ import annotations

import math
from dataclasses import asdict
from itertools import pairwise
from typing import TYPE_CHECKING, Final

from chainbuild.cli.pathdata import PathData
from chainbuild.cli.show import console, empty_table, note, print_json, say, shown_number
from chainbuild.cli.verdicts import print_verdicts, verdicts_data

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from chainbuild.analysis.path.along import PathOptions
    from chainbuild.analysis.path.places import PathMinimum, PathPlace, PathReport, PathStretch, PathViolation
    from chainbuild.analysis.singularity.speeds import AxisSpeed
    from chainbuild.analysis.verdicts.blockverdicts import SingularityVerdicts
    from chainbuild.arrays import Vector
    from chainbuild.cli.usage import BetweenRows
    from chainbuild.robot import Robot

_DIGITS: Final = 6  # of mm/s and deg/s: further ones are noise
_MINIMA_SHOWN: Final = 10  # of one stretch: more are a path that swings through the singularity, and counted
_RUNS_SHOWN: Final = 10  # of rows without axis values: fit in a line or two; the others are counted


def report_path(
    robot: Robot,
    rows: Iterable[Vector],
    between: BetweenRows,
    asked: PathOptions,
    picture: Path | None,
    json: bool,
) -> None:
    """Report on a path, between its rows, too; the rows are read one by one.

    They are kept for a picture, and where thresholds of the control are known.

    Args:
        robot: The robot.
        rows: Axis values of each row, (n_axes,); NaN where there are none.
        between: What the machine does between rows.
        asked: Thresholds and speeds.
        picture: SVG file to write.
        json: Whether to print JSON.
    """
    from chainbuild.analysis.path.along import path_report
    from chainbuild.analysis.verdicts.thresholds import thresholds_of

    limits = thresholds_of(robot.chain)
    kept: list[Vector] | None = [] if picture or limits is not None else None
    report = path_report(robot, rows if kept is None else _keeping(rows, kept), between=between, options=asked)
    if picture and kept is not None:
        from chainbuild.analysis.path.dips import dips_of
        from chainbuild.writers.pathpicture import path_picture
        from chainbuild.writers.picture import write_picture

        dips = dips_of(robot, kept, report)
        note(f"wrote {write_picture(picture, path_picture(report, dips, robot.chain.title, asked.smallest))}")
    verdicts = _verdicts(robot, kept, between, asked) if kept and limits is not None else None
    if json:
        data = {
            "task": robot.task,
            "thresholds": None if limits is None else asdict(limits),
            "verdicts": None if verdicts is None else verdicts_data(verdicts),
            "path": PathData(robot, report, asked).data(),
        }
        print_json("singularity-path", data)
        return
    print_report(robot, report, asked)
    if verdicts is not None:
        print_verdicts(verdicts)
    say(last_line(report))


def _verdicts(
    robot: Robot, rows: Sequence[Vector], between: BetweenRows, asked: PathOptions
) -> SingularityVerdicts | None:
    """Return what the control makes of the blocks; None, with a note, where rows are missing."""
    import numpy as np

    from chainbuild.analysis.verdicts.judging import singularity_verdicts

    every = np.array(rows)
    if between == "rows" or len(every) < 2:
        return None
    if not np.isfinite(every).all():
        note("rows without axis values interrupt the path: its blocks are not judged by the thresholds of the control")
        return None
    return singularity_verdicts(robot, every, between=between, feed_mm_min=asked.feed_mm_min)


def _keeping(rows: Iterable[Vector], kept: list[Vector]) -> Iterator[Vector]:
    for row in rows:
        kept.append(row)
        yield row


def print_report(robot: Robot, report: PathReport, options: PathOptions) -> None:
    """Print a report on a path, but for its last line.

    Args:
        robot: The robot.
        report: The report.
        options: What it was made with.
    """
    stretches = [one for one in report.stretches if not one.of_vector]
    if stretches:
        _print_stretches(stretches)
    else:
        say("no part of the path is close to a singularity")
    for stretch in report.stretches:
        if stretch.of_vector:
            say(f"notice: {span(stretch.begin, stretch.end)}: {vector_notice(robot, stretch)}")
    print_limits(report)
    if report.speeds:
        _print_speeds(report, options)
    for place in report.leaves:
        say(left_words(place))
    print_gaps(report)
    for remark in report.remarks:
        say(remark)


def _print_stretches(stretches: Sequence[PathStretch]) -> None:
    timed = stretches[0].seconds is not None
    speed = stretches[0].minima[0].tool_speed
    ways = ["mm", "s"] if timed else ["mm"]
    shown = empty_table(
        f"Close to singularities; speeds at {speed:.4g} mm/s of the tool: along the path, and in the worst direction",
        *("Kind", "From", "To", *ways, "Closest", "Value", "Smallest", "Axis", "Path needs", "Worst", "Can"),
    )
    for stretch in stretches:
        kind = stretch.kind if stretch.proven else f"{stretch.kind} (sampled)"
        first = [kind, stretch.begin.label, stretch.end.label, f"{stretch.length_mm:.4g}"]
        first += [f"{stretch.seconds:.4g}"] if stretch.seconds is not None else []
        for minimum in stretch.minima[:_MINIMA_SHOWN]:
            shown.add_row(*first, *_minimum_cells(minimum))
            first = [""] * len(first)
    console().print(shown)
    for stretch in stretches:
        for minimum in stretch.minima[:_MINIMA_SHOWN]:
            say(f"{stretch.kind} at {minimum.place.label}: {minimum.sentence}")
        if len(stretch.minima) > _MINIMA_SHOWN:
            say(f"… and {len(stretch.minima) - _MINIMA_SHOWN} more {span(stretch.begin, stretch.end)}")
        if stretch.throughout:
            say(f"singular all the way {span(stretch.begin, stretch.end)}")


def _minimum_cells(minimum: PathMinimum) -> list[str]:
    value = "0" if minimum.singular else f"{minimum.value:.3g}"
    smallest = "–" if math.isnan(minimum.smallest) else f"{round(minimum.smallest, _DIGITS) + 0.0:.3g}"
    cells = [minimum.place.label, value, smallest]
    pair = hardest(minimum)
    if pair is None:
        return [*cells, *["–"] * 4]
    own, worst = pair
    return [*cells, own.name, shown_speed(own), shown_speed(worst), shown_limit(own)]


def hardest(minimum: PathMinimum) -> tuple[AxisSpeed, AxisSpeed] | None:
    """Return the speed of one axis or drive along the path, and in the worst direction; None: none is known.

    It is one that the path moves faster than it can, else the one that the worst direction asks most of, as a share of
    what it can where that is known.
    """
    pairs = [pair for pair in zip(minimum.speeds, minimum.worst, strict=False) if not math.isnan(pair[0].needed)]
    limited = [pair for pair in pairs if pair[0].limit]

    def strain(pair: tuple[AxisSpeed, AxisSpeed]) -> tuple[bool, float, float]:
        own, worst = pair
        can = own.limit or 1.0
        asked = own.needed / can
        return own.excessive, asked if own.excessive else worst.needed / can, asked

    return max(limited or pairs, key=strain, default=None)


def shown_speed(speed: AxisSpeed) -> str:
    """Return the speed that an axis or drive needs as text."""
    return "∞" if math.isinf(speed.needed) else f"{round(speed.needed, _DIGITS):.4g} {_unit(speed)}"


def shown_limit(speed: AxisSpeed) -> str:
    """Return the speed that an axis or drive can reach as text."""
    return "–" if speed.limit is None else f"{shown_number(speed.limit)} {_unit(speed)}"


def _unit(speed: AxisSpeed) -> str:
    return "deg/s" if speed.axis.unit == "deg" else "mm/s"


def _print_speeds(report: PathReport, options: PathOptions) -> None:
    shown = empty_table(
        f"Largest axis speeds at {options.feed_mm_min:g} mm/min", "Axis", "Path needs", "At", "Can", "Beyond it"
    )
    for one in report.speeds:
        beyond = span(one.begin, one.end) if one.begin and one.end else ""
        shown.add_row(one.speed.name, shown_speed(one.speed), one.place.label, shown_limit(one.speed), beyond)
    console().print(shown)


def print_limits(report: PathReport) -> None:
    """Print the limits that a path violates, one line each."""
    for violation in report.violations:
        say(f"limit violated {violation_words(violation)}")


def violation_words(violation: PathViolation) -> str:
    """Return where a limit is violated, and how."""
    worst = f", most at {violation.worst.label}" if violation.begin.label != violation.end.label else ""
    sampled = "" if violation.proven else " (sampled)"
    return f"{span(violation.begin, violation.end)}{worst}: {violation.words}{sampled}"


def left_words(place: PathPlace) -> str:
    """Return that a line leaves the reach."""
    return f"the line leaves the reach of the arm at {place.label}"


def vector_notice(robot: Robot, stretch: PathStretch) -> str:
    """Return what a tool vector as the target would meet on a stretch that rotary axes pass without loss."""
    from chainbuild.analysis.singularity.names import vector_words

    least = min(stretch.minima, key=lambda one: one.value)
    if stretch.kind in ("pole", "wrist"):
        words = vector_words(robot, least.value)
    else:
        words = least.sentence
        if not words.startswith("a tool vector"):
            words = f"a tool vector as the target would come close to a singularity: {words}"
    return f"{words}, closest at {least.place.label}; rotary axes as programmed lose nothing there"


def print_gaps(report: PathReport) -> None:
    """Print which rows have no axis values or no pose."""
    if report.gaps:
        verb = "has" if len(report.gaps) == 1 else "have"
        say(f"{rows_words(report.gaps)} {verb} no axis values or no pose: the path is interrupted there")


def rows_words(rows: Sequence[int]) -> str:
    """Return rows, counted from 0 and rising, as a table counts them: "rows 3, 5 … 9"."""
    ends = [n for n, (before, after) in enumerate(pairwise(rows), start=1) if after != before + 1]
    runs = [(rows[a] + 1, rows[b - 1] + 1) for a, b in pairwise([0, *ends, len(rows)])]
    parts = [f"{first}" if first == last else f"{first} … {last}" for first, last in runs[:_RUNS_SHOWN]]
    more = f" and {len(runs) - _RUNS_SHOWN} runs more" if len(runs) > _RUNS_SHOWN else ""
    return f"row{'s' * (len(rows) > 1)} {', '.join(parts)}{more}"


def span(begin: PathPlace, end: PathPlace) -> str:
    """Return "from 1 + 0.2 to 2", or "at 2"."""
    if begin.label == end.label:
        return f"at {begin.label}"
    return f"from {begin.label} to {end.label}"


def last_line(report: PathReport) -> str:
    """Return what was looked at."""
    known = [value for value in report.smallest.tolist() if not math.isnan(value)]
    least = f", the smallest singular value at the rows is {min(known):.4g}" if known else ""
    seconds = f", {report.seconds:.6g} s" if report.seconds is not None else ""
    return f"{report.rows} rows, {report.between} between them, {report.length_mm:.6g} mm{seconds}{least}"
