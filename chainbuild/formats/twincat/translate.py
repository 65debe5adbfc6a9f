"""From a configured kinematic to a chain: head offsets, tool, angle mode and axis limits come together here."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Final

from chainbuild.chain.drives import DriveLimit
from chainbuild.chain.elements import Axis, Chain
from chainbuild.chain.names import channel_names, renamed
from chainbuild.convention import Choices
from chainbuild.errors import ChainbuildError, MachineDataError, UnsupportedKinematicError
from chainbuild.findings import Collector
from chainbuild.formats.overlay_poses import with_named_poses
from chainbuild.formats.overlay_sums import with_sums
from chainbuild.formats.twincat.axis_offsets import with_axis_offsets
from chainbuild.formats.twincat.coupling.coupling import coupling_draft
from chainbuild.formats.twincat.coupling.coupling_groups import (
    COUPLING,
    MULTISTEP,
    coupling_data,
    label_of,
    member_named,
    read_groups,
)
from chainbuild.formats.twincat.coupling.two_steps import two_steps
from chainbuild.formats.twincat.lists.axislist import with_limits
from chainbuild.formats.twincat.lists.config import Trafo
from chainbuild.formats.twincat.lists.source import Source
from chainbuild.formats.twincat.types.draft import serial_draft
from chainbuild.formats.twincat.universal.universal import UNIVERSAL, universal_draft
from chainbuild.kinematics.ranges import with_ranges, within_reach

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
    ahead = _axes_ahead(source, choose)
    chain = with_axis_offsets(draft(source, choose, collector), source, choose, collector)
    chain = _named(chain, ahead, source, collector)
    axes = chain.axes
    if source.second is not None:
        above = draft(source.upper(), choose, collector)
        chain = two_steps(chain, source.trafo, above, source.second, collector)
        axes = (*axes, *above.axes)
    _tell_table_sense(axes, source, choose, collector)
    chain = replace(_limited(chain, ahead, source, collector), name=name, title=title)
    chain = with_sums(chain, source.overlay, main=source.main) if source.overlay.sums else chain
    return with_named_poses(chain, source.overlay, collector) if source.main and source.overlay.poses else chain


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
    return _coupling_of(source) is not None


def _coupling_of(source: Source) -> Trafo | None:
    """Return the first coupling of the channel that names the kinematic, or None."""
    trafos = source.channel.trafos
    for coupling in (trafo for trafo in trafos if trafo.type == COUPLING):
        for key, entry in coupling.extras.items():
            if ".chain[" in key and source.trafo in member_named(label_of(entry, empty=True), trafos):
                return coupling
    return None


def _axes_ahead(source: Source, choose: Choices) -> int:
    """Return how many axes of the channel come before those of a kinematic.

    Those of a coupling come behind six simulated TCP axes; those of one of its partials alone are the same as in the
    coupling.
    """
    simulated = int(coupling_data()["tcp_axes"])
    if source.trafo.type == COUPLING:
        return simulated
    coupling = _coupling_of(source)
    if coupling is None or not (source.channel.axes or source.axis_lists):
        return 0
    ahead = simulated
    try:
        groups = read_groups(coupling, source.channel.trafos, Collector())
        for member in (member for group in groups for member in group.members):
            if member is source.trafo:
                break
            alone = replace(source, trafo=member, second=None, tool=None, tool_length_mm=0.0)
            ahead += len(draft(alone, Choices(choose.chosen), Collector()).axes)
    except ChainbuildError:
        return 0  # the coupling itself tells what is wrong with it
    return ahead


def _named(chain: Chain, ahead: int, source: Source, collector: Collector) -> Chain:
    """Return the chain with the channel's own names of its axes, as far as the list gives them."""
    listed = source.channel.axes
    given = [listed[n].name if n in listed else "" for n in range(ahead, ahead + len(chain.axes))]
    _tell_swapped([axis.name for axis in chain.axes], given, ahead, source, collector)
    names, lost = channel_names(chain.axes, given)
    for n in lost:
        generic = chain.axes[n].name
        other = next(listed[ahead + k] for k, name in enumerate(given) if name.casefold() == generic.casefold())
        parameter = f"gruppe[0].achse[{other.index}].bezeichnung"
        text = f"{other.name} is the name of another axis than {generic} of the kinematic, which is called {names[n]}"
        hint = f"name all axes: gruppe[0].achse[{ahead + n}].bezeichnung is missing"
        collector.add("CB413", text, span=other.span, parameter=parameter, hint=hint)
    return renamed(chain, names)


