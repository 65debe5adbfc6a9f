"""Programming modes of KIN_TYP 91: two angles, or a vector, as a tool direction."""

from __future__ import annotations

import math

import numpy as np
import pytest

from chainbuild.errors import ChainbuildError
from chainbuild.formats.twincat.universal.directions import (
    DIRECTION_MODES,
    _wrapped,
    angles_of_direction,
    tool_direction,
)
from chainbuild.kinematics.displayed import wrapped
from tests.kit.universal import rotation

AXES = {"A": (1, 0, 0), "B": (0, 1, 0), "C": (0, 0, 1), "X": (1, 0, 0), "Y": (0, 1, 0), "Z": (0, 0, 1)}
# P-CHAN-00112: mode → first angle, second angle, tool direction at zero.
MODES = {14: "ABX", 15: "BAY", 16: "ACX", 17: "CAZ", 18: "BCY", 19: "CBZ", 20: "ABZ", 21: "BAZ"}


def by_hand(mode: int, first: float, second: float) -> np.ndarray:
    a, b, tool = MODES[mode]
    return (rotation(AXES[a], first) @ rotation(AXES[b], second))[:3, :3] @ np.array(AXES[tool], dtype=float)


@pytest.mark.parametrize("mode", MODES)
def test_two_angles_make_a_direction(mode: int) -> None:
    rng = np.random.default_rng(mode)
    for first, second in rng.uniform(-180, 180, (50, 2)):
        assert tool_direction(mode, (first, second)) == pytest.approx(by_hand(mode, first, second), abs=1e-14)


@pytest.mark.parametrize("mode", MODES)
def test_a_direction_has_two_pairs_of_angles(mode: int) -> None:
    rng = np.random.default_rng(mode)
    for first, second in rng.uniform(-180, 180, (50, 2)):
        direction = by_hand(mode, first, second)
        pairs = angles_of_direction(mode, direction * rng.uniform(0.1, 9.0))
        assert len(pairs) == 2
        for pair in pairs:
            assert by_hand(mode, *pair) == pytest.approx(direction, abs=1e-12)
        found = min(
            math.hypot(*(math.remainder(x - y, 360) for x, y in zip(pair, (first, second), strict=True)))
            for pair in pairs
        )
        assert found < 1e-9


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_along_the_first_axis_its_angle_is_free(mode: int, sign: float) -> None:
    direction = sign * np.array(AXES[MODES[mode][0]], dtype=float)
    ((first, second),) = angles_of_direction(mode, direction)
    assert first == 0.0
    for anything in (0.0, 33.0, -120.0):
        assert by_hand(mode, anything, second) == pytest.approx(direction, abs=1e-12)


def test_the_table_is_that_of_the_parameter() -> None:
    assert {n: m.first + m.second + m.tool for n, m in DIRECTION_MODES.items()} == MODES


def test_a_vector_need_not_be_normalised() -> None:
    assert tool_direction(10, (0, 3, 4)) == pytest.approx((0, 0.6, 0.8))


@pytest.mark.parametrize(("mode", "values"), [(10, (0, 0, 0)), (11, (1, 2)), (12, (1, 2)), (0, (1, 2)), (22, (1, 2))])
def test_refused(mode: int, values: tuple[float, ...]) -> None:
    with pytest.raises(ChainbuildError):
        tool_direction(mode, values)


def test_the_zero_vector_has_no_angles() -> None:
    with pytest.raises(ChainbuildError, match="zero"):
        angles_of_direction(17, (0, 0, 0))
    with pytest.raises(ChainbuildError, match="names no tool direction"):
        angles_of_direction(10, (0, 0, 1))


@pytest.mark.parametrize("mode", MODES)
def test_angles_are_in_half_open_turns_without_signed_zeros(mode: int) -> None:
    for direction in (
        *np.eye(3),
        *-np.eye(3),
        (1, 1, 0),
        (-1, 0, -1),
        (0, -1, 1),
        (-0.0, -1.0, -0.0),
        (-1.0, -0.0, 0.0),
    ):
        for pair in angles_of_direction(mode, direction):
            assert all(-180.0 < angle <= 180.0 for angle in pair)
            assert all(math.copysign(1.0, angle) == 1.0 for angle in pair if angle == 0.0)


@pytest.mark.parametrize(
    ("angle", "wanted"),
    [(180.0, 180.0), (-180.0, 180.0), (540.0, 180.0), (-540.0, 180.0), (-360.0, 0.0), (190.0, -170.0), (-190.0, 170.0)],
)
def test_angles_are_wrapped_as_displayed_ones_are(angle: float, wanted: float) -> None:
    for found in (_wrapped(angle), wrapped(angle)):
        assert (found, math.copysign(1.0, found)) == (wanted, math.copysign(1.0, wanted))
