"""The hand formulas of tables, face types and arms against the manual's own statements and independent poses."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from tests.kit.paths import REFERENCE

from .kin_faces import TiltError, effective_tool_length_mm
from .tables_algebra import Matrix, chain, rx, ry, rz
from .tables_cases import CASES, FORMULAS, TIGHT, pose, same, span


def generic(kin: int, seed: int = 1, length: float = 0.0, **conv: str) -> Matrix:
    """Return a pose of the type with every HD set."""
    return FORMULAS[kin](CASES[kin].param(seed), CASES[kin].position(seed), length, conv)


@pytest.mark.parametrize("name", ["kin36_1", "kin58_trt_2", "kin58_trt_3"])
def test_independent_poses(name: str) -> None:
    truth = json.loads((REFERENCE / f"{name}.json").read_text())
    param = {}
    for line in (REFERENCE / f"{name}.lis").read_text().splitlines():
        if "param[" in line:
            key, value = line.split()
            param[int(key.split("param[")[1].rstrip("]"))] = float(value)
    assert len(truth["rows"]) > 10
    for row in truth["rows"]:
        result = FORMULAS[truth["kin"]](param, row["axes"], truth["tool_length"], {})
        assert np.allclose(result[:3, 3], row["p"], rtol=0, atol=2e-9)
        if "R" in row:
            assert np.allclose(result[:3, :3], row["R"], rtol=0, atol=TIGHT)
        else:
            assert np.allclose(result[:3, 2], row["z"], rtol=0, atol=TIGHT)


@pytest.mark.parametrize("kin", sorted(CASES))
def test_every_listed_hd_acts_and_no_other(kin: int) -> None:
    case, param, axes = CASES[kin], CASES[kin].param(), CASES[kin].position()
    before = FORMULAS[kin](param, axes, 0.0, {})
    assert np.allclose(before[:3, :3] @ before[:3, :3].T, np.eye(3)) and np.linalg.det(before[:3, :3]) > 0
    listed = {*span(case.lengths), *span(case.angles)}
    for number in listed:
        changed = {**param, number - 1: param[number - 1] + 10_000.0}
        assert not np.allclose(before, FORMULAS[kin](changed, axes, 0.0, {}), atol=1e-4), number
    for number, value in case.reversing:
        assert not np.allclose(before, FORMULAS[kin]({**param, number - 1: value}, axes, 0.0, {}), atol=1e-4), number
    unlisted = set(range(1, 60)) - listed - {*case.flags, *(number for number, _ in case.fixed)}
    assert same(before, FORMULAS[kin]({**param, **{number - 1: 7e5 for number in unlisted}}, axes, 0.0, {}))


@pytest.mark.parametrize("kin", sorted(CASES))
def test_rank_of_position_and_tool_vector(kin: int) -> None:
    case, axes, step = CASES[kin], CASES[kin].position(), 1e-4
    columns = []
    for i in range(len(axes)):
        ends = [FORMULAS[kin](case.param(), [*axes[:i], axes[i] + d, *axes[i + 1 :]], 0.0, {}) for d in (step, -step)]
        delta = (ends[0] - ends[1]) / (2 * step)
        columns.append([*delta[:3, 3], *(100 * delta[:3, 2])])
    assert np.linalg.matrix_rank(np.array(columns).T, tol=1e-4) == case.rank


@pytest.mark.parametrize("kin", sorted(set(CASES) - {85, 206, 208}))
def test_length_extends_along_minus_the_tool_vector(kin: int) -> None:
    short, long = generic(kin), generic(kin, length=123.0)
    assert np.allclose(long[:3, 3] - short[:3, 3], -123.0 * short[:3, 2], atol=TIGHT)


@pytest.mark.parametrize("kin", [1, 23, 52, 57, 58, 61, 63, 64, 80, 81, 82, 34])
def test_linear_axes_act_as_in_two_and_a_half_d(kin: int) -> None:
    # 1.3: at rotary zero the tool moves along +X, +Y, +Z of the workpiece, whoever carries the axis
    rotary = [0.0] * (len(CASES[kin].axes) - 3)
    for i in range(3):
        ends = [pose(kin, {}, [*(np.eye(3)[i] * value), *rotary])[:3, 3] for value in (0.0, 100.0)]
        assert np.allclose(ends[1] - ends[0], 100 * np.eye(3)[i], atol=TIGHT)


def test_type_1_b_is_negative_at_flag_0() -> None:
    for flag, sign in ((0, -1), (1, 1)):
        assert same(pose(1, {13: flag}, [0, 0, 0, 30, 0]), ry(sign * 30))
    # 2.1: slide -> B -> clamp, each end named; C at HD7..9 from machine zero
    hd = {1: 10.0, 2: 20.0, 3: 3.0, 4: 4.0, 5: 5.0, 6: 6.0, 7: 70.0, 8: 80.0, 9: 90.0}
    assert np.allclose(pose(1, hd, [0] * 5)[:3, 3], [3 + 5 - 70, 4 + 6 - 80, -20 - 10 - 90])


@pytest.mark.parametrize("kin", [61, 63])
def test_rotary_axes_meet_at_slide_zero(kin: int) -> None:
    for a, b in ((0, 0), (30, 0), (0, -50), (70, 20)):
        assert np.allclose(pose(kin, {}, [0, 0, 0, a, b])[:3, 3], 0, atol=TIGHT)
    # HD7..9 undo the slide offset: with HD7..9 = HD4..6 the axes meet again at 0
    hd = {4: 11.0, 5: -7.0, 6: 5.0, 7: 11.0, 8: -7.0, 9: 5.0}
    assert np.allclose(pose(kin, hd, [0, 0, 0, 33, 44])[:3, 3], 0, atol=TIGHT)
    hd = {4: 11.0, 5: -7.0, 6: 5.0}
    free = pose(kin, hd, [0, 0, 0, 33, 44], pivot_to_slide_effect="absorbed")
    assert np.allclose(free[:3, 3], 0, atol=TIGHT)


@pytest.mark.parametrize("kin", [80, 81])
def test_outer_table_axis_passes_through_the_slide_point(kin: int) -> None:
    inner = {4: 40.0, 5: -50.0, 6: 60.0, 7: 7.0, 8: 8.0, 9: 9.0}
    points = [pose(kin, inner, [0, 0, 0, outer, 25])[:3, 3] for outer in (0, 40, 90)]
    assert np.allclose(points, points[0], atol=TIGHT)
    moved = [pose(kin, {**inner, 10: 30.0, 11: 20.0, 12: 10.0}, [-30, -20, -10, outer, 25])[:3, 3] for outer in (0, 40)]
    assert np.allclose(moved, points[0], atol=TIGHT)
    clamp = [pose(kin, {1: 100.0, 2: 5.0, 3: 6.0}, [0, 0, 0, outer, 0])[:3, 3] for outer in (0, 40)]
    assert np.allclose(clamp[0], [5, 6, -100]) and not np.allclose(clamp[0], clamp[1])


def test_63_replaces_23_and_64_contains_58() -> None:
    axes = [10.0, 20.0, 30.0, 40.0, 50.0]
    assert same(pose(23, {1: 100.0, 2: 60.0}, axes, 12), pose(63, {1: 100.0, 12: 60.0}, axes, 12))
    to_64 = {1: 1, 2: 2, 3: 3, 4: 7, 5: 8, 6: 9, 7: 10, 8: 11, 9: 12, 10: 17, 11: 18, 14: 13, 15: 14, 16: 15}
    hd58 = {number: float(number) for number in to_64}
    hd64 = {to_64[number]: value for number, value in hd58.items()}
    assert same(pose(58, hd58, axes, 12), pose(64, hd64, [10, 20, 30, 0, 40, 50], 12))


def _quarter_turn(hd: dict[int, float], *vectors: int) -> dict[int, float]:
    """Return HD values whose vectors (x, y, z from the given numbers) are turned by Rz(90)."""
    turned = dict(hd)
    for first in vectors:
        turned[first], turned[first + 1] = -hd[first + 1], hd[first]
    return turned


def test_sister_types_differ_by_a_quarter_turn_only() -> None:
    # Rz(90) takes the A axis to B and the B axis to -A; X, Y travel turns along
    hd = {number: float(3 * number + 1) for number in range(1, 10)} | {14: 14.0, 15: 15.0, 16: 16.0, 10: 0.0, 11: 0.0}
    turned = _quarter_turn(hd, 4, 7, 14) | {2: -hd[3], 3: hd[2]}
    there = pose(58, hd, [10, 20, 30, 40, 50], 5)
    assert same(chain(rz(90), there, rz(-90)), pose(57, turned, [-20, 10, 30, 40, 50], 5))
    hd = {number: float(3 * number + 1) for number in range(1, 13)}
    turned = _quarter_turn(hd, 4, 7, 10) | {2: -hd[3], 3: hd[2]}
    there = pose(80, hd, [10, 20, 30, 40, 50], 5)
    assert same(chain(rz(90), there, rz(-90)), pose(81, turned, [-20, 10, 30, 40, -50], 5))
    hd |= {17: 17.0, 18: 18.0, 19: 19.0}
    turned = _quarter_turn(hd, 4, 7, 10, 17) | {2: -hd[3], 3: hd[2]}
    there = pose(61, hd, [10, 20, 30, 40, 50], 5)
    assert same(chain(rz(90), there, rz(-90)), pose(63, turned, [-20, 10, 30, -50, 40], 5))


def test_82_named_ends_and_free_a() -> None:
    hd = {number: float(number) for number in range(1, 16)}
    expected = -np.array([2 + 4 + 7, 3 + 5 + 8, 1 + 6 + 9]) + np.array([13 - 10, 14 - 11, 15 - 12])
    assert np.allclose(pose(82, hd, [0] * 6)[:3, 3], expected)
    assert same(pose(82, {}, [0, 0, 0, 20, 0, 30]), chain(ry(20), rx(30)))
    assert same(pose(82, {}, [0, 0, 0, 0, 30, 0]), rz(-30))


@pytest.mark.parametrize("kin", [13, 14])
def test_face_hole_of_radius_hd4(kin: int) -> None:
    radii = [
        math.hypot(*pose(kin, {4: -12.5, 1: 80}, [x, c, 5])[:2, 3])
        for x in np.linspace(-50, 50, 101)
        for c in (-170, 0, 33, 90)
    ]
    assert min(radii) == pytest.approx(12.5, abs=TIGHT)
    # N500: HD5 = 1 switches the sense of rotation
    assert same(pose(kin, {5: 1, 4: 3}, [10, 30, 5]), pose(kin, {5: 0, 4: 3}, [10, -30, 5]))
    assert np.allclose(pose(kin, {1: 100}, [10, 0, 100])[:3, 3], [10, 0, 0])


def test_202_points_left_or_right_and_lies_along_x_at_zero() -> None:
    for variant, tip_side in ((0, -1), (1, 1)):
        result = pose(202, {1: 40, 10: variant}, [500, 0, 0, 0], 60)
        assert np.allclose(result[:3, 3], [500 + tip_side * 100, 0, 0], atol=TIGHT)
        assert np.allclose(result[:3, 2], [-tip_side, 0, 0], atol=TIGHT)
        assert np.allclose(result[:3, 1], [0, 1, 0], atol=TIGHT)
    turned = pose(202, {5: 10, 9: 20}, [0, 10 + 35, 0, 20 + 35])
    assert np.allclose(turned[:3, 2], [1, 0, 0], atol=TIGHT)  # tool angle in the X-Y plane is y - c


def test_203_reaches_the_ring_between_both_arms() -> None:
    hd = {2: 300.0, 10: 200.0}
    radii = [math.hypot(*pose(203, hd, [c, y, 0])[:2, 3]) for y in range(0, 360, 5) for c in (0, 77)]
    assert min(radii) == pytest.approx(100) and max(radii) == pytest.approx(500)
    one, other = pose(203, hd, [0, 60, 0])[:2, 3], pose(203, hd, [0, -60, 0])[:2, 3]
    assert np.hypot(*one) == pytest.approx(np.hypot(*other))  # two branches for one radius


def test_205_variants() -> None:
    axes, z_variant, x_variant = [10.0, 25.0, 30.0], {16: 1, 17: 0}, {16: 0, 17: 1}
    polar, cartesian = {2: 50.0, 3: 30.0}, {4: 50 * math.cos(math.pi / 6), 5: 25.0}
    both = {**polar, 4: 2 * cartesian[4], 5: 2 * cartesian[5]}
    for variant in (z_variant, x_variant):
        assert same(pose(205, {**polar, **variant}, axes), pose(205, {**cartesian, **variant}, axes))
        tripled = {4: 3 * cartesian[4], 5: 3 * cartesian[5], **variant}
        assert same(pose(205, {**both, **variant}, axes), pose(205, tripled, axes))
    assert same(pose(205, polar, axes), pose(205, {**polar, **z_variant}, axes))
    on_z = pose(205, {1: 10, **z_variant}, [0, 90, 0], 5)
    assert np.allclose(on_z[:3, 3], [0, 0, -15]) and np.allclose(on_z[:3, 2], [0, 0, 1])
    on_x = pose(205, {1: 10, **x_variant}, [0, 90, 0], 5)
    assert np.allclose(on_x[:3, 3], [-15, 0, 0]) and np.allclose(on_x[:3, 2], [1, 0, 0])
    disc = pose(205, {4: 20, 5: 0, **x_variant}, [0, 90, 0])[:3, 3]
    assert np.allclose(disc, [0, 0, 20], atol=TIGHT)
    with pytest.raises(ValueError, match="not permitted"):
        pose(205, {16: 1, 17: 1}, axes)


def test_98_length_law() -> None:
    param = {0: 50e4, 1: 45e4, 2: 60e4, 3: 70e4}
    assert effective_tool_length_mm(param, 100, 45) == pytest.approx(100)
    assert effective_tool_length_mm(param, 100, 45 + 1e-9) == pytest.approx(100)
    for tilt in (46, 50, -60):
        height = effective_tool_length_mm(param, 100, tilt) * math.cos(math.radians(tilt))
        assert height == pytest.approx(100 * math.cos(math.pi / 4))
    assert effective_tool_length_mm(param, 100, 70) == effective_tool_length_mm(param, 100, 60)
    assert effective_tool_length_mm(param, 100, 0, {"kin98_hd1": "added"}) == pytest.approx(150)
    with pytest.raises(TiltError):
        effective_tool_length_mm(param, 100, 70.001)
