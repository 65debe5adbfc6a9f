"""The hand formulas of KIN_TYP 19 against one another and against what is known of its tilts."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from .loops_table import (
    TABLE_CHOICES,
    continued,
    heights,
    placed,
    random_hd,
    random_state,
    residuals,
    spokes,
    table_of,
    tool_in_workpiece,
    turn,
)

GUIDES = TABLE_CHOICES["kin19_guide"]
HD = {1: 80.0, 2: 500.0, 3: 150.0, 4: 300.0, 5: 40.0}


@pytest.mark.parametrize("guide", GUIDES)
def test_placed_tables_miss_nothing(guide: str) -> None:
    """The third joint is in its plane because the tilt has no torsion; rods have their length by either height."""
    rng = np.random.default_rng(3)
    for azimuth, numbering in itertools.product(TABLE_CHOICES["kin19_azimuth"], TABLE_CHOICES["kin19_numbering"]):
        conv = {"kin19_guide": guide, "kin19_azimuth": azimuth, "kin19_numbering": numbering}
        M = placed(HD, turn([*rng.uniform(-0.6, 0.6, 2), 0.0]), 30.0, conv)
        for own in itertools.product(*heights(HD, M, conv)):
            assert np.abs(residuals(HD, [0.0, 0.0, *own], M, conv)).max() < 1e-9


def test_the_guides_differ_by_the_square_of_the_sine_of_half_the_tilt() -> None:
    tilt = turn([math.radians(10.0) * math.cos(0.7), math.radians(10.0) * math.sin(0.7), 0.0])
    radial, centred = (placed(HD, tilt, 0.0, {"kin19_guide": guide}) for guide in GUIDES)
    apart = float(np.linalg.norm(radial[:3, 3] - centred[:3, 3]))
    assert apart == pytest.approx(150.0 * math.sin(math.radians(5.0)) ** 2, abs=1e-12)
    assert round(apart, 1) == 1.1


def test_a_torsion_is_missed() -> None:
    for guide in GUIDES:
        M = placed(HD, turn([0.2, 0.1, 0.0]), 0.0, {"kin19_guide": guide})
        M[:3, :3] = M[:3, :3] @ turn([0.0, 0.0, 1e-3])
        assert np.abs(residuals(HD, [0.0] * 5, M, {"kin19_guide": guide})[3:]).max() > 0.1


def test_spokes_stand_where_the_choices_say() -> None:
    first = {"deg_0": (1, 0), "deg_90": (0, 1), "deg_180": (-1, 0), "deg_minus_90": (0, -1)}
    for azimuth, (x, y) in first.items():
        for numbering, sense in (("ccw", 1.0), ("cw", -1.0)):
            out = spokes({"kin19_azimuth": azimuth, "kin19_numbering": numbering})
            assert out[0] == pytest.approx([x, y, 0.0], abs=1e-15)
            assert np.cross(out[0], out[1])[2] == pytest.approx(sense * math.sqrt(0.75))
            assert out.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-15)


def test_the_pose_is_read_back() -> None:
    rng = np.random.default_rng(4)
    conv = {"kin19_guide": "radial_planes"}
    axes, M = random_state(HD, conv, rng)
    assert np.allclose(table_of(HD, axes, tool_in_workpiece(HD, axes[0], axes[1], M, 33.0), 33.0), M, atol=1e-9)


@pytest.mark.parametrize("guide", GUIDES)
@pytest.mark.parametrize("carriages", TABLE_CHOICES["kin19_carriages"])
def test_what_is_followed_from_level_is_what_was_drawn(guide: str, carriages: str) -> None:
    rng = np.random.default_rng(5)
    conv = {"kin19_guide": guide, "kin19_carriages": carriages}
    for _ in range(2):
        hd = random_hd(rng)
        axes, M = random_state(hd, conv, rng)
        assert np.abs(continued(hd, axes, conv) - M).max() < 1e-6
