"""Axis lists: software limits and the modulo mode of the machine's axes.

`kenngr.swe_neg` and `kenngr.swe_pos` (P-AXIS-00177, P-AXIS-00178) count in 1e-4 mm or 1e-4 degrees;
bit 4 of `kenngr.achs_mode` (P-AXIS-00015) says that the axis turns without end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final

from chainbuild.chain.elements import Axis
from chainbuild.chain.names import generic_name
from chainbuild.errors import Span
from chainbuild.findings import Collector
from chainbuild.formats.twincat.lists.config import ChannelAxis, RawValue, errors_collected_by
from chainbuild.formats.twincat.lists.counts import Unit, check_lengths, check_number
from chainbuild.formats.twincat.lists.reader import ParameterList
from chainbuild.units import deg_from_raw, mm_from_tenth_um

_LIMITS: Final = ("kenngr.swe_neg", "kenngr.swe_pos")
_MODULO: Final = 0x4  # bit of the axis mode: a modulo axis
_UNS32: Final = 2**32 - 1  # largest value of the mode, an unsigned 32-bit number


@dataclass(frozen=True, slots=True)
class AxisList:
    """Contents of one axis list.

    Attributes:
        span: Where it begins.
        names: Names it goes by: kopf.log_achs_name, or those of the container.
        number: Logical axis number (kopf.achs_nr), or None.
        index: Channel index (`DefaultIndex` of a container), or None.
        lower: Lower software limit in the list's counts, or None.
        upper: Upper software limit, or None.
        modulo: True for an axis that turns without end.
        drive_type: kenngr.antr_typ (P-AXIS-00020), or None.
        measures: True where kenngr.messachse (P-AXIS-00118) says that it takes part in measuring.
    """

    span: Span | None
    names: tuple[str, ...]
    number: int | None
    index: int | None
    lower: float | None
    upper: float | None
    modulo: bool
    drive_type: int | None = None
    measures: bool = False


def read_axis_list(parameters: ParameterList, facts: Mapping[str, str], collector: Collector) -> AxisList:
    """Type an axis list.

    Args:
        parameters: The list.
        facts: Short texts beside it in a container: `Name`, `DefaultProgName`, `DefaultIndex` … .
        collector: Takes findings.

    Raises:
        ParseError: a value is not a number.
    """

    def number(name: str) -> float | None:
        entry = parameters.get(name)
        if entry is not None:
            with errors_collected_by(collector):
                value = entry.number()
                unit: Unit = "mm or deg" if name in _LIMITS else ""
                check_number(value, entry.raw, entry.name, entry.span, unit, collector)
                return value
        return None

    named = parameters.get("kopf.log_achs_name")
    names = [facts.get(key, "") for key in ("DefaultProgName", "Name", "ItemName")]
    with errors_collected_by(collector):
        if named is not None:
            names.insert(0, named.text())
    mode = parameters.get("kenngr.achs_mode")
    modulo = False
    with errors_collected_by(collector):
        modulo = mode is not None and bool(mode.integer(0, _UNS32) & _MODULO)
    axis_number, drive_type = number("kopf.achs_nr"), number("kenngr.antr_typ")
    lower, upper = (number(name) for name in _LIMITS)
    ends = zip(_LIMITS, (lower, upper), strict=True)
    limits = [
        RawValue(value, entry.name, entry.span, entry.raw)
        for name, value in ends
        if value is not None and (entry := parameters.get(name)) is not None
    ]
    shown = next((name for name in names if name), "without a name")
    check_lengths(limits, f"the software limits of axis {shown} are", "mm or deg", collector)
    index = facts.get("DefaultIndex", "")
    return AxisList(
        span=parameters.span,
        names=tuple(name for name in names if name),
        number=None if axis_number is None else int(axis_number),
        index=int(index) if index.isascii() and index.isdigit() else None,
        lower=lower,
        upper=upper,
        modulo=modulo,
        drive_type=None if drive_type is None else int(drive_type),
        measures=bool(number("kenngr.messachse")),
    )


def with_limits(
    axes: Sequence[Axis],
    channel: Mapping[int, ChannelAxis],
    lists: Sequence[AxisList],
    collector: Collector,
    ahead: int = 0,
) -> tuple[Axis, ...]:
    """Return the axes with the limits of their lists.

    A list belongs to the axis that the channel calls by the same name or logical number, or whose channel index it
    has. Where none does, the type's own axis names decide if they fit all lists or all axes; else the lists are taken
    in channel order, with a finding. (A channel may call its axes A1 to A6 where KIN_TYP 45 has an A1 of its own.)

    Args:
        axes: Axes in channel order.
        channel: Axes as the channel list names them, by channel index.
        lists: Axis lists in file order.
        collector: Takes findings.
        ahead: How many axes of the channel come before them.
    """
    if not lists:
        return tuple(axes)
    by_channel = {i: list_by_channel(ahead + i, channel.get(ahead + i), lists) for i in range(len(axes))}
    matched = {i: found for i, found in by_channel.items() if found}
    if not matched:
        matched = _by_type(axes, lists)
    if not matched:
        text = "the axis lists name no axis of the kinematic; they are taken in channel order"
        collector.add("CB232", text, span=lists[0].span)
        matched = dict(enumerate(lists[ahead : ahead + len(axes)]))
    return tuple(_limited(axis, matched.get(i), collector) for i, axis in enumerate(axes))


def list_by_channel(index: int, channel: ChannelAxis | None, lists: Iterable[AxisList]) -> AxisList | None:
    """Return the list of an axis of the channel: by name, else by logical number, else by channel index."""
    name = channel.name.lower() if channel else ""
    number = channel.number if channel else None
    tests: tuple[Callable[[AxisList], bool], ...] = (
        lambda entry: name in {known.lower() for known in entry.names} - {""},
        lambda entry: number is not None and entry.number == number,
        lambda entry: entry.index == index,
    )
    return next((entry for test in tests for entry in lists if test(entry)), None)


def _by_type(axes: Sequence[Axis], lists: Sequence[AxisList]) -> dict[int, AxisList]:
    found = {i: entry for i, axis in enumerate(axes) for entry in lists if generic_name(axis) in entry.names}
    return found if len(found) in (len(axes), len(lists)) else {}


def _limited(axis: Axis, entry: AxisList | None, collector: Collector) -> Axis:
    if entry is None:
        return axis
    axis = replace(axis, endless=axis.endless or (entry.modulo and axis.kind == "rotary"))
    scale = mm_from_tenth_um if axis.kind == "linear" else deg_from_raw
    if entry.lower is None or entry.upper is None:
        if entry.lower is None and entry.upper is None:
            return axis
        return _one_sided(axis, entry, scale, collector)
    lower, upper = scale(entry.lower), scale(entry.upper)
    if not lower < upper:
        text = f"the software limits of axis {axis.name} leave no range: {lower:g} to {upper:g} {axis.unit}"
        # Both at one value may mean that none are set; an endless axis ignores them.
        code = "CB230" if lower == upper or axis.endless else "CB234"
        permitted = f"swe_pos above {entry.lower:g}" if code == "CB234" else None
        collector.add(code, text, span=entry.span, parameter="kenngr.swe_neg, kenngr.swe_pos", permitted=permitted)
        return axis
    return replace(axis, lower=lower, upper=upper, assumed=False)


def _one_sided(axis: Axis, entry: AxisList, scale: Callable[[float], float], collector: Collector) -> Axis:
    """Return an axis with the limit that the list gives; the other side is assumed."""
    side, missing = ("upper", "kenngr.swe_neg") if entry.lower is None else ("lower", "kenngr.swe_pos")
    text = f"axis {axis.name} has only the {side} software limit; the other side is assumed"
    collector.add("CB233", text, span=entry.span, parameter=missing)
    if entry.lower is not None:
        lower = scale(entry.lower)
        return replace(axis, lower=lower, upper=max(axis.upper, lower + 1.0), assumed=True)
    upper = scale(entry.upper or 0.0)
    return replace(axis, lower=min(axis.lower, upper - 1.0), upper=upper, assumed=True)
