"""Catalogue of SINUMERIK machine data: name, unit, permitted values and default of each datum."""

import math
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import Any, Final, Literal

DatumType = Literal["int", "float", "bool", "hex", "string"]
Prefix = Literal["MC", "MA", "MN", "ON", "SN", "SC", "TC"]
IndexKind = Literal["element", "axis", "tool"]
Group = Literal["geometry", "axes", "tool", "additional_axes", "solver", "dynamics", "control", "standard"]
ValueRange = tuple[float | None, float | None]

_ROBX = "ROBX_"
_TE4 = "TRAFO6_"
# The older TE4 package numbers the same data 300 lower: 62620 AXIS_SEQ is 62920 (ROBX manual 5.3.15).
_TE4_DISTANCE: Final = 300


@dataclass(frozen=True, slots=True)
class MachineDatum:
    """One machine, setting or tool datum.

    Attributes:
        number: MD or SD number; None for tool data and where only the name is known.
        name: Identifier without ``$`` and prefix.
        prefix: Letters after ``$``: MC channel, MA axis, MN NC, ON option, SN and SC setting, TC tool.
        type: Kind of value; ``hex`` is a bit mask, ``bool`` holds 0 or 1.
        unit: Unit the controller counts in; ``mm_or_deg`` follows the kind of the axis.
        dimension: Number of elements; 1 for a scalar, 0 where no source states the length.
        indexed_by: Index in brackets: element number, machine axis, or tool and cutting edge.
        default: One value for each element; None where no source gives it.
        default_known: The leading elements of a default whose rest is missing in the copy of the manual.
        minimum: Lower limit; None where the manual gives none.
        maximum: Upper limit; None where the manual gives none.
        element_ranges: Limits of each element where they differ (RPY angles).
        step: Values from 0 on are multiples of this; None for any.
        permitted: The discrete values the manual names; empty for a continuous datum.
        labels: Meaning of each permitted value; empty where the value speaks for itself.
        lost: Fields that are missing in the copy of the manual.
        meaning: What the datum means.
        group: Topic.
        manual: Sections of the ROBX manual; empty for general data it does not list.
        aliases: Other spellings the manual itself uses.
        alternative_prefix: Another prefix the manual itself uses.
        family: Name with ``{n}`` of the numbered family this datum belongs to.
        member: Its number in the family.
    """

    number: int | None
    name: str
    prefix: Prefix
    type: DatumType
    unit: str
    dimension: int
    indexed_by: IndexKind
    default: tuple[float, ...] | None
    default_known: tuple[float, ...]
    minimum: float | None
    maximum: float | None
    element_ranges: tuple[tuple[float, float], ...]
    step: int | None
    permitted: tuple[float, ...]
    labels: tuple[str, ...]
    lost: tuple[str, ...]
    meaning: str
    group: Group
    manual: str
    aliases: tuple[str, ...]
    alternative_prefix: Prefix | None
    family: str | None
    member: int | None

    @property
    def identifier(self) -> str:
        """Name as written in a machine data file, for example ``$MC_ROBX_MAIN_AXES``."""
        return f"${self.prefix}_{self.name}"

    @property
    def te4_name(self) -> str | None:
        """Name of the same datum in the older TE4 package, or None for data that are not ROBX's."""
        return _TE4 + self.name.removeprefix(_ROBX) if self.name.startswith(_ROBX) else None

    @property
    def te4_number(self) -> int | None:
        """Number of the same datum in the older TE4 package, or None for data that are not ROBX's."""
        return self.number - _TE4_DISTANCE if self.number is not None and self.te4_name else None

    def limits(self, index: int = 0) -> ValueRange:
        """Return minimum and maximum of an element in the datum's unit; None where there is no limit."""
        if self.element_ranges:
            return self.element_ranges[index]
        return self.minimum, self.maximum

    def permits(self, value: float, index: int = 0) -> bool:
        """Tell whether an element may hold a value, by type, discrete values, limits and step (ROBX manual 11.2)."""
        if not math.isfinite(value) or (self.type != "float" and value != int(value)):
            return False
        if self.permitted:
            return value in self.permitted
        minimum, maximum = self.limits(index)
        inside = (minimum is None or value >= minimum) and (maximum is None or value <= maximum)
        return inside and (self.step is None or value < 0 or value % self.step == 0)

    def permitted_text(self, index: int = 0) -> str:
        """Describe in words what an element may hold, for an error message."""
        if self.permitted:
            return _alternatives(self.permitted)
        minimum, maximum = self.limits(index)
        if minimum is not None and maximum is not None:
            text = f"{minimum:.10g} to {maximum:.10g}"
        elif minimum is not None:
            text = f"{minimum:.10g} or more"
        elif maximum is not None:
            text = f"{maximum:.10g} or less"
        else:
            text = "any number"
        return text if self.step is None else f"{text}, from 0 on multiples of {self.step}"


