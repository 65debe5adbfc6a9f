"""Singularities of closed loops by name, against the lengths of the single rods, by hand and differenced.

A tripod or delta robot has six rods here, each pair apart across its arm, and a platform with six freedoms: what its
lengths leave free by the platform's motion or by an axis is what must be named.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from chainbuild import Robot, path_report
from chainbuild.analysis.singularity.loops import losses_at
from chainbuild.analysis.singularity.measures import measure, measure_batch, smallest_value
from chainbuild.analysis.singularity.names import examine, examine_path, sentence_at
from chainbuild.analysis.singularity.nearest import nearest_singularity
from chainbuild.errors import ChainbuildError
from tests.hand.loops_cases import channel_list

Values = Sequence[float] | np.ndarray

TRIPOD = {1: 80.0, 5: 420.0, 6: 90.0, 7: 650.0}
TABLE = {1: 120.0, 5: 420.0, 6: 90.0, 7: 650.0, 34: -50.0, 37: -900.0}
DELTA = {1: 50.0, 4: 40.0, 5: 150.0, 6: 400.0, 7: 200.0}
LAMBDA = {1: 60.0, 2: 500.0, 3: 600.0, 4: 450.0, 5: 0.0, 6: 20.0, 7: 0.0, 11: 40.0}
APART = 50.0  # mm between the rods of a pair: in no machine data
AZIMUTHS = {12: (120.0, 240.0, 0.0), 209: (120.0, 240.0, 0.0), 37: (-90.0, 30.0, 150.0)}


def build(folder: Path, kin: int, hd: dict[int, float], **conventions: str) -> Robot:
    path = folder / f"kin{kin}.lis"
    path.write_text(channel_list(kin, hd))
    return Robot.load(path, conventions=conventions)


def uppers(kin: int, hd: dict[int, float], axes: Values) -> np.ndarray:
    """Return the upper ends (3, 2, 3) of the rods [mm]."""
    ends = []
    for azimuth, value in zip(AZIMUTHS[kin], axes, strict=False):
        c, s = math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth))
        out, z = hd[5], value
        if kin == 37:
            out, z = hd[5] + hd[7] * math.cos(math.radians(value)), -hd[7] * math.sin(math.radians(value))
        ends.append([[out * c - side * s, out * s + side * c, z] for side in (-APART / 2, APART / 2)])
    return np.array(ends)


def lengths(kin: int, hd: dict[int, float], axes: Values, moved: np.ndarray) -> np.ndarray:
    """Return the lengths (6,) of the rods [mm] for a platform shifted by moved[:3] and turned by moved[3:] [rad]."""
    R = pin.exp3(moved[3:])
    lower = []
    for azimuth in AZIMUTHS[kin]:
        c, s = math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth))
        radius = hd[4] if kin == 37 else hd[6]
        lower.append([[radius * c - side * s, radius * s + side * c, 0.0] for side in (-APART / 2, APART / 2)])
    ends = np.array(lower) @ R.T + moved[:3]
    return np.asarray(np.linalg.norm(uppers(kin, hd, axes) - ends, axis=2).ravel())


def held(kin: int, hd: dict[int, float], axes: Values, p: np.ndarray) -> np.ndarray:
    """Return the derivative (6, 6) of the lengths by the motion of the platform; turns count 100 mm a radian."""
    columns = []
    for n in range(6):
        step = np.zeros(6)
        step[n] = 1e-3 if n < 3 else 1e-5
        ahead, behind = (lengths(kin, hd, axes, np.append(p, np.zeros(3)) + sign * step) for sign in (1.0, -1.0))
        columns.append((ahead - behind) / 2e-3)
    return np.array(columns).T


def platform(robot: Robot, hd: dict[int, float], axes: Values) -> np.ndarray:
    """Return the middle of the platform's pins [mm] of a machine without table and tool length."""
    T = robot.frame_placements(axes)["flange"]
    return np.asarray(T.translation * 1000.0 + [0.0, 0.0, hd[1]])


