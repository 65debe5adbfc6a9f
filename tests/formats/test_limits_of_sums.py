"""Limits on sums of axes in the overlay of machine data: kept by ik and ik_all, told by fk, drawn by `limits`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild import Robot
from chainbuild.analysis.collision.sweep import sweep
from chainbuild.collision.model import CollisionModel
from chainbuild.errors import OverlayError
from tests.kit.command_line import Run, rows_of, write

# Machine → a sum of its axes, and axis values inside the limits of the axes.
MACHINES = {
    "palletiser_kin96": ("G2+G3", [20.0, 30.0, -20.0, 10.0]),
    "palletiser_kin213": ("G3+G2", [20.0, -90.0, 100.0, 5.0, 10.0]),
    "kr6r900_2": ("B1 + B2", [10.0, -70.0, 60.0, 20.0, 40.0, 30.0]),
    "kr6r900": ("A2+A3", [10.0, -70.0, 60.0, 20.0, 40.0, 30.0]),
    "parallelogram_nr": ("A2 - 0.5*A3", [10.0, -20.0, -60.0, 20.0, 40.0, 30.0]),
    "irb2600_track": ("A2+A3", [10.0, 20.0, 30.0, 20.0, 40.0, 30.0, 500.0]),
    "scara_cc": ("A2+A3", [-100.0, 40.0, -50.0, 10.0]),
    "ac_table_kin58": ("X+Y", [100.0, 50.0, -200.0, -20.0, 30.0]),
    "gantry_robot_kin210": ("B1+B2", [100.0, 50.0, 1500.0, 10.0, -70.0, 60.0, 20.0, 40.0, 30.0]),
}


def limited(folder: Path, name: str, lines: str) -> Robot:
    """Return a shipped machine with an overlay; its own one is part of it."""
    own = chainbuild.load(name).overlay.path
    text = own.read_text("utf-8") if own is not None else ""
    path = folder / "limited.toml"
    kept = "".join(line for line in text.splitlines(keepends=True) if not line.startswith("axis_lists"))
    path.write_text(f"{kept}\n[limits.sums]\n{lines}\n", "utf-8")
    return Robot.load(name, overlay=path)


def value_of(robot: Robot, text: str, values: np.ndarray) -> float:
    """Return a sum, which is Python but for the names."""
    named = {axis.name: float(value) for axis, value in zip(robot.axes, values, strict=True)}
    found: float = eval(text, {}, named)
    return found


@pytest.mark.parametrize(("name", "text", "at"), [(name, *more) for name, more in MACHINES.items()], ids=MACHINES)
def test_a_sum_is_kept_and_told(tmp_path: Path, name: str, text: str, at: list[float]) -> None:
    free, values = Robot.load(name), np.array(at)
    there = value_of(free, text, values)
    wide = limited(tmp_path, name, f'"{text}" = [{there - 3}, {there + 5}]')
    assert wide.violated_limits(values) == free.violated_limits(values) == ()
    T = free.fk(values)
    assert wide.ik(T, start=values).success
    narrow = limited(tmp_path, name, f'"{text}" = [{there + 1}, {there + 40}]')
    assert narrow.violated_limits(values) == (text,)
    assert (narrow.fk(values).homogeneous == T.homogeneous).all()
    found = narrow.ik(T, start=values)
    assert not found.success or value_of(free, text, found.axes) >= there + 1 - 1e-6
    branches = narrow.ik_all(T, start=values, held=_held(narrow, values))
    every = free.ik_all(T, start=values, held=_held(free, values))
    inside = [one for one in every.axes if there + 1 - 1e-6 <= value_of(free, text, one) <= there + 40 + 1e-6]
    assert len(branches.axes) == len(inside) < len(every.axes)
    for one in branches.axes:
        assert narrow.violated_limits(one) == ()


def _held(robot: Robot, values: np.ndarray) -> dict[str, float]:
    """Return the axes that a pose leaves open, held where they are."""
    named = {axis.name: float(value) for axis, value in zip(robot.axes, values, strict=True)}
    over = [axis.name for axis in robot.axes if axis.held] or (list("XYZ") if len(robot.axes) > 6 else [])
    return {name: named[name] for name in over}


def test_random_poses_of_an_arm_never_break_a_sum(tmp_path: Path) -> None:
    robot = limited(tmp_path, "kr6r900", '"A2+A3" = [-40, 20]\n"A4 - A6" = [-100, 100]')
    rng = np.random.default_rng(0)
    reached = 0
    for values in rng.uniform([-100, -120, -60, -120, -100, -150], [100, 20, 120, 120, 100, 150], (40, 6)):
        found = robot.ik(robot.fk(values))
        reached += found.success
        if found.success:
            assert -40 - 1e-6 <= found.axes[1] + found.axes[2] <= 20 + 1e-6
            assert -100 - 1e-6 <= found.axes[3] - found.axes[5] <= 100 + 1e-6
        if robot.violated_limits(values) == ():
            assert found.success
    assert reached > 5


def test_names_of_the_channel_and_generic_ones_mean_the_same(tmp_path: Path) -> None:
    plain = limited(tmp_path, "kr6r900_2", '"b1+b2" = [-10, 10]')
    assert plain.violated_limits([0, -60, 80, 0, 30, 0]) == ("b1+b2",)


@pytest.mark.parametrize(
    ("lines", "text"),
    [
        ('"A2+B7" = [0, 1]', "'A2+B7' is no sum of axes"),
        ('"A2" = [0, 1]', "'A2' is no sum of axes"),
        ('"A2+A3" = [900, 1000]', "no axis values within their limits give 'A2+A3' a value from 900 to 1000"),
        ('"A2+A3" = [1, 0]', "leave no range"),
        ('"A2+A3" = 4', "has the wrong type"),
    ],
)
def test_mistakes(tmp_path: Path, lines: str, text: str) -> None:
    with pytest.raises(OverlayError) as caught:
        limited(tmp_path, "kr6r900", lines)
    assert text in str(caught.value)
    assert caught.value.line


def test_kinematics_without_these_axes_do_without_the_sum(tmp_path: Path) -> None:
    path = tmp_path / "two.lis"
    text = chainbuild.load("kr6r900_2").path.read_text("utf-8")
    path.write_text(text.replace("Ende", "trafo[1].id 9\ntrafo[1].param[0] 1200000\nEnde"), "utf-8")
    overlay = tmp_path / "two.chainbuild.toml"
    overlay.write_text('[limits.sums]\n"B1+B2" = [-10, 10]\n', "utf-8")
    machine = chainbuild.load(path)
    assert [limit.name for limit in machine.chain().constraints] == ["B1+B2"]
    assert machine.chain(9).constraints == ()


def test_fk_and_ik_tell_and_limits_end_the_interval(run: Run, tmp_path: Path) -> None:
    write("sums.toml", '[limits]\nA2 = [-190, 45]\nA3 = [-120, 156]\n[limits.sums]\n"A2+A3" = [-30, 40]\n')
    poses = run("fk", "kr6r900", "--overlay", "sums.toml", "--at", "0,-90,90,0,30,0", "--at", "0,-90,140,0,30,0")
    assert [row["violations"] for row in rows_of(poses.out)] == ["", "A2+A3"]
    assert "1 row outside the limits of A2+A3" in poses.err
    write("poses.csv", poses.out)
    found = run("ik", "kr6r900", "--overlay", "sums.toml", "--poses", "poses.csv")
    assert found.code == 3
    assert [row["status"] for row in rows_of(found.out)] == ["ok", "limits"]
    shown = run("limits", "kr6r900", "--overlay", "sums.toml", "--axis", "A3", "--over", "A2", "--steps", "3")
    assert "limit A2+A3" in shown.out
    assert run("check", "kr6r900", "--overlay", "sums.toml").code == 0


def test_intervals_end_at_sums(tmp_path: Path) -> None:
    robot = limited(tmp_path, "kr6r900", '"A3 + 2*A2" = [-150, -40]\n"A2 - A4" = [-100, 30]')
    values = [-120.0, -80.0, -60.0, 31.0]
    found = sweep(CollisionModel(robot), "A3", "A2", at=[0, -80, 90, 0, 0, 0], values=values)
    for one in found.intervals[1:3]:
        assert one.upper == pytest.approx(min(-40 - 2 * one.over, 156))
        assert one.upper_limit == "A3 + 2*A2"
        assert one.lower is not None
        assert one.lower >= max(-150 - 2 * one.over, -120) - 1e-9
    for outside in (found.intervals[0], found.intervals[3]):
        assert outside.lower is None
        assert outside.lower_limit == "A2 - A4"
