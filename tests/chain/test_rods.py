"""The rods of a parallelogram: closed at every position, driven by the axes, written as mimic joints."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild.analysis.singularity.names import examine, names_at
from chainbuild.analysis.singularity.structure import singular_structure
from chainbuild.chain.assemble import mark, rotary, shift
from chainbuild.chain.bodies.geometry import RodData
from chainbuild.chain.bodies.rods import ROD_END, ROD_PIN, has_rods, pinned_links, with_rods
from chainbuild.chain.followers import followers
from chainbuild.errors import ChainError, OverlayError
from tests.kit.robots import make_chain

ARMS = ["parallelogram_nr", "palletiser_kin96", "palletiser_kin213", "irb2600", "kr6r900_2"]
ODD = RodData(crank=0.31, angle_deg=-150.0, sideways=0.12)


def samples(robot: chainbuild.Robot, count: int) -> np.ndarray:
    rng = np.random.default_rng(1)
    return np.array([[rng.uniform(a.lower, a.upper) for a in robot.axes] for _ in range(count)])


@pytest.mark.parametrize("data", [RodData(), ODD], ids=["default", "odd"])
@pytest.mark.parametrize("name", ARMS)
def test_rods_close_and_leave_the_robot_as_it_was(name: str, data: RodData) -> None:
    chain = chainbuild.load(name).chain()
    plain, rodded = chainbuild.Robot(chain), chainbuild.Robot(with_rods(chain, data))
    assert rodded.model.nq > plain.model.nq
    assert rodded.axes == plain.axes
    for axes in samples(plain, 200):
        np.testing.assert_allclose(rodded.fk(axes).homogeneous, plain.fk(axes).homogeneous, atol=1e-13)
        np.testing.assert_allclose(rodded.jacobian(axes), plain.jacobian(axes), atol=1e-13)
        np.testing.assert_allclose(rodded.axes_from_q(rodded.q(axes)), axes, atol=1e-9)
        places = rodded.frame_placements(axes)
        gap = places[ROD_END].translation - places[ROD_PIN].translation
        assert np.linalg.norm(gap) < 1e-12
        # The rod stays parallel to the upper arm and as long.
        rod = places[ROD_END].translation - places["rod"].translation
        elbow = next(j.name for j in rodded.chain.joints if j.child == rodded.chain.frame(ROD_PIN).link)
        arm = places[elbow].translation - places["crank"].translation
        np.testing.assert_allclose(rod, arm, atol=1e-12)


@pytest.mark.parametrize("absolute", [False, True])
@pytest.mark.parametrize(("sign2", "sign3"), [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0)])
def test_rods_under_a_level_head_close_whatever_the_zeros(absolute: bool, sign2: float, sign3: float) -> None:
    """Arms whose axes count from other zeros than those drawn: the head is as level as it was, the rods meet."""
    turned = {"G3": sign3} if absolute else {"G2": sign2, "G3": sign3}
    tool = [
        rotary("G1", "z"), shift(x=150.0, z=400.0),
        rotary("G2", "y", sign=sign2, offset_deg=25.0), shift(z=800.0),
        rotary("G3", "y", drive={"G3": sign3, "G2": -sign2} if absolute else {"G3": sign3}, offset_deg=-40.0),
        shift(x=900.0),
        rotary("level", "y", drive={name: -sign for name, sign in turned.items()}, offset_deg=15.0),
        shift(x=120.0), rotary("G4", "z"), mark("flange"),
    ]  # fmt: skip
    plain = chainbuild.Robot(make_chain(tool, [], "G1 G2 G3 G4"))
    rodded = chainbuild.Robot(with_rods(plain.chain, ODD))
    assert "level_plate" in {joint.name for joint in rodded.chain.joints}
    for axes in samples(plain, 20):
        T, places = rodded.fk(axes).homogeneous, rodded.frame_placements(axes)
        np.testing.assert_allclose(T, plain.fk(axes).homogeneous, atol=1e-13)
        np.testing.assert_allclose(T[2, :3], [0.0, 0.0, 1.0], atol=1e-13)
        np.testing.assert_allclose(places[ROD_END].translation, places[ROD_PIN].translation, atol=1e-12)
        upper_arm = places["level_plate"].translation - places["crank"].translation
        assert float(np.linalg.norm(upper_arm)) == pytest.approx(0.8)
        np.testing.assert_allclose(places[ROD_END].translation - places["rod"].translation, upper_arm, atol=1e-12)


@pytest.mark.parametrize("name", ARMS)
def test_every_rod_joint_follows_one_other(name: str) -> None:
    chain = with_rods(chainbuild.load(name).chain(), RodData())
    masters = followers(chain)
    expected = {"crank", "rod"} | ({"level_plate", "level_crank", "level"} if name == "palletiser_kin96" else set())
    assert set(masters) == expected
    assert not {master for master, _, _ in masters.values()} & expected
    robot = chainbuild.Robot(chain)
    names = [joint.name for joint in chain.joints]
    for axes in samples(robot, 20):
        q = dict(zip(names, robot.q(axes), strict=True))
        for joint, (master, factor, offset) in masters.items():
            assert q[joint] == pytest.approx(factor * q[master] + offset, abs=1e-12)


@pytest.mark.parametrize("name", ARMS[:3])
def test_urdf_writes_mimic_joints_that_readers_follow(name: str, tmp_path: Path) -> None:
    robot = chainbuild.Robot(with_rods(chainbuild.load(name).chain(), RodData()))
    path = chainbuild.write_urdf(robot, tmp_path)
    assert path.read_text("utf-8").count("<mimic") == len(followers(robot.chain))
    model = pin.buildModelFromUrdf(str(path), mimic=True)
    masters = followers(robot.chain)
    assert model.nq == robot.model.nq - len(masters)
    data = model.createData()
    joints = [joint.name for joint in robot.chain.joints]
    for axes in samples(robot, 10):
        values = dict(zip(joints, robot.q(axes), strict=True))
        q = pin.neutral(model)
        for joint, value in values.items():
            if joint not in masters:
                q[model.joints[model.getJointId(joint)].idx_q] = value
        pin.framesForwardKinematics(model, data, q)
        places = robot.frame_placements(axes)
        for frame in ("tool", ROD_END, ROD_PIN):
            T = data.oMf[model.getFrameId(frame)]
            np.testing.assert_allclose(T.homogeneous, places[frame].homogeneous, atol=1e-9)


def test_rods_come_from_the_overlay_when_asked(tmp_path: Path) -> None:
    source = chainbuild.load("parallelogram_nr").path
    file = tmp_path / "arm.tea"
    file.write_text(source.read_text("utf-8"), "utf-8")
    overlay = tmp_path / "arm.chainbuild.toml"
    overlay.write_text("[geometry]\ncrank_mm = 300\n", "utf-8")
    plain = chainbuild.load(file).chain()
    assert not has_rods(plain)
    assert plain.geometry.rod_data.crank == pytest.approx(0.3)
    overlay.write_text("[geometry]\nrods = true\ncrank_mm = 300\ncrank_angle_deg = 170\nrod_radius_mm = 30\n", "utf-8")
    rodded = chainbuild.load(file).chain()
    assert has_rods(rodded)
    pin_place = rodded.frame(ROD_PIN).T_link_frame[:3, 3]
    assert np.linalg.norm(pin_place) == pytest.approx(0.3)
    assert next(link.radius for link in rodded.links if link.name == "rod_link") == pytest.approx(0.03)
    mill = tmp_path / "mill.lis"
    mill.write_text(chainbuild.load("ca_head_kin9").path.read_text("utf-8"), "utf-8")
    (tmp_path / "mill.chainbuild.toml").write_text("[geometry]\nrods = true\n", "utf-8")
    with pytest.raises(OverlayError, match="parallel rotary joints"):
        chainbuild.load(mill).chain()


def test_rods_that_cannot_be_are_refused() -> None:
    with pytest.raises(ChainError, match="parallel"):
        with_rods(chainbuild.load("ba_head_kin16").chain(), RodData())
    with pytest.raises(ChainError, match="affine"):
        with_rods(chainbuild.load("plasma_head_kin25").chain(), RodData())


def test_structure_and_names_do_not_change_with_rods() -> None:
    for name in ARMS:
        chain = chainbuild.load(name).chain()
        plain, rodded = chainbuild.Robot(chain), chainbuild.Robot(with_rods(chain, RodData()))
        assert type(singular_structure(rodded).form) is type(singular_structure(plain).form)
        for axes in samples(plain, 40):
            assert [f.sentence for f in names_at(rodded, axes)] == [f.sentence for f in names_at(plain, axes)]


def test_the_dead_point_of_the_linkage_is_a_notice() -> None:
    """A crank in line with the forearm is dead where the arm is stretched: its sine is the elbow's."""
    chain = chainbuild.load("irb2600").chain()
    robot = chainbuild.Robot(with_rods(chain, RodData()))
    stretched = math.degrees(math.atan2(115.0, 795.0)) - 90.0
    for off in (0.0, 3.0, -9.0, 12.0):
        axes = [0.0, 10.0, stretched + off, 10.0, 30.0, 0.0]
        found = [notice for notice in examine(robot, axes).notices if notice.kind == "dead_point"]
        assert len(found) == (abs(off) < 10.0)
        for notice in found:
            assert notice.value == pytest.approx(math.sin(math.radians(abs(off))), abs=1e-9)
            assert notice.axes == ("A3",)
            assert f"{abs(off):.3g}° from its dead point" in notice.condition or off == 0.0
        assert not [n for n in examine(chainbuild.Robot(chain), axes).notices if n.kind == "dead_point"]


def test_pinned_links_are_known() -> None:
    assert pinned_links(chainbuild.load("irb2600").chain()) == ()
    pairs = pinned_links(with_rods(chainbuild.load("palletiser_kin96").chain(), RodData()))
    assert ("rod_link", "G3_link") in pairs
    assert ("crank_link", "G2_link") in pairs
