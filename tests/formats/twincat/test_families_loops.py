"""The axis maps of closed loops, row by row: joints that close a loop move no tool, and only this would tell."""

from __future__ import annotations

import itertools
import math
import re
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.axismap import SamplingMap, random_axis_values
from chainbuild.formats.twincat.maps.scissors import LambdaMap
from chainbuild.formats.twincat.maps.struts import Column, Lever, ThreeRodsMap
from chainbuild.kinematics.closure import Closure
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
            assert chain.axis_map.axes(chain.axis_map.q(axes)) == pytest.approx(axes, abs=1e-9)
            J = chain.axis_map.dq_daxes(axes)
            for n, axis in enumerate(chain.axes):
                si = 1e-3 if axis.kind == "linear" else math.pi / 180.0
                step = np.zeros(len(axes))
                step[n] = 1e-7 / si
                way = chain.axis_map.q(axes + step) - chain.axis_map.q(axes - step)
                way[revolute] = np.remainder(way[revolute] + math.pi, math.tau) - math.pi
                assert way / 2e-7 == pytest.approx(J[:, n], abs=1e-5, rel=1e-5)


@pytest.mark.parametrize(("kin", "conventions"), CASES)
def test_the_rods_meet_their_pins_where_the_platform_is(kin: int, conventions: dict[str, str], tmp_path: Path) -> None:
    """The platform is where the formula by hand puts it; Pinocchio places the ends of each loop at one point."""
    rng = np.random.default_rng(seed_of("meet", kin, str(conventions)))
    hd = random_hd(kin, rng, conventions) | {21: {5: 120.0, 10: -70.0}, 209: {30: 25.0}}.get(kin, {})
    robot = build(tmp_path, kin, hd, conventions)
    for _ in range(3):
        axes = random_closing(kin, hd, conventions, rng)
        wanted = LOOPS[kin](hd, axes, 0.0, conventions)
        assert wanted is not None
        wanted[:3, 3] /= 1000.0
        assert robot.fk(axes).homogeneous == pytest.approx(wanted, abs=1e-9)
        assert Closure(robot).gap(robot.q(axes)) < 1e-12


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
                if kin != 21:  # a rod leans by a quarter turn at most
                    assert (-low[-1], high[-1]) == pytest.approx((math.pi / 2.0, math.pi / 2.0))


@pytest.mark.parametrize("angle", range(-360, 361, 30))
def test_right_angles_are_exact(angle: float) -> None:
    x, y = Column(float(angle), 1.0).centre(0.0)[0][:2]
    assert (x, y) == pytest.approx((math.cos(math.radians(angle)), math.sin(math.radians(angle))), abs=1e-15)
    if angle % 90 == 0:
        assert (x, y) == (round(x), round(y))


ARMS = [Column(120.0, 0.4, -1.0), Lever(-50.0, 0.15, 0.3), Lever(200.0, 0.05, 0.7, 20.0)]


@pytest.mark.parametrize("arm", ARMS)
def test_with_what_is_missing_a_rod_just_reaches(arm: Column | Lever) -> None:
    rng = np.random.default_rng(4)
    told = []
    for _ in range(300):
        p = tuple(rng.uniform(-1.0, 1.0, 3).tolist())
        rod = float(rng.uniform(0.1, 1.8))
        missing = arm.missing(p, rod)
        if arm.values(p, rod, 1.0):
            assert missing <= 0.0
            continue
        told.append(missing > 0.0)
        beyond = math.copysign(1e-9, missing)
        assert arm.values(p, rod + missing + beyond, 1.0)
        assert not arm.values(p, rod + missing - beyond, 1.0)
    assert set(told) == ({True} if arm.kind == "linear" else {True, False})


def circle_of_two(a: np.ndarray, b: np.ndarray, rod: float) -> np.ndarray:
    """Return 4000 places at the distance of a rod from both centres."""
    aside = np.linalg.svd((b - a)[None])[2][1:]
    turns = np.linspace(0.0, math.tau, 4000)[:, None]
    radius = math.sqrt(rod**2 - float(np.linalg.norm(b - a)) ** 2 / 4.0)
    return (a + b) / 2.0 + radius * (np.cos(turns) * aside[0] + np.sin(turns) * aside[1])


