"""Closed axis maps of three rods that carry a platform: tripods (12, 209) and the delta robot (37).

Each rod ends on a ball of radius r about its upper joint, seen with the platform's pins shrunk to one point p: the
centres are (ρ_i·cos φ_i, ρ_i·sin φ_i, z_i). p is the common point of the three balls on one side of the plane of their
centres:

    p = o ∓ h·n        o the circumcentre, n the normal taken upwards, h² = r² - R²; minus: the platform hangs

Joint values: p (3), rotary axes of a table, and for each arm its axis and the two angles of its rod, which hangs (or
stands) at 0 and swings about the tangent, then leans about its own x.
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
from chainbuild.closest import and_joined
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.formats.twincat.maps.arms import Centre, Column, Lever, direction
from chainbuild.formats.twincat.maps.losing import rod_losses, strut_losses
from chainbuild.formats.twincat.maps.rows import common_points, in_columns
from chainbuild.units import deg_from_rad, m_from_mm, mm_from_m, rad_from_deg

_ARMS: Final = 3  # three balls have a common point
_TO_SI: Final = {"linear": m_from_mm, "rotary": rad_from_deg}
_SHOWN: Final = {"linear": mm_from_m, "rotary": deg_from_rad}
_PER_ARM: Final = 3  # joints: the axis, and two angles of the rod
_FLAT: Final = 1e-12  # squared sine of the triangle of the centres: below it they lie on a line
_SAME: Final = 1e-9  # of r: centres nearer than that are one, the direction between them is rounding
_TOUCHES: Final = 1e-15  # of r²: rounding where the rods lie in the plane of their joints
_LOOSE: Final = 1e-12  # sine below which the rods count as lying in a plane: 1/_LOOSE stands for an endless rate


@dataclass(frozen=True, slots=True, eq=False)
class ThreeRodsMap:
    """Axis values of three arms (and of rotary axes beside them) → joint values.

    Attributes:
        arms: The three arms.
        rod: r [m].
        hanging: +1 where the platform hangs below the joints, -1 where it stands on them.
        beside: How many rotary axes follow those of the arms: joints of the workpiece branch.
        names: Names of the arms' axes.
    """

    arms: tuple[Column | Lever, ...]
    rod: float
    hanging: float
    beside: int = 0
    names: tuple[str, ...] = ("Z1", "Z2", "Z3")

    def named(self, names: Sequence[str]) -> ThreeRodsMap:
        """Return the map that names its axes by other names."""
        return replace(self, names=tuple(names[:_ARMS]))

    @property
    def periodic(self) -> tuple[int, ...]:
        """Indices of the axes whose whole turn leads to the same pose."""
        levers = tuple(n for n, arm in enumerate(self.arms) if arm.kind == "rotary")
        return (*levers, *range(_ARMS, _ARMS + self.beside))

    def _si(self, axes: Vector) -> list[float]:
        own = [_TO_SI[arm.kind](value) for arm, value in zip(self.arms, axes.tolist(), strict=False)]
        return own + [rad_from_deg(value) for value in axes.tolist()[_ARMS:]]

    def _shown(self, values: Sequence[float]) -> Vector:
        own = [_SHOWN[arm.kind](value) for arm, value in zip(self.arms, values, strict=False)]
        return np.array(own + [deg_from_rad(value) for value in values[_ARMS:]])

    def q(self, axes: Vector) -> Vector:
        """Return the joint values of axis values; not a number where the rods do not meet."""
        values = self._si(axes)
        centres = [arm.centre(value) for arm, value in zip(self.arms, values, strict=False)]
        p = self.common([centre for centre, _, _ in centres])
        if p is None:
            return np.full(_ARMS + self.beside + _ARMS * _PER_ARM, math.nan)
        q = [*p, *values[_ARMS:]]
        for arm, value, (centre, _, turned) in zip(self.arms, values, centres, strict=False):
            q += [value, *self._rod_angles(arm, p, centre, turned)]
        return np.array(q)

    def formulas(self, symbols: Sequence[str]) -> Formulas:
        """Return the map written down: what the arms and rotary axes beside them stand at."""
        arms = [text for symbol in symbols[:_ARMS] for text in (symbol, "", "")]
        return Formulas((), ("", "", "", *symbols[_ARMS:], *arms))

    def tip_values(self, axes: Vector) -> list[float] | None:
        """Return the joint values of the platform and of rotary axes beside the arms, or None where nothing closes."""
        shown = axes.tolist()
        a, b, c = self.arms
        p = self.common((a.place(shown[0]), b.place(shown[1]), c.place(shown[2])))
        return None if p is None else [*p, *map(rad_from_deg, shown[_ARMS:])]

    def tip_rows(self, rows: Matrix) -> Matrix:
        """Return them (N, 3 + beside) at rows of axis values; not a number where nothing closes."""
        a, b, c = (arm.centre_rows(rows[:, n]) for n, arm in enumerate(self.arms))
        p = common_points((a, b, c), self.rod, self.hanging, (_FLAT, _SAME, _TOUCHES))
        return in_columns(*p, *np.radians(rows[:, _ARMS:]).T)

    def _rod_angles(self, arm: Column | Lever, p: Centre, centre: Centre, turned: float) -> tuple[float, float]:
        x, y = direction(arm.angle_deg)
        dx, dy = p[0] - centre[0], p[1] - centre[1]
        out, across, up = dx * x + dy * y, dy * x - dx * y, p[2] - centre[2]
        s = -self.hanging
        lean = math.asin(max(-1.0, min(1.0, -s * across / self.rod)))
        return math.remainder(math.atan2(s * out, s * up) - turned, math.tau), lean

    def common(self, centres: Sequence[Centre]) -> Centre | None:
        """Return the common point [m] of balls about three centres, or None where there is none."""
        (ax, ay, az), b, c = centres
        ux, uy, uz = b[0] - ax, b[1] - ay, b[2] - az
        vx, vy, vz = c[0] - ax, c[1] - ay, c[2] - az
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        square = nx * nx + ny * ny + nz * nz
        uu, vv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
        least = (_SAME * self.rod) ** 2
        if square <= _FLAT * uu * vv or uu <= least or vv <= least or math.dist(b, c) <= _SAME * self.rod:
            return None  # the centres lie on a line, about which the platform could turn, or on one another
        # The circumcentre from a: (|u|²·(v × n) + |v|²·(n × u)) / (2·|n|²).
        ox = (uu * (vy * nz - vz * ny) + vv * (ny * uz - nz * uy)) / (2.0 * square)
        oy = (uu * (vz * nx - vx * nz) + vv * (nz * ux - nx * uz)) / (2.0 * square)
        oz = (uu * (vx * ny - vy * nx) + vv * (nx * uy - ny * ux)) / (2.0 * square)
        height = self.rod**2 - (ox * ox + oy * oy + oz * oz)
        if abs(height) < _TOUCHES * self.rod**2:
            height = 0.0
        if height < 0.0:
            return None
        # The lower point (the upper one of a platform that stands): n is taken upwards.
        step = math.copysign(math.sqrt(height / square), nz) * self.hanging
        return ax + ox - step * nx, ay + oy - step * ny, az + oz - step * nz

    def axes(self, q: Vector) -> Vector:
        """Return the axis values of joint values: those of the axes' own joints."""
        first = _ARMS + self.beside
        own = [float(q[first + _PER_ARM * n]) for n in range(_ARMS)]
        return self._shown(own + q[_ARMS:first].tolist())

    def dq_daxes(self, axes: Vector) -> Matrix:
        """Return the derivative by elimination: (p - c_i)·(dp - dc_i) = 0; 1e12 where the platform is loose."""
        values = self._si(axes)
        centres = [arm.centre(value) for arm, value in zip(self.arms, values, strict=False)]
        first = _ARMS + self.beside
        J = np.zeros((first + _ARMS * _PER_ARM, first))
        J[_ARMS:first, _ARMS:] = np.eye(self.beside)
        p = self.common([centre for centre, _, _ in centres])
        if p is None:
            return np.full(J.shape, math.nan)
        rods = [self._rod(p, centre) for centre, _, _ in centres]
        dp = np.array(_rates(rods, [slope for _, slope, _ in centres]))
        J[:_ARMS, :_ARMS] = dp
        for n, (arm, (_, slope, _)) in enumerate(zip(self.arms, centres, strict=False)):
            x, y = direction(arm.angle_deg)
            row = first + _PER_ARM * n
            J[row, n] = 1.0
            moved = dp.copy()
            moved[:, n] -= slope
            ux, uy, up = rods[n]
            out = ux * x + uy * y
            plane = max(out * out + up * up, _FLAT)
            # Rows of d(swing), d(lean) by the motion of the rod's lower end against the upper one.
            lean = self.hanging / math.sqrt(plane)
            by_end = [[up * x / plane, up * y / plane, -out / plane], [-lean * y, lean * x, 0.0]]
            J[row + 1 : row + 3, :_ARMS] = np.array(by_end) @ moved / self.rod
            if arm.kind == "rotary":
                J[row + 1, n] -= 1.0
        return J

    def _rod(self, p: Centre, centre: Centre) -> Centre:
        """Return the unit vector along a rod, from its upper end to the platform's point."""
        return (p[0] - centre[0]) / self.rod, (p[1] - centre[1]) / self.rod, (p[2] - centre[2]) / self.rod

    def losses(self, axes: Vector) -> tuple[Loss, ...]:
        """Return every function that vanishes at a singularity; none where the rods do not meet."""
        values = self._si(axes)
        centres = [arm.centre(value)[0] for arm, value in zip(self.arms, values, strict=False)]
        p = self.common(centres)
        if p is None:
            return ()
        rods = [self._rod(p, centre) for centre in centres]
        struts = [arm.standing(rod, value) for arm, rod, value in zip(self.arms, rods, values, strict=False)]
        across = [direction(arm.angle_deg) for arm in self.arms]
        count = _ARMS * (1 + _PER_ARM) + self.beside
        return (*strut_losses(struts, self.names), *rod_losses(rods, across, self.names, count))

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return which rod is too short or too long at axis values, and by how much, or None where they meet."""
        values = self._si(axes)
        centres = [arm.centre(value)[0] for arm, value in zip(self.arms, values, strict=False)]
        if self.common(centres) is not None:
            return None
        permitted = "axis values at which the platform closes"
        alike = self._alike(centres)
        if alike:
            text = f"the rods of {and_joined(alike)} are parallel and hold nothing: their upper ends meet in one point"
            return AxisValueError(text, parameter=alike[0], permitted=permitted)
        gap, first, second = max(
            (math.dist(centres[n], centres[m]) - 2.0 * self.rod, n, m) for n, m in ((0, 1), (1, 2), (0, 2))
        )
        if gap > 0.0:
            pair = f"{self.names[first]} and {self.names[second]}"
            text = f"the rods do not meet: those of {pair} together are {mm_from_m(gap):.6g} mm too short"
            return AxisValueError(text, parameter=self.names[first], permitted=permitted)
        n, missing = self._worst(centres)
        length = f"{mm_from_m(abs(missing)):.6g} mm too {'short' if missing > 0.0 else 'long'}"
        text = f"the rods do not meet: the rod of {self.names[n]} is {length} for where the others meet"
        if not math.isfinite(missing):
            text = "the rods hold nothing: their joints lie on a line, about which the platform could turn"
        return AxisValueError(text, parameter=self.names[n], permitted=permitted)

    def _alike(self, centres: Sequence[Centre]) -> list[str]:
        """Return the names of the axes whose rods begin in the same point."""
        near = [
            any(m != n and math.dist(one, other) <= _SAME * self.rod for m, other in enumerate(centres))
            for n, one in enumerate(centres)
        ]
        return [name for name, met in zip(self.names, near, strict=True) if met]

    def _worst(self, centres: Sequence[Centre]) -> tuple[int, float]:
        """Return the rod that misses the circle on which the others meet by most, and by how much [m]."""
        found = []
        for n in range(_ARMS):
            a, b = (np.array(centres[m]) for m in range(_ARMS) if m != n)
            way = b - a
            apart = float(np.linalg.norm(way))
            square = self.rod**2 - apart**2 / 4.0
            if square < 0.0 or apart == 0.0:
                continue
            off = np.array(centres[n]) - (a + b) / 2.0
            along = float(off @ way) / apart
            beside = float(np.linalg.norm(off - along * way / apart))
            near = math.hypot(along, beside - math.sqrt(square)) - self.rod
            far = math.hypot(along, beside + math.sqrt(square)) - self.rod
            found.append((n, near if near > 0.0 else min(far, 0.0)))
        return max(found, key=lambda one: abs(one[1]), default=(0, math.inf))

    def closing(self, q: Vector) -> list[list[float]]:
        """Return the axis values of each arm that reach the platform's point, and the rotary ones as they are."""
        p = (float(q[0]), float(q[1]), float(q[2]))
        found = [[_SHOWN[arm.kind](v) for v in arm.values(p, self.rod, self.hanging)] for arm in self.arms]
        return [*found, *([deg_from_rad(float(v))] for v in q[_ARMS : _ARMS + self.beside])]

    def rank(self, axes: Vector) -> int:
        """Return how many levers point inwards: without a start all stand outwards."""
        q = self.q(axes)
        inwards = 0
        for value, reached in zip(axes.tolist(), self.closing(q), strict=True):
            off = [abs(math.remainder(value - one, 360.0)) for one in reached]
            inwards += len(off) > 1 and off[1] < off[0]
        return inwards

    def unreached(self, q: Vector) -> str:
        """Return which rods are too short or too long for the platform's point, and by how much."""
        p = (float(q[0]), float(q[1]), float(q[2]))
        words = []
        for arm, name in zip(self.arms, self.names, strict=True):
            missing = 0.0 if arm.values(p, self.rod, self.hanging) else arm.missing(p, self.rod)
            if missing:
                size = f"{mm_from_m(abs(missing)):.6g} mm too {'short' if missing > 0.0 else 'long'}"
                words.append(f"the rod of {name} is {size}")
        return ", ".join(words)

    def drawn_axes(self, rng: np.random.Generator, lower: Vector, upper: Vector) -> Vector | None:
        """Return axis values of a random platform point: the first arm at random, the others as its point asks."""
        low, high = self._si(lower), self._si(upper)
        own = (np.array(low) + np.subtract(high, low) * rng.random(len(low))).tolist()
        p = self._near(own[0], rng)
        for n, arm in enumerate(self.arms):
            reached = [value for value in arm.values(p, self.rod, self.hanging) if low[n] <= value <= high[n]]
            if not reached:
                return None
            own[n] = reached[int(rng.integers(len(reached)))]
        return self._shown(own)

    def strut_ranges(self) -> tuple[tuple[float, float] | None, ...]:
        """Return the range of each axis that the rods leave: carriages stand as far apart as two rods reach.

        Where they stand together is free: the range lies around 0 and holds every shape of the tripod.
        """
        feet = [(arm.radius * x, arm.radius * y) for arm in self.arms for x, y in (direction(arm.angle_deg),)]
        reach = [4.0 * self.rod**2 - math.dist(feet[n], feet[n - 1]) ** 2 for n in range(_ARMS)]
        half = mm_from_m(math.sqrt(max(*reach, 0.0)) / 2.0)
        own = [arm.range_deg(self.rod) if isinstance(arm, Lever) else (-half, half) for arm in self.arms]
        return (*own, *(None for _ in range(self.beside)))

    def _near(self, value: float, rng: np.random.Generator) -> Centre:
        """Return a random point on the ball of the first arm, on the platform's side of its centre."""
        (x, y, z), _, _ = self.arms[0].centre(value)
        out = rng.normal(size=3)
        out *= self.rod / float(np.linalg.norm(out))
        return x + float(out[0]), y + float(out[1]), z - self.hanging * abs(float(out[2]))

    def q_bounds(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector]:
        """Return bounds of the joint values: the platform is within a rod of every joint."""
        low, high = self._si(lower), self._si(upper)
        least, most = np.full(3, -math.inf), np.full(3, math.inf)
        angles: list[tuple[float, float]] = []
        for arm, first, last in zip(self.arms, low, high, strict=False):
            if isinstance(arm, Column):
                ends = np.array([arm.centre(first)[0], arm.centre(last)[0]])
            else:
                x, y = direction(arm.angle_deg)
                middle, size = np.array([arm.radius * x, arm.radius * y, 0.0]), arm.length
                ends = np.array([middle - size, middle + size])
            least = np.maximum(least, ends.min(axis=0) - self.rod)
            most = np.minimum(most, ends.max(axis=0) + self.rod)
            angles += [(first, last), (-math.pi, math.pi), (-math.pi / 2.0, math.pi / 2.0)]
        beside = list(zip(low[_ARMS:], high[_ARMS:], strict=True))
        every = [*zip(least.tolist(), most.tolist(), strict=True), *beside, *angles]
        return np.array([one[0] for one in every]), np.array([max(one) for one in every])


def _rates(rods: Sequence[Centre], slopes: Sequence[Centre]) -> list[list[float]]:
    """Return the derivative (3, 3) of the platform's point by the axes: u_i·dp = u_i·dc_i, solved by Cramer's rule.

    Args:
        rods: Unit vectors u_i along the rods.
        slopes: dc_i by the axis of the arm.
    """
    crosses = [_cross(rods[(n + 1) % _ARMS], rods[(n + 2) % _ARMS]) for n in range(_ARMS)]
    determinant = _dot(rods[0], crosses[0])
    least = _LOOSE * math.sqrt(max(_dot(cross, cross) for cross in crosses))
    moved = [_dot(rod, slope) for rod, slope in zip(rods, slopes, strict=True)]
    if abs(determinant) < least:
        determinant = math.copysign(least, determinant)
        moved = [share if abs(share) > _LOOSE else 1.0 for share in moved]  # 0 over 0 is no rate either
    shares = [share / determinant for share in moved]
    return [[cross[row] * share for cross, share in zip(crosses, shares, strict=True)] for row in range(_ARMS)]


def _cross(a: Centre, b: Centre) -> Centre:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def _dot(a: Centre, b: Centre) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
