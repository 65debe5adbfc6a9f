"""All branches of many poses of arms with three parallel axes: against the poses one by one and scipy's rotations."""

from __future__ import annotations

import itertools
import math
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from chainbuild.arrays import Matrices, Matrix, Vector
from chainbuild.chain.assemble import rotary, shift, turn
from chainbuild.chain.axismap import AffineMap
from chainbuild.chain.sums import AxisConstraint, AxisSum
from chainbuild.errors import ChainbuildError
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.core.serial import Serial
from chainbuild.ik.branches.every import every_branch
from chainbuild.ik.branches.planar import batch, constants
from chainbuild.ik.branches.planar.batch import planar_batch
from chainbuild.ik.branches.planar.constants import planar_constants
from chainbuild.ik.branches.planar.formulas import PLANAR_ROWS, arm_rows, is_confirmed, seen_from_axes
from chainbuild.ik.request import IkRequest, start_point
from chainbuild.robot import Robot
from tests.kit.parallel_arms import MADE, made_arm, pose_by_hand, random_parallel_arm, robot_of_screws, with_signs
from tests.kit.robots import arm, robot_from, ur5

LIMITS = ((-170, 190), (-200, 95), (-150, 155), (-360, 360), (-20, 300), (-350, 20))
both_paths = pytest.mark.parametrize("compiled", [True, False], ids=["compiled", "numpy"])


def poses(serial: Serial, count: int, seed: int = 5) -> tuple[Matrix, Matrices]:
    """Return joint values and their poses by scipy's rotations."""
    values = np.random.default_rng(seed).uniform(-math.pi, math.pi, (count, 6))
    return values, np.array([pose_by_hand(serial, row) for row in values])


def quick(robot: Robot, targets: Matrices, *, compiled: bool, limits: bool = True) -> tuple[Matrices, Vector]:
    known = planar_batch(robot, targets, limits=limits, compiled=compiled)
    assert known is not None
    return known


def one_by_one(robot: Robot, target: Matrix, *, compiled: bool) -> Matrix:
    return (
        robot.ik_all(target).axes
        if compiled
        else every_branch(BranchQuery.of(IkRequest.of(robot, target))).branches.axes
    )


def compare(robot: Robot, serial: Serial, targets: Matrices, compiled: bool, limits: bool = True) -> tuple[int, int]:
    """Compare with poses one by one and scipy; return how many branches there are, and how many poses in doubt."""
    axes, counts = quick(robot, targets, compiled=compiled, limits=limits)
    every = robot.ik_all_batch(targets, compiled=compiled, limits=limits)
    for row, count, whole, target in zip(axes, counts.tolist(), every, targets, strict=True):
        single = one_by_one(robot, target, compiled=compiled) if limits else None
        kept = whole[np.isfinite(whole).all(axis=1)]
        assert np.isnan(whole[len(kept) :]).all()
        if single is not None:
            np.testing.assert_allclose(kept, single, rtol=0.0, atol=1e-6)
        for one in kept:
            assert np.abs(pose_by_hand(serial, np.radians(one)) - target).max() < 1e-8
            assert not limits or robot.violated_limits(one) == ()
        if count >= 0:
            np.testing.assert_array_equal(row[:count], kept)
            assert np.isnan(row[count:]).all()
    return int(np.isfinite(every[:, :, 0]).sum()), int((counts < 0).sum())


@both_paths
@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("wrist", ["meeting", "parallel"])
def test_arms_in_any_place_with_any_signs(wrist: str, backwards: bool, compiled: bool) -> None:
    rng = np.random.default_rng(1)
    for _ in range(3):
        serial = random_parallel_arm(rng, wrist, backwards=backwards)
        values, targets = poses(serial, 40 if compiled else 6)
        robot = robot_of_screws(serial)
        branches, doubtful = compare(robot, serial, targets, compiled)
        assert branches >= 2 * len(targets) - 2 * doubtful
        assert doubtful <= 1
        every = robot.ik_all_batch(targets, compiled=compiled)
        off = np.abs((every - np.degrees(values)[:, None] + 180.0) % 360.0 - 180.0).max(axis=2)
        assert np.nanmin(off, axis=1).max() < 1e-6  # what made the pose is among them


