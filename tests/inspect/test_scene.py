"""The scene: what is sent to meshcat stands where Pinocchio puts it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from meshcat import Visualizer

from chainbuild.frames import matrix_from_quaternion, transform
from chainbuild.inspect.scene import Scene, labelled_frames
from chainbuild.inspect.sweep import axis_sweep
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


@pytest.mark.parametrize("name", ROBOTS)
def test_every_keyframe_is_the_pose_that_pinocchio_computes(name: str) -> None:
    robot, window = ROBOTS[name](), Window()
    scene, motion = Scene(Visualizer(window=window), robot), axis_sweep(robot)
    scene.animate(motion.q)
    clips = {a["path"]: a["clip"] for a in window.commands[-1]["animations"]}
    assert len(clips) == len(robot.chain.joints)
    for k in range(0, len(motion.q), 7):
        transforms = {path: pose_at(clip, k) for path, clip in clips.items()}
        expected = robot.frame_placements(motion.axes[k])
        for link, path in link_paths(transforms).items():
            np.testing.assert_allclose(in_world(path, transforms), expected[link].homogeneous, atol=1e-9)


def pose_at(clip: dict[str, Any], frame: int) -> np.ndarray:
    """Return a clip's pose at a frame; a joint at rest has no key there and keeps the last one."""
    found = {}
    for track in clip["tracks"]:
        keys = [key for key in track["keys"] if key["time"] <= frame]
        found[track["name"]] = keys[-1]["value"]
        assert track["keys"][0]["time"] == 0
    return transform(matrix_from_quaternion(found[".quaternion"]), found[".position"])


def test_frames_in_one_place_share_a_label() -> None:
    assert [label for label, _ in labelled_frames(arm().chain)] == ["base = workpiece", "flange", "tool"]
    assert [label for label, _ in labelled_frames(gantry().chain)] == ["base", "flange", "tool", "workpiece"]


@pytest.mark.parametrize("name", ROBOTS)
def test_bounds_hold_every_frame(name: str) -> None:
    robot = ROBOTS[name]()
    scene, motion = Scene(Visualizer(window=Window()), robot), axis_sweep(robot)
    low, high = scene.bounds(motion.q)
    for axes in motion.axes[::5]:
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
