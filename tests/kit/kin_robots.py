"""Robots of every KIN_TYP with head offsets that are all different from 0, and poses inside their ranges."""

from __future__ import annotations

from functools import cache

import numpy as np

from chainbuild.formats.twincat.types.catalogue import catalogue
from chainbuild.robot import Robot
from tests.kit.kin_types import HEADS, build, generic_hd, head_hd

# The types that are built from head offsets; struts meet with dimensions that fit alone, and have tests of their own.
ALL = tuple(number for number, kind in catalogue().items() if not kind.listed and kind.family != "parallel")
# Types that have no three linear axes to solve for directly.
NOT_DIRECT = (13, 14, 36, 45, 85, 96, 202, 203, 205, 206, 208, 213)


@cache
def robot_of(kin: int) -> Robot:
    """Return a robot of a KIN_TYP with generic dimensions."""
    values = head_hd(kin) if kin in HEADS else generic_hd(catalogue()[kin].data)
    return build(kin, values, length=120.0).robot


def poses(robot: Robot, n: int, seed: int = 0) -> list[np.ndarray]:
    """Return axis values inside ±400 mm, ±170 degrees and nine tenths of the limits that have a finite pose."""
    rng = np.random.default_rng(seed)
    axes = robot.axes
    middle = np.array([(axis.lower + axis.upper) / 2.0 for axis in axes])
    half = np.array([min(400.0 if a.kind == "linear" else 170.0, 0.45 * (a.upper - a.lower)) for a in axes])
    found: list[np.ndarray] = []
    while len(found) < n:
        values = middle + (rng.random(len(half)) * 2.0 - 1.0) * half
        if np.isfinite(robot.kinematics.pose(robot.q(values)).homogeneous).all():
            found.append(values)
    return found
