"""Every branch while axes are held: what is left of an arm is an arm of its own, and its branches are all there."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import chainbuild

AXES = {"kr6r900": 6, "tx2_60": 6, "arm_nr5": 5, "scara_cc": 4, "palletiser_kin96": 4}
CASES = [(name, count) for name, axes in AXES.items() for count in range(1, axes + 1)]


@pytest.mark.parametrize(("name", "count"), CASES)
def test_the_pose_that_the_others_made_is_among_the_branches(name: str, count: int) -> None:
    robot, rng = chainbuild.Robot.load(name), np.random.default_rng(count)
    rotary = np.array([axis.kind == "rotary" for axis in robot.axes])
    ends = np.array([(axis.lower, axis.upper) for axis in robot.axes])
    lower, upper = np.where(rotary[:, None], np.clip(ends, -175.0, 175.0), ends).T
    for held in itertools.combinations(range(len(robot.axes)), count):
        axes = lower + (upper - lower) * rng.random(len(lower))
        while robot.violated_limits(axes):
            axes = lower + (upper - lower) * rng.random(len(lower))
        found = robot.ik_all(robot.fk(axes), held={robot.axes[n].name: axes[n] for n in held})
        off = np.array([branch.axes - axes for branch in found])
        off[:, rotary] -= 360.0 * np.round(off[:, rotary] / 360.0)  # whole turns may lie nearer to the start
        assert np.abs(off).max(axis=1).min() < 1e-4, f"held {held}"
