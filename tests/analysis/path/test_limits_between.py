"""Limits of axes, sums and drives between rows, and the speeds of the motion, against dense differences."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from chainbuild.robot import Robot
from tests.kit.aimed_lines import lines_of, pose_between

DENSE = 1201


def sliding(robot: Robot, rows: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return the axes of a block whose rotary axes change evenly, the tip on a line: linear axes carry the tool."""
    linear = [n for n, axis in enumerate(robot.axes) if axis.kind == "linear"]
    axes = rows[0] + t[:, None] * (rows[1] - rows[0])
    p = robot.fk_batch(rows)[:, :3, 3] * 1000.0
    miss = p[0] + t[:, None] * (p[1] - p[0]) - robot.fk_batch(axes)[:, :3, 3] * 1000.0
    for n in range(len(t)):
        axes[n, linear] += np.linalg.solve(directions(robot, axes[n], linear), miss[n])
    return axes


def directions(robot: Robot, axes: np.ndarray, linear: list[int]) -> np.ndarray:
    """Return (3, 3) how far linear axes carry the tool for a millimetre each, by differences."""
    moved = robot.fk_batch(axes + np.eye(len(axes))[linear])[:, :3, 3]
    return (moved - robot.fk_batch(axes[None])[:, :3, 3]).T * 1000.0


def dense_parts(robot: Robot, axes: np.ndarray) -> dict[str, list[tuple[float, float]]]:
    """Return the parts of a block outside limits, by name, at the resolution of the samples."""
    names = [set(robot.limits.violated(row)) for row in axes]
    found = {}
    for name in set().union(*names):
        out = np.array([name in here for here in names])
        edges = np.flatnonzero(np.diff(np.concatenate([[0], out.astype(int), [0]])))
        found[name] = [(a / (DENSE - 1), (b - 1) / (DENSE - 1)) for a, b in edges.reshape(-1, 2).tolist()]
    return found


def compare(report: chainbuild.PathReport, dense: dict[str, list[tuple[float, float]]], tolerance: float) -> int:
    found: dict[str, list[tuple[float, float]]] = {}
    for one in report.violations:
        place = one.begin.row + one.begin.share, one.end.row + one.end.share
        found.setdefault(one.name, []).append(place)
        assert one.begin.row + one.begin.share <= one.worst.row + one.worst.share <= place[1]
        assert one.excess > 0.0 and one.name in one.words
    wide = {name: parts for name, parts in dense.items() if max(b - a for a, b in parts) > 2.0 * tolerance}
    assert set(wide) <= set(found) <= set(dense)
    for name, parts in wide.items():
        assert np.abs(np.array(found[name]) - parts).max() < tolerance, name
    return len(wide)


@pytest.mark.parametrize("name", ["parallelogram_nr", "kr6r900", "bevel_head_kin76"])
def test_limits_of_straight_axes(name: str) -> None:
    robot, rng = Robot.load(name), np.random.default_rng(4)
    lower = np.array([max(axis.lower, -2000.0) for axis in robot.axes])
    upper = np.array([min(axis.upper, 2000.0) for axis in robot.axes])
    t, seen = np.linspace(0.0, 1.0, DENSE), set[str]()
    for _ in range(6):
        rows = rng.uniform(lower - 0.1 * (upper - lower), upper + 0.1 * (upper - lower), (2, len(lower)))
        report = chainbuild.path_report(robot, rows)
        dense = dense_parts(robot, rows[0] + t[:, None] * (rows[1] - rows[0]))
        compare(report, dense, 1.0 / (DENSE - 1))
        assert all(one.proven for one in report.violations)
        seen |= set(dense)
    assert len(seen) >= 3
    if name == "parallelogram_nr":
        assert any(limit.name in seen for limit in robot.limits.sums)


@pytest.mark.parametrize("name", ["cardan_head_kin59", "geared_head_kin28", "plasma_head_kin25"])
@pytest.mark.parametrize("between", ["ptp", "cp"])
def test_limits_of_heads(name: str, between: chainbuild.Between) -> None:
    robot, rng = Robot.load(name), np.random.default_rng(5)
    lower = np.array([max(axis.lower, -800.0) for axis in robot.axes])
    upper = np.array([min(axis.upper, 800.0) for axis in robot.axes])
    t, seen = np.linspace(0.0, 1.0, DENSE), 0
    for _ in range(3):
        rows = rng.uniform(lower - 0.2 * (upper - lower), upper + 0.2 * (upper - lower), (2, len(lower)))
        rows[:, 4] = np.clip(rows[:, 4], -89.0, 89.0)  # beyond, some heads have no joint values
        axes = rows[0] + t[:, None] * (rows[1] - rows[0]) if between == "ptp" else sliding(robot, rows, t)
        if np.isfinite(axes).all():
            report = chainbuild.path_report(robot, rows, between=between)
            seen += compare(report, dense_parts(robot, axes), 2e-3)
    assert seen


