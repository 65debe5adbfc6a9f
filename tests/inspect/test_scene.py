"""The scene: what is sent to meshcat stands where Pinocchio puts it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from meshcat import Visualizer

from chainbuild.inspect.scene import Scene, labelled_frames
from chainbuild.inspect.sweep import rest_pose, swept_poses
from tests.kit.drawn_robots import ROBOTS, arm, gantry


class Window:
    """Keeps commands as meshcat would send them."""

    def __init__(self) -> None:
        self.commands: list[dict[str, Any]] = []

    def send(self, command: Any) -> None:
        self.commands.append(command.lower())

    def transforms(self) -> dict[str, np.ndarray]:
        """Return the last transform of every path."""
        found = [c for c in self.commands if c["type"] == "set_transform"]
        return {c["path"]: np.array(c["matrix"]).reshape(4, 4).T for c in found}


def in_world(path: str, transforms: dict[str, np.ndarray]) -> np.ndarray:
    T, parts = np.eye(4), path.strip("/").split("/")
    for n in range(len(parts)):
        T = T @ transforms.get("/" + "/".join(parts[: n + 1]), np.eye(4))
    return T


def link_paths(transforms: dict[str, np.ndarray]) -> dict[str, str]:
    return {path.rsplit("/", 1)[-1]: path for path in transforms if path.endswith("_link")}


@pytest.mark.parametrize("name", ROBOTS)
def test_draw_and_update_put_links_and_frames_in_place(name: str) -> None:
    robot, rng, window = ROBOTS[name](), np.random.default_rng(8), Window()
    scene = Scene(Visualizer(window=window), robot)
    scene.draw([(axis.lower + axis.upper) / 2 for axis in robot.axes])
    for _ in range(3):
        axes = [axis.lower + (axis.upper - axis.lower) * rng.random() for axis in robot.axes]
        scene.update(axes)
        transforms, expected = window.transforms(), robot.frame_placements(axes)
        for link, path in link_paths(transforms).items():
            np.testing.assert_allclose(in_world(path, transforms), expected[link].homogeneous, atol=1e-9)
        drawn = [path for path in transforms if "/frame " in path and path.count("/frame ") == 1]
        for path in (path for path in drawn if path.rsplit("/", 1)[-1].startswith("frame ")):
            frame = path.rsplit("frame ", 1)[-1]
            np.testing.assert_allclose(in_world(path, transforms), expected[frame].homogeneous, atol=1e-9)


def test_frames_in_one_place_share_a_label() -> None:
    assert [label for label, _ in labelled_frames(arm().chain)] == ["base = workpiece", "flange", "tool"]
    assert [label for label, _ in labelled_frames(gantry().chain)] == ["base", "flange", "tool", "workpiece"]


@pytest.mark.parametrize("name", ROBOTS)
def test_bounds_hold_every_flange(name: str) -> None:
    robot = ROBOTS[name]()
    scene, swept = Scene(Visualizer(window=Window()), robot), swept_poses(robot, rest_pose(robot))
    low, high = scene.bounds(robot.q(axes) for axes in swept)
    for axes in swept:
        place = robot.frame_placements(axes)["flange"].translation
        assert (low - 1e-9 <= place).all()
        assert (place <= high + 1e-9).all()


def test_a_live_meshcat_server_takes_the_scene() -> None:
    viewer = Visualizer()
    try:
        robot = arm()
        scene = Scene(viewer, robot)
        scene.draw([0.0] * 6)
        scene.update([10.0] * 6)
        assert viewer.static_html().count("handle_command_bytearray") > 50
    finally:
        viewer.window.server_proc.kill()
        viewer.window.server_proc.wait()


def test_names_of_frames_are_drawn_where_they_are_asked_for() -> None:
    robot = arm()
    for labels in (True, False):
        window = Window()
        Scene(Visualizer(window=window), robot).draw([0.0] * 6, labels=labels)
        assert any("/label/" in command["path"] for command in window.commands) == labels
