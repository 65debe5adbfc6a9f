"""KIN_TYP 210 as its list gives it: groups, their members, priorities and locks, checked as the controller does.

Members and groups are named by name in older builds of the controller, by id in newer ones; both are read.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any, Final

from chainbuild.errors import MachineDataError, Span
from chainbuild.findings import Collector
from chainbuild.formats.twincat.lists.config import Trafo
from chainbuild.formats.twincat.lists.reader import Assignment

COUPLING: Final = 210
# Numbers of the controller's alarms.
NOT_UNIQUE: Final = 21931
NO_TOOL_MEMBER: Final = 22053
MULTISTEP: Final = 22093
_UNSUPPORTED: Final = 292060
_GROUP_TWICE: Final = 292063
_UNKNOWN_MEMBER: Final = 292064
_UNKNOWN_WORKPIECE: Final = 292066
_INCOMPLETE_PRIORITY: Final = 292067
_NO_GROUP: Final = 292085
_GAP: Final = 292086
_NO_MEMBER: Final = 292087

_GROUP: Final = re.compile(r"group\[(\d+)\]")
_KNOWN: Final = re.compile(r"group\[\d+\]\.(name|id|workpiece_cs|(chain|move_prio)\[\d+\])|lock_dof\[\d+\]")


@dataclass(frozen=True, slots=True)
class Group:
    """A group of a coupling.

    Attributes:
        index: k of group[k].
        label: Name or id, as messages show it.
        members: Kinematics from the ground up.
        priority: Ranks of the members in the distribution of a TCP motion.
        workpiece: Index of the group whose TCP frame this one's coordinates are read in, or None.
    """

    index: int
    label: str
    members: tuple[Trafo, ...]
    priority: tuple[int, ...]
    workpiece: int | None


@cache
def coupling_data() -> Mapping[str, Any]:
    """Return limits, permitted partials and error numbers of the coupling kinematic."""
    text = resources.files("chainbuild").joinpath("formats/twincat/data/coupling.toml").read_text("utf-8")
    return tomllib.loads(text)


def coupling_error(number: int, text: str, *, span: Span | None, parameter: str, permitted: str) -> MachineDataError:
    """Return the error with a number of the controller; 0: the manual gives none."""
    return MachineDataError(
        text, span=span, parameter=parameter, permitted=permitted, alarm=number or None, code="CB455"
    )


def read_groups(coupling: Trafo, trafos: Sequence[Trafo], collector: Collector) -> tuple[Group, ...]:
    """Return the groups of a coupling.

    Args:
        coupling: The kinematic of KIN_TYP 210.
        trafos: All kinematics of the channel's first step.
        collector: Takes findings.

    Raises:
        MachineDataError: the configuration is one that the controller refuses, with its error number.
    """
    others = [trafo for trafo in trafos if trafo is not coupling and trafo.step == coupling.step]
    return _Reading(coupling, others, collector).run()


def member_named(label: str, trafos: Iterable[Trafo]) -> list[Trafo]:
    """Return the kinematics that a name, else an id, means."""
    known = list(trafos)
    by_name = [trafo for trafo in known if trafo.name == label]
    return by_name or [trafo for trafo in known if label.isdecimal() and trafo.id == int(label)]


@dataclass(slots=True)
class _Draft:
    """A group as written: its name or id, and its place."""

    index: int
    label: str
    span: Span | None


@dataclass(slots=True)
class _Reading:
    """A coupling while it is read."""

    coupling: Trafo
    others: Sequence[Trafo]
    collector: Collector

    def run(self) -> tuple[Group, ...]:
        self.unknown_names()
        drafts = self.drafts()
        groups = tuple(self.group(draft, drafts) for draft in drafts)
        if len(groups) > 1 and groups[0].workpiece == 1 and groups[1].workpiece == 0:
            what, permitted = "each group follows the other", "one workpiece_cs"
            raise self.refusal(0, what, self.coupling.span, "group[1].workpiece_cs", permitted)
        members = [member for group in groups for member in group.members]
        for n, member in enumerate(members):
            if member in members[:n]:
                text = f"the kinematic {member.name or member.id} is listed twice"
                raise self.refusal(NOT_UNIQUE, text, self.coupling.span, "group", "each kinematic once")
        if len(members) > coupling_data()["max_partials"]:
            text = f"the coupling has {len(members)} partial kinematics"
            raise self.refusal(0, text, self.coupling.span, "group", f"at most {coupling_data()['max_partials']}")
        return groups

    def drafts(self) -> list[_Draft]:
        """Return the configured groups; empty ones are permitted at the end only."""
        indices = sorted({k for k, _ in self.entries()})
        by_id = any(f"group[{k}].id" in self.coupling.extras for k in indices)
        configured = [k for k in indices if self.configured(k, by_id)]
        if not configured:
            raise self.refusal(_NO_GROUP, "no group is configured", self.coupling.span, "group[0]", "a group")
        limit = coupling_data()["max_groups"]
        if configured[-1] >= limit:
            k = configured[-1]
            raise self.refusal(0, f"group[{k}] is one too many", self.span(k), f"group[{k}]", f"at most {limit} groups")
        if configured != list(range(len(configured))):
            k = configured[-1]
            text = f"group[{k}] follows a group that is not configured"
            raise self.refusal(_GAP, text, self.span(k), f"group[{k}]", "groups without a gap")
        drafts = [_Draft(k, self.label(k), self.span(k)) for k in configured]
        labels = [draft.label for draft in drafts if draft.label]
        if len(set(labels)) < len(labels):
            text = f"two groups are called {labels[0]}"
            raise self.refusal(_GROUP_TWICE, text, drafts[-1].span, "group", "different names or ids")
        return drafts

    def entries(self) -> list[tuple[int, Assignment]]:
        """Return the list's entries on groups, each with the group's index."""
        found = ((_GROUP.match(key), entry) for key, entry in self.coupling.extras.items())
        return [(int(match[1]), entry) for match, entry in found if match]

    def unknown_names(self) -> None:
        for key, entry in self.coupling.extras.items():
            if not _KNOWN.fullmatch(key):
                text = f"{entry.name} is not a parameter of KIN_TYP {COUPLING}; it is ignored"
                self.collector.add("CB456", text, span=entry.span, parameter=entry.name)

    def configured(self, k: int, by_id: bool) -> bool:
        """Return whether a group counts: by an id other than 0, or by a name or a chain where ids are not used."""
        if by_id:
            return self.label(k) not in ("", "0")
        return bool(self.label(k)) or bool(self.coupling.indexed(f"group[{k}].chain"))

    def label(self, k: int) -> str:
        for key in ("id", "name"):
            entry = self.coupling.extras.get(f"group[{k}].{key}")
            if entry is not None:
                return label_of(entry)
        return ""

    def group(self, draft: _Draft, drafts: Sequence[_Draft]) -> Group:
        name = f"group[{draft.index}]"
        entries = self.named(f"{name}.chain")
        if not entries:
            text = f"{name} has no members"
            raise self.refusal(_NO_MEMBER, text, draft.span, f"{name}.chain", "at least one kinematic")
        limit = coupling_data()["max_partials_a_group"]
        if len(entries) > limit:
            text = f"{name} has {len(entries)} members"
            raise self.refusal(0, text, entries[-1].span, f"{name}.chain", f"at most {limit}")
        members = tuple(self.member(entry) for entry in entries)
        return Group(draft.index, draft.label, members, self.priority(name, members), self.workpiece(draft, drafts))

    def named(self, name: str) -> list[Assignment]:
        """Return the entries of a list that are not empty; a gap in their indices leaves a finding."""
        entries = {k: e for k, e in self.coupling.indexed(name).items() if label_of(e, empty=True) not in ("", "0")}
        if list(entries) != list(range(len(entries))):
            first = next(iter(entries.values()))
            text = f"the indices of {name}[] have a gap; its entries are taken in their order"
            self.collector.add("CB456", text, span=first.span, parameter=first.name)
        return list(entries.values())

    def member(self, entry: Assignment) -> Trafo:
        label = label_of(entry)
        found = member_named(label, self.others)
        if not found:
            found = [trafo for trafo in self.others if trafo.name.lower() == label.lower()]
            if len(found) == 1:
                text = f"{label} is taken for {found[0].name}: the letters differ in case"
                self.collector.add("CB456", text, span=entry.span, parameter=entry.name)
        if not found:
            text = f"{label} is not a configured kinematic"
            raise self.refusal(_UNKNOWN_MEMBER, text, entry.span, entry.name, _known(self.others))
        if len(found) > 1:
            text = f"{len(found)} kinematics are called {label}"
            raise self.refusal(NOT_UNIQUE, text, found[1].span, entry.name, "different names or ids")
        permitted = coupling_data()["partials"]
        if str(found[0].type) not in permitted:
            text = f"KIN_TYP {found[0].type} ({label}) cannot be a partial kinematic"
            raise self.refusal(_UNSUPPORTED, text, entry.span, entry.name, f"KIN_TYP {', '.join(permitted)}")
        return found[0]

    def priority(self, name: str, members: Sequence[Trafo]) -> tuple[int, ...]:
        entries = self.named(f"{name}.move_prio")
        if not entries:
            return tuple(range(len(members)))
        ranked = []
        for entry in entries:
            found = [m for m in members if label_of(entry).lower() in (m.name.lower(), str(m.id))]
            if len(found) != 1:
                text = f"{label_of(entry)} is not a member of {name}"
                raise self.refusal(_INCOMPLETE_PRIORITY, text, entry.span, entry.name, _known(members))
            ranked.append(found[0])
        if sorted(t.index for t in ranked) != sorted(t.index for t in members):
            text = f"{name}.move_prio names {len({t.index for t in ranked})} of {len(members)} members"
            last, permitted = entries[-1], "all members once, or none"
            raise self.refusal(_INCOMPLETE_PRIORITY, text, last.span, last.name, permitted)
        return tuple(ranked.index(member) for member in members)

    def workpiece(self, draft: _Draft, drafts: Sequence[_Draft]) -> int | None:
        entry = self.coupling.extras.get(f"group[{draft.index}].workpiece_cs")
        label = "" if entry is None else label_of(entry, empty=True)
        if entry is None or label in ("", "0"):
            return None
        found = [other.index for other in drafts if other is not draft and other.label == label]
        if not found:
            others = ", ".join(other.label for other in drafts if other is not draft) or "another group"
            text = f"{label} is not another group of the coupling"
            raise self.refusal(_UNKNOWN_WORKPIECE, text, entry.span, entry.name, others)
        return found[0]

    def span(self, k: int) -> Span | None:
        return next((entry.span for index, entry in self.entries() if index == k), self.coupling.span)

    def refusal(self, number: int, text: str, span: Span | None, parameter: str, permitted: str) -> MachineDataError:
        if not parameter.startswith(self.coupling.prefix):
            parameter = f"{self.coupling.prefix}.{parameter}"
        return coupling_error(number, text, span=span, parameter=parameter, permitted=permitted)


def label_of(entry: Assignment, *, empty: bool = False) -> str:
    """Return a name, or an id without its comment.

    Args:
        entry: The entry.
        empty: True where an empty value is permitted; else it is refused.

    Raises:
        ParseError: no value.
    """
    if empty and not entry.raw:
        return ""
    text = entry.text()
    head = text.split(maxsplit=1)[0] if text else ""
    return str(int(head)) if head.isdecimal() else text


def _known(trafos: Iterable[Trafo]) -> str:
    return ", ".join(trafo.name or str(trafo.id) for trafo in trafos) or "nothing is configured"
