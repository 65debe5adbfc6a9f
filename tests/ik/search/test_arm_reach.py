"""The bound on an arm's reach: never too small, tight where it can be, and what it saves is said."""

from __future__ import annotations

from functools import cache

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild.frames import transform
from chainbuild.ik.request import DEFAULT, IkOptions
from chainbuild.ik.search.problem import problem_of
from chainbuild.ik.search.starts.arm_reach import ArmReach, arm_reach
from chainbuild.kinematics.product import Product, poses_at
from chainbuild.robot import Robot

PLAIN = IkOptions(compiled=False)
BOTH = pytest.mark.parametrize("options", [DEFAULT, PLAIN], ids=["compiled", "plain"])


@cache
def load(name: str) -> Robot:
    return chainbuild.Robot.load(name)


def known_reach(arm: Product) -> ArmReach:
    found = arm_reach(arm)
    assert found is not None
    return found


def reach_of(robot: Robot) -> ArmReach:
    product = robot.kinematics.product
    assert product is not None
    return known_reach(product.by_axes(np.arange(len(robot.axes)), np.zeros(len(robot.axes))))


def turning_arm(rng: np.random.Generator, joints: int, share_parallel: float) -> Product:
    """Return an arm of turning joints, some of them parallel or opposite to the one before."""
    fixed = []
    for _ in range(joints + 1):
        R = pin.exp3(rng.normal(size=3))
        if rng.random() < share_parallel:
            R = pin.exp3(np.array([0.0, 0.0, rng.uniform(-3.0, 3.0)])) @ np.diag(
                [1.0, *([rng.choice([-1.0, 1.0])] * 2)]
            )
        fixed.append(transform(R, rng.normal(size=3)))
    return Product(np.array(fixed), np.zeros(joints, dtype=bool), np.eye(joints), rng.normal(size=joints))


def distances(reach: ArmReach, poses: np.ndarray) -> np.ndarray:
    return np.array([reach.distance(T) for T in poses])


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("joints", [2, 3, 4, 6, 7])
def test_no_pose_is_farther_than_the_bound(joints: int, share: float) -> None:
    rng = np.random.default_rng(joints)
    for _ in range(20):
        arm = turning_arm(rng, joints, share)
        reach = known_reach(arm)
        values = rng.uniform(-np.pi, np.pi, (400, joints))
        assert distances(reach, poses_at(arm, values, np.ones(joints))).max() <= reach.length


def test_parallel_axes_reach_their_diagonal_and_not_more() -> None:
    """0.4 and 0.3 across, aside by 0.2 and back by 0.15; what lies along the outer axes does not count."""
    turned_over = np.diag([1.0, -1.0, -1.0])
    shifts = [(0.0, 0.0, 1.0), (0.4, 0.0, 0.2), (0.0, 0.3, 0.15), (5.0, 6.0, 7.0)]
    turns = [np.eye(3), turned_over, np.eye(3), np.eye(3)]
    fixed = np.array([transform(R, t) for R, t in zip(turns, shifts, strict=True)])
    arm = Product(fixed, np.zeros(3, dtype=bool), np.eye(3), np.zeros(3))
    reach = known_reach(arm)
    # The first and the last axis are parallel, too: all that is along them is moved to the ends.
    values = np.random.default_rng(0).uniform(-np.pi, np.pi, (4000, 3))
    assert distances(reach, poses_at(arm, values, np.ones(3))).max() == pytest.approx(reach.length, rel=1e-4)


@pytest.mark.parametrize("name", ["kr6r900", "tx2_60", "irb2600"])
def test_the_bound_of_a_known_arm_is_tight(name: str) -> None:
    robot = load(name)
    reach, rng = reach_of(robot), np.random.default_rng(1)
    lower, upper = (np.array([getattr(axis, end) for axis in robot.axes]) for end in ("lower", "upper"))
    farthest = distances(reach, robot.fk_batch(lower + (upper - lower) * rng.random((20_000, len(lower))))).max()
    assert 0.995 * reach.length < farthest <= reach.length


