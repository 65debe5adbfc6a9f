"""The form of check poses: what to drive to, what the control should show, and room for what it does show."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from chainbuild.chain.programmed.display import ANGLE_COLUMNS, TOOL_COLUMNS
from chainbuild.closest import and_joined
from chainbuild.kinematics.displayed import displayed
from chainbuild.writers.machine_report.checkposes import CheckPose, CheckPoses, moved_both_ways
from chainbuild.writers.machine_report.document.blocks import Bullets, Chapter, Paragraph, ReportBlock, TableBlock
from chainbuild.writers.machine_report.document.numbers import angle, fixed, named_values
from chainbuild.writers.machine_report.document.page import TICK

if TYPE_CHECKING:
    from chainbuild.chain.elements import Chain
    from chainbuild.kinematics.mechanism import Mechanism

_SHOWN: Final = 3  # decimals of mm and degrees: what a control displays
_SHARES: Final = 6  # of a tool vector


def check_chapter(robot: Mechanism, found: CheckPoses) -> Chapter:
    """Return the chapter with the form of check poses."""
    title = "Check poses"
    if not found.poses:
        text = (
            "No safe pose was found: every position looked at is singular, or bodies, which are assumed by rule, "
            "touch. Compare the display in positions that are known to be safe."
        )
        return Chapter(title, [Paragraph.of(text)])
    return Chapter(title, [*_told(robot, found), _form(robot, found)])


def _told(robot: Mechanism, found: CheckPoses) -> Iterator[ReportBlock]:
    singles = {pose.moved for pose in found.poses}
    yield Paragraph.of(
        "Drive to each pose before switching the transformation on: axis by axis in JOG, at reduced override. Compare "
        "the pose that the control shows there; if it shows none yet, switch the transformation on at standstill to "
        "read it, and off again. Move with it only when every value of every pose agrees."
    )
    items = [
        "All poses are inside the limits of axes, sums and drives, away from singular positions, and no bodies touch. "
        "Bodies are assumed by rule; fixtures, cables and the room are not among them: watch the machine.",
        _ways_in_words(robot, found),
        "Pose 1 is the reference; the following move the axis named alone, the last ones all axes. A wrong sign of an "
        "axis shows where it alone is moved: as far, to the other side. A wrong length, zero or tool shows in pose 1.",
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
            f"Home, every axis at 0 or at the limit next to it, is no place to begin: {found.reason}. Find your own "
            "way to pose 1. The straight ways of the axes from there to every other pose are "
            f"{free}: go back to it in between."
        )
    home = named_values(robot.axes, found.home.tolist())
    return (
        f"The straight ways of the axes from home ({home}) and from pose 1 to every pose are {free}: go back to one "
        "of them in between."
    )


def _form(robot: Mechanism, found: CheckPoses) -> ReportBlock:
    drives = robot.chain.drives is not None and bool(robot.chain.drives.differing)
    rows: list[list[str]] = []
    head: tuple[str, ...] = ()
    for n, pose in enumerate(found.poses, 1):
        # Once the displayed angles are those before: of two answers of a tool vector a control shows the nearer one.
        shown = displayed(robot, pose.axes)
        held = {axis.name for axis in robot.axes if axis.held}
        columns = [name for name in shown if name not in held]
        what = _moved_in_words(robot, pose, found.poses[0])
        cells = [_value(name, shown[name]) for name in columns]
        to = [named_values(robot.axes, pose.axes.tolist())]
        if drives:
            to.append(named_values(robot.axes, robot.drives(pose.axes).tolist(), _SHOWN))
        rows.append([str(n), what, *to, "expected", *cells, TICK])
        rows.append(["", "", *([""] * len(to)), "shown", *([""] * len(cells)), ""])
        head = (
            "No.",
            "Moves",
            "Axis values",
            *(["DRIVES"] if drives else []),
            "",
            *(column_title(name, robot.chain) for name in columns),
            "✓",
        )
    return TableBlock(head, rows, "form")


def _moved_in_words(robot: Mechanism, pose: CheckPose, first: CheckPose) -> str:
    """Return which axes stand elsewhere than in the first pose."""
    if pose.moved is not None:
        return f"{robot.axes[pose.moved].name} alone"
    count = int((pose.axes != first.axes).sum())
    return "reference" if not count else "all axes" if count == len(first.axes) else "several axes"


def column_title(column: str, chain: Chain) -> str:
    """Return a column of a pose as its title: "X [mm]"."""
    units: dict[str, str] = {axis.name: axis.unit for axis in chain.axes}
    if column in units:
        return f"{column} [{units[column]}]"
    name, _, unit = column.rpartition("_")
    return f"{name.upper()} [{unit}]" if unit in ("mm", "deg") and name else column


def _value(column: str, value: float) -> str:
    if column in TOOL_COLUMNS:
        return fixed(value, _SHARES)
    return angle(value, _SHOWN) if column in ANGLE_COLUMNS else fixed(value, _SHOWN)
