"""The solver of a mechanism's poses while some axes are held: its name, reason and completeness."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Final, Literal

import numpy as np

from chainbuild.arrays import Matrix
from chainbuild.chain.elements import Task
from chainbuild.ik.branches.arms.arms import ARMS, ArmName, arm_solver
from chainbuild.ik.branches.arms.parallel_axes import ParallelArm, parallel_arm
from chainbuild.ik.branches.arms.three_parallel import ThreeParallelAxes
from chainbuild.ik.branches.arms.virtual_joints import (
    common_rotary_axis,
    first_joints,
    orientation_from_chain,
    with_spin_joint,
    with_virtual_joints,
)
from chainbuild.ik.branches.closed import is_posed, opened_query
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.core.serial import ArmSolver, Serial, Solution
from chainbuild.ik.branches.direct import query_is_direct
from chainbuild.ik.branches.elimination.elimination import JOINTS, elimination
from chainbuild.ik.request import IkRequest
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.shown import two_lines

PlanName = ArmName | Literal["direct", "three parallel axes", "elimination", "struts", "search"]

TASK_ROWS: Final[Mapping[Task, int]] = {"pose": 6, "direction": 5, "position": 3}  # freedoms that a task determines
_MAX_VIRTUAL_JOINTS: Final = 2  # chains of fewer than four joints are left to the search
_MAX_PREPARED: Final = 64  # every value of a held axis makes another chain
_REASONS: Final[Mapping[str, str]] = {
    **ARMS,
    "direct": "three independent linear axes: the rotary axes give the orientation, the linear ones the position",
    "three parallel axes": "the axes beside three parallel ones are found first, then a planar arm of two links",
    "elimination": "six joints without a special structure: all solutions as eigenvalues of one matrix",
}


@dataclass(frozen=True, slots=True, eq=False)
class SolverPlan:
    """The solver that finds every branch of a pose, chosen once for each set of held axes.

    Attributes:
        name: "direct", "spherical wrist", "single wrist axis", "parallel arm", "position", "three parallel axes",
            "elimination", "struts" (closed loops), or "search": damped descents from many starts.
        reason: Why, in words.
        complete: True if all branches follow from equations, so that none is missing but by rounding where branches
            meet; False if they are only searched for.
    """

    name: PlanName
    reason: str
    complete: bool
    solver: ArmSolver | None = field(default=None, repr=False)

    def __repr__(self) -> str:
        how = "every branch" if self.complete else "searched for"
        return two_lines(f"<SolverPlan {self.name} ({how}): {self.reason}>")


def plan_of(mechanism: Mechanism, held: Mapping[str, float] | Iterable[str] = ()) -> SolverPlan:
    """Return the plan of a mechanism; see `Robot.plan`."""
    names = (held,) if isinstance(held, str) else held
    values = names if isinstance(names, Mapping) else dict.fromkeys(names, 0.0)
    return plan_for(BranchQuery.of(IkRequest(mechanism, np.eye(4), held=values)))


def plan_for(query: BranchQuery) -> SolverPlan:
    """Return the plan of a query, chosen at the first one of its kind."""
    if query.mechanism.chain.loops:
        if is_posed(query):
            return SolverPlan(
                "struts", "closed loops, each axis by itself; before that the tilt that the guide permits", True
            )
        opened = opened_query(query)
        if opened is None or not (known := plan_for(opened)).complete:
            return _searched("the chain has closed loops")
        return SolverPlan("struts", f"closed loops, each axis by itself; before that {known.reason}", True)
    if query_is_direct(query):
        return _complete("direct")
    serial = query.serial()
    return query.mechanism.prepared("plan", lambda: _chosen(query, serial), serial, _MAX_PREPARED)


def _complete(name: PlanName, solver: ArmSolver | None = None) -> SolverPlan:
    return SolverPlan(name, _REASONS[name], True, solver)


def _searched(reason: str) -> SolverPlan:
    return SolverPlan("search", f"{reason}: branches are searched for", False)


def _chosen(query: BranchQuery, serial: Serial) -> SolverPlan:
    task, count = query.mechanism.task, len(serial.screws)
    if task == "pose":
        found = _for_pose(serial)
    elif task == "direction" and count < JOINTS:
        found = _for_direction(query, serial)
    else:
        known = arm_solver(serial, task)
        found = None if known is None else _complete(*known)
    if found is not None:
        return found
    free = len(query.structure.free)
    if free > TASK_ROWS[task]:
        return _searched(f"{free} axes are free but the task determines only {TASK_ROWS[task]}")
    return _searched(f"no closed form is known for {count} joints in this arrangement")


def _for_direction(query: BranchQuery, serial: Serial) -> SolverPlan | None:
    """Return a plan for position and tool direction, with the rotation about the tool vector as one more joint."""
    column, axis = query.mechanism.chain.tool_column, common_rotary_axis(serial)
    known = None if axis is None else arm_solver(serial, "direction")
    if axis is not None and known is not None:
        return _complete(known[0], orientation_from_chain(known[1], serial, column, axis))
    found = _for_pose(with_spin_joint(serial, column))
    if found is None or found.solver is None:
        return None
    return _complete(found.name, first_joints(found.solver, len(serial.screws), len(serial.screws) + 1))


def _for_pose(serial: Serial) -> SolverPlan | None:
    known = arm_solver(serial, "pose")
    if known is not None:
        return _complete(*known)
    parallels = parallel_arm(serial)
    if parallels is not None:
        return _complete("three parallel axes", _helped_out(parallels, serial))
    eliminating = _eliminating(serial)
    return None if eliminating is None else _complete("elimination", eliminating)


def _eliminating(serial: Serial) -> ArmSolver | None:
    count = len(serial.screws)
    if not JOINTS - _MAX_VIRTUAL_JOINTS <= count <= JOINTS:
        return None
    solver = elimination(with_virtual_joints(serial, JOINTS - count))
    return None if solver is None else first_joints(solver.solve, count, JOINTS)


def _helped_out(arm: ParallelArm, serial: Serial) -> ArmSolver:
    """Return the solver of three parallel axes, helped out by elimination where solutions may be missing."""
    closed_form, otherwise = ThreeParallelAxes(arm), cache(lambda: _eliminating(serial))

    def solve(target: Matrix, keep: Sequence[float]) -> list[Solution]:
        found, doubtful = closed_form.solve(target, keep)
        helper = otherwise() if doubtful else None
        return found if helper is None else found + helper(target, keep)

    return solve
