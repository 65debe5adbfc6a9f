"""Heads whose axis values do not simply turn joints: growing nozzle, gear, spatial angles, saw blade, CV, plunge."""

from __future__ import annotations

import math

import numpy as np
import pytest

from chainbuild.chain.fold import drawn_values
from chainbuild.errors import ChainbuildError, MachineDataError
from chainbuild.frames import rot_about, rot_x, rot_y, rot_z
from tests.kit.kin_types import Built, Vector, axes_inside, build, distance

Hd = dict[int | str, float]


def rad(*angles_deg: float) -> list[float]:
    return [math.radians(angle) for angle in angles_deg]


# ---------------------------------------------------------------- 25: the nozzle keeps its height


def test_the_nozzle_keeps_its_height_over_the_sheet() -> None:
    level, head = build(25, {1: 100}, 8.0), build(25, {1: 100}, 8.0, kin25_length="head_and_gap")
    for a in (-60.0, -20.0, 0.0, 45.0):
        nozzle_tip = -100 * math.cos(math.radians(a))
        axes = [0, 0, 0, 33, a]
        assert level.mm(axes)[2] == pytest.approx(nozzle_tip - 8.0, abs=1e-9)
        assert head.mm(axes)[2] == pytest.approx(-108.0, abs=1e-9)
        assert level.base_mm("flange", axes)[2] == pytest.approx(nozzle_tip, abs=1e-9)


def test_the_nozzle_at_its_end() -> None:
    built = build(25, {1: 100}, 8.0)
    with pytest.raises(ChainbuildError):
        built.robot.fk([0, 0, 0, 0, 90])
    assert np.isfinite(built.robot.chain.axis_map.dq_daxes(np.array([0, 0, 0, 0, 90.0]))).all()
    assert (built.robot.axes[4].lower, built.robot.axes[4].upper) == (-80, 80)
    assert len(build(25, {1: 100}).robot.chain.joints) == 5  # nothing grows without a gap
    assert "kin25_length" not in build(25, length=8.0).asked()
    wide = build(25, {1: 100}, 8.0).robot.chain.axis_map.q_bounds(np.full(5, -170.0), np.full(5, 170.0))
    assert wide[1][5] == 10.0 == -wide[0][5]


# ---------------------------------------------------------------- 28: coupling gear

GEAR: Hd = {1: 100, 3: 7, 4: 5, 9: 20, 11: 11, 12: 3, 13: 4, 14: 1, 15: 1, 16: 5, 17: 2}


def drives(c: float, a: float) -> tuple[float, float]:
    """The manual's equations: CM = CW, AM = AW·k_a + NP0 + k_ca·CW."""
    return c, a * 5 / 2 + 11 + 3 / 4 * c


@pytest.mark.parametrize("signs", [(1, 1), (-1, 1), (1, -1), (-1, -1)])
def test_drives_and_head_angles_meet_in_the_same_pose(signs: tuple[int, int]) -> None:
    hd = {**GEAR, 14: signs[0], 15: signs[1]}
    head, motors = build(28, hd), build(28, hd, kin28_axis_values="drives")
    for axes in axes_inside(head.robot, 10):
        there = [*axes[:3], *drives(*axes[3:])]
        assert distance(head.robot.fk(axes), motors.robot.fk(there)) < 1e-12
        # The joints stand where they are drawn: those of the head's angles count as their axes do.
        stands = [
            drawn_values(robot.chain.joints, robot.q(a)) for robot, a in ((head.robot, axes), (motors.robot, there))
        ]
        assert stands[0] == pytest.approx(stands[1], abs=1e-11)


def test_the_gear_leaves_programmed_angles_alone() -> None:
    plain, geared = build(28, {1: 100, 3: 7, 4: 5, 9: 20, 14: 1, 15: 1}), build(28, GEAR)
    for axes in axes_inside(plain.robot, 5):
        assert distance(plain.robot.fk(axes), geared.robot.fk(axes)) < 1e-15


