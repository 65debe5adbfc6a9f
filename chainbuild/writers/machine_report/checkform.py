"""The form of check poses: what to drive to, what the control should show, and room for what it does show."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.chain.programmed.display import ANGLE_COLUMNS, TOOL_COLUMNS
from chainbuild.closest import and_joined
from chainbuild.frames import inverse
from chainbuild.kinematics.displayed import displayed
from chainbuild.units import deg_from_rad, mm_from_m
from chainbuild.writers.machine_report.checkposes import CheckPose, CheckPoses, moved_both_ways
from chainbuild.writers.machine_report.document.blocks import Bullets, Chapter, Paragraph, ReportBlock, TableBlock
from chainbuild.writers.machine_report.document.numbers import angle, decimal, fixed, named_values
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
            "No safe pose was found: at every position looked at the machine is singular, or bodies touch. Compare "
            "the display in positions that are known to be safe."
        )
        return Chapter(title, [Paragraph.of(text)])
    return Chapter(title, [*_told(robot, found), _form(robot, found)])


def _told(robot: Mechanism, found: CheckPoses) -> Iterator[ReportBlock]:
    singles = {pose.moved for pose in found.poses}
    yield Paragraph.of(
        "Drive to each pose before switching the transformation on, at reduced override: all axes together in one "
        "block, or one axis after the other in JOG. Compare the pose that the control shows there; if it shows none "
        "yet, switch the transformation on at standstill to read it, and off again. Move with it only when every value "
        "of every pose agrees."
    )
    items = [
        f"On the control no zero offset and no programmed frame is active, and the tool is that of this report: "
        f"{tool_in_words(robot.chain)}.",
        _safety_in_words(robot, found),
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


def tool_in_words(chain: Chain) -> str:
    """Return where the tool centre point is on the flange: "none, the TCP is in the flange"."""
    flange, tool = chain.frame("flange"), chain.frame("tool")
    T = inverse(flange.T_link_frame) @ tool.T_link_frame
    turned = decimal(deg_from_rad(float(np.arccos(np.clip((np.trace(T[:3, :3]) - 1.0) / 2.0, -1.0, 1.0)))), _SHOWN)
    place = {name: decimal(mm_from_m(float(value)), _SHOWN) for name, value in zip("XYZ", T[:3, 3], strict=True)}
    parts = [f"{name}\u00a0{value}\u00a0mm" for name, value in place.items() if value != "0"]
    if not parts and turned == "0":
        return "none, the TCP is in the flange"
    at = f"TCP at {', '.join(parts)} of the flange" if parts else "TCP in the flange"
    return at if turned == "0" else f"{at}, its axes turned by {turned}°"


def bodies_in_words(chain: Chain) -> str:
    """Return where the bodies of a chain come from."""
    given = chain.geometry.shapes or chain.geometry.visuals
    if not given:
        return "assumed by rule"
    source = "URDF" if chain.dialect == "URDF" else "overlay"
    return f"given by the {source}" if chain.dialect == "URDF" else f"given by the {source}, else assumed by rule"


def _safety_in_words(robot: Mechanism, found: CheckPoses) -> str:
    inside = "All poses are inside the limits of axes, sums and drives and away from singular positions"
    floor = (
        "" if found.floor is None else f"; nothing comes below Z {decimal(mm_from_m(found.floor), 0)} mm of the base"
    )
    if not found.watched:
        return (
            f"{inside}{floor}. Collisions were NOT looked for: the data place no two bodies of this machine that could "
            "touch. Look at every pose, the tool and the table above all, before you drive there."
        )
    return (
        f"{inside}{floor}. These bodies, {bodies_in_words(robot.chain)}, do not touch: {and_joined(found.watched)}. "
        "Other bodies, fixtures, cables and the room are not known: watch the machine."
    )


def _ways_in_words(robot: Mechanism, found: CheckPoses) -> str:
    free = "free of collisions of these bodies and inside the limits" if found.watched else "inside the limits"
    others = "Moved one after the other the axes go other ways, which were not looked at."
    if found.home is None:
        return (
            f"Home, every axis at 0 or at the limit next to it, is no place to begin: {found.reason}. Find your own "
            "way to pose 1. The straight ways of the axes, all together, from there to every other pose are "
            f"{free}: go back to it in between. {others}"
        )
    home = named_values(robot.axes, found.home.tolist())
    return (
        f"The straight ways of the axes, all together, from home ({home}) and from pose 1 to every pose are {free}: "
        f"go back to one of them in between. {others}"
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
