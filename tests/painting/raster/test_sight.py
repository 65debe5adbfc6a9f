"""Pixels: which body each shows, how deep, how bright, by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from chainbuild.frames import rot_x, rot_y
from chainbuild.painting.raster.pixels import painted
from chainbuild.painting.raster.sight import NOTHING, render
from chainbuild.painting.views import VIEWS, Window
from tests.kit.placed import placed

WINDOW = Window(-1.0, 1.0, 100.0, 200, 200)  # ±1 m
TOP = VIEWS["top"]


def pixel(x: float, y: float) -> tuple[int, int]:
    """Return row and column of a place seen from above."""
    return int((1.0 - y) * 100.0), int((x + 1.0) * 100.0)


def test_nearest_bodies_are_seen() -> None:
    bodies = [placed("box", (1, 1, 0.2), (0, 0, 0)), placed("box", (0.4, 0.4, 0.2), (0.2, 0, 1))]
    buffers = render(bodies, TOP, WINDOW)
    assert buffers.bodies[pixel(0.2, 0.0)] == 1
    assert buffers.bodies[pixel(-0.3, 0.3)] == 0
    assert buffers.bodies[pixel(0.8, 0.8)] == NOTHING
    assert buffers.depth[pixel(0.2, 0.0)] == pytest.approx(1.1)
    assert buffers.depth[pixel(-0.3, 0.3)] == pytest.approx(0.1)
    assert np.bincount(buffers.bodies[buffers.bodies >= 0]).tolist() == [10000 - 1600, 1600]


def test_depths_of_round_and_slanted_bodies() -> None:
    ball = render([placed("sphere", (0.5,), (0, 0, 0.3))], TOP, WINDOW)
    assert ball.depth[pixel(0.305, 0.005)] == pytest.approx(0.3 + math.sqrt(0.25 - 0.305**2 - 0.005**2), abs=1e-6)
    lying = render([placed("cylinder", (0.5, 1.0), (0, 0, 0), rot_y(90.0))], TOP, WINDOW)
    assert lying.depth[pixel(0.1, 0.305)] == pytest.approx(math.sqrt(0.25 - 0.305**2), abs=1e-6)
    assert lying.bodies[pixel(0.52, 0.0)] == NOTHING
    slanted = render([placed("box", (1, 1, 0.2), (0, 0, 0), rot_x(30.0))], TOP, WINDOW)
    # Its upper face: z = tan 30° · y + 0.1 / cos 30°.
    expected = math.tan(math.radians(30.0)) * 0.205 + 0.1 / math.cos(math.radians(30.0))
    assert slanted.depth[pixel(0.0, 0.205)] == pytest.approx(expected, abs=1e-6)


def test_light_falls_from_above_left_and_before() -> None:
    box = render([placed("box", (0.5, 0.5, 0.5), (0, 0, 0))], VIEWS["iso"], WINDOW)
    shades = {int(face): float(box.shade[box.face == face][0]) for face in np.unique(box.face) if face >= 0}
    assert len(shades) == 3
    x, y, z = shades.values()
    assert z > y > x
    ball = render([placed("sphere", (0.5,), (0, 0, 0))], VIEWS["front"], WINDOW).shade
    assert ball[pixel(-0.3, 0.3)] > ball[pixel(0.3, 0.3)] > ball[pixel(0.3, -0.3)]
    # Straight on: 0.8 + 0.32 · 0.57.
    assert ball[pixel(0.0, 0.0)] == pytest.approx(0.9824, abs=0.006)


def test_faces_in_one_plane_show_the_first_body() -> None:
    bodies = [placed("box", (0.4, 0.4, 0.2), (0, 0, 0)), placed("box", (1.0, 1.0, 0.4), (0, 0, -0.1))]
    for order in (1, -1):
        shown = render(bodies[::order], TOP, WINDOW).bodies
        assert shown[pixel(0.0, 0.0)] == 0
        assert np.unique(shown[60:140, 60:140]).tolist() == ([0, 1] if order == 1 else [0])


def test_hidden_bodies_have_no_pixels() -> None:
    bodies = [placed("box", (1, 1, 1), (0, 0, 0)), placed("box", (0.5, 0.5, 0.5), (0, 0, 0))]
    shown = render(bodies, VIEWS["iso"], WINDOW).bodies
    assert set(np.unique(shown)) == {NOTHING, 0}


def test_colours_outlines_and_ground() -> None:
    pixels = painted([placed("box", (1, 1, 0.2), (0, 0, 0), grey=0.5)], TOP, WINDOW)
    assert pixels.shape == (200, 200, 3)
    assert pixels[pixel(0.0, 0.0)].tolist() == [125] * 3  # 255 · 0.5 · 0.9824
    assert pixels[pixel(0.9, 0.9)].tolist() == [249, 250, 251]
    border = pixels[pixel(0.0, 0.495)]
    assert (border < 100).all()


def test_bodies_out_of_the_picture_are_left_out() -> None:
    buffers = render([placed("box", (1, 1, 1), (9, 0, 0)), placed("sphere", (0.2,), (1, 1, 0))], TOP, WINDOW)
    assert 0 < (buffers.bodies == 1).sum() < 400
    assert (buffers.bodies != 0).all()
