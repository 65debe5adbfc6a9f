"""Joints that follow one other joint, and how they are written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild.chain.followers import followers

# A hollow wrist: the second half of axis 5 turns back by as much as the first half turns.
HOLLOW = """<robot name="hollow"><link name="l0"/><link name="l1"/><link name="l2"/><link name="l3"/>
<joint name="joint4" type="revolute"><parent link="l0"/><child link="l1"/><origin xyz="0 0 0.5"/><axis xyz="0 0 1"/>
<limit lower="-3" upper="3" effort="1" velocity="1"/></joint>
<joint name="joint5" type="revolute"><parent link="l1"/><child link="l2"/><origin xyz="0 0 0.2"/><axis xyz="0 1 0"/>
<limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
<joint name="joint5b" type="revolute"><parent link="l2"/><child link="l3"/><origin xyz="0 0 0.1" rpy="0.3 0 0"/>
<axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="1" velocity="1"/><mimic joint="joint5" multiplier="-1"
offset="0.25"/></joint></robot>"""


def test_an_inclined_saw_follows_its_vertical_axis(tmp_path: Path) -> None:
    robot = chainbuild.Robot.load("inclined_saw_kin207")
    [(joint, (leader, factor, offset))] = followers(robot.chain).items()
    assert (joint, leader) == ("plunge", "Z")
    names = [one.name for one in robot.chain.joints]
    for axes in np.random.default_rng(1).uniform(-100, 100, (5, 4)):
        q = dict(zip(names, robot.q(axes), strict=True))
        assert q["plunge"] == pytest.approx(factor * q["Z"] + offset, abs=1e-12)
    path = chainbuild.write_urdf(robot, tmp_path)
    assert path.read_text("utf-8").count("<mimic") == 1
    assert pin.buildModelFromUrdf(str(path), mimic=True).nq == 4


def test_a_joint_of_several_axes_follows_none() -> None:
    assert followers(chainbuild.load("palletiser_kin96").chain()) == {}
    assert followers(chainbuild.load("tripod_kin12").chain()) == {}


def test_a_hollow_wrist_comes_back_as_it_was(tmp_path: Path) -> None:
    file = tmp_path / "hollow.urdf"
    file.write_text(HOLLOW, "utf-8")
    first = chainbuild.Robot(chainbuild.from_urdf(file))
    assert followers(first.chain) == {"joint5b": ("joint5", -1.0, pytest.approx(0.25))}
    path = chainbuild.write_urdf(first, tmp_path / "out")
    second = chainbuild.Robot(chainbuild.from_urdf(path, tool="tool"))
    assert [axis.name for axis in second.axes] == ["joint4", "joint5"]
    model = pin.buildModelFromUrdf(str(file), mimic=True)
    data = model.createData()
    for axes in np.random.default_rng(2).uniform(-90, 90, (5, 2)):
        pin.framesForwardKinematics(model, data, np.radians(axes))
        expected = data.oMf[model.getFrameId("l3")].homogeneous
        for robot in (first, second):
            np.testing.assert_allclose(robot.fk(axes).homogeneous, expected, rtol=0, atol=1e-12)
