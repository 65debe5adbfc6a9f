"""Inside the limits: every question gets the same answer, for axes and for sums of axes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from chainbuild import IkOptions, Robot, tolerances
from chainbuild.ik.solve import SOLVERS

SLACK = tolerances.LIMIT_SLACK


@pytest.fixture(scope="module")
def heavy() -> Robot:
    return Robot.load("parallelogram_nr")


def at_the_edge(robot: Robot, beyond_deg: float) -> np.ndarray:
    """Return axis values that put the sum A2 + A3 so far beyond its upper limit."""
    (limit,) = robot.chain.constraints
    assert limit.sum.coefficients[1:3] == (1.0, 1.0)
    axes = np.array([10.0, 20.0, 0.0, 30.0, 40.0, 50.0])
    axes[2] = limit.upper + beyond_deg - limit.sum.value(axes)
    return axes


def answers(robot: Robot, axes: np.ndarray) -> dict[str, bool]:
    """Return by name whether each way to ask finds these axis values inside the limits."""
    T = robot.fk(axes)

    def here(found: np.ndarray) -> bool:
        return bool(np.abs(found - axes).max() < 1e-5)

    said = {"violated_limits": robot.violated_limits(axes) == ()}
    for solver in SOLVERS:
        if solver != "controller":
            found = robot.ik(T, axes, solver=solver)
            said[f"ik {solver}"] = found.success and here(found.axes)
    plain = robot.ik(T, axes, options=IkOptions(compiled=False))
    said["ik plain"] = plain.success and here(plain.axes)
    said["ik_all"] = any(here(row) for row in robot.ik_all(T, axes).axes)
    said["ik_all_batch"] = bool((np.abs(robot.ik_all_batch([T])[0] - axes).max(axis=1) < 1e-5).any())
    for compiled in (True, False):
        rows = robot.ik_all_batch([T], compiled=compiled)[0]
        said[f"ik_all_batch compiled={compiled}"] = bool((np.abs(rows - axes).max(axis=1) < 1e-5).any())
    row = robot.ik_batch([T], axes)[0]
    said["ik_batch"] = row.success and here(row.axes)
    return said


@pytest.mark.parametrize("beyond_deg", [-1e-3, 0.0, 5e-8, 0.5 * SLACK])
def test_a_sum_on_its_limit_is_inside_for_all(heavy: Robot, beyond_deg: float) -> None:
    said = answers(heavy, at_the_edge(heavy, beyond_deg))
    assert all(said.values()), said


def test_a_sum_beyond_its_limit_is_outside_for_all(heavy: Robot) -> None:
    said = answers(heavy, at_the_edge(heavy, 0.01))
    assert not any(said.values()), said


@pytest.mark.parametrize(("beyond_deg", "inside"), [(0.0, True), (5e-8, True), (0.5 * SLACK, True), (0.01, False)])
def test_an_axis_at_its_limit(beyond_deg: float, inside: bool) -> None:
    robot = Robot.load("kr6r900")
    axes = np.array([10.0, robot.axes[1].upper + beyond_deg, 0.0, 30.0, 40.0, 50.0])
    said = answers(robot, axes)
    assert set(said.values()) == {inside}, said


def test_what_is_handed_out_stands_on_the_limit() -> None:
    robot = Robot.load("kr6r900")
    upper = robot.axes[1].upper
    axes = np.array([10.0, upper + 0.5 * SLACK, 0.0, 30.0, 40.0, 50.0])
    T = robot.fk(axes)
    handed_out = [robot.ik(T, axes, solver=solver).axes for solver in ("auto", "damped", "analytic")]
    handed_out += [*robot.ik_all(T, axes).axes, *robot.ik_batch([T], axes).axes]
    assert len(handed_out) > 4
    assert all(row[1] <= upper for row in handed_out)


def test_the_slack_is_the_same_in_si() -> None:
    robot = Robot.load("irb2600_track")
    track = next(n for n, axis in enumerate(robot.axes) if axis.kind == "linear")
    for n, axis in enumerate(robot.axes):
        values = np.zeros(len(robot.axes))
        values[n] = axis.upper + 0.9 * SLACK
        assert n not in robot.limits.outside(values)
        values[n] = axis.upper + 1.1 * SLACK
        assert robot.limits.outside(values) == [n]
        assert robot.violated_limits(values)[0] == axis.name
    assert robot.kinematics.si_factors[track] == 1e-3


def test_an_endless_axis_has_no_limit() -> None:
    robot = Robot.load("kr6r900")
    axes = (*robot.axes[:5], replace(robot.axes[5], endless=True))
    endless = Robot(robot.chain.with_axes(axes))
    assert endless.violated_limits([0.0, 0.0, 0.0, 0.0, 0.0, 9999.0]) == ()
    assert robot.violated_limits([0.0, 0.0, 0.0, 0.0, 0.0, 9999.0]) == ("A6",)
