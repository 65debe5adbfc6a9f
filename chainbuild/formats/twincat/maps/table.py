"""Axis map of the workpiece table on three rods (19): X and Y carry the tool, Z1 to Z3 the table by its rods.

Joint values: X, Y; the shifts and the turns about X, Y and Z of the table; each carriage with its rod; the links of a
guide. Rods in radial planes only swing, so that planes guide the table, which has three shifts. On the axis it has one,
and the rods lean, too. What keeps it from turning there is a pair of equal links: they stand on a post along the axis
and, like its mirror image, under the table, and meet on the plane between the two.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.axismap import Formulas
from chainbuild.chain.closing import Loss, StrutRange
from chainbuild.closest import and_joined
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.formats.twincat.maps.losing import strut_losses
from chainbuild.formats.twincat.maps.table_rods import RODS, TableRods, Triple, solved
from chainbuild.frames import rot_x, rot_y, rot_z
from chainbuild.units import deg_from_rad, m_from_mm, mm_from_m

LINK_RISE: Final = 0.5  # sine by which the links of the guide lean at home: any other keeps the table from turning, too

_SLIDES: Final = 2  # X and Y come before the carriages
_FULL: Final = math.sqrt(1.5)  # smallest singular value of the level table's slopes with upright rods
_LEVEL: Final = 1e-9  # upward part of the tool vector below which the table stands upright
_STEEPEST: Final = 0.7  # sine of half a drawn tilt: short of upright


@dataclass(frozen=True, slots=True, eq=False)
class TableMap:
    """X, Y, Z1, Z2, Z3 → joint values.

    Attributes:
        rods: The rods and their guide.
        names: Names of the axes.
    """

    rods: TableRods
    names: tuple[str, ...] = ("X", "Y", "Z1", "Z2", "Z3")

    def named(self, names: Sequence[str]) -> TableMap:
        """Return the map that names its axes by other names."""
        return replace(self, names=tuple(names))

    @property
    def radial(self) -> bool:
        """Whether radial planes guide the table."""
        return self.rods.offset != 0.0

    @property
    def _carriages(self) -> list[int]:
        """Places of the carriages among the joint values."""
        return [8, 10, 12] if self.radial else [6, 9, 12]

    @property
    def _count(self) -> int:
        return 14 if self.radial else 17

    def _state(self, axes: Vector) -> tuple[Triple, list[float]] | None:
        """Return (h, x, y) and the heights of the carriages [m], or None where the way from home does not lead."""
        heights = [m_from_mm(value) for value in axes.tolist()[_SLIDES:]]
        state, gone = self.rods.reached(heights)
        return (state, heights) if gone == 1.0 else None

    def q(self, axes: Vector) -> Vector:
        """Return the joint values of axis values; not a number where the way from home does not lead."""
        found = self._state(axes)
        if found is None:
            return np.full(self._count, math.nan)
        state, heights = found
        q = [m_from_mm(value) for value in axes.tolist()[:_SLIDES]] + self._table_joints(*state)
        s = -self.rods.hanging
        for rod, (ex, ey), z in zip(self.rods.rods(state, heights), self.rods.directions, heights, strict=True):
            (dx, dy, up), _, _ = rod
            q += [z, math.atan2(s * (dx * ex + dy * ey), s * up)]
            if not self.radial:
                q.append(math.asin(max(-1.0, min(1.0, -s * (dy * ex - dx * ey) / self.rods.length))))
        if not self.radial:
            angle, _ = self._link(state)
            q += [angle, -angle]
        return np.array(q)

    def formulas(self, symbols: Sequence[str]) -> Formulas:
        """Return the map written down: what the slides and the carriages stand at."""
        turns = 1 if self.radial else 2
        rods = [text for symbol in symbols[_SLIDES:] for text in (symbol, *[""] * turns)]
        guide = [""] * (self._count - _SLIDES - len(rods) - (0 if self.radial else 2))
        return Formulas((), (*symbols[:_SLIDES], *guide, *rods, *([] if self.radial else ["", ""])))

    def _table_joints(self, h: float, x: float, y: float) -> list[float]:
        """Return the shifts that the guide leaves the table [m], and its turns about X, Y and Z [rad]."""
        w, centre = math.sqrt(1.0 - x * x - y * y), self.rods.centre(x, y)
        about_x = math.atan2(2.0 * w * x, 1.0 - 2.0 * (x * x + y * y))
        about_z = math.atan2(-2.0 * x * y, 1.0 - 2.0 * y * y)
        turns = [about_x, math.asin(2.0 * w * y), about_z]
        return [h, centre.real, centre.imag, *turns] if self.radial else [h, *turns]

    def _link(self, state: Triple) -> tuple[float, Triple]:
        """Return the angle of the link on the post, and its derivatives by h, x and y.

        With e half the tilt, seen from across the link, the plane between post and mirror image meets it at
        e - asin(LINK_RISE·cos e).
        """
        _, x, y = state
        w = math.sqrt(1.0 - x * x - y * y)
        ex, ey = self.rods.directions[0]
        across = x * ey - y * ex  # the links stand opposite to the first column
        half = math.atan2(across, w)
        rise = LINK_RISE * math.cos(half)
        rate = (1.0 + LINK_RISE * math.sin(half) / math.sqrt(1.0 - rise * rise)) / (w * w + across * across)
        slopes = (0.0, rate * (ey * w + across * x / w), rate * (across * y / w - ex * w))
        return half - math.asin(rise), slopes

    def axes(self, q: Vector) -> Vector:
        """Return the axis values of joint values: those of the axes' own joints."""
        return np.array([mm_from_m(float(q[n])) for n in (0, 1, *self._carriages)])

    def dq_daxes(self, axes: Vector) -> Matrix:
        """Return the derivative by elimination."""
        J = np.zeros((self._count, len(axes)))
        found = self._state(axes)
        if found is None:
            return np.full(J.shape, math.nan)
        state, heights = found
        rows = self.rods.equations(state, heights)
        # (3, 3): h, x and y by the heights.
        pushed = [[row[1] if n == m else 0.0 for m, row in enumerate(rows)] for n in range(RODS)]
        rates = np.array([solved(rows, one) for one in pushed]).T
        J[0, 0] = J[1, 1] = 1.0
        first = self._carriages[0]
        J[_SLIDES:first, _SLIDES:] = self._table_slopes(*state) @ rates
        for n, ((way, by_x, by_y), (ex, ey)) in enumerate(
            zip(self.rods.rods(state, heights), self.rods.directions, strict=True)
        ):
            row = self._carriages[n]
            frame = np.array([[ex, ey, 0.0], [-ey, ex, 0.0], [0.0, 0.0, 1.0]])
            moved = np.array([(0.0, 0.0, 1.0), by_x, by_y]).T @ rates
            moved[2, n] -= 1.0
            out, _, up = frame @ way
            d_out, d_across, d_up = frame @ moved
            J[row, _SLIDES + n] = 1.0
            J[row + 1, _SLIDES:] = (up * d_out - out * d_up) / (out * out + up * up)
            if not self.radial:
                J[row + 2, _SLIDES:] = self.rods.hanging * d_across / math.hypot(out, up)
        if not self.radial:
            J[-2, _SLIDES:] = self._link(state)[1] @ rates
            J[-1] = -J[-2]
        return J

    def _table_slopes(self, _: float, x: float, y: float) -> Matrix:
        """Return the derivatives of the table's joints by h, x and y."""
        w, along = math.sqrt(1.0 - x * x - y * y), 2.0 * self.rods.offset * complex(x, -y)
        up, level, s, t = 1.0 - 2.0 * (x * x + y * y), 1.0 - 2.0 * y * y, 2.0 * w * x, 2.0 * w * y
        both = -2.0 * x * y / w  # of s by y, and of t by x
        a, b, c = s * s + up * up, math.sqrt(1.0 - t * t), level * level + (2.0 * x * y) ** 2
        shifts = [[1.0, 0.0, 0.0], [0.0, along.real, along.imag], [0.0, along.imag, -along.real]]
        turns = [
            [0.0, (up * 2.0 * (w - x * x / w) + 4.0 * x * s) / a, (up * both + 4.0 * y * s) / a],
            [0.0, both / b, 2.0 * (w - y * y / w) / b],
            [0.0, -2.0 * y * level / c, -2.0 * x * (level + 4.0 * y * y) / c],
        ]
        return np.array([*(shifts if self.radial else shifts[:1]), *turns])

    def refusal(self, axes: Vector) -> ChainbuildError | None:
        """Return which rod is too short or too long where the table comes to rest, and by how much, or None."""
        heights = [m_from_mm(value) for value in axes.tolist()[_SLIDES:]]
        state, gone = self.rods.reached(heights)
        if gone == 1.0:
            return None
        missing = [math.hypot(*way) - self.rods.length for way, _, _ in self.rods.rods(state, heights)]
        n = max(range(RODS), key=lambda k: abs(missing[k]))
        length = f"{mm_from_m(abs(missing[n])):.6g} mm too {'short' if missing[n] > 0.0 else 'long'}"
        name, tilt = self.names[_SLIDES + n], 2.0 * deg_from_rad(math.asin(math.hypot(state[1], state[2])))
        stops = f"after {100.0 * gone:.4g} % of the way from equal heights it stops at a tilt of {tilt:.4g} deg"
        text = f"the table does not get there: {stops}, where the rod of {name} is {length}"
        return AxisValueError(text, parameter=name, permitted="axis values at which the table closes")

    def losses(self, axes: Vector) -> tuple[Loss, ...]:
        """Return every function that vanishes at a singularity; none where the way from home does not lead.

        A carriage moves nothing where its rod lies flat. The table moves by itself where every rod stands across the
        motion of its joint: the slopes of the three lengths by h, x and y have no full rank there.
        """
        found = self._state(axes)
        if found is None:
            return ()
        names, length = self.names[_SLIDES:], self.rods.length
        rows = np.array([row[1:] for row in self.rods.equations(*found)]) / length
        carriages = tuple(range(_SLIDES, _SLIDES + RODS))
        flat = strut_losses([(float(row[0]), "the rod of {name} {nearly}lies flat") for row in rows], names)
        struts = [replace(loss, axes=(_SLIDES + loss.axes[0],)) for loss in flat]
        scaled = rows / [1.0, 2.0 * self.rods.table, 2.0 * self.rods.table]
        _, values, Vt = np.linalg.svd(scaled)
        motion = Vt[-1] / [1.0, 2.0 * self.rods.table, 2.0 * self.rods.table]
        rates = np.zeros(self._count)
        rates[_SLIDES : self._carriages[0]] = self._table_slopes(*found[0]) @ motion
        value = float(np.copysign(values[-1], np.linalg.det(scaled))) / _FULL
        words = f"the rods of {and_joined(names)} {{nearly}}stand across a motion of the table"
        return (*struts, Loss("platform", value, carriages, words, rates=rates))

    def strut_ranges(self) -> tuple[StrutRange | None, ...]:
        """Return how far the carriages are drawn apart: as much as a table with all its radius upright; around 0."""
        apart = mm_from_m(self.rods.table)
        return (None,) * _SLIDES + ((-apart, apart),) * RODS

    def posed(self, target: Matrix, tool: Matrix, workpiece: Matrix) -> Vector:
        """Return the joint values between the tips that bring the upright tool to a pose; others are 0."""
        w, x, y = _tilt_upright(workpiece[:3, :3] @ target[:3, 2])
        R = np.array([
            [1.0 - 2.0 * y * y, 2.0 * x * y, 2.0 * w * y],
            [2.0 * x * y, 1.0 - 2.0 * x * x, -2.0 * w * x],
            [-2.0 * w * y, 2.0 * w * x, 1.0 - 2.0 * (x * x + y * y)],
        ])  # fmt: skip
        tip = R @ (workpiece[:3, :3] @ target[:3, 3] + workpiece[:3, 3]) - tool[:3, 3]
        centre = self.rods.centre(x, y)
        q = np.zeros(self._count)
        q[0], q[1] = centre.real + tip[0], centre.imag + tip[1]
        q[_SLIDES : self._carriages[0]] = self._table_joints(-float(tip[2]), x, y)
        return q

    def _joints(self, q: Vector) -> list[Triple] | None:
        """Return the table's joints [m] at joint values between the tips, or None for a table beyond upright."""
        centre = [*(q[_SLIDES + 1 : _SLIDES + 3] if self.radial else (0.0, 0.0)), q[_SLIDES]]
        a, b, c = (deg_from_rad(float(value)) for value in q[self._carriages[0] - 3 : self._carriages[0]])
        R = rot_x(a) @ rot_y(b) @ rot_z(c)
        if R[2, 2] < _LEVEL:
            return None
        found = (centre + self.rods.table * (R[:, :2] @ direction) for direction in self.rods.directions)
        return [(float(x), float(y), float(z)) for x, y, z in found]

    def closing(self, q: Vector) -> list[list[float]]:
        """Return X and Y as they are, and the heights of each carriage that reach the table, the usual side first."""
        values = [[mm_from_m(float(q[0]))], [mm_from_m(float(q[1]))]]
        joints = self._joints(q)
        if joints is None:
            return [*values, [], [], []]
        for (x, y, z), (ex, ey) in zip(joints, self.rods.directions, strict=True):
            square = self.rods.length**2 - (x - self.rods.columns * ex) ** 2 - (y - self.rods.columns * ey) ** 2
            rise = self.rods.hanging * math.sqrt(max(square, 0.0))
            sides = (rise, -rise) if self.rods.may_lie_flat else (rise,)
            values.append([] if square < 0.0 else [mm_from_m(z + side) for side in sides])
        return values

    def rank(self, axes: Vector) -> int:
        """Return how many carriages stand on the other side of the table than at home."""
        found = self._state(axes)
        ways = [] if found is None else self.rods.rods(*found)
        return sum(way[2] * self.rods.hanging > 0.0 for way, _, _ in ways)

    def unreached(self, q: Vector) -> str:
        """Return which rods are too short for the table, and by how much, or why it does not get there."""
        joints = self._joints(q)
        if joints is None:
            return "the table would stand upright, or beyond"
        words = []
        for (x, y, _), (ex, ey), name in zip(joints, self.rods.directions, self.names[_SLIDES:], strict=True):
            missing = math.hypot(x - self.rods.columns * ex, y - self.rods.columns * ey) - self.rods.length
            if missing > 0.0:
                words.append(f"the rod of {name} is {mm_from_m(missing):.6g} mm too short")
        return ", ".join(words) or "a singular position lies on the way there from equal heights"

    def drawn_axes(self, rng: np.random.Generator, lower: Vector, upper: Vector) -> Vector | None:
        """Return axis values at a random tilt, those of small ones more often, with the carriages as it asks."""
        size, turn = _STEEPEST * float(rng.random()), float(rng.uniform(0.0, math.tau))
        state = (0.0, size * math.cos(turn), size * math.sin(turn))
        rises = []
        for (x, y, z), _, _ in self.rods.rods(state, [0.0] * RODS):
            square = self.rods.length**2 - x * x - y * y
            if square < 0.0:
                return None
            rises.append(mm_from_m(z + self.rods.hanging * math.sqrt(square)))
        axes = lower + (upper - lower) * rng.random(len(lower))
        least = max(low - rise for low, rise in zip(lower[_SLIDES:], rises, strict=True))
        most = min(high - rise for high, rise in zip(upper[_SLIDES:], rises, strict=True))
        if least > most:
            return None
        axes[_SLIDES:] = np.array(rises) + float(rng.uniform(least, most))
        return axes if self._state(axes) is not None else None

    def q_bounds(self, lower: Vector, upper: Vector) -> tuple[Vector, Vector]:
        """Return bounds of the joint values: the table is within a rod of every carriage."""
        low, high = ([m_from_mm(value) for value in ends.tolist()] for ends in (lower, upper))
        length, aside, right = self.rods.length, self.rods.table / 2.0, math.pi / 2.0
        # The height is the mean of those of the joints, each within a rod of its carriage.
        rise = (sum(low[_SLIDES:]) / RODS - length, sum(high[_SLIDES:]) / RODS + length)
        bounds = [*zip(low[:_SLIDES], high[:_SLIDES], strict=True), rise]
        bounds += [*([(-aside, aside)] * 2 if self.radial else []), *[(-right, right)] * 3]
        for ends in zip(low[_SLIDES:], high[_SLIDES:], strict=True):
            bounds += [ends, (-math.pi, math.pi), *([] if self.radial else [(-right, right)])]
        bounds += [] if self.radial else [(-right, right)] * 2
        return np.array([one[0] for one in bounds]), np.array([one[1] for one in bounds])


def _tilt_upright(direction: Vector) -> Triple:
    """Return the quaternion (w, x, y, 0) of the tilt that brings a direction (3,) of the table to Z."""
    x, y, z = direction.tolist()
    size = math.hypot(1.0 + z, x, y)
    return ((1.0 + z) / size, y / size, -x / size) if size > _LEVEL else (0.0, 1.0, 0.0)
