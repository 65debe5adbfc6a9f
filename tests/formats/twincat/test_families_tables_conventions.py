"""Each choice of each convention of the table and mixed types does what its meaning says, looked at from outside."""

from __future__ import annotations

import numpy as np
import pytest

from chainbuild.convention import applying_to, conventions
from chainbuild.formats.twincat.lists.hdtable import type_data
from chainbuild.frames import rot_x, rot_y, rot_z
from tests.kit.kin_types import axes_anywhere, build, distance, generic_hd
from tests.kit.twincat_files import codes, machine

TYPES = (1, 13, 14, 23, 34, 52, 57, 58, 61, 63, 64, 80, 81, 82, 202, 203, 205, 36, 85, 96, 206, 208, 213)
TURN = {"A": rot_x, "B": rot_y, "C": rot_z}
FLAGGED = {57: "BC", 58: "AC", 61: "AB", 63: "AB", 64: "CAC", 80: "AB", 81: "BA", 82: "BC"}


def axes_with(kin: int, **values: float) -> list[float]:
    """Axis values, 0 where not named."""
    return [values.get(row.name, 0.0) for row in type_data()[kin].axes]


def letter(name: str) -> str:
    """Return the letter that tells what an axis turns about."""
    return {"YQ": "C", "YL": "C", "CS": "C"}.get(name, name[0])


def workpiece_axes() -> list[tuple[int, str]]:
    return [
        (kin, row.name)
        for kin in TYPES
        for row in type_data()[kin].axes
        if row.kind == "rotary" and row.carries == "workpiece"
    ]


@pytest.mark.parametrize(("kin", "name"), workpiece_axes())
def test_table_rotary_sense(kin: int, name: str) -> None:
    for choice, sense in (("right_handed", 1.0), ("left_handed", -1.0)):
        built = build(kin, table_rotary_sense=choice)
        turned = built.base_rotation("workpiece", axes_with(kin, **{name: 10.0}))
        assert turned == pytest.approx(TURN[letter(name)](sense * 10.0), abs=1e-14)
        assert "table_rotary_sense" in built.asked()


def test_left_handed_tables_leave_the_head_alone() -> None:
    for kin, name in ((1, "B"), (23, "A"), (61, "B"), (63, "A"), (82, "B")):
        same = [build(kin, table_rotary_sense=choice) for choice in ("right_handed", "left_handed")]
        turned = [built.base_rotation("tool", axes_with(kin, **{name: 10.0})) for built in same]
        assert turned[0] == pytest.approx(turned[1], abs=0)


def test_left_handed_reverses_the_whole_internal_angle() -> None:
    for choice in ("right_handed", "left_handed"):
        built = build(58, {"offset_a": 30.0}, table_rotary_sense=choice)
        assert built.base_rotation("workpiece", axes_with(58, A=30.0)) == pytest.approx(np.eye(3), abs=1e-14)


@pytest.mark.parametrize("kin", FLAGGED)
def test_table_flag_coding(kin: int) -> None:
    for row in type_data()[kin].axes:
        flag = f"direction_{row.name.lower()}"
        if row.kind != "rotary" or flag not in {hd.name for hd in type_data()[kin].hd}:
            continue
        frame = "tool" if row.carries == "tool" else "workpiece"
        axes = axes_with(kin, **{row.name: 10.0})
        for choice, value, sense in (
            ("zero_one", 0, 1), ("zero_one", 1, -1), ("zero_one", -1, -1),
            ("plus_minus_one", 0, 1), ("plus_minus_one", 1, 1), ("plus_minus_one", -1, -1),
        ):  # fmt: skip
            built = build(kin, {flag: value}, table_flag_coding=choice)
            assert "CB430" not in built.codes()
            assert built.base_rotation(frame, axes) == pytest.approx(TURN[letter(row.name)](sense * 10.0), abs=1e-14)


# Types and axes with a direction and a zero offset → HD values that reverse the axis.
REVERSED = {
    (1, "B"): {13: 0}, (1, "C"): {14: 1},
    **{(kin, row.name): {f"direction_{row.name.lower()}": 1}
       for kin in FLAGGED for row in type_data()[kin].axes
       if row.kind == "rotary" and (kin, row.name) != (82, "A")},
    (205, "C"): {13: -1, 16: 1},
    **{(213, f"G{n}"): {f"direction_g{n}": 1} for n in range(1, 6)},
}  # fmt: skip


