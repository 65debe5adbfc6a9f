"""The matrix product that array code works on, against Pinocchio: joints askew, offsets, both branches, held axes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from chainbuild import Robot
from chainbuild.chain.assemble import linear, rotary, shift, turn
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.elements import Axis
from chainbuild.frames import rot_x, rot_z, unit
from chainbuild.kinematics.evaluation import usual_range
from chainbuild.kinematics.product import poses_at, slides_at
from tests.kit.robots import make_chain

SENSES = [(x, y, z) for x in (1.0, -1.0) for y in (1.0, -1.0) for z in (1.0, -1.0)]


def askew(sense: tuple[float, float, float]) -> Robot:
    """A slide and a turn in either branch, along directions beside every axis; joints are sums of axes, and offset."""
    far, near = (unit(np.array(sense) * parts) for parts in ((0.3, 0.4, 0.8), (0.7, 0.6, 0.2)))
    tool = [shift(10.0, 20.0, 30.0), linear("X", "x"), turn(rot_x(20.0)), rotary("A", "x"), shift(z=-90.0)]
    workpiece = [shift(-40.0, 5.0, 7.0), rotary("C", "x"), shift(x=60.0), turn(rot_z(70.0)), linear("Y", "x")]
    chain = make_chain(tool, [*workpiece, shift(y=11.0)], "X Y A C")
    # As drawn: assembling folds what it can into the joints, a chain of a URDF need not.
    along = {"X": far, "A": near, "C": far, "Y": near}
    joints = tuple(replace(joint, direction=along[joint.name]) for joint in chain.joints)
    kinds = [axis.kind for axis in chain.axes]
    A = np.zeros((4, 4))
    for row, joint in enumerate(joints):
        mixed = {"X": (1.0, 0.5, 0, 0), "Y": (0, -2.0, 0, 0), "A": (0, 0, 1.0, 0.25), "C": (0, 0, -0.5, 1.0)}
        A[row] = mixed[joint.name]
    offsets = np.array([0.05 if joint.kind == "prismatic" else 0.4 for joint in joints])
    return Robot(replace(chain, joints=joints, axis_map=AffineMap.of(A, offsets, kinds)))


def by_pinocchio(robot: Robot, row: np.ndarray) -> np.ndarray:
    """Return the tool in the workpiece frame, from frames that Pinocchio places at the map's joint values."""
    model = robot.kinematics.model
    data = model.createData()
    pin.framesForwardKinematics(model, data, robot.chain.axis_map.q(row))
    tool, workpiece = (data.oMf[model.getFrameId(name)] for name in ("tool", "workpiece"))
    return (workpiece.inverse() * tool).homogeneous


ROWS = np.random.default_rng(2).uniform(-150.0, 150.0, (4, 4))


@pytest.mark.parametrize("sense", SENSES)
def test_joints_askew_with_offsets(sense: tuple[float, float, float]) -> None:
    robot = askew(sense)
    kinematics = robot.kinematics
    assert kinematics.product is not None
    expected = np.array([by_pinocchio(robot, row) for row in ROWS])
    np.testing.assert_allclose(poses_at(kinematics.product, ROWS, kinematics.si_factors), expected, atol=1e-14)
    for row, T in zip(ROWS, expected, strict=True):
        x = row * kinematics.si_factors
        np.testing.assert_allclose(kinematics.q(x), robot.chain.axis_map.q(row), atol=1e-14)
        np.testing.assert_allclose(kinematics.pose_and_jacobian(x)[0].homogeneous, T, atol=1e-14)


def test_slides_askew_with_offsets() -> None:
    """Along X and Y the tool moves straight: where it is after 10 mm, is told by what it is now."""
    robot = askew((1.0, -1.0, 1.0))
    kinematics = robot.kinematics
    assert kinematics.product is not None
    places, rates = slides_at(kinematics.product, ROWS, kinematics.si_factors, np.array([0, 1]))
    for row, place, rate in zip(ROWS, places, rates, strict=True):
        assert place == pytest.approx(by_pinocchio(robot, row)[:3, 3], abs=1e-14)
        for n in (0, 1):
            moved = row + 10.0 * np.eye(4)[n]
            assert place + 0.01 * rate[:, n] == pytest.approx(by_pinocchio(robot, moved)[:3, 3], abs=1e-14)


def test_held_axes_are_offsets_of_the_others() -> None:
    robot = askew((-1.0, 1.0, 1.0))
    kinematics = robot.kinematics
    assert kinematics.product is not None
    held = ROWS[0] * (0.0, 1.0, 0.0, 1.0) * kinematics.si_factors
    less = kinematics.product.by_axes(np.array([0, 2]), held)
    found = poses_at(less, ROWS[:1, [0, 2]], kinematics.si_factors[[0, 2]])
    np.testing.assert_allclose(found[0], by_pinocchio(robot, ROWS[0]), atol=1e-14)


@pytest.mark.parametrize("length", [0.3, 3000.0])
def test_a_stretched_arm_reaches_its_full_length(length: float) -> None:
    """Slack by a share of the length as well as by a constant: short arms and long ones."""
    reach = Robot(make_chain([rotary("A", "z"), shift(x=length)], [], "A")).kinematics.reach
    assert length / 1000.0 < reach < length / 1000.0 * (1.0 + 1e-8) + 1e-8


def test_bodies_hang_on_the_frames_of_their_joints() -> None:
    robot = Robot.load("kr6r900")
    model = robot.kinematics.model
    for joint in robot.chain.joints:
        body = model.frames[model.getFrameId(joint.child)]
        above = model.frames[body.parentFrame]
        assert (above.name, above.type) == (joint.name, pin.FrameType.JOINT)


def test_positions_are_drawn_within_about_half_a_turn() -> None:
    wide = Axis("A", "rotary", "deg", -math.inf, math.inf, False, endless=True)
    low, high = usual_range(wide)
    assert -180.0 < low < -150.0
    assert 150.0 < high < 180.0
    assert usual_range(replace(wide, lower=-20.0, upper=30.0)) == (-20.0, 30.0)
    assert usual_range(replace(wide, lower=200.0, upper=300.0)) == (200.0, 300.0)