@both_paths
@pytest.mark.parametrize("limits", [True, False])
@pytest.mark.parametrize("name", MADE)
def test_arms_as_they_are_made(name: str, limits: bool, compiled: bool) -> None:
    signs = itertools.cycle(itertools.product((1.0, -1.0), repeat=6))
    for step in (1, 11, 23):
        serial = with_signs(made_arm(name), next(itertools.islice(signs, step, None)))
        robot = robot_of_screws(serial, LIMITS)
        _, targets = poses(serial, 60 if compiled else 6, seed=step)
        branches, _ = compare(robot, serial, targets, compiled, limits)
        assert branches > (len(targets) if limits else 4 * len(targets))


@pytest.mark.parametrize("seed", [3, pytest.param(4, marks=pytest.mark.slow), pytest.param(5, marks=pytest.mark.slow)])
def test_thousands_of_poses_and_few_in_doubt(seed: int) -> None:
    """Compiled and by NumPy the same; one in a hundred at most is left to the poses one by one."""
    serial = made_arm("UR10e")
    robot = robot_of_screws(serial, LIMITS)
    _, targets = poses(serial, 3000, seed)
    axes, counts = quick(robot, targets, compiled=True)
    plain, plain_counts = quick(robot, targets, compiled=False)
    np.testing.assert_array_equal(counts, plain_counts)
    assert (counts < 0).sum() < 30
    told = counts >= 0
    np.testing.assert_allclose(axes[told], plain[told], rtol=0.0, atol=1e-8)
    tiled = np.tile(targets, (3, 1, 1))  # enough for all cores, the last part short
    np.testing.assert_array_equal(robot.ik_all_batch(tiled), np.tile(robot.ik_all_batch(targets), (3, 1, 1)))


@both_paths
@pytest.mark.parametrize("beside", [0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-3, 1e-2])
def test_singular_poses_and_poses_beside_them_are_those_one_by_one(beside: float, compiled: bool) -> None:
    """Straight and folded links, axis 6 parallel to the three: in doubt, or as exact as elsewhere."""
    serial = made_arm("UR5")
    robot = robot_of_screws(serial, LIMITS)
    values = np.random.default_rng(7).uniform(-2.0, 2.0, (12, 6))
    values[:4, 2], values[4:8, 4], values[8:, 2] = beside, beside, math.pi - beside
    targets = np.array([pose_by_hand(serial, row) for row in values])
    _, doubtful = compare(robot, serial, targets, compiled)
    assert doubtful == 12 or beside > 1e-5
    assert doubtful == 0 or beside < 5e-3


@both_paths
def test_an_axis_on_its_limit_is_in_doubt(compiled: bool) -> None:
    serial = made_arm("UR5")
    values = np.array([20.0, -70.0, 80.0, 30.0, 50.0, -40.0])
    target = pose_by_hand(serial, np.radians(values))[None]
    for n, off in itertools.product(range(6), (0.0, 1e-9, -1e-9, 1e-3, -1e-3)):
        for lower in (True, False):
            ends = (values[n] + off, values[n] + 195.0) if lower else (values[n] - 195.0, values[n] + off)
            robot = robot_of_screws(serial, [*LIMITS[:n], ends, *LIMITS[n + 1 :]])
            axes, counts = quick(robot, target, compiled=compiled)
            assert (counts[0] < 0) == (abs(off) < 1e-6)
            there = np.abs(robot.ik_all_batch(target, compiled=compiled)[0] - values).max(axis=1) < 1e-6
            assert there.any() == (abs(off) < 1e-6 or (off < 0.0) == lower)
            assert counts[0] < 0 or (np.abs(axes[0] - values).max(axis=1) < 1e-6).any() == there.any()


