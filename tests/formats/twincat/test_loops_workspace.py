"""Closed loops all over their workspace: a long way without a jump of the assembly, states found again, rows at once.

Where a machine can stand is told by the hand formulas alone.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from chainbuild import Robot
from chainbuild.analysis.singularity.loops import losses_at
from chainbuild.kinematics.closure import closing_axes, closure_of
from tests.hand.loops_cases import CHOICES, channel_list, differ, random_closing, random_hd
from tests.hand.loops_hand import LOOP_INVERSES, LOOPS
from tests.kit.draws import seed_of

TYPES = sorted(LOOPS)
MACHINES: dict[int, dict[int, float]] = {
    12: {1: 80.0, 3: 20.0, 5: 420.0, 6: 90.0, 7: 650.0},
    209: {1: 120.0, 5: 420.0, 6: 90.0, 7: 650.0, 30: 25.0, 31: 0.0, 34: -50.0, 35: 10.0, 37: -900.0, 40: 1.0},
    37: {1: 50.0, 4: 40.0, 5: 150.0, 6: 500.0, 7: 200.0, 8: 5.0, 10: -10.0},
    21: {1: 60.0, 2: 500.0, 3: 600.0, 4: 450.0, 5: 80.0, 6: 20.0, 11: 40.0},
}
STEPS = 1000
ROUND_TRIPS = 10_000  # a type
SHARE = 0.93  # of the way from the middle to where the hand formula ends
FOUND_AGAIN = 1e-5  # mm and degrees

Hd = dict[int, float]


def build(folder: Path, kin: int, hd: Hd, conv: dict[str, str] | None = None) -> Robot:
    path = folder / f"kin{kin}.lis"
    path.write_text(channel_list(kin, hd))
    return Robot.load(path, conventions=conv or {})


def farthest(kin: int, hd: Hd, T: np.ndarray, way: np.ndarray) -> float:
    """Return how far from a pose along a direction [mm] the hand formula has axis values in the outward assembly."""
    low, high = 0.0, 1000.0
    for _ in range(22):
        middle = (low + high) / 2.0
        pose = T.copy()
        pose[:3, 3] += middle * way
        found = LOOP_INVERSES[kin](hd, pose, 0.0, {})
        # The outermost set comes first, where all levers reach outwards.
        low, high = (middle, high) if found and (kin != 37 or len(found) == 8) else (low, middle)
    return low


def long_way(kin: int, hd: Hd) -> np.ndarray:
    """Return axis values (STEPS, n) of a way that winds from the middle to the edge of the workspace and back."""
    share = np.linspace(0.0, 1.0, STEPS)
    if kin == 21:  # from B's rod nearly upright to both nearly stretched, while the slides travel and the gripper turns
        upright, stretched = math.sqrt(hd[3] ** 2 - hd[2] ** 2) + 40.0, hd[2] + hd[3] - 10.0
        apart = (stretched + upright) / 2.0 + (stretched - upright) / 2.0 * np.sin(2.0 * np.pi * 3.0 * share)
        x1 = -300.0 + 900.0 * np.sin(2.0 * np.pi * share)
        return np.column_stack([x1, x1 + apart, 200.0 * np.cos(5.0 * share), 300.0 * np.sin(4.0 * share)])
    # The platform of 209 moves as that of a tripod, whose columns stand turned by HD30.
    own = {12: hd, 37: hd}.get(kin, {n: hd[n] for n in (1, 5, 6, 7)})
    base = 37 if kin == 37 else 12

    def middle_and_way(t: float) -> tuple[np.ndarray, np.ndarray]:
        T, angle = np.eye(4), 2.0 * np.pi * 6.0 * t
        T[2, 3] = 300.0 * math.sin(4.0 * np.pi * t) if kin != 37 else -480.0 + 60.0 * math.sin(4.0 * np.pi * t)
        return T, np.array([math.cos(angle), math.sin(angle), 0.0])

    some = share[::27]
    edge = np.interp(share, some, [farthest(base, own, *middle_and_way(t)) for t in some])
    rows = []
    for t, far in zip(share.tolist(), edge.tolist(), strict=True):
        T, way = middle_and_way(t)
        T[:3, 3] += SHARE * math.sin(math.pi * t) * far * way
        table = [40.0 * math.sin(6.0 * t), 250.0 * t] if kin == 209 else []
        rows.append([*LOOP_INVERSES[base](own, T, 0.0, {})[0], *table])
    return np.array(rows)


@pytest.mark.parametrize("kin", TYPES)
def test_a_long_way_through_the_workspace_never_jumps(kin: int, tmp_path: Path) -> None:
    hd = MACHINES[kin]
    robot = build(tmp_path, kin, hd)
    way = long_way(kin, hd)
    wanted = []
    for row in way:
        T = LOOPS[kin](hd, row.tolist(), 0.0, {})
        assert T is not None
        wanted.append(T)
    found = robot.fk_batch(way)
    assert np.abs(found[:, :3, 3] * 1000.0 - np.array(wanted)[:, :3, 3]).max() <= 1e-6
    assert np.abs(found[:, :3, :3] - np.array(wanted)[:, :3, :3]).max() <= 1e-9
    # Close to the edge at the outer turns: some strut or rod is nearly singular there, and none is passed.
    losses = [{(loss.kind, loss.axes): loss.value for loss in losses_at(robot, row)} for row in way[::3]]
    least = {key: np.array([one[key] for one in losses]) for key in losses[0]}
    assert min(np.abs(values).min() for values in least.values()) < 0.4
    for key, values in least.items():
        if key[0] != "twist":
            assert (np.sign(values) == np.sign(values[0])).all(), key
    # every body of the assembly, not the tool alone
    closure = closure_of(robot)
    assert max(closure.gap(robot.q(row)) for row in way[::3]) < 1e-12
    frames = np.array([[T.homogeneous for T in robot.frame_placements(row).values()] for row in way[::3]])
    steps = np.abs(np.diff(frames, axis=0)).max(axis=(1, 2, 3))
    assert steps.max() < 12.0 * steps.mean()
    assert len(np.unique(np.round(found[:, :2, 3], 2), axis=0)) > 300
    some = slice(None, None, 4 if kin == 21 else 10)
    back = robot.ik_path(found[some], start=way[0])
    assert all(status == "ok" for status in back.status)
    assert max(differ(kin, one, axes) for one, axes in zip(back.axes, way[some], strict=True)) < FOUND_AGAIN


@pytest.mark.parametrize("kin", TYPES)
def test_rows_at_once_follow_the_hand_formula_by_every_choice(kin: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed_of("rows", kin))
    for name, choices in CHOICES[kin].items():
        for choice in choices:
            conv = {name: choice}
            hd = random_hd(kin, rng, conv)
            rows = np.array([random_closing(kin, hd, conv, rng) for _ in range(12)])
            robot = build(tmp_path, kin, hd, conv)
            wanted = [LOOPS[kin](hd, row.tolist(), 0.0, conv) for row in rows]
            found = robot.fk_batch(rows)
            for T, hand, row in zip(found, wanted, rows, strict=True):
                assert hand is not None
                assert np.abs(T[:3, 3] * 1000.0 - hand[:3, 3]).max() <= 1e-6, (conv, hd, row)
                assert np.abs(T[:3, :3] - hand[:3, :3]).max() <= 1e-9, (conv, hd, row)
                assert np.abs(robot.fk(row).homogeneous - T).max() < 1e-12
                assert np.array_equal(robot.fk(row).homogeneous, robot.kinematics.pose(robot.q(row)).homogeneous)


def round_trips(kin: int, count: int, machines: int, folder: Path) -> None:
    """Forward and back: the state found again, every branch checked by the hand formula, none missed that it has."""
    rng, found_again = np.random.default_rng(seed_of("round trips", kin, count)), 0
    for _ in range(machines):
        hd = random_hd(kin, rng, {})
        robot = build(folder, kin, hd)
        for row in closing_axes(robot, rng, count // machines):
            axes = row.tolist()
            T = LOOPS[kin](hd, axes, 0.0, {})
            assert T is not None
            where = f"KIN_TYP {kin}, HD {hd}, axes {axes}"
            by_hand = LOOP_INVERSES[kin](hd, T, 0.0, {})
            wanted = any(differ(kin, one, axes) < 1e-6 for one in by_hand)
            steady = min(abs(loss.value) for loss in losses_at(robot, row)) > 0.02
            if kin == 209 and abs(T[2, 2]) > 0.999:
                continue  # the table's C turns about the tool vector
            found = robot.ik(pin.SE3(T[:3, :3], T[:3, 3] / 1000.0), start=axes)
            if wanted and steady:
                found_again += 1
                assert found.success, (where, found)
                assert differ(kin, found.axes.tolist(), axes) < FOUND_AGAIN, (where, found)
            if found.success:
                again = LOOPS[kin](hd, found.axes.tolist(), 0.0, {})
                assert again is not None, (where, found)
                assert np.abs(again[:3, 3] - T[:3, 3]).max() < 1e-3, (where, found)
                assert np.abs(again[:3, 2] - T[:3, 2]).max() < 1e-6, (where, found)
            else:
                assert found.reason, where
    assert found_again > 0.5 * count


@pytest.mark.parametrize("kin", TYPES)
def test_states_are_found_again(kin: int, tmp_path: Path) -> None:
    round_trips(kin, 40, 4, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("kin", TYPES)
def test_ten_thousand_states_are_found_again(kin: int, tmp_path: Path) -> None:
    round_trips(kin, ROUND_TRIPS, 50, tmp_path)
