"""KIN_TYP 98: the tool grows with its tilt, so that its head keeps a minimum distance from the surface.

The manual gives the rule of the length but no axes and no chain: what carries the tool is the convention
`kin98_carrier`, by default the head of KIN_TYP 9 without offsets::

      X, Y, Z ──o
                C   about Z
                A   about X
                |   HD1 where it counts (convention kin98_hd1)
               [ ]  clamped tool; effective length down
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import isnan, nan, pi, radians, remainder, tan, tau
from typing import Final

from chainbuild.chain.assemble import linear
from chainbuild.convention import Choices
from chainbuild.errors import ChainbuildError, MachineDataError, UnsupportedKinematicError
from chainbuild.formats.twincat.maps.length import TiltLengthMap
from chainbuild.formats.twincat.recipes.parts import tool_end, tool_slides
from chainbuild.formats.twincat.recipes.recipe import Drive, Params, Recipe, RecipeFunction, driven
from chainbuild.frames import cos_sin_deg
from chainbuild.units import deg_from_rad, m_from_mm

_ANGLE_SLACK_DEG: Final = 1e-9  # a tilt brought from degrees to radians and back still counts as within the limit
_UPSIDE_DOWN_DEG: Final = 180.0  # no tool leans farther


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

    def refusal(self, tilt_deg: float) -> MachineDataError | None:
        """Return the error of a tilt above the limit, or None."""
        if abs(tilt_deg) <= self.limit_deg:
            return None
        return MachineDataError(
            f"the tool leans by {abs(tilt_deg):g} deg", parameter="HD4", permitted=f"up to {self.limit_deg:g} deg"
        )

    def _check(self, tilt_deg: float) -> None:
        refusal = self.refusal(tilt_deg)
        if refusal is not None:
            raise refusal


@dataclass(frozen=True, slots=True)
class DistanceExtension:
    """What the law adds to the length at no tilt, as a function of the swivel axis' angle [rad]; see `TiltLaw`."""

    law: DistanceLaw

    def extension(self, angle: float) -> float:
        """Return what is added to the length [m]; not a number above the limit."""
        tilt = self._tilt_deg(angle)
        if isnan(tilt):
            return nan
        return m_from_mm(self.law.effective_mm(tilt) - self.law.effective_mm(0.0))

    def slope(self, angle: float) -> float:
        """Return the derivative [m/rad]; 0 above the limit."""
        tilt = self._tilt_deg(angle)
        return 0.0 if isnan(tilt) else m_from_mm(self.law.slope_mm_per_rad(tilt))

    def bounds(self, low: float, high: float) -> tuple[float, float]:
        """Return bounds [m]: the length changes in one direction only, up to the end of the law or the limit."""
        law, tilt = self.law, min(max(abs(low), abs(high)), pi)
        farthest = m_from_mm(law.effective_mm(min(deg_from_rad(tilt), law.limit_deg)) - law.effective_mm(0.0))
        return min(0.0, farthest), max(0.0, farthest)

    def refusal(self, angle: float) -> ChainbuildError | None:
        """Return the error of a tilt above the limit, or None."""
        return self.law.refusal(deg_from_rad(remainder(angle, tau))) if isnan(self._tilt_deg(angle)) else None

    def formula(self, angle: str) -> None:
        """Return None: the law has three ranges."""

    def _tilt_deg(self, angle: float) -> float:
        """Return the signed tilt, brought to the limit where rounding has led beyond; not a number above it."""
        tilt, limit = deg_from_rad(remainder(angle, tau)), self.law.limit_deg
        if abs(tilt) > limit + _ANGLE_SLACK_DEG:
            return nan
        return max(-limit, min(limit, tilt))


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


def kin_98(p: Params, choose: Choices) -> Recipe:
    """Build the C/A head whose tool grows with its tilt.

    Raises:
        UnsupportedKinematicError: convention `kin98_carrier` names no carrier.
    """
    if choose["kin98_carrier"] == "refused":
        raise UnsupportedKinematicError(
            "KIN_TYP 98 (tool length that keeps a minimum distance) cannot be built: the KIN_TYP manual names neither "
            "its axes nor its chain",
            span=p.span,
            parameter="type",
            permitted="the KIN_TYP of the machine that carries the head",
            hint="convention kin98_carrier=ca_head assumes a C/A head",
        )
    law = _limited_law(p, choose)
    text = "the KIN_TYP manual names neither axes nor chain of KIN_TYP 98; a C/A head like that of KIN_TYP 9 is assumed"
    p.collector.add("CB425", text, span=p.span, hint="convention kin98_carrier=refused refuses the type")
    p.note("CB421", "inclination_start", "the tool's length follows the tilt A: a URDF file holds it as the free joint "
           "'extension'")  # fmt: skip
    tool = [*tool_slides(), driven("C", "z", Drive()), driven("A", "x", Drive()), *tool_end(p, z=-law.head_mm)]
    axes = p.axes
    if law.limit_deg < _UPSIDE_DOWN_DEG:
        most = law.limit_deg
        axes = tuple(replace(axis, lower=-most, upper=most) if axis.name == "A" else axis for axis in axes)
    tool.append(linear("extension", "-z", drive={}))
    return Recipe(tool=tool, axes=axes, axis_map=TiltLengthMap.of(DistanceExtension(law)))


def _limited_law(p: Params, choose: Choices) -> DistanceLaw:
    """Return the law of a configured type; a limit that permits no tilt is refused."""
    law = distance_law(p, choose)
    if law.limit_deg > 0:
        return law
    text = f"HD4 is {law.limit_deg:g} deg: above that inclination the controller stops, so that the tool could not tilt"
    p.refuse("inclination_limit", text, "an angle above 0 deg")
    return replace(law, limit_deg=_UPSIDE_DOWN_DEG)


RECIPES: Final[Mapping[int, RecipeFunction]] = {98: kin_98}
