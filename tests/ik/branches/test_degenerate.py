"""Random degenerate chains: a pose that axis values make has branches, and what these say of families is true."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

from chainbuild.ik.branches.core.branches import Branch, Branches
from chainbuild.ik.plan import TASK_ROWS
from chainbuild.robot import Robot
from tests.kit.compare import same_turns
from tests.kit.degenerate import Case, degenerate_case

COUNT = 1260
# Poses that had no branch: a point on several axes, slides on one line, a double root, curves of several kinds.
CAUSES = (106, 155, 332, 336, 450, 488, 565, 642, 684, 715, 837, 1183)
REGULAR = 1e-4  # smallest singular value of the task's Jacobian [m, rad] at which axes have six digits


def residual(robot: Robot, case: Case):
    """Return the function from SI axis values to what is left to the pose and its Jacobian."""
    return robot.kinematics.residual(robot.fk(case.axes), robot.task)


def is_redundant(robot: Robot) -> bool:
    return len(robot.axes) > TASK_ROWS[robot.task]


def solutions_at(robot: Robot, case: Case, branch: Branch, row: np.ndarray, way: float) -> float:
    """Return how far the pose is missed at the best place so far along a direction, as scipy finds it."""
    left, start = residual(robot, case), branch.to("si").axes
    goal = start + way * row

    def off(x: np.ndarray) -> np.ndarray:
        return np.append(left(x)[0], row @ (x - goal))

    return float(np.abs(least_squares(off, goal, xtol=1e-15, ftol=1e-15, gtol=1e-15).fun).max())


def check(seed: int) -> Branches | None:
    case = degenerate_case(seed)
    robot, axes = case.robot, case.axes
    target = robot.fk(axes)
    if is_redundant(robot) and robot.plan().name == "search":
        with pytest.raises(Exception, match="infinitely many"):
            robot.ik_all(target)
        return None
    found = robot.ik_all(target)
    assert len(found), case.text
    for branch in found:
        assert np.abs(residual(robot, case)(branch.to("si").axes)[0]).max() < 1e-6, case.text
        sides = [
            [solutions_at(robot, case, branch, row, way) for way in (0.02, -0.02)] for row in branch.free_directions
        ]
        assert all(min(misses) < 1e-9 for misses in sides), case.text
        np.testing.assert_allclose(np.linalg.norm(branch.free_directions, axis=1), 1.0)
    sizes = np.linalg.svd(residual(robot, case)(axes * robot.kinematics.si_factors)[1], compute_uv=False)
    if not is_redundant(robot) and len(sizes) == len(axes) and sizes[-1] > REGULAR:
        assert any(same_turns(robot, branch.axes, axes, 1e-4) for branch in found), case.text
    return found


@pytest.mark.parametrize("seed", [*range(12), *CAUSES])
def test_a_degenerate_chain_has_branches(seed: int) -> None:
    check(seed)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, COUNT, 60))
def test_every_degenerate_chain_has_branches(first: int) -> None:
    for seed in range(first, first + 60):
        check(seed)


def test_the_chains_are_degenerate_in_all_ways() -> None:
    cases = [degenerate_case(seed) for seed in range(60)]
    assert {len(case.axes) for case in cases} == {3, 4, 5, 6}
    assert {case.robot.task for case in cases} == {"pose", "direction", "position"}
    assert {"search", "direct", "position", "single wrist axis", "elimination"} <= {c.robot.plan().name for c in cases}
    lost = 0
    for case in cases:
        J = residual(case.robot, case)(case.axes * case.robot.kinematics.si_factors)[1]
        lost += bool(np.linalg.svd(J, compute_uv=False)[-1] < 1e-9)
    assert lost > 20


def test_narrow_limits_leave_what_is_inside() -> None:
    """The start of a curve's member is inside limits: the joint that is held there stands between them."""
    case = degenerate_case(118)
    limits = tuple(replace(axis, lower=-200.0, upper=200.0) for axis in case.robot.axes)
    robot = Robot(replace(case.robot.chain, axes=limits))
    found = robot.ik_all(robot.fk(case.axes))
    assert len(found)
    assert not any(robot.limits.violated(branch.axes) for branch in found)
