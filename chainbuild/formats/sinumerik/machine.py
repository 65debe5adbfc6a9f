"""RobxMachine: a SINUMERIK machine data file with its ROBX transformations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from chainbuild.chain.assemble import assemble
from chainbuild.chain.elements import Chain
from chainbuild.chain.names import generic_name, renamed
from chainbuild.chain.programmed.display import POSE_ANGLES, Display
from chainbuild.convention import Choices
from chainbuild.errors import ChainbuildError, MachineDataError, Span
from chainbuild.findings import Collector, refuse_errors
from chainbuild.formats.entries import (
    Datum,
    KinematicEntry,
    ParameterRow,
    Selected,
    changed_overlay,
    checked_channel,
    checked_kinematic,
    checked_values,
)
from chainbuild.formats.machine import Machine
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.overlay_poses import with_named_poses
from chainbuild.formats.overlay_sums import with_sums
from chainbuild.formats.sinumerik.geometry.robot_axes import basic_moves
from chainbuild.formats.sinumerik.geometry.tool import Tool, active_data, tools_of_channels
from chainbuild.formats.sinumerik.geometry.translate import translate
from chainbuild.formats.sinumerik.parameters import geometry_data, parameter_rows, tool_data
from chainbuild.formats.sinumerik.reading.catalogue import catalogue
from chainbuild.formats.sinumerik.reading.data_table import DataTable, DatumKey, tabulate, with_values
from chainbuild.formats.sinumerik.reading.reader import read_assignments
from chainbuild.formats.sinumerik.reading.robx import WRISTS, Robx
from chainbuild.formats.sinumerik.reading.transformations import find_transformations
from chainbuild.formats.sinumerik.rules.arms import check_geometry
from chainbuild.formats.sinumerik.rules.axes import check_axes, check_axis_names, check_gripper
from chainbuild.formats.sinumerik.rules.chain_data import (
    absolute_c,
    check_pose_data,
    constraints,
    controller_solver,
    machine_axes,
    singularity_watch,
    warn_of_orphans,
)
from chainbuild.formats.text import SourceText

GRIPPER = "gripper"
_NAMES = {
    "SS": "Gantry",
    "CC": "SCARA",
    "NR": "Articulated arm",
    "SC": "SCARA on two linear axes",
    "RR": "Arm with two rotary and one linear axis",
    "CS": "Cylindrical arm",
    "NN": "Arm with three rotary axes",
}


@dataclass(frozen=True, slots=True)
class _Configured:
    """An entry of the machine with its transformation.

    Attributes:
        entry: The entry.
        robx: The transformation.
        gripper: True for gripper-referred motion.
    """

    entry: KinematicEntry
    robx: Robx
    gripper: bool

    @property
    def listed(self) -> bool:
        """Whether the machine lists it: gripper-referred motion needs six axes and no rotary additional ones."""
        robx = self.robx
        return not self.gripper or (robx.num_axes == 6 and not robx.table.axes and not robx.flange.axes)


class RobxMachine(Machine):
    """A SINUMERIK machine data file, read and typed.

    Attributes:
        table: All data of the file.
        transformations: The ROBX and TE4 transformations, in the order of channels and data sets.
        tools: The active tool of each channel.
    """

    dialect = "SINUMERIK ROBX"

    def __init__(
        self,
        path: Path,
        overlay: Overlay,
        collector: Collector,
        table: DataTable,
        transformations: tuple[Robx, ...],
        tools: Mapping[int, Tool],
    ) -> None:
        super().__init__(table.reading.file, path, overlay, collector)
        self.table = table
        self.transformations = transformations
        self.tools = tools
        self._configured = tuple(one for robx in transformations for one in _entries(robx, robx is transformations[0]))

    def kinematics(self) -> tuple[KinematicEntry, ...]:
        """Return the transformations; each six-axis one without rotary additional axes also as "gripper"."""
        return tuple(one.entry for one in self._configured if one.listed)

    def parameters(
        self, kinematic: int | str | tuple[int | str, int | str] | None = None, channel: int | None = None
    ) -> tuple[ParameterRow, ...]:
        """Return every datum of a transformation with value, meaning and source."""
        robx = self.transformation(kinematic, channel)
        return parameter_rows(robx, self.tool(robx), Choices(self.overlay.conventions))

    def geometry(
        self, kinematic: int | str | tuple[int | str, int | str] | None = None, channel: int | None = None
    ) -> tuple[Datum, ...]:
        """Return lengths, angles and directions of a transformation, element by element."""
        return geometry_data(self.transformation(kinematic, channel), Choices(self.overlay.conventions))

    def with_values(self, values: Mapping[Datum, float]) -> RobxMachine:
        """Return the machine with other values of some data."""
        checked_values(values)
        te4 = {robx.data.channel_number for robx in self.transformations if robx.data.te4}
        changed: dict[DatumKey, tuple[float, Span]] = {
            (one.channel, one.channel in te4 and not isinstance(one.key[1], tuple), *one.key): (
                value,
                one.span or Span(self.file),
            )
            for one, value in values.items()
            if one.key[0] in catalogue()
        }
        table, overlay = with_values(self.table, changed), changed_overlay(self.overlay, values)
        collector = Collector(self._collector.strict, list(self._reading))
        transformations = find_transformations(table, Collector(strict=False))
        tools = tools_of_channels(table, list(self.tools), overlay, Collector(strict=False))
        return RobxMachine(self.path, overlay, collector, table, transformations, tools)

    def _tool_data(self, selected: Selected) -> Iterator[Datum]:
        rows, own = active_data(self.table, self.overlay, selected.entry.channel)
        return tool_data(rows, own, self.overlay)

    def transformation(
        self, kinematic: int | str | tuple[int | str, int | str] | None = None, channel: int | None = None
    ) -> Robx:
        """Return the typed data of a transformation; `control` holds motion limits and the iteration's budget."""
        selected = self._select(checked_kinematic(kinematic), checked_channel(channel), Collector())
        return self._found(selected.entry).robx

    def tool(self, robx: Robx) -> Tool:
        """Return the active tool of a transformation's channel."""
        return self.tools[robx.data.channel_number]

    def examine(self) -> None:
        """Check every transformation with the overlay's conventions; `chain` returns what is built here.

        Raises:
            ChainbuildError: what the controller would refuse; a lenient machine keeps it in `findings`.
        """
        for one in self._configured:
            if one.gripper:
                continue
            collector = Collector(self._collector.strict)
            try:
                self._translated(Selected(one.entry), 0.0, self.overlay.conventions, collector)
            except ChainbuildError as error:
                if collector.strict:
                    raise
                collector.add_error(error)
            self._note(collector.findings)

    def _found(self, entry: KinematicEntry) -> _Configured:
        return next(one for one in self._configured if one.entry is entry)

    def _channel(self, wanted: int | None, collector: Collector) -> int:
        channels = sorted({robx.data.channel_number for robx in self.transformations})
        if wanted is None:
            if len(channels) > 1:
                text = f"channels {', '.join(map(str, channels))} have transformations; channel {channels[0]} is taken"
                collector.add("CB340", text, span=Span(self.file))
            return channels[0] if channels else 1
        if wanted not in channels:
            text = f"channel {wanted!r} has no ROBX transformation"
            permitted = ", ".join(map(str, channels))
            raise MachineDataError(text, span=Span(self.file), parameter="channel", permitted=permitted)
        return wanted

    def _named(self, wanted: int | str | None, entries: Sequence[KinematicEntry]) -> KinematicEntry:
        """Return the requested entry; "gripper" is the channel's first transformation, possible or not."""
        if wanted == GRIPPER and entries:
            robx = self._found(entries[0]).robx
            return next(one.entry for one in self._configured if one.robx is robx and one.gripper)
        return super()._named(wanted, entries)

    def _tell_unused(self, names: Sequence[str], asked: Mapping[str, str], collector: Collector) -> None:
        """Note what was chosen for this chain only: the overlay's choices serve all transformations of a file."""
        for name in names:
            if name in asked:
                text = f"this kinematic does not use the convention {name}"
                collector.add("CB339", text, span=Span(self.file))

    def _translate(self, selected: Selected, tool_length_mm: float, choose: Choices, collector: Collector) -> Chain:
        if self.table.reading.refused:
            refuse_errors(self._reading)  # refused data would appear as missing
        found = self._found(selected.entry)
        check_axes(found.robx, self.table, collector)
        refuse_errors(collector.findings)  # a chain needs axes that do not contradict each other
        chain = _build(self, found.robx, tool_length_mm, found.gripper, choose, collector)
        poses = self.overlay.poses and self._has_poses(selected.entry)
        return with_named_poses(chain, self.overlay, collector) if poses else chain

    def _has_poses(self, entry: KinematicEntry) -> bool:
        """Return whether the overlay's poses are those of a kinematic: of its transformation or the default one."""
        named = self.overlay.kinematic
        if isinstance(named, int):
            return entry.id == named
        return any(one.default and one.id == entry.id for one in self._entries_of(entry.channel))


