"""RobxMachine: a SINUMERIK machine data file with its ROBX transformations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from chainbuild.chain.assemble import assemble
from chainbuild.chain.elements import Chain
from chainbuild.convention import Choices
from chainbuild.errors import ChainbuildError, MachineDataError, Span
from chainbuild.findings import Collector
from chainbuild.formats.machine import (
    KinematicEntry,
    Machine,
    ParameterRow,
    blame_channel,
    checked_channel,
    checked_kinematic,
    choose_kinematic,
    finite_length_mm,
)
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.sinumerik.geometry.main_axes import basic_moves
from chainbuild.formats.sinumerik.geometry.tool import Tool
from chainbuild.formats.sinumerik.geometry.tool_data import active_tool
from chainbuild.formats.sinumerik.geometry.translate import translate
from chainbuild.formats.sinumerik.parameters import parameter_rows
from chainbuild.formats.sinumerik.reading.data_table import DataTable, tabulate
from chainbuild.formats.sinumerik.reading.reader import read_assignments
from chainbuild.formats.sinumerik.reading.robx import WRISTS, Robx
from chainbuild.formats.sinumerik.reading.transformations import find_transformations
from chainbuild.formats.sinumerik.rules.arms import check_geometry
from chainbuild.formats.sinumerik.rules.axes import check_axes, check_gripper
from chainbuild.formats.sinumerik.rules.limits import machine_axes, warn_of_orphans
from chainbuild.formats.sinumerik.rules.pose_data import absolute_c, check_pose_data, constraints, controller_solver
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


class RobxMachine(Machine):
    """A SINUMERIK machine data file, read and typed.

    Attributes:
        table: All data of the file.
        transformations: The ROBX and TE4 transformations, in the order of channels and data sets.
        tool: The active tool.
    """

    dialect = "SINUMERIK ROBX"

    def __init__(
        self,
        path: Path,
        overlay: Overlay,
        collector: Collector,
        table: DataTable,
        transformations: tuple[Robx, ...],
        tool: Tool,
    ) -> None:
        super().__init__(path, overlay, collector)
        self.table = table
        self.transformations = transformations
        self.tool = tool
        self._reading_findings = tuple(collector.findings)

    def kinematics(self) -> tuple[KinematicEntry, ...]:
        """Return the transformations; each six-axis one without rotary additional axes also as "gripper"."""
        entries: list[KinematicEntry] = []
        for robx in self.transformations:
            number, channel = robx.transformation, robx.data.channel_number
            span = robx.data.span(f"TRAFO_TYPE_{number}")
            wrist = WRISTS.get(robx.wrist, f"wrist type {robx.wrist}")
            title = f"{_NAMES[robx.arrangement]} ({robx.arrangement}), {robx.num_axes} axes, {wrist}"
            entry = KinematicEntry(number, robx.package, robx.type_text, title, channel, not entries, span)
            entries.append(entry)
            if robx.num_axes == 6 and not robx.table.axes and not robx.flange.axes:
                entries.append(replace(entry, name=GRIPPER, title=f"{title}, gripper-referred", default=False))
        return tuple(entries)

    def parameters(self, kinematic: int | str | None = None, channel: int | None = None) -> tuple[ParameterRow, ...]:
        """Return every datum of a transformation with value, meaning and source."""
        return parameter_rows(self.transformation(kinematic, channel), self.tool, Choices(self.overlay.conventions))

    def transformation(self, kinematic: int | str | None = None, channel: int | None = None) -> Robx:
        """Return the typed data of a transformation; `control` holds motion limits and the iteration's budget."""
        return self._choose(kinematic, channel, Collector())[0]

    def chain(
        self,
        kinematic: int | str | None = None,
        channel: int | None = None,
        tool_length_mm: float = 0.0,
        conventions: Mapping[str, str] | None = None,
    ) -> Chain:
        """Translate a transformation; see `Machine.chain`. The kinematic "gripper" is gripper-referred motion."""
        self._refuse_if_faulty()
        length_mm = finite_length_mm(tool_length_mm) + self.overlay.tool_length_mm
        collector = Collector(strict=True)
        robx, gripper = self._choose(kinematic, channel, collector)
        choose = Choices(self.chosen_conventions(conventions))
        check_axes(robx, self.table, collector)
        chain = _build(self, robx, length_mm, gripper, choose, collector)
        for name in choose.unused():
            if name in (conventions or {}):
                text = f"this kinematic does not use the convention {name}"
                collector.add("CB339", text, span=Span(self.table.reading.file))
        found = dict.fromkeys((*self._reading_findings, *collector.findings))
        return replace(chain, conventions=choose.used(), findings=tuple(found))

    def _refuse_if_faulty(self) -> None:
        """Raise the first error that the lenient door has let through."""
        for finding in self._collector.findings:
            if finding.severity == "error":
                raise MachineDataError(
                    finding.text,
                    span=finding.span,
                    parameter=finding.parameter,
                    permitted=finding.permitted,
                    alarm=finding.alarm,
                    hint=finding.hint,
                    code=finding.code,
                )

    def _choose(self, kinematic: int | str | None, channel: int | None, collector: Collector) -> tuple[Robx, bool]:
        """Return the transformation wanted and whether it is wanted gripper-referred."""
        file = self.table.reading.file
        kinematic, channel = checked_kinematic(kinematic), checked_channel(channel)
        wanted = self.overlay.kinematic if kinematic is None else kinematic
        channels = sorted({robx.data.channel_number for robx in self.transformations})
        if channel is None:
            channel = channels[0] if channels else 1
            if len(channels) > 1:
                text = f"channels {', '.join(map(str, channels))} have transformations; channel {channel} is taken"
                collector.add("CB340", text, span=Span(file))
        elif channel not in channels:
            text = f"channel {channel!r} has no ROBX transformation"
            permitted = ", ".join(map(str, channels))
            raise MachineDataError(text, span=Span(file), parameter="channel", permitted=permitted)
        here = [robx for robx in self.transformations if robx.data.channel_number == channel]
        if wanted == GRIPPER and here:
            return here[0], True
        entries = [entry for entry in self.kinematics() if entry.channel == channel]
        try:
            number = choose_kinematic(entries, wanted, file).id
        except MachineDataError as error:
            blame_channel(error, self.kinematics(), wanted, channel)
            raise error if kinematic is not None else self.overlay.blamed(error, "kinematic") from None
        return next(robx for robx in here if robx.transformation == number), False


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
    # Data that were refused would show as missing: no judgement on what is left.
    transformations = find_transformations(table, Collector(strict=False) if reading.refused else collector)
    warn_of_orphans(table, transformations, collector)
    tool = active_tool(table, overlay, collector)
    machine = RobxMachine(path, overlay, collector, table, transformations, tool)
    if not reading.refused:
        for robx in transformations:
            _examine(machine, robx, collector)
    return machine


