"""URDF is read back by two independent readers with the same pose; it is the same bytes each time."""

from __future__ import annotations

import io
import math
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
import yourdfpy

import chainbuild
from chainbuild.chain import assemble as recipe
from chainbuild.chain.bodies.shapes import solid_bodies
from chainbuild.chain.elements import Axis, Chain, Frame, Loop
from chainbuild.convention import UsedConvention, conventions
from chainbuild.drawing.machine import drawn_bodies
from chainbuild.errors import ChainError, FileAccessError
from chainbuild.frames import rot_x, rot_y, rot_z, urdf_rpy
from chainbuild.robot import Robot
from chainbuild.writers.models.urdf import joint_speeds, urdf_limitations, urdf_text, write_urdf
from tests.kit.draws import random_axes
from tests.kit.sample_chains import arm, chain_of, rotary_axis, table_machine

SAMPLES: dict[str, Callable[[], Chain]] = {
    "arm": arm,
    "skew_arm": lambda: arm(37.123456789),
    "near_right_angles": lambda: arm(270.0 + 1e-7),
    "table": table_machine,
}
SHIPPED: dict[str, Callable[[], Chain]] = {
    name: (lambda name=name: chainbuild.load(name).chain()) for name in chainbuild.shipped()
}
ALL = [pytest.param(make, id=name) for name, make in {**SAMPLES, **SHIPPED}.items()]


def by_name(robot: Robot, q: np.ndarray) -> dict[str, float]:
    return {joint.name: float(value) for joint, value in zip(robot.chain.joints, q, strict=True)}


@pytest.mark.parametrize("make", ALL)
def test_pinocchio_reads_the_same_pose(make: Callable[[], Chain], tmp_path: Path) -> None:
    robot = chainbuild.Robot(make())
    model = pin.buildModelFromUrdf(str(write_urdf(robot, tmp_path)))
    data = model.createData()
    assert model.nq == model.nv == robot.model.nq
    rng = np.random.default_rng(1)
    for _ in range(200):
        axes = random_axes(robot, rng)
        q = np.zeros(model.nq)
        for name, value in by_name(robot, robot.q(axes)).items():
            q[model.joints[model.getJointId(name)].idx_q] = value
        pin.framesForwardKinematics(model, data, q)
        tool, workpiece = (data.oMf[model.getFrameId(name)] for name in ("tool", "workpiece"))
        T = workpiece.actInv(tool).homogeneous
        assert np.abs(T - robot.fk(axes).homogeneous).max() <= 1e-12


@pytest.mark.parametrize("make", ALL)
def test_yourdfpy_reads_the_same_pose(make: Callable[[], Chain], tmp_path: Path) -> None:
    robot = chainbuild.Robot(make())
    path = write_urdf(robot, tmp_path)
    model = yourdfpy.URDF.load(str(path), build_scene_graph=True, load_meshes=False)
    assert model.validate()
    rng = np.random.default_rng(2)
    for _ in range(20):
        axes = random_axes(robot, rng)
        model.update_cfg(by_name(robot, robot.q(axes)))
        T = model.get_transform("tool", "workpiece")
        assert np.abs(T - robot.fk(axes).homogeneous).max() <= 1e-12


def test_siblings_are_mapped_by_name(tmp_path: Path) -> None:
    """The reader sorts siblings: a position in q says nothing about the joint."""
    robot = chainbuild.Robot(table_machine())
    model = pin.buildModelFromUrdf(str(write_urdf(robot, tmp_path)))
    ours, theirs = list(robot.model.names)[1:], list(model.names)[1:]
    assert sorted(ours) == sorted(theirs)
    assert ours != theirs


def test_limits_and_speeds_are_those_of_the_model(tmp_path: Path) -> None:
    robot = chainbuild.Robot(table_machine())
    model = pin.buildModelFromUrdf(str(write_urdf(robot, tmp_path)))
    for n, joint in enumerate(robot.chain.joints):
        k = model.joints[model.getJointId(joint.name)].idx_q
        assert model.lowerPositionLimit[k] == pytest.approx(robot.model.lowerPositionLimit[n], abs=1e-13)
        assert model.upperPositionLimit[k] == pytest.approx(robot.model.upperPositionLimit[n], abs=1e-13)
    # Y has a speed of 500 mm/s; X and A have none and take the default.
    assert dict(zip("YXZBA", joint_speeds(robot.chain), strict=True)) == {
        "Y": 0.5, "X": 1.0, "Z": 1.0, "B": math.pi, "A": math.pi
    }  # fmt: skip


