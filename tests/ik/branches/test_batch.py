"""Branches over arrays: the same as one by one, limits kept, every branch confirmed, bad poses refused."""

from __future__ import annotations

import itertools
import math
import tracemalloc
from dataclasses import replace

import numpy as np
import py_opw_kinematics
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

import chainbuild
from chainbuild.chain.sums import AxisConstraint, AxisSum
from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.many import ik_all_batch
from chainbuild.ik.branches.opw import (
    batch,
)
from chainbuild.ik.branches.opw import (
    compiled as compiled_opw,
)
from chainbuild.ik.branches.opw import (
    constants as opw_constants,
)
from chainbuild.ik.branches.opw.formulas import CONSTANTS, confirmed, constant_rows
from chainbuild.ik.branches.opw.parameters import opw_arm
from chainbuild.ik.branches.vectors import operands, rows
from chainbuild.ik.request import IkRequest
from chainbuild.robot import Robot
from tests.kit.kin_robots import poses
from tests.kit.robots import arm, table_machine

MACHINES = ("arm", "kr6r900", "tx2_60", "irb2600", "parallelogram_nr")
both_paths = pytest.mark.parametrize("compiled", [True, False], ids=["compiled", "numpy"])


def machine(name: str) -> Robot:
    return arm() if name == "arm" else chainbuild.Robot.load(name)


def row_of(name: str) -> int:
    """Return where a constant of six numbers a row stands."""
    lengths = {"base": 2, "flange": 2, "turn": 6, "back": 6}
    return sum(lengths.get(before, 1) for before in CONSTANTS[: CONSTANTS.index(name)])


def compare_with_single(robot: Robot, targets: np.ndarray, found: np.ndarray, within: float = 1e-9) -> int:
    """Compare with `ik_all`, pose by pose, and with Pinocchio; return how many branches there are."""
    count = 0
    for row, target in zip(found, targets, strict=True):
        kept = row[np.isfinite(row).all(axis=1)]
        single = np.array([branch.axes for branch in robot.ik_all(target)]).reshape(-1, 6)
        assert len(kept) == len(single)
        for one in kept:
            assert np.abs(one - single).max(axis=1).min() < 1e-5
            assert robot.violated_limits(one) == ()
            assert np.abs(robot.fk(one).homogeneous - target).max() < within
        count += len(kept)
    return count


@both_paths
@pytest.mark.parametrize("name", MACHINES)
def test_the_same_branches_as_one_by_one(name: str, compiled: bool) -> None:
    robot = machine(name)
    targets = robot.fk_batch(np.array(poses(robot, 150)))
    assert compare_with_single(robot, targets, ik_all_batch(robot, targets, compiled=compiled)) > 150


@both_paths
@pytest.mark.parametrize("name", MACHINES)
def test_the_same_where_the_wrist_is_straight(name: str, compiled: bool) -> None:
    robot = machine(name)
    axes = np.array(poses(robot, 40))
    axes[:, 4] = 0.0
    targets = robot.fk_batch(axes)
    found = ik_all_batch(robot, targets, compiled=compiled)
    assert compare_with_single(robot, targets, found) > 20


@both_paths
@pytest.mark.parametrize("count", [80, pytest.param(400, marks=pytest.mark.slow)])
def test_the_same_where_the_wrist_stands_on_the_first_axis(count: int, compiled: bool) -> None:
    robot = machine("kr6r900")
    axes = np.array(poses(robot, count))
    axes[:, 0] = np.linspace(-100.0, 100.0, len(axes))
    targets = robot.fk_batch(axes)
    # The wrist centre, 80 mm behind the flange, moved onto axis 1: as far from it as it was high.
    centre = targets[:, :3, 3] - 0.08 * targets[:, :3, 2]
    targets[:, :3, 3] += np.stack([-centre[:, 0], -centre[:, 1], 0.0 * centre[:, 2]], axis=1)
    found = ik_all_batch(robot, targets, compiled=compiled)
    assert compare_with_single(robot, targets, found) > 100


