"""Turns that the point an arm places leaves open, and slides that have come to lie on a line or in a plane."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from chainbuild.chain.assemble import linear, rotary, shift
from chainbuild.ik.branches.arms.loose_turns import loose_turns, with_loose_turns
from chainbuild.ik.branches.arms.orientation import for_rotation
from chainbuild.ik.branches.arms.positioner import positioner
from chainbuild.ik.branches.core.branches import collect
from chainbuild.ik.branches.core.families import with_families
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.core.serial import Screw
from chainbuild.ik.branches.direct import find_direct
from chainbuild.ik.request import IkRequest
from chainbuild.robot import Robot
from tests.kit.draws import unit
from tests.kit.robots import robot_from

X, Y, Z = np.eye(3)


def turned(axes: list[np.ndarray], values: np.ndarray) -> np.ndarray:
    """Return the product of turns (3, 3), by scipy."""
    product = Rotation.identity()
    for axis, value in zip(axes, values, strict=True):
        product = product * Rotation.from_rotvec(value * axis)
    return product.as_matrix()


def solved(robot: Robot, axes: list[float], keep: list[float]) -> list[np.ndarray]:
    """Return what the plan's solver finds for a pose, by itself."""
    target, query = robot.fk(axes), BranchQuery.of(IkRequest.of(robot, robot.fk(axes)))
    solver = robot.plan().solver
    assert solver is not None
    found = [values for values, _ in solver(target.homogeneous, keep)]
    return [v for v in found if np.abs(query.serial().pose(v) - target.homogeneous).max() < 1e-6]


def arm(rng: np.random.Generator, through: np.ndarray) -> list[Screw]:
    """Return three turns, of which the last two go through a point."""
    return [Screw("revolute", unit(rng), point, n) for n, point in enumerate((through + X, through, through))]


@pytest.mark.parametrize("seed", range(6))
def test_loose_turns_and_one_wrist_axis_give_the_orientation(seed: int) -> None:
    rng = np.random.default_rng(seed)
    point, wrist = rng.normal(size=3), unit(rng)
    screws, values = arm(rng, point), rng.uniform(-3.0, 3.0, 4)
    assert loose_turns(screws, values[:3].tolist(), point) == [1, 2]
    axes = [*(screw.direction for screw in screws), wrist]
    R = turned(axes, values)
    start = [float(values[0]), 0.3, -0.4]
    found = with_loose_turns(screws, start, [1, 2], [wrist], R, [*start, 0.0])
    assert all(np.abs(turned(axes, one) - R).max() < 1e-9 for one, _ in found)
    assert any(np.abs(np.sin((one - values) / 2.0)).max() < 1e-9 for one, _ in found)


@pytest.mark.parametrize("seed", range(6))
def test_a_loose_turn_brings_the_orientation_just_into_the_reach_of_an_oblique_wrist(seed: int) -> None:
    rng = np.random.default_rng(seed)
    point = rng.normal(size=3)
    screws, values = arm(rng, point), rng.uniform(-3.0, 3.0, 6)
    # Two bends of 20 degrees: the last axis stays within 40 degrees of the first.
    wrist = [turned([X], np.radians([bend])) @ Z for bend in (0.0, 20.0, 40.0)]
    axes = [*(screw.direction for screw in screws), *wrist]
    R = turned(axes, values)
    found = with_loose_turns(screws, values[:3].tolist(), [2], wrist, R, [0.0] * 6)
    before = turned(axes[:2], values[:2])
    ways = np.linspace(-np.pi, np.pi, 181)
    reached = [bool(for_rotation(wrist, (before @ turned([axes[2]], np.array([w]))).T @ R, [0.0] * 3)) for w in ways]
    assert bool(found) == (not all(reached))  # a wrist that reaches the orientation at every turn has no limit
    for one, _ in found:
        assert np.abs(turned(axes, one) - R).max() < 1e-6
        np.testing.assert_allclose(one[:2], values[:2])
        assert abs(np.sin(one[4])) < 1e-3  # at the limit of its reach a wrist is stretched or folded