def test_signs_before_the_gear_belong_to_the_drives() -> None:
    turned = {**GEAR, 14: -1, 15: -1}
    plain, head = build(28, GEAR), build(28, turned, gear_flag_place="before_gear")
    motors = build(28, turned, gear_flag_place="before_gear", kin28_axis_values="drives")
    for axes in axes_inside(plain.robot, 5):
        assert distance(plain.robot.fk(axes), head.robot.fk(axes)) < 1e-15
        cm, am = drives(*axes[3:])
        assert distance(plain.robot.fk(axes), motors.robot.fk([*axes[:3], -cm, -am])) < 1e-12
    after = build(28, {15: -1, 11: 10, 14: 1}, gear_flag_place="after_gear", kin28_axis_values="drives")
    before = build(28, {15: -1, 11: 10, 14: 1}, gear_flag_place="before_gear", kin28_axis_values="drives")
    assert after.tool_vector([0, 0, 0, 0, 40]) == pytest.approx((0, math.sin(*rad(30)), math.cos(*rad(30))), abs=1e-12)
    assert before.tool_vector([0, 0, 0, 0, 40]) == pytest.approx((0, math.sin(*rad(50)), math.cos(*rad(50))), abs=1e-12)


def test_the_offset_inside_the_sign_behind_the_gear() -> None:
    hd = {**GEAR, 3: 10, 4: 0, 14: 1, 15: -1}
    for choice, a in (("inside", 10.0), ("outside", -10.0)):
        built = build(28, hd, kin28_axis_values="drives", offset_inside_flag=choice)
        assert built.base_rotation("tool", [0, 0, 0, *drives(0, a)]) == pytest.approx(np.eye(3), abs=1e-12)


def test_gear_factors_of_zero() -> None:
    assert build(28, {14: 1, 15: 1}).codes() == ["CB420", "CB420"]
    built = build(28, {11: 4, 14: 1, 15: 1}, kin28_axis_values="drives")
    assert built.tool_vector([0, 0, 0, 50, 34]) == pytest.approx(rot_z(50) @ rot_x(30) @ (0, 0, 1), abs=1e-12)
    for hd in ({12: 1}, {16: 1}, {17: 1}):
        with pytest.raises(MachineDataError, match="gear factor"):
            build(28, {14: 1, 15: 1, **hd})
        assert "CB401" in build(28, {14: 1, 15: 1, **hd}, strict=False).codes()


# ---------------------------------------------------------------- 59, 60: spatial angles


@pytest.mark.parametrize(("kin", "turned", "side"), [(59, rot_x, "plus"), (60, rot_y, "plus"), (60, rot_y, "minus")])
@pytest.mark.parametrize("tilt", [45.0, 33.0, 70.0, 120.0, -40.0])
def test_spatial_angles_give_their_direction(kin: int, turned: object, side: str, tilt: float) -> None:
    chosen = {"kin60_tilt_sign": side} if kin == 60 else {}
    built = build(kin, {7: tilt}, **chosen)
    reach = 2 * min(abs(tilt), 180 - abs(tilt))
    assert built.robot.axes[4].upper == pytest.approx(reach, abs=1e-12) == -built.robot.axes[4].lower
    for c, share in ((0, 0.3), (77, -0.8), (-130, 0.999), (10, -1.0), (5, 1.0)):
        expected = rot_z(c) @ turned(share * reach) @ (0, 0, 1)  # type: ignore[operator]
        assert built.tool_vector([0, 0, 0, c, share * reach]) == pytest.approx(expected, abs=1e-9)
    with pytest.raises(ChainbuildError):
        built.robot.fk([0, 0, 0, 0, reach + 1e-6])


