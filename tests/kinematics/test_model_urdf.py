"""Any Pinocchio model as URDF: poses, names, masses and gravity of what is read back are those of the model."""

from __future__ import annotations

import importlib.metadata
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path

import coal
import mujoco
import numpy as np
import pinocchio as pin
import pytest
import yourdfpy

import chainbuild
from chainbuild.kinematics.model_urdf import model_to_urdf

QUICK = ("ur5_robot.urdf", "panda.urdf", "anymal.urdf", "tiago_pro.urdf", "kinova.urdf", "so101.urdf", "xarm7.urdf")
# Pinocchio's reader refuses their mimic joints, whose drivers hang in other branches; without them it reads the file.
OTHER_BRANCH = {"romeo", "alex_psyonic_hands", "talos_full_v2", "talos_full_v2_box"}
IMPOSSIBLE = {"romeo_small", "romeo_laas_small"}  # moments that no body has: MuJoCo refuses them
NO_MODEL = {"ur3"}  # an included part: no reader takes it for a robot


def robots() -> Path:
    """Return the folder of example-robot-data's robots."""
    files = importlib.metadata.files("example-robot-data") or []
    found = next(file for file in files if str(file).endswith("ur_description/urdf/ur5_robot.urdf"))
    return Path(str(found.locate())).resolve().parents[2]


FILES = sorted(robots().rglob("*.urdf"))
SAMPLES = {
    "humanoid": pin.buildSampleModelHumanoid,
    "humanoid random": pin.buildSampleModelHumanoidRandom,
    "humanoid mimic": lambda: pin.buildSampleModelHumanoidRandom(True, True),
    "manipulator": pin.buildSampleModelManipulator,
    "manipulator mimic": lambda: pin.buildSampleModelManipulator(True),
}


def read_back(model: pin.Model) -> pin.Model:
    """Return the model of the file of a model."""
    return pin.buildModelFromXML(model_to_urdf(model), mimic=len(model.mimicking_joints) > 0)


