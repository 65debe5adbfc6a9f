"""Plausibility of the numbers of a list: counts of 1e-4 mm and 1e-4 degrees, or mm and degrees by mistake?"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Final, Literal

from chainbuild import tolerances
from chainbuild.errors import ChainbuildError, Span
from chainbuild.findings import Collector
from chainbuild.formats.twincat.lists.config import RawValue, Trafo
from chainbuild.formats.twincat.lists.hdtable import HdRow, type_data
from chainbuild.formats.twincat.lists.named_parameters import named_parameter, slot_name
from chainbuild.units import deg_from_raw, mm_from_tenth_um, raw_from_mm

Unit = Literal["mm", "deg", "mm or deg", ""]
_UNIVERSAL: Final = 91
TILT: Final = "tilt_angle"  # name of the head offset that leans the inner axis of a head
# Counts of 1e-4 degrees that nobody measures, but everybody means in degrees.
_WHOLE_DEGREES: Final = frozenset({15.0, 30.0, 45.0, 90.0, 180.0, 270.0, 360.0})
# Everything behind a number is a comment. One that is only a unit was probably meant as a unit.
_UNIT_BEHIND: Final = re.compile(
    r"\S+\s+(mm|cm|m|µm|um|°|deg|degrees?|grad|rad|in|inch|zoll)\.?\s*(?:$|[(#;/])", re.IGNORECASE
)


def check_count(entry: RawValue, unit: Unit, collector: Collector) -> None:
    """Warn of a count that looks like a value in mm or degrees: small with a fraction, with a unit, or 90 for an angle.

    Args:
        entry: The number as the list has it.
        unit: Unit of the value that it counts in 1e-4; an empty string for a bare number.
        collector: Takes the finding.
    """
    shown = f"{entry.value:g} is {_scaled(entry.value, unit)}: counts are 1e-4 {unit}" if unit else ""
    if behind := _UNIT_BEHIND.match(entry.raw):
        text = f"'{behind[1]}' behind the value of {entry.name} is read as a comment"
        text += f"; {shown}" if shown else ""
        collector.add("CB511", text, span=entry.span, parameter=entry.name, hint=_hint(entry.value, unit))
    elif unit and _small(entry.value) and _fraction(entry):
        text = f"{entry.name} has a fraction: {shown}"
        collector.add("CB510", text, span=entry.span, parameter=entry.name, hint=_hint(entry.value, unit))
    elif unit == "deg" and abs(entry.value) in _WHOLE_DEGREES:
        text = f"{entry.name} looks like whole degrees: {shown}"
        collector.add("CB441", text, span=entry.span, parameter=entry.name, hint=_hint(entry.value, unit))


def _fraction(entry: RawValue) -> bool:
    return "." in (entry.raw.split(maxsplit=1)[0] if entry.raw else "") or bool(entry.value % 1.0)


def _small(value: float) -> bool:
    return 0.0 < abs(value) < tolerances.SMALL_COUNT


def check_lengths(lengths: Sequence[RawValue], what: str, unit: Unit, collector: Collector) -> None:
    """Warn where all lengths of something are below 0.1 mm: they look like whole millimetres.

    Those that leave a doubt of their own by `check_count` say so themselves.

    Args:
        lengths: The numbers as the list has them.
        what: What they belong to.
        unit: What they count in 1e-4.
        collector: Takes the finding.
    """
    given = [entry for entry in lengths if entry.value]
    if not given or any(not _small(entry.value) for entry in given):
        return
    plain = [entry for entry in given if not _fraction(entry) and not _UNIT_BEHIND.match(entry.raw)]
    if not plain:
        return
    largest = max(plain, key=lambda entry: abs(entry.value))
    shown = f"{largest.name} = {largest.value:g} is {_scaled(largest.value, unit)}"
    text = f"{what} below 0.1 {unit}, the largest: {shown}; counts are 1e-4 {unit}"
    hint = _hint(largest.value, unit)
    collector.add("CB440", text, span=largest.span, parameter=largest.name, hint=hint)


def check_counts(trafo: Trafo, collector: Collector) -> None:
    """Warn of every doubtful number of a kinematic."""
    check_param_counts(trafo.params, trafo.type, collector)
    lengths = [entry for k, entry in trafo.params.items() if _param_unit(k, trafo.type) == "mm"]
    for name, entry in trafo.extras.items():
        unit = _named_unit(name)
        if not unit:
            continue
        try:
            number = entry.number()
        except ChainbuildError:
            continue  # the reader reports it
        check_number(number, entry.raw, entry.name, entry.span, unit, collector)
        if unit == "mm":
            lengths.append(RawValue(number, entry.name, entry.span, entry.raw))
    check_lengths(lengths, f"all lengths of kinematic {trafo.id} are", "mm", collector)


def check_param_counts(params: Mapping[int, RawValue], kin_typ: int, collector: Collector) -> None:
    """Warn of doubtful values of param[k], those of a tool among them."""
    for k, entry in params.items():
        row, unit = _row(k, kin_typ), _param_unit(k, kin_typ)
        if row is None or row.name != TILT or abs(entry.value) not in _WHOLE_DEGREES:
            check_count(entry, unit, collector)  # a head that hardly tilts says so itself: `check_tilt`


def _row(k: int, kin_typ: int) -> HdRow | None:
    data = type_data().get(kin_typ)
    return next((row for row in data.hd if row.n == k + 1), None) if data else None


def _param_unit(k: int, kin_typ: int) -> Unit:
    """Return the unit that param[k] counts in 1e-4; empty where it is a bare number or has no meaning."""
    if kin_typ == _UNIVERSAL:
        return _named_unit(slot_name(k))
    row = _row(k, kin_typ)
    return _unit(row.kind) if row is not None else ""


def _unit(kind: str) -> Unit:
    return "mm" if kind == "length" else "deg" if kind == "angle" else ""


def _named_unit(name: str) -> Unit:
    known = named_parameter(name)
    return _unit(known.kind) if known is not None else ""


def _scaled(value: float, unit: Unit) -> str:
    scaled = deg_from_raw(value) if unit == "deg" else mm_from_tenth_um(value)
    return f"{scaled:g} {unit}"


def _hint(value: float, unit: Unit) -> str | None:
    return f"{value:g} {unit} would be {raw_from_mm(value):.10g}" if unit else None


def check_number(value: float, raw: str, name: str, span: Span, unit: Unit, collector: Collector) -> None:
    """Warn of a doubtful number outside a kinematic's parameters; see `check_count`."""
    check_count(RawValue(value, name, span, raw), unit, collector)
