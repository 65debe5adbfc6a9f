"""`chainbuild singularity`: how close axis values are to a singularity, in numbers and in words."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

from cyclopts import Parameter

from chainbuild.cli.axisvalues import At, given_rows
from chainbuild.cli.show import console, empty_table, note, print_json, say, shown_number
from chainbuild.cli.usage import DEFAULT_OPTIONS, Json, MachineOptions, UsageError
from chainbuild.cli.verdicts import print_verdicts, verdicts_data
from chainbuild.units import mm_from_m

if TYPE_CHECKING:
    from chainbuild.analysis.singularity.names import SingularityReport
    from chainbuild.analysis.singularity.nearest import Nearest
    from chainbuild.analysis.singularity.singularity import Singularity
    from chainbuild.analysis.verdicts.blockverdicts import SingularityVerdicts
    from chainbuild.analysis.verdicts.thresholds import Assessment, Thresholds
    from chainbuild.robot import Robot

_LEVELS = {"singular": "singular", "watched": "watched", "clear": "above its thresholds"}
_DIGITS: Final = 6  # of mm/s and deg/s: further ones are noise


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


DEFAULT_MEASURES = MeasureOptions()


def singularity(
    file: str,
    /,
    *,
    at: At = (),
    axes: Path | None = None,
    picture: Path | None = None,
    json: Json = False,
    measures: MeasureOptions = DEFAULT_MEASURES,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Report how close axis values are to a singularity: measures, names, axis speeds.

    Example: `chainbuild singularity kr6r900 --at 0,-90,90,0,2,0 --nearest`

    Args:
        file: A machine file, or the name of a shipped machine.
        at: Axis values in channel order, mm and degrees, separated by commas; may be repeated.
        axes: CSV table of axis values: a path; the rows at or near a singularity are reported.
        picture: SVG file to write: the smallest singular value over the rows.
        json: Print JSON.
        measures: How to measure.
        options: Which kinematic.
    """
    from chainbuild.analysis.verdicts.thresholds import thresholds_of

    robot = options.robot(file)
    rows = given_rows(robot, at, axes)
    if not len(rows):
        raise UsageError("expected --at or --axes")
    limits = thresholds_of(robot.chain)
    shown = _Shown(robot, rows, limits, measures)
    if picture:
        note(f"wrote {shown.draw(picture)}")
    if json:
        print_json(shown.data())
    elif len(rows) == 1:
        shown.print_position()
    else:
        shown.print_path()
    return 0


class _Shown:
    """One position or path with its measures and judgements."""

    def __init__(self, robot: Robot, rows: Any, limits: Thresholds | None, measures: MeasureOptions) -> None:
        from chainbuild.analysis.singularity.measures import measure_batch
        from chainbuild.analysis.singularity.names import examine, examine_path
        from chainbuild.analysis.singularity.nearest import nearest_singularity
        from chainbuild.analysis.verdicts.judging import singularity_verdicts
        from chainbuild.analysis.verdicts.thresholds import assess
        from chainbuild.units import m_from_mm

        length = None if measures.length is None else m_from_mm(measures.length)
        self.robot, self.rows, self.limits = robot, rows, limits
        self.table = measure_batch(robot, rows, length=length)
        self.reports: list[tuple[int, SingularityReport]]
        if len(rows) == 1:
            self.reports = [(0, examine(robot, rows[0], tool_speed_mm=measures.speed, length=length))]
        else:
            self.reports = list(examine_path(robot, rows, tool_speed_mm=measures.speed))
        chosen = [row for row, _ in self.reports] if measures.nearest else []
        self.nearest: dict[int, Nearest] = {row: nearest_singularity(robot, rows[row], length=length) for row in chosen}
        self.assessments: dict[int, Assessment] = {}
        self.verdicts: SingularityVerdicts | None = None
        if limits is not None:
            self.assessments = {row: assess(robot, rows[row], limits) for row, _ in self.reports}
            self.verdicts = singularity_verdicts(robot, rows) if len(rows) > 1 else None

    def draw(self, path: Path) -> Path:
        from chainbuild.analysis.singularity.names import NEAR
        from chainbuild.writers.picture import measure_picture, write_picture

        return write_picture(path, measure_picture(self.table.smallest, self.robot.chain.title, NEAR))

    def data(self) -> dict[str, Any]:
        return {
            "task": self.robot.task,
            "length_mm": mm_from_m(self.reports[0][1].measures.length) if self.reports else None,
            "thresholds": asdict(self.limits) if self.limits else None,
            "smallest": [_finite(value) for value in self.table.smallest],
            "manipulability": [_finite(value) for value in self.table.manipulability],
            "condition": [_finite(value) for value in self.table.condition],
            "rows": [self._row(row, report) for row, report in self.reports],
            "verdicts": verdicts_data(self.verdicts) if self.verdicts else None,
        }

    def _row(self, row: int, report: SingularityReport) -> dict[str, Any]:
        speed, nearest = report.speed, self.nearest.get(row)
        names = [axis.name for axis in self.robot.axes]
        return {
            "row": row + 1,
            "axes": dict(zip(names, report.axes.tolist(), strict=True)),
            "singular_values": report.measures.singular_values.tolist(),
            "lost": report.measures.lost.tolist(),
            "runaway": dict(zip(names, report.measures.runaway.tolist(), strict=True)),
            "names": [asdict(found) for found in report.names],
            "notices": [asdict(found) for found in report.notices],
            "speeds": {one.name: _finite(one.needed) for one in (*speed.axes, *speed.drives)},
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
            unit = "deg/s" if row.axis.unit == "deg" else "mm/s"
            needed = "∞" if math.isinf(row.needed) else f"{round(row.needed, _DIGITS):.4g} {unit}"
            shown.add_row(row.name, needed, f"{shown_number(row.limit)} {unit}" if row.limit is not None else "–")
        console().print(shown)
        if report.speed.alarm:
            say(f"an axis exceeds its speed limit: alarm {report.speed.alarm} in JOG")

    def print_path(self) -> None:
        shown = empty_table("Close to singularities", "Row", "Smallest", "Kind", "What")
        for row, report in self.reports:
            for found in (*report.names, *report.notices):
                shown.add_row(str(row + 1), f"{self.table.smallest[row]:.3g}", _kind(found), found.sentence)
        console().print(shown)
        if self.verdicts is not None:
            print_verdicts(self.verdicts)
        for row, nearest in self.nearest.items():
            say(f"row {row + 1}: ", end="")
            _print_nearest(nearest, self.robot)
        posed = [value for value in self.table.smallest.tolist() if not math.isnan(value)]
        if len(posed) < len(self.rows):
            say(f"{len(self.rows) - len(posed)} rows have no pose and are left out")
        least = f", the smallest singular value is {min(posed):.4g}" if posed else ""
        say(f"{len(self.rows)} rows{least}")


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


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
