"""The input of closed forms: a request with its structure and its limits."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from chainbuild.arrays import Indices, Vector
from chainbuild.ik.branches.core.serial import AxisStructure, Serial, axis_structure, unrolled
from chainbuild.ik.region import freedoms_of
from chainbuild.ik.request import IkRequest
from chainbuild.kinematics.inputs import Pose
from chainbuild.kinematics.mechanism import Mechanism
from chainbuild.tolerances import LIMIT_SLACK


@dataclass(frozen=True, slots=True, eq=False)
class BranchQuery:
    """One inverse kinematics problem.

    Attributes:
        mechanism: Whose axis values.
        target: Tool in the workpiece frame [m].
        x0: (n_axes,) start in SI; held axes have their values.
        structure: Which axes are free and what they move.
        lower: (n_axes,) limits in SI, infinite where endless.
        upper: The same.
        slack: (n_axes,) how far beyond a limit [m, rad] still counts as inside.
        periodic: (n_axes,) True where a whole turn of the axis leads to the same pose.
        windings: True: every whole turn within the limits is a branch of its own; False: only the nearest one.
        below_zero: Axis → True: of its whole turns only those below zero count; False: only the others.
        keeps: Tells by its axis values (n_axes,), mm and degrees, whether a solution counts; None: all do.
    """

    mechanism: Mechanism
    target: Pose
    x0: Vector
    structure: AxisStructure
    lower: Vector
    upper: Vector
    slack: Vector
    periodic: NDArray[np.bool_]
    windings: bool = False
    below_zero: Mapping[int, bool] = field(default_factory=dict)
    keeps: Callable[[Vector], bool] | None = None

    @classmethod
    def of(cls, request: IkRequest, windings: bool = False) -> BranchQuery:
        """Build the query of a request.

        Raises:
            AxisValueError: held has a wrong number of values, an unknown name or a non-finite value.
            ChainbuildError: the target is not a rigid transform.
        """
        mechanism = request.mechanism
        x0, fixed = request.start_point()
        box = freedoms_of(mechanism).box
        structure = axis_structure(mechanism, fixed)
        slack = LIMIT_SLACK * mechanism.kinematics.si_factors
        return cls(mechanism, request.pose, x0, structure, box.lower, box.upper, slack, box.periodic, windings)

    @property
    def q0(self) -> Vector:
        """Joint values at the start."""
        return self.mechanism.kinematics.q(self.x0)

    def serial(self) -> Serial:
        """Return the chain as screws, held axes at their values."""
        return unrolled(self.mechanism, self.q0, self.structure.moving)

    def shown(self, x: Vector) -> Vector:
        """Return SI axis values (n_axes,) in mm and degrees."""
        values: Vector = x / self.mechanism.kinematics.si_factors
        return values

    def axis_names(self, indices: Iterable[int]) -> tuple[str, ...]:
        """Return the names of axes."""
        return tuple(self.mechanism.axes[n].name for n in indices)

    def undetermined_axes(self, joints: Indices, free: Iterable[bool], columns: Indices) -> list[int]:
        """Return the axes behind joints that are free: for each the one that moves it most."""
        loose = [n for n, is_free in enumerate(free) if is_free]
        if not loose:
            return []
        slopes = np.abs(self.mechanism.kinematics.dq_dx(self.x0)[np.ix_(joints, columns)])
        return [int(columns[int(np.argmax(slopes[n]))]) for n in loose]

    def distance(self, x: Vector) -> float:
        """Return the distance to the start [m and rad alike]."""
        return math.dist(x.tolist(), self.x0.tolist())
