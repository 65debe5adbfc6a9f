"""Masses, efforts and bodies in URDF: estimates by volume, what they weigh, meshes and hulls beside the file."""

from __future__ import annotations

import struct
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild.chain.bodies.geometry import Geometry, Shape
from chainbuild.chain.bodies.inertia import Inertia, JointDynamics
from chainbuild.chain.elements import Chain
from chainbuild.drawing.machine import drawn_bodies
from chainbuild.errors import FileAccessError, OverwriteError
from chainbuild.machines import shipped
from chainbuild.robot import Robot
from chainbuild.writers.models.masses import DENSITY, holding_efforts, link_inertias
from chainbuild.writers.models.urdf import urdf_files, urdf_text
from tests.kit.draws import random_axes
from tests.kit.mesh_files import write_stl
from tests.kit.sample_chains import arm
from tests.kit.urdf_files import joint as urdf_joint
from tests.kit.urdf_files import link, written

STEEL_CUBE = 0.2**3 * DENSITY  # kg


def with_geometry(chain: Chain, **given: object) -> Robot:
    return Robot(replace(chain, geometry=replace(chain.geometry, **given)))  # type: ignore[arg-type]


def cube_file(path: Path, edge: float) -> Path:
    """Write a cube as OBJ, its corner at the origin."""
    path.parent.mkdir(parents=True, exist_ok=True)
    ends = (0.0, edge)
    corners = "".join(f"v {x} {y} {z}\n" for x in ends for y in ends for z in ends)
    faces = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))
    path.write_text(corners + "".join(f"f {a} {b} {c}\nf {a} {c} {d}\n" for a, b, c, d in faces), "utf-8")
    return path


@pytest.mark.parametrize("kind", ["box", "hull", "mesh"])
def test_a_cube_weighs_what_a_cube_weighs(kind: str, tmp_path: Path) -> None:
    place = (0.1, 0.2, 0.3, 90.0, 0.0, 0.0)
    cube = {
        "box": Shape("box", size=(0.2, 0.2, 0.2), place=(0.0, 0.3, 0.4, 90.0, 0.0, 0.0)),
        "hull": Shape("hull", file=cube_file(tmp_path / "cube.obj", 200.0), place=place),
        "mesh": Shape("mesh", file=cube_file(tmp_path / "cube.obj", 200.0), place=place),
    }[kind]
    robot = with_geometry(arm(), shapes={"A1_link": (cube,)})
    found = link_inertias(robot.chain, drawn_bodies(robot.chain))["A1_link"]
    assert found.mass == pytest.approx(STEEL_CUBE, rel=1e-5)
    np.testing.assert_allclose(found.centre, [0.0, 0.3, 0.4], atol=1e-6)  # the corner turned by 90 degrees about z
    np.testing.assert_allclose(found.moments, np.eye(3) * STEEL_CUBE * 0.2**2 / 6.0, atol=1e-5)


def test_two_bodies_of_a_link_by_hand() -> None:
    shapes = (Shape("sphere", points=(0.0, 0.0, 0.5), radius=0.1), Shape("sphere", points=(0.0, 0.0, -0.1), radius=0.1))
    robot = with_geometry(arm(), shapes={"A1_link": shapes})
    found = link_inertias(robot.chain, ())["A1_link"]
    ball = DENSITY * 4.0 / 3.0 * np.pi * 0.1**3
    across = 2 * (0.4 * ball * 0.1**2 + ball * 0.3**2)
    assert found.mass == pytest.approx(2 * ball, rel=1e-5)
    np.testing.assert_allclose(found.centre, [0, 0, 0.2], atol=1e-6)
    np.testing.assert_allclose(np.diag(found.moments), [across, across, 2 * 0.4 * ball * 0.1**2], rtol=1e-4)


@pytest.mark.parametrize("name", shipped())
def test_pinocchio_weighs_the_estimates_and_efforts_hold_them(name: str, tmp_path: Path) -> None:
    robot = Robot.load(name)
    path = chainbuild.write_urdf(robot, tmp_path)
    model = pin.buildModelFromUrdf(str(path))
    inertias = link_inertias(robot.chain, drawn_bodies(robot.chain))
    told = sum(inertia.mass for link, inertia in inertias.items() if link != "base")
    assert pin.computeTotalMass(model) == pytest.approx(told, rel=1e-12)
    data, rng = model.createData(), np.random.default_rng(2)
    low, high = np.maximum(model.lowerPositionLimit, -50), np.minimum(model.upperPositionLimit, 50)
    for _ in range(20 if not robot.chain.loops else 0):
        torque = pin.computeGeneralizedGravity(model, data, low + (high - low) * rng.random(model.nq))
        assert (np.abs(torque) <= model.upperEffortLimit).all()
    if robot.chain.loops:
        columns = [joint.name for joint in robot.chain.joints if joint.kind == "prismatic"]
        forces = [model.upperEffortLimit[model.joints[model.getJointId(one)].idx_v] for one in columns]
        assert min(forces) >= 9.81 * sum(inertia.mass for inertia in inertias.values())
    without = urdf_text(robot, inertia=False)
    assert "inertial" not in without
    assert "Masses" not in without


