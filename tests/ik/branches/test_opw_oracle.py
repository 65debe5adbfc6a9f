"""The two KUKA files against py-opw-kinematics, an independent closed form with the maker's published parameters."""

from __future__ import annotations

import numpy as np
import pytest
from py_opw_kinematics import KinematicModel
from py_opw_kinematics import Robot as OpwRobot
from scipy.spatial.transform import RigidTransform

import chainbuild

# Published OPW parameters (mm); their zero has the arm stretched upwards, KUKA's lies along +X.
PARAMETERS = {
    "kr6r900": {"a1": 25.0, "a2": -35.0, "b": 0.0, "c1": 400.0, "c2": 455.0, "c3": 420.0, "c4": 80.0},
    "kr6r900_2": {"a1": 25.0, "a2": -25.0, "b": 0.0, "c1": 400.0, "c2": 455.0, "c3": 420.0, "c4": 90.0},
}
SIGNS = np.array([-1.0, 1.0, 1.0, -1.0, 1.0, -1.0])
ZERO = np.array([0.0, 90.0, 0.0, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("name", PARAMETERS)
def test_forward_kinematics_agrees(name: str) -> None:
    oracle = OpwRobot(KinematicModel(**PARAMETERS[name]))
    robot = chainbuild.Robot.load(name)
    rng = np.random.default_rng(11)
    for _ in range(1000):
        axes = rng.uniform(-180.0, 180.0, 6)
        wanted = oracle.forward(tuple(SIGNS * axes + ZERO)).as_matrix()
        T = robot.fk(axes)
        np.testing.assert_allclose(T.translation * 1000.0, wanted[:3, 3], atol=1e-9)
        np.testing.assert_allclose(T.rotation, wanted[:3, :3], atol=1e-12)


@pytest.mark.parametrize("name", PARAMETERS)
def test_our_answers_are_among_its_branches(name: str) -> None:
    oracle = OpwRobot(KinematicModel(**PARAMETERS[name]))
    robot = chainbuild.Robot.load(name)
    rng = np.random.default_rng(12)
    lower = np.array([axis.lower for axis in robot.axes])
    upper = np.array([axis.upper for axis in robot.axes])
    for _ in range(100):
        target = robot.fk(lower + (upper - lower) * rng.random(6))
        found = robot.ik(target)
        assert found.success
        pose = target.homogeneous.copy()
        pose[:3, 3] *= 1000.0
        branches = np.array(oracle.inverse(RigidTransform.from_matrix(pose)))
        theta = SIGNS * found.axes + ZERO
        off = np.abs((branches - theta + 180.0) % 360.0 - 180.0).max(axis=1)
        assert off.min() < 1e-5
