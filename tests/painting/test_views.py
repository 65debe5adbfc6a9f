"""Views and windows: right-handed, and where a point of the site is seen."""

from __future__ import annotations

import numpy as np
import pytest

from chainbuild.painting.stage import framed
from chainbuild.painting.views import VIEWS, Window, window_around
from tests.kit.placed import placed


@pytest.mark.parametrize("name", VIEWS)
def test_views_are_right_handed(name: str) -> None:
    view = VIEWS[name]  # type: ignore[index]
    R = np.array([view.right, view.up, view.toward])
    assert pytest.approx(np.eye(3), abs=1e-11) == R @ R.T
    assert np.cross(view.right, view.up) == pytest.approx(view.toward, abs=1e-11)


def test_where_one_looks_from() -> None:
    window = Window(0.0, 0.0, 100.0, 10, 10)
    assert window.spot(VIEWS["front"], (1, 2, 3)) == (100.0, -300.0)
    assert window.spot(VIEWS["right"], (1, 2, 3)) == (200.0, -300.0)
    assert window.spot(VIEWS["top"], (1, 2, 3)) == (100.0, -200.0)
    # From the right, from before, from above: X runs right and down, Y right and up, Z up.
    x, y, z = (window.spot(VIEWS["iso"], axis) for axis in np.eye(3).tolist())
    assert x[0] > 0.0 < x[1]
    assert y[0] < 0.0 or y[1] < 0.0
    assert z == pytest.approx((0.0, -100.0 * np.cos(np.radians(26.0))))
    toward = VIEWS["iso"].toward
    assert toward[0] > 0.0 > toward[1]
    assert toward[2] > 0.0


def test_a_window_shows_its_rectangle_in_the_middle() -> None:
    window = window_around((1.0, -1.0), (3.0, 0.0), 240, 220, 20)
    assert window.scale == 100.0
    view = VIEWS["top"]
    assert window.spot(view, (1.0, -1.0, 0.0)) == pytest.approx((20.0, 160.0))
    assert window.spot(view, (3.0, 0.0, 0.0)) == pytest.approx((220.0, 60.0))
    half = window.rescaled(50.0)
    assert half.spot(view, (2.0, -0.5, 0.0)) == pytest.approx((120.0, 110.0))
    assert half.spot(view, (3.0, -0.5, 0.0)) == pytest.approx((170.0, 110.0))
    assert window.moved(7, 9).spot(view, (2.0, -0.5, 0.0)) == pytest.approx((127.0, 119.0))
    assert window.finer(2).spot(view, (2.0, -0.5, 0.0)) == pytest.approx((240.0, 220.0))


def test_bodies_and_points_fill_the_picture() -> None:
    bodies = [
        placed("box", (2, 1, 1), (0, 0, 0)),
        placed("sphere", (0.5,), (0, 0, 2)),
        placed("cylinder", (1, 4), (3, 0, 0)),
    ]
    window = framed(bodies, VIEWS["front"], 540, 520, 20)
    assert window.scale == pytest.approx(100.0)  # from x = -1 to 4, z = -2 to 2.5
    assert window.left == pytest.approx(-1.2)
    assert window.top == pytest.approx(2.85)
    assert framed(bodies, VIEWS["front"], 540, 520, 20, [(9, 0, 0)]).scale == pytest.approx(50.0)
