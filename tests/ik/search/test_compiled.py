"""The compiled path: the kinematics of Pinocchio, the answers of the plain path, and nothing lost without it."""

from __future__ import annotations

from functools import cache

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild.ik.request import DEFAULT, IkOptions, IkRequest
from chainbuild.ik.search.compiled import packing as compiled
from chainbuild.ik.search.problem import problem_of
from chainbuild.ik.search.solver import search
from chainbuild.robot import Robot
from tests.kit.draws import random_axes
from tests.kit.robots import arm, table_machine

PLAIN = IkOptions(compiled=False)
NAMES = (
    "arm",
    "table",
    "kr6r900",
    "irb2600_track",
    "irb2600_table",
    "parallelogram_nr",
    "ba_head_c_table_kin82",
    "scara_cc",
    "c_face_kin14",
)


@cache
def load(name: str) -> Robot:
    """Return a robot of the tests, or a shipped machine by name."""
    made = {"arm": arm, "table": table_machine}
    return made[name]() if name in made else chainbuild.Robot.load(name)


@cache
def pose_and_jacobian() -> object:
    """Return the compiled function with a wrapper that Python can call."""
    import numba

    from chainbuild.ik.search.compiled.kernels import pose_and_jacobian as inner

    @numba.njit
    def outer(fixed, prismatic, A, b, y, T, J, turns):
        inner(fixed, prismatic, A, b, y, T, J, turns)

    return outer


def poses(robot: Robot, count: int, seed: int) -> list[np.ndarray]:
    """Return poses inside all limits, input axes at 0."""
    rng, found = np.random.default_rng(seed), []
    while len(found) < count:
        axes = random_axes(robot, rng)
        axes[[axis.held for axis in robot.axes]] = 0.0
        if not robot.violated_limits(axes):
            found.append(robot.fk(axes).homogeneous)
    return found


def test_numba_is_there_for_the_tests() -> None:
    assert compiled.available()


@pytest.mark.parametrize("name", NAMES)
def test_kinematics_are_those_of_pinocchio(name: str) -> None:
    from chainbuild.ik.search.compiled.kernels import unpack

    robot, rng = load(name), np.random.default_rng(5)
    problem = problem_of(robot, None, None, DEFAULT)
    packed = compiled.packed(problem)
    arrays = unpack.py_func(*packed.arrays)
    T, J, turns = np.empty((3, 4)), np.empty((6, len(problem.free))), np.empty((len(arrays.b), 2))
    for _ in range(50):
        axes = random_axes(robot, rng)
        axes[[axis.held for axis in robot.axes]] = 0.0
        y = np.ascontiguousarray(problem.free_part(axes))
        pose_and_jacobian()(arrays.fixed, arrays.prismatic, arrays.A, arrays.b, y, T, J, turns)
        np.testing.assert_allclose(T, robot.fk(axes).homogeneous[:3], atol=1e-12)
        np.testing.assert_allclose(J, robot.jacobian(axes)[:, problem.free], atol=1e-10)


def test_the_reach_counts_where_the_whole_distance_does() -> None:
    from chainbuild.ik.search.compiled.kernels import unpack

    robot = load("kr6r900")
    for weights, counts in (((1.0,) * 6, True), ((0.0, 1.0, 1.0, 1.0, 1.0, 1.0), False)):
        packed = compiled.packed(problem_of(robot, None, None, IkOptions(weights=weights)))
        assert packed is not None
        assert unpack.py_func(*packed.arrays).reach == (robot.kinematics.reach if counts else np.inf)


@pytest.mark.parametrize("name", NAMES)
def test_answers_are_those_of_the_plain_path(name: str) -> None:
    robot = load(name)
    for T in poses(robot, 40, seed=6):
        ours, plain = search(IkRequest.of(robot, T)), search(IkRequest.of(robot, T, options=PLAIN))
        assert (ours.success, ours.restarts, ours.status) == (plain.success, plain.restarts, "ok")
        np.testing.assert_allclose(ours.axes, plain.axes, atol=1e-5)
        for found in (ours, plain):
            reached = robot.fk(found.axes)
            assert np.linalg.norm(reached.translation - T[:3, 3]) < 1e-8
            assert robot.violated_limits(found.axes) == ()


