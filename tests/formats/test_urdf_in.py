"""Robots from URDF: the same poses as Pinocchio's own reader, every joint kind, and errors with a line."""

from __future__ import annotations

import importlib.metadata
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild.errors import ChainbuildError, FileAccessError, ParseError
from tests.kit.paths import TESTS

BENCH = TESTS / "bench"

BRANCHED = """<robot name="two arms">
  <link name="base"/><link name="slide"/><link name="upper"/><link name="fore"/><link name="hand"/><link name="camera"/>
  <joint name="X" type="prismatic"><origin xyz="0.1 0 0"/><parent link="base"/><child link="slide"/>
    <axis xyz="1 0 0"/><limit lower="-0.5" upper="1.5" effort="0" velocity="0.25"/></joint>
  <joint name="A" type="continuous"><origin rpy="0.1 0.2 0.3"/><parent link="slide"/><child link="upper"/>
    <axis xyz="0 2 0"/></joint>
  <joint name="B" type="revolute"><origin xyz="0 0 0.4"/><parent link="upper"/><child link="fore"/>
    <axis xyz="0 0 -1"/><mimic joint="A" multiplier="-2" offset="0.5"/></joint>
  <joint name="C" type="revolute"><parent link="fore"/><child link="hand"/></joint>
  <joint name="fixed" type="fixed"><origin xyz="0 1 0"/><parent link="slide"/><child link="camera"/></joint>
</robot>"""


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "robot.urdf"
    path.write_text(text)
    return path


def examples() -> Path:
    files = importlib.metadata.files("example-robot-data") or []
    found = next(file for file in files if str(file).endswith("ur_description/urdf/ur5_robot.urdf"))
    return Path(str(found.locate())).resolve().parents[2]


@pytest.mark.parametrize(
    ("path", "tool", "count"),
    [
        (examples() / "ur_description/urdf/ur5_robot.urdf", "tool0", 6),
        (examples() / "ur_description/urdf/ur10_robot.urdf", "ee_link", 6),
        (examples() / "panda_description/urdf/panda.urdf", "panda_link8", 7),
        (BENCH / "kr6r700.urdf", "tool0", 6),
    ],
    ids=lambda value: getattr(value, "stem", str(value)),
)
def test_poses_are_those_of_pinocchios_reader(path: Path, tool: str, count: int) -> None:
    robot = chainbuild.Robot(chainbuild.from_urdf(path, tool=tool))
    model = pin.buildModelFromUrdf(str(path))
    data, rng = model.createData(), np.random.default_rng(0)
    assert len(robot.axes) == count
    for _ in range(20):
        values = {axis.name: rng.uniform(axis.lower, axis.upper) for axis in robot.axes}
        q = pin.neutral(model)
        for name, value in values.items():
            q[model.joints[model.getJointId(name)].idx_q] = np.radians(value)
        pin.framesForwardKinematics(model, data, q)
        expected = data.oMf[model.getFrameId(tool)].homogeneous
        np.testing.assert_allclose(robot.fk(list(values.values())).homogeneous, expected, atol=1e-12)


def test_limits_and_speeds_are_shown_in_mm_and_degrees(tmp_path: Path) -> None:
    robot = chainbuild.Robot(chainbuild.from_urdf(written(tmp_path, BRANCHED), tool="hand"))
    X, A, C = robot.axes
    assert (X.name, X.kind, X.lower, X.upper, X.assumed, X.max_speed) == ("X", "linear", -500.0, 1500.0, False, 250.0)
    assert (A.name, A.endless, A.assumed) == ("A", True, True)
    assert (C.name, C.assumed, C.max_speed) == ("C", True, None)
    assert robot.chain.name == "two_arms"
    assert robot.chain.title == "two arms"


def test_a_mimic_joint_is_driven_by_the_axis_it_names(tmp_path: Path) -> None:
    robot = chainbuild.Robot(chainbuild.from_urdf(written(tmp_path, BRANCHED), tool="hand"))
    np.testing.assert_allclose(
        robot.q([100.0, 30.0, 10.0]), [0.1, np.radians(30.0), 0.5 - 2 * np.radians(30.0), np.radians(10.0)]
    )


def test_other_branches_are_left_out_and_the_tool_must_be_clear(tmp_path: Path) -> None:
    path = written(tmp_path, BRANCHED)
    assert [axis.name for axis in chainbuild.from_urdf(path, tool="camera").axes] == ["X"]
    with pytest.raises(ChainbuildError, match="2 links could be the tool") as caught:
        chainbuild.from_urdf(path)
    assert caught.value.permitted == "camera, hand"
    assert 'tool="hand"' in str(caught.value)
    with pytest.raises(ChainbuildError, match="no joint leads to a link 'finger'"):
        chainbuild.from_urdf(path, tool="finger")