def slides(p: Sequence[float], hd: dict[int, float], azimuths: Sequence[float]) -> list[float]:
    """Return the heights of the carriages above a platform [mm]."""
    found = []
    for azimuth in azimuths:
        x, y = ((hd[5] - hd[6]) * f(math.radians(azimuth)) for f in (math.cos, math.sin))
        found.append(p[2] + math.sqrt(hd[7] ** 2 - (p[0] - x) ** 2 - (p[1] - y) ** 2))
    return found


def by_kind(robot: Robot, axes: Values) -> dict[str, str]:
    return {found.kind: found.sentence for found in examine(robot, axes).names}


def finite_everywhere(robot: Robot, axes: Values) -> None:
    """What is asked about a state close to a singularity is answered in numbers, or refused in words."""
    T = robot.fk(axes)
    assert np.isfinite(T.homogeneous).all()
    found = robot.ik(T, start=axes)
    assert found.status in ("ok", "limits"), found
    assert np.abs(robot.fk(found.axes).translation - T.translation).max() < 1e-8
    report = examine(robot, axes)
    numbers = [*report.measures.singular_values, report.measures.smallest, *report.measures.lost]
    assert np.isfinite(numbers).all()
    assert not any(math.isnan(one.needed) for one in report.speed.axes)
    table = measure_batch(robot, np.array([axes]))
    assert table.smallest[0] == pytest.approx(smallest_value(robot, axes), abs=1e-12)
    try:
        assert np.isfinite(robot.jacobian(axes)).all()
    except ChainbuildError as told:
        assert "the axes hold the tool no more" in str(told)


@pytest.mark.parametrize("kin", [12, 209])
@pytest.mark.parametrize("off", [0.0, 0.2])
def test_a_rod_across_its_column(kin: int, off: float, tmp_path: Path) -> None:
    """The platform stands a whole rod away from the third column, but for `off` mm: its carriage moves nothing."""
    hd = TRIPOD if kin == 12 else TABLE
    robot = build(tmp_path, kin, hd)
    inward = hd[5] - hd[6] - hd[7] + off
    axes = slides([inward, 0.0, 0.0], hd, AZIMUTHS[kin]) + ([-20.0, 30.0] if kin == 209 else [])
    value = math.sqrt(hd[7] ** 2 - (hd[7] - off) ** 2) / hd[7]
    found = next(one for one in losses_at(robot, np.array(axes)) if one.kind == "strut")
    assert found.value == pytest.approx(-value, abs=1e-7)
    down = build(tmp_path, kin, hd, kin12_z_positive="down")
    lowered = np.array([-value for value in axes[:3]] + axes[3:])
    turned = next(one for one in losses_at(down, lowered) if one.kind == "strut")
    assert turned.value == pytest.approx(value, abs=1e-7)  # carriages that count downwards
    name, sentence = examine(robot, axes).names[0], by_kind(robot, axes)["strut"]
    assert name.axes == ("Z3",)
    nearly = "nearly " if off else ""
    assert sentence.startswith(f"the rod of Z3 stands {nearly}across its column: ")
    assert f"is {nearly}lost" in sentence
    # What is lost is the motion along the rod, which lies along X.
    R = robot.frame_placements(axes)["tool"].rotation
    if not off:
        assert np.abs(R @ measure(robot, axes).lost[:3])[0] > 0.99 * np.linalg.norm(measure(robot, axes).lost[:3])
    finite_everywhere(robot, axes)
    assert measure(robot, axes).smallest < (1e-6 if not off else 0.1)


