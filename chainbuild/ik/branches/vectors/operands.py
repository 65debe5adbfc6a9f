"""Formulas that take numbers or arrays alike: of many poses at once by NumPy, or of one by compiled code.

`compiled` says what these functions are for numbers.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np

# A number or an array of them, and tuples of these; a pose is twelve numbers, a 3×4 matrix row by row.
Operand = Any

BRANCHES: Final = 8  # of a pose: three choices of two


def arctan2(y: Operand, x: Operand) -> Operand:
    """Return the angle of (x, y)."""
    return np.arctan2(y, x)


def sine_cosine(angle: Operand) -> Operand:
    """Return sine and cosine, through the tangent of half the angle: NumPy is quicker at one tangent than at both."""
    t = np.tan(0.5 * angle)
    share = 2.0 / (1.0 + t * t)
    return t * share, share - 1.0


def root(value: Operand) -> Operand:
    """Return the square root."""
    return np.sqrt(value)


def where(condition: Operand, a: Operand, b: Operand) -> Operand:
    """Return a where a condition holds, else b."""
    return np.where(condition, a, b)


def six(c: Operand, row: int) -> Operand:
    """Return a row as six numbers."""
    return c[row, 0], c[row, 1], c[row, 2], c[row, 3], c[row, 4], c[row, 5]


def rows_of_axes(c: Operand, at: int) -> Operand:
    """Return what leads from angles to axis values, back again, and the limits, of constants from row `at` on."""
    return (
        (six(c, at), six(c, at + 1), six(c, at + 2), six(c, at + 3), six(c, at + 4), six(c, at + 5), six(c, at + 6)),
        (
            six(c, at + 7),
            six(c, at + 8),
            six(c, at + 9),
            six(c, at + 10),
            six(c, at + 11),
            six(c, at + 12),
            six(c, at + 13),
        ),
        (six(c, at + 14), six(c, at + 15), six(c, at + 16), six(c, at + 17), six(c, at + 18), six(c, at + 19)),
    )  # fmt: skip


def product(a: Operand, b: Operand) -> Operand:
    """Return the product of two poses."""
    return (
        a[0] * b[0] + a[1] * b[4] + a[2] * b[8],
        a[0] * b[1] + a[1] * b[5] + a[2] * b[9],
        a[0] * b[2] + a[1] * b[6] + a[2] * b[10],
        a[0] * b[3] + a[1] * b[7] + a[2] * b[11] + a[3],
        a[4] * b[0] + a[5] * b[4] + a[6] * b[8],
        a[4] * b[1] + a[5] * b[5] + a[6] * b[9],
        a[4] * b[2] + a[5] * b[6] + a[6] * b[10],
        a[4] * b[3] + a[5] * b[7] + a[6] * b[11] + a[7],
        a[8] * b[0] + a[9] * b[4] + a[10] * b[8],
        a[8] * b[1] + a[9] * b[5] + a[10] * b[9],
        a[8] * b[2] + a[9] * b[6] + a[10] * b[10],
        a[8] * b[3] + a[9] * b[7] + a[10] * b[11] + a[11],
    )


def affine(x: Operand, rows: Operand) -> Operand:
    """Return rows·x with the last row of constants added."""
    matrix, last = np.array(rows[:6]), np.array(rows[6])
    stacked = np.array(x[:6])
    flat: Operand = matrix @ stacked.reshape(6, -1) + last[:, None]
    return flat.reshape(stacked.shape)


def by_turns(x: Operand, limits: Operand, n: int) -> Operand:
    """Return an axis value moved by whole turns into its limits, near to the start, and how far rounding may be."""
    wanted, period, per_turn, lower, upper, slack = limits
    near = x - period[n] * np.rint((x - wanted[n]) * per_turn[n])
    low, high = lower[n] - slack[n], upper[n] + slack[n]
    return near + where(near < low, period[n], 0.0) - where(near > high, period[n], 0.0), low, high


def inside(x: Operand, limits: Operand, n: int) -> Operand:
    """Return an axis value moved by whole turns into its limits, near to the start, and whether it is inside."""
    _, _, _, lower, upper, _ = limits
    moved, low, high = by_turns(x, limits, n)
    return np.minimum(np.maximum(moved, lower[n]), upper[n]), (moved >= low) & (moved <= high)