@cache
def catalogue() -> Mapping[str, MachineDatum]:
    """Return all data by name; families appear with each of their members."""
    source = files("chainbuild.formats.sinumerik").joinpath("data", "machine_data.toml")
    entries = tomllib.loads(source.read_text(encoding="utf-8"))["datum"]
    return MappingProxyType({datum.name: datum for entry in entries for datum in _members(entry)})


@cache
def by_number() -> Mapping[int, MachineDatum]:
    """Return the numbered data by MD or SD number; TE4 numbers are left to :func:`lookup_number`."""
    return MappingProxyType({datum.number: datum for datum in catalogue().values() if datum.number is not None})


def lookup(name: str) -> MachineDatum | None:
    """Find a datum by name, with or without ``$`` and prefix, in ROBX's or TE4's spelling; None if it is unknown."""
    prefix = None
    if name.startswith("$"):
        prefix, _, name = name[1:].partition("_")
    datum = _by_spelling().get(name.upper())
    if datum is None or prefix is None or prefix.upper() in (datum.prefix, datum.alternative_prefix):
        return datum
    return None


def lookup_number(number: int) -> MachineDatum | None:
    """Find a datum by its MD or SD number, in ROBX's or TE4's numbering; None if it is unknown."""
    datum = by_number().get(number)
    if datum is not None:
        return datum
    datum = by_number().get(number + _TE4_DISTANCE)
    return datum if datum is not None and datum.te4_number == number else None


@cache
def _by_spelling() -> Mapping[str, MachineDatum]:
    spellings: dict[str, MachineDatum] = {}
    for datum in catalogue().values():
        names = (datum.name, *datum.aliases) if datum.te4_name is None else (datum.name, *datum.aliases, datum.te4_name)
        spellings.update(dict.fromkeys(names, datum))
    return MappingProxyType(spellings)


def _members(entry: Mapping[str, Any]) -> Iterator[MachineDatum]:
    """Yield the datum of an entry, or one for each member of a family."""
    if "family" not in entry:
        yield _datum(entry, entry["name"], entry.get("number"), None)
        return
    first, last = entry["family"]
    numbers = dict(enumerate(entry.get("family_numbers", ()), start=first))
    for n in range(first, last + 1):
        yield _datum(entry, entry["name"].format(n=n), numbers.get(n), n)


def _datum(entry: Mapping[str, Any], name: str, number: int | None, member: int | None) -> MachineDatum:
    default = entry.get("default")
    return MachineDatum(
        number=number,
        name=name,
        prefix=entry["prefix"],
        type=entry["type"],
        unit=entry["unit"],
        dimension=entry["dimension"],
        indexed_by=entry.get("indexed_by", "element"),
        default=None if default is None else tuple(default),
        default_known=tuple(entry.get("default_known", ())),
        minimum=entry.get("minimum"),
        maximum=entry.get("maximum"),
        element_ranges=tuple((low, high) for low, high in entry.get("element_ranges", ())),
        step=entry.get("step"),
        permitted=tuple(entry.get("permitted", ())),
        labels=tuple(entry.get("labels", ())),
        lost=tuple(entry.get("lost", ())),
        meaning=entry["meaning"],
        group=entry["group"],
        manual=entry.get("manual", ""),
        aliases=tuple(alias.format(n=member) for alias in entry.get("aliases", ())),
        alternative_prefix=entry.get("alternative_prefix"),
        family=None if member is None else entry["name"],
        member=member,
    )


def _alternatives(values: tuple[float, ...]) -> str:
    *head, last = (f"{value:g}" for value in values)
    return f"{', '.join(head)} or {last}" if head else last
