"""Checks the hand formulas of the heads and of arm 45 against statements and numbers of the KIN_TYP manual."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from .heads_cases import AXIS_COUNT, pose, sample
from .kin_arm45 import arm
from .kin_cardan import kin59, machine_to_spatial, spatial_to_machine
from .kin_drill_heads import kin28_drives
from .kin_heads import FORMULAS
from .kin_heads_base import Head
from .kin_tilt_heads import kin70_machine_angles


@pytest.mark.parametrize("kin", [9, 25, 28, 76])
def test_two_solutions_of_a_ca_head(kin: int) -> None:
    """1.4: ori = (0, -0.7071, 0.7071) at C 0, A 45 and at C 180, A -45; A = 0 leaves C free."""
    ori = (0.0, -math.sqrt(0.5), math.sqrt(0.5))
    for c, a in ((0.0, 45.0), (180.0, -45.0)):
        assert np.allclose(pose(kin, [0, 0, 0, c, a])[:3, 2], ori, atol=1e-12)
    assert np.allclose(pose(kin, [0, 0, 0, 123.0, 0.0])[:3, 2], (0, 0, 1), atol=1e-12)


def test_ab_head_remark_points_both_ways() -> None:
    """1.4: A/B heads singular along Y (true with B outside), avoided by limiting B (true with A outside)."""
    for outside, a, b, singular in (("a_outside", 30.0, 90.0, (1, 0, 0)), ("b_outside", 90.0, 30.0, (0, -1, 0))):
        conv = {"kin22_axis_order": outside}
        still = [0.0, 0.0, 0.0, 0.0, b] if outside == "a_outside" else [0.0, 0.0, 0.0, a, 0.0]
        for values in (still, [0.0, 0.0, 0.0, a, b]):
            assert np.allclose(pose(22, values, 0.0, conv)[:3, 2], singular, atol=1e-12)


def test_double_spindle_change_is_half_a_turn() -> None:
    upper, lower = pose(3, [1, 2, 3, 180 + 25], 40, HD1=100, HD3=7), pose(4, [1, 2, 3, 25], 40, HD1=100, HD3=7)
    assert np.allclose(upper, lower, atol=1e-12)
    assert np.allclose(pose(3, [0, 0, 0, 0], 40, HD1=100)[:3, 3], (0, 0, 140), atol=1e-12)


@pytest.mark.parametrize(("hd5", "tip"), [(0, (0, 1)), (90, (-1, 0)), (180, (0, -1)), (-90, (1, 0))])
def test_cross_head_offset_counts_from_plus_y_to_the_tool(hd5: float, tip: tuple[int, int]) -> None:
    """2.5: HD5 is counted positive from the zero of C (+Y) to the tool."""
    assert np.allclose(pose(5, [0, 0, 0, 0], 60, HD1=40, HD5=hd5)[:2, 3], 100 * np.array(tip), atol=1e-12)


def test_underfloor_cutter_points_up() -> None:
    assert np.allclose(pose(6, [0, 0, 0, 0], 60, HD2=100, HD3=30)[:3, 3], (0, 30, -40), atol=1e-12)


@pytest.mark.parametrize("kin", [8, 10, 18, 207])
def test_saw_rest_position_has_spindle_along_y(kin: int) -> None:
    """2.8, 2.10, 2.16, 2.40: rest at +90; HD2 is the Y distance of clamping point and A axis."""
    axes = [0.0] * AXIS_COUNT[kin]
    extra = {"HD4": 90.0} if kin != 10 else {}
    if kin == 10:
        axes[4] = 90.0
    T = pose(kin, axes, 20, {"kin207_programmed_point": "tip"}, HD2=150, HD3=80, **extra)
    assert np.allclose(T[:3, 3], (0, 170, -80), atol=1e-12)
    assert np.allclose(T[:3, 2], (0, -1, 0), atol=1e-12)


@pytest.mark.parametrize("kin", [9, 25, 28])
def test_static_offset_does_not_turn_with_c(kin: int) -> None:
    """2.9: the offset between M and K does not depend on C and A."""
    a = pose(kin, [0, 0, 0, 70, 30], HD1=100, HD6=20, HD7=11, HD8=13)
    b = pose(kin, [0, 0, 0, 70, 30], HD1=100, HD6=20)
    assert np.allclose((a - b)[:3, 3], (11, 13, 0), atol=1e-12)


def test_kin11_ideal_length_needs_no_linear_motion() -> None:
    """2.11: with the ideal length a turn of B leaves the tip in place, else it moves; A always moves it."""
    for b in (-50.0, 20.0, 90.0):
        assert np.allclose(pose(11, [5, 6, 7, 0, b], 80, HD1=120, HD2=200, HD3=45)[:3, 3], (5, 6, 7), atol=1e-12)
    tip = [pose(11, [5, 6, 7, 0, b], 90, HD1=120, HD2=200, HD3=45)[:3, 3] for b in (0.0, 40.0)]
    assert np.linalg.norm(tip[1] - tip[0]) > 1.0
    assert not np.allclose(pose(11, [5, 6, 7, 10, 0], 80, HD1=120, HD2=200, HD3=45)[:3, 3], (5, 6, 7), atol=1e-3)


def test_kin11_axes_meet_at_zero_and_tilt_is_limited() -> None:
    """2.11: at zero the A and B axes meet; not every orientation can be reached (tilt at most 2*HD3)."""
    assert np.allclose(pose(11, [0, 0, 0, 35, 60], 80, HD1=120, HD2=200, HD3=45)[:3, 3], 0, atol=1e-12)
    assert math.isclose(pose(11, [0, 0, 0, 0, 180], HD3=30)[2, 2], math.cos(math.radians(60)), abs_tol=1e-12)


@pytest.mark.parametrize("a", [0.0, 20.0, -45.0])
def test_kin25_nozzle_height_is_constant(a: float) -> None:
    """2.21: the nozzle tip stays at the same height above the sheet and the gap along the beam grows."""
    on_sheet = pose(25, [0, 0, 0, 30, a], 5, HD1=100)[:3, 3]
    nozzle = pose(25, [0, 0, 0, 30, a], 0, HD1=100)[:3, 3]
    assert math.isclose(nozzle[2] - on_sheet[2], 5.0, abs_tol=1e-12)
    assert math.isclose(float(np.linalg.norm(nozzle - on_sheet)), 5.0 / math.cos(math.radians(a)), abs_tol=1e-12)


@pytest.mark.parametrize("place", ["after_gear", "before_gear"])
def test_kin28_gear(place: str) -> None:
    """2.22: CM = CW, AM = AW*k_a + NP0 + k_ca*CW, and back from the drives to the same pose."""
    param, axes = sample(28)
    if place == "before_gear":
        param |= {13: 1.0, 14: 1.0}
    cm, am = kin28_drives({10: 5e4, 11: 1.0, 12: 2.0, 15: 3.0, 16: 1.0}, 40.0, 10.0)
    assert (cm, am) == pytest.approx((40.0, 10.0 * 3 + 5 + 20))
    drives = [*axes[:3], *kin28_drives(param, axes[3], axes[4])]
    conv = {"kin28_axis_values": "drives", "gear_flag_place": place}
    expected = FORMULAS[28](param, axes, 30.0, {"gear_flag_place": place})
    assert np.allclose(FORMULAS[28](param, drives, 30.0, conv), expected, atol=1e-9)


def test_kin28_zero_divisors() -> None:
    """Unset factors (0/0) mean no coupling and ratio one; any other zero divisor is refused."""
    assert kin28_drives({}, 30.0, 12.0) == (30.0, 12.0)
    with pytest.raises(ValueError, match="denominator"):
        pose(28, [0.0] * 5, raw12=1)


@pytest.mark.parametrize("kin", [33, 76])
def test_compensated_heads_keep_the_point(kin: int) -> None:
    """2.24, 2.34: no linear motion is needed when the rotary axes turn (76 without a length)."""
    for c, a in ((0.0, 0.0), (50.0, 20.0), (-130.0, -35.0)):
        assert np.allclose(pose(kin, [1, 2, 3, c, a], HD3=45)[:3, 3], (1, 2, 3), atol=1e-12)


def test_kin70_is_kin16_and_cv_turns_the_tool_vector() -> None:
    """2.33: without HD14 and CV the table is that of 16; CV turns the tool vector about Z, angles within +-90."""
    param, axes = sample(16)
    assert np.allclose(FORMULAS[70](param, [*axes, 0.0], 50, {}), FORMULAS[16](param, axes, 50, {}), atol=1e-9)
    v = pose(70, [0, 0, 0, 20, 30, 0])[:3, 2]
    w = pose(70, [0, 0, 0, 20, 30, 75], HD14=40)[:3, 2]
    turn = math.radians(75 + 40)
    expected = (v[0] * math.cos(turn) - v[1] * math.sin(turn), v[0] * math.sin(turn) + v[1] * math.cos(turn), v[2])
    assert np.allclose(w, expected, atol=1e-12)
    assert all(abs(angle) <= 90 for angle in kin70_machine_angles(20, 30, 75))
    assert kin70_machine_angles(20, 150, 0) == pytest.approx((20, 150))


def test_kin207_plunges_along_the_blade() -> None:
    """2.40: moving only the programmed Z moves the machine's tip along the blade; at Z0 tip and program agree."""
    hd = {"HD2": 60.0, "HD4": 60.0, "HD5": 5.0, "HD11": -20.0}
    axes = [10.0, 20.0, 0.0, 33.0]
    tip = pose(207, axes, 25, {"kin207_programmed_point": "tip"}, **hd)
    axes[2] = -20.0 - tip[2, 3]
    at_plane = pose(207, axes, 25, **hd)
    assert np.allclose(at_plane, pose(207, axes, 25, {"kin207_programmed_point": "tip"}, **hd), atol=1e-12)
    raised = [a + 12.0 * e for a, e in zip(axes, [*at_plane[:3, 1], 0.0], strict=True)]
    assert np.allclose(pose(207, raised, 25, **hd)[:2, 3], at_plane[:2, 3], atol=1e-12)


