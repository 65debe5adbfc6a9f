"""Arms of parallel kinematics: the drive between the base and the upper joint of a rod.

The lower end of the rod is seen at the platform's point p, its pins shrunk to one: what an arm knows is where the rod's
upper end stands, the centre of a ball about which p lies.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.units import deg_from_rad, m_from_mm, rad_from_deg

Centre = tuple[float, float, float]

_TOUCHES: Final = 1e-14  # of r²: rounding of a rod that reaches with nothing to spare


@dataclass(frozen=True, slots=True)
class Column:
    """A carriage on a column, driven along Z.

    Attributes:
        angle_deg: Azimuth φ.
        radius: ρ, of the column less that of the platform [m].
        sign: +1 where the axis counts upwards.
    """

    angle_deg: float
    radius: float
    sign: float = 1.0

    kind = "linear"

    def centre(self, value: float) -> tuple[Centre, Centre, float]:
        """Return the centre of the ball [m], its derivative by the axis, and the turn of the rod's frame [rad]."""
        x, y = direction(self.angle_deg)
        return (self.radius * x, self.radius * y, self.sign * value), (0.0, 0.0, self.sign), 0.0

    def place(self, shown: float) -> Centre:
        """Return the centre of the ball [m] at an axis value [mm]: what forward kinematics alone needs."""
        x, y = direction(self.angle_deg)
        return self.radius * x, self.radius * y, self.sign * m_from_mm(shown)

    def centre_rows(self, shown: Vector) -> tuple[Vector, Vector, Vector]:
        """Return the centres of the ball [m] at many axis values [mm]."""
        x, y = direction(self.angle_deg)
        return np.full(len(shown), self.radius * x), np.full(len(shown), self.radius * y), m_from_mm(self.sign) * shown

    def values(self, p: Centre, radius: float, side: float) -> list[float]:
        """Return the axis values [m] for a platform point: one, the carriage above (side 1) or below it."""
        x, y = direction(self.angle_deg)
        square = radius**2 - (p[0] - self.radius * x) ** 2 - (p[1] - self.radius * y) ** 2
        if square < -_TOUCHES * radius**2:
            return []
        return [self.sign * (p[2] + side * math.sqrt(max(square, 0.0)))]

    def missing(self, p: Centre, radius: float) -> float:
        """Return how much longer [m] the rod would have to be for a platform point; 0 or less: it is long enough."""
        x, y = direction(self.angle_deg)
        return math.hypot(p[0] - self.radius * x, p[1] - self.radius * y) - radius

    def standing(self, rod: Centre, value: float) -> tuple[float, str]:
        """Return what the axis moves of the platform point, 0 to ±1, and in words where that is nothing.

        Args:
            rod: Unit vector from the carriage to the platform point.
            value: Axis value [m].
        """
        return self.sign * rod[2], "the rod of {name} stands {nearly}across its column"


