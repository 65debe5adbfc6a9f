"""The catalogue of KIN_TYPs: HD table, conventions and recipe of every type that is built."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Final

from chainbuild.convention import Choices, Convention, applying_to
from chainbuild.errors import Span, UnsupportedKinematicError
from chainbuild.formats.twincat import families
from chainbuild.formats.twincat.lists.hdtable import AxisRow, HdRow, TypeData, type_data
from chainbuild.formats.twincat.recipes.recipe import Params, Recipe, RecipeFunction
from chainbuild.shown import two_lines

# Given as lists of axes or of kinematics, not by a table of head offsets: built by `translate`, without a recipe.
_LISTS: Final = frozenset({91, 210})
# Named in the KIN_TYP manual, described in a document of their own.
_TUBE_PROCESSING: Final = frozenset({15, 78, 79, 90, 93})


@dataclass(frozen=True, slots=True)
class KinType:
    """A KIN_TYP: what the manual's tables say, and how its chain is built.

    Attributes:
        data: Tables of the type.
        recipe: Builds the branches of the chain; refuses where the list gives axes or kinematics.
    """

    data: TypeData
    recipe: RecipeFunction

    def __repr__(self) -> str:
        axes = "as listed" if self.listed else ", ".join(axis.name for axis in self.axes)
        return two_lines(f"<KinType {self.number}: {self.title}; axes {axes}; {len(self.hd)} HD parameters>")

    @property
    def number(self) -> int:
        """KIN_TYP."""
        return self.data.number

    @property
    def listed(self) -> bool:
        """True where the list gives the axes (91) or the kinematics (210): no axes, no HD table, no recipe."""
        return self.number in _LISTS

    @property
    def title(self) -> str:
        """English title."""
        return self.data.title

    @property
    def family(self) -> str:
        """Family: "head", "table", "arm" … ."""
        return self.data.family

    @property
    def manual(self) -> str:
        """Section of the manual."""
        return self.data.manual

    @property
    def orientation(self) -> str:
        """Orientation: "rtcp", machine angles are programmed; "complete", a pose is; "listed", the list decides."""
        return self.data.orientation

    @property
    def summary(self) -> str:
        """Structure and zero position in words."""
        return self.data.summary

    @property
    def axes(self) -> tuple[AxisRow, ...]:
        """Axes in channel order."""
        return self.data.axes

    @property
    def hd(self) -> tuple[HdRow, ...]:
        """HD table."""
        return self.data.hd

    @property
    def conventions(self) -> tuple[Convention, ...]:
        """What the manual leaves open about this type."""
        return applying_to(["KIN", f"KIN {self.number}"])


def _no_recipe(p: Params, choose: Choices) -> Recipe:
    """Refuse to build a type of head offsets that it does not have."""
    number = p.data.number
    text = f"KIN_TYP {number} ({p.data.title}) is not built from head offsets but from what its list names"
    raise UnsupportedKinematicError(text, span=p.span, parameter="type", permitted="its own parameters", code="CB410")


@cache
def catalogue() -> Mapping[int, KinType]:
    """Return the KIN_TYPs that are built, by number."""
    recipes: dict[int, RecipeFunction] = dict.fromkeys(_LISTS, _no_recipe)
    for module in pkgutil.iter_modules(families.__path__, families.__name__ + "."):
        recipes.update(importlib.import_module(module.name).RECIPES)
    data = type_data()
    return MappingProxyType(
        {number: KinType(data[number], recipes[number]) for number in sorted(recipes) if number in data}
    )


def title_of(kin_typ: int) -> str:
    """Return the English title of any type, built or not."""
    if kin_typ in type_data():
        return type_data()[kin_typ].title
    if kin_typ in _TUBE_PROCESSING:
        return "Tube processing"
    return "unknown type"


def why_unsupported(kin_typ: int) -> str | None:
    """Return why a type is refused, or None where it is built."""
    if kin_typ in catalogue():
        return None
    if kin_typ in _TUBE_PROCESSING:
        return f"KIN_TYP {kin_typ} (tube processing) is not supported: the KIN_TYP manual describes it elsewhere"
    if kin_typ in type_data():
        return f"KIN_TYP {kin_typ} ({title_of(kin_typ)}) is known, but this version does not build it yet"
    return f"KIN_TYP {kin_typ} is unknown"


def kin_type(kin_typ: int, span: Span | None = None) -> KinType:
    """Return a type of the catalogue.

    Raises:
        UnsupportedKinematicError: the type is unknown or not built; the known ones are listed.
    """
    reason = why_unsupported(kin_typ)
    if reason is None:
        return catalogue()[kin_typ]
    known = ", ".join(str(number) for number in catalogue())
    raise UnsupportedKinematicError(reason, span=span, parameter="type", permitted=f"KIN_TYP {known}", code="CB410")