def read_machine(source: SourceText, path: Path, overlay: Overlay, collector: Collector) -> RobxMachine:
    """Read a SINUMERIK machine data file.

    Args:
        source: Its text.
        path: Its path.
        overlay: What the file beside it adds.
        collector: Takes the findings; a strict one raises at the first error.

    Raises:
        ChainbuildError: syntax, range, or data that the controller would refuse.
    """
    reading = read_assignments(source, collector)
    table = tabulate(reading, collector)
    check_axis_names(table, collector)
    # Refused data would appear as missing: the rest is not checked.
    transformations = find_transformations(table, Collector(strict=False) if reading.refused else collector)
    warn_of_orphans(table, transformations, collector)
    channels = list(dict.fromkeys(robx.data.channel_number for robx in transformations)) or [1]
    tools = tools_of_channels(table, channels, overlay, collector)
    machine = RobxMachine(path, overlay, collector, table, transformations, tools)
    if not reading.refused:
        machine.examine()
    return machine


def _entries(robx: Robx, default: bool) -> tuple[_Configured, _Configured]:
    """Return a transformation as it is and gripper-referred."""
    number, channel = robx.transformation, robx.data.channel_number
    span = robx.data.span(f"TRAFO_TYPE_{number}")
    wrist = WRISTS.get(robx.wrist, f"wrist type {robx.wrist}")
    title = f"{_NAMES[robx.arrangement]} ({robx.arrangement}), {robx.num_axes} axes, {wrist}"
    entry = KinematicEntry(number, robx.package, robx.type_text, title, channel, default, span)
    gripper = replace(entry, name=GRIPPER, title=f"{title}, gripper-referred", default=False)
    return _Configured(entry, robx, False), _Configured(gripper, robx, True)


