"""Six rotary axes of which three neighbouring ones, 2, 3 and 4 or 3, 4 and 5, are parallel: all solutions.

What the parallel axes turn keeps its height along them. With E = T·M⁻¹ = E1·…·E6 and h along axes 2, 3 and 4, a point
and the direction of axis 6, which E6 leaves alone, therefore give two equations without joints 2, 3, 4 and 6:

    h·(E1⁻¹·E·x) = h·(E5·x)            x on axis 6
    h·(R1⁻¹·R·k6) = h·(R5·k6)

Both are linear in the cosine and sine of angle 1 and in those of angle 5. Where axes 5 and 6 meet or are parallel, one
of them has angle 1 alone: two values of it with two of angle 5 each; else they leave one unknown of degree four. Angle
6 follows from what it does to h, and then the motion of the parallel axes is known: a planar arm of two links.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix
from chainbuild.frames import inverse
from chainbuild.ik.branches.arms.angle_pairs import AnglePairs, Pair, angle_pairs
from chainbuild.ik.branches.arms.parallel_axes import ParallelArm
from chainbuild.ik.branches.core.plain import PlainVector, plain_cross, plain_dot, plain_length, plain_turned
from chainbuild.ik.branches.core.serial import Solution
from chainbuild.ik.branches.core.subproblems import ON_AXIS, TOUCH, half_open

Sinusoid = tuple[float, float, float]  # a, b, c of a·cos + b·sin = c

# Half the difference of two angles, sines and shares of lengths below this are 0: rounding of a cosine near 1 leaves
# its angle uncertain by the square root of the last digit, 1.5e-8.
_ROUNDING: Final = 1e-7
_TURN: Final = math.radians(5.0)  # between the angles that are tried where the one to keep leads nowhere
_HALVINGS: Final = 20  # of these five degrees: to 1e-7 rad


class ThreeParallelAxes:
    """All solutions of an arm with three parallel axes.

    Args:
        arm: Its measures.
    """

    def __init__(self, arm: ParallelArm) -> None:
        self.arm = arm

    def solve(self, target: Matrix, keep: Sequence[float]) -> tuple[list[Solution], bool]:
        """Return the joint values of a pose, and whether some may be missing.

        Where a joint is free it has its value to keep, or the nearest one to it with which the others reach the pose.

        Args:
            target: (4, 4) tool in the workpiece frame [m].
            keep: (6,) values to keep [rad].
        """
        if self.arm.backwards:
            target, keep = inverse(target), keep[::-1]
        E = (self.arm.before @ target @ self.arm.after).tolist()
        found, free, doubtful = self._found(E, keep)
        if free and not found:
            found = self._beside(E, keep)
            doubtful = not found
        if self.arm.backwards:
            found = [(values[::-1], loose[::-1]) for values, loose in found]
        return found, doubtful

    def _found(self, E: list[list[float]], keep: Sequence[float]) -> tuple[list[Solution], bool, bool]:
        """Return the solutions of a motion, whether angle 1 is free, and whether some may be missing."""
        pairs, free, doubtful = self._pairs(E, keep)
        found: list[Solution] = []
        for first, fifth in pairs:
            found += self._completed(E, (first, fifth), keep, free=free)
        return found, free, doubtful

    def _beside(self, E: list[list[float]], keep: Sequence[float]) -> list[Solution]:
        """Return the solutions with the free angle 1 nearest to its value to keep, which itself has none."""

        def turned(way: float) -> list[Solution]:
            return self._found(E, (keep[0] + way, *keep[1:]))[0]

        ways = [sign * n * _TURN for n in range(1, round(math.pi / _TURN) + 1) for sign in (1.0, -1.0)]
        outer = next((way for way in ways if turned(way)), None)
        if outer is None:
            return []
        inner = outer - math.copysign(_TURN, outer)
        for _ in range(_HALVINGS):
            middle = 0.5 * (inner + outer)
            inner, outer = (inner, middle) if turned(middle) else (middle, outer)
        return turned(outer)

    def _pairs(self, E: list[list[float]], keep: Sequence[float]) -> AnglePairs:
        """Return angles 1 and 5 of a motion."""
        rows = self._equations(E)
        if self.arm.alone == 2:
            (a, b, e, c, d, f), (g, h, k, m, n, p) = rows
            return angle_pairs((a, b, g, h), (e - f, k - p), (c, d, m, n), keep[0])
        with_one, with_both = rows[self.arm.alone], rows[1 - self.arm.alone]
        x, y, z, _, _, w = with_one
        firsts = _turns((x, y, w - z))
        x, y, z, u, v, w = with_both
        if firsts is None:
            # Every angle 1 is right. The nearest with which there is an angle 5:
            amplitude = math.hypot(u, v)
            level = _nearest_within((x, y, z - w), -amplitude, amplitude, keep[0])
            first = [] if level is None else [level]
        else:
            first = firsts
        pairs: list[Pair] = []
        for angle in first:
            right = x * math.cos(angle) + y * math.sin(angle) + z - w
            pairs += [(angle, fifth) for fifth in _turns((u, v, right)) or ()]
        return AnglePairs(pairs, free=firsts is None)

    def _equations(self, E: list[list[float]]) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return both equations as x·cos q1 + y·sin q1 + z = u·cos q5 + v·sin q5 + w, the first in arm sizes."""
        arm = self.arm
        (one, five, six), (on_one, on_five, on_six) = arm.axes, arm.points
        moved = _difference(_moved(E, on_six), on_one)
        x, y, z = _heights(one, moved)
        u, v, w = _heights(five, _difference(on_six, on_five))
        share = 1.0 / arm.size
        place = (x * share, -y * share, (z + on_one[2]) * share, u * share, v * share, (w + on_five[2]) * share)
        x, y, z = _heights(one, _turned(E, six))
        return place, (x, -y, z, *_heights(five, six))

    def _completed(self, E: list[list[float]], pair: Pair, keep: Sequence[float], *, free: bool) -> list[Solution]:
        """Return the solutions with an angle 1, free or not, and an angle 5."""
        (first, fifth), (one, five, six) = pair, self.arm.axes
        up = (0.0, 0.0, 1.0)
        seen = _turned_back(E, plain_turned(one, first, up))
        wanted = plain_turned(five, -fifth, up)
        across = plain_cross(seen, wanted)
        last_free = max(plain_length(plain_cross(six, seen)), plain_length(plain_cross(six, wanted))) < _ROUNDING
        level = plain_dot(six, seen) * plain_dot(six, wanted)
        lasts = [math.atan2(plain_dot(six, across), plain_dot(seen, wanted) - level)]
        if last_free:
            lasts = self._nearest_reach(E, first, fifth, keep[5])
        found: list[Solution] = []
        for last in lasts:
            x, y, turn = self._planar(E, first, fifth, last)
            for second, third, second_free in self._links(x, y, keep[1]):
                fourth = half_open(turn - second - third)
                values = (first, second, third * self.arm.signs[0], fourth * self.arm.signs[1], fifth, last)
                found.append((np.array(values), (free, second_free, False, False, False, last_free)))
        return found

    def _planar(self, E: list[list[float]], first: float, fifth: float, last: float) -> tuple[float, float, float]:
        """Return where the parallel axes bring axis 4, and by which angle they turn."""
        one, five, six = self.arm.axes
        on_one, on_five, on_six = self.arm.points
        place = _about(on_six, six, -last, _about(on_five, five, -fifth, self.arm.tip))
        x, y, _ = _about(on_one, one, -first, _moved(E, place))
        aside = plain_turned(six, -last, plain_turned(five, -fifth, (1.0, 0.0, 0.0)))
        cosine, sine, _ = plain_turned(one, -first, _turned(E, aside))
        return x, y, math.atan2(sine, cosine)

    def _links(self, x: float, y: float, keep: float) -> list[tuple[float, float, bool]]:
        """Return the angles of the two links that reach a place, and whether the first one is free."""
        inner, outer = self.arm.links
        distance = math.hypot(x, y)
        bends = _turns((1.0, 0.0, (distance * distance - inner * inner - outer * outer) / (2.0 * inner * outer)))
        found = []
        for bend in bends or ():
            ahead = math.atan2(outer * math.sin(bend), inner + outer * math.cos(bend))
            free = distance < _ROUNDING * self.arm.size
            second = keep if free else half_open(math.atan2(y, x) - self.arm.lead - ahead)
            found.append((second, half_open(bend - self.arm.bend), free))
        return found

    def _nearest_reach(self, E: list[list[float]], first: float, fifth: float, keep: float) -> list[float]:
        """Return the angle 6 nearest to another with which the links reach axis 4, where axis 6 is parallel to them.

        It then takes axis 4 along a circle: the square of the distance is a sinusoid of the angle. Where that leaves
        the reach on both sides, the links reach it on two arcs, and no motion leads from one to the other: there the
        angle is the mirror image.
        """
        squares = []
        for angle in (0.0, math.pi / 2.0, math.pi):
            x, y, _ = self._planar(E, first, fifth, angle)
            squares.append(x * x + y * y)
        middle = (squares[0] + squares[2]) / 2.0
        wave = ((squares[0] - squares[2]) / 2.0, squares[1] - middle, middle)
        low, high = (self.arm.links[0] - self.arm.links[1]) ** 2, (self.arm.links[0] + self.arm.links[1]) ** 2
        nearest = _nearest_within(wave, low, high, keep)
        if nearest is None:
            return []
        amplitude, slack = math.hypot(wave[0], wave[1]), TOUCH * max(high, wave[2])
        if wave[2] + amplitude > high + slack and wave[2] - amplitude < low - slack:
            return [nearest, half_open(2.0 * math.atan2(wave[1], wave[0]) - nearest)]
        return [nearest]


