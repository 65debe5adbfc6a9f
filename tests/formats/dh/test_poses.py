"""Chains of Denavit-Hartenberg tables against products of matrices written here, numpy and math only."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild import Robot

Row = tuple[float, float, float, float, str]  # a, d, alpha, theta, kind
AT = [10.0, 20.0, 30.0, 40.0, 50.0, 60.0]


def about_z(angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], dtype=float)


def about_x(angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1]], dtype=float)


def shifted(x: float, z: float) -> np.ndarray:
    T = np.eye(4)
    T[0, 3], T[2, 3] = x, z
    return T


def by_hand(convention: str, rows: list[Row], values: list[float]) -> np.ndarray:
    """Return the pose [m] of a table's rows at axis values in degrees and mm."""
    T, left = np.eye(4), list(values)
    for a, d, alpha, theta, kind in rows:
        turned, moved = theta, d
        if kind == "revolute":
            turned += left.pop(0)
        elif kind == "prismatic":
            moved += left.pop(0)
        z = about_z(math.radians(turned)) @ shifted(0.0, moved / 1000.0)
        x = shifted(a / 1000.0, 0.0) @ about_x(math.radians(alpha))
        T = T @ (z @ x if convention == "standard" else x @ z)
    return T


def table(folder: Path, convention: str, rows: list[Row], limits: str = "") -> Path:
    path = folder / "arm.csv"
    head = "a,d,alpha,theta,kind" + (",lower,upper" if limits else "")
    lines = [",".join([*map(repr, row[:4]), row[4], *([limits] if limits else [])]) for row in rows]
    path.write_text("\n".join([f"# {convention}", head, *lines]) + "\n", "utf-8")
    return path


def drawn(rng: np.random.Generator, count: int) -> list[Row]:
    kinds = rng.choice(["revolute", "prismatic", "fixed"], count, p=[0.6, 0.25, 0.15]).tolist()
    kinds[0] = "revolute"
    numbers = np.column_stack([rng.uniform(-500, 500, (count, 2)), rng.uniform(-180, 180, (count, 2))])
    return [(*row, kind) for row, kind in zip(numbers.tolist(), kinds, strict=True)]


