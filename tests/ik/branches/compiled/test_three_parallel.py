"""Three parallel axes compiled: the sets of the plain solver at every pose it is sure of, doubt where it must be."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from chainbuild.arrays import Matrix, Vector
from chainbuild.ik.branches.arms.parallel_axes import parallel_arm, three_parallel_constants
from chainbuild.ik.branches.arms.three_parallel import ThreeParallelAxes
from chainbuild.ik.branches.compiled.constants import DOUBTFUL, ROWS
from chainbuild.ik.branches.compiled.entries import FORMS
from chainbuild.ik.branches.core.serial import Serial
from chainbuild.tolerances import ROTATION_MATRIX
from tests.kit.parallel_arms import (
    MADE,
    WRISTS,
    apart,
    made_arm,
    pose_by_hand,
    random_parallel_arm,
    same_solutions,
    smallest_singular_value,
    solutions,
    unit,
    with_signs,
)

NOTHING = (0.0,) * 6


def compiled(serial: Serial, targets: list[Matrix]) -> list[list[Vector] | None]:
    """Return the joint values of poses, None where the compiled form is not sure."""
    constants = three_parallel_constants(serial)
    assert constants is not None
    values, counts = np.full((len(targets), ROWS, 6), np.nan), np.empty(len(targets), np.int64)
    FORMS["three parallel axes"](constants, np.array(targets), ROTATION_MATRIX, values, counts)
    return [None if n == DOUBTFUL else list(rows[:n]) for rows, n in zip(values, counts.tolist(), strict=True)]


def plain(serial: Serial, T: Matrix) -> list[Vector]:
    arm = parallel_arm(serial)
    assert arm is not None
    return solutions(serial, T, (values for values, _ in ThreeParallelAxes(arm).solve(T, NOTHING)[0]))


def right_with(serial: Serial, q: Vector) -> list[Vector]:
    """Return what the plain solver finds where it keeps the values."""
    arm = parallel_arm(serial)
    assert arm is not None
    return [values for values, _ in ThreeParallelAxes(arm).solve(pose_by_hand(serial, q), q.tolist())[0]]


def compared(serial: Serial, values: Matrix) -> int:
    """Compare the branches of the poses of joint values (n, 6) with the plain solver; return of how many it is sure."""
    targets = [pose_by_hand(serial, q) for q in values]
    found = compiled(serial, targets)
    for T, rows in zip(targets, found, strict=True):
        if rows is None:
            continue
        assert len(solutions(serial, T, rows, within=1e-9)) == len(rows)
        assert same_solutions(rows, plain(serial, T))
    return sum(rows is not None for rows in found)


@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("wrist", WRISTS)
def test_the_sets_of_the_plain_solver(wrist: str, backwards: bool) -> None:
    rng, sure = np.random.default_rng(21), 0
    for _ in range(20):
        serial = random_parallel_arm(rng, wrist, backwards=backwards)
        sure += compared(serial, rng.uniform(-3.1, 3.1, (10, 6)))
    assert sure >= 199


@pytest.mark.parametrize("name", MADE)
def test_arms_as_they_are_made_with_any_signs(name: str) -> None:
    rng, sure = np.random.default_rng(22), 0
    for _ in range(8):
        serial = with_signs(made_arm(name), rng.choice((-1.0, 1.0), 6).tolist())
        sure += compared(serial, rng.uniform(-math.pi, math.pi, (10, 6)))
    assert sure == 80


@pytest.mark.slow
def test_thousands_of_poses() -> None:
    rng, sure = np.random.default_rng(23), 0
    for name in MADE:
        sure += compared(made_arm(name), rng.uniform(-math.pi, math.pi, (1000, 6)))
    for wrist in WRISTS:
        for n in range(30):
            sure += compared(random_parallel_arm(rng, wrist, backwards=n % 2 == 0), rng.uniform(-3.1, 3.1, (50, 6)))
    assert sure > 0.998 * 7500


@pytest.mark.parametrize("gap", [1e-8, 1e-6, 1e-4, 1e-2])
def test_axes_that_nearly_meet(gap: float) -> None:
    rng, sure = np.random.default_rng(24), 0
    for _ in range(10):
        *rest, five, six = random_parallel_arm(rng, "meeting").screws
        six = replace(six, point=six.point + gap * unit(np.cross(five.direction, six.direction)))
        sure += compared(Serial((*rest, five, six), np.eye(4)), rng.uniform(-3.0, 3.0, (6, 6)))
    assert sure >= 58


def test_right_angles_and_what_is_beside_them() -> None:
    rng, regular, sure = np.random.default_rng(25), 0, 0
    for _ in range(10):
        serial = made_arm("UR5") if rng.random() < 0.5 else made_arm("CR5").reversed()
        values = np.radians(rng.integers(-3, 5, (20, 6)) * 45.0)
        values += rng.normal(size=(20, 6)) * (rng.random((20, 6)) < 0.5) * 10.0 ** rng.uniform(-9.0, -1.0, (20, 1))
        regular += sum(smallest_singular_value(serial, q) > 1e-2 for q in values)
        sure += compared(serial, values)
    assert sure > 0
    assert sure >= 0.9 * regular


def test_singular_poses_are_left_to_the_plain_solver() -> None:
    rng = np.random.default_rng(26)
    serial = made_arm("UR5")
    for joint, values in ((4, (0.0, math.pi)), (2, (0.0, math.pi))):
        for value in values:
            for beside in (0.0, 1e-9, 1e-6, 2e-5):
                q = rng.uniform(-3.0, 3.0, 6)
                q[joint] = value + beside
                assert compiled(serial, [pose_by_hand(serial, q)]) == [None]
                assert min(apart(row, q) for row in right_with(serial, q)) < 1e-4


def test_what_is_out_of_reach_is_left_to_the_plain_solver() -> None:
    serial = made_arm("UR5")
    T = pose_by_hand(serial, np.ones(6))
    T[:3, 3] *= 10.0
    assert compiled(serial, [T]) == [None]


def test_where_every_angle_1_has_its_angle_5_it_is_not_sure() -> None:
    rng = np.random.default_rng(27)
    for wrist in ("meeting", "apart"):
        for _ in range(10):
            serial = random_parallel_arm(rng, wrist)
            _, a, b, c, five, six = serial.screws
            there = Serial((a, b, c), np.eye(4)).pose(rng.uniform(-2.0, 2.0, 3))
            serial = Serial((replace(five.transformed(there), joint=0), a, b, c, five, six), serial.M)
            assert compiled(serial, [there @ six.T(0.4) @ serial.M]) == [None]
