"""Zeros of a sum of cosines along a block, none missed.

On a box of half width h about t, with |f⁽ᵏ⁾| ≤ M_k:

    no zero             |f| > |f′|·h + M2·h²/2
    at most one zero    |f′| > M2·h                 f is monotonic: the signs at the ends tell, and bisection finds it
    one extremum        |f″| > M3·h                 f′ is monotonic: its zero splits the box, or is a touch

Every other box is halved. M_k = Σ |a|·|ω|ᵏ. The first-order bound alone would not end at a touch.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from chainbuild.analysis.vanishing.functions import SingularFunction
from chainbuild.arrays import Matrix, Vector

TOUCHES: Final = 1e-12  # functions are about 1 and rounded to some 1e-15: below this an extremum is a zero
_STILL: Final = 1e-12  # rad over a block: a cosine that turns less is constant
_ALIKE: Final = 1e-12  # rad over a block: cosines whose rates differ less are one
_ENDS: Final = 1e-12  # width of a bracket at which bisection ends
_NARROW: Final = 1e-9  # half width of a box whose extremum is taken for a touch: places are promised to 1e-6


@dataclass(frozen=True, slots=True)
class Wave:
    """f(t) = c + Σ a·cos(α + ω·t) for t in 0 … 1, with bounds of its derivatives.

    Attributes:
        constant: c.
        terms: (a, α [rad], ω [rad]) of each cosine; rates differ and none is 0.
    """

    constant: float
    terms: tuple[tuple[float, float, float], ...]

    def bound(self, order: int) -> float:
        """Return a bound of the absolute value of a derivative of order 1 or higher."""
        return math.fsum(a * abs(w) ** order for a, _, w in self.terms)

    def at(self, t: float) -> float:
        """Return f(t)."""
        return self.constant + sum(a * math.cos(phase + w * t) for a, phase, w in self.terms)

    def derivatives(self, t: float) -> tuple[float, float, float]:
        """Return f, f′ and f″ at t."""
        value, first, second = self.constant, 0.0, 0.0
        for a, phase, w in self.terms:
            angle = phase + w * t
            cosine = a * math.cos(angle)
            value += cosine
            first -= a * w * math.sin(angle)
            second -= w * w * cosine
        return value, first, second

    def shifted(self, by: float) -> Wave:
        """Return f + by."""
        return Wave(self.constant + by, self.terms)

    def slope(self) -> Wave:
        """Return f′."""
        return Wave(0.0, tuple((a * abs(w), phase + math.copysign(math.pi / 2.0, w), w) for a, phase, w in self.terms))


def wave_of(amplitudes: Vector, angles: Vector, rates: Vector) -> Wave:
    """Return the wave of cosines, those of one rate added up.

    Args:
        amplitudes: (m,).
        angles: (m,) at the begin of the block [rad].
        rates: (m,) over the whole block [rad].
    """
    constant, sums = 0.0, list[tuple[float, complex]]()
    for a, angle, rate in zip(amplitudes.tolist(), angles.tolist(), rates.tolist(), strict=True):
        if abs(rate) < _STILL:
            constant += a * math.cos(angle)
            continue
        # cos(α − ω·t) = cos(−α + ω·t)
        part = a * complex(math.cos(angle), math.copysign(1.0, rate) * math.sin(angle))
        for n, (other, total) in enumerate(sums):
            if abs(other - abs(rate)) < _ALIKE:
                sums[n] = (other, total + part)
                break
        else:
            sums.append((abs(rate), part))
    terms = [(abs(total), math.atan2(total.imag, total.real), rate) for rate, total in sums if abs(total) > TOUCHES]
    return Wave(constant, tuple(terms))


def zeros(wave: Wave) -> list[float]:
    """Return every zero in 0 … 1 in rising order; touches and zeros at the ends count, each once.

    A wave that is 0 throughout (up to `TOUCHES`) has none: `throughout` tells.
    """
    if not wave.terms:
        return []
    found = _of_one(wave) if len(wave.terms) == 1 else _of_many(wave)
    found.sort()
    return [t for n, t in enumerate(found) if n == 0 or t - found[n - 1] > _NARROW]


def throughout(wave: Wave, near: float) -> bool:
    """Return whether |f| ≤ near holds on all of 0 … 1 because f does not vary enough to leave."""
    return abs(wave.constant) + math.fsum(a for a, _, _ in wave.terms) <= near


def _of_one(wave: Wave) -> list[float]:
    """Return the zeros of c + a·cos(α + ω·t), in closed form."""
    a, phase, w = wave.terms[0]
    cosine = -wave.constant / a
    if abs(cosine) > 1.0 + TOUCHES / a:
        return []
    angle = math.acos(max(-1.0, min(1.0, cosine)))
    low, high = sorted((phase, phase + w))
    found = []
    for side in {angle, -angle}:
        first = math.ceil((low - side) / math.tau - _NARROW)
        last = math.floor((high - side) / math.tau + _NARROW)
        found += [(side + turn * math.tau - phase) / w for turn in range(first, last + 1)]
    return [min(max(t, 0.0), 1.0) for t in found if -_NARROW <= t <= 1.0 + _NARROW]


def _of_many(wave: Wave) -> list[float]:
    found = [t for t in (0.0, 1.0) if abs(wave.at(t)) <= TOUCHES]
    second, third = wave.bound(2), wave.bound(3)
    slope = wave.slope()
    boxes = [(0.0, 1.0)]
    while boxes:
        low, high = boxes.pop()
        t, h = (low + high) / 2.0, (high - low) / 2.0
        f, f1, f2 = wave.derivatives(t)
        if abs(f) > abs(f1) * h + second * h * h / 2.0:
            continue
        if abs(f1) > second * h:
            found += _between(wave, low, high)
        elif abs(f2) > third * h:
            # f′ is monotonic: f has one extremum in the box or none.
            turn = _bisected(slope, low, high)
            if turn is None:
                found += _between(wave, low, high)
            elif abs(wave.at(turn)) <= TOUCHES:
                found.append(turn)
            else:
                found += [*_between(wave, low, turn), *_between(wave, turn, high)]
        elif h < _NARROW:
            found.append(t)
        else:
            boxes += [(low, t), (t, high)]
    return found


def _between(wave: Wave, low: float, high: float) -> list[float]:
    t = _bisected(wave, low, high)
    return [] if t is None else [t]


def _bisected(wave: Wave, low: float, high: float) -> float | None:
    """Return the zero of a monotonic wave, or None where it has one sign: Newton's steps kept inside the bracket."""
    below, above = wave.at(low), wave.at(high)
    if below == 0.0 or above == 0.0:
        return low if below == 0.0 else high
    if (below > 0.0) == (above > 0.0):
        return None
    t = low + (high - low) * below / (below - above)
    while high - low > _ENDS:
        f, f1, _ = wave.derivatives(t)
        if f == 0.0:
            return t
        if (f > 0.0) == (below > 0.0):
            low = t
        else:
            high = t
        step = t - f / f1 if f1 else math.inf
        # Half a bracket beyond the zero, so that both ends close in.
        inner = step + math.copysign(min(_ENDS / 4.0, (high - low) / 4.0), f * (1.0 if below > 0.0 else -1.0))
        t = inner if low < inner < high else (low + high) / 2.0
    return (low + high) / 2.0


