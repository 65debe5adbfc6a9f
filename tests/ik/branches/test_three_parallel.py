"""Three parallel axes in closed form: against elimination, EAIK, scipy's rotations; also where axes have no effect."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from chainbuild.arrays import Matrix, Vector
from chainbuild.chain.assemble import rotary, shift
from chainbuild.comparison.eaik_model import eaik_answers, eaik_robot
from chainbuild.frames import inverse, rot_x
from chainbuild.ik.branches.arms.angle_pairs import angle_pairs
from chainbuild.ik.branches.arms.parallel_axes import parallel_arm
from chainbuild.ik.branches.arms.three_parallel import ThreeParallelAxes
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.core.serial import Serial, Solution
from chainbuild.ik.branches.elimination.elimination import elimination
from chainbuild.ik.request import IkRequest
from chainbuild.robot import Robot
from tests.kit.compare import same_turns
from tests.kit.parallel_arms import (
    MADE,
    WRISTS,
    apart,
    made_arm,
    pose_by_hand,
    random_parallel_arm,
    same_solutions,
    solutions,
    unit,
    with_signs,
)
from tests.kit.robots import robot_from

Keep = Sequence[float]
NOTHING = (0.0,) * 6


def solver_of(serial: Serial) -> ThreeParallelAxes:
    arm = parallel_arm(serial)
    assert arm is not None
    return ThreeParallelAxes(arm)


def exact(serial: Serial, T: Matrix, keep: Keep = NOTHING) -> list[Vector]:
    """Return the solutions, once each; the closed form must not doubt them."""
    found, doubtful = solver_of(serial).solve(T, keep)
    assert not doubtful
    return solutions(serial, T, (values for values, _ in found))


def right(serial: Serial, T: Matrix, keep: Keep) -> list[Solution]:
    """Return the solutions with the joints that are free."""
    found, _ = solver_of(serial).solve(T, keep)
    return [row for row in found if np.abs(pose_by_hand(serial, row[0]) - T).max() < 1e-6]


@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("wrist", WRISTS)
def test_the_sets_that_elimination_finds(wrist: str, backwards: bool) -> None:
    rng = np.random.default_rng(1)
    for _ in range(2):
        serial = random_parallel_arm(rng, wrist, backwards=backwards)
        general = elimination(serial)
        assert general is not None
        for _ in range(4):
            q = rng.uniform(-3.0, 3.0, 6)
            T = pose_by_hand(serial, q)
            theirs = solutions(serial, T, (values for values, _ in general.solve(T, NOTHING)))
            assert same_solutions(exact(serial, T), theirs)


@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("wrist", WRISTS)
def test_no_solution_is_missing_or_wrong(wrist: str, backwards: bool) -> None:
    rng, seen = np.random.default_rng(2), set()
    for _ in range(12):
        serial = random_parallel_arm(rng, wrist, backwards=backwards)
        for q in rng.uniform(-3.1, 3.1, (8, 6)):
            T = pose_by_hand(serial, q)
            found = exact(serial, T)
            raw, _ = solver_of(serial).solve(T, NOTHING)
            assert wrist == "apart" or len(raw) == len(found)  # of roots close to each other the means are tried, too
            assert max(np.abs(pose_by_hand(serial, values) - T).max() for values in found) < 1e-9
            assert min(apart(values, q) for values in found) < 1e-7
            seen.add(len(found))
    assert seen == {2, 4, 6, 8} or seen == {2, 4, 8}


@pytest.mark.parametrize("name", MADE)
def test_every_pattern_of_signs(name: str) -> None:
    straight, rng = made_arm(name), np.random.default_rng(3)
    values = rng.uniform(-3.0, 3.0, (3, 6))
    known = [exact(straight, straight.pose(q)) for q in values]
    for signs in itertools.product((-1.0, 1.0), repeat=6):
        serial = with_signs(straight, signs)
        for q, rows in zip(values, known, strict=True):
            found = exact(serial, straight.pose(q))
            assert len(found) == len(rows)
            assert same_solutions(found, [np.array(signs) * row for row in rows])


@pytest.mark.parametrize("name", MADE)
@pytest.mark.parametrize("flip", [(1, 1, 1, 1, 1, 1), (-1, 1, 1, 1, -1, 1), (1, -1, -1, -1, 1, -1)])
def test_the_sets_that_eaik_finds_where_it_is_right(name: str, flip: tuple[float, ...]) -> None:
    serial, rng = with_signs(made_arm(name), flip), np.random.default_rng(4)
    model = eaik_robot(serial)
    for q in rng.uniform(-3.1, 3.1, (30, 6)):
        T = pose_by_hand(serial, q)
        theirs = solutions(serial, T, (row for row, approximate in eaik_answers(model, serial, T) if not approximate))
        assert len(theirs) >= 2
        assert same_solutions(exact(serial, T), theirs)


def test_what_is_out_of_reach_has_no_solution() -> None:
    for wrist in WRISTS:
        serial = random_parallel_arm(np.random.default_rng(5), wrist)
        T = pose_by_hand(serial, np.zeros(6))
        T[:3, 3] += (40.0, 30.0, -20.0)
        assert exact(serial, T) == []


@pytest.mark.parametrize("gap", [1e-8, 1e-6, 1e-4, 1e-2])
def test_axes_that_nearly_meet(gap: float) -> None:
    rng, found = np.random.default_rng(6), []
    for _ in range(20):
        serial = random_parallel_arm(rng, "meeting")
        *rest, five, six = serial.screws
        beside = unit(np.cross(five.direction, six.direction))
        serial = Serial((*rest, five, replace(six, point=six.point + gap * beside)), serial.M)
        for q in rng.uniform(-3.0, 3.0, (3, 6)):
            rows = exact(serial, pose_by_hand(serial, q))
            found.append(len(rows))
            assert min(apart(values, q) for values in rows) < 1e-6
    assert set(found) == {2, 4, 6, 8} or set(found) == {2, 4, 8}


@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("straight", [0.0, math.pi])
def test_where_axis_6_is_parallel_to_the_three_it_is_kept(straight: float, backwards: bool) -> None:
    serial = made_arm("UR5").reversed() if backwards else made_arm("UR5")
    first, last = (1, 0) if backwards else (4, 5)
    rng, kept, moved = np.random.default_rng(7), 0, 0
    for q in rng.uniform(-2.5, 2.5, (30, 6)):
        q[first] = straight
        T, keep = pose_by_hand(serial, q), rng.uniform(-3.0, 3.0, 6)
        at_start = [(values, free) for values, free in right(serial, T, q) if free[last]]
        assert min(apart(values, q) for values, _ in at_start) < 1e-6
        away = [values for values, free in right(serial, T, keep) if free[last]]
        assert away
        for values in away:
            turned = abs(math.remainder(values[last] - keep[last], math.tau))
            kept, moved = kept + (turned < 1e-12), moved + (turned > 1e-12)
    assert kept > 0
    assert moved > 0


def test_axis_6_moves_no_farther_than_the_links_need() -> None:
    serial, rng = made_arm("UR5"), np.random.default_rng(8)
    checked = 0
    for q in rng.uniform(-2.5, 2.5, (20, 6)):
        q[4] = 0.0
        T, keep = pose_by_hand(serial, q), rng.uniform(-3.0, 3.0, 6)
        for values, free in right(serial, T, keep):
            way = math.remainder(values[5] - keep[5], math.tau)
            if not free[5] or abs(way) < 1e-3:
                continue
            checked += 1
            nearer = [*keep[:5], values[5] - 0.01 * math.copysign(1.0, way)]
            others = [other for other, _ in right(serial, T, nearer)]
            same_shoulder = [other[5:] for other in others if apart(other[:1], values[:1]) < 1.0]
            assert all(apart(other, np.array(nearer[5:])) > 1e-3 for other in same_shoulder)
    assert checked >= 5


def test_where_links_are_folded_back_axis_2_is_kept() -> None:
    rng = np.random.default_rng(9)
    serial = random_parallel_arm(rng, "meeting")
    first, a, b, c, *rest = serial.screws
    h = a.direction
    # As long as the first link, and folded back on it where joint 3 is 0.
    c = replace(c, point=a.point + 0.3 * h)
    serial = Serial((first, a, b, c, *rest), serial.M)
    q = np.array([0.3, -1.1, 0.0, 0.9, 0.4, 0.5])
    T = pose_by_hand(serial, q)
    found = right(serial, T, [0.0, 0.77, 0.0, 0.0, 0.0, 0.0])
    there = [values for values, free in found if free[1] and abs(values[0] - q[0]) < 1e-6]
    assert there
    assert all(values[1] == 0.77 for values in there)


@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("wrist", ["meeting", "apart"])
def test_where_axes_1_and_5_turn_against_each_other_axis_1_is_kept(wrist: str, backwards: bool) -> None:
    """Where the three bring axis 5 to axis 1, both turn about one line: every angle 1 has its angle 5."""
    rng, checked = np.random.default_rng(11), 0
    for _ in range(12):
        serial = random_parallel_arm(rng, wrist)
        first, a, b, c, five, six = serial.screws
        # Joints 2, 3 and 4 in some position: there axis 5 lies on axis 1.
        there = Serial((a, b, c), np.eye(4)).pose(rng.uniform(-2.0, 2.0, 3))
        first = replace(five.transformed(there), joint=0)
        serial = Serial((first, a, b, c, five, six), serial.M)
        T = there @ six.T(0.4) @ serial.M
        if backwards:
            serial, T = serial.reversed(), inverse(T)
        one = 5 if backwards else 0
        keep = rng.uniform(-3.0, 3.0, 6)
        found = right(serial, T, keep)
        assert found
        assert all(free[one] and values[one] == keep[one] for values, free in found)
        checked += len(found)
    assert checked >= 24


def level_arm() -> Robot:
    """Return an arm whose wrist can stand over axis 1."""
    return robot_from([
        rotary("A1", "z"), rotary("A2", "y"), shift(z=300.0), rotary("A3", "y"), shift(z=200.0), rotary("A4", "y"),
        rotary("A5", "z"), shift(z=250.0), rotary("A6", "y"), shift(y=80.0),
    ])  # fmt: skip


def test_where_the_wrist_is_over_axis_1_it_is_kept_or_moves_to_where_there_are_solutions() -> None:
    robot = level_arm()
    assert robot.plan().name == "three parallel axes"
    height = 300.0 * math.sin(math.radians(30.0)) - 200.0 * math.sin(math.radians(35.0))
    axes = np.array([20.0, 30.0, -65.0, 35.0 - math.degrees(math.asin(height / 250.0)), 40.0, 50.0])
    T, kept = robot.fk(axes), 0
    at_start = robot.ik_all(T, axes)
    assert same_turns(robot, at_start[0].axes, axes)
    assert at_start[0].free_axes == ("A1",)
    for start in np.random.default_rng(0).uniform(-180.0, 180.0, (20, 6)):
        found = robot.ik_all(T, start)
        assert len(found) > 0
        assert all(branch.free_axes == ("A1",) for branch in found)
        kept += sum(abs(branch.axes[0] - start[0]) < 1e-9 for branch in found)
    assert 0 < kept < 40


def test_where_no_value_of_a_free_axis_leads_anywhere_elimination_answers() -> None:
    """Every angle 1 has its angle 5, but only where axis 6 is parallel to the three do the links reach the pose."""
    robot = robot_from([
        shift(-1e3, -1e3, 0.0), rotary("A1", "z"), shift(2e3, 0.0, 2e3), rotary("A2", "-x"), shift(-1e3, 2e3, -1e3),
        rotary("A3", "x"), shift(0.0, -1e3, 1e3), rotary("A4", "x"), shift(-1e3, 2e3, -1e3), rotary("A5", "-y"),
        shift(-1e3, 0.0, -2e3), rotary("A6", "-z"), shift(0.0, -3e3, -1e3),
    ])  # fmt: skip
    axes = np.array([0.0, 180.0, -90.0, 0.0, 90.0, 180.0])
    T, start = robot.fk(axes), np.full(6, 71.3)
    serial = BranchQuery.of(IkRequest.of(robot, T)).serial()
    found, doubtful = solver_of(serial).solve(T.homogeneous, np.radians(start))
    assert (found, doubtful) == ([], True)
    assert robot.plan().name == "three parallel axes"
    assert len(robot.ik_all(T, start)) > 0


def test_other_arms_are_not_taken_for_such() -> None:
    serial = made_arm("UR5")
    first, a, b, c, five, six = serial.screws
    h = a.direction
    for screws in (
        (first, a, b, replace(c, direction=rot_x(1e-4) @ c.direction), five, six),  # not parallel
        (replace(first, direction=h), a, b, c, five, six),  # four parallel axes
        (first, a, b, c, replace(five, direction=h), six),
        (first, a, replace(b, point=a.point + 0.1 * h), c, five, six),  # twice the same axis
        (first, a, b, replace(c, point=b.point + 0.1 * h), five, six),
        (first, a, b, c, five, replace(six, direction=five.direction, point=five.point)),
        (first, a, b, replace(c, kind="prismatic"), five, six),
        (a, b, c, five, six),
    ):
        assert parallel_arm(Serial(screws, serial.M)) is None


def test_where_three_pairs_of_angles_meet_they_keep_their_digits() -> None:
    found = angle_pairs((-0.2, 0.2, 1.0, 0.0), (-0.2, 0.0), (0.0, -0.2, 1.0, 0.0), 0.0)
    assert not (found.free or found.doubtful)
    for wanted in ((math.pi, math.pi), (math.acos(0.6), math.acos(0.6))):
        assert min(apart(np.array(pair), np.array(wanted)) for pair in found.pairs) < 1e-12


def test_two_axes_that_meet_or_are_parallel_need_no_quartic() -> None:
    for alone, wrist in enumerate(WRISTS):
        arm = parallel_arm(random_parallel_arm(np.random.default_rng(12), wrist))
        assert arm is not None
        assert arm.alone == alone
