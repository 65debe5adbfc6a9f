"""Position and C of ROBX robots of four axes: A and B follow, and C runs on where the machine says so."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import chainbuild
from chainbuild import frames
from chainbuild.errors import ChainbuildError
from chainbuild.ik.policies import four_axis as programmed
from chainbuild.robot import Robot
from tests.kit.draws import random_axes

FOUR_AXES = ("scara_cc", "scara_sc", "cylinder_cs", "palletiser_nr4")


def build(name: str) -> Robot:
    return chainbuild.Robot.load(name)


@pytest.mark.parametrize("name", FOUR_AXES)
def test_a_and_b_follow_where_they_cannot_be_reached(name: str) -> None:
    robot, rng = build(name), np.random.default_rng(3)
    for _ in range(15):
        axes = random_axes(robot, rng)
        T = robot.fk(axes)
        a, b, c = frames.angles_from_matrix("orirpy", T.rotation)
        # B stays off ±90, where A and C could not be told apart, and off what the robot can do.
        asked = frames.matrix_from_angles("orirpy", (a + 25.0, 0.5 * b + 11.0, c))
        found = robot.ik(frames.transform(asked, T.translation), axes)
        assert found.success
        assert robot.violated_limits(found.axes) == ()
        reached = robot.fk(found.axes)
        np.testing.assert_allclose(reached.translation, T.translation, atol=1e-6)
        assert math.remainder(robot_c(reached.rotation) - c, 360.0) == pytest.approx(0.0, abs=1e-4)
        # The place it started from has that C already: nothing moves, whole turns of axis 4 neither.
        np.testing.assert_allclose(found.axes, axes, atol=1e-4)


def robot_c(R: np.ndarray) -> float:
    return frames.angles_from_matrix("orirpy", R)[2]


@pytest.mark.parametrize("name", FOUR_AXES)
def test_a_pose_within_reach_is_met_as_given(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    robot, rng = build(name), np.random.default_rng(4)
    monkeypatch.setattr(
        programmed, "with_reachable_orientation", lambda *_: pytest.fail("the orientation was replaced")
    )
    for _ in range(10):
        T = robot.fk(random_axes(robot, rng))
        found = robot.ik(T)
        assert found.success
        np.testing.assert_allclose(robot.fk(found.axes).rotation, T.rotation, atol=2e-6)


def test_what_is_out_of_reach_stays_so() -> None:
    robot = build("palletiser_nr4")
    found = robot.ik(frames.transform(frames.rot_y(30.0), (9.0, 0.0, 0.5)))
    assert (found.success, found.status) == (False, "unreachable")


def test_six_axes_do_not_follow() -> None:
    robot = build("parallelogram_nr")
    assert not robot.chain.follows_c
    T = robot.fk([0.0, 0.0, -90.0, 0.0, 40.0, 0.0])
    T.translation = np.array([9.0, 0.0, 0.0])
    assert robot.ik(T).status == "unreachable"


def test_the_rate_of_c_is_its_derivative() -> None:
    rng = np.random.default_rng(5)
    for mode in ("orirpy", "orirpy2"):
        for _ in range(20):
            angles = tuple(float(v) for v in rng.uniform(-80.0, 80.0, 3))
            R, step = frames.matrix_from_angles(mode, angles), 1e-5
            row = programmed._angle_rates(mode, dict(zip("ABC", angles, strict=True)), ("C",))[0]
            for n in range(3):
                moved = R @ frames.rot_about(np.eye(3)[n], math.degrees(step))
                slope = math.radians(frames.angles_from_matrix(mode, moved)[2] - angles[2]) / step
                assert row[n] == pytest.approx(slope, abs=1e-3)


def test_the_rate_of_c_where_a_is_0() -> None:
    """At B = 90 only the turn about the tool's own X changes C, one to one."""
    rates = programmed._angle_rates("orirpy", {"A": 0.0, "B": 90.0, "C": 33.0}, ("C",))
    np.testing.assert_allclose(rates, [[1.0, 0.0, 0.0]], atol=1e-12)