def _tell_swapped(
    generic: Sequence[str], given: Sequence[str], ahead: int, source: Source, collector: Collector
) -> None:
    """Note where a channel gives its axes the names that the type has, in another order."""
    written, known = [name.casefold() for name in given], [name.casefold() for name in generic]
    if written == known or sorted(written) != sorted(known):
        return
    n = next(n for n, (name, own) in enumerate(zip(written, known, strict=True)) if name != own)
    axis = source.channel.axes[ahead + n]
    text = f"the axes are called {', '.join(given)}, in another order than those of the type: {', '.join(generic)}"
    hint = "the order of the channel counts, not the names: check which drive is which"
    collector.add("CB413", text, span=axis.span, parameter=f"gruppe[0].achse[{axis.index}].bezeichnung", hint=hint)


def _limited(chain: Chain, ahead: int, source: Source, collector: Collector) -> Chain:
    """Return the chain with the limits of axis lists and overlay.

    Those of a list belong to the drive: where it stands at the axis value, to the axis, too.

    Args:
        chain: The chain.
        ahead: How many axes of the channel come before its own.
        source: Lists and overlay.
        collector: Takes findings.
    """
    behind = chain.drives.differing if chain.drives is not None else ()
    unknown = tuple(Axis.unlimited(axis.name, axis.kind) if n in behind else axis for n, axis in enumerate(chain.axes))
    listed = with_limits(unknown, source.channel.axes, source.axis_lists, collector, ahead)
    # For a kinematic that the overlay is not written for, it may name axes that only others have.
    overlay = source.overlay if source.main else source.overlay.for_axes(chain.axes)
    axes = tuple(
        replace(axis, endless=listed[n].endless) if n in behind else listed[n] for n, axis in enumerate(chain.axes)
    )
    axes = overlay.apply_limits(axes, behind)
    limits = []
    for n in behind:
        limit = DriveLimit(n)
        one_sided = (listed[n].lower, listed[n].upper) != (unknown[n].lower, unknown[n].upper)
        if (one_sided or not listed[n].assumed) and not listed[n].endless:
            limit = DriveLimit(n, listed[n].lower, listed[n].upper)
        limit = overlay.drive_limit(axes, limit)
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
        span = source.overlay.limits_span(chain.axes, n) or source.trafo.span
        reach = f"{least:.6g} to {most:.6g} deg"
        if axis.lower >= most or axis.upper <= least:
            collector.add(
                "CB433", f"the limits of axis {axis.name} leave nothing of what the head reaches", span=span,
                parameter=axis.name, permitted=reach, error=MachineDataError,
            )  # fmt: skip
        else:
            collector.add("CB432", text, span=span, parameter=axis.name, permitted=reach)
    ranged, lost = with_ranges(reached)
    for n, axis in ((n, axis) for n, axis in enumerate(ranged.axes) if axis.name in lost):
        given = (source.overlay.limits_span(ranged.axes, n, drives=drives) for drives in (True, False))
        span = next((one for one in given if one is not None), source.trafo.span)
        if axis.widest is None:
            text = f"the limits of axis {axis.name} and those of the drives have no value in common"
            permitted = "ranges that overlap"
            collector.add("CB433", text, span=span, parameter=axis.name, permitted=permitted, error=MachineDataError)
        else:
            text = f"with the other axes in the middle the limits of the drives leave nothing of axis {axis.name}"
            collector.add("CB434", text, span=span, parameter=axis.name)
    return ranged
