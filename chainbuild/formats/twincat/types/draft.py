"""Chains of catalogued types before limits and names are known: what partials and whole machines have in common."""

from __future__ import annotations

from typing import Final

from chainbuild import frames
from chainbuild.chain.assemble import assemble
from chainbuild.chain.elements import Chain
from chainbuild.chain.programmed.vectors import VectorProgramming, check_condition
from chainbuild.convention import Choices
from chainbuild.errors import ChainbuildError, ConventionError
from chainbuild.findings import Collector
from chainbuild.formats.twincat.lists.config import Orientation, RawValue
from chainbuild.formats.twincat.lists.counts import check_param_counts
from chainbuild.formats.twincat.lists.source import DIALECT, Source
from chainbuild.formats.twincat.lists.toollist import acting_params
from chainbuild.formats.twincat.recipes.arms import check_arm_magnitudes, check_tilt
from chainbuild.formats.twincat.recipes.recipe import Params
from chainbuild.formats.twincat.types.catalogue import KinType, kin_type
from chainbuild.formats.twincat.types.displays import display_of

SIX_AXIS_ARM: Final = 45  # the KIN_TYP of the manual on #ORI MODE
_EULER: Final = {"a_first": "euler_a_first", "c_first": "euler_c_first"}


def build_params(source: Source, kind: KinType, collector: Collector) -> Params:
    """Return the head offsets of a kinematic with the tool's added, by number.

    Raises:
        MachineDataError: the tool cannot act on this kinematic.
    """
    raw: dict[int, float] = {}
    entries: dict[int, RawValue] = {}
    for params in (acting_params(source.tool, source.trafo, collector), source.trafo.params):
        for k, entry in params.items():
            raw[k + 1] = raw.get(k + 1, 0.0) + entry.value
            entries[k + 1] = entry
    check_param_counts(acting_params(source.tool, source.trafo, Collector(strict=False)), kind.number, collector)
    known = {row.n for row in kind.hd}
    for n in sorted(set(raw) - known):
        if raw[n]:
            text = f"HD{n} has no meaning for KIN_TYP {kind.number}; its value is ignored"
            collector.add("CB403", text, span=entries[n].span, parameter=entries[n].name)
    return Params(
        data=kind.data,
        raw=raw,
        spans={n: entry.span for n, entry in entries.items()},
        tool_length_mm=source.tool_length_mm,
        tool_radius_mm=source.tool.radius_mm if source.tool else 0.0,
        span=source.trafo.span,
        collector=collector,
    )


def serial_draft(source: Source, choose: Choices, collector: Collector) -> Chain:
    """Return the chain of a type of the catalogue, its axes without limits.

    Raises:
        UnsupportedKinematicError: the type is unknown or not built.
        MachineDataError: a head offset is not permitted.
        ConventionError: a convention without default is not chosen.
    """
    kind = kin_type(source.trafo.type, source.trafo.span)
    params = build_params(source, kind, collector)
    try:
        recipe = kind.recipe(params, choose)
    except ConventionError as error:
        error.span = error.span or params.span  # a convention without default: what asks for it is this kinematic
        raise
    check_arm_magnitudes(params)
    check_tilt(params)
    axes = recipe.axes or params.axes
    mode = recipe.angle_mode or angle_mode(source.channel.angle_mode, choose, collector)
    vectors = None
    if kind.number == SIX_AXIS_ARM:
        vectors = _vectors(source.channel.orientation, mode, choose, collector)
    body = assemble(axes, recipe.tool, recipe.workpiece, recipe.axis_map, recipe.branches)
    return Chain(
        name=draft_name(source),
        title=source.trafo.name or kind.title,
        dialect=DIALECT,
        kinematic=f"KIN_TYP {kind.number}",
        links=body.links,
        joints=body.joints,
        frames=body.frames,
        axes=axes,
        axis_map=body.axis_map,
        angle_mode=mode,
        task=recipe.task,
        display=display_of(params, axes, mode, choose),
        vectors=vectors,
        drives=recipe.drives,
        loops=recipe.loops,
    )


def _vectors(given: Orientation, mode: str, choose: Choices, collector: Collector) -> VectorProgramming:
    """Return how vectors are programmed; a condition that does not go with every vector leaves a finding.

    The chain is built all the same: nothing depends on it before a program turns vectors on.
    """
    how = VectorProgramming(given.mode, given.fixed, given.plane, "z" if choose["ori_vector_axis"] == "z" else "x")
    try:
        check_condition(how, mode)
    except ChainbuildError as error:
        span = given.spans.get("fixed_axis_index" if how.fixed else "tool_ax_in_plane")
        collector.add(
            "CB414", error.message, span=span, parameter=error.parameter, permitted=error.permitted, hint=error.hint
        )
    return how


def draft_name(source: Source) -> str:
    """Return what a kinematic is called among others of its file."""
    return source.trafo.name or f"kin_{source.trafo.id}"


def angle_mode(given: RawValue | None, choose: Choices, collector: Collector) -> str:
    """Return the name of P-CHAN-00112's angle mode; the default is 0, yaw-pitch-roll."""
    number = int(given.value) if given else 0
    span = given.span if given else None
    if number == 1:
        return _EULER[choose["euler_letters"]]
    if number == -1:
        text = "ori_rotation_angle is -1: angles pass through unchanged; poses are shown as yaw-pitch-roll (mode 0)"
        collector.add("CB408", text, span=span)
    elif number not in frames.ANGLE_MODE_NUMBERS:
        text = f"ori_rotation_angle {number} is meant for KIN_TYP 91; poses are shown as yaw-pitch-roll (mode 0)"
        collector.add("CB409", text, span=span)
    return frames.ANGLE_MODE_NUMBERS.get(number, "ypr")
