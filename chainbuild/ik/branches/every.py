"""Every branch of a pose: closed forms, elimination for six joints without one, damped descents for the rest."""

from __future__ import annotations

from dataclasses import replace

from numpy.typing import ArrayLike

from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.closed import find_closed, opened_request, unreached_words, usual_branch
from chainbuild.ik.branches.compiled.doubtful.settle import Doubtful
from chainbuild.ik.branches.compiled.quick import quick_branches
from chainbuild.ik.branches.core.branches import Branches, Solutions, collect, named
from chainbuild.ik.branches.core.families import with_families
from chainbuild.ik.branches.core.free_axis import solutions_of, with_free_axes_inside
from chainbuild.ik.branches.core.members import members_inside
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.direct import find_direct
from chainbuild.ik.branches.multistart import multistart_branches
from chainbuild.ik.branches.redundant import REDUNDANT_SAMPLES, Redundant, held_samples, joined_branches
from chainbuild.ik.branches.status_filter import StatusFilter
from chainbuild.ik.branches.status_turn import has_status, status_turn_rows
from chainbuild.ik.plan import TASK_ROWS, SolverPlan, plan_for
from chainbuild.ik.request import Held, IkRequest
from chainbuild.ik.result import IkResult
from chainbuild.kinematics.inputs import Pose
from chainbuild.kinematics.mechanism import Mechanism


def ik_all(
    mechanism: Mechanism,
    T: Pose | ArrayLike,
    start: ArrayLike | None = None,
    held: Held | None = None,
    *,
    windings: bool = False,
    status: int | None = None,
    turn: int | None = None,
    redundant: Redundant | None = None,
    samples: int = REDUNDANT_SAMPLES,
) -> Branches:
    """Return every branch of a pose inside all limits, nearest to the start first; see `Robot.ik_all`."""
    request = IkRequest.of(mechanism, T, start, held)
    if redundant is not None:
        choices = held_samples(mechanism, redundant, samples, held, request.start)
        parts = [ik_all(mechanism, T, start, one, windings=windings, status=status, turn=turn) for one in choices]
        return joined_branches(parts, request.start_point()[0])
    known: Doubtful | None = None
    if status is None and turn is None and not windings:
        found = quick_branches(mechanism, request.target, request.start, held)
        if isinstance(found, Branches):
            return found
        known = found
    query = BranchQuery.of(request, windings)
    if status is not None or turn is not None:
        query = StatusFilter.of(mechanism, status, turn).applied(query)
    return every_branch(query, known).branches


def every_branch(query: BranchQuery, known: Doubtful | None = None) -> Solutions:
    """Return the branches of a query by its plan.

    Args:
        query: The query.
        known: What the compiled form knows of the pose.

    Raises:
        ChainbuildError: more axes are free than the task determines.
    """
    plan = plan_for(query)
    found = _every_solution(query, plan, known)
    is_determined = len(query.structure.free) <= TASK_ROWS[query.mechanism.task]
    if is_determined and not len(found.branches) and found.all_beyond:  # families go on, perhaps to the inside
        members = [(x, ()) for x in members_inside(query, found.all_beyond)]
        found = collect(query, members) if members else found
    branches = with_families(query, found)
    bits = status_turn_rows(query.mechanism, branches.axes) if has_status(query.mechanism) else None
    return replace(found, branches=named(branches, plan.name, bits))


def _every_solution(query: BranchQuery, plan: SolverPlan, known: Doubtful | None = None) -> Solutions:
    """Return the solutions of a query by its plan, several of one family among them."""
    if known is not None and len(known.places) and plan.name == "elimination":
        found = collect(query, ((x, ()) for x in known.places))
        if found.beyond is None:  # else a family may have members inside the limits
            return found
    if plan.name == "direct":
        found = find_direct(query)
    elif plan.name == "struts":
        found = find_closed(query, lambda opened: _every_solution(opened, plan_for(opened)))
    elif plan.solver is not None:
        found = collect(query, with_free_axes_inside(query, solutions_of(plan.solver)))
        if known is not None and not len(found.branches) and found.beyond is None:
            found = collect(query, ((x, ()) for x in (*known.places, *known.near)))
    else:
        _refuse_redundant(query)
        found = collect(query, ((x, ()) for x in multistart_branches(query)))
    return found


def nearest_branch(request: IkRequest, *, explained: bool = True) -> IkResult | None:
    """Return the branch nearest to the start, or a failure; None if the plan only searches.

    Args:
        request: The request.
        explained: False: None as well where compiled code is sure that there is no branch; to say why takes longer.
    """
    quick = quick_branches(request.mechanism, request.target, request.start, request.held)
    if isinstance(quick, Branches) and (len(quick) or not explained):
        return quick[0] if len(quick) else None
    query = BranchQuery.of(request)
    if not plan_for(query).complete:
        return None
    found = every_branch(query)
    if len(found.branches):
        if request.start is None and request.mechanism.chain.loops:
            return usual_branch(request.mechanism, found.branches)
        return found.branches[0]
    if found.beyond is not None:
        reason = f"reached only outside the limits of {', '.join(found.outside)}"
        return replace(found.beyond, success=False, status="limits", reason=reason, violated=found.outside)
    mechanism = request.mechanism
    distance, angle = mechanism.kinematics.errors(query.x0, query.target, mechanism.task)
    reason = "no branch of the closed form reaches the pose"
    if mechanism.chain.loops:
        reason = unreached_words(query, every_branch) or _open_reason(query) or reason
    return IkResult(
        False, query.shown(query.x0), "unreachable", distance, angle, 0, 0, mechanism.task, mechanism.labels, reason
    )


def _open_reason(query: BranchQuery) -> str:
    """Return why the open chain between the tips of closed loops does not reach a pose; empty: it does."""
    from chainbuild.ik.search.solver import search

    request = opened_request(query)
    return "" if request is None else search(request).reason


def no_closed_form(request: IkRequest) -> ChainbuildError:
    """Return the error for a requested closed form that is not known."""
    plan = plan_for(BranchQuery.of(request))
    return ChainbuildError(
        f"no closed form is known for this kinematic: {plan.reason}",
        parameter="solver",
        permitted="auto, damped",
        hint="if more axes are free than the pose determines, hold some",
    )


def _refuse_redundant(query: BranchQuery) -> None:
    """Refuse a chain whose branches are curves instead of points."""
    free, rows = query.structure.free, TASK_ROWS[query.mechanism.task]
    if len(free) <= rows:
        return
    names = ", ".join(query.axis_names(free))
    raise ChainbuildError(
        f"{len(free)} axes are free but the pose determines only {rows}: there are infinitely many solutions",
        parameter="held",
        permitted=f"{len(free) - rows} of {names} held",
    )
