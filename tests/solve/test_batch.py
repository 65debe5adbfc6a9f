"""Branches over arrays: the same as one by one, limits kept, memory in chunks."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from chainbuild.errors import ChainbuildError
from chainbuild.robot.robot import Robot
from chainbuild.solve.batch import ik_all_batch
from tests.solve.machines import poses
from tests.test_robot import arm, table_machine


def machines() -> list[Robot]:
    return [
        arm(),
        *(chainbuild.load(name).chain().build() for name in ("kr6r900", "tx2_60", "irb2600", "parallelogram_nr")),
    ]


@pytest.mark.parametrize("n", range(5))
def test_the_same_branches_as_one_by_one(n: int) -> None:
    robot = machines()[n]
    axes = poses(robot, 150)
    targets = np.array([robot.fk(row).homogeneous for row in axes])
    batch = ik_all_batch(robot, targets)
    found = 0
    for row, target in zip(batch, targets, strict=True):
        kept = row[np.isfinite(row).all(axis=1)]
        single = np.array([branch.axes for branch in robot.ik_all(target)]).reshape(-1, 6)
        assert len(kept) == len(single)
        for one in kept:
            assert min(np.abs((one - other + 180.0) % 360.0 - 180.0).max() for other in single) < 1e-5
            assert robot.violated_limits(one) == ()
            assert np.abs(robot.fk(one).homogeneous - target).max() < 1e-9
        found += len(kept)
    assert found > 150


def test_without_limits_every_branch_is_exact() -> None:
    robot = arm()
    targets = np.array([robot.fk(row).homogeneous for row in poses(robot, 200)])
    batch = ik_all_batch(robot, targets, limits=False)
    exists = np.isfinite(batch).all(axis=2)
    assert exists.sum(axis=1).min() >= 4
    for n, slot in zip(*np.nonzero(exists), strict=True):
        assert np.abs(robot.fk(batch[n, slot]).homogeneous - targets[n]).max() < 1e-9


def test_out_of_reach_is_not_a_number() -> None:
    far = np.eye(4)
    far[0, 3] = 9.0
    assert np.isnan(ik_all_batch(arm(), far[None])).all()
    assert ik_all_batch(arm(), np.empty((0, 4, 4))).shape == (0, 8, 6)


def test_chunks_do_not_change_the_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = arm()
    targets = np.array([robot.fk(row).homogeneous for row in poses(robot, 25)])
    whole = ik_all_batch(robot, targets)
    monkeypatch.setattr("chainbuild.solve.batch._CHUNK", 7)
    np.testing.assert_allclose(ik_all_batch(robot, targets), whole, rtol=0.0, atol=1e-9)


def test_other_kinematics_are_refused() -> None:
    with pytest.raises(ChainbuildError, match="no closed form over arrays"):
        ik_all_batch(table_machine(), np.eye(4)[None])
    with pytest.raises(ChainbuildError, match="shape"):
        ik_all_batch(arm(), np.eye(4))
