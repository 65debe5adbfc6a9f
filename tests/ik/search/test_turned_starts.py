"""Turned starts against Pinocchio: what is known of a point must hold wherever the arm and its tool are turned."""

from __future__ import annotations

from functools import cache

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild.ik.request import DEFAULT, IkOptions
from chainbuild.ik.search.problem import Problem, problem_of
from chainbuild.ik.search.starts.turned import COUNT, LARGEST_STEP, TurnedStarts
from chainbuild.robot import Robot
from tests.kit.robots import arm, table_machine

NAMES = (
    "arm",
    "kr6r900",
    "kr6r900_2",
    "tx2_60",
    "irb2600",
    "irb2600_track",
    "parallelogram_nr",
    "ba_head_c_table_kin82",
)


@cache
def load(name: str) -> Robot:
    return arm() if name == "arm" else chainbuild.Robot.load(name)


def table_of(robot: Robot) -> tuple[Problem, TurnedStarts]:
    problem = problem_of(robot, None, None, DEFAULT)
    turned = problem.turned_starts()
    assert turned is not None
    return problem, turned


def start_for(problem: Problem, turned: TurnedStarts, T: np.ndarray, n: int) -> np.ndarray | None:
    return turned.start(n, turned.query(T), problem.box, problem.middle)


def miss(problem: Problem, y: np.ndarray, T: np.ndarray) -> float:
    """Return how far the pose at y is from T, both parts together."""
    reached = problem.mechanism.fk(problem.shown(y))
    return float(np.linalg.norm(pin.log6(reached.actInv(pin.SE3(T))).vector))


def inner_points(problem: Problem, turned: TurnedStarts, count: int) -> list[int]:
    """Return points whose axes stay off their limits."""
    room = np.minimum(turned.points.values - problem.box.lower, problem.box.upper - turned.points.values)
    room[:, [turned.first, turned.last]] = np.inf
    return [int(n) for n in np.flatnonzero(room.min(axis=1) > 0.02)[:count]]


@pytest.mark.parametrize("name", NAMES)
def test_a_point_is_found_again_with_the_arm_and_the_tool_turned(name: str) -> None:
    problem, turned = table_of(load(name))
    rng, met = np.random.default_rng(3), 0
    for n in inner_points(problem, turned, 60):
        y = turned.points.values[n].copy()
        for m in (turned.first, turned.last):
            y[m] = rng.uniform(*np.clip([problem.box.lower[m], problem.box.upper[m]], -3.0, 3.0))
        T = problem.mechanism.fk(problem.shown(y)).homogeneous
        start = start_for(problem, turned, T, n)
        if start is not None:
            assert miss(problem, start, T) < 1e-9
            met += 1
    assert met > 40


@pytest.mark.parametrize("name", NAMES)
def test_the_step_from_a_point_leaves_an_error_of_second_order(name: str) -> None:
    """Ten times closer, a hundred times better: every sign of every derivative is in this."""
    problem, turned = table_of(load(name))
    rng, ratios = np.random.default_rng(4), []
    for n in inner_points(problem, turned, 80):
        away = rng.normal(size=len(problem.free))
        away[[turned.first, turned.last]] = 0.0
        left = []
        for size in (1e-2, 1e-3):
            y = turned.points.values[n] + size * away / np.linalg.norm(away)
            T = problem.mechanism.fk(problem.shown(y)).homogeneous
            start = start_for(problem, turned, T, n)
            left.append(np.nan if start is None else miss(problem, start, T) / size)
        ratios.append(left)
    far, near = np.nanmedian(np.array(ratios), axis=0)
    assert near < 0.03
    assert near < 0.5 * far


