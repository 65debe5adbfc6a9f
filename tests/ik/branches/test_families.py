"""Families of branches: a curve or surface of solutions is one branch with its free directions; others are isolated."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.assemble import linear, rotary, shift
from chainbuild.ik.branches.core.branches import Branch
from chainbuild.ik.search.compiled import packing
from chainbuild.robot import Robot
from tests.kit.parallel_arms import made_arm, pose_by_hand, robot_of_screws
from tests.kit.robots import make_chain, robot_from

ALONG = np.linspace(-1.5, 1.5, 13)


def elbow_arm() -> Robot:
    """Return an arm with a spherical wrist, whose elbow is stretched at A3 = 0 and whose wrist at A5 = 0."""
    return robot_from([
        shift(z=300.0), rotary("B1", "z"), rotary("B2", "y"), shift(x=250.0), rotary("B3", "y"), shift(x=200.0),
        rotary("B4", "x"), rotary("B5", "y"), rotary("B6", "x"), shift(x=70.0),
    ])  # fmt: skip


def planar_arm() -> Robot:
    """Return three parallel axes with equal links, and one that tilts the tool at their end."""
    link = shift(x=100.0)
    return robot_from(
        [rotary("B1", "z"), link, rotary("B2", "z"), link, rotary("B3", "z"), link, rotary("B4", "y"), shift(z=0.0)]
    )


def assert_same_pose(robot: Robot, branch: Branch, direction: np.ndarray, within: float = 1e-9) -> None:
    """Assert that the pose stays the same along a straight line of axis values."""
    start = branch.to("si").axes
    for way in ALONG:
        shown = (start + way * direction) / robot.kinematics.si_factors
        np.testing.assert_allclose(robot.fk(shown).homogeneous, robot.fk(branch.axes).homogeneous, atol=within)


@pytest.mark.parametrize("name", ["kr6r900", "tx2_60", "irb2600"])
def test_a_stretched_wrist_turns_its_axes_against_one_another(name: str) -> None:
    robot = chainbuild.Robot.load(name)
    axes = np.array([10.0, -60.0, 70.0, 20.0, 0.0, -30.0])
    axes = axes if name == "kr6r900" else np.array([10.0, 30.0, 40.0, 20.0, 0.0, -30.0])
    stretched = [branch for branch in robot.ik_all(robot.fk(axes)) if len(branch.free_directions)]
    assert len(stretched) == 1
    (direction,) = stretched[0].free_directions
    np.testing.assert_allclose(np.abs(direction), [0.0, 0.0, 0.0, np.sqrt(0.5), 0.0, np.sqrt(0.5)], atol=1e-9)
    assert_same_pose(robot, stretched[0], direction)
    assert stretched[0].free_axes == (robot.axes[3].name,)


def test_a_stretched_elbow_is_isolated_and_counts_once() -> None:
    robot = elbow_arm()
    found = robot.ik_all(robot.fk([20.0, -40.0, 0.0, 15.0, 35.0, -25.0]))
    assert len(found) == 4
    assert all(len(directions) == 0 for directions in found.free_directions)
    assert np.abs(found.axes[:, 2]).max() < 1e-5


def test_a_stretched_elbow_does_not_take_part_in_a_stretched_wrist() -> None:
    robot = elbow_arm()
    found = robot.ik_all(robot.fk([20.0, -40.0, 0.0, 15.0, 0.0, -25.0]))
    assert len(found) == 2
    for branch in found:
        (direction,) = branch.free_directions
        assert_same_pose(robot, branch, direction, 1e-6)
        np.testing.assert_allclose(np.abs(direction[[0, 1, 2, 4]]), 0.0, atol=1e-4)


def test_an_upright_arm_has_two_free_directions() -> None:
    """Axes 1, 4 and 6 are on one line, the elbow is stretched: a surface, but no third direction."""
    robot = elbow_arm()
    found = robot.ik_all(robot.fk([20.0, -90.0, 0.0, 15.0, 0.0, -25.0]), start=[30.0, -80.0, 10.0, 5.0, 1.0, -5.0])
    assert len(found) == 1
    rows = found[0].free_directions
    assert rows.shape == (2, 6)
    assert np.linalg.matrix_rank(rows) == 2
    for row in rows:
        assert_same_pose(robot, found[0], row, 1e-6)


def test_parallel_slides_move_against_one_another() -> None:
    robot = robot_from([
        linear("X1", "x"), shift(x=100.0, z=100.0), rotary("B2", (1.0, 1.0, 0.0)), shift(y=100.0, z=200.0),
        linear("X3", "-x"), shift(x=200.0),
    ])  # fmt: skip
    assert robot.task == "position"
    found = robot.ik_all(robot.fk([0.0, 0.0, 0.0]))
    assert [len(directions) for directions in found.free_directions].count(1) == 1
    family = next(branch for branch in found if len(branch.free_directions))
    np.testing.assert_allclose(family.free_directions[0], [np.sqrt(0.5), 0.0, np.sqrt(0.5)], atol=1e-9)


@pytest.mark.parametrize(("distance", "count"), [(0.15, 1), (0.05, 2)])
def test_a_linkage_is_one_family_or_two(distance: float, count: int) -> None:
    """Three links and the distance are a four-bar: by Grashof's rule it moves in one piece or in two."""
    robot = planar_arm()
    target = robot.fk([0.0, 0.0, 0.0, 0.0]).homogeneous
    target[:3, 3] = distance, 0.0, 0.0
    found = robot.ik_all(target, start=[30.0, 20.0, 10.0, 0.0])
    assert len(found) == count
    for branch in found:
        (direction,) = branch.free_directions
        slope = np.array([robot.fk(branch.axes + way * np.degrees(direction)).translation for way in (-1e-5, 1e-5)])
        assert np.abs(slope[1] - slope[0]).max() < 1e-11
        assert np.linalg.norm(direction) == pytest.approx(1.0)


