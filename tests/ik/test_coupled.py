"""The angle of a parallelogram: no answer violates it, and a motion may retract into it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.sums import AxisConstraint, AxisSum
from chainbuild.ik.request import IkRequest
from chainbuild.ik.result import IkResult
from chainbuild.ik.solve import keeping_sums
from chainbuild.robot import Robot
from tests.kit.draws import random_axes


@pytest.fixture(scope="module")
def heavy() -> Robot:
    return chainbuild.Robot.load("parallelogram_nr")


def test_the_machine_watches_the_angle_of_its_elbow(heavy: Robot) -> None:
    (limit,) = heavy.chain.constraints
    assert (limit.lower, limit.upper, limit.alarm) == (30.0, 150.0, 75329)
    assert "CB322" not in {finding.code for finding in heavy.chain.findings}
    names = [joint.name for joint in heavy.chain.joints]
    assert names[1:3] == ["A2", "A3"]
    # Upper arm from axis 2 to axis 3, forearm along X of P3: the angle between them by geometry alone.
    shoulder, elbow = _joint_place(heavy, "A2"), _joint_place(heavy, "A3")
    upper, fore = elbow[0] - shoulder[0], elbow[1][:, 0]
    cosine = float(-upper @ fore / np.linalg.norm(upper))
    assert np.degrees(np.arccos(cosine)) == pytest.approx(limit.sum.value([0.0, 40.0, -100.0, 0.0, 0.0, 0.0]))


def _joint_place(robot: Robot, name: str) -> tuple[np.ndarray, np.ndarray]:
    robot.fk([0.0, 40.0, -100.0, 0.0, 0.0, 0.0])
    M = robot.kinematics.data.oMi[robot.model.getJointId(name)]
    return M.translation.copy(), M.rotation.copy()


def test_no_answer_violates_it(heavy: Robot) -> None:
    rng = np.random.default_rng(8)
    refused = 0
    for _ in range(400):
        axes = random_axes(heavy, rng)
        found = heavy.ik(heavy.fk(axes), axes)  # half of the starts stand outside the parallelogram's limit
        if found.success:
            assert heavy.limits.broken_sums(found.axes) == ()
            assert heavy.violated_limits(found.axes) == ()
        else:
            refused += 1
            assert heavy.limits.broken_sums(axes), "a pose with an answer inside was refused"
            assert found.status == "limits"
    assert refused > 20


def test_the_refusal_names_the_limit(heavy: Robot) -> None:
    axes = [0.0, 60.0, -16.0, 170.0, 100.0, 0.0]  # no other branch folds the elbow within the axes' limits
    assert heavy.violated_limits(axes) == ("parallelogram angle",)
    for solver in ("auto", "damped", "controller"):
        found = heavy.ik(heavy.fk(axes), axes, solver=solver)
        assert (found.success, found.status) == (False, "limits"), solver
        assert "parallelogram angle" in found.reason


def test_an_answer_that_a_solver_lets_through_is_refused(heavy: Robot) -> None:
    axes = np.array([0.0, 60.0, -16.0, 170.0, 100.0, 0.0])
    request = IkRequest.of(heavy, heavy.fk(axes), axes)
    careless = IkResult(True, axes, "ok", 0.0, 0.0, 1, 0, "pose", heavy.labels)
    refused = keeping_sums(request, careless, "damped")
    assert (refused.success, refused.status) == (False, "limits")
    assert "parallelogram angle (alarm 75329)" in refused.reason
    inside = replace(careless, axes=np.array([0.0, 0.0, -90.0, 0.0, 40.0, 0.0]))
    assert keeping_sums(request, inside, "damped") is inside


def test_another_branch_is_taken_where_there_is_one(heavy: Robot) -> None:
    axes = np.array([0.0, 70.0, -20.0, 0.0, 0.0, 0.0])
    assert heavy.limits.broken_sums(axes)
    found = heavy.ik(heavy.fk(axes), axes)
    assert found.success
    assert heavy.limits.broken_sums(found.axes) == ()


def test_retracting() -> None:
    limit = AxisConstraint("angle", AxisSum((1.0, 1.0), 180.0), 30.0, 150.0, 75329)
    outside, further, nearer, inside, beyond = [-100.0, -60.0], [-100.0, -61.0], [-100.0, -55.0], [0.0, -90.0], [0, -20]
    assert limit.margin(outside) == pytest.approx(-10.0)
    assert limit.allows(outside, inside)
    assert limit.allows(outside, nearer)
    assert not limit.allows(outside, further)
    assert not limit.allows(outside, outside)
    assert limit.allows(inside, inside)
    assert not limit.allows(inside, outside)
    assert limit.allows(beyond, [0.0, -30.0])  # onto the limit itself
