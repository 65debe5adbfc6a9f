"""`chainbuild singularity`: how close axis values are to a singularity, in numbers and in words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import chain, islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from chainbuild.cli.axisvalues import At, values_of
from chainbuild.cli.pathdata import PathData, finite
from chainbuild.cli.pathinput import PathInput
from chainbuild.cli.pathreport import print_gaps, print_limits, report_path, shown_limit, shown_speed
from chainbuild.cli.show import console, empty_table, note, print_json, say
from chainbuild.cli.usage import DEFAULT_OPTIONS, Json, MachineOptions, UsageError
from chainbuild.errors import Span, TableError
from chainbuild.units import mm_from_m

if TYPE_CHECKING:
    from chainbuild.analysis.path.along import PathOptions
    from chainbuild.analysis.singularity.names import SingularityReport
    from chainbuild.analysis.singularity.nearest import Nearest
    from chainbuild.analysis.singularity.singularity import Singularity
    from chainbuild.analysis.verdicts.thresholds import Assessment, Thresholds
    from chainbuild.arrays import Matrix, Vector
    from chainbuild.robot import Robot

_LEVELS = {"singular": "singular", "watched": "watched", "clear": "above its thresholds"}


@Parameter(name="*", group="Singularity")
@dataclass(frozen=True, slots=True)
class MeasureOptions:
    """How a position is measured and what is reported.

    Attributes:
        speed: Tool speed for which axis speeds are reported, in mm/s (deg/s where only rotations are lost).
        length: Characteristic length in mm that makes lengths and angles comparable. Default: the length of the chain
            from its first joint to the tips.
        nearest: Also search for the nearest singularity.
    """

    speed: float = 10.0
    length: float | None = None
    nearest: Annotated[bool, Parameter(negative="")] = False

    def refuse_on_paths(self) -> None:
        """Refuse what is asked of positions alone.

        Raises:
            UsageError: it is given with a path.
        """
        for name, given in (("--nearest", self.nearest), ("--length", self.length is not None)):
            if given:
                raise UsageError(f"{name} requires --at or --between rows")


DEFAULT_MEASURES = MeasureOptions()
NO_PATH = PathInput()


def singularity(
    file: str,
    /,
    *,
    at: At = (),
    picture: Path | None = None,
    json: Json = False,
    path: PathInput = NO_PATH,
    measures: MeasureOptions = DEFAULT_MEASURES,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Report how close axis values or a path are to a singularity: measures, names, axis speeds.

    Of a path what happens between its rows counts, too: where it is singular or close, which limits it violates, and,
    with --feed, the axis speeds it needs. docs/paths.md lists what is proven and what is sampled.

    Example: `chainbuild singularity kr6r900 --at 0,-90,90,0,2,0 --nearest`

    Example: `chainbuild singularity kr6r900 --axes path.csv --feed 6000 --picture path.svg`

    Example: `chainbuild singularity kr6r900 --poses line.csv --start start.csv`

    Args:
        file: A machine file, or the name of a shipped machine.
        at: Axis values in channel order, mm and degrees, separated by commas; may be repeated.
        picture: SVG file to write: the smallest singular value over the rows, and between them where it is small.
        json: Print JSON.
        path: A path instead.
        measures: How to measure.
        options: Which kinematic.
    """
    path.check(bool(at))
    robot = options.robot(file)
    if at:
        _rows_alone(robot, [values_of(robot, text) for text in at], measures, picture, json)
        return 0
    asked = path.path_options(measures.speed)
    with path.rows(robot) as source:
        ahead = list(islice(source, 2))
        if not ahead:
            raise TableError("the table has no rows", span=Span(str(path.axes or path.poses)))
        rows = chain(ahead, source)
        if len(ahead) == 1:
            _rows_alone(robot, list(rows), measures, picture, json)
        elif path.motion == "rows":
            _rows_alone(robot, list(rows), measures, picture, json, asked)
        else:
            measures.refuse_on_paths()
            report_path(robot, rows, path.motion, asked, picture, json)
    return 0


