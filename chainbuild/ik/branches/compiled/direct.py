"""Machines with three linear axes, compiled: what their rotary axes stand at; the linear ones follow in `finish`."""

from __future__ import annotations

from chainbuild.ik.branches.compiled.constants import DIRECT
from chainbuild.ik.branches.compiled.small import one_turn, turned, two_turns, vector
from chainbuild.ik.branches.compiled.spherical import motion_of, product
from chainbuild.ik.search.compiled.kernels import jit

_COUNT, _COLUMN, _AXES, _BACK, _TOOL, _ASIDE = DIRECT


@jit
def direct_branches(constants, T, values):
    """Write the values of the rotary joints; return how many rows, and whether none can be missing."""
    count, column = int(constants[_COUNT]), int(constants[_COLUMN])
    row = values[0]
    if count == 0:
        return 1, True
    w1 = vector(constants, _AXES)
    if column >= 0:
        tool, d = vector(constants, _TOOL), (T[0, column], T[1, column], T[2, column])
        if count == 1:
            row[0], sure = one_turn(w1, tool, d)
            return 1, sure
        pairs, row[0], row[1], values[1, 0], values[1, 1], sure = two_turns(w1, vector(constants, _AXES + 3), tool, d)
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
    w2 = vector(constants, _AXES + 3)
    pairs, row[0], row[1], values[1, 0], values[1, 1], sure = two_turns(w1, w2, last, image)
    for n in range(pairs):
        back = turned(w2, -values[n, 1], turned(w1, -values[n, 0], edge))
        values[n, 2], sure_last = one_turn(last, aside, back)
        sure &= sure_last
    return pairs, sure