@pytest.mark.parametrize("options", [DEFAULT, PLAIN], ids=["compiled", "plain"])
def test_half_turns_and_opposite_directions(options: IkOptions) -> None:
    robot = arm()
    start = np.array([0.0, -80.0, 70.0, 0.0, 40.0, 0.0])
    for direction in np.vstack((np.eye(3), [[0.6, 0.8, 0.0], [-0.6, 0.0, 0.8]])):
        for angle in (np.pi, np.pi - 1e-7, np.pi - 1e-3):
            T = robot.fk(start)
            T.rotation = T.rotation @ pin.exp3(angle * direction)
            found = robot.ik(T, start, options=options)
            if found.success:
                error = pin.log3(robot.fk(found.axes).rotation.T @ T.rotation)
                assert np.linalg.norm(error) < 1e-6
    mill = table_machine()
    target = mill.fk([0.0, 0.0, 0.0, 170.0, 10.0])
    assert mill.ik(target, [0.0, 0.0, 0.0, -10.0, 10.0], options=options).success


@pytest.mark.parametrize("options", [DEFAULT, PLAIN], ids=["compiled", "plain"])
@pytest.mark.parametrize(
    "T",
    [
        np.diag([1.0, 1.0, -1.0, 1.0]),
        2.0 * np.eye(4),
        np.full((4, 4), np.nan),
        np.ones((4, 4)),
        np.eye(4) * [1, 1, 1, 2],
    ],
)
def test_what_is_no_rigid_transform_is_refused_by_both(T: np.ndarray, options: IkOptions) -> None:
    with pytest.raises(chainbuild.ChainbuildError, match="a pose must be"):
        arm().ik(T, options=options)
    with pytest.raises(chainbuild.ChainbuildError, match="pose 1: a pose must be"):
        arm().ik_batch(np.array([np.eye(4), T]), options=options)


def test_without_numba_everything_works(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = load("kr6r900")
    targets = np.array(poses(robot, 5, seed=9))
    with_numba = [robot.ik(T).axes for T in targets], robot.ik_batch(targets).axes, robot.ik_path(targets[:2]).axes
    monkeypatch.setattr(compiled, "available", lambda: False)
    monkeypatch.setattr(compiled, "entries", lambda: pytest.fail("the compiled path was taken"))
    without = [robot.ik(T).axes for T in targets], robot.ik_batch(targets).axes, robot.ik_path(targets[:2]).axes
    for ours, plain in zip(with_numba, without, strict=True):
        np.testing.assert_allclose(ours, plain, atol=1e-5)


def test_a_numba_that_cannot_be_imported_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(name: str) -> None:
        raise ImportError(f"{name} needs another NumPy")

    compiled.available.cache_clear()
    monkeypatch.setattr(compiled, "import_module", refuse)
    assert not compiled.available()
    assert arm().ik(arm().fk([10.0, -80.0, 70.0, 20.0, 40.0, 30.0])).success
    compiled.available.cache_clear()


def test_a_nonlinear_axis_map_takes_the_plain_path() -> None:
    robot = load("cardan_head_kin59")
    assert compiled.packed(problem_of(robot, None, None, DEFAULT)) is None
    axes = np.array([10.0, 20.0, 30.0, 40.0, 20.0])
    assert robot.ik(robot.fk(axes), axes + 1.0).success
    assert robot.ik_batch([robot.fk(axes)] * 3).success.all()
    np.testing.assert_array_equal(robot.fk_batch([axes])[0], robot.fk(axes).homogeneous)


def test_stale_machine_code_is_told_by_a_fingerprint() -> None:
    entries = compiled.entries()
    cells = {cell.cell_contents for cell in entries.search_one.py_func.__closure__}
    assert entries._FINGERPRINT in cells
