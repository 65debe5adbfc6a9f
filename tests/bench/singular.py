"""A path through a wrist singularity: our largest step against the best that a dense search over branches finds.

The search knows every branch of every pose with every whole turn, and chooses the sequence whose largest step of any
axis is smallest (dynamic programming over the whole path): no tracker can do better. On a robot whose control keeps the
pose status along a path, so does the search.
"""

from __future__ import annotations

import numpy as np

from chainbuild.ik.branches.status_turn import has_status, status_and_decided
from tests.bench.machines import Machine


def passes(machine: Machine, count: int = 12, points: int = 81) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return straight lines of the tool, orientation constant, that pass a wrist singularity; with starts."""
    robot, rng, found = machine.robot, np.random.default_rng(8), []
    while len(found) < count:
        axes = machine.axes(1, seed=int(rng.integers(1 << 30)))[0] * 0.6
        axes[4] = rng.choice([0.0, 0.05, 0.5, 2.0])  # degrees from the singularity in the middle of the line
        middle = robot.fk(axes).homogeneous
        direction = rng.normal(size=3)
        direction *= 0.1 / np.linalg.norm(direction)
        poses = np.repeat(middle[None], points, axis=0)
        poses[:, :3, 3] += np.linspace(-1.0, 1.0, points)[:, None] * direction
        if robot.ik_batch(poses).success.all():
            found.append((poses, robot.ik(poses[0], axes).axes))
    return found


def largest_steps(machine: Machine) -> tuple[list[float], list[float]]:
    """Return for each path our largest step and the smallest possible one, in degrees."""
    ours, best = [], []
    for poses, start in passes(machine):
        found = machine.robot.ik_path(poses, start)
        assert found.success.all()
        ours.append(float(np.abs(np.diff(found.axes, axis=0, prepend=start[None])).max()))
        best.append(min(ours[-1], least_largest_step(machine, poses, start)))
    return ours, best


def least_largest_step(machine: Machine, poses: np.ndarray, start: np.ndarray) -> float:
    """Return the smallest largest step over all sequences of branches from the start on."""
    layer, cost = start[None], np.zeros(1)
    for pose in poses:
        following = keeping(machine, branches(machine, pose, layer), start)
        steps = np.abs(following[:, None] - layer[None]).max(axis=2)
        cost = np.maximum(steps, cost[None]).min(axis=1)
        layer = following
    return float(cost.min())


def branches(machine: Machine, pose: np.ndarray, before: np.ndarray) -> np.ndarray:
    """Return all solutions with all whole turns; in the singularity itself also those that keep axis 4 or 6."""
    robot = machine.robot
    found = [b.axes for b in robot.ik_all(pose, windings=True)]
    for row in before:
        near = robot.ik(pose, row)
        if near.success:
            found.append(near.axes)
    return np.unique(np.round(np.array(found), 7), axis=0)


def keeping(machine: Machine, found: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Return the solutions with the pose status of the start, where there are some and the control keeps it."""
    if not has_status(machine.robot):
        return found
    bits, decided = status_and_decided(machine.robot, np.vstack([start, found]))
    same = ((bits[1:] ^ bits[0]) & decided[1:] & decided[0]) == 0
    return found[same] if same.any() else found


def report(machine: Machine) -> str:
    ours, best = largest_steps(machine)
    ratio = np.array(ours) / np.array(best)
    return f"{machine.name}: {len(ours)} paths, largest step {max(ours):.1f}°, worst ratio {ratio.max():.2f}"