def test_the_member_nearest_to_the_start_stands_for_a_family() -> None:
    robot = planar_arm()
    target = robot.fk([0.0, 0.0, 0.0, 0.0]).homogeneous
    target[:3, 3] = 0.15, 0.0, 0.0
    near = robot.ik_all(target, start=[60.0, -60.0, -60.0, 0.0])[0]
    far = robot.ik_all(target, start=[-60.0, 60.0, 60.0, 0.0])[0]
    assert near.axes[0] == pytest.approx(-far.axes[0], abs=1e-6)
    assert near.axes[0] > 0.0


def test_more_axes_than_the_task_determines_tell_their_directions_and_stay() -> None:
    slides = [linear("X", "x"), linear("Y", "y"), linear("Z", "z")]
    turns = [rotary("A", "x"), shift(z=-80.0), rotary("B", "y"), rotary("C", (0.0, 1.0, 1.0)), shift(z=-60.0)]
    chain = make_chain([*slides, *turns], [], "X Y Z A B C")
    robot = Robot(replace(chain, task="direction"))
    assert robot.plan().name == "direct"
    found = robot.ik_all(robot.fk([10.0, 20.0, -30.0, 20.0, 30.0, 40.0]))
    assert len(found) > 1
    for branch in found:
        (direction,) = branch.free_directions
        start, pose = branch.to("si").axes, robot.fk(branch.axes)
        for way in (-1e-4, 1e-4):
            moved = robot.fk((start + way * direction) / robot.kinematics.si_factors)
            np.testing.assert_allclose(moved.translation, pose.translation, atol=1e-7)
            np.testing.assert_allclose(moved.rotation[:, 2], pose.rotation[:, 2], atol=1e-7)


def test_families_are_shown() -> None:
    robot = elbow_arm()
    found = robot.ik_all(robot.fk([20.0, -40.0, 30.0, 15.0, 0.0, -25.0]))
    family = next(branch for branch in found if len(branch.free_directions))
    assert "goes on along 0.707 B4 - 0.707 B6" in repr(family).replace("\n", " ")
    assert "2 of them not isolated" in repr(found)
    assert "0.707 B4 - 0.707 B6" in found._repr_html_()
    regular = robot.ik_all(robot.fk([20.0, -40.0, 30.0, 15.0, 20.0, -25.0]))
    assert "isolated" not in repr(regular)
    assert "Goes on" not in regular._repr_html_()
    assert regular[0].free_directions.shape == (0, 6)


