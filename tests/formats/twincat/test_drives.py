"""Drives of 3, 28, 59, 60, 70 and 76 by formulas written from the manual, and their software limits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

import chainbuild
from chainbuild import AffineDrives, ChainbuildError, Robot
from chainbuild.formats.twincat.maps.drives import BevelDrives
from tests.kit.machine_files import machine_file

LINEAR = "X = [-3000, 3000]\nY = [-3000, 3000]\nZ = [-3000, 3000]\n"
GEAR_2 = {14: 1, 15: 1, 16: 2, 17: 1}


def text_of(kin_typ: int, hd: Mapping[int, float]) -> str:
    """Return a list; flags, signs and gear numbers as they are, others in 1e-4."""
    bare = (
        {13, 14, 15, 12, 16, 17}
        if kin_typ == 28
        else {9, 10}
        if kin_typ == 70
        else {21}
        if kin_typ in (59, 60)
        else set()
    )
    rows = [f"trafo[0].param[{n - 1}] {value if n in bare else round(value * 1e4)}" for n, value in hd.items()]
    return "\n".join([f"trafo[0].id {kin_typ}", *rows, "Ende"]) + "\n"


def robot_of(folder: Path, kin_typ: int, hd: Mapping[int, float], overlay: str = "", **conventions: str) -> Robot:
    path = machine_file(folder, text_of(kin_typ, hd), overlay)
    return Robot.load(path, conventions=conventions or None)


def check_derivative(robot: Robot, axes: np.ndarray) -> None:
    drives = robot.chain.drives
    assert drives is not None
    step, numeric = 1e-4, []
    for n in range(len(axes)):
        there = np.zeros(len(axes))
        there[n] = step
        numeric.append((robot.drives(axes + there) - robot.drives(axes - there)) / (2.0 * step))
    assert np.abs(np.array(numeric).T - drives.derivative(axes)).max() < 1e-5


def test_3_programmed_b_is_half_a_turn_off_the_drive(tmp_path: Path) -> None:
    assert robot_of(tmp_path, 3, {}).drives([1, 2, 3, 10]).tolist() == [1, 2, 3, 10]
    robot = robot_of(tmp_path, 3, {}, "[limits.drives]\nB = [0, 200]\n", kin3_b_value="programmed")
    assert robot.drives([1, 2, 3, 10]).tolist() == [1, 2, 3, 190]
    assert (robot.axes[3].lower, robot.axes[3].upper, robot.axes[3].assumed) == (-180.0, 20.0, False)
    assert robot.violated_limits([0, 0, 0, 30]) == ("B_drive",)


def gear_28(c: float, a: float, signs: tuple[float, float] = (1.0, 1.0)) -> tuple[float, float]:
    """C and A drive by 2.22 at HD11 = 7, HD12/13 = 1/2, HD16/17 = 2."""
    return signs[0] * c, signs[1] * (2.0 * a + 7.0 + 0.5 * c)


@pytest.mark.parametrize("place", ["after_gear", "before_gear"])
def test_28_by_the_gear(tmp_path: Path, place: str) -> None:
    hd = {**GEAR_2, 11: 7.0, 12: 1, 13: 2, 14: -1, 15: -1, 3: 5.0, 4: 6.0}
    robot = robot_of(tmp_path, 28, hd, gear_flag_place=place)
    signs = (-1.0, -1.0) if place == "before_gear" else (1.0, 1.0)
    rng = np.random.default_rng(1)
    for _ in range(20):
        axes = rng.uniform(-90.0, 90.0, 5)
        assert robot.drives(axes) == pytest.approx([*axes[:3], *gear_28(*axes[3:], signs)], abs=1e-12)
        check_derivative(robot, axes)
    # What the other place of the signs gives is another answer.
    other = gear_28(30.0, 40.0, (-signs[0], -signs[1]))
    assert robot.drives([0, 0, 0, 30, 40])[3:].tolist() != pytest.approx(other)


def test_28_a_gear_that_reverses(tmp_path: Path) -> None:
    """A_drive = A·HD16/HD17, here -A; 1:1 it is no gear at all."""
    robot = robot_of(tmp_path, 28, {**GEAR_2, 16: -1})
    assert robot.drives([1, 2, 3, 40, 50]).tolist() == [1, 2, 3, 40, -50]
    assert robot_of(tmp_path, 28, {**GEAR_2, 16: 1}).chain.drives is None


def test_28_a_gear_without_an_offset_has_no_signed_zeros(tmp_path: Path) -> None:
    robot = robot_of(tmp_path, 28, {**GEAR_2, 14: -1, 15: -1}, gear_flag_place="before_gear")
    drives = robot.chain.drives
    assert isinstance(drives, AffineDrives)
    assert drives.b.tolist() == [0.0] * 5
    assert not np.signbit(drives.b).any()
    assert not np.signbit(drives.A[drives.A == 0.0]).any()


def test_28_axis_values_that_are_the_drives(tmp_path: Path) -> None:
    robot = robot_of(tmp_path, 28, {**GEAR_2, 12: 1, 13: 2}, kin28_axis_values="drives")
    assert robot.drives([1, 2, 3, 40, 50]).tolist() == [1, 2, 3, 40, 50]


def test_28_the_drive_of_a_geared_axis_is_limited(tmp_path: Path) -> None:
    """A geared 2:1, drive ±100: A = 80 is outside, for its drive is at 160."""
    robot = robot_of(tmp_path, 28, GEAR_2, f"[limits]\n{LINEAR}C = [-180, 180]\n[limits.drives]\nA = [-100, 100]\n")
    assert (robot.axes[4].lower, robot.axes[4].upper, robot.axes[4].widest) == (-50.0, 50.0, None)
    assert robot.drives([0, 0, 0, 0, 80])[4] == 160.0
    assert robot.violated_limits([0, 0, 0, 0, 80]) == ("A_drive",)
    assert robot.violated_limits([0, 0, 0, 0, 50]) == ()
    refused = robot.ik(robot.fk([0, 0, 0, 30, 80]))
    assert (refused.status, refused.violated) == ("limits", ("A_drive",))
    assert "A_drive is 160, outside -100 … 100 deg" in refused.reason


def test_28_limits_of_the_axis_and_of_the_drive_are_both_tested(tmp_path: Path) -> None:
    overlay = f"[limits]\n{LINEAR}C = [-180, 180]\nA = [-45, 80]\n[limits.drives]\nA = [-100, 100]\n"
    robot = robot_of(tmp_path, 28, GEAR_2, overlay)
    assert (robot.axes[4].lower, robot.axes[4].upper) == (-45.0, 50.0)
    assert robot.violated_limits([0, 0, 0, 0, -47]) == ("A",)
    assert robot.violated_limits([0, 0, 0, 0, 55]) == ("A_drive",)


def test_28_a_range_that_depends_on_c(tmp_path: Path) -> None:
    overlay = f"[limits]\n{LINEAR}C = [-100, 300]\nA = [-360, 360]\n[limits.drives]\nA = [-100, 100]\n"
    robot = robot_of(tmp_path, 28, {**GEAR_2, 12: 1, 13: 2}, overlay)
    c, a = robot.axes[3:]
    assert (a.lower, a.upper) == (-75.0, 25.0)  # at C = 100, the middle
    assert a.widest == (-360.0, 360.0)
    assert (c.lower, c.upper, c.widest) == (-100.0, 200.0, (-100.0, 300.0))
    assert robot.violated_limits([0, 0, 0, 0, 49]) == ()
    assert robot.violated_limits([0, 0, 0, 0, 51]) == ("A_drive",)
    assert robot.violated_limits([0, 0, 0, 310, 0]) == ("C", "A_drive")
    # Where its own limits are not known, the drive's are all there are.
    robot = robot_of(tmp_path, 28, {**GEAR_2, 12: 1, 13: 2}, overlay.replace("A = [-360, 360]\n", ""))
    assert robot.axes[4].widest == (-125.0, 75.0)  # at C = 300 and -100
    assert robot.violated_limits([0, 0, 0, 0, 500]) == ("A_drive",)


def test_limits_of_axis_lists_are_those_of_drives(tmp_path: Path) -> None:
    path = machine_file(tmp_path, text_of(28, GEAR_2), 'axis_lists = ["a.lis"]\n[limits]\nA = [-40, 90]\n')
    rows = "kopf.log_achs_name A\nkenngr.swe_neg -1000000\nkenngr.swe_pos 1000000\nEnde\n"
    (tmp_path / "a.lis").write_text(rows, "utf-8")
    robot = Robot.load(path)
    assert [(one.axis, one.lower, one.upper) for one in robot.chain.drive_limits] == [(4, -100.0, 100.0)]
    assert (robot.axes[4].lower, robot.axes[4].upper, robot.axes[4].assumed) == (-40.0, 50.0, False)


def machine_59(c: float, a: float, hd7: float) -> tuple[float, float]:
    """Machine angles of spatial ones by 2.29: 2·asin(sin(A/2)/sin HD7), C compensated."""
    tilt = 2.0 * math.asin(math.sin(math.radians(a) / 2.0) / math.sin(math.radians(hd7)))
    turn = math.atan2(math.cos(math.radians(hd7)) * math.sin(tilt / 2.0), math.cos(tilt / 2.0))
    return c - math.degrees(turn), math.degrees(tilt)


def test_59_machine_angle_of_a_spatial_one(tmp_path: Path) -> None:
    assert robot_of(tmp_path, 59, {7: 45.0}).drives([0, 0, 0, 0, 85])[4] == pytest.approx(145.658, abs=5e-4)


@pytest.mark.parametrize(("kin_typ", "sign"), [(59, 1.0), (60, 1.0), (60, -1.0)])
def test_59_and_60_spatial(tmp_path: Path, kin_typ: int, sign: float) -> None:
    chosen = {"kin60_tilt_sign": "minus"} if sign < 0 else {}
    robot = robot_of(tmp_path, kin_typ, {7: 40.0, 1: 100.0}, **chosen)
    rng = np.random.default_rng(2)
    for _ in range(20):
        axes = np.array([*rng.uniform(-100.0, 100.0, 4), rng.uniform(-75.0, 75.0)])
        c, tilt = machine_59(float(axes[3]), sign * float(axes[4]), 40.0)
        assert robot.drives(axes) == pytest.approx([*axes[:3], c, tilt], abs=1e-9)
        check_derivative(robot, axes)


@pytest.mark.parametrize("offsets", ["after_conversion", "direction_exact"])
@pytest.mark.parametrize("drive", ["added", "contained"])
@pytest.mark.parametrize("pose", ["subtracted", "not_in_pose"])
@pytest.mark.parametrize("machine_angles", [0, 1])
def test_59_zero_offsets(tmp_path: Path, offsets: str, drive: str, pose: str, machine_angles: int) -> None:
    """HD14, HD15 act on the model alone, HD16, HD17 like a zero offset: programmed 0 moves the drive."""
    hd = {7: 45.0, 14: 1.0, 15: 2.0, 16: 3.0, 17: 4.0, 21: machine_angles}
    chosen = {"spatial_angle_offsets": offsets, "kin59_drive_offset": drive, "kin59_zero_offset": pose}
    robot = Robot.load(machine_file(tmp_path, text_of(59, hd)), conventions=chosen)
    c, a = (50.0, 20.0) if machine_angles else machine_59(50.0, 20.0, 45.0)
    if machine_angles:
        more = (0.0, 0.0) if pose == "subtracted" else (3.0, 4.0)
    elif offsets == "direction_exact":
        more = (4.0, 6.0)
    else:
        more = (3.0, 4.0) if drive == "added" else (0.0, 0.0)
    assert robot.drives([0, 0, 0, 50, 20])[3:] == pytest.approx([c + more[0], a + more[1]], abs=1e-9)


def test_59_range_by_the_drive(tmp_path: Path) -> None:
    """The range of A is monotone in its drive's: exact at both ends, and C's depends on A."""
    overlay = f"[limits]\n{LINEAR}C = [-180, 180]\n[limits.drives]\nA = [-60, 145.65835833]\nC = [-200, 200]\n"
    robot = robot_of(tmp_path, 59, {7: 45.0}, overlay)
    c, a = robot.axes[3:]
    assert a.upper == pytest.approx(85.0, abs=1e-8)
    assert a.lower == pytest.approx(-2.0 * math.degrees(math.asin(0.5 * math.sin(math.pi / 4))), abs=1e-10)
    assert a.widest is not None
    assert c.widest is not None
    assert robot.violated_limits([0, 0, 0, 0, 86]) == ("A_drive",)
    assert robot.violated_limits([0, 0, 0, 180, -40]) == ("C_drive",)


def turned_70(b: float, a: float, cv: float) -> tuple[float, float]:
    """B', A' by Rz(CV)·Ry(B)·Rx(A)·e_z within ±90 (2.33)."""
    b, a, cv = (math.radians(angle) for angle in (b, a, cv))
    x, y, z = math.sin(b) * math.cos(a), -math.sin(a), math.cos(b) * math.cos(a)
    x, y = math.cos(cv) * x - math.sin(cv) * y, math.sin(cv) * x + math.cos(cv) * y
    return math.degrees(math.atan2(x, z)), math.degrees(math.asin(-y))


@pytest.mark.parametrize("signs", [(1, 1), (-1, 1), (1, -1)])
def test_70_follows_cv(tmp_path: Path, signs: tuple[int, int]) -> None:
    zero_a, zero_b = 4.0, 9.0
    robot = robot_of(tmp_path, 70, {7: zero_a, 8: zero_b, 9: signs[0], 10: signs[1]})
    rng = np.random.default_rng(4)
    for _ in range(20):
        axes = np.array([*rng.uniform(-100.0, 100.0, 3), *rng.uniform(-70.0, 70.0, 2), rng.uniform(-170.0, 170.0)])
        b, a = turned_70(signs[1] * axes[3] - zero_b, signs[0] * axes[4] - zero_a, axes[5])
        expected = [*axes[:3], signs[1] * (b + zero_b), signs[0] * (a + zero_a), axes[5]]
        assert robot.drives(axes) == pytest.approx(expected, abs=1e-9)
        check_derivative(robot, axes)
    assert [(axis.lower, axis.upper) for axis in robot.axes[3:5]] == [(-90.0, 90.0)] * 2
    machine = robot_of(tmp_path, 70, {7: zero_a, 9: 1, 10: 1}, kin70_cv="machine")
    assert machine.drives([0, 0, 0, 10, 20, 90]).tolist() == [0, 0, 0, 10, 20, 90]


def rot(axis: tuple[float, float, float], angle: float) -> np.ndarray:
    x, y, z = axis
    K, t = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]), math.radians(angle)
    return np.eye(3) + math.sin(t) * K + (1.0 - math.cos(t)) * K @ K


@pytest.mark.parametrize("mounting", ["plus", "minus"])
@pytest.mark.parametrize("axes_stand", ["b_outside", "a_outside", "upright"])
def test_76_machine_axes_point_the_tool_where_it_is_programmed(tmp_path: Path, axes_stand: str, mounting: str) -> None:
    robot = robot_of(tmp_path, 76, {6: 20.0, 7: 65.0}, kin76_machine_axes=axes_stand, kin76_hd6_sign=mounting)
    inclined = (math.sin(math.radians(65.0)), 0.0, math.cos(math.radians(65.0)))
    z = np.array([0.0, 0.0, 1.0])
    rng = np.random.default_rng(5)
    for _ in range(50):
        axes = np.array([*rng.uniform(-100.0, 100.0, 3), rng.uniform(-180.0, 180.0), rng.uniform(1.0, 60.0)])
        _, _, _, a, b = robot.drives(axes)
        head = {
            "b_outside": rot((0, 1, 0), b) @ rot(inclined, a),
            "a_outside": rot(inclined, a) @ rot((0, 1, 0), b),
            "upright": rot((0, 0, 1), b) @ rot(inclined, a),
        }[axes_stand]
        found = rot((0, 0, 1), 20.0 if mounting == "plus" else -20.0) @ head @ z
        assert found == pytest.approx(robot.fk(axes).rotation[:, 2], abs=1e-12)
        assert isinstance(robot.chain.drives, BevelDrives)
        assert robot.chain.drives.direction(robot.drives(axes)) == pytest.approx(head @ z, abs=1e-12)
        check_derivative(robot, axes)
    assert robot.drives(np.zeros(5))[4] == pytest.approx(
        -20.0 if axes_stand == "upright" and mounting == "plus" else 20.0 if axes_stand == "upright" else 0.0, abs=1e-9
    )


@pytest.mark.parametrize(("axes_stand", "across"), [("b_outside", 65.0), ("upright", 130.0), ("a_outside", 179.0)])
def test_76_how_far_the_readings_reach(tmp_path: Path, axes_stand: str, across: float) -> None:
    """Only b_outside bounds the lean near the printed ±60 degrees."""
    robot = robot_of(tmp_path, 76, {7: 65.0}, kin76_machine_axes=axes_stand)
    assert np.isfinite(robot.drives([0, 0, 0, 0, across - 0.01])).all()
    if axes_stand != "a_outside":
        with pytest.raises(ChainbuildError, match="cannot lean"):
            robot.drives([0, 0, 0, 0, across + 0.01])


def test_76_without_an_inclined_axis_has_no_drives_of_its_own(tmp_path: Path) -> None:
    assert robot_of(tmp_path, 76, {}).chain.drives is None


@pytest.mark.parametrize(("kin_typ", "axis"), [(59, "A"), (60, "B")])
def test_limits_beyond_the_reach_are_a_finding(tmp_path: Path, kin_typ: int, axis: str) -> None:
    path = machine_file(tmp_path, text_of(kin_typ, {7: 45.0}), f"[limits]\n{LINEAR}{axis} = [-180, 180]\n")
    (found,) = [finding for finding in chainbuild.check(path) if finding.code == "CB432"]
    assert found.span is not None
    assert (found.span.file, found.span.line) == (str(tmp_path / "machine.chainbuild.toml"), 5)
    robot = Robot.load(path)
    assert (robot.axes[4].lower, robot.axes[4].upper) == pytest.approx((-90.0, 90.0))
    within = machine_file(tmp_path, text_of(kin_typ, {7: 45.0}), f"[limits]\n{LINEAR}{axis} = [-90, 90]\n")
    assert "CB432" not in {finding.code for finding in chainbuild.check(within)}


def test_limits_that_leave_nothing_are_refused(tmp_path: Path) -> None:
    path = machine_file(tmp_path, text_of(59, {7: 45.0}), "[limits]\nA = [100, 180]\n")
    with pytest.raises(ChainbuildError, match="leave nothing"):
        Robot.load(path)
    overlay = "[limits]\nA = [60, 80]\n[limits.drives]\nA = [-100, 100]\n"
    path = machine_file(tmp_path, text_of(28, GEAR_2), overlay)
    with pytest.raises(ChainbuildError, match="no value in common"):
        Robot.load(path)
    assert "CB433" in {finding.code for finding in chainbuild.check(path)}


def test_limits_that_exclude_the_middle_are_a_finding(tmp_path: Path) -> None:
    overlay = f"[limits]\n{LINEAR}C = [200, 360]\nA = [-20, 20]\n[limits.drives]\nA = [-100, 95]\n"
    path = machine_file(tmp_path, text_of(28, {**GEAR_2, 12: 1, 13: 2}), overlay)
    robot = Robot.load(path)
    assert robot.violated_limits([0, 0, 0, 280, 0]) == ("A_drive",)
    assert robot.violated_limits([0, 0, 0, 200, -10]) == ()
    assert (robot.axes[4].lower, robot.axes[4].upper, robot.axes[4].widest) == (-20.0, 20.0, (-20.0, 20.0))
    assert "CB434" in {finding.code for finding in chainbuild.check(path)}
    (tmp_path / "machine.chainbuild.toml").write_text(overlay.replace("-20, 20", "0, 20"), "utf-8")
    with pytest.raises(ChainbuildError, match="no value in common"):
        Robot.load(path)


def test_two_steps_have_the_drives_of_the_first(tmp_path: Path) -> None:
    rows = [f"kin_step[0].trafo[0].{line}" for line in ("id 59", "param[6] 450000")]
    rows += ["kin_step[1].trafo[0].id 58"]
    rows += ["default_id_of_kin_step[0] 59", "default_id_of_kin_step[1] 58", "Ende"]
    robot = Robot.load(machine_file(tmp_path, "\n".join(rows) + "\n", "[limits.drives]\nA = [-100, 100]\n"))
    assert robot.drives([0, 0, 0, 0, 85])[4] == pytest.approx(145.658, abs=5e-4)
    assert robot.violated_limits([0, 0, 0, 0, 85]) == ("A_drive",)


def test_the_reach_of_wide_limits_set_later_raises_nothing(tmp_path: Path) -> None:
    """Limits of a chain that a program widens: samples without a pose are left out everywhere."""
    from dataclasses import replace

    from chainbuild import MapSpec, make_map, measure_batch, nearest_singularity

    chain = robot_of(tmp_path, 60, {7: 45.0, 1: 100.0}, f"[limits]\n{LINEAR}C = [-180, 180]\n").chain
    wide = replace(chain.axes[4], lower=-180.0, upper=180.0)
    robot = Robot(chain.with_axes((*chain.axes[:4], wide)))
    target = robot.fk([1, 2, 3, 40, 50])
    assert robot.ik(target).success
    assert len(robot.ik_all(target)) == 2
    table = measure_batch(robot, [[0, 0, 0, 0, 50], [0, 0, 0, 0, 150]])
    assert np.isnan(table.smallest).tolist() == [False, True]
    assert nearest_singularity(robot, [0, 0, 0, 0, 60]).found
    with pytest.raises(ChainbuildError):
        nearest_singularity(robot, [0, 0, 0, 0, 150])
    shown = make_map(robot, MapSpec("axes", ("C", "B"), cells=8), workers=1)
    assert np.count_nonzero(shown.count) == 32
    assert make_map(robot, MapSpec("xz", cells=4, samples=200), workers=1).count.sum() > 0


def test_a_full_turn_as_the_limit_of_a_drive_counts(tmp_path: Path) -> None:
    path = machine_file(tmp_path, text_of(28, GEAR_2), 'axis_lists = ["a.lis"]\n')
    rows = "kopf.log_achs_name A\nkenngr.swe_neg -3600000\nkenngr.swe_pos 3600000\nEnde\n"
    (tmp_path / "a.lis").write_text(rows, "utf-8")
    robot = chainbuild.Robot.load(path)
    assert robot.violated_limits([0.0, 0.0, 0.0, 0.0, 185.0]) == ("A_drive",)
    assert robot.violated_limits([0.0, 0.0, 0.0, 0.0, 170.0]) == ()
