"""From a configured kinematic to a chain: head offsets, tool, angle mode and axis limits come together here."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Final

from chainbuild.chain.elements import Axis, Chain
from chainbuild.convention import Choices
from chainbuild.errors import UnsupportedKinematicError
from chainbuild.findings import Collector
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.twincat.axis_offsets import with_axis_offsets
from chainbuild.formats.twincat.coupling.coupling import coupling_draft
from chainbuild.formats.twincat.coupling.coupling_groups import (
    COUPLING,
    MULTISTEP,
    coupling_data,
    label_of,
    member_named,
)
from chainbuild.formats.twincat.coupling.two_steps import two_steps
from chainbuild.formats.twincat.lists.axislist import with_limits
from chainbuild.formats.twincat.lists.source import Source
from chainbuild.formats.twincat.types.draft import serial_draft
from chainbuild.formats.twincat.universal.universal import UNIVERSAL, universal_draft

_TABLE_SENSE: Final = "table_rotary_sense"


def translate(source: Source, name: str, title: str, choose: Choices, collector: Collector) -> Chain:
    """Return the chain of a kinematic, its axes with limits.

    Args:
        source: What it is built from.
        name: File-system-safe name.
        title: Name for people.
        choose: Conventions.
        collector: Takes the findings of the translation.

    Raises:
        UnsupportedKinematicError: the type is unknown or not built.
        MachineDataError: a parameter is not permitted.
    """
    chain = draft(source, choose, collector)
    chain = with_axis_offsets(chain, source, choose, collector)
    axes = chain.axes
    if source.second is not None:
        above = draft(source.upper(), choose, collector)
        chain = two_steps(chain, source.trafo, above, source.second, collector)
        axes = (*axes, *above.axes)
    _tell_table_sense(axes, source, choose, collector)
    ahead = int(coupling_data()["tcp_axes"]) if source.trafo.type == COUPLING else 0
    axes = _limited(chain.axes, ahead, source, collector)
    return replace(chain.with_axes(axes), name=name, title=title)


def _tell_table_sense(axes: Iterable[Axis], source: Source, choose: Choices, collector: Collector) -> None:
    """Note that the sense of rotary axes that carry the workpiece is open, unless it was chosen."""
    open_points = {one.convention.name: one for one in choose.used() if not one.by_user}
    if _TABLE_SENSE not in open_points:
        return
    used = open_points[_TABLE_SENSE]
    names = dict.fromkeys(axis.name for axis in axes if axis.kind == "rotary" and axis.carries == "workpiece")
    text = f"the sense of the rotary workpiece axes ({', '.join(names)}) is open: {used.choice} is assumed"
    hint = f"{used.convention.verify} Then set convention {_TABLE_SENSE}"
    collector.add("CB465", text, span=source.trafo.span, hint=hint)


def draft(source: Source, choose: Choices, collector: Collector) -> Chain:
    """Return the chain of one transformation step, its axes without limits."""
    trafo = source.trafo
    if trafo.type == UNIVERSAL:
        return universal_draft(source, choose, collector, member=_is_member(source))
    if trafo.type != COUPLING:
        return serial_draft(source, choose, collector)
    if trafo.step > 0 or source.second is not None:
        raise UnsupportedKinematicError(
            "a coupling kinematic cannot be part of a transformation of two steps", span=trafo.span,
            parameter=f"{trafo.prefix}.id", permitted="a coupling alone in step 0", alarm=MULTISTEP, code="CB455",
        )  # fmt: skip
    return coupling_draft(source, choose, collector)


def _is_member(source: Source) -> bool:
    """Return whether a coupling of the channel names the kinematic: then it may have fewer axes."""
    trafos = source.channel.trafos
    for coupling in (trafo for trafo in trafos if trafo.type == COUPLING):
        for key, entry in coupling.extras.items():
            if ".chain[" in key and source.trafo in member_named(label_of(entry, empty=True), trafos):
                return True
    return False


def _limited(axes: tuple[Axis, ...], ahead: int, source: Source, collector: Collector) -> tuple[Axis, ...]:
    """Return the axes with the limits of axis lists and overlay.

    Args:
        axes: Axes in channel order.
        ahead: How many axes of the channel come before them.
        source: Lists and overlay.
        collector: Takes findings.
    """
    simulated = tuple(Axis.unlimited(f"TCP axis {n}", "linear") for n in range(ahead))
    listed = with_limits((*simulated, *axes), source.channel.axes, source.axis_lists, collector)
    return _overlay_for(axes, source).apply_limits(listed[ahead:])


def _overlay_for(axes: tuple[Axis, ...], source: Source) -> Overlay:
    """Return the overlay; for a kinematic that it is not written for, without what it says of other axes."""
    overlay = source.overlay
    if source.main:
        return overlay
    known = {axis.name for axis in axes}
    rotary = {axis.name for axis in axes if axis.kind == "rotary"}
    return replace(
        overlay,
        limits={name: limits for name, limits in overlay.limits.items() if name in known},
        speeds={name: speed for name, speed in overlay.speeds.items() if name in known},
        endless=tuple(name for name in overlay.endless if name in rotary),
    )
