"""Parameters of ortho-parallel arms as py-opw-kinematics takes them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import py_opw_kinematics
import pytest
import yaml

import chainbuild
from chainbuild.errors import ChainbuildError
from chainbuild.machines import shipped
from chainbuild.robot import Robot
from chainbuild.writers.models.opw import _half_turn, opw_text
from chainbuild.writers.models.robotfiles import yaml_number
from tests.kit.draws import random_axes

ARMS = (
    "comau_calibrated", "irb2600", "kr6r900", "kr6r900_2", "parallelogram_nr", "tx2_60",
)  # fmt: skip


def placement(given: dict[str, list[float]]) -> np.ndarray:
    roll, pitch, yaw = given["rpy"]
    turns = []
    for (i, j), angle in zip(((0, 1), (2, 0), (1, 2)), (yaw, pitch, roll), strict=True):
        R = np.eye(3)
        R[i, i] = R[j, j] = np.cos(angle)
        R[i, j], R[j, i] = -np.sin(angle), np.sin(angle)
        turns.append(R)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = turns[0] @ turns[1] @ turns[2], given["xyz"]
    return T


@pytest.mark.parametrize("name", ARMS)
def test_py_opw_computes_the_poses(name: str, tmp_path: Path) -> None:
    robot = Robot.load(name)
    path = chainbuild.export(robot, tmp_path, formats=["opw"])["opw"]
    assert path.name == f"{name}.opw.yaml"
    read = yaml.safe_load(path.read_text("utf-8"))
    lengths = read["opw_kinematics_geometric_parameters"]
    signs = read["opw_kinematics_joint_sign_corrections"]
    offsets = np.array(read["opw_kinematics_joint_offsets"])
    own = read["chainbuild"]
    assert own["joints"] == [joint.name for joint in robot.chain.joints]
    assert set(signs) <= {1, -1}
    model = py_opw_kinematics.Robot(
        py_opw_kinematics.KinematicModel(**lengths, offsets=tuple(offsets), flip_axes=tuple(s < 0 for s in signs)),
        degrees=False,
    )
    base, tool = placement(own["base"]), placement(own["tool"])
    rng = np.random.default_rng(5)
    for _ in range(50):
        axes = random_axes(robot, rng)
        T = base @ np.array(model.forward(tuple(robot.q(axes))).as_matrix()) @ tool
        np.testing.assert_allclose(T, robot.fk(axes).homogeneous, rtol=0, atol=1e-12)


def test_the_flange_of_a_known_arm() -> None:
    text = opw_text(Robot.load("kr6r900"))
    assert text is not None
    assert yaml.safe_load(text)["opw_kinematics_geometric_parameters"] == {
        "a1": 0.025, "a2": -0.035, "b": 0.0, "c1": 0.4, "c2": 0.455, "c3": 0.42, "c4": 0.08,
    }  # fmt: skip


def test_which_machines_have_them(tmp_path: Path) -> None:
    assert tuple(name for name in shipped() if opw_text(Robot.load(name)) is not None) == ARMS
    robot = Robot.load("ca_head_kin9")
    with pytest.raises(ChainbuildError, match="no opw parameters of this kinematic"):
        chainbuild.export(robot, tmp_path, formats=["urdf", "opw"])
    assert list(tmp_path.iterdir()) == []
    assert set(chainbuild.export(robot, tmp_path, samples=10)) == {"urdf", "mjcf", "srdf", "report"}


@pytest.mark.parametrize(
    ("angle", "wanted"), [(-np.pi, np.pi), (3 * np.pi, np.pi), (-3.5 * np.pi, 0.5 * np.pi), (-1.0, -1.0)]
)
def test_offsets_lie_within_half_a_turn_and_half_a_turn_is_positive(angle: float, wanted: float) -> None:
    assert _half_turn(angle) == pytest.approx(wanted, abs=1e-12)


def test_tiny_numbers_are_numbers_for_readers_of_yaml() -> None:
    """YAML 1.1 takes 5e-06 for a text."""
    chain = chainbuild.load("kr6r900").chain()
    T = chain.joints[1].T_parent_joint.copy()
    T[0, 3] = 5e-6
    robot = Robot(
        replace(chain, joints=(chain.joints[0], replace(chain.joints[1], T_parent_joint=T), *chain.joints[2:]))
    )
    text = opw_text(robot)
    assert text is not None
    read = yaml.safe_load(text)
    numbers = [*read["opw_kinematics_geometric_parameters"].values(), *read["opw_kinematics_joint_offsets"]]
    numbers += [value for place in ("base", "tool") for part in read["chainbuild"][place].values() for value in part]
    assert "e-06" in text
    assert all(isinstance(value, float) for value in numbers)
    assert [yaml_number(one) for one in ("5e-06", "-1e-13", "5.5e-06", "7", "0.25")] == [
        "5.0e-06", "-1.0e-13", "5.5e-06", "7", "0.25",
    ]  # fmt: skip
