"""The damped search as compiled code: the tables of starts.

See `starts.py` and `turned_starts.py` for the same in NumPy.
"""

from __future__ import annotations

import math
from typing import Any, Final

import numba
import numpy as np

from chainbuild.ik import rules
from chainbuild.ik.search.compiled.kernels import LOWER, UPPER, copy_to, leaf
from chainbuild.ik.search.compiled.limits import turned_inside
from chainbuild.ik.search.starts.turned import LARGEST_STEP, NO_RADIUS

_TURN: Final = 2.0 * math.pi  # rad
_TAKEN: Final = np.float32(1e30)  # a distance that no start has; finite, for loops without infinities are quicker

fastmath_jit: Final[Any] = numba.njit(error_model="numpy", fastmath=True)


@leaf
def rank_starts(problem, work, target, distances):
    """Write how far each start is from the target; of turned starts, fill `work` with the lookup data."""
    if len(problem.turned_values) > 0:
        _look(problem, work, target)
        _rank(problem.turned_rows, work.key, distances)
        return
    wanted, scale, features = work.features, problem.scale, problem.features
    for r in range(3):
        for c in range(4):
            wanted[4 * r + c] = target[r, c] * scale[4 * r + c]
    for s in range(len(distances)):
        squared = 0.0
        for f in range(12):
            difference = features[f, s] - wanted[f]
            squared += difference * difference
        distances[s] = squared


@fastmath_jit
def _rank(rows, key, distances):
    """Write the weighted squared distance of each point's key, plus its penalty at the edge."""
    a, b, c, d, e, f = key[0], key[1], key[2], key[3], key[4], key[5]
    for s in range(len(distances)):
        near = a * rows[0, s] + b * rows[1, s] + c * rows[2, s]
        turned = d * rows[3, s] + e * rows[4, s] + f * rows[5, s]
        distances[s] = near + turned + rows[6, s] + rows[7, s]


@fastmath_jit
def remove_edge_penalty(rows, distances):
    """Remove the edge penalty of points: it applies to the first start only."""
    for s in range(rows.shape[1]):
        distances[s] -= rows[7, s]


@fastmath_jit
def _least(distances):
    """Return the smallest of some numbers without NaN; four at a time, since each waits for the previous one."""
    count = len(distances)
    a = b = c = d = distances[0]
    for s in range(0, count - 3, 4):
        a, b = min(a, distances[s]), min(b, distances[s + 1])
        c, d = min(c, distances[s + 2]), min(d, distances[s + 3])
    for s in range(count - count % 4, count):
        a = min(a, distances[s])
    return min(a, b, c, d)


@leaf
def _look(problem, work, target):
    """Write key (6,) and view (12,) of the target, and its azimuth behind them; see `TurnedStarts.query`."""
    before, after, M, W, scale = problem.turned[0], problem.turned[1], work.T, work.W, problem.turned_scale
    for r in range(3):
        for k in range(4):
            M[r, k] = before[r, 0] * target[0, k] + before[r, 1] * target[1, k] + before[r, 2] * target[2, k]
        M[r, 3] += before[r, 3]
    for r in range(3):
        for k in range(4):
            W[r, k] = M[r, 0] * after[0, k] + M[r, 1] * after[1, k] + M[r, 2] * after[2, k]
        W[r, 3] += M[r, 3]
    radius = math.hypot(W[0, 3], W[1, 3])
    c, s = 1.0, 0.0
    if radius > NO_RADIUS:
        c, s = W[0, 3] / radius, W[1, 3] / radius
    view, key = work.seen, work.key
    view[0], view[1] = radius, W[2, 3]
    view[2], view[3] = scale * (c * W[0, 2] + s * W[1, 2]), scale * (c * W[1, 2] - s * W[0, 2])
    view[4] = scale * W[2, 2]
    for n in range(2):
        view[5 + 3 * n], view[6 + 3 * n] = c * W[0, n] + s * W[1, n], c * W[1, n] - s * W[0, n]
        view[7 + 3 * n] = W[2, n]
    view[11], view[12] = 1.0, math.atan2(s, c)
    for n in range(5):
        key[n] = view[n]
    key[5] = radius * radius + W[2, 3] * W[2, 3] + scale * scale


@leaf
def next_start(problem, work, distances, attempt, wanted, y):
    """Write a start not yet taken to y: the one whose pose is nearest, later on any in turns with it."""
    if len(distances) == 0:
        copy_to(y, wanted)
        return
    for _ in range(rules.TURN_TRIES):
        taken = attempt % len(distances)
        if attempt < rules.NEAREST_FIRST or attempt % 2 == 0 or distances[taken] >= _TAKEN:
            nearest, taken = _least(distances), 0
            while distances[taken] != nearest:
                taken += 1
        distances[taken] = _TAKEN
        if len(problem.turned_values) == 0:
            break
        if _turned(problem, work, taken, wanted, y):
            return
    copy_to(y, problem.points[taken % len(problem.points)])


@leaf
def _turned(problem, work, taken, wanted, y):
    """Write a point moved and turned towards the target to y; return whether limits allow the turns."""
    n, view, lower, upper = len(y), work.seen, problem.limits[LOWER], problem.limits[UPPER]
    first, last, signs = problem.turned_first, problem.turned_last, problem.turned_signs
    rows, largest = problem.turned_maps[taken], 0.0
    for m in range(n):
        step = rows[m, 11]
        for f in range(5):
            step += rows[m, f] * view[f]
        y[m] = step
        largest = max(largest, abs(step))
    share = LARGEST_STEP / largest if largest > LARGEST_STEP else 1.0
    c, s = 0.0, 0.0
    for f in range(5, 11):
        c += rows[n, f] * view[f]
        s += rows[n + 1, f] * view[f]
    for m in range(n):
        y[m] = problem.turned_values[taken, m] + share * y[m]
    y[first] += signs[0] * view[12]
    y[last] += signs[1] * math.atan2(s, c)
    for m in (first, last):
        value, far = y[m], wanted[m] - y[m]
        if not -math.pi <= far <= math.pi:
            value += _TURN * np.rint(far / _TURN)
        value = turned_inside(problem, m, value)
        if not lower[m] <= value <= upper[m]:
            return False
        y[m] = value
    for m in range(n):
        y[m] = min(max(y[m], lower[m]), upper[m])
    return True
