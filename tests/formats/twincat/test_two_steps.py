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
