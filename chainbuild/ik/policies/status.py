"""The solution of a programmed pose status and turn, or why there is none (KIN_TYP manual 3.3.3)."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.every import every_branch
from chainbuild.ik.branches.status_filter import StatusFilter
from chainbuild.ik.branches.status_turn import status_turn_rows
from chainbuild.ik.request import IkRequest
from chainbuild.ik.result import IkResult
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.tolerances import BELOW_ZERO_DEG

_FOREARM: Final = 3  # place of axis 4 among the axes
_FLANGE: Final = 5  # place of axis 6
_TURN_DEG: Final = 360.0  # axes 4 and 6 may stand apart by it in the same pose
_MOST_WINDINGS: Final = 64  # of one branch that the reason of a failure looks at: two of each axis
_CLEAR: Final = 2.0  # times the tolerance: surely below zero


def with_status(
    request: IkRequest, status: object, turn: object, solver: str, failure: Callable[[], IkResult]
) -> IkResult:
    """Return the solution of a status and a turn that is nearest to the start, or a failure that names those there are.

    Args:
        request: The request.
        status: Pose status, 0 … 7.
        turn: Turn, 0 … 63; None: any.
        solver: As for `Robot.ik`.
        failure: Solves the request without them, for the reason where nothing reaches the pose.

    Raises:
        ChainbuildError: status or turn is refused, or the solver finds one solution only.
    """
    wanted = StatusFilter.of(request.mechanism, status, turn)
    if solver not in {"auto", "analytic"}:
        text = f"solver '{solver}' returns the solution it meets first, whatever its status"
        raise ChainbuildError(text, parameter="solver", permitted="auto, analytic")
    found = every_branch(wanted.applied(BranchQuery.of(request)))
    if len(found.branches):
        return found.branches[0]
    turned = _wrist_turned(request, wanted)
    if turned is not None:
        return turned
    there = every_branch(BranchQuery.of(request, windings=_few_windings(request.mechanism))).branches
    if found.beyond is not None:
        limits = f"{wanted.words} is reached only outside the limits of {', '.join(found.outside)}"
        reason = f"{limits}{_inside_words(wanted, there.axes)}"
        return replace(found.beyond, success=False, status="limits", reason=reason, violated=found.outside)
    best = there[0] if len(there) else failure()
    if not best.success or wanted.keeps(best.axes):
        return best
    rows = there.axes if len(there) else best.axes[None]
    reason = f"no solution has {wanted.words}{_inside_words(wanted, rows)}"
    return replace(best, success=False, status="unreachable", reason=reason)


def _few_windings(mechanism: Mechanism) -> bool:
    """Return whether the whole turns that the limits leave are few enough to name them all."""
    limits = mechanism.limits
    return bool(np.prod(np.ceil((limits.upper - limits.lower) / _TURN_DEG)) <= _MOST_WINDINGS)


def _inside_words(wanted: StatusFilter, rows: Matrix) -> str:
    """Return the statuses and turns of solutions (k, 6), as the end of a sentence."""
    turns: dict[int, set[int]] = {}
    for status, turn in status_turn_rows(wanted.mechanism, rows).tolist():
        turns.setdefault(status, set()).add(turn)
    if not turns:
        return ""
    # The turns of the same status are the answer; without it, the other statuses.
    shown = [wanted.status] if wanted.status in turns else sorted(turns)
    words = (f"status {status} with turn {_or(sorted(turns[status]))}" for status in shown)
    return f"; inside the limits: {', '.join(words)}"


def _or(numbers: list[int]) -> str:
    *most, last = map(str, numbers)
    return f"{', '.join(most)} or {last}" if most else last


def _wrist_turned(request: IkRequest, wanted: StatusFilter) -> IkResult | None:
    """Return a solution where axes 4 and 6 turn about one line, which leaves one of them free to keep the turn."""
    if wanted.turn is None:
        return None
    for branch in every_branch(BranchQuery.of(request)).branches:
        if branch.free_axes != (request.mechanism.axes[_FOREARM].name,):
            continue
        for value in _forearm_values(request.mechanism, branch.axes, wanted.turn):
            start = branch.axes.copy()
            start[_FOREARM] = value
            there = every_branch(wanted.applied(BranchQuery.of(request.to(request.target, start)))).branches
            if len(there):
                return there[0]
    return None


def _forearm_values(mechanism: Mechanism, axes: Vector, turn: int) -> Iterator[float]:
    """Yield values of axis 4 [degrees], nearest first, where it and axis 6 have the signs of a turn, in their limits.

    Args:
        mechanism: The robot.
        axes: (6,) axis values at which both axes turn about one line: only their sum or difference matters.
        turn: The turn.
    """
    J = mechanism.jacobian(axes)
    same = math.copysign(1.0, float(J[3:, _FOREARM] @ J[3:, _FLANGE]))
    low, high = _signed_range(mechanism, axes, _FOREARM, turn)
    other = np.sort(same * np.array(_signed_range(mechanism, axes, _FLANGE, turn)))
    here = float(axes[_FOREARM])
    total = here + same * float(axes[_FLANGE])
    first, last = math.ceil((low + other[0] - total) / _TURN_DEG), math.floor((high + other[1] - total) / _TURN_DEG)
    values = []
    for turns in range(first, last + 1):
        least, most = (float(end) + total + turns * _TURN_DEG for end in -other[::-1])
        least, most = max(low, least), min(high, most)
        if least <= most:
            value = min(max(here, least), most)
            values.append(0.0 if abs(value) < BELOW_ZERO_DEG and least <= 0.0 <= most else value)
    yield from sorted(values, key=lambda value: abs(value - here))


def _signed_range(mechanism: Mechanism, axes: Vector, n: int, turn: int) -> tuple[float, float]:
    """Return the part of the range of an axis [degrees] that has its sign in a turn; two turns where it is endless."""
    here, limits = float(axes[n]), mechanism.limits
    low = max(float(limits.lower[n]), here - 2.0 * _TURN_DEG)
    high = min(float(limits.upper[n]), here + 2.0 * _TURN_DEG)
    if turn >> n & 1:
        return low, min(high, -_CLEAR * BELOW_ZERO_DEG)
    return max(low, -BELOW_ZERO_DEG / _CLEAR), high