@pytest.mark.parametrize(("kin", "name"), REVERSED)
def test_offset_inside_flag(kin: int, name: str) -> None:
    """A reversed axis with offset 30 stands at the model's zero at +30 (inside) or at -30 (outside)."""
    hd = {**REVERSED[kin, name], f"offset_{name.lower()}": 30.0}
    printed = -30.0 if kin in {205, 213} else 30.0
    for choice, value in (("as_printed", printed), ("inside", 30.0), ("outside", -30.0)):
        built = build(kin, hd, offset_inside_flag=choice)
        plain = build(kin, {16: 1} if kin == 205 else {})
        at_zero, expected = built.robot.fk(axes_with(kin, **{name: value})), plain.robot.fk(plain.zeros())
        assert distance(at_zero, expected) < 1e-14
        assert "offset_inside_flag" in built.asked()


def test_offset_inside_flag_is_asked_only_where_it_matters() -> None:
    assert "offset_inside_flag" not in build(58, {"offset_a": 30.0}).asked()
    assert "offset_inside_flag" not in build(58, {"direction_a": 1}).asked()


@pytest.mark.parametrize("kin", [23, 52])
def test_sign_coding(kin: int) -> None:
    for row in type_data()[kin].axes[3:]:
        frame, axes = ("tool" if row.carries == "tool" else "workpiece"), axes_with(kin, **{row.name: 10.0})
        for choice, value, sense in (
            ("plus_minus_one", -1, -1), ("plus_minus_one", 0, 1), ("plus_minus_one", 1, 1),
            ("zero_one", -1, -1), ("zero_one", 0, 1), ("zero_one", 1, -1),
        ):  # fmt: skip
            built = build(kin, {f"direction_{row.name.lower()}": value}, sign_coding=choice)
            assert built.base_rotation(frame, axes) == pytest.approx(TURN[row.name](sense * 10.0), abs=1e-14)


@pytest.mark.parametrize("kin", [57, 58, 64])
def test_slide_offset_sign(kin: int) -> None:
    for choice, sense in (("minus", -1.0), ("plus", 1.0)):
        built = build(kin, {1: 50.0, 2: 20.0, 3: 30.0}, slide_offset_sign=choice)
        assert built.base_mm("flange", built.zeros()) == pytest.approx((sense * 20, sense * 30, -50), abs=1e-12)


@pytest.mark.parametrize(("kin", "first"), [(61, 7), (63, 7), (80, 10), (81, 10), (82, 13)])
def test_machine_zero_sign(kin: int, first: int) -> None:
    """The tool's point at zero sees the outer table axis at the offset."""
    for choice, sense in (("plus", 1.0), ("minus", -1.0)):
        built = build(kin, {first: 10.0, first + 1: 20.0, first + 2: 30.0}, machine_zero_sign=choice)
        table = built.base_mm("workpiece", built.zeros()) - built.base_mm("flange", built.zeros())
        assert table == pytest.approx(sense * np.array([10.0, 20.0, 30.0]), abs=1e-12)


@pytest.mark.parametrize(("kin", "head"), [(61, "B"), (63, "A")])
def test_pivot_to_slide_effect(kin: int, head: str) -> None:
    for choice, acts in (("shifts_zero", 1.0), ("absorbed", 0.0)):
        built = build(kin, {4: 10.0, 5: 20.0, 6: 30.0}, pivot_to_slide_effect=choice)
        for angle in (0.0, 40.0):
            pivot = built.base_mm(head, axes_with(kin, **{head: angle}))
            assert pivot == pytest.approx(acts * np.array([-10.0, -20.0, -30.0]), abs=1e-12)


@pytest.mark.parametrize(("kin", "head", "table"), [(61, "B", "A"), (63, "A", "B")])
def test_the_axes_of_61_and_63_meet_at_the_ideal_zero(kin: int, head: str, table: str) -> None:
    built = build(kin, dict.fromkeys((1, 2, 3, 10, 11, 12, 17, 18, 19), 17.0))
    assert built.base_mm(head, built.zeros()) == pytest.approx(built.base_mm(table, built.zeros()), abs=1e-12)


@pytest.mark.parametrize("kin", [13, 14])
def test_face_y_offset(kin: int) -> None:
    """The tool stands beside the X axis; no X and C bring it nearer to the turning centre than HD4."""
    for choice, sense in (("plus", 1.0), ("minus", -1.0)):
        built = build(kin, {4: 12.0}, face_y_offset_sign=choice)
        assert built.mm([0, 0, 0])[1] == pytest.approx(sense * 12.0)
    nearest = min(np.hypot(*built.mm(axes)[:2]) for axes in axes_anywhere(built.robot, 200))
    assert nearest >= 12.0
    assert np.hypot(*built.mm([0.0, 77.0, 5.0])[:2]) == pytest.approx(12.0)


