"""Arms with a spherical wrist, compiled: three rotary axes place its centre, three turn about it."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from chainbuild.ik.branches.compiled.angle_pairs import VANISHED, wave_roots
from chainbuild.ik.branches.compiled.constants import MEETING_AXES, SKEW_AXES, SPHERICAL
from chainbuild.ik.branches.compiled.small import (
    BARELY,
    across,
    dot,
    length,
    minus,
    one_turn,
    plus,
    to_distance,
    to_height_kept,
    turned,
    turned_about,
    two_turns,
    two_turns_kept,
    vector,
)
from chainbuild.ik.branches.core.subproblems import TOUCH
from chainbuild.ik.search.compiled.kernels import jit, leaf

_FIFTH: Final = 0.4 * math.pi  # of a turn

_KIND, _BACKWARDS, _FROM_TOOL, _ROW, _ARM, _WRIST, _CENTRE, _BACK, _ASIDE, _MEETING = SPHERICAL


@jit
def motion_of(constants, at, T, from_tool):
    """Return R and t of T·M⁻¹, or of T⁻¹·M⁻¹; M⁻¹ stands in the constants, three rows of four."""
    R, t = np.empty((3, 3)), np.empty(3)
    for r in range(3):
        if from_tool:
            a = T[0, r], T[1, r], T[2, r]
            shift = -(a[0] * T[0, 3] + a[1] * T[1, 3] + a[2] * T[2, 3])
        else:
            a = T[r, 0], T[r, 1], T[r, 2]
            shift = T[r, 3]
        for c in range(3):
            R[r, c] = a[0] * constants[at + c] + a[1] * constants[at + 4 + c] + a[2] * constants[at + 8 + c]
        t[r] = a[0] * constants[at + 3] + a[1] * constants[at + 7] + a[2] * constants[at + 11] + shift
    return R, t


@leaf
def product(R, v):
    """Return R·v."""
    return (
        R[0, 0] * v[0] + R[0, 1] * v[1] + R[0, 2] * v[2],
        R[1, 0] * v[0] + R[1, 1] * v[1] + R[1, 2] * v[2],
        R[2, 0] * v[0] + R[2, 1] * v[1] + R[2, 2] * v[2],
    )


@leaf
def _after_parallel(constants, p, d, arms, keep):
    """Write the values of a turn before two parallel turns that bring p to d; see `arms.positioner`.

    Returns:
        How many, whether the first turn is free and has the value to keep, and whether they are sure.
    """
    a, point_a = vector(constants, _ROW), vector(constants, _ROW + 3)
    b, point_b = vector(constants, _ROW + 6), vector(constants, _ROW + 9)
    c, point_c = vector(constants, _ROW + 12), vector(constants, _ROW + 15)
    back = -a[0], -a[1], -a[2]
    count, one, other, free, sure = to_height_kept(back, minus(d, point_a), b, dot(b, minus(p, point_a)), keep)
    flat_p = plus(p, -dot(b, minus(p, point_b)), b)
    pivot = plus(point_c, -dot(b, minus(point_c, point_b)), b)
    arm = minus(flat_p, pivot)
    found = 0
    for n in range(count):
        first = one if n == 0 else other
        place = turned_about(a, point_a, -first, d)
        goal = minus(plus(place, -dot(b, minus(place, point_b)), b), point_b)
        elbows, up, down, sure_elbow = to_distance(c, arm, minus(point_b, pivot), length(goal))
        sure &= sure_elbow
        for m in range(elbows):
            third = up if m == 0 else down
            second, sure_turn = one_turn(b, minus(plus(pivot, 1.0, turned(c, third, arm)), point_b), goal)
            sure &= sure_turn
            arms[found, 0], arms[found, 1], arms[found, 2] = first, second, third
            found += 1
    return found, free, sure


@leaf
def _stays_bent(wrist, forearm, first, image):
    """Tell whether both bends of a wrist stay apart, and stay bends, all around a free first turn.

    Args:
        wrist: Its three axes where all joints are 0.
        forearm: The first of them as the second and third joint turn it.
        first: The axis of the first joint.
        image: The last of them as the pose has it.
    """
    w1, w2, w3 = wrist
    middle = dot(forearm, first) * dot(image, first)
    swing = length(across(forearm, first)) * length(across(image, first))
    both, apart = dot(w1, w2) * dot(w2, w3), length(across(w1, w2)) * length(across(w2, w3))
    return both - apart + TOUCH < middle - swing and middle + swing < both + apart - TOUCH


@leaf
def _after_meeting(constants, p, d, arms):
    """Write the values of two turns whose axes meet before a third that bring p to d."""
    a, b = vector(constants, _ROW), vector(constants, _ROW + 6)
    c, point_c, centre = vector(constants, _ROW + 12), vector(constants, _ROW + 15), vector(constants, _MEETING)
    goal, arm = minus(d, centre), minus(p, point_c)
    count, one, other, sure = to_distance(c, arm, minus(centre, point_c), length(goal))
    found = 0
    for n in range(count):
        third = one if n == 0 else other
        moved = minus(plus(point_c, 1.0, turned(c, third, arm)), centre)
        pairs, first, second, first_too, second_too, sure_pair = two_turns(a, b, moved, goal)
        sure &= sure_pair
        for _ in range(pairs):
            arms[found, 0], arms[found, 1], arms[found, 2] = first, second, third
            first, second = first_too, second_too
            found += 1
    return found, sure


@leaf
def _missed_length(constants, goal, u):
    """Return by how much what axis b turns would change its length, and where it takes u; see `skew_turns`."""
    a, b = vector(constants, _ROW), vector(constants, _ROW + 6)
    between = minus(vector(constants, _ROW + 9), vector(constants, _ROW + 3))
    along = dot(u, b)
    height = dot(a, minus(goal, between)) - along * dot(a, b)
    square = 0.5 * (dot(goal, goal) - dot(between, between) - dot(u, u)) - along * dot(b, between)
    v = (
        constants[_MEETING] * height + constants[_MEETING + 1] * square,
        constants[_MEETING + 3] * height + constants[_MEETING + 4] * square,
        constants[_MEETING + 6] * height + constants[_MEETING + 7] * square,
    )
    return dot(v, v) - dot(u, u) + along * along, v


@jit
def _after_skew(constants, p, d, arms):
    """Write the values of two turns about skew axes before a third that bring p to d: a quartic for the third."""
    a, point_a = vector(constants, _ROW), vector(constants, _ROW + 3)
    b, point_b = vector(constants, _ROW + 6), vector(constants, _ROW + 9)
    c, point_c = vector(constants, _ROW + 12), vector(constants, _ROW + 15)
    goal, arm = minus(d, point_a), minus(p, point_c)
    if not dot(arm, arm) - dot(c, arm) ** 2 > BARELY * BARELY * dot(arm, arm):
        return 0, False
    roots = np.empty((4, 2))
    m, a1, b1, a2, b2, size = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for n in range(5):
        moved = plus(point_c, 1.0, turned(c, n * _FIFTH, arm))
        sample, _ = _missed_length(constants, goal, minus(moved, point_b))
        m, size = m + 0.2 * sample, size + abs(sample)
        a1, b1 = a1 + 0.4 * sample * math.cos(n * _FIFTH), b1 + 0.4 * sample * math.sin(n * _FIFTH)
        a2, b2 = a2 + 0.4 * sample * math.cos(2.0 * n * _FIFTH), b2 + 0.4 * sample * math.sin(2.0 * n * _FIFTH)
    count, sure = wave_roots(m, a1, b1, a2, b2, VANISHED * size, roots)
    for n in range(count):
        angle = math.atan2(roots[n, 1], roots[n, 0])
        moved = plus(point_c, 1.0, turned(c, angle, arm))
        u = minus(moved, point_b)
        _, place = _missed_length(constants, goal, u)
        second, sure_second = one_turn(b, u, place)
        first, sure_first = one_turn(a, minus(turned_about(b, point_b, second, moved), point_a), goal)
        sure &= sure_first and sure_second
        arms[n, 0], arms[n, 1], arms[n, 2] = first, second, angle
    return count, sure


@jit
def spherical_branches(constants, T, keep, values):
    """Write the joint values of a pose, and which is free; return how many rows, and whether none can be missing."""
    from_tool, backwards = constants[_FROM_TOOL] != 0.0, constants[_BACKWARDS] != 0.0
    R, t = motion_of(constants, _BACK, T, from_tool)
    centre = vector(constants, _CENTRE)
    place = plus(product(R, centre), 1.0, (t[0], t[1], t[2]))
    arms = np.empty((4, 3))
    p, d = (place, centre) if backwards else (centre, place)
    swings = False
    if constants[_KIND] == MEETING_AXES:
        count, sure = _after_meeting(constants, p, d, arms)
    elif constants[_KIND] == SKEW_AXES:
        count, sure = _after_skew(constants, p, d, arms)
    else:
        count, swings, sure = _after_parallel(constants, p, d, arms, keep[5 if from_tool else 0])
        sure &= not (swings and backwards)
    w1, w2, w3 = vector(constants, _WRIST), vector(constants, _WRIST + 3), vector(constants, _WRIST + 6)
    aside = vector(constants, _ASIDE)
    image, side = product(R, w3), product(R, aside)
    loose = 2 if from_tool else 3  # the outermost axis of the wrist: free where the wrist is stretched
    found, kept = 0, keep[loose]
    for n in range(count):
        if backwards:
            arms[n, 0], arms[n, 2] = arms[n, 2], arms[n, 0]
        tip, edge = image, side
        for m in range(3):
            k = vector(constants, _ARM + 3 * m)
            tip, edge = turned(k, -arms[n, m], tip), turned(k, -arms[n, m], edge)
        pairs, first, second, first_too, second_too, free, sure_pair = two_turns_kept(w1, w2, w3, tip, kept, 0.0)
        sure &= sure_pair and free != 1
        if swings:
            k1, k2, k3 = vector(constants, _ARM), vector(constants, _ARM + 3), vector(constants, _ARM + 6)
            forearm = turned(k2, arms[n, 1], turned(k3, arms[n, 2], w1))
            sure &= free != 0 and _stays_bent((w1, w2, w3), forearm, k1, image)
        for _ in range(pairs):
            last, _ = one_turn(w3, aside, turned(w2, -second, turned(w1, -first, edge)))
            row = values[found]
            row[0], row[1], row[2], row[3], row[4], row[5] = arms[n, 0], arms[n, 1], arms[n, 2], first, second, last
            if from_tool:
                row[0], row[1], row[2], row[3], row[4], row[5] = row[5], row[4], row[3], row[2], row[1], row[0]
            row[6] = loose if free == 0 else -1.0
            row[7] = found if swings else -1.0
            first, second = first_too, second_too
            found += 1
    return found, sure
