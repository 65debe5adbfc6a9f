"""Closed axis map of the lambda kinematic (21): two slides, two rods, one of them stretched out to an arm.

The joint C stands at (s_c, y_c), the joint B at (s_b, y_b); the rods l_c from C and l_b from B meet in D, on one side
of the line from C to B. With d = |CB| and side = +1 for the left:

    θ = direction of CB + side·acos((l_c² + d² - l_b²) / (2·l_c·d))         the rod from C
    φ = direction of BD                                                      the rod from B
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import Formulas
from chainbuild.chain.closing import Loss
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.formats.twincat.maps.rows import IN_LINE, in_columns, rod_turns
from chainbuild.units import deg_from_rad, m_from_mm, mm_from_m, rad_from_deg

_Z: Final = 2  # index in X1, X2, Z, C
_C: Final = 3  # likewise
_LOOSE: Final = 1e-12  # sine below which the rods count as in line: 1/_LOOSE stands for an endless rate


@dataclass(frozen=True, slots=True, eq=False)
class LambdaMap:
    """X1, X2, Z, C → slide of C, θ, Z, turn of the gripper; slide of B, φ.

    Attributes:
        along: (2,) of the joint C and of the joint B along X at axis value 0 [m].
        across: (2,) of the joints across X [m].
        rods: Lengths l_c and l_b [m].
        side: +1: D lies left of the line from C to B, -1: right.
        slides: Index of the axis that carries C, and of the one that carries B.
        bend: Angle from the rod to the arm that carries the gripper [rad].
        by_arm: Whether C counts from the arm; else from X.
        names: Names of X1 and X2.
    """

    along: tuple[float, float]
    across: tuple[float, float]
    rods: tuple[float, float]
    side: float
    slides: tuple[int, int] = (0, 1)
    bend: float = 0.0
    by_arm: bool = True
    names: tuple[str, ...] = ("X1", "X2")

    def named(self, names: Sequence[str]) -> LambdaMap:
        """Return the map that names its axes by other names."""
        return replace(self, names=tuple(names[:2]))

    @property
    def periodic(self) -> tuple[int, ...]:
        """Index of the axis whose whole turn leads to the same pose: C."""
        return (_C,)

    def _way(self, axes: Vector) -> tuple[float, float]:
        """Return the way from C to B [m]."""
        c, b = (m_from_mm(float(axes[n])) + start for n, start in zip(self.slides, self.along, strict=True))
        return b - c, self.across[1] - self.across[0]

    def _angles(self, axes: Vector) -> tuple[float, float] | None:
        """Return θ and φ [rad], or None where the rods do not meet."""
        x, y = self._way(axes)
        apart, (rod, other) = math.hypot(x, y), self.rods
        if apart == 0.0:
            return None
        cosine = (rod**2 + apart**2 - other**2) / (2.0 * rod * apart)
        if abs(cosine) > 1.0 + IN_LINE:
            return None
        theta = math.atan2(y, x) + self.side * math.acos(max(-1.0, min(1.0, cosine)))
        return theta, math.atan2(rod * math.sin(theta) - y, rod * math.cos(theta) - x)

    def q(self, axes: Vector) -> Vector:
        """Return the joint values of axis values; not a number where the rods do not meet."""
        angles = self._angles(axes)
        if angles is None:
            return np.full(6, math.nan)
        theta, phi = angles
        slides = [m_from_mm(float(axes[n])) for n in self.slides]
        turn = rad_from_deg(float(axes[_C])) - (0.0 if self.by_arm else theta + self.bend)
        return np.array([slides[0], theta, m_from_mm(float(axes[_Z])), turn, slides[1], phi])

    def formulas(self, symbols: Sequence[str]) -> Formulas:
        """Return the map written down: what the slides, Z and the gripper stand at."""
        (c, b), z, turn = (symbols[n] for n in self.slides), symbols[_Z], symbols[_C]
        if self.by_arm:
            return Formulas((), (c, "", z, turn, b, ""))
        rod, other = self.rods
        steps = (
            ("x", f"{b} - ({c}) + ({self.along[1] - self.along[0]:.15g})"),
            ("to", f"atan2({self.across[1] - self.across[0]:.15g}, x)"),
            ("apart", f"x*cos(to) + ({self.across[1] - self.across[0]:.15g})*sin(to)"),
            ("cosine", f"({rod**2 - other**2:.15g} + apart*apart)/({2.0 * rod:.15g}*apart)"),
            ("rod", f"to + {self.side:g}*(pi/2 - asin(max(-1, min(1, cosine))))"),
        )
        return Formulas(steps, (c, "", z, f"{turn} - rod - ({self.bend:.15g})", b, ""))

    def tip_values(self, axes: Vector) -> list[float] | None:
        """Return the joint values of the way to the gripper, or None where the rods do not meet."""
        angles = self._angles(axes)
        if angles is None:
            return None
        turn = rad_from_deg(float(axes[_C])) - (0.0 if self.by_arm else angles[0] + self.bend)
        return [m_from_mm(float(axes[self.slides[0]])), angles[0], m_from_mm(float(axes[_Z])), turn]

    def tip_rows(self, rows: Matrix) -> Matrix:
        """Return them (N, 4) at rows of axis values; not a number where the rods do not meet."""
        c, b = (rows[:, n] / 1000.0 for n in self.slides)
        y = self.across[1] - self.across[0]
        theta = rod_turns(b + self.along[1] - c - self.along[0], y, self.rods, self.side)
        turn = np.radians(rows[:, _C]) - (0.0 if self.by_arm else theta + self.bend)
        return in_columns(c, theta, rows[:, _Z] / 1000.0, turn)

    def axes(self, q: Vector) -> Vector:
        """Return the axis values of joint values."""
        found = np.zeros(4)
        found[list(self.slides)] = mm_from_m(float(q[0])), mm_from_m(float(q[4]))
        found[_Z] = mm_from_m(float(q[2]))
        found[_C] = deg_from_rad(float(q[3]) + (0.0 if self.by_arm else float(q[1]) + self.bend))
        return found

    def dq_daxes(self, axes: Vector) -> Matrix:
        """Return the derivative by elimination; where the rods lie in line 1e12 stands for what has no end."""
        J = np.zeros((6, 4))
        c, b = self.slides
        J[0, c], J[4, b], J[2, _Z], J[3, _C] = 1.0, 1.0, 1.0, 1.0
        angles = self._angles(axes)
        if angles is None:
            return np.full(J.shape, math.nan)
        theta, phi = angles
        # (D - B)·(D' - B') = 0 with D' = C' + l_c·θ'·e(θ + 90°), and φ' from what is left across the rod of B.
        lean = math.sin(theta - phi)
        lean = math.copysign(max(abs(lean), _LOOSE), lean)
        rod, other = self.rods
        J[1, c], J[1, b] = math.cos(phi) / (rod * lean), -math.cos(phi) / (rod * lean)
        for axis, moved in ((c, 1.0), (b, -1.0)):
            across = -moved * math.sin(phi) + rod * J[1, axis] * math.cos(theta - phi)
            J[5, axis] = across / other
        if not self.by_arm:
            J[3] -= J[1]
        return J

    def losses(self, axes: Vector) -> tuple[Loss, ...]:
        """Return every function that vanishes at a singularity; none where the rods do not meet."""
        angles = self._angles(axes)
        if angles is None:
            return ()
        theta, phi = angles
        c, b = self.slides
        rates = np.array([0.0, 1.0, 0.0, 0.0 if self.by_arm else -1.0, 0.0, 0.0])
        how = "stretched in one line" if math.cos(theta - phi) < 0.0 else "folded onto one another"
        rods = f"the rods of {self.names[0]} and {self.names[1]} are {{nearly}}{how}"
        slide, arm = (f"{self.names[n]} stands {{nearly}}across its slide" for n in (b, c))
        return (
            Loss("platform", math.sin(theta - phi), (c, b), rods, rates=rates),
            Loss("strut", math.cos(phi), (b,), f"the rod of {slide}"),
            Loss("strut", math.cos(theta + self.bend), (c,), f"the arm of {arm}"),
        )

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return by how much the rods miss one another at axis values, or None where they meet."""
        if self._angles(axes) is not None:
            return None
        apart, (rod, other) = math.hypot(*self._way(axes)), self.rods
        short, close = (mm_from_m(gap) for gap in (apart - rod - other, abs(rod - other) - apart))
        first, second = self.names
        how = (
            f"are {short:.6g} mm too short" if short > 0.0 else f"are too long: {first} and {second} are {close:.6g} mm"
        )
        text = f"the rods do not meet: at the distance of {first} and {second} they {how}"
        if short <= 0.0:
            text += " too close"
        return AxisValueError(text, parameter=second, permitted="axis values at which the rods close")

    def closing(self, q: Vector) -> list[list[float]]:
        """Return the axis values at the slide of C, θ, Z and the turn: B lies on the circle about D, on either side."""
        own = self.axes(np.append(q[:4], (0.0, 0.0)))
        rod, other = self.rods
        theta = float(q[1])
        c = float(q[0]) + self.along[0]
        across = self.across[0] + rod * math.sin(theta) - self.across[1]
        square = other**2 - across**2
        square = 0.0 if abs(square) < IN_LINE * other**2 else square
        values = [[value] for value in own.tolist()]
        middle, half = c + rod * math.cos(theta) - self.along[1], math.sqrt(max(square, 0.0))
        values[self.slides[1]] = [] if square < 0.0 else [mm_from_m(middle - half), mm_from_m(middle + half)]
        return values

    def rank(self, axes: Vector) -> int:
        """Return 0: without a start the branch nearest to 0 is taken."""
        return 0

    def unreached(self, q: Vector) -> str:
        """Return by how much the rod of B is too short to reach from its slide to D."""
        across = self.across[0] + self.rods[0] * math.sin(float(q[1])) - self.across[1]
        short = abs(across) - self.rods[1]
        return f"the rod of {self.names[1]} is {mm_from_m(short):.6g} mm too short" if short > 0.0 else ""

    def drawn_axes(self, rng: np.random.Generator, lower: Vector, upper: Vector) -> Vector | None:
        """Return axis values with the slides at a random distance at which the rods meet."""
        axes = lower + (upper - lower) * rng.random(4)
        across = self.across[1] - self.across[0]
        least, most = abs(self.rods[0] - self.rods[1]), sum(self.rods)
        apart = float(rng.uniform(least, most))
        if apart < abs(across):
            return None
        way = float(np.sqrt(apart**2 - across**2)) * float(rng.choice((-1.0, 1.0)))
        c, b = self.slides
        axes[b] = axes[c] + mm_from_m(way + self.along[0] - self.along[1])
        return axes

    def strut_ranges(self) -> tuple[tuple[float, float] | None, ...]:
        """Return the range of each axis that the rods leave: the slides stand as far apart as both rods reach.

        Where they stand together is free: the range lies around 0 and holds every shape of the rods.
        """
        half = math.sqrt(max(sum(self.rods) ** 2 - (self.across[1] - self.across[0]) ** 2, 0.0)) / 2.0
        ranges: list[tuple[float, float] | None] = [None] * 4
        for n, middle in zip(self.slides, (0.0, self.along[0] - self.along[1]), strict=True):
            ranges[n] = mm_from_m(middle - half), mm_from_m(middle + half)
        return tuple(ranges)

    def q_bounds(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector]:
        """Return bounds of the joint values."""
        low, high = np.full(6, -2.0 * math.pi), np.full(6, 2.0 * math.pi)
        for row, n in zip((0, 2, 4), (self.slides[0], _Z, self.slides[1]), strict=True):
            low[row], high[row] = m_from_mm(float(lower[n])), m_from_mm(float(upper[n]))
        turn = 0.0 if self.by_arm else 2.0 * math.pi + abs(self.bend)
        low[3], high[3] = rad_from_deg(float(lower[_C])) - turn, rad_from_deg(float(upper[_C])) + turn
        return low, high
