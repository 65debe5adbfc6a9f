"""Every arrangement that loads: no branch is missing, at random poses, at limits and where axes stand square."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.formats.sinumerik.reading.robx import MAIN_AXES
from chainbuild.ik.branches.core.branches import collect
from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.every import ik_all
from chainbuild.ik.branches.multistart import multistart_branches
from chainbuild.ik.request import IkRequest
from chainbuild.machines import shipped
from chainbuild.robot import Robot
from docs.robx_combinations import LAST_ROTARY, machine_data
from tests.kit.compare import same_turns
from tests.kit.draws import random_axes
from tests.kit.kin_robots import robot_of

KINS = (85, 202, 206, 208, 213)
# One of each pair of wrists that lead to the same structure.
ROBX = [
    (number, letters, parallel, count, wrist)
    for number, letters in MAIN_AXES.items()
    for parallel in (True, False)
    for count, wrist in ((4, 2), (5, 2), (5, 3), (6, 3), (6, 5), (6, 6))
    if letters in LAST_ROTARY or not parallel
]
# Singular values of the task's Jacobian below this [m, rad] merge branches beyond what can be told apart.
REGULAR = 1e-2


@cache
def load(text: str, folder: Path) -> Robot:
    path = folder / f"machine_{len(list(folder.iterdir()))}.tea"
    path.write_text(text, "utf-8")
    return chainbuild.Robot.load(path)


def robx(key: tuple[int, str, bool, int, int], folder: Path) -> Robot:
    return load(machine_data(*key), folder)


def smallest(robot: Robot, axes: np.ndarray) -> float:
    """Return the smallest singular value of the task's Jacobian."""
    _, J = robot.kinematics.residual(robot.fk(axes), robot.task)(axes * robot.kinematics.si_factors)
    return float(np.linalg.svd(J, compute_uv=False).min())


def square_axes(robot: Robot, rng: np.random.Generator) -> np.ndarray:
    """Return axis values most of which are multiples of 30 degrees, one of them at a limit."""
    axes = np.round(random_axes(robot, rng) / 30.0) * 30.0
    axes = np.where(rng.random(len(axes)) < 0.2, random_axes(robot, rng), axes)
    lower, upper = (np.array([getattr(axis, name) for axis in robot.axes]) for name in ("lower", "upper"))
    n = int(rng.integers(len(axes)))
    axes[n] = (lower, upper)[int(rng.integers(2))][n]
    return np.clip(axes, lower, upper)


def check(robot: Robot, count: int) -> None:
    """Check round trips everywhere, and at some poses that restarts find no branch that is missing."""
    rng = np.random.default_rng(8)
    for n in range(3 * count):
        axes = random_axes(robot, rng) if n % 3 else square_axes(robot, rng)
        if smallest(robot, axes) < REGULAR:
            continue
        target = robot.fk(axes)
        found = ik_all(robot, target, axes)
        assert any(same_turns(robot, branch.axes, axes) for branch in found), axes.tolist()
        for branch in found:
            assert branch.method != "search"
            assert branch.position_error < 1e-6
        if n % 3 != 1:
            continue
        query = BranchQuery.of(IkRequest.of(robot, target, axes))
        for other in collect(query, ((x, ()) for x in multistart_branches(query))).branches:
            if smallest(robot, other.axes) > REGULAR:
                assert any(same_turns(robot, branch.axes, other.axes) for branch in found), axes.tolist()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("arrangements")


@pytest.mark.parametrize("key", ROBX, ids=lambda key: "-".join(str(part) for part in key))
def test_robx(key, folder: Path) -> None:
    robot = robx(key, folder)
    assert robot.plan().name != "search"
    check(robot, 5)


@pytest.mark.parametrize("kin", KINS)
def test_kin_types(kin: int) -> None:
    assert robot_of(kin).plan().name != "search"
    check(robot_of(kin), 6)


@pytest.mark.slow
@pytest.mark.parametrize("key", ROBX, ids=lambda key: "-".join(str(part) for part in key))
def test_robx_long(key, folder: Path) -> None:
    check(robx(key, folder), 60)


def test_only_too_many_axes_are_left_to_restarts() -> None:
    left = set()
    for name in shipped():
        robot = chainbuild.Robot.load(name)
        if robot.plan().name == "search":
            left.add((name, len(robot.axes) > 6))
    assert left == {
        ("gantry_robot_kin210", True), ("robot_head_kin210", True), ("robot_tilting_table_kin210", True),
        ("robot_xy_unit_kin210", True),
    }  # fmt: skip
