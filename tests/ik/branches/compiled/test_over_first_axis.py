"""Wrists over axis 1, which is free there: told as by the plain path, which follows each curve."""

from __future__ import annotations

import math

import numpy as np
import pytest

pytest.importorskip("numba")

from chainbuild.chain.assemble import Element, rotary, shift, turn
from chainbuild.ik.branches.compiled.quick import quick_branches
from chainbuild.ik.branches.core.branches import Branches
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.core.subproblems import rotation
from chainbuild.ik.branches.every import every_branch
from chainbuild.ik.request import IkRequest
from chainbuild.robot import Robot
from tests.kit.arms45 import limited
from tests.kit.draws import unit
from tests.kit.robots import robot_from

# A column, a shoulder 25 mm before it, links of 455 mm and of 420 mm, the latter 35 mm above its axis.
ARM: list[Element] = [
    rotary("A1", "z"), shift(25.0, 0.0, 400.0), rotary("A2", "y"), shift(z=455.0), rotary("A3", "y"),
    shift(420.0, 0.0, 35.0),
]  # fmt: skip
SQUARE: list[Element] = [rotary("A4", "x"), rotary("A5", "y"), rotary("A6", "x"), shift(x=80.0, y=7.0)]
# Axis 5 is inclined to axes 4 and 6, so that their directions are 16 to 90 degrees apart.
INCLINED: list[Element] = [
    rotary("A4", "x"), rotary("A5", (0.6, 0.8, 0.0)), rotary("A6", (0.8, 0.0, 0.6)), shift(z=80.0),
]  # fmt: skip


def over_axis_1(rng: np.random.Generator) -> np.ndarray:
    """Return axis values [degrees] that put the wrist over axis 1."""
    a3 = rng.uniform(-2.0, 0.0)
    # Upper arm and forearm are one arm of this length and lead when axis 3 stands still.
    x, z = 420.0 * math.cos(a3) + 35.0 * math.sin(a3), 455.0 - 420.0 * math.sin(a3) + 35.0 * math.cos(a3)
    a2 = math.asin(-25.0 / math.hypot(x, z)) - math.atan2(x, z)
    axes = np.degrees([rng.uniform(-2.0, 2.0), a2, a3, *rng.uniform(-2.0, 2.0, 3)])
    axes[4] = rng.choice([-1.0, 1.0]) * rng.uniform(20.0, 80.0)
    return axes


def robot_with(wrist: list[Element], carries: str) -> Robot:
    about = [turn(rotation(unit(np.random.default_rng(2)), 0.7)), shift(100.0, -50.0, 20.0)]
    elements = [*about, *ARM, *wrist]
    robot = robot_from(elements) if carries == "tool" else robot_from([shift(1.0, 2.0, 3.0)], elements)
    return limited(robot, every=(-180.0, 180.0))


@pytest.mark.parametrize("carries", ["tool", "workpiece"])
@pytest.mark.parametrize("wrist", [SQUARE, INCLINED], ids=["square", "inclined"])
def test_each_bend_of_arm_and_wrist_is_a_curve_of_its_own(wrist: list[Element], carries: str) -> None:
    robot, rng = robot_with(wrist, carries), np.random.default_rng(4)
    sure = told = 0
    for _ in range(12):
        axes = over_axis_1(rng)
        T, start = robot.fk(axes), axes + rng.uniform(-9.0, 9.0, 6)
        quick = quick_branches(robot, T.homogeneous, start, None)
        wanted = every_branch(BranchQuery.of(IkRequest.of(robot, T, start))).branches
        if not isinstance(quick, Branches):
            continue
        sure += 1
        np.testing.assert_allclose(quick.axes, wanted.axes, atol=1e-6)
        assert quick.free_axes == wanted.free_axes
        for found, one, other in zip(quick.axes, quick.free_directions, wanted.free_directions, strict=True):
            told += 1
            assert found[0] == pytest.approx(start[0], abs=1e-9)
            assert float((one @ other.T).item()) == pytest.approx(1.0, abs=1e-6)
    assert sure >= (12 if wrist is SQUARE else 3)
    assert told >= 2 * sure


@pytest.mark.parametrize("aside", [0.0, 1e-10, 0.01])
def test_where_axis_4_passes_through_the_direction_of_axis_6_the_curves_cross(aside: float) -> None:
    """Half a turn of axis 1 from a stretched wrist: the curves of both bends meet there and the plain path looks."""
    robot, rng = robot_with(SQUARE, "tool"), np.random.default_rng(5)
    axes = over_axis_1(rng)
    axes[3:] = 0.0, math.degrees(aside), 30.0
    stretched = robot.fk(axes)
    start = axes - [math.copysign(170.0, axes[0]), 0.0, 0.0, 20.0, 30.0, 0.0]
    quick = quick_branches(robot, stretched.homogeneous, start, None)
    assert isinstance(quick, Branches) == (aside == 0.01)
    assert len(robot.ik_all(stretched, start)) >= 1
