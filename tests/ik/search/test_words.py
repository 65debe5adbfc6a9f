"""Rows of tables say why they failed: in the words of single calls, and only when asked."""

from __future__ import annotations

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

import chainbuild
from chainbuild.ik.request import IkOptions
from chainbuild.ik.search import words
from tests.kit.draws import random_axes
from tests.kit.robots import arm, table_machine

BOTH = [True, False]


def mixed_poses(robot, count: int, seed: int = 5) -> np.ndarray:
    """Return poses inside the limits, outside them, and out of reach, in turn."""
    rng = np.random.default_rng(seed)
    axes = np.array([random_axes(robot, rng) for _ in range(count)])
    axes[1::3] *= 1.6
    poses = robot.fk_batch(axes)
    poses[2::3, :3, 3] *= 2.5
    return poses


@pytest.mark.parametrize("compiled", BOTH)
@pytest.mark.parametrize("make", [arm, table_machine])
def test_words_are_those_of_single_calls(make, compiled: bool) -> None:
    robot, options = make(), IkOptions(compiled=compiled, max_restarts=30)
    poses = mixed_poses(robot, 18)
    table = robot.ik_batch(poses, options=options)
    assert {"ok", "limits"} <= set(table.status)
    for row, pose, reason in zip(table, poses, table.reasons(), strict=True):
        single = robot.ik(pose, solver="damped", options=options)
        assert (row.status, row.violated, row.reason) == (single.status, single.violated, reason)
        assert bool(reason) == (not row.success)
        assert words.kind_of(reason) == words.kind_of(single.reason)


@pytest.mark.parametrize("compiled", BOTH)
def test_limits_in_the_way_of_a_mill(compiled: bool) -> None:
    # Tool upright: X and Y of the machine are those of the pose; z = 0 needs Z = -410.
    robot = chainbuild.Robot.load("ac_table_kin58")
    poses = np.repeat(np.eye(4)[None], 4, axis=0)
    poses[:, :3, 3] = [(0.7, 0.0, 0.2), (0.1, 0.0, 0.2), (0.0, -0.6, 0.2), (0.7, 0.0, 0.0)]
    table = robot.ik_batch(poses, options=IkOptions(compiled=compiled))
    assert [row.violated for row in table] == [("X",), (), ("Y",), ("X", "Z")]
    x = "X at 700.000 mm (limit 400.000)"
    assert table.reasons() == [
        f"reached only outside the limits: {x}",
        "",
        "reached only outside the limits: Y at -600.000 mm (limit -300.000)",
        f"reached only outside the limits: {x}, Z at -410.000 mm (limit -350.000)",
    ]


@pytest.mark.parametrize("compiled", BOTH)
def test_one_start_a_pose(compiled: bool) -> None:
    robot, options = arm(), IkOptions(compiled=compiled, max_restarts=30)
    poses = mixed_poses(robot, 9)
    starts = np.array([random_axes(robot, np.random.default_rng(n)) for n in range(9)])
    table = robot.ik_batch(poses, starts, options=options)
    singles = [robot.ik(T, start, solver="damped", options=options) for T, start in zip(poses, starts, strict=True)]
    assert [row.violated for row in table] == [single.violated for single in singles]
    assert list(map(words.kind_of, table.reasons())) == [words.kind_of(single.reason) for single in singles]


def test_rows_with_input_axes_of_their_own() -> None:
    robot = chainbuild.Robot.load("irb2600_track")
    starts = np.array([[100.0 * row if axis.held else 10.0 for axis in robot.axes] for row in range(3)])
    poses = robot.fk_batch(starts)
    poses[1:, 2, 3] += 3.0
    table = robot.ik_batch(poses, starts)
    assert table.status == ["ok", "unreachable", "unreachable"]
    assert table.reasons() == ["", *(robot.ik(poses[n], starts[n], solver="damped").reason for n in (1, 2))]
    assert table[-1].reason.startswith("too far: the tool ends 2")