# ------------------------------------------------------------------ cardanic heads


@pytest.mark.parametrize("kin", [59, 60])
@pytest.mark.parametrize("hd7", [30.0, 45.0, 60.0])
def test_cardan_maximum_is_twice_hd7(kin: int, hd7: float) -> None:
    """2.29: the head reaches a spatial angle of at most 2*HD7, at a machine angle of 180."""
    tilts = [math.degrees(math.acos(pose(kin, [0, 0, 0, 0, a], HD7=hd7, raw21=1)[2, 2])) for a in range(-180, 181, 5)]
    assert math.isclose(max(tilts), min(2 * hd7, 180), abs_tol=1e-6)
    assert tilts.index(max(tilts)) in (0, len(tilts) - 1)
    with pytest.raises(ValueError, match="2\\*HD7"):
        pose(kin, [0, 0, 0, 0, 2 * hd7 + 1], HD7=hd7)


@pytest.mark.parametrize("kin", [59, 60])
def test_cardan_spatial_angles(kin: int) -> None:
    """Programmed spatial angles give the tool vector of an ordinary C/A or C/B head, with either tilt sign of 60."""
    for tilt_sign in ("plus", "minus"):
        for c, a in ((0.0, 30.0), (77.0, -50.0), (-160.0, 79.0), (12.0, 0.0)):
            z = pose(kin, [0, 0, 0, c, a], 0.0, {"kin60_tilt_sign": tilt_sign}, HD7=40)[:3, 2]
            cr, ar = math.radians(c), math.radians(a)
            side = (math.sin(cr), -math.cos(cr)) if kin == 59 else (math.cos(cr), math.sin(cr))
            assert np.allclose(z, (side[0] * math.sin(ar), side[1] * math.sin(ar), math.cos(ar)), atol=1e-12)


