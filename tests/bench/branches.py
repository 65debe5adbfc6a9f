"""All branches of a pose: closed forms beside each other, one by one and over arrays.

Their answers are joint values, moved into the limits where whole turns do that; what counts is decided by
`measure.judge`, as for the others. What a peer wants to be handed is made before the clock starts.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from chainbuild.comparison.eaik_model import eaik_robot
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.core.serial import Serial
from chainbuild.ik.branches.every import ik_all
from chainbuild.ik.branches.many import ik_all_batch
from chainbuild.ik.branches.opw.parameters import OpwArm, opw_arm
from chainbuild.ik.branches.planar.batch import planar_batch
from chainbuild.ik.plan import plan_of
from chainbuild.ik.request import IkRequest
from tests.bench.machines import Machine
from tests.bench.measure import clock, judge
from tests.bench.peers import into_limits

OPW = "py-opw-kinematics"
OURS = "chainbuild, compiled"
JUDGED = 300  # poses of a batch whose branches are judged


@dataclass(frozen=True)
class BranchSolver:
    """A closed form: pose (4, 4) → what it wants to be handed, → what it answers, → joint values (k, n)."""

    prepare: Callable[[np.ndarray], Any]
    solve: Callable[[Any], Any]
    joints: Callable[[Any], np.ndarray]


@dataclass(frozen=True)
class BranchRow:
    """One closed form on one machine: µs a pose, branches a pose inside the limits, share of poses with one, wrong."""

    machine: str
    solver: str
    median: float
    branches: float
    found: float
    wrong: int


def one_by_one(machine: Machine, count: int) -> list[BranchRow]:
    """Return the cost of one call for each closed form that takes the machine."""
    if len(machine.robot.axes) != 6:
        return []
    targets = [np.ascontiguousarray(T) for T in machine.robot.fk_batch(machine.axes(count, seed=3))]
    rows = []
    for name, solver in solvers(machine):
        handed = [solver.prepare(T) for T in targets]
        solver.solve(handed[0])
        times, answers = clock(lambda x, _, solve=solver.solve: solve(x), handed, [None] * count)
        rows.append(judged(machine, name, float(np.median(times)), targets, [solver.joints(a) for a in answers]))
    return rows


def over_arrays(machine: Machine, count: int) -> list[BranchRow]:
    """Return the cost of all branches of many poses, processor time of one core; [] where no formulas take arrays."""
    robot = machine.robot
    if arm_of(machine) is None and planar_batch(robot, np.eye(4)[None], limits=True, compiled=False) is None:
        return []
    targets = machine.robot.fk_batch(machine.axes(count, seed=3))
    rows = []
    one_core()
    for name, solver in batch_solvers(machine):
        handed = solver.prepare(targets)
        cost = processor_time(lambda solver=solver, handed=handed: solver.solve(handed)) / count * 1e6
        some = targets[:JUDGED]
        answers = solver.joints(solver.solve(solver.prepare(some)))
        rows.append(judged(machine, name, cost, list(some), list(answers)))
    return rows


def judged(machine: Machine, name: str, cost: float, targets: list[np.ndarray], answers: list[np.ndarray]) -> BranchRow:
    """Return a row whose branches are those that keep the limits and meet the pose by Pinocchio."""
    kept, wrong = [], 0
    for target, rows in zip(targets, answers, strict=True):
        inside = [q for q in (into_limits(machine, row) for row in rows if np.isfinite(row).all()) if q is not None]
        good = sum(judge(machine, q, target) for q in inside)
        wrong += len(inside) - good
        kept.append(good)
    return BranchRow(machine.name, name, cost, float(np.mean(kept)), float(np.mean(np.array(kept) > 0)), wrong)


def processor_time(work: Callable[[], object], rounds: int = 5) -> float:
    """Return the least processor time [s] of a piece of work, of the whole process."""
    work()
    times = []
    for _ in range(rounds):
        begin = time.process_time()
        work()
        times.append(time.process_time() - begin)
    return min(times)


def one_core() -> None:
    """Keep compiled code to one core: processor time then is what one core takes, without idle threads in it."""
    try:
        import numba
    except ImportError:
        return
    numba.config.NUMBA_NUM_THREADS = 1


def arm_of(machine: Machine) -> tuple[Serial, OpwArm] | None:
    """Return a machine as screws and as an ortho-parallel arm, or None."""
    serial = BranchQuery.of(IkRequest(machine.robot, np.eye(4))).serial()
    arm = opw_arm(serial)
    return None if arm is None else (serial, arm)


def ours(machine: Machine) -> BranchSolver:
    """`ik_all`, one pose a call."""
    robot = machine.robot
    return BranchSolver(
        lambda T: T,
        lambda T: ik_all(robot, T),
        lambda found: np.array([robot.q(branch.axes) for branch in found]).reshape(-1, 6),
    )


def ours_over_arrays(machine: Machine, *, compiled: bool) -> BranchSolver:
    """`ik_all_batch`."""
    robot = machine.robot

    def joints(axes: np.ndarray) -> np.ndarray:
        rows = axes.reshape(-1, 6)
        q = np.array([robot.q(row) if np.isfinite(row).all() else np.full(6, np.nan) for row in rows])
        return q.reshape(axes.shape)

    return BranchSolver(lambda T: T, lambda T: ik_all_batch(robot, T, compiled=compiled), joints)


def eaik(machine: Machine) -> BranchSolver | None:
    """EAIK: subproblems, C++."""
    import eaik  # noqa: F401 - names the package where it is missing

    serial = BranchQuery.of(IkRequest(machine.robot, np.eye(4))).serial()
    model = eaik_robot(serial)
    if model is None:
        return None

    def prepare(T: np.ndarray) -> np.ndarray:
        pose = T.copy()
        pose[:3, :3] = T[:3, :3] @ serial.M[:3, :3].T
        return pose

    def joints(found: Any) -> np.ndarray:
        rows = np.asarray(found.Q, dtype=float).reshape(-1, 6)
        return rows[~np.asarray(found.is_LS, dtype=bool).reshape(-1)]

    return BranchSolver(prepare, model.IK, joints)


def opw(machine: Machine, *, arrays: bool) -> BranchSolver | None:
    """py-opw-kinematics: the closed form of ortho-parallel arms, Rust; over arrays `reach`, which finds more beside."""
    import py_opw_kinematics
    from scipy.spatial.transform import RigidTransform

    known = arm_of(machine)
    if known is None:
        return None
    arm = known[1]
    model = py_opw_kinematics.Robot(py_opw_kinematics.KinematicModel(**arm.parameters), degrees=False)

    def prepare(T: np.ndarray) -> Any:
        return RigidTransform.from_matrix(np.linalg.inv(arm.T_base_arm) @ T @ np.linalg.inv(arm.T_flange_tool))

    def joints(rows: Any) -> np.ndarray:
        theta = np.asarray(rows, dtype=float)
        values = arm.joints(theta if theta.size else theta.reshape(0, 6))
        return (values + np.pi) % (2.0 * np.pi) - np.pi

    if arrays:
        return BranchSolver(prepare, lambda T: model.reach(T).joints, joints)
    return BranchSolver(prepare, model.inverse, joints)


def solvers(machine: Machine) -> Iterator[tuple[str, BranchSolver]]:
    """Yield the closed forms that are installed and take the machine."""
    yield f"chainbuild ik_all ({plan_of(machine.robot).name})", ours(machine)
    makers = {
        "chainbuild ik_all_batch, compiled, of one pose": lambda: _batch_of_one(machine),
        "EAIK": lambda: eaik(machine),
        OPW: lambda: opw(machine, arrays=False),
    }
    yield from _there(makers)


def batch_solvers(machine: Machine) -> Iterator[tuple[str, BranchSolver]]:
    """Yield what finds all branches over arrays."""
    makers = {
        OURS: lambda: _compiled(machine),
        "chainbuild, NumPy": lambda: ours_over_arrays(machine, compiled=False),
        f"{OPW} (reach, one thread)": lambda: opw(machine, arrays=True),
    }
    yield from _there(makers)


def _batch_of_one(machine: Machine) -> BranchSolver | None:
    if arm_of(machine) is None:
        return None
    whole = _compiled(machine)
    return BranchSolver(lambda T: T[None], whole.solve, lambda axes: whole.joints(axes)[0])


def _compiled(machine: Machine) -> BranchSolver:
    import numba  # noqa: F401 - named where it is missing

    return ours_over_arrays(machine, compiled=True)


def _there(makers: dict[str, Callable[[], BranchSolver | None]]) -> Iterator[tuple[str, BranchSolver]]:
    for name, make in makers.items():
        try:
            solver = make()
        except ImportError as error:
            print(f"skipped: {name} ({error.name} is not installed)")
            continue
        if solver is not None:
            yield name, solver