@dataclass(frozen=True, slots=True, eq=False)
class Waves:
    """One function along many blocks at once.

    Attributes:
        amplitudes: (m,).
        angles: (N, m) at the begin of each block [rad].
        rates: (N, m) over each block [rad].
    """

    amplitudes: Vector
    angles: Matrix
    rates: Matrix

    @classmethod
    def along(cls, function: SingularFunction, q: Matrix) -> Waves:
        """Return a function along the blocks between rows of joint values (N + 1, n_q)."""
        angles = q @ function.multiples.T + function.phases
        return cls(function.amplitudes, angles[:-1], np.diff(q, axis=0) @ function.multiples.T)

    def block(self, n: int) -> Wave:
        """Return the wave of block n."""
        return wave_of(self.amplitudes, self.angles[n], self.rates[n])

    def not_clear(self, near: float, halvings: int) -> Vector:
        """Return the indices of blocks whose |f| is not proven to stay above `near`.

        Args:
            near: Threshold.
            halvings: How often a box is halved before it is given up.
        """
        open_blocks = np.arange(len(self.angles))
        middles, half = np.full(len(open_blocks), 0.5), 0.5
        for level in range(halvings + 1):
            rates = self.rates[open_blocks]
            angles = self.angles[open_blocks] + middles[:, None] * rates
            f = np.cos(angles) @ self.amplitudes
            first = (np.sin(angles) * rates) @ self.amplitudes
            second = rates**2 @ np.abs(self.amplitudes)
            left = np.abs(f) - near <= np.abs(first) * half + second * half**2 / 2.0
            open_blocks, middles = open_blocks[left], middles[left]
            if not len(open_blocks) or level == halvings:
                break
            half /= 2.0
            open_blocks = np.repeat(open_blocks, 2)
            middles = np.repeat(middles, 2) + np.tile([-half, half], len(middles))
        return np.unique(open_blocks)