def _examine(machine: RobxMachine, robx: Robx, collector: Collector) -> None:
    """Judge one transformation with the overlay's conventions."""
    own = Collector(strict=collector.strict)
    check_axes(robx, machine.table, own)
    if not any(finding.severity == "error" for finding in own.findings):
        try:
            _build(machine, robx, 0.0, False, Choices(machine.overlay.conventions), own)
        except ChainbuildError as error:
            if collector.strict:
                raise
            own.add_error(error)
    collector.findings.extend(finding for finding in own.findings if finding not in collector.findings)


def _build(
    machine: RobxMachine, robx: Robx, tool_length_mm: float, gripper: bool, choose: Choices, collector: Collector
) -> Chain:
    if gripper:
        check_gripper(robx, collector, asked=True)
    translation = translate(robx, machine.tool, tool_length_mm, gripper, choose)
    check_geometry(robx, translation, machine.tool, choose, collector)
    basic = basic_moves(translation.basic)
    axes = machine_axes(robx, machine.table, translation.internal, basic, gripper, collector)
    axes = machine.overlay.apply_limits(axes)
    check_pose_data(robx, translation, axes, collector)
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
        absolute_c=absolute_c(robx, translation, axes, choose),
        tool_axis="z" if robx.tool_dir == 1 else "x",
        follows_c=robx.num_axes == 4,
        controller_solver=controller_solver(robx, translation, axes),
    )
    return machine.overlay.apply_geometry(chain)


def _chain_name(machine: RobxMachine, robx: Robx, gripper: bool) -> str:
    """Return the machine's name, with channel and data set behind it for all but the file's first transformation."""
    here = f"_channel{robx.data.channel_number}_trafo{robx.transformation}"
    first = robx is machine.transformations[0]
    return f"{machine.name}{'' if first else here}{'_gripper' if gripper else ''}"
