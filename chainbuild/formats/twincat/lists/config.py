"""Channel configuration, typed: kinematics, defaults and axes, each value with its place in the file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Final

from chainbuild.chain.names import name_fault
from chainbuild.chain.programmed.vectors import AngleLetter, OriMode, ToolPlane
from chainbuild.errors import ChainbuildError, MachineDataError, ParseError, Span
from chainbuild.findings import Collector
from chainbuild.formats.twincat.lists.reader import Assignment

MAX_TRAFOS: Final = 10  # kinematics of a channel and step, trafo[0] to trafo[9]
MAX_KINEMATIC_STEPS: Final = 2  # of a coupled transformation, kin_step[0] and kin_step[1]
MAX_PARAM: Final = 74  # P-TOOL-00009 and P-CHAN-00094; HD75 is the last
MAX_NAME_CHARACTERS: Final = 16  # of a kinematic that is called by its name, and of an axis (P-CHAN-00006)
UNS16: Final = 65535  # largest id and type
UNKNOWN_ID_ALARM: Final = 21630
_KEPT_NAME: Final = re.compile(r"[ABCQU-Z]\w*", re.IGNORECASE)  # of an axis (P-CHAN-00006)
_NAME_ALARM: Final = 20425  # an axis' name is too long or begins with another letter; the controller replaces it


@dataclass(frozen=True, slots=True)
class RawValue:
    """A number of a list in its own counts (1e-4 mm, 1e-4 degrees or bare), its place and its spelling."""

    value: float
    name: str
    span: Span
    raw: str = ""


@dataclass(frozen=True, slots=True)
class Trafo:
    """One configured kinematic.

    Attributes:
        step: Transformation step, 0 or 1; 0 is nearest to the machine.
        index: j of trafo[j]; the id where the old form kinematik[ID] is used.
        id: P-CHAN-00262.
        type: KIN_TYP (P-CHAN-00829); the id where the list gives none.
        name: P-CHAN-00443, or an empty string.
        params: k → param[k], the list's counts.
        extras: Everything else by its name behind the dot: "zero_orientation[0]", "group[0].chain[1]", "base[2]" … .
        span: Where it is configured.
        prefix: How the list writes it: "trafo[0]".
    """

    step: int
    index: int
    id: int
    type: int
    name: str
    params: Mapping[int, RawValue]
    extras: Mapping[str, Assignment]
    span: Span
    prefix: str

    def numbers(self, name: str, count: int) -> tuple[float, ...]:
        """Return name[0] … name[count-1] of the extras, 0 where absent; raises ParseError at a bad one."""
        entries = (self.extras.get(f"{name}[{k}]") for k in range(count))
        return tuple(0.0 if entry is None else entry.number() for entry in entries)

    def indexed(self, name: str) -> Mapping[int, Assignment]:
        """Return the extras name[0], name[1] … by index, in the order of their indices."""
        found = {entry.keys[-1][1]: entry for key, entry in self.extras.items() if key.rpartition("[")[0] == name}
        return {index: found[index] for index in sorted(k for k in found if k is not None)}


@dataclass(frozen=True, slots=True)
class ChannelAxis:
    """An axis as the channel list names it: gruppe[0].achse[i].

    Attributes:
        index: Its index i in the channel.
        name: bezeichnung (P-CHAN-00006), or an empty string.
        number: Logical axis number, log_achs_nr, or None.
        span: Place of the name.
    """

    index: int
    name: str
    number: int | None = None
    span: Span | None = None


@dataclass(frozen=True, slots=True)
class Default:
    """Which kinematic of a step is active after start-up; id and name each with its place."""

    id: int | None = None
    name: str | None = None
    span: Span | None = None
    name_span: Span | None = None

    def matches(self, trafo: Trafo) -> bool:
        """Return True where both id and name, as far as given, are those of a kinematic."""
        return self.id in (None, trafo.id) and self.name in (None, trafo.name)

    def fault(self, trafos: Iterable[Trafo], step: int = 0) -> tuple[str, Span | None, str]:
        """Return what is wrong with a default that no kinematic matches, where, and what would be permitted."""
        here = [trafo for trafo in trafos if trafo.step == step]
        known = ", ".join(f"{trafo.id} ({trafo.name})" if trafo.name else str(trafo.id) for trafo in here)
        if self.id is None or self.name is None:
            span = self.span if self.name is None else self.name_span or self.span
            return f"the default kinematic {self.id or self.name!r} is not configured", span, known
        has_id = any(trafo.id == self.id for trafo in here)
        has_name = any(trafo.name == self.name for trafo in here)
        what = f"the default kinematic is id {self.id} and name {self.name!r}"
        if has_id and has_name:
            return f"{what}, which contradict each other: no kinematic has both", self.name_span, known
        lacks = f"no kinematic has this {'name' if has_id else 'id' if has_name else 'id or name'}"
        return f"{what}, but {lacks}: it is not configured", self.name_span if has_id else self.span, known


@dataclass(frozen=True, slots=True)
class Orientation:
    """How the channel's programs state orientations: ori.mode and its neighbours.

    Attributes:
        mode: P-CHAN-00177.
        fixed: P-CHAN-00178, the angle of the rotary axis that is kept; None where the index is 0.
        plane: P-CHAN-00436, 1 (ZX) or 2 (YZ) that a tool axis is parallel to, or 0.
        spans: Name → where the list gives it.
    """

    mode: OriMode = "angle"
    fixed: AngleLetter | None = None
    plane: ToolPlane = 0
    spans: Mapping[str, Span] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Channel:
    """Contents of one channel list.

    Attributes:
        index: Number of the channel in the file, from 0.
        name: Name in the container, or an empty string.
        trafos: Kinematics in file order, step by step.
        pcs: PCS transformations (trafo_pcs), which act on the program's side.
        defaults: Step → default kinematic.
        angle_mode: P-CHAN-00112, ori_rotation_angle.
        axes: Axes by channel index.
        span: Where the list begins.
        orientation: Angles or vectors (ori.mode).
    """

    index: int
    name: str
    trafos: tuple[Trafo, ...]
    pcs: tuple[Trafo, ...] = ()
    defaults: Mapping[int, Default] = field(default_factory=dict)
    angle_mode: RawValue | None = None
    axes: Mapping[int, ChannelAxis] = field(default_factory=dict)
    span: Span | None = None
    orientation: Orientation = field(default_factory=Orientation)

    def default_trafo(self, step: int = 0) -> Trafo | None:
        """Return the default kinematic of a step: as the list names it, else None."""
        default = self.defaults.get(step)
        if default is None:
            return None
        return next((t for t in self.trafos if t.step == step and default.matches(t)), None)


@contextmanager
def errors_collected_by(collector: Collector) -> Iterator[None]:
    """Keep an error as a finding where the collector is lenient; raise it where it is strict."""
    try:
        yield
    except ChainbuildError as error:
        if collector.strict:
            raise
        collector.add_error(error)


def checked_axis_name(entry: Assignment, others: Mapping[int, Assignment], collector: Collector) -> str:
    """Return the name of a channel axis; an empty string, with a finding, where it names none.

    The controller itself replaces a name that is too long or begins with another letter (ID 20425).

    Args:
        entry: gruppe[0].achse[i].bezeichnung.
        others: The axes that were named before.
        collector: Takes findings.

    Raises:
        MachineDataError: it is the name of a column of the tables or of another axis, or holds other characters than
            letters, digits, `_` and `-`.
        ParseError: a quote is not closed.
    """
    name = entry.text() if entry.raw else ""
    if not name:
        text = f"{entry.name} is empty: the axis keeps the name that the kinematic gives it"
        collector.add("CB413", text, span=entry.span, parameter=entry.name)
        return ""
    fault = name_fault(name)
    twice = next((other for other in others.values() if other.text() == name), None)
    if twice is not None:
        fault = f"two axes are called {name!r}, also in line {twice.span.line}", "a name of its own for each axis"
    if fault is not None:
        raise MachineDataError(fault[0], span=entry.span, parameter=entry.name, permitted=fault[1], code="CB416")
    if not _KEPT_NAME.fullmatch(name) or len(name) > MAX_NAME_CHARACTERS:
        text = f"the controller does not keep the axis' name {name[:40]!r}"
        permitted = f"A, B, C, U to Z or Q, then letters, digits and _, at most {MAX_NAME_CHARACTERS} characters"
        collector.add("CB413", text, span=entry.span, parameter=entry.name, permitted=permitted, alarm=_NAME_ALARM)
    return name


def bad_name(entry: Assignment, permitted: str) -> ChainbuildError:
    """Return the error for a name that lacks a part."""
    return ParseError(
        f"{entry.name} is not a complete name", span=entry.span, parameter=entry.name, permitted=permitted, code="CB201"
    )


def checked_index(entry: Assignment, index: int | None, highest: int) -> int:
    """Return an index within 0 … highest.

    Raises:
        MachineDataError: it is missing or too large.
    """
    if index is None or index > highest:
        what = "has no index" if index is None else f"has the index {index}"
        raise MachineDataError(
            f"{entry.name} {what}", span=entry.span, parameter=entry.name, permitted=f"[0] to [{highest}]", code="CB203"
        )
    return index


def short_name(entry: Assignment, collector: Collector) -> str:
    """Return a name; one longer than the controller keeps leaves a finding."""
    value = entry.text()
    if len(value) > MAX_NAME_CHARACTERS:
        text = f"the name {value[:40]!r} has {len(value)} characters"
        collector.add(
            "CB225", text, span=entry.span, parameter=entry.name, permitted=f"at most {MAX_NAME_CHARACTERS} characters"
        )
    return value
