"""Meshes as pixels: those of a box show what the box itself shows, and a picture holds them in either format."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from base64 import b64decode
from dataclasses import replace
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import chainbuild
from chainbuild.frames import rot_x, rot_y, rot_z
from chainbuild.painting.raster.sight import render
from chainbuild.painting.stage import PlacedBody
from chainbuild.painting.views import VIEWS, ViewName, Window
from tests.kit.mesh_files import box, surface, write_arm
from tests.kit.placed import placed

WINDOW = Window(-1.0, 1.0, 100.0, 200, 200)  # ±1 m
SIZE = (0.9, 0.5, 0.3)


def meshed(body: PlacedBody) -> PlacedBody:
    """Return a box as a mesh."""
    half = np.array(body.body.dimensions) / 2
    return replace(body, body=replace(body.body, kind="mesh", surface=surface(box(-half, half))))


@pytest.mark.parametrize("view", ["iso", "front", "top", "right"])
def test_a_box_of_triangles_looks_like_a_box(view: ViewName) -> None:
    block = placed("box", SIZE, (0.1, -0.2, 0.15), rot_z(20.0) @ rot_y(35.0) @ rot_x(-50.0))
    exact, found = (render([one], VIEWS[view], WINDOW) for one in (block, meshed(block)))
    seen = (exact.bodies == 0) & (found.bodies == 0)
    assert seen.sum() > 1000
    assert ((exact.bodies == 0) != (found.bodies == 0)).sum() <= 2
    np.testing.assert_allclose(found.depth[seen], exact.depth[seen], atol=1e-5)
    np.testing.assert_allclose(found.shade[seen], exact.shade[seen], atol=1e-5)


def test_the_nearest_is_seen_whichever_comes_first() -> None:
    low, high = placed("box", SIZE, (0, 0, 0)), placed("box", (0.3, 0.3, 0.3), (0, 0, 1))
    for bodies in ([meshed(low), high], [low, meshed(high)], [meshed(low), meshed(high)]):
        ahead, behind = render(bodies, VIEWS["top"], WINDOW), render(bodies[::-1], VIEWS["top"], WINDOW)
        assert (ahead.bodies[100, 100], behind.bodies[100, 100]) == (1, 0)
        assert (ahead.bodies[100, 60], behind.bodies[100, 60]) == (0, 1)


def test_triangles_that_run_the_other_way_are_lit_alike() -> None:
    block = meshed(placed("box", SIZE, (0, 0, 0), rot_x(30.0)))
    assert block.body.surface is not None
    turned = replace(block.body.surface, corners=block.body.surface.corners[:, ::-1])
    inside_out = replace(block, body=replace(block.body, surface=turned))
    one, other = (render([body], VIEWS["iso"], WINDOW) for body in (block, inside_out))
    np.testing.assert_allclose(one.shade, other.shade, atol=1e-5)


def test_bodies_beside_the_picture_cost_nothing() -> None:
    found = render([meshed(placed("box", SIZE, (9.0, 9.0, 0)))], VIEWS["top"], WINDOW)
    assert (found.face < 0).all()


def test_pictures_of_meshes(tmp_path: Path) -> None:
    robot = chainbuild.Robot.from_urdf(write_arm(tmp_path))
    plain = chainbuild.picture(robot, tmp_path / "a.png")
    drawn = chainbuild.picture(robot, tmp_path / "a.svg", view="sheet")
    with Image.open(plain) as image:
        whole = np.asarray(image)
    blue = (whole[..., 2] > 150) & (whole[..., 0] < 100)
    assert blue.sum() > 1000
    images = list(ET.parse(drawn).iter("{http://www.w3.org/2000/svg}image"))
    places = [tuple(int(one.attrib[key]) // 10 for key in ("x", "y", "width", "height")) for one in images]
    assert sorted(places) == [(x, y, 640, 480) for x in (0, 640) for y in (0, 480)]
    for one in images:
        with Image.open(BytesIO(b64decode(one.attrib["href"].removeprefix("data:image/png;base64,")))) as image:
            pane = np.asarray(image.convert("RGB"))
        assert pane.shape == (480, 640, 3)
        assert ((pane[..., 2] > 150) & (pane[..., 0] < 100)).sum() > 300
