"""What a recipe gets and what it returns: the parameters of a kinematic, scaled, and the branches of its chain."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from chainbuild.chain.assemble import Element, Move, rotary
from chainbuild.chain.axismap import AxisMap
from chainbuild.chain.drives import DriveMap
from chainbuild.chain.elements import Axis, Loop, Task
from chainbuild.convention import Choices
from chainbuild.errors import MachineDataError, Span
from chainbuild.findings import Collector
from chainbuild.formats.twincat.lists.hdtable import HdKind, HdRow, TypeData

Direction = str | Sequence[float]


@dataclass(frozen=True, slots=True, eq=False)
class Recipe:
    """A kinematic written down like its drawing.

    Attributes:
        tool: Base → tool tip, elements of `chain.assemble`; lengths in mm, angles in degrees.
        workpiece: Base → workpiece.
        axes: The axes where they differ from the type's table (`Params.axes`), else None.
        axis_map: A nonlinear map over the joints (tool branch, then workpiece branch), else None: joint drives. Those
            of its joints that one axis alone drives are drawn with that drive, the others without.
        angle_mode: Name in `frames.ANGLE_MODES`; None: by P-CHAN-00112 of the channel.
        task: What inverse kinematics solves for.
        drives: What the drives stand at; None: at the axis values.
        branches: Base → ends of loops: the arms of a parallel kinematic.
        loops: Where these ends meet other frames.
    """

    tool: Sequence[Element]
    workpiece: Sequence[Element] = ()
    axes: tuple[Axis, ...] | None = None
    axis_map: AxisMap | None = None
    angle_mode: str | None = None
    task: Task = "auto"
    drives: DriveMap | None = None
    branches: Sequence[Sequence[Element]] = ()
    loops: tuple[Loop, ...] = ()


@dataclass(slots=True)
class Params:
    """The head offsets of one configured kinematic, channel list and tool already added, by name or number.

    Attributes:
        data: Tables of the type.
        raw: HD number → count of the list (1e-4 mm, 1e-4 degrees, bare number); absent: the default.
        spans: HD number → where the list gives it.
        tool_length_mm: Length of the active tool.
        tool_radius_mm: Radius of the active tool.
        span: Where the kinematic is configured.
        collector: Takes findings.
    """

    data: TypeData
    raw: Mapping[int, float] = field(default_factory=dict)
    spans: Mapping[int, Span] = field(default_factory=dict)
    tool_length_mm: float = 0.0
    tool_radius_mm: float = 0.0
    span: Span | None = None
    collector: Collector = field(default_factory=Collector)

    @property
    def axes(self) -> tuple[Axis, ...]:
        """The type's axes in channel order, without limits."""
        return self.data.unlimited_axes()

    def mm(self, key: str | int) -> float:
        """Return a length in mm."""
        return self._scaled(key, "length")

    def deg(self, key: str | int) -> float:
        """Return an angle in degrees."""
        return self._scaled(key, "angle")

    def number(self, key: str | int) -> float:
        """Return a bare number (flag, sign, ratio or count) as the list has it."""
        row = self.data.row(key)
        if row.unit:
            raise TypeError(f"HD{row.n} of KIN_TYP {self.data.number} has a unit: use mm() or deg()")
        return self._raw(row)

    def flag(self, key: str | int) -> int:
        """Return a flag.

        Raises:
            MachineDataError: the table does not permit the value.
        """
        row, value = self.data.row(key), self.number(key)
        if row.permitted and value not in row.permitted:
            self.refuse(key, f"HD{row.n} is {value:g}", ", ".join(f"{choice:g}" for choice in row.permitted))
            return int(row.default)
        return int(value)

    def direction(self, key: str | int) -> float:
        """Return +1 for flag 0 and -1 for flag 1."""
        return -1.0 if self.flag(key) else 1.0

    def sign(self, key: str | int, *, zero_is_plus: bool = False) -> float:
        """Return -1 for a negative value, else +1.

        Args:
            key: Name or number of the HD.
            zero_is_plus: True where the manual itself says that 0 is positive; else 0 leaves a finding.
        """
        row, value = self.data.row(key), self.number(key)
        if value == 0 and not zero_is_plus:
            self.note("CB402", key, f"the direction sign HD{row.n} ({row.name}) is 0; it counts as +1")
        return -1.0 if value < 0 else 1.0

    def given(self, key: str | int) -> bool:
        """Return True where channel list or tool give a value."""
        return self.data.row(key).n in self.raw

    def note(self, code: str, key: str | int, text: str, hint: str | None = None) -> None:
        """Record a finding at the line of an HD."""
        self.collector.add(code, text, span=self._span(key), hint=hint, parameter=self._name(key))

    def refuse(self, key: str | int, text: str, permitted: str, *, alarm: int | None = None) -> None:
        """Refuse the value of an HD (CB401); returns only where the collector is lenient.

        Raises:
            MachineDataError: always where the collector is strict.
        """
        self.collector.add(
            "CB401", text, span=self._span(key), parameter=self._name(key), permitted=permitted, alarm=alarm,
            error=MachineDataError,
        )  # fmt: skip

    def _scaled(self, key: str | int, kind: HdKind) -> float:
        row = self.data.row(key)
        if row.kind != kind:
            raise TypeError(f"HD{row.n} of KIN_TYP {self.data.number} is a {row.kind}, not a {kind}")
        return row.scaled(self._raw(row)) + 0.0

    def _raw(self, row: HdRow) -> float:
        return self.raw.get(row.n, row.default)

    def _span(self, key: str | int) -> Span | None:
        return self.spans.get(self.data.row(key).n, self.span)

    def _name(self, key: str | int) -> str:
        row = self.data.row(key)
        return f"HD{row.n} {row.name}"


