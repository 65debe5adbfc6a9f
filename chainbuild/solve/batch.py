"""All branches of many poses at once: ortho-parallel arms with a spherical wrist, in array arithmetic.

The closed form is that of Brandstötter, Angerer, Hofbaur 2014 over the parameters that `opw_arm` measures on the chain.
Slot 4·flip + 2·shoulder + elbow: flip 0 has θ5 ≥ 0, shoulder 0 the arm in front of axis 1, elbow 0 and 1 its two bends.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from chainbuild.chain.axismap import AffineMap
from chainbuild.errors import ChainbuildError
from chainbuild.robot.robot import as_pose
from chainbuild.solve.opw_arm import OpwArm, opw_arm
from chainbuild.solve.query import LIMIT_SLACK, Query

if TYPE_CHECKING:
    from chainbuild.robot.robot import Robot

Array = NDArray[np.float64]

BRANCHES: Final = 8
_CHUNK: Final = 2048  # poses at a time: what they need stays in the processor's cache
_TOUCH: Final = 1e-9  # a cosine may leave its range by this


def ik_all_batch(robot: Robot, poses: ArrayLike, *, limits: bool = True) -> Array:
    """Return all branches (n, 8, 6) of poses, mm and degrees; not a number where a branch does not exist.

    Args:
        robot: A six-axis arm whose axes stand at right angles or parallel, with a spherical wrist.
        poses: (n, 4, 4) tool in the workpiece frame [m].
        limits: True: axes are moved by whole turns into their limits, and branches outside them left out; False:
            every branch, as the closed form gives it.

    Raises:
        ChainbuildError: the robot is no such arm, or poses have another shape.
    """
    targets = np.asarray(poses, dtype=float)
    if targets.ndim != 3 or targets.shape[1:] != (4, 4):
        raise ChainbuildError(f"poses have the shape {targets.shape}", permitted="(n, 4, 4)")
    query = Query.of(robot, as_pose(np.eye(4)), None, None)
    serial = query.serial()
    arm, axis_map = opw_arm(serial), robot.chain.axis_map
    if arm is None or not isinstance(axis_map, AffineMap) or len(robot.axes) != 6 or robot.chain.loops:
        raise ChainbuildError(
            "there is no closed form over arrays for this kinematic",
            permitted="six-axis arms with axes at right angles or parallel and a spherical wrist",
        )
    order = np.argsort([screw.joint for screw in serial.screws])
    # From angles to SI axis values in one matrix: x = back·(signs·(theta − offsets) − b).
    turn = axis_map.back @ np.diag(arm.signs)[order]
    shift = turn @ arm.offsets + axis_map.back @ axis_map.b
    axes = np.empty((len(targets), BRANCHES, 6))
    for first in range(0, len(targets), _CHUNK):
        chunk = slice(first, first + _CHUNK)
        theta = _angles(arm, targets[chunk])
        x = (turn @ theta.reshape(6, -1)) - shift[:, None]
        if limits:
            _move_inside(query, x)
        x /= axis_map.si_factors[:, None]
        axes[chunk] = x.reshape(6, BRANCHES, -1).transpose(2, 1, 0)
    return axes


def _move_inside(query: Query, x: Array) -> None:
    """Move axis values (6, m) by whole turns into the limits; not a number where that does not help."""
    outside = np.zeros(x.shape[1], dtype=bool)
    for n, row in enumerate(x):
        lower, upper = float(query.lower[n]) - LIMIT_SLACK, float(query.upper[n]) + LIMIT_SLACK
        if query.periodic[n] and math.isfinite(lower) and math.isfinite(upper):
            low, high = row < lower, row > upper
            row[low] += math.tau * np.ceil((lower - row[low]) / math.tau)
            row[high] -= math.tau * np.ceil((row[high] - upper) / math.tau)
        outside |= ~((row >= lower) & (row <= upper))
    values = x / query.robot.kinematics.si_factors[:, None] if query.robot.chain.constraints else x
    for constraint in query.robot.chain.constraints:
        total = np.array(constraint.sum.coefficients) @ values + constraint.sum.offset
        outside |= ~((total >= constraint.lower - LIMIT_SLACK) & (total <= constraint.upper + LIMIT_SLACK))
    x[:, outside] = np.nan


def _angles(arm: OpwArm, targets: Array) -> Array:
    """Return the angles (6, 8, m) of the sixth axis' frames that belong to tool poses (m, 4, 4)."""
    T = np.linalg.inv(arm.T_base_arm) @ targets @ np.linalg.inv(arm.T_flange_tool)
    columns = np.ascontiguousarray(T[:, :3, :].transpose(1, 2, 0))  # (3, 4, m): every entry a run in memory
    theta = np.empty((6, BRANCHES, len(targets)))
    with np.errstate(invalid="ignore"):
        _arm_angles(arm.parameters, columns, theta)
    _wrist_angles(columns, theta)
    return theta


