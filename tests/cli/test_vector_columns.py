"""Vector programming in tables: ori_x, ori_y, ori_z of a six-axis arm, from a start and from row to row."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import chainbuild
from chainbuild.errors import ChainbuildError
from tests.hand.displayed import angles_of_rotation, rotation_from_vector

START = [5.0, -80.0, 80.0, 10.0, 40.0, -20.0]
NAMES = ("C1", "B1", "B2", "A1", "B3", "A2")


def axes_of(table: str) -> np.ndarray:
    head, *rows = (line.split(",") for line in table.splitlines())
    return np.array([[float(dict(zip(head, row, strict=True))[name]) for name in NAMES] for row in rows])


def path_of_vectors(robot: chainbuild.Robot, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return positions [mm] and vectors near those of the start."""
    T = robot.fk(START)
    turned = [T.rotation[:, 0] + 0.02 * n * T.rotation[:, 1] - 0.01 * n * T.rotation[:, 2] for n in range(count)]
    return np.tile(T.translation * 1000.0, (count, 1)), np.array(turned)


def test_rows_keep_the_angle_that_leaves_the_vector_free(run: Any) -> None:
    robot = chainbuild.Robot.load("kr6r900_2")
    places, vectors = path_of_vectors(robot, 8)
    rows = [
        ",".join(map(repr, [*place.tolist(), *(2.5 * vector).tolist()]))
        for place, vector in zip(places, vectors, strict=True)
    ]
    Path("poses.csv").write_text("x_mm,y_mm,z_mm,ori_x,ori_y,ori_z\n" + "\n".join(rows) + "\n", "utf-8")
    Path("start.csv").write_text(",".join(NAMES) + "\n" + ",".join(map(repr, START)) + "\n", "utf-8")
    kept = angles_of_rotation(0, robot.fk(START).rotation)["A"]
    for words in ((), ("--follow",)):
        told = run("ik", "kr6r900_2", "--poses", "poses.csv", "--start", "start.csv", *words)
        assert told.code == 0, told.err
        before = robot.fk(START).rotation
        for axes, vector in zip(axes_of(told.out), vectors, strict=True):
            R = robot.fk(axes).rotation
            np.testing.assert_allclose(R[:, 0], vector / np.linalg.norm(vector), atol=2e-6)
            assert math.isclose(angles_of_rotation(0, R)["A"], kept, abs_tol=2e-4)
            wanted = rotation_from_vector(0, vector, "A", kept, R_before=before)
            np.testing.assert_allclose(R, wanted, atol=3e-6)
            before = wanted


def test_a_vector_in_python_goes_on_from_the_start() -> None:
    robot = chainbuild.Robot.load("kr6r900_2")
    places, vectors = path_of_vectors(robot, 3)
    shown = dict(zip(("x_mm", "y_mm", "z_mm"), places[2], strict=True))
    shown |= zip(("ori_x", "ori_y", "ori_z"), vectors[2], strict=True)
    found = robot.from_display(shown, start=START)
    assert found.success
    np.testing.assert_allclose(robot.fk(found.axes).rotation[:, 0], vectors[2] / np.linalg.norm(vectors[2]), atol=2e-6)
    with pytest.raises(ChainbuildError, match="vector"):
        robot.from_display({**shown, "ori_x": 0.0, "ori_y": 0.0, "ori_z": 0.0}, start=START)


def test_a_zero_vector_and_a_machine_without_vectors(run: Any) -> None:
    Path("poses.csv").write_text("x_mm,y_mm,z_mm,ori_x,ori_y,ori_z\n500,0,500,0,0,0\n", "utf-8")
    told = run("ik", "kr6r900_2", "--poses", "poses.csv")
    assert (told.code, "poses.csv:2" in told.err, "zero vector" in told.err) == (1, True, True)
    told = run("ik", "kr6r900", "--poses", "poses.csv")
    assert (told.code, "unknown column 'ori_x'" in told.err) == (1, True)
