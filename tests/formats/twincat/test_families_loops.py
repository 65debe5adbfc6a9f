"""The axis maps of closed loops, row by row: joints that close a loop move no tool, and only this would tell."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.axismap import SamplingMap, random_axis_values
from tests.hand.loops_cases import CHOICES, channel_list, random_closing, random_hd
from tests.hand.loops_hand import LOOPS
from tests.kit.draws import seed_of

TYPES = sorted(LOOPS)
CASES = [(kin, {name: choice}) for kin in TYPES for name, choices in CHOICES[kin].items() for choice in choices]
# Conventions of tables beside the loop change nothing about it.
CASES = [(kin, chosen) for kin, chosen in CASES if next(iter(chosen)).startswith("kin")]


def build(folder: Path, kin: int, hd: dict[int, float], conventions: dict[str, str]) -> chainbuild.Robot:
    path = folder / f"kin{kin}.lis"
    path.write_text(channel_list(kin, hd))
    return chainbuild.Robot(chainbuild.load(path).chain(conventions=conventions))


@pytest.mark.parametrize(("kin", "conventions"), CASES)
def test_every_row_of_the_map_is_the_derivative(kin: int, conventions: dict[str, str], tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("row", kin, str(conventions)))
    for _ in range(2):
        hd = random_hd(kin, rng, conventions)
        chain = build(tmp_path, kin, hd, conventions).chain
        revolute = np.array([joint.kind == "revolute" for joint in chain.joints])
        for _ in range(3):
            axes = np.array(random_closing(kin, hd, conventions, rng))
            J = chain.axis_map.dq_daxes(axes)
            for n, axis in enumerate(chain.axes):
                si = 1e-3 if axis.kind == "linear" else math.pi / 180.0
                step = np.zeros(len(axes))
                step[n] = 1e-7 / si
                way = chain.axis_map.q(axes + step) - chain.axis_map.q(axes - step)
                way[revolute] = np.remainder(way[revolute] + math.pi, math.tau) - math.pi
                assert way / 2e-7 == pytest.approx(J[:, n], abs=1e-5, rel=1e-5)


@pytest.mark.parametrize("kin", TYPES)
def test_drawn_axis_values_close_on_both_sides(kin: int, tmp_path: Path) -> None:
    """What is drawn closes, stays inside the box, and the second axis is often beyond the first and often not."""
    rng = np.random.default_rng(seed_of("drawn", kin))
    for along in ("x", "y"):
        stands, choices = ({5: 120.0}, {"kin21_hd5_along": along}) if kin == 21 else ({}, {})
        chain = build(tmp_path, kin, random_hd(kin, rng, {}) | stands, choices).chain
        axis_map = chain.axis_map
        assert isinstance(axis_map, SamplingMap)
        rotary = np.array([axis.kind == "rotary" for axis in chain.axes])
        lower, upper = np.where(rotary, -60.0, -900.0), np.where(rotary, 170.0, 1500.0)
        rows = [axis_map.drawn_axes(rng, lower, upper) for _ in range(400)]
        drawn = np.array([row for row in rows if row is not None][:40])
        assert len(drawn) == 40
        assert np.isfinite([axis_map.q(row) for row in drawn]).all()
        assert 0.2 < np.mean(drawn[:, 1] > drawn[:, 0]) < 0.8
        drawn_itself = [n for n in range(len(rotary)) if (kin, n) != (21, 1)]  # that slide stands off the first
        assert ((drawn >= lower) & (drawn <= upper))[:, drawn_itself].all()
        assert (np.ptp(drawn, axis=0) > 0.6 * (upper - lower)).all()


@pytest.mark.parametrize("kin", TYPES)
def test_joint_bounds_hold_where_the_loops_close(kin: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("bounds", kin))
    for beta in (120.0, -120.0):
        for side in ("left", "right"):
            # A lambda whose gripper counts from X: its joint turns by C less both angles of the arm.
            arm, choices = ({2: 500.0, 3: 350.0, 6: beta}, {"kin21_c_zero": "along_x", "kin21_side": side})
            hd = random_hd(kin, rng, {}) | (arm if kin == 21 else {})
            chain = build(tmp_path, kin, hd, choices if kin == 21 else {}).chain
            rotary = np.array([axis.kind == "rotary" for axis in chain.axes])
            for c in (0.0, 50.0):
                lower, upper = np.where(rotary, c - 20.0, -900.0), np.where(rotary, c + 20.0, 1500.0)
                rows = random_axis_values(chain.axis_map, rng, lower, upper, 30)
                found = np.array([q for q in map(chain.axis_map.q, rows) if np.isfinite(q).all()])
                low, high = chain.axis_map.q_bounds(lower, upper)
                assert len(found) > 3
                assert (found >= low - 1e-9).all()
                assert (found <= high + 1e-9).all()
                assert (low <= high).all()
