"""The damped search: common entry to its plain and its compiled form, and results with reasons.

Both take the same steps from the same starts; the compiled form (extra `fast`) is used if it is installed and the
chain's axis map is affine. Every answer is verified by forward kinematics.
"""

from __future__ import annotations

from dataclasses import replace

from chainbuild.arrays import Matrix, Vector
from chainbuild.errors import ChainbuildError
from chainbuild.frames import is_rigid
from chainbuild.ik import rules
from chainbuild.ik.request import IkOptions, IkRequest
from chainbuild.ik.result import STATUSES, IkResult, quick_result
from chainbuild.ik.search import plain
from chainbuild.ik.search.compiled import packing as compiled
from chainbuild.ik.search.found import SearchEnd
from chainbuild.ik.search.problem import Problem, asked, problem_of
from chainbuild.ik.search.reason import reason_of
from chainbuild.kinematics.inputs import as_pose


def search(request: IkRequest) -> IkResult:
    """Find axis values for a pose: from the start, else from the nearest configurations of a table.

    Machine tools without a start begin near zero.

    Raises:
        AxisValueError: held has a wrong number of values, an unknown name or a non-finite value.
        ChainbuildError: the target is not a rigid transform.
    """
    mechanism, target, begin, held, options = request
    problem = problem_of(mechanism, begin, held, options)
    start = None if begin is None else problem.free_part(begin)
    return result_of(problem, target, find(problem, target, start, options), options)


def refusal(target: Matrix) -> ChainbuildError:
    """Return the error for a target that the search rejects as not rigid."""
    try:
        as_pose(target)
    except ChainbuildError as error:
        return error
    return ChainbuildError("a pose must be a rigid 4×4 transform")


def find(problem: Problem, target: Matrix, start: Vector | None, options: IkOptions) -> SearchEnd:
    """Search by the installed path; a target beyond reach gets one descent, for the nearest pose.

    Args:
        problem: The problem.
        target: (4, 4) tool in the workpiece frame [m].
        start: (n_free,) SI values to start from; None: the problem's home, or its table.
        options: Tolerances and budget.

    Raises:
        ChainbuildError: the target is not a rigid transform.
    """
    start = problem.home if start is None else start
    wanted = problem.middle if start is None else start
    if options.compiled and compiled.available():
        packed = compiled.packed(problem)
        if packed is not None:
            found = compiled.compiled_search(packed, target, start, wanted, options)
            if found.outcome == rules.NOT_RIGID:
                raise refusal(target)
            if problem.rechecked:
                found = _with_drives(problem, target, found, start, wanted, options)
            return _held_inside(problem, found)
    if not is_rigid(target):
        raise refusal(target)
    return _held_inside(problem, plain.plain_search(problem, target, start, wanted, options))


def _with_drives(
    problem: Problem, target: Matrix, found: SearchEnd, start: Vector | None, wanted: Vector, options: IkOptions
) -> SearchEnd:
    """Return an outcome of compiled code, or a better one where limits of sums or drives ask for other whole turns."""
    if found.outcome not in {rules.OK, rules.LIMITS} or (found.outcome == rules.OK and problem.keeps(found.y)):
        return found
    if problem.curved:
        return plain.plain_search(problem, target, start, wanted, options)
    wound = problem.wound(problem.box.into(found.outside), wanted)
    ended = plain.plain_search(problem, target, wound, wanted, replace(options, max_restarts=0))
    return ended if ended.outcome == rules.OK else found


def certainly_unreachable(request: IkRequest) -> bool:
    """Return whether a pose is farther away than the kinematic is long: then no solver reaches it."""
    problem = asked(request)
    return problem.beyond_bound(request.target) or problem.arm_too_short(request.target) is not None


def _held_inside(problem: Problem, found: SearchEnd) -> SearchEnd:
    """Return an outcome, as a failure if a held axis is outside its limits."""
    if problem.held_beyond and found.outcome == rules.OK:
        return found._replace(outcome=rules.LIMITS)
    return found


def result_of(problem: Problem, target: Matrix, found: SearchEnd, options: IkOptions) -> IkResult:
    """Return the outcome of a search as a result, with the reason of a failure."""
    outcome, iterations, restarts, distance, angle, y, _ = found
    axes, task, labels = problem.shown(y), problem.task, problem.mechanism.labels
    if outcome == rules.OK:
        return quick_result(True, axes, "ok", distance, angle, iterations, restarts, task, labels)
    reason, status = reason_of(problem, target, found, options, find), STATUSES[outcome]
    violated: tuple[str, ...] = ()
    if outcome == rules.LIMITS:
        violated = problem.mechanism.limits.violated(axes if problem.held_beyond else problem.shown(found.outside))
    return IkResult(False, axes, status, distance, angle, iterations, restarts, task, labels, reason, violated)