def moved(model: pin.Model, other: pin.Model, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Return the same random configuration of two models with the same joints."""
    q, there = pin.integrate(model, pin.neutral(model), rng.uniform(-1, 1, model.nv)), pin.neutral(other)
    for n in range(1, model.njoints):
        own, its = model.joints[n], other.joints[other.getJointId(model.names[n])]
        assert own.nq == its.nq
        if own.nq:
            there[its.idx_q : its.idx_q + its.nq] = q[own.idx_q : own.idx_q + own.nq]
    return q, there


def check(model: pin.Model) -> None:
    """Compare a model with what is read back of it."""
    other = read_back(model)
    assert sorted(other.names) == sorted(model.names)
    assert pin.computeTotalMass(other) == pytest.approx(pin.computeTotalMass(model), rel=0, abs=1e-12)
    data, its = model.createData(), other.createData()
    rng = np.random.default_rng(4)
    for _ in range(3):
        q, there = moved(model, other, rng)
        pin.framesForwardKinematics(model, data, q)
        pin.framesForwardKinematics(other, its, there)
        for n, frame in enumerate(model.frames):
            if frame.name != "universe":
                place = its.oMf[frame_of(other, frame)]
                np.testing.assert_allclose(place.homogeneous, data.oMf[n].homogeneous, rtol=0, atol=1e-12)
        if len(model.mimicking_joints):
            continue  # Pinocchio has no gravity of these
        expected, found = (
            pin.computeGeneralizedGravity(one, store, at) for one, store, at in ((model, data, q), (other, its, there))
        )
        for n in range(1, model.njoints):
            own, back = model.joints[n], other.joints[other.getJointId(model.names[n])]
            part, rounding = found[back.idx_v : back.idx_v + back.nv], 1e-14 * max(100.0, np.abs(expected).max())
            np.testing.assert_allclose(part, expected[own.idx_v : own.idx_v + own.nv], rtol=0, atol=rounding)
    for name in ("lowerPositionLimit", "upperPositionLimit"):
        for n in range(1, model.njoints):
            own, back = model.joints[n], other.joints[other.getJointId(model.names[n])]
            if own.nq == 1:
                expected_end = np.clip(getattr(model, name)[own.idx_q], -1.7976931348623157e308, 1.7976931348623157e308)
                assert getattr(other, name)[back.idx_q] == expected_end
    for name in ("effortLimit", "velocityLimit", "damping", "friction"):
        for n in range(1, model.njoints):
            own, back = model.joints[n], other.joints[other.getJointId(model.names[n])]
            if own.nv == 1:
                assert getattr(other, name)[back.idx_v] == min(getattr(model, name)[own.idx_v], 1.7976931348623157e308)


def frame_of(model: pin.Model, frame: pin.Frame) -> int:
    """Return the frame of the same name; what was a mere frame is a link in a file."""
    kinds = (
        (frame.type, pin.FrameType.BODY)
        if frame.type in (pin.FrameType.OP_FRAME, pin.FrameType.SENSOR)
        else (frame.type,)
    )
    found = [n for n, one in enumerate(model.frames) if one.name == frame.name and one.type in kinds]
    assert len(found) == 1, frame
    return found[0]


def check_by_mujoco(model: pin.Model) -> None:
    """Compare a model with what MuJoCo reads of its file: poses of links, mass, gravity; it reads no free-flyers.

    MuJoCo refuses links that move without a mass: a nanogram, and an inertia as small, is put there.
    """
    settings = '<mujoco><compiler fusestatic="false" boundmass="1e-12" boundinertia="1e-12"/></mujoco>'
    its = mujoco.MjModel.from_xml_string(model_to_urdf(model).replace("</robot>", f"{settings}</robot>"))
    store, data, rng = mujoco.MjData(its), model.createData(), np.random.default_rng(4)
    assert its.body_mass.sum() == pytest.approx(sum(inertia.mass for inertia in model.inertias), abs=1e-9)
    bodies = [frame for frame in model.frames if frame.type == pin.FrameType.BODY and frame.name != "universe"]
    assert bodies
    for _ in range(3):
        q = pin.integrate(model, pin.neutral(model), rng.uniform(-1, 1, model.nv))
        for name, joint in zip(model.names[1:], list(model.joints)[1:], strict=True):
            own = q[joint.idx_q : joint.idx_q + joint.nq]
            if joint.nq == 7:
                store.joint(name).qpos = [*own[:3], own[6], *own[3:6]]
            elif joint.nq:
                store.joint(name).qpos[0] = own[0] if joint.nq == 1 else np.arctan2(own[1], own[0])
        mujoco.mj_forward(its, store)
        pin.framesForwardKinematics(model, data, q)
        for frame in bodies:
            place, found = data.oMf[model.getFrameId(frame.name, pin.FrameType.BODY)], store.body(frame.name)
            np.testing.assert_allclose(found.xpos, place.translation, rtol=0, atol=1e-9)
            np.testing.assert_allclose(found.xmat.reshape(3, 3), place.rotation, rtol=0, atol=1e-9)
        gravity = pin.computeGeneralizedGravity(model, data, q)
        for name, joint in zip(model.names[1:], list(model.joints)[1:], strict=True):
            if joint.nv == 1:
                bias = store.qfrc_bias[its.joint(name).dofadr[0]]
                assert bias == pytest.approx(gravity[joint.idx_v], abs=1e-7)


@pytest.mark.parametrize("name", SAMPLES)
def test_sample_models(name: str) -> None:
    check(SAMPLES[name]())


@pytest.mark.parametrize("path", [path for path in FILES if path.name in QUICK], ids=lambda path: path.stem)
def test_robots(path: Path) -> None:
    check(pin.buildModelFromUrdf(str(path), mimic=True))
    check_by_mujoco(pin.buildModelFromUrdf(str(path)))


@pytest.mark.slow
@pytest.mark.parametrize("path", [path for path in FILES if path.stem not in NO_MODEL], ids=lambda path: path.stem)
def test_mujoco_sees_every_robot(path: Path) -> None:
    model = pin.buildModelFromUrdf(str(path))
    if path.stem in IMPOSSIBLE:
        with pytest.raises(ValueError, match="inertia"):
            check_by_mujoco(model)
    else:
        check_by_mujoco(model)


@pytest.mark.slow
@pytest.mark.parametrize("flying", [False, True])
@pytest.mark.parametrize("path", [path for path in FILES if path.stem not in NO_MODEL], ids=lambda path: path.stem)
def test_every_robot(path: Path, flying: bool) -> None:
    root = (pin.JointModelFreeFlyer(),) if flying else ()
    check(pin.buildModelFromUrdf(str(path), *root, mimic=path.stem not in OTHER_BRANCH))


def placements() -> Iterator[pin.SE3]:
    """Yield a generic placement, and those whose pitch is a right angle or close to it."""
    yield pin.SE3.Random()
    for pitch in (np.pi / 2, -np.pi / 2, np.pi / 2 - 1e-9, -np.pi / 2 + 3e-13):
        R = pin.rpy.rpyToMatrix(0.7, 0.0, 0.0).T @ pin.rpy.rpyToMatrix(0.0, pitch, 0.0) @ pin.rpy.rpyToMatrix(0.3, 0, 0)
        yield pin.SE3(pin.rpy.rpyToMatrix(0.2, pitch, 1.3), np.array([0.1, -2.0, 3.0]))
        yield pin.SE3(R, np.zeros(3))


JOINTS = {
    "unaligned turn": pin.JointModelRevoluteUnaligned(np.array([0.6, 0.0, -0.8])),
    "unaligned slide": pin.JointModelPrismaticUnaligned(np.array([0.0, -0.6, 0.8])),
    "endless": pin.JointModelRUBY(),
    "planar": pin.JointModelPlanar(),
    "floating": pin.JointModelFreeFlyer(),
}
ROWS = {
    "translation": pin.JointModelTranslation(),
    "angles": pin.JointModelSphericalZYX(),
    "universal": pin.JointModelUniversal(np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])),
}


@pytest.mark.parametrize("kind", JOINTS)
def test_joints_of_every_kind_and_place(kind: str) -> None:
    for place in placements():
        model = pin.Model()
        first = model.addJoint(0, JOINTS[kind], place, "moving <&\"'> joint")
        model.appendBodyToJoint(first, pin.Inertia.Random(), pin.SE3.Identity())
        second = model.addJoint(first, pin.JointModelRZ(), place, "second")
        model.appendBodyToJoint(second, pin.Inertia.Random(), pin.SE3.Random())
        model.addFrame(pin.Frame("tip", second, 0, place, pin.FrameType.OP_FRAME))
        check(model)


def test_an_endless_turn_about_an_inclined_axis() -> None:
    text = (
        '<robot name="r"><link name="a"/><link name="b"><inertial><mass value="2"/><origin xyz="1 2 3"/>'
        '<inertia ixx="3" ixy="0" ixz="0" iyy="3" iyz="0" izz="3"/></inertial></link>'
        '<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0.6 0.8"/></joint></robot>'
    )
    model = pin.buildModelFromXML(text)
    assert model.joints[1].shortname() == "JointModelRevoluteUnboundedUnaligned"
    check(model)


@pytest.mark.parametrize("kind", ROWS)
def test_joints_in_a_row(kind: str) -> None:
    model = pin.Model()
    place = pin.SE3.Random()
    joint = model.addJoint(0, ROWS[kind], place, "row")
    model.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Random())
    other = read_back(model)
    assert list(other.names)[1:] == [f"row_{n + 1}" for n in range(model.nq)]
    data, its = model.createData(), other.createData()
    for q in np.random.default_rng(2).uniform(-1, 1, (5, model.nq)):
        pin.forwardKinematics(model, data, q)
        pin.forwardKinematics(other, its, q)
        np.testing.assert_allclose(its.oMi[-1].homogeneous, data.oMi[-1].homogeneous, rtol=0, atol=1e-12)
    assert pin.computeTotalMass(other) == pin.computeTotalMass(model)


@pytest.mark.parametrize(
    "joint", [pin.JointModelSpherical(), pin.JointModelHX(0.1), pin.JointModelComposite(pin.JointModelRX())]
)
def test_what_urdf_has_not_is_refused_by_name(joint: object) -> None:
    model = pin.Model()
    model.addJoint(0, joint, pin.SE3.Identity(), "the_joint")
    with pytest.raises(ValueError, match=r"joint 'the_joint' is a (Spherical|HX|Composite): URDF has no such joint"):
        model_to_urdf(model)


def test_what_is_lost_is_said() -> None:
    model = pin.buildSampleModelManipulator()
    assert "not in this file" not in model_to_urdf(model)
    model.armature = np.full(model.nv, 0.1)
    assert "<!-- not in this file: rotor inertias (armature) -->" in model_to_urdf(model)


def test_bodies_are_where_they_were() -> None:
    model = pin.buildSampleModelManipulator()
    bodies = pin.GeometryModel()
    shapes = {
        "box": coal.Box(0.1, 0.2, 0.3), "ball": coal.Sphere(0.05), "tube": coal.Cylinder(0.04, 0.5),
        "pill": coal.Capsule(0.03, 0.4),
    }  # fmt: skip
    for n, (name, shape) in enumerate(shapes.items()):
        bodies.addGeometryObject(pin.GeometryObject(name, n + 1, pin.SE3.Random(), shape))
    text = model_to_urdf(model, bodies, bodies)
    other = pin.buildModelFromXML(text)
    back = pin.buildGeomFromUrdfString(other, text, pin.GeometryType.COLLISION)
    assert len(back.geometryObjects) == 6  # a capsule is a cylinder and two balls
    links = ET.fromstring(text).findall("link")
    assert sum(len(link.findall("visual")) for link in links) == 6
    found = {str(one.tag): one for link in links for one in link.iter() if one.tag in ("box", "cylinder")}
    assert found["box"].get("size") == "0.1 0.2 0.3"
    places = [one.placement.homogeneous for one in bodies.geometryObjects]
    read = [one.placement.homogeneous for one in back.geometryObjects]
    for place in places:
        assert min(np.abs(place - one).max() for one in read) < 1e-12
    bodies.addGeometryObject(pin.GeometryObject("cone", 1, pin.SE3.Identity(), coal.Cone(0.1, 0.2)))
    with pytest.raises(ValueError, match="body 'cone' is a Cone"):
        model_to_urdf(model, bodies)


def check_by_yourdfpy(path: Path, file: Path) -> None:
    """Compare a model with what yourdfpy reads of its file: poses of links."""
    model = pin.buildModelFromUrdf(str(path))
    file.write_text(model_to_urdf(model), "utf-8")
    robot = yourdfpy.URDF.load(str(file), load_meshes=False, build_scene_graph=True)
    q, data = pin.integrate(model, pin.neutral(model), np.linspace(-1, 1, model.nv)), model.createData()
    pin.framesForwardKinematics(model, data, q)
    values = {}
    for n in range(1, model.njoints):
        joint = model.joints[n]
        part = q[joint.idx_q : joint.idx_q + joint.nq]
        values[str(model.names[n])] = float(part[0]) if joint.nq == 1 else float(np.arctan2(part[1], part[0]))
    robot.update_cfg(values)
    bodies = [frame for frame in model.frames if frame.type == pin.FrameType.BODY]
    assert bodies
    for frame in bodies:
        found = robot.get_transform(frame.name, robot.base_link)
        place = data.oMf[model.getFrameId(frame.name, pin.FrameType.BODY)]
        np.testing.assert_allclose(found, place.homogeneous, rtol=0, atol=1e-9)


def test_another_reader_sees_the_same(tmp_path: Path) -> None:
    check_by_yourdfpy(next(path for path in FILES if path.name == "kinova.urdf"), tmp_path / "robot.urdf")


@pytest.mark.slow
@pytest.mark.parametrize("path", [path for path in FILES if path.stem not in NO_MODEL], ids=lambda path: path.stem)
def test_another_reader_sees_every_robot(path: Path, tmp_path: Path) -> None:
    check_by_yourdfpy(path, tmp_path / "robot.urdf")


def test_it_is_a_function_of_the_package() -> None:
    assert chainbuild.model_to_urdf is model_to_urdf
