"""Poses that a closed chain does not reach: a status, and in words which strut, which limit or which direction."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from chainbuild import IkOptions, Robot
from chainbuild.errors import ChainbuildError
from tests.hand.loops_cases import channel_list, random_hd, random_regular
from tests.hand.loops_hand import LOOPS
from tests.kit.draws import seed_of

SHIPPED = ("tripod_kin12", "delta_kin37", "lambda_kin21", "tripod_table_kin209")


def shifted(robot: Robot, axes: np.ndarray, by: tuple[float, float, float]) -> pin.SE3:
    T = robot.fk(axes)
    T.translation = T.translation + np.array(by)
    return T


def middle(robot: Robot) -> np.ndarray:
    return np.array([sum(axis.range) / 2.0 for axis in robot.axes])


def test_every_rod_that_is_too_short_is_told_with_its_length() -> None:
    robot = Robot.load("tripod_kin12")
    T = shifted(robot, middle(robot), (1.5, 0.0, 0.0))
    found = robot.ik(T)
    assert found.status == "unreachable"
    # Seen from above the platform's middle is 1500 mm from the axis; columns stand at 120, 240 and 0 degrees, 330 out.
    side = math.hypot(1500.0 + 165.0, 330.0 * math.sqrt(0.75)) - 650.0
    told = [float(number) for number in re.findall(r"is ([0-9.]+) mm too short", found.reason)]
    assert told == pytest.approx([side, side, 1500.0 - 330.0 - 650.0], abs=5e-3)
    assert re.findall(r"the rod of (\w+) is", found.reason) == ["Z1", "Z2", "Z3"]
    delta = Robot.load("delta_kin37")
    T = delta.fk([10.0, 10.0, 10.0])
    T.translation = np.array([0.0, 0.0, -2.0])
    found = delta.ik(T)
    # From the motors' ring, 110 mm wider than the platform's, to its pins 50 mm above the clamp.
    short = math.hypot(1950.0, 110.0) - 700.0
    told = [float(number) for number in re.findall(r"is ([0-9.]+) mm too short", found.reason)]
    assert told == pytest.approx([short] * 3, abs=5e-3)


@pytest.mark.parametrize(
    ("name", "by", "status", "reason"),
    [
        ("tripod_kin12", (0.0, 0.0, 3.0), "limits", r"outside the limits of Z1, Z2, Z3"),
        ("lambda_kin21", (0.0, 0.0, 3.0), "limits", r"outside the limits of Z$"),
        ("lambda_kin21", (1.5, 0.0, 0.0), "limits", r"outside the limits of X1"),
        ("lambda_kin21", (0.0, 1.2, 0.0), "unreachable", r"too far: the tool ends [0-9.]+ mm off"),
        ("tripod_table_kin209", (2.0, 0.0, 0.0), "unreachable", r"the rod of Z1 is [0-9.]+ mm too short"),
    ],
)
def test_what_is_in_the_way_is_told(name: str, by: tuple[float, float, float], status: str, reason: str) -> None:
    robot = Robot.load(name)
    T = shifted(robot, middle(robot), by)
    for start in (None, middle(robot)):
        found = robot.ik(T, start=start)
        assert found.status == status
        assert re.search(reason, found.reason), found.reason
    assert not len(robot.ik_all(T))
    table = robot.ik_batch([robot.fk(middle(robot)).homogeneous, T.homogeneous])
    assert list(table.status) == ["ok", status]
    assert re.search(reason, table[1].reason)
    path = robot.ik_path([robot.fk(middle(robot)), T], start=middle(robot))
    assert list(path.status) == ["ok", status]


def test_an_orientation_that_cannot_be_is_told() -> None:
    """The lambda's gripper turns about Z alone: it is asked for. Platforms do not turn: what is missed is said."""
    robot = Robot.load("lambda_kin21")
    T = robot.fk(middle(robot))
    T.rotation = T.rotation @ pin.exp3(np.array([0.3, 0.0, 0.0]))
    found = robot.ik(T)
    assert found.status == "unreachable"
    assert "the position can be reached, but not with this orientation" in found.reason
    delta = Robot.load("delta_kin37")
    T = delta.fk([10.0, 20.0, 30.0])
    T.rotation = pin.exp3(np.array([0.3, 0.0, 0.0]))
    found = delta.ik(T)
    assert found.success
    assert found.rotation_error == pytest.approx(0.3)
    assert "17.2 deg" in repr(found)