@pytest.mark.parametrize("how", ["stretched", "folded"])
@pytest.mark.parametrize("off", [0.0, 0.5])
def test_a_lever_in_line_with_its_rod(how: str, off: float, tmp_path: Path) -> None:
    robot = build(tmp_path, 37, DELTA)
    theta = math.radians(110.0 if how == "stretched" else -75.0)
    base, lever, rod = DELTA[5] - DELTA[4], DELTA[7], DELTA[6]
    far = lever + rod if how == "stretched" else lever - rod
    # In the plane of the first arm, which stands at -90°: outwards is -Y.
    p = np.array([0.0, -(base + far * math.cos(theta)), -far * math.sin(theta)])
    others = []
    for azimuth in AZIMUTHS[37][1:]:
        e = np.array([math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth)), 0.0])
        out, aside = float(p @ e) - base, float(e[0] * p[1] - e[1] * p[0])
        leg, distance = math.sqrt(rod**2 - aside**2), math.hypot(out, p[2])
        opening = math.acos((lever**2 + distance**2 - leg**2) / (2.0 * lever * distance))
        others.append(math.degrees(math.atan2(-p[2], out) - opening))
    axes = [math.degrees(theta) + off, *others]
    nearly = "nearly " if off else ""
    sentence = by_kind(robot, axes)["strut"]
    assert sentence.startswith(f"the lever and the rod of J1 are {nearly}{how}: motion along ")
    assert platform(robot, DELTA, axes) == pytest.approx(p, abs=1e-3 if not off else 20.0)
    rates = np.array(
        [lengths(37, DELTA, np.array(axes) + step * np.eye(3)[0], np.append(p, [0, 0, 0])) for step in (1e-3, -1e-3)]
    )
    by_axis = float(np.abs(rates[0] - rates[1]).max()) / math.radians(2e-3) / lever
    found = next(one for one in losses_at(robot, np.array(axes)) if one.kind == "strut" and one.axes == (0,))
    assert abs(found.value) == pytest.approx(by_axis, abs=1e-6 if not off else 2e-2)
    finite_everywhere(robot, axes)


@pytest.mark.parametrize(("kin", "hd"), [(12, TRIPOD), (37, DELTA)])
def test_struts_and_rods_lose_what_the_lengths_of_six_rods_do(kin: int, hd: dict[int, float], tmp_path: Path) -> None:
    """The determinant of the rods' lengths by the platform's motion changes its sign exactly where a name is given."""
    robot = build(tmp_path, kin, hd)
    rng = np.random.default_rng(5)
    crossed = 0
    for _ in range(400):
        ends: list[np.ndarray] = []
        while len(ends) < 2:
            axes = rng.uniform(-1.0, 1.0, 3) * (400.0 if kin == 12 else 100.0)
            if np.isfinite(robot.chain.axis_map.q(axes)).all():
                ends.append(axes)
        share = np.linspace(0.0, 1.0, 11)[:, None]
        way = [row for row in ends[0] + share * (ends[1] - ends[0]) if np.isfinite(robot.chain.axis_map.q(row)).all()]
        if len(way) < 11:
            continue
        signs = [np.linalg.slogdet(held(kin, hd, row, platform(robot, hd, row)))[0] for row in way]
        named = [loss for loss in losses_at(robot, way[0]) if loss.kind != "strut"]
        assert {loss.kind for loss in named} == {"platform", "twist"}
        for n in np.flatnonzero(np.diff(signs)):
            low, high = way[n], way[n + 1]
            if np.abs(platform(robot, hd, low) - platform(robot, hd, high)).max() > 200.0:
                continue  # the lower side changes between upright planes of the centres
            for _ in range(40):
                middle = (low + high) / 2.0
                same = np.linalg.slogdet(held(kin, hd, middle, platform(robot, hd, middle)))[0] == signs[n]
                low, high = (middle, high) if same else (low, middle)
            found = {loss.kind: loss for loss in losses_at(robot, middle)}
            least = min((found["platform"], found["twist"]), key=lambda loss: abs(loss.value))
            assert abs(least.value) < 1e-5
            if least.kind != "twist":
                continue
            crossed += 1
            free = np.linalg.svd(held(kin, hd, middle, platform(robot, hd, middle)))[2][-1]
            about = free[3:] / np.linalg.norm(free[3:])
            assert abs(float(about @ least.about)) == pytest.approx(1.0, abs=1e-3)
            assert "let the platform turn about" in by_kind(robot, middle)["twist"]
            finite_everywhere(robot, middle)
        if crossed >= 2:
            return
    raise AssertionError(f"only {crossed} turns of the platform found")