@pytest.mark.parametrize(("kin", "rotary"), [(23, "B"), (34, "C")])
def test_table_slide_order(kin: int, rotary: str) -> None:
    for choice, carried in (("slides_carry_rotary", False), ("rotary_carries_slides", True)):
        built = build(kin, table_slide_order=choice)
        before, after = (built.base_mm("workpiece", axes_with(kin, X=x, **{rotary: 90.0})) for x in (0.0, 10.0))
        along_x = abs((after - before)[0]) == pytest.approx(10.0)
        assert along_x is not carried
        assert np.linalg.norm(after - before) == pytest.approx(10.0)


def test_workpiece_slides_run_against_the_axis() -> None:
    for kin, name, n in (
        (1, "X", 0),
        (1, "Y", 1),
        (23, "X", 0),
        (34, "X", 0),
        (52, "Z", 2),
        (61, "Y", 1),
        (63, "X", 0),
    ):
        built = build(kin)
        moved = built.base_mm("workpiece", axes_with(kin, **{name: 100.0}))
        assert moved == pytest.approx(-100.0 * np.eye(3)[n])


def test_kin23_platform_sign() -> None:
    for choice, sense in (("plus", 1.0), ("minus", -1.0)):
        built = build(23, {2: 40.0}, kin23_platform_sign=choice)
        assert built.base_mm("workpiece", built.zeros()) == pytest.approx((0, 0, sense * 40.0))
        assert built.base_mm("workpiece", axes_with(23, B=90.0)) == pytest.approx((sense * 40.0, 0, 0), abs=1e-12)


def test_kin34_offset_sign() -> None:
    for choice, sense in (("plus", 1.0), ("minus", -1.0)):
        built = build(34, {2: 40.0, 3: 50.0}, kin34_offset_sign=choice)
        assert built.base_mm("C", built.zeros()) == pytest.approx((sense * 40.0, sense * 50.0, 0))


def test_kin52_conventions() -> None:
    for choice, turned in (("a_carries_b", True), ("b_carries_a", False)):
        built = build(52, kin52_table_order=choice)
        inner = built.base_rotation("B", axes_with(52, A=90.0))[:, 1]
        assert (inner == pytest.approx((0, 0, 1), abs=1e-12)) is turned
    for choice, sense in (("plus", 1.0), ("minus", -1.0)):
        tool = build(52, {2: 40.0}, kin52_tool_y_sign=choice)
        assert tool.base_mm("flange", tool.zeros()) == pytest.approx((0, sense * 40.0, 0))
        work = build(52, {3: 40.0}, kin52_wcs_offset_sign=choice)
        assert work.base_mm("workpiece", work.zeros()) == pytest.approx((0, sense * 40.0, 0))
        assert work.base_mm("workpiece", axes_with(52, A=90.0)) == pytest.approx((0, 0, sense * 40.0), abs=1e-12)


def test_kin52_keeps_the_workpiece_offset_inside_the_inner_axis() -> None:
    built = build(52, {3: 40.0}, kin52_table_order="b_carries_a")
    turned = built.base_mm("workpiece", axes_with(52, A=90.0, B=90.0))
    assert turned == pytest.approx((-40.0, 0, 0), abs=1e-12)


def test_type_1_turns_b_negatively_by_default() -> None:
    for flag, sense in ((0, -1.0), (1, 1.0)):
        built = build(1, {13: flag})
        assert built.base_rotation("tool", axes_with(1, B=10.0)) == pytest.approx(rot_y(sense * 10.0), abs=1e-14)


def test_the_rotary_axis_of_the_faces_turns_by_the_flag() -> None:
    for kin in (13, 14):
        for flag, sense in ((0, 1.0), (1, -1.0)):
            turned = build(kin, {5: flag}).base_rotation("workpiece", [0, 10.0, 0])
            assert turned == pytest.approx(rot_z(sense * 10.0), abs=1e-14)


def test_the_outer_axis_of_80_and_81_passes_through_the_slide_point_at_zero() -> None:
    for kin in (80, 81):
        built = build(kin, {1: 50.0, 2: 20.0, 3: 30.0})
        outer = built.robot.chain.joints[3].name
        assert built.base_mm(outer, built.zeros()) == pytest.approx((0, 0, 0), abs=1e-12)
        assert built.base_mm("flange", built.zeros()) == pytest.approx((20, 30, -50), abs=1e-12)


