"""Programmed status and turn: what they select, what is refused, and what is said where nothing has them."""

from __future__ import annotations

import numpy as np
import pytest

import chainbuild
from chainbuild.chain.programmed.status import parse_status, parse_turn
from chainbuild.errors import ChainbuildError
from chainbuild.robot import Robot
from tests.kit.arms45 import bent_arm, limited, status_by_frames
from tests.kit.draws import random_axes
from tests.kit.kin_types import build
from tests.kit.robots import arm

SHIPPED = ("kr6r900_2", "tx2_60")
POSE = [10.0, -80.0, 70.0, 20.0, 40.0, 30.0]


@pytest.fixture(scope="module")
def kuka() -> Robot:
    return Robot.load("kr6r900_2")


def drawn(robot: Robot, count: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.array([random_axes(robot, rng) for _ in range(count)])


@pytest.mark.parametrize("make", [*SHIPPED, "bent"])
def test_rows_have_the_status_that_frames_show(make: str) -> None:
    robot = bent_arm() if make == "bent" else Robot.load(make)
    rows = np.random.default_rng(1).uniform(-400.0, 400.0, (2000, 6))
    found = chainbuild.status_turn_rows(robot, rows)
    assert found.shape == (2000, 2)
    assert set(found[:, 0].tolist()) == set(range(8))
    for row, (status, turn) in zip(rows, found.tolist(), strict=True):
        assert (status, turn) == status_by_frames(robot, row)
    for row, (status, turn) in zip(rows[:50], found[:50].tolist(), strict=True):
        assert chainbuild.status_turn(robot, row) == (status, turn)


def test_rows_of_nothing_and_of_a_zero_that_was_rounded(kuka: Robot) -> None:
    assert chainbuild.status_turn_rows(kuka, np.zeros((0, 6))).shape == (0, 2)
    rows = [[10.0, -80.0, 70.0, 20.0, -1e-12, -2.5e-15], [10.0, -80.0, 70.0, 20.0, -1e-8, -1e-8]]
    assert chainbuild.status_turn_rows(kuka, rows).tolist() == [[2, 0b000010], [6, 0b110010]]
    with pytest.raises(chainbuild.AxisValueError):
        chainbuild.status_turn_rows(kuka, [1.0, 2.0])
    with pytest.raises(ChainbuildError, match="KIN_TYP 45 only"):
        chainbuild.status_turn_rows(arm(), np.zeros((2, 6)))


@pytest.mark.parametrize("make", [*SHIPPED, "bent"])
def test_status_and_turn_lead_back_to_the_axes(make: str) -> None:
    """At these random poses, none nearer to a singular one than 0.01 degrees, they name one solution."""
    robot = bent_arm() if make == "bent" else Robot.load(make)
    rows = drawn(robot, 300, 2)
    seen = set()
    for T, wanted, (status, turn) in zip(
        robot.fk_batch(rows), rows, chainbuild.status_turn_rows(robot, rows).tolist(), strict=True
    ):
        found = robot.ik(T, status=status, turn=turn)
        assert found.success, found.reason
        assert (found.status_bits, found.turn_bits) == (status, turn)
        np.testing.assert_allclose(found.axes, wanted, atol=1e-9)
        seen.add(status)
    assert seen == set(range(8))


def test_the_start_does_not_matter_but_between_equals(kuka: Robot) -> None:
    wide = limited(kuka, A2=(-2700.0, 2700.0))
    T = wide.fk(POSE)
    for turns in (-5, -1, 0, 2):
        start = np.array([170.0, 40.0, 150.0, -180.0, -110.0, POSE[5] + turns * 360.0])
        found = wide.ik(T, start, status=2, turn=0b000010 if turns >= 0 else 0b100010)
        np.testing.assert_allclose(found.axes, [*POSE[:5], start[5]], atol=1e-9)


def test_a_turn_selects_whole_turns(kuka: Robot) -> None:
    T = kuka.fk(POSE)
    for turn, flange in ((0b000010, 30.0), (0b100010, -330.0)):
        assert kuka.ik(T, POSE, status=2, turn=turn).axes[5] == pytest.approx(flange)
        assert kuka.ik_all(T, POSE, status=2, turn=turn)[0].axes[5] == pytest.approx(flange)


@pytest.mark.parametrize("make", [*SHIPPED, "wide"])
def test_the_filter_is_the_filter(make: str) -> None:
    robot = (
        limited(Robot.load("kr6r900_2"), B2=(-200.0, 330.0), A2=(-800.0, 800.0)) if make == "wide" else Robot.load(make)
    )
    rng, some = np.random.default_rng(4), 0
    for wanted in drawn(robot, 3 if make == "wide" else 4, 3):
        T, start = robot.fk(wanted), random_axes(robot, rng)
        every = robot.ik_all(T, start, windings=True)
        for status, turn in {*zip(every.status_bits.tolist(), every.turn_bits.tolist(), strict=True), (3, 3)}:
            for asked in (None, turn):
                match = (every.status_bits == status) & ((asked is None) | (every.turn_bits == asked))
                found = robot.ik_all(T, start, windings=True, status=status, turn=asked)
                np.testing.assert_allclose(found.axes, every.axes[match], atol=1e-9)
                nearest = robot.ik_all(T, start, status=status, turn=asked)
                assert len(nearest) <= len(found)
                if match.any():
                    some += 1
                    np.testing.assert_allclose(nearest.axes[0], every.axes[match][0], atol=1e-9)
                    np.testing.assert_allclose(
                        robot.ik(T, start, status=status, turn=asked).axes, every.axes[match][0], atol=1e-9
                    )
    assert some > 20


def test_the_program_of_the_manual() -> None:
    """N020 G01 X1000 Y0 Z1400 A0 B90 C0 IS2 IT2: the tool along X, as B90 turns it."""
    hd = {7: 700.0, 8: 800.0, 9: 700.0, 10: 100.0, 14: -90.0, 15: 90.0}
    robot = limited(build(45, hd).robot, every=(-190.0, 190.0))
    for x in (1.0, 1.1):
        T = np.array([[0.0, 0.0, 1.0, x], [0.0, 1.0, 0.0, 0.0], [-1.0, 0.0, 0.0, 1.4], [0.0, 0.0, 0.0, 1.0]])
        found = robot.ik(T, status=2, turn=2)
        assert found.success, found.reason
        assert found.axes[1] < 0.0
        assert (found.axes[[0, 2, 3, 4, 5]] > -1e-9).all()
        np.testing.assert_allclose(robot.fk(found.axes).homogeneous, T, atol=1e-9)


def test_a_stretched_wrist_leaves_axis_4_to_the_turn() -> None:
    """At A5 = 0 only the sum of axes 4 and 6 counts: `ik` divides it as the turn wants."""
    for name in SHIPPED:
        robot, rng = Robot.load(name), np.random.default_rng(5)
        for wanted in drawn(robot, 40, 6):
            wanted[4] = 0.0
            wanted[3] = rng.choice([wanted[3], 0.0])
            status, turn = chainbuild.status_turn(robot, wanted)
            found = robot.ik(robot.fk(wanted), random_axes(robot, rng), status=status, turn=turn)
            assert found.success, found.reason
            assert chainbuild.status_turn(robot, found.axes) == (status, turn)


def test_what_is_missing_is_said(kuka: Robot) -> None:
    T = kuka.fk(POSE)
    other = kuka.ik(T, status=0, turn=1)
    assert (other.success, other.status) == (False, "limits")
    assert "status 0 with turn 1 is reached only outside the limits of" in other.reason
    assert "; inside the limits: status 0 with turn " in other.reason
    assert set(other.violated) <= {axis.name for axis in kuka.axes}
    behind = kuka.ik(kuka.fk([0.0, -80.0, 80.0, 0.0, 10.0, 0.0]), status=3)
    assert behind.status == "limits"
    assert behind.violated == ("C1",)
    far = T.copy()
    far.translation[0] = 9.0
    assert kuka.ik(far, status=2).reason == kuka.ik(far).reason
    straight = kuka.fk([10.0, -80.0, 70.0, 20.0, 0.0, 30.0])
    bent_back = kuka.ik(straight, POSE, status=6)
    assert (bent_back.success, bent_back.status) == (False, "limits")  # only A5 = -360 is below 0 there
    assert bent_back.violated == ("B3",)


def test_many_turns_do_not_make_a_failure_slow(kuka: Robot) -> None:
    wide = limited(kuka, A1=(-2700.0, 2700.0), A2=(-2700.0, 2700.0), C1=(-2700.0, 2700.0), B1=(-190.0, 0.0))
    refused = wide.ik(wide.fk(POSE), POSE, status=2, turn=0)
    assert (refused.success, refused.violated) == (False, ("B1",))
    assert refused.reason.endswith("; inside the limits: status 2 with turn 2")


def test_a_held_axis_has_its_say(kuka: Robot) -> None:
    T = kuka.fk(POSE)
    assert kuka.ik(T, POSE, {"A2": 30.0}, status=2, turn=2).success
    refused = kuka.ik(T, POSE, {"A2": 30.0}, status=2, turn=0b100010)
    assert (refused.success, refused.status) == (False, "unreachable")
    assert refused.reason == "no solution has status 2 with turn 34; inside the limits: status 2 with turn 2"


def test_units_are_those_asked_for(kuka: Robot) -> None:
    T = kuka.fk(POSE)
    np.testing.assert_allclose(kuka.ik(T, status=2, turn=2, units="si").axes, np.radians(POSE), atol=1e-9)
    assert kuka.ik_all(T, status=2, units="si").units == "si"


@pytest.mark.parametrize(
    ("options", "message", "parameter"),
    [
        ({"turn": 2}, "needs the pose status", "status"),
        ({"status": 8}, "status (IS) is 8; permitted: whole numbers of 0 … 7", "status"),
        ({"status": -1}, "status (IS) is -1", "status"),
        ({"status": 2.0}, "status (IS) is 2.0", "status"),
        ({"status": True}, "status (IS) is True", "status"),
        ({"status": "2"}, "status (IS) is '2'", "status"),
        ({"status": 2, "turn": 64}, "permitted: whole numbers of 0 … 63", "turn"),
        ({"status": 2, "turn": 16}, "says axis 5 >= 0, turn 16 (IT) says axis 5 < 0; permitted: turn 0", "turn"),
        ({"status": 6, "turn": 2}, "says axis 5 < 0, turn 2 (IT) says axis 5 >= 0; permitted: turn 18", "turn"),
    ],
)
def test_what_the_controller_refuses(kuka: Robot, options, message: str, parameter: str) -> None:
    for solve in (kuka.ik, kuka.ik_all):
        with pytest.raises(ChainbuildError) as caught:
            solve(np.eye(4), **options)
        assert message in str(caught.value)
        assert caught.value.parameter == parameter
        assert caught.value.permitted


@pytest.mark.parametrize(
    "options", [{"solver": "damped"}, {"solver": "controller"}, {"prefer": "near"}, {"absolute_c_deg": 10.0}]
)
def test_nothing_else_chooses_the_solution(kuka: Robot, options) -> None:
    with pytest.raises(ChainbuildError) as caught:
        kuka.ik(np.eye(4), status=2, **options)
    assert caught.value.parameter == next(iter(options))
    assert kuka.ik(kuka.fk(POSE), status=np.int64(2), solver="analytic").success


def test_other_kinematics_have_no_status() -> None:
    for solve in (arm().ik, arm().ik_all):
        with pytest.raises(ChainbuildError, match="KIN_TYP 45 only"):
            solve(np.eye(4), status=2)


@pytest.mark.parametrize("text", ["2", " 2 ", "02", "2.0", "0b10", "0B010", "'B010'", "'b10'", "2#10", "02#010"])
def test_texts_of_a_status(text: str) -> None:
    assert parse_status(text) == 2
    assert parse_turn(text) == 2


@pytest.mark.parametrize(
    "text", ["8", "-1", "2.5", "B10", "'B10", "10'", "0b12", "0b1000", "1e0", "nan", "٢", "9" * 5000]
)
def test_texts_that_are_none(text: str) -> None:
    with pytest.raises(ChainbuildError, match="is no status") as caught:
        parse_status(text)
    assert caught.value.parameter == "is"
    assert "0 … 7" in caught.value.permitted
    assert len(str(caught.value)) < 200


def test_an_empty_text_is_no_status() -> None:
    assert parse_status("  ") is None
    assert parse_turn("") is None
    assert parse_turn("0b111111") == 63
    with pytest.raises(ChainbuildError, match="'64' is no turn; parameter it; permitted: 0 … 63"):
        parse_turn("64")