@dataclass(frozen=True, slots=True)
class Lever:
    """A lever that turns about the tangent; positive turns lower its tip.

    Attributes:
        angle_deg: Azimuth φ.
        radius: Of the motors less that of the platform [m].
        length: Of the lever [m].
        zero_deg: Axis value at which the lever is level.
    """

    angle_deg: float
    radius: float
    length: float
    zero_deg: float = 0.0

    kind = "rotary"

    def centre(self, value: float) -> tuple[Centre, Centre, float]:
        """Return the centre of the ball [m], its derivative by the axis, and the turn of the rod's frame [rad]."""
        x, y = direction(self.angle_deg)
        angle = value - rad_from_deg(self.zero_deg)
        c, s = math.cos(angle), math.sin(angle)
        out, slope = self.radius + self.length * c, -self.length * s
        return (out * x, out * y, -self.length * s), (slope * x, slope * y, -self.length * c), angle

    def place(self, shown: float) -> Centre:
        """Return the centre of the ball [m] at an axis value [deg]: what forward kinematics alone needs."""
        x, y = direction(self.angle_deg)
        angle = rad_from_deg(shown) - rad_from_deg(self.zero_deg)
        out = self.radius + self.length * math.cos(angle)
        return out * x, out * y, -self.length * math.sin(angle)

    def centre_rows(self, shown: Vector) -> tuple[Vector, Vector, Vector]:
        """Return the centres of the ball [m] at many axis values [deg]."""
        x, y = direction(self.angle_deg)
        angles = np.radians(shown - self.zero_deg)
        out = self.radius + self.length * np.cos(angles)
        return out * x, out * y, -self.length * np.sin(angles)

    def values(self, p: Centre, radius: float, side: float) -> list[float]:
        """Return the axis values [rad] for a platform point: two, the elbow outside first."""
        # In the plane of the lever: |u - length·(cos θ, -sin θ)|² = r² - across².
        x, y = direction(self.angle_deg)
        out, across = p[0] * x + p[1] * y - self.radius, p[1] * x - p[0] * y
        distance = math.hypot(out, p[2])
        square = radius**2 - across**2
        if square < -_TOUCHES * radius**2 or distance == 0.0 or self.length == 0.0:
            return []
        cosine = (distance**2 + self.length**2 - max(square, 0.0)) / (2.0 * distance * self.length)
        if abs(cosine) > 1.0 + _TOUCHES:
            return []
        middle, half = math.atan2(-p[2], out), math.acos(max(-1.0, min(1.0, cosine)))
        both = [middle - half, middle + half]
        both.sort(key=lambda angle: -math.cos(angle))
        return [math.remainder(angle, math.tau) + rad_from_deg(self.zero_deg) for angle in both]

    def missing(self, p: Centre, radius: float) -> float:
        """Return how much longer (positive) or shorter [m] the rod from the lever's tip to a platform point must be."""
        x, y = direction(self.angle_deg)
        out, across = p[0] * x + p[1] * y - self.radius, p[1] * x - p[0] * y
        distance = math.hypot(out, p[2])
        short = math.hypot(distance - self.length, across) - radius
        return short if short > 0.0 else min(0.0, math.hypot(distance + self.length, across) - radius)

    def range_deg(self, radius: float) -> tuple[float, float] | None:
        """Return where all levers, moved alike, keep their elbows outside [deg]; None: nowhere.

        The platform rises and falls on the axis then. At either end lever and rod are in line, folded or stretched;
        where the rods are too short for level levers, the range begins where they meet.
        """
        spare = radius - self.length
        if spare > 0.0 and abs(self.radius) <= spare:
            lower = -math.acos(self.radius / spare)
        elif self.radius + self.length >= radius and abs(radius - self.radius) <= self.length:
            lower = math.acos((radius - self.radius) / self.length)
        else:
            return None
        if abs(self.radius) > radius + self.length:
            return None
        upper = math.acos(-self.radius / (radius + self.length))
        return deg_from_rad(lower) + self.zero_deg, deg_from_rad(upper) + self.zero_deg

    def standing(self, rod: Centre, value: float) -> tuple[float, str]:
        """Return what the axis moves of the platform point, 0 to ±1, and in words where that is nothing.

        Args:
            rod: Unit vector from the tip of the lever to the platform point.
            value: Axis value [rad].
        """
        x, y = direction(self.angle_deg)
        angle = value - rad_from_deg(self.zero_deg)
        c, s = math.cos(angle), math.sin(angle)
        out, across = rod[0] * x + rod[1] * y, rod[1] * x - rod[0] * y
        along = out * c - rod[2] * s
        moved = -out * s - rod[2] * c
        if abs(along) < abs(across):
            return moved, "the rod of {name} stands {nearly}across the plane in which its lever turns"
        return moved, f"the lever and the rod of {{name}} are {{nearly}}{'stretched' if along > 0.0 else 'folded'}"


@cache
def direction(angle_deg: float) -> tuple[float, float]:
    """Return cosine and sine of an angle, right angles exact; those of a machine's arms are asked for at every pose."""
    turned = math.remainder(angle_deg, 360.0)
    exact = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), -180.0: (-1.0, 0.0), -90.0: (0.0, -1.0)}
    if turned in exact:
        return exact[turned]
    angle = rad_from_deg(turned)
    return math.cos(angle), math.sin(angle)
