"""Every solver of the benchmark behind one shape: target (4, 4) and start → answer or None, in its own units.

Where a peer makes one attempt a call, it gets random restarts like the others. Nobody's answer is believed: what
counts as found is decided by `measure.judge`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pinocchio as pin

from chainbuild.ik.request import IkOptions
from tests.bench.machines import Machine

Solver = Callable[[np.ndarray, np.ndarray | None], np.ndarray | None]

RESTARTS = 100


def ours(machine: Machine, *, compiled: bool) -> Solver:
    robot, options = machine.robot, IkOptions(compiled=compiled)

    def solve(T: np.ndarray, start: np.ndarray | None) -> np.ndarray | None:
        found = robot.ik(T, start, options=options)
        return found.axes if found.success else None

    return solve


def toolbox(machine: Machine) -> Solver:
    """roboticstoolbox: ik_LM, C++, Chan's damping; its tolerance is half the squared error."""
    import roboticstoolbox as rtb

    chain, ets = machine.robot.chain, rtb.ETS()
    for joint in chain.joints:
        axis = int(np.argmax(np.abs(joint.direction)))
        kinds = (rtb.ET.tx, rtb.ET.ty, rtb.ET.tz) if joint.kind == "prismatic" else (rtb.ET.Rx, rtb.ET.Ry, rtb.ET.Rz)
        ets = ets * rtb.ET.SE3(joint.T_parent_joint) * kinds[axis](flip=bool(joint.direction[axis] < 0))
    ets = rtb.ET.SE3(np.linalg.inv(chain.frame("workpiece").T_link_frame)) * ets
    ets = ets * rtb.ET.SE3(chain.frame("tool").T_link_frame)
    for link, lower, upper in zip(ets.joints(), machine.lower, machine.upper, strict=True):
        link.qlim = [lower, upper]

    def solve(T: np.ndarray, start: np.ndarray | None) -> np.ndarray | None:
        found = ets.ik_LM(T, q0=start, slimit=RESTARTS, tol=5e-13)
        return found.q if found.success else None

    return solve


def optik(machine: Machine) -> Solver:
    """optik: SLSQP on the Lie group, Rust."""
    import optik

    robot = optik.Robot.from_urdf_file(str(machine.urdf), "base", "tool")
    robot.set_parallelism(1)
    config = optik.SolverConfig(max_time=1.0, max_restarts=RESTARTS, tol_f=1e-13, tol_df=-1.0, tol_dx=-1.0)
    middle = (machine.lower + machine.upper) / 2.0

    def solve(T: np.ndarray, start: np.ndarray | None) -> np.ndarray | None:
        found = robot.ik(config, T, middle if start is None else start)
        return None if found is None else np.array(found[0])

    return solve


def dynibo(machine: Machine) -> Solver:
    """dynibo: damped least squares, Rust; one attempt a call."""
    import dynibo

    robot = dynibo.Robot.from_urdf(str(machine.urdf))
    tool, options = robot.link_id("tool"), dynibo.IkOptions(max_iterations=60)
    rng = np.random.default_rng(0)

    def solve(T: np.ndarray, start: np.ndarray | None) -> np.ndarray | None:
        pose = dynibo.Pose(tuple(T[:3, 3]), tuple(pin.Quaternion(T[:3, :3]).coeffs()))
        for attempt in range(RESTARTS):
            q = start if attempt == 0 and start is not None else rng.uniform(machine.lower, machine.upper)
            try:
                found = robot.inverse_kinematics(q, tool, pose, options)
            except dynibo.SolverError:
                continue
            found = into_limits(machine, np.asarray(found))
            if found is not None:
                return found
        return None

    return solve


def trac_ik(machine: Machine) -> Solver:
    """TRAC-IK through pytracik: KDL and SQP side by side, C++."""
    from trac_ik import TracIK

    solver = TracIK("base", "tool", str(machine.urdf), timeout=0.05, epsilon=5e-7)
    rng = np.random.default_rng(0)

    def solve(T: np.ndarray, start: np.ndarray | None) -> np.ndarray | None:
        q = rng.uniform(machine.lower, machine.upper) if start is None else start
        found = solver.ik(T[:3, 3], T[:3, :3], q)
        return None if found is None else np.asarray(found)

    return solve