def _arm_angles(p: dict[str, float], T: Array, theta: Array) -> None:
    """Write θ1, θ2, θ3 of the four arm branches; the wrist centre is the origin of T because c4 is part of the tool."""
    x, y, z = T[0, 3], T[1, 3], T[2, 3] - p["c1"]
    out = np.sqrt(_nonnegative(x * x + y * y - p["b"] * p["b"]))
    heading, aside = np.arctan2(y, x), np.arctan2(p["b"], out)
    forearm = p["a2"] ** 2 + p["c3"] ** 2
    bend = math.atan2(p["a2"], p["c3"])
    for shoulder, reach in enumerate((out - p["a1"], -out - p["a1"])):
        first = heading - aside if shoulder == 0 else heading + aside - math.pi
        squared = reach * reach + z * z
        middle = np.arctan2(reach, z)
        lift = _arccos((squared + p["c2"] ** 2 - forearm) / (2.0 * p["c2"] * np.sqrt(squared)))
        elbow = _arccos((squared - p["c2"] ** 2 - forearm) / (2.0 * p["c2"] * math.sqrt(forearm)))
        for side, sign in enumerate((1.0, -1.0)):
            slot = 2 * shoulder + side
            theta[0, slot], theta[1, slot], theta[2, slot] = first, middle - sign * lift, sign * elbow - bend


def _wrist_angles(T: Array, theta: Array) -> None:
    """Write θ4, θ5, θ6 and the flipped wrist, from the arm angles that stand there."""
    sin_1, cos_1 = np.repeat(np.sin(theta[0, :4:2]), 2, axis=0), np.repeat(np.cos(theta[0, :4:2]), 2, axis=0)
    pitch = theta[1, :4] + theta[2, :4]
    sin_23, cos_23 = np.sin(pitch), np.cos(pitch)
    ahead = [T[0, n] * cos_1 + T[1, n] * sin_1 for n in range(3)]
    along = [ahead[n] * sin_23 + T[2, n] * cos_23 for n in range(3)]
    across = T[1, 2] * cos_1 - T[0, 2] * sin_1
    up = ahead[2] * cos_23 - T[2, 2] * sin_23
    theta[3, :4], theta[5, :4] = np.arctan2(across, up), np.arctan2(along[1], -along[0])
    theta[4, :4] = np.arctan2(np.sqrt(across * across + up * up), along[2])
    theta[:3, 4:] = theta[:3, :4]
    theta[3, 4:], theta[4, 4:], theta[5, 4:] = theta[3, :4] + math.pi, -theta[4, :4], theta[5, :4] + math.pi


def _nonnegative(value: Array) -> Array:
    """Return values with what rounding took below 0 lifted to it; not a number where they are below by more."""
    lifted: Array = np.where((value < 0.0) & (value > -_TOUCH), 0.0, value)
    return lifted


def _arccos(cosine: Array) -> Array:
    """Return the arc cosine; at the edge of the range rounding is cut off."""
    size = np.abs(cosine)
    touching = (size > 1.0) & (size < 1.0 + _TOUCH)
    angle: Array = np.arccos(np.where(touching, np.sign(cosine), cosine))
    return angle
