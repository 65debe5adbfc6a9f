"""Arms of KIN_TYP 45 for status and turn, and where their wrists stand by another way of reckoning."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from chainbuild.chain.poses import link_placements
from chainbuild.frames import inverse
from chainbuild.kinematics.screws import joints_between_tips
from chainbuild.robot import Robot
from tests.kit.kin_types import build

# Every length and offset, the directions of axes 1, 3, 5 and 6 reversed.
BENT = {
    7: 400.0, 8: 455.0, 9: 420.0, 10: 80.0, 11: 25.0, 12: -35.0, 32: 15.0,
    14: -90.0, 15: 90.0, 21: 1, 23: 1, 25: 1, 26: 1, 36: 20.0, 37: -15.0, 38: 10.0, 39: 30.0,
}  # fmt: skip


def limited(robot: Robot, **limits: tuple[float, float]) -> Robot:
    """Return the robot with other limits of some axes, or of `every` axis."""
    axes = []
    for axis in robot.axes:
        lower, upper = limits.get(axis.name, limits.get("every", (axis.lower, axis.upper)))
        axes.append(replace(axis, lower=lower, upper=upper))
    return Robot(robot.chain.with_axes(tuple(axes)))


def bent_arm() -> Robot:
    """Return an arm with every offset and reversed axes, limits of half a turn."""
    return limited(build(45, BENT).robot, every=(-180.0, 180.0))


def status_by_frames(robot: Robot, axes: np.ndarray) -> tuple[int, int]:
    """Return status and turn by the placements of all links, one row, without tolerances."""
    chain = robot.chain
    links = link_placements(chain, robot.q(axes))
    arm = [links[chain.joints[n].child] for n in sorted(joints_between_tips(chain))]
    (x2, _, z2), (x3, _, z3), (xw, _, zw) = ((inverse(arm[0]) @ arm[n])[:3, 3] for n in (1, 2, 4))
    in_front = (z3 - z2) * (xw - x2) - (x3 - x2) * (zw - z2) > 0.0
    below = [bool(value < 0.0) for value in axes]
    return int(xw < 0.0) + 2 * int(in_front) + 4 * below[4], sum(1 << n for n, is_below in enumerate(below) if is_below)
