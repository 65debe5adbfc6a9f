"""Damped inverse kinematics: the door to the plain and the compiled search, and words for what they found.

Both paths take the same steps from the same starts; the compiled one (extra `fast`) is used where it is installed and
the chain's axis map is affine. Every answer is verified by forward kinematics.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild.errors import ChainbuildError
from chainbuild.ik.options import DEFAULT, IkOptions
from chainbuild.ik.result import IkResult
from chainbuild.ik.search import plain, rules
from chainbuild.ik.search.compiled import packing as compiled
from chainbuild.ik.search.found import Found
from chainbuild.ik.search.problem import Problem, problem_of
from chainbuild.ik.search.reason import beyond_bound, reason_of
from chainbuild.ik.search.table import STATUSES
from chainbuild.ik.start import Held
from chainbuild.kinematics.mechanism import as_pose

if TYPE_CHECKING:
    import pinocchio as pin

    from chainbuild.kinematics.mechanism import Robot

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


def solve(
    robot: Robot,
    target: pin.SE3 | Matrix,
    start: ArrayLike | None = None,
    held: Held | None = None,
    options: IkOptions | None = None,
) -> IkResult:
    """Find axis values for a pose.

    Args:
        robot: The robot.
        target: Tool in the workpiece frame [m]: `pin.SE3` or a (4, 4) array.
        start: Axis values (n_axes,), mm and degrees; None: near zero on machine tools, else the configuration of a
            table whose pose is nearest.
        held: See `Robot.ik`.
        options: See `IkOptions`.

    Raises:
        AxisValueError: start or held of wrong count, unknown name or not finite.
        ChainbuildError: the target is no rigid transform.
    """
    options = options or DEFAULT
    problem = problem_of(robot, start, held, options)
    first = None if start is None else problem.free_part(robot.axis_values(start))
    T = matrix_of(target)
    return result_of(problem, T, find(problem, T, first, options), options)


def matrix_of(target: pin.SE3 | ArrayLike) -> Matrix:
    """Return a pose as a (4, 4) array; whether it is rigid is looked at by the search.

    Raises:
        ChainbuildError: not 4×4 real numbers.
    """
    T = getattr(target, "homogeneous", target)
    if type(T) is np.ndarray and T.dtype == np.float64 and T.shape == (4, 4):
        return np.ascontiguousarray(T)
    matrix: Matrix = np.ascontiguousarray(as_pose(target).homogeneous)
    return matrix


def refusal(target: Matrix) -> ChainbuildError:
    """Return the error for a target that the search takes for no rigid transform."""
    try:
        as_pose(target)
    except ChainbuildError as error:
        return error
    return ChainbuildError("a pose must be a rigid 4×4 transform")


def find(problem: Problem, target: Matrix, start: Vector | None, options: IkOptions) -> Found:
    """Search by the path that is installed; a target beyond reach gets one descent, for the nearest pose.

    Args:
        problem: What is asked.
        target: (4, 4) tool in the workpiece frame [m].
        start: (n_free,) SI values to start from; None: the problem's home, or its table.
        options: Tolerances and budget.

    Raises:
        ChainbuildError: the target is no rigid transform.
    """
    start = problem.home if start is None else start
    wanted = problem.middle if start is None else start
    if beyond_bound(problem, target):
        options = replace(options, max_restarts=0)
    if options.compiled and compiled.available():
        packed = compiled.packed(problem)
        if packed is not None:
            found = compiled.search(packed, target, start, wanted, options)
            if found.outcome == rules.NOT_RIGID:
                raise refusal(target)
            return _judged(problem, found)
    if not plain.is_rigid(target):
        raise refusal(target)
    return _judged(problem, plain.search(problem, target, start, wanted, options))


def certainly_unreachable(
    robot: Robot, target: pin.SE3 | Matrix, start: ArrayLike | None, held: Held | None, options: IkOptions | None
) -> bool:
    """Return whether a pose is farther away than the kinematic is long: no solver can do better then."""
    problem, T = problem_of(robot, start, held, options or DEFAULT), matrix_of(target)
    return beyond_bound(problem, T) or problem.arm_too_short(T) is not None


def _judged(problem: Problem, found: Found) -> Found:
    """Return what was found; no success while a held axis stands outside its limits."""
    if problem.held_beyond and found.outcome == rules.OK:
        return found._replace(outcome=rules.LIMITS)
    return found


def result_of(problem: Problem, target: Matrix, found: Found, options: IkOptions) -> IkResult:
    """Return a search's end as a result, with words where it failed."""
    outcome, iterations, restarts, distance, angle, y, _ = found
    ok = outcome == rules.OK
    reason = "" if ok else reason_of(problem, target, found, options, find)
    axes = problem.shown(y)
    violated: tuple[str, ...] = ()
    if outcome == rules.LIMITS:
        violated = problem.robot.violated_limits(axes if problem.held_beyond else problem.shown(found.outside))
    return IkResult(ok, axes, STATUSES[outcome], distance, angle, iterations, restarts, problem.task, reason, violated)
