"""Meshes on the page: in their link's place, moved with it, lit, in ghosts; few enough triangles to be usable."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from meshcat import Visualizer
from playwright.sync_api import Browser

import chainbuild
from chainbuild.inspect import scene as scenes
from chainbuild.inspect.export import export_page
from chainbuild.inspect.scene import Scene
from tests.kit.live_page import LivePage, opened
from tests.kit.mesh_files import write_arm

AT_HOME = (0.0, 0.0, 0.0), (0.1, 0.3, 0.3)  # where the L of link "one" is: corners of the box around it [m]


class Window:
    """Keeps commands as meshcat would send them."""

    def __init__(self) -> None:
        self.commands: list[dict[str, Any]] = []

    def send(self, command: Any) -> None:
        self.commands.append(command.lower())


def last(window: Window, kind: str, path: str) -> dict[str, Any]:
    return [one for one in window.commands if one["type"] == kind and one["path"] == path][-1]


def test_the_scene_has_the_mesh_in_its_link(tmp_path: Path) -> None:
    robot, window = chainbuild.Robot.from_urdf(write_arm(tmp_path)), Window()
    scene = Scene(Visualizer(window=window), robot)
    scene.draw([0.0, 0.0])
    (path,) = {one["path"] for one in window.commands if one["path"].endswith("/one/link1")}
    sent = last(window, "set_object", path)["object"]
    data = sent["geometries"][0]["data"]
    points = np.frombuffer(data["attributes"]["position"]["array"].data, dtype=np.float32).reshape(-1, 3)
    corners = np.frombuffer(data["index"]["array"].data, dtype=np.uint32).reshape(-1, 3)
    # An L of two boxes: 12 triangles each, and a vertex for each side of each edge.
    assert (points.shape, corners.shape, corners.max()) == ((48, 3), (24, 3), 47)
    assert sent["materials"][0]["color"] == 0x0000FF
    T = np.array(last(window, "set_transform", path)["matrix"]).reshape(4, 4).T
    placed = points @ T[:3, :3].T + T[:3, 3]
    np.testing.assert_allclose([placed.min(axis=0), placed.max(axis=0)], AT_HOME, atol=1e-6)


def test_meshes_are_seen_lit_and_move_with_their_links(browser: Browser, tmp_path: Path) -> None:
    robot = chainbuild.Robot.from_urdf(write_arm(tmp_path))
    page = export_page(robot, tmp_path / "page.html", at=[0.0, 0.0])

    def blue(live: LivePage) -> tuple[np.ndarray, np.ndarray]:
        frames = live.tab.evaluate("window.chainbuild.frames")
        live.until(f"window.chainbuild.frames > {frames}")  # the last one at rest
        picture = live.picture().astype(int)
        seen = (picture[..., 2] > 90) & (picture[..., 0] < 40) & (picture[..., 1] < 40)
        return np.argwhere(seen), picture[..., 2][seen]

    with opened(browser, page, size=(560, 360)) as live:
        live.tab.get_by_text("Frames", exact=True).click()
        home, shades = blue(live)
        assert len(home) > 300
        # Its sides stand differently to the light.
        assert np.ptp(shades) > 40
        live.call("set", [-90.0, 0.0])
        turned, _ = blue(live)
        assert len(turned) > 300
        # It moves by 14 to 16 pixels, as the blue axes of the frames have gone from the first picture or not yet.
        assert np.abs(home.mean(axis=0) - turned.mean(axis=0)).max() > 10


def test_bounds_hold_meshes(tmp_path: Path) -> None:
    scene = Scene(Visualizer(window=Window()), chainbuild.Robot.from_urdf(write_arm(tmp_path)))
    low, high = scene.bounds([np.zeros(2)])
    np.testing.assert_allclose(low, (0.0, -0.05, -0.05), atol=1e-7)
    np.testing.assert_allclose(high, (0.55, 0.3, 0.3), atol=1e-7)


def test_a_page_has_no_more_triangles_than_it_can_hold(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = chainbuild.Robot.from_urdf(write_arm(tmp_path))
    monkeypatch.setattr(scenes, "MOST_TRIANGLES", 30)
    bodies = Scene(Visualizer(window=Window()), robot).bodies
    assert sum(len(body.surface.corners) for body in bodies if body.surface is not None) <= 30
    assert [body.kind for body in bodies][-1] == "sphere"
