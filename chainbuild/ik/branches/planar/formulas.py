"""The eight branches of an arm with three parallel axes, as formulas that take numbers or arrays alike.

The equations of `arms.three_parallel` for arms whose axes 5 and 6 meet or are parallel, so that one equation has angle
1 alone. Every axis turns about the z axis of its own frame, and of each frame the x axis is chosen such that nothing
but a turn about it and a shift lead to the next; X1 shifts across axis 1, X5 along its x axis:

    M = Z(q1)·X1·Z(q2)·(a2, 0, 0)·Z(q3)·(a3, 0, 0)·Z(q4)·X4·Z(q5)·X5·Z(q6)

Each branch is confirmed from the very axis values that are returned. Where two branches nearly meet, an axis nearly has
no effect, or a value is as near to its limit as rounding, the pose is in doubt: infinity instead of its branches.

Slot 4·first + 2·fifth + bend: the two values of angle 1, of angle 5 with each, and the bends of the links.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.ik.branches.vectors.axes import AXIS_ROWS
from chainbuild.ik.branches.vectors.operands import (
    Operand,
    affine,
    arctan2,
    by_turns,
    product,
    root,
    rows_of_axes,
    sine_cosine,
    six,
    where,
)

CLEAR: Final = 1e-6  # squared sine: angles farther apart keep their digits, and no other branch is near
EFFECT: Final = 1e-8  # squared share of the size of an arm or a direction: with less, angle 1 loses digits

# The rows of the array of constants (n, 6), by name.
PLANAR_ROWS: Final = (
    "before",  # twelve numbers: inverse of the frame of axis 1 in the workpiece frame
    "after",  # twelve numbers: the frame of axis 6 in that of the tool
    "first",  # X1: cosine and sine of its turn, its shift [m]
    "fourth",  # X4
    "fifth",  # X5
    "links",  # a2, a3, the sum of their squares, half the inverse of their product, the square that angle 1 needs
    "alone",  # 1: the equation of the point has angle 1 alone, 0: that of the direction; numbers of both equations
    "kept",  # squared tolerances of branches [m², rad²], 1: an arm seen from the tool, tolerance of rotations
    *AXIS_ROWS,
)


def arm_rows(constants: Operand) -> Operand:
    """Return constants (n, 6) as tuples: separate variables are read once, not at every pose."""
    own = (
        six(constants, 0) + six(constants, 1),
        six(constants, 2) + six(constants, 3),
        (
            six(constants, 4), six(constants, 5), six(constants, 6), six(constants, 7), six(constants, 8),
            six(constants, 9),
        ),
    )  # fmt: skip
    return own + rows_of_axes(constants, 10)


def every_branch_of(T: Operand, rows: Operand) -> Operand:
    """Return the axis values of eight branches, six each; NaN where there is none, see `completed`."""
    arm = rows[2]
    T, off = nearest_rotation(T)
    M = seen_from_axes(T, rows)
    c1, s1, c1_too, s1_too, doubt = first_angles(M, arm)
    doubt = doubt | (off >= arm[5][3])
    a = fifth_angles(M, c1, s1, doubt, arm)
    b = fifth_angles(M, c1_too, s1_too, doubt, arm)
    p, q = links(M, c1, s1, a[0], a[1], a[4], arm)
    r, s = links(M, c1, s1, a[2], a[3], a[4], arm)
    t, u = links(M, c1_too, s1_too, b[0], b[1], b[4], arm)
    v, w = links(M, c1_too, s1_too, b[2], b[3], b[4], arm)
    return (
        completed(p, M, rows), completed(q, M, rows), completed(r, M, rows), completed(s, M, rows),
        completed(t, M, rows), completed(u, M, rows), completed(v, M, rows), completed(w, M, rows),
    )  # fmt: skip


def nearest_rotation(T: Operand) -> Operand:
    """Return a pose whose rotation has lost digits, as in 32 bits, with the nearest one, and by how much it was off."""
    a, b, c = (
        T[0] * T[0] + T[4] * T[4] + T[8] * T[8], T[1] * T[1] + T[5] * T[5] + T[9] * T[9],
        T[2] * T[2] + T[6] * T[6] + T[10] * T[10],
    )  # fmt: skip
    d, e, f = (
        T[0] * T[1] + T[4] * T[5] + T[8] * T[9], T[0] * T[2] + T[4] * T[6] + T[8] * T[10],
        T[1] * T[2] + T[5] * T[6] + T[9] * T[10],
    )  # fmt: skip
    # One of Newton's steps towards it, R·(3 - RᵀR)/2, which squares what it is off by.
    u, v, w = 1.5 - 0.5 * a, 1.5 - 0.5 * b, 1.5 - 0.5 * c
    x, y, z = -0.5 * d, -0.5 * e, -0.5 * f
    off = np.maximum(np.maximum(np.abs(a - 1.0), np.abs(b - 1.0)), np.abs(c - 1.0))
    off = np.maximum(np.maximum(np.maximum(off, np.abs(d)), np.abs(e)), np.abs(f))
    return (
        T[0] * u + T[1] * x + T[2] * y, T[0] * x + T[1] * v + T[2] * z, T[0] * y + T[1] * z + T[2] * w, T[3],
        T[4] * u + T[5] * x + T[6] * y, T[4] * x + T[5] * v + T[6] * z, T[4] * y + T[5] * z + T[6] * w, T[7],
        T[8] * u + T[9] * x + T[10] * y, T[8] * x + T[9] * v + T[10] * z, T[8] * y + T[9] * z + T[10] * w, T[11],
    ), off  # fmt: skip


def seen_from_axes(T: Operand, rows: Operand) -> Operand:
    """Return the frame of the last axis in that of the first one; of an arm seen from the tool with T turned over."""
    back = rows[2][5][2]
    on = 1.0 - back
    return product(product(rows[0], (
        on * T[0] + back * T[0], on * T[1] + back * T[4], on * T[2] + back * T[8],
        on * T[3] - back * (T[0] * T[3] + T[4] * T[7] + T[8] * T[11]),
        on * T[4] + back * T[1], on * T[5] + back * T[5], on * T[6] + back * T[9],
        on * T[7] - back * (T[1] * T[3] + T[5] * T[7] + T[9] * T[11]),
        on * T[8] + back * T[2], on * T[9] + back * T[6], on * T[10] + back * T[10],
        on * T[11] - back * (T[2] * T[3] + T[6] * T[7] + T[10] * T[11]),
    )), rows[1])  # fmt: skip


def first_angles(M: Operand, arm: Operand) -> Operand:
    """Return cosine and sine of both angles 1, and whether there is doubt."""
    first, alone = arm[0], arm[4]
    x, y, z = chosen(M, alone[0])
    a, b, level = -first[1] * y, first[1] * x, alone[1] - first[0] * z
    square = a * a + b * b
    share = 1.0 / square
    left = square - level * level
    wide = root(where(left > 0.0, left, np.nan))
    doubt = (np.abs(left) <= CLEAR * square) | (square <= arm[3][4])
    return (
        (a * level - b * wide) * share, (b * level + a * wide) * share,
        (a * level + b * wide) * share, (b * level - a * wide) * share, doubt,
    )  # fmt: skip


def chosen(M: Operand, pick: Operand) -> Operand:
    """Return the point of axis 6 where pick is 1, its direction where it is 0."""
    rest = 1.0 - pick
    return pick * M[3] + rest * M[2], pick * M[7] + rest * M[6], pick * M[11] + rest * M[10]


def fifth_angles(M: Operand, c1: Operand, s1: Operand, doubt: Operand, arm: Operand) -> Operand:
    """Return cosine and sine of both angles 5 with an angle 1, and whether there is doubt."""
    first, alone = arm[0], arm[4]
    x, y, z = chosen(M, 1.0 - alone[0])
    cosine = (first[1] * (x * s1 - y * c1) + first[0] * z - alone[2]) * alone[5]
    left = 1.0 - cosine * cosine
    wide = root(where(left > 0.0, left, np.nan))
    u, v = alone[3], alone[4]
    return (
        u * cosine - v * wide, v * cosine + u * wide, u * cosine + v * wide, v * cosine - u * wide,
        doubt | (np.abs(left) <= CLEAR),
    )  # fmt: skip


def links(M: Operand, c1: Operand, s1: Operand, c5: Operand, s5: Operand, doubt: Operand, arm: Operand) -> Operand:
    """Return both branches with angles 1 and 5: six angles, and whether there is doubt."""
    first, fourth, fifth, sizes = arm[0], arm[1], arm[2], arm[3]
    # What angle 6 does to the height along the parallel axes.
    u, v = fourth[1] * s5, fourth[1] * c5 * fifth[0] + fourth[0] * fifth[1]
    square = u * u + v * v
    share = 1.0 / square  # where it is 0, so is the sine of angle 5
    high_0 = first[1] * (M[0] * s1 - M[4] * c1) + first[0] * M[8]
    high_1 = first[1] * (M[1] * s1 - M[5] * c1) + first[0] * M[9]
    c6, s6 = (high_0 * u + high_1 * v) * share, (high_0 * v - high_1 * u) * share
    # The point of axis 4, then the direction of its x axis, seen from axis 6,
    x, y, z = turned_back(c5, s5, -fourth[2], -fourth[0] * fourth[3] - fourth[1] * fourth[4],
                     fourth[1] * fourth[3] - fourth[0] * fourth[4])  # fmt: skip
    x, y, z = turned_back(c6, s6, x - fifth[2], fifth[0] * y + fifth[1] * z, fifth[0] * z - fifth[1] * y)
    u, v, w = turned_back(c6, s6, c5, -s5 * fifth[0], s5 * fifth[1])
    # and from axis 2.
    x, y, z = turned_back(
        c1, s1, M[0] * x + M[1] * y + M[2] * z + M[3], M[4] * x + M[5] * y + M[6] * z + M[7],
        M[8] * x + M[9] * y + M[10] * z + M[11],
    )  # fmt: skip
    x, y = x - first[2], first[0] * (y - first[3]) + first[1] * z
    cosine, v, w = turned_back(
        c1, s1, M[0] * u + M[1] * v + M[2] * w, M[4] * u + M[5] * v + M[6] * w, M[8] * u + M[9] * v + M[10] * w
    )
    turn = arctan2(first[0] * v + first[1] * w, cosine)
    bend = (x * x + y * y - sizes[2]) * sizes[3]
    left = 1.0 - bend * bend
    wide = root(where(left > 0.0, left, np.nan))
    unclear = doubt | (np.abs(left) <= CLEAR)
    middle, ahead, third = arctan2(y, x), arctan2(sizes[1] * wide, sizes[0] + sizes[1] * bend), arctan2(wide, bend)
    one, five, six_ = arctan2(s1, c1), arctan2(s5, c5), arctan2(s6, c6)
    return (
        (one, middle - ahead, third, turn - middle + ahead - third, five, six_, unclear),
        (one, middle + ahead, -third, turn - middle - ahead + third, five, six_, unclear),
    )


def turned_back(c: Operand, s: Operand, x: Operand, y: Operand, z: Operand) -> Operand:
    """Return a vector turned back about the z axis."""
    return c * x + s * y, c * y - s * x, z


def completed(branch: Operand, M: Operand, rows: Operand) -> Operand:
    """Return the axis values of a branch inside the limits; NaN where there is none, infinity where there is doubt."""
    limits = rows[5]
    x = affine(branch, rows[3])
    x0, in_0, near_0 = among_limits(x[0], limits, 0)
    x1, in_1, near_1 = among_limits(x[1], limits, 1)
    x2, in_2, near_2 = among_limits(x[2], limits, 2)
    x3, in_3, near_3 = among_limits(x[3], limits, 3)
    x4, in_4, near_4 = among_limits(x[4], limits, 4)
    x5, in_5, near_5 = among_limits(x[5], limits, 5)
    within = in_0 & in_1 & in_2 & in_3 & in_4 & in_5
    near = near_0 & near_1 & near_2 & near_3 & near_4 & near_5
    met = is_confirmed((x0, x1, x2, x3, x4, x5), M, rows[2], rows[4])
    exists = np.abs(branch[2]) < np.inf
    # Digits may be lost, or rounding may decide about a limit.
    none = where(branch[6] | (exists & ~met) | (near & ~within), np.inf, np.nan)
    good = within & met & ~branch[6]
    return (
        where(good, x0, none), where(good, x1, none), where(good, x2, none),
        where(good, x3, none), where(good, x4, none), where(good, x5, none),
    )  # fmt: skip


def among_limits(x: Operand, limits: Operand, n: int) -> Operand:
    """Return an axis value by whole turns near to the start, and whether its limits hold it for certain, perhaps."""
    _, _, _, lower, upper, slack = limits
    moved, low, high = by_turns(x, limits, n)
    inside = (moved >= lower[n] + slack[n]) & (moved <= upper[n] - slack[n])
    return moved, inside, (moved >= low) & (moved <= high)


def is_confirmed(x: Operand, M: Operand, arm: Operand, backward: Operand) -> Operand:
    """Return whether axis values lead to a pose, by forward kinematics seen from axis 2."""
    first, fourth, fifth, sizes, kept = arm[0], arm[1], arm[2], arm[3], arm[5]
    q = affine(x, backward)
    s1, c1 = sine_cosine(q[0])
    s2, c2 = sine_cosine(q[1])
    s23, c23 = sine_cosine(q[1] + q[2])
    s, c = sine_cosine(q[1] + q[2] + q[3])
    s5, c5 = sine_cosine(q[4])
    s6, c6 = sine_cosine(q[5])
    # The frame of axis 6 seen from X4, before the parallel axes turn it,
    a, b = c5 * fifth[0], s5 * fifth[0]
    u0, u1, u2 = c5 * c6 - b * s6, -c5 * s6 - b * c6, s5 * fifth[1]
    v0, v1, v2 = s5 * c6 + a * s6, a * c6 - s5 * s6, -c5 * fifth[1]
    w0, w1, w2 = fifth[1] * s6, fifth[1] * c6, fifth[0]
    v0, w0 = fourth[0] * v0 - fourth[1] * w0, fourth[1] * v0 + fourth[0] * w0
    v1, w1 = fourth[0] * v1 - fourth[1] * w1, fourth[1] * v1 + fourth[0] * w1
    v2, w2 = fourth[0] * v2 - fourth[1] * w2, fourth[1] * v2 + fourth[0] * w2
    along = s5 * fifth[2]
    px, py, pz = c5 * fifth[2] + fourth[2], fourth[0] * along + fourth[3], fourth[1] * along + fourth[4]
    # and what it misses of the one that is wanted, seen from axis 2 before it turns.
    x0, y0, z0 = missed(turned_back(c, -s, u0, v0, w0), turned_back(c1, s1, M[0], M[4], M[8]), first)
    x1, y1, z1 = missed(turned_back(c, -s, u1, v1, w1), turned_back(c1, s1, M[1], M[5], M[9]), first)
    x2, y2, z2 = missed(turned_back(c, -s, u2, v2, w2), turned_back(c1, s1, M[2], M[6], M[10]), first)
    x, y, z = turned_back(c, -s, px, py, pz)
    u, v, w = turned_back(c1, s1, M[3], M[7], M[11])
    x, y, z = missed(
        (x + sizes[0] * c2 + sizes[1] * c23, y + sizes[0] * s2 + sizes[1] * s23, z),
        (u - first[2], v - first[3], w), first,
    )  # fmt: skip
    distance = x * x + y * y + z * z
    # A rotation by a small angle differs from 1 by √2 times that angle.
    angle = (x0 * x0 + y0 * y0 + z0 * z0 + x1 * x1 + y1 * y1 + z1 * z1 + x2 * x2 + y2 * y2 + z2 * z2) * 0.5
    return (distance <= kept[0]) & (angle <= kept[1])


def missed(vector: Operand, wanted: Operand, first: Operand) -> Operand:
    """Return by how much a vector seen from axis 2 differs from one seen from axis 1."""
    return (
        vector[0] - wanted[0], vector[1] - (first[0] * wanted[1] + first[1] * wanted[2]),
        vector[2] - (first[0] * wanted[2] - first[1] * wanted[1]),
    )  # fmt: skip
