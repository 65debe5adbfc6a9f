"""KIN_TYP 91 as its list gives it: axes, chain, zero pose and linkage, by name or by PARAM[] slot.

Slots: 0 to 2 zero_orientation, 3 to 5 zero_position, 6 number_of_axes, then seven for each axis: type, orientation
(3), point (3). A name wins over its slot; what the active tool gives for a slot is added to either.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild import tolerances
from chainbuild.arrays import Matrix, Vector
from chainbuild.errors import MachineDataError, Span
from chainbuild.findings import Collector
from chainbuild.formats.twincat.lists.config import RawValue, Trafo
from chainbuild.units import AxisKind, mm_from_tenth_um

_SLOTS_AHEAD: Final = 7  # numbers of PARAM[] before those of the first axis
_SLOTS_AN_AXIS: Final = 7  # type, orientation (3), point (3)
# Axes that KIN_TYP 91 permits; of the rotary ones two where it is programmed by position and angles.
MAX_AXES: Final = 6
_MAX_LINEAR: Final = 3
_MAX_ROTARY: Final = 3
_MAX_ROTARY_COMPLETE: Final = 2
_KINDS: Final[Mapping[float, AxisKind]] = {1.0: "linear", 2.0: "rotary"}
_UNSUPPORTED_MODE: Final = 11
_MODES: Final = (0, *range(10, 22))
SINGULAR_LINKAGE_ALARM: Final = 292010

_KNOWN: Final = re.compile(
    r"(zero_orientation|zero_position)\[[0-2]\]|rtcp|programming_mode|number_of_axes|linkage_mode|chain\[[0-5]\]"
    r"|axis\[[0-5]\]\.(type|(orientation|point)\[[0-2]\])|linkage\[[0-2]\]\[[0-3]\]|base\[[0-5]\]"
)


@dataclass(frozen=True, slots=True, eq=False)
class UniversalAxis:
    """One axis: kind, direction as entered (3), point on a rotary axis (3) [mm], and the place of its direction."""

    kind: AxisKind
    orientation: Vector
    point_mm: Vector
    span: Span | None


@dataclass(frozen=True, slots=True, eq=False)
class UniversalData:
    """Contents of the list.

    Attributes:
        axes: Axes by index, which is the order of the channel.
        chain: Axis indices in the order met from the workpiece over the machine origin to the tool.
        zero_orientation: Tool vector at the zero position, of length 1.
        zero_position_mm: Flange at the zero position.
        rtcp: True where machine angles are programmed, False for a complete transformation.
        mode: Programming mode, 10 to 21, or 0 where the list gives none.
        linkage: (3, 4) Cartesian values of the linear axes from their axis values, the last column in mm; or None.
    """

    axes: tuple[UniversalAxis, ...]
    chain: tuple[int, ...]
    zero_orientation: Vector
    zero_position_mm: Vector
    rtcp: bool
    mode: int
    linkage: Matrix | None


def read_universal(trafo: Trafo, tool: Mapping[int, RawValue], collector: Collector, *, member: bool) -> UniversalData:
    """Type the parameters of KIN_TYP 91.

    Args:
        trafo: The kinematic.
        tool: Slot → what the active tool adds.
        collector: Takes findings.
        member: True for a partial of a coupling, which may have fewer linear axes.

    Raises:
        MachineDataError: a value is not permitted, or the axes make no kinematic.
    """
    return _Reading(trafo, tool, collector, member).run()


@dataclass(slots=True)
class _Reading:
    """A kinematic while it is read."""

    trafo: Trafo
    tool: Mapping[int, RawValue]
    collector: Collector
    member: bool

    def run(self) -> UniversalData:
        self.unknown_names()
        count = self.axis_count()
        axes = tuple(self.axis(k) for k in range(count))
        rtcp = bool(self.whole("rtcp", None, (0, 1)))
        self.check_kinds([axis.kind for axis in axes], rtcp)
        zero = self.vector("zero_orientation", 0)
        norm = float(np.linalg.norm(zero))
        if norm < tolerances.ZERO_VECTOR:
            raise self.refusal("zero_orientation", "zero_orientation is the zero vector", "any other vector")
        return UniversalData(
            axes=axes,
            chain=self.chain(count),
            zero_orientation=zero / norm,
            zero_position_mm=np.array([mm_from_tenth_um(v) for v in self.vector("zero_position", 3)]),
            rtcp=rtcp,
            mode=self.mode(),
            linkage=self.linkage([axis.kind for axis in axes]),
        )

    def unknown_names(self) -> None:
        for name, entry in self.trafo.extras.items():
            if not _KNOWN.fullmatch(name):
                text = f"{entry.name} is not a parameter of KIN_TYP 91; it is ignored"
                self.collector.add("CB450", text, span=entry.span, parameter=entry.name)

    def axis_count(self) -> int:
        count = self.whole("number_of_axes", 6, range(1, MAX_AXES + 1))
        beyond = [k for k in range(count, MAX_AXES) if self.given(f"axis[{k}].type", _first_slot(k))]
        if beyond:
            text = f"axis[{beyond[0]}] is beyond number_of_axes {count}; it is ignored"
            self.collector.add("CB450", text, span=self.span(f"axis[{beyond[0]}].type", _first_slot(beyond[0])))
        return count

    def axis(self, k: int) -> UniversalAxis:
        slot = _first_slot(k)
        name = f"axis[{k}]"
        kind = self.whole(f"{name}.type", slot, (1, 2))
        orientation = self.vector(f"{name}.orientation", slot + 1)
        if float(np.linalg.norm(orientation)) < tolerances.ZERO_VECTOR:
            what = f"the orientation of axis {k} is the zero vector"
            raise self.refusal(f"{name}.orientation", what, "any other vector", slot + 1)
        point = np.array([mm_from_tenth_um(v) for v in self.vector(f"{name}.point", slot + 4)])
        return UniversalAxis(_KINDS[kind], orientation, point, self.span(f"{name}.orientation", slot + 1))

    def check_kinds(self, kinds: Sequence[AxisKind], rtcp: bool) -> None:
        rotary = kinds.count("rotary")
        most = _MAX_ROTARY if rtcp else _MAX_ROTARY_COMPLETE
        if rotary > most:
            what = f"{rotary} rotary axes in {'an RTCP' if rtcp else 'a complete'} transformation"
            raise self.refusal("rtcp", what, f"at most {most}")
        if self.member and kinds.count("linear") <= _MAX_LINEAR:
            return
        if len(kinds) < _MAX_LINEAR:
            axes = "one axis" if len(kinds) == 1 else "two axes"
            text = f"a universal kinematic of {axes} is described as a partial of a coupling only"
            hint = "the controller may want three linear axes at 0 to 2"
            self.collector.add("CB466", text, span=self.span("number_of_axes", 6), hint=hint)
            return
        wrong = [k for k, kind in enumerate(kinds) if (kind == "linear") != (k < _MAX_LINEAR)]
        if wrong:
            k = wrong[0]
            raise self.refusal(
                f"axis[{k}].type", f"axis {k} is {kinds[k]}", "three linear axes at 0 to 2, then rotary ones",
                _first_slot(k),
            )  # fmt: skip

    def chain(self, count: int) -> tuple[int, ...]:
        entries = self.trafo.indexed("chain")
        if not entries and count > 1:
            text = "the list gives no chain[]; the axes are taken in the order of their indices"
            self.collector.add("CB451", text, span=self.trafo.span, parameter=f"{self.trafo.prefix}.chain[0]")
            return tuple(range(count))
        order = [entries[k].integer(0, MAX_AXES - 1) if k in entries else 0 for k in range(count)]
        if sorted(order) != list(range(count)):
            shown = ", ".join(map(str, order))
            raise self.refusal("chain", f"chain[] is {shown}", f"each of 0 to {count - 1} once")
        return tuple(order)

    def mode(self) -> int:
        mode = self.whole("programming_mode", None, _MODES)
        check_mode(mode, self.span("programming_mode", None), f"{self.trafo.prefix}.programming_mode")
        return mode

    def linkage(self, kinds: Sequence[AxisKind]) -> Matrix | None:
        if not self.whole("linkage_mode", None, (0, 1)):
            return None
        if kinds.count("linear") != _MAX_LINEAR:
            raise self.refusal("linkage_mode", "a linkage needs three linear axes", "0")
        rows = [[self.number(f"linkage[{i}][{j}]", None) for j in range(4)] for i in range(3)]
        linkage = np.array([[*row[:3], mm_from_tenth_um(row[3])] for row in rows])
        if np.linalg.matrix_rank(linkage[:, :3]) < _MAX_LINEAR:
            span = self.span("linkage[0][0]", None)
            raise MachineDataError(
                "the linkage matrix is singular", span=span, parameter=f"{self.trafo.prefix}.linkage",
                permitted="a matrix that can be inverted", alarm=SINGULAR_LINKAGE_ALARM, code="CB452",
            )  # fmt: skip
        return linkage

    def vector(self, name: str, slot: int) -> Vector:
        return np.array([self.number(f"{name}[{i}]", slot + i) for i in range(3)])

    def number(self, name: str, slot: int | None) -> float:
        """Return a value by its name, else by its slot, else 0; what the tool adds to the slot included."""
        entry = self.trafo.extras.get(name)
        by_slot = None if slot is None else self.trafo.params.get(slot)
        added = 0.0 if slot is None or slot not in self.tool else self.tool[slot].value
        if entry is None:
            return (0.0 if by_slot is None else by_slot.value) + added
        value = entry.number()
        if by_slot is not None and by_slot.value != value:
            text = f"{entry.name} is {value:g}, {by_slot.name} says {by_slot.value:g}; the name is used"
            self.collector.add("CB450", text, span=by_slot.span, parameter=by_slot.name)
        return value + added

    def whole(self, name: str, slot: int | None, permitted: Sequence[int]) -> int:
        value = self.number(name, slot)
        if value not in permitted:
            choices = ", ".join(map(str, permitted))
            raise self.refusal(name, f"{name} is {value:g}", choices, slot)
        return int(value)

    def given(self, name: str, slot: int) -> bool:
        return name in self.trafo.extras or slot in self.trafo.params

    def span(self, name: str, slot: int | None) -> Span | None:
        """Return the place of a parameter, or of its first element."""
        for known, entry in self.trafo.extras.items():
            if known == name or known.startswith(f"{name}["):
                return entry.span
        by_slot = None if slot is None else self.trafo.params.get(slot)
        return self.trafo.span if by_slot is None else by_slot.span

    def refusal(self, name: str, what: str, permitted: str, slot: int | None = None) -> MachineDataError:
        return MachineDataError(
            what, span=self.span(name, slot), parameter=f"{self.trafo.prefix}.{name}", permitted=permitted, code="CB452"
        )


def check_mode(mode: int, span: Span | None, parameter: str) -> None:
    """Refuse the programming mode that the controller does not support.

    Raises:
        MachineDataError: mode 11.
    """
    if mode == _UNSUPPORTED_MODE:
        raise MachineDataError(
            "programming mode 11 is not supported by the controller", span=span, parameter=parameter,
            permitted="10, 12 to 21", code="CB452",
        )  # fmt: skip


def _first_slot(k: int) -> int:
    return _SLOTS_AHEAD + _SLOTS_AN_AXIS * k