@pytest.mark.parametrize("compiled", BOTH)
def test_rows_of_a_path(compiled: bool) -> None:
    robot, options = arm(), IkOptions(compiled=compiled, max_restarts=30)
    wanted = np.linspace([0.0, -80.0, 70.0, 20.0, 40.0, 30.0], [9.0, -80.0, 70.0, 20.0, 40.0, 30.0], 10)
    poses = robot.fk_batch(wanted)
    poses[[0, 4, 5], 0, 3] = 30.0
    outside = mixed_poses(robot, 9)[1]
    poses[7] = outside
    for start in (None, wanted[0]):
        table = robot.ik_path(poses, start, options=options)
        assert [n for n, reason in enumerate(table.reasons()) if reason] == [0, 4, 5, 7]
        assert all(table[n].reason.startswith("too far: 30") for n in (0, 4, 5))
        last = table.axes[6]
        single = robot.ik(outside, last, solver="damped", options=options)
        assert (table[7].status, table[7].violated) == (single.status, single.violated)
        assert words.kind_of(table[7].reason) == words.kind_of(single.reason)


@pytest.mark.parametrize("compiled", BOTH)
def test_an_axis_held_outside_its_limits(compiled: bool) -> None:
    robot, options = arm(), IkOptions(compiled=compiled)
    T = robot.fk_batch([[175.0, -90.0, 90.0, 0.0, 30.0, 0.0]] * 2)
    for table in (robot.ik_batch(T, held={"A1": 175.0}, options=options), robot.ik_path(T, held={"A1": 175.0})):
        assert table.reasons() == ["an axis is held outside its limits: A1 is 175, outside -170 … 170 deg"] * 2
        assert [row.violated for row in table] == [("A1",)] * 2


def test_words_are_looked_for_when_asked_and_once(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    real = words.result_of
    monkeypatch.setattr(words, "result_of", lambda *args: asked.append(args) or real(*args))
    robot = arm()
    poses = mixed_poses(robot, 9)
    table = robot.ik_batch(poses)
    rows = list(table)
    assert [row.status for row in rows] == table.status
    assert not asked
    n = table.status.index("unreachable")
    first = rows[n].reason
    assert first
    assert (rows[n].reason, rows[n].violated, table[n].reason, len(asked)) == (first, (), first, 1)


def test_a_table_keeps_the_targets_of_failed_rows_alone() -> None:
    robot = arm()
    poses = mixed_poses(robot, 30)
    table = robot.ik_batch(poses)
    failed = int((~table.success).sum())
    assert 0 < failed < 30
    failures = table.explain.__self__
    assert (len(failures.rows), len(failures.targets), failures.starts) == (failed, failed, None)
    assert robot.ik_batch(poses[::3]).explain is None
    assert robot.ik_path(poses[:1]).explain is None


def test_words_outlive_the_poses_given() -> None:
    robot = arm()
    poses = mixed_poses(robot, 9)
    expected, table = robot.ik_batch(poses).reasons(), robot.ik_batch(poses)
    poses[:] = np.eye(4)
    assert table.reasons() == expected


def test_rows_and_tables_are_copied_with_their_words() -> None:
    robot = arm()
    table = robot.ik_batch(mixed_poses(robot, 9))
    expected = table.reasons()
    n = next(n for n, reason in enumerate(expected) if reason)
    table = robot.ik_batch(mixed_poses(robot, 9))
    assert pickle.loads(pickle.dumps(table)).reasons() == expected
    for other in (pickle.loads(pickle.dumps(table[n])), copy.copy(table[n]), replace(table[n], restarts=0)):
        assert other.reason == expected[n]
    assert expected[n] in repr(table[n])
    assert not hasattr(table[n], "words")
    with pytest.raises(IndexError):
        table[9]


@pytest.mark.parametrize(
    ("reason", "kind"),
    [
        ("too far: 9000.0 mm from the workpiece frame", "too far: … mm from the workpiece frame"),
        ("A3 at -170.1 deg (limit 1e-05), EX1 at 5 mm", "A3 at … deg (limit …), EX1 at … mm"),
        ("A1 is 3, outside -170 … 170 deg", "A1 is …, outside … … … deg"),
        ("the search ended 0.100 mm and 0.200° from the pose", "the search ended … mm and …° from the pose"),
    ],
)
def test_a_kind_is_a_reason_without_numbers(reason: str, kind: str) -> None:
    assert words.kind_of(reason) == kind
