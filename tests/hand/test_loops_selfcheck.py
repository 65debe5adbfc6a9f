"""The hand formulas of the closed loops against the manual's statements, independent poses and the struts."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from tests.kit.draws import seed_of
from tests.kit.paths import REFERENCE

from .loops_cases import (
    CHOICES,
    differ,
    is_steady,
    random_closing,
    random_far,
    random_hd,
    random_in_mode,
    read_hd,
)
from .loops_hand import LOOP_INVERSES, LOOPS, common_point, limits37
from .tables_algebra import Matrix, chain, rx, ry, rz, seen_from, shift

TIGHT = 1e-9
TRIPOD = {5: 500.0, 6: 100.0, 7: 500.0}  # level carriages stand 300 above the rods' common point
DELTA = {4: 50.0, 5: 200.0, 6: 500.0, 7: 250.0}  # level levers stand 300 above it
LAMBDA = {2: 500.0, 3: 500.0, 4: 200.0}  # slides 600 apart: D is 400 aside, 300 along


def pose(kin: int, hd: dict[int, float], axes: list[float], length: float = 0.0, **conv: str) -> Matrix:
    T = LOOPS[kin](hd, axes, length, conv)
    assert T is not None
    return T


def place(kin: int, hd: dict[int, float], axes: list[float], length: float = 0.0, **conv: str) -> Matrix:
    return pose(kin, hd, axes, length, **conv)[:3, 3]


def choices_of(kin: int) -> list[dict[str, str]]:
    return [{name: choice} for name, choices in CHOICES[kin].items() for choice in choices]


ALL = [(kin, conv) for kin in sorted(LOOPS) for conv in choices_of(kin)]


def test_common_point_below_and_above() -> None:
    rng = np.random.default_rng(1)
    for _ in range(200):
        centres = [np.array(row) for row in rng.uniform(-100.0, 100.0, (3, 3))]
        normal = np.cross(centres[1] - centres[0], centres[2] - centres[0])
        normal *= np.sign(normal[2])
        for lower, side in ((True, -1.0), (False, 1.0)):
            point = common_point(centres, 300.0, lower)
            if point is not None:
                assert np.allclose([np.linalg.norm(point - c) for c in centres], 300.0, atol=1e-7)
                assert np.sign(normal @ (point - centres[0])) == side
    flat = [np.array([x, 2.0 * x, 0.0]) for x in (0.0, 1.0, 2.0)]
    assert common_point(flat, 10.0, lower=True) is None
    upright = [np.array([0.0, y, z]) for y, z in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))]
    assert common_point(upright, 10.0, lower=True) is None


def test_12_level_carriages_and_offsets() -> None:
    assert np.allclose(place(12, TRIPOD, [0, 0, 0]), [0, 0, -300])
    assert np.allclose(place(12, TRIPOD, [70, 70, 70]), [0, 0, -230])
    offsets = {1: 10.0, 2: 2.0, 3: 3.0, 4: 40.0}
    hd = {**TRIPOD, **offsets}
    assert np.allclose(place(12, hd, [0, 0, 0], 500), [-3, -2, -300 - 10 - 40 - 500])
    assert np.allclose(place(12, hd, [0, 0, 0], kin12_hd4_sign="plus"), [-3, -2, -300 - 10 + 40])
    assert np.allclose(place(12, hd, [0, 0, 0], kin12_tool_xy="swapped"), [-2, -3, -350])
    assert np.allclose(place(12, hd, [0, 0, 0], kin12_tool_xy_sign="plus"), [3, 2, -350])
    assert np.allclose(place(12, TRIPOD, [70, 70, 70], kin12_z_positive="down"), [0, 0, -370])
    assert np.allclose(place(12, TRIPOD, [0, 0, 0], kin12_carriages="below"), [0, 0, 300])
    assert np.allclose(pose(12, hd, [10, -20, 30], 500)[:3, :3], np.eye(3))


@pytest.mark.parametrize("kin", [12, 209])
@pytest.mark.parametrize(
    ("azimuth", "degrees"), [("deg_0", 0.0), ("deg_90", 90.0), ("deg_180", 180.0), ("deg_minus_90", -90.0)]
)
def test_12_where_the_columns_stand(kin: int, azimuth: str, degrees: float) -> None:
    """Ends of the rods at the lengths of the rods from the place found, columns told apart by their heights."""
    rest = [0.0, 0.0] if kin == 209 else []
    for hd, first, second in ((TRIPOD, 120.0, 120.0), ({**TRIPOD, 8: 1.0, 9: 100.0, 10: 135.0}, 100.0, 135.0)):
        for numbering, sense in (("ccw", 1.0), ("cw", -1.0)):
            heights = [20.0, -50.0, 110.0]
            at = place(kin, hd, [*heights, *rest], kin12_azimuth=azimuth, kin12_numbering=numbering)
            for height, angle in zip(heights, (sense * first, -sense * second, 0.0), strict=True):
                phi = math.radians(degrees + angle)
                end = np.array([400.0 * math.cos(phi), 400.0 * math.sin(phi), height])
                assert np.linalg.norm(at - end) == pytest.approx(500.0, abs=TIGHT)
    ignored = {**TRIPOD, 9: 100.0, 10: 135.0}  # HD8 = 0
    assert np.allclose(pose(kin, ignored, [20, -50, 110, *rest]), pose(kin, TRIPOD, [20, -50, 110, *rest]))


def test_209_is_12_over_the_table() -> None:
    hd = {**TRIPOD, 1: 10.0, 2: 2.0, 3: 3.0, 4: 40.0, 32: 1.0, 33: 2.0, 34: 3.0, 35: 11.0, 36: 12.0, 37: 13.0}
    slides = [20.0, -50.0, 110.0]
    twelve = pose(12, hd, slides, 60)
    zero = place(209, hd, [*slides, 0, 0], 60)
    assert np.allclose(zero, twelve[:3, 3] - [12, 14, 16])
    table = chain(shift(11, 12, 13), rx(35), shift(1, 2, 3), rz(50))
    assert np.allclose(pose(209, hd, [*slides, 35, 50], 60), seen_from(table, twelve))
    table = chain(shift(11, 12, 13), ry(35), shift(1, 2, 3), rz(50))
    assert np.allclose(pose(209, {**hd, 31: 1.0}, [*slides, 35, 50], 60), seen_from(table, twelve))
    # the tool vector leans to +Y of the workpiece at A > 0, to -X at B > 0
    assert np.allclose(pose(209, hd, [*slides, 90, 0])[:3, 2], [0, 1, 0])
    assert np.allclose(pose(209, {**hd, 31: 1.0}, [*slides, 90, 0])[:3, 2], [-1, 0, 0])


def test_209_offsets_flags_and_their_readings() -> None:
    slides, offsets = [20.0, -50.0, 110.0], {38: 7.0, 39: 9.0}
    plain = pose(209, TRIPOD, [*slides, 30, 40])
    assert np.allclose(pose(209, {**TRIPOD, **offsets}, [*slides, 37, 49]), plain)
    reversed_ = {**TRIPOD, **offsets, 40: 1.0, 41: 1.0}
    assert np.allclose(pose(209, reversed_, [*slides, -23, -31]), plain)
    assert np.allclose(pose(209, reversed_, [*slides, -37, -49], offset_inside_flag="outside"), plain)
    assert np.allclose(pose(209, reversed_, [*slides, 37, 49], table_flag_coding="plus_minus_one"), plain)
    assert np.allclose(pose(209, TRIPOD, [*slides, -30, -40], table_rotary_sense="left_handed"), plain)
    one = {**TRIPOD, 40: 1.0}
    assert np.allclose(pose(209, one, [*slides, -30, 40]), plain)


def test_209_hd30_turns_the_columns_or_the_table() -> None:
    """Columns: the place turns, the tool does not. Table: all that is seen from it turns back; reversed: along."""
    slides, hd = [20.0, -50.0, 110.0], {**TRIPOD, 2: 2.0, 3: 3.0, 30: 25.0}
    zero = pose(12, hd, slides)
    stand = [*slides, 0.0, 0.0]
    columns = pose(209, hd, stand)
    assert np.allclose(columns[:3, :3], np.eye(3))
    tool = np.array([-3.0, -2.0, 0.0])
    assert np.allclose(columns[:3, 3], rz(25)[:3, :3] @ (zero[:3, 3] - tool) + tool)
    assert np.allclose(pose(209, hd, stand, kin209_column_angle="table"), rz(-25) @ zero)
    assert np.allclose(pose(209, hd, stand, kin209_column_angle="table_reversed"), rz(25) @ zero)
    bare = {**TRIPOD, 30: 25.0}  # the same place with another turn of the tool
    along = place(209, bare, stand, kin209_column_angle="table_reversed")
    assert np.allclose(place(209, bare, stand), along)


def test_37_independent_poses() -> None:
    truth = json.loads((REFERENCE / "kin37_0.json").read_text("utf-8"))
    hd = read_hd((REFERENCE / "kin37_0.lis").read_text("utf-8"))
    assert len(truth["rows"]) > 20
    for row in truth["rows"]:
        T = pose(37, hd, row["axes"], truth["tool_length"], kin37_azimuth="deg_minus_90", kin37_numbering="ccw")
        assert np.abs(T[:3, 3] - row["p"]).max() <= 1e-6
        assert np.array_equal(T[:3, :3], np.eye(3))
        # the same robot from another side, and with its arms counted the other way round
        for azimuth, degrees in (("deg_0", 90.0), ("deg_90", 180.0), ("deg_180", 270.0)):
            turned = place(37, hd, row["axes"], kin37_azimuth=azimuth)
            assert np.abs(turned - rz(degrees)[:3, :3] @ row["p"]).max() <= 1e-6
        first, second, third = row["axes"]
        assert np.abs(place(37, hd, [first, third, second], kin37_numbering="cw") - row["p"]).max() <= 1e-6


def test_37_level_levers_and_offsets() -> None:
    assert np.allclose(place(37, DELTA, [0, 0, 0]), [0, 0, -300])
    assert np.allclose(place(37, {**DELTA, 8: 90.0, 9: 90.0, 10: 90.0}, [90, 90, 90]), [0, 0, -300])
    assert place(37, DELTA, [10, 10, 10])[2] < -300  # positive turns lower the tip
    shifted = place(37, {**DELTA, 8: 5.0, 9: -7.0, 10: 11.0}, [15, 3, 41])
    assert np.allclose(shifted, place(37, DELTA, [10, 10, 30]))
    hd = {**DELTA, 1: 10.0, 13: 40.0}
    assert np.allclose(place(37, hd, [0, 0, 0], 500), [0, 0, -300 - 10 - 40 - 500])
    assert np.allclose(place(37, hd, [0, 0, 0], kin37_hd1_sign="plus"), [0, 0, -300 + 10 - 40])
    assert np.allclose(place(37, hd, [0, 0, 0], kin37_hd13_sign="plus"), [0, 0, -300 - 10 + 40])
    lowered = place(37, DELTA, [30, 0, 0])  # the arm at azimuth -90 pushes the platform away from itself
    assert lowered[0] == pytest.approx(0.0, abs=TIGHT) and lowered[1] > 0


def test_37_limits() -> None:
    assert limits37(DELTA, {}) is None
    hd = {**DELTA, 8: 5.0, 10: -7.0, 11: -30.0, 12: 80.0}
    assert limits37(hd, {}) == [(-30.0, 80.0)] * 3
    assert limits37(hd, {"kin37_limits_of": "lever"}) == [(-25.0, 85.0), (-30.0, 80.0), (-37.0, 73.0)]


def test_37_eight_branches_where_the_levers_reach() -> None:
    T = pose(37, DELTA, [20, 25, 30])
    found = LOOP_INVERSES[37](DELTA, T, 0.0, {})
    assert len(found) == 8
    assert differ(37, found[0], [20, 25, 30]) < 1e-6  # all levers outward come first
    assert all(math.cos(math.radians(one)) > 0 for one in found[0])
    assert all(math.cos(math.radians(one)) < 0 for one in found[-1])


def test_21_triangle_and_arm() -> None:
    """C at the origin, B at (600, 0), rods of 500: D at (300, 400); the arm lies along CD at HD6 = 0."""
    axes, lean = [0.0, 600.0, 0.0, 0.0], math.degrees(math.atan2(400.0, 300.0))
    assert np.allclose(place(21, LAMBDA, axes), [120, 160, 0])
    assert np.allclose(pose(21, LAMBDA, axes)[:3, :3], rz(lean)[:3, :3])
    assert np.allclose(pose(21, LAMBDA, [0, 600, 0, 15])[:3, :3], rz(lean + 15)[:3, :3])
    assert np.allclose(pose(21, LAMBDA, [0, 600, 0, 15], kin21_c_zero="along_x")[:3, :3], rz(15)[:3, :3])
    assert np.allclose(place(21, LAMBDA, axes, kin21_side="right"), [120, -160, 0])
    assert np.allclose(place(21, {**LAMBDA, 6: 90.0}, axes), [-160, 120, 0])
    assert np.allclose(place(21, {**LAMBDA, 6: 90.0}, axes, kin21_beta_sign="minus"), [160, -120, 0])
    assert np.allclose(place(21, {**LAMBDA, 11: 50.0}, axes), [150, 200, 0])
    assert np.allclose(place(21, {**LAMBDA, 11: 50.0}, axes, kin21_c_zero="along_x"), [170, 160, 0])
    assert np.allclose(place(21, {**LAMBDA, 7: 30.0}, axes), [120, 190, 0])
    assert np.allclose(place(21, {**LAMBDA, 10: 30.0}, axes), [150, 160, 0])
    assert np.allclose(place(21, {**LAMBDA, 10: 30.0}, axes, kin21_hd10_sign="minus"), [90, 160, 0])
    assert np.allclose(place(21, {**LAMBDA, 1: 7.0}, [0, 600, 300, 0], 40), [120, 160, 300 - 7 - 40])
    assert np.allclose(place(21, LAMBDA, [10, 610, 0, 0]), [130, 160, 0])


def test_21_rods_slides_and_the_offset_of_their_joints() -> None:
    # rods 400 at B and 300 at C, joints 500 apart: a right angle at D
    hd = {2: 400.0, 3: 300.0, 4: 100.0}
    assert np.allclose(place(21, hd, [0, 500, 0, 0]), [60, 80, 0])
    assert np.allclose(place(21, {**hd, 5: 300.0}, [0, 400, 0, 0]), [60 * 0.8 - 80 * 0.6, 60 * 0.6 + 80 * 0.8, 0])
    assert np.allclose(place(21, {**hd, 5: 100.0}, [0, 400, 0, 0], kin21_hd5_along="x"), [60, 80, 0])
    assert np.allclose(place(21, hd, [500, 0, 0, 0], kin21_slides="x2_carries_c"), [60, 80, 0])
    assert np.allclose(place(21, {**hd, 5: 100.0}, [0, -600, 0, 0], kin21_hd5_along="x"), [-60, -80, 0])
    conv = {"kin21_slides": "x2_carries_c", "kin21_hd5_along": "x"}
    assert np.allclose(place(21, {**hd, 5: 100.0}, [400, 0, 0, 0], **conv), [60, 80, 0])  # B stays 100 from its slide


def test_21_two_or_four_branches() -> None:
    """A = 200 at 100 or 80 degrees: rod CD at 40 or 20 with HD6 = 60, and B to the right of C on either side of D."""
    hd, reach = {2: 350.0, 3: 500.0, 4: 200.0, 6: 60.0}, 500.0 * math.sin(math.radians(40.0))
    joint_b = 500.0 * math.cos(math.radians(40.0)) + math.sqrt(350.0**2 - reach**2)
    T = pose(21, hd, [0, joint_b, 0, 0])
    assert np.allclose(T[:3, 3], rz(100)[:3, 0] * 200)
    found = LOOP_INVERSES[21](hd, T, 0.0, {})
    assert len(found) == 4 and len({round(one[3]) for one in found}) == 2
    assert [round(one[3]) for one in found if abs(one[0]) > 1.0] == [20, 20]  # C makes up for the other arm
    lambda_ = {**LAMBDA, 2: 450.0}
    for axes in ([0.0, 600.0, 0.0, 0.0], [0.0, 600.0, 0.0, 77.0]):
        assert len(LOOP_INVERSES[21](lambda_, pose(21, lambda_, axes), 0.0, {})) == 2


def test_209_table_tilted_to_either_side() -> None:
    for b in (0.0, 1.0):
        hd = {**TRIPOD, 31: b, 38: 5.0, 39: 7.0}
        found = LOOP_INVERSES[209](hd, pose(209, hd, [20, -50, 110, 35, 57]), 0.0, {})
        turns = sorted((round(one[3], 6), round(one[4] % 360.0, 6)) for one in found)
        assert turns == [(-25.0, 237.0), (35.0, 57.0)]


@pytest.mark.parametrize(
    ("axes", "closes"),
    [([0, 699.9], True), ([0, 700.1], False), ([0, -100.1], True), ([0, 99.9], False), ([0, 0], False)],
)
def test_21_closes_between_stretched_and_folded(axes: list[float], closes: bool) -> None:
    T = LOOPS[21]({2: 400.0, 3: 300.0, 4: 100.0}, [*axes, 0.0, 0.0], 0.0, {})
    assert (T is not None) == closes


@pytest.mark.parametrize(("kin", "conv"), ALL)
def test_every_choice_gives_another_pose(kin: int, conv: dict[str, str]) -> None:
    ((name, choice),) = conv.items()
    if name == "kin37_limits_of":
        return  # moves limits: above
    rng = np.random.default_rng(seed_of("another pose", kin))
    hd = {n: value or 30.0 + n for n, value in random_hd(kin, rng, conv).items()}
    hd |= {40: -1.0, 41: -1.0} if choice in CHOICES[209]["table_flag_coding"] else {40: 1.0, 41: 1.0}
    axes = random_closing(kin, hd, {}, rng)
    poses = [LOOPS[kin](hd, axes, 60.0, {name: other}) for other in CHOICES[kin][name]]
    default = LOOPS[kin](hd, axes, 60.0, {})
    assert np.array_equal(poses[0], default)  # type: ignore[arg-type]
    if name == "table_flag_coding":
        hd |= {40: 1.0}  # 1 reverses in one coding alone
        poses = [LOOPS[kin](hd, axes, 60.0, {name: other}) for other in CHOICES[kin][name]]
    mine = poses[CHOICES[kin][name].index(choice)]
    for other in (one for one in poses if one is not mine):
        assert mine is None or other is None or not np.allclose(mine, other, atol=TIGHT, rtol=0)


@pytest.mark.parametrize(("kin", "conv"), ALL)
def test_inverse_finds_the_axes_again(kin: int, conv: dict[str, str]) -> None:
    rng = np.random.default_rng(seed_of("inverse", kin, conv))
    counts = set()
    for _ in range(5):
        hd, length = random_hd(kin, rng, conv), float(rng.uniform(0.0, 200.0))
        for _ in range(4):
            axes = random_in_mode(kin, hd, conv, rng, length)
            T = pose(kin, hd, axes, length, **conv)
            found = LOOP_INVERSES[kin](hd, T, length, conv)
            assert min(differ(kin, one, axes) for one in found) < 1e-6
            for one in found:
                other = pose(kin, hd, one, length, **conv)
                assert np.allclose(other[:3, 3], T[:3, 3], atol=1e-6, rtol=0)
                assert np.allclose(other[:3, 2], T[:3, 2], atol=TIGHT, rtol=0)
            counts.add(len(found))
    assert counts <= {12: {1}, 21: {1, 2, 3, 4}, 37: set(range(1, 9)), 209: {1, 2}}[kin]


@pytest.mark.parametrize("kin", sorted(LOOPS))
def test_states_that_do_not_close_give_none(kin: int) -> None:
    rng = np.random.default_rng(seed_of("none", kin))
    for _ in range(20):
        hd = random_hd(kin, rng, {})
        short, apart = random_far(kin, hd, rng)
        assert LOOPS[kin](short, apart, 0.0, {}) is None
        assert is_steady(kin, hd, random_closing(kin, hd, {}, rng), {})
        far = shift(1e5, 0.0, 0.0)
        assert LOOP_INVERSES[kin](hd, far, 0.0, {}) == [] or kin == 21  # 21 moves along X as far as one likes
