"""A tripod below programmed rotary axes (KIN_TYP 209): the tip on a line, rotary axes even, the struts follow."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from chainbuild.analysis.path.motion import SlidingMotion, motion_of
from chainbuild.analysis.path.nearby import Near, nearby
from chainbuild.robot import Robot

ROWS = np.array([[-300.0, -300.0, -300.0, -40.0, 0.0], [-250.0, -330.0, -320.0, 20.0, 60.0]])
SHARES = np.linspace(0.0, 1.0, 7)
STRUTS = 3


@pytest.fixture(scope="module")
def tripod() -> Robot:
    return Robot.load("tripod_table_kin209")


def test_rotary_axes_are_even_and_the_tip_is_on_the_line(tripod: Robot) -> None:
    motion = motion_of(tripod, ROWS, "cp")
    axes = motion.axes(np.zeros(len(SHARES), dtype=np.intp), SHARES)
    tips, ends = tripod.fk_batch(axes)[:, :3, 3], tripod.fk_batch(ROWS)[:, :3, 3]
    assert np.abs(tips - ends[0] - SHARES[:, None] * (ends[1] - ends[0])).max() < 1e-9
    assert (
        np.abs(axes[:, STRUTS:] - ROWS[0, STRUTS:] - SHARES[:, None] * np.diff(ROWS[:, STRUTS:], axis=0)).max() < 1e-9
    )
    assert np.abs(axes[3, :STRUTS] - ROWS[:, :STRUTS].mean(axis=0)).max() > 20.0  # they are not even


def test_speeds_are_differences(tripod: Robot) -> None:
    motion, step = motion_of(tripod, ROWS, "cp"), 1e-5
    inside, blocks = SHARES[1:-1], np.zeros(len(SHARES) - 2, dtype=np.intp)
    before, behind = (motion.axes(blocks, inside + side * step) for side in (-1.0, 1.0))
    found, way_mm, _ = motion.speeds(blocks, inside)
    assert np.abs(found - (behind - before) / (2.0 * step)).max() < 1e-3
    ends = tripod.fk_batch(ROWS)[:, :3, 3]
    assert np.abs(way_mm - np.linalg.norm(ends[1] - ends[0]) * 1000.0).max() < 1e-6


def test_a_position_out_of_reach_has_no_axis_values(tripod: Robot) -> None:
    tips = tripod.fk_batch(ROWS)[:, :3, 3] + [[0.0] * 3, [5.0, 0.0, 0.0]]
    motion = SlidingMotion(tripod, ROWS, tips)
    found = motion.axes(np.zeros(2, dtype=np.intp), np.array([0.01, 1.0]))
    assert np.isfinite(found[0]).all() and np.isnan(found[1]).all()


def test_the_pole_of_the_table_is_no_singularity_and_flat_rods_are(tripod: Robot) -> None:
    through = np.array([[-300.0, -300.0, -300.0, -20.0, 0.0], [-300.0, -300.0, -300.0, 20.0, 0.0]])
    report = chainbuild.path_report(tripod, through, between="cp")
    assert not report.stretches and not report.gaps
    motion = motion_of(tripod, ROWS, "cp")
    (found,) = nearby(motion, Near(0.1, 0.9))  # so high a threshold that all of it is near
    (part,) = found.parts[0]
    axes = motion.axes(np.zeros(1, dtype=np.intp), np.array([part.least]))[0]
    moved = axes + 1e-3 * np.vstack([np.eye(5)[:STRUTS], -np.eye(5)[:STRUTS]])
    ends = tripod.fk_batch(moved)[:, :3, 3] * 1000.0
    by_differences = (ends[:STRUTS] - ends[STRUTS:]).T / 2e-3
    assert part.value == pytest.approx(np.linalg.svd(by_differences, compute_uv=False)[-1], abs=1e-6)
