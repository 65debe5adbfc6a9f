"""What a machine file lists: kinematics, parameters, geometric data; and which kinematic an id or name means."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from numbers import Real
from typing import Final

from chainbuild import tolerances
from chainbuild.closest import listed
from chainbuild.errors import ChainbuildError, MachineDataError, Span
from chainbuild.formats.overlay import Overlay
from chainbuild.shown import fields_shown

# What names a kinematic: its id or name, or a pair of these for the transformation steps 0 and 1 (#KIN ID[9,58]).
Wanted = int | str | tuple[int | str, int | str]

_PERMITTED: Final = "an id, a name, a pair of these for the two steps, or None"
_BY_NAME: Final = "by name: {one: 600.0 for one in machine.geometry() if one.name == 'a2'}"
_ID_DIGITS: Final = 9  # more than any id has
_HUGE_NUMBER: Final = 10**_ID_DIGITS  # beyond any id or channel


@dataclass(frozen=True, slots=True)
class ParameterRow:
    """One parameter of a kinematic as `info` shows it.

    Attributes:
        name: Name in the file: "$MC_ROBX_TX3P3_POS[0]", "trafo[0].param[6]".
        symbol: Short name: "MD62908", "HD7".
        value: Value in `unit`.
        unit: "mm", "deg" or an empty string.
        meaning: What it does.
        given: True where the file gives it, False for a default.
        source: Manual section.
        span: Where the file gives it.
        si: Value in `si_unit`, for dynamics that the file counts otherwise.
        si_unit: "m/s", "rad/s", "rad/s²", or an empty string.
    """

    __repr__ = fields_shown

    name: str
    symbol: str
    value: float | int | str | None
    unit: str
    meaning: str
    given: bool
    source: str
    span: Span | None = None
    si: float | None = None
    si_unit: str = ""


@dataclass(frozen=True, slots=True)
class Datum:
    """One number of a file that places or directs something: a length, an angle, a direction.

    Attributes:
        name: Name in the file: "$MC_ROBX_AXES_DIR[2]", "trafo[0].param[4]".
        symbol: Short name: "MD62918", "HD5", "T4 D1" of a tool, "overlay"; empty where it has none.
        value: Value in `unit`.
        unit: "mm", "deg" or an empty string.
        span: Where the file gives it; None for a default.
        channel: Its channel; of SINUMERIK tool data the tool area.
        key: How its machine finds it.
        others: Values that a bare number may have besides.
        counts: What the file counts for one unit.
        twins: Names of two zeros: both 180 degrees on may be the same arm as this direction reversed.
    """

    __repr__ = fields_shown

    name: str
    symbol: str
    value: float
    unit: str
    span: Span | None
    channel: int
    key: tuple[str, int | tuple[int, int] | None]
    others: tuple[float, ...] = ()
    counts: float = 1.0
    twins: tuple[str, ...] = ()


_PREFIX: Final = "$MC_ROBX_"  # of all the data concerned, so that a name can do without


def datum_name(datum: Datum, data: Sequence[Datum]) -> str:
    """Return how a datum is called among others: its symbol where it is the only one, else the name in the file."""
    lone = datum.symbol.startswith("HD") and [one.symbol for one in data].count(datum.symbol) == 1
    return datum.symbol if lone else datum.name.removeprefix(_PREFIX).removesuffix("_mm")


TOOL_LENGTH: Final = "tool_length_mm"  # what the argument and the overlay call it
TOOL_TABLE: Final = "tool."  # of the overlay: keys of data there begin with it


@dataclass(frozen=True, slots=True)
class KinematicEntry:
    """A kinematic that the file configures.

    Attributes:
        id: Configured id; for ROBX the transformation number.
        name: Configured name, or an empty string.
        type: "KIN_TYP 45", "ROBX NR, 6 axes" … .
        title: English title.
        channel: Channel number (SINUMERIK) or index (TwinCAT).
        default: True where `chain()` without arguments takes it.
        span: Where the file configures it.
        step: Transformation step, 0 or 1; 0 is next to the machine.
    """

    __repr__ = fields_shown

    id: int
    name: str
    type: str
    title: str
    channel: int
    default: bool
    span: Span | None = None
    step: int = 0

    @property
    def label(self) -> str:
        """Id, and the name where there is one: "45 (ROBOT)"."""
        return f"{self.id} ({self.name})" if self.name else str(self.id)


@dataclass(frozen=True, slots=True)
class Selected:
    """The kinematic that a chain is translated from.

    Attributes:
        entry: The kinematic.
        second: The kinematic of the second transformation step, or None.
    """

    entry: KinematicEntry
    second: KinematicEntry | None = None


def added_lengths(overlay: Overlay, argument_mm: float, given: bool) -> Iterator[Datum]:
    """Yield the lengths that are added to a tool's own: that of the overlay, that of the caller.

    Args:
        overlay: The overlay.
        argument_mm: What the caller adds.
        given: True where the tool has data of its own; False: the caller's length is yielded although it is 0.
    """
    added, key = overlay.tool_length_mm, (TOOL_LENGTH, None)
    if added:
        yield Datum(TOOL_LENGTH, "overlay", added, "mm", overlay.span(TOOL_LENGTH), 0, key)
    if argument_mm or not (added or given):
        yield Datum(TOOL_LENGTH, "--tool-length", argument_mm, "mm", None, 0, key)


def changed_overlay(overlay: Overlay, values: Mapping[Datum, float]) -> Overlay:
    """Return an overlay with other values of its tool data; what the caller's length changes by is added here."""
    added = [value - one.value for one, value in values.items() if one.key[0] == TOOL_LENGTH]
    of_table = {one.key[0]: value for one, value in values.items() if one.key[0].startswith(TOOL_TABLE)}
    if not added and not of_table:
        return overlay
    tool = {**overlay.tool, **{key.removeprefix(TOOL_TABLE): value for key, value in of_table.items()}}
    return replace(overlay, tool_length_mm=overlay.tool_length_mm + sum(added), tool=tool)


