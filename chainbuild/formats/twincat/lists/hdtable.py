"""The head-offset (HD) tables of the KIN_TYPs, as data: one TOML file a type in `data/`."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import resources
from types import MappingProxyType
from typing import Any, Literal

from chainbuild.chain.elements import Axis
from chainbuild.shown import fields_shown
from chainbuild.units import AxisKind, deg_from_raw, mm_from_tenth_um

HdKind = Literal["length", "angle", "flag", "sign", "ratio", "count"]
Carries = Literal["tool", "workpiece"]

_UNITS: Mapping[str, str] = {"length": "mm", "angle": "deg"}


@dataclass(frozen=True, slots=True)
class AxisRow:
    """An axis of a KIN_TYP in channel order.

    Attributes:
        name: Name in the machine's drawing: "X", "C1" … .
        kind: "linear" or "rotary".
        carries: What it moves: the tool or the workpiece.
        meaning: What it does.
    """

    __repr__ = fields_shown

    name: str
    kind: AxisKind
    carries: Carries
    meaning: str


@dataclass(frozen=True, slots=True)
class HdRow:
    """A row of an HD table: HD n is param[n - 1] of a channel list.

    Attributes:
        n: Number, counted from 1.
        name: Name that recipes use: "tool_z".
        kind: length (1e-4 mm in the list), angle (1e-4 degrees), or a bare number: flag, sign, ratio, count.
        default: Value where the list gives none, in the list's counts.
        meaning: What it does.
        effect: What it acts on: "pose", "limit", "control" or "none".
        permitted: Values a flag or sign may have; empty for all others.
    """

    __repr__ = fields_shown

    n: int
    name: str
    kind: HdKind
    default: float
    meaning: str
    effect: str
    permitted: tuple[float, ...] = ()

    @property
    def unit(self) -> str:
        """Unit of the scaled value: "mm", "deg" or an empty string."""
        return _UNITS.get(self.kind, "")

    def scaled(self, raw: float) -> float:
        """Return a list's count in mm or degrees; a bare number as it is."""
        if self.kind == "length":
            return mm_from_tenth_um(raw)
        return deg_from_raw(raw) if self.kind == "angle" else raw


@dataclass(frozen=True, slots=True)
class TypeData:
    """The KIN_TYP manual's tables of one type.

    Attributes:
        number: KIN_TYP.
        title: English title.
        family: "head", "table", "arm" … .
        manual: Section of the manual.
        orientation: "rtcp" (machine angles are programmed), "complete" (a pose is) or "listed" (the list decides).
        summary: Structure and zero position in words.
        axes: Axes in channel order; empty where the list gives them (91, 210).
        hd: HD rows in the order of their numbers; empty where there is no table (91, 210).
        display: What is displayed beside the position, as fields of `Display`; empty: by `orientation`.
    """

    __repr__ = fields_shown

    number: int
    title: str
    family: str
    manual: str
    orientation: Literal["rtcp", "complete", "listed"]
    summary: str
    axes: tuple[AxisRow, ...]
    hd: tuple[HdRow, ...]
    display: Mapping[str, Any] = field(default_factory=dict)

    def row(self, key: str | int) -> HdRow:
        """Return an HD row by name or number.

        Raises:
            KeyError: there is none; recipes name rows, so this is an error in the recipe.
        """
        for row in self.hd:
            if key in (row.n, row.name):
                return row
        raise KeyError(f"KIN_TYP {self.number} has no HD {key!r}")

    def unlimited_axes(self) -> tuple[Axis, ...]:
        """Return the axes in channel order without limits."""
        return tuple(Axis.unlimited(row.name, row.kind, row.carries) for row in self.axes)


@cache
def type_data() -> Mapping[int, TypeData]:
    """Return the data of every KIN_TYP that has a file, by number; a recipe may still be missing."""
    folder = resources.files("chainbuild").joinpath("formats/twincat/data")
    found = {}
    for entry in sorted(folder.iterdir(), key=lambda item: item.name):
        if entry.name.startswith("kin") and entry.name.endswith(".toml"):
            data = _type_data(tomllib.loads(entry.read_text("utf-8")))
            found[data.number] = data
    return MappingProxyType(found)


def _type_data(raw: Mapping[str, Any]) -> TypeData:
    axes = tuple(AxisRow(**row) for row in raw["axes"])
    rows = [HdRow(**{**row, "permitted": tuple(row.get("permitted", ()))}) for row in raw["hd"]]
    return TypeData(
        number=raw["kin_typ"],
        title=raw["title"],
        family=raw["family"],
        manual=raw["manual"],
        orientation=raw["orientation"],
        summary=raw["summary"].strip(),
        axes=axes,
        hd=tuple(sorted(rows, key=lambda row: row.n)),
        display=MappingProxyType(raw.get("display", {})),
    )