@pytest.mark.parametrize(
    ("beyond", "how"),
    [
        ([1300.0, -100.0, 500.0], "the rods of Z1, Z2 and Z3 are {}in a plane"),
        ([1200.0, -100.0, 0.0], "the rods of Z1 and Z2 are {}in one line"),  # the triangle of the joints is obtuse
    ],
)
def test_rods_in_the_plane_of_their_joints(beyond: list[float], how: str, tmp_path: Path) -> None:
    """At the edge of what closes the platform falls by itself: free is what the lengths of the rods leave free."""
    robot = build(tmp_path, 12, TRIPOD)
    low, high = np.array([0.0, 0.0, 0.0]), np.array(beyond)
    for _ in range(60):
        middle = (low + high) / 2.0
        low, high = (middle, high) if np.isfinite(robot.chain.axis_map.q(middle)).all() else (low, middle)
    p = platform(robot, TRIPOD, low)
    free = np.linalg.svd(held(12, TRIPOD, low, p))[2][-1]
    found = {loss.kind: loss for loss in losses_at(robot, low)}
    assert abs(found["platform"].value) < 1e-6
    assert np.abs(free[3:]).max() < 1e-3
    rates = found["platform"].rates
    assert rates is not None
    assert abs(float(rates[:3] @ free[:3])) == pytest.approx(1.0, abs=1e-6)
    sentence = by_kind(robot, low)["platform"]
    assert sentence.startswith(f"{how.format('')}: the axes let go of the tool along ")
    assert measure(robot, low).smallest < 1e-6
    with pytest.raises(ChainbuildError, match=r"the rods of Z1.* are in .*, and the axes hold the tool no more"):
        robot.jacobian(low)
    with pytest.raises(ChainbuildError, match=r"the rods .* too (short|long)"):
        robot.fk(high + [1e-3, 0.0, 0.0])
    near = low - [0.5, 0.0, 0.0]
    sentence = by_kind(robot, near)["platform"]
    assert f"{how.format('nearly ')}: the axes nearly let go of the tool along " in sentence
    assert "1 mm/s of Z" in sentence
    for axes in (low, near):
        finite_everywhere(robot, axes)
    nearest = nearest_singularity(robot, near)
    assert nearest.found
    assert "platform" in by_kind(robot, nearest.axes)


@pytest.mark.parametrize("off", [0.0, 1e-8, 0.3])
def test_parallel_rods_of_a_delta_robot(off: float, tmp_path: Path) -> None:
    """HD5 - HD4 + HD7·cos θ = 0 on all arms: the upper ends of the rods are one point."""
    robot = build(tmp_path, 37, DELTA)
    theta = math.degrees(math.acos(-(DELTA[5] - DELTA[4]) / DELTA[7]))
    axes = [theta - off] * 3
    if off < 1e-6:
        with pytest.raises(ChainbuildError, match=r"the rods of J1, J2 and J3 are parallel and hold nothing"):
            robot.fk(axes)
        return
    assert platform(robot, DELTA, axes)[2] == pytest.approx(-DELTA[7] * math.sin(math.radians(theta)) - DELTA[6], abs=2)
    found = by_kind(robot, axes)
    assert found["platform"].startswith("the rods of J1, J2 and J3 are nearly parallel: the axes nearly let go")
    assert "let the platform turn about the flange's Z" in found["twist"]
    free = np.linalg.svd(held(37, DELTA, axes, platform(robot, DELTA, axes)))[1]
    assert (free[-3:] < 0.02).all()  # three freedoms: rank 15 of 18
    assert free[-4] > 0.1
    finite_everywhere(robot, axes)


def test_two_levers_to_one_point(tmp_path: Path) -> None:
    robot = build(tmp_path, 37, DELTA)
    theta = math.degrees(math.acos(-(DELTA[5] - DELTA[4]) / DELTA[7]))
    with pytest.raises(ChainbuildError, match="the rods of J1 and J3 are parallel and hold nothing"):
        robot.fk([theta, 80.0, theta])