@both_paths
@pytest.mark.parametrize("digits", [9, 8, 7, 0])
def test_poses_with_few_digits(digits: int, compiled: bool) -> None:
    """Rounded, or in 32 bits: the nearest rotation is meant; nothing is lost, also on limits, and few are in doubt."""
    serial, rng = made_arm("UR10e"), np.random.default_rng(12)
    for side in range(12 if compiled else 3):
        values = rng.uniform(-150.0, 150.0, 6).round()
        limits = np.column_stack([values - 25.0, values + 25.0])
        limits[side % 6] = (values[side % 6] - 50.0, values[side % 6])
        robot = robot_of_screws(serial, [(low, high) for low, high in limits.tolist()])
        T = pose_by_hand(serial, np.radians(values))
        given = T.round(digits) if digits else T.astype(np.float32)
        single = one_by_one(robot, given.astype(float), compiled=compiled)
        every = robot.ik_all_batch(given[None], compiled=compiled)[0]
        kept = every[np.isfinite(every[:, 0])]
        assert len(kept) == len(single)
        np.testing.assert_allclose(kept, single, rtol=0.0, atol=2e-5)
    _, targets = poses(serial, 300)
    rounded = targets.round(digits) if digits else targets.astype(np.float32).astype(float)
    _, counts = quick(robot_of_screws(serial), rounded, compiled=compiled)
    assert (counts < 0).sum() < 5
    spoiled = targets.copy()
    spoiled[:, :3, 0] *= 1.0 + 1e-5
    with pytest.raises(ChainbuildError, match="pose 0: "):
        quick(robot_of_screws(serial), spoiled, compiled=compiled)


@both_paths
def test_what_another_pose_needs_room_for_is_no_branch(compiled: bool) -> None:
    """A singular pose beside one with more branches, both left to the poses one by one."""
    serial = made_arm("UR10e")
    limits = [(-350.0, 350.0), (-350.0, 350.0), (-360.0, 360.0), (-170.0, 170.0), (-180.0, 180.0), (-360.0, 360.0)]
    robot = robot_of_screws(serial, limits)
    singular = pose_by_hand(serial, np.radians([78.0, 15.0, 180.0, 107.0, -180.0, 90.0]))
    many = pose_by_hand(serial, np.radians([20.0, -70.0, 80.0, 30.0, 0.003, -40.0]))
    assert (quick(robot, np.array([singular, many]), compiled=compiled)[1] == -1).all()
    alone = [robot.ik_all_batch(T[None], compiled=compiled)[0] for T in (singular, many)]
    together = robot.ik_all_batch(np.array([singular, many, singular]), compiled=compiled)
    for row, one in zip(together, (*alone, alone[0]), strict=True):
        np.testing.assert_array_equal(row[np.isfinite(row[:, 0])], one[np.isfinite(one[:, 0])])
    assert len(alone[0]) < len(alone[1])


@both_paths
def test_half_a_turn_from_the_start(compiled: bool) -> None:
    """180 and -180 degrees are the same place: the one that `ik_all` tells."""
    serial = made_arm("UR5")
    others = np.random.default_rng(9).uniform(-90.0, 90.0, (12, 6))
    for middle in (0.0, 30.0, -30.0):
        robot = robot_of_screws(serial, [(middle - 360.0, middle + 360.0)] * 6)
        start = np.degrees(start_point(robot, None, None)[0])  # near the middle of the limits
        for n in (0, 5):
            values = others.copy()
            values[:, n] = 180.0 + start[n]
            targets = np.array([pose_by_hand(serial, np.radians(row)) for row in values])
            compare(robot, serial, targets, compiled)


