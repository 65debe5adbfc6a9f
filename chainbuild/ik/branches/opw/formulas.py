"""The eight branches of an ortho-parallel arm, as formulas that take numbers or arrays alike.

The closed form is that of Brandstötter, Angerer, Hofbaur 2014 over the parameters that `opw_arm` measures on a chain.
Every branch is confirmed by forward kinematics from the very axis values that are returned. `batch` calls the formulas
with arrays of poses; `compiled_opw` compiles them for one pose at a time, with an arctangent and sines of its own.

Slot 4·flip + 2·shoulder + elbow: flip 0 has θ5 ≥ 0, shoulder 0 the arm in front of axis 1, elbow 0 and 1 its two bends.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from chainbuild.ik.branches.core.subproblems import ON_AXIS, TOUCH
from chainbuild.ik.branches.vectors.axes import AXIS_ROWS
from chainbuild.ik.branches.vectors.operands import (
    Operand,
    affine,
    arctan2,
    inside,
    product,
    root,
    rows_of_axes,
    sine_cosine,
    six,
    where,
)

# Two branches whose angles differ by less than twice this are one [rad].
SAME: Final = 5e-6

# The rows of the array of constants (n, 6), by name.
CONSTANTS: Final = (
    "base",  # twelve numbers: inverse of the arm's base in the workpiece frame
    "flange",  # twelve numbers: inverse of the tool on the sixth axis
    "lengths",  # a1, b, c1, c2, forearm, its square [m]
    "bend",  # angle of the forearm's line from its c3, its cosine, its sine; a2, c3
    "keep",  # cosine and sine of θ1 and θ4 at the start: values of an angle without effect
    "tip",  # tool on the sixth axis [m], squared tolerances [m², rad²]
    *AXIS_ROWS,
)


def constant_rows(constants: Operand) -> Operand:
    """Return constants (n, 6) as tuples: separate variables are read once, not at every pose."""
    own = (
        six(constants, 0) + six(constants, 1),
        six(constants, 2) + six(constants, 3),
        (six(constants, 4), six(constants, 5), six(constants, 6), six(constants, 7)),
    )
    return own + rows_of_axes(constants, 8)


def all_branches(T: Operand, rows: Operand) -> Operand:
    """Return the axis values of eight branches, six each; NaN where there is none; see `finished`."""
    M, a, b, c, d = upper_branches(T, rows)
    return (
        finished(a, a[6], M, rows), finished(b, b[6], M, rows), finished(c, c[6], M, rows), finished(d, d[6], M, rows),
        finished(flipped(a), a[6], M, rows), finished(flipped(b), b[6], M, rows),
        finished(flipped(c), c[6], M, rows), finished(flipped(d), d[6], M, rows),
    )  # fmt: skip


def upper_branches(T: Operand, rows: Operand) -> Operand:
    """Return the sixth axis in the arm's base, then four branches: six angles, and whether the wrist is straight."""
    base, flange, arm, _, _, _ = rows
    M = product(product(base, T), flange)
    c1, s1, reach, c1_behind, s1_behind, reach_behind = shoulders(M, arm)
    front = elbows(reach, M[11] - arm[0][2], arm)
    behind = elbows(reach_behind, M[11] - arm[0][2], arm)
    a, b = both_elbows(M, c1, s1, front, arm)
    c, d = both_elbows(M, c1_behind, s1_behind, behind, arm)
    return M, a, b, c, d


def shoulders(M: Operand, arm: Operand) -> Operand:
    """Return cosine and sine of θ1 and the reach from axis 2 on, in front of axis 1 and behind it.

    The wrist centre is at `out` along the arm and b beside it. On axis 1 θ1 has no effect, and the arm behind it
    is the same as the arm in front.
    """
    a1, b = arm[0][0], arm[0][1]
    x, y = M[3], M[7]
    around = x * x + y * y
    squared = around - b * b
    out = root(where(squared > -TOUCH, np.maximum(squared, 0.0), np.nan))
    free = around < ON_AXIS * ON_AXIS
    share = 1.0 / where(free, 1.0, around)
    c1 = where(free, arm[2][0], (x * out + y * b) * share)
    s1 = where(free, arm[2][1], (y * out - x * b) * share)
    one = free | (squared <= SAME * SAME * around)
    behind = where(one, np.nan, -out - a1)
    return c1, s1, out - a1, (y * b - x * out) * share, -(y * out + x * b) * share, behind