def pink(machine: Machine) -> Solver:
    """pink: a quadratic programme a step on Pinocchio (daqp), with restarts."""
    import pink as library
    from pink.tasks import FrameTask

    model = pin.buildModelFromUrdf(str(machine.urdf))
    data, rng = model.createData(), np.random.default_rng(0)
    task = FrameTask("tool", position_cost=1.0, orientation_cost=1.0, lm_damping=1e-3)

    def attempt(q: np.ndarray, T: pin.SE3) -> np.ndarray | None:
        configuration = library.Configuration(model, data, q)
        task.set_target(T)
        for _ in range(60):
            error = task.compute_error(configuration)
            if np.linalg.norm(error) < 1e-7:
                return configuration.q
            velocity = library.solve_ik(configuration, [task], 1.0, solver="daqp")
            configuration.integrate_inplace(velocity, 1.0)
        return None

    def solve(T: np.ndarray, start: np.ndarray | None) -> np.ndarray | None:
        pose = pin.SE3(T)
        for n in range(20):
            q = start if n == 0 and start is not None else rng.uniform(machine.lower, machine.upper)
            try:
                found = attempt(q, pose)
            except Exception:  # a failed programme counts as a failed attempt, whatever its solver calls it
                continue
            if found is not None:
                return found
        return None

    return solve


def mink(machine: Machine) -> Solver:
    """mink: a quadratic programme a step on MuJoCo (daqp), with restarts."""
    import mink as library
    import mujoco

    spec = mujoco.MjSpec.from_file(str(machine.urdf))
    spec.compiler.fusestatic = False  # else the tool is no body
    spec.compiler.boundmass, spec.compiler.boundinertia = 1e-3, 1e-6  # MuJoCo takes no massless bodies
    model = spec.compile()
    configuration, rng = library.Configuration(model), np.random.default_rng(0)
    task = library.FrameTask("tool", "body", position_cost=1.0, orientation_cost=1.0, lm_damping=1e-3)
    limits = [library.ConfigurationLimit(model)]

    def attempt(q: np.ndarray) -> np.ndarray | None:
        configuration.update(q)
        for _ in range(60):
            if np.linalg.norm(task.compute_error(configuration)) < 1e-7:
                return configuration.q.copy()
            velocity = library.solve_ik(configuration, [task], 1.0, solver="daqp", limits=limits)
            configuration.integrate_inplace(velocity, 1.0)
        return None

    def solve(T: np.ndarray, start: np.ndarray | None) -> np.ndarray | None:
        task.set_target(library.SE3.from_matrix(T))
        for n in range(20):
            q = start if n == 0 and start is not None else rng.uniform(machine.lower, machine.upper)
            try:
                found = attempt(q)
            except library.MinkError:  # a failed programme counts as a failed attempt
                continue
            if found is not None:
                return found
        return None

    return solve


def into_limits(machine: Machine, q: np.ndarray) -> np.ndarray | None:
    """Move joints by whole turns into their limits; None where that is not possible."""
    q = q - 2.0 * np.pi * np.ceil((q - machine.upper - 1e-9) / (2.0 * np.pi))
    q = q + 2.0 * np.pi * np.ceil((machine.lower - q - 1e-9) / (2.0 * np.pi))
    return q if (q <= machine.upper + 1e-9).all() else None


PEERS: dict[str, Callable[[Machine], Solver]] = {
    "roboticstoolbox ik_LM": toolbox,
    "chainbuild, compiled": lambda machine: ours(machine, compiled=True),
    "chainbuild, plain": lambda machine: ours(machine, compiled=False),
    "dynibo + restarts": dynibo,
    "optik": optik,
    "TRAC-IK (pytracik)": trac_ik,
    "pink (daqp)": pink,
    "mink (daqp)": mink,
}
SLOW = {"pink (daqp)", "mink (daqp)"}
IN_AXES = {"chainbuild, compiled", "chainbuild, plain"}  # start and answer in mm and degrees; the others: joint values


def solvers(machine: Machine) -> Iterator[tuple[str, Solver]]:
    """Yield the solvers that are installed and take the machine; the others are named."""
    for name, make in PEERS.items():
        try:
            yield name, make(machine)
        except ImportError as error:
            print(f"skipped: {name} ({error.name} is not installed)")
        except Exception as error:
            print(f"skipped: {name} on {machine.name} ({type(error).__name__}: {error})")
