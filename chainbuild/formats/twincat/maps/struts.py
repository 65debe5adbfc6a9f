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
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.units import deg_from_rad, m_from_mm, mm_from_m, rad_from_deg

Centre = tuple[float, float, float]

_ARMS: Final = 3  # three balls have a common point
_TO_SI: Final = {"linear": m_from_mm, "rotary": rad_from_deg}
_SHOWN: Final = {"linear": mm_from_m, "rotary": deg_from_rad}
_PER_ARM: Final = 3  # joints: the axis, and two angles of the rod
_FLAT: Final = (
    1e-12  # of r²: below it the rods lie in the plane of their joints, and the platform is free to fall or rise
)


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
        x, y = _direction(self.angle_deg)
        return (self.radius * x, self.radius * y, self.sign * value), (0.0, 0.0, self.sign), 0.0

    def values(self, p: Centre, radius: float, side: float) -> list[float]:
        """Return the axis values [m] for a platform point: one, the carriage above (side 1) or below it."""
        x, y = _direction(self.angle_deg)
        square = radius**2 - (p[0] - self.radius * x) ** 2 - (p[1] - self.radius * y) ** 2
        return [self.sign * (p[2] + side * math.sqrt(square))] if square >= 0.0 else []

    def missing(self, p: Centre, radius: float) -> float:
        """Return how much longer [m] the rod would have to be for a platform point; 0 or less: it is long enough."""
        x, y = _direction(self.angle_deg)
        return math.hypot(p[0] - self.radius * x, p[1] - self.radius * y) - radius


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
        x, y = _direction(self.angle_deg)
        angle = value - rad_from_deg(self.zero_deg)
        c, s = math.cos(angle), math.sin(angle)
        out, slope = self.radius + self.length * c, -self.length * s
        return (out * x, out * y, -self.length * s), (slope * x, slope * y, -self.length * c), angle

    def values(self, p: Centre, radius: float, side: float) -> list[float]:
        """Return the axis values [rad] for a platform point: two, the elbow outside first."""
        # In the plane of the lever: |u - length·(cos θ, -sin θ)|² = r² - across².
        x, y = _direction(self.angle_deg)
        out, across = p[0] * x + p[1] * y - self.radius, p[1] * x - p[0] * y
        distance = math.hypot(out, p[2])
        square = radius**2 - across**2
        if square < 0.0 or distance == 0.0 or self.length == 0.0:
            return []
        cosine = (distance**2 + self.length**2 - square) / (2.0 * distance * self.length)
        if abs(cosine) > 1.0:
            return []
        middle, half = math.atan2(-p[2], out), math.acos(cosine)
        both = [middle - half, middle + half]
        both.sort(key=lambda angle: -math.cos(angle))
        return [math.remainder(angle, math.tau) + rad_from_deg(self.zero_deg) for angle in both]

    def missing(self, p: Centre, radius: float) -> float:
        """Return how much longer (positive) or shorter [m] the rod from the lever's tip to a platform point must be."""
        x, y = _direction(self.angle_deg)
        out, across = p[0] * x + p[1] * y - self.radius, p[1] * x - p[0] * y
        distance = math.hypot(out, p[2])
        short = math.hypot(distance - self.length, across) - radius
        return short if short > 0.0 else min(0.0, math.hypot(distance + self.length, across) - radius)


def _direction(angle_deg: float) -> tuple[float, float]:
    """Return cosine and sine of an angle, right angles exact."""
    turned = math.remainder(angle_deg, 360.0)
    exact = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), -180.0: (-1.0, 0.0), -90.0: (0.0, -1.0)}
    if turned in exact:
        return exact[turned]
    angle = rad_from_deg(turned)
    return math.cos(angle), math.sin(angle)


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

    def _rod_angles(self, arm: Column | Lever, p: Centre, centre: Centre, turned: float) -> tuple[float, float]:
        x, y = _direction(arm.angle_deg)
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
        if square <= _FLAT * uu * vv or square == 0.0:
            return None  # the centres lie on a line: the platform could turn about it
        # The circumcentre from a: (|u|²·(v × n) + |v|²·(n × u)) / (2·|n|²).
        ox = (uu * (vy * nz - vz * ny) + vv * (ny * uz - nz * uy)) / (2.0 * square)
        oy = (uu * (vz * nx - vx * nz) + vv * (nz * ux - nx * uz)) / (2.0 * square)
        oz = (uu * (vx * ny - vy * nx) + vv * (nx * uy - ny * ux)) / (2.0 * square)
        height = self.rod**2 - (ox * ox + oy * oy + oz * oz)
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
        """Return the derivative by elimination: (p - c_i)·(dp - dc_i) = 0; inf where the platform loses a direction."""
        values = self._si(axes)
        centres = [arm.centre(value) for arm, value in zip(self.arms, values, strict=False)]
        first = _ARMS + self.beside
        J = np.zeros((first + _ARMS * _PER_ARM, first))
        J[_ARMS:first, _ARMS:] = np.eye(self.beside)
        p = self.common([centre for centre, _, _ in centres])
        if p is None:
            return np.full(J.shape, math.nan)
        rods = np.array([np.subtract(p, centre) for centre, _, _ in centres])
        slopes = np.array([slope for _, slope, _ in centres])
        rates = np.diag(np.einsum("ij,ij->i", rods, slopes))
        try:
            dp = np.linalg.solve(rods, rates)
        except np.linalg.LinAlgError:
            return np.full(J.shape, math.inf)
        J[:_ARMS, :_ARMS] = dp
        for n, (arm, (_, slope, _)) in enumerate(zip(self.arms, centres, strict=False)):
            x, y = _direction(arm.angle_deg)
            row = first + _PER_ARM * n
            J[row, n] = 1.0
            moved = dp.copy()
            moved[:, n] -= slope
            frame = np.array([[x, y, 0.0], [-y, x, 0.0], [0.0, 0.0, 1.0]])
            out, across, up = frame @ rods[n]
            d_out, d_across, d_up = frame @ moved
            s, plane = -self.hanging, out * out + up * up
            J[row + 1, :_ARMS] = (up * d_out - out * d_up) / plane
            J[row + 2, :_ARMS] = -s * d_across / math.sqrt(max(self.rod**2 - across**2, _FLAT))
            if arm.kind == "rotary":
                J[row + 1, n] -= 1.0
        return J

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return which rod is too short or too long at axis values, and by how much, or None where they meet."""
        values = self._si(axes)
        centres = [arm.centre(value)[0] for arm, value in zip(self.arms, values, strict=False)]
        if self.common(centres) is not None:
            return None
        permitted = "axis values at which the platform closes"
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
                x, y = _direction(arm.angle_deg)
                middle, size = np.array([arm.radius * x, arm.radius * y, 0.0]), arm.length
                ends = np.array([middle - size, middle + size])
            least = np.maximum(least, ends.min(axis=0) - self.rod)
            most = np.minimum(most, ends.max(axis=0) + self.rod)
            angles += [(first, last), (-math.pi, math.pi), (-math.pi / 2.0, math.pi / 2.0)]
        beside = list(zip(low[_ARMS:], high[_ARMS:], strict=True))
        every = [*zip(least.tolist(), most.tolist(), strict=True), *beside, *angles]
        return np.array([one[0] for one in every]), np.array([max(one) for one in every])
