"""Axis values in metres and radians where they are asked for: the same answers as in mm and degrees."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import chainbuild
from chainbuild import AxisValueError, ChainbuildError, Robot
from chainbuild.units import AxisLabels

# Linear and rotary axes; held axes, coupled axes.
MACHINES = ("ac_table_kin58", "irb2600_track", "scara_cc", "gantry_robot_kin210")


@pytest.fixture(scope="module", params=MACHINES)
def robot(request: pytest.FixtureRequest) -> Robot:
    return Robot.load(request.param)


def some_axes(robot: Robot, rows: int = 6) -> Any:
    rng = np.random.default_rng(3)
    lower = np.array([max(axis.lower, -500.0 if axis.kind == "linear" else -100.0) for axis in robot.axes])
    upper = np.array([min(axis.upper, 500.0 if axis.kind == "linear" else 100.0) for axis in robot.axes])
    return lower + (upper - lower) * rng.uniform(0.3, 0.7, (rows, len(lower)))


def si(robot: Robot) -> Any:
    return np.array([1e-3 if axis.kind == "linear" else np.pi / 180.0 for axis in robot.axes])


def test_forward_and_jacobian(robot: Robot) -> None:
    rows, factors = some_axes(robot), si(robot)
    for axes in rows:
        T = robot.fk(axes * factors, units="si")
        np.testing.assert_allclose(T.homogeneous, robot.fk(axes).homogeneous, atol=1e-12)
        for frame in ("tool", "workpiece"):
            J = robot.jacobian(axes * factors, frame, units="si")
            np.testing.assert_allclose(J, robot.jacobian(axes, frame), atol=1e-12)
    np.testing.assert_allclose(robot.fk_batch(rows * factors, units="si"), robot.fk_batch(rows), atol=1e-12)
    np.testing.assert_array_equal(robot.fk_batch(rows, units="controller"), robot.fk_batch(rows))


def test_the_jacobian_is_the_derivative_by_si_values(robot: Robot) -> None:
    x = some_axes(robot, 1)[0] * si(robot)
    J = robot.jacobian(x, "workpiece", units="si")
    for n in range(len(x)):
        step = np.eye(len(x))[n] * 1e-6
        ahead, behind = robot.fk(x + step, units="si"), robot.fk(x - step, units="si")
        np.testing.assert_allclose((ahead.translation - behind.translation) / 2e-6, J[:3, n], atol=1e-6)


def test_inverse(robot: Robot) -> None:
    factors, held = si(robot), {axis.name for axis in robot.axes if axis.held}
    for axes in some_axes(robot):
        T, start = robot.fk(axes), axes + np.where([axis.name in held for axis in robot.axes], 0.0, 1.0)
        shown, found = robot.ik(T, start), robot.ik(T, start * factors, units="si")
        assert (shown.units, found.units, found.status) == ("controller", "si", shown.status)
        np.testing.assert_allclose(found.axes, shown.axes * factors, atol=1e-9)
        if shown.success:
            np.testing.assert_allclose(robot.fk(found.axes, units="si").homogeneous, T.homogeneous, atol=1e-5)
        back = found.to("controller")
        np.testing.assert_allclose(back.axes, shown.axes, atol=1e-6)
        assert found.to("si") is found


def test_held_values_are_in_the_units_asked_for() -> None:
    robot = Robot.load("irb2600_track")
    factors = dict(zip((axis.name for axis in robot.axes), si(robot), strict=True))
    inputs = [axis.name for axis in robot.axes if axis.held] or [robot.axes[0].name]
    axes = some_axes(robot, 1)[0]
    values = {name: float(axes[[a.name for a in robot.axes].index(name)]) for name in inputs}
    in_si = {name: value * factors[name] for name, value in values.items()}
    T = robot.fk(axes)
    shown = robot.ik(T, axes, held=values)
    for held in (in_si, list(in_si.values())) if any(axis.held for axis in robot.axes) else (in_si,):
        found = robot.ik(T, axes * si(robot), held=held, units="si")
        np.testing.assert_allclose(found.axes, shown.axes * si(robot), atol=1e-9)
    with pytest.raises(AxisValueError, match="no axis 'Q7'"):
        robot.ik(T, held={"Q7": 1.0}, units="si")
    with pytest.raises(AxisValueError, match="is held at 'x'"):
        robot.ik(T, held={inputs[0]: "x"}, units="si")  # type: ignore[dict-item]
    with pytest.raises(AxisValueError, match="held"):
        robot.ik(T, held=[1.0] * 9, units="si")
    with pytest.raises(AxisValueError):
        robot.ik(T, held={inputs[0]: 10**5000}, units="si")


def test_tables_and_branches() -> None:
    for name in ("ac_table_kin58", "kr6r900"):
        robot = Robot.load(name)
        rows, factors = some_axes(robot, 5), si(robot)
        poses = robot.fk_batch(rows)
        for shown, found in (
            (robot.ik_batch(poses, rows), robot.ik_batch(poses, rows * factors, units="si")),
            (robot.ik_batch(poses, rows[0]), robot.ik_batch(poses, rows[0] * factors, units="si")),
            (robot.ik_path(poses, rows[0]), robot.ik_path(poses, rows[0] * factors, units="si")),
            (robot.ik_all(poses[0], rows[0]), robot.ik_all(poses[0], rows[0] * factors, units="si")),
        ):
            np.testing.assert_allclose(found.axes, shown.axes * factors, atol=1e-9)
            assert (found.units, found[0].units, shown.units) == ("si", "si", "controller")
            np.testing.assert_allclose(found[0].axes, found.axes[0])


def test_arrays_of_branches() -> None:
    robot = Robot.load("kr6r900")
    poses = robot.fk_batch(some_axes(robot, 5))
    found = robot.ik_all_batch(poses, units="si")
    np.testing.assert_allclose(found, np.radians(robot.ik_all_batch(poses)))
    np.testing.assert_array_equal(found, chainbuild.ik_all_batch(robot, poses, units="si"))


def test_rows_that_failed_say_the_same_in_both_units() -> None:
    robot = Robot.load("kr6r900")
    far, outside = np.eye(4), robot.fk([0.0, -90.0, 170.0, 0.0, 10.0, 0.0]).homogeneous
    far[:3, 3] = 9.0, 0.0, 0.0
    poses = np.array([far, outside, robot.fk([10.0, -80.0, 70.0, 20.0, 40.0, 30.0]).homogeneous])
    shown, found = robot.ik_batch(poses), robot.ik_batch(poses, units="si")
    assert found.reasons() == shown.reasons()
    assert found.to("controller").reasons() == shown.reasons()
    row = robot.ik_batch(poses, units="si")[0]
    assert (row.to("controller").reason, row.units) == (shown[0].reason, "si")
    assert pickle.loads(pickle.dumps(found[2])).units == "si"


@pytest.mark.parametrize("units", ["SI", "mm", "", None, 5, b"si", ["si"], np.array(["si", "si"])[:1]])
def test_unknown_units_are_answered_by_the_known_ones(units: Any) -> None:
    robot = Robot.load("kr6r900")
    axes, T = [10.0, -80.0, 70.0, 20.0, 40.0, 30.0], robot.fk([10.0, -80.0, 70.0, 20.0, 40.0, 30.0])
    calls = (
        lambda: robot.fk(axes, units=units),
        lambda: robot.fk_batch([axes], units=units),
        lambda: robot.jacobian(axes, units=units),
        lambda: robot.ik(T, units=units),
        lambda: robot.ik_all(T, units=units),
        lambda: robot.ik_batch([T], units=units),
        lambda: robot.ik_path([T], units=units),
        lambda: robot.ik_all_batch([T], units=units),
        lambda: robot.ik(T).to(units),
    )
    for call in calls:
        with pytest.raises(ChainbuildError, match="permitted: controller, si") as caught:
            call()
        assert caught.value.parameter == "units"


@pytest.mark.parametrize("axes", [[0.0], "x", None, [[0.0] * 6], np.full(6, np.nan), [10**400] * 6])
def test_bad_values_are_refused_in_si_as_well(axes: Any) -> None:
    robot = Robot.load("kr6r900")
    with pytest.raises(AxisValueError):
        robot.fk(axes, units="si")


def test_values_handed_over_are_left_alone() -> None:
    robot = Robot.load("kr6r900")
    axes = np.array([0.1, -1.0, 1.0, 0.2, 0.3, 0.1])
    before = axes.copy()
    T = robot.fk(axes, units="si")
    robot.jacobian(axes, units="si")
    robot.ik(T, axes, units="si")
    robot.ik_batch([T], axes, units="si")
    assert np.array_equal(axes, before)


def test_labels() -> None:
    labels = AxisLabels(("X", "C"), ("linear", "rotary"))
    assert labels.units_of_axes == ("mm", "deg")
    assert labels.to("si").units_of_axes == ("m", "rad")
    assert labels.factors == (1.0, 1.0)
    assert labels.to("controller") is labels
    assert labels.to("si").to("controller") == labels
