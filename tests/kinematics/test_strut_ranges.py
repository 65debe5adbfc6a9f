"""Ranges that struts leave axes without limits, and what draws states of loops, on files without an overlay."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from chainbuild import CheckOptions, MapSpec, Robot, crosscheck
from chainbuild.analysis.collision.pairs import classify_pairs
from chainbuild.analysis.workspace.maps import make_map
from chainbuild.chain.bodies.shapes import shown_limits
from chainbuild.chain.closing import drawn_range
from chainbuild.comparison.samples import random_samples
from chainbuild.inspect.sweep import rest_pose, swept_poses
from chainbuild.kinematics.closure import closing_axes
from tests.hand.loops_cases import channel_list, random_hd
from tests.hand.loops_hand import LOOPS
from tests.kit.draws import seed_of

TYPES = (12, 21, 37, 209)


def bare(folder: Path, kin: int, hd: dict[int, float]) -> Robot:
    path = folder / f"kin{kin}.lis"
    path.write_text(channel_list(kin, hd))
    return Robot.load(path)


@pytest.mark.parametrize("kin", TYPES)
def test_states_are_drawn_where_the_struts_let_the_axes_stand(kin: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("strut ranges", kin))
    for _ in range(3):
        hd = random_hd(kin, rng, {})
        robot = bare(tmp_path, kin, hd)
        rows = closing_axes(robot, rng, 200)
        lower, upper = drawn_range(robot.chain)
        assert len(rows) == 200
        assert ((rows >= lower) & (rows <= upper)).all()
        assert all(LOOPS[kin](hd, row.tolist(), 0.0, {}) is not None for row in rows)
        shown = shown_limits(robot.chain)
        count = {12: 3, 21: 2, 37: 3, 209: 3}[kin]
        for n in range(count):
            assert (shown[0][n], shown[1][n]) == (lower[n], upper[n])
            # A good part of the range is met.
            assert np.ptp(rows[:, n]) > 0.6 * (upper[n] - lower[n])
        assert [axis.assumed for axis in robot.axes] == [True] * len(robot.axes)


@pytest.mark.parametrize("kin", [12, 209])
def test_carriages_as_far_apart_as_two_rods_reach(kin: int, tmp_path: Path) -> None:
    """No two carriages of a closed state are farther apart than the range is wide, and some are nearly as far."""
    hd = {5: 420.0, 6: 90.0, 7: 650.0}
    robot = bare(tmp_path, kin, hd)
    lower, upper = (bound[:3] for bound in drawn_range(robot.chain))
    # Two columns are 330·√3 apart, two rods 1300 long.
    assert upper - lower == pytest.approx(math.sqrt(1300.0**2 - 3.0 * 330.0**2), abs=1e-9)
    assert lower == pytest.approx(-upper)
    far = [0.4995 * float(upper[0] - lower[0]), -0.4995 * float(upper[0] - lower[0])]
    thirds = np.linspace(-600.0, 600.0, 2401)
    rest = [0.0, 0.0] if kin == 209 else []
    assert any(LOOPS[kin](hd, [*far, third, *rest], 0.0, {}) is not None for third in thirds)
    beyond = [far[0] * 1.002, far[1] * 1.002]
    assert not any(LOOPS[kin](hd, [*beyond, third, *rest], 0.0, {}) is not None for third in thirds)


@pytest.mark.parametrize("hd5", [50.0, 0.0, -40.0, 350.0])
def test_levers_between_the_dead_points_of_their_common_motion(hd5: float, tmp_path: Path) -> None:
    """Moved alike, the levers lower the platform all the way through the range, and no farther."""
    hd = {4: 100.0, 5: 100.0 + hd5, 6: 420.0, 7: 200.0, 8: 10.0, 9: 20.0, 10: -30.0}
    robot = bare(tmp_path, 37, hd)
    lower, upper = drawn_range(robot.chain)
    assert upper - lower == pytest.approx(np.full(3, upper[0] - lower[0]))
    assert lower - lower[0] == pytest.approx([0.0, 10.0, -40.0])  # HD8 to HD10

    def height(share: float) -> float | None:
        T = LOOPS[37](hd, (lower + share * (upper - lower)).tolist(), 0.0, {})
        return None if T is None else float(T[2, 3])

    inside = [height(share) for share in np.linspace(0.001, 0.999, 60)]
    assert all(value is not None for value in inside)
    assert (np.diff(np.array(inside, dtype=float)) < 0.0).all()
    after = height(1.001), height(1.003)
    assert None in after or after[1] > after[0]  # type: ignore[operator]
    before = height(-0.003), height(-0.001)
    assert None in before or before[1] > before[0]  # type: ignore[operator]


def test_slides_as_far_apart_as_both_rods_reach(tmp_path: Path) -> None:
    hd = {2: 500.0, 3: 600.0, 4: 450.0, 5: 200.0}
    for conventions, width in (({}, math.sqrt(1100.0**2 - 200.0**2)), ({"kin21_hd5_along": "x"}, 1100.0)):
        path = tmp_path / "kin21.lis"
        path.write_text(channel_list(21, hd))
        robot = Robot.load(path, conventions=conventions)
        lower, upper = drawn_range(robot.chain)
        assert upper[:2] - lower[:2] == pytest.approx([width, width])
        for sign in (1.0, -1.0):
            shift = 200.0 if conventions else 0.0
            apart = sign * width - shift
            assert LOOPS[21](hd, [0.0, apart * 0.999 - 0.001 * shift, 0.0, 0.0], 0.0, conventions) is not None
            assert LOOPS[21](hd, [0.0, apart + sign * 2.0, 0.0, 0.0], 0.0, conventions) is None
            x1 = (-apart - shift) / 2.0
            for value, n in ((x1, 0), (x1 + apart, 1)):
                assert lower[n] - 1e-9 <= value <= upper[n] + 1e-9


def test_limits_that_somebody_gives_are_kept(tmp_path: Path) -> None:
    robot = Robot.load("tripod_kin12")
    assert [bound.tolist() for bound in drawn_range(robot.chain)] == [[700.0] * 3, [1100.0] * 3]
    delta = bare(tmp_path, 37, {4: 40.0, 5: 150.0, 6: 500.0, 7: 200.0, 11: -20.0, 12: 70.0})
    assert [bound.tolist() for bound in drawn_range(delta.chain)] == [[-20.0] * 3, [70.0] * 3]


@pytest.mark.parametrize("kin", TYPES)
def test_what_draws_states_works_without_an_overlay(kin: int, tmp_path: Path) -> None:
    """The page, a map, the pairs that can collide, a comparison: each of a file that limits nothing."""
    robot = bare(tmp_path, kin, random_hd(kin, np.random.default_rng(seed_of("bare", kin)), {}))
    swept = swept_poses(robot, rest_pose(robot))
    assert np.isfinite([robot.q(axes) for axes in swept]).all()
    assert np.ptp(swept, axis=0).min() > 0.0  # every axis moves
    samples = random_samples(robot, 100, np.random.default_rng(1))
    assert sum(np.isfinite(robot.chain.axis_map.q(row)).all() for row in samples) > 90
    if kin == 21:
        found = make_map(robot, MapSpec(kind="volume", cells=4, samples=200), workers=1)
        assert np.isfinite(found.smallest).sum() > 3
    assert classify_pairs(robot, samples=20).pairs
    checked = crosscheck(robot, lambda axes: robot.fk(axes).homogeneous, options=CheckOptions(30, kind="fk"))
    assert checked.forward is not None