def test_efforts_bound_what_an_arm_carries() -> None:
    robot = Robot.load("kr6r900")
    weights = {joint.child: Inertia(100.0, np.array([0.3, 0.0, 0.0]), np.eye(3)) for joint in robot.chain.joints}
    bound = holding_efforts(robot.chain, weights)
    model = robot.model.copy()
    for name, inertia in weights.items():
        joint = model.frames[model.getFrameId(name)].parentJoint
        model.appendBodyToJoint(joint, pin.Inertia(inertia.mass, inertia.centre, inertia.moments), pin.SE3.Identity())
    rng, data = np.random.default_rng(4), model.createData()
    found = [np.abs(pin.computeGeneralizedGravity(model, data, robot.q(random_axes(robot, rng)))) for _ in range(500)]
    assert (np.max(found, axis=0) <= bound).all()
    assert np.max(found, axis=0)[1] > 0.6 * bound[1]  # a bound, not just a large number


def test_what_a_file_gives_is_written_as_it_is(tmp_path: Path) -> None:
    chain = arm()
    joint = replace(chain.joints[0], dynamics=JointDynamics(effort=77.0, damping=0.25, friction=0.125))
    moments = np.array([[3e-7, 1e-8, 0.0], [1e-8, 4e-7, -2e-8], [0.0, -2e-8, 5e-7]])
    given = {chain.joints[0].child: Inertia(1.25, np.array([0.01, -0.02, 0.03]), moments)}
    geometry = replace(chain.geometry, inertias=given)
    robot = Robot(replace(chain, joints=(joint, *chain.joints[1:]), geometry=geometry))
    model = pin.buildModelFromUrdf(str(chainbuild.write_urdf(robot, tmp_path)))
    for read in (model, robot.model):
        n = read.getJointId(joint.name)
        assert read.inertias[n].mass == 1.25
        np.testing.assert_array_equal(read.inertias[n].lever, [0.01, -0.02, 0.03])
        np.testing.assert_allclose(read.inertias[n].inertia, moments, rtol=1e-14)
        assert pin.computeTotalMass(read) == 1.25
        v = read.joints[n].idx_v
        assert (read.upperEffortLimit[v], read.lowerEffortLimit[v]) == (77.0, -77.0)
        assert (read.damping[v], read.upperDryFrictionLimit[v]) == (0.25, 0.125)


def test_shapes_meshes_and_hulls_are_written_beside_the_file(tmp_path: Path) -> None:
    mesh, other = cube_file(tmp_path / "a b.obj", 200.0), cube_file(tmp_path / "A_B.obj", 100.0)
    place = (0.1, 0.2, 0.3, 10.0, 20.0, 30.0)
    shapes = {
        "A1_link": (Shape("mesh", file=mesh, place=place), Shape("hull", file=mesh, place=place)),
        "A2_link": (Shape("capsule", points=(0.0, 0.0, 0.0, 0.3, 0.0, 0.0), radius=0.05), Shape("mesh", file=other)),
        "C9_link": (),
    }
    seen = Shape("mesh", file=mesh, scale=(0.001, 0.001, -0.001), colour=(0.25, 0.5, 0.75))
    robot = with_geometry(arm(), shapes=shapes, visuals={"A1_link": (seen,)})
    path = chainbuild.write_urdf(robot, tmp_path / "out")
    names = sorted(str(one.relative_to(path.parent)) for one in path.parent.rglob("*") if one.is_file())
    assert names == [path.name, "meshes/A_B_2.obj", "meshes/a_b.obj", "meshes/a_b_hull.stl"]
    assert (path.parent / "meshes/a_b.obj").read_bytes() == mesh.read_bytes()
    model = pin.buildModelFromUrdf(str(path))
    solid = pin.buildGeomFromUrdf(model, str(path), pin.GeometryType.COLLISION, [str(path.parent)])
    kinds = [type(one.geometry).__name__ for one in solid.geometryObjects if one.name.startswith(("A1", "A2", "C9"))]
    assert sorted(kinds) == ["BVHModelOBBRSS", "BVHModelOBBRSS", "BVHModelOBBRSS", "Cylinder", "Sphere", "Sphere"]
    turned = pin.rpy.rpyToMatrix(*np.deg2rad([30.0, 20.0, 10.0]))
    placed = next(one for one in solid.geometryObjects if one.name.startswith("A1"))
    np.testing.assert_allclose(placed.placement.rotation, turned, atol=1e-12)
    np.testing.assert_allclose(placed.placement.translation, [0.1, 0.2, 0.3], atol=1e-12)
    visual = ET.parse(path).getroot().find("link[@name='A1_link']/visual")
    assert visual is not None
    mesh_element, colour = visual.find("geometry/mesh"), visual.find("material/color")
    assert mesh_element is not None
    assert colour is not None
    assert mesh_element.attrib == {"filename": "meshes/a_b.obj", "scale": "0.001 0.001 -0.001"}
    assert colour.attrib == {"rgba": "0.25 0.5 0.75 1"}
    assert ET.parse(path).getroot().find("link[@name='C9_link']/collision") is None