def test_the_largest_lean_is_twice_the_tilt() -> None:
    machine = build(59, {7: 50, 21: 1})
    leans = [math.degrees(math.acos(machine.tool_vector([0, 0, 0, 0, a])[2])) for a in range(-180, 181, 5)]
    assert max(leans) == pytest.approx(100, abs=1e-9)
    for a in (10.0, -60.0, 170.0):  # the same head by spatial angles
        joints = machine.robot.q([1, 2, 3, 20, a])
        spatial = build(59, {7: 50}).robot
        axes = spatial.axes_from_q(joints)
        assert math.copysign(1, axes[4]) == math.copysign(1, a)
        assert abs(axes[4]) == pytest.approx(math.degrees(math.acos(machine.tool_vector([0, 0, 0, 0, a])[2])), abs=1e-9)
        assert spatial.q(axes) == pytest.approx(joints, abs=1e-9)


def test_the_jacobian_stays_finite_at_the_largest_lean() -> None:
    assert np.isfinite(build(59, {7: 45}).robot.jacobian([0, 0, 0, 0, 90])).all()


@pytest.mark.parametrize(
    ("kin", "offsets", "inner"), [(59, {14: 4, 15: 5, 16: 6, 17: 7}, 12), (60, {14: 10, 15: 12}, 12)]
)
def test_offsets_behind_the_conversion_or_not(kin: int, offsets: Hd, inner: float) -> None:
    hd: Hd = {7: 45, 1: 100, **offsets}
    exact = build(kin, hd, spatial_angle_offsets="direction_exact")
    ideal, machine = build(kin, {7: 45, 1: 100}), build(kin, {7: 45, 1: 100, 21: 1})
    shifted = build(kin, hd)
    for axes in axes_inside(ideal.robot, 5):
        assert distance(exact.robot.fk(axes), ideal.robot.fk(axes)) < 1e-12
        joints = np.degrees(ideal.robot.q(axes)[3:])
        assert (
            distance(shifted.robot.fk(axes), machine.robot.fk([*axes[:3], joints[0] - 10, joints[1] - inner])) < 1e-12
        )
    assert "spatial_angle_offsets" in exact.asked()
    assert "spatial_angle_offsets" not in build(kin, {**hd, 21: 1}).asked()


def test_zero_offsets_that_act_like_a_zero_shift() -> None:
    for choice, (c, a) in (("subtracted", (16, 18)), ("not_in_pose", (6, 7))):
        built = build(59, {7: 45, 21: 1, 14: 6, 15: 7, 16: 10, 17: 11}, kin59_zero_offset=choice)
        assert built.base_rotation("tool", [0, 0, 0, c, a]) == pytest.approx(np.eye(3), abs=1e-12)


def test_a_head_without_tilt_is_refused() -> None:
    for kin in (59, 60):
        with pytest.raises(MachineDataError, match="cannot tilt"):
            build(kin, {7: 180})
        assert "CB401" in build(kin, strict=False).codes()
        assert build(kin, {21: 1}).tool_vector([0, 0, 0, 10, 20]) == pytest.approx((0, 0, 1), abs=1e-12)


# ---------------------------------------------------------------- 59: saw blade and underfloor cutter


def lowest_tooth(built: Built, axes: list[float], radius: float) -> Vector:
    """Search the rim of a blade about the tool vector for its lowest point, by brute force."""
    centre = build(59, {7: 40, 21: 1, 1: 100}).robot.fk(axes)
    angles = np.linspace(0, 2 * np.pi, 200_001)
    rim = centre.translation[:, None] * 1000 + radius * centre.rotation @ np.array(
        [np.cos(angles), np.sin(angles), 0 * angles]
    )
    lowest: Vector = rim[:, int(np.argmin(rim[2]))]
    return lowest


@pytest.mark.parametrize("a", [60.0, -35.0, 150.0])
def test_the_tool_point_is_the_lowest_tooth(a: float) -> None:
    axes = [1.0, 2.0, 3.0, 25.0, a]
    built = build(59, {7: 40, 21: 1, 1: 100, 19: a, 20: 2}, radius=150.0)
    assert built.mm(axes) == pytest.approx(lowest_tooth(built, axes, 150.0), abs=1e-2)
    always_x = build(59, {7: 40, 21: 1, 1: 100, 19: a, 20: 2}, radius=150.0, kin59_saw_tcp="plus_x")
    assert always_x.mm([0] * 5) == pytest.approx((150, 0, -100), abs=1e-12)
    level = build(59, {7: 40, 21: 1, 1: 100, 20: 2}, radius=150.0)
    assert level.mm([0] * 5) == pytest.approx((150, 0, -100), abs=1e-12)


