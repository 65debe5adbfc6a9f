"""Inverse kinematics of one pose: all stages, in order.

request → search → (its first success is the answer if no more is requested)
→ answer        the chosen solver; a closed form if the search finds nothing
→ sums          a branch that keeps the limits on sums of axes and on drives
→ four axes     a ROBX robot of four axes: A and B of the pose follow, C counts turns
→ redundancy    the preferred one of infinitely many solutions
→ status        instead of all these where one is programmed: the branch of that pose status and turn
→ last check    every axis on the inner side of its limits, the pose still met
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from chainbuild.errors import ChainbuildError
from chainbuild.ik.request import Held, IkRequest
from chainbuild.ik.result import IkResult
from chainbuild.ik.rules import SOLVERS
from chainbuild.ik.search.solver import certainly_unreachable, search
from chainbuild.ik.verify import on_limits

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from chainbuild.arrays import Vector
    from chainbuild.ik.policies.redundancy import Preference
    from chainbuild.ik.request import IkOptions
    from chainbuild.ik.search.table import IkTable
    from chainbuild.kinematics.inputs import Pose
    from chainbuild.kinematics.mechanism import Mechanism
    from chainbuild.progress import Progress


def solve(
    mechanism: Mechanism,
    T: Pose | ArrayLike,
    start: ArrayLike | None = None,
    held: Held | None = None,
    solver: str = "auto",
    absolute_c_deg: float | None = None,
    prefer: Preference | None = None,
    options: IkOptions | None = None,
    status_turn: tuple[int | None, int | None] = (None, None),
) -> IkResult:
    """Return axis values for a pose; see `Robot.ik`."""
    request, searched = IkRequest.of(mechanism, T, start, held, options), None
    if status_turn != (None, None):
        return checked(request, of_status(request, status_turn, solver, absolute_c_deg, prefer))
    if request.mechanism.chain.loops and solver == "auto":
        # Each axis by itself, exactly; the damped descent would walk from one assembly towards another.
        closed = _complete_answer(request)
        if closed is not None:
            return checked(request, closed)
    if absolute_c_deg is None and solver in {"auto", "damped"}:
        searched = search(request)
        if searched.success and prefer is None:
            return searched  # verified, and inside all limits: most calls end here
    from chainbuild.ik.policies.four_axis import as_programmed
    from chainbuild.ik.policies.redundancy import preferred

    def whole(asked: IkRequest) -> IkResult:
        known = searched if asked is request else None
        return keeping_sums(asked, answer(asked, solver, known), solver)

    request, found = as_programmed(request, whole, absolute_c_deg, from_start=solver == "controller")
    found = preferred(request, found, prefer)
    return checked(request, found)


def solve_many(
    mechanism: Mechanism,
    poses: Sequence[Pose] | ArrayLike,
    start: ArrayLike | None = None,
    held: Held | None = None,
    progress: Progress = False,
    options: IkOptions | None = None,
) -> IkTable:
    """Return axis values for many poses; see `Robot.ik_batch`."""
    from chainbuild.ik.search.batch import solve_batch

    solver = _by_struts if mechanism.chain.loops else None
    return solve_batch(mechanism, poses, start, held, progress, options, solver)


def solve_along(
    mechanism: Mechanism,
    poses: Sequence[Pose] | ArrayLike,
    start: ArrayLike | None = None,
    held: Held | None = None,
    progress: Progress = False,
    options: IkOptions | None = None,
) -> IkTable:
    """Return axis values along a path; see `Robot.ik_path`."""
    if not mechanism.chain.loops:
        from chainbuild.ik.policies.status_path import follow_path

        return follow_path(mechanism, poses, start, held, progress, options)
    from chainbuild.ik.search.batch import solve_batch

    last: Vector | None = None

    def following(request: IkRequest) -> IkResult:
        nonlocal last
        found = _by_struts(request if last is None else request._replace(start=last))
        last = found.axes if found.success else last
        return found

    return solve_batch(mechanism, poses, start, held, progress, options, following)


def _by_struts(request: IkRequest) -> IkResult:
    """Return the answer for a chain with loops: each strut alone where the way between the tips has a closed form."""
    closed = _complete_answer(request)
    return search(request) if closed is None else checked(request, closed)


def of_status(
    request: IkRequest,
    status_turn: tuple[int | None, int | None],
    solver: str,
    absolute_c_deg: float | None,
    prefer: Preference | None,
) -> IkResult:
    """Return the answer for a programmed status and turn.

    Raises:
        ChainbuildError: the kinematic has no such status and turn, or something else chooses the solution, too.
    """
    from chainbuild.ik.policies.status import with_status

    for name, value in (("absolute_c_deg", absolute_c_deg), ("prefer", prefer)):
        if value is not None:
            text = f"{name} and the status both choose the solution"
            raise ChainbuildError(text, parameter=name, permitted=f"status and turn, or {name}")
    return with_status(request, *status_turn, solver, lambda: answer(request, "auto"))


def answer(request: IkRequest, solver: str, searched: IkResult | None = None) -> IkResult:
    """Return a solver's answer; "auto" uses the plan's closed form if the search finds nothing.

    Args:
        request: The request.
        solver: "auto", "damped", "analytic" or "controller".
        searched: The result of the search, if it has run.

    Raises:
        ChainbuildError: an unknown solver, or one that the mechanism does not have.
    """
    if solver not in SOLVERS:
        raise ChainbuildError(f"unknown solver '{solver}'", parameter="solver", permitted=", ".join(SOLVERS))
    if solver == "analytic":
        return _closed_form(request)
    if solver == "controller":
        from chainbuild.ik.policies.controller import solve_controller

        return solve_controller(request)
    found = search(request) if searched is None else searched
    if found.success or solver == "damped" or certainly_unreachable(request):
        return found
    other = _complete_answer(request, explained=False)
    return other if other is not None and other.success else found


def keeping_sums(request: IkRequest, found: IkResult, solver: str) -> IkResult:
    """Return an answer that keeps the limits on sums and drives: the one found, another branch, or a refusal."""
    limits = request.mechanism.limits
    broken = limits.joint_violations(found.axes) if found.success and (limits.sums or limits.curved) else ()
    if not broken:
        return found
    other = _complete_answer(request, explained=False) if solver == "auto" else None
    if other is not None and other.success:
        return other
    reason = f"reached only outside the limits of {', '.join(text for _, text in broken)}"
    return replace(found, success=False, status="limits", reason=reason, violated=tuple(name for name, _ in broken))


def checked(request: IkRequest, found: IkResult) -> IkResult:
    """Return an answer with its axes on the inner side of their limits, or as a failure if they are not."""
    if not found.success:
        return found
    outside = request.mechanism.limits.violations(found.axes)
    if outside:
        reason, violated = "; ".join(text for _, text in outside), tuple(name for name, _ in outside)
        return replace(found, success=False, status="limits", reason=reason, violated=violated)
    moved = on_limits(request.mechanism, request.pose, found.axes, found.task)
    if moved is None:
        return found
    axes, distance, angle = moved
    return replace(found, axes=axes, position_error=distance, rotation_error=angle)


def _complete_answer(request: IkRequest, *, explained: bool = True) -> IkResult | None:
    """Return the branch nearest to the start by the plan's closed form, or a failure; see `every.nearest_branch`."""
    from chainbuild.ik.branches.every import nearest_branch

    return nearest_branch(request, explained=explained)


def _closed_form(request: IkRequest) -> IkResult:
    """Return the answer of the plan's closed form.

    Raises:
        ChainbuildError: the plan has none.
    """
    found = _complete_answer(request)
    if found is None:
        from chainbuild.ik.branches.every import no_closed_form

        raise no_closed_form(request)
    return found
