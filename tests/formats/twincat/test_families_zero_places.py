"""Where flange, axes and workpiece stand at zero, and which way the tool's slides run, as the manual's tables say."""

from __future__ import annotations

import math

import numpy as np
import pytest

from chainbuild.formats.twincat.lists.hdtable import type_data
from chainbuild.formats.twincat.recipes.recipe import Params
from tests.kit.kin_types import build

# Type, HD values → frame and its place in the machine base at zero of all axes.
PLACES: list[tuple[int, dict[int | str, float], str, tuple[float, float, float]]] = [
    (1, {2: 250.0, 3: 3.0, 4: 4.0}, "B", (3, 4, -250)),
    (1, {1: 100.0, 5: 5.0, 6: 6.0}, "flange", (5, 6, -100)),
    (1, {7: 7.0, 8: 8.0, 9: 9.0}, "C", (7, 8, 9)),
    (13, {1: 100.0}, "flange", (0, 0, -100)),
    (23, {1: 100.0}, "flange", (0, 0, -100)),
    (36, {1: 100.0}, "tool", (0, 0, -100)),
    (52, {1: 100.0}, "flange", (0, 0, -100)),
    (57, {1: 100.0}, "flange", (0, 0, -100)),
    (57, {4: 4.0, 5: 5.0, 6: 6.0, 7: 70.0, 8: 80.0, 9: 90.0}, "C", (74, 85, 96)),
    (57, {7: 70.0, 8: 80.0, 9: 90.0}, "B", (70, 80, 90)),
    (57, {14: 14.0, 15: 15.0, 16: 16.0}, "workpiece", (14, 15, 16)),
    (61, {1: 100.0, 2: 2.0, 3: 3.0}, "flange", (2, 3, -100)),
    (61, {10: 1.0, 11: 2.0, 12: 3.0, 17: 10.0, 18: 20.0, 19: 30.0}, "workpiece", (11, 22, 33)),
    (63, {1: 100.0, 2: 2.0, 3: 3.0}, "flange", (2, 3, -100)),
    (64, {4: 4.0, 5: 5.0, 6: 6.0, 10: 10.0, 11: 11.0, 12: 12.0}, "A", (14, 16, 18)),
    (64, {7: 7.0, 8: 8.0, 9: 9.0}, "C2", (7, 8, 9)),
    (64, {13: 13.0, 14: 14.0, 15: 15.0}, "workpiece", (13, 14, 15)),
    (80, {4: 4.0, 5: 5.0, 6: 6.0}, "B", (4, 5, 6)),
    (80, {7: 7.0, 8: 8.0, 9: 9.0}, "workpiece", (7, 8, 9)),
    (81, {4: 4.0, 5: 5.0, 6: 6.0}, "A", (4, 5, 6)),
    (81, {7: 7.0, 8: 8.0, 9: 9.0}, "workpiece", (7, 8, 9)),
    (82, {1: 100.0, 2: 2.0, 3: 3.0}, "flange", (-2, -3, -100)),
    (82, {7: 7.0, 8: 8.0, 9: 9.0}, "B", (-7, -8, -9)),
    (82, {10: 10.0, 11: 11.0, 12: 12.0}, "workpiece", (10, 11, 12)),
    (202, {2: 2.0, 3: 3.0, 4: 4.0}, "YQ", (2, 3, 4)),
    (202, {6: 6.0, 7: 7.0, 8: 8.0}, "CS", (6, 7, 8)),
    (203, {2: 2.0, 3: 3.0, 4: 4.0}, "YL", (2, 3, 4)),
    (203, {6: 6.0, 7: 7.0, 8: 8.0}, "C", (6, 7, 8)),
    (203, {1: 100.0}, "tool", (0, 0, -100)),
]
SLIDES = {"X": (1, 0, 0), "Y": (0, 1, 0), "Z": (0, 0, 1), "XQ": (1, 0, 0), "ZQ": (0, 0, 1), "ZL": (0, 0, 1)}
TYPES = (1, 13, 14, 23, 34, 36, 52, 57, 58, 61, 63, 64, 80, 81, 82, 85, 202, 203, 205)


@pytest.mark.parametrize(("kin", "hd", "frame", "place"), PLACES)
def test_place_at_zero(kin: int, hd: dict[int | str, float], frame: str, place: tuple[float, float, float]) -> None:
    built = build(kin, hd)
    assert built.base_mm(frame, built.zeros()) == pytest.approx(place, abs=1e-12)


@pytest.mark.parametrize("kin", TYPES)
def test_slides_run_along_their_names(kin: int) -> None:
    """Seen from the workpiece every slide moves the tool along its own letter, whichever of the two it carries."""
    built = build(kin)
    for n, row in enumerate(type_data()[kin].axes):
        if row.kind == "linear":
            moved = built.mm(100.0 * np.eye(len(built.robot.axes))[n]) - built.mm(built.zeros())
            assert moved == pytest.approx(100.0 * np.array(SLIDES[row.name]), abs=1e-12)


@pytest.mark.parametrize("kin", TYPES)
def test_rotary_axes_lie_at_the_origin_without_offsets(kin: int) -> None:
    built = build(kin)
    for row in type_data()[kin].axes:
        if row.kind == "rotary":
            assert built.base_mm(row.name, built.zeros()) == pytest.approx((0, 0, 0), abs=1e-12)


def test_a_zero_of_the_list_has_no_sign() -> None:
    """Written as -0: what is shown of it would be -0."""
    value = Params(type_data()[58], {1: -0.0}).mm(1)
    assert (value, math.copysign(1.0, value)) == (0.0, 1.0)
