"""Every branch of a pose by compiled code (extra `fast`); None where the plain path has to look.

That path takes over where numba is missing, no compiled form knows the machine, limits on sums of axes or drives
decide about whole turns, and at poses that a form calls doubtful and those beside do not settle.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from chainbuild.arrays import Integers, Matrix, Vector
from chainbuild.ik.branches.compiled.constants import REFUSED, ROWS, TOLD, UNSURE
from chainbuild.ik.branches.compiled.doubtful.settle import Doubtful, is_searched, settled
from chainbuild.ik.branches.compiled.forms import QuickForm, compiled_entries, quick_form
from chainbuild.ik.branches.core.branches import Branches, quick_made
from chainbuild.ik.request import Held
from chainbuild.ik.search.compiled.cores import on_all_cores
from chainbuild.ik.search.solver import refusal
from chainbuild.kinematics.mechanism import Mechanism

_PART: Final = 1024  # poses that one core takes at a time
_NONE_FREE: Final = tuple(((),) * count for count in range(ROWS + 1))


def quick_branches(
    mechanism: Mechanism, target: Matrix, start: Vector | None, held: Held | None
) -> Branches | Doubtful | None:
    """Return every branch of a pose, nearest to the start first; None or solutions where the plain path has to look.

    Args:
        mechanism: The mechanism.
        target: (4, 4) tool in the workpiece frame [m].
        start: (n_axes,) mm and degrees, or None.
        held: As for `ik_all`.

    Raises:
        AxisValueError: held has a wrong number of values, an unknown name or a non-finite value.
        ChainbuildError: the target is not a rigid transform.
    """
    form, x0 = quick_form(mechanism, start, held)
    if form is None:
        return None
    n = len(x0)
    rows, left, along = np.empty((1, ROWS, n)), np.empty((1, ROWS, TOLD)), np.empty((1, ROWS, n))
    count, loose, values = form.write(target[None], x0, rows, left, along, np.empty(1, np.int64))
    if count == REFUSED:
        raise refusal(target)
    if count <= UNSURE:
        if not is_searched(form):
            return None
        known = settled(form, target, x0, values[0], count)
        if isinstance(known, Doubtful):
            return known
        count, loose, rows, left, along = known
    free: tuple[tuple[str, ...], ...] = _NONE_FREE[count]
    directions, told = form.isolated[:count], left[0, :count]
    if loose:
        axes, ways = told[:, 4].tolist(), along[0]
        free = tuple([form.free_names[n] for n in axes])
        directions = tuple([directions[k] if n == -1.0 else ways[k : k + 1] for k, n in enumerate(axes)])
    status, turn = None, None
    if form.status is not None:
        bits = np.empty((count, 2), np.int64)
        compiled_entries().status_rows(form.status, rows[0, :count], bits)
        status, turn = bits.T
    return quick_made(
        rows[0, :count], told[:, 0], told[:, 1], told[:, 2].astype(np.int64), free, mechanism.task, mechanism.labels,
        status, turn, form.method, directions,
    )  # fmt: skip


def write_branches_of(
    form: QuickForm, targets: Matrix, x0: Vector, found: Matrix, counts: Integers
) -> dict[int, Doubtful]:
    """Write the branches of many poses on all cores.

    Args:
        form: The form.
        targets: (N, 4, 4) tool in the workpiece frame [m].
        x0: (n_axes,) start in SI.
        found: (N, ROWS, n_axes) out: axis values, mm and degrees, nearest to the start first.
        counts: (N,) out: numbers of branches, below 0 where the plain path has to look.

    Returns:
        What is known of such poses.
    """
    doubtful: dict[int, Doubtful] = {}

    def write(part: slice) -> None:
        left, along = np.empty((part.stop - part.start, ROWS, TOLD)), np.empty((part.stop - part.start, ROWS, len(x0)))
        _, _, values = form.write(targets[part], x0, found[part], left, along, counts[part])
        for n in np.flatnonzero(counts[part] <= UNSURE).tolist() if is_searched(form) else ():
            row = part.start + n
            known = settled(form, targets[row], x0, values[n], int(counts[row]))
            if isinstance(known, Doubtful):
                doubtful[row] = known
            else:
                counts[row] = known[0]
                found[row] = np.nan
                found[row, : known[0]] = known[2][0, : known[0]]

    on_all_cores(write, len(targets), _PART)
    return doubtful