@pytest.mark.parametrize("name", SHIPPED)
def test_rows_of_a_batch_that_do_not_close_are_named(name: str, tmp_path: Path) -> None:
    robot = Robot.load(name)
    rows = np.array([middle(robot)] * 5)
    if name == "delta_kin37":  # with rods that do not reach one another between level levers
        (tmp_path / "short.lis").write_text(channel_list(37, {4: 40.0, 5: 150.0, 6: 280.0, 7: 200.0}))
        robot = Robot.load(tmp_path / "short.lis")
        rows[:] = 60.0
        rows[3] = 0.0
    elif name == "lambda_kin21":
        rows[3, 1] += 5000.0
    else:
        rows[3, 0] += 3000.0
    with pytest.raises(ChainbuildError) as alone:
        robot.fk(rows[3])
    with pytest.raises(ChainbuildError) as told:
        robot.fk_batch(rows)
    assert str(told.value).startswith("row 3: ")
    assert str(alone.value) in str(told.value)
    assert told.value.parameter == alone.value.parameter
    assert robot.fk_batch(rows[:3]).shape == (3, 4, 4)


@pytest.mark.parametrize("kin", [12, 21, 37, 209])
def test_at_full_reach_a_pose_is_found(kin: int, tmp_path: Path) -> None:
    """From the middle outwards: as long as a hand formula closes a pose is found, and beyond it is refused in words."""
    rng = np.random.default_rng(seed_of("edge", kin))
    hd = random_hd(kin, rng, {})
    path = tmp_path / f"kin{kin}.lis"
    path.write_text(channel_list(kin, hd))
    robot = Robot.load(path)
    start = random_regular(kin, hd, {}, rng, 0.0)
    T = LOOPS[kin](hd, start, 0.0, {})
    assert T is not None
    way = np.array([1.0, 0.0, 0.0]) if kin != 21 else np.array([0.0, 1.0, 0.0])
    low, high = 0.0, 5000.0

    def found(far: float) -> bool:
        result = robot.ik(pin.SE3(T[:3, :3], (T[:3, 3] + far * way) / 1000.0), start=start)
        assert result.success or result.reason
        assert np.isfinite(result.axes).all()
        return bool(result.success)

    assert found(low)
    assert not found(high)
    for _ in range(60):
        between = (low + high) / 2.0
        low, high = (between, high) if found(between) else (low, between)
    assert high - low < 1e-9
    assert found(low - 1e-6)


def test_a_batch_takes_the_struts_alone_as_one_pose_does(tmp_path: Path) -> None:
    delta = Robot.load("delta_kin37")
    rows = np.array([[10.0, 20.0, 30.0], [0.0, 60.0, 40.0], [-20.0, -10.0, 5.0]])
    T = delta.fk_batch(rows)
    table = delta.ik_batch(T)
    single = [delta.ik(one) for one in T]
    assert np.array_equal(table.axes, [one.axes for one in single])
    assert table.axes == pytest.approx(rows, abs=1e-9)
    near = delta.ik_batch(T, start=rows, units="controller")
    assert near.axes == pytest.approx(rows, abs=1e-9)
    assert delta.ik_batch(T[:1], held={}).axes == pytest.approx(rows[:1], abs=1e-9)
    T[1, 0, 0] = 3.0
    with pytest.raises(ChainbuildError, match="pose 1: "):
        delta.ik_batch(T)


@pytest.mark.parametrize("name", ["tripod_kin12", "lambda_kin21", "tripod_table_kin209"])
def test_the_damped_search_from_where_nothing_closes(name: str) -> None:
    """It starts elsewhere or gives up; neither ends in what is no number."""
    robot = Robot.load(name)
    lower, upper = np.array([axis.range for axis in robot.axes]).T
    apart = np.where(np.arange(len(lower)) % 2 == 0, lower, upper)
    far = middle(robot)
    far[0] += 4000.0
    T = robot.fk(middle(robot))
    for start in (apart, far):
        for options in (None, IkOptions(max_restarts=0)):
            found = robot.ik(T, start=start, solver="damped", options=options)
            assert np.isfinite(found.axes).all()
            assert not math.isnan(found.position_error + found.rotation_error)
            assert found.success or found.reason
        assert robot.ik(T, start=start).success
