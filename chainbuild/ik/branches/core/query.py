"""The question a closed form answers: robot, pose, start, held axes, limits."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild.ik.branches.core.serial import Indices, Serial, Structure, structure_of, unrolled
from chainbuild.ik.limits import freedoms_of
from chainbuild.ik.start import Held, start_point

if TYPE_CHECKING:
    import pinocchio as pin

    from chainbuild.kinematics.mechanism import Robot

Vector = NDArray[np.float64]

LIMIT_SLACK: Final = 1e-9  # a limit [m, rad] is still kept this far beyond it: the answer is rounded


@dataclass(frozen=True, slots=True, eq=False)
class Query:
    """One question: which axis values bring the tool there?

    Attributes:
        robot: The robot.
        target: Tool in the workpiece frame [m].
        x0: (n_axes,) start in SI; held axes stand at their values.
        structure: Which axes are free and what they move.
        lower: (n_axes,) limits in SI, infinite where endless.
        upper: The same.
        periodic: (n_axes,) True where a whole turn of the axis leads to the same pose.
        windings: True: every whole turn within the limits is a branch of its own; False: only the nearest one.
    """

    robot: Robot
    target: pin.SE3
    x0: Vector
    structure: Structure
    lower: Vector
    upper: Vector
    periodic: NDArray[np.bool_]
    windings: bool = False

    @classmethod
    def of(
        cls, robot: Robot, target: pin.SE3, start: ArrayLike | None, held: Held | None, windings: bool = False
    ) -> Query:
        """Build a query; see `Robot.ik` for start and held."""
        x0, fixed = start_point(robot, start, held)
        factors = robot.kinematics.si_factors
        lower = np.array([-math.inf if axis.endless else axis.lower for axis in robot.axes]) * factors
        upper = np.array([math.inf if axis.endless else axis.upper for axis in robot.axes]) * factors
        periodic = freedoms_of(robot).box.periodic
        return cls(robot, target, x0, structure_of(robot, fixed), lower, upper, periodic, windings)

    @property
    def q0(self) -> Vector:
        """Joint values at the start."""
        return self.robot.kinematics.q(self.x0)

    def serial(self) -> Serial:
        """Return the chain as screws, held axes at their values."""
        return unrolled(self.robot, self.q0, self.structure.moving)

    def axis_names(self, indices: Iterable[int]) -> tuple[str, ...]:
        """Return the names of axes."""
        return tuple(self.robot.axes[n].name for n in indices)

    def loose_axes(self, joints: Indices, free: Iterable[bool], columns: Indices) -> list[int]:
        """Return the axes behind joints that are free: for each the one that moves it most."""
        loose = [n for n, is_free in enumerate(free) if is_free]
        if not loose:
            return []
        slopes = np.abs(self.robot.kinematics.dq_dx(self.x0)[np.ix_(joints, columns)])
        return [int(columns[int(np.argmax(slopes[n]))]) for n in loose]

    def outside(self, x: Vector, columns: Indices | None = None) -> tuple[str, ...]:
        """Return the names of the axes, and where no columns are named the coupled limits, that x violates."""
        look = self.structure.free if columns is None else columns
        names = [
            self.robot.axes[n].name
            for n in look
            if not self.lower[n] - LIMIT_SLACK <= x[n] <= self.upper[n] + LIMIT_SLACK
        ]
        if columns is None:
            values = x / self.robot.kinematics.si_factors
            names += [c.name for c in self.robot.chain.constraints if c.margin(values) < -LIMIT_SLACK]
        return tuple(names)

    def distance(self, x: Vector) -> float:
        """Return the distance to the start [m and rad alike]."""
        return float(np.linalg.norm(x - self.x0))
