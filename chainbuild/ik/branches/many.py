"""All branches of many poses at once, of every kinematic whose plan finds every branch."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from chainbuild.arrays import Indices, Matrix, Vector
from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.compiled.constants import ROWS
from chainbuild.ik.branches.compiled.forms import quick_form
from chainbuild.ik.branches.compiled.quick import write_branches_of
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.every import every_branch
from chainbuild.ik.branches.opw.batch import (
    has_ortho_parallel_batch,
    ortho_parallel_batch,
    slots_over_first_axis,
    wrists_over_first_axis,
)
from chainbuild.ik.branches.planar.batch import planar_batch
from chainbuild.ik.branches.redundant import REDUNDANT_SAMPLES, Redundant, held_samples
from chainbuild.ik.plan import plan_of
from chainbuild.ik.request import Held, IkRequest, held_by_name, in_controller_units, start_point
from chainbuild.ik.search.batch import at_row, pose_array
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.progress import Progress, counting
from chainbuild.units import Units

if TYPE_CHECKING:
    from chainbuild.kinematics.inputs import Pose

_CHUNK: Final = 8192  # poses between updates of the progress bar and checks for interrupts
_BAR: Final = "branches"  # what the progress bar is labelled with


def ik_all_batch(
    robot: Mechanism,
    poses: Sequence[Pose] | ArrayLike,
    *,
    limits: bool = True,
    compiled: bool = True,
    held: Held | None = None,
    redundant: Redundant | None = None,
    samples: int = REDUNDANT_SAMPLES,
    units: Units = "controller",
    progress: Progress = False,
) -> Matrix:
    """Return all branches (N, K, n_axes) of poses, mm and degrees; NaN where a branch does not exist.

    They are the branches of `ik_all` without a start: whole turns end near the middle of the limits, and an axis that
    does not affect a pose is placed where all limits hold, as near to there as possible. Every row of numbers was
    confirmed by forward kinematics to 1e-6 m and 1e-6 rad.

    Of a six-axis arm with axes at right angles or parallel and a spherical wrist K is 8, and slot 4·flip + 2·shoulder +
    elbow is the same branch in every pose: flip 0 has θ5 ≥ 0 (the wrist turned from straight in the one sense),
    shoulder 0 the arm in front of axis 1, elbow 0 and 1 its two bends. Branches that coincide fill the first of their
    slots. Of every other kinematic K is the largest number of branches of these poses, at least 1, and those of a pose
    stand nearest to the middle of the limits first. With a redundant axis K is that for each of its values, one after
    the other: branch k of value s stands in slot s·K/(number of values) + k.

    Args:
        robot: A kinematic whose plan finds every branch, see `Robot.plan`.
        poses: (N, 4, 4) tool in the workpiece frame [m], or `pin.SE3`.
        limits: True: axes are moved by whole turns into their limits, and branches outside them left out; False:
            every branch, whatever the limits.
        compiled: False: plain Python and NumPy, even where numba is installed.
        held: Axis name → value to hold, or one value for each input axis in order.
        redundant: Name of an axis too many, or names of several: its values are spread over its limits.
        samples: Number of these values.
        units: Those of held and of the result: "controller", mm and degrees, or "si", metres and radians.
        progress: True: show a progress bar on stderr.

    Raises:
        AxisValueError: held has a wrong number of values, an unknown name or a non-finite value.
        ChainbuildError: the plan does not find every branch, a pose is no rigid transform, an unknown redundant axis,
            or there are no such units.
    """
    factors, targets = robot.labels.to(units).factors, pose_array(poses)
    _, held = in_controller_units(robot, None, held, units)
    if redundant is not None:
        choices = held_samples(robot, redundant, samples, held, None)
        parts = [_batch(robot, targets, limits, compiled, one, progress) for one in choices]
        most = max(part.shape[1] for part in parts)
        axes = np.full((len(targets), len(parts), most, len(robot.axes)), np.nan)
        for n, part in enumerate(parts):
            axes[:, n, : part.shape[1]] = part
        axes = axes.reshape(len(targets), -1, len(robot.axes))
    elif held is None and has_ortho_parallel_batch(robot, limits=limits):
        axes = ortho_parallel_batch(robot, targets, limits=limits, compiled=compiled)
        # Where axis 1 is free its start may be in the way.
        for row in wrists_over_first_axis(robot, targets, axes).tolist() if limits else ():
            found = every_branch(BranchQuery.of(IkRequest(robot, targets[row]))).branches.axes
            axes[row, slots_over_first_axis(robot, found)] = found
    else:
        axes = _batch(robot, targets, limits, compiled, held, progress)
    return axes if units == "controller" else axes * factors


def _batch(
    robot: Mechanism, targets: Matrix, limits: bool, compiled: bool, held: Held | None, progress: Progress
) -> Matrix:
    """Return the branches (N, K, n_axes) of poses, nearest to the middle of the limits first."""
    mechanism, start = robot, None
    if not limits:
        mechanism = robot.prepared("without limits", lambda: _without_limits(robot))
        start = start_point(robot, None, None)[0] / robot.kinematics.si_factors
    plan = plan_of(mechanism, held_by_name(mechanism, held))
    if not plan.complete:
        raise ChainbuildError(
            f"ik_all_batch needs a plan that finds every branch: {plan.reason}",
            parameter="held",
            permitted="axes held or named as redundant until the pose determines the others",
        )
    quick = planar_batch(robot, targets, limits=limits, compiled=compiled) if held is None else None
    with counting(len(targets), progress, _BAR) as advance:
        if quick is None:
            return _in_parts(mechanism, targets, np.arange(len(targets)), (start, held), compiled, advance)
        found, counts = quick
        doubtful = np.flatnonzero(counts < 0)
        if len(targets) > len(doubtful):
            advance(len(targets) - len(doubtful))
        others = _in_parts(mechanism, targets, doubtful, (start, held), compiled, advance)
    found = _wide(found, max(others.shape[1], int(counts.max(initial=0))))
    found[doubtful] = _wide(others, found.shape[1])
    return found


def _in_parts(
    mechanism: Mechanism,
    targets: Matrix,
    rows: Indices,
    begin: tuple[Vector | None, Held | None],
    compiled: bool,
    advance: Callable[[int], None],
) -> Matrix:
    """Return the branches (n, K, n_axes) of some rows of poses; begin: start and held axes."""
    form, x0 = quick_form(mechanism, *begin) if compiled else (None, start_point(mechanism, *begin)[0])
    parts = [np.full((0, 1, len(mechanism.axes)), np.nan)]
    for first in range(0, len(rows), _CHUNK):
        some = rows[first : first + _CHUNK]
        part = targets[some]
        found = np.full((len(some), ROWS, len(mechanism.axes)), np.nan)
        counts = np.full(len(some), -1, dtype=np.int64)
        doubtful = {} if form is None else write_branches_of(form, part, x0, found, counts)
        alone: dict[int, Matrix] = {}
        for row in np.flatnonzero(counts < 0).tolist():
            try:
                query = BranchQuery.of(IkRequest(mechanism, part[row], *begin))
            except ChainbuildError as error:
                raise at_row(error, int(some[row])) from None
            alone[row] = every_branch(query, doubtful.get(row)).branches.axes
        found = _wide(found, max([1, *counts.tolist(), *map(len, alone.values())]))
        found[np.arange(found.shape[1]) >= counts[:, None]] = np.nan  # what compiled code has left behind the last one
        for row, axes in alone.items():
            found[row, : len(axes)] = axes
        parts.append(found)
        advance(len(some))
    most = max(part.shape[1] for part in parts)
    return np.concatenate([_wide(part, most) for part in parts])


def _wide(found: Matrix, width: int) -> Matrix:
    """Return branches (N, K, n_axes) with K cut or filled up to a width."""
    if found.shape[1] == width:
        return found
    wide = np.full((len(found), width, found.shape[2]), np.nan)
    kept = min(width, found.shape[1])
    wide[:, :kept] = found[:, :kept]
    return wide


def _without_limits(mechanism: Mechanism) -> Mechanism:
    """Return a mechanism whose axes go as far as they like."""
    chain = mechanism.chain
    axes = tuple(replace(axis, endless=True, widest=None) for axis in chain.axes)
    return Mechanism(replace(chain, axes=axes, constraints=(), drive_limits=()))
