"""KIN_TYP 210, the coupling kinematic: partial kinematics stacked in groups, one group at the workpiece of another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from chainbuild import frames
from chainbuild.arrays import Matrix
from chainbuild.chain.compose import beside, displaced, follow, stack
from chainbuild.chain.elements import Chain, Partial
from chainbuild.convention import Choices
from chainbuild.errors import MachineDataError
from chainbuild.findings import Collector
from chainbuild.formats.twincat.coupling.coupling_axes import Place, check_angle_mode, check_axes
from chainbuild.formats.twincat.coupling.coupling_groups import (
    COUPLING,
    NO_TOOL_MEMBER,
    Group,
    coupling_data,
    coupling_error,
    read_groups,
)
from chainbuild.formats.twincat.lists.config import Trafo
from chainbuild.formats.twincat.lists.source import Source
from chainbuild.formats.twincat.types.catalogue import catalogue, kin_type
from chainbuild.formats.twincat.types.displays import by_angles
from chainbuild.formats.twincat.types.draft import draft_name, serial_draft
from chainbuild.formats.twincat.universal.universal import UNIVERSAL, universal_draft
from chainbuild.units import deg_from_raw, m_from_mm, mm_from_m, mm_from_tenth_um

_REST: Final = "CBA"  # letters that a universal kinematic does not have come last
_OPEN: Final = "kin210_base_offset"


def coupling_draft(source: Source, choose: Choices, collector: Collector) -> Chain:
    """Return the chain of a coupling: the real axes, group by group, its axes without limits.

    The tool frame is that of the first group; where it names a workpiece_cs, its workpiece frame rides on the tool
    frame of the other group.

    Raises:
        MachineDataError: the configuration is one that the controller refuses.
    """
    groups = read_groups(source.trafo, source.channel.trafos, collector)
    return _Building(source, choose, collector, groups).run()


@dataclass(slots=True)
class _Building:
    """A coupling while its chain is built."""

    source: Source
    choose: Choices
    collector: Collector
    groups: tuple[Group, ...]

    def run(self) -> Chain:
        self.check_tool()
        chains = [self.stacked(group) for group in self.groups]
        chain = chains[0]
        for group, other in zip(self.groups[1:], chains[1:], strict=True):
            if self.groups[0].workpiece == group.index:
                chain = follow(chain, workpiece_of=other)
                continue
            chain = beside(chain, other)
            if group.workpiece is not None:
                text = f"group {group.label} follows group {self.groups[0].label}; the TCP is that of the first group"
                hint = f"its own tool frame is {self.name(group.members[-1])}_tool"
                self.collector.add("CB458", text, span=self.source.trafo.span, hint=hint)
        self.check_channel(chain)
        types = " + ".join(str(member.type) for group in self.groups for member in group.members)
        return replace(
            chain,
            name=draft_name(self.source),
            title=self.source.trafo.name or "Coupling kinematic",
            kinematic=f"KIN_TYP {COUPLING} ({types})",
            partials=self.ranked(chain),
            display=by_angles(chain.angle_mode),
        )

    def stacked(self, group: Group) -> Chain:
        lower: Chain | None = None
        for member in group.members:
            chain, T = self.partial(group, member), self.base(group, member)
            lower = displaced(chain, T) if lower is None else stack(lower, T, chain)
        assert lower is not None  # a group has members
        return lower

    def partial(self, group: Group, member: Trafo) -> Chain:
        """Return the chain of a member; the tool is clamped to one of them only."""
        holder = member is self.tool_member()
        source = replace(
            self.source,
            trafo=member,
            tool=self.source.tool if holder else None,
            tool_length_mm=self.source.tool_length_mm if holder else 0.0,
        )
        if member.type != UNIVERSAL:
            return serial_draft(source, self.choose, self.collector)
        return universal_draft(source, self.choose, self.collector, member=True, table=self.is_read_backwards(group))

    def is_read_backwards(self, group: Group) -> bool:
        followed = any(other.workpiece == group.index for other in self.groups)
        return followed and self.choose["kin210_table_frame"] == "inverse"

    def base(self, group: Group, member: Trafo) -> Matrix:
        """Return a member's coordinate system in the tool frame below it [m]."""
        raw = member.numbers("base", 6)
        if not any(raw):
            return np.eye(4)
        position = [m_from_mm(mm_from_tenth_um(value)) for value in raw[:3]]
        rotation = self.base_rotation(group, member, [deg_from_raw(value) for value in raw[3:]])
        T = frames.transform(rotation, position)
        if self.choose[_OPEN] == "carrier_seen_from_mcs":
            T = frames.inverse(T)
        if _OPEN not in self.choose.chosen:
            below = group.members[group.members.index(member) - 1] if member is not group.members[0] else None
            seen = "the MCS of the coupling" if below is None else f"the TCP frame of {self.name(below)}"
            x, y, z = (round(mm_from_m(float(value)), 4) + 0.0 for value in T[:3, 3])
            text = (
                f"the direction in which the basic offset of {self.name(member)} counts is open; as read, its MCS is at"
            )
            hint = f"check convention {_OPEN}: {self.choose[_OPEN]} is used"
            entry = next(e for key, e in member.extras.items() if key.startswith("base["))
            self.collector.add(
                "CB454", f"{text} X {x:g}, Y {y:g}, Z {z:g} mm in {seen}", span=entry.span,
                parameter=f"{member.prefix}.base", hint=hint,
            )  # fmt: skip
        return T

    def base_rotation(self, group: Group, member: Trafo, angles: Sequence[float]) -> Matrix:
        if not any(angles):
            return np.eye(3)
        sequence = str(coupling_data()["partials"][str(member.type)])
        if self.choose["kin210_base_rotation"] == "c_b_a":
            sequence = "CBA"
        if sequence == "angle_mode":
            return frames.matrix_from_angles(self.partial(group, member).angle_mode, angles)
        if sequence == "axes":
            sequence = self.axis_sequence(member)
        turns = dict(zip("ABC", angles, strict=True))
        rotations = {"A": frames.rot_x, "B": frames.rot_y, "C": frames.rot_z}
        result = np.eye(3)
        for letter in sequence:
            result = result @ rotations[letter](turns[letter])
        return result

    def axis_sequence(self, member: Trafo) -> str:
        """Return the letters of the rotary axes of a universal kinematic in the order of its chain."""
        return "".join(dict.fromkeys([*self.universal_letters(member), *_REST]))

    def universal_letters(self, member: Trafo) -> str:
        source = replace(self.source, trafo=member, tool=None, tool_length_mm=0.0)
        chain = universal_draft(source, self.choose, Collector(), member=True)
        return "".join(joint.name[0] for joint in chain.joints if joint.kind == "revolute")

    def tool_member(self) -> Trafo:
        """Return the member that the tool is clamped to: the one it names, else the last of the first group."""
        name = self.source.tool.kin_name if self.source.tool else ""
        members = [member for group in self.groups for member in group.members]
        return next((m for m in members if name and name == m.name), self.groups[0].members[-1])

    def check_tool(self) -> None:
        tool = self.source.tool
        if tool is None or not tool.kin_name:
            return
        names = [member.name for group in self.groups for member in group.members]
        if tool.kin_name not in names:
            raise coupling_error(
                NO_TOOL_MEMBER,
                f"tool {tool.number} names the unknown partial kinematic {tool.kin_name}",
                span=tool.span, parameter=f"wz[{tool.number}].kin_name", permitted=", ".join(filter(None, names)),
            )  # fmt: skip

    def check_channel(self, chain: Chain) -> None:
        """Check order and kind of the channel's axes, and its angle mode against RTCP partials that carry the TCP."""
        members = [member for group in self.groups for member in group.members]
        letters = [coordinate_letters(m.type, p.chain) for m, p in zip(members, chain.partials, strict=True)]
        places = [Place(self.name(member), of) for member, of in zip(members, letters, strict=True)]
        check_axes(self.source, places, self.collector)
        for member in self.groups[0].members:
            if is_rtcp(member):
                rotary = self.rotary_letters(member)
                check_angle_mode(self.name(member), rotary, self.source.channel, member.span, self.collector)

    def rotary_letters(self, member: Trafo) -> str:
        """Return the letters of a member's rotary axes, in the order of its chain."""
        if member.type == UNIVERSAL:
            return self.universal_letters(member)
        return "".join(axis.name[0] for axis in kin_type(member.type).axes if axis.kind == "rotary")

    def ranked(self, chain: Chain) -> tuple[Partial, ...]:
        """Return the partials with their ranks and locked coordinates."""
        ranks = [rank for group in self.groups for rank in group.priority]
        members = [member for group in self.groups for member in group.members]
        locks = self.locks(chain)
        return tuple(
            replace(
                partial,
                name=self.name(member),
                rank=rank,
                locked=locks.get(n, ()),
                letters=coordinate_letters(member.type, partial.chain),
            )
            for n, (partial, member, rank) in enumerate(zip(chain.partials, members, ranks, strict=True))
        )

    def locks(self, chain: Chain) -> Mapping[int, tuple[str, ...]]:
        """Return the coordinates that lock_dof locks, by partial.

        Its index is that of an axis of the channel: six TCP axes, then the axes of each partial, which represent
        its coordinates while the coupling is active.
        """
        found: dict[int, tuple[str, ...]] = {}
        members = [member for group in self.groups for member in group.members]
        ahead = int(coupling_data()["tcp_axes"])
        for k, entry in self.source.trafo.indexed("lock_dof").items():
            if entry.integer(0, 1) == 0:
                continue
            axis = k - ahead
            n = next((n for n, p in enumerate(chain.partials) if 0 <= axis - p.first_axis < len(p.chain.axes)), None)
            if n is None:
                last = ahead + len(chain.axes) - 1
                raise MachineDataError(
                    f"{entry.name} is not an axis of a partial kinematic", span=entry.span, parameter=entry.name,
                    permitted=f"{ahead} to {last}", code="CB455",
                )  # fmt: skip
            partial = chain.partials[n]
            letter = coordinate_letters(members[n].type, partial.chain)[axis - partial.first_axis]
            found[n] = (*found.get(n, ()), letter)
        return found

    def name(self, member: Trafo) -> str:
        return member.name or f"kin_{member.id}"


def is_rtcp(trafo: Trafo) -> bool:
    """Return whether a kinematic is programmed by its machine angles; of one given as a list its list says so."""
    known = catalogue().get(trafo.type)
    if known is None or known.orientation != "listed":
        return known is not None and known.orientation == "rtcp"
    entry = trafo.extras.get("rtcp")
    return entry is not None and bool(entry.number())


def coordinate_letters(kin_typ: int, chain: Chain) -> str:
    """Return which Cartesian coordinate each axis of a partial stands for while the coupling is active."""
    by_type: Mapping[str, str] = coupling_data()["coordinates"]
    return by_type.get(str(kin_typ)) or "".join(axis.name[0] for axis in chain.axes)