def _turns(equation: Sinusoid) -> list[float] | None:
    """Return the angles t with a·cos t + b·sin t = c, lengths in arm sizes; None where all do."""
    a, b, c = equation
    amplitude = math.hypot(a, b)
    if amplitude <= ON_AXIS:
        return None if abs(c) <= TOUCH else []
    middle, cosine = math.atan2(b, a), c / amplitude
    if abs(cosine) > 1.0 + TOUCH:
        return []
    spread = 2.0 * math.atan2(math.sqrt(max(1.0 - cosine, 0.0)), math.sqrt(max(1.0 + cosine, 0.0)))
    if spread < _ROUNDING or math.pi - spread < _ROUNDING:
        return [half_open(middle + (0.0 if spread < 1.0 else math.pi))]
    return [half_open(middle + spread), half_open(middle - spread)]


def _nearest_within(wave: Sinusoid, low: float, high: float, keep: float) -> float | None:
    """Return the angle t nearest to another with low ≤ a·cos t + b·sin t + c ≤ high, or None."""
    a, b, c = wave
    slack = TOUCH * max(abs(high), abs(c))
    if low - slack <= a * math.cos(keep) + b * math.sin(keep) + c <= high + slack:
        return keep
    ends = [angle for bound in (low, high) for angle in _turns((a, b, bound - c)) or ()]
    return min(
        (keep + math.remainder(angle - keep, math.tau) for angle in ends), key=lambda t: abs(t - keep), default=None
    )