# Angles that robots with fewer axes than six are programmed by (ROBX manual 5.3.19, 6.1.3); the others follow.
_DISPLAYS: Final = {4: Display(columns=("c_deg",)), 5: Display(columns=("a_deg", "b_deg"))}


def _build(
    machine: RobxMachine, robx: Robx, tool_length_mm: float, gripper: bool, choose: Choices, collector: Collector
) -> Chain:
    if gripper:
        check_gripper(robx, choose, collector)
    translation = translate(robx, machine.tool(robx), tool_length_mm, gripper, choose)
    check_geometry(robx, translation, machine.tool(robx), choose, collector)
    basic = basic_moves(translation.basic)
    axes = machine_axes(robx, machine.table, translation.internal, basic, gripper, collector)
    named = machine.overlay.apply_limits(axes)
    # Recipes and sums of axes go by the generic names; the chain gets the channel's at the end.
    axes = tuple(replace(axis, name=generic_name(axis), generic="") for axis in named)
    check_pose_data(robx, translation, axes, choose, collector)
    body = assemble(axes, translation.tool, translation.workpiece)
    chain = Chain(
        name=_chain_name(machine, robx, gripper),
        title=f"{machine.title}, gripper-referred" if gripper else machine.title,
        dialect=machine.dialect,
        kinematic=f"{robx.package} {robx.arrangement}",
        links=body.links,
        joints=body.joints,
        frames=body.frames,
        axes=axes,
        axis_map=body.axis_map,
        angle_mode="orirpy2" if robx.tool_dir == 1 else "orirpy",
        task="direction" if robx.num_axes == 5 else "pose",
        constraints=constraints(robx, translation, axes, choose),
        absolute_c=absolute_c(robx, translation, axes, choose, collector),
        tool_axis="z" if robx.tool_dir == 1 else "x",
        follows_c=robx.num_axes == 4,
        controller_solver=controller_solver(robx, translation, axes),
        singularity_watch=singularity_watch(robx, choose),
        display=_DISPLAYS.get(robx.num_axes, POSE_ANGLES),
    )
    chain = renamed(chain, [axis.name for axis in named])
    return with_sums(chain, machine.overlay) if machine.overlay.sums else chain


def _chain_name(machine: RobxMachine, robx: Robx, gripper: bool) -> str:
    """Return the machine's name, with channel and data set behind it for all but the file's first transformation."""
    here = f"_channel{robx.data.channel_number}_trafo{robx.transformation}"
    first = robx is machine.transformations[0]
    return f"{machine.name}{'' if first else here}{'_gripper' if gripper else ''}"
