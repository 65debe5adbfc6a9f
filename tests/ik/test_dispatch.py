"""One door to the solvers: auto, damped, analytic, controller."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from chainbuild.chain.elements import ControllerSolver
from chainbuild.chain.sums import AxisSum
from chainbuild.errors import ChainbuildError
from chainbuild.ik import solve as dispatch
from chainbuild.ik.branches import every
from chainbuild.ik.result import IkResult
from chainbuild.robot import Robot
from tests.kit.robots import arm

AXES = np.array([10.0, -80.0, 70.0, 20.0, 40.0, 30.0])


def granted(max_count: int = 8, precision: float = 1e-6, limit2_deg: float = 0.0) -> ControllerSolver:
    return ControllerSolver(max_count, precision, 3.0, limit2_deg, AxisSum((0.0, 0.0, 0.0, 0.0, 1.0, 0.0), 0.0))


@pytest.mark.parametrize("solver", ["auto", "damped", "analytic"])
def test_each_solver_finds_the_pose(solver: str) -> None:
    robot = arm()
    found = robot.ik(robot.fk(AXES), AXES + 2.0, solver=solver)
    assert found.success
    np.testing.assert_allclose(found.axes, AXES, atol=1e-6)


def test_an_unknown_solver_is_refused() -> None:
    with pytest.raises(ChainbuildError, match=r"unknown solver 'best'.*auto, damped, analytic, controller"):
        arm().ik(np.eye(4), solver="best")


def test_a_chain_without_budget_says_so() -> None:
    with pytest.raises(ChainbuildError, match="give no iteration budget for the controller's solver"):
        arm().ik(np.eye(4), solver="controller")


def test_auto_asks_the_closed_form_where_damping_finds_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = arm()

    def nothing(*_: object) -> IkResult:
        return IkResult(False, AXES, "stalled", 1.0, 1.0, 0, 0, "pose", robot.labels, "gave up")

    monkeypatch.setattr(dispatch, "search", nothing)
    assert robot.ik(robot.fk(AXES), AXES).success
    assert not robot.ik(robot.fk(AXES), AXES, solver="damped").success
    far = robot.fk(AXES)
    far.translation = np.array([9.0, 0.0, 0.0])
    assert robot.ik(far, AXES).reason == "gave up"


def test_outside_the_limits_nothing_is_computed_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compiled code is sure that no branch is inside: the plain closed form would add nothing to the search."""
    pytest.importorskip("numba")
    robot = arm()
    outside = robot.fk(AXES + np.array([0.0, 0.0, 0.0, 0.0, 95.0, 0.0]))  # both ways of the wrist are beyond A5
    assert len(robot.ik_all(outside)) == 0
    damped = robot.ik(outside, AXES, solver="damped")
    assert robot.ik(outside, AXES, solver="analytic").status == "limits"  # which says why

    def refused(*_: object) -> object:
        raise AssertionError("the plain closed form was asked")

    monkeypatch.setattr(every, "every_branch", refused)
    found = robot.ik(outside, AXES)
    assert (found.status, found.reason) == (damped.status, damped.reason)
    with pytest.raises(AssertionError, match="plain closed form"):
        robot.ik(outside, AXES, solver="analytic")


def test_every_branch_through_the_robot() -> None:
    robot = arm()
    found = robot.ik_all(robot.fk(AXES), AXES)
    np.testing.assert_allclose(found[0].axes, AXES, atol=1e-9)
    assert len(found) > 2


def test_the_controllers_budget() -> None:
    target = arm().fk(AXES)

    def by_budget(start: np.ndarray, budget: ControllerSolver) -> IkResult:
        return Robot(replace(arm().chain, controller_solver=budget)).ik(target, start, solver="controller")

    near = by_budget(AXES + 1.0, granted())
    assert near.success
    assert 0 < near.iterations <= 8
    np.testing.assert_allclose(near.axes, AXES, atol=1e-4)
    short = by_budget(AXES + 20.0, granted(max_count=1))
    assert (short.success, short.status, short.iterations) == (False, "stalled", 1)
    assert "budget of 1 iterations" in short.reason
    singular = by_budget(AXES + 1.0, granted(limit2_deg=45.0))
    assert singular.status == "limits"
    assert "75370" in singular.reason
