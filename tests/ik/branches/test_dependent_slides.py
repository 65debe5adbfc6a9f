"""Slides that rotary axes turn into one plane: an answer or none, never an error of linear algebra."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.assemble import linear, rotary, shift
from chainbuild.ik.branches.compiled.forms import quick_form
from chainbuild.ik.branches.compiled.quick import quick_branches
from chainbuild.ik.branches.core.branches import Branches
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


@pytest.mark.parametrize("turned", [90.0, 90.0 + 1e-9, -90.0])
def test_slides_along_each_other_are_left_to_the_plain_path_which_finds_the_place(turned: float) -> None:
    robot = robot_from([
        linear("X1", "x"), linear("Z3", "z"), rotary("C", "z"), shift(x=100.0), linear("Y2", "y"), rotary("B", "y"),
        rotary("A", "x"), shift(z=-80.0),
    ])  # fmt: skip
    axes = np.array([10.0, -20.0, turned, 30.0, 20.0, 35.0])
    T = robot.fk(axes)
    assert quick_form(robot, None, None)[0] is not None
    assert not isinstance(quick_branches(robot, T.homogeneous, axes, None), Branches)
    assert any(np.abs(branch.axes - axes).max() < 1e-6 for branch in robot.ik_all(T, axes))


def test_slides_nearly_along_each_other_are_placed_by_the_compiled_form() -> None:
    robot = robot_from([
        linear("X1", "x"), linear("Z3", "z"), rotary("C", "z"), shift(x=100.0), linear("Y2", "y"), rotary("B", "y"),
        rotary("A", "x"), shift(z=-80.0),
    ])  # fmt: skip
    axes = np.array([10.0, -20.0, 90.0 + 1e-3, 30.0, 20.0, 35.0])
    found = quick_branches(robot, robot.fk(axes).homogeneous, axes, None)
    assert isinstance(found, Branches)
    assert any(np.abs(row - axes).max() < 1e-6 for row in found.axes)
