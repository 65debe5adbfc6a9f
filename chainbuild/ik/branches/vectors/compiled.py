"""The functions of `operands` as machine code: four or eight poses in one instruction.

A loop without a jump becomes vector instructions. That needs an arctangent, a sine and a cosine without jumps: those of
Cephes (Moshier 1989) and Taylor's series.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Final

import numba
import numpy as np
from numba.extending import overload, register_jitable

from chainbuild.ik.branches.vectors import operands
from chainbuild.ik.branches.vectors.operands import affine, arctan2, root, sine_cosine, where
from chainbuild.ik.search.compiled.inner import INNER
from chainbuild.ik.search.compiled.kernels import FAST, jit

LANE: Final = 64  # poses between writing answers: their data stay in the processor's nearest cache
IN_LOOP: Final[Any] = {"forceinline": True, **INNER, **FAST}  # of functions that are put into a loop over poses


def compile_formulas(module: Any, names: Sequence[str]) -> None:
    """Let compiled code call formulas of a module."""
    for name in names:
        register_jitable(**IN_LOOP)(getattr(module, name))


compile_formulas(operands, ("six", "rows_of_axes", "product", "by_turns", "inside"))


@overload(root, jit_options=IN_LOOP)
def _root(value):
    # No formula passes a negative value; the compiler must see it, else it calls the library, which sets errno.
    return lambda value: math.sqrt(abs(value))


@overload(where, jit_options=IN_LOOP)
def _where(condition, a, b):
    return lambda condition, a, b: a if condition else b


@overload(affine, jit_options=IN_LOOP)
def _affine(x, rows):
    return _affine_by_entries


def _affine_by_entries(x, rows):
    return (
        _entry(x, rows, 0), _entry(x, rows, 1), _entry(x, rows, 2),
        _entry(x, rows, 3), _entry(x, rows, 4), _entry(x, rows, 5),
    )  # fmt: skip


@numba.njit(**IN_LOOP)
def _entry(x, rows, n):
    a = rows[n]
    return a[0] * x[0] + a[1] * x[1] + a[2] * x[2] + a[3] * x[3] + a[4] * x[4] + a[5] * x[5] + rows[6][n]


@overload(arctan2, jit_options=IN_LOOP)
def _arctan2(y, x):
    return _arctan2_without_jumps


def _arctan2_without_jumps(y, x):
    """Angle of (x, y): an arctangent below 1, moved below tan(π/8) by 45°, mirrored into its octant."""
    a, b = abs(y), abs(x)
    large, small = max(a, b), min(a, b)
    far = small > 0.4142135623730950488 * large
    t = where(far, small - large, small) / where(far, small + large, large)
    z = t * t
    p = (((-8.750608600031904122785e-1 * z - 1.615753718733365076637e1) * z - 7.500855792314704667340e1) * z
         - 1.228866684490136173410e2) * z - 6.485021904942025371773e1  # fmt: skip
    q = ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z + 4.328810604912902668951e2) * z
         + 4.853903996359136964868e2) * z + 1.945506571482613964425e2  # fmt: skip
    angle = t + t * z * (p / q) + where(far, math.pi / 4.0, 0.0)
    angle = where(a > b, math.pi / 2.0 - angle, angle)
    angle = where(x < 0.0, math.pi - angle, angle)
    return where(y < 0.0, -angle, angle)


@overload(sine_cosine, jit_options=IN_LOOP)
def _sine_cosine(angle):
    return _sine_cosine_without_jumps


def _sine_cosine_without_jumps(angle):
    """Sine and cosine to 1e-11: Taylor's series on ±π/2, mirrored for every half turn. Used for confirming."""
    half_turns = np.rint(angle * (1.0 / math.pi))
    r = angle - half_turns * math.pi
    sign = 1.0 - 4.0 * abs(0.5 * half_turns - np.rint(0.5 * half_turns))
    z = r * r
    sine = 1.0 - z / 210.0
    sine = 1.0 - z / 156.0 * sine
    sine = 1.0 - z / 110.0 * sine
    sine = 1.0 - z / 72.0 * sine
    sine = 1.0 - z / 42.0 * sine
    sine = 1.0 - z / 20.0 * sine
    sine = 1.0 - z / 6.0 * sine
    cosine = 1.0 - z / 240.0
    cosine = 1.0 - z / 182.0 * cosine
    cosine = 1.0 - z / 132.0 * cosine
    cosine = 1.0 - z / 90.0 * cosine
    cosine = 1.0 - z / 56.0 * cosine
    cosine = 1.0 - z / 30.0 * cosine
    cosine = 1.0 - z / 12.0 * cosine
    cosine = 1.0 - z / 2.0 * cosine
    return sign * r * sine, sign * cosine


@numba.njit(**IN_LOOP)
def _put(found, i, slot, x):
    at = slot * 6 * LANE + i
    found[at], found[at + LANE], found[at + 2 * LANE] = x[0], x[1], x[2]
    found[at + 3 * LANE], found[at + 4 * LANE], found[at + 5 * LANE] = x[3], x[4], x[5]


def lane(branches_of: Any, rows_of: Any) -> Any:
    """Return a compiled function that writes the eight branches of poses, six axis values each.

    Args:
        branches_of: From a pose and constants as tuples to the branches.
        rows_of: From constants (n, 6) to tuples.
    """

    @jit
    def branches_of_lane(poses, constants, found):
        """Find the branches of up to `LANE` poses: 48 numbers each, every one in a run of its own."""
        rows = rows_of(constants)
        for i in range(len(poses)):
            T = (
                poses[i, 0, 0], poses[i, 0, 1], poses[i, 0, 2], poses[i, 0, 3],
                poses[i, 1, 0], poses[i, 1, 1], poses[i, 1, 2], poses[i, 1, 3],
                poses[i, 2, 0], poses[i, 2, 1], poses[i, 2, 2], poses[i, 2, 3],
            )  # fmt: skip
            x = branches_of(T, rows)
            _put(found, i, 0, x[0])
            _put(found, i, 1, x[1])
            _put(found, i, 2, x[2])
            _put(found, i, 3, x[3])
            _put(found, i, 4, x[4])
            _put(found, i, 5, x[5])
            _put(found, i, 6, x[6])
            _put(found, i, 7, x[7])

    return branches_of_lane
