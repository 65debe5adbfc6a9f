"""Every branch of a pose that a compiled form calls doubtful, or what is known of it. Nothing here imports numba."""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Integers, Matrix, Vector
from chainbuild.ik.branches.compiled.constants import (
    CLUSTERED,
    COLUMNS,
    ENDS,
    FOLLOWED,
    ISOLATED,
    ROWS,
    STATE,
    TOLD,
    UNSURE,
)
from chainbuild.ik.branches.compiled.forms import QuickForm, compiled_entries

# Where poses beside a doubtful one tell more than the plain path: other closed forms know themselves what is free.
_SEARCHED: Final = ("general", "three parallel axes")
_FOLLOWED: Final = ("general",)  # the same where solutions are on curves
_ENOUGH: Final = 4  # what pairs of poses that bring nothing new must amount to
_ENOUGH_BESIDE: Final = 8  # the same beside curves and clusters of branches, which move far or vanish on either side
# What one does, by how many of its poses are sure: a branch that both leave out would have to vanish on either side.
_WEIGHT: Final = (1, 2, 4)
_ANYWHERE: Final = np.random.default_rng(20240229).uniform(-math.pi, math.pi, (ROWS, 6))  # the last resort
_REACHED: Final = 1e-9  # m and rad: what is left at a solution at most
_NEARLY: Final = 3e-7  # the same where solutions are singular several times over, within the tolerance of `ik`
_MOST_PLACES: Final = 64  # solutions of a pose, one of each curve
_MOST_POINTS: Final = 1024  # of all curves of a pose
_MOST_PIECES: Final = 64  # two of each curve
_TOLD_OF: Final = 3  # columns behind the axis values of a place
_OUTSIDE: Final = -1.5  # a curve with no place inside the limits is told by less

Settled = tuple[int, bool, Matrix, Matrix, Matrix]  # what `entries.finish_poses` returns and writes: found, left, along


class Doubtful(NamedTuple):
    """What is known of a pose that the plain path decides: surfaces, curves that are not followed, or nothing found.

    Attributes:
        places: (k, n_axes) solutions in SI, whatever the limits: all but for those on such curves and surfaces.
        near: (0 or 1, n_axes) the last resort: a solution for a pose of which nobody finds any.
    """

    places: Matrix
    near: Matrix


def is_searched(form: QuickForm) -> bool:
    """Return whether `settled` tells more of a doubtful pose than the plain path."""
    return form.form in _SEARCHED


def settled(form: QuickForm, target: Matrix, x0: Vector, values: Matrix, count: int) -> Settled | Doubtful:
    """Return every branch of a doubtful pose if poses beside it tell them, or else what they tell.

    Args:
        form: The form.
        target: (4, 4) tool in the workpiece frame [m].
        x0: (n_axes,) start in SI.
        values: (ROWS, COLUMNS) what the form wrote for the pose,
        count: and what was told of it.
    """
    curves = _no_curves(len(x0), ends=form.form not in _FOLLOWED)
    places = _places_at(form, target, x0, values, count, curves)
    if not len(places):
        return Doubtful(places[:, :-_TOLD_OF], _place_near(form, target, x0))
    state = curves[-1][STATE]
    if state in {ISOLATED, FOLLOWED}:
        shown = places
        if state == FOLLOWED:
            shown = places.copy()
            compiled_entries().nearest_places(*form.axes, target, x0, *curves, shown, len(shown))
            shown = shown[shown[:, -1] > _OUTSIDE]
        found = _finished(form, target, x0, shown)
        if found is not None:
            return found
    return Doubtful(places[:, :-_TOLD_OF], places[:0, :-_TOLD_OF])


def settle_ahead(form: QuickForm, target: Matrix, x0: Vector) -> None:
    """Call all that `settled` may call, so that it is compiled.

    Args:
        form: The form.
        target: (4, 4) tool in the workpiece frame [m].
        x0: (n_axes,) start in SI.
    """
    settled(form, target, x0, np.empty((ROWS, COLUMNS)), UNSURE)
    curves, places = _no_curves(len(x0), ends=False), np.empty((1, len(x0) + _TOLD_OF))
    compiled_entries().nearest_places(*form.axes, target, x0, *curves, places, 0)


