"""Transformations of two steps: step 1 takes what step 0 makes of the axes for its own axis values."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from chainbuild.chain.elements import Chain
from chainbuild.errors import UnsupportedKinematicError
from chainbuild.frames import angles_from_matrix
from chainbuild.robot import Robot
from tests.kit.twincat_files import codes, machine, pose
from tests.kit.universal import CA_HEAD

AC_TABLE = ["id 58", "param[0] 1500000", "param[5] 600000", "param[8] -5000000", "param[9] 100000"]
CA_HEAD_9 = ["id 9", "param[0] 1200000", "param[1] 800000", "param[4] 30000"]
ARM = ["id 45", "param[6] 4000000", "param[7] 4550000", "param[8] 4200000", "param[9] 900000", "param[10] 250000"]


def both(first: Sequence[str], second: Sequence[str], *more: str) -> Chain:
    lines = [f"kin_step[0].trafo[0].{line}" for line in first] + [f"kin_step[1].trafo[0].{line}" for line in second]
    ids = [line.split()[1] for line in (first[0], second[0])]
    defaults = [f"default_id_of_kin_step[{n}] {number}" for n, number in enumerate(ids)]
    return machine("\n".join([*lines, *defaults, *more])).chain()


def alone(lines: Sequence[str], *more: str) -> Chain:
    return machine("\n".join([*(f"trafo[0].{line}" for line in lines), *more])).chain()


@pytest.mark.parametrize(("first", "second"), [(AC_TABLE, CA_HEAD_9), (CA_HEAD_9, AC_TABLE)])
def test_machine_angles_pass_through(first: Sequence[str], second: Sequence[str]) -> None:
    chain, below, above = both(first, second), alone(first), alone(second)
    assert codes(chain) == ["CB459", "CB465"]
    assert [axis.name for axis in chain.axes] == [axis.name for axis in below.axes]
    rng = np.random.default_rng(1)
    for _ in range(50):
        axes = rng.uniform(-100, 100, 5)
        coordinates = [*pose(below, axes)[:3, 3], *axes[3:]]
        assert pose(chain, axes) == pytest.approx(pose(above, coordinates), abs=1e-8)


@pytest.mark.parametrize("mode", [0, 3, 4])
def test_a_robot_below_gives_a_pose(mode: int) -> None:
    angle = f"ori_rotation_angle {mode}"
    chain, below, above = both(ARM, CA_HEAD_9, angle), alone(ARM, angle), alone(CA_HEAD_9)
    rng = np.random.default_rng(2)
    for _ in range(30):
        axes = rng.uniform(-80, 80, 6)
        T = pose(below, axes)
        coordinates = [*T[:3, 3], *angles_from_matrix(below.angle_mode, T[:3, :3])]
        assert pose(chain, axes) == pytest.approx(pose(above, coordinates[:5]), abs=1e-8)


@pytest.mark.parametrize(("first", "second"), [(AC_TABLE, CA_HEAD_9), (ARM, CA_HEAD_9)])
def test_the_derivative_is_one(first: Sequence[str], second: Sequence[str]) -> None:
    robot = Robot(both(first, second))
    rng = np.random.default_rng(3)
    factors = np.array([1e-3 if axis.kind == "linear" else np.pi / 180 for axis in robot.axes])
    for _ in range(10):
        axes = rng.uniform(-60, 60, len(factors))
        J, step = robot.jacobian(axes), 1e-6
        T = robot.fk(axes)
        for n in range(len(factors)):
            ahead, behind = axes.copy(), axes.copy()
            ahead[n] += step / factors[n]
            behind[n] -= step / factors[n]
            velocity = T.rotation.T @ (robot.fk(ahead).translation - robot.fk(behind).translation) / (2 * step)
            assert velocity == pytest.approx(J[:3, n], abs=1e-6)


@pytest.mark.parametrize(("first", "second"), [(AC_TABLE, CA_HEAD_9), (CA_HEAD_9, AC_TABLE), (ARM, CA_HEAD_9)])
def test_there_and_back(first: Sequence[str], second: Sequence[str]) -> None:
    chain = both(first, second)
    robot = Robot(chain)
    rng = np.random.default_rng(4)
    for _ in range(10):
        axes = rng.uniform(-60, 60, len(chain.axes))
        q = robot.q(axes)
        assert robot.q(robot.axes_from_q(q))[:3] == pytest.approx(q[:3], abs=1e-8)
        lower, upper = robot.model.lowerPositionLimit, robot.model.upperPositionLimit
        assert (q >= lower).all()
        assert (q <= upper).all()
        found = robot.ik(robot.fk(axes), start=axes + 1.0)
        assert found.success
        assert np.abs(robot.fk(found.axes).translation - robot.fk(axes).translation).max() < 2e-6


def test_a_universal_kinematic_below() -> None:
    universal = [line.removeprefix("trafo[0].") for line in CA_HEAD.lines()]
    chain = both(universal, AC_TABLE)
    axes = [10.0, 20.0, 30.0, 40.0, 50.0]
    below = machine("\n".join(CA_HEAD.lines())).chain()
    assert pose(chain, axes) == pytest.approx(pose(alone(AC_TABLE), [*pose(below, axes)[:3, 3], 40, 50]), abs=1e-8)
    complete = [line.replace("rtcp 1", "rtcp 0") for line in universal]
    with pytest.raises(UnsupportedKinematicError, match="complete transformation cannot precede"):
        both(complete, AC_TABLE)


def test_one_of_the_two_can_still_be_chosen() -> None:
    lines = [*(f"trafo[0].{line}" for line in AC_TABLE), *(f"kin_step[1].trafo[0].{line}" for line in CA_HEAD_9)]
    text = "\n".join([*lines, "default_id_of_kin_step[0] 58", "default_id_of_kin_step[1] 9"])
    assert machine(text).chain(58).kinematic == "KIN_TYP 58"
    assert machine(text).chain(9).kinematic == "KIN_TYP 9"
    assert machine(text).chain().kinematic == "KIN_TYP 58 below KIN_TYP 9"


def test_steps_that_do_not_fit() -> None:
    with pytest.raises(UnsupportedKinematicError, match="takes mm mm mm deg deg, KIN_TYP 14 gives mm mm mm") as caught:
        both(["id 14"], CA_HEAD_9)
    assert caught.value.code == "CB460"


@pytest.mark.parametrize("turns", [-720.0, -270.0, 190.0, 350.0, 710.0])
def test_turns_of_the_axes_come_back(turns: float) -> None:
    chain = both(AC_TABLE, CA_HEAD_9)
    axes = np.array([10.0, 20.0, 30.0, turns, turns / 2.0])
    assert chain.axis_map.axes(chain.axis_map.q(axes)) == pytest.approx(axes, abs=1e-8)


@pytest.mark.parametrize("turns", [-2, -1, 1, 3])
def test_pose_angles_are_found_whatever_their_turns(turns: int) -> None:
    """A robot below knows its pose angles up to whole turns only; those of the joints may be on another."""
    chain = both(ARM, CA_HEAD_9)
    axes = np.array([10.0, 20.0, -30.0, 40.0, 50.0, 60.0])
    q = chain.axis_map.q(axes)
    rotary = [joint.kind == "revolute" for joint in chain.joints]
    assert sum(rotary) == 2
    found = chain.axis_map.axes(q + 2.0 * np.pi * turns * np.array(rotary))
    assert chain.axis_map.q(found) == pytest.approx(q, abs=1e-8)


@pytest.mark.parametrize(("first", "second"), [(AC_TABLE, CA_HEAD_9), (CA_HEAD_9, AC_TABLE), (ARM, CA_HEAD_9)])
def test_every_row_of_the_map_is_the_derivative(first: Sequence[str], second: Sequence[str]) -> None:
    chain = both(first, second)
    factors = np.array([1e-3 if axis.kind == "linear" else np.pi / 180 for axis in chain.axes])
    rng = np.random.default_rng(5)
    for _ in range(5):
        axes = rng.uniform(-50.0, 50.0, len(factors))
        J = chain.axis_map.dq_daxes(axes)
        for n, factor in enumerate(factors):
            step = np.zeros(len(factors))
            step[n] = 1e-6 / factor
            slope = (chain.axis_map.q(axes + step) - chain.axis_map.q(axes - step)) / 2e-6
            assert slope == pytest.approx(J[:, n], abs=1e-6)


def test_bounds_of_the_angles_that_are_passed_on() -> None:
    """Axes keep their limits, pose angles have half a turn either way; neither is taken for a length."""
    through = both(AC_TABLE, CA_HEAD_9)
    lower, upper = np.array([-1.0, -1.0, -1.0, -20.0, -30.0]), np.array([1.0, 1.0, 1.0, 40.0, 50.0])
    low, high = through.axis_map.q_bounds(lower, upper)
    rotary = np.array([joint.kind == "revolute" for joint in through.joints])
    assert sorted(np.degrees(low[rotary])) == pytest.approx([-30.0, -20.0])
    assert sorted(np.degrees(high[rotary])) == pytest.approx([40.0, 50.0])
    above = both(ARM, CA_HEAD_9)
    low, high = above.axis_map.q_bounds(np.full(6, -10.0), np.full(6, 10.0))
    rotary = np.array([joint.kind == "revolute" for joint in above.joints])
    assert np.degrees(low[rotary]) == pytest.approx([-180.0, -180.0])
    assert np.degrees(high[rotary]) == pytest.approx([180.0, 180.0])
    # As far as the arm reaches: 0.4 + 0.455 + 0.42 + 0.09 + 0.025 m is more than it can be.
    assert (high[~rotary] > 0.8).all()
    assert (high[~rotary] < 2.0).all()
    assert (low[~rotary] < -0.8).all()
