"""The tool direction in tables is the machine's own, in what `fk` writes and in what is read."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import chainbuild


def table_of(path: Path, robot: chainbuild.Robot, count: int) -> list[str]:
    """Write axis values inside the shown limits; return the header and the rows."""
    lower, upper = (np.array([getattr(axis, end) for axis in robot.axes]) for end in ("lower", "upper"))
    middle = np.clip(0.0, lower, upper)
    lower, upper = np.maximum(lower, middle - 60.0), np.minimum(upper, middle + 60.0)
    rows = lower + (upper - lower) * np.random.default_rng(3).random((count, len(lower)))
    lines = [",".join(axis.name for axis in robot.axes), *(",".join(map(repr, row.tolist())) for row in rows)]
    path.write_text("\n".join(lines) + "\n", "utf-8")
    return lines


@pytest.mark.parametrize("name", chainbuild.shipped())
def test_what_fk_writes_agrees_as_a_recording(name: str, run: Any, tmp_path: Path) -> None:
    """With all columns, and with the tool direction alone."""
    robot = chainbuild.Robot.load(name)
    header, *rows = table_of(tmp_path / "axes.csv", robot, 8)
    assert run("fk", name, "--axes", "axes.csv", "--quaternion", "-o", "poses.csv").code == 0
    with (tmp_path / "poses.csv").open(encoding="utf-8") as stream:
        written = list(csv.DictReader(stream))
    for columns in (("qx", "qy", "qz", "qw"), ("tool_x", "tool_y", "tool_z")):
        shown = ("x_mm", "y_mm", "z_mm", *columns)
        lines = [f"{row},{','.join(poses[c] for c in shown)}" for row, poses in zip(rows, written, strict=True)]
        (tmp_path / "recording.csv").write_text("\n".join([f"{header},{','.join(shown)}", *lines]) + "\n", "utf-8")
        told = run("crosscheck", name, "--recording", "recording.csv")
        assert told.code == 0, told.out
    for row, poses in zip(rows, written, strict=True):
        T = robot.fk([float(value) for value in row.split(",")])
        column = {"x": 0, "z": 2}[robot.chain.tool_axis]
        vector = [float(poses[name]) for name in ("tool_x", "tool_y", "tool_z")]
        np.testing.assert_allclose(vector, T.rotation[:, column], atol=1e-12)


def test_the_tool_of_a_scara_hangs(run: Any) -> None:
    """ROBX counts the tool along X of its frame, which points down here."""
    header, row = (line.split(",") for line in run("fk", "scara_cc", "--at", "0,0,0,0").out.splitlines())
    shown = dict(zip(header, row, strict=True))
    vector = [float(shown[column]) for column in ("tool_x", "tool_y", "tool_z")]
    np.testing.assert_allclose(vector, (0.0, 0.0, -1.0), atol=1e-12)
