"""Light on colours: darker below a shade of 1, paler above it."""

from __future__ import annotations

import pytest

from chainbuild.painting.colours import hex_colour, lit


def test_light_darkens_and_pales() -> None:
    assert lit((0.2, 0.5, 1.0), 0.5) == pytest.approx((0.1, 0.25, 0.5))
    assert lit((0.2, 0.5, 1.0), 1.25) == pytest.approx((0.4, 0.625, 1.0))
    assert lit((0.2, 0.5, 1.0), 1.0) == pytest.approx((0.2, 0.5, 1.0))


def test_colours_as_text() -> None:
    assert hex_colour((0.0, 0.4, 1.0)) == "#0066ff"
    assert hex_colour((-0.1, 1.2, 0.2)) == "#00ff33"