def test_without_a_tool_the_only_end_is_taken() -> None:
    assert len(chainbuild.from_urdf(BENCH / "kr6r700.urdf").axes) == 6


def test_solvers_take_it(tmp_path: Path) -> None:
    robot = chainbuild.Robot(chainbuild.from_urdf(examples() / "panda_description/urdf/panda.urdf", tool="panda_link8"))
    rng = np.random.default_rng(2)
    axes = np.array([[rng.uniform(axis.lower, axis.upper) for axis in robot.axes] for _ in range(200)])
    found = robot.ik_batch(robot.fk_batch(axes))
    assert found.success.all()
    assert chainbuild.write_urdf(robot, tmp_path).is_file()


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("<robot>", 1, "not well-formed"),
        ("hello", 1, "not well-formed"),
        ("<mujoco/>", None, "no <robot> element"),
        ('<!DOCTYPE robot [<!ENTITY a "b">]><robot/>', 1, "document type"),
        ('<robot>\n<joint name="a" type="revolute"><parent link="p"/></joint></robot>', 2, "lacks <child>"),
        ('<robot>\n<joint name="a" type="ball"><parent link="p"/><child link="c"/></joint></robot>', 2, "of type ball"),
        ('<robot>\n<joint name="a"><parent link="p"/><child link="c"/></joint></robot>', 2, "lacks the attribute type"),
        (
            '<robot>\n<joint name="a" type="fixed"><parent link="p"/><child link="c"/>\n<origin xyz="0 0 nan"/>'
            "</joint></robot>",
            3,
            "xyz=",
        ),
        (
            '<robot>\n<joint name="a" type="revolute"><parent link="p"/><child link="c"/><axis xyz="0 0 0"/>'
            "</joint></robot>",
            2,
            "is the zero vector",
        ),
        (
            '<robot><joint name="a" type="fixed"><parent link="p"/><child link="c"/></joint>\n'
            '<joint name="b" type="fixed"><parent link="c"/><child link="p"/></joint></robot>',
            2,
            "is its own ancestor|links could be the tool",
        ),
        ("<a>" * 100, 1, "too deep"),
    ],
)
def test_what_is_no_urdf_is_refused_with_its_line(tmp_path: Path, text: str, line: int | None, message: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(ChainbuildError, match=message) as caught:
        chainbuild.from_urdf(path, tool="c" if "links could" not in message else "p")
    assert caught.value.line == line
    assert caught.value.file == str(path)


def test_an_unknown_mimic_and_a_missing_file(tmp_path: Path) -> None:
    with pytest.raises(ChainbuildError, match="joint B mimics joint Z, which the file does not have"):
        chainbuild.from_urdf(written(tmp_path, BRANCHED.replace('mimic joint="A"', 'mimic joint="Z"')), tool="hand")
    with pytest.raises(FileAccessError):
        chainbuild.from_urdf(tmp_path / "none.urdf")
    assert issubclass(ParseError, ChainbuildError)


@pytest.mark.parametrize("name", ["status", "X_mm", "is", "A_drive", "tool"])
def test_joints_whose_names_mean_other_things_are_renamed(tmp_path: Path, name: str) -> None:
    text = """<robot name="r"><link name="base"/><link name="end"/><joint name="NAME" type="revolute">
<parent link="base"/><child link="end"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
    robot = chainbuild.Robot.from_urdf(written(tmp_path, text.replace("NAME", name)), tool="end")
    assert [(axis.name, axis.generic) for axis in robot.axes] == [(f"{name}_joint", name)]
    with pytest.raises(ChainbuildError, match="the axis is called"):
        chainbuild.Robot(replace(robot.chain, axes=(replace(robot.axes[0], name=name, generic=""),)))


def test_an_angle_beyond_all_numbers_is_refused(tmp_path: Path) -> None:
    text = """<robot name="r"><link name="base"/><link name="end"/><joint name="A" type="revolute">
<parent link="base"/><child link="end"/><origin rpy="1e308 0.5 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""
    with pytest.raises(ParseError, match="joint A is turned by too much") as caught:
        chainbuild.Robot.from_urdf(written(tmp_path, text), tool="end")
    assert caught.value.span is not None
    assert caught.value.span.line == 2
