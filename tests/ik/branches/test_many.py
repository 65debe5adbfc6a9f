"""All branches of many poses, of every plan: the same as one by one; redundant axes at samples of their range."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.ik.branches.compiled.quick import quick_branches
from chainbuild.ik.branches.core.branches import Branches
from chainbuild.ik.branches.every import ik_all
from chainbuild.ik.branches.many import ik_all_batch
from chainbuild.ik.search.compiled import packing
from chainbuild.robot import Robot
from tests.kit.draws import random_axes
from tests.kit.robots import arm

# One machine of each plan, and the number of poses: those of the plain path take milliseconds.
PLANS = {
    "ac_table_kin58": 20, "cac_table_kin64": 6, "arm_nr5": 20, "arm_nn": 6, "comau_calibrated": 20, "scara_cc": 10,
    "palletiser_kin213": 6, "linear_robot_kin206": 3, "c_face_kin14": 6, "delta_kin37": 4, "parallelogram_nr": 20,
    "irb2600_track": 20,
}  # fmt: skip


# Machines that compiled code knows.
COMPILED = {"hand", "kr6r900_2", "arm_nn", "ac_table_kin58"}


def some_poses(robot: Robot, count: int, seed: int = 3) -> np.ndarray:
    rng = np.random.default_rng(seed)
    rows = np.array([random_axes(robot, rng) for _ in range(count)])
    rows[:, [n for n, axis in enumerate(robot.axes) if axis.held]] = 0.0
    return np.array([robot.fk(row).homogeneous for row in rows])


def rows_of(pose: np.ndarray) -> np.ndarray:
    return pose[np.isfinite(pose).all(axis=1)]


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("name", PLANS)
def test_the_same_branches_as_one_by_one(name: str, compiled: bool) -> None:
    robot = chainbuild.Robot.load(name)
    poses = some_poses(robot, PLANS[name] if compiled else 3)
    found = ik_all_batch(robot, poses, compiled=compiled)
    assert found.shape[0] == len(poses)
    assert found.shape[2] == len(robot.axes)
    assert np.isfinite(found).any()
    for row, T in zip(found, poses, strict=True):
        single = robot.ik_all(T).axes
        kept = rows_of(row)
        assert len(kept) == len(single)
        assert np.isnan(row[len(kept) :]).all() or robot.plan().name == "spherical wrist"
        for axes in kept:
            assert np.abs(single - axes).max(axis=1).min() < 1e-5
            assert robot.violated_limits(axes) == ()


@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize(
    "name",
    ["hand", "kr6r900_2", "arm_rr", "arm_nn", "ac_table_kin58", "plasma_head_kin25", "tripod_table_kin209", "scara_cc"],
)
def test_poses_with_few_digits_have_the_same_branches(
    monkeypatch: pytest.MonkeyPatch, name: str, compiled: bool
) -> None:
    """Seven decimals, as in a file, or 32 bits: the nearest rotation is meant, which the equations need to 1e-9."""
    if not compiled:
        monkeypatch.setattr(packing, "available", lambda: False)
    robot = arm() if name == "hand" else chainbuild.Robot.load(name)
    for T in some_poses(robot, 5 if compiled else 2):
        exact = robot.ik_all(T).axes
        for given in (T.round(7), T.astype(np.float32)):
            if compiled and name in COMPILED:
                assert isinstance(quick_branches(robot, np.asarray(given, dtype=float), None, None), Branches)
            few, batch = robot.ik_all(given).axes, rows_of(robot.ik_all_batch(given[None])[0])
            assert len(few) == len(batch) == len(exact)
            for axes in exact:
                assert np.abs(few - axes).max(axis=1).min() < 0.05
                assert np.abs(batch - axes).max(axis=1).min() < 0.05


@pytest.mark.parametrize("name", ["ac_table_kin58", "scara_cc", "palletiser_kin213"])
def test_without_limits_there_are_more(name: str) -> None:
    robot = chainbuild.Robot.load(name)
    poses = some_poses(robot, 12)
    inside, every = ik_all_batch(robot, poses), ik_all_batch(robot, poses, limits=False)
    assert np.isfinite(every).all(axis=2).sum() > np.isfinite(inside).all(axis=2).sum()
    for row, T in zip(every, poses, strict=True):
        for axes in rows_of(row):
            assert np.abs(robot.fk(axes).homogeneous[:3, 3] - T[:3, 3]).max() < 1e-8


def test_more_poses_than_one_core_takes_at_a_time() -> None:
    robot = chainbuild.Robot.load("ac_table_kin58")
    poses = some_poses(robot, 3000)
    told: list[tuple[int, int]] = []
    found = robot.ik_all_batch(poses, progress=lambda done, total: told.append((done, total)))
    assert told[-1] == (3000, 3000)
    for n in (0, 1023, 1024, 2999):
        np.testing.assert_allclose(rows_of(found[n]), robot.ik_all(poses[n]).axes, atol=1e-9)


def test_held_axes_and_units() -> None:
    robot = chainbuild.Robot.load("irb2600_track")
    T = robot.fk([10.0, 20.0, -30.0, 40.0, 50.0, 60.0, 1500.0])
    found = rows_of(robot.ik_all_batch([T], held={"EX1": 1500.0})[0])
    np.testing.assert_allclose(found, robot.ik_all(T, held={"EX1": 1500.0}).axes, atol=1e-9)
    si = rows_of(robot.ik_all_batch([T], held={"EX1": 1.5}, units="si")[0])
    np.testing.assert_allclose(si, found * robot.kinematics.si_factors, atol=1e-12)
    with pytest.raises(AxisValueError, match="no axis 'EX9'"):
        robot.ik_all_batch([T], held={"EX9": 0.0})


def test_a_redundant_axis_stands_at_samples_of_its_range() -> None:
    robot = chainbuild.Robot.load("irb2600_track")
    T = robot.fk([10.0, 20.0, -30.0, 40.0, 50.0, 60.0, 1500.0])
    places = np.linspace(0.0, 6000.0, 9)
    found = robot.ik_all(T, redundant="EX1", samples=9)
    assert set(found.axes[:, 6]) <= set(places)
    assert len(found) == sum(len(robot.ik_all(T, held={"EX1": place})) for place in places)
    for branch in found:
        assert np.abs(robot.fk(branch.axes).homogeneous - T.homogeneous).max() < 1e-9
    start = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1510.0])
    near = robot.ik_all(T, start, redundant="EX1", samples=9)
    assert (near.axes[:, 6] == 1510.0).any()
    far = [np.linalg.norm((branch.axes - start) * robot.kinematics.si_factors) for branch in near]
    assert far == sorted(far)
    batch = robot.ik_all_batch([T, T], redundant="EX1", samples=9)
    width = batch.shape[1] // 9
    for n, place in enumerate(places):
        rows = rows_of(batch[1, n * width : (n + 1) * width])
        np.testing.assert_allclose(rows, robot.ik_all(T, held={"EX1": place}).axes, atol=1e-9)


def test_seven_rotary_axes_with_one_named_redundant() -> None:
    """A seven-axis arm: its third axis over a whole turn, without the second end, which is the first again."""
    robot = seven_axes()
    axes = np.array([20.0, 40.0, 90.0, -70.0, 30.0, 60.0, -40.0])
    T = robot.fk(axes)
    with pytest.raises(ChainbuildError, match="7 axes are free"):
        robot.ik_all(T)
    found = robot.ik_all(T, redundant="J3", samples=8)
    assert set(found.axes[:, 2]) == set(np.arange(-180.0, 180.0, 45.0))
    assert np.abs(found.axes - axes).max(axis=1).min() < 1e-6
    assert len(found) > 16
    for branch in found:
        assert np.abs(robot.fk(branch.axes).homogeneous - T.homogeneous).max() < 1e-9


def seven_axes() -> Robot:
    """Return an arm of seven axes that stand across each other, spherical at shoulder and wrist."""
    from chainbuild.chain.assemble import rotary, shift
    from tests.kit.robots import robot_from

    elements = [
        shift(z=340.0), rotary("J1", "z"), rotary("J2", "y"), rotary("J3", "z"), shift(z=400.0), rotary("J4", "-y"),
        shift(z=400.0), rotary("J5", "z"), rotary("J6", "y"), rotary("J7", "z"), shift(x=10.0, z=126.0),
    ]  # fmt: skip
    return robot_from(elements)


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({"redundant": "EX9"}, "no axis 'EX9'"),
        ({"redundant": 7}, "no axis 7"),
        ({"redundant": "EX1", "held": {"EX1": 0.0}}, "both held and redundant"),
        ({"redundant": ("EX1", "EX1")}, "named twice"),
        ({"redundant": ()}, "no redundant axis"),
        ({"redundant": "EX1", "samples": 0}, "samples is 0"),
        ({"redundant": "EX1", "samples": 2.5}, "samples is 2.5"),
        ({"redundant": ("A1", "EX1"), "samples": 2000}, "4000000 combinations"),
    ],
)
def test_what_a_redundant_axis_must_be(given: dict[str, object], text: str) -> None:
    robot = chainbuild.Robot.load("irb2600_track")
    T = robot.fk(np.zeros(7))
    for call in (lambda: ik_all(robot, T, **given), lambda: ik_all_batch(robot, [T], **given)):  # type: ignore[arg-type]
        with pytest.raises(ChainbuildError, match=text):
            call()


def test_an_arm_that_urdf_rounds_has_all_its_branches(tmp_path) -> None:
    """Roll, pitch, yaw of 1.5708 put the wrist axes beside each other by a hair: no closed form, eight branches."""
    joints = [
        ("0 0 0.4", "0 0 0", "0 0 1"), ("0.025 0 0", "-1.5708 0 0", "0 0 1"), ("0.455 0 0", "0 0 0", "0 0 1"),
        ("0.035 0.42 0", "-1.5708 0 0", "0 0 1"), ("0 0 0", "1.5708 0 0", "0 0 1"), ("0 0 0", "-1.5708 0 0", "0 0 1"),
    ]  # fmt: skip
    text = '<robot name="rounded"><link name="l0"/>'
    for n, (xyz, rpy, axis) in enumerate(joints, start=1):
        text += f'<link name="l{n}"/><joint name="J{n}" type="revolute"><parent link="l{n - 1}"/><child link="l{n}"/>'
        text += f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>'
        text += '<limit lower="-3.1" upper="3.1" effort="1" velocity="1"/></joint>'
    file = tmp_path / "rounded.urdf"
    file.write_text(text + "</robot>", "utf-8")
    robot = Robot.from_urdf(file)
    rng = np.random.default_rng(3)
    rows = np.degrees(rng.uniform(-1.2, 1.2, (6, 6)))
    poses = robot.fk_batch(rows)
    found = robot.ik_all_batch(poses)
    for axes, pose in zip(rows, found, strict=True):
        assert np.abs(rows_of(pose) - axes).max(axis=1).min() < 1e-6
    assert np.isfinite(found).all(axis=2).sum(axis=1).max() == 8


def test_arm_keeps_its_slots() -> None:
    """What has a numbering of its branches keeps it; held axes go through the other path to the same branches."""
    robot = arm()
    T = robot.fk([10.0, -60.0, 80.0, 30.0, 50.0, 40.0])
    assert ik_all_batch(robot, [T]).shape == (1, 8, 6)
