"""Arms: each convention choice, and what the manual states of KIN_TYP 36, 96, 206, 208 and 213."""

from __future__ import annotations

import math

import numpy as np
import pytest

from chainbuild.frames import rot_x, rot_y, rot_z
from tests.kit.kin_types import axes_anywhere, build

SCARA = {2: 225.0, 3: 175.0}


def test_scara_base_offset() -> None:
    for choice, sense in (("plus", 1.0), ("minus", -1.0)):
        built = build(36, {**SCARA, 4: 10.0, 5: 20.0}, kin36_base_offset_sign=choice)
        assert built.mm([0, 0, 0, 0]) == pytest.approx((sense * 10 + 400, sense * 20, 0))


@pytest.mark.parametrize("absolute", [0, 1])
def test_scara_angle_offsets(absolute: int) -> None:
    """The axes show the offsets (minus) or their opposites (plus) where the arm is stretched."""
    for choice, sense in (("minus", 1.0), ("plus", -1.0)):
        built = build(36, {**SCARA, 6: 15.0, 7: absolute, 8: 25.0}, kin36_angle_offset_sign=choice)
        assert built.mm([sense * 15.0, sense * 25.0, 0, 0]) == pytest.approx((400, 0, 0), abs=1e-9)


def test_scara_second_arm_relative_or_absolute() -> None:
    relative, absolute = build(36, SCARA), build(36, {**SCARA, 7: 1})
    elbow = 225.0 * rot_z(30.0)[:, 0]
    assert relative.mm([30, 20, 0, 0]) == pytest.approx(elbow + 175.0 * rot_z(50.0)[:, 0])
    assert absolute.mm([30, 20, 0, 0]) == pytest.approx(elbow + 175.0 * rot_z(20.0)[:, 0])


def test_scara_tool_angle() -> None:
    for choice, turned in (("relative_to_arm2", 35.0), ("follows_hd7", 10.0)):
        built = build(36, {**SCARA, 7: 1, 8: 5.0}, kin36_tool_angle=choice)
        assert built.robot.fk([30, 30, 0, 10]).rotation == pytest.approx(rot_z(turned), abs=1e-14)
        relative = build(36, SCARA, kin36_tool_angle=choice)
        assert relative.robot.fk([30, 30, 0, 10]).rotation == pytest.approx(rot_z(70.0), abs=1e-14)
        assert "kin36_tool_angle" not in relative.asked()


PALLETISER = {1: 100.0, 2: 500.0, 3: 800.0, 5: 700.0, 6: 150.0}


def test_palletiser_zero_pose() -> None:
    assert build(96, PALLETISER).mm([0, 0, 0, 0]) == pytest.approx((950, 0, 1300))
    forward = build(96, PALLETISER, kin96_zero_pose="arm1_forward")
    assert forward.mm([0, 0, 0, 0]) == pytest.approx((1750, 0, 500))


def test_palletiser_second_arm() -> None:
    for choice, turned in (("absolute", 0.0), ("relative", 25.0)):
        built = build(96, PALLETISER, kin96_arm2_angle=choice)
        assert built.base_rotation("G3", [0, 25, 0, 0]) == pytest.approx(rot_y(turned), abs=1e-14)


@pytest.mark.parametrize("choice", ["absolute", "relative"])
def test_palletiser_flange_stays_level(choice: str) -> None:
    built = build(96, {**PALLETISER, 10: 90.0}, kin96_arm2_angle=choice)
    for axes in axes_anywhere(built.robot, 10):
        assert built.robot.fk(axes).rotation == pytest.approx(rot_z(axes[0] + axes[3]), abs=1e-12)


def test_palletiser_offsets() -> None:
    for choice, sense in (("plus", 1.0), ("minus", -1.0)):
        side = build(96, {4: 30.0}, kin96_y_offset_sign=choice)
        assert side.mm([0, 0, 0, 0]) == pytest.approx((0, sense * 30, 0))
        assert side.mm([90, 0, 0, 0]) == pytest.approx((-sense * 30, 0, 0), abs=1e-12)
        drop = build(96, {10: 30.0}, kin96_head_z_sign=choice)
        assert drop.mm([0, 20, 30, 0]) == pytest.approx((0, 0, sense * 30), abs=1e-12)
    for choice, place in (
        ("lateral_plus_z_down", (8, 7, -14)), ("all_plus", (8, 7, 4)), ("all_minus", (-8, -7, -14)),
    ):  # fmt: skip
        tool = build(96, {7: 7.0, 8: 8.0, 9: 9.0}, 5.0, kin96_tool_offset=choice)
        assert tool.mm([0, 0, 0, 0]) == pytest.approx(place)
        assert tool.mm([0, 0, 0, 90]) == pytest.approx(rot_z(90) @ place)