def test_cardan_angle_relation() -> None:
    for c, a in ((10.0, 150.0), (-80.0, -66.0)):
        assert spatial_to_machine(*machine_to_spatial(c, a, 45.0), 45.0) == pytest.approx((c, a))
    assert machine_to_spatial(0.0, 180.0, 45.0) == pytest.approx((90.0, 90.0))


@pytest.mark.parametrize("hd7", [30.0, 45.0])
@pytest.mark.parametrize("target", [-40.0, 15.0, 55.0])
def test_saw_tcp_is_the_lowest_tooth(hd7: float, target: float) -> None:
    """2.29.1.1: at the target angle the tool point is the lowest point of the blade; at A = 0 the tooth towards +X."""
    param = {6: hd7 * 1e4, 18: target * 1e4, 19: 2.0}
    axes = [0.0, 0.0, 0.0, 25.0, target]
    tooth = kin59(param, axes, 80.0, {}, blade_radius_mm=150.0)
    centre = kin59({6: hd7 * 1e4}, axes, 80.0, {})
    rim = [centre @ (150 * math.cos(t), 150 * math.sin(t), 0, 1) for t in np.linspace(0, 2 * math.pi, 3601)]
    assert math.isclose(tooth[2, 3], min(point[2] for point in rim), abs_tol=1e-3)
    assert math.isclose(float(np.linalg.norm((tooth - centre)[:3, 3])), 150.0, abs_tol=1e-9)
    flat = kin59({6: hd7 * 1e4, 19: 2.0}, [0.0] * 5, 0.0, {}, blade_radius_mm=150.0)
    assert np.allclose(flat[:3, 3], (150, 0, 0), atol=1e-12)


