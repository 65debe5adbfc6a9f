"""The chapter on the axes: units, limits and where they come from, sums of axes, drives, joints and loops."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from chainbuild.chain.followers import followers
from chainbuild.closest import and_joined
from chainbuild.formats.listing import axis_meanings, limits_source
from chainbuild.writers.machine_report.document.blocks import (
    Bullets,
    Chapter,
    Heading,
    Paragraph,
    ReportBlock,
    table_block,
)
from chainbuild.writers.machine_report.document.numbers import decimal
from chainbuild.writers.models.notes import axis_map_in_words

if TYPE_CHECKING:
    from chainbuild.chain.elements import Axis, Chain
    from chainbuild.formats.machine import Machine
    from chainbuild.kinematics.mechanism import Mechanism


def axes_chapter(robot: Mechanism, machine: Machine | None) -> Chapter:
    """Return the chapter on the axes."""
    return Chapter("Axes, limits and drives", [_axes(robot.chain, machine), *_together(robot), *_joints(robot.chain)])


def _axes(chain: Chain, machine: Machine | None) -> ReportBlock:
    meanings = axis_meanings(chain) or [""] * len(chain.axes)
    two_sided = len({axis.carries for axis in chain.axes}) > 1
    rows = []
    for n, axis in enumerate(chain.axes):
        source = "assumed" if axis.assumed else "given" if machine is None else limits_source(machine, chain, n)
        speed = "–" if axis.max_speed is None else f"{decimal(axis.max_speed)} {axis.unit}/s"
        limits = ["endless", "endless"] if axis.endless else [decimal(axis.lower), decimal(axis.upper)]
        rows.append(
            [
                axis.name, axis.generic, axis.kind, axis.unit, *limits, source, speed,
                axis.carries if two_sided else "", _remarks(axis), meanings[n],
            ]
        )  # fmt: skip
    head = (
        "Axis", "Generic", "Kind", "Unit", "Lower", "Upper", "Limits from", "Speed", "Carries", "Remarks", "Meaning"
    )  # fmt: skip
    return table_block(head, rows)


def _remarks(axis: Axis) -> str:
    remarks = []
    if axis.held:
        remarks.append("held by inverse kinematics")
    if axis.widest is not None:
        remarks.append(f"with the others elsewhere {decimal(axis.widest[0])} … {decimal(axis.widest[1])}")
    return ", ".join(remarks)


def _together(robot: Mechanism) -> Iterator[ReportBlock]:
    limits, chain = robot.limits, robot.chain
    sums = [
        [one.label, _sum_in_words(chain, one.sum.coefficients, one.sum.offset), decimal(one.lower), decimal(one.upper)]
        for one in limits.plain_sums
    ]
    if sums:
        yield Heading(("Limits on sums of axes",))
        yield table_block(("What", "Sum", "Lower", "Upper"), sums)
    if chain.drives is None:
        yield Paragraph.of("Every drive stands at its axis value.")
        return
    names = [chain.axes[n].name for n in chain.drives.differing]
    if names:
        yield Heading(("Drives",))
        differ = "drive of {} does not stand at its axis value"
        if len(names) > 1:
            differ = "drives of {} do not stand at their axis values"
        yield Paragraph.of(
            f"The {differ.format(and_joined(names))}; robot.drives(axes) returns where drives stand. Software limits "
            "and speeds of machine data belong to drives."
        )
    rows = []
    for drive in chain.drive_limits:
        axis = chain.axes[drive.axis]
        ends = [decimal(end) if math.isfinite(end) else "–" for end in (drive.lower, drive.upper)]
        speed = "–" if drive.max_speed is None else f"{decimal(drive.max_speed)} {axis.unit}/s"
        rows.append([limits.drive_name(drive), axis.unit, *ends, speed])
    if rows:
        yield table_block(("Drive", "Unit", "Lower", "Upper", "Speed"), rows)


def _sum_in_words(chain: Chain, coefficients: tuple[float, ...], offset: float) -> str:
    parts = [
        f"{'-' if factor < 0.0 else '+'} {'' if abs(factor) == 1.0 else decimal(abs(factor)) + '*'}{axis.name}"
        for axis, factor in zip(chain.axes, coefficients, strict=True)
        if factor
    ]
    if decimal(abs(offset)) != "0":
        parts.append(f"{'-' if offset < 0.0 else '+'} {decimal(abs(offset))}")
    return " ".join(parts).removeprefix("+ ")


def _joints(chain: Chain) -> Iterator[ReportBlock]:
    """Yield what joints do that no axis of their name drives, and what closes loops."""
    if chain.loops:
        axes = {axis.name for axis in chain.axes}
        passive = [joint.name for joint in chain.joints if joint.name not in axes]
        yield Heading(("Closed loops",))
        yield Paragraph.of(
            f"The model is a tree of {len(chain.joints)} joints, closed by {len(chain.loops)} loop"
            f"{'s' * (len(chain.loops) > 1)}. No axis drives {and_joined(passive)}: they follow from the loops."
        )
        loops = [[one.name, one.kind, one.frame_a, one.frame_b] for one in chain.loops]
        yield table_block(("Loop", "Kind", "From frame", "To frame"), loops)
        return
    equations = axis_map_in_words(chain)
    masters = followers(chain)
    if equations:
        yield Heading(("Joint values that are not the axis of their name",))
        yield Bullets(tuple(Paragraph.of(line) for line in equations))
    if masters:
        yield Paragraph.of(f"Joints that follow another one: {and_joined(list(masters))}.")