@pytest.mark.parametrize("compiled", [True, False])
def test_what_was_settled_is_put_onto_its_limits(monkeypatch: pytest.MonkeyPatch, compiled: bool) -> None:
    """A stretched arm but for a millionth of a degree, axis 2 on its limit: the settled place was beyond it."""
    if not compiled:
        monkeypatch.setattr(packing, "available", lambda: False)
    serial = made_arm("UR10e")
    values = [-80.2245235, 73.7203032, 1e-6, -30.0943268, -6.4310469, -68.0332078]
    limits = [(-350.0, 350.0), (13.0, values[1]), *[(-350.0, 350.0)] * 4]
    robot = robot_of_screws(serial, limits)
    found = robot.ik_all(pose_by_hand(serial, np.radians(values)))
    assert np.abs(found.axes - values).max(axis=1).min() < 1e-4
    assert (found.axes[:, 1] <= values[1]).all()


# A wrist over axis 1: axes 1, 4, 5 and 6 move against each other. With axis 1 at its start, axis 5 is beyond its limit.
OVER = np.array([
    -109.74257222508496, 116.58534812908952, 56.66892235871629, 140.30218386343705, -4.6797560049248546,
    -16.286465310270728,
])  # fmt: skip


@pytest.mark.parametrize("compiled", [True, False])
def test_a_family_is_found_inside_the_limits_from_its_members_outside(
    monkeypatch: pytest.MonkeyPatch, compiled: bool
) -> None:
    if not compiled:
        monkeypatch.setattr(packing, "available", lambda: False)
    robot = chainbuild.Robot.load("irb2600")
    rng = np.random.default_rng(6)
    for n in range(12 if compiled else 4):
        axes = OVER.copy()
        if n:
            axes[[0, 3, 4, 5]] = rng.uniform(-110.0, 110.0, 4)
        T = robot.fk(axes)
        for start in (None, np.zeros(6), np.full(6, 90.0)):
            found = robot.ik_all(T, start)
            assert len(found) > 0
            assert any(len(branch.free_directions) for branch in found)
            for row in found.axes:
                assert robot.violated_limits(row) == ()
                assert np.abs(robot.fk(row).homogeneous - T.homogeneous).max() < 1e-8


@pytest.mark.parametrize("width", [30.0, 2.0])
def test_a_family_is_found_in_a_small_range_of_one_of_its_axes(width: float) -> None:
    robot = chainbuild.Robot.load("irb2600")
    rng = np.random.default_rng(7)
    for n in (0, 3, 4, 5):
        axes = OVER.copy()
        axes[[0, 3, 4, 5]] = rng.uniform(-100.0, 100.0, 4)
        ends = list(robot.chain.axes)
        ends[n] = replace(ends[n], lower=axes[n] - 0.3 * width, upper=axes[n] + 0.7 * width)
        narrow = Robot(replace(robot.chain, axes=tuple(ends)))
        T = narrow.fk(axes)
        found = narrow.ik_all(T)
        assert any(len(branch.free_directions) for branch in found), n
        assert narrow.ik(T).success


@pytest.mark.parametrize("turn", [360.0, -360.0])
def test_a_family_is_found_in_a_small_range_a_whole_turn_away(turn: float) -> None:
    robot = chainbuild.Robot.load("irb2600")
    for last in (20.0, 80.0):
        axes = OVER.copy()
        axes[5] = -math.copysign(last, turn)
        ends = list(robot.chain.axes)
        ends[5] = replace(ends[5], lower=axes[5] + turn - 0.6, upper=axes[5] + turn + 1.4)
        narrow = Robot(replace(robot.chain, axes=tuple(ends)))
        found = narrow.ik_all(robot.fk(axes))
        assert any(len(branch.free_directions) for branch in found)
        assert (np.abs(found.axes[:, 5] - axes[5] - turn) <= 1.4 + 1e-6).all()
