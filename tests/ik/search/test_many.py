"""Many poses at once: the rows are those of single calls, starts and input axes included."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from chainbuild.errors import AxisValueError, ChainbuildError
from chainbuild.ik.request import IkOptions
from tests.kit.draws import random_axes
from tests.kit.robots import arm, table_machine


@pytest.mark.parametrize("make", [arm, table_machine])
@pytest.mark.parametrize("compiled", [True, False])
def test_rows_are_those_of_single_calls(make, compiled: bool) -> None:
    robot, rng, options = make(), np.random.default_rng(1), IkOptions(compiled=compiled)
    axes = np.array([random_axes(robot, rng) for _ in range(20)])
    T = robot.fk_batch(axes)
    table = robot.ik_batch(T, options=options)
    assert len(table) == 20
    assert table.success.all()
    assert set(table.status) == {"ok"}
    for row, pose in zip(table, T, strict=True):
        single = robot.ik(pose, options=options)
        np.testing.assert_allclose(row.axes, single.axes, atol=1e-9)
        assert (row.status, row.restarts, row.iterations, row.task) == (
            single.status, single.restarts, single.iterations, single.task,
        )  # fmt: skip
        assert row.position_error < 1e-8


def test_forward_batch_is_the_forward_kinematics() -> None:
    for robot in (arm(), table_machine(), chainbuild.Robot.load("irb2600_table")):
        axes = np.array([random_axes(robot, np.random.default_rng(n)) for n in range(50)])
        expected = np.array([robot.fk(row).homogeneous for row in axes])
        np.testing.assert_allclose(robot.fk_batch(axes), expected, atol=1e-14)
    assert arm().fk_batch(np.empty((0, 6))).shape == (0, 4, 4)


def test_forward_batch_in_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = arm()
    axes = np.array([random_axes(robot, np.random.default_rng(n)) for n in range(10)])
    whole = robot.fk_batch(axes)
    monkeypatch.setattr("chainbuild.kinematics.product._CHUNK", 3)
    np.testing.assert_allclose(robot.fk_batch(axes), whole, atol=1e-15)


@pytest.mark.parametrize(
    ("axes", "text"),
    [
        ([0.0] * 6, "expected rows of axis values, got an array of shape"),
        (np.zeros((2, 5)), "expected rows of axis values, got an array of shape"),
        ([["a"] * 6], "expected rows of axis values, got values that are not real numbers"),
        ([[0.0] * 6, [0.0, 0.0, np.nan, 0.0, 0.0, 0.0]], "axis A3 has the value nan"),
    ],
)
def test_forward_batch_refuses(axes, text: str) -> None:
    with pytest.raises(AxisValueError, match=text):
        arm().fk_batch(axes)


@pytest.mark.parametrize("compiled", [True, False])
def test_starts_one_for_all_or_one_a_pose(compiled: bool) -> None:
    robot, options = arm(), IkOptions(compiled=compiled)
    axes = np.array([[10.0, -80.0, 70.0, 20.0, 40.0, 330.0], [20.0, -70.0, 60.0, -20.0, 50.0, -330.0]])
    T = robot.fk_batch(axes)
    np.testing.assert_allclose(robot.ik_batch(T, axes + 2.0, options=options).axes, axes, atol=1e-6)
    near_first = robot.ik_batch(T, axes[0], options=options)
    np.testing.assert_allclose(near_first.axes[0], axes[0], atol=1e-6)
    assert near_first.axes[1, 5] == pytest.approx(30.0)  # the turn nearest to the common start


def test_every_part_of_a_large_table_has_its_own_starts() -> None:
    robot, rng = arm(), np.random.default_rng(11)
    axes = np.array([random_axes(robot, rng) for _ in range(1500)])
    table = robot.ik_batch(robot.fk_batch(axes), axes)
    np.testing.assert_allclose(table.axes, axes, atol=1e-6)


def test_input_axes_are_taken_from_each_start() -> None:
    robot = chainbuild.Robot.load("irb2600_track")
    held = [axis.held for axis in robot.axes]
    axes = np.array([[100.0 if h else 10.0 * (row + 1) for h in held] for row in range(3)])
    axes[:, held] = [[0.0], [150.0], [300.0]]
    table = robot.ik_batch(robot.fk_batch(axes), axes + np.where(held, 0.0, 1.0))
    assert table.success.all()
    np.testing.assert_allclose(table.axes, axes, atol=1e-6)
    name = next(axis.name for axis in robot.axes if axis.held)
    same = robot.ik_batch(robot.fk_batch(axes[1:2]), held={name: 150.0})
    assert same.axes[0, held.index(True)] == 150.0


def test_failed_rows_keep_their_status() -> None:
    robot = arm()
    far = np.eye(4)
    far[0, 3] = 50.0
    table = robot.ik_batch([robot.fk([10.0, -80.0, 70.0, 20.0, 40.0, 30.0]), far])
    assert table.status == ["ok", "unreachable"]
    assert table.success.tolist() == [True, False]
    assert table.position_error[1] > 40.0
    assert table[1].status == "unreachable"


@pytest.mark.parametrize(
    ("poses", "starts", "error", "text"),
    [
        (5, None, ChainbuildError, "poses must be"),
        ([np.eye(3)], None, ChainbuildError, "pose 0: "),
        ([np.eye(4)], [0.0], AxisValueError, "start values"),
        (
            [np.eye(4)],
            np.zeros((2, 6)),
            AxisValueError,
            r"one row of start values or one per pose \(1\), got 2",
        ),
        ([np.eye(4)], [np.nan] * 6, AxisValueError, "start values"),
    ],
)
def test_bad_input_is_one_error(poses, starts, error, text: str) -> None:
    with pytest.raises(error, match=text):
        arm().ik_batch(poses, starts)


def test_nothing_in_nothing_out() -> None:
    assert len(arm().ik_batch(np.empty((0, 4, 4)))) == 0
    assert len(arm().ik_path([])) == 0


def test_a_progress_bar_goes_to_standard_error(capsys: pytest.CaptureFixture[str]) -> None:
    robot = arm()
    T = robot.fk_batch([[10.0, -80.0, 70.0, 20.0, 40.0, 30.0]] * 3)
    assert robot.ik_batch(T, progress=True).success.all()
    assert robot.ik_path(T, progress=True).success.all()
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("compiled", [True, False])
def test_an_axis_held_outside_its_limits_is_no_success(compiled: bool) -> None:
    robot, options = arm(), IkOptions(compiled=compiled)
    T = robot.fk_batch([[175.0, -90.0, 90.0, 0.0, 30.0, 0.0]] * 2)
    single = robot.ik(T[0], held={"A1": 175.0}, solver="damped", options=options)
    assert (single.success, single.status, single.violated) == (False, "limits", ("A1",))
    assert single.reason == "an axis is held outside its limits: A1 is 175, outside -170 … 170 deg"
    assert robot.ik_batch(T, held={"A1": 175.0}, options=options).status == ["limits"] * 2
    assert robot.ik_path(T, held={"A1": 175.0}, options=options).status == ["limits"] * 2


@pytest.mark.parametrize("compiled", [True, False])
def test_answers_keep_the_limits_to_the_last_digit(compiled: bool) -> None:
    robot, rng = arm(), np.random.default_rng(9)
    lower, upper = (np.array([getattr(axis, end) for axis in robot.axes]) for end in ("lower", "upper"))
    axes = np.array([random_axes(robot, rng) for _ in range(100)])
    axes = np.where(rng.random(axes.shape) < 0.4, np.where(rng.random(axes.shape) < 0.5, lower, upper), axes)
    found = robot.ik_batch(robot.fk_batch(axes), options=IkOptions(compiled=compiled))
    assert found.success.mean() > 0.9
    assert ((found.axes >= lower) & (found.axes <= upper))[found.success].all()
