"""Closed loops 12, 21, 37, 209 against formulas by hand from the manual, by somebody who had not seen the recipes.

As in test_hand_formulas the machine goes the whole way from the channel list to the pose: zero and non-zero offsets,
either sign, every choice of every convention, and axis values drawn until the struts close.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import chainbuild
from chainbuild.convention import conventions
from chainbuild.errors import ChainbuildError
from tests.hand.loops_cases import (
    CHOICES,
    channel_list,
    circle,
    differ,
    random_closing,
    random_far,
    random_hd,
    random_regular,
)
from tests.hand.loops_hand import LOOP_CHOICES, LOOP_INVERSES, LOOPS, limits37
from tests.hand.tables_algebra import Matrix
from tests.kit.draws import seed_of
from tests.kit.paths import REFERENCE

TYPES = sorted(LOOPS)
POSITION_MM = 1e-6
ROTATION = 1e-9
FOUND_AGAIN = 1e-5  # mm and degrees: solvers stop at 1e-6 m and rad at the latest, and polish

STATES = 2000  # a type, those of its choices among them
MACHINES = 12
CHOICE_MACHINES = 2
CHOICE_STATES = 15

Hd = dict[int, float]
Conv = dict[str, str]


def build(folder: Path, kin: int, hd: Hd, length: float = 0.0, conv: Conv | None = None) -> chainbuild.Robot:
    path = folder / f"kin{kin}.lis"
    path.write_text(channel_list(kin, hd))
    return chainbuild.Robot(chainbuild.load(path).chain(tool_length_mm=length, conventions=conv))


def by_hand(kin: int, hd: Hd, axes: list[float], length: float = 0.0, conv: Conv | None = None) -> Matrix:
    T = LOOPS[kin](hd, axes, length, conv or {})
    assert T is not None
    return T


def metres(T: Matrix) -> pin.SE3:
    return pin.SE3(T[:3, :3], T[:3, 3] / 1000.0)


def compare(folder: Path, kin: int, rng: np.random.Generator, states: int, conv: Conv) -> None:
    hd, length = random_hd(kin, rng, conv), float(rng.choice([0.0, rng.uniform(10.0, 200.0)]))
    robot = build(folder, kin, hd, length, conv)
    for _ in range(states):
        axes = random_closing(kin, hd, conv, rng)
        T, wanted = robot.fk(axes), by_hand(kin, hd, axes, length, conv)
        missed = np.abs(T.translation * 1000.0 - wanted[:3, 3]).max(), np.abs(T.rotation - wanted[:3, :3]).max()
        where = f"KIN_TYP {kin}, {conv}, HD {hd}, L {length}, axes {axes}"
        assert missed[0] <= POSITION_MM and missed[1] <= ROTATION, f"{missed}: {where}"


@pytest.mark.parametrize("kin", TYPES)
def test_loop_follows_its_hand_formula(kin: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("loops", kin))
    by_choice = CHOICE_MACHINES * CHOICE_STATES * sum(map(len, CHOICES[kin].values()))
    for _ in range(MACHINES):
        compare(tmp_path, kin, rng, (STATES - by_choice) // MACHINES + 1, {})


EVERY_CHOICE = [(kin, name, choice) for kin in TYPES for name in CHOICES[kin] for choice in CHOICES[kin][name]]


@pytest.mark.parametrize(("kin", "name", "choice"), EVERY_CHOICE)
def test_loop_follows_its_hand_formula_by_every_choice(kin: int, name: str, choice: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("loops", kin, name, choice))
    for _ in range(CHOICE_MACHINES):
        compare(tmp_path, kin, rng, CHOICE_STATES, {name: choice})


def test_registry_and_hand_formulas_name_the_same_choices() -> None:
    own = {name for name in conventions() if name.split("_")[0] in ("kin12", "kin21", "kin37", "kin209")}
    assert own == set(LOOP_CHOICES)
    for name, choices in LOOP_CHOICES.items():
        convention = conventions()[name]
        assert set(convention.choices) == set(choices)
        assert convention.default == choices[0], name
    for kin in TYPES:
        applying = {name for name, convention in conventions().items() if f"KIN {kin}" in convention.applies}
        assert applying == set(CHOICES[kin])


@pytest.mark.parametrize("kin", TYPES)
def test_axes_are_named_as_the_manual_does(kin: int, tmp_path: Path) -> None:
    names = {12: "Z1 Z2 Z3", 21: "X1 X2 Z C", 37: "J1 J2 J3", 209: "Z1 Z2 Z3 A C"}[kin].split()
    hd = random_hd(kin, np.random.default_rng(seed_of("names", kin)), {}) | ({31: 0.0} if kin == 209 else {})
    assert [axis.name for axis in build(tmp_path, kin, hd).axes] == names
    if kin == 209:
        assert [axis.name for axis in build(tmp_path, kin, hd | {31: 1.0}).axes][3:] == ["B", "C"]


def test_reference_poses_of_a_delta_robot() -> None:
    conv = {"kin37_azimuth": "deg_minus_90", "kin37_numbering": "ccw"}
    truth = json.loads((REFERENCE / "kin37_0.json").read_text("utf-8"))
    robot = chainbuild.Robot(chainbuild.load(REFERENCE / "kin37_0.lis").chain(conventions=conv))
    assert len(truth["rows"]) > 20
    for row in truth["rows"]:
        T = robot.fk(row["axes"])
        assert np.abs(T.translation * 1000.0 - row["p"]).max() <= 1e-6
        assert np.abs(T.rotation - np.eye(3)).max() <= ROTATION


@pytest.mark.parametrize("choice", ["axis", "lever"])
def test_limits_of_37(choice: str, tmp_path: Path) -> None:
    conv = {"kin37_limits_of": choice}
    hd = random_hd(37, np.random.default_rng(seed_of("limits")), {}) | {8: 5.0, 9: 0.0, 10: -7.0, 11: -30.0, 12: 60.0}
    wanted = limits37(hd, conv)
    assert wanted is not None
    axes = build(tmp_path, 37, hd, conv=conv).axes
    assert np.allclose([(axis.lower, axis.upper) for axis in axes], wanted, rtol=0, atol=1e-9)
    assert not any(axis.assumed for axis in axes)
    assert all(axis.assumed for axis in build(tmp_path, 37, hd | {11: 0.0, 12: 0.0}).axes)


STRUTS = r"(?is)(rod|strut).*(short|long)|(short|long).*(rod|strut)"


@pytest.mark.parametrize("kin", TYPES)
def test_states_that_do_not_close_name_the_strut(kin: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("far", kin))
    for _ in range(10):
        hd, axes = random_far(kin, random_hd(kin, rng, {}), rng)
        robot = build(tmp_path, kin, hd)
        for call in (robot.fk, robot.jacobian, robot.q):
            with pytest.raises(ChainbuildError, match=STRUTS):
                call(axes)


def numeric_jacobian(kin: int, hd: Hd, axes: list[float], length: float) -> Matrix:
    """Central differences of the hand formula in the tool's axes, by metres and radians."""
    step, columns = 1e-3, []
    rotary = {12: (), 21: (3,), 37: (0, 1, 2), 209: (3, 4)}[kin]
    R = by_hand(kin, hd, axes, length)[:3, :3]
    for n in range(len(axes)):
        ahead, behind = (
            by_hand(kin, hd, [value + sign * step * (n == m) for m, value in enumerate(axes)], length)
            for sign in (1.0, -1.0)
        )
        si = 2.0 * step * (np.pi / 180.0 if n in rotary else 1e-3)
        spin = R.T @ (ahead - behind)[:3, :3] / si
        linear = R.T @ (ahead - behind)[:3, 3] / 1000.0 / si
        columns.append([*linear, spin[2, 1], spin[0, 2], spin[1, 0]])
    return np.array(columns).T