def _rows_alone(
    robot: Robot,
    given: Sequence[Vector],
    measures: MeasureOptions,
    picture: Path | None,
    json: bool,
    asked: PathOptions | None = None,
) -> None:
    """Report on positions, or, with path options, on the rows of a path; rows of NaN are gaps."""
    import numpy as np

    from chainbuild.analysis.path.along import path_report
    from chainbuild.analysis.verdicts.thresholds import thresholds_of

    rows = np.array(given)
    known = np.flatnonzero(np.isfinite(rows).all(axis=1))
    shown = _Shown(robot, rows[known], (known + 1).tolist(), len(rows), thresholds_of(robot.chain), measures)
    report = None if asked is None else path_report(robot, rows, between="rows", options=asked)
    if picture:
        note(f"wrote {shown.draw(picture)}")
    if json:
        more = {} if report is None or asked is None else {"path": PathData(robot, report, asked).data()}
        print_json("singularity", shown.data() | more)
    elif len(rows) == len(known) == 1:
        shown.print_position()
    else:
        shown.print_path()
        if report is not None:
            print_limits(report)
            print_gaps(report)


class _Shown:
    """Positions with their measures and judgements.

    Args:
        robot: The robot.
        rows: (n, n_axes) those with axis values.
        numbers: Their rows in the table, from 1.
        count: Rows of the table.
        limits: Thresholds of the control.
        measures: How to measure.
    """

    def __init__(
        self,
        robot: Robot,
        rows: Matrix,
        numbers: list[int],
        count: int,
        limits: Thresholds | None,
        measures: MeasureOptions,
    ) -> None:
        from chainbuild.analysis.singularity.measures import measure_batch
        from chainbuild.analysis.singularity.names import examine, examine_path
        from chainbuild.analysis.singularity.nearest import nearest_singularity
        from chainbuild.analysis.verdicts.thresholds import assess
        from chainbuild.units import m_from_mm

        length = None if measures.length is None else m_from_mm(measures.length)
        self.robot, self.rows, self.limits = robot, rows, limits
        self.numbers, self.count = numbers, count
        self.table = measure_batch(robot, rows, length=length)
        self.reports: list[tuple[int, SingularityReport]]
        if len(rows) == count == 1:
            self.reports = [(0, examine(robot, rows[0], tool_speed_mm=measures.speed, length=length))]
        else:
            self.reports = list(examine_path(robot, rows, tool_speed_mm=measures.speed))
        chosen = [row for row, _ in self.reports] if measures.nearest else []
        self.nearest: dict[int, Nearest] = {row: nearest_singularity(robot, rows[row], length=length) for row in chosen}
        self.assessments: dict[int, Assessment] = {}
        if limits is not None:
            self.assessments = {row: assess(robot, rows[row], limits) for row, _ in self.reports}

    def draw(self, path: Path) -> Path:
        import numpy as np

        from chainbuild.analysis.singularity.names import NEAR
        from chainbuild.writers.picture import measure_picture, write_picture

        smallest = np.full(self.count, np.nan)
        smallest[np.array(self.numbers, dtype=int) - 1] = self.table.smallest
        return write_picture(path, measure_picture(smallest, self.robot.chain.title, NEAR))

    def _column(self, values: Vector) -> list[float | None]:
        found: list[float | None] = [None] * self.count
        for number, value in zip(self.numbers, values.tolist(), strict=True):
            found[number - 1] = finite(value)
        return found

    def data(self) -> dict[str, Any]:
        return {
            "task": self.robot.task,
            "length_mm": mm_from_m(self.reports[0][1].measures.length) if self.reports else None,
            "thresholds": asdict(self.limits) if self.limits else None,
            "smallest": self._column(self.table.smallest),
            "manipulability": self._column(self.table.manipulability),
            "condition": self._column(self.table.condition),
            "rows": [self._row(row, report) for row, report in self.reports],
        }

    def _row(self, row: int, report: SingularityReport) -> dict[str, Any]:
        speed, nearest = report.speed, self.nearest.get(row)
        names = [axis.name for axis in self.robot.axes]
        return {
            "row": self.numbers[row],
            "axes": dict(zip(names, report.axes.tolist(), strict=True)),
            "singular_values": report.measures.singular_values.tolist(),
            "lost": report.measures.lost.tolist(),
            "runaway": dict(zip(names, report.measures.runaway.tolist(), strict=True)),
            "names": [asdict(found) for found in report.names],
            "notices": [asdict(found) for found in report.notices],
            "speeds": {one.name: finite(one.needed) for one in (*speed.axes, *speed.drives)},
            "possible_speed": speed.possible,
            "alarm": speed.alarm,
            "judgement": asdict(self.assessments[row]) if row in self.assessments else None,
            "nearest": None if nearest is None else _nearest_data(nearest, names),
        }

    def print_position(self) -> None:
        out, report = console(), self.reports[0][1]
        measures = report.measures
        values = ", ".join(f"{value + 0.0:.4g}" for value in measures.singular_values)
        shown = empty_table("Measures", "Measure", "Value")
        shown.add_row("singular values, scaled", values)
        shown.add_row("smallest", f"{measures.smallest + 0.0:.6g}")
        shown.add_row("manipulability", f"{measures.manipulability + 0.0:.4g}")
        shown.add_row("condition", f"{measures.condition:.4g}")
        shown.add_row("characteristic length", f"{mm_from_m(measures.length):.6g} mm")
        assessment = self.assessments.get(0)
        if assessment is not None and self.limits is not None:
            level = _LEVELS[assessment.level] + (", axis 5 within ITERLIMIT" if assessment.hand_limit else "")
            shown.add_row(
                "for the control", f"{level}: {assessment.measure} {assessment.value:.4g} ({_thresholds(self.limits)})"
            )
        out.print(shown)
        self._print_speeds(report)
        for found in (*report.names, *report.notices):
            _print_singularity(found)
        if not report.names:
            say("no singularity near")
        if 0 in self.nearest:
            _print_nearest(self.nearest[0], self.robot)

    def _print_speeds(self, report: SingularityReport) -> None:
        shown = empty_table(
            f"Axis speeds at {report.speed.tool_speed:g} mm/s of the tool, worst direction", "Axis", "Needs", "Can"
        )
        for row in (*report.speed.axes, *report.speed.drives):
            shown.add_row(row.name, shown_speed(row), shown_limit(row))
        console().print(shown)
        if report.speed.alarm:
            say(f"an axis exceeds its speed limit: alarm {report.speed.alarm} in JOG")

    def print_path(self) -> None:
        shown = empty_table("Close to singularities", "Row", "Smallest", "Kind", "What")
        for row, report in self.reports:
            for found in (*report.names, *report.notices):
                shown.add_row(str(self.numbers[row]), f"{self.table.smallest[row]:.3g}", _kind(found), found.sentence)
        console().print(shown)
        for row, nearest in self.nearest.items():
            say(f"row {self.numbers[row]}: ", end="")
            _print_nearest(nearest, self.robot)
        posed = [value for value in self.table.smallest.tolist() if not math.isnan(value)]
        if len(posed) < len(self.rows):
            say(f"{len(self.rows) - len(posed)} rows have no pose and are left out")
        least = f", the smallest singular value is {min(posed):.4g}" if posed else ""
        say(f"{self.count} rows{least}")


