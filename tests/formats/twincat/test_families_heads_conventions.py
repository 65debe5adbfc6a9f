"""Every choice of every convention of the tool heads does what its meaning says, in places worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from chainbuild.convention import conventions
from tests.kit.kin_types import HEADS, build, distance

Hd = dict[int | str, float]
S, C = math.sin(math.radians(30.0)), math.cos(math.radians(30.0))
MACHINE = {7: 45.0, 21: 1.0}  # 59, 60 with machine angles

# convention, its choices (the second one negates the place), type, HDs, axes, place of the tool [mm]
SIGNED_PLACES = [
    *(("named_offset_sign", ("p_to_q", "q_to_p"), kin, hd, axes, place) for kin, hd, axes, place in [
        (2, {3: 10, 2: 20}, (0,) * 5, (-10, -20, 0)),
        (3, {3: 10}, (0, 0, 0, 180), (-10, 0, 0)),
        (4, {3: 10}, (0,) * 4, (-10, 0, 0)),
        (6, {9: 10, 10: 20}, (0,) * 4, (-10, -20, 0)),
        (7, {6: 10, 5: 20}, (0, 0, 0, 90), (20, -10, 0)),
        (17, {6: 10, 5: 20}, (0,) * 3, (-10, -20, 0)),
        (8, {9: 10, 10: 20}, (0, 0, 0, 90), (20, -10, 0)),
        (10, {9: 10, 10: 20}, (0, 0, 0, 90, 0), (20, -10, 0)),
        (18, {9: 10, 10: 20, 5: 90}, (0,) * 3, (20, -10, 0)),
        (207, {9: 10, 10: 20, 4: 90}, (0, 0, 0, 90), (20, -10, 0)),
        (9, {9: 10}, (0, 0, 0, 0, 90), (0, 0, -10)),
        (25, {9: 10}, (0, 0, 0, 90, 0), (10, 0, 0)),
        (28, {9: 10}, (0, 0, 0, 90, 0), (10, 0, 0)),
        (16, {2: 10, 3: 20, 6: 5}, (0,) * 5, (-10, -15, 0)),
        (16, {6: 5}, (0, 0, 0, 0, 90), (0, 0, 5)),
        (30, {6: 10, 7: 20, 2: 1, 3: 2}, (0,) * 4, (-11, -22, 0)),
        (59, {4: 1, 5: 2, 8: 10, 9: 20, 11: 100, 12: 200, **MACHINE}, (0,) * 5, (-111, -222, 0)),
        (60, {4: 1, 5: 2, 8: 10, 9: 20, 11: 100, 12: 200, **MACHINE}, (0, 0, 0, 90, 0), (-78, -211, 0)),
    ]),
    *(("static_offset_sign", ("plus", "minus"), kin, {7: 10, 8: 20, **more}, (0, 0, 0, 77, 0)[:n], (10, 20, 0))
      for kin, n, more in [(5, 4, {}), (6, 4, {}), (7, 4, {}), (8, 4, {}), (9, 5, {}), (10, 5, {}), (17, 3, {4: 77}),
                           (18, 3, {5: 77}), (25, 5, {}), (28, 5, {}), (207, 4, {4: 90})]),
    ("static_offset_sign", ("plus", "minus"), 33, {4: 10, 5: 20, 6: 30}, (0, 0, 0, 77, 5), (10, 20, 30)),
    *(("c_pivot_sign", ("minus", "plus"), kin, {6: 10, 5: 20}, (0, 0, 0, 180, 0), (10, 20, 0)) for kin in (9, 25, 28)),
    ("head_y_offset_sign", ("minus", "plus"), 3, {2: 10}, (0, 0, 0, 33), (0, -10, 0)),
    ("head_y_offset_sign", ("minus", "plus"), 4, {2: 10}, (0, 0, 0, 33), (0, -10, 0)),
    ("kin3_offset_zero", ("tool_down", "tool_up"), 3, {3: 10}, (0, 0, 0, 180), (-10, 0, 0)),
    ("kin5_h_sign", ("minus", "plus"), 5, {2: 10}, (0, 0, 0, 180), (10, 0, 0)),
    ("kin5_hd4_sign", ("minus", "plus"), 5, {4: 10}, (0,) * 4, (0, 0, -10)),
    ("kin6_hd2_sign", ("minus", "plus"), 6, {2: 10}, (0,) * 4, (0, 0, -10)),
    ("kin6_hd4_sign", ("plus", "minus"), 6, {3: 10, 4: 90}, (0,) * 4, (-10, 0, 0)),
    ("saw_hd2_sign", ("minus", "plus"), 8, {2: 10, 4: 90}, (0,) * 4, (0, 10, 0)),
    ("saw_hd2_sign", ("minus", "plus"), 10, {2: 10}, (0, 0, 0, 0, 90), (0, 10, 0)),
    ("saw_hd2_sign", ("minus", "plus"), 18, {2: 10, 4: 90}, (0,) * 3, (0, 10, 0)),
    ("saw_hd2_sign", ("minus", "plus"), 207, {2: 10, 4: 90}, (0,) * 4, (0, 10, 0)),
    ("kin16_heights", ("magnitudes", "signed"), 16, {1: 10, 4: 20}, (0, 0, 0, 90, 0), (-30, 0, 0)),
    ("kin16_hd5_sign", ("plus", "minus"), 16, {5: 10}, (0, 0, 0, 90, 0), (0, 0, -10)),
    ("clamp_offset_sign", ("plus", "minus"), 59, {2: 10, 3: 20, **MACHINE}, (0, 0, 0, 90, 0), (-20, 10, 0)),
    ("clamp_offset_sign", ("plus", "minus"), 60, {2: 10, 3: 20, **MACHINE}, (0, 0, 0, 90, 0), (-20, 10, 0)),
    ("kin70_lateral_sign", ("as_kin16", "reversed"), 70, {2: 10, 3: 20, 5: 1, 6: 2}, (0,) * 6, (-9, -18, 0)),
    ("kin76_offset_sign", ("plus", "minus"), 76, {8: 10, 9: 20, 10: 30}, (0, 0, 0, 40, 50), (10, 20, 30)),
]  # fmt: skip


@pytest.mark.parametrize(("name", "choices", "kin", "hd", "axes", "place"), SIGNED_PLACES)
def test_signs_of_offsets(
    name: str, choices: tuple[str, str], kin: int, hd: Hd, axes: tuple[float, ...], place: tuple[float, ...]
) -> None:
    assert set(choices) == set(conventions()[name].choices) and conventions()[name].default == choices[0]
    for choice, sign in zip(choices, (1.0, -1.0), strict=True):
        built = build(kin, hd, **{name: choice})
        assert built.mm(list(axes)) == pytest.approx(sign * np.array(place), abs=1e-9)
        assert name in built.asked()


@pytest.mark.parametrize(
    ("kin", "n", "axis"),
    [(7, 4, 3), (8, 5, 3), (207, 5, 3), (9, 4, 3), (9, 3, 4), (25, 4, 3), (25, 3, 4), (28, 4, 3), (28, 3, 4),
     (10, 5, 3), (10, 4, 4), (16, 7, 4), (16, 8, 3), (70, 7, 4), (70, 8, 3), (30, 5, 3), (59, 14, 3), (59, 16, 3),
     (59, 15, 4), (59, 17, 4), (60, 14, 3), (60, 15, 4)],
)  # fmt: skip
def test_the_tool_stands_at_zero_at_plus_or_minus_the_offset(kin: int, n: int, axis: int) -> None:
    base: Hd = {207: {4: 90.0}, 59: MACHINE, 60: MACHINE}.get(kin, {})
    at_zero = build(kin, base)
    expected = at_zero.robot.fk(at_zero.zeros())
    for choice, value in (("minus", 10.0), ("plus", -10.0)):
        built = build(kin, {**base, n: 10.0}, angle_offset_sign=choice)
        axes = built.zeros()
        axes[axis] = value
        assert distance(built.robot.fk(axes), expected) < 1e-12
        assert "angle_offset_sign" in built.asked()


@pytest.mark.parametrize(
    ("kin", "sign", "zero", "axis"),
    [(16, 9, 7, 4), (16, 10, 8, 3), (30, 4, 5, 3), (28, 14, 4, 3), (28, 15, 3, 4), (70, 9, 7, 4), (70, 10, 8, 3)],
)
def test_zero_offset_before_or_after_the_direction(kin: int, sign: int, zero: int, axis: int) -> None:
    for choice, value in (("as_printed", -10.0), ("outside", -10.0), ("inside", 10.0)):
        built = build(kin, {sign: -1.0, zero: 10.0}, offset_inside_flag=choice)
        axes = built.zeros()
        axes[axis] = value
        assert built.base_rotation("tool", axes) == pytest.approx(np.eye(3), abs=1e-12)
    assert "offset_inside_flag" not in build(kin, {sign: 1.0, zero: 10.0}).asked()


def test_slide_point_of_2() -> None:
    for choice, x in (("a_axis", -10.0), ("b_axis_at_zero", 0.0)):
        assert build(2, {3: 10, 2: 20}, kin2_slide_point=choice).mm([0] * 5)[0] == pytest.approx(x, abs=1e-12)
    turned = build(2, {3: 10, 2: 20}, kin2_slide_point="b_axis_at_zero", named_offset_sign="q_to_p")
    assert turned.mm([0, 0, 0, 180, 0]) == pytest.approx((0, -40, 0), abs=1e-9)


def test_b_of_the_upper_spindle() -> None:
    for choice, down in (("drive", 180.0), ("programmed", 0.0)):
        assert build(3, kin3_b_value=choice).tool_vector([0, 0, 0, down]) == pytest.approx((0, 0, 1), abs=1e-12)


@pytest.mark.parametrize(("hd5", "opposite", "adjacent"), [(0, 10, 10), (90, 3, 10), (180, 10, 3), (-90, 3, 3)])
def test_spindle_pairs_of_the_cross_head(hd5: float, opposite: float, adjacent: float) -> None:
    for choice, h in (("opposite", opposite), ("adjacent", adjacent), ("sum", 13)):
        built = build(5, {2: 10, 3: 3, 5: hd5}, kin5_spindle_pairs=choice)
        assert built.mm([0, 0, 0, -hd5]) == pytest.approx((-h, 0, 0), abs=1e-9)


def test_the_a_offset_of_6_turns_or_not() -> None:
    for choice, x in (("turns_with_c", 20.0), ("static", 0.0)):
        built = build(6, {9: 10, 10: 5, 3: 7}, kin6_a_axis_offset=choice)
        moved = built.mm([0, 0, 0, 180]) - built.mm([0] * 4)
        assert moved == pytest.approx((x, -14.0 + x / 2, 0), abs=1e-9)
    both = build(6, {9: 10, 10: 5}, kin6_a_axis_offset="static", named_offset_sign="q_to_p")
    assert both.mm([0, 0, 0, 55]) == pytest.approx((10, 5, 0), abs=1e-9)


@pytest.mark.parametrize(("kin", "hd"), [(7, {}), (17, {4: 180.0})])
def test_hd6_inside_or_outside_c(kin: int, hd: Hd) -> None:
    axes = [0, 0, 0, 180][: 4 if kin == 7 else 3]
    for choice, named, x in (
        ("inside_c", "p_to_q", 10.0),
        ("outside_c", "p_to_q", 10.0),
        ("inside_c", "q_to_p", -10.0),
        ("outside_c", "q_to_p", -10.0),
    ):
        built = build(kin, {**hd, 6: 10}, kin7_hd6_place=choice, named_offset_sign=named)
        assert built.mm(axes) == pytest.approx((x, 0, 0), abs=1e-9)
    if kin == 7:
        for choice, x in (("inside_c", -10.0), ("outside_c", 10.0)):
            assert build(7, {6: 10}, kin7_hd6_place=choice).mm([0] * 4) == pytest.approx((x, 0, 0), abs=1e-9)


@pytest.mark.parametrize(("kin", "hd"), [(11, {3: 30}), (60, {7: 30, 21: 1})])
def test_side_of_the_inclined_b(kin: int, hd: Hd) -> None:
    name = f"kin{kin}_tilt_sign"
    for choice, sign in (("plus", 1.0), ("minus", -1.0)):
        built = build(kin, hd, **{name: choice})
        assert sign * built.tool_vector([0, 0, 0, 0, 5])[0] > 0.01
        assert sign * built.tool_vector([0, 0, 0, 0, 180])[1] == pytest.approx(2 * S * C, abs=1e-12)


def test_ideal_length() -> None:
    for choice, ideal in (("with_hd1", 100.0 - 30.0), ("tool_only", 100.0)):
        built = build(11, {1: 30, 2: 100, 3: 40}, ideal, kin11_ideal_length=choice)
        assert built.mm([1, 2, 0, 0, 123]) == pytest.approx((1, 2, 0), abs=1e-9)
        off = build(11, {1: 30, 2: 100, 3: 40}, ideal + 1, kin11_ideal_length=choice)
        assert off.mm([1, 2, 0, 0, 123])[:2] != pytest.approx((1, 2), abs=1e-2)


def test_sense_of_the_workpiece_axis_of_11() -> None:
    for choice, y in (("right_handed", -1.0), ("left_handed", 1.0)):
        built = build(11, table_rotary_sense=choice)
        assert built.tool_vector([0, 0, 0, 90, 0]) == pytest.approx((0, -y, 0), abs=1e-12)
    assert build(11).base_mm("workpiece", [0, 0, 5, 0, 0]) == pytest.approx((0, 0, -5), abs=1e-12)


def test_axis_order_and_sign_coding_of_22() -> None:
    for choice, spins in (("a_outside", False), ("b_outside", True)):
        built = build(22, {1: 10}, kin22_axis_order=choice)
        vector = built.tool_vector([0, 0, 0, 30, 90])
        assert vector == pytest.approx((C, -S, 0) if spins else (1, 0, 0), abs=1e-12)
    for choice, sign in (("plus_minus_one", 1.0), ("zero_one", -1.0)):
        built = build(22, {4: 1, 5: 1}, sign_coding=choice)
        assert built.tool_vector([0, 0, 0, 30, 0]) == pytest.approx((0, -sign * S, C), abs=1e-12)
        assert built.tool_vector([0, 0, 0, 0, 30]) == pytest.approx((sign * S, 0, C), abs=1e-12)
    assert build(22).base_mm("workpiece", [5, 6, 0, 0, 0]) == pytest.approx((-5, -6, 0), abs=1e-12)


def test_tilt_axis_of_33() -> None:
    tops = {"xz_plus": (1, 0), "xz_minus": (-1, 0), "yz_plus": (0, 1), "yz_minus": (0, -1)}
    for choice, (x, y) in tops.items():
        built = build(33, {3: 30}, kin33_tilt_axis=choice)
        assert built.tool_vector([0, 0, 0, 0, 180]) == pytest.approx((2 * S * C * x, 2 * S * C * y, 0.5), abs=1e-12)
        assert built.tool_vector([0, 0, 0, 0, 5])[:2] @ (-y, x) == pytest.approx(
            -S * math.sin(math.radians(5)), abs=1e-12
        )


def test_tool_length_of_33() -> None:
    assert build(33, {3: 30}, 50.0, kin33_tool_length="ignored").mm([0, 0, 0, 20, 70]) == pytest.approx((0, 0, 0))
    counts = build(33, {3: 30}, 50.0, kin33_tool_length="along_tool")
    assert counts.mm([0, 0, 0, 0, 180]) == pytest.approx((-100 * S * C, 0, -25), abs=1e-9)
    assert "CB407" in build(33, {3: 30}, 50.0).codes() and "CB407" not in counts.codes()


def test_every_convention_of_the_heads_has_a_test() -> None:
    here = {name for name, *_ in SIGNED_PLACES} | {
        "angle_offset_sign", "offset_inside_flag", "kin2_slide_point", "kin3_b_value", "kin5_spindle_pairs",
        "kin6_a_axis_offset", "kin7_hd6_place", "kin11_tilt_sign", "kin60_tilt_sign", "kin11_ideal_length",
        "table_rotary_sense", "kin22_axis_order", "sign_coding", "kin33_tilt_axis", "kin33_tool_length",
    }  # fmt: skip
    elsewhere = {  # test_families_heads_special
        "kin25_length", "kin28_axis_values", "gear_flag_place", "spatial_angle_offsets", "kin59_zero_offset",
        "kin59_saw_tcp", "kin59_saw_angle", "kin59_underfloor", "kin70_offset_place", "kin70_hd14_sign", "kin70_cv",
        "kin207_programmed_point", "kin207_z0",
        "kin59_drive_offset", "kin76_machine_axes", "kin76_hd6_sign",  # test_drives
    }  # fmt: skip
    concerned = {c.name for c in conventions().values() if {f"KIN {kin}" for kin in HEADS} & set(c.applies)}
    assert here | elsewhere == concerned