@pytest.mark.parametrize("options", [DEFAULT, IkOptions(compiled=False)], ids=["compiled", "plain"])
@pytest.mark.parametrize("name", NAMES)
def test_most_searches_end_with_the_first_start(name: str, options: IkOptions) -> None:
    robot, rng = load(name), np.random.default_rng(5)
    problem = problem_of(robot, None, None, DEFAULT)
    lower, upper = np.maximum(problem.box.lower, -np.pi), np.minimum(problem.box.upper, np.pi)
    first, count = 0, 0
    while count < 100:
        axes = problem.shown(rng.uniform(lower, upper))
        if robot.violated_limits(axes):
            continue
        found = robot.ik(robot.fk(axes), options=options)
        assert found.success
        first, count = first + (found.restarts == 0), count + 1
    assert first >= 80


def test_the_step_is_bounded() -> None:
    problem, turned = table_of(load("kr6r900"))
    T = problem.mechanism.fk([30.0, -60.0, 80.0, 20.0, 40.0, 10.0]).homogeneous
    query, moving = turned.query(T), [n for n in range(6) if n not in (turned.first, turned.last)]
    for n in range(len(turned.points.values)):
        start = turned.start(n, query, problem.box, problem.middle)
        if start is not None:
            assert np.abs(start - turned.points.values[n])[moving].max() <= LARGEST_STEP + 1e-12


def test_limits_of_the_turning_axes_are_kept() -> None:
    problem, turned = table_of(load("kr6r900"))
    lower, upper = problem.box.lower, problem.box.upper
    behind = problem.mechanism.fk([179.0, -60.0, 80.0, 20.0, 40.0, 10.0]).homogeneous  # axis 1 ends at 170°
    query = turned.query(behind)
    found = [turned.start(n, query, problem.box, problem.middle) for n in range(len(turned.points.values))]
    kept = [y for y in found if y is not None]
    assert kept
    assert len(kept) < len(found)
    for y in kept:
        assert ((lower <= y) & (y <= upper)).all()


@pytest.mark.parametrize("name", ["bed_mill_kin1", "scara_cc", "geared_head_kin28"])
def test_machines_without_such_turns_have_no_such_table(name: str) -> None:
    robot = table_machine() if name == "table" else load(name)
    assert problem_of(robot, None, None, DEFAULT).turned_starts() is None


def test_an_axis_held_between_gives_a_table_of_its_own_but_not_without_end() -> None:
    robot = chainbuild.Robot.load("kr6r900")
    angles = (0.0, 10.0, 20.0, 30.0)
    tables = [problem_of(robot, None, {"A4": angle}, DEFAULT).turned_starts() for angle in angles]
    assert tables[0] is not None
    assert tables[1] is not None
    assert tables[0].points is not tables[1].points
    assert tables[3] is None
    outside = problem_of(chainbuild.Robot.load("irb2600_track"), None, {"EX1": 500.0}, DEFAULT)
    assert outside.turned_starts() is not None


@pytest.mark.parametrize("options", [DEFAULT, IkOptions(compiled=False)], ids=["compiled", "plain"])
@pytest.mark.parametrize("axes", [(115.32, -129.73, 66.33, -85.56, -103.14), (130.66, -129.65, 60.31, -59.76, 133.59)])
def test_an_arm_that_reaches_just_behind_its_first_axis(axes: tuple[float, ...], options: IkOptions) -> None:
    """From before the axis it stands half a turn away and outside its limits; in a corner of these lies the answer."""
    robot = load("palletiser_kin213")
    assert robot.ik(robot.fk(axes), solver="damped", options=options).success


@pytest.mark.parametrize("name", NAMES)
def test_points_seen_from_behind_have_the_key_of_what_is_half_a_turn_away(name: str) -> None:
    points = table_of(load(name))[1].points
    keys = -points.rows[:5] / (2.0 * points.rows[5])
    front, behind = keys[:, :COUNT], keys[:, COUNT:]
    assert behind.shape[1] > 0
    assert (front[0] >= 0.0).all()
    mirror = np.array([-1.0, 1.0, -1.0, -1.0, 1.0])
    for key in behind.T:
        assert np.abs(front.T - key * mirror).max(axis=1).min() < 1e-6
