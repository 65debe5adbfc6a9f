"""What compiled closed forms know of a machine: its form and the form's constants, packed once.

Nothing here imports numba.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Final

import numpy as np

from chainbuild.arrays import Vector
from chainbuild.frames import inverse
from chainbuild.ik.branches.arms.arms import wrist_centre
from chainbuild.ik.branches.arms.general_reach import skew_inverse
from chainbuild.ik.branches.arms.orientation import perpendicular
from chainbuild.ik.branches.arms.positioner import MEETING, meeting_point, parallel
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.core.serial import Screw, Serial
from chainbuild.ik.branches.core.subproblems import cross, norm, perpendicular_part
from chainbuild.tolerances import RANK

ALONG: Final = -2  # instead of a free axis: a solution is on a curve along which several axes move
REFUSED: Final = -2  # instead of a number of branches: the target is no rigid transform
ROWS: Final = 32  # joint values that a form may write: twice as many as six joints have branches
COLUMNS: Final = 8  # of such a row: six joint values, which of them is free, which rows are a family (-1: none)
TOLD: Final = 6  # what is told of a branch, see `finish.finished`
UNSURE: Final = -3  # less the number of rows that a form has written, instead of a number of branches: doubtful

# What is known of the curves of a pose: how many points, how many pieces, whether that is all there is to them, whether
# looking for more ends with the first solution on one, and whether at an isolated one several directions are weak.
POINTS: Final = 0
PIECES: Final = 1
STATE: Final = 2
ENDS: Final = 3
CLUSTERED: Final = 4
ISOLATED: Final = 0  # no solution is on a curve
FOLLOWED: Final = 1  # every curve has been followed to its ends
UNKNOWN: Final = 2  # solutions form a surface, more curves cross, or there is no room for all

# Where the constants of an arm with a spherical wrist stand: kind of the first three axes, whether these are solved
# from their end, whether the whole arm is; their row as solved, direction and point each; their directions, those of
# the wrist, the wrist centre, M⁻¹, a vector across the last axis, then the point where two axes of the row meet, or for
# skew axes a matrix (3, 3).
SPHERICAL: Final = (0, 1, 2, 3, 21, 30, 39, 42, 54, 57)
PARALLEL_AXES: Final = 0.0  # kind of a row whose second and third axes are parallel
MEETING_AXES: Final = 1.0  # kind of a row whose first and second axes meet
SKEW_AXES: Final = 2.0  # kind of a row whose first and second axes neither meet nor are parallel

# The same for three linear axes and up to three rotary ones: number of rotary ones, column of the tool vector (-1: the
# whole rotation counts), their directions, M⁻¹, the tool vector, a vector across the last axis.
DIRECT: Final = (0, 1, 2, 11, 23, 26)
_DIRECT_SIZE: Final = 29


def spherical_constants(serial: Serial) -> Vector | None:
    """Return the constants of an arm of six rotary axes with a spherical wrist, or None where it is no such arm."""
    if len(serial.screws) != 6 or any(screw.kind != "revolute" for screw in serial.screws):
        return None
    for candidate, from_tool in ((serial, 0.0), (serial.reversed(), 1.0)):
        centre = wrist_centre(candidate.screws[3:])
        row = None if centre is None else _row(candidate.screws[:3])
        if row is None or centre is None:
            continue
        kind, backwards, screws, meeting = row
        last = candidate.screws[5].direction
        constants: Vector = np.concatenate([
            [kind, backwards, from_tool],
            *(part for screw in screws for part in (screw.direction, screw.point)),
            *(screw.direction for screw in candidate.screws),
            centre, inverse(candidate.M)[:3].ravel(), perpendicular(last), meeting,
        ])  # fmt: skip
        return constants
    return None


def _row(screws: tuple[Screw, ...]) -> tuple[float, float, list[Screw], Vector] | None:
    """Return the kind of three axes, whether they are solved from their end, their row, and what its kind needs."""
    back = [screw.reversed() for screw in reversed(screws)]
    rows = [(row, end) for row, end in ((list(screws), 0.0), (back, 1.0)) if not _parallel_first(row)]
    for row, backwards in rows:
        a, b, c = row
        if parallel(b.direction, c.direction):
            return PARALLEL_AXES, backwards, row, np.zeros(3)
        centre = meeting_point(a, b)
        if centre is not None and norm(perpendicular_part(c.direction, centre - c.point)) >= MEETING:
            return MEETING_AXES, backwards, row, centre
    for row, backwards in rows:
        if meeting_point(*row[:2]) is None:
            return SKEW_AXES, backwards, row, skew_inverse(*row[:2]).ravel()
    return None


def _parallel_first(row: Sequence[Screw]) -> bool:
    return parallel(row[0].direction, row[1].direction)


def direct_constants(query: BranchQuery) -> Vector | None:
    """Return the constants of the rotary joints of a query that is solved directly, or None."""
    serial, task = query.serial(), query.mechanism.task
    directions = [screw.direction for screw in serial.screws if screw.kind == "revolute"]
    column = query.mechanism.chain.tool_column if task == "direction" else -1
    if task == "position" or len(directions) > (3 if column < 0 else 2):
        return None
    if any(norm(cross(a, b)) < RANK for a, b in itertools.pairwise(directions)):
        return None  # parallel axes: only their sum counts
    constants = np.zeros(_DIRECT_SIZE)
    constants[0], constants[1] = len(directions), column
    constants[2 : 2 + 3 * len(directions)] = np.concatenate([*directions, []])
    constants[11:23] = inverse(serial.M)[:3].ravel()
    constants[23:26] = serial.M[:3, max(column, 0)]
    constants[26:29] = perpendicular(directions[-1]) if directions else 0.0
    return constants