@both_paths
@pytest.mark.parametrize("beside", [1e-9, 1e-8, 1e-4, -1e-9])
def test_where_both_values_of_angle_1_nearly_meet(beside: float, compiled: bool) -> None:
    """The wrist as far from axis 1 as the shoulder is offset from it, but for a share."""
    serial = made_arm("UR5")
    robot = robot_of_screws(serial, LIMITS)
    _, targets = poses(serial, 12)
    wrist = targets[:, :2, 3] - 0.0823 * targets[:, :2, 2]
    away = np.linalg.norm(wrist, axis=1, keepdims=True)
    targets[:, :2, 3] += wrist * (0.10915 * (1.0 + beside) / away - 1.0)
    near = np.linalg.norm(targets[:, :2, 3] - 0.0823 * targets[:, :2, 2], axis=1)
    np.testing.assert_allclose(near, 0.10915 * (1.0 + beside), rtol=1e-13)
    _, doubtful = compare(robot, serial, targets, compiled)
    assert doubtful == (0 if beside > 1e-5 else 12)


@both_paths
@pytest.mark.parametrize("wrist", ["over axis 1", "parallel to axis 1"])
def test_where_angle_1_has_no_effect_but_for_rounding(wrist: str, compiled: bool) -> None:
    """Every angle 1 is right: a whole curve of solutions, not none."""
    over = wrist == "over axis 1"
    base, tool = (
        Rotation.from_euler("xyz", (0.3, -0.5, 0.7)).as_matrix(),
        Rotation.from_rotvec((0.4, 0.6, -0.2)).as_matrix(),
    )
    robot = robot_from([
        turn(base), shift(z=100.0), rotary("A1", "z"), rotary("A2", "y"), shift(z=400.0), rotary("A3", "y"),
        shift(z=300.0), rotary("A4", "y"), rotary("A5", "z"), shift(x=0.0 if over else 200.0, z=50.0),
        rotary("A6", "y" if over else "z"), shift(z=77.0), turn(tool),
    ])  # fmt: skip
    rng, targets = np.random.default_rng(11), []
    for row in rng.uniform(-150.0, 150.0, (100, 6)):
        T = robot.fk(row).homogeneous
        if over:  # where axes 5 and 6 meet
            wrist = base.T @ (T[:3, 3] - 0.077 * T[:3, :3] @ tool.T[:, 2])
            T[:3, 3] -= base @ [*wrist[:2], 0.0]
        else:
            T[:3, :3] = base @ Rotation.from_rotvec([0.0, 0.0, rng.uniform(-3.0, 3.0)]).as_matrix() @ tool
        targets.append(T)
    _, counts = quick(robot, np.array(targets), compiled=compiled)
    assert (counts == -1).all()


@both_paths
def test_coupled_axes(compiled: bool) -> None:
    """Axes that take others with them, whole turns staying whole turns."""
    serial = made_arm("CR5")
    plain = robot_of_screws(serial)
    A = np.eye(6)
    A[2, 1], A[5, 4] = -1.0, 1.0
    axis_map = plain.chain.axis_map
    assert isinstance(axis_map, AffineMap)
    coupled = Robot(replace(plain.chain, axis_map=replace(axis_map, A=A)))
    rows = np.random.default_rng(8).uniform(-170.0, 170.0, (20, 6))
    targets = np.array([pose_by_hand(serial, A @ np.radians(row)) for row in rows])
    axes, counts = quick(coupled, targets, compiled=compiled)
    assert (counts > 0).all()
    for row, found, target in zip(rows, axes, targets, strict=True):
        kept = found[np.isfinite(found[:, 0])]
        assert np.abs((kept - row + 180.0) % 360.0 - 180.0).max(axis=1).min() < 1e-6
        for one in kept:
            assert np.abs(pose_by_hand(serial, A @ np.radians(one)) - target).max() < 1e-8


