"""Robot as a roof: ways to make one, its plan, all branches as arrays."""

from __future__ import annotations

import pickle
from dataclasses import MISSING, FrozenInstanceError, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import chainbuild
from chainbuild import ChainbuildError, Robot
from chainbuild.errors import AxisValueError
from chainbuild.ik.branches.core.branches import Branch, Branches, quick_made
from chainbuild.ik.result import IkResult, quick_result
from chainbuild.kinematics.mechanism import Mechanism

AXES = [10.0, -80.0, 70.0, 20.0, 40.0, 30.0]


def test_robots_are_loaded_and_built() -> None:
    loaded = Robot.load("tx2_60", tool_length_mm=100.0)
    built = Robot(chainbuild.load("tx2_60").chain(tool_length_mm=100.0))
    assert type(loaded) is type(built) is Robot
    assert np.array_equal(loaded.fk(AXES).homogeneous, built.fk(AXES).homogeneous)
    assert repr(loaded).startswith("<Robot tx2_60")
    assert repr(Mechanism(loaded.chain)).startswith("<Mechanism tx2_60")
    with pytest.raises(ChainbuildError, match="no kinematic 99"):
        Robot.load("tx2_60", 99)


def test_a_robot_from_urdf(tmp_path: Path) -> None:
    robot = Robot.load("kr6r900")
    path = chainbuild.write_urdf(robot, tmp_path)
    read = Robot.from_urdf(path, tool="tool")
    # Joint values of the file are the controller's axis values, and so are the axes read from it.
    assert [axis.name for axis in read.axes] == [axis.name for axis in robot.axes]
    np.testing.assert_allclose(read.fk(AXES).homogeneous, robot.fk(AXES).homogeneous, atol=1e-12)


def test_a_mechanism_has_no_solvers() -> None:
    mechanism = Mechanism(chainbuild.load("kr6r900").chain())
    assert not any(hasattr(mechanism, name) for name in ("ik", "ik_path", "ik_batch", "ik_all", "distribute", "plan"))


def test_the_jacobian_in_either_frame() -> None:
    robot = Robot.load("ac_table_kin58")
    axes = [10.0, 20.0, -30.0, 40.0, 50.0]
    T, J, J_workpiece = robot.fk(axes), robot.jacobian(axes), robot.jacobian(axes, frame="workpiece")
    for n, factor in enumerate(robot.kinematics.si_factors):
        step = np.zeros(5)
        step[n] = 1e-6 / factor
        ahead, behind = robot.fk(axes + step), robot.fk(axes - step)
        velocity = (ahead.translation - behind.translation) / 2e-6
        np.testing.assert_allclose(J_workpiece[:3, n], velocity, atol=1e-7)
        np.testing.assert_allclose(T.rotation @ J[:3, n], velocity, atol=1e-7)
        spin = (ahead.rotation - behind.rotation) / 2e-6 @ T.rotation.T
        np.testing.assert_allclose(J_workpiece[3:, n], [spin[2, 1], spin[0, 2], spin[1, 0]], atol=1e-7)
    with pytest.raises(ChainbuildError, match=r"unknown frame 'base'.*tool, workpiece"):
        robot.jacobian(axes, frame="base")


def test_the_plan_of_each_set_of_held_axes() -> None:
    robot = Robot.load("kr6r900")
    assert (robot.plan().name, robot.plan().complete) == ("spherical wrist", True)
    assert robot.plan(["A4"]).name == "parallel arm"
    assert robot.plan({"A4": 20.0}).name == "elimination"
    assert "meet in a point" in robot.plan().reason
    many = Robot.load("gantry_robot_kin210").plan()
    assert (many.name, many.complete) == ("search", False)
    assert "9 axes are free" in many.reason
    with pytest.raises(AxisValueError, match="no axis 'A9'"):
        robot.plan(["A9"])


def test_the_plan_is_what_answers() -> None:
    robot = Robot.load("kr6r900")
    T = robot.fk([10.0, -80.0, 70.0, 0.0, 40.0, 30.0])
    for held in ({}, {"A4": 0.0}):
        assert {branch.method for branch in robot.ik_all(T, held=held)} == {robot.plan(held).name}


def test_branches_are_arrays_and_a_sequence() -> None:
    robot = Robot.load("tx2_60")
    found = robot.ik_all(robot.fk(AXES), AXES)
    assert found.axes.shape == (len(found), 6)
    assert len(found) > 4
    assert found.status_bits is not None
    assert found.turn_bits is not None
    for n, branch in enumerate(found):
        assert isinstance(branch, Branch)
        assert np.array_equal(branch.axes, found.axes[n])
        assert (branch.status_bits, branch.turn_bits) == (found.status_bits[n], found.turn_bits[n])
        assert (branch.position_error, branch.rotation_error) == (found.position_error[n], found.rotation_error[n])
        assert branch.success
        assert branch.method == found.method == "spherical wrist"
    assert np.array_equal(found[-1].axes, found.axes[-1])
    assert len(found[1:3]) == 2
    with pytest.raises(IndexError):
        found[len(found)]
    assert "by spherical wrist" in repr(found)
    assert not robot.ik_all(np.array([[1, 0, 0, 9.0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]))


def test_all_branches_of_many_poses_through_the_robot() -> None:
    robot = Robot.load("kr6r900")
    T = robot.fk(AXES)
    assert np.array_equal(robot.ik_all_batch([T]), chainbuild.ik_all_batch(robot, [T]), equal_nan=True)


@pytest.mark.parametrize("kind", [Robot, Mechanism])
def test_only_a_chain_becomes_a_robot(kind: type[Mechanism]) -> None:
    for other in ("kr6r900", chainbuild.load("kr6r900"), None):
        with pytest.raises(ChainbuildError, match=rf"expected a Chain, got {type(other).__name__};.*Robot\.load"):
            kind(other)


def test_one_held_axis_needs_no_list() -> None:
    robot = Robot.load("kr6r900")
    assert robot.plan("A4") == robot.plan(["A4"]) != robot.plan()


@pytest.mark.parametrize("kind", [IkResult, Branches])
def test_what_is_made_quickly_is_what_the_constructor_makes(kind: type[IkResult] | type[Branches]) -> None:
    quick: Any = {IkResult: quick_result, Branches: quick_made}[kind]
    named: Any = {IkResult: {"reason": "why"}, Branches: {"method": "how"}}[kind]
    own = fields(kind)
    given = [f"{each.name} given" for each in own if each.default is MISSING]
    made: Any = quick(*given)
    assert type(made) is kind
    assert [getattr(made, each.name) for each in own] == [getattr(kind(*given), each.name) for each in own]
    with pytest.raises(FrozenInstanceError):
        setattr(made, own[0].name, "other")
    changed: Any = replace(made, **named)
    assert [getattr(changed, name) for name in named] == list(named.values())
    assert getattr(pickle.loads(pickle.dumps(made)), own[0].name) == given[0]