RecipeFunction = Callable[[Params, Choices], Recipe]


@dataclass(frozen=True, slots=True)
class Drive:
    """An affine drive: joint angle = sign·axis + offset_deg."""

    sign: float = 1.0
    offset_deg: float = 0.0

    def reversed(self) -> Drive:
        """Return the drive with the whole joint angle negated."""
        return Drive(-self.sign, -self.offset_deg)


def zero_and_sign(choose: Choices, sign: float, zero_deg: float, *, printed: Literal["inside", "outside"]) -> Drive:
    """Return how a direction sign and a zero offset make an internal angle: the one place for it.

    inside: sign·(axis - zero); outside: sign·axis - zero. The two differ only at a reversed axis with an offset; only
    there convention `offset_inside_flag` is used.

    Args:
        choose: Conventions.
        sign: +1 or -1.
        zero_deg: Zero offset that the table says is subtracted.
        printed: What choice `as_printed` of the convention means for this type.
    """
    if sign > 0 or zero_deg == 0:
        return Drive(sign, -zero_deg)
    chosen = choose["offset_inside_flag"]
    inside = (printed if chosen == "as_printed" else chosen) == "inside"
    return Drive(sign, zero_deg if inside else -zero_deg)


def table_flag(p: Params, choose: Choices, key: str | int) -> float:
    """Return the direction of a table axis by its flag: +1 or -1 (convention `table_flag_coding`)."""
    value = p.number(key)
    if value > 0:  # only here do the codings differ
        return 1.0 if choose["table_flag_coding"] == "plus_minus_one" else -1.0
    return -1.0 if value < 0 else 1.0


def driven(name: str, direction: Direction, drive: Drive) -> Move:
    """Return the revolute joint of an axis behind a drive."""
    return rotary(name, direction, sign=drive.sign, offset_deg=drive.offset_deg)


def mapped(name: str, direction: Direction) -> Move:
    """Return a revolute joint that the recipe's axis map drives: no axis alone is its angle."""
    return rotary(name, direction, drive={})


def head_rotary(choose: Choices, name: str, direction: Direction, *, sign: float = 1.0, zero_deg: float = 0.0) -> Move:
    """Return a rotary axis of a head or arm: printed as sign·axis - zero (KIN_TYP 16, 28, 30, 45, 70, 205, 213)."""
    return driven(name, direction, zero_and_sign(choose, sign, zero_deg, printed="outside"))


def table_rotary(
    choose: Choices,
    name: str,
    direction: Direction,
    *,
    sign: float = 1.0,
    zero_deg: float = 0.0,
    carries: Literal["tool", "workpiece"] = "workpiece",
) -> Move:
    """Return a rotary axis of a table machine: printed as sign·(axis - zero) (KIN_TYP 1, 57, 58, 61, 63, 64, 80 to 82).

    Args:
        choose: Conventions; `table_rotary_sense` is used for axes that carry the workpiece.
        name: Axis name.
        direction: "x", "-y", … .
        sign: +1 or -1.
        zero_deg: Zero offset, subtracted.
        carries: "tool" for the head axis of a mixed machine.
    """
    drive = zero_and_sign(choose, sign, zero_deg, printed="inside")
    if carries == "workpiece" and choose["table_rotary_sense"] == "left_handed":
        drive = drive.reversed()
    return driven(name, direction, drive)
