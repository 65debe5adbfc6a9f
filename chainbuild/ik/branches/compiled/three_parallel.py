"""Six rotary axes of which three neighbouring ones are parallel, as compiled code: the twin of `arms.three_parallel`.

The same equations, on cosines and sines instead of angles. Where axis 6 is parallel to the three it is free and keeps
its value, or takes the nearest that leads somewhere, as in the twin. Where axis 1 has no effect or equations lose
digits, this says that it is not sure.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from chainbuild.ik.branches.compiled.angle_pairs import MERGED, paired_roots, sinusoid_roots
from chainbuild.ik.branches.core.subproblems import TOUCH
from chainbuild.ik.search.compiled.kernels import jit, leaf

# Where the parts of `three_parallel_constants` begin: M⁻¹ seen from the frame of axis 2, directions of axes 1, 5 and 6,
# points on them and on axis 4, lengths of the links, their angles, signs of axes 3 and 4, then single numbers.
_AFTER: Final = 12
_ONE: Final = 24
_FIVE: Final = 27
_SIX: Final = 30
_ON_ONE: Final = 33
_ON_FIVE: Final = 36
_ON_SIX: Final = 39
_TIP: Final = 42
_LINKS: Final = 45
_LEAD: Final = 47
_BEND: Final = 48
_SIGNS: Final = 49
_ALONE: Final = 51
_SIZE: Final = 52
_BACKWARDS: Final = 53

_TURN: Final = 2.0 * math.pi  # rad

_CENTRE: Final = 1e-14  # squared share of the arm's size: a place so near to axis 2 leaves that axis open

_PARALLEL: Final = 1e-14  # squared sine of the angle between axis 6 and the parallel ones below which it has no effect


@jit
def three_parallel_branches(constants, T, keep, values):
    """Write the joint values of every branch of a pose.

    Args:
        constants: Of `three_parallel_constants`.
        T: (4, 4) tool in the workpiece frame [m].
        keep: (6,) joint values to keep [rad].
        values: (16, COLUMNS) or larger, out: joint values in the order of the screws [rad], any whole turn.

    Returns:
        How many branches were written, and whether these are certainly all.
    """
    E, rows, pairs, work = np.empty((3, 4)), np.empty((2, 6)), np.empty((4, 4)), np.empty((4, 2))
    _write_motion(constants, T, E)
    _write_equations(constants, E, rows)
    alone = int(constants[_ALONE])
    if alone < 2:
        pair_count, sure = _pairs(rows, alone, pairs, work)
    else:
        pair_count, sure = paired_roots(rows, pairs, work)
    count = 0 * pair_count  # not a number written out, for which numba would compile what is called once more
    for n in range(pair_count):
        count, settled = _complete(constants, E, pairs[n], keep, values, count)
        sure = sure and settled
    return count, sure and count > 0


@leaf
def _write_motion(c, T, E):
    """Write the motion from the zero pose, seen from the frame of axis 2."""
    for i in range(3):
        x, y, z, shift = 0.0, 0.0, 0.0, c[4 * i + 3]
        for k in range(3):
            turn = c[4 * i + k]
            if c[_BACKWARDS] != 0.0:
                x, y, z = x + turn * T[0, k], y + turn * T[1, k], z + turn * T[2, k]
                shift -= turn * (T[0, k] * T[0, 3] + T[1, k] * T[1, 3] + T[2, k] * T[2, 3])
            else:
                x, y, z = x + turn * T[k, 0], y + turn * T[k, 1], z + turn * T[k, 2]
                shift += turn * T[k, 3]
        for j in range(4):
            E[i, j] = x * c[_AFTER + j] + y * c[_AFTER + 4 + j] + z * c[_AFTER + 8 + j]
        E[i, 3] += shift


@leaf
def _heights(c, at, x, y, z):
    """Return a, b, e with a·cos t + b·sin t + e = height of a vector turned about an axis by t."""
    k0, k1, k2 = c[at], c[at + 1], c[at + 2]
    along = k0 * x + k1 * y + k2 * z
    return z - k2 * along, k0 * y - k1 * x, k2 * along


@leaf
def _write_equations(c, E, rows):
    """Write both equations: of the point on axis 6, in arm sizes, and of its direction."""
    share = 1.0 / c[_SIZE]
    x, y, z = _turned(E, c[_ON_SIX], c[_ON_SIX + 1], c[_ON_SIX + 2])
    a, b, e = _heights(c, _ONE, x + E[0, 3] - c[_ON_ONE], y + E[1, 3] - c[_ON_ONE + 1], z + E[2, 3] - c[_ON_ONE + 2])
    rows[0, 0], rows[0, 1], rows[0, 2] = a * share, -b * share, (e + c[_ON_ONE + 2]) * share
    a, b, e = _heights(
        c, _FIVE, c[_ON_SIX] - c[_ON_FIVE], c[_ON_SIX + 1] - c[_ON_FIVE + 1], c[_ON_SIX + 2] - c[_ON_FIVE + 2]
    )
    rows[0, 3], rows[0, 4], rows[0, 5] = a * share, b * share, (e + c[_ON_FIVE + 2]) * share
    x, y, z = _turned(E, c[_SIX], c[_SIX + 1], c[_SIX + 2])
    a, b, e = _heights(c, _ONE, x, y, z)
    rows[1, 0], rows[1, 1], rows[1, 2] = a, -b, e
    rows[1, 3], rows[1, 4], rows[1, 5] = _heights(c, _FIVE, c[_SIX], c[_SIX + 1], c[_SIX + 2])


@leaf
def _pairs(rows, alone, pairs, work):
    """Write cosine and sine of angles 1 and 5 where one equation has angle 1 alone; how many, whether sure."""
    fifth = work[2:]
    firsts, sure = sinusoid_roots(rows[alone, 0], rows[alone, 1], rows[alone, 5] - rows[alone, 2], work)
    count, both = 0, 1 - alone
    for n in range(firsts):
        level = rows[both, 0] * work[n, 0] + rows[both, 1] * work[n, 1] + rows[both, 2] - rows[both, 5]
        fifths, settled = sinusoid_roots(rows[both, 3], rows[both, 4], level, fifth)
        sure = sure and settled
        for k in range(fifths):
            pairs[count, 0], pairs[count, 1] = work[n, 0], work[n, 1]
            pairs[count, 2], pairs[count, 3] = fifth[k, 0], fifth[k, 1]
            count += 1
    return count, sure


@leaf
def _turned(E, x, y, z):
    return (
        E[0, 0] * x + E[0, 1] * y + E[0, 2] * z,
        E[1, 0] * x + E[1, 1] * y + E[1, 2] * z,
        E[2, 0] * x + E[2, 1] * y + E[2, 2] * z,
    )


@leaf
def _rotated(c, at, cosine, sine, x, y, z):
    """Return a vector turned back about an axis by an angle."""
    k0, k1, k2 = c[at], c[at + 1], c[at + 2]
    rest = (1.0 - cosine) * (k0 * x + k1 * y + k2 * z)
    return (
        cosine * x - sine * (k1 * z - k2 * y) + rest * k0,
        cosine * y - sine * (k2 * x - k0 * z) + rest * k1,
        cosine * z - sine * (k0 * y - k1 * x) + rest * k2,
    )


@leaf
def _complete(c, E, pair, keep, values, row):
    """Write the branches with a pair of angles 1 and 5 behind others; how many there are then, and whether all."""
    c1, s1, c5, s5 = pair[0], pair[1], pair[2], pair[3]
    x, y, z = _rotated(c, _ONE, c1, -s1, 0.0, 0.0, 1.0)
    u = E[0, 0] * x + E[1, 0] * y + E[2, 0] * z
    v = E[0, 1] * x + E[1, 1] * y + E[2, 1] * z
    w = E[0, 2] * x + E[1, 2] * y + E[2, 2] * z
    x, y, z = _rotated(c, _FIVE, c5, s5, 0.0, 0.0, 1.0)
    s6 = c[_SIX] * (v * z - w * y) + c[_SIX + 1] * (w * x - u * z) + c[_SIX + 2] * (u * y - v * x)
    along = (c[_SIX] * u + c[_SIX + 1] * v + c[_SIX + 2] * w) * (c[_SIX] * x + c[_SIX + 1] * y + c[_SIX + 2] * z)
    c6 = u * x + v * y + w * z - along
    size = math.sqrt(c6 * c6 + s6 * s6)
    if size > _PARALLEL:
        return _with_links(c, E, pair, c6 / size, s6 / size, values, row, -1.0, 0.0)
    return _with_free_last(c, E, pair, keep[0 if c[_BACKWARDS] != 0.0 else 5], values, row)


@leaf
def _with_free_last(c, E, pair, keep, values, row):
    """Write the branches of `_complete` where axis 6 is parallel to the three: it takes axis 4 along a circle.

    The squared distance that the links have to reach is a sinusoid of angle 6. Where it leaves their reach on one side
    or the other, both bends are of one family; where on both, there is another family on the other side of its top.
    Where it touches an end of their reach the bends cross, and each goes on as the other; twice is as good as never.
    """
    inner, outer = c[_LINKS], c[_LINKS + 1]
    x, y, _, _ = _planar(c, E, pair, 1.0, 0.0)
    first = x * x + y * y
    x, y, _, _ = _planar(c, E, pair, -1.0, 0.0)
    last = x * x + y * y
    x, y, _, _ = _planar(c, E, pair, 0.0, 1.0)
    middle = 0.5 * (first + last)
    a, b = 0.5 * (first - last), x * x + y * y - middle
    high, low, wide = (inner + outer) ** 2, (inner - outer) ** 2, math.hypot(a, b)
    slack = TOUCH * (high + middle + wide)
    over, under = middle + wide - high, low - middle + wide
    level = a * math.cos(keep) + b * math.sin(keep) + middle
    if not low - slack <= level <= high + slack:
        keep = _end_of_reach(a, b, (high if level > high else low) - middle, keep)
    leaves_both = over > slack and under > slack
    joined = 1.0 if max(over, under) > slack or (over < -slack) != (under < -slack) else 0.0
    first_row = row
    row, sure = _with_links(c, E, pair, math.cos(keep), math.sin(keep), values, row, 5.0, joined)
    if leaves_both:
        other = 2.0 * math.atan2(b, a) - keep
        row, settled = _with_links(c, E, pair, math.cos(other), math.sin(other), values, row, 5.0, 1.0)
        sure = sure and settled
    return row, sure and row > first_row


@leaf
def _end_of_reach(a, b, level, keep):
    """Return the angle t nearest to one to keep with a·cos t + b·sin t = level; there are two."""
    top, cosine = math.atan2(b, a), level / math.hypot(a, b)
    spread = math.acos(max(-1.0, min(1.0, cosine)))
    one, other = top + spread - keep, top - spread - keep
    one -= _TURN * np.rint(one / _TURN)
    other -= _TURN * np.rint(other / _TURN)
    return keep + (one if abs(one) <= abs(other) else other)


@leaf
def _with_links(c, E, pair, c6, s6, values, row, loose, joined):
    """Write the branches with angles 1, 5 and 6 behind others; how many there are then, and whether all.

    Args:
        c: The constants.
        E: (3, 4) the motion from the zero pose.
        pair: (4,) cosine and sine of angles 1 and 5.
        c6: Cosine of angle 6,
        s6: and sine.
        values: Out.
        row: How many there are.
        loose: Which joint is free, in the order of the arm; -1: none.
        joined: 1 where both bends are of one family, 0 elsewhere.
    """
    c1, s1, c5, s5 = pair[0], pair[1], pair[2], pair[3]
    x, y, sine, cosine = _planar(c, E, pair, c6, s6)
    inner, outer = c[_LINKS], c[_LINKS + 1]
    bend = (x * x + y * y - inner * inner - outer * outer) / (2.0 * inner * outer)
    left = 1.0 - bend * bend
    if not left > -2.0 * TOUCH:
        return row, True
    if not x * x + y * y > _CENTRE * c[_SIZE] * c[_SIZE]:
        return row, False
    wide = math.sqrt(left) if left > MERGED else 0.0
    middle = math.atan2(y, x) - c[_LEAD]
    ahead, folded = math.atan2(outer * wide, inner + outer * bend), math.atan2(wide, bend)
    turn, first, fifth, last = math.atan2(sine, cosine), math.atan2(s1, c1), math.atan2(s5, c5), math.atan2(s6, c6)
    count = 2 if wide > 0.0 else 1
    for n in range(count):
        sign = 1.0 - 2.0 * n
        second, third = middle - sign * ahead, sign * folded - c[_BEND]
        fourth = turn - second - third
        place = values[row + n, :6]
        if c[_BACKWARDS] != 0.0:
            place = place[::-1]
        place[0], place[1], place[2] = first, second, c[_SIGNS] * third
        place[3], place[4], place[5] = c[_SIGNS + 1] * fourth, fifth, last
        values[row + n, 6] = -1.0 if loose < 0.0 else (5.0 - loose if c[_BACKWARDS] != 0.0 else loose)
        values[row + n, 7] = row if joined > 0.0 else -1.0
    return row + count, True


@leaf
def _planar(c, E, pair, c6, s6):
    """Return where the parallel axes bring axis 4, and sine and cosine of the angle by which they turn."""
    c1, s1, c5, s5 = pair[0], pair[1], pair[2], pair[3]
    x, y, z = _rotated(
        c, _FIVE, c5, s5, c[_TIP] - c[_ON_FIVE], c[_TIP + 1] - c[_ON_FIVE + 1], c[_TIP + 2] - c[_ON_FIVE + 2]
    )
    x, y, z = x + c[_ON_FIVE] - c[_ON_SIX], y + c[_ON_FIVE + 1] - c[_ON_SIX + 1], z + c[_ON_FIVE + 2] - c[_ON_SIX + 2]
    x, y, z = _rotated(c, _SIX, c6, s6, x, y, z)
    x, y, z = _turned(E, x + c[_ON_SIX], y + c[_ON_SIX + 1], z + c[_ON_SIX + 2])
    x, y, z = x + E[0, 3] - c[_ON_ONE], y + E[1, 3] - c[_ON_ONE + 1], z + E[2, 3] - c[_ON_ONE + 2]
    x, y, z = _rotated(c, _ONE, c1, s1, x, y, z)
    u, v, w = _rotated(c, _FIVE, c5, s5, 1.0, 0.0, 0.0)
    u, v, w = _rotated(c, _SIX, c6, s6, u, v, w)
    u, v, w = _turned(E, u, v, w)
    u, v, w = _rotated(c, _ONE, c1, s1, u, v, w)
    return x + c[_ON_ONE], y + c[_ON_ONE + 1], v, u
