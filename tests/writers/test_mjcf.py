"""MJCF as MuJoCo reads it: poses, couplings and loops that hold, drives that move axes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

import chainbuild
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.bodies.body import Body, mesh_body
from chainbuild.errors import ChainbuildError
from chainbuild.frames import f_frame
from chainbuild.kinematics.closure import closing_axes
from chainbuild.machines import shipped
from chainbuild.meshes import Triangles
from chainbuild.robot import Robot
from chainbuild.units import si_factor
from chainbuild.writers.models.masses import estimated
from chainbuild.writers.models.mjcf import home, mjcf_text
from tests.kit import urdf_files
from tests.kit.mesh_files import box, surface, write_arm

TURN = urdf_files.joint("A1", "revolute", "base", "arm", inside='<axis xyz="0 0 1"/>')
CONSTRAINED = (
    "delta_kin37", "inclined_saw_kin207", "lambda_kin21", "palletiser_kin96", "rod_table_kin19", "tripod_kin12",
    "tripod_table_kin209",
)  # fmt: skip


def read(robot: Robot) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Return a robot's model in MuJoCo, at the file's own key."""
    model = mujoco.MjModel.from_xml_string(mjcf_text(robot))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    return model, data


def pose(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    """Return the tool in the workpiece frame [m]."""
    found = []
    for name in ("workpiece", "tool"):
        site = model.site(name).id
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = data.site_xmat[site].reshape(3, 3), data.site_xpos[site]
        found.append(T)
    return np.linalg.inv(found[0]) @ found[1]


def positions(robot: Robot, count: int) -> np.ndarray:
    """Return axis values within the limits at which the kinematic has a pose."""
    rng = np.random.default_rng(6)
    if robot.chain.loops:
        return closing_axes(robot, rng, count)
    lower, upper = np.array([axis.range for axis in robot.axes]).T
    return lower + (upper - lower) * rng.random((count, len(lower)))


def compare(name: str, count: int) -> None:
    """Compare poses at plain joint values with those of the robot."""
    robot = Robot.load(name)
    model, data = read(robot)
    assert pose(model, data) == pytest.approx(robot.fk(home(robot)).homogeneous, abs=1e-12)
    for axes in positions(robot, count):
        for joint, value in zip(robot.chain.joints, robot.q(axes), strict=True):
            data.joint(joint.name).qpos[0] = value
        mujoco.mj_kinematics(model, data)
        np.testing.assert_allclose(pose(model, data), robot.fk(axes).homogeneous, rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", shipped())
def test_poses_are_those_of_the_robot(name: str) -> None:
    compare(name, 5)


@pytest.mark.slow
@pytest.mark.parametrize("name", shipped())
def test_a_thousand_poses(name: str) -> None:
    compare(name, 1000)


@pytest.mark.parametrize("name", CONSTRAINED)
def test_loops_and_couplings_hold_and_drives_move_the_axes(name: str) -> None:
    robot = Robot.load(name)
    model, data = read(robot)
    assert [model.actuator(n).name for n in range(model.nu)] == [axis.name for axis in robot.axes]
    worst = 0.0

    def step() -> None:
        nonlocal worst
        mujoco.mj_step(model, data)
        equal = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
        assert equal.any()
        worst = max(worst, float(np.abs(data.efc_pos[equal]).max()))

    second = round(1.0 / model.opt.timestep)
    for _ in range(second):  # held
        step()
    assert worst < 1e-4
    start = home(robot)
    middle = np.mean([axis.range for axis in robot.axes], axis=1)
    turns = (ones(robot), -ones(robot), np.sign(middle - start), np.ones(len(start)))
    tried = (start + size * turn for size in (10, 5, 2, 1) for turn in turns)
    goal = next(axes for axes in tried if not robot.violated_limits(axes) and closes(robot, axes))
    factors = np.array([si_factor(axis.kind) for axis in robot.axes])
    for share in (1 - np.cos(np.linspace(0, np.pi, second))) / 2:  # moved
        data.ctrl[:] = (start + share * (goal - start)) * factors
        step()
    assert worst < 1e-4
    for _ in range(second):
        step()
    # Drives give way by what they carry; what was asked for has been reached all the same.
    off = np.linalg.norm(pose(model, data)[:3, 3] - robot.fk(goal).translation)
    moved = np.linalg.norm(robot.fk(start).translation - robot.fk(goal).translation)
    assert off < 2e-4
    assert moved > 0.9e-3
    assert sum(one.number for one in data.warning) == 0


def closes(robot: Robot, axes: np.ndarray) -> bool:
    """Return whether the kinematic has a pose."""
    return bool(np.isfinite(robot.chain.axis_map.q(axes)).all())


def ones(robot: Robot) -> np.ndarray:
    """Return a step of every axis, alternating."""
    return np.array([(-1.0) ** n for n in range(len(robot.axes))])


def test_stiffer_settings_keep_a_loop_closer() -> None:
    robot = Robot.load("tripod_table_kin209")
    model, data = read(robot)
    model.opt.timestep = 1e-4
    model.eq_solref[:] = (2e-4, 1.0)
    model.eq_solimp[:] = (0.9999, 0.99999, 0.001, 0.5, 2)
    worst = 0.0
    for _ in range(2000):
        mujoco.mj_step(model, data)
        equal = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
        worst = max(worst, float(np.abs(data.efc_pos[equal]).max()))
    assert worst < 1e-6


def test_a_drive_of_a_coupled_axis_pulls_the_sum_of_its_joints() -> None:
    robot = Robot.load("palletiser_kin96")
    text = mjcf_text(robot)
    assert '<joint joint="G2" coef="1" />' in text
    assert '<tendon tendon1="level_follows"' in text
    model, data = read(robot)
    axes = np.array([5.0, -10.0, 7.0, 3.0])
    for joint, value in zip(robot.chain.joints, robot.q(axes), strict=True):
        data.joint(joint.name).qpos[0] = value
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.actuator_length, np.radians(axes), atol=1e-12)
    level = model.tendon("level_follows").id
    assert data.ten_length[level] == pytest.approx(model.equality(0).data[0], abs=1e-12)


def test_a_drive_rests_where_its_control_is_also_with_a_zero_elsewhere() -> None:
    chain = Robot.load("palletiser_kin96").chain
    assert isinstance(chain.axis_map, AffineMap)
    zeros = np.array([0.1, -0.2, 0.05, -0.15, 0.3])
    moved = AffineMap.of(chain.axis_map.A, chain.axis_map.b + zeros, [axis.kind for axis in chain.axes])
    robot = Robot(replace(chain, axis_map=moved))
    model, data = read(robot)
    axes = np.array([5.0, -10.0, 7.0, 3.0])
    for joint, value in zip(robot.chain.joints, robot.q(axes), strict=True):
        data.joint(joint.name).qpos[0] = value
    data.ctrl[:] = np.radians(axes)
    mujoco.mj_forward(model, data)
    np.testing.assert_allclose(data.actuator_force, 0.0, atol=1e-4)  # of drives of 1e6 N·m/rad


def test_masses_are_those_of_solid_bodies() -> None:
    T = np.eye(4)
    T[:3, 3] = (1.0, 2.0, 3.0)
    box = Body("l", "link", T, "box", (0.1, 0.2, 0.3), (0, 0, 0))
    found = estimated([box], density=1000.0)
    assert found.mass == pytest.approx(6.0)
    np.testing.assert_allclose(found.centre, (1, 2, 3))
    np.testing.assert_allclose(np.diag(found.moments), [6 * 0.13 / 12, 6 * 0.10 / 12, 6 * 0.05 / 12])
    # A dumbbell, by hand: two balls of 4/3·π·r³·ρ at ±a, each 2/5·m·r² of its own.
    ends = []
    for side in (-1.0, 1.0):
        T = np.eye(4)
        T[0, 3] = side
        ends.append(Body("l", "link", T, "sphere", (0.1,), (0, 0, 0)))
    found = estimated(ends, density=1000.0)
    mass = 4 / 3 * np.pi * 0.1**3 * 1000
    assert found.mass == pytest.approx(2 * mass)
    np.testing.assert_allclose(np.diag(found.moments), np.array([0, 2 * mass, 2 * mass]) + 2 * 0.4 * mass * 0.01)
    tube = estimated([Body("l", "link", np.eye(4), "cylinder", (0.1, 2.0), (0, 0, 0))], density=1000.0)
    assert tube.mass == pytest.approx(np.pi * 0.01 * 2 * 1000)
    np.testing.assert_allclose(np.diag(tube.moments) / tube.mass, [0.01 / 4 + 4 / 12, 0.01 / 4 + 4 / 12, 0.005])


def test_masses_of_meshes_are_those_of_what_they_enclose(tmp_path: Path) -> None:
    T = f_frame((1.0, 2.0, 3.0), (20.0, 30.0, 40.0))
    block = Body("l", "link", T, "box", (0.1, 0.2, 0.3), (0, 0, 0))
    half = np.array(block.dimensions) / 2
    # Off the origin of its file, as meshes are.
    mesh = mesh_body("l", T, surface(box(1 - half, 1 + half)), (0, 0, 0))
    known, found = estimated([block]), estimated([mesh])
    assert found.mass == pytest.approx(known.mass)
    np.testing.assert_allclose(found.centre, (T @ (1, 1, 1, 1))[:3], atol=1e-12)
    np.testing.assert_allclose(found.moments, known.moments, atol=1e-12)
    assert mesh.surface is not None
    for count in (0, 8, 11):
        open_one = replace(mesh, surface=Triangles(mesh.surface.points, mesh.surface.corners[:count]))
        assert estimated([open_one]).mass == pytest.approx(known.mass)
    assert mujoco.MjModel.from_xml_string(mjcf_text(Robot.from_urdf(write_arm(tmp_path)))).nbody == 4


def test_the_file_is_the_same_each_time_and_lies_beside_the_urdf(tmp_path: Path) -> None:
    path = chainbuild.write_mjcf(Robot.load("delta_kin37"), tmp_path)
    assert path == tmp_path / "delta_kin37" / "delta_kin37.xml"
    assert path.read_text("utf-8") == mjcf_text(Robot.load("delta_kin37"))
    with pytest.raises(ChainbuildError, match="expected a robot"):
        chainbuild.write_mjcf("delta_kin37", tmp_path)  # type: ignore[arg-type]


def test_the_head_of_a_machine_with_loops_says_which_joints_are_axes() -> None:
    text = mjcf_text(Robot.load("tripod_kin12"))
    assert "Joints with the names of axes stand at axis values, in metres and radians; the others follow" in text
    assert "robot.q(axes)" not in text


def test_what_is_not_expressed_is_said() -> None:
    assert "not expressed by this file" in mjcf_text(Robot.load("cardan_head_kin59"))
    assert "Without a drive, for want of a joint of their own: CV." in mjcf_text(Robot.load("rotated_head_kin70"))
    assert "not expressed" not in mjcf_text(Robot.load("tripod_kin12"))


@pytest.mark.parametrize("given", ["0 0 0 0 0 0", "-1e-13 0 0 0 0 0", "1e-3 0 0 1e-3 0 0", "1e-15 0 0 1e-15 0 1e-15"])
@pytest.mark.parametrize("mass", [2.0, 1e-14, 0.0])
def test_moments_that_a_file_lacks_are_those_of_a_small_body(given: str, mass: float, tmp_path: Path) -> None:
    links = (urdf_files.link("base", 0.0), urdf_files.link("arm", mass, "0.1 0 0", given))
    path = urdf_files.written(
        tmp_path, *links, urdf_files.joint("A1", "revolute", "base", "arm", inside='<axis xyz="0 0 1"/>')
    )
    model, _ = read(Robot.from_urdf(path))
    arm = model.body("arm")
    assert arm.mass[0] == (2.0 if mass == 2.0 else 0.1)
    least = 2.0 * 0.01**2 if mass == 2.0 else 1e-5
    assert arm.inertia.min() == pytest.approx(least, rel=1e-6)
    assert arm.inertia.max() < 2e-3


def test_moments_that_a_file_gives_stay(tmp_path: Path) -> None:
    links = (urdf_files.link("base", 0.0), urdf_files.link("arm", 1e-3, moments="1e-9 0 0 2e-9 0 2.5e-9"))
    path = urdf_files.written(
        tmp_path, *links, urdf_files.joint("A1", "revolute", "base", "arm", inside='<axis xyz="0 0 1"/>')
    )
    model, _ = read(Robot.from_urdf(path))
    np.testing.assert_allclose(sorted(model.body("arm").inertia), [1e-9, 2e-9, 2.5e-9], rtol=1e-9)


@pytest.mark.parametrize("body", ['box size="1e-9 1 1"', 'sphere radius="1e-8"', 'cylinder radius="1" length="1e-8"'])
def test_bodies_thinner_than_the_drawing_are_left_out(body: str, tmp_path: Path) -> None:
    arm = f'<link name="arm"><visual><geometry><{body}/></geometry></visual></link>'
    path = urdf_files.written(tmp_path, urdf_files.link("base", 0.0), arm, TURN)
    model, _ = read(Robot.from_urdf(path))
    assert model.ngeom == 0