def test_an_arm_whose_wrist_axis_needs_another_turn_of_the_arm() -> None:
    robot = robot_from([
        rotary("B1", "y"), shift(x=100.0), rotary("B2", "-y"), rotary("B3", "-y"), rotary("B4", "z"),
    ])  # fmt: skip
    assert robot.plan().name == "single wrist axis"
    assert solved(robot, [180.0, 90.0, 0.0, 180.0], [0.0] * 4)
    assert len(robot.ik_all(robot.fk([180.0, 90.0, 0.0, 180.0])))


def test_an_oblique_wrist_on_an_axis_of_its_arm() -> None:
    robot = robot_from([
        shift(x=100.0), rotary("B1", "-x"), rotary("B2", (-1.0, -1.0, 0.0)), rotary("B3", "-z"), shift(x=100.0),
        rotary("B4", "-x"), shift(y=100.0), rotary("B5", (0.0, -1.0, -1.0)), shift(y=100.0), rotary("B6", "-y"),
    ])  # fmt: skip
    assert robot.plan().name == "spherical wrist"
    axes = [90.0, 90.0, 90.0, 90.0, -90.0, 0.0]
    for keep in np.linspace(-3.0, 3.0, 13).tolist():
        assert solved(robot, axes, [keep] * 6)


def test_slides_on_one_line_stay_where_they_are_kept() -> None:
    """The values to keep are moved as little as possible: not along the line of solutions."""
    oblique = (X + Y) / np.sqrt(2.0)
    row = [
        Screw("prismatic", X, 0.0 * X, 0), Screw("revolute", oblique, 0.1 * Z, 1), Screw("prismatic", -X, 0.3 * Z, 2),
    ]  # fmt: skip
    reach = positioner(row)
    assert reach is not None
    point = np.array([0.2, 0.1, 0.4])
    for keep in ((0.3, 0.0, 0.1), (-0.2, 0.0, 0.5)):
        kept = [values for values in reach(point, point + 0.05 * X, keep) if abs(values[1]) < 1e-9]
        assert kept
        assert kept[0][0] == pytest.approx(kept[0][2] + 0.05)
        assert kept[0][0] + kept[0][2] == pytest.approx(keep[0] + keep[2])


def test_slides_in_a_plane_reach_what_a_free_turn_brings_there() -> None:
    robot = robot_from([
        linear("X1", "z"), shift(x=100.0), linear("Y1", "-x"), rotary("B3", "z"), shift(z=100.0), rotary("B4", "x"),
        linear("Z1", "-z"), shift(x=100.0), rotary("B6", "-z"),
    ])  # fmt: skip
    assert robot.plan().name == "direct"
    target = robot.fk([0.0, 0.0, -60.0, 180.0, -100.0, 90.0])
    found = find_direct(BranchQuery.of(IkRequest.of(robot, target))).branches
    assert len(found)
    for branch in found:
        np.testing.assert_allclose(robot.fk(branch.axes).homogeneous, target.homogeneous, atol=1e-6)
    assert len(robot.ik_all(target))


def test_places_beside_one_isolated_solution_are_one() -> None:
    robot = robot_from([
        shift(z=300.0), rotary("B1", "z"), rotary("B2", "y"), shift(x=250.0), rotary("B3", "y"), shift(x=200.0),
        rotary("B4", "x"), rotary("B5", "y"), rotary("B6", "x"), shift(x=70.0),
    ])  # fmt: skip
    axes = np.array([20.0, -40.0, 0.0, 15.0, 35.0, -25.0])
    query = BranchQuery.of(IkRequest.of(robot, robot.fk(axes), axes))
    _, J = robot.kinematics.pose_and_jacobian(np.radians(axes))
    lost = np.linalg.svd(J)[2][-1]
    beside = [np.radians(axes) + way * 2e-5 * lost for way in (1.0, -1.0)]
    found = collect(query, [(x, ()) for x in beside])
    assert len(found.branches) == 2
    settled = with_families(query, found)
    assert len(settled) == 1
    np.testing.assert_allclose(settled.axes[0], axes, atol=1e-4)
    assert settled.free_directions[0].shape == (0, 6)
