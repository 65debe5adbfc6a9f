"""There and back for every KIN_TYP: no wrong answer, and a target that was reached is found again."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.errors import ChainbuildError
from tests.kit.draws import seed_of
from tests.kit.random_types import FORMULAS, channel_list, random_axes, random_machine

BUILT = sorted(set(chainbuild.catalogue()) & set(FORMULAS))


def round_trip(kin: int, folder: Path, poses: int) -> None:
    rng = np.random.default_rng(seed_of("round trip", kin))
    path = folder / f"kin{kin}.lis"
    param = random_machine(kin, rng)
    if kin == 25:
        param[2] = 50_000.0  # the nozzle's length grows as 1/cos: only a head that stays clear of 90° is a machine
    path.write_text(channel_list(kin, param))
    robot = chainbuild.Robot(chainbuild.load(path).chain(tool_length_mm=50.0))
    held = [n for n, axis in enumerate(robot.axes) if axis.held]
    tried = found = 0
    while tried < poses:
        axes = random_axes(kin, rng)
        try:
            target = robot.fk(axes)
        except ChainbuildError:
            continue
        tried += 1
        result = robot.ik(target, held=[axes[n] for n in held])
        if not result.success:
            continue
        found += 1
        reached = robot.fk(result.axes)
        assert np.linalg.norm(reached.translation - target.translation) < 1e-6
        assert robot.violated_limits(result.axes) == ()
        if result.task != "position":
            assert np.linalg.norm(reached.rotation[:, 2] - target.rotation[:, 2]) < 2e-6
        if result.task == "pose":
            assert np.abs(reached.rotation - target.rotation).max() < 2e-6
    assert found >= 0.995 * poses, f"KIN_TYP {kin}: {found} of {poses} found"


@pytest.mark.parametrize("kin", BUILT)
def test_there_and_back(kin: int, tmp_path: Path) -> None:
    round_trip(kin, tmp_path, 60)


@pytest.mark.slow
@pytest.mark.parametrize("kin", BUILT)
def test_there_and_back_2000(kin: int, tmp_path: Path) -> None:
    round_trip(kin, tmp_path, 2000)