@pytest.mark.parametrize("kin", TYPES)
def test_jacobian_is_the_derivative_of_the_hand_formula(kin: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("jacobian", kin))
    for _ in range(5):
        hd = random_hd(kin, rng, {})
        robot = build(tmp_path, kin, hd, 60.0)
        for _ in range(10):
            axes = random_closing(kin, hd, {}, rng)
            assert robot.jacobian(axes) == pytest.approx(numeric_jacobian(kin, hd, axes, 60.0), abs=1e-6, rel=1e-6)


@pytest.mark.parametrize("kin", TYPES)
def test_inverse_kinematics_find_the_state_again(kin: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("again", kin))
    for _ in range(4):
        hd = random_hd(kin, rng, {})
        robot = build(tmp_path, kin, hd, 60.0)
        for _ in range(5):
            axes = random_regular(kin, hd, {}, rng, 60.0)
            T = by_hand(kin, hd, axes, 60.0)
            result = robot.ik(metres(T), start=axes)
            assert result.success, (hd, axes, result)
            assert differ(kin, result.axes, axes) < FOUND_AGAIN
            if kin == 12:
                assert differ(kin, robot.ik(metres(T)).axes, axes) < FOUND_AGAIN
            if kin == 37 and len(every := LOOP_INVERSES[37](hd, T, 60.0, {})) == 8:
                assert differ(kin, robot.ik(metres(T)).axes, every[0]) < FOUND_AGAIN  # all levers outward
            if kin == 209:
                held = {robot.axes[n].name: axes[n] for n in (3, 4)}
                assert differ(kin, robot.ik(metres(T), held=held).axes, axes) < FOUND_AGAIN
            free = robot.ik(metres(T))
            assert free.success
            assert robot.fk(free.axes).translation * 1000.0 == pytest.approx(T[:3, 3], abs=1e-3)


