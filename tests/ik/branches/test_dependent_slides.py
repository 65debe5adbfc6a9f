"""Slides that rotary axes turn into one plane: an answer or none, never an error of linear algebra."""

from __future__ import annotations

import numpy as np

import chainbuild
from chainbuild.chain.assemble import linear, rotary, shift
from chainbuild.robot import Robot
from tests.kit.robots import robot_from


def test_a_slide_that_has_been_turned_along_another_one() -> None:
    chain = robot_from([
        linear("A1", "-x"), shift(x=200.0), rotary("A2", "z"), shift(100.0, 100.0, 100.0), linear("A3", "-x"),
        rotary("A4", "-x"), shift(y=200.0), rotary("A5", "x"), shift(x=200.0), linear("A6", "z"),
    ]).chain  # fmt: skip
    robot = Robot(chain.with_axes(tuple(chainbuild.Axis.unlimited(axis.name, axis.kind) for axis in chain.axes)))
    assert robot.plan().name == "direct"
    target = robot.fk([90.0, -90.0, 90.0, 90.0, 0.0, 0.0])
    for branch in robot.ik_all(target):
        np.testing.assert_allclose(robot.fk(branch.axes).homogeneous, target.homogeneous, atol=1e-9)
    assert robot.ik(target, solver="damped").success