def test_branches_over_the_first_axis_stand_in_their_slots() -> None:
    """With axis 1 at its start there is none; flip and elbow are those of the same axis values beside that axis."""
    robot = machine("irb2600")
    rng = np.random.default_rng(14)
    told = set()
    for middle in (-109.742572, 60.0, 110.0):
        for _ in range(12):
            axes = np.array([middle, 116.58534812908952, 56.66892235871629, 0.0, 0.0, 0.0])
            axes[3:] = rng.uniform(-110.0, 110.0, 3)
            found = ik_all_batch(robot, robot.fk(axes).homogeneous[None])[0]
            for slot in np.flatnonzero(np.isfinite(found[:, 0])).tolist():
                beside = found[slot] + [0.0, 0.3, 0.0, 0.0, 0.0, 0.0]
                every = ik_all_batch(robot, robot.fk(beside).homogeneous[None], limits=False)[0]
                off = np.abs(np.remainder(every - beside + 180.0, 360.0) - 180.0).max(axis=1)
                other = int(np.nanargmin(off))
                assert off[other] < 1e-6
                assert (other // 4, other % 2) == (slot // 4, slot % 2)
                told.add((slot // 4, slot % 2))
    assert len(told) > 1


def narrowed(robot: Robot, **limits: tuple[float, float]) -> Robot:
    """Return a robot with other limits of some axes."""
    ends = {axis.name: limits.get(axis.name, (axis.lower, axis.upper)) for axis in robot.axes}
    axes = [replace(axis, lower=ends[axis.name][0], upper=ends[axis.name][1]) for axis in robot.axes]
    return Robot(replace(robot.chain, axes=tuple(axes)))


@both_paths
def test_a_free_axis_of_the_wrist_is_placed_where_all_limits_hold(compiled: bool) -> None:
    """A4 in the middle of its limits would turn A6 beyond its own."""
    robot = narrowed(arm(), A4=(-100.0, 100.0), A6=(-60.0, 60.0))
    axes = np.array(poses(robot, 40))
    axes[:, 4] = 0.0
    axes[:, 3] = np.linspace(-100.0, 100.0, len(axes))
    targets = robot.fk_batch(axes)
    found = ik_all_batch(robot, targets, compiled=compiled)
    assert compare_with_single(robot, targets, found) > 40
    assert np.isfinite(found[:, :4, 0]).any(axis=1).all()
    loose = ik_all_batch(robot, targets, limits=False, compiled=compiled)
    assert (np.abs(found - loose)[np.isfinite(found)] > 1.0).any()
    kept = np.isfinite(found[:, :, :3]) & np.isfinite(loose[:, :, :3])  # the slot is that of the same branch
    assert np.abs((found - loose)[:, :, :3][kept]).max() < 1e-5


@both_paths
def test_a_free_axis_keeps_sums_of_axes(compiled: bool) -> None:
    sums = AxisConstraint("A4 + A2", AxisSum((0.0, 1.0, 0.0, 1.0, 0.0, 0.0), 0.0), 20.0, 90.0)
    robot = narrowed(Robot(replace(arm().chain, constraints=(sums,))), A4=(-170.0, 170.0))
    axes = np.array(poses(arm(), 15))
    axes[:, 3], axes[:, 4] = np.clip(np.linspace(20.0, 90.0, len(axes)) - axes[:, 1], -170.0, 170.0), 0.0
    targets = robot.fk_batch(axes)
    found = ik_all_batch(robot, targets, compiled=compiled)
    # A branch that ends on a limit of an axis is moved onto it by what rounding may leave.
    assert compare_with_single(robot, targets, found, within=1e-7) > 15


@both_paths
def test_whole_turns_that_keep_sums_of_axes_are_found(compiled: bool) -> None:
    """A2 + A4 within ten degrees, of axes that may turn more than once: not only the turns nearest to the middle."""
    sums = AxisConstraint("A2 + A4", AxisSum((0.0, 1.0, 0.0, 1.0, 0.0, 0.0), 0.0), 223.0, 233.0)
    free = narrowed(arm(), **{f"A{n}": (-540.0, 540.0) for n in range(1, 7)})
    robot = Robot(replace(free.chain, constraints=(sums,)))
    axes = np.random.default_rng(3).uniform(-170.0, 170.0, (12, 6))
    axes[:, 3] = np.random.default_rng(4).uniform(224.0, 232.0, 12) - axes[:, 1]
    targets = robot.fk_batch(axes)
    found = ik_all_batch(robot, targets, compiled=compiled)
    assert np.isfinite(found[:, :, 0]).any(axis=1).all()
    compare_with_single(robot, targets, found)


@both_paths
def test_without_limits_every_branch_is_exact(compiled: bool) -> None:
    robot = arm()
    targets = robot.fk_batch(np.array(poses(robot, 200)))
    found = ik_all_batch(robot, targets, limits=False, compiled=compiled)
    exists = np.isfinite(found).all(axis=2)
    assert exists.sum(axis=1).min() >= 4
    for n, slot in zip(*np.nonzero(exists), strict=True):
        assert np.abs(robot.fk(found[n, slot]).homogeneous - targets[n]).max() < 1e-9


@both_paths
def test_a_stretched_arm_has_its_branches(compiled: bool) -> None:
    """The wrist as far away as it comes, but for rounding: 4.76° straighten the forearm, which is 35 mm aside."""
    robot = arm()
    axes = np.array(poses(robot, 30))
    axes[:, 2] = math.degrees(math.atan2(35.0, 420.0))
    found = ik_all_batch(robot, robot.fk_batch(axes), limits=False, compiled=compiled)
    off = np.abs(np.remainder(found - axes[:, None] + 180.0, 360.0) - 180.0).max(axis=2)
    assert np.nanmin(off, axis=1).max() < 1e-4


@both_paths
def test_a_slot_is_a_branch(compiled: bool) -> None:
    """Along a path every slot moves continuously: it is the same branch in every pose."""
    robot = machine("irb2600")
    share = np.linspace(0.0, 1.0, 400)[:, None]
    first, last = np.array([10.0, 20.0, -30.0, 40.0, 50.0, 60.0]), np.array([40.0, 0.0, 10.0, 60.0, 70.0, 10.0])
    targets = robot.fk_batch(first + share * (last - first))
    found = ik_all_batch(robot, targets, limits=False, compiled=compiled)
    whole = np.isfinite(found).all(axis=(0, 2))
    assert whole.sum() >= 4
    steps = np.diff(found[:, whole], axis=0)
    assert np.abs((steps + 180.0) % 360.0 - 180.0).max() < 1.0


@both_paths
@pytest.mark.parametrize("name", ["arm", "irb2600", "tx2_60"])
def test_slots_are_those_of_another_closed_form(name: str, compiled: bool) -> None:
    """py-opw-kinematics numbers its branches alike; it is handed the arm's lengths and answers in the arm's angles."""
    robot = machine(name)
    serial = BranchQuery.of(IkRequest(robot, np.eye(4))).serial()
    known = opw_arm(serial)
    assert known is not None
    targets = robot.fk_batch(np.array(poses(robot, 200)))
    inward = np.array([known.inward(T) for T in targets])
    model = py_opw_kinematics.Robot(py_opw_kinematics.KinematicModel(**known.parameters), degrees=False)
    theirs = np.asarray(model.reach(RigidTransform.from_matrix(inward)).joints)
    found = ik_all_batch(robot, targets, limits=False, compiled=compiled)
    joints = [screw.joint for screw in serial.screws]
    ours = np.array([[known.theta(robot.q(row)[joints]) for row in pose] for pose in np.nan_to_num(found)])
    np.testing.assert_array_equal(np.isnan(found).any(axis=2), np.isnan(theirs).any(axis=2))
    exists = np.isfinite(found).all(axis=2)
    off = (ours - theirs)[exists]
    assert np.abs((off + np.pi) % (2.0 * np.pi) - np.pi).max() < 1e-7


@both_paths
def test_out_of_reach_is_not_a_number(compiled: bool) -> None:
    far = np.eye(4)
    far[0, 3] = 9.0
    assert np.isnan(ik_all_batch(arm(), far[None], compiled=compiled)).all()
    assert ik_all_batch(arm(), np.empty((0, 4, 4)), compiled=compiled).shape == (0, 8, 6)


@both_paths
def test_what_forward_kinematics_does_not_confirm_is_left_out(monkeypatch: pytest.MonkeyPatch, compiled: bool) -> None:
    """A closed form that goes wrong by 2e-4 degrees in one axis gives nothing; by 2e-8 degrees it is within."""
    robot = arm()
    targets = robot.fk_batch(np.array(poses(robot, 50)))
    right = opw_constants.opw_constants(robot, limits=False)
    assert right is not None
    for shift, count in ((2e-4, 0), (2e-8, np.isfinite(ik_all_batch(robot, targets, limits=False)).sum())):
        for axis in range(6):
            wrong = right.copy()
            wrong[row_of("shift"), axis] += shift
            monkeypatch.setattr(batch, "_constants", lambda *_, wrong=wrong: wrong)
            found = ik_all_batch(robot, targets, limits=False, compiled=compiled)
            assert np.isfinite(found).sum() == count
        monkeypatch.undo()


def test_every_part_of_a_pose_is_confirmed() -> None:
    """A pose that is turned about the TCP, or moved, by more than the tolerance is not the one that was meant."""
    robot = arm()
    known = opw_constants.opw_constants(robot, limits=True)
    assert known is not None
    base, flange, measures, _, backward, _ = constant_rows(known)
    axes = np.random.default_rng(5).uniform(-170.0, 170.0, (60, 6))
    meant = robot.fk_batch(axes)
    seen = operands.product(operands.product(base, meant[:, :3].reshape(60, 12).T), flange)
    for n, off in itertools.product(range(6), (0.5e-6, 2e-6)):
        T = meant.copy()
        if n < 3:
            T[:, n, 3] += off
        else:
            T[:, :3, :3] = Rotation.from_rotvec(off * np.eye(3)[n - 3]).as_matrix() @ T[:, :3, :3]
        M = operands.product(operands.product(base, T[:, :3].reshape(60, 12).T), flange)
        met = confirmed(axes.T, M, measures, backward)
        assert (met == (off < 1e-6)).all(), (n, off)
    # Turned about the flange, a long tool moves: what is 0.9e-6 rad there is 9e-6 m at 10 m.
    for tip in 10.0 * np.eye(3):
        long = (*measures[:3], (*tip, *measures[3][3:]))
        for n in range(3):
            M = np.array(seen).T.reshape(60, 3, 4)
            about_tip = Rotation.from_rotvec(0.9e-6 * np.eye(3)[n]).as_matrix()
            place = M[:, :, :3] @ tip + M[:, :, 3]
            M[:, :, :3] = about_tip @ M[:, :, :3]
            M[:, :, 3] = place - M[:, :, :3] @ tip
            assert confirmed(axes.T, M.reshape(60, 12).T, long, backward).all(), (tip, n)


@pytest.mark.parametrize("length", ["a1", "a2", "b", "c1", "c2", "c3"])
def test_lengths_that_are_not_the_robots_are_refused(monkeypatch: pytest.MonkeyPatch, length: str) -> None:
    measured = opw_constants.opw_arm

    def wrong(serial):
        found = measured(serial)
        return replace(found, parameters={**found.parameters, length: found.parameters[length] + 1e-6})

    monkeypatch.setattr(opw_constants, "opw_arm", wrong)
    assert opw_constants.opw_constants(arm(), limits=True) is None


@both_paths
def test_chunks_do_not_change_the_answer(monkeypatch: pytest.MonkeyPatch, compiled: bool) -> None:
    robot = machine("parallelogram_nr")
    targets = robot.fk_batch(np.array(poses(robot, 2100)))
    whole = ik_all_batch(robot, targets, compiled=compiled)
    one_by_one = np.concatenate([ik_all_batch(robot, target[None], compiled=compiled) for target in targets[:70]])
    np.testing.assert_allclose(one_by_one, whole[:70], rtol=0.0, atol=1e-9)
    monkeypatch.setattr(rows, "_CHUNK", 7)
    np.testing.assert_allclose(ik_all_batch(robot, targets, compiled=compiled), whole, rtol=0.0, atol=1e-9)
    monkeypatch.undo()
    # Enough for all cores, the last block short.
    many = ik_all_batch(robot, np.tile(targets, (5, 1, 1)), compiled=compiled)
    np.testing.assert_allclose(many, np.tile(whole, (5, 1, 1)), rtol=0.0, atol=1e-9)


@both_paths
def test_memory_is_the_answers(compiled: bool) -> None:
    robot = arm()
    targets = np.repeat(robot.fk_batch(np.array(poses(robot, 50))), 1000, axis=0)
    ik_all_batch(robot, targets[:50], compiled=compiled)
    tracemalloc.start()
    found = ik_all_batch(robot, targets, compiled=compiled)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 1.5 * found.nbytes


@both_paths
@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda T: T.__setitem__((slice(3), slice(3)), 1.001 * T[:3, :3]), "rotation"),
        (lambda T: T.__setitem__((slice(3), 0), -T[:3, 0]), "rotation"),
        (lambda T: T.__setitem__((3, 0), 0.5), "last row"),
        (lambda T: T.__setitem__((0, 3), math.nan), "finite"),
    ],
)
def test_poses_that_are_not_rigid_are_refused_by_number(spoil, message: str, compiled: bool) -> None:
    robot = arm()
    targets = robot.fk_batch(np.array(poses(robot, 70)))
    spoil(targets[66])
    with pytest.raises(ChainbuildError, match=r"pose 66: ") as caught:
        ik_all_batch(robot, targets, compiled=compiled)
    with pytest.raises(ChainbuildError) as single:
        robot.ik_all(targets[66])
    assert caught.value.message == f"pose 66: {single.value.message}"


