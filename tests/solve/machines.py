"""Robots of every KIN_TYP with head offsets that are all different from 0, and poses inside their ranges."""

from __future__ import annotations

from functools import cache

import numpy as np

from chainbuild.formats.twincat.types.catalogue import catalogue
from chainbuild.robot import Robot
from tests.twincat import head_kit, table_kit

ALL = tuple(catalogue())


@cache
def robot_of(kin: int) -> Robot:
    """Return a robot of a KIN_TYP with generic dimensions."""
    if kin in head_kit.HEADS:
        return head_kit.build(kin, head_kit.generic_hd(kin), length=120.0).robot
    return table_kit.build(kin, table_kit.generic_hd(catalogue()[kin].data), length=120.0).robot


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
