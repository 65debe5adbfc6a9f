"""The hand formulas of the arms against the manual, and every open point against the convention file."""

from __future__ import annotations

import math
import tomllib

import numpy as np
import pytest

from tests.kit.paths import PACKAGE

from .tables_algebra import DEFAULTS, chain, rx, ry, rz
from .tables_cases import CASES, FORMULAS, TIGHT, pose, same

CONVENTIONS = tomllib.loads((PACKAGE / "data" / "conventions_twincat_tables.toml").read_text("utf-8"))


def test_36_zero_bend_and_hands() -> None:
    hd = {2: 225.0, 3: 175.0}
    assert np.allclose(pose(36, hd, [0, 0, 0, 0])[:3, 3], [400, 0, 0])  # stretched along +X
    angle_to_x = pose(36, {**hd, 7: 1}, [30, 90, 0, 0])[:3, 3]
    assert np.allclose(angle_to_x, [225 * math.cos(math.pi / 6), 225 * 0.5 + 175, 0])
    bent = pose(36, {**hd, 8: 90}, [0, 0, 0, 0])[:3, 3]
    assert np.allclose(bent, [225, -175, 0])  # HD8: the zero pose is not stretched
    right, left = pose(36, hd, [10, 60, 0, 0])[:3, 3], pose(36, hd, [40, -60, 0, 0])[:3, 3]
    assert np.hypot(*right[:2]) == pytest.approx(np.hypot(*left[:2]))
    assert pose(36, {1: 50.0}, [0, 0, 200, 0], 30)[2, 3] == pytest.approx(120)  # length along Z


def test_85_left_and_right_lever_share_a_point() -> None:
    hd, g = {1: 500.0, 2: 300.0, 3: 20.0}, 35.0
    right = pose(85, hd, [100, g + 20])[:3, 3]
    left = pose(85, hd, [100 + 600 * math.cos(math.radians(g)), 180 - g + 20])[:3, 3]
    assert np.allclose(right, left, atol=TIGHT)
    assert np.allclose(pose(85, hd, [0, 20])[:3, 3], [300, 0, 500])  # horizontal at C = HD3


def test_96_flange_stays_horizontal_and_arm_2_keeps_its_angle() -> None:
    hd = {number: float(50 + 10 * number) for number in range(1, 11)}
    axes = [25.0, -30.0, 40.0, 55.0]
    assert np.allclose(pose(96, hd, axes)[:3, :3], rz(25 + 55)[:3, :3])
    zero = pose(96, hd, [0] * 4)[:3, 3]
    assert np.allclose(zero, [hd[1] + hd[5] + hd[6] + hd[8], hd[4] + hd[7], hd[2] + hd[3] - hd[10] - hd[9]])
    move = pose(96, hd, [0, 90, 0, 0])[:3, 3] - zero
    assert np.allclose(move, [hd[3], 0, -hd[3]], atol=TIGHT)  # G2 alone moves the head by the first arm's chord
    move = pose(96, hd, [0, 0, 90, 0])[:3, 3] - zero
    assert np.allclose(move, [-hd[5], 0, -hd[5]], atol=TIGHT)