def _places_at(
    form: QuickForm,
    target: Matrix,
    x0: Vector,
    values: Matrix,
    count: int,
    curves: tuple[Matrix, Integers, Integers, Integers],
) -> Matrix:
    """Return the solutions (k, n_axes + 3) of a doubtful pose as `beside.places_beside` writes them, one of each curve.

    Those of poses beside it lead there: of pairs on either side of the pose, at several distances, until enough of
    them bring nothing new. A pair is enough where the form is sure of both and they lead to the same.
    """
    entries, idle, known, known_of = compiled_entries(), 0, 0, curves[-1]
    places = np.empty((_MOST_PLACES, len(x0) + _TOLD_OF))
    targets = form.beside.copy()
    targets[:, :3, :3] = targets[:, :3, :3] @ target[:3, :3]
    targets[:, :3, 3] += target[:3, 3]
    rows, counts = np.empty((3, ROWS, COLUMNS)), np.array([count, 0, 0])
    rows[0] = values
    # The pose itself with the first one beside it, then the one on the other side.
    looks: tuple[slice, ...] = (slice(0, 2), slice(2, 3))
    for first in range(0, len(targets), 2):
        form.write_values(targets[first : first + 2], x0, rows[1:], counts[1:], briefly=first > 0)
        before = told = known
        for new in looks:
            before, told = told, entries.beside_pose(
                *form.axes, target, x0, rows[new], counts[new], _REACHED, *curves, places, told
            )  # fmt: skip
        one, other = counts[1:].tolist()
        is_plain = known_of[STATE] == ISOLATED and not known_of[CLUSTERED]
        if not first and is_plain and min(one, other) >= 0 and 0 < told == before:
            return places[:told]  # either side is sure to be whole, and the second one tells nothing new
        looks = (slice(1, 3),)
        if told > known:
            idle = 0
        elif first and (min(one, other) < UNSURE or max(one, other) > 0):  # else these poses say nothing
            idle += _WEIGHT[(one >= 0) + (other >= 0)]
        known = told
        if known_of[STATE] != ISOLATED and known_of[ENDS]:
            break
        if known and first and idle >= (_ENOUGH if is_plain else _ENOUGH_BESIDE):
            break
    return places[:known]


def _place_near(form: QuickForm, target: Matrix, x0: Vector) -> Matrix:
    """Return one solution (1, n_axes) [SI] that descents from anywhere lead to, or none (0, n_axes)."""
    values, counts, places = np.full((1, ROWS, COLUMNS), -1.0), np.array([ROWS]), np.empty((1, len(x0) + _TOLD_OF))
    values[0, :, :6] = _ANYWHERE
    curves = _no_curves(len(x0), ends=False)
    count = compiled_entries().beside_pose(*form.axes, target, x0, values, counts, _NEARLY, *curves, places, 0)
    return places[:count, :-_TOLD_OF]


def _no_curves(n: int, *, ends: bool) -> tuple[Matrix, Integers, Integers, Integers]:
    """Return room for curves of n axes, as `curves.Curves` has them; whether looking ends with the first one."""
    points: NDArray[np.float64] = np.empty((_MOST_POINTS, n))
    return (
        points,
        np.empty(_MOST_POINTS, np.int64),
        np.empty(_MOST_PIECES, np.int64),
        np.array([0, 0, ISOLATED, ends, 0]),
    )


def _finished(form: QuickForm, target: Matrix, x0: Vector, places: Matrix) -> Settled | None:
    """Return the branches among the solutions of a pose, or None where these are in doubt."""
    if len(places) > ROWS:
        return None
    values, counts = np.full((1, ROWS, COLUMNS), -1.0), np.array([len(places)])
    values[0, : len(places), :6] = places[:, :-_TOLD_OF] @ form.by_axes.T + form.at_zero
    values[0, : len(places), COLUMNS - 1] = places[:, -1]
    rows, left, along = (np.empty((1, ROWS, size)) for size in (len(x0), TOLD, len(x0)))
    count, loose = compiled_entries().finish_poses(*form.axes, target[None], x0, values, counts, rows, left, along)
    return (count, loose, rows, left, along) if count >= 0 else None
