"""Notices without a loss of motion: gimbal lock of the pose angles, dead points of a parallelogram."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np

from chainbuild import frames
from chainbuild.analysis.singularity.singularity import Singularity
from chainbuild.arrays import Vector
from chainbuild.chain.bodies.rods import CRANK, ROD, ROD_END, ROD_PIN, has_rods
from chainbuild.kinematics.mechanism import Mechanism

# Sine of the angle to the lock: 1 degree.
NEAR_LOCK: Final = 0.0175
# Sine of the angle between crank and rod: 10 degrees, where the rod's force is six times that of the best angle.
NEAR_DEAD: Final = 0.1736
_FOLLOWS: Final = ("ab", "ba")  # angle modes that program two angles only: they cannot lock


def notices(robot: Mechanism, axes: Vector) -> Iterator[Singularity]:
    """Yield the notices at axis values (n_axes,), mm and degrees.

    Args:
        robot: The robot.
        axes: Axis values.
    """
    # A robot with four axes is programmed by position and C, which cannot lock.
    if robot.task == "pose" and robot.chain.angle_mode not in _FOLLOWS and not robot.chain.follows_c:
        yield from _gimbal_locks(robot, axes)
    if has_rods(robot.chain):
        yield from _dead_points(robot, axes)


def _dead_points(robot: Mechanism, axes: Vector) -> Iterator[Singularity]:
    """Yield the dead point of a parallelogram: crank and rod in line, so that the rod transmits no torque."""
    places = robot.frame_placements(axes)
    crank = places[ROD].translation - places[CRANK].translation
    rod = places[ROD_END].translation - places[ROD].translation
    along = next(joint.direction for joint in robot.chain.joints if joint.name == CRANK)
    across = places[CRANK].rotation @ along
    crank, rod = crank - across * (across @ crank), rod - across * (across @ rod)
    value = float(np.linalg.norm(np.cross(crank, rod)) / (np.linalg.norm(crank) * np.linalg.norm(rod)))
    if value <= NEAR_DEAD:
        elbow = next(j.name for j in robot.chain.joints if j.child == robot.chain.frame(ROD_PIN).link)
        angle = math.degrees(math.asin(min(value, 1.0)))
        condition = f"the parallelogram is {angle:.3g}° from its dead point: crank and rod are in line"
        sentence = f"{condition}; there the rod holds no torque of {elbow}, and the linkage may fold over"
        yield Singularity("dead_point", "", value, (elbow,), condition, sentence)


def _gimbal_locks(robot: Mechanism, axes: Vector) -> Iterator[Singularity]:
    R = robot.fk(axes).rotation
    mode = frames.ANGLE_MODES[robot.chain.angle_mode]
    (first, a, _), (_, b, _), (last, c, _) = mode.factors
    angles = dict(zip("ABC", frames.angles_from_matrix(mode.name, R), strict=True))
    middle = math.radians(angles[b])
    value = abs(math.sin(middle)) if first == last else abs(math.cos(middle))
    watched = robot.chain.singularity_watch is not None
    if value <= NEAR_LOCK:
        condition = f"the pose angles {a} and {c} turn about the same line ({b} = {angles[b]:.4g}°, {mode.meaning})"
        remark = "ROBX manual 10.1.3 names B = 0, which is the lock of Euler angles" if watched else ""
        yield _lock(value, (a, c), condition, remark)
    tilt = float(np.hypot(R[0, 2], R[1, 2]))
    if watched and tilt <= NEAR_LOCK:
        condition = f"programmed as Euler angles, A and C turn about the same line (B = {_tilt_deg(R):.4g}°)"
        yield _lock(tilt, ("A", "C"), condition, "ROBX manual 10.1.3")


def _tilt_deg(R: Vector) -> float:
    return math.degrees(math.atan2(math.hypot(float(R[0, 2]), float(R[1, 2])), float(R[2, 2])))


def _lock(value: float, letters: tuple[str, str], condition: str, remark: str) -> Singularity:
    first, last = letters
    sentence = f"{condition}: the axes lose nothing, but a turn across that line makes {first} and {last} jump"
    return Singularity("gimbal_lock", "", value, letters, condition, sentence, remark)
