"""What the named parameters of a kinematic mean: those of KIN_TYP 91 and 210, and the basic offsets."""

from __future__ import annotations

import difflib
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Final, Literal

from chainbuild.units import deg_from_raw, mm_from_tenth_um

_INDEX: Final = re.compile(r"\[(\d+)\]")
_ANGLES: Final = (3, 4, 5)  # indices of base[] behind those of the position
# What every kinematic has and how it is written; the last two act in a coupling.
_GENERAL: Final = {"id": "id", "type": "type", "name": "name", "param": "param[k]", "base": "base[k]",
                   "lock_dof": "lock_dof[k]"}  # fmt: skip


@dataclass(frozen=True, slots=True)
class NamedParameter:
    """A parameter with a name.

    Attributes:
        kind: "length" (1e-4 mm), "angle" (1e-4 degrees) or "bare".
        source: Its number among the channel parameters.
        meaning: What it does.
        slot: Its numbers of PARAM[] in KIN_TYP 91, or an empty string.
    """

    kind: Literal["length", "angle", "bare"]
    source: str
    meaning: str
    slot: str = ""

    @property
    def unit(self) -> str:
        """Unit of the scaled value."""
        return {"length": "mm", "angle": "deg", "bare": ""}[self.kind]

    def scaled(self, value: float | str) -> float | str:
        """Return a list's count in mm or degrees; anything else as it is."""
        if isinstance(value, str) or self.kind == "bare":
            return value
        return mm_from_tenth_um(value) if self.kind == "length" else deg_from_raw(value)


@cache
def named_parameters() -> Mapping[str, NamedParameter]:
    """Return the named parameters by their names without indices."""
    text = resources.files("chainbuild").joinpath("formats/twincat/data/named_parameters.toml").read_text("utf-8")
    return {name: NamedParameter(**row) for name, row in tomllib.loads(text).items()}


def named_parameter(name: str) -> NamedParameter | None:
    """Return what a name behind the dot of trafo[j] means, or None.

    >>> named_parameter("axis[1].point[2]").unit
    'mm'
    """
    key = _INDEX.sub("", name)
    if key == "base":
        index = _INDEX.search(name)
        key = "base.angle" if index and int(index[1]) in _ANGLES else "base.position"
    return named_parameters().get(key)


def is_general(name: str) -> bool:
    """Return whether a name behind the dot of trafo[j] is a named parameter of every kinematic in a coupling."""
    return named_parameter(name) is not None and _INDEX.sub("", name) in _GENERAL


def nearest_name(name: str) -> str | None:
    """Return how a name behind the dot of trafo[j] was probably meant.

    >>> nearest_name("paramm[0]"), nearest_name("param[1][2]"), nearest_name("foo")
    ('param[k]', 'param[k]', None)
    """
    known = {**{key: key for key in named_parameters()}, **_GENERAL}
    close = difflib.get_close_matches(_INDEX.sub("", name)[:80], known, 1)
    return known[close[0]] if close else None


def slot_name(slot: int) -> str:
    """Return the name that a PARAM[] slot of KIN_TYP 91 stands for.

    >>> slot_name(12)
    'axis[0].point[1]'
    """
    if slot < 7:
        return (*(f"zero_orientation[{i}]" for i in range(3)), *(f"zero_position[{i}]" for i in range(3)),
                "number_of_axes")[slot]  # fmt: skip
    axis, part = divmod(slot - 7, 7)
    parts = ("type", *(f"orientation[{i}]" for i in range(3)), *(f"point[{i}]" for i in range(3)))
    return f"axis[{axis}].{parts[part]}"