@pytest.mark.parametrize(("kin", "last", "lengthens"), [(206, 37, 1), (208, 31, 2)])
def test_linear_unit_points_and_tool(kin: int, last: int, lengthens: int) -> None:
    count = len(CASES[kin].axes)
    hd = {1: 1.0, 2: 2.0, 3: 3.0, 4: 40.0, 5: 50.0, 6: 60.0, last: 700.0, last + 1: 20.0, last + 2: 900.0}
    zero = pose(kin, hd, [0.0] * count, 10.0)
    expected = np.array([701.0, 22.0, 903.0])
    expected[lengthens] += 10
    assert np.allclose(zero[:3, 3], expected)
    assert np.allclose(zero[:3, :3], chain(rx(60), ry(50), rz(40))[:3, :3])  # HD6 X, HD5 Y', HD4 Z''
    assert np.allclose(pose(kin, hd, [55.0] + [0.0] * (count - 1), 10.0)[:3, 3], expected + [55, 0, 0])
    # the tool at the suspension point of A3 stays there when A3 turns, and turns about X
    for hung, turn in ((19, rx), (31, ry)):
        point = {hung: 30.0, hung + 1: 40.0, hung + 2: 50.0}
        tool = {last: 30.0, last + 1: 40.0, last + 2: 50.0}
        axes = [0.0] * count
        axes[(hung - 13) // 6 + 1] = 35.0
        result = pose(kin, {**tool, **point}, axes)
        assert np.allclose(result[:3, 3], [30, 40, 50]) and np.allclose(result[:3, :3], turn(35)[:3, :3])


def test_linear_unit_deviations_are_small_tilts() -> None:
    travel = pose(206, {10: 1.0, 11: 2.0}, [1000.0, 0, 0, 0, 0, 0])[:3, 3]
    assert np.allclose(travel, chain(rz(2), ry(1))[:3, 0] * 1000)
    axis = {34: 3.0, 35: 4.0}  # A5, nominally Y: turning it leaves its own direction in place
    direction = chain(rz(4), rx(3))[:3, 1]
    turned = pose(208, axis, [0, 0, 0, 0, 70.0])
    assert np.allclose(turned[:3, :3] @ direction, direction)
    toward = pose(208, axis, [0, 0, 0, 0, 70.0], linear_unit_deviation_sense="toward_positive")
    assert np.allclose(toward[:3, :3] @ chain(rz(-4), rx(3))[:3, 1], chain(rz(-4), rx(3))[:3, 1])


def test_213_zero_flange_and_program_example() -> None:
    hd = {7: 700.0, 8: 800.0, 9: 900.0, 10: 100.0, 11: 110.0, 12: 12.0, 48: 48.0, 1: 5.0}
    zero = pose(213, hd, [0] * 5, 7)
    # HD12 > 0: joint 3 above joint 4; HD48 > 0: flange below joint 4
    assert np.allclose(zero[:3, 3], [110 + 900 + 100, 0, 700 + 800 - 12 - 48 - 5 - 7])
    assert np.allclose(zero[:3, :3], np.eye(3))
    # the program's start A2=-90 A3=90 is an upright upper arm and a horizontal forearm with offsets -90, 90
    start = pose(213, {**hd, 14: -90.0, 15: 90.0}, [23, -90, 90, 0, 47])
    assert np.allclose(start[:3, :3], rz(23 + 47)[:3, :3])
    assert start[2, 3] == pytest.approx(zero[2, 3] + 7)
    level = pose(213, hd, [10, 20, 30, -50, 40])
    assert np.allclose(level[:3, :3], rz(50)[:3, :3])  # B = 0: j2 + j3 + j4 = 0
    out = pose(213, {**hd, 2: 2, 3: 3}, [0] * 5, 7, kin213_flange_frame="z_down")
    assert np.allclose(out[:3, 3], [1112, -3, 1428]) and np.allclose(out[:3, 2], [0, 0, -1])


def test_offset_inside_or_outside_the_flag_part_at_a_reversed_axis_only() -> None:
    for kin, offset, flag, printed in ((58, 11, 13, "inside"), (1, 11, 14, "inside"), (213, 38, 25, "outside")):
        other = {"inside": "outside", "outside": "inside"}[printed]
        for value in (0, 1):
            hd, axes = {offset: 20.0, flag: value, 4: 50.0}, CASES[kin].position()
            assert same(pose(kin, hd, axes), pose(kin, hd, axes, offset_inside_flag=printed))
            assert same(pose(kin, hd, axes), pose(kin, hd, axes, offset_inside_flag=other)) == (value == 0)


def test_sign_coding_of_the_symmetric_types() -> None:
    for kin in (23, 52):
        axes = CASES[kin].position()
        for number in (4, 5):
            plain = pose(kin, {}, axes)
            assert same(plain, pose(kin, {number: 1}, axes))
            assert not same(plain, pose(kin, {number: -1}, axes))
            assert same(pose(kin, {number: 1}, axes, sign_coding="zero_one"), pose(kin, {number: -1}, axes))


def test_convention_file_and_formulas_name_the_same_choices() -> None:
    for name, table in CONVENTIONS.items():
        assert DEFAULTS[name] == table["default"] == next(iter(table["choices"])), name
    assert set(DEFAULTS) - set(CONVENTIONS) == {"offset_inside_flag", "sign_coding"}


@pytest.mark.parametrize("name", sorted(set(CONVENTIONS) - {"kin98_hd1"}))
def test_every_choice_gives_another_pose(name: str) -> None:
    table = CONVENTIONS[name]
    extra = {"kin36_tool_angle": {6: 1.0}, "kin202_right_frame": {9: 1.0}, "kin205_x_variant": {15: 0.0, 16: 1.0}}
    kins = [int(text.split()[1]) for text in table["applies"]]
    covered = [kin for kin in kins if kin in FORMULAS]
    assert set(kins) - set(covered) <= {11, 209}  # their formulas live elsewhere
    for kin in covered:
        case = CASES[kin]
        param = {**case.param(), **extra.get(name, {})}
        if name == "table_flag_coding":
            param |= {number - 1: 1.0 for number in case.flags}
        if name == "kin205_legacy_mode":
            param |= {15: 0.0, 16: 0.0}
        poses = [FORMULAS[kin](param, case.position(), 60.0, {name: option}) for option in table["choices"]]
        assert same(poses[0], FORMULAS[kin](param, case.position(), 60.0, {}))
        for i, left in enumerate(poses):
            assert not any(same(left, right) for right in poses[:i]), (kin, i)