# ------------------------------------------------------------------ arm 45

ARM = {"HD7": 400.0, "HD8": 450.0, "HD9": 420.0, "HD10": 90.0, "HD11": 25.0}


def test_arm_internal_zero_and_kuka_zero() -> None:
    """3.3: upper arm up and hand along +X; HD14/HD15 = -90/90 make the axis zero a straight horizontal arm."""
    assert np.allclose(pose(45, [0] * 6, **ARM)[:3, 3], (535, 0, 850), atol=1e-12)
    straight = pose(45, [0] * 6, HD14=-90, HD15=90, **ARM)
    assert np.allclose(straight[:3, 3], (25 + 450 + 420 + 90, 0, 400), atol=1e-9)
    assert np.allclose(straight[:3, 2], (1, 0, 0), atol=1e-12)


def test_arm_offset_signs() -> None:
    """3.3: HD12 > 0 has axis 3 above axis 5, HD32 > 0 has axis 1 on the +Y side of axis 4."""
    assert np.allclose(pose(45, [0] * 6, HD12=30, HD32=20, **ARM)[:3, 3], (535, -20, 820), atol=1e-12)


def wrist(axes: list[float], **hd: float) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Returns the wrist point: the flange without HD10."""
    return pose(45, axes, **{**ARM, **hd, "HD10": 0.0})[:3, 3]


def smallest_singular_value(axes: list[float], **hd: float) -> float:
    """Returns the smallest singular value of the arm's 6x6 Jacobian [mm/rad, 100*rad/rad]."""
    base, columns = pose(45, axes, **ARM, **hd), []
    for i in range(6):
        ahead = pose(45, [a + (1e-4 if k == i else 0.0) for k, a in enumerate(axes)], **ARM, **hd)
        step = math.radians(1e-4)
        spin = (ahead[:3, :3] - base[:3, :3]) @ base[:3, :3].T / step
        columns.append([*((ahead - base)[:3, 3] / step), 100 * spin[2, 1], 100 * spin[0, 2], 100 * spin[1, 0]])
    return float(np.linalg.svd(np.array(columns).T, compute_uv=False)[-1])


def test_arm_singularities() -> None:
    """3.3.4: wrist at A5 = 0; elbow at A3 = 0 for HD12 = 0; shoulder on the cylinder of radius HD32 about axis 1."""
    kuka = {"HD14": -90.0, "HD15": 90.0}
    assert smallest_singular_value([10, -70, 80, 20, 40, 15], **kuka) > 1.0
    assert smallest_singular_value([10, -70, 80, 20, 0, 15], **kuka) < 1e-2
    assert smallest_singular_value([10, -70, 0, 20, 40, 15], **kuka) < 1e-2
    # Wrist over axis 1: 25 + 450*sin(j2) + 420*cos(j2 + j3) = 0 with j2 = 0.
    j3 = math.degrees(math.acos(-25 / 420))
    for hd32 in (0.0, 60.0):
        axes = [10.0, -90.0, j3 + 90.0, 20.0, 40.0, 15.0]
        assert math.isclose(math.hypot(*wrist(axes, HD32=hd32, **kuka)[:2]), hd32, abs_tol=1e-9)
        assert smallest_singular_value(axes, HD32=hd32, **kuka) < 1e-2


def test_arm_tool_and_moved_workpiece() -> None:
    """3.3, 3.3.1: tool order Z, X, Y; HD34 = 4 counts the length along z; HD33 = 1 fixes the tool in space."""
    tool = {"HD1": 100.0, "HD2": 10.0, "HD3": 20.0, "HD4": 15.0, "HD5": 25.0, "HD6": 35.0}
    axes = [10.0, -20.0, 30.0, 40.0, 50.0, 60.0]
    flange, held = pose(45, axes, **ARM), pose(45, axes, **ARM, **tool)
    local = np.linalg.inv(flange) @ held
    assert np.allclose(local[:3, 3], (10, 20, 100), atol=1e-9)
    assert np.allclose(pose(45, axes, 70, **ARM, **tool), held, atol=1e-12)
    assert np.allclose(np.linalg.inv(held) @ pose(45, axes, 70, raw34=4, **ARM, **tool) @ (0, 0, 0, 1), (0, 0, 70, 1))
    assert np.allclose(pose(45, axes, raw33=1, **ARM, **tool), np.linalg.inv(flange) @ local, atol=1e-9)
    assert np.allclose(arm(Head({}), [0.0] * 6), np.eye(4))
