"""From a configured kinematic to a chain: head offsets, tool, angle mode and axis limits come together here."""

from __future__ import annotations

from dataclasses import replace

from chainbuild.chain.drives import DriveLimit
from chainbuild.chain.elements import Axis, Chain
from chainbuild.convention import Choices
from chainbuild.errors import MachineDataError, UnsupportedKinematicError
from chainbuild.findings import Collector
from chainbuild.formats.overlay import Overlay
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
from chainbuild.kinematics.ranges import with_ranges, within_reach


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
    if source.second is not None:
        second = replace(source, trafo=source.second, second=None, tool=None, tool_length_mm=0.0)
        chain = two_steps(chain, source.trafo, draft(second, choose, collector), source.second, collector)
    return replace(_limited(chain, source, collector), name=name, title=title)


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


def _limited(chain: Chain, source: Source, collector: Collector) -> Chain:
    """Return the chain with the limits of axis lists and overlay.

    Those of a list belong to the drive: where it stands at the axis value, to the axis, too.
    """
    behind = chain.drives.differing if chain.drives is not None else ()
    ahead = int(coupling_data()["tcp_axes"]) if source.trafo.type == COUPLING else 0
    simulated = tuple(Axis.unlimited(f"TCP axis {n}", "linear") for n in range(ahead))
    unknown = tuple(Axis.unlimited(axis.name, axis.kind) if n in behind else axis for n, axis in enumerate(chain.axes))
    listed = with_limits((*simulated, *unknown), source.channel.axes, source.axis_lists, collector)[ahead:]
    overlay = _overlay_for(chain.axes, source)
    axes = tuple(
        replace(axis, endless=listed[n].endless) if n in behind else listed[n] for n, axis in enumerate(chain.axes)
    )
    axes = overlay.apply_limits(axes, [chain.axes[n].name for n in behind])
    limits = []
    for n in behind:
        limit = DriveLimit(n)
        if (listed[n].lower, listed[n].upper) != (unknown[n].lower, unknown[n].upper) and not listed[n].endless:
            limit = DriveLimit(n, listed[n].lower, listed[n].upper)
        limit = overlay.drive_limit(axes[n], limit)
        if limit.bounded or limit.max_speed is not None:
            limits.append(limit)
    return _ranged(chain.with_axes(axes).with_drive_limits(tuple(limits)), source, collector)


def _ranged(chain: Chain, source: Source, collector: Collector) -> Chain:
    """Return the chain with the ranges that its limits leave, with findings where they leave little.

    Raises:
        MachineDataError: they leave nothing.
    """
    reached, narrowed = within_reach(chain)
    for n in narrowed:
        axis, (least, most) = chain.axes[n], (reached.axes[n].lower, reached.axes[n].upper)
        if chain.drives is not None:
            least, most = chain.drives.reach[n]
        text = f"the limits of axis {axis.name}, {axis.lower:g} to {axis.upper:g} deg, go beyond what the head reaches"
        span = source.overlay.span("limits", axis.name) if axis.name in source.overlay.limits else source.trafo.span
        reach = f"{least:.6g} to {most:.6g} deg"
        if axis.lower >= most or axis.upper <= least:
            collector.add(
                "CB433", f"the limits of axis {axis.name} leave nothing of what the head reaches", span=span,
                parameter=axis.name, permitted=reach, error=MachineDataError,
            )  # fmt: skip
        else:
            collector.add("CB432", text, span=span, parameter=axis.name, permitted=reach)
    ranged, lost = with_ranges(reached)
    for axis in (axis for axis in ranged.axes if axis.name in lost):
        span = source.overlay.span("limits", "drives", axis.name) or source.trafo.span
        if axis.widest is None:
            text = f"the limits of axis {axis.name} and those of the drives have no value in common"
            permitted = "ranges that overlap"
            collector.add("CB433", text, span=span, parameter=axis.name, permitted=permitted, error=MachineDataError)
        else:
            text = f"with the other axes in the middle the limits of the drives leave nothing of axis {axis.name}"
            collector.add("CB434", text, span=span, parameter=axis.name)
    return ranged


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
        drive_limits={name: limits for name, limits in overlay.drive_limits.items() if name in known},
        speeds={name: speed for name, speed in overlay.speeds.items() if name in known},
        drive_speeds={name: speed for name, speed in overlay.drive_speeds.items() if name in known},
        endless=tuple(name for name in overlay.endless if name in rotary),
    )
