"""Plausibility of the numbers of a list: counts of 1e-4 mm and 1e-4 degrees, or mm and degrees by mistake?"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Final, Literal

from chainbuild import tolerances
from chainbuild.errors import ChainbuildError, Span
from chainbuild.findings import Collector
from chainbuild.formats.twincat.lists.config import RawValue, Trafo
from chainbuild.formats.twincat.lists.hdtable import type_data
from chainbuild.formats.twincat.lists.named_parameters import named_parameter, slot_name
from chainbuild.units import deg_from_raw, mm_from_tenth_um, raw_from_mm

Unit = Literal["mm", "deg", "mm or deg", ""]
_UNIVERSAL: Final = 91
# Everything behind a number is a comment. One that is only a unit was probably meant as a unit.
_UNIT_BEHIND: Final = re.compile(
    r"\S+\s+(mm|cm|m|µm|um|°|deg|degrees?|grad|rad|in|inch|zoll)\.?\s*(?:$|[(#;/])", re.IGNORECASE
)


def check_count(entry: RawValue, unit: Unit, collector: Collector) -> None:
    """Warn of a count that looks like a value in mm or degrees: with a fraction though small, or with a unit.

    Args:
        entry: The number as the list has it.
        unit: Unit of the value that it counts in 1e-4; an empty string for a bare number.
        collector: Takes the finding.
    """
    token = entry.raw.split(maxsplit=1)[0] if entry.raw else ""
    shown = f"{entry.value:g} is {_scaled(entry.value, unit)}: counts are 1e-4 {unit}" if unit else ""
    if behind := _UNIT_BEHIND.match(entry.raw):
        text = f"'{behind[1]}' behind the value of {entry.name} is read as a comment"
        text += f"; {shown}" if shown else ""
        collector.add("CB511", text, span=entry.span, parameter=entry.name, hint=_hint(entry.value, unit))
    elif unit and 0.0 < abs(entry.value) < tolerances.FRACTIONAL_COUNT and ("." in token or entry.value % 1.0):
        text = f"{entry.name} has a fraction: {shown}"
        collector.add("CB510", text, span=entry.span, parameter=entry.name, hint=_hint(entry.value, unit))


def check_counts(trafo: Trafo, collector: Collector) -> None:
    """Warn of every doubtful number of a kinematic."""
    check_param_counts(trafo.params, trafo.type, collector)
    for name, entry in trafo.extras.items():
        unit = _named_unit(name)
        if not unit:
            continue
        try:
            number = entry.number()
        except ChainbuildError:
            continue  # the reader reports it
        check_number(number, entry.raw, entry.name, entry.span, unit, collector)


def check_param_counts(params: Mapping[int, RawValue], kin_typ: int, collector: Collector) -> None:
    """Warn of doubtful values of param[k], those of a tool among them."""
    data = type_data().get(kin_typ)
    units = {row.n - 1: _unit(row.kind) for row in data.hd} if data else {}
    for k, entry in params.items():
        check_count(entry, _named_unit(slot_name(k)) if kin_typ == _UNIVERSAL else units.get(k, ""), collector)


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