FIVE_AXIS = {7: 400.0, 8: 900.0, 9: 800.0, 10: 120.0, 11: 150.0, 12: 60.0, 48: 80.0}


def test_five_axis_palletiser_zero_pose() -> None:
    """Upper arm up, forearm forward; joint 3 above joint 4, flange below joint 4."""
    built = build(213, FIVE_AXIS)
    zeros = built.zeros()
    assert built.base_mm("G2", zeros) == pytest.approx((150, 0, 400))
    assert built.base_mm("G3", zeros) == pytest.approx((150, 0, 1300))
    assert built.base_mm("G4", zeros) == pytest.approx((950, 0, 1240))
    assert built.base_mm("flange", zeros) == pytest.approx((1070, 0, 1160))


def test_five_axis_palletiser_offsets_of_the_printed_program() -> None:
    """The manual's program starts at A2 = -90, A3 = 90: with these as zero offsets the upper arm stands upright."""
    built = build(213, {**FIVE_AXIS, 14: -90.0, 15: 90.0})
    assert built.mm([0, -90, 90, 0, 0]) == pytest.approx((1070, 0, 1160))


def test_five_axis_palletiser_level_flange_has_b_zero() -> None:
    built = build(213, FIVE_AXIS)
    for g2, g3, g5 in ((20.0, 30.0, 40.0), (-50.0, 10.0, -70.0)):
        rotation = built.robot.fk([15.0, g2, g3, -g2 - g3, g5]).rotation
        assert rotation == pytest.approx(rot_z(15.0 + g5), abs=1e-14)


def test_five_axis_palletiser_flange_frame() -> None:
    hd = {1: 10.0, 2: 20.0, 3: 30.0, 6: 40.0}
    for choice, place, rotation in (
        ("z_up", (20, 30, -15), rot_z(40)),
        ("z_down", (20, -30, -15), rot_x(180) @ rot_z(40)),
        ("z_up_signed", (20, 30, 5), rot_z(40)),
    ):
        built = build(213, hd, 5.0, kin213_flange_frame=choice)
        assert built.mm([0, 0, 0, 0, 0]) == pytest.approx(place, abs=1e-12)
        assert built.robot.fk([0, 0, 0, 0, 0]).rotation == pytest.approx(rotation, abs=1e-14)


def test_five_axis_palletiser_g5_sense() -> None:
    for choice, sense in (("plus", 1.0), ("minus", -1.0)):
        for frame in ("z_up", "z_down"):
            built = build(213, kin213_g5_sense=choice, kin213_flange_frame=frame)
            at_zero = built.robot.fk([0, 0, 0, 0, 0]).rotation
            assert built.robot.fk([0, 0, 0, 0, 10]).rotation == pytest.approx(rot_z(sense * 10) @ at_zero, abs=1e-14)


def test_five_axis_palletiser_is_the_six_axis_arm_without_its_fourth_joint() -> None:
    six = build(45, {n: FIVE_AXIS[n] for n in (7, 8, 9, 10, 11, 12)})
    five = build(213, {**FIVE_AXIS, 48: 0.0})
    for g1, g2, g3, g4, _ in axes_anywhere(five.robot, 10):
        arm = six.robot.frame_placements([g1, g2, g3, 0.0, g4, 0.0])["flange"].translation
        assert five.robot.frame_placements([g1, g2, g3, g4, 0.0])["flange"].translation == pytest.approx(arm)


POINTS = {n: float(7 * n % 11) * 40.0 for n in (13, 14, 15, 19, 20, 21, 25, 26, 27, 31, 32, 33)}


@pytest.mark.parametrize(("kin", "last"), [(206, 6), (208, 5)])
def test_linear_robot_stands_at_its_points_at_zero(kin: int, last: int) -> None:
    hd = {**POINTS, **({37: 100.0, 38: 200.0, 39: 300.0} if kin == 206 else {})}
    built = build(kin, hd)
    for n in range(2, last + 1):
        first = 13 + 6 * (n - 2)
        assert built.base_mm(f"A{n}", built.zeros()) == pytest.approx([hd[first + k] for k in range(3)])
    assert built.robot.fk(built.zeros()).rotation == pytest.approx(np.eye(3), abs=0)
    for n in range(2, last + 1):
        turned = built.robot.fk([10.0 if i == n - 1 else 0.0 for i in range(last)]).rotation
        assert turned == pytest.approx(rot_y(10.0) if n == 5 else rot_x(10.0), abs=1e-14)
    assert built.mm([25.0, *[0.0] * (last - 1)]) - built.mm(built.zeros()) == pytest.approx((25, 0, 0))