@pytest.mark.parametrize("convention", ["standard", "modified"])
@pytest.mark.parametrize("seed", range(12))
def test_random_tables(tmp_path: Path, convention: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows = drawn(rng, 2 + seed % 6)
    robot = Robot.load(table(tmp_path, convention, rows))
    assert [axis.unit for axis in robot.axes] == [
        {"revolute": "deg", "prismatic": "mm"}[kind] for *_, kind in rows if kind != "fixed"
    ]
    for _ in range(4):
        values = rng.uniform(-170, 170, len(robot.axes)).tolist()
        assert np.abs(robot.fk(values).homogeneous - by_hand(convention, rows, values)).max() < 1e-13


# Puma 560 as textbooks have it: Craig's table, and the same arm in the standard convention with its zero.
CRAIG: list[Row] = [
    (0, 0, 0, 0, "revolute"),
    (0, 0, -90, 0, "revolute"),
    (431.8, 149.09, 0, 0, "revolute"),
    (20.32, 433.07, -90, 0, "revolute"),
    (0, 0, 90, 0, "revolute"),
    (0, 0, -90, 0, "revolute"),
]
STANDARD: list[Row] = [
    (0, 0, -90, 0, "revolute"),
    (431.8, 149.09, 0, 0, "revolute"),
    (20.32, 0, -90, 0, "revolute"),
    (0, 433.07, 90, 0, "revolute"),
    (0, 0, -90, 0, "revolute"),
    (0, 0, 0, 0, "revolute"),
]


def test_one_arm_in_both_conventions(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    (tmp_path / "standard").mkdir()
    craig = Robot.load(table(tmp_path, "modified", CRAIG))
    standard = Robot.load(table(tmp_path / "standard", "standard", STANDARD))
    for values in rng.uniform(-170, 170, (8, 6)):
        assert np.abs(craig.fk(values).homogeneous - standard.fk(values).homogeneous).max() < 1e-14
    swapped = Robot.load(table(tmp_path, "standard", CRAIG))
    assert np.abs(swapped.fk(AT).translation - craig.fk(AT).translation).max() > 0.1


def test_right_angles_are_exact(tmp_path: Path) -> None:
    T = Robot.load(table(tmp_path, "modified", CRAIG)).fk([0.0] * 6)
    assert T.translation.tolist() == pytest.approx([0.45212, 0.14909, -0.43307], abs=1e-15)
    assert T.rotation.tolist() == [[1, 0, 0], [0, -1, 0], [0, 0, -1]]


@pytest.mark.parametrize(("convention", "rows"), [("modified", CRAIG), ("standard", STANDARD)])
def test_inverse_kinematics_finds_the_way_back(tmp_path: Path, convention: str, rows: list[Row]) -> None:
    robot = Robot.load(table(tmp_path, convention, rows, "-170,170"))
    assert robot.plan().complete
    for values in np.random.default_rng(2).uniform(-160, 160, (4, 6)):
        T = by_hand(convention, rows, values.tolist())
        assert robot.ik(T, start=values + 3).axes == pytest.approx(values, abs=1e-6)
        found = robot.ik_all(T)
        assert min(np.abs(one - values).max() for one in found.axes) < 1e-6
        for one in found.axes:
            assert np.abs(by_hand(convention, rows, one.tolist()) - T).max() < 1e-9


@pytest.mark.slow
def test_another_library_agrees(tmp_path: Path) -> None:
    import roboticstoolbox

    rng = np.random.default_rng(3)
    rows = [(*row[:4], row[4].replace("fixed", "revolute")) for row in drawn(rng, 6)]
    for convention, revolute, prismatic in (
        ("standard", roboticstoolbox.RevoluteDH, roboticstoolbox.PrismaticDH),
        ("modified", roboticstoolbox.RevoluteMDH, roboticstoolbox.PrismaticMDH),
    ):
        links = [
            revolute(a=a / 1e3, d=d / 1e3, alpha=math.radians(alpha), offset=math.radians(theta))
            if kind == "revolute"
            else prismatic(a=a / 1e3, offset=d / 1e3, alpha=math.radians(alpha), theta=math.radians(theta))
            for a, d, alpha, theta, kind in rows
        ]
        theirs = roboticstoolbox.DHRobot(links)
        robot = Robot.load(table(tmp_path, convention, rows))
        for _ in range(4):
            values = rng.uniform(-150, 150, 6)
            assert np.abs(robot.fk(values).homogeneous - theirs.fkine(robot.q(values)).A).max() < 1e-12


@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_as_urdf_and_back(tmp_path: Path, convention: str) -> None:
    rows = drawn(np.random.default_rng(4), 7)
    robot = Robot.load(table(tmp_path, convention, rows, ""))
    path = chainbuild.write_urdf(robot, tmp_path / "out")
    back = Robot.load(path, tool="tool")
    values = np.linspace(-40, 60, len(robot.axes))
    assert [axis.name for axis in back.axes] == [axis.name for axis in robot.axes]
    assert np.abs(back.fk(values).homogeneous - by_hand(convention, rows, values.tolist())).max() < 1e-12


def test_the_jacobian_is_the_derivative(tmp_path: Path) -> None:
    rows = drawn(np.random.default_rng(5), 6)
    robot, step = Robot.load(table(tmp_path, "modified", rows)), 1e-4
    values = np.linspace(-40, 60, len(robot.axes))
    J = robot.jacobian(values, frame="workpiece")
    for n, axis in enumerate(robot.axes):
        ahead, behind = (values + sign * step * (np.arange(len(values)) == n) for sign in (1, -1))
        moved = by_hand("modified", rows, ahead.tolist()) - by_hand("modified", rows, behind.tolist())
        in_si = math.radians(2 * step) if axis.kind == "rotary" else 2 * step / 1000.0
        assert np.abs(J[:3, n] - moved[:3, 3] / in_si).max() < 1e-6


def test_a_tool_length_lies_along_the_last_z(tmp_path: Path) -> None:
    path = table(tmp_path, "standard", STANDARD)
    flange, tool = Robot.load(path), Robot.load(path, tool_length_mm=120.0)
    T = by_hand("standard", STANDARD, AT)
    assert np.abs(flange.fk(AT).homogeneous - T).max() < 1e-14
    assert np.abs(tool.fk(AT).homogeneous - T @ shifted(0.0, 0.12)).max() < 1e-14