@both_paths
def test_what_forward_kinematics_does_not_confirm_is_in_doubt(monkeypatch: pytest.MonkeyPatch, compiled: bool) -> None:
    """A closed form that goes wrong by 2e-6 degrees in one axis tells nothing of a pose that has branches."""
    serial = made_arm("UR5")
    _, targets = poses(serial, 20)
    right = planar_constants(robot_of_screws(serial), limits=True)
    assert right is not None
    for axis in range(6):
        wrong = right.copy()
        wrong[row_of("shift"), axis] += 2e-6
        monkeypatch.setattr(batch, "planar_constants", lambda *_, wrong=wrong, **__: wrong)
        _, counts = quick(robot_of_screws(serial), targets, compiled=compiled)
        assert (counts == -1).all()


def row_of(name: str) -> int:
    """Return where a constant of six numbers a row stands."""
    lengths = {"before": 2, "after": 2, "turn": 6, "back": 6}
    return sum(lengths.get(before, 1) for before in PLANAR_ROWS[: PLANAR_ROWS.index(name)])


@pytest.mark.parametrize("wrist", ["meeting", "parallel"])
def test_every_part_of_a_pose_is_confirmed(wrist: str) -> None:
    """Moved along each axis or turned about it by more than the tolerance, a pose is not the one that was meant."""
    robot = robot_of_screws(random_parallel_arm(np.random.default_rng(4), wrist))
    known = planar_constants(robot, limits=True)
    assert known is not None
    rows = arm_rows(known)
    axes = np.random.default_rng(5).uniform(-170.0, 170.0, (60, 6))
    meant = np.array(seen_from_axes(robot.fk_batch(axes)[:, :3].reshape(60, 12).T, rows)).T.reshape(60, 3, 4)
    for n, off in itertools.product(range(6), (0.5e-9, 3e-9)):
        M = meant.copy()
        if n < 3:
            M[:, n, 3] += off
        else:
            M[:, :, :3] = Rotation.from_rotvec(off * np.eye(3)[n - 3]).as_matrix() @ M[:, :, :3]
        assert (is_confirmed(axes.T, M.reshape(60, 12).T, rows[2], rows[4]) == (off < 1e-9)).all(), (n, off)


MEASURES = {"before": 12, "after": 12, "first": 4, "fourth": 5, "fifth": 3, "links": 2, "back": 36, "zero": 6}