def test_the_target_angle_of_the_saw_is_programmed_like_a() -> None:
    hd: Hd = {7: 45, 19: 90, 20: 2}
    like_axis, machine = (build(59, hd, radius=100.0, kin59_saw_angle=c) for c in ("like_axis", "machine"))
    for built, angle in ((like_axis, 180.0), (machine, 90.0)):
        up = rot_about((1, 0, 1), angle).T @ (0, 0, 1)
        expected = -100.0 * up[:2] / np.hypot(*up[:2])
        assert built.mm([0] * 5)[:2] == pytest.approx(expected, abs=1e-9)
    with pytest.raises(MachineDataError, match="target angle"):
        build(59, {7: 45, 19: 91, 20: 2}, radius=100.0)


def test_the_offset_is_taken_off_the_target_angle() -> None:
    with_offset = build(59, {7: 40, 21: 1, 15: 20, 19: 80, 20: 2}, radius=100.0)
    without = build(59, {7: 40, 21: 1, 19: 60, 20: 2}, radius=100.0)
    assert distance(with_offset.robot.fk([0, 0, 0, 0, 20]), without.robot.fk([0] * 5)) < 1e-12


def test_a_saw_without_radius_stays_at_the_centre() -> None:
    built = build(59, {7: 45, 19: 30, 20: 2})
    assert "CB424" in built.codes()
    assert built.mm([0] * 5) == pytest.approx((0, 0, 0), abs=1e-12)


def test_underfloor_cutter() -> None:
    hd: Hd = {7: 45, 2: 10, 19: 90, 20: 1}
    assert build(59, hd).mm([0] * 5) == pytest.approx((10, 0, 0), abs=1e-12)
    assert build(59, hd, kin59_underfloor="turns_tool").mm([0] * 5) == pytest.approx((0, 10, 0), abs=1e-12)


# ---------------------------------------------------------------- 70: virtual axis


def test_cv_turns_the_programmed_tool_vector() -> None:
    s, c = math.sin(*rad(10)), math.cos(*rad(10))
    for choice, vector in (("programmed", (0, s, c)), ("machine", (s, 0, c))):
        assert build(70, kin70_cv=choice).tool_vector([0, 0, 0, 10, 0, 90]) == pytest.approx(vector, abs=1e-12)
    hd: Hd = {1: 50, 4: 20, 7: 3, 8: 4, 9: -1, 10: 1, 14: 25}
    built, plain = build(70, hd), build(70, hd, kin70_cv="machine")
    for axes in axes_inside(plain.robot, 10):
        still = [*axes[:5], 0.0]
        assert distance(built.robot.fk(still), plain.robot.fk(still)) < 1e-12
        turned = rot_z(25 + axes[5]) @ rot_z(-25) @ plain.tool_vector(still)
        assert built.tool_vector(axes) == pytest.approx(turned, abs=1e-12)


def test_cv_beyond_the_quarter_turn() -> None:
    built, plain = build(70), build(70, kin70_cv="machine")
    for b, a in ((170.0, 130.0), (-200.0, 40.0), (20.0, -260.0), (400.0, 95.0)):
        assert built.robot.q([0, 0, 0, b, a, 0]) == pytest.approx(plain.robot.q([0, 0, 0, b, a, 0]), abs=1e-12)
        expected = rot_z(66) @ plain.tool_vector([0, 0, 0, b, a, 0])
        assert built.tool_vector([0, 0, 0, b, a, 66]) == pytest.approx(expected, abs=1e-12)
    low, high = built.robot.chain.axis_map.q_bounds(np.full(6, -400.0), np.full(6, 400.0))
    assert high[3] == pytest.approx(math.radians(580)) and low[4] == pytest.approx(-math.radians(580))


