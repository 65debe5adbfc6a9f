"""Files as an outsider reads them: by URDF, NAME.loops.yaml and the values that a controller shows alone."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pinocchio as pin
import pytest
import yaml
import yourdfpy

import chainbuild
from chainbuild.chain.axismap import Block, BlockMap
from chainbuild.chain.compose import follow
from chainbuild.formats.twincat.axis_offsets import ShiftedMap
from chainbuild.formats.twincat.maps.heads import SpatialAnglesMap, VirtualTurnMap
from chainbuild.formats.twincat.maps.length import NozzleLaw, TiltLengthMap
from chainbuild.kinematics.closure import closing_axes
from chainbuild.machines import shipped
from chainbuild.robot import Robot
from chainbuild.writers.models.loops import formulas_of, loop_files
from chainbuild.writers.models.mjcf import mjcf_text
from chainbuild.writers.models.srdf import pair_table, srdf_text

WORDS = {name: getattr(math, name) for name in ("sin", "cos", "asin", "atan2", "copysign", "pi")} | {
    "min": min,
    "max": max,
    "round": round,
}
KNOWN_PARTS = 60  # of the way from the closed state of the file to another one


class Outsider:
    """Reads a folder that chainbuild has written, and computes poses by controller values."""

    def __init__(self, folder: Path) -> None:
        [urdf] = folder.glob("*.urdf")
        self.text = urdf.read_text("utf-8")
        self.path = urdf
        self.tree = ET.fromstring(self.text)
        self.joints = {
            joint.attrib["name"]: joint for joint in self.tree.iter("joint") if joint.attrib["type"] != "fixed"
        }
        self.model = pin.buildModelFromUrdf(str(urdf))
        self.data = self.model.createData()
        extra = urdf.with_name(f"{urdf.stem}.loops.yaml")
        self.extra: dict[str, Any] | None = yaml.safe_load(extra.read_text("utf-8")) if extra.exists() else None

    def values(self, names: list[str], axes: np.ndarray) -> dict[str, float]:
        """Return joint values of what the controller shows."""
        if self.extra is None:
            return {
                name: float(value) * (math.pi / 180 if self.joints[name].attrib["type"] == "revolute" else 0.001)
                for name, value in zip(names, axes, strict=True)
            }
        own = self.extra["chainbuild"]
        assert own["version"] == 1
        assert [axis["name"] for axis in own["axes"]] == names
        found = self._driven(own, axes)
        return self._closed(own, found, axes) if self.extra["closed_loop"] else found

    def _driven(self, own: dict[str, Any], axes: np.ndarray) -> dict[str, float]:
        known = dict(WORDS)
        for axis, value in zip(own["axes"], axes, strict=True):
            known[axis["symbol"]] = float(value) * axis["factor"]
        for name, expression in own.get("steps", []):
            known[name] = eval(expression, {"__builtins__": {}}, known)
        return {name: float(eval(text, {"__builtins__": {}}, known)) for name, text in own["joints"].items()}

    def _closed(self, own: dict[str, Any], driven: dict[str, float], axes: np.ndarray) -> dict[str, float]:
        start = own["assembly"]["joints"]
        state = {name: float(start[name]) for name in self.joints}
        first = {name: state[name] for name in driven}
        for k in range(1, KNOWN_PARTS + 1):
            for name, value in driven.items():
                state[name] = first[name] + (value - first[name]) * k / KNOWN_PARTS
            miss = self._close(state, own["passive"])
        assert miss < 1e-12, axes
        return state

    def _close(self, state: dict[str, float], passive: list[str]) -> float:
        assert self.extra is not None
        pairs = [[self.model.getFrameId(name) for name in pair] for pair in self.extra["closed_loop"]]
        assert set(self.extra["type"]) == {"3D"}
        columns = [self.model.joints[self.model.getJointId(name)].idx_v for name in passive]
        for _ in range(30):
            pin.computeJointJacobians(self.model, self.data, self.q(state))
            pin.updateFramePlacements(self.model, self.data)
            error, rows = [], []
            for a, b in pairs:
                error.append(self.data.oMf[a].translation - self.data.oMf[b].translation)
                J = [pin.getFrameJacobian(self.model, self.data, f, pin.LOCAL_WORLD_ALIGNED)[:3] for f in (a, b)]
                rows.append((J[0] - J[1])[:, columns])
            miss = float(np.abs(error).max())
            if miss < 1e-14:
                break
            step = np.linalg.lstsq(np.vstack(rows), -np.concatenate(error), rcond=1e-9)[0]
            for name, value in zip(passive, step.tolist(), strict=True):
                state[name] += value
        return miss

    def q(self, values: dict[str, float]) -> np.ndarray:
        q = np.zeros(self.model.nq)
        for name, value in values.items():
            q[self.model.joints[self.model.getJointId(name)].idx_q] = value
        return q

    def by_pinocchio(self, values: dict[str, float]) -> np.ndarray:
        pin.framesForwardKinematics(self.model, self.data, self.q(values))
        tips = [self.data.oMf[self.model.getFrameId(name)] for name in ("workpiece", "tool")]
        return tips[0].actInv(tips[1]).homogeneous


def written(name: str, folder: Path) -> tuple[Robot, Outsider]:
    robot = Robot.load(name)
    return robot, Outsider(chainbuild.write_urdf(robot, folder).parent)


def draws(robot: Robot, count: int) -> np.ndarray:
    """Return axis values at which the kinematic has a pose."""
    rng = np.random.default_rng(3)
    if robot.chain.loops:
        return closing_axes(robot, rng, count)
    lower, upper = np.array([axis.range for axis in robot.axes]).T
    return lower + (upper - lower) * rng.random((count, len(lower)))


def read_alone(robot: Robot, folder: Path, count: int) -> dict[str, Any]:
    """Compare the poses of one reader with those of a robot, and return what stands in the file beside the URDF."""
    outsider = Outsider(chainbuild.write_urdf(robot, folder).parent)
    names = [axis.name for axis in robot.axes]
    for axes in draws(robot, count):
        found, wanted = outsider.by_pinocchio(outsider.values(names, axes)), robot.fk(axes).homogeneous
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-12 * reach(wanted))
    assert outsider.extra is not None
    start = outsider.extra["chainbuild"].get("assembly", {"axes": [], "joints": {}})
    assert all(isinstance(value, int | float) for value in (*start["axes"], *start["joints"].values()))
    return outsider.extra


def compare(name: str, folder: Path, count: int) -> None:
    """Compare the poses of three readers with those of the robot."""
    robot, outsider = written(name, folder)
    names = [axis.name for axis in robot.axes]
    theirs = yourdfpy.URDF.load(str(outsider.path), load_meshes=False, build_scene_graph=True)
    plain = outsider.text.replace("</robot>", '<mujoco><compiler fusestatic="false"/></mujoco></robot>')
    model = mujoco.MjModel.from_xml_string(plain)
    data = mujoco.MjData(model)
    for axes in draws(robot, count):
        wanted = robot.fk(axes).homogeneous
        values = outsider.values(names, axes)
        np.testing.assert_allclose(outsider.by_pinocchio(values), wanted, rtol=0, atol=1e-12 * reach(wanted))
        theirs.update_cfg({joint: values[joint] for joint in theirs.actuated_joint_names})
        # It takes a joint that has moved by less than 1e-8 for one that has not.
        dropped = 2.0 * sum(abs(value) for value in values.values() if abs(value) < 1e-8)
        np.testing.assert_allclose(theirs.get_transform("tool", "workpiece"), wanted, rtol=0, atol=1e-9 + dropped)
        for joint, value in values.items():
            data.joint(joint).qpos[0] = value
        mujoco.mj_kinematics(model, data)
        T = [np.eye(4), np.eye(4)]
        for one, tip in zip(T, ("workpiece", "tool"), strict=True):
            one[:3, :3], one[:3, 3] = data.body(tip).xmat.reshape(3, 3), data.body(tip).xpos
        np.testing.assert_allclose(np.linalg.inv(T[0]) @ T[1], wanted, rtol=0, atol=1e-9)


def reach(T: np.ndarray) -> float:
    """Return what a rounding error grows with: metres of the pose, at least one."""
    return max(1.0, float(np.abs(T[:3, 3]).max()))


@pytest.mark.parametrize("name", shipped())
def test_three_readers_agree(name: str, tmp_path: Path) -> None:
    compare(name, tmp_path, 3)


@pytest.mark.slow
@pytest.mark.parametrize("name", shipped())
def test_three_readers_agree_on_a_thousand(name: str, tmp_path: Path) -> None:
    compare(name, tmp_path, 1000)


def test_only_what_is_not_plain_gets_a_file() -> None:
    assert loop_files(Robot.load("kr6r900")) == {}
    assert list(loop_files(Robot.load("palletiser_kin96"))) == ["palletiser_kin96.loops.yaml"]


@pytest.mark.parametrize("slides", ["x1_carries_c", "x2_carries_c"])
@pytest.mark.parametrize(("side", "along"), [("left", "x"), ("right", "y")])
def test_a_gripper_that_counts_from_x_is_turned_back_by_its_arm(
    side: str, along: str, slides: str, tmp_path: Path
) -> None:
    chosen = {"kin21_c_zero": "along_x", "kin21_side": side, "kin21_slides": slides, "kin21_hd5_along": along}
    robot = Robot(chainbuild.load("lambda_kin21").chain(conventions=chosen))
    extra = read_alone(robot, tmp_path, 5)
    assert sorted(extra["name_mot"]) == ["C_turn", "X1", "X2", "Z"]
    assert sorted(extra["chainbuild"]["passive"]) == ["phi", "theta"]
    passive = re.findall('passive_joint name="(.*?)"', srdf_text(robot, pair_table(robot, 1)))
    assert sorted(passive) == ["phi", "theta"]


@pytest.mark.parametrize("pair", [("tripod_kin12", "palletiser_kin96"), ("inclined_saw_kin207", "lambda_kin21")])
def test_couplings_beside_loops_are_not_forgotten(pair: tuple[str, str], tmp_path: Path) -> None:
    first, second = (chainbuild.load(name).chain() for name in pair)
    robot = Robot(follow(first, workpiece_of=second))
    read_alone(robot, tmp_path, 3)
    mujoco.MjModel.from_xml_string(mjcf_text(robot))


def test_tiny_numbers_of_a_closed_state_are_numbers(tmp_path: Path) -> None:
    chain = chainbuild.load("lambda_kin21").chain()
    axes = tuple(replace(axis, lower=4e-6) if axis.name == "C" else axis for axis in chain.axes)
    extra = read_alone(Robot(chain.with_axes(axes)), tmp_path, 1)
    assert "e-0" in (tmp_path / "lambda_kin21" / "lambda_kin21.loops.yaml").read_text("utf-8")
    assert extra["chainbuild"]["assembly"]["joints"]["C"] > 0.0


def test_axes_with_an_offset_stand_beside_what_they_show(tmp_path: Path) -> None:
    chain = Robot.load("plasma_head_kin25").chain
    shifted = replace(chain, axis_map=ShiftedMap(chain.axis_map, np.array([0.0, 0.0, 0.0, 10.0, -7.0])))
    read_alone(Robot(shifted), tmp_path, 5)


def evaluated(axis_map: Any, axes: np.ndarray, factors: np.ndarray) -> list[float]:
    symbols = [f"x{n}" for n in range(len(axes))]
    found = formulas_of(axis_map, symbols)
    assert found is not None
    known: dict[str, Any] = WORDS | dict(zip(symbols, (axes * factors).tolist(), strict=True))
    for name, text in found.steps:
        known[name] = eval(text, {"__builtins__": {}}, known)
    return [float(eval(text, {"__builtins__": {}}, known)) for text in found.joints]


def test_maps_side_by_side_are_written_with_their_own_steps() -> None:
    """Every sign and offset of the nonlinear maps, two of a kind in one chain."""
    turn = VirtualTurnMap.of((1.0, 1.0, 1.0, -1.0, 1.0, -1.0), (0.0, 0.0, 0.0, 10.0, -20.0, 5.0))
    tilted = SpatialAnglesMap.of(40.0, (12.0, -7.0), -1.0)
    plasma = TiltLengthMap.of(NozzleLaw(0.3), 4.0)
    maps, counts = (turn, tilted, tilted, plasma), ((6, 5), (5, 5), (5, 5), (5, 6))
    blocks, axis, joint = [], 0, 0
    for one, (axes, joints) in zip(maps, counts, strict=True):
        places = joint + np.arange(joints)[::-1] if one is plasma else joint + np.arange(joints)
        blocks.append(Block(one, slice(axis, axis + axes), places))
        axis, joint = axis + axes, joint + joints
    whole = BlockMap(tuple(blocks), (joint, axis))
    rng, linear = np.random.default_rng(8), np.array([1, 1, 1, 0, 0, 0] + [1, 1, 1, 0, 0] * 3)
    factors = np.where(linear, 0.001, math.pi / 180)
    for _ in range(200):
        values = rng.uniform(-70.0, 70.0, axis)
        values[:6] *= 2.5  # beyond the quarter turn of the virtual axis, too
        np.testing.assert_allclose(evaluated(whole, values, factors), whole.q(values), rtol=0, atol=1e-11)


def test_a_map_with_cases_says_that_it_is_not_written() -> None:
    class Cases:
        """An axis map without formulas."""

    assert formulas_of(Cases(), ["x1"]) is None  # type: ignore[arg-type]
    assert formulas_of(BlockMap((Block(Cases(), slice(0, 1), np.array([0])),), (1, 1)), ["x1"]) is None  # type: ignore[arg-type]
