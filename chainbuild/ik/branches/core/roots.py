"""All real roots of trigonometric and ordinary polynomials that are given by their values.

A trigonometric polynomial of degree n in an angle t is a polynomial of degree 2n in z = exp(i·t); its real angles are
the roots on the unit circle. Both kinds are interpolated at roots of unity, where that loses no digits.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Vector

ComplexVector = NDArray[np.complex128]

# How far beside the real ones a root may lie: rounding moves a double root by the square root of the last digit.
NEARLY_REAL: Final = 1e-4
_NOTHING: Final = 1e-13  # a coefficient below this share of the largest is rounding


def real_angles(f: Callable[[Vector], Vector], degree: int) -> list[float]:
    """Return the angles in (−π, π] where a trigonometric polynomial vanishes; none where it vanishes everywhere.

    Args:
        f: Angles (n,) → values (n,).
        degree: Its degree.
    """
    count = 2 * degree + 1
    values = f(2.0 * np.pi * np.arange(count) / count)
    spectrum = np.fft.fft(values)
    # From z^degree down to z^−degree.
    roots = _roots(np.concatenate([spectrum[degree::-1], spectrum[:degree:-1]]))
    return [float(np.angle(z)) for z in roots if abs(abs(z) - 1.0) < NEARLY_REAL]


def real_lengths(f: Callable[[ComplexVector], ComplexVector], degree: int, scale: float) -> list[float]:
    """Return the real numbers where a polynomial vanishes; none where it vanishes everywhere.

    Args:
        f: Complex numbers (n,) → values (n,).
        degree: Its degree at most.
        scale: The size of its roots.
    """
    count = degree + 1
    points = scale * np.exp(2j * np.pi * np.arange(count) / count)
    roots = _roots(np.fft.fft(f(points))[::-1])
    return [float(z.real) * scale for z in roots if abs(z.imag) < NEARLY_REAL * (1.0 + abs(z))]


def _roots(coefficients: ComplexVector) -> ComplexVector:
    """Return the roots of a polynomial, highest power first."""
    sizes = np.abs(coefficients)
    largest = float(sizes.max(initial=0.0))
    if largest == 0.0 or not np.isfinite(largest):
        return np.empty(0, dtype=complex)
    trimmed = np.where(sizes <= _NOTHING * largest, 0.0, coefficients)
    return np.asarray(np.roots(trimmed), dtype=complex)
