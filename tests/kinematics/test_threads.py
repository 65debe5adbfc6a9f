"""Mechanisms and collision models shared by threads, pickled and copied."""

from __future__ import annotations

import copy
import pickle
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import chainbuild
from chainbuild import CollisionModel, IkOptions, Robot

THREADS = 8
# coal looks for the distance of boxes from where its last query ended, and stops within 1e-6 m: the answer depends on
# the query before by up to 1.4e-6 m in one thread, too. A body of another thread's position is millimetres away.
COAL_STOPS_WITHIN_M = 5e-6
Answer = Callable[[np.ndarray], np.ndarray]


@pytest.fixture
def impatient() -> Iterator[None]:
    """Let threads take turns a thousand times more often than Python has them by itself."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-5)
    yield
    sys.setswitchinterval(before)


def drawn(robot: Robot, count: int, seed: int) -> np.ndarray:
    lower, upper = (np.array([getattr(axis, end) for axis in robot.axes]) for end in ("lower", "upper"))
    return lower + (upper - lower) * np.random.default_rng(seed).random((count, len(lower)))


def wrong(answer: Answer, rows: np.ndarray, rounds: int, tolerance: float = 0.0) -> int:
    """Return how many answers of eight threads differ from those that one thread gives, by default in any bit."""
    alone = [answer(row) for row in rows]

    def work(thread: int) -> int:
        order = np.random.default_rng(thread).permutation(len(rows))
        return sum(not same(answer(rows[n]), alone[n]) for _ in range(rounds) for n in order)

    def same(one: np.ndarray, other: np.ndarray) -> bool:
        return np.array_equal(one, other) or (tolerance > 0.0 and bool((np.abs(one - other) <= tolerance).all()))

    with ThreadPoolExecutor(THREADS) as pool:
        return sum(pool.map(work, range(THREADS)))


@pytest.mark.usefixtures("impatient")
@pytest.mark.parametrize("name", ["kr6r900", "ac_table_kin58"])
def test_threads_share_a_robot(name: str) -> None:
    robot = Robot.load(name)
    assert wrong(lambda row: robot.fk(row).homogeneous, drawn(robot, 300, 1), 10) == 0  # 24,000 poses
    assert wrong(robot.jacobian, drawn(robot, 100, 2), 2) == 0


@pytest.mark.usefixtures("impatient")
def test_threads_share_a_collision_model() -> None:
    robot = Robot.load("kr6r900")
    bodies = CollisionModel(robot)
    assert wrong(bodies.distances, drawn(robot, 100, 3), 3) == 0  # 2,400 distances
    assert wrong(lambda row: np.array(bodies.collides(row)), drawn(robot, 100, 4), 3) == 0


@pytest.mark.usefixtures("impatient")
@pytest.mark.parametrize("compiled", [True, False])
def test_threads_share_the_solvers(compiled: bool) -> None:
    robot, options = Robot.load("kr6r900"), IkOptions(compiled=compiled)

    def solved(row: np.ndarray) -> np.ndarray:
        return robot.ik(robot.fk(row), start=row + 3.0, options=options).axes

    assert wrong(solved, drawn(robot, 50, 5), 2) == 0
    assert wrong(lambda row: robot.ik_all(robot.fk(row)).axes, drawn(robot, 5, 6), 1) == 0


def test_what_many_threads_ask_for_at_once_is_made_once() -> None:
    robot, made = Robot.load("kr6r900"), []

    def make() -> object:
        made.append(object())
        return made[-1]

    with ThreadPoolExecutor(THREADS) as pool:
        found = list(pool.map(lambda _: robot.prepared("thing", make, "key"), range(200)))
    assert len(made) == 1
    assert set(map(id, found)) == {id(made[0])}


def test_only_the_newest_of_a_kind_are_kept() -> None:
    robot = Robot.load("kr6r900")
    for n in range(5):
        assert robot.prepared("number", lambda n=n: n, n, 2) == n
    assert robot.prepared("number", lambda: -1, 4, 2) == 4
    assert robot.prepared("number", lambda: -1, 0, 2) == -1  # forgotten, and made anew


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda thing: pickle.loads(pickle.dumps(thing))])
def test_used_robots_and_collision_models_are_copied(copied: Callable[[object], object]) -> None:
    robot = Robot.load("irb2600_track")
    axes = [10.0, -20.0, 30.0, 40.0, 50.0, 60.0, 700.0]
    bodies = CollisionModel(robot, [("A2_link", "A5_link")])
    distance, solved = bodies.distances(axes), robot.ik(robot.fk(axes), held={"EX1": 700.0})
    other, their_bodies = copied(robot), copied(bodies)
    assert isinstance(other, Robot)
    assert isinstance(their_bodies, CollisionModel)
    assert np.array_equal(other.fk(axes).homogeneous, robot.fk(axes).homogeneous)
    assert np.array_equal(other.ik(robot.fk(axes), held={"EX1": 700.0}).axes, solved.axes)
    assert their_bodies.pairs_by_link() == bodies.pairs_by_link()
    assert np.array_equal(their_bodies.distances(axes), distance)


@pytest.mark.slow
@pytest.mark.usefixtures("impatient")
@pytest.mark.parametrize(("name", "share"), [("kr6r900", 1), ("ac_table_kin58", 1), ("parallelogram_nr", 10)])
def test_eight_threads_a_hundred_thousand_times_each(name: str, share: int) -> None:
    """A machine with limits of sums takes a tenth of the rounds: it would take a quarter of an hour."""
    robot = chainbuild.Robot.load(name)
    bodies, plain = CollisionModel(robot), IkOptions(compiled=False)

    def solved(row: np.ndarray) -> np.ndarray:
        return robot.ik(robot.fk(row), start=row + 1.0).axes

    def solved_plainly(row: np.ndarray) -> np.ndarray:
        return robot.ik(robot.fk(row), start=row + 1.0, options=plain).axes

    assert wrong(lambda row: robot.fk(row).homogeneous, drawn(robot, 1000, 11), 100 // share) == 0
    assert wrong(robot.jacobian, drawn(robot, 1000, 12), 100 // share) == 0
    assert wrong(solved, drawn(robot, 500, 13), 200 // share) == 0
    assert wrong(solved_plainly, drawn(robot, 100, 14), 20 // share) == 0
    assert wrong(bodies.distances, drawn(robot, 500, 15), 200 // share, COAL_STOPS_WITHIN_M) == 0
