"""The form of check poses: what to drive to, what the control should show, and room for what it does show."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from chainbuild.chain.programmed.display import ANGLE_COLUMNS, TOOL_COLUMNS
from chainbuild.closest import and_joined
from chainbuild.kinematics.displayed import displayed
from chainbuild.writers.machine_report.checkposes import CheckPoses, moved_both_ways
from chainbuild.writers.machine_report.document.blocks import Block, Bullets, Chapter, Grid, Paragraph
from chainbuild.writers.machine_report.document.numbers import angle, fixed, with_unit
from chainbuild.writers.machine_report.document.page import TICK

if TYPE_CHECKING:
    from chainbuild.arrays import Vector
    from chainbuild.kinematics.mechanism import Mechanism

_SHOWN: Final = 3  # decimals of mm and degrees: what a control displays
_SHARES: Final = 6  # of a tool vector


def check_chapter(robot: Mechanism, found: CheckPoses) -> Chapter:
    """Return the chapter with the form of check poses."""
    title = "Check poses"
    if not found.poses:
        text = (
            "No safe pose was found: every position looked at is singular, or bodies, which are assumed by rule, touch. "
            "Compare the display in positions that are known to be safe."
        )
        return Chapter(title, [Paragraph.of(text)])
    return Chapter(title, [*_told(robot, found), _form(robot, found)])


def _told(robot: Mechanism, found: CheckPoses) -> Iterator[Block]:
    singles = {pose.moved for pose in found.poses}
    yield Paragraph.of(
        "Drive to each pose before the transformation is switched on, axis by axis in JOG at reduced override, and compare "
        "what the control would show with what is expected. Switch it on only when every line agrees."
    )
    items = [
        "All poses are inside the limits, away from singular positions, and clear of the drawn bodies by more than touching. "
        "Bodies are assumed by rule, and fixtures and cables are not among them: watch the machine.",
        _ways_in_words(robot, found),
        "Pose 1 is the reference; each of the following moves the axis named alone, the last ones move all axes. An error "
        "in one axis shows in its line first: a wrong sign with the right amount to the wrong side, a wrong length or zero "
        "in every line.",
    ]
    if len(found.poses) < found.wanted:
        items.append(f"Only {len(found.poses)} of {found.wanted} such poses were found.")
    lacking = [axis.name for n, axis in enumerate(robot.axes) if n not in singles]
    if lacking:
        items.append(f"No safe pose moves {and_joined(lacking)} alone.")
    one_way = [axis.name for axis, both in zip(robot.axes, moved_both_ways(found.poses), strict=True) if not both]
    if one_way:
        items.append(f"No safe poses move {and_joined(one_way)} to both sides of pose 1.")
    if robot.chain.drives is not None and robot.chain.drives.differing:
        items.append(
            "Drives do not stand at the axis values: with the transformation off, drive them to the values of DRIVES."
        )
    yield Bullets(tuple(Paragraph.of(item) for item in items))


def _ways_in_words(robot: Mechanism, found: CheckPoses) -> str:
    free = "free of the drawn bodies and inside the limits"
    if found.home is None:
        return (
            "Home, every axis at 0 or at the limit next to it, is outside the limits or lets assumed bodies touch: find your own "
            f"way to pose 1. The straight ways of the axes from pose 1 to every other pose are {free}: go back to it in between."
        )
    home = _axes_in_words(robot, found.home)
    return (
        f"The straight ways of the axes from home ({home}) and from pose 1 to every pose are {free}: go back to pose 1 or home "
        "in between."
    )


def _axes_in_words(robot: Mechanism, axes: Vector) -> str:
    return ", ".join(
        f"{axis.name} {with_unit(value, axis.unit)}" for axis, value in zip(robot.axes, axes.tolist(), strict=True)
    )


def _form(robot: Mechanism, found: CheckPoses) -> Block:
    drives = robot.chain.drives is not None and bool(robot.chain.drives.differing)
    rows: list[list[str]] = []
    head: tuple[str, ...] = ()
    for n, pose in enumerate(found.poses, 1):
        # Once the displayed angles are those before: of two answers of a tool vector a control shows the nearer one.
        shown = displayed(robot, pose.axes)
        held = {axis.name for axis in robot.axes if axis.held}
        columns = [name for name in shown if name not in held]
        what = "reference" if n == 1 else "all axes" if pose.moved is None else f"{robot.axes[pose.moved].name} alone"
        cells = [_value(name, shown[name]) for name in columns]
        to = [_axes_in_words(robot, pose.axes)]
        if drives:
            at = robot.drives(pose.axes).tolist()
            to.append(
                ", ".join(f"{a.name} {with_unit(v, a.unit, _SHOWN)}" for a, v in zip(robot.axes, at, strict=True))
            )
        rows.append([str(n), what, *to, "expected", *cells, TICK])
        rows.append(["", "", *([""] * len(to)), "shown", *([""] * len(cells)), ""])
        head = ("No.", "Moves", "Axis values", *(["DRIVES"] if drives else []), "", *map(column_title, columns), "✓")
    return Grid(head, rows, "form")


def column_title(column: str) -> str:
    """Return a column as its title: "X [mm]"."""
    name, _, unit = column.rpartition("_")
    return f"{name.upper()} [{unit}]" if unit in ("mm", "deg") and name else column


def _value(column: str, value: float) -> str:
    if column in TOOL_COLUMNS:
        return fixed(value, _SHARES)
    return angle(value, _SHOWN) if column in ANGLE_COLUMNS else fixed(value, _SHOWN)
