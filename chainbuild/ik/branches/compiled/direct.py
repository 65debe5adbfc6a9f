"""Machines with three linear axes, compiled: what their rotary axes stand at; the linear ones follow in `finish`."""

from __future__ import annotations

from chainbuild.ik.branches.compiled.constants import DIRECT
from chainbuild.ik.branches.compiled.small import one_turn, turned, two_turns_kept, vector
from chainbuild.ik.branches.compiled.spherical import motion_of, product
from chainbuild.ik.search.compiled.kernels import jit

_COUNT, _COLUMN, _AXES, _BACK, _TOOL, _ASIDE = DIRECT


@jit
def direct_branches(constants, T, keep, values):
    """Write the values of the rotary joints, and which is free; return how many rows, and whether none can be missing.

    Joints after those of the machine stay as they are; column 6 is the free joint, -1 where there is none.
    """
    count, column = int(constants[_COUNT]), int(constants[_COLUMN])
    row, other = values[0], values[1]
    row[6], other[6] = -1.0, -1.0
    if count == 0:
        return 1, True
    w1, w2 = vector(constants, _AXES), vector(constants, _AXES + 3)
    if column >= 0:
        tool, d = vector(constants, _TOOL), (T[0, column], T[1, column], T[2, column])
        if count == 1:
            row[0], sure = one_turn(w1, tool, d)
            return 1, sure
        pairs, row[0], row[1], other[0], other[1], row[6], sure = two_turns_kept(w1, w2, tool, d, keep[0], keep[1])
        return pairs, sure
    R, _ = motion_of(constants, _BACK, T, False)
    aside, last = vector(constants, _ASIDE), vector(constants, _AXES + 3 * (count - 1))
    image, edge = product(R, last), product(R, aside)
    if count == 1:
        row[0], sure = one_turn(last, aside, edge)
        return 1, sure
    if count == 2:
        row[0], sure = one_turn(w1, last, image)
        row[1], sure_last = one_turn(last, aside, turned(w1, -row[0], edge))
        return 1, sure and sure_last
    pairs, row[0], row[1], other[0], other[1], row[6], sure = two_turns_kept(w1, w2, last, image, keep[0], keep[1])
    for n in range(pairs):
        back = turned(w2, -values[n, 1], turned(w1, -values[n, 0], edge))
        values[n, 2], sure_last = one_turn(last, aside, back)
        sure &= sure_last
    return pairs, sure