@pytest.mark.parametrize("kin", TYPES)
def test_every_branch_is_found_and_no_other(kin: int, tmp_path: Path) -> None:
    """12: one; 209: the table tilted to either side; 21: two or four; 37: eight where every lever reaches twice."""
    rng = np.random.default_rng(seed_of("branches", kin))
    counts = set()
    for _ in range(4):
        hd = random_hd(kin, rng, {})
        robot = build(tmp_path, kin, hd, 60.0)
        for _ in range(5):
            axes = random_regular(kin, hd, {}, rng, 60.0)
            T = by_hand(kin, hd, axes, 60.0)
            wanted = LOOP_INVERSES[kin](hd, T, 60.0, {})
            found = robot.ik_all(metres(T), start=axes)
            where = f"HD {hd}, axes {axes}, found {[list(one.axes) for one in found]}, by hand {wanted}"
            assert len(found) == len(wanted), where
            for one in wanted:
                assert min(differ(kin, other.axes, one) for other in found) < FOUND_AGAIN, where
            for other in found:
                T_met = by_hand(kin, hd, list(other.axes), 60.0)
                assert T_met[:3, 3] == pytest.approx(T[:3, 3], abs=1e-3)
                assert T_met[:3, 2] == pytest.approx(T[:3, 2], abs=1e-6)
            counts.add(len(wanted))
    assert max(counts) == {12: 1, 21: max(counts), 37: 8, 209: 2}[kin]


@pytest.mark.parametrize("kin", TYPES)
def test_a_path_of_a_thousand_steps_never_jumps(kin: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("path", kin))
    hd = random_hd(kin, rng, {})
    robot = build(tmp_path, kin, hd)
    path = circle(kin, hd, {}, rng, 1000)
    there = [robot.fk(axes) for axes in path]
    wanted = np.array([by_hand(kin, hd, axes.tolist())[:3, 3] for axes in path])
    assert np.abs([T.translation * 1000.0 for T in there] - wanted).max() <= POSITION_MM
    # every body of the assembly, not the tool alone
    frames = np.array([[T.homogeneous for T in robot.frame_placements(axes).values()] for axes in path])
    steps = np.abs(np.diff(frames, axis=0)).max(axis=(1, 2, 3))
    assert steps.max() < 10.0 * steps.mean()
    # the same poses whichever way and in whatever order they are asked for
    order = rng.permutation(len(path))
    for n in order:
        assert np.array_equal(robot.fk(path[n]).homogeneous, there[n].homogeneous)
    assert np.abs(robot.fk_batch(path) - [T.homogeneous for T in there]).max() < 1e-12
    back = robot.ik_path(there[::10], start=path[0])
    assert all(status == "ok" for status in back.status)
    assert max(differ(kin, found, axes) for found, axes in zip(back.axes, path[::10], strict=True)) < FOUND_AGAIN


@pytest.mark.parametrize("kin", TYPES)
def test_the_same_axes_give_the_same_pose_after_any_other_call(kin: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("pure", kin))
    hd = random_hd(kin, rng, {})
    robot = build(tmp_path, kin, hd, 60.0)
    axes, other = (random_regular(kin, hd, {}, rng, 60.0) for _ in range(2))
    first, J, q = robot.fk(axes).homogeneous, robot.jacobian(axes), robot.q(axes)
    _, far = random_far(kin, hd, rng)

    def refused() -> None:
        if LOOPS[kin](hd, far, 60.0, {}) is None:
            with pytest.raises(ChainbuildError):
                robot.fk(far)

    calls = (
        lambda: robot.fk(other),
        lambda: robot.jacobian(other),
        lambda: robot.ik(robot.fk(other)),
        lambda: robot.ik_all(robot.fk(other)),
        lambda: robot.fk_batch([other, axes]),
        lambda: robot.frame_placements(other),
        lambda: robot.display(other),
        refused,
    )
    for call in calls:
        call()
        assert np.array_equal(robot.fk(axes).homogeneous, first)
        assert np.array_equal(robot.jacobian(axes), J)
        assert np.array_equal(robot.q(axes), q)
    fresh = build(tmp_path, kin, hd, 60.0)
    assert np.array_equal(fresh.fk(axes).homogeneous, first)


def test_columns_that_no_tripod_can_have(tmp_path: Path) -> None:
    hd = {5: 500.0, 6: 100.0, 7: 500.0}
    for extra in ({8: 1.0, 9: 200.0, 10: 160.0}, {6: 500.0}):  # no room for the third angle; parallel rods
        with pytest.raises(ChainbuildError):
            build(tmp_path, 12, hd | extra)
    unused = build(tmp_path, 12, hd | {9: 100.0, 10: 135.0})  # HD8 = 0
    assert any("HD9" in str(finding) or "HD10" in str(finding) for finding in unused.chain.findings)
