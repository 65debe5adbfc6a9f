"""The pose in which a page shows a machine first, and how far its axes move it from there."""

from __future__ import annotations

import math
from itertools import pairwise, product
from typing import TYPE_CHECKING, Final

import numpy as np

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.bodies.shapes import machine_size, shown_limits
from chainbuild.chain.elements import Chain
from chainbuild.chain.fold import joint_motion
from chainbuild.chain.poses import link_placements
from chainbuild.errors import ChainbuildError
from chainbuild.kinematics.closure import closing_axes
from chainbuild.kinematics.ranges import range_beside

if TYPE_CHECKING:
    from chainbuild.kinematics.mechanism import Mechanism

_SEED: Final = 5  # the page of a machine does not change
_CLOSING: Final = 40  # states looked at for one in which the loops close well
# Angles a rotary axis may take in the pose shown, degrees.
_CANDIDATES: Final = (0.0, 45.0, -45.0, 90.0, -90.0)
# A pose whose smallest singular value is below this share of the largest looks stretched or folded.
_STRETCHED: Final = 0.05


def swept_poses(robot: Mechanism, rest: Vector) -> list[Vector]:
    """Return axis values (n_axes,), mm and degrees: at rest, then each axis alone at either end of its shown range.

    Ends at which the kinematic has no pose are left out.

    Args:
        robot: The robot.
        rest: (n_axes,) axis values, mm and degrees.
    """
    lower, upper = shown_limits(robot.chain)
    found = [rest]
    for n in range(len(rest)):
        for end in _alone(robot, rest, n, lower[n], upper[n]):
            wanted = rest.copy()
            wanted[n] = end
            if np.isfinite(robot.chain.axis_map.q(wanted)).all():
                found.append(wanted)
    return found


def _alone(robot: Mechanism, rest: Vector, n: int, low: float, high: float) -> tuple[float, float]:
    """Return how far axis n moves of its shown range while the others rest."""
    least, most = range_beside(robot.chain, n, rest) or (rest[n], rest[n])
    return max(low, least), min(high, most)


def rest_pose(robot: Mechanism) -> Vector:
    """Return axis values (n_axes,), mm and degrees, that show a machine well: neither stretched nor below the floor.

    Linear axes are in the middle. Rotary axes are at 0 or as near as their limits allow; if that pose is singular,
    neighbouring pairs bend by the angles that improve it most. Loops that do not close there stand where they close
    best.

    Raises:
        ChainbuildError: the kinematic has no pose there.
    """
    lower, upper = shown_limits(robot.chain, at_middle=True)
    linear = np.array([axis.kind == "linear" for axis in robot.axes])
    pose: Vector = np.where(linear, (lower + upper) / 2, np.clip(np.zeros(len(lower)), lower, upper))
    size = machine_size(robot.chain)
    if robot.chain.loops and not np.isfinite(robot.chain.axis_map.q(pose)).all():
        closing = closing_axes(robot, np.random.default_rng(_SEED), _CLOSING)
        pose = max(closing, key=lambda axes: _evenness(robot, axes, size), default=pose)
    if _evenness(robot, pose, size) > _STRETCHED:
        return pose
    floor = min(0.0, float(_heights(robot, pose).min()))
    best = _score(robot, pose, size, floor)
    free = [n for n, axis in enumerate(robot.axes) if axis.kind == "rotary" and not axis.held]
    for pair in 2 * list(pairwise(free)):
        start = pose
        for angles in product(_CANDIDATES, repeat=2):
            tried = start.copy()
            tried[list(pair)] = angles
            score = _score(robot, tried, size, floor) if ((lower <= tried) & (tried <= upper)).all() else -math.inf
            if score > best + 1e-6:
                pose, best = tried, score
    return pose


def _singular_values(robot: Mechanism, axes: Vector, size: float) -> Vector:
    J = robot.jacobian(axes).copy()
    J[:3] /= size
    return np.asarray(np.linalg.svd(J, compute_uv=False), dtype=np.float64)


def _evenness(robot: Mechanism, axes: Vector, size: float) -> float:
    values = _singular_values(robot, axes, size)
    return float(values[-1] / values[0]) if values[0] > 0 else 0.0


def _score(robot: Mechanism, axes: Vector, size: float, floor: float) -> float:
    try:
        dexterity = float(np.log(np.maximum(_singular_values(robot, axes, size), 1e-3)).sum())
        heights = _heights(robot, axes)
    except ChainbuildError:
        return -math.inf
    bent = float(np.abs(axes[[axis.kind == "rotary" for axis in robot.axes]]).sum()) / 90.0
    depth = max(0.0, floor - float(heights.min())) / size
    # An upright arm is easier to read than a horizontal one, and its tool should point down.
    looks = (5.0 * float(heights.mean()) - float(robot.fk(axes).translation[2])) / size
    return dexterity + looks - 4.0 * depth - 0.03 * bent


def _heights(robot: Mechanism, axes: Vector) -> Vector:
    """Return the heights [m] of all joints above the base's origin."""
    return np.array([T[2, 3] for T in link_placements(robot.chain, robot.q(axes)).values()])


def joint_transforms(chain: Chain, q: Vector) -> list[Matrix]:
    """Return the transform (4, 4) [m] from parent link to child link for every joint at joint values (n_q,), SI."""
    return [joint.T_parent_joint @ joint_motion(joint, float(v)) for joint, v in zip(chain.joints, q, strict=True)]