def test_a_hull_is_closed_and_looks_outwards(tmp_path: Path) -> None:
    shape = Shape("hull", file=cube_file(tmp_path / "cube.obj", 200.0))
    files = urdf_files(with_geometry(arm(), shapes={"A1_link": (shape,)}))
    content = files["meshes/cube_hull.stl"]
    assert isinstance(content, bytes)
    (count,) = struct.unpack_from("<I", content, 80)
    corners = np.array([struct.unpack_from("<12f", content, 84 + 50 * n)[3:] for n in range(count)]).reshape(-1, 3, 3)
    assert count == 12
    volume = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6.0
    assert volume == pytest.approx(0.2**3, rel=1e-6)


def test_nothing_is_written_where_a_mesh_is_missing(tmp_path: Path) -> None:
    shape = Shape("mesh", file=cube_file(tmp_path / "cube.obj", 200.0))
    robot = with_geometry(arm(), shapes={"A1_link": (shape,)})
    assert shape.file is not None
    shape.file.unlink()
    with pytest.raises(FileAccessError, match=r"mesh of link A1_link"):
        chainbuild.write_urdf(robot, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_geometry_names_follow_composition() -> None:
    given = Geometry(visuals={"a": ()}, inertias={"a": Inertia(1.0, np.zeros(3), np.eye(3))}).renamed({"a": "b"})
    assert set(given.visuals) == set(given.inertias) == {"b"}


def test_a_flat_mesh_weighs_nothing(tmp_path: Path) -> None:
    sheet = write_stl(tmp_path / "sheet.stl", ([(0, 0, 0), (9, 0, 0), (9, 9, 0)], [(0, 1, 2)]))
    flat, cube = Shape("mesh", file=sheet), Shape("mesh", file=cube_file(tmp_path / "cube.obj", 200.0))
    robot = with_geometry(arm(), shapes={"A1_link": (cube, flat), "A2_link": (flat,)})
    found = link_inertias(robot.chain, drawn_bodies(robot.chain))
    assert found["A1_link"].mass == pytest.approx(STEEL_CUBE, rel=1e-5)
    np.testing.assert_allclose(found["A1_link"].centre, np.full(3, 0.1), atol=1e-6)
    assert found["A2_link"].mass == 0.1


def test_a_mesh_that_is_read_is_not_written_over(tmp_path: Path) -> None:
    """The other mesh is named as this one, and comes first."""
    own = cube_file(tmp_path / "arm" / "meshes" / "cube.obj", 200.0)
    robot = with_geometry(arm(), shapes={"A1_link": (Shape("mesh", file=own),)})
    again = chainbuild.write_urdf(robot, tmp_path)
    assert again.is_relative_to(tmp_path / "arm")
    before = own.read_bytes()
    other = cube_file(tmp_path / "cube.obj", 300.0)
    shapes = {"A1_link": (Shape("mesh", file=other),), "A2_link": (Shape("mesh", file=own),)}
    with pytest.raises(OverwriteError, match="also an input") as caught:
        chainbuild.export(with_geometry(arm(), shapes=shapes), tmp_path, formats=["urdf", "mjcf"])
    assert caught.value.file == str(own)
    assert own.read_bytes() == before
    assert sorted(path.name for path in (tmp_path / "arm").rglob("*.*")) == ["arm.urdf", "cube.obj"]


def test_long_names_of_meshes_are_cut(tmp_path: Path) -> None:
    files = [cube_file(tmp_path / f"{'x' * 248}{n}.obj", 200.0) for n in (1, 2)]
    robot = with_geometry(arm(), shapes={"A1_link": tuple(Shape("hull", file=file) for file in files)})
    written = chainbuild.write_urdf(robot, tmp_path / "out").parent / "meshes"
    names = sorted(path.name for path in written.iterdir())
    assert names == [f"{'x' * 80}_2_hull.stl", f"{'x' * 80}_hull.stl"]


def test_a_slide_holds_its_load_at_the_end_of_its_stroke(tmp_path: Path) -> None:
    """By hand: 2 kg, 0.1 m beyond a slide that stands 0.3 m off the turn and leaves up to 1.2 m."""
    limit = '<axis xyz="1 0 0"/><limit lower="{}" upper="{}" effort="1" velocity="1"/>'
    path = written(
        tmp_path,
        *(link("base", 0.0), link("turn", 0.0), link("ram", 2.0, "0.1 0 0")),
        urdf_joint("A1", "revolute", "base", "turn", inside=limit.format(-1, 1)),
        urdf_joint("A2", "prismatic", "turn", "ram", "0 0.3 0", limit.format(-1.2, 0.5)),
    )
    chain = Robot.from_urdf(path).chain
    found = holding_efforts(chain, chain.geometry.inertias)
    np.testing.assert_allclose(found, 9.81 * 2.0 * np.array([0.1 + 0.3 + 1.2, 1.0]))
