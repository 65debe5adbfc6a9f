"""Poses at which a branch was once lost: along valleys, between others, in clusters, beside curves.

The arms are public ones as `make bench-arms` takes them, some of them calibrated, in `tests/data/lost_branches.json`.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from chainbuild.ik.branches.compiled.quick import quick_branches
from chainbuild.ik.branches.core.branches import Branches
from tests.bench.arms.geometry import OTHER, Arm
from tests.bench.arms.peers import robot_of
from tests.bench.arms.truth import distance, truths

CASES: list[dict[str, Any]] = json.loads(
    (Path(__file__).parents[3] / "data" / "lost_branches.json").read_text(encoding="utf-8")
)


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case['arm']}, {case['where']}")
def test_no_branch_is_lost(case: dict[str, Any]) -> None:
    axes, points, M, q = (np.array(case[part]) for part in ("axes", "points", "M", "q"))
    arm = Arm(case["arm"], OTHER, "calibrated" in case["arm"], axes, points, M)
    robot, T = robot_of(arm), arm.pose(q)
    found = quick_branches(robot, T, None, None)
    assert isinstance(found, Branches)
    rows = np.radians(found.axes)
    (judged,) = truths(arm, T[None], q[None], [[rows]], np.random.default_rng(3))
    assert 4 <= len(judged.branches) <= len(rows)
    assert all(distance(rows, branch).min() < 1e-4 for branch in judged.branches)
    assert judged.wrong == [0]
