"""A URDF as a machine: each link that could be the tool is one of its kinematics."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from chainbuild.chain.elements import Chain
from chainbuild.convention import Choices
from chainbuild.errors import MachineDataError, Span
from chainbuild.findings import Collector
from chainbuild.formats.entries import (
    Datum,
    KinematicEntry,
    ParameterRow,
    Selected,
    checked_channel,
    checked_kinematic,
    checked_values,
)
from chainbuild.formats.machine import Machine
from chainbuild.formats.overlay import Overlay
from chainbuild.formats.text import SourceText
from chainbuild.formats.urdf.data import origin_data, origin_rows, with_origins
from chainbuild.formats.urdf.joints import Joints, UrdfJoint
from chainbuild.formats.urdf.robot import moved_leaves, named_tool, urdf_chain, way_to
from chainbuild.formats.urdf.xml import Node, parse

_CHANNEL: Final = 1  # a URDF has none


class UrdfMachine(Machine):
    """A URDF file, read: the joints on the way from the root link to a tool link become a chain.

    Args:
        path: The file.
        overlay: What the file beside it adds.
        collector: Takes the findings.
        robot: The element <robot>.
        tool: Link whose frame is the tool; None: the only link without children, or the overlay's `kinematic`.

    Raises:
        ParseError: joints that are no joints, or a link with two parents.
        ChainbuildError: no joint leads to the tool.
    """

    dialect = "URDF"

    def __init__(self, path: Path, overlay: Overlay, collector: Collector, robot: Node, tool: str | None) -> None:
        self._robot, self._joints = robot, Joints(robot)
        self._tool = named_tool(tool, overlay)
        super().__init__(str(path), path, replace(overlay, kinematic=self._tool), collector)
        if self._tool is not None or not self._joints.all:
            self._way(self._tool)
        self._entries = tuple(self._listed())

    def kinematics(self) -> tuple[KinematicEntry, ...]:
        """Return the links that could be the tool: those without children behind a joint that moves, and the named."""
        return self._entries

    def parameters(
        self, kinematic: int | str | tuple[int | str, int | str] | None = None, channel: int | None = None
    ) -> tuple[ParameterRow, ...]:
        """Return the origins of the joints on the way to a tool link, with their meaning."""
        return origin_rows(self.geometry(kinematic, channel))

    def geometry(
        self, kinematic: int | str | tuple[int | str, int | str] | None = None, channel: int | None = None
    ) -> tuple[Datum, ...]:
        """Return the origins of the joints on the way to a tool link: six numbers each, mm and degrees."""
        selected = self._select(checked_kinematic(kinematic), checked_channel(channel), Collector(strict=False))
        return origin_data(self._way(selected.entry.name), _CHANNEL)

    def tool_data(
        self,
        kinematic: int | str | tuple[int | str, int | str] | None = None,
        channel: int | None = None,
        *,
        tool_length_mm: float = 0.0,
    ) -> tuple[Datum, ...]:
        """Return nothing: the tool is a link."""
        return ()

    def _tool_data(self, selected: Selected) -> Iterable[Datum]:
        return ()

    def with_values(self, values: Mapping[Datum, float]) -> UrdfMachine:
        """Return the machine with other origins of joints."""
        checked_values(values)
        if not values:
            return self
        collector = Collector(self._collector.strict, list(self._reading))
        return UrdfMachine(self.path, self.overlay, collector, with_origins(self._robot, values), self._tool)

    def trial_chain(
        self,
        kinematic: int | str | tuple[int | str, int | str] | None = None,
        channel: int | None = None,
        tool_length_mm: float = 0.0,
        conventions: Mapping[str, str] | None = None,
    ) -> Chain:
        """Translate a kinematic as `chain` does, without bodies: meshes would be read each time."""
        collector = Collector(strict=False)
        selected = self._select(checked_kinematic(kinematic), checked_channel(channel), collector)
        return urdf_chain(self._robot, self.path, selected.entry.name, self.overlay, collector, bodies=False)

    def _listed(self) -> Iterator[KinematicEntry]:
        joints = self._joints.all
        leaves = sorted({joint.child for joint in joints} - {joint.parent for joint in joints})
        moved = moved_leaves(joints, Span(self.file))
        links = dict.fromkeys([*([] if self._tool is None else [self._tool]), *moved])
        for number, link in enumerate(links, start=1):
            yield self._entry(number, link, default=link == self._tool if self._tool else len(leaves) == 1)

    def _entry(self, number: int, link: str, *, default: bool) -> KinematicEntry:
        way = self._way(link)
        title = f"{self._robot.attributes.get('name', self.path.stem)}, from {way[0].parent} to {link}"
        return KinematicEntry(number, link, self.dialect, title, _CHANNEL, default, way[-1].span)

    def _way(self, link: str | None) -> list[UrdfJoint]:
        return way_to(link, self._joints.all, Span(self.file))

    def _channel(self, wanted: int | None, collector: Collector) -> int:
        if wanted not in (None, _CHANNEL):
            text = f"there is no channel {wanted!r}: a URDF has none"
            raise MachineDataError(text, span=Span(self.file), parameter="channel", permitted="no channel")
        return _CHANNEL

    def _named(self, wanted: int | str | None, entries: Sequence[KinematicEntry]) -> KinematicEntry:
        """Return the requested tool link, also one that is not listed; None: the default."""
        known = [entry for entry in entries if wanted in (entry.name, entry.id) or (wanted is None and entry.default)]
        if known:
            return known[0]
        link = None if wanted is None else str(wanted)
        return self._entry(len(entries) + 1, self._way(link)[-1].child, default=False)

    def _is_main(self, selected: Selected) -> bool:
        """Tell that the overlay's bodies are on the chain already: their names are the file's."""
        return False

    def _translate(self, selected: Selected, tool_length_mm: float, choose: Choices, collector: Collector) -> Chain:
        if tool_length_mm:
            text = "a URDF does not say where its tool points: a tool length has no direction"
            hint = "name the link whose frame is the TCP: tool=LINK, on the command line --tool LINK"
            raise MachineDataError(text, span=Span(self.file), parameter="tool_length_mm", permitted="0", hint=hint)
        return urdf_chain(self._robot, self.path, selected.entry.name, self.overlay, collector)

    def _tell_unused(self, names: Sequence[str], asked: Mapping[str, str], collector: Collector) -> None:
        for name in names:
            collector.add("CB528", f"a URDF leaves nothing open: convention {name} has no effect", span=Span(self.file))


def read_urdf(
    source: SourceText, path: Path, overlay: Overlay, collector: Collector, tool: str | None = None
) -> UrdfMachine:
    """Read a URDF file.

    Args:
        source: Its text.
        path: Its path.
        overlay: What the file beside it adds.
        collector: Takes the findings.
        tool: Link whose frame is the tool; None: see `UrdfMachine`.

    Raises:
        ParseError: no URDF, or xacro that is not expanded.
        ChainbuildError: the tool link does not exist.
    """
    return UrdfMachine(path, overlay, collector, parse(source.text, str(path)), tool)
