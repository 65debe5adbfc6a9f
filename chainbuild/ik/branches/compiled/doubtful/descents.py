"""Descents to the solutions of a pose, and whether two of these are one, compiled.

A place is a row of n + 3 numbers: axis values, how far around it Newton's steps lead there, what is left of the way to
the target, and the first piece of the curve that it is on; -1: none.
"""

from __future__ import annotations

import math
from typing import Final

from chainbuild.ik.branches.compiled.axes import FLOOR, look, way_of
from chainbuild.ik.branches.compiled.doubtful.steps import stepped
from chainbuild.ik.branches.core.branches import BETWEEN_BRANCHES, CLOSE_BRANCHES, SAME_BRANCH
from chainbuild.ik.search.compiled.kernels import jit, leaf

_STEPS: Final = 30  # damped Newton steps: a start near a branch takes five, where branches meet twenty
_EXACT: Final = 1e-15  # m and rad: rounding
_SLOW_BELOW: Final = 1e-11  # m and rad: below, steps that gain less than half have come to rounding
_HOPELESS_AFTER: Final = 10  # steps: what is not near by then is given up
_HOPELESS: Final = 0.05  # m and rad
_CRAWL_BELOW: Final = 1e-7  # m and rad: where steps are undamped but for the floor
_CRAWLS: Final = 2  # steps in succession
_SLOW: Final = 0.85  # share of what was left before that a step leaves there
_DAMPING: Final = 0.1  # times the squared error
_MOST_DAMPED: Final = 0.01  # far from a solution, where more only takes longer
_A_QUARTER: Final = 0.05  # share of the error before, by which it may differ from a quarter
_SHARES: Final = (0.5, 0.3)  # of the way between two places: in the middle of two solutions may be a third
_BETWEEN: Final = 3  # steps from there to a solution
_BESIDE: Final = 0.1  # of the way, which such steps do not leave


@leaf
def descended(axes, room, target, places, count, origin, near, reached):
    """Bring room.x to the target; return what is left of the way there.

    Given up, infinite, is what comes nearer than `near` to an origin (n,), or so near to one of the first places that
    it would end there. Where two branches meet, steps leave half of the way and a quarter of the error: twice the step
    does not. Where a direction is so weak that damping decides, each step gains the same small share: it is given up
    if the steps left will not do, or there is nothing left to gain.

    Args:
        axes: The machine's axes.
        room: Scratch.
        target: (4, 4) tool in the workpiece frame [m].
        places: Places known,
        count: and how many.
        origin: (n,) from where a step began.
        near: What comes nearer to it is given up.
        reached: What is left at a solution at most [m, rad].
    """
    left, quarters, crawled = math.inf, 0, 0
    for step in range(_STEPS + 1):
        if _leads_to_known(axes, room.x, places, count):
            return math.inf
        before = left
        left = max(look(axes, room, target))
        if not left < math.inf or left < _EXACT or step == _STEPS or (left < _SLOW_BELOW and left > 0.5 * before):
            break
        if step >= _HOPELESS_AFTER and left > _HOPELESS:
            break
        crawled = crawled + 1 if _SLOW * before < left < _CRAWL_BELOW else 0
        if crawled >= _CRAWLS and (left < reached or left * (left / before) ** (_STEPS - step) > reached):
            break
        quarters = quarters + 1 if abs(left - 0.25 * before) < _A_QUARTER * before else 0
        stepped(axes, room, max(FLOOR, min(_MOST_DAMPED, _DAMPING * left * left)), 1.0 + quarters // 2)
        quarters %= 2
        away = 0.0
        for m in range(len(axes.free)):
            away = max(away, abs(room.x[axes.free[m]] - origin[axes.free[m]]))
        if away < near:
            return math.inf
    return left


@leaf
def _leads_to_known(axes, x, places, count):
    """Tell whether Newton's steps from x lead to one of the first places: it is as near as their own column says."""
    for i in range(count):
        inside = places[i, len(x)] > 0.0
        for m in range(len(x)):
            inside = inside and abs(way_of(axes, m, places[i, m], x[m])) < places[i, len(x)]
            if not inside:
                break
        if inside:
            return True
    return False


@jit
def is_place(axes, room, target, left, places, count):
    """Tell whether room.x is one of the first places; close ones are one where between them it is as good."""
    x, n = room.x, len(room.x)
    for i in range(count):
        apart = 0.0
        for m in range(n):
            apart = max(apart, abs(way_of(axes, m, places[i, m], x[m])))
            if apart >= CLOSE_BRANCHES:
                break
        if apart < SAME_BRANCH:
            return True
        if apart < CLOSE_BRANCHES:
            here = x.copy()
            reached, is_one = max(BETWEEN_BRANCHES, left, places[i, n + 1]), True
            for share in _SHARES:
                is_one = is_one and _is_between(axes, room, target, here, places[i], share, _BESIDE * apart, reached)
            for m in range(n):
                x[m] = here[m]
            if is_one:
                return True
    return False


@jit
def _is_between(axes, room, target, start, place, share, beside, reached):
    """Tell whether a share of the way from a start (n,) to a place there is a solution; moves room.x there.

    Along a valley that bends, it is beside the way: a few steps lead there, and nowhere else.
    """
    for m in range(len(room.x)):
        room.x[m] = start[m] - share * way_of(axes, m, place[m], start[m])
    between, left = room.x.copy(), math.inf
    for step in range(_BETWEEN + 1):
        left = max(look(axes, room, target))
        if left < reached:
            break
        if step < _BETWEEN:
            stepped(axes, room, left + FLOOR, 1.0)
    away = 0.0
    for m in range(len(room.x)):
        away = max(away, abs(room.x[m] - between[m]))
    return left < reached and away < beside
