"""Every shipped machine: it loads without errors, goes there and back, and its URDF is the committed one."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.robot import Robot
from chainbuild.writers.models.export import formats_of
from tests.kit.paths import ROOT

MACHINES = chainbuild.shipped()
ARMS = ("kr6r900", "irb2600", "kr6r900_2", "tx2_60")
TARGETS = 100
TARGETS_ARM = 2000


def build(name: str) -> Robot:
    return chainbuild.Robot.load(name)


def random_axes(robot: Robot, rng: np.random.Generator) -> np.ndarray:
    """Draw axis values inside the limits where the kinematic has a pose."""
    lower = np.array([max(axis.lower, -360.0) if axis.kind == "rotary" else axis.lower for axis in robot.axes])
    upper = np.array([min(axis.upper, 360.0) if axis.kind == "rotary" else axis.upper for axis in robot.axes])
    while True:
        axes = lower + (upper - lower) * rng.random(len(lower))
        try:
            robot.fk(axes)
        except chainbuild.ChainbuildError:
            continue
        if all(c.margin(axes) > 0 for c in robot.chain.constraints):
            return axes


def test_the_promised_machines_are_there() -> None:
    assert set(ARMS) <= set(MACHINES)


@pytest.mark.parametrize("name", MACHINES)
def test_no_errors_are_found(name: str) -> None:
    assert [finding for finding in chainbuild.check(name) if finding.severity == "error"] == []


@pytest.mark.parametrize("name", MACHINES)
def test_limits_are_known(name: str) -> None:
    assert not any(axis.assumed for axis in build(name).axes)


@pytest.mark.parametrize("name", MACHINES)
def test_every_machine_names_its_source(name: str) -> None:
    path = chainbuild.machines.shipped_path(name)
    head = "\n".join(path.read_text("utf-8").splitlines()[:8]).lower()
    words = ("invented", "data sheet", "public", "backup", "manual")
    assert any(word in head for word in words), head


@pytest.mark.parametrize("name", MACHINES)
def test_there_and_back(name: str) -> None:
    robot, rng = build(name), np.random.default_rng(5)
    input_axes = [n for n, axis in enumerate(robot.axes) if axis.held]
    found = 0
    count = TARGETS_ARM if name in ARMS else TARGETS
    for _ in range(count):
        axes = random_axes(robot, rng)
        target = robot.fk(axes)
        result = robot.ik(target, held=[float(axes[n]) for n in input_axes])
        if not result.success:
            continue
        found += 1
        reached = robot.fk(result.axes)
        assert np.linalg.norm(reached.translation - target.translation) < 1e-6
        assert robot.violated_limits(result.axes) == ()
        if result.task == "pose":
            assert np.abs(reached.rotation - target.rotation).max() < 2e-6
        elif result.task == "direction":
            column = 0 if robot.chain.tool_axis == "x" else 2
            assert np.abs(reached.rotation[:, column] - target.rotation[:, column]).max() < 2e-6
    assert found >= 0.999 * count


def same_as_committed(paths: Iterable[Path], folder: Path) -> set[Path]:
    """Compare every file that lies where these do with the committed one; return their names."""
    found = {file for path in paths for file in path.parent.rglob("*") if file.is_file()}
    for file in found:
        committed = ROOT / "urdf_out" / file.relative_to(folder)
        assert file.read_bytes() == committed.read_bytes(), f"{file.name}: run `make demo` and commit urdf_out/"
    return {file.relative_to(folder) for file in found}


def test_committed_files_are_regenerated_byte_for_byte(tmp_path: Path) -> None:
    """All but what is sampled, and the example whole: what `make demo` writes."""
    written: set[Path] = set()
    for name in MACHINES:
        machine = chainbuild.load(name)
        robot = Robot(machine.chain())
        formats = [one for one in formats_of(robot) if one not in ("srdf", "report") or name == "kr6r900"]
        paths = chainbuild.export(robot, tmp_path, formats=formats, machine=machine)
        written |= same_as_committed(paths.values(), tmp_path)
    kept = {path.relative_to(ROOT / "urdf_out") for path in (ROOT / "urdf_out").rglob("*") if path.is_file()}
    assert kept == written