@pytest.mark.parametrize(("radii", "word"), [((0.2, 0.1, 0.45), "long"), ((0.48, 0.49, 0.46), "short")])
def test_the_rod_that_misses_the_others_by_most(radii: tuple[float, ...], word: str) -> None:
    """The third rod misses the circle on which two rods meet by so much at best."""
    rng, rod = np.random.default_rng(6), 0.5
    arms = tuple(Column(120.0 * n + 90.0, radius) for n, radius in enumerate(radii))
    map_, told = ThreeRodsMap(arms, rod, 1.0), []
    for _ in range(400):
        axes = rng.uniform(-550.0, 550.0, 3)
        refused = map_.refusal(axes)
        if refused is None:
            continue
        words = re.search(r"rods? .*? ([0-9.]+) mm too (short|long)", refused.message)
        assert words
        centres = np.array([arm.centre(value / 1000.0)[0] for arm, value in zip(arms, axes, strict=True)])
        gap = max(float(np.linalg.norm(a - b)) - 2.0 * rod for a, b in itertools.combinations(centres, 2))
        if gap > 0.0:
            assert (float(words[1]), words[2]) == (pytest.approx(1000.0 * gap, rel=1e-5), "short")
            assert "together" in refused.message
            continue
        misses = []
        for n in range(3):
            others = np.delete(centres, n, axis=0)
            off = np.linalg.norm(circle_of_two(*others, rod) - centres[n], axis=1) - rod
            misses.append(off.min() if off.min() > 0.0 else min(off.max(), 0.0))
        worst = int(np.argmax(np.abs(misses)))
        assert f"rod of Z{worst + 1} " in refused.message
        assert float(words[1]) == pytest.approx(1000.0 * abs(misses[worst]), abs=1e-2)
        assert words[2] == ("short" if misses[worst] > 0.0 else "long")
        told.append(words[2])
    assert told.count(word) > 2


@pytest.mark.parametrize("word", ["short", "long"])
@pytest.mark.parametrize("rods", [(0.3, 0.5), (0.6, 0.2)])
def test_by_how_much_the_rods_of_a_lambda_miss_one_another(rods: tuple[float, float], word: str) -> None:
    """Joints 120 mm apart across the slides: |BC|² = 120² + (X2 - X1)²."""
    way = 900.0 if word == "short" else 50.0
    apart = math.hypot(way, 120.0)
    wrong = apart - 800.0 if word == "short" else 1000.0 * abs(rods[0] - rods[1]) - apart
    for x1, x2 in ((10.0, 10.0 + way), (10.0 + way, 10.0)):
        refused = LambdaMap((0.0, 0.0), (0.1, 0.22), rods, 1.0).refusal(np.array([x1, x2, 5.0, 20.0]))
        assert refused is not None
        assert f"too {word}" in refused.message
        (told,) = re.findall(r"([0-9.]+) mm too (?:short|close)", refused.message)
        assert float(told) == pytest.approx(wrong, rel=1e-5)


def test_a_rod_that_does_not_reach_from_its_slide() -> None:
    """C at (0.2, 0.1), rod of 0.5 at θ; the slide of B 0.25 across: its rod of 0.3 has to bridge what is left."""
    lambda_map = LambdaMap((0.2, 0.0), (0.1, 0.25), (0.5, 0.3), 1.0)
    for theta in np.radians([-170.0, -80.0, -30.0, 20.0, 60.0, 90.0, 130.0]):
        q = np.array([0.05, theta, 0.1, 0.2, 0.0, 0.0])
        missing = abs(0.1 + 0.5 * math.sin(theta) - 0.25) - 0.3
        words = lambda_map.unreached(q)
        assert words == (f"the rod of X2 is {1000.0 * missing:.6g} mm too short" if missing > 0.0 else "")
        assert (len(lambda_map.closing(q)[1]) == 2) == (missing <= 0.0)
