"""The page's closed loops where rods just reach, and its angles where they are right."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Page

from chainbuild.formats.twincat.maps.arms import Column, Lever, direction
from chainbuild.formats.twincat.maps.scissors import LambdaMap
from chainbuild.formats.twincat.maps.struts import ThreeRodsMap
from chainbuild.formats.twincat.maps.table import TableMap
from chainbuild.formats.twincat.maps.table_rods import TableRods
from chainbuild.frames import cos_sin_deg
from chainbuild.inspect.chain_data import as_json
from tests.kit.module_page import computed, module_page, page_modules

ROOTED = 1e-7  # m, rad: where rods just reach, rounding stands below a root
SIZES = (0.3, 0.33, 0.41, 0.7, 0.9, 1.1)  # m; some sums and squares round upwards, others downwards


@pytest.fixture(scope="module")
def page(browser: Browser) -> Page:
    return module_page(browser, page_modules())


def compare(page: Page, axis_map: Any, rows: list[list[float]], between: list[list[float]]) -> None:
    """Compare joint values and values that close where rounding decides whether there are any."""
    script = """async ({ data, rows, between }) => {
      const loops = await import("cb/loops");
      const map = new loops[data.class](data);
      return { q: rows.map((row) => map.q(row)), closing: between.map((q) => map.closing(q)) };
    }"""
    found = computed(page, script, {"data": as_json(axis_map), "rows": rows, "between": between})
    for row, q in zip(rows, found["q"], strict=True):
        wanted = axis_map.q(np.array(row))
        np.testing.assert_allclose(np.array(q, dtype=float), wanted, rtol=0.0, atol=ROOTED, err_msg=str(row))
    for one, values in zip(between, found["closing"], strict=True):
        for mine, wanted in zip(values, axis_map.closing(np.array(one)), strict=True):
            np.testing.assert_allclose(mine, wanted, rtol=0.0, atol=1e3 * ROOTED)


def test_scissors_in_line_and_across(page: Page) -> None:
    for rod in SIZES:
        for other in SIZES:
            axis_map = LambdaMap((0.0, 0.0), (0.0, 0.0), (rod, other), 1.0)
            ends = [rod + other, abs(rod - other)]
            rows = [[0.0, 1e3 * (end + off), 0.0, 0.0] for end in ends for off in (-1e-9, 0.0, 1e-9)]
            # D as far off the slide of B as its rod is long.
            theta = math.asin(min(1.0, other / rod))
            between = [
                [0.0, side * theta + off, 0.0, 0.0, 0.0, 0.0] for side in (1.0, -1.0) for off in (-1e-9, 0, 1e-9)
            ]
            compare(page, axis_map, rows, between)


@pytest.mark.parametrize("hanging", [1.0, -1.0])
def test_rods_of_a_tripod_that_just_reach(page: Page, hanging: float) -> None:
    for rod in SIZES:
        arms = tuple(Column(90.0 * n, rod) for n in range(3))
        axis_map = ThreeRodsMap(arms, rod, hanging)
        rows = [[100.0 * z] * 3 for z in range(5)] + [[0.0, 1e-4, 0.0], [0.0, 0.0, 1e-4]]
        # Circles about the columns touch in the middle; beside it one rod or another is too short.
        between = [[x, y, 0.1, *[0.0] * 9] for x in (0.0, 1e-9) for y in (0.0, -1e-9)]
        compare(page, axis_map, rows, between)


def test_centres_on_a_line_or_on_one_another(page: Page) -> None:
    line = (Column(0.0, 0.1), Column(180.0, 0.1), Column(0.0, 0.2))
    one = (Column(0.0, 0.1), Column(0.0, 0.1), Column(120.0, 0.1))
    for arms in (line, one):
        axis_map = ThreeRodsMap(arms, 0.5, 1.0)
        rows = [[0.0, 0.0, 0.0], [1e-7, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 30.0]]
        assert np.isnan(axis_map.q(np.array(rows[0]))).all()
        compare(page, axis_map, rows, [])


def test_levers_that_just_reach(page: Page) -> None:
    for rod in SIZES:
        arms = tuple(Lever(90.0 * n, 0.1, 0.25) for n in range(3))
        axis_map = ThreeRodsMap(arms, rod, 1.0)
        stretched = [[0.1 + 0.25 + rod + off, 0.0, 0.0] for off in (-1e-9, 0.0, 1e-9)]
        folded = [[0.1 + abs(0.25 - rod) + off, 0.0, 0.0] for off in (-1e-9, 0.0, 1e-9)]
        aside = [[0.1, rod + off, -0.25] for off in (-1e-9, 0.0, 1e-9)]
        compare(page, axis_map, [], [[*p, *[0.0] * 9] for p in [*stretched, *folded, *aside, [0.1, 0.0, 0.0]]])


@pytest.mark.parametrize("radial", [True, False])
def test_tables_beyond_upright_and_rods_too_short(page: Page, radial: bool) -> None:
    axis_map = TableMap(TableRods.of((0.0, 120.0, 240.0), 0.15, 0.3, 0.2, -1.0, radial))
    shifts = [0.01, 0.02, 0.3] if not radial else [0.01, 0.02, 0.3, 0.01, -0.02]
    tilts = [(0.2, 0.1, 0.05), (1.5, 1.2, 0.4), (math.pi / 2, 0.3, 0.0), (0.3, math.pi / 2, 0.0), (2.0, 0.1, 0.3)]
    rest = [0.0] * (17 - len(shifts) - 3)
    between = [[*shifts, *tilt, *rest] for tilt in tilts]
    assert [len(axis_map.closing(np.array(q))[2]) for q in between][3:] == [0, 0]
    compare(page, axis_map, [], between)


def test_right_angles_and_remainders(page: Page) -> None:
    degrees = [45.0 * n for n in range(-20, 21)] + [90.0 + 5e-13, 180.0 - 5e-13, -270.0 + 1e-9, 33.0]
    pairs = [(0.5 * n, whole) for n in range(-30, 31) for whole in (1.0, 2.0, math.tau, 360.0)]
    script = """async ({ degrees, pairs }) => {
      const units = await import("cb/units");
      return {
        turns: degrees.map(units.cosSinDeg),
        azimuths: degrees.map(units.azimuth),
        rests: pairs.map(([value, whole]) => units.remainder(value, whole)),
        signs: [-2, -0, 0, 2].map((like) => units.withSign(3, like)),
      };
    }"""
    found = computed(page, script, {"degrees": degrees, "pairs": pairs})
    exact = [n for n, angle in enumerate(degrees) if abs(angle / 90.0 - round(angle / 90.0)) < 1e-13]
    for name, wanted in (("turns", cos_sin_deg), ("azimuths", direction)):
        both = np.array(found[name]), np.array([wanted(angle) for angle in degrees])
        np.testing.assert_allclose(*both, rtol=0.0, atol=1e-13)
        assert np.array_equal(both[0][exact], np.round(both[0][exact]))
    assert found["rests"] == [math.remainder(value, whole) for value, whole in pairs]
    assert found["signs"] == [-3, -3, 3, 3]
