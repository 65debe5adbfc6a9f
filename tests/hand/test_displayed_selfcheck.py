"""The hand formulas of displayed columns, drives and vectors against printed numbers and against plain algebra."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from .displayed import (
    ROTARY,
    angles_of_rotation,
    displayed,
    displayed_robx,
    drives_3,
    drives_28,
    drives_59,
    drives_60,
    drives_70,
    drives_76,
    free_letters,
    kin76_axes,
    rotation_from_vector,
    rotation_in_plane,
    rotation_of_angles,
    status_turn_45,
    universal_angles,
    wrist_45,
)
from .displayed_angles import PAIRS, SEQUENCES, UNIT, X, Y, Z, rot

RNG = np.random.default_rng(4)
THREE = tuple(SEQUENCES)


def random_rotation() -> np.ndarray:
    q = RNG.normal(size=4)
    a, b, c, d = q / np.linalg.norm(q)
    return np.array(
        [
            [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
            [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
            [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d],
        ]
    )


def random_unit() -> np.ndarray:
    v = RNG.normal(size=3)
    return v / np.linalg.norm(v)


# --- P-CHAN-00112 ---


def test_single_turns_are_the_text_book_ones() -> None:
    assert np.allclose(rot(Z, 90) @ X, Y)
    assert np.allclose(rot(X, 90) @ Y, Z)
    assert np.allclose(rot(Y, 90) @ Z, X)


def test_cba_equals_ypr_as_printed() -> None:
    cba = rotation_of_angles(2, {"A": 15, "B": -90, "C": 20})
    assert np.allclose(cba, rotation_of_angles(0, {"A": 20, "B": 90, "C": 15}), atol=1e-15)


def test_cba_std_is_cba_with_other_letters() -> None:
    assert np.allclose(rotation_of_angles(4, {"A": 1, "B": 2, "C": 3}), rotation_of_angles(2, {"A": 3, "B": 2, "C": 1}))


def test_sequences_written_out() -> None:
    word = {"A": 11.0, "B": 22.0, "C": 33.0}
    assert np.allclose(rotation_of_angles(0, word), rot(Z, 33) @ rot(Y, -22) @ rot(X, 11))
    assert np.allclose(rotation_of_angles(1, word), rot(Z, 33) @ rot(Y, 22) @ rot(Z, 11))
    assert np.allclose(rotation_of_angles(1, word, {"euler_letters": "a_first"}), rot(Z, 11) @ rot(Y, 22) @ rot(Z, 33))
    assert np.allclose(rotation_of_angles(3, word), rot(Z, 33) @ rot(X, 11) @ rot(Y, 22))
    assert np.allclose(rotation_of_angles(5, word), rot(X, 11) @ rot(Y, 22) @ rot(Z, 33))
    assert np.allclose(rotation_of_angles(14, word), rot(X, 11) @ rot(Y, 22))
    assert np.allclose(rotation_of_angles(15, word), rot(Y, 22) @ rot(X, 11))


@pytest.mark.parametrize("mode", THREE)
def test_angles_rebuild_the_rotation_and_come_back(mode: int) -> None:
    for _ in range(300):
        R = random_rotation()
        found = angles_of_rotation(mode, R)
        assert np.allclose(rotation_of_angles(mode, found), R, atol=1e-12)
        middle = "A" if mode == 3 else "B"
        assert (0 if mode == 1 else -90) <= found[middle] <= (180 if mode == 1 else 90)
        word = {"A": RNG.uniform(-400, 400), "B": RNG.uniform(-400, 400), "C": RNG.uniform(-400, 400)}
        again = angles_of_rotation(mode, rotation_of_angles(mode, word), before=word)
        assert again == pytest.approx(word, abs=1e-8)


@pytest.mark.parametrize("mode", THREE)
@pytest.mark.parametrize("middle", [90.0, -90.0, 0.0, 180.0])
def test_gimbal_lock_keeps_one_angle(mode: int, middle: float) -> None:
    letters = {0: "CBA", 1: "CBA", 2: "ABC", 3: "CAB", 4: "CBA", 5: "ABC"}[mode]
    if (mode == 1) != (middle in (0.0, 180.0)):
        return
    word = {letters[0]: 31.0, letters[1]: middle, letters[2]: -47.0}
    R = rotation_of_angles(mode, word)
    for keep, held in (("third", letters[2]), ("first", letters[0])):
        assert (found := angles_of_rotation(mode, R, keep=keep))[held] == 0.0
        assert np.allclose(rotation_of_angles(mode, found), R, atol=1e-12)
        found = angles_of_rotation(mode, R, before={**word, held: 12.0}, keep=keep)
        assert found[held] == 12.0
        assert np.allclose(rotation_of_angles(mode, found), R, atol=1e-12)


@pytest.mark.parametrize("mode", [14, 15])
def test_two_letter_modes(mode: int) -> None:
    for _ in range(100):
        word = {"A": RNG.uniform(-179, 179), "B": RNG.uniform(-179, 179)}
        R = rotation_of_angles(mode, word)
        assert angles_of_rotation(mode, R) == pytest.approx(word, abs=1e-8)
        R = random_rotation()
        for reading, tool in (("z", Z), ("as_91", {14: X, 15: Y}[mode])):
            found = angles_of_rotation(mode, R, {"two_angle_tool": reading})
            assert np.allclose(rotation_of_angles(mode, found) @ tool, R @ tool, atol=1e-12)
    assert list(displayed(45, dict.fromkeys("abcdef", 0.0), np.eye(3), X, angle_mode=mode))[3:] == ["a_deg", "b_deg"]


def test_mode_minus_one_has_no_order() -> None:
    with pytest.raises(ValueError, match="no sequence"):
        displayed(45, dict.fromkeys("abcdef", 0.0), np.eye(3), X, angle_mode=-1)
    R = rotation_of_angles(4, {"A": 10, "B": 20, "C": 30})
    out = displayed(45, dict.fromkeys("abcdef", 0.0), R, X, angle_mode=-1, params={"pass_through_as": 4})
    assert (out["a_deg"], out["b_deg"], out["c_deg"]) == pytest.approx((10, 20, 30))


# --- programming modes of 91 ---


def test_mode_14_prints_the_numbers_of_the_note() -> None:
    v = rot(Z, 30) @ rot(X, 20) @ Z
    assert universal_angles(14, v) == pytest.approx((17.495, -80.153), abs=5e-4)
    assert universal_angles(14, v, (190, 70)) == pytest.approx((197.495, 80.153), abs=5e-4)
    assert universal_angles(17, v) == pytest.approx((30, 20))


def test_the_manuals_two_answers_of_a_ca_head() -> None:
    v = (0.0, -0.7071, 0.7071)
    assert universal_angles(17, v) == pytest.approx((0, 45))
    assert universal_angles(17, v, (170, -40)) == pytest.approx((180, -45))
    assert universal_angles(17, (0.0, 0.0, 1.0), (123.0, 5.0)) == pytest.approx((123, 0))  # the singular vector: any C


@pytest.mark.parametrize("mode", sorted(PAIRS))
def test_universal_angles_aim_the_tool(mode: int) -> None:
    first, second, e = PAIRS[mode].split()
    for _ in range(1000):
        v = random_unit()
        answers = [universal_angles(mode, v)]
        assert -90 < answers[0][0] <= 90
        a, b = answers[0]
        answers.append(universal_angles(mode, v, (a + 170, (180 - b if mode > 19 else -b) + 3)))
        assert answers[1][0] == pytest.approx(a + 180, abs=1e-9)
        for one, two in answers:
            assert np.allclose(rot(UNIT[first[1]], one) @ rot(UNIT[second[1]], two) @ UNIT[e], v, atol=1e-12)
    pole = UNIT[first[1]]
    assert universal_angles(mode, pole, (77.0, 1.0))[0] == 77.0
    assert universal_angles(mode, -pole)[0] == 0.0


# --- columns ---


@pytest.mark.parametrize("kin", sorted(ROTARY))
def test_rtcp_types_show_their_rotary_axes(kin: int) -> None:
    rotary = ROTARY[kin].split()
    if rotary:
        axes = {"X": 1.0, "Y": 2.0, "Z": 3.0} | {name: 10.0 * (i + 1) for i, name in enumerate(rotary)}
    else:
        axes = {85: {"X": 1.0, "C": 50.0}, 203: {"C": 50.0, "YL": 2.0, "ZL": 3.0}}.get(
            kin, {"X": 1.0, "C": 5.0, "Z": 3.0}
        )
    out = displayed(kin, axes, random_rotation(), (7, 8, 9))
    assert list(out) == ["x_mm", "y_mm", "z_mm", *rotary]
    assert all(out[name] == axes[name] for name in rotary)
    assert (out["x_mm"], out["y_mm"], out["z_mm"]) == (7, 8, 9)


def test_an_axis_too_many_is_told() -> None:
    with pytest.raises(ValueError, match="expected"):
        displayed(9, dict.fromkeys("XYZC", 0.0), np.eye(3), X)


def test_scara_c() -> None:
    axes, R = {"C1": 20.0, "C2": 30.0, "Z": 0.0, "C3": 15.0}, rot(Z, 65)
    assert displayed(36, axes, R, X)["C3"] == 15
    assert displayed(36, axes, R, X, params={"kin36_c": "absolute"})["c_deg"] == pytest.approx(65)


@pytest.mark.parametrize(("hd10", "zero"), [(0, X), (1, -X)])
def test_202_angle_of_the_tool(hd10: int, zero: np.ndarray) -> None:
    axes = {"XQ": 0.0, "YQ": 50.0, "ZQ": 0.0, "CS": 20.0}
    tool = rot(Z, 50 - 20) @ zero
    R = np.column_stack((-Z, np.cross(tool, -Z), tool))
    assert np.linalg.det(R) == pytest.approx(1)
    shown = {
        name: displayed(202, axes, R, X, params={"hd10": hd10, "kin202_c": name})
        for name in ("relative", "tool_vector")
    }
    assert shown["relative"]["c_deg"] == pytest.approx(30)
    assert shown["tool_vector"]["c_deg"] == pytest.approx(30 - 180 * hd10)


def test_complete_types() -> None:
    arm = dict.fromkeys("abcdef", 0.0)
    R = rotation_of_angles(0, {"A": 10, "B": 20, "C": 30})
    assert list(displayed(12, arm, R, X)) == ["x_mm", "y_mm", "z_mm"]
    assert displayed(96, arm, rot(Z, 33), X)["c_deg"] == pytest.approx(33)
    bevel = displayed(76, arm, rot(Z, -100) @ rot(X, 40), X)
    assert list(bevel)[3:] == ["c_deg", "a_deg"]
    assert (bevel["c_deg"], bevel["a_deg"]) == pytest.approx((-100, 40))
    for kin, columns in (
        (45, ["a_deg", "b_deg", "c_deg"]),
        (206, ["a_deg", "b_deg", "c_deg"]),
        (213, ["b_deg", "c_deg"]),
    ):
        out = displayed(kin, arm, R, X)
        assert list(out)[3:] == columns
        assert [out[c] for c in columns] == pytest.approx([{"a": 10, "b": 20, "c": 30}[c[0]] for c in columns])
    assert displayed(19, arm, R, X)["tool_z"] == R[2, 2]


def test_213_flat_flange_shows_b_0_and_its_turn() -> None:
    out = displayed(213, dict.fromkeys("abcde", 0.0), rot(Z, 23) @ rot(Y, -90 + 90) @ rot(Z, 47), X)
    assert (out["b_deg"], out["c_deg"]) == pytest.approx((0, 70))


def test_213_b_says_level_in_one_reading_only() -> None:
    arm = dict.fromkeys("abcde", 0.0)
    reading = {"kin213_bc": "pitch_and_sum"}
    for a1, pitch, a5 in ((23, -11, 47), (-160, 30, 90), (100, 20, -170)):
        R, p = rot(Z, a1) @ rot(Y, pitch) @ rot(Z, a5), 900 * (rot(Z, a1) @ X) + 500 * Z
        out = displayed(213, arm, R, p, params=reading)
        assert out["b_deg"] == pytest.approx(pitch)
        assert math.remainder(out["c_deg"] - a1 - a5, 360) == pytest.approx(0, abs=1e-9)
    tilted = rot(Z, 23) @ rot(Y, 30) @ rot(Z, 90)
    assert displayed(213, arm, tilted, X)["b_deg"] == pytest.approx(0)  # pose angles: B = 0 though it tilts by 30


def test_208_pose_reading_misses_the_tilt_of_the_last_joint() -> None:
    axes = dict.fromkeys(("A1", "A2", "A3", "A4", "A5"), 0.0)
    for mode in THREE:
        seen = displayed(208, axes, rot(Y, 25), X, angle_mode=mode, params={"kin208_angles": "pose"})
        assert (seen["c_deg"], seen["a_deg"]) == pytest.approx((0, 0))
    assert abs(displayed(208, axes, rot(Y, 25), X)["a_deg"]) == pytest.approx(25)


def test_208_readings() -> None:
    axes = dict.fromkeys(("A1", "A2", "A3", "A4", "A5"), 0.0)
    R = rot(X, 35) @ rot(Y, 25)  # joints about X, X, X, Y: the free part of its orientation
    two = displayed(208, axes, R, X)
    assert np.allclose(rot(Z, two["c_deg"]) @ rot(X, two["a_deg"]) @ Z, R[:, 2])
    assert list(two)[3:] == ["c_deg", "a_deg"]
    pose = displayed(208, axes, R, X, angle_mode=5, params={"kin208_angles": "pose"})
    assert (pose["c_deg"], pose["a_deg"]) == pytest.approx((0, 35))  # in mode 5 C says nothing
    assert (displayed(208, axes, rot(X, 35), X)["c_deg"], displayed(208, axes, rot(X, 35), X)["a_deg"]) == (
        0,
        pytest.approx(35),
    )


def test_universal_columns() -> None:
    axes = {"X": 0.0, "Y": 0.0, "Z": 0.0, "C": 30.0, "A": 20.0}
    R = rot(Z, 30) @ rot(X, 20)
    assert list(displayed(91, axes, R, X, params={"rtcp": 1}))[3:] == ["C", "A"]
    assert list(displayed(91, axes, R, X))[3:] == ["a_deg", "b_deg", "c_deg"]
    shown = displayed(91, axes, R, X, angle_mode=17, params={"rtcp": 1, "programming_mode": 14})
    assert (shown["a_deg"], shown["b_deg"]) == pytest.approx((17.495, -80.153), abs=5e-4)
    assert list(displayed(91, axes, R, X, angle_mode=17))[3:] == ["c_deg", "a_deg"]
    assert list(displayed(91, axes, R, X, params={"programming_mode": 10}))[3:] == ["tool_x", "tool_y", "tool_z"]
    with pytest.raises(ValueError, match="refused"):
        displayed(91, axes, R, X, params={"programming_mode": 11})


# --- ROBX ---


@pytest.mark.parametrize("tool_dir", [0, -1, 1])
def test_robx_angles(tool_dir: int) -> None:
    for _ in range(200):
        R = random_rotation()
        out = displayed_robx(6, R, X, tool_dir)
        a, b, c = out["a_deg"], out["b_deg"], out["c_deg"]
        orders = {1: rot(X, a) @ rot(Y, b) @ rot(Z, c)}
        assert np.allclose(orders.get(tool_dir, rot(Z, a) @ rot(Y, b) @ rot(X, c)), R, atol=1e-12)
        assert -90 <= b <= 90
        assert np.allclose([out["tool_x"], out["tool_y"], out["tool_z"]], R[:, 2 if tool_dir == 1 else 0])
        five = displayed_robx(5, R, X, tool_dir)
        assert (five["a_deg"], five["b_deg"]) == (a, b)
        assert "c_deg" not in five
        assert displayed_robx(4, R, X, tool_dir)["c_deg"] == c


def test_robx_upright_scara_shows_c_alone() -> None:
    out = displayed_robx(4, rot(Y, 90) @ rot(X, 40), X)
    assert [name for name in out if name.endswith("deg")] == ["c_deg"]
    assert out["c_deg"] == pytest.approx(40)
    assert displayed_robx(6, rot(Y, 90) @ rot(X, 40), X)["a_deg"] == 0.0


def test_robx_runs_through_180() -> None:
    out = displayed_robx(6, rot(Z, -179) @ rot(X, 181), X, before={"a_deg": 178.0, "b_deg": 0.0, "c_deg": 179.0})
    assert (out["a_deg"], out["c_deg"]) == pytest.approx((181, 181))


# --- drives ---


def test_28_geared_two_to_one() -> None:
    assert drives_28(0, 80, {16: 2, 17: 1}) == {"C": 0, "A": 160}
    assert drives_28(30, 80, {11: 5, 12: 1, 13: 3}) == pytest.approx({"C": 30, "A": 95})
    with pytest.raises(ValueError, match="denominator"):
        drives_28(0, 0, {12: 1})


def test_59_prints_the_number_of_the_note() -> None:
    assert drives_59(0, 85, {7: 45})["A"] == pytest.approx(145.658, abs=5e-4)
    assert drives_59(10, 90, {7: 45})["A"] == pytest.approx(180)  # 2*HD7 is the largest spatial angle
    with pytest.raises(ValueError, match="beyond"):
        drives_59(0, 91, {7: 45})


@pytest.mark.parametrize("hd7", [30.0, 45.0, 60.0])
def test_cardan_drives_aim_the_spatial_direction(hd7: float) -> None:
    for _ in range(100):
        c, tilt = RNG.uniform(-180, 180), RNG.uniform(-2, 2) * hd7
        s, k = math.sin(math.radians(hd7)), math.cos(math.radians(hd7))
        head = drives_59(c, tilt, {7: hd7})
        assert np.allclose(rot(Z, head["C"]) @ rot((s, 0, k), head["A"]) @ Z, rot(Z, c) @ rot(X, tilt) @ Z)
        for name, side in (("plus", 1), ("minus", -1)):
            head = drives_60(c, tilt, {7: hd7}, {"kin60_tilt_sign": name})
            assert np.allclose(rot(Z, head["C"]) @ rot((0, side * s, k), head["B"]) @ Z, rot(Z, c) @ rot(Y, tilt) @ Z)


def test_59_zero_offsets_move_the_head_and_inner_ones_do_not() -> None:
    assert drives_59(0, 0, {7: 45, 16: 3, 17: 4}) == {"C": 3, "A": 4}
    assert drives_59(0, 0, {7: 45, 14: 3, 15: 4}) == {"C": 0, "A": 0}
    moved = drives_59(0, 0, {7: 45, 17: 4}, {"kin59_zero_offset_place": "before_conversion"})
    assert moved == pytest.approx(drives_59(0, 4, {7: 45}))
    assert drives_59(7, 120, {7: 45, 21: 1}) == {"C": 7, "A": 120}


def test_70_follows_cv() -> None:
    for _ in range(200):
        b, a, cv, hd14 = RNG.uniform(-50, 50), RNG.uniform(-50, 50), RNG.uniform(-180, 180), RNG.uniform(-90, 90)
        hd = {7: 2.0, 8: 3.0, 9: -1.0, 14: hd14}
        wanted = rot(Z, cv) @ rot(Z, hd14) @ rot(Y, b - 3) @ rot(X, -a - 2) @ Z
        out = drives_70(b, a, cv, hd)
        assert np.allclose(rot(Z, hd14) @ rot(Y, out["B"] - 3) @ rot(X, -out["A"] - 2) @ Z, wanted)
        still = drives_70(b, a, 0.0, hd)
        assert (still["B"], still["A"]) == pytest.approx((b, a))
    with pytest.raises(ValueError, match="range"):
        drives_70(0, 95, 10, {})
    assert drives_70(20, 0, 90, {})["A"] == pytest.approx(-20)  # a tilt towards +X becomes one towards +Y


@pytest.mark.parametrize("axes", ["b_outside", "a_outside", "vertical_outside"])
def test_76_machine_axes_reach_the_programmed_direction(axes: str) -> None:
    hd, options = {6: 25.0, 7: 65.0}, {"kin76_axes": axes}
    outer, u1, inner, u2 = kin76_axes(hd, options)
    for _ in range(200):
        c, a = RNG.uniform(-180, 180), RNG.uniform(-60, 60)
        out = drives_76(c, a, hd, options)
        assert np.allclose(
            rot(Z, 25) @ rot(u1, out[outer]) @ rot(u2, out[inner]) @ Z, rot(Z, c) @ rot(X, a) @ Z, atol=1e-9
        )
    assert drives_76(0, 0, {7: 65.0}, options) == pytest.approx({"A": 0, "B": 0})


def test_76_limit_of_b_outside_is_hd7() -> None:
    assert drives_76(0, 64.99, {7: 65.0})
    with pytest.raises(ValueError, match="reach"):
        drives_76(0, 65.01, {7: 65.0})


def test_3_turns_half_way_where_the_axis_is_programmed() -> None:
    assert drives_3(10, {"kin3_b_value": "programmed"}) == {"B": 190}
    assert drives_3(10) == {"B": 10}


# --- status and turn ---

ARM = {7: 450.0, 8: 700.0, 9: 750.0, 10: 100.0, 11: 150.0, 12: 40.0, 14: -90.0, 15: 90.0}


def test_the_manuals_sample_pose_has_is_2_and_it_2() -> None:
    home = (0, -90, 90, 0, 0, 0)  # upper arm upright, forearm level
    assert status_turn_45(home, ARM) == (2, 2)
    flange = rot(Y, 0 + 0 + 0) @ rot(Y, 90)
    for mode in (2, 4):
        assert np.allclose(flange, rotation_of_angles(mode, {"B": 90}))
    assert not np.allclose(flange, rotation_of_angles(0, {"B": 90}))


def test_status_bits_from_geometry() -> None:
    assert status_turn_45((0, -90, 90, 0, -1, 0), ARM) == (6, 18)
    assert status_turn_45((-1, -1, -1, -1, -1, -1), ARM)[1] == 63
    assert status_turn_45((0, 0, 0, 0, 0, 0), {**ARM, 12: 0.0}) == (0, 0)  # stretched: on the line, not in front
    assert status_turn_45((0, 0, 1, 0, 0, 0), {**ARM, 12: 0.0})[0] == 2
    behind, _ = status_turn_45((0, -150, 10, 0, 5, 0), ARM)
    assert behind & 1 == 1
    assert wrist_45((0, -150, 10, 0, 5, 0), ARM)[2][0] < 0


def test_elbow_bit_changes_where_the_wrist_crosses_the_line() -> None:
    for _ in range(200):
        axes = [0.0, *RNG.uniform(-120, 120, 2), 0.0, 5.0, 0.0]
        shoulder, elbow, wrist = wrist_45(axes, ARM)
        side = np.cross(elbow - shoulder, wrist - shoulder)[1]
        assert (status_turn_45(axes, ARM)[0] & 2 == 2) == (side > 0)
        turned = [axes[0] + 77.0, *axes[1:]]
        assert status_turn_45(turned, ARM)[0] == status_turn_45(axes, ARM)[0]


# --- vectors ---

FIRST = """X149.316 Z165.012 A-0.0457 C0.999; X188.532 Z146.7645 A0.2111 C0.9775; X198.2064 Z144.3474 A0.2758 C0.9612;
X207.7002 Z141.2733 A0.3393 C0.9407; X216.978 Z137.5713 A0.4012 C0.916"""
SECOND = """X10.667 Y1.976 I-.097 J-.018 K.995; X9.517 Y4.713 I-.088 J-.043 K.995; X7.387 Y7.597 I-.068 J-.07 K.995;
X3.924 Y10.011 I-.035 J-.091 K.995; X-3.083 Y9.956 I.028 J-.093 K.995; X-8.601 Y6.233 I.078 J-.057 K.995"""


def words(text: str) -> list[dict[str, float]]:
    return [{w[0]: float(w[1:]) for w in re.findall(r"[A-Z]-?[\d.]+", line)} for line in text.split(";")]


def test_the_vectors_of_the_manuals_programs_stand_on_the_path_from_the_tip_up() -> None:
    rows = words(FIRST)[1:]
    for last, row, after in zip(rows, rows[1:], rows[2:], strict=False):
        path = np.array([after["X"] - last["X"], after["Z"] - last["Z"]])
        v = np.array([row["A"], row["C"]])
        assert abs(path @ v) / np.linalg.norm(path) < 2e-3
        assert v[1] > 0
    for row in words(SECOND):  # a cone about Z that opens downwards: the holder leans to the middle
        assert row["X"] * row["I"] + row["Y"] * row["J"] < 0
        assert abs(row["X"] * row["J"] - row["Y"] * row["I"]) < 0.02
        assert math.hypot(row["I"], row["J"], row["K"]) == pytest.approx(1, abs=1e-3)


def test_which_angle_leaves_the_vector_free() -> None:
    assert {mode: free_letters(mode) for mode in THREE} == {0: ["A"], 1: ["C"], 2: ["C"], 3: ["C"], 4: ["A"], 5: ["A"]}
    assert {mode: free_letters(mode, "z") for mode in (0, 2, 4, 5)} == {0: ["C"], 2: ["A"], 4: ["C"], 5: ["C"]}
    with pytest.raises(ValueError, match="binds"):
        rotation_from_vector(0, X, "C", 45.0)


@pytest.mark.parametrize("mode", THREE)
@pytest.mark.parametrize("axis", ["x", "z"])
def test_vector_met_and_angle_kept(mode: int, axis: str) -> None:
    letter = free_letters(mode, axis)[0]
    for _ in range(300):
        v, kept, R0 = random_unit(), RNG.uniform(-180, 180), random_rotation()
        plain = rotation_from_vector(mode, 3 * v, letter, kept, vector_axis=axis)
        near = rotation_from_vector(mode, v, letter, kept, R_before=R0, vector_axis=axis)
        assert np.trace(R0.T @ near) >= np.trace(R0.T @ plain) - 1e-12
        for R in (plain, near):
            assert np.allclose(R @ UNIT[axis], v, atol=1e-12)
            assert np.linalg.det(R) == pytest.approx(1)
            shown = angles_of_rotation(mode, R)[letter] - kept  # the other answer of the mode has it 180 away
            gaps = [abs((shown + turn) % 360 - 180) for turn in (180, 0)]
            assert min(gaps) < 1e-9


def test_vector_programs_keep_c_45_in_mode_2() -> None:
    for row in words(FIRST):
        v = np.array([row["A"], 0.0, row["C"]])
        R = rotation_from_vector(2, v, "C", 45.0)
        assert np.allclose(R[:, 0], v / np.linalg.norm(v), atol=1e-12)
        assert angles_of_rotation(2, R)["C"] == pytest.approx(45)
    before = rotation_of_angles(2, {"A": 20, "B": -90, "C": 45})
    assert np.allclose(rotation_from_vector(2, Z, "C", 45.0, R_before=before), before)  # at the pole A stays


@pytest.mark.parametrize("plane", [1, 2])
def test_tool_axis_in_plane(plane: int) -> None:
    across, column = ((1, 2), (0, 1))[plane - 1]
    for _ in range(1000):
        v, R0 = random_unit(), random_rotation()
        R = rotation_in_plane(5 * v, plane, R0)
        assert np.allclose(R.T @ R, np.eye(3), atol=1e-12)
        assert np.linalg.det(R) == pytest.approx(1)
        assert np.allclose(R[:, 0], v, atol=1e-12)
        assert abs(R[across, column]) < 1e-12
        assert np.trace(R0.T @ R) >= np.trace(R0.T @ R @ rot(X, 180)) - 1e-12
    along = (Y, X)[plane - 1]
    spin = rotation_in_plane(along, plane, R0)
    assert np.allclose(rotation_in_plane(along, plane, spin), spin, atol=1e-12)
    assert np.allclose(rotation_in_plane(-along, plane, spin)[:, 0], -along, atol=1e-12)