def bare_of_drawing(chain: Chain) -> list[str]:
    """Return the links that nothing is drawn of: those that only carry freedoms of a platform."""
    drawn = {body.link for body in drawn_bodies(chain)}
    return [link.name for link in chain.links if link.name not in drawn]


@pytest.mark.parametrize("make", ALL)
def test_structure(make: Callable[[], Chain]) -> None:
    chain = make()
    root = ET.fromstring(urdf_text(chainbuild.Robot(chain)))
    assert root.get("name") == chain.name
    links = [link.get("name") for link in root.iter("link")]
    assert links == [*(link.name for link in chain.links), *(f.name for f in chain.frames if f.name != "base")]
    children = [element.get("link", "") for element in root.iter("child")]
    assert sorted(children) == sorted(set(links) - {"base"})
    kinds = {joint.get("type") for joint in root.findall("joint")}
    assert kinds <= {"revolute", "prismatic", "fixed"}
    tips = {"tool": "tool", "table": "workpiece"}
    solid = Counter(tips.get(body.part, body.link) for body in solid_bodies(chain))
    bare = set(bare_of_drawing(chain))
    for link in root.findall("link"):
        visuals = link.findall("visual")
        assert len(link.findall("visual/geometry/*")) == len(link.findall("visual/material")) == len(visuals)
        assert bool(visuals) != (link.get("name") in bare)
        assert len(link.findall("collision")) == solid[link.get("name", "")]
    materials = [material.get("name") for material in root.iter("material")]
    assert len(set(materials)) == len(materials)
    for element in root.iter():
        for value in element.attrib.values():
            assert "nan" not in value
            assert "-0 " not in f"{value} "


@pytest.mark.parametrize("make", ALL)
def test_same_bytes_each_time_and_after_a_flip_of_the_last_bit(make: Callable[[], Chain], tmp_path: Path) -> None:
    chain = make()
    first = write_urdf(chainbuild.Robot(chain), tmp_path / "a").read_bytes()
    assert write_urdf(chainbuild.Robot(chain), tmp_path / "b").read_bytes() == first
    assert b"\r" not in first
    if chain.name in chainbuild.shipped():
        shaken = replace(chain, joints=tuple(replace(j, T_parent_joint=shake(j.T_parent_joint)) for j in chain.joints))
        assert write_urdf(chainbuild.Robot(shaken), tmp_path / "c").read_bytes() == first


def shake(T: np.ndarray) -> np.ndarray:
    """Return a transform whose entries are off by as much as another processor's sums would be."""
    rng = np.random.default_rng(3)
    result = T.copy()
    result[:3] += rng.choice([-2e-16, 0.0, 2e-16], size=(3, 4))
    return result


@pytest.mark.parametrize("pitch_deg", [90.0, -90.0, 90.0 - 1e-6, 90.0 - 1e-9, -90.0 + 1e-11, 89.999999, 12.0])
@pytest.mark.parametrize("others_deg", [(0.0, 0.0), (30.0, -77.123), (180.0, 3.1234567891), (-180.0, 180.0)])
def test_rpy_is_exact_at_two_metres(pitch_deg: float, others_deg: tuple[float, float]) -> None:
    roll_deg, yaw_deg = others_deg
    R = rot_z(yaw_deg) @ rot_y(pitch_deg) @ rot_x(roll_deg)
    chain = chain_of(
        "lever",
        [rotary_axis("A")],
        [recipe.rotary("A", "z"), recipe.turn(R), recipe.mark("flange"), recipe.shift(2000.0, 0.0, 0.0)],
    )
    model = pin.buildModelFromXML(urdf_text(chainbuild.Robot(chain)))
    data = model.createData()
    pin.framesForwardKinematics(model, data, np.zeros(1))
    # The lever hangs on the turned flange, so that an angle error shows at its end.
    flange = data.oMf[model.getFrameId("flange")]
    end = flange.act(np.array([2.0, 1.0, -1.0]))
    assert np.abs(end - R @ [2.0, 1.0, -1.0]).max() <= 1e-12