def test_cv_is_an_input_and_a_and_b_are_bounded() -> None:
    by_name = {axis.name: axis for axis in build(70).robot.axes}
    assert by_name["CV"].held
    assert all((by_name[n].lower, by_name[n].upper) == (-90, 90) for n in "AB")


def test_mounting_of_the_head_of_70() -> None:
    for choice, x in (("plus", 1.0), ("minus", -1.0)):
        built = build(70, {14: 90}, kin70_hd14_sign=choice)
        assert built.tool_vector([0, 0, 0, 0, 10, 0]) == pytest.approx((x * math.sin(*rad(10)), 0, math.cos(*rad(10))))
    for choice, place in (("inside_hd14", (0, -10, 0)), ("outside_hd14", (-10, 0, 0))):
        assert build(70, {2: 10, 14: 90}, kin70_offset_place=choice).mm([0] * 6) == pytest.approx(place, abs=1e-12)


# ---------------------------------------------------------------- 207: oblique plunge

SAW: Hd = {2: 10, 3: 100, 4: 60, 11: -400}


def tip(axes: list[float], length: float) -> Vector:
    """The tip of the blade by hand: Rx(60) turns (0, 0, -HD2 - L) into the YZ plane."""
    reach = 10 + length
    on_c = np.array([0, reach * math.sin(*rad(60)), -100 - reach * math.cos(*rad(60))])
    place: Vector = np.array(axes[:3]) + rot_z(axes[3]) @ on_c
    return place


def slid(p: Vector, c: float, z0: float) -> Vector:
    plunge = rot_z(c) @ (0, math.cos(*rad(60)), math.sin(*rad(60)))
    place: Vector = p + plunge * (z0 - p[2]) / plunge[2]
    return place


@pytest.mark.parametrize("relative", [False, True])
def test_which_point_is_programmed(relative: bool) -> None:
    axes = [11.0, 22.0, -250.0, 40.0]
    p = tip(axes, 30.0)
    on_plane = slid(p, 40.0, -400 + (p[2] + 250 if relative else 0))
    places = {"tip": p, "slid_xyz": on_plane, "slid_xy_tip_z": np.array([*on_plane[:2], p[2]])}
    for choice, place in places.items():
        chosen = {"kin207_programmed_point": choice, "kin207_z0": "relative" if relative else "absolute"}
        built = build(207, SAW, 30.0, **chosen)
        assert built.mm(axes) == pytest.approx(place, abs=1e-9)
        assert built.tool_vector(axes) == pytest.approx(rot_z(40) @ rot_x(60) @ (0, 0, 1), abs=1e-12)
        assert ("kin207_z0" in built.asked()) == (choice != "tip")


def test_moving_z_alone_drives_the_blade_along_itself() -> None:
    built = build(207, SAW, 30.0)
    target = built.robot.fk([0, 0, -200, 40])
    target.translation[2] -= 0.05
    found = built.robot.ik(target, start=[0, 0, -200, 40])
    assert found.success
    moved = tip(list(found.axes), 30.0) - tip([0, 0, -200, 40], 30.0)
    assert np.cross(moved, rot_z(40) @ (0, math.cos(*rad(60)), math.sin(*rad(60)))) == pytest.approx(
        (0, 0, 0), abs=1e-2
    )


def test_a_level_blade_cannot_plunge() -> None:
    for angle in (0.0, 180.0):
        with pytest.raises(MachineDataError, match="cannot plunge"):
            build(207, {4: angle})
        assert np.isfinite(build(207, {4: angle}, strict=False).mm([0] * 4)).all()
        assert build(207, {4: angle, 2: 10}, kin207_programmed_point="tip").mm([1, 2, 3, 0])[0] == 1
    upright = build(207, {4: 90, 11: -50}, kin207_programmed_point="slid_xyz")
    assert upright.mm([1, 2, 3, 40]) == pytest.approx((1, 2, -50), abs=1e-9)
