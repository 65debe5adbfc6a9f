"""Named poses in SRDF, read back."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.analysis.collision.pairs import classify_pairs
from chainbuild.chain.programmed.named import NamedPose
from chainbuild.writers.models.srdf import srdf_text
from chainbuild.writers.models.urdf import urdf_text, write_urdf


def with_poses(name: str, **poses: tuple[float, ...]) -> chainbuild.Robot:
    chain = chainbuild.load(name).chain()
    return chainbuild.Robot(replace(chain, named_poses=tuple(NamedPose(*one) for one in poses.items())))


def states(robot: chainbuild.Robot) -> tuple[list[str], dict[str, dict[str, float]]]:
    """Return the joints of the one group, and the joint values of each state."""
    root = ET.fromstring(srdf_text(robot, classify_pairs(robot, samples=3)))
    (group,) = root.findall("group")
    assert {state.get("group") for state in root.findall("group_state")} == {group.get("name")} == {"axes"}
    joints = [joint.get("name", "") for joint in group.findall("joint")]
    found = {
        state.get("name", ""): {one.get("name", ""): float(one.get("value", "")) for one in state.findall("joint")}
        for state in root.findall("group_state")
    }
    return joints, found


def test_a_state_puts_the_urdf_where_the_pose_is(tmp_path: Path) -> None:
    axes = (10.0, -80.0, 70.0, 20.0, 30.0, -40.0)
    robot = with_poses("irb2600", park=axes, zero=(0.0,) * 6)
    joints, found = states(robot)
    assert list(found) == ["park", "zero"]
    assert list(found["park"]) == joints
    urdf = chainbuild.Robot(chainbuild.from_urdf(write_urdf(robot, tmp_path), tool="tool"))
    assert joints == [axis.name for axis in urdf.axes]
    read = urdf.fk(np.degrees([found["park"][name] for name in joints]))
    workpiece = robot.frame_placements(axes)["workpiece"]
    np.testing.assert_allclose(read.homogeneous, (workpiece * robot.fk(axes)).homogeneous, atol=1e-9)


def test_closed_loops_stand_as_they_close_or_are_left_out() -> None:
    robot = with_poses("delta_kin37", open=(180.0, 0.0, 0.0), closed=(5.0, 10.0, 15.0))
    joints, found = states(robot)
    assert list(found) == ["closed"]
    assert joints == [joint.name for joint in robot.chain.joints]
    np.testing.assert_allclose(list(found["closed"].values()), robot.q([5.0, 10.0, 15.0]), atol=1e-9)


def test_rods_follow_and_have_no_value(tmp_path: Path) -> None:
    overlay = tmp_path / "rods.toml"
    overlay.write_text("[geometry]\nrods = true\n[poses]\npark = [0, 10, -80, 0, 30, 0]\n", "utf-8")
    robot = chainbuild.Robot(chainbuild.load("parallelogram_nr", overlay=overlay).chain())
    joints, found = states(robot)
    urdf = ET.fromstring(urdf_text(robot))
    following = [joint.get("name") for joint in urdf.findall("joint") if joint.find("mimic") is not None]
    assert len(following) == 2
    assert [joint.name for joint in robot.chain.joints if joint.name not in joints] == following
    assert list(found["park"]) == joints


def test_the_group_of_axes_stands_there_without_poses() -> None:
    robot = chainbuild.Robot.load("irb2600")
    root = ET.fromstring(srdf_text(robot, classify_pairs(robot, samples=3)))
    [group] = root.findall("group")
    assert [joint.get("name") for joint in group.findall("joint")] == [joint.name for joint in robot.chain.joints]
    assert [link.get("name") for link in group.findall("link")] == ["tool"]
    assert root.find("group_state") is None


def test_reasons_stand_with_their_confidence(tmp_path: Path) -> None:
    robot = chainbuild.Robot.load("kr6r900")
    text = chainbuild.write_srdf(robot, tmp_path, samples=59).read_text("utf-8")
    assert "Never: they touched at none of 59 positions, and with 95% confidence touch at less than 0.05 of all" in text
    assert text.index("Never: ") < text.index('reason="Never"')
    assert "Adjacent: a joint connects them" in text


def test_linear_axes_are_metres() -> None:
    robot = with_poses("ca_head_kin9", park=(100.0, -200.0, -50.0, 90.0, 45.0))
    _, found = states(robot)
    linear = [found["park"][joint.name] for joint in robot.chain.joints if joint.kind == "prismatic"]
    assert sorted(linear) == pytest.approx([-0.2, -0.05, 0.1])