def test_rpy_of_half_turns_has_one_spelling() -> None:
    for noise in (-1e-16, 0.0, 1e-16):
        R = rot_x(180.0) + np.array([[0, 0, 0], [0, 0, noise], [0, -noise, 0]])
        assert urdf_rpy(R)[0] == math.pi


def test_coupled_axes_loops_and_endless_axes_are_named() -> None:
    axes = [
        rotary_axis("G2"),
        rotary_axis("G3"),
        Axis("G4", "rotary", "deg", -360.0, 360.0, True, endless=True),
    ]
    tool = [
        recipe.rotary("G2", "y"),
        recipe.shift(z=500.0),
        recipe.rotary("G3", "y", drive={"G3": 1.0, "G2": -1.0}),
        recipe.rotary("hand", "y", drive={}, offset_deg=20.0),
        recipe.rotary("G4", "z"),
    ]
    chain = chain_of("coupled", axes, tool)
    chain = replace(chain, loops=(Loop("rod", "hinge", "flange", "tool"),))
    text = "\n".join(urdf_limitations(chain))
    for words in (
        "loop rod (hinge between flange and tool)",
        "joint G3 is driven by axes G2, G3",
        "axis G2 drives joints G2, G3 together",
        "joint hand has a fixed value",
        "axis G4 is endless",
        "limits of axis G4 are assumed",
    ):
        assert words in text
    head = urdf_text(chainbuild.Robot(chain))
    assert "q[G3] = (-G2 + G3)*pi/180" in head
    assert "q[hand] = 20*pi/180" in head
    assert all(line in head for line in urdf_limitations(chain))


def test_a_nonlinear_map_is_named() -> None:
    chain = arm()

    class Bent:
        def q(self, axes: Any) -> Any:
            return np.deg2rad(axes) ** 3

        def axes(self, q: Any) -> Any:
            return np.rad2deg(np.cbrt(q))

        def dq_daxes(self, axes: Any) -> Any:
            return np.diag(3.0 * np.deg2rad(axes) ** 2)

        def q_bounds(self, lower: Any, upper: Any) -> Any:
            return np.full(len(lower), -np.inf), np.full(len(upper), np.inf)

    robot = chainbuild.Robot(replace(chain, axis_map=Bent()))
    assert "nonlinear" in urdf_limitations(robot.chain)[0]
    text = urdf_text(robot)
    assert "nonlinear map" in text
    assert 'lower="-6.28318530717959" upper="6.28318530717959"' in text


def test_head_names_conventions_and_survives_odd_titles() -> None:
    name, convention = next(iter(conventions().items()))
    used = UsedConvention(convention, convention.default, False)
    chain = replace(arm(), title="Spindle --> <b>Stäubli</b> & \x01 --", conventions=(used,))
    text = urdf_text(chainbuild.Robot(chain))
    assert f"{name}={convention.default} [{convention.mark}] (default)" in text
    builder = ET.TreeBuilder(insert_comments=True)
    parsed = ET.parse(io.StringIO(text), ET.XMLParser(target=builder)).getroot()
    assert "Stäubli" in (parsed[0].text or "")


def test_a_frame_named_like_a_link_is_refused() -> None:
    chain = arm()
    clash = replace(chain, frames=(*chain.frames, Frame("Z1_link", "base", np.eye(4))))
    with pytest.raises(ChainError, match="Z1_link"):
        urdf_text(chainbuild.Robot(clash))


def test_path_and_trouble(tmp_path: Path) -> None:
    robot = chainbuild.Robot(arm())
    assert write_urdf(robot, tmp_path) == tmp_path / "arm" / "arm.urdf"
    (tmp_path / "file").write_text("", "utf-8")
    with pytest.raises(FileAccessError):
        write_urdf(robot, tmp_path / "file")