def _kind(found: Singularity) -> str:
    return f"{found.kind} ({found.alias})" if found.alias else found.kind.replace("_", " ")


def _print_singularity(found: Singularity) -> None:
    say(f"{_kind(found)}: {found.sentence}")
    if found.remark:
        say(f"  {found.remark}")


def _print_nearest(nearest: Nearest, robot: Robot) -> None:
    if not nearest.found:
        say("the descent from this position finds no singularity")
        return
    moves = [
        f"{axis.name} {change:+.4g}{'°' if axis.unit == 'deg' else ' mm'}"
        for axis, change in zip(robot.axes, nearest.change.tolist(), strict=True)
        if abs(change) > 5e-4
    ]
    place = "" if nearest.inside else " (outside the limits)"
    say(f"nearest singularity at {nearest.distance:.4g} rad{place}: {', '.join(moves) or 'here'}")


def _thresholds(limits: Thresholds) -> str:
    text = f"SD41670 {limits.threshold:g}, SD41671 {limits.clearance:g}, ITERLIMIT {limits.iter_limit_deg:g}°"
    return text if limits.given else f"{text}: recommended, not in the file"


def _nearest_data(nearest: Nearest, names: list[str]) -> dict[str, Any]:
    return {
        "found": nearest.found,
        "axes": dict(zip(names, nearest.axes.tolist(), strict=True)),
        "change": dict(zip(names, nearest.change.tolist(), strict=True)),
        "distance": nearest.distance,
        "smallest": nearest.smallest,
        "inside": nearest.inside,
    }
