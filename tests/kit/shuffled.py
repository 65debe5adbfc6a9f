"""The same machine written down in another way: another base and tool, axes reversed, zeros elsewhere."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.elements import Task
from chainbuild.robot import Robot

_BASE_M = 0.8  # how far base and tool are moved at most
_ZERO_DEG = 25.0  # by how much the zeros of rotary axes are moved at most: limits stay within what a turn allows
_ZERO_MM = 150.0


@dataclass(frozen=True)
class Shuffled:
    """A machine and how its axis values and poses follow from those of the original.

    Attributes:
        robot: The machine.
        signs: (n_axes,) -1 where an axis counts the other way.
        zeros: (n_axes,) mm and degrees: the original's values where the shuffled ones are 0.
        base: (4, 4) the new workpiece frame in the old one.
        tool: (4, 4) the new tool frame in the old one.
    """

    robot: Robot
    signs: np.ndarray
    zeros: np.ndarray
    base: np.ndarray
    tool: np.ndarray

    def axes(self, original: np.ndarray) -> np.ndarray:
        """Return the axis values (…, n_axes) that stand where the original's do."""
        return self.signs * (original - self.zeros)

    def pose(self, original: np.ndarray) -> np.ndarray:
        """Return the pose (4, 4) that the machine has where the original has one."""
        return np.linalg.inv(self.base) @ original @ self.tool


def shuffled(robot: Robot, rng: np.random.Generator) -> Shuffled:
    """Return a machine with a random base, tool, signs and zeros; the tool moves as far as its task lets it."""
    chain = robot.chain
    assert isinstance(chain.axis_map, AffineMap)
    rotary = np.array([axis.kind == "rotary" for axis in chain.axes])
    signs = rng.choice([-1.0, 1.0], len(chain.axes))
    zeros = np.where(rotary, _ZERO_DEG, _ZERO_MM) * rng.uniform(-1.0, 1.0, len(chain.axes))
    base, tool = _placed(rng, "pose", 0), _placed(rng, robot.task, chain.tool_column)
    frames = tuple(
        replace(frame, T_link_frame=frame.T_link_frame @ {"tool": tool, "workpiece": base}.get(frame.name, np.eye(4)))
        for frame in chain.frames
    )
    axes = []
    for axis, sign, zero in zip(chain.axes, signs.tolist(), zeros.tolist(), strict=True):
        ends = sorted((sign * (axis.lower - zero), sign * (axis.upper - zero)))
        axes.append(replace(axis, lower=ends[0], upper=ends[1]))
    A, b, factors = chain.axis_map.A, chain.axis_map.b, chain.axis_map.si_factors
    axis_map = AffineMap.of(A * signs, b + A @ (zeros * factors), [axis.kind for axis in chain.axes])
    body = replace(
        chain, frames=frames, axes=tuple(axes), axis_map=axis_map, partials=(), constraints=(), task=robot.task
    )
    return Shuffled(Robot(body), signs, zeros, base, tool)


def _placed(rng: np.random.Generator, task: Task, column: int) -> np.ndarray:
    """Return a random place (4, 4) that changes no solution: along and about the tool vector, or at one point."""
    T, along = np.eye(4), np.eye(3)[column]
    about = Rotation.from_rotvec(rng.uniform(-3.0, 3.0) * along)
    T[:3, :3] = (about if task == "direction" else Rotation.random(random_state=rng)).as_matrix()
    T[:3, 3] = {"pose": 1.0, "direction": along}.get(task, 0.0) * rng.uniform(-_BASE_M, _BASE_M, 3)
    return T