def elbows(reach: Operand, z: Operand, arm: Operand) -> Operand:
    """Return the triangle of upper arm and forearm.

    Returns: cosine and sine of the line to the wrist from the vertical, cosine and sine of the upper arm from that line
        and of the forearm from the upper arm, the latter's angle, and whether both elbows are one.
    """
    upper, forearm, square = arm[0][3], arm[0][4], arm[0][5]
    squared = reach * reach + z * z
    nearness = 1.0 / root(squared)
    cos_lift = in_range((squared + (upper * upper - square)) * nearness * (0.5 / upper))
    cos_elbow = in_range((squared - (upper * upper + square)) * (0.5 / (upper * forearm)))
    sin_lift = root((1.0 - cos_lift) * (1.0 + cos_lift))
    sin_elbow = root((1.0 - cos_elbow) * (1.0 + cos_elbow))
    one = (sin_lift < SAME) & (sin_elbow < SAME)
    bend = arctan2(sin_elbow, cos_elbow)
    return z * nearness, reach * nearness, cos_lift, sin_lift, cos_elbow, sin_elbow, bend, one


def in_range(cosine: Operand) -> Operand:
    """Return a cosine, clipped to its range within rounding; NaN beyond."""
    inside = np.minimum(np.maximum(cosine, -1.0), 1.0)
    return where(np.abs(cosine) < 1.0 + TOUCH, inside, np.nan)


def both_elbows(M: Operand, c1: Operand, s1: Operand, triangle: Operand, arm: Operand) -> Operand:
    """Return the six angles of both elbows, each with whether its wrist is straight."""
    cos_line, sin_line, cos_lift, sin_lift, cos_elbow, sin_elbow, bend, one = triangle
    bent, cos_bend, sin_bend = arm[1][0], arm[1][1], arm[1][2]
    first = arctan2(s1, c1)
    s2, c2 = sin_line * cos_lift - cos_line * sin_lift, cos_line * cos_lift + sin_line * sin_lift
    s3, c3 = sin_elbow * cos_bend - cos_elbow * sin_bend, cos_elbow * cos_bend + sin_elbow * sin_bend
    up = wrist_angles(M, c1, s1, s2 * c3 + c2 * s3, c2 * c3 - s2 * s3, arm)
    a = (first, arctan2(s2, c2), bend - bent) + up  # noqa: RUF005 - numba adds tuples, it does not unpack them
    s2, c2 = sin_line * cos_lift + cos_line * sin_lift, cos_line * cos_lift - sin_line * sin_lift
    s3, c3 = -sin_elbow * cos_bend - cos_elbow * sin_bend, cos_elbow * cos_bend - sin_elbow * sin_bend
    down = wrist_angles(M, c1, s1, s2 * c3 + c2 * s3, c2 * c3 - s2 * s3, arm)
    b = (first, where(one, np.nan, arctan2(s2, c2)), -bend - bent) + down  # noqa: RUF005
    return a, b


def wrist_angles(M: Operand, c1: Operand, s1: Operand, s23: Operand, c23: Operand, arm: Operand) -> Operand:
    """Return θ4, θ5, θ6 and whether θ5 is a multiple of π, where θ4 has no effect of its own."""
    ahead_0, ahead_1, ahead_2 = M[0] * c1 + M[4] * s1, M[1] * c1 + M[5] * s1, M[2] * c1 + M[6] * s1
    side_0, side_1, side_2 = M[4] * c1 - M[0] * s1, M[5] * c1 - M[1] * s1, M[6] * c1 - M[2] * s1
    up_0, up_1, up_2 = ahead_0 * c23 - M[8] * s23, ahead_1 * c23 - M[9] * s23, ahead_2 * c23 - M[10] * s23
    radius = root(up_2 * up_2 + side_2 * side_2)
    straight = radius < ON_AXIS
    share = 1.0 / where(straight, 1.0, radius)
    c4, s4 = where(straight, arm[2][2], up_2 * share), where(straight, arm[2][3], side_2 * share)
    # θ6 from θ4, not from the third row: that row vanishes where the wrist is straight.
    sixth = arctan2(c4 * side_0 - s4 * up_0, c4 * side_1 - s4 * up_1)
    return arctan2(s4, c4), arctan2(radius, ahead_2 * s23 + M[10] * c23), sixth, straight


