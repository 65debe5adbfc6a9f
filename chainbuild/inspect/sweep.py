"""The motion of a page: each axis in turn from limit to limit and back, around a readable pose."""

from __future__ import annotations

import math
from dataclasses import dataclass
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

FRAMES_PER_SECOND: Final = 10  # the viewer interpolates between keyframes
_SEED: Final = 5  # the page of a machine does not change
_CLOSING: Final = 40  # states looked at for one in which the loops close well
_FRAMES_PER_AXIS: Final = 50  # five seconds
# Shares of an axis's time: to the lower limit, across to the upper one, back; the rest is a pause.
_PHASES: Final = (0.24, 0.44, 0.24)

# Angles a rotary axis may take in the pose shown, degrees.
_CANDIDATES: Final = (0.0, 45.0, -45.0, 90.0, -90.0)
# A pose whose smallest singular value is below this share of the largest looks stretched or folded.
_STRETCHED: Final = 0.05


@dataclass(frozen=True, slots=True)
class Segment:
    """The frames, first and last included, in which one axis moves."""

    axis: int
    first: int
    last: int


@dataclass(frozen=True, slots=True, eq=False)
class AxisSweep:
    """A motion in keyframes, `FRAMES_PER_SECOND` apart.

    Attributes:
        axes: (n_frames, n_axes) axis values, mm and degrees.
        q: (n_frames, n_q) joint values, SI.
        segments: Which axis moves when, in channel order.
        held: Names of axes that stop short of their range because the kinematic has no pose beyond.
    """

    axes: Matrix
    q: Matrix
    segments: tuple[Segment, ...]
    held: tuple[str, ...]


def axis_sweep(robot: Mechanism) -> AxisSweep:
    """Return the motion that takes every axis over its shown range, one after the other, starting and ending at rest.

    Raises:
        ChainbuildError: the kinematic has no pose to start from.
    """
    rest = rest_pose(robot)
    lower, upper = shown_limits(robot.chain)
    axes, q, segments, held = [rest], [robot.q(rest)], [], []
    for n, axis in enumerate(robot.axes):
        segments.append(Segment(n, len(axes) - 1, len(axes) - 1 + _FRAMES_PER_AXIS))
        for value in _course(rest[n], *_alone(robot, rest, n, lower[n], upper[n])):
            wanted = rest.copy()
            wanted[n] = value
            try:
                q.append(robot.q(wanted))
                axes.append(wanted)
            except ChainbuildError:
                q.append(q[-1])
                axes.append(axes[-1])
                held.append(axis.name)
    return AxisSweep(np.array(axes), np.array(q), tuple(segments), tuple(dict.fromkeys(held)))


def _alone(robot: Mechanism, rest: Vector, n: int, low: float, high: float) -> tuple[float, float]:
    """Return how far axis n moves of its shown range while the others rest."""
    least, most = range_beside(robot.chain, n, rest) or (rest[n], rest[n])
    return max(low, least), min(high, most)


def _course(rest: float, lower: float, upper: float) -> list[float]:
    """Return the values of one axis: rest, lower, upper, rest, with soft ends and a pause."""
    stops = [float(rest), float(lower), float(upper), float(rest)]
    values: list[float] = []
    for start, stop, share in zip(stops[:-1], stops[1:], _PHASES, strict=True):
        count = round(share * _FRAMES_PER_AXIS)
        values += [start + (stop - start) * (1 - math.cos(math.pi * k / count)) / 2 for k in range(1, count)] + [stop]
    return values + [stops[-1]] * (_FRAMES_PER_AXIS - len(values))


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