def test_what_shifts_has_no_such_bound() -> None:
    for name in ("gantry_ss", "bed_mill_kin1", "scara_cc"):
        robot = load(name)
        assert robot.kinematics.product is None or arm_reach(robot.kinematics.product) is None


@BOTH
def test_a_pose_too_far_for_the_arm_is_refused_at_once_and_says_why(options: IkOptions) -> None:
    robot = load("kr6r900")
    axes = [20.0, 0.0, 0.0, 10.0, 20.0, 30.0]
    T = robot.fk(axes).homogeneous
    away = T.copy()
    away[:3, 3] *= 1.15
    found = robot.ik(away, options=options)
    assert (found.success, found.status, found.restarts) == (False, "unreachable", 0)
    assert "too far" in found.reason
    assert "the arm would have to be" in found.reason
    assert found.iterations < 90
    turned = T.copy()  # the flange reaches there, but not from outside
    turned[:3, :3] = T[:3, :3] @ np.diag([1.0, -1.0, -1.0])
    found = robot.ik(turned, options=options)
    assert (found.success, found.status, found.restarts) == (False, "unreachable", 0)
    assert found.reason.startswith("the position can be reached, but not with this orientation")
    assert "the arm would have to be" in found.reason


@BOTH
def test_the_stretched_arm_is_reached(options: IkOptions) -> None:
    robot, reach = load("kr6r900"), reach_of(load("kr6r900"))
    stretched = max(
        (np.array([15.0, -30.0, a3, 20.0, 40.0, 60.0]) for a3 in np.arange(-10.0, 30.0, 0.01)),
        key=lambda axes: reach.distance(robot.fk(axes).homogeneous),
    )
    T = robot.fk(stretched)
    assert robot.ik(T, options=options).success
    assert robot.ik(T, stretched, options=options).success


@BOTH
def test_where_the_orientation_does_not_count_it_does_not_refuse(options: IkOptions) -> None:
    robot = load("kr6r900")
    T = robot.fk([20.0, 0.0, 0.0, 10.0, 20.0, 30.0]).homogeneous
    T[:3, :3] = T[:3, :3] @ np.diag([1.0, -1.0, -1.0])
    shifts = IkOptions(weights=(1.0, 1.0, 1.0, 0.0, 0.0, 0.0), compiled=options.compiled)
    assert problem_of(robot, None, None, shifts).arm is None
    assert robot.ik(T, options=shifts).success


@BOTH
def test_with_the_track_held_the_arm_is_what_stands_on_it(options: IkOptions) -> None:
    robot = load("irb2600_track")
    T = robot.fk([0.0, 0.0, 0.0, 10.0, 20.0, 30.0, 1500.0])
    found = robot.ik(T, held={"EX1": 1500.0}, options=options)
    assert found.success
    far = robot.ik(T, held={"EX1": 6000.0}, options=options)
    assert "the arm would have to be" in far.reason


def test_what_lies_along_parallel_axes_adds_up_with_its_signs() -> None:
    """Aside by 0.13 before three parallel axes, back by 0.12 between them, aside by 0.05 behind: 0.06 in all."""
    to_y, back = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]), np.eye(3)[[0, 2, 1]] * [1.0, -1.0, 1.0]
    turns = [np.eye(3), to_y, np.eye(3), np.eye(3), back, np.eye(3)]
    shifts = [(0.0, 0.0, 0.0), (0.0, 0.13, 0.0), (0.4, 0.0, -0.12), (0.39, 0.0, 0.0), (0.0, 0.0, 0.05), (0.0, 0.0, 0.0)]
    fixed = np.array([transform(R, t) for R, t in zip(turns, shifts, strict=True)])
    reach = known_reach(Product(fixed, np.zeros(5, dtype=bool), np.eye(5), np.zeros(5)))
    assert reach.length == pytest.approx(np.hypot(0.06, 0.79), rel=1e-6)
