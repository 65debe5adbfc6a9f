"""Axis values that a nonlinear map has no joint values for: an error with axis and range, never not-a-number."""

from __future__ import annotations

from pathlib import Path

import pytest

import chainbuild
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.robot import Robot
from tests.kit.kin_types import build

CASES = [
    (59, {7: 45}, "A", 90.001, "-90 to 90 deg"),
    (59, {7: 30}, "A", -60.5, "-60 to 60 deg"),
    (60, {7: 45}, "B", 91.0, "-90 to 90 deg"),
    (25, {1: 100}, "A", 90.0, "less than 90 deg off 0"),
]


def assert_refused(robot: Robot, axes: list[float], axis: str, permitted: str) -> None:
    for evaluate in (robot.fk, robot.q, robot.jacobian, robot.frame_placements, robot.pose_angles):
        with pytest.raises(AxisValueError) as caught:
            evaluate(axes)
        assert (caught.value.parameter, caught.value.permitted) == (axis, permitted)


@pytest.mark.parametrize(("kin", "hd", "axis", "value", "permitted"), CASES)
def test_the_error_names_axis_and_range(
    kin: int, hd: dict[int | str, float], axis: str, value: float, permitted: str
) -> None:
    assert_refused(build(kin, hd, 8.0).robot, [0, 0, 0, 0, value], axis, permitted)


def test_two_steps_pass_the_error_on(tmp_path: Path) -> None:
    """59 as the first of two steps, whose own map refuses."""
    path = tmp_path / "steps.lis"
    path.write_text(
        "default_id_of_kin_step[0] 59\ndefault_id_of_kin_step[1] 9\ntrafo[0].id 59\ntrafo[0].param[6] 300000\n"
        "kin_step[1].trafo[0].id 9\n"
    )
    robot = chainbuild.Robot.load(path)
    assert_refused(robot, [0, 0, 0, 0, 61], "A", "-60 to 60 deg")
    assert robot.ik(robot.fk([1, 2, 3, 4, 5]), start=[0, 0, 0, 0, 59]).success


def test_inverse_kinematics_takes_no_harm() -> None:
    robot = build(59, {7: 30}, 8.0).robot
    target = robot.fk([10, 20, 30, 40, 59])
    for solver in ("damped", "analytic"):
        assert robot.ik(target, solver=solver, start=[0, 0, 0, 0, 0]).success
    level = build(59, {7: 89}, 8.0).robot.fk([0, 0, 0, 0, 120])
    assert robot.ik(level).status == "unreachable"


def test_one_error_class_for_all() -> None:
    assert issubclass(AxisValueError, ChainbuildError)
