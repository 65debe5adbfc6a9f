"""The pose status along a path: kept where a solution has it, told where the path leads past a singular position."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from chainbuild.ik.request import IkOptions
from chainbuild.ik.search.path import solve_path
from chainbuild.robot import Robot
from tests.kit.arms45 import limited
from tests.kit.draws import random_axes
from tests.kit.robots import arm

SHIPPED = ("kr6r900_2", "tx2_60")


def through_the_wrist() -> np.ndarray:
    """Axis 5 passes through 0 in row 30; row 31 is beyond."""
    rows = np.tile([10.0, -60.0, 60.0, 30.0, 0.0, 20.0], (61, 1))
    rows[:, 4] = np.linspace(-30.0, 30.0, 61)
    return rows


def statuses(robot: Robot, rows: np.ndarray) -> list[int]:
    return chainbuild.status_turn_rows(robot, rows)[:, 0].tolist()


@pytest.mark.parametrize("name", SHIPPED)
def test_the_status_is_kept_by_a_jump(name: str) -> None:
    robot, rows = Robot.load(name), through_the_wrist()
    found = robot.ik_path(robot.fk_batch(rows), rows[0])
    assert found.success.all()
    status = statuses(robot, rows[:1])[0]
    assert [(c.row, c.old, c.new, c.kept) for c in found.status_changes] == [(31, status, status ^ 4, True)]
    assert f"status {status} is kept, and the axes jump" in found.status_changes[0].words
    np.testing.assert_allclose(found.axes[:30], rows[:30], atol=1e-5)
    assert set(statuses(robot, found.axes[31:])) == {status}
    np.testing.assert_allclose(robot.fk_batch(found.axes), robot.fk_batch(rows), atol=1e-6)
    assert np.abs(np.diff(found.axes[31:], axis=0)).max() < 1.5
    assert chainbuild.status_changes(robot, found.axes) == []
    assert (found.position_error < 1e-6).all()


@pytest.mark.parametrize("name", SHIPPED)
def test_where_it_cannot_be_kept_the_row_is_told(name: str) -> None:
    rows = through_the_wrist()
    robot = limited(Robot.load(name), A1=(-100.0, 100.0), A2=(-100.0, 100.0))
    found = robot.ik_path(robot.fk_batch(rows), rows[0])
    assert found.success.all()
    np.testing.assert_allclose(found.axes, rows, atol=1e-5)
    status = statuses(robot, rows[:1])[0]
    assert found.status_changes == (chainbuild.StatusChange(31, status, status ^ 4, False),)
    assert found.status_changes == tuple(chainbuild.status_changes(robot, rows))
    assert "does not change along a path" in found.status_changes[0].words


def test_there_and_back_is_told_twice() -> None:
    robot, rows = Robot.load("kr6r900_2"), through_the_wrist()
    both = np.concatenate((rows, rows[::-1]))
    found = robot.ik_path(robot.fk_batch(both), both[0])
    assert [(c.row, c.kept) for c in found.status_changes] == [(31, True), (92, True)]
    np.testing.assert_allclose(found.axes[-1], both[-1], atol=1e-5)


@pytest.mark.parametrize("name", SHIPPED)
def test_a_path_that_needs_no_change_is_as_it_was(name: str) -> None:
    robot, rng = Robot.load(name), np.random.default_rng(3)
    for _ in range(5):
        first, last = (0.5 * random_axes(robot, rng) for _ in range(2))
        first[4], last[4] = 20.0, 70.0
        rows = first + np.linspace(0.0, 1.0, 100)[:, None] * (last - first)
        if chainbuild.status_changes(robot, rows):
            continue
        poses = robot.fk_batch(rows)
        found, searched = robot.ik_path(poses, first), solve_path(robot, poses, first)
        assert found.status_changes == ()
        np.testing.assert_array_equal(found.axes, searched.axes)
        np.testing.assert_allclose(found.axes, rows, atol=1e-5)


def test_a_path_may_begin_or_turn_back_in_the_singular_position() -> None:
    robot = Robot.load("kr6r900_2")
    rows = through_the_wrist()
    for part in (rows[30:], rows[30::-1], np.concatenate((rows[:31], rows[29::-1]))):
        found = robot.ik_path(robot.fk_batch(part), part[0])
        assert found.status_changes == ()
        np.testing.assert_allclose(found.axes, part, atol=1e-4)
        assert chainbuild.status_changes(robot, part) == []


def test_the_first_row_keeps_the_status_of_the_start() -> None:
    robot, rows = Robot.load("kr6r900_2"), through_the_wrist()
    (change,) = robot.ik_path(robot.fk_batch(rows[32:]), rows[29]).status_changes
    assert (change.row, change.kept) == (0, True)
    alone = robot.ik_path(robot.fk_batch(rows[32:]))
    assert alone.status_changes == ()
    assert len(robot.ik_path([], rows[0])) == 0


def test_rows_that_fail_are_passed_over() -> None:
    robot, rows = Robot.load("kr6r900_2"), through_the_wrist()
    poses = robot.fk_batch(rows)
    poses[[0, 31, 40], 0, 3] += 9.0
    found = robot.ik_path(poses, rows[0], options=IkOptions(compiled=False))
    assert np.flatnonzero(~found.success).tolist() == [0, 31, 40]
    assert [(c.row, c.kept) for c in found.status_changes] == [(32, True)]
    assert "too far" in found[31].reason
    # Row 30 is in the singular position, and has the sign that rounding gives it.
    assert set(statuses(robot, np.delete(found.axes, [0, 30, 31, 40], axis=0))) == {6}


def test_units_and_other_robots() -> None:
    robot, rows = Robot.load("kr6r900_2"), through_the_wrist()
    found = robot.ik_path(robot.fk_batch(rows), np.radians(rows[0]), units="si")
    assert len(found.status_changes) == 1
    np.testing.assert_allclose(found.axes[:30], np.radians(rows[:30]), atol=1e-6)
    assert arm().ik_path(arm().fk_batch(rows), rows[0]).status_changes == ()
    with pytest.raises(chainbuild.ChainbuildError, match="KIN_TYP 45 only"):
        chainbuild.status_changes(arm(), rows)