def flipped(branch: Operand) -> Operand:
    """Return the other wrist of a branch; a straight wrist has none."""
    first, second, third, fourth, fifth, sixth, straight = branch
    return first, second, third, fourth + math.pi, where(straight, np.nan, -fifth), sixth + math.pi, straight


def finished(branch: Operand, straight: Operand, M: Operand, rows: Operand) -> Operand:
    """Return the axis values of a branch if it is inside the limits and meets the pose, else NaN.

    Infinity where the branch is outside, but its wrist straight: another θ4 may bring it inside.
    """
    _, _, arm, forward, backward, limits = rows
    x = affine(branch, forward)
    x0, in_0 = inside(x[0], limits, 0)
    x1, in_1 = inside(x[1], limits, 1)
    x2, in_2 = inside(x[2], limits, 2)
    x3, in_3 = inside(x[3], limits, 3)
    x4, in_4 = inside(x[4], limits, 4)
    x5, in_5 = inside(x[5], limits, 5)
    within = in_0 & in_1 & in_2 & in_3 & in_4 & in_5
    good = within & confirmed((x0, x1, x2, x3, x4, x5), M, arm, backward)
    # A branch that does not exist is no number in every axis.
    none = where(straight, where(within, np.nan, (np.abs(x[0]) + 1.0) * np.inf), np.nan)
    return (
        where(good, x0, none), where(good, x1, none), where(good, x2, none),
        where(good, x3, none), where(good, x4, none), where(good, x5, none),
    )  # fmt: skip


def confirmed(x: Operand, M: Operand, arm: Operand, backward: Operand) -> Operand:
    """Return whether axis values lead to a pose, by forward kinematics seen from the forearm."""
    theta = affine(x, backward)
    s1, c1 = sine_cosine(theta[0])
    s2, c2 = sine_cosine(theta[1])
    s23, c23 = sine_cosine(theta[1] + theta[2])
    s4, c4 = sine_cosine(theta[3])
    s5, c5 = sine_cosine(theta[4])
    s6, c6 = sine_cosine(theta[5])
    a1, b, base, upper, a2, c3 = arm[0][0], arm[0][1], arm[0][2], arm[0][3], arm[1][3], arm[1][4]
    ahead_0, ahead_1, ahead_2 = M[0] * c1 + M[4] * s1, M[1] * c1 + M[5] * s1, M[2] * c1 + M[6] * s1
    # What the rotation misses, row by row in the frame of the forearm,
    u0 = c4 * c5 * c6 - s4 * s6 - (ahead_0 * c23 - M[8] * s23)
    u1 = -c4 * c5 * s6 - s4 * c6 - (ahead_1 * c23 - M[9] * s23)
    u2 = c4 * s5 - (ahead_2 * c23 - M[10] * s23)
    v0 = s4 * c5 * c6 + c4 * s6 - (M[4] * c1 - M[0] * s1)
    v1 = -s4 * c5 * s6 + c4 * c6 - (M[5] * c1 - M[1] * s1)
    v2 = s4 * s5 - (M[6] * c1 - M[2] * s1)
    w0 = -s5 * c6 - (ahead_0 * s23 + M[8] * c23)
    w1 = s5 * s6 - (ahead_1 * s23 + M[9] * c23)
    w2 = c5 - (ahead_2 * s23 + M[10] * c23)
    # and the wrist centre, then the tip.
    out, up = upper * s2 + a1 - (M[3] * c1 + M[7] * s1), upper * c2 + base - M[11]
    tip = arm[3]
    x_tip = u0 * tip[0] + u1 * tip[1] + u2 * tip[2] + out * c23 - up * s23 + a2
    y_tip = v0 * tip[0] + v1 * tip[1] + v2 * tip[2] + b - (M[7] * c1 - M[3] * s1)
    z_tip = w0 * tip[0] + w1 * tip[1] + w2 * tip[2] + out * s23 + up * c23 + c3
    distance = x_tip * x_tip + y_tip * y_tip + z_tip * z_tip
    # A rotation by a small angle differs from 1 by √2 times that angle.
    angle = (u0 * u0 + u1 * u1 + u2 * u2 + v0 * v0 + v1 * v1 + v2 * v2 + w0 * w0 + w1 * w1 + w2 * w2) * 0.5
    return (distance <= tip[3]) & (angle <= tip[4])
