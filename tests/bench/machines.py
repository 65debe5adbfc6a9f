"""The machines of the benchmark: three robots that everybody has, one with KUKA's numbers, three that ship."""

from __future__ import annotations

import importlib.metadata
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import chainbuild
from chainbuild.robot import Robot

HERE = Path(__file__).parent
SHIPPED = ("kr6r900", "tx2_60", "irb2600")
EXAMPLES = {
    "UR5": ("ur_description/urdf/ur5_robot.urdf", "tool0"),
    "UR10": ("ur_description/urdf/ur10_robot.urdf", "tool0"),
    "Panda": ("panda_description/urdf/panda.urdf", "panda_link8"),
}


@dataclass(frozen=True)
class Machine:
    """A robot, its URDF for those who read that, and the range of its joints [rad, m]."""

    name: str
    robot: Robot
    urdf: Path
    lower: np.ndarray
    upper: np.ndarray

    def axes(self, count: int, seed: int) -> np.ndarray:
        """Return random axis values (count, n) over the whole range, mm and degrees."""
        lower = np.array([axis.lower for axis in self.robot.axes])
        upper = np.array([axis.upper for axis in self.robot.axes])
        return lower + (upper - lower) * np.random.default_rng(seed).random((count, len(lower)))


def machines(folder: Path) -> Iterator[Machine]:
    """Yield the machines that are there; those of a missing package are named on the way."""
    try:
        found = examples_folder()
        for name, (path, tool) in EXAMPLES.items():
            yield _machine(name, chainbuild.Robot(chainbuild.from_urdf(found / path, tool=tool)), folder)
    except importlib.metadata.PackageNotFoundError:
        print("skipped: UR5, UR10, Panda (package example-robot-data is not installed)")
    yield _machine("KR 6 R700", chainbuild.Robot(chainbuild.from_urdf(HERE / "kr6r700.urdf", tool="tool0")), folder)
    for name in SHIPPED:
        yield _machine(name, chainbuild.Robot.load(name), folder)


def examples_folder() -> Path:
    """Return where example-robot-data keeps its robots."""
    files = importlib.metadata.files("example-robot-data") or []
    found = next(file for file in files if str(file).endswith(EXAMPLES["UR5"][0]))
    return Path(str(found.locate())).resolve().parents[2]


def _machine(name: str, robot: Robot, folder: Path) -> Machine:
    urdf = chainbuild.write_urdf(robot, folder)
    lower, upper = robot.model.lowerPositionLimit, robot.model.upperPositionLimit
    return Machine(name, robot, Path(urdf), lower.copy(), upper.copy())
