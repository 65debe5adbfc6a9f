"""`chainbuild limits`: limits of one axis that depend on another, and those of a parallelogram."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chainbuild.cli.axisvalues import At, values_of
from chainbuild.cli.show import console, empty_table, note, print_json, say
from chainbuild.cli.usage import DEFAULT_OPTIONS, Json, MachineOptions, UsageError, Whole
from chainbuild.progress import bars_shown

if TYPE_CHECKING:
    from collections.abc import Sequence

    from chainbuild.analysis.collision.parallelogram import LimitReport
    from chainbuild.analysis.collision.sweep import FreeInterval, Sweep
    from chainbuild.robot import Robot


def limits(
    file: str,
    /,
    *,
    axis: str | None = None,
    over: str | None = None,
    at: At = (),
    steps: Whole = 37,
    picture: Path | None = None,
    json: Json = False,
    options: MachineOptions = DEFAULT_OPTIONS,
) -> int:
    """Find the collision-free interval of one axis over another, to a hundredth of a degree.

    Limits on sums of axes, [limits.sums] of the overlay among them, end it, too. Without --axis: check the limit angles
    of a ROBX parallelogram (MD62964) in the file and propose values.

    Example: `chainbuild limits kr6r900 --axis A3 --over A2`

    Args:
        file: A machine file, or the name of a shipped machine.
        axis: Axis whose collision-free interval is computed.
        over: Axis that is swept over its limits.
        at: Values of all axes at the start of the sweep, separated by commas. Default: the middle of the limits.
        steps: Number of values of the swept axis.
        picture: SVG file to write: the collision-free interval over the swept axis.
        json: Print JSON.
        options: Which kinematic.
    """
    if (axis is None) != (over is None):
        raise UsageError("--axis and --over must be given together")
    robot = options.robot(file)
    if axis is None or over is None:
        if at:
            raise UsageError("--at requires --axis and --over")
        _parallelogram(robot, steps, picture, json)
    else:
        _sweep(robot, axis, over, at, steps, picture, json)
    return 0


def _sweep(
    robot: Robot, axis: str, over: str, at: tuple[str, ...], steps: int, picture: Path | None, as_json: bool
) -> None:
    import numpy as np

    from chainbuild.analysis.collision.sweep import sweep, swept_axis
    from chainbuild.chain.bodies.shapes import shown_limits
    from chainbuild.collision.model import CollisionModel

    model = CollisionModel(robot)
    index = swept_axis(model, over)
    low, high = (float(bound[index]) for bound in shown_limits(robot.chain))
    if steps < 1:
        raise UsageError(f"--steps {steps}: expected at least 1")
    begin = values_of(robot, at[-1]) if at else None
    values = np.linspace(low, high, steps).tolist()
    found: Sweep = sweep(model, axis, over, at=begin, values=values, progress=bars_shown())
    axis, over = found.moved, found.over
    labels = f"{over} [{found.unit_over}]", f"{axis} [{found.unit_moved}]"
    if picture:
        _draw(picture, found.intervals, f"{robot.chain.title}: {axis} over {over}", labels)
    if as_json:
        print_json("limits", {"axis": axis, "over": over, "intervals": [asdict(i) for i in found.intervals]})
    else:
        _print(found.intervals, f"Free interval of {axis}", labels)


def _parallelogram(robot: Robot, steps: int, picture: Path | None, as_json: bool) -> None:
    from chainbuild.analysis.collision.parallelogram import swept_limits

    found: LimitReport = swept_limits(robot, steps=steps, progress=bars_shown())
    labels = f"{found.over} [deg]", "q3DH − q2DH [deg]"
    if picture:
        _draw(picture, found.intervals, f"{robot.chain.title}: parallelogram", labels, found.given)
    if as_json:
        data: dict[str, Any] = asdict(found) | {"machine_data": list(found.machine_data())}
        print_json("limits-parallelogram", data)
        return
    _print(found.intervals, "Free interval of the parallelogram's angle", labels)
    for verdict in found.verdicts:
        say(verdict)
    if found.drawn:
        names = ", ".join(found.drawn)
        say(f"an estimate: {names} with default dimensions; with those of [geometry] in the overlay limits are printed")
    for line in found.machine_data():
        say(line)


def _draw(
    picture: Path,
    intervals: Sequence[FreeInterval],
    title: str,
    labels: tuple[str, str],
    marks: Sequence[float] = (),
) -> None:
    from chainbuild.writers.picture import interval_picture, write_picture

    note(f"wrote {write_picture(picture, interval_picture(intervals, title, *labels, marks))}")


def _print(intervals: Sequence[FreeInterval], title: str, labels: tuple[str, str]) -> None:
    shown = empty_table(title, labels[0], "From", "To", "Below", "Above")
    for one in intervals:
        if one.lower is None or one.upper is None:
            limit = one.lower_limit or one.upper_limit
            shown.add_row(f"{one.over:.6g}", "–", "–", f"limit {limit}" if limit else "no free position", "")
            continue
        sides = (one.lower_pair, one.lower_limit), (one.upper_pair, one.upper_limit)
        limited = [f"limit {limit}" if limit else "end of the range" for _, limit in sides]
        ends = [" – ".join(pair) if pair else end for (pair, _), end in zip(sides, limited, strict=True)]
        shown.add_row(f"{one.over:.6g}", f"{one.lower:.2f}", f"{one.upper:.2f}", *ends)
    console().print(shown)
