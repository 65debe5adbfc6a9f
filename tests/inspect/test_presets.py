"""Presets of the page: every one has a pose, singular ones are what they are called, the mathematical zero by hand."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.programmed.named import NamedPose
from chainbuild.inspect.presets import presets_of
from chainbuild.inspect.scene import as_shown
from chainbuild.inspect.sweep import rest_pose

# What is found inside the limits, besides start, zeros and middle.
KINDS = {
    "kr6r900": ["wrist", "elbow", "shoulder"],
    "parallelogram_nr": ["wrist", "shoulder"],
    "scara_cc": ["elbow"],
    "cardan_head_kin60": ["pole", "tilt_end"],
    "tripod_table_kin209": ["pole"],
    "delta_kin37": [],
    "rod_table_kin19": [],
    "robot_head_kin210": [],
}


@cache
def presets(name: str, **poses: tuple[float, ...]) -> tuple[chainbuild.Robot, dict[str, dict[str, Any]]]:
    chain = chainbuild.load(name).chain()
    named = tuple(NamedPose(*one) for one in poses.items())
    robot = as_shown(chainbuild.Robot(replace(chain, named_poses=named)))
    assert isinstance(robot, chainbuild.Robot)
    found = presets_of(robot, rest_pose(robot))
    assert len({one["name"] for one in found}) == len(found)
    return robot, {one["name"]: one for one in found}


@pytest.mark.parametrize("name", KINDS)
def test_every_preset_has_a_pose_and_is_what_it_is_called(name: str) -> None:
    robot, found = presets(name)
    assert next(iter(found)) == "start"
    assert found["start"]["axes"] == rest_pose(robot).tolist()
    assert [key.removeprefix("singular:") for key in found if key.startswith("singular:")] == KINDS[name]
    for key, preset in found.items():
        assert np.isfinite(robot.fk(preset["axes"]).homogeneous).all()
        if not key.startswith("singular:"):
            assert preset["note"].endswith(robot.limits.words(np.array(preset["axes"])))
            continue
        assert robot.violated_limits(preset["axes"]) == ()
        report = chainbuild.examine(robot, preset["axes"])
        assert report.measures.smallest < 1e-9
        (meant,) = (one for one in report.names if one.kind == key.removeprefix("singular:"))
        assert (meant.value < 1e-6, preset["note"]) == (True, meant.sentence)
        assert "nearly" not in preset["note"]


def test_titles_and_notes() -> None:
    _, found = presets("irb2600", park=(0, 0, 0, 0, 90, 0), far=(0, 200, 0, 0, 0, 0))
    assert [(key, one["title"]) for key, one in found.items()] == [
        ("start", "Start"),
        ("zero", "Axes zero (mechanical zero)"),
        ("mathematical_zero", "Mathematical zero"),
        ("middle", "Middle of the limits"),
        ("pose:park", "park"),
        ("pose:far", "far"),
        ("singular:wrist", "Singular: wrist"),
        ("singular:elbow", "Singular: elbow"),
        ("singular:shoulder", "Singular: shoulder"),
    ]
    assert found["middle"]["axes"] == [0.0, 30.0, -52.5, 0.0, 0.0, 0.0]
    assert found["pose:park"]["note"] == ""
    assert found["pose:far"]["note"] == "A2 is 200, outside -95 … 155 deg"


def test_singular_poses_differ_little_from_the_first_one() -> None:
    """The wrist's and the elbow's are each one axis away."""
    _, found = presets("kr6r900")
    start = np.array(found["start"]["axes"])
    for kind, axes in (("wrist", [4]), ("elbow", [2]), ("shoulder", [1, 2])):
        assert np.flatnonzero(np.array(found[f"singular:{kind}"]["axes"]) != start).tolist() == axes
    assert found["singular:wrist"]["axes"][4] == 0.0
    # Stretched: the wrist point on the line of the upper arm, by the forearm's 35 mm across and 420 mm along.
    assert found["singular:elbow"]["axes"][2] == pytest.approx(np.degrees(np.arctan2(35.0, 420.0)), abs=1e-6)


def test_limits_without_ends_have_their_middle_at_zero() -> None:
    robot, found = presets("ca_head_kin9")
    for axis, value in zip(robot.axes, found["middle"]["axes"], strict=True):
        assert value == (0.0 if axis.assumed or axis.endless else (axis.lower + axis.upper) / 2.0)


def test_poses_that_loops_do_not_have_are_left_out() -> None:
    _, found = presets("delta_kin37", open=(180, 0, 0), closed=(5, 10, 15))
    assert "pose:open" not in found
    assert found["pose:closed"]["axes"] == [5.0, 10.0, 15.0]


def test_a_kinematic_that_is_singular_everywhere_has_no_singular_presets() -> None:
    chain = chainbuild.load("ca_head_kin9").chain()
    joints = tuple(
        replace(joint, direction=chain.joints[0].direction) if joint.name == "Y" else joint for joint in chain.joints
    )
    robot = chainbuild.Robot(replace(chain, joints=joints))
    assert not [one for one in presets_of(robot, np.zeros(5)) if one["name"].startswith("singular")]


@pytest.mark.parametrize(
    ("name", "axes", "tcp_mm"),
    [
        # Base height, A and B of the basic axes, TX3P3 and TFLWP, all along X of the stretched arm but the heights:
        ("irb2600", [0.0, 90.0, -90.0, 0.0, 0.0, 0.0], (150 + 700 + 795 + 85, 0, 445 + 115)),
        ("parallelogram_nr", [0.0, 90.0, -90.0, 0.0, 0.0, 0.0], (400 + 1100 + 1250 + 230, 0, 850 + 250)),
    ],
)
def test_the_mathematical_zero_is_the_arm_stretched_along_x(
    name: str, axes: list[float], tcp_mm: tuple[float, float, float]
) -> None:
    robot, found = presets(name)
    assert found["mathematical_zero"]["axes"] == axes
    T = robot.fk(found["mathematical_zero"]["axes"])
    np.testing.assert_allclose(1000.0 * T.translation, tcp_mm, atol=1e-9)
    # TX3P3_RPY alone turns: by 90 degrees about Y, so that Z of the flange is along X, as axis 4 is.
    np.testing.assert_allclose(T.rotation, [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]], atol=1e-12)


def test_only_robx_has_a_mathematical_zero_and_only_where_it_differs() -> None:
    for name in ("kr6r900", "delta_kin37", "tripod_table_kin209"):
        _, found = presets(name)
        assert "mathematical_zero" not in found
        assert found["zero"]["title"] == ("Axes zero (mechanical zero)" if name == "kr6r900" else "Axes zero")