@pytest.mark.parametrize("name", MEASURES)
def test_measures_that_are_not_the_robots_are_refused(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Each number of an arm is confirmed by forward kinematics, before the first pose."""
    serial = random_parallel_arm(np.random.default_rng(2), "parallel")
    robot = robot_of_screws(serial)
    assert planar_constants(robot, limits=True) is not None
    for n in range(MEASURES[name]):

        def wrong(right: Matrix, n: int = n) -> object:
            spoiled = right.copy()
            spoiled[row_of(name) + n // 6, n % 6] += 1e-6
            return arm_rows(spoiled)

        monkeypatch.setattr(constants, "arm_rows", wrong)
        assert planar_constants(robot, limits=True) is None, n
        monkeypatch.undo()


@both_paths
@pytest.mark.parametrize("name", ["links", "alone"])
def test_what_only_solving_needs_is_in_doubt_where_it_is_wrong(
    monkeypatch: pytest.MonkeyPatch, name: str, compiled: bool
) -> None:
    """Numbers that forward kinematics does not take: a wrong one leads to no branch that it confirms."""
    serial = random_parallel_arm(np.random.default_rng(2), "parallel")
    _, targets = poses(serial, 20)
    right = planar_constants(robot_of_screws(serial), limits=True)
    assert right is not None
    for n in range(2, 4) if name == "links" else range(6):
        wrong = right.copy()
        wrong[row_of(name), n] += 1e-3
        monkeypatch.setattr(batch, "planar_constants", lambda *_, wrong=wrong, **__: wrong)
        axes, counts = quick(robot_of_screws(serial), targets, compiled=compiled)
        assert (counts[np.isfinite(axes[:, 0, 0]) | (counts != 0)] == -1).all()


@both_paths
def test_poses_that_are_not_rigid_are_refused_by_number(compiled: bool) -> None:
    robot = ur5()
    good = robot.fk_batch(np.random.default_rng(0).uniform(-170.0, 170.0, (70, 6)))
    for spoil, message in (
        (lambda T: T.__setitem__((slice(3), slice(3)), 1.001 * T[:3, :3]), "rotation"),
        (lambda T: T.__setitem__((slice(3), 0), -T[:3, 0]), "rotation"),
        (lambda T: T.__setitem__((3, 0), 0.5), "last row"),
        (lambda T: T.__setitem__((0, 3), math.nan), "finite"),
        (lambda T: T.__setitem__((1, 3), math.nan), "finite"),
        (lambda T: T.__setitem__((2, 3), math.nan), "finite"),
        (lambda T: T.__setitem__((0, 3), 1e300), "pose"),
    ):
        targets = good.copy()
        spoil(targets[66])
        with pytest.raises(ChainbuildError, match=r"pose 66: ") as caught:
            robot.ik_all_batch(targets, compiled=compiled)
        assert message in str(caught.value)
        with pytest.raises(ChainbuildError) as single:
            robot.ik_all(targets[66])
        assert caught.value.message == f"pose 66: {single.value.message}"


@both_paths
def test_out_of_reach_none_and_no_poses(compiled: bool) -> None:
    far = np.eye(4)
    far[0, 3] = 9.0
    robot = ur5()
    axes, counts = quick(robot, far[None], compiled=compiled)
    assert counts.tolist() == [0]
    assert np.isnan(axes).all()
    assert robot.ik_all_batch(far[None], compiled=compiled).shape == (1, 1, 6)
    assert robot.ik_all_batch(np.empty((0, 4, 4)), compiled=compiled).shape == (0, 1, 6)


def test_other_arms_are_left_to_their_own_ways() -> None:
    rng = np.random.default_rng(3)
    sums = AxisConstraint("A2 + A3", AxisSum((0.0, 1.0, 1.0, 0.0, 0.0, 0.0), 0.0), -90.0, 90.0)
    summed = Robot(replace(ur5().chain, constraints=(sums,)))
    for robot in (arm(), robot_of_screws(random_parallel_arm(rng, "apart")), summed):
        assert planar_batch(robot, np.eye(4)[None], limits=True, compiled=True) is None
    assert planar_batch(summed, np.eye(4)[None], limits=False, compiled=True) is not None
    axes = np.array([10.0, -80.0, 60.0, 20.0, 40.0, 30.0])
    T = summed.fk(axes)
    every = summed.ik_all_batch([T])[0]
    np.testing.assert_allclose(every[np.isfinite(every[:, 0])], summed.ik_all(T).axes, atol=1e-9)
    assert len(summed.ik_all_batch([T], limits=False)[0]) > len(every)


def test_progress_ends_with_all_poses() -> None:
    told: list[tuple[int, int]] = []
    robot = ur5()
    targets = robot.fk_batch(np.random.default_rng(0).uniform(-170.0, 170.0, (300, 6)))
    targets[5] = robot.fk([0.0, -80.0, 0.0, 20.0, 40.0, 30.0]).homogeneous  # stretched: in doubt
    robot.ik_all_batch(targets, progress=lambda done, total: told.append((done, total)))
    assert told[-1] == (300, 300)
    told.clear()
    robot.ik_all_batch(np.empty((0, 4, 4)), progress=lambda done, total: told.append((done, total)))
    assert told == []


@both_paths
def test_memory_is_the_answers(compiled: bool) -> None:
    robot = ur5()
    some = robot.fk_batch(np.random.default_rng(0).uniform(-170.0, 170.0, (50, 6)))
    targets = np.repeat(some[quick(robot, some, compiled=compiled)[1] >= 0], 1000, axis=0)
    robot.ik_all_batch(targets[:50], compiled=compiled)
    tracemalloc.start()
    found = robot.ik_all_batch(targets, compiled=compiled)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 1.5 * found.nbytes