def finite_length_mm(value: object) -> float:
    """Return a tool length as a float; any real number is one, also numpy's and arrays without dimension.

    Raises:
        MachineDataError: not a finite number of plausible size.
    """
    if getattr(value, "ndim", None) == 0 and hasattr(value, "item"):
        value = value.item()
    wrong, length, shown = "is not a number", 0.0, ""
    if isinstance(value, Real) and not isinstance(value, bool):
        try:
            length = float(value)
        except OverflowError:
            length = tolerances.HUGE_AXIS_VALUE
        shown = f" {length:g}"
        wrong = "" if math.isfinite(length) else "is not finite"
        if not wrong and abs(length) >= tolerances.HUGE_AXIS_VALUE:
            wrong = "is too large"
    if wrong:
        raise MachineDataError(
            f"the tool length{shown or f' {value!r:.40}'} {wrong}", parameter="tool_length_mm",
            permitted=f"a number in mm, below {tolerances.HUGE_AXIS_VALUE:g} in size",
        )  # fmt: skip
    return length


def checked_kinematic(value: object) -> Wanted | None:
    """Return what names a kinematic: an id, a name, a pair of these as a tuple, or None.

    Raises:
        MachineDataError: anything else, including True and "".
    """
    if value is None:
        return None
    if not isinstance(value, tuple | list):
        return _checked_one(value)
    if len(value) != 2:
        text = f"{value!r:.40} is not a kinematic: a pair names those of steps 0 and 1"
        raise MachineDataError(text, parameter="kinematic", permitted=_PERMITTED)
    return _checked_one(value[0]), _checked_one(value[1])


def _checked_one(value: object) -> int | str:
    if isinstance(value, str) and value:
        return value
    number = _as_int(value)
    if number is None or abs(number) >= _HUGE_NUMBER:
        shown = "a huge number" if number else f"{value!r:.40}"
        raise MachineDataError(f"{shown} is not a kinematic", parameter="kinematic", permitted=_PERMITTED)
    return number


def checked_channel(value: object) -> int | None:
    """Return what names a channel: a whole number or None.

    Raises:
        MachineDataError: anything else.
    """
    number = _as_int(value)
    if (number is None and value is not None) or abs(number or 0) >= _HUGE_NUMBER:
        shown = "a huge number" if number else f"{value!r:.40}"
        raise MachineDataError(f"{shown} is not a channel", parameter="channel", permitted="a whole number or None")
    return number


def _as_int(value: object) -> int | None:
    """Return a whole number of any type, also numpy's, as int; None for anything else."""
    if value is None or isinstance(value, bool):
        return None
    try:
        return operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        return None


def name_right_channel(
    error: MachineDataError, entries: Sequence[KinematicEntry], wanted: Wanted | None, channel: int
) -> None:
    """Add to an error on a kinematic that a channel lacks which other channel has it; of a pair, both."""
    if wanted is None:
        return
    parts = list(enumerate(wanted)) if isinstance(wanted, tuple) else [(None, wanted)]
    others = dict.fromkeys(entry.channel for entry in entries if entry.channel != channel)
    having = [
        other
        for other in others
        if all(_matching([e for e in entries if e.channel == other and step in (None, e.step)], w) for step, w in parts)
    ]
    if having:
        channels = " and ".join(map(str, having))
        error.message = f"channel {channel} configures no kinematic {wanted!r}"
        error.hint = f"it is in channel {channels}: choose that channel"