@both_paths
def test_a_pose_that_is_not_rigid_is_found_among_those_of_all_cores(compiled: bool) -> None:
    robot = arm()
    targets = np.tile(robot.fk_batch(np.array(poses(robot, 100))), (90, 1, 1))
    targets[5000, 3, 0] = 0.5
    with pytest.raises(ChainbuildError, match=r"pose 5000: "):
        ik_all_batch(robot, targets, compiled=compiled)


def test_what_is_refused() -> None:
    robot = Robot.load("gantry_robot_kin210")
    with pytest.raises(ChainbuildError, match=r"needs a plan that finds every branch: .* axes are free") as caught:
        ik_all_batch(robot, np.eye(4)[None])
    assert caught.value.parameter == "held"
    with pytest.raises(ChainbuildError, match="pose"):
        ik_all_batch(arm(), np.eye(4))
    with pytest.raises(ChainbuildError, match="pose 1: "):
        ik_all_batch(table_machine(), [np.eye(4), 2.0 * np.eye(4)])


def test_compiled_angles_are_those_of_the_library() -> None:
    import numba

    @numba.njit
    def angle(y, x):
        return operands.arctan2(y, x)

    @numba.njit
    def pair(a):
        return operands.sine_cosine(a)

    assert compiled_opw.write_branches is not None  # registers the formulas
    rng = np.random.default_rng(0)
    points = rng.normal(size=(20_000, 2)) * 10.0 ** rng.uniform(-9.0, 3.0, (20_000, 2))
    special = [(0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (-1.0, 0.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1e-300, -1.0)]
    for y, x in [*points.tolist(), *special]:
        assert angle(y, x) == pytest.approx(math.atan2(y, x), rel=4e-16, abs=1e-300)
    for a in rng.uniform(-20.0, 20.0, 5000):
        assert pair(a) == pytest.approx((math.sin(a), math.cos(a)), abs=1e-11)


@pytest.mark.parametrize("name", ["kr6r900", "kr6r900_2", "tx2_60", "irb2600", "parallelogram_nr"])
def test_slots_tell_the_shoulder_as_it_is_drawn(name: str) -> None:
    """Shoulder 0 is the wrist ahead of axis 1, in X of the column's frame, whichever way the axes count."""
    robot = chainbuild.Robot.load(name)
    first, wrist = (robot.chain.joints[n].child for n in (0, 4))
    seen = set()
    for axes in np.random.default_rng(4).uniform(-150.0, 150.0, (40, 6)):
        rows = robot.ik_all_batch([robot.fk(axes)], limits=False)[0]
        off = np.abs(np.remainder(rows - axes + 180.0, 360.0) - 180.0).max(axis=1)
        slot = int(np.nanargmin(off))
        assert off[slot] < 1e-6
        placed = robot.frame_placements(axes)
        ahead = float(placed[first].actInv(placed[wrist]).translation[0])
        assert (slot // 2) % 2 == (ahead < 0.0), (axes, slot, ahead)
        seen.add(ahead < 0.0)
    assert seen == {True, False}
