"""From a configured kinematic to a chain: head offsets, tool, angle mode and axis limits come together here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from chainbuild import frames
from chainbuild.chain.assemble import assemble
from chainbuild.chain.elements import Chain
from chainbuild.conventions import Choices
from chainbuild.findings import Collector
from chainbuild.overlay import Overlay
from chainbuild.twincat.axislist import AxisList, with_limits
from chainbuild.twincat.catalogue import KinType, kin_type
from chainbuild.twincat.config import Channel, RawValue, Trafo
from chainbuild.twincat.recipe import Params
from chainbuild.twincat.toollist import Tool, acting_params

DIALECT = "TwinCAT CNC"
_EULER = {"a_first": "euler_a_first", "c_first": "euler_c_first"}


@dataclass(frozen=True, slots=True)
class Source:
    """What a chain is built from.

    Attributes:
        trafo: The kinematic.
        channel: The channel that configures it.
        tool: The active tool, or None.
        tool_length_mm: Length of the tool, all sources added.
        axis_lists: Axis lists in file order.
        overlay: What the file beside the machine file adds.
    """

    trafo: Trafo
    channel: Channel
    tool: Tool | None = None
    tool_length_mm: float = 0.0
    axis_lists: Sequence[AxisList] = field(default_factory=tuple)
    overlay: Overlay = field(default_factory=Overlay)


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
    known = {row.n for row in kind.hd}
    for n in sorted(set(raw) - known):
        if raw[n]:
            text = f"HD{n} has no meaning for KIN_TYP {kind.number}; its value is left alone"
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


def translate(source: Source, name: str, title: str, conventions: Mapping[str, str], collector: Collector) -> Chain:
    """Return the chain of a kinematic.

    Args:
        source: What it is built from.
        name: File-system-safe name.
        title: Name for people.
        conventions: The user's choices.
        collector: Takes the findings of the translation.

    Raises:
        UnsupportedKinematicError: the type is unknown or not built.
        MachineDataError: a head offset is not permitted.
        ConventionError: an unknown convention or choice.
    """
    kind = kin_type(source.trafo.type, source.trafo.span)
    choose = Choices(conventions)
    params = build_params(source, kind, collector)
    recipe = kind.recipe(params, choose)
    axes = with_limits(recipe.axes or params.axes, source.channel.axes, source.axis_lists, collector)
    axes = source.overlay.apply_limits(axes)
    body = assemble(axes, recipe.tool, recipe.workpiece, recipe.axis_map)
    mode = recipe.angle_mode or _angle_mode(source.channel.angle_mode, choose, collector)
    for unused in choose.unused():
        collector.add("CB405", f"the chosen convention {unused} has no bearing on this kinematic")
    return Chain(
        name=name,
        title=title,
        dialect=DIALECT,
        kinematic=f"KIN_TYP {kind.number}",
        links=body.links,
        joints=body.joints,
        frames=body.frames,
        axes=axes,
        axis_map=body.axis_map,
        angle_mode=mode,
        task=recipe.task,
        conventions=choose.used(),
        findings=tuple(collector.findings),
    )


def _angle_mode(given: RawValue | None, choose: Choices, collector: Collector) -> str:
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
