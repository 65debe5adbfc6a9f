"""Half a turn to either side of the start: the place nearer to zero, 180 degrees rather than -180, by every path."""

from __future__ import annotations

import numpy as np
import pytest

from chainbuild.ik.branches.core.query import BranchQuery
from chainbuild.ik.branches.every import every_branch
from chainbuild.ik.request import IkRequest
from chainbuild.robot import Robot
from tests.kit.arms45 import limited
from tests.kit.robots import arm


@pytest.fixture(scope="module")
def robot() -> Robot:
    return limited(arm(), every=(-400.0, 400.0))


@pytest.mark.parametrize(
    ("start", "wanted"), [(0.0, 180.0), (180.0, 0.0), (90.0, -90.0), (-90.0, 90.0), (200.0, 20.0), (-200.0, -20.0)]
)
@pytest.mark.parametrize("rounding", [0.0, 1e-12, -1e-12])
def test_the_place_nearer_to_zero_counts(robot: Robot, start: float, wanted: float, rounding: float) -> None:
    axes = np.array([10.0, -60.0, 80.0, 30.0, 40.0, wanted])
    T = robot.fk(axes + [0.0, 0.0, 0.0, 0.0, 0.0, rounding])
    begin = np.array([*axes[:5], start])
    plain = every_branch(BranchQuery.of(IkRequest.of(robot, T, begin))).branches.axes
    for found in (plain, robot.ik_all(T, begin).axes):
        assert sixth(found, axes) == pytest.approx(wanted, abs=1e-9)


def sixth(found: np.ndarray, axes: np.ndarray) -> float:
    """Return axis 6 of the one branch with these other axes."""
    (same,) = found[np.abs(found[:, :5] - axes[:5]).max(axis=1) < 1e-6]
    return float(same[5])