def choose_pair(
    entries: Sequence[KinematicEntry], wanted: tuple[int | str, int | str], file: str
) -> tuple[KinematicEntry, KinematicEntry]:
    """Return the entries of step 0 and step 1 that a pair names.

    Raises:
        MachineDataError: there is no second step, or a step has no such kinematic; the ones it has are listed.
    """
    steps = [[entry for entry in entries if entry.step == step] for step in (0, 1)]
    permitted = "; ".join(f"step {n}: {_labels(steps[n]) or 'none'}" for n in (0, 1))
    if not steps[1]:
        text = f"the pair {_pair(wanted)} needs two transformation steps; the file configures one"
        raise MachineDataError(text, span=Span(file), parameter="kinematic", permitted=f"one of {_labels(steps[0])}")
    wrong = [n for n in (0, 1) if not _matching(steps[n], wanted[n])]
    if wrong:
        lacks = " and ".join(f"step {n} has no kinematic {wanted[n]!r:.60}" for n in wrong)
        reversed_fits = all(_matching(steps[n], wanted[1 - n]) for n in (0, 1))
        hint = "the pair is (step 0, step 1); step 0 is next to the machine" if reversed_fits else None
        text = f"the file configures no pair {_pair(wanted)}: {lacks}"
        raise MachineDataError(text, span=Span(file), parameter="kinematic", permitted=permitted, hint=hint)
    return choose_kinematic(steps[0], wanted[0], file), choose_kinematic(steps[1], wanted[1], file)


def _pair(wanted: tuple[int | str, int | str]) -> str:
    return f"({wanted[0]!r:.60}, {wanted[1]!r:.60})"


def _labels(entries: Iterable[KinematicEntry]) -> str:
    return ", ".join(entry.label for entry in entries)


def choose_kinematic(entries: Sequence[KinematicEntry], wanted: int | str | None, file: str) -> KinematicEntry:
    """Return the entry that `wanted` names by id or name; None: the one marked default.

    Of several with the same id the one without a name is taken, which no name could select, else the first.

    Raises:
        MachineDataError: no kinematic is configured, or none is `wanted`.
    """
    if not entries:
        raise MachineDataError("the file configures no kinematic", span=Span(file))
    if wanted is None:
        return next((entry for entry in entries if entry.default), entries[0])
    matches = _matching(entries, wanted)
    if not matches:
        shown = [e.label for e in entries]
        known = listed(str(wanted), shown, called=[e.name or str(e.id) for e in entries])
        raise MachineDataError(
            f"the file configures no kinematic {wanted!r:.60}", span=Span(file), parameter="kinematic", permitted=known
        )
    return next((e for e in matches if not e.name), matches[0])


def checked_values(values: Mapping[Datum, float]) -> None:
    """Refuse what is no map of data to numbers.

    Raises:
        ChainbuildError: a key that is no datum, such as its name, or a value that is no number.
    """
    data = "data of geometry() and tool_data()"
    if not isinstance(values, Mapping):
        raise ChainbuildError(f"expected a dict of {data}, got {type(values).__name__}", parameter="values")
    for datum, value in values.items():
        if not isinstance(datum, Datum):
            text = f"{datum!r:.60} is no datum; a name may belong to several"
            raise ChainbuildError(text, parameter="values", permitted=data, hint=_BY_NAME)
        if not isinstance(value, Real):
            text, unit = f"the value of {datum.name} is no number: {value!r:.60}", datum.unit or "its unit"
            raise ChainbuildError(text, parameter="values", permitted=f"a number in {unit}")


def _matching(entries: Sequence[KinematicEntry], wanted: int | str) -> list[KinematicEntry]:
    """Return the entries with a name, else those with an id."""
    return [e for e in entries if wanted == e.name] or matching_id(entries, wanted)


def matching_id(entries: Sequence[KinematicEntry], wanted: int | str | None) -> list[KinematicEntry]:
    """Return the entries with an id, given as a number or as its digits."""
    if isinstance(wanted, str):
        if not (wanted.isascii() and wanted.isdigit() and len(wanted) <= _ID_DIGITS):
            return []
        wanted = int(wanted)
    return [entry for entry in entries if entry.id == wanted]