@pytest.mark.parametrize("kin", [206, 208])
def test_linear_robot_turns_about_the_given_point(kin: int) -> None:
    built = build(kin, POINTS)
    point = np.array([POINTS[n] for n in (19, 20, 21)])
    before, after = (np.append(built.mm([0, 0, a3, *[0.0] * (3 if kin == 206 else 2)]), 1.0)[:3] for a3 in (0.0, 35.0))
    assert after - point == pytest.approx(rot_x(35.0) @ (before - point), abs=1e-9)


def direction_of(kin: int, name: str, hd: dict[int | str, float], **conventions: str) -> np.ndarray:
    joints = build(kin, hd, **conventions).robot.chain.joints
    return next(joint.direction for joint in joints if joint.name == name)


@pytest.mark.parametrize("kin", [206, 208])
@pytest.mark.parametrize("name", ["A1", "A2", "A3", "A4", "A5"])
def test_deviations(kin: int, name: str) -> None:
    """A small positive deviation moves the axis' tip, seen from its start, by these signs of the cross direction."""
    plane, nominal, across = ("yz", 1, 0) if name == "A5" else ("xz", 0, 1)
    up = f"deviation_{name.lower()}_{plane}"
    aside = f"deviation_{name.lower()}_xy"
    right_handed = {up: 1.0 if name == "A5" else -1.0, aside: -1.0 if name == "A5" else 1.0}
    for choice, factors in (
        ("right_handed", right_handed),
        ("left_handed", {key: -value for key, value in right_handed.items()}),
        ("toward_positive", {up: 1.0, aside: 1.0}),
    ):
        for key, out in ((up, 2), (aside, across)):
            found = direction_of(kin, name, {key: 2.0}, linear_unit_deviation_sense=choice)
            assert found[out] == pytest.approx(factors[key] * math.sin(math.radians(2.0)))
            assert found[nominal] == pytest.approx(math.cos(math.radians(2.0)))


def test_deviation_in_xy_is_outermost() -> None:
    found = direction_of(206, "A2", {16: 20.0, 17: 30.0})
    assert found == pytest.approx(rot_z(30) @ rot_y(20) @ [1, 0, 0])
    found = direction_of(206, "A5", {34: 20.0, 35: 30.0})
    assert found == pytest.approx(rot_z(30) @ rot_x(20) @ [0, 1, 0])


def test_cardan_angle() -> None:
    d = rot_z(3) @ rot_y(2) @ [1, 0, 0]
    for choice, turn in (
        ("about_z", rot_z(25)), ("about_minus_z", rot_z(-25)), ("about_y", rot_y(25)), ("about_minus_y", rot_y(-25)),
    ):  # fmt: skip
        found = direction_of(206, "A6", {40: 2.0, 41: 3.0, 43: 25.0}, kin206_cardan_axis=choice)
        assert found == pytest.approx(turn @ d)
    assert "kin206_cardan_axis" not in build(206).asked()


@pytest.mark.parametrize(("kin", "offsets"), [(206, (18, 24, 30, 36, 42)), (208, (18, 24, 30, 36))])
def test_linear_robot_offsets(kin: int, offsets: tuple[int, ...]) -> None:
    hd = {**POINTS, 12: 50.0, **{n: float(n) for n in offsets}}
    for choice, sense in (("plus", -1.0), ("minus", 1.0)):
        built, plain = build(kin, hd, linear_unit_offset_sign=choice), build(kin, POINTS)
        shown = [sense * 50.0, *(sense * n for n in offsets)]
        assert built.mm(shown) == pytest.approx(plain.mm(plain.zeros()), abs=1e-9)


def test_linear_robot_tool() -> None:
    hd = {1: 1.0, 2: 2.0, 3: 3.0, 4: 10.0, 5: 20.0, 6: 30.0}
    for kin, place in ((206, (1, 12, 3)), (208, (1, 2, 13))):
        built = build(kin, hd, 10.0)
        assert built.mm(built.zeros()) == pytest.approx(place)
        assert built.robot.fk(built.zeros()).rotation == pytest.approx(rot_x(30) @ rot_y(20) @ rot_z(10))
