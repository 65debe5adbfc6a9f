"""Status and turn of branches, compiled: the twin of `status_turn.status_turn_bits`."""

from __future__ import annotations

import math
from typing import Final

from chainbuild.chain.programmed.status import HAND_AXIS, HAND_NEGATIVE, WRIST_BEHIND, WRIST_IN_FRONT
from chainbuild.ik.search.compiled.kernels import leaf
from chainbuild.tolerances import BELOW_ZERO_DEG, ZERO_VECTOR

# Where the constants of `status_turn.status_constants` begin: axes 2 to 4 by the axis values, products of their cosines
# and sines, axis 2 in front of axis 1.
_ROW: Final = 7  # six factors and a constant
_PRODUCTS: Final = 21
_SHOULDER: Final = 129


@leaf
def write_status(constants, values, bits):
    """Write status and turn of rows of axis values.

    Args:
        constants: Of `status_turn.status_constants`.
        values: (N, 6) degrees.
        bits: (N, 2) out.
    """
    for i in range(len(values)):
        turn = 0
        for m in range(6):
            if values[i, m] < -BELOW_ZERO_DEG:
                turn += 1 << m
        x3, z3, xw, zw = 0.0, 0.0, 0.0, 0.0
        c1, s1 = _wave(constants, values, i, 0)
        c2, s2 = _wave(constants, values, i, _ROW)
        c3, s3 = _wave(constants, values, i, 2 * _ROW)
        for a in range(3):
            first = 1.0 if a == 0 else (c1 if a == 1 else s1)
            for b in range(3):
                second = first * (1.0 if b == 0 else (c2 if b == 1 else s2))
                for c in range(3):
                    share = second * (1.0 if c == 0 else (c3 if c == 1 else s3))
                    at = _PRODUCTS + 4 * (9 * a + 3 * b + c)
                    x3 += share * constants[at]
                    z3 += share * constants[at + 1]
                    xw += share * constants[at + 2]
                    zw += share * constants[at + 3]
        status = WRIST_BEHIND if -constants[_SHOULDER] - xw > ZERO_VECTOR else 0
        if (z3 * xw - x3 * zw) / max(math.sqrt(x3 * x3 + z3 * z3), ZERO_VECTOR) > ZERO_VECTOR:
            status += WRIST_IN_FRONT
        if values[i, HAND_AXIS] < -BELOW_ZERO_DEG:
            status += HAND_NEGATIVE
        bits[i, 0], bits[i, 1] = status, turn


@leaf
def _wave(constants, values, i, at):
    """Return cosine and sine of an angle."""
    angle = constants[at + 6]
    for m in range(6):
        angle += constants[at + m] * values[i, m]
    return math.cos(angle), math.sin(angle)