@pytest.mark.parametrize("off", [0.0, 0.5])
def test_the_lambda_stretched_folded_and_across(off: float, tmp_path: Path) -> None:
    robot = build(tmp_path, 21, LAMBDA)
    nearly = "nearly " if off else ""
    stretched = by_kind(robot, [0.0, 1100.0 - off, 10.0, 0.0])["platform"]
    assert stretched.startswith(f"the rods of X1 and X2 are {nearly}stretched in one line: the axes {nearly}let go")
    folded = by_kind(robot, [0.0, 100.0 + off, 10.0, 0.0])["platform"]
    assert folded.startswith(f"the rods of X1 and X2 are {nearly}folded onto one another: ")
    # B's rod upright: D stands 500 above its slide, sqrt(600² - 500²) before it.
    across = by_kind(robot, [0.0, math.sqrt(600.0**2 - 500.0**2) + off, 10.0, 30.0])["strut"]
    assert across.startswith(f"the rod of X2 stands {nearly}across its slide: motion along ")
    # The arm upright: its rod leans by 70°.
    x, y = 600.0 * math.cos(math.radians(70.0)), 600.0 * math.sin(math.radians(70.0))
    longer = build(tmp_path, 21, LAMBDA | {2: 700.0})
    axes = [0.0, x + math.sqrt(700.0**2 - y**2) + off, 10.0, 30.0]
    arm = by_kind(longer, axes)["strut"]
    assert arm.startswith(f"the arm of X1 stands {nearly}across its slide: motion along ")
    # With the arm upright nothing moves the gripper's pivot along Y but the rod's turn, which moves it along X.
    turned = longer.frame_placements(axes)["tool"].rotation @ measure(longer, axes).lost[:3]
    assert abs(turned[1]) > 0.9
    for machine, values in (
        (robot, [0.0, 1100.0 - off, 10.0, 0.0]),
        (robot, [0.0, 100.0 + off, 10.0, 0.0]),
        (longer, axes),
    ):
        finite_everywhere(machine, values)


@pytest.mark.parametrize("zero", ["along_arm", "along_x"])
def test_what_the_stretched_lambda_lets_go_of(zero: str, tmp_path: Path) -> None:
    """The arm turns about its slide: the gripper's pivot moves across the arm, which leans by HD6."""
    robot = build(tmp_path, 21, LAMBDA | {11: 0.0}, kin21_c_zero=zero)
    axes = np.array([0.0, 1099.9999, 10.0, 0.0])
    loss = next(one for one in losses_at(robot, axes) if one.kind == "platform")
    assert abs(loss.value) < 2e-3
    ahead, behind = (robot.fk(axes + [0.0, step, 0.0, 0.0]) for step in (1e-5, -1e-5))
    moved = (ahead.translation - behind.translation) / np.linalg.norm(ahead.translation - behind.translation)
    across = np.radians(110.0)
    assert abs(float(moved @ [math.cos(across), math.sin(across), 0.0])) == pytest.approx(1.0, abs=1e-3)
    spin = pin.log3(behind.rotation.T @ ahead.rotation)[2]
    assert (abs(spin) < 1e-9) == (zero == "along_x")
    assert loss.rates is not None
    assert (loss.rates[3] == -1.0) == (zero == "along_x")


def test_paths_report_what_they_pass(tmp_path: Path) -> None:
    robot = build(tmp_path, 12, TRIPOD)
    first = slides([-200.0, 0.0, 0.0], TRIPOD, AZIMUTHS[12])
    last = slides([-319.9, 0.0, 0.0], TRIPOD, AZIMUTHS[12])
    rows = np.linspace(first, last, 50)
    named = dict(examine_path(robot, rows))
    assert 49 in named
    assert named[49].names[0].kind == "strut"
    assert 0 not in named
    report = path_report(robot, rows)
    assert report.stretches
    assert "the rod of Z3 stands nearly across its column" in report.stretches[0].minima[0].sentence
    assert "Z3" in sentence_at(robot, rows[-1], "other", 10.0)
