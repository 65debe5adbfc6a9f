"""KIN_TYP 98: the tool grows with its tilt, so that its head keeps a minimum distance from the surface.

The manual gives the rule of the length but no axes and no chain; the type is named and refused as a machine of its
own, and the rule stands here for itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import radians, tan
from typing import Final

from chainbuild.conventions import Choices
from chainbuild.errors import MachineDataError, UnsupportedKinematicError
from chainbuild.frames import cos_sin_deg
from chainbuild.twincat.recipe import Params, Recipe, RecipeFunction


@dataclass(frozen=True, slots=True)
class DistanceLaw:
    """How the effective tool length follows the tilt (KIN_TYP manual 2.39).

    Up to `start_deg` the length is that of the tool. From there to `end_deg` it grows so that the head's height above
    the surface stays what it was at `start_deg`; beyond it stays. Above `limit_deg` the controller stops.

    Attributes:
        length_mm: Tool length.
        start_deg: Tilt from which the distance is kept (HD2).
        end_deg: Tilt up to which it is kept (HD3).
        limit_deg: Largest permitted tilt (HD4).
        head_mm: What HD1 adds, 0 where it does not count as tool length (convention `kin98_hd1`).
    """

    length_mm: float
    start_deg: float
    end_deg: float
    limit_deg: float
    head_mm: float = 0.0

    def effective_mm(self, tilt_deg: float) -> float:
        """Return the effective tool length at a tilt of the tool against the surface's normal.

        Raises:
            MachineDataError: the tilt exceeds the limit.
        """
        self._check(tilt_deg)
        if abs(tilt_deg) <= self.start_deg:
            return self.head_mm + self.length_mm
        held, leaning = cos_sin_deg(self.start_deg)[0], cos_sin_deg(min(abs(tilt_deg), self.end_deg))[0]
        return self.head_mm + self.length_mm * held / leaning

    def slope_mm_per_rad(self, tilt_deg: float) -> float:
        """Return the derivative of the effective length by the tilt; the one from below where it jumps.

        Raises:
            MachineDataError: the tilt exceeds the limit.
        """
        self._check(tilt_deg)
        if not self.start_deg < abs(tilt_deg) <= self.end_deg:
            return 0.0
        return (self.effective_mm(tilt_deg) - self.head_mm) * tan(radians(tilt_deg))

    def _check(self, tilt_deg: float) -> None:
        if abs(tilt_deg) > self.limit_deg:
            raise MachineDataError(
                f"the tool leans by {abs(tilt_deg):g} deg", parameter="HD4", permitted=f"up to {self.limit_deg:g} deg"
            )


def distance_law(p: Params, choose: Choices) -> DistanceLaw:
    """Return the law of a configured KIN_TYP 98.

    Raises:
        MachineDataError: not 0 <= HD2 <= HD3 < 90 degrees.
    """
    start, end, limit = p.deg("inclination_start"), p.deg("inclination_end"), p.deg("inclination_limit")
    if not 0 <= start <= end < 90:
        p.refuse("inclination_end", f"HD2 is {start:g} deg, HD3 {end:g} deg", "0 <= HD2 <= HD3 < 90 deg")
        start = end = 0.0
    head = p.mm("tool_z")
    counted = head if head and choose["kin98_hd1"] == "added" else 0.0
    return DistanceLaw(p.tool_length_mm, start, end, limit, counted)


def kin_98(p: Params, _choose: Choices) -> Recipe:
    """Refuse the type by name.

    Raises:
        UnsupportedKinematicError: always.
    """
    raise UnsupportedKinematicError(
        "KIN_TYP 98 (tool length that keeps a minimum distance) cannot be built: the KIN_TYP manual names neither its "
        "axes nor its chain",
        span=p.span,
        parameter="type",
        permitted="the KIN_TYP of the machine that carries the head",
        hint="chainbuild.twincat.families.minimum_distance.DistanceLaw gives the effective tool length",
    )


RECIPES: Final[Mapping[int, RecipeFunction]] = {98: kin_98}