def test_an_axis_that_leaves_and_comes_back_to_where_it_was_is_seen() -> None:
    robot = Robot.load("ca_head_kin9")
    rows = np.array([[0.0, 0.0, 399.0, 0.0, 70.0], [0.0, 0.0, 399.0, 0.0, 20.0]])
    axes = sliding(robot, rows, np.linspace(0.0, 1.0, DENSE))
    dense = dense_parts(robot, axes)
    assert list(dense) == ["Z"] and axes[[0, -1], 2].max() < 400.0
    report = chainbuild.path_report(robot, rows, between="cp")
    compare(report, dense, 2e-3)
    assert report.violations[0].excess == pytest.approx(axes[:, 2].max() - 400.0, rel=0.01)


def rates_over(axes: np.ndarray, step: float) -> np.ndarray:
    """Return the rates over a block from values at -2, -1, 1, 2 steps."""
    return (axes[0] - 8.0 * axes[1] + 8.0 * axes[2] - axes[3]) / (12.0 * step)


def test_speeds_at_minima_of_straight_axes() -> None:
    robot = Robot.load("kr6r900")
    rows = np.array([[0.0, -60.0, 80.0, 10.0, -8.0, 20.0], [20.0, -70.0, 90.0, 30.0, 9.0, -10.0]])
    options = chainbuild.PathOptions(feed_mm_min=3000.0)
    report = chainbuild.path_report(robot, rows, options=options)
    (stretch,) = report.stretches
    (minimum,) = stretch.minima
    h = 1e-4
    tips = robot.fk_batch(minimum.place.axes + h * np.array([[-1.0], [1.0]]) * (rows[1] - rows[0]))[:, :3, 3]
    per_block = float(np.linalg.norm(tips[1] - tips[0])) / (2.0 * h) * 1000.0
    assert [s.needed for s in minimum.speeds] == pytest.approx(np.abs(rows[1] - rows[0]) * 50.0 / per_block, rel=1e-5)
    assert [s.speed.needed for s in report.speeds] == pytest.approx(
        np.abs(rows[1] - rows[0]) * 50.0 / report.length_mm, rel=1e-9
    )
    assert report.seconds == pytest.approx(report.length_mm / 50.0)
    t = np.linspace(0.0, 1.0, 2001)[:, None]
    tips = robot.fk_batch(rows[0] + t * (rows[1] - rows[0]))[:, :3, 3]
    assert report.length_mm == pytest.approx(np.linalg.norm(np.diff(tips, axis=0), axis=1).sum() * 1e3, rel=1e-6)


def test_speeds_at_minima_of_lines() -> None:
    lines, rng = lines_of("kr6r900"), np.random.default_rng(3)
    robot, seen = lines.robot, 0
    while seen < 1:
        axes = lines.onto("wrist", rng)
        axes[4] += 2.0  # passed by at a small distance
        first, last = lines.ends(axes, "wrist", 0.5, rng)
        signs = np.sign(lines.functions(axes[None])[0])
        h = 2e-4
        rows = lines.rows(first, last, np.array([0.0, 1.0]), signs, axes)
        if rows is None or np.abs(np.diff(rows, axis=0)).max() > 250.0:
            continue
        report = chainbuild.path_report(robot, rows, between="cp", options=chainbuild.PathOptions(feed_mm_min=600.0))
        for minimum in (m for s in report.stretches for m in s.minima if s.kind == "wrist" and not m.singular):
            t = minimum.place.share
            if not 0.01 < t < 0.99:
                continue
            near = [robot.ik(pose_between(first, last, t + k * h), minimum.place.axes).axes for k in (-2, -1, 1, 2)]
            wanted = np.abs(rates_over(np.array(near), h)) * 10.0 / report.length_mm
            assert [s.needed for s in minimum.speeds] == pytest.approx(wanted, rel=1e-3, abs=1e-3)
            fastest = np.array([s.speed.needed for s in report.speeds])
            assert (fastest >= wanted * (1.0 - 1e-3) - 1e-3).all()
            seen += 1


@pytest.mark.parametrize("name", ["ca_head_kin9", "ac_table_kin58", "geared_head_kin28"])
def test_largest_speeds_where_rotary_axes_are_programmed(name: str) -> None:
    robot = Robot.load(name)
    rows = np.array([[10.0, 20.0, -30.0, 15.0, 20.0], [60.0, -20.0, 10.0, 40.0, 35.0]])
    report = chainbuild.path_report(robot, rows, between="cp", options=chainbuild.PathOptions(feed_mm_min=6000.0))
    t = np.linspace(0.0, 1.0, DENSE)
    axes = sliding(robot, rows, t)
    fastest = np.abs(np.diff(axes, axis=0)).max(axis=0) * (DENSE - 1) * 100.0 / report.length_mm
    found = np.array([s.speed.needed for s in report.speeds if not s.speed.of_drive])
    assert found == pytest.approx(fastest, rel=2e-3)
    for one in report.speeds:
        assert one.place.row == 0 and 0.0 <= one.place.share <= 1.0
