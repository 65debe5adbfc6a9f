"""What is measured: cold and warm single poses, batches, refusals, a path through a wrist singularity."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

import chainbuild
from tests.bench.machines import Machine
from tests.bench.peers import IN_AXES, SLOW, Solver, solvers

TOLERANCE = 1e-6  # m and rad


@dataclass(frozen=True)
class Row:
    """One solver on one machine: cold median and 95th percentile, share found, wrong answers, warm median [µs]."""

    machine: str
    solver: str
    median: float
    p95: float
    found: float
    wrong: int
    warm: float


def compare(machine: Machine, count: int, rounds: int) -> list[Row]:
    """Run all solvers over the same targets, one after the other in each round; medians over rounds."""
    axes = machine.axes(count, seed=1)
    targets = [np.ascontiguousarray(T) for T in machine.robot.fk_batch(axes)]
    near = [np.clip(machine.robot.q(row) + 0.01, machine.lower + 1e-6, machine.upper - 1e-6) for row in axes]
    near_axes = [machine.robot.axes_from_q(q) for q in near]
    known = dict(solvers(machine))
    for solve in known.values():  # the first call compiles and fills tables
        solve(targets[0], None)
    times: dict[str, list[tuple[float, float, float]]] = {name: [] for name in known}
    answers: dict[str, list[np.ndarray | None]] = {}
    for _ in range(rounds):
        for name, solve in known.items():
            some = targets[: max(20, count // 10)] if name in SLOW else targets
            cold, answers[name] = clock(solve, some, [None] * len(some))
            warm, _ = clock(solve, some, (near_axes if name in IN_AXES else near)[: len(some)])
            times[name].append((float(np.median(cold)), float(np.percentile(cold, 95)), float(np.median(warm))))
    rows = []
    for name, found in answers.items():
        median, p95, warm = np.median(times[name], axis=0)
        joints = [machine.robot.q(a) if name in IN_AXES and a is not None else a for a in found]
        good = [q is not None and judge(machine, q, T) for q, T in zip(joints, targets, strict=False)]
        wrong = sum(q is not None for q in found) - sum(good)
        rows.append(Row(machine.name, name, float(median), float(p95), sum(good) / len(found), wrong, float(warm)))
    return rows


def clock(
    solve: Solver, targets: list[np.ndarray], starts: list[np.ndarray | None] | list[None]
) -> tuple[list[float], list[np.ndarray | None]]:
    """Return the time of each call in µs, and the answers."""
    times, answers = [], []
    for target, start in zip(targets, starts, strict=True):
        begin = time.perf_counter()
        answer = solve(target, start)
        times.append((time.perf_counter() - begin) * 1e6)
        answers.append(answer)
    return times, answers


def judge(machine: Machine, q: np.ndarray, target: np.ndarray) -> bool:
    """Return whether joint values keep the limits and meet a pose, by Pinocchio."""
    T = machine.robot.kinematics.pose(np.asarray(q, dtype=float))
    distance = np.linalg.norm(T.translation - target[:3, 3])
    angle = np.linalg.norm(pin.log3(T.rotation.T @ target[:3, :3]))
    inside = (q >= machine.lower - 1e-9).all() and (q <= machine.upper + 1e-9).all()
    return bool(inside and distance <= TOLERANCE and angle <= TOLERANCE)


def per_item(work: Callable[[], object], count: int, rounds: int = 3) -> float:
    """Return the least time of one of `count` items over some rounds, in µs."""
    work()
    times = []
    for _ in range(rounds):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return min(times) / count * 1e6


def batches(machine: Machine, count: int) -> dict[str, float]:
    """Return µs a pose of batches: forward kinematics, cold inverse on one core, a path."""
    import numba

    robot, axes = machine.robot, machine.axes(count, seed=2)
    T = robot.fk_batch(axes)
    cores, path = numba.config.NUMBA_NUM_THREADS, straight(machine, 2000)
    numba.config.NUMBA_NUM_THREADS = 1
    found = {
        "forward, NumPy": per_item(lambda: robot.fk_batch(axes), count),
        "inverse, cold, one core": per_item(lambda: robot.ik_batch(T), count),
        "inverse along a path": per_item(lambda: robot.ik_path(*path), len(path[0])),
        **clear_blocks(machine, min(count, 20_000)),
    }
    numba.config.NUMBA_NUM_THREADS = cores
    return found


def clear_blocks(machine: Machine, count: int) -> dict[str, float]:
    """Return µs a block of a path that stays clear of singularities and limits: straight axes, and lines of the tip."""
    share = np.linspace(0.0, 300.0, count + 1)[:, None]
    waves = np.sin(share * [0.9, 1.1, 0.8, 1.2, 0.7, 1.3, 1.0][: len(machine.lower)])
    for centre in machine.axes(500, seed=7):
        rows = centre + 2.0 * waves  # degrees
        few = chainbuild.path_report(machine.robot, rows[::10])
        if few.proven and not few.stretches and not few.violations:
            break
    else:
        return {}
    found = {}
    for kind, between in (("clear block, straight axes", "ptp"), ("clear block, line", "cp")):
        if not chainbuild.path_report(machine.robot, rows[:3], between=between).proven:
            continue
        found[kind] = per_item(lambda b=between: chainbuild.path_report(machine.robot, rows, between=b), count)
    return found


def straight(machine: Machine, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return poses of a straight motion of the axes, and its start."""
    first, last = machine.axes(2, seed=4) * 0.2 + np.mean(machine.axes(1000, seed=5), axis=0) * 0.8
    share = np.linspace(0.0, 1.0, count)[:, None]
    return machine.robot.fk_batch(first + share * (last - first)), first


def refusals(machine: Machine, count: int = 200) -> dict[str, float]:
    """Return the median time in ms that refusing a pose takes: too far away, and turned in a way that cannot be."""
    robot, rng = machine.robot, np.random.default_rng(6)
    T = robot.fk_batch(machine.axes(5000, seed=6))
    centre = T[:, :3, 3].mean(axis=0)
    distance = np.linalg.norm(T[:, :3, 3] - centre, axis=1)
    far, turned = T[:count].copy(), T[np.argsort(-distance)[: 3 * count]].copy()
    outward = (far[:, :3, 3] - centre) / distance[:count, None]
    far[:, :3, 3] = centre + outward * distance.max() * rng.uniform(1.05, 1.5, (count, 1))
    for pose in turned:
        pose[:3, :3] = pin.exp3(rng.uniform(-np.pi, np.pi, 3))
    turned = turned[~robot.ik_batch(turned).success][:count]
    result = {}
    for name, poses in (("beyond reach", far), ("orientation impossible", turned)):
        times, found = [], []
        for pose in poses:
            begin = time.perf_counter()
            found.append(robot.ik(pose).success)
            times.append(time.perf_counter() - begin)
        assert not any(found)
        result[name] = float(np.median(times)) * 1e3
    return result