def _heights(k: PlainVector, p: PlainVector) -> PlainVector:
    """Return a, b, c with a·cos t + b·sin t + c = z of p turned about k by t."""
    along = plain_dot(k, p)
    return p[2] - k[2] * along, k[0] * p[1] - k[1] * p[0], k[2] * along


def _about(point: PlainVector, k: PlainVector, angle: float, p: PlainVector) -> PlainVector:
    x, y, z = plain_turned(k, angle, _difference(p, point))
    return x + point[0], y + point[1], z + point[2]


def _turned(E: list[list[float]], p: PlainVector) -> PlainVector:
    a, b, c, _ = E
    x, y, z = p
    return a[0] * x + a[1] * y + a[2] * z, b[0] * x + b[1] * y + b[2] * z, c[0] * x + c[1] * y + c[2] * z


def _turned_back(E: list[list[float]], p: PlainVector) -> PlainVector:
    a, b, c, _ = E
    x, y, z = p
    return a[0] * x + b[0] * y + c[0] * z, a[1] * x + b[1] * y + c[1] * z, a[2] * x + b[2] * y + c[2] * z


def _moved(E: list[list[float]], p: PlainVector) -> PlainVector:
    x, y, z = _turned(E, p)
    return x + E[0][3], y + E[1][3], z + E[2][3]


def _difference(p: PlainVector, q: PlainVector) -> PlainVector:
    return p[0] - q[0], p[1] - q[1], p[2] - q[2]
