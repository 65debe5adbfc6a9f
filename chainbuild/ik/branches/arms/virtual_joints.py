"""Virtual joints that bring a task to the form of a solver for six joints.

Five joints reach a position and a direction with some rotation about the tool vector. A sixth joint at the tip, the
*spin*, undoes this rotation, so that the whole pose is reached and every solver for six joints finds all branches.
Fewer joints than the task determines are supplemented by *idle* joints in arbitrary places: the caller verifies all
solutions and keeps those in which the idle joints do not move.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.frames import transform
from chainbuild.ik.branches.arms.positioner import parallel
from chainbuild.ik.branches.core.serial import Screw, Serial
from chainbuild.ik.branches.core.subproblems import rotation, subproblem_1

if TYPE_CHECKING:
    from chainbuild.ik.branches.core.serial import ArmSolver, Solution


NO_JOINT: Final = -1


def common_rotary_axis(serial: Serial) -> Vector | None:
    """Return the direction all rotary axes of a chain have, or None; then a tool direction determines the spin."""
    axes = [screw.direction for screw in serial.screws if screw.kind == "revolute"]
    return axes[0] if axes and all(parallel(axes[0], axis) for axis in axes) else None


def orientation_from_chain(solver: ArmSolver, serial: Serial, column: int, axis: Vector) -> ArmSolver:
    """Return a solver that takes the turn about the tool vector from the chain instead of the target.

    Args:
        solver: A solver of whole poses.
        serial: Its chain.
        column: See `with_spin_joint`.
        axis: What `common_rotary_axis` found.
    """

    def solve(target: Matrix, keep: Sequence[float]) -> list[Solution]:
        turn = subproblem_1(axis, serial.M[:3, column], target[:3, column])
        R = target[:3, :3] if turn.free else rotation(axis, turn.angle) @ serial.M[:3, :3]
        return solver(transform(R, target[:3, 3]), keep)

    return solve


def with_spin_joint(serial: Serial, column: int) -> Serial:
    """Return a chain with one more joint that turns about its tool vector.

    Args:
        serial: The chain as screws.
        column: Which column of the tool frame is the tool vector; see `Chain.tool_column`.
    """
    spin = Screw("revolute", serial.M[:3, column], serial.M[:3, 3], NO_JOINT)
    return Serial((*serial.screws, spin), serial.M)


def with_virtual_joints(serial: Serial, count: int) -> Serial:
    """Return a chain with turns in arbitrary places near its tip, `count` of them."""
    rng = np.random.default_rng(20240229)
    reach = max(
        [float(np.linalg.norm(s.point - serial.M[:3, 3])) for s in serial.screws if s.kind == "revolute"] or [1]
    )
    idle = []
    for _ in range(count):
        direction = rng.normal(size=3)
        point = serial.M[:3, 3] + (reach or 1.0) * rng.uniform(-0.5, 0.5, 3)
        idle.append(Screw("revolute", direction / float(np.linalg.norm(direction)), point, NO_JOINT))
    return Serial((*serial.screws, *idle), serial.M)


def first_joints(solver: ArmSolver, count: int, among: int) -> ArmSolver:
    """Return a solver that answers with the first of its joints only.

    Args:
        solver: A solver of more joints.
        count: How many are wanted.
        among: How many it has.
    """

    def solve(target: Matrix, keep: Sequence[float]) -> list[Solution]:
        found = solver(target, [*keep, *[0.0] * (among - count)])
        return [(values[:count], free[:count]) for values, free in found]

    return solve