def test_absolute_c_does_not_jump() -> None:
    robot = build("scara_cc")
    shown = [robot.pose_angles([-100.0, 20.0, 30.0, turn])[2] for turn in np.arange(-1000.0, 1000.0, 7.0)]
    np.testing.assert_allclose(np.diff(shown), -7.0, atol=1e-9)
    assert shown[0] == pytest.approx(1000.0 - 50.0)
    # Within one turn it is the C of the pose.
    a, b, c = robot.pose_angles([-100.0, 20.0, 30.0, 40.0])
    R = robot.fk([-100.0, 20.0, 30.0, 40.0]).rotation
    np.testing.assert_allclose(frames.matrix_from_angles("orirpy", (a, b, c)), R, atol=1e-12)


def test_pose_angles_of_other_robots_are_those_of_the_pose() -> None:
    robot = build("irb2600")
    axes = [10.0, 20.0, -30.0, 40.0, 50.0, 60.0]
    R = frames.matrix_from_angles(robot.chain.angle_mode, robot.pose_angles(axes))
    np.testing.assert_allclose(R, robot.fk(axes).rotation, atol=1e-12)


def test_absolute_c_decides_the_turns() -> None:
    robot, rng = build("scara_cc"), np.random.default_rng(6)
    for _ in range(40):
        axes = random_axes(robot, rng)
        c = robot.pose_angles(axes)[2]
        found = robot.ik(robot.fk(axes), absolute_c_deg=c)
        assert found.success
        assert robot.violated_limits(found.axes) == ()
        assert robot.pose_angles(found.axes)[2] == pytest.approx(c, abs=1e-4)
        np.testing.assert_allclose(robot.fk(found.axes).homogeneous, robot.fk(axes).homogeneous, atol=2e-6)


def test_absolute_c_rules_over_an_orientation_that_does_not_go_with_it() -> None:
    robot = build("scara_cc")
    axes = np.array([-100.0, 20.0, 30.0, 400.0])
    c = robot.pose_angles(axes)[2]
    found = robot.ik(frames.transform(np.eye(3), robot.fk(axes).translation), axes, absolute_c_deg=c)
    np.testing.assert_allclose(found.axes, axes, atol=1e-4)


def test_absolute_c_beyond_the_limits() -> None:
    robot = build("scara_cc")
    axes = np.array([-100.0, 20.0, 30.0, 0.0])
    c = robot.pose_angles(axes)[2] + 4 * 360.0  # axis 4 has three turns either way
    found = robot.ik(robot.fk(axes), axes, absolute_c_deg=c)
    assert (found.success, found.status) == (False, "limits")
    assert "A4 is -1440, outside -1080 … 1080 deg" in found.reason


@pytest.mark.parametrize(("name", "c"), [("irb2600", 10.0), ("scara_sc", 10.0), ("scara_cc", math.nan)])
def test_an_absolute_c_that_cannot_be(name: str, c: float) -> None:
    robot = build(name)
    with pytest.raises(ChainbuildError, match="C"):
        robot.ik(np.eye(4), absolute_c_deg=c)


def test_an_offset_that_is_not_the_poses_own() -> None:
    """Where C_ANGLE_OFFSET is not what the manual asks for, C rules and not the pose angle."""
    chain = chainbuild.load("scara_cc").chain()
    assert chain.absolute_c is not None
    robot = Robot(replace(chain, absolute_c=replace(chain.absolute_c, offset=70.0)))
    axes = np.array([-100.0, 20.0, 30.0, 400.0])
    c = robot.pose_angles(axes)[2]
    a, b, _ = robot.pose_angles(axes)
    T = frames.transform(frames.matrix_from_angles("orirpy", (a, b, c)), robot.fk(axes).translation)
    found = robot.ik(T, axes, absolute_c_deg=c)
    np.testing.assert_allclose(found.axes, axes, atol=1e-4)


def test_nothing_is_left_to_turn() -> None:
    robot = chainbuild.Robot.load("scara_cc")
    axes = {"A1": -10.0, "A2": 20.0, "A3": 30.0, "A4": 40.0}
    T = robot.fk(list(axes.values())).homogeneous
    assert robot.ik(T, held=axes).success
    T[:3, :3] = T[:3, :3] @ np.diag([1.0, -1.0, -1.0])
    T[2, 3] += 0.1
    found = robot.ik(T, held=axes)
    assert not found.success
    assert found.reason
