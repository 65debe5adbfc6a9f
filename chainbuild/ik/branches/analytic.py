"""Every branch of a pose: closed forms, the elimination where six joints have none, damped descents for the rest."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Final, Literal
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild.chain.elements import Task
from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.arms.arms import ArmName, ArmSolver, arm_solver
from chainbuild.ik.branches.arms.spin import ToolAxis, despun, first_joints, one_axis, with_idle, with_spin
from chainbuild.ik.branches.core.axis_values import axes_for
from chainbuild.ik.branches.core.branches import Branch, Found, collect
from chainbuild.ik.branches.core.query import Query
from chainbuild.ik.branches.core.serial import Serial
from chainbuild.ik.branches.direct import find_direct, query_is_direct
from chainbuild.ik.branches.elimination.eaik_arm import eaik_solver
from chainbuild.ik.branches.elimination.elimination import JOINTS, elimination
from chainbuild.ik.branches.gather import gather
from chainbuild.ik.branches.status_turn import has_status, status_turn
from chainbuild.ik.result import IkResult
from chainbuild.ik.start import Held
from chainbuild.kinematics.mechanism import as_pose

if TYPE_CHECKING:
    import pinocchio as pin

    from chainbuild.kinematics.mechanism import Robot

Vector = NDArray[np.float64]
Method = ArmName | Literal["direct", "EAIK", "elimination", "restarts"]

_MOST_IDLE: Final = 2
_ROWS = {"pose": 6, "direction": 5, "position": 3}
_solvers: WeakKeyDictionary[Serial, tuple[Method, ArmSolver | None]] = WeakKeyDictionary()


def ik_all(
    robot: Robot,
    T: pin.SE3 | ArrayLike,
    start: ArrayLike | None = None,
    held: Held | None = None,
    *,
    windings: bool = False,
) -> tuple[Branch, ...]:
    """Return every branch of a pose inside all limits, nearest to the start first, each verified by forward kinematics.

    Args:
        robot: The robot.
        T: Tool in the workpiece frame [m]: `pin.SE3` or (4, 4).
        start: Axis values (n_axes,), mm and degrees; None: near the middle of the limits. Axes that a singular pose
            leaves free keep theirs.
        held: See `Robot.ik`.
        windings: True: every whole turn within the limits counts as a branch of its own, not only the nearest.

    Raises:
        ChainbuildError: T is no rigid transform, or the robot has more axes than its task determines.
    """
    query = Query.of(robot, as_pose(T), start, held, windings)
    # Held axes are no branch's business: outside their limits there is no branch at all.
    return tuple(branch for branch in find_all(query).branches if not robot.violated_limits(branch.axes))


def find_all(query: Query) -> Found:
    """Return the branches of a query by the best method there is."""
    method, solver = _method(query)
    if method == "direct":
        found = find_direct(query)
    elif solver is not None:
        found = collect(query, _arm_candidates(query, solver))
    else:
        _refuse_redundant(query)
        found = collect(query, ((x, ()) for x in gather(query)))
    return replace(found, branches=tuple(_finished(query.robot, branch, method) for branch in found.branches))


def method_of(robot: Robot, held: Held | None = None) -> Method:
    """Return how `ik_all` answers for a robot.

    The name of a closed form; "EAIK"; "elimination": all six joints at once, as the eigenvalues of one matrix;
    "restarts": damped descents, the only answer that may miss a branch.
    """
    return _method(Query.of(robot, as_pose(np.eye(4)), None, held))[0]


def solve_analytic(
    robot: Robot, T: pin.SE3 | ArrayLike, start: ArrayLike | None = None, held: Held | None = None
) -> IkResult:
    """Return the branch nearest to the start, by a closed form or the elimination.

    Raises:
        ChainbuildError: neither knows the robot.
    """
    found = in_closed_form(robot, T, start, held)
    if found is None:
        raise ChainbuildError(
            "no closed form is known for this kinematic",
            parameter="solver",
            permitted="auto, damped",
            hint="where more axes are free than the pose determines, hold some",
        )
    return found


def in_closed_form(
    robot: Robot, T: pin.SE3 | ArrayLike, start: ArrayLike | None = None, held: Held | None = None
) -> IkResult | None:
    """Return what `solve_analytic` does, or None where it knows no closed form."""
    query = Query.of(robot, as_pose(T), start, held)
    if _method(query)[0] == "restarts":
        return None
    found = find_all(query)
    if found.branches:
        return found.branches[0]
    axes = query.x0 / robot.kinematics.si_factors
    if found.beyond is not None:
        reason = f"only reached outside the limits of {', '.join(found.outside)}"
        return replace(found.beyond, success=False, status="limits", reason=reason)
    distance, angle = robot.kinematics.errors(query.x0, query.target, robot.task)
    reason = "no branch of the closed form reaches the pose"
    return IkResult(False, axes, "unreachable", distance, angle, 0, 0, robot.task, reason)


def _method(query: Query) -> tuple[Method, ArmSolver | None]:
    if query.robot.chain.loops:
        return "restarts", None
    if query_is_direct(query):
        return "direct", None
    serial = query.serial()
    if serial not in _solvers:
        _solvers[serial] = _arm(serial, query.robot.task, query.robot.chain.tool_axis)
    return _solvers[serial]


def _arm(serial: Serial, task: Task, tool_axis: ToolAxis) -> tuple[Method, ArmSolver | None]:
    if task == "pose":
        return _whole_pose(serial)
    if task == "direction" and len(serial.screws) < JOINTS:
        return _position_and_direction(serial, tool_axis)
    return arm_solver(serial, task) or ("restarts", None)


def _position_and_direction(serial: Serial, tool_axis: ToolAxis) -> tuple[Method, ArmSolver | None]:
    axis = one_axis(serial)
    if axis is not None:
        known = arm_solver(serial, "direction")
        if known is not None:
            return known[0], despun(known[1], serial, tool_axis, axis)
    method, solver = _whole_pose(with_spin(serial, tool_axis))
    return method, None if solver is None else first_joints(solver, len(serial.screws), len(serial.screws) + 1)


def _whole_pose(serial: Serial) -> tuple[Method, ArmSolver | None]:
    known = arm_solver(serial, "pose")
    if known is not None:
        return known
    count = len(serial.screws)
    solver = elimination(with_idle(serial, JOINTS - count)) if JOINTS - _MOST_IDLE <= count <= JOINTS else None
    eliminating = None if solver is None else first_joints(solver.solve, count, JOINTS)
    through_eaik = eaik_solver(serial, eliminating)
    if through_eaik is not None:
        return "EAIK", through_eaik
    return ("restarts", None) if eliminating is None else ("elimination", eliminating)


def _arm_candidates(query: Query, solver: ArmSolver) -> Iterator[tuple[Vector, tuple[str, ...]]]:
    joints = np.array([screw.joint for screw in query.serial().screws], dtype=np.intp)
    keep = query.q0[joints].tolist()
    free_axes = query.structure.free
    for values, free in solver(query.target.homogeneous, keep):
        for x in axes_for(query, joints, values, free_axes):
            yield x, query.axis_names(query.loose_axes(joints, free, free_axes))


def _refuse_redundant(query: Query) -> None:
    """Refuse a chain whose branches are no points but curves."""
    free, task = query.structure.free, query.robot.task
    if len(free) <= _ROWS[task]:
        return
    names = ", ".join(query.axis_names(free))
    raise ChainbuildError(
        f"{len(free)} axes are free and the pose determines {_ROWS[task]}: there is no end of solutions",
        parameter="held",
        permitted=f"{len(free) - _ROWS[task]} of {names} held",
    )


def _finished(robot: Robot, branch: Branch, method: Method) -> Branch:
    if not has_status(robot):
        return replace(branch, method=method)
    status, turn = status_turn(robot, branch.axes)
    return replace(branch, method=method, status_bits=status, turn_bits=turn)