def test_the_head_of_82_holds_b_outside_a_and_the_table_turns_between_them_in_the_channel() -> None:
    built = build(82, {4: 10.0, 5: 20.0, 6: 30.0})
    assert [axis.name for axis in built.robot.axes] == ["X", "Y", "Z", "B", "C", "A"]
    turned = built.base_rotation("tool", axes_with(82, B=20.0, A=30.0))
    assert turned == pytest.approx(rot_y(20.0) @ rot_x(30.0), abs=1e-14)
    assert built.base_mm("A", built.zeros()) == pytest.approx((-10, -20, -30), abs=1e-12)


def test_kin202_right_frame() -> None:
    hd = {1: 100.0, 6: 5.0, 7: 6.0}
    plain, turned = (build(202, {**hd, 10: 1}, kin202_right_frame=c) for c in ("unshifted", "turned_180"))
    axes = [200.0, 20.0, 30.0, 40.0]
    assert turned.mm(axes) == pytest.approx(np.array([-1, -1, 1]) * plain.mm(axes), abs=1e-12)
    assert "kin202_right_frame" not in build(202, hd, kin202_right_frame="turned_180").asked()


def test_the_tip_of_202_lies_left_or_right_of_its_swivel_axis() -> None:
    for right, sense in ((0, -1.0), (1, 1.0)):
        built = build(202, {1: 100.0, 10: right}, 20.0)
        at_zero = built.base_mm("tool", built.zeros()) - built.base_mm("YQ", built.zeros())
        assert at_zero == pytest.approx((sense * 120.0, 0, 0), abs=1e-12)
        swivelled = built.base_mm("tool", [0, 90, 0, 0]) - built.base_mm("YQ", [0, 90, 0, 0])
        assert swivelled == pytest.approx((0, sense * 120.0, 0), abs=1e-12)
        assert built.base_rotation("tool", built.zeros())[:, 1] == pytest.approx((0, 1, 0), abs=1e-15)


def test_kin203_arm_zero() -> None:
    for choice, degrees in (("deg_0", 0), ("deg_90", 90), ("deg_180", 180), ("deg_270", 270)):
        built = build(203, {5: 15.0, 10: 80.0}, kin203_arm_zero=choice)
        axes = axes_with(203, YL=15.0)
        arm = built.base_mm("tool", axes) - built.base_mm("YL", axes)
        assert arm == pytest.approx(80.0 * rot_z(degrees)[:, 0], abs=1e-12)
        assert built.base_rotation("tool", axes) == pytest.approx(np.eye(3), abs=1e-14)


@pytest.mark.parametrize("kin", TYPES)
def test_every_convention_of_a_type_is_asked_somewhere(kin: int) -> None:
    """With every parameter set each convention that names the type shapes its chain, in one variant at least."""
    asked: set[str] = set()
    hd = generic_hd(type_data()[kin])
    flags = [row.n for row in type_data()[kin].hd if row.kind in {"flag", "sign"}]
    for value in ({}, dict.fromkeys(flags, 1.0), dict.fromkeys(flags, -1.0), dict.fromkeys(flags, 0.0)):
        changed = {**hd, **value}
        if kin == 205:
            changed.update({17: 1.0, 16: 0.0} if value and changed[17] else {17: 0.0, 16: 0.0})
        if kin in {13, 14, 1, 36, 202, 213}:
            changed = {n: abs(v) if n in flags else v for n, v in changed.items()}
        asked |= build(kin, changed, 80.0).asked()
    assert asked >= {convention.name for convention in applying_to([f"KIN {kin}"])}


@pytest.mark.parametrize("kin", TYPES)
def test_a_type_asks_only_conventions_that_name_it(kin: int) -> None:
    named = {convention.name for convention in applying_to([f"KIN {kin}"])}
    assert build(kin, generic_hd(type_data()[kin]), 80.0).asked() <= named


@pytest.mark.parametrize(
    ("kin", "names"), [(58, "A, C"), (64, "C1, A, C2"), (82, "C"), (11, "A"), (13, "C"), (202, "CS"), (9, ""), (45, "")]
)
def test_the_open_sense_of_a_table_is_told_once(kin: int, names: str) -> None:
    chain = machine(f"trafo[0].id {kin}").chain()
    told = [finding for finding in chain.findings if finding.code == "CB465"]
    if not names:
        assert told == []
        return
    (found,) = told
    assert (found.severity, found.text) == (
        "info", f"the sense of the rotary workpiece axes ({names}) is open: right_handed is assumed"
    )  # fmt: skip
    assert "counter-clockwise for right_handed" in (found.hint or "")
    assert conventions()["table_rotary_sense"].mark == "?"
    decided = machine(f"trafo[0].id {kin}").chain(conventions={"table_rotary_sense": "right_handed"})
    assert "CB465" not in codes(decided)
