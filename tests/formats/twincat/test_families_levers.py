"""Levers: each convention choice, and what the manual states of KIN_TYP 85 and 205."""

from __future__ import annotations

import math

import numpy as np
import pytest

from chainbuild.errors import MachineDataError
from chainbuild.frames import rot_x, rot_y
from tests.kit.kin_types import build


def test_lever() -> None:
    for choice, sense in (("raises", 1.0), ("lowers", -1.0)):
        built = build(85, {1: 300.0, 2: 200.0}, kin85_lever_sense=choice)
        expected = (50 + 200 * math.cos(math.radians(20)), 0, 300 + sense * 200 * math.sin(math.radians(20)))
        assert built.mm([50, 20]) == pytest.approx(expected)


def test_lever_offset_shows_on_the_axis_when_horizontal() -> None:
    for choice, sense in (("minus", 1.0), ("plus", -1.0)):
        built = build(85, {1: 300.0, 2: 200.0, 3: 12.0}, kin85_angle_offset_sign=choice)
        assert built.mm([0, sense * 12.0]) == pytest.approx((200, 0, 300))


def test_lever_reaches_a_height_with_two_arms() -> None:
    built = build(85, {1: 300.0, 2: 200.0})
    right, left = built.mm([0, 30]), built.mm([2 * 200 * math.cos(math.radians(30)), 150])
    assert right == pytest.approx(left)


def test_lever_tool_length() -> None:
    hd = {2: 200.0}
    ignored = build(85, hd, 50.0)
    assert ignored.mm([0, 0]) == pytest.approx((200, 0, 0))
    assert ignored.codes() == ["CB407"]
    assert build(85, hd, 50.0, kin85_tool_length="along_arm").mm([0, 90]) == pytest.approx((0, 0, 250), abs=1e-12)
    across = build(85, hd, 50.0, kin85_tool_length="along_tool_vector")
    assert across.mm([0, 0]) == pytest.approx((200, 0, -50))
    assert across.mm([0, 90]) == pytest.approx((50, 0, 200), abs=1e-12)
    assert "kin85_tool_length" not in build(85, hd).asked()


DISC = {2: 60.0, 3: 30.0, 4: 7.0, 5: 9.0, 1: 40.0}


def test_disc_adds_polar_and_cartesian_place() -> None:
    r, s = 60.0 * math.cos(math.radians(30)) + 7.0, 60.0 * math.sin(math.radians(30)) + 9.0
    assert build(205, {**DISC, 16: 1}, 5.0).mm([0, 0, 0]) == pytest.approx((r, s, -45.0))
    about_x = {
        "yz_plane": (-45.0, r, s),
        "turned_about_y": (-45.0, s, -r),
        "tool_along_z": (0.0, r, s - 45.0),
    }
    for choice, place in about_x.items():
        built = build(205, {**DISC, 17: 1}, 5.0, kin205_x_variant=choice)
        assert built.mm([0, 0, 0]) == pytest.approx(place, abs=1e-12)
        assert built.mm([0, 25, 0]) == pytest.approx(rot_x(25.0) @ place, abs=1e-12)


def test_disc_tool_frame_about_x() -> None:
    rotation = build(205, {17: 1}).robot.fk([0, 0, 0]).rotation
    assert rotation == pytest.approx(np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]]), abs=1e-15)
    rotation = build(205, {17: 1}, kin205_x_variant="turned_about_y").robot.fk([0, 0, 0]).rotation
    assert rotation == pytest.approx(rot_y(90), abs=1e-15)


def test_disc_zero_points() -> None:
    hd = {16: 1, 6: 1.0, 7: 2.0, 8: 3.0, 9: 10.0, 10: 20.0, 11: 30.0}
    for choice, place in (("sum", (11, 22, 33)), ("x_only", (1, 2, 3)), ("z_only", (10, 20, 30))):
        assert build(205, hd, kin205_zero_points=choice).mm([0, 0, 0]) == pytest.approx(place)


def test_disc_senses() -> None:
    built = build(205, {16: 1, 4: 10.0, 13: -1, 14: -1, 15: -1})
    assert built.mm([1, 90, 3]) == pytest.approx((-1, -10, -3), abs=1e-12)
    for sign in (0, 1, 5):
        forward = build(205, {16: 1, 4: 10.0, 13: sign, 14: sign, 15: sign})
        assert forward.mm([1, 90, 3]) == pytest.approx((1, 10, 3), abs=1e-12)
        assert forward.codes() == []


def test_disc_axis_by_hd16_and_hd17() -> None:
    legacy = build(205, DISC)
    assert legacy.codes() == ["CB431"]
    axes = [1.0, 20.0, 3.0]
    assert legacy.mm(axes) == pytest.approx(build(205, {**DISC, 16: 1}).mm(axes))
    about_x = build(205, DISC, kin205_legacy_mode="about_x")
    assert about_x.mm(axes) == pytest.approx(build(205, {**DISC, 17: 1}).mm(axes))
    for chosen in ({16: 1}, {17: 1}):
        assert build(205, {**DISC, **chosen}).codes() == []
    with pytest.raises(MachineDataError, match="HD16 and HD17 are both 1"):
        build(205, {16: 1, 17: 1})
    assert build(205, {16: 1, 17: 1}, strict=False).codes() == ["CB401"]
