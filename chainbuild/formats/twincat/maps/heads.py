"""Nonlinear axis maps of tool heads: the virtual axis of 70, the spatial angles of 59 and 60.

Each takes the axis values through an affine map to inner values (SI; sign and zero offset of those that it bends) and
bends only those that are not straight: q = bend(A·axes + b). Those of tools that grow with their tilt: `maps_length`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from chainbuild import tolerances
from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import AffineMap, Formulas
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.files import number_text
from chainbuild.frames import cos_sin_deg
from chainbuild.units import AxisKind, deg_from_rad, rad_from_deg

FIVE_AXES: Final[tuple[AxisKind, ...]] = ("linear", "linear", "linear", "rotary", "rotary")
_SIX_AXES: Final[tuple[AxisKind, ...]] = (*FIVE_AXES, "rotary")
_TILT_SLACK: Final = 1e-12  # [rad] the largest lean, computed back by an arc sine, still counts as reached
# Indices in X, Y, Z, C, A (59: C, A; 60: C, B).
_C: Final = 3
_A: Final = 4


def straight_map(
    kinds: Sequence[AxisKind], offsets_deg: Sequence[float], signs: Sequence[float] | None = None
) -> AffineMap:
    """Return the map sign·axis + offset, axis by axis; the offsets of linear axes must be 0."""
    offsets = np.array([rad_from_deg(offset) for offset in offsets_deg])
    return AffineMap.of(np.diag(signs if signs is not None else np.ones(len(kinds))), offsets, kinds)


def nonzero(cosine: float) -> float:
    """Return a cosine kept off 0, so that a derivative at a singular point is huge but finite."""
    return math.copysign(max(abs(cosine), tolerances.GIMBAL_LOCK), cosine)


@dataclass(frozen=True, slots=True, eq=False)
class VirtualTurnMap:
    """KIN_TYP 70: the programmed B, A give a tool vector, CV turns it about Z, the head moves to B', A'.

    v = Ry(b)·Rx(a)·e_z, v' = Rz(CV)·v = Ry(b')·Rx(a')·e_z; of the two solutions the one that CV = 0 leaves unchanged.

    Attributes:
        straight: Axis values → X, Y, Z, b, a, CV.
    """

    straight: AffineMap

    @classmethod
    def of(cls, signs: Sequence[float], offsets_deg: Sequence[float]) -> VirtualTurnMap:
        """Build the map of signs and added angles of X, Y, Z, B, A, CV."""
        return cls(straight_map(_SIX_AXES, offsets_deg, signs))

    @property
    def periodic(self) -> tuple[int, ...]:
        """Indices of the axes whose whole turn leads to the same pose: B, A, CV."""
        return (3, 4, 5)

    def q(self, axes: Vector) -> Vector:
        """Return the joint values X, Y, Z, B', A' (5,) of axis values (6,)."""
        inner = self.straight.q(axes)
        b, a, cv = (float(angle) for angle in inner[3:])
        x, y, z = _turned(b, a, cv)
        side = math.copysign(1.0, math.cos(a))
        a_turned = math.asin(max(-1.0, min(1.0, -y)))
        if side < 0:
            a_turned = math.pi - a_turned
        b_turned = math.atan2(side * x, side * z)
        return np.array([*inner[:3], _nearest_turn(b_turned, b), _nearest_turn(a_turned, a)])

    def formulas(self, symbols: Sequence[str]) -> Formulas:
        """Return the map written down."""
        *slides, b, a, cv = self.straight.sums(symbols)
        steps = (
            ("b", b),
            ("a", a),
            ("cv", cv),
            ("side", "copysign(1, cos(a))"),
            ("x", "cos(cv)*sin(b)*cos(a) + sin(cv)*sin(a)"),
            ("y", "sin(cv)*sin(b)*cos(a) - cos(cv)*sin(a)"),
            ("tilt", "pi/2 + side*(asin(max(-1, min(1, -y))) - pi/2)"),
            ("turn", "atan2(side*x, side*cos(b)*cos(a))"),
        )
        nearest = "{0} + 2*pi*round(({1} - {0})/(2*pi))"
        return Formulas(steps, (*slides, nearest.format("turn", "b"), nearest.format("tilt", "a")))

    def axes(self, q: Vector) -> Vector:
        """Return axis values with CV = 0: the joints do not show by which CV they were reached."""
        return self.straight.axes(np.append(q, self.straight.b[5]))

    def dq_daxes(self, axes: Vector) -> Matrix:
        """Return the derivative (5, 6)."""
        inner = self.straight.q(axes)
        b, a, cv = (float(angle) for angle in inner[3:])
        x, y, z = _turned(b, a, cv)
        cos_a, sin_a, cos_b, sin_b = math.cos(a), math.sin(a), math.cos(b), math.sin(b)
        cos_v, sin_v = math.cos(cv), math.sin(cv)
        by_b, by_a = (cos_b * cos_a, 0.0, -sin_b * cos_a), (-sin_b * sin_a, -cos_a, -cos_b * sin_a)
        by_angles = [(cos_v * dx - sin_v * dy, sin_v * dx + cos_v * dy, dz) for dx, dy, dz in (by_b, by_a)]
        by_angles.append((-y, x, 0.0))
        radius = nonzero(math.copysign(math.hypot(x, z), cos_a))
        bent = np.zeros((5, 6))
        bent[:3, :3] = np.eye(3)
        for n, (dx, dy, dz) in enumerate(by_angles, start=3):
            bent[3, n] = (z * dx - x * dz) / radius**2
            bent[4, n] = -dy / radius
        product: Matrix = bent @ self.straight.A
        return product

    def q_bounds(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector]:
        """Return the joint bounds: within a quarter turn CV cannot lead out of it, beyond that up to half a turn."""
        low, high = self.straight.q_bounds(lower, upper)
        low, high = low[:5], high[:5]
        quarter = math.pi / 2 + tolerances.GIMBAL_LOCK
        if (np.abs(np.append(low[3:], high[3:])) <= quarter).all():
            low[3:], high[3:] = -math.pi / 2, math.pi / 2
        else:
            low[3:] -= math.pi
            high[3:] += math.pi
        return low, high


def _turned(b: float, a: float, cv: float) -> tuple[float, float, float]:
    """Return Rz(cv)·Ry(b)·Rx(a)·e_z (angles in radians)."""
    x, y, z = math.sin(b) * math.cos(a), -math.sin(a), math.cos(b) * math.cos(a)
    return math.cos(cv) * x - math.sin(cv) * y, math.sin(cv) * x + math.cos(cv) * y, z


def _nearest_turn(angle: float, wanted: float) -> float:
    """Return the angle, moved by whole turns as near as possible to another one [rad]."""
    return angle + math.tau * round((wanted - angle) / math.tau)


@dataclass(frozen=True, slots=True, eq=False)
class SpatialAnglesMap:
    """KIN_TYP 59, 60 with HD21 = 0: spatial angles C_s, A_s are programmed, joints C, A are at machine angles.

    With tilt δ: A_m = side·2·asin(sin(A_s/2)/sin δ), C_m = C_s - atan2(cos δ·sin(A_m/2), cos(A_m/2)); the joint
    angles are these minus the zero offsets. A lean beyond twice the tilt has no machine angle.

    Attributes:
        straight: Axis values → X, Y, Z, C_s, A_s.
        cos_tilt: cos δ.
        sin_tilt: sin δ, not 0.
        side: +1, or -1 where the inclined axis leans to the other side.
        zero: (2,) offsets taken off C_m and A_m [rad].
        axis: Name of the inclined axis.
    """

    straight: AffineMap
    cos_tilt: float
    sin_tilt: float
    side: float
    zero: tuple[float, float]
    axis: str = "A"

    @classmethod
    def of(
        cls, tilt_deg: float, zero_deg: tuple[float, float] = (0.0, 0.0), side: float = 1.0, axis: str = "A"
    ) -> SpatialAnglesMap:
        """Build the map of a tilt other than 0 and the offsets taken off the machine angles C and A (B)."""
        cosine, sine = cos_sin_deg(tilt_deg)
        zero = (rad_from_deg(zero_deg[0]), rad_from_deg(zero_deg[1]))
        return cls(straight_map(FIVE_AXES, (0.0,) * 5), cosine, sine, side, zero, axis)

    @property
    def periodic(self) -> tuple[int, ...]:
        """Index of the axis whose whole turn leads to the same pose."""
        return (_C,)

    def named(self, names: Sequence[str]) -> SpatialAnglesMap:
        """Return the map that names the inclined axis by another name."""
        return replace(self, axis=names[_A])

    @property
    def largest_tilt(self) -> float:
        """The largest spatial angle [rad]: twice the tilt against ±Z."""
        return 2.0 * math.asin(abs(self.sin_tilt))

    def machine_angle(self, spatial: float) -> float:
        """Return the machine angle of the inclined axis of a spatial angle [rad]; not a number beyond the reach."""
        if abs(spatial) > self.largest_tilt + _TILT_SLACK:
            return math.nan
        ratio = math.sin(spatial / 2.0) / self.sin_tilt
        return self.side * 2.0 * math.asin(max(-1.0, min(1.0, ratio)))

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return the error of a lean that the head cannot reach, or None."""
        if math.isfinite(self.machine_angle(float(self.straight.q(axes)[_A]))):
            return None
        lean = deg_from_rad(self.largest_tilt)
        return AxisValueError(
            f"the head cannot tilt the tool by {self.axis} = {axes[_A]:g} deg: twice its axis' tilt (HD7) is the most",
            parameter=self.axis,
            permitted=f"{-lean:.9g} to {lean:.9g} deg",
        )

    def _turn_of_c(self, machine: float) -> float:
        """Return C_s - C_m: how far the inclined axis itself turns the lean about Z."""
        return math.atan2(self.cos_tilt * math.sin(machine / 2.0), math.cos(machine / 2.0))

    def q(self, axes: Vector) -> Vector:
        """Return the joint values (5,) of axis values (5,)."""
        q = self.straight.q(axes)
        machine = self.machine_angle(float(q[_A]))
        q[_C] += -self._turn_of_c(machine) - self.zero[0]
        q[_A] = machine - self.zero[1]
        return q

    def formulas(self, symbols: Sequence[str]) -> Formulas:
        """Return the map written down."""
        *slides, turn, lean = self.straight.sums(symbols)
        zero_c, zero_a = (number_text(value) for value in self.zero)
        # All digits: close to the largest lean an arc sine makes much of the last of them.
        cosine, ratio = f"{self.cos_tilt:.15g}", f"sin(lean/2)/({self.sin_tilt:.15g})"
        steps = (("lean", lean), ("machine", f"{number_text(self.side)}*2*asin(max(-1, min(1, {ratio})))"))
        c = f"{turn} - atan2({cosine}*sin(machine/2), cos(machine/2)) - ({zero_c})"
        return Formulas(steps, (*slides, c, f"machine - ({zero_a})"))

    def axes(self, q: Vector) -> Vector:
        """Return the axis values (5,) of joint values (5,)."""
        inner = q.copy()
        machine = math.remainder(float(q[_A]) + self.zero[1], math.tau)
        inner[_C] += self.zero[0] + self._turn_of_c(machine)
        inner[_A] = 2.0 * math.asin(self.sin_tilt * math.sin(self.side * machine / 2.0))
        return self.straight.axes(inner)

    def dq_daxes(self, axes: Vector) -> Matrix:
        """Return the derivative (5, 5); huge but finite at the largest lean, where the head is stretched."""
        result: Matrix = np.eye(5)
        spatial = float(self.straight.q(axes)[_A])
        half = self.machine_angle(spatial) / 2.0
        cosine = nonzero(math.cos(half))
        slope = self.side * math.cos(spatial / 2.0) / (self.sin_tilt * cosine)
        result[_A, _A] = slope
        # d/dm atan2(cos δ·sin(m/2), cos(m/2)) = (cos δ/2) / (1 - sin²δ·sin²(m/2))
        level = 1.0 - (self.sin_tilt * math.sin(half)) ** 2
        result[_C, _A] = -slope * self.cos_tilt / 2.0 / max(level, tolerances.GIMBAL_LOCK)
        return result

    def q_bounds(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector]:
        """Return the joint bounds: both machine angles are monotonous in the spatial angle."""
        low, high = self.straight.q_bounds(lower, upper)
        lean = self.largest_tilt
        ends = [self.machine_angle(max(-lean, min(lean, float(bound[_A])))) for bound in (low, high)]
        turns = [-self._turn_of_c(machine) for machine in ends]
        low[_C] += min(turns) - self.zero[0]
        high[_C] += max(turns) - self.zero[0]
        low[_A], high[_A] = min(ends) - self.zero[1], max(ends) - self.zero[1]
        return low, high
